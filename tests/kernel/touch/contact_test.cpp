// Contacts with planes: the impulse formula, bounce heights, rest, friction and symmetry.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

class Contacts : public CaseTest {};
INSTANTIATE_TEST_SUITE_P(every, Contacts, testing::ValuesIn(every_case()), NameOf{});

// The largest relative error of the first ten apex heights of a ball dropped from 1 m. During flight the energy gives
// the apex.
Number worst_apex(AnyWorld& world, Number restitution) {
    Number worst = 0, expected = 1;
    bool falling = true;
    for (int bounces = 0, step = 0; bounces < 10 && step < 4000; ++step) {
        world.step();
        const Motion m = world.motion(0);
        if (falling && m.v.y > 0) {
            ++bounces;
            expected *= restitution * restitution;
            const Number apex = m.x.y - 0.5L + m.v.y * m.v.y / 2 / g;
            worst = std::max(worst, std::abs(apex / expected - 1));
        }
        falling = m.v.y <= 0;
        if (step == 3999) return 1;
    }
    return worst;
}

TEST_P(Contacts, a_ball_bounces_to_its_heights) {
    if (order() < 2) GTEST_SKIP() << "falls with the error of order 1";
    for (const Number restitution : {1.0L, 0.8L}) {
        const auto world = build(floor(restitution, 0, {placed(sphere(1, 0.5), {0, 1.5, 0})}), GetParam());
        const Number worst = worst_apex(*world, restitution);
        std::printf("%s: restitution %.1Lf, worst of ten apex heights off by %.2Lg\n", name_of(GetParam()).c_str(),
                    restitution, worst);
        EXPECT_LE(worst, tolerance::apex.of(system())) << restitution;
        EXPECT_TRUE(world->status().ok());
    }
}

TEST_P(Contacts, a_ball_comes_to_rest_and_stays) {
    for (const Number restitution : {0.0L, 0.5L, 0.9L}) {
        const auto world = run(floor(restitution, 0, {placed(sphere(1, 0.5), {0, 1, 0})}), 256 * 20);
        EXPECT_TRUE(world->status().ok()) << restitution << ": status " << static_cast<int>(world->status().bits)
                                          << " at step " << world->status().first_step;
        Number lowest = 1, highest = 0;
        for (int step = 0; step < 1000; ++step) {
            world->step();
            const Number height = world->motion(0).x.y - 0.5L;
            lowest = std::min(lowest, height);
            highest = std::max(highest, height);
        }
        EXPECT_LE(-lowest, tolerance::depth.of(system())) << restitution;
        // A method of order 1 may add g h to the speed of every hop. The hops last until restitution takes as much.
        const Number hop = order() == 1 ? 2 * g / 256 / (1 - restitution) : g / 256 * 1.01L;
        EXPECT_LE(highest - hop * hop / 2 / g, tolerance::depth.of(system())) << restitution;
        EXPECT_LE(norm(world->motion(0).v), hop) << restitution;
    }
}

TEST_P(Contacts, a_ball_pressed_down_by_a_force_rests_too) {
    SceneSetup setup = floor(0.5L, 0, {placed(sphere(1, 0.5), {0, 0.5, 0})});
    setup.forces = {{.body = 0, .from = 0.0, .until = 100.0, .force = {0, -100, 0}}};
    const auto world = run(setup, 256 * 4);
    // A hop of a method of order 1 adds (g + f) h to the speed. The hops last until restitution takes as much.
    const Number step_speed = (g + 100) / 256;
    EXPECT_LE(norm(world->motion(0).v),
              order() == 1 ? tolerance::pressed_hop.of(system()) * step_speed : tolerance::rest_speed.of(system()));
    EXPECT_LE(std::abs(world->motion(0).x.y - 0.5L), tolerance::place.of(system()));
}

TEST_P(Contacts, a_tilted_box_comes_to_rest_on_a_face) {
    const BodySpec body = oriented(placed(box(2, {1, 0.5, 0.75}), {0, 1.5, 0}), {0.9, {0.1, -0.3, 0.2}});
    const auto world = run(floor(0.25L, 0.5L, {body}), 256 * 15);
    const Motion m = world->motion(0);
    const Vector up = m.q.normalized().rotate_back({0, 1, 0});  // the plane's normal in the box's axes
    const Number upright = std::max({std::abs(up.x), std::abs(up.y), std::abs(up.z)});
    EXPECT_LE(norm(m.v), tolerance::rest_speed.of(system())) << "height " << m.x.y;
    EXPECT_LE(norm(m.w), tolerance::rest_speed.of(system()));
    EXPECT_LE(1 - upright, tolerance::rest_tilt.of(system()));
    const Number half = std::abs(up.x) == upright ? 0.5L : std::abs(up.y) == upright ? 0.25L : 0.375L;
    EXPECT_LE(std::abs(m.x.y - half), tolerance::place.of(system()));
    EXPECT_FALSE(world->status().has(Issue::contacts_full) || world->status().has(Issue::range_left));
}

TEST_P(Contacts, a_box_hit_off_centre_gets_the_spin_of_the_impulse_formula) {
    struct Shape {
        RealVec3 edges;
        RealQuat orientation;
    };
    for (const Shape& shape :
         {Shape{{1, 0.5, 0.75}, {0.9, {0.1, -0.3, 0.2}}}, Shape{{0.25, 2, 0.25}, {0.95, {0.1, 0.05, 0.25}}},
          Shape{{1, 1, 1}, {0.8, {0.3, 0.1, -0.4}}}}) {
        for (const Number restitution : {0.0L, 0.5L, 1.0L}) {
            const BodySpec body = oriented(placed(box(2, shape.edges), {0, 3, 0}, {0.5, -4, 0.25}), shape.orientation);
            SceneSetup setup = floor(restitution, 0, {body});
            setup.world.gravity = {};
            const auto world = build(setup, GetParam());
            const Motion before = start_of(body);
            // The lowest corner.
            const Vector n{0, 1, 0}, n_b = before.q.rotate_back(n), half = vector(shape.edges) * Number(0.5);
            const Vector r{n_b.x > 0 ? -half.x : half.x, n_b.y > 0 ? -half.y : half.y, n_b.z > 0 ? -half.z : half.z};
            const Vector moments{number(body.inertia.xx), number(body.inertia.yy), number(body.inertia.zz)};
            const Number j = (1 + restitution) * 4 / (0.5L + dot(cross(r, n_b), over(cross(r, n_b), moments)));
            const Vector v = before.v + n * (j / 2), w = over(cross(r, n_b * j), moments);
            for (int step = 0; step < 256 && world->contact_count(0) == 0; ++step) world->step();
            ASSERT_EQ(world->contact_count(0), 1);
            ASSERT_TRUE(world->status().ok());
            const Motion after = world->motion(0);
            EXPECT_LE(norm(after.v - v), tolerance::contact_impulse.of(system())) << restitution;
            // The rest of the step after the impact rotates w a little if the body is not a sphere, so momenta are
            // compared.
            EXPECT_LE(norm(angular_momentum(after, moments) - before.q.rotate(times(moments, w))),
                      tolerance::contact_impulse.of(system()) +
                          tolerance::method_error(order(), norm(w) / 256, norm(w) / 256))
                << restitution;
        }
    }
}

TEST_P(Contacts, a_box_that_falls_flat_bounces_without_spin) {
    const auto world = build(floor(0.5L, 0, {placed(box(2, {1, 0.5, 0.75}), {0, 1.25, 0})}), GetParam());
    bool bounced = false;
    for (int step = 0; step < 512; ++step) {
        world->step();
        bounced = bounced || world->motion(0).v.y > 1;
        ASSERT_LE(norm(world->motion(0).w), tolerance::symmetric_spin.of(system())) << step;
        ASSERT_LE(std::abs(world->motion(0).v.x) + std::abs(world->motion(0).v.z),
                  tolerance::symmetric_spin.of(system()))
            << step;
    }
    EXPECT_TRUE(bounced);
}

TEST_P(Contacts, a_shape_without_contact_falls_through_the_floor) {
    SceneSetup setup = floor(0.5L, 0, {top({1, 2, 3}, {})});
    setup.bodies[0].position = {0, 1, 0};
    const auto world = run(setup, 256);
    EXPECT_LT(world->motion(0).x.y, -3);
    EXPECT_EQ(world->contact_count(0), 0);
}

class ContactsOfFew : public Contacts {};
INSTANTIATE_TEST_SUITE_P(every, ContactsOfFew, testing::ValuesIn(contact_cases()), NameOf{});

// The largest distance of a ball of the given radius beyond walls at x = 0 and x = width, or beyond a floor at y = 0.
Number deepest(AnyWorld& world, const Axes3& axes, Number radius, Number width, int steps) {
    Number deep = 0;
    for (int step = 0; step < steps; ++step) {
        world.step();
        const Vector x = axes.from_world(world.motion(0).x);
        deep = std::max({deep, radius - x.x, x.x + radius - width, radius - x.y});
    }
    return deep;
}

// 0.1 m above the floor: a bounce takes 0.29 s.
TEST_P(ContactsOfFew, an_elastic_ball_never_gains_energy_in_1e4_bounces) {
    constexpr int wanted = 10000;
    const auto world = build(floor(1, 0, {placed(sphere(1, 0.5), {0, 0.6015625, 0})}), GetParam());
    const Number start = g * 0.1015625L;
    Number greatest = 0, least = 1e9L;
    int bounces = 0;
    bool falling = true;
    for (int step = 0; bounces < wanted && step < 100 * wanted; ++step) {
        world->step();
        const Motion m = world->motion(0);
        if (falling && m.v.y > 0) ++bounces;
        falling = m.v.y <= 0;
        const Number energy = g * (m.x.y - 0.5L) + dot(m.v, m.v) / 2;
        greatest = std::max(greatest, energy);
        least = std::min(least, energy);
    }
    std::printf("%s: %d elastic bounces, energy from %+.2Lg to %+.2Lg\n", name_of(GetParam()).c_str(), bounces,
                least / start - 1, greatest / start - 1);
    EXPECT_EQ(bounces, wanted);
    EXPECT_LE(greatest / start - 1, tolerance::elastic_gain.of(system()));
}

// Decimal speeds, positions and steps give impacts at the very end of a step.
TEST_P(ContactsOfFew, a_ball_between_walls_never_passes_a_wall) {
    const Seconds steps[] = {{1, 100}, {1, 100}, {1, 200}, {1, 128}, {1, 256}};
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Random random{seed};
        const Axes3 axes = random_axes(random);
        const Number restitution = random.between(0, 1) == 0 ? 1 : decimal(random.uniform(0.5, 1), 2);
        const Number radius = random.between(0, 1) == 0 ? 0.1L : 0.05L, width = decimal(random.uniform(0.3, 0.7), 1);
        const Number speed = decimal(random.uniform(1, 12), random.between(0, 1));
        const Number x = std::clamp(decimal(random.uniform(0, 0.7), 2), radius, width - radius);
        SceneSetup setup{.name = "walls", .step = steps[random.between(0, 4)]};
        setup.world = {.gravity = real(axes.to_world({0, random.between(0, 3) == 0 ? 0 : -9.81L, 0})),
                       .contact = {.restitution = real(restitution)}};
        setup.planes = {axes.plane({0, 1, 0}), axes.plane({1, 0, 0}), axes.plane({-1, 0, 0}, width)};
        if (random.between(0, 1) == 0) setup.planes[0].restitution = 0;
        setup.bodies = {sphere(real(decimal(random.uniform(0.1, 5), 1)), real(radius))};
        setup.bodies[0].position = real(axes.to_world({x, radius, 0}));
        setup.bodies[0].velocity = real(axes.to_world({random.between(0, 1) == 0 ? speed : -speed, 0, 0}));
        const auto world = build(setup, GetParam());
        EXPECT_LE(deepest(*world, axes, radius, width, 150), tolerance::depth.of(system())) << "seed " << seed;
        EXPECT_TRUE(world->status().ok()) << "seed " << seed;
    }
}

TEST_P(ContactsOfFew, a_ball_with_too_many_impacts_in_a_step_stays_between_its_walls) {
    int told = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        Random random{seed};
        const Axes3 axes = random_axes(random);
        const Number radius = random.uniform(0.05, 0.2), room = random.uniform(2e-4, 1e-2);
        SceneSetup setup{.name = "narrow", .step = random.between(0, 1) == 0 ? Seconds{1, 100} : Seconds{1, 256}};
        setup.world.contact.restitution = random.between(0, 1) == 0 ? 1 : random.uniform(0, 1);
        setup.planes = {axes.plane({1, 0, 0}), axes.plane({-1, 0, 0}, 2 * radius + room)};
        setup.bodies = {sphere(random.uniform(0.1, 10), real(radius))};
        setup.bodies[0].position = real(axes.to_world({radius + room * random.uniform(0.1, 0.9), 10, 0}));
        setup.bodies[0].velocity = real(axes.to_world({random.uniform(5, 30), 0, 0}));
        const auto world = build(setup, GetParam());
        EXPECT_LE(deepest(*world, axes, radius, 2 * radius + room, 64), tolerance::depth.of(system()))
            << "seed " << seed;
        EXPECT_FALSE(world->status().has(Issue::range_left)) << "seed " << seed;
        told += world->status().has(Issue::step_bound_hit) ? 1 : 0;
    }
    EXPECT_GT(told, 30);
    EXPECT_LT(told, 90);
}

// Small dice: an edge that hits sends them beyond the range of spin, and the next corner within the same step brings
// them back. While nothing is reported, they move as in double precision, until one step separates them.
TEST_P(ContactsOfFew, leaving_the_range_between_two_impacts_of_a_step_is_reported) {
    int told = 0, whole = 0;
    for (std::uint64_t seed = 0; seed < 75; ++seed) {
        Random random{seed};
        const Axes3 axes = random_axes(random);
        const double size = seed % 3 == 0 ? 0.01 : seed % 3 == 1 ? 0.05 : 0.1, turn = 11;
        SceneSetup setup{.name = "die"};
        setup.world = {.gravity = real(axes.to_world({0, -9.81L, 0})),
                       .contact = {.restitution = random.uniform(0, 0.9), .friction = random.uniform(0, 0.6)}};
        setup.planes = {axes.plane({0, 1, 0})};
        setup.bodies = {box(random.uniform(1e-3, 1), {size, size, size})};
        setup.bodies[0].position = real(axes.to_world({0, 1, 0}));
        setup.bodies[0].orientation = real(exponential(direction(random) * random.uniform(-3, 3)));
        setup.bodies[0].angular_velocity = real(direction(random) * random.uniform(0, turn));
        const auto world = build(setup, GetParam()), truth = build(setup, GetParam().method.name, "f64");
        Number before = 0;
        bool same = true;
        for (int step = 0; step < 205 && same && world->step().ok(); ++step) {
            truth->step();
            const Motion a = world->motion(0), b = truth->motion(0);
            const Number apart = std::max(norm(a.v - b.v), norm(a.w - b.w) * static_cast<Number>(size));
            EXPECT_FALSE(before < 1e-4L && apart > 0.2L) << "seed " << seed << ", step " << step << ": " << apart;
            same = apart < 0.05L;
            before = apart;
        }
        (world->status().ok() ? whole : told) += 1;
    }
    if (system().fixed_point) { EXPECT_GT(told, 25); }
    EXPECT_GT(whole, 8);
}

// A die that rattles to rest on its corners, with random axes, mass, size, friction, speed and step.
SceneSetup thrown_die(std::uint64_t seed) {
    Random random{seed};
    const Axes3 axes = random_axes(random);
    SceneSetup setup{.name = "die", .step = {1, random.between(0, 1) == 0 ? 256 : 300}};
    setup.world = {
        .gravity = real(axes.to_world({0, -9.81L, 0})),
        .contact = {.restitution = 0, .friction = real(0.2L * random.between(0, 2)), .tolerance = real(0.002L)}};
    setup.planes = {axes.plane({0, 1, 0})};
    const auto edge = [&] { return real(decimal(random.uniform(0.06, 0.1), 3)); };
    BodySpec die = box(real(decimal(random.uniform(0.05, 5), 2)), {edge(), edge(), edge()});
    die.position = real(axes.to_world({0, decimal(random.uniform(0.1, 0.2), 3), 0}));
    die.velocity = real(axes.to_world(direction(random) * 0.5L));
    const Vector tilt = direction(random);
    die.orientation = {real(random.uniform(-1, 1)), real(tilt)};
    die.angular_velocity = real(direction(random) * 3.0L);
    setup.bodies = {die};
    return setup;
}

// An impact leaves corners that arrive exactly at the end of the step. Rounding must not decide which of them are held.
TEST_P(ContactsOfFew, dice_come_to_rest_as_they_do_in_double) {
    constexpr int dice = 200;
    int other_way = 0;
    for (int i = 0; i < dice; ++i) {
        const SceneSetup setup = thrown_die(static_cast<std::uint64_t>(i));
        const auto world = build(setup, GetParam()), expected = build(setup, GetParam().method.name, "f64");
        Number apart = 0;
        for (int step = 0; step < 150; ++step) {
            world->step();
            expected->step();
            apart = std::max(apart, norm(world->motion(0).w - expected->motion(0).w));
        }
        EXPECT_TRUE(world->status().ok() && expected->status().ok()) << "die " << i;
        if (apart > 0.3L) ++other_way;  // rad/s
    }
    std::printf("%s: %d of %d dice go another way\n", name_of(GetParam()).c_str(), other_way, dice);
    EXPECT_LE(other_way, 4);  // at least 36 if rounding decides
}

// Planes at offsets of up to four times the range of positions, the most in fixed point.
TEST_P(ContactsOfFew, a_ball_meets_a_far_plane_as_it_does_in_double) {
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        Random random{seed};
        const Axes3 axes = random_axes(random);
        SceneSetup setup{.name = "far plane"};
        setup.world = {.gravity = real(axes.to_world({0, -9.81L, 0}))};
        setup.planes = {
            axes.plane(random.between(0, 1) == 0 ? Vector{0, 1, 0} : direction(random), random.uniform(-0.5, 4) * 64)};
        setup.bodies = {sphere(random.uniform(0.1, 10), random.uniform(0.05, 1))};
        setup.bodies[0].position =
            real(Vector{random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-60, 60)});
        setup.bodies[0].velocity = real(direction(random) * random.uniform(0, 10));
        const auto world = build(setup, GetParam()), truth = build(setup, GetParam().method.name, "f64");
        for (int step = 0; step < 128 && world->step().ok(); ++step) truth->step();
        if (!world->status().ok()) continue;
        EXPECT_LE(norm(world->motion(0).x - truth->motion(0).x), tolerance::far_plane.of(system())) << "seed " << seed;
    }
}

// The unit of length follows from the largest body, or from the largest displacement in a step.
TEST(ContactTolerance, below_the_resolution_of_the_numbers_still_holds_a_ball_on_a_floor) {
    struct Floor {
        RealVec3 edges;
        Seconds step;
        Number off;  // m
    };
    for (const Floor& floor :
         {Floor{{600, 1, 600}, {1, 256}, 1e-3L}, Floor{{1, 1, 1e5}, {1, 256}, 0.2L}, Floor{{2, 1, 2}, {1, 4}, 0.05L}}) {
        for (const double tolerance : {1e-6, 1e-9, 1e-300}) {
            for (const Case& c : every_case()) {
                if (std::string_view{c.method.name} != "verlet" && std::string_view{c.method.name} != "rk4") continue;
                for (const bool plane : {false, true}) {
                    SceneSetup setup{.name = "floor", .step = floor.step};
                    setup.world = {.gravity = gravity,
                                   .contact = {.restitution = 0, .friction = 0.5, .tolerance = Real{tolerance}}};
                    setup.bodies = {fixed(placed(box(1, floor.edges), {0, plane ? -2.0 : -0.5, 0})),
                                    placed(sphere(1, 0.005), {0, 0.00495, 0}, {0, -0.001, 0})};
                    if (plane) setup.planes = {{}};
                    const auto world = build(setup, c);
                    world->run(64);
                    EXPECT_LE(std::abs(world->motion(1).x.y - 0.005L), floor.off)
                        << name_of(c) << ", tolerance " << tolerance << ", edges " << number(floor.edges.z);
                }
            }
        }
    }
}

// Sizes, steps, masses, speeds and tolerances over many decades, bodies inside each other and far below planes. The
// result is finite and in its range, or the status reports it.
TEST_P(ContactsOfFew, extreme_scenes_stay_finite_or_are_reported) {
    const auto decades = [](Random& random, double least, double most) {
        return std::pow(10, random.uniform(least, most));
    };
    for (std::uint64_t seed = 0; seed < 120; ++seed) {
        Random random{seed};
        SceneSetup setup{.name = "extreme", .step = Seconds{Real{decades(random, -6, 1)}}};
        setup.world = {.gravity = real(direction(random) * decades(random, -3, 4)),
                       .contact = {.restitution = random.uniform(0, 1),
                                   .friction = random.uniform(0, 2),
                                   .tolerance = decades(random, -12, 1)}};
        for (int i = random.between(0, 2); i > 0; --i)
            setup.planes.push_back({.normal = real(direction(random)), .offset = random.uniform(-256, 256)});
        for (int i = random.between(1, 3); i > 0; --i) {
            const double size = decades(random, -5, 6), mass = decades(random, -5, 5);
            BodySpec body = random.between(0, 1) == 0
                                ? sphere(mass, size)
                                : box(mass, {size, size * decades(random, -2, 0), size * decades(random, -2, 0)});
            body.position = real(direction(random) * random.uniform(0, 63));
            body.fixed = i > 1 && random.between(0, 3) == 0;
            if (!body.fixed) body.velocity = real(direction(random) * random.uniform(0, 31));
            body.angular_velocity = real(direction(random) * decades(random, -3, 1));
            body.orientation = real(exponential(direction(random) * random.uniform(-3, 3)));
            setup.bodies.push_back(body);
        }
        const auto world = build(setup, GetParam());
        for (int step = 0; step < 30 && world->step().ok(); ++step) {}
        for (int b = 0; b < world->body_count(); ++b) {
            const Motion m = world->motion(b);
            EXPECT_TRUE(!world->status().ok() || std::isfinite(norm(m.x) + norm(m.v) + norm(m.w))) << "seed " << seed;
        }
    }
    // Gravity that moves a body further in a step than lengths hold, and a plane that no body reaches.
    SceneSetup setup{.name = "fall", .step = Seconds{33, 20}};
    setup.world.gravity = {0, -1000, 0};
    setup.bodies = {placed(sphere(1, 0.1), {0, 60, 0})};
    setup.planes = {{.offset = 256}};
    EXPECT_TRUE(!build(setup, GetParam())->step().ok() || !system().fixed_point);
}

using ContactDeathTest = ContactsOfFew;
INSTANTIATE_TEST_SUITE_P(every, ContactDeathTest, testing::ValuesIn(cases_of("verlet")), NameOf{});

TEST_P(ContactDeathTest, impossible_contact_values_end_the_program) {
    SceneSetup good = floor(0.5L, 0.5L);
    good.bodies = {sphere(1, 1), box(1, {1, 1, 0.125})};
    (void)build(good, GetParam());
    const auto dies = [&](const char* what, auto&& spoil) {
        SceneSetup bad = good;
        spoil(bad);
        EXPECT_DEATH((void)build(bad, GetParam()), "") << what;
    };
    using Contact = ContactSpec;
    for (Real Contact::*value : {&Contact::restitution, &Contact::restitution_threshold, &Contact::friction,
                                 &Contact::tolerance, &Contact::stiffness, &Contact::damping, &Contact::barrier})
        dies("a negative value", [&](SceneSetup& bad) { bad.world.contact.*value = -1e-3; });
    for (Real SleepSpec::*value : {&SleepSpec::speed, &SleepSpec::angular_speed, &SleepSpec::time})
        dies("a negative limit of sleep", [&](SceneSetup& bad) { bad.world.contact.sleep.*value = -1e-3; });
    dies("a restitution above 1", [](SceneSetup& bad) { bad.world.contact.restitution = 1.0001; });
    dies("a body's above 1", [](SceneSetup& bad) { bad.bodies[1].restitution = 5; });
    dies("a plane's above 1", [](SceneSetup& bad) { bad.planes[0].restitution = 2; });
    dies("no tolerance", [](SceneSetup& bad) { bad.world.contact.tolerance = 0; });
    dies("a negative radius", [](SceneSetup& bad) { bad.bodies[0].shape.size.x = -1; });
    dies("no radius", [](SceneSetup& bad) { bad.bodies[0].shape.size.x = 0; });
    dies("a negative edge", [](SceneSetup& bad) { bad.bodies[1].shape.size.z = -1; });
    dies("no edges", [](SceneSetup& bad) { bad.bodies[1].shape.size = {}; });
    if (!system().fixed_point) return;
    const double farthest = system().name == std::string_view{"q32_field"} ? 131072 : 256;
    SceneSetup far = good;
    far.planes = {{.offset = farthest}, {.offset = -farthest}};
    (void)build(far, GetParam());
    dies("a plane too far away", [&](SceneSetup& bad) { bad.planes[0].offset = farthest * 1.001; });
    dies("a plane too far above", [&](SceneSetup& bad) { bad.planes[0].offset = -1e20; });
    dies("a sphere of 1e20 m", [](SceneSetup& bad) { bad.bodies[0].shape.size.x = 1e20; });
    dies("a box of 1e20 m", [](SceneSetup& bad) { bad.bodies[1].shape.size.y = 1e20; });
}

}  // namespace
}  // namespace tumble::test
