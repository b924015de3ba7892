// Impacts of several points at one moment: the order of bodies and the handedness of a scene do not matter, no impact
// makes energy, and light bodies keep their restitution.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

class Impacts : public CaseTest {
protected:
    // m/s and rad/s that rounding leaves to bodies of a metre.
    static Number rounding() { return system().bits == 64 ? 1e-9L : 2e-5L; }
};
INSTANTIATE_TEST_SUITE_P(every, Impacts, testing::ValuesIn(contact_cases()), NameOf{});

BodySpec with_axes(BodySpec body, const Axes3& axes) {
    body.position = real(axes.to_world(vector(body.position)));
    body.velocity = real(axes.to_world(vector(body.velocity)));
    return body;
}

// By symmetry both balls of mass m get the impulse J along the directions from the first: J (1/m + 2 c^2/M) =
// (1 + e) v c, with the cosine c of half the angle between them.
TEST_P(Impacts, a_ball_strikes_two_at_once_and_they_leave_like_mirror_images) {
    Random random{41};
    for (const Number restitution : {1.0L, 0.5L, 0.0L}) {
        for (const Number mass : {1.0L, 0.25L, 30.0L}) {
            for (const bool swapped : {false, true}) {
                const Axes3 axes = random_axes(random);
                const Number radius = 0.125L, c = std::sqrt(0.75L), v = 2;
                const Number side = swapped ? -radius : radius;
                SceneSetup setup = space(
                    restitution, 0,
                    {with_axes(placed(sphere(real(mass), real(radius)), {-0.5L - 2 * radius * c, 0, 0}, {v, 0, 0}),
                               axes),
                     with_axes(placed(sphere(1, real(radius)), {0, side, 0}), axes),
                     with_axes(placed(sphere(1, real(radius)), {0, -side, 0}), axes)});
                const auto world = run(setup, second / 2);
                const Number impulse = (1 + restitution) * v * c / (1 + 2 * c * c / mass);
                const Number allowed = 1e-5L * v + rounding();
                EXPECT_LE(norm(world->motion(0).v - axes.to_world({v - 2 * impulse * c / mass, 0, 0})), allowed);
                for (int b = 1; b < 3; ++b) {
                    const Number y = (b == 1 ? side : -side) / radius * 0.5L;
                    EXPECT_LE(norm(world->motion(b).v - axes.to_world({impulse * c, impulse * y, 0})), allowed) << mass;
                }
            }
        }
    }
}

// One law for all that does not answer a push: a plane is put in the place of the top of a fixed box.
TEST_P(Impacts, on_a_fixed_box_are_those_on_a_plane) {
    Random random{53};
    const Number allowed = system().bits == 64 ? 1e-7L : rounding();  // m; within rounding until a face has landed
    for (int t = 0; t < 12; ++t) {
        const Axes3 axes = t % 2 == 0 ? Axes3{} : Axes3{random};
        const Number restitution = 0.45L * (t % 3), friction = t % 4 < 2 ? 0.5L : 0;
        BodySpec body = t % 5 == 0 ? sphere(2, 0.25) : box(2, {0.25, 0.375, 0.1875});
        body.position = real(axes.to_world({0.1L, random.uniform(0.625, 0.8125), -0.1L}));
        body.velocity = real(direction(random) * 0.5L);
        body.angular_velocity = real(direction(random) * 3);
        body.orientation = real(exponential(direction(random) * 2));
        BodySpec block = fixed(placed(box(1, {4, 1, 4}), axes.to_world({0, -0.5L, 0})));
        block.orientation = real(axes.turn());
        SceneSetup on_plane = floor(restitution, friction, {body}),
                   on_box = space(restitution, friction, {body, block});
        on_plane.world.gravity = on_box.world.gravity = real(axes.to_world({0, -g, 0}));
        on_plane.planes = {axes.plane({0, 1, 0})};
        const auto first = build(on_plane, GetParam()), second_one = build(on_box, GetParam());
        Number lowest = 1;
        for (int step = 0; step < second / 2; ++step) {
            first->step();
            second_one->step();
            EXPECT_LE(norm(first->motion(0).x - second_one->motion(0).x), allowed) << t << ", step " << step;
            lowest = std::min(lowest, axes.from_world(second_one->motion(0).x).y);
        }
        EXPECT_LT(lowest, 0.5L) << "it has come to the floor";
    }
}

// The friction of each side works against the normal of the other.
TEST_P(Impacts, a_ball_that_falls_into_a_wedge_stays_in_its_middle) {
    for (const Number restitution : {0.5L, 0.8L}) {
        for (const Number friction : {0.0L, 0.3L, 0.45L}) {
            for (const Number slope : {0.5L, 1.0L, 1.7320508L}) {
                for (const Number radius : {0.1L, 0.25L}) {
                    SceneSetup setup = floor(restitution, friction, {placed(sphere(2, real(radius)), {0, 1.5L, 0})});
                    const Vector normal = Vector{1, slope, 0} * (1 / std::hypot(1.0L, slope));
                    setup.planes = {{.normal = real(normal)}, {.normal = real(Vector{-normal.x, normal.y, 0})}};
                    const auto world = build(setup, GetParam());
                    for (int step = 0; step < 2 * second; ++step) world->step();
                    EXPECT_LE(std::abs(world->motion(0).x.x), 1e-5L) << "slope " << slope << ", " << friction;
                    EXPECT_LE(std::abs(world->motion(0).v.x), 1e-4L) << "slope " << slope << ", " << friction;
                }
            }
        }
    }
}

// The rows of a triangle of balls are at right angles to x; mirror partners are at opposite z.
TEST_P(Impacts, a_triangle_of_balls_breaks_like_its_mirror_image) {
    for (const Number restitution : {0.95L, 0.6L}) {
        SceneSetup setup = space(restitution, 0, {placed(sphere(1, 0.125), {-1, 0, 0}, {4, 0, 0})});
        for (int row = 0; row < 4; ++row)
            for (int k = 0; k <= row; ++k)
                setup.bodies.push_back(
                    placed(sphere(1, 0.125), {0.125L * std::sqrt(3.0L) * row, 0, 0.25L * (k - row / 2.0L)}));
        const auto world = run(setup, second);
        int first = 1;
        for (int row = 0; row < 4; first += ++row) {
            for (int k = 0; k <= row; ++k) {
                const Vector x = world->motion(first + k).x, mirrored = world->motion(first + row - k).x;
                EXPECT_LE(std::hypot(x.x - mirrored.x, x.z + mirrored.z), system().bits == 64 ? 1e-9L : 1e-4L)
                    << "row " << row << ", ball " << k;
            }
        }
    }
}

// Newton's law with friction makes energy here: 56 % with the restitution 1.
TEST_P(Impacts, a_rough_rod_that_lands_on_an_end_gains_no_energy) {
    for (const Number restitution : {1.0L, 0.9L, 0.8L}) {
        for (const Number friction : {0.5L, 1.0L}) {
            for (const Number hand : {1.0L, -1.0L}) {
                SceneSetup setup = space(restitution, friction);
                setup.planes = {{}};
                BodySpec rod = placed(box(3, {1, 0.1, 0.1}), {0, 0.36235L, 0}, {0, -1, 0});
                rod = oriented(rod, {0.93937271, {0, 0, real(hand * 0.34289781L)}});
                rod.angular_velocity = real(Vector{0, 0, hand * 4.2L});
                setup.bodies = {rod};
                const auto world = build(setup, GetParam());
                const Number before = sums_of(*world, setup.bodies).energy;
                for (int step = 0; step < 8; ++step) world->step();
                EXPECT_LE(sums_of(*world, setup.bodies).energy, before * (1 + 1e-5L)) << restitution;
                EXPECT_GT(world->motion(0).v.y, 0.1L) << restitution;
            }
        }
    }
}

// A box that lands on an edge has two points, between which friction couples the impulses. Its mirror images in x and
// in z, and the scene turned by a right angle about the vertical, have the mirrored and turned motion.
TEST_P(Impacts, a_rough_impact_on_an_edge_is_that_of_its_mirror_image) {
    Random random{1};
    for (int i = 0; i < 12; ++i) {
        const Number tilt = random.uniform(0.1, 0.7), friction = random.uniform(0.3, 1),
                     half = random.uniform(0.05, 0.3);
        const Vector size{0.4L, 0.1L, 2 * half};
        const Number low = size.x / 2 * std::sin(tilt) + size.y / 2 * std::cos(tilt);
        const Vector v{random.uniform(-2, 2), -1, random.uniform(-2, 2)},
            spin{random.uniform(-0.3, 0.3), random.uniform(-3, 3), random.uniform(-3, 3)};
        const auto after = [&](const auto& place, const auto& turn, RealQuat orientation, RealQuat about_y) {
            SceneSetup setup = space(0.25L, friction);
            setup.planes = {{}};
            BodySpec body = oriented(placed(box(2, real(size)), {0, low, 0}, place(v)), about_y * orientation);
            body.angular_velocity = real(rotation(body.orientation).normalized().rotate_back(turn(spin)));
            setup.bodies = {body};
            return run(setup, 2)->motion(0).v;
        };
        const RealQuat none{1, {0, 0, 0}}, quarter{Real(0.70710678118654752), {0, Real(0.70710678118654752), 0}};
        const RealQuat up{real(std::cos(tilt / 2)), {0, 0, real(std::sin(tilt / 2))}}, down{up.w, {0, 0, -up.v.z}};
        const auto same = [](Vector a) { return a; };
        const auto turned = [](Vector a) { return Vector{a.z, a.y, -a.x}; };
        const auto across_x = [](Vector a) { return Vector{-a.x, a.y, a.z}; };
        const auto across_z = [](Vector a) { return Vector{a.x, a.y, -a.z}; };
        const auto spin_across_x = [](Vector w) { return Vector{w.x, -w.y, -w.z}; };
        const auto spin_across_z = [](Vector w) { return Vector{-w.x, -w.y, w.z}; };
        const Vector first = after(same, same, up, none);
        const Number bound = system().bits == 64 ? 1e-6L : 1e-3L;
        EXPECT_LE(norm(turned(first) - after(turned, turned, up, quarter)), bound) << i;
        EXPECT_LE(norm(across_x(first) - after(across_x, spin_across_x, down, none)), bound) << i;
        EXPECT_LE(norm(across_z(first) - after(across_z, spin_across_z, up, none)), bound) << i;
    }
}

// A rod that lies flat and spins strikes with one end at a time. Each time Newton's law holds at that end alone.
TEST_P(Impacts, an_end_that_rises_takes_no_part_in_the_impact_of_the_other) {
    for (const Number restitution : {1.0L, 0.9L, 0.5L}) {
        for (const Number spin : {4.0L, -4.0L, 3.0L}) {
            SceneSetup setup = space(restitution);
            setup.planes = {{}};
            BodySpec body = placed(box(2, {1, 0.125, 0.125}), {0, 0.0625L, 0}, {0, -1, 0});
            body.angular_velocity = real(Vector{0, 0, spin});
            setup.bodies = {body};
            const auto world = run(setup, 2);
            const Number inertia = moments_of(body).z / 2;  // over the mass
            Number v = -1, w = spin;
            for (Number arm = spin > 0 ? -0.5L : 0.5L; v + w * arm < 0; arm = -arm) {
                const Number impulse = -(1 + restitution) * (v + w * arm) / (1 + arm * arm / inertia);
                v += impulse;
                w += arm * impulse / inertia;
            }
            EXPECT_LE(std::abs(world->motion(0).v.y - v), 0.001L) << restitution << ", " << spin;
            EXPECT_LE(std::abs(world->motion(0).w.z - w), 0.01L) << restitution << ", " << spin;
        }
    }
}

// The step ends before another point of the rim comes down.
TEST_P(Impacts, a_rim_that_lands_tilted_bounces_on_the_point_that_touches_alone) {
    const Number radius = 0.125L, tilt = 0.03125L, flown = 0.9375L / second;
    for (const BodySpec& shape : {hoop(2, real(radius)), cylinder(2, real(radius), 0.03125)})
        for (const Number restitution : {0.0L, 0.5L, 1.0L})
            for (const Number spin : {16.0L, 4.0L, -4.0L}) {
                const bool is_hoop = shape.shape.kind == ShapeKind::hoop;
                const Number half = is_hoop ? 0 : 0.015625L;
                const Rotation upright = reference::exponential(Vector{-std::acos(0.0L) + tilt - spin * flown, 0, 0});
                BodySpec body = placed(shape, {0, radius * std::sin(tilt) + half * std::cos(tilt) + flown, 0},
                                       {0, -1, 0}, {spin, 0, 0});
                body.orientation = real(upright);
                SceneSetup setup = space(restitution, 0, {body});
                setup.planes = {{}};
                const auto world = run(setup, 1);
                const Number arm = radius * std::cos(tilt) - half * std::sin(tilt), over_mass = moments_of(body).x / 2,
                             change = (1 + restitution) * (1 + spin * arm) / (1 + arm * arm / over_mass);
                EXPECT_LE(std::abs(world->motion(0).v.y - (change - 1)), 0.001L) << restitution << ", " << spin;
                EXPECT_LE(std::abs(world->motion(0).w.x - (spin - change * arm / over_mass)), 0.02L)
                    << restitution << ", " << spin;
                EXPECT_LE(world->contact_count(0), 1);
            }
}

TEST_P(Impacts, no_impact_makes_energy) {
    Random random{43};
    for (int i = 0; i < 40; ++i) {
        SceneSetup setup = space(random.uniform(0.5, 1), i % 2 == 0 ? 0 : random.uniform(0.1, 1));
        setup.planes = {{}};
        const int count = random.between(1, 2);
        for (int b = 0; b < count; ++b) {
            BodySpec body =
                box(real(random.uniform(0.3, 3)),
                    {real(random.uniform(0.2, 1)), real(random.uniform(0.2, 1)), real(random.uniform(0.2, 1))});
            body = placed(body, {0, 1 + 1.5L * b, 0}, Vector{random.uniform(-1, 1), -2.0L - b, random.uniform(-1, 1)});
            const Vector axis = direction(random);
            if (i % 3 != 0) body = oriented(body, {0.8, real(axis * 0.6L)});
            body.angular_velocity = real(direction(random) * 3);
            setup.bodies.push_back(body);
        }
        const auto world = build(setup, GetParam());
        Number last = sums_of(*world, setup.bodies).energy;
        for (int step = 0; step < second; ++step) {
            world->step();
            const Number now = sums_of(*world, setup.bodies).energy;
            ASSERT_LE(now, last * (1 + 1e-4L)) << "scene " << i << ", step " << step;
            last = now;
        }
    }
}

// It slides in the impact, so friction is mu times the normal impulse. Seen from the turntable it loses energy; seen
// from the ground it gains.
TEST_P(Impacts, a_ball_that_a_turntable_drags_along_still_bounces) {
    for (const Number rate : {6.0L, -8.0L}) {
        for (const Number restitution : {0.5L, 1.0L}) {
            for (const Number friction : {0.5L, 1.0L}) {
                SceneSetup setup = space(restitution, friction);
                BodySpec table = placed(box(1, {4, 0.5, 4}), {0, -0.25L, 0}, {}, {0, rate, 0});
                table.fixed = true;
                setup.bodies = {placed(sphere(2, 0.125), {1.5L, 0.1875L, 0}, {0, -1, 0}), table};
                const auto world = run(setup, second / 4);
                const Number along = friction * (1 + restitution) * (rate > 0 ? -1 : 1);
                EXPECT_LE(norm(world->motion(0).v - Vector{0, restitution, along}), 1e-3L) << rate;
            }
        }
    }
}

// With its mass over a million a heavy ball goes on, and a light one leaves twice as fast.
TEST_P(Impacts, a_light_ball_keeps_its_restitution) {
    for (const Number ratio : {1e3L, 1e5L, 1e6L}) {
        for (const bool heavy_first : {true, false}) {
            for (const Number restitution : {1.0L, 0.5L}) {
                SceneSetup setup =
                    space(restitution, 0,
                          {placed(sphere(real(ratio), 0.125), {-1, 0, 0}, {3, 0, 0}), placed(sphere(1, 0.125), {})});
                if (!heavy_first) std::swap(setup.bodies[0], setup.bodies[1]);
                const auto world = run(setup, second);
                const Number leaves = 3 * (1 + restitution) * ratio / (ratio + 1);
                EXPECT_LE(std::abs(world->motion(heavy_first ? 1 : 0).v.x - leaves), 1e-4L * leaves) << ratio;
            }
        }
    }
}

}  // namespace
}  // namespace tumble::test
