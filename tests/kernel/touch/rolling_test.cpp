// Resistance to rolling and spinning, by closed forms. A moment r N acts against the rolling of a body with the moment
// of inertia I about its axis. Where it rolls on a plane without slip, it is slower by r g / (R (1 + I / (m R^2))) each
// second. A moment s N acts against its spin about the normal.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

class Rolling : public CaseTest {
protected:
    // m and m/s after a second: what sweeps and rounding leave.
    static Number allowed() { return system().bits == 64 ? 1e-7L : 2e-4L; }

    static SceneSetup rolling_floor(Number rolling, Number spinning = 0) {
        SceneSetup setup = sleepy_floor(0.5L);
        setup.world.contact.rolling_resistance = real(rolling);
        setup.world.contact.spinning_resistance = real(spinning);
        return setup;
    }
    // It rolls without slip along `way`, in the plane of the floor.
    static BodySpec rolling_ball(Number mass, Number radius, Vector way, Number up = 0) {
        return placed(sphere(real(mass), real(radius)), {0, up + radius, 0}, way,
                      cross(Vector{0, 1, 0}, way) * (1 / radius));
    }
    // m/s^2
    static Number slowing(Number rolling, Number radius, Number inertia_per_mass) {
        return rolling * g / (radius * (1 + inertia_per_mass / (radius * radius)));
    }
};
INSTANTIATE_TEST_SUITE_P(every, Rolling, testing::ValuesIn(contact_cases()), NameOf{});

TEST_P(Rolling, a_ball_slows_down_stops_where_it_must_and_falls_asleep) {
    for (const Number radius : {0.03125L, 0.25L}) {
        for (const Number resistance : {0.001L, 0.004L}) {
            for (const Vector way : {Vector{1, 0, 0}, Vector{-0.3L, 0, 0.4L}}) {
                SceneSetup setup = rolling_floor(resistance);
                setup.bodies = {rolling_ball(0.75L, radius, way)};
                const auto world = build(setup, GetParam());
                const Number speed = norm(way), slower = slowing(resistance, radius, 0.4L * radius * radius);
                const int half = static_cast<int>(speed / slower * second / 2);
                world->run(half);
                const Number time = Number(half) / second, left = speed - slower * time;
                EXPECT_LE(norm(world->motion(0).v - way * (left / speed)), allowed());
                EXPECT_LE(norm(world->motion(0).w) - left / radius, allowed() / radius);
                world->run(half + second + 2);
                const Vector end = Vector{0, radius, 0} + way * (speed / slower / 2);
                // The last step may end a step early.
                EXPECT_LE(norm(world->motion(0).x - end),
                          allowed() * (1 + norm(end)) + slower / (2.0L * second * second));
                EXPECT_TRUE(world->asleep(0));
                EXPECT_TRUE(world->status().ok());
            }
        }
    }
}

TEST_P(Rolling, a_cylinder_and_a_capsule_slow_down_by_their_moments_of_inertia) {
    const Number radius = 0.125L, resistance = 0.002L;
    for (const bool ends_are_round : {false, true}) {
        SceneSetup setup = rolling_floor(resistance);
        const BodySpec body = ends_are_round ? capsule(2, real(radius), 0.5) : cylinder(2, real(radius), 0.5);
        setup.bodies = {placed(body, {0, radius, 0}, {1, 0, 0}, {0, 0, -1 / radius})};
        const auto world = run(setup, second);
        const Number slower = slowing(resistance, radius, number(body.inertia.zz) / 2);
        EXPECT_LE(norm(world->motion(0).v - Vector{1 - slower, 0, 0}), allowed());
    }
}

TEST_P(Rolling, a_ball_on_an_incline_stays_up_to_the_angle_of_its_resistance) {
    const Number radius = 0.125L, resistance = 0.004L;
    for (const Number part : {0.5L, 0.97L, 1.05L, 2.0L}) {
        for (const Number side : {1.0L, -1.0L}) {
            SceneSetup setup = rolling_floor(resistance);
            const Number slope = std::atan(part * resistance / radius);
            setup.world.gravity = real(Vector{side * g * std::sin(slope), -g * std::cos(slope), 0});
            setup.bodies = {rolling_ball(2, radius, {})};
            const auto world = run(setup, second);
            const Number faster = g * (std::sin(slope) - resistance / radius * std::cos(slope)) / 1.4L;
            EXPECT_LE(norm(world->motion(0).x - Vector{faster > 0 ? side * faster / 2 : 0, radius, 0}), allowed());
            EXPECT_EQ(world->asleep(0), part < 1);
        }
    }
}

TEST_P(Rolling, a_spin_about_the_normal_ends_by_its_own_resistance) {
    const Number radius = 0.125L, mass = 3, spin = 10;
    for (const Number resistance : {0.001L, 0.003L}) {
        for (const Number side : {1.0L, -1.0L}) {
            SceneSetup setup = rolling_floor(0.01L, resistance);
            setup.bodies = {placed(sphere(real(mass), real(radius)), {0, radius, 0}, {}, {0, side * spin, 0})};
            const auto world = build(setup, GetParam());
            const Number slower = resistance * g / (0.4L * radius * radius);
            const int half = static_cast<int>(spin / slower * second / 2);
            world->run(half);
            EXPECT_LE(norm(world->motion(0).w - Vector{0, side * (spin - slower * half / second), 0}), 10 * allowed());
            world->run(half + second);
            EXPECT_TRUE(world->asleep(0));
            EXPECT_LE(norm(world->motion(0).x - Vector{0, radius, 0}), allowed());
        }
    }
}

// Of two sides the larger resistance counts. A body or plane without one has that of the world.
TEST_P(Rolling, on_a_box_the_larger_resistance_of_two_bodies_counts) {
    const Number radius = 0.125L;
    for (const bool reversed : {false, true}) {
        SceneSetup setup = rolling_floor(0);
        BodySpec ball = rolling_ball(0.5L, radius, {1, 0, 0}, 1), table = placed(box(20, {6, 1, 2}), {2, 0.5L, 0});
        (reversed ? table : ball).rolling_resistance = 0.003;
        (reversed ? ball : table).rolling_resistance = 0.001;
        setup.bodies = {ball, table};
        if (reversed) std::swap(setup.bodies[0], setup.bodies[1]);
        const auto world = run(setup, second);
        const Number slower = slowing(0.003L, radius, 0.4L * radius * radius);
        EXPECT_LE(norm(world->motion(reversed ? 1 : 0).v - Vector{1 - slower, 0, 0}), allowed());
        EXPECT_LE(norm(world->motion(reversed ? 0 : 1).v), allowed());
    }
}

// Two balls that meet along x exchange spin about it: at most s times the impulse, and at most as much as makes the
// spins equal. Their axes of rotation need not be along x: across it, rolling resists.
TEST_P(Rolling, two_balls_that_meet_exchange_their_spins) {
    const Number inertia = 0.4L * 0.125L * 0.125L;
    for (const Number mass : {1.0L, 20.0L}) {
        for (const Number resistance : {0.001L, 0.004L, 1.0L}) {
            for (const Number restitution : {0.0L, 0.5L}) {
                SceneSetup setup = space(restitution, 0.5L);
                setup.world.contact.rolling_resistance = setup.world.contact.spinning_resistance = real(resistance);
                setup.bodies = {placed(sphere(1, 0.125), {-0.25L, 0, 0}, {2, 0, 0}, {9, 0, 0}),
                                placed(sphere(real(mass), 0.125), {0.25L, 0, 0}, {-2, 0, 0}, {-3, 0, 0})};
                const auto world = run(setup, second / 4);
                const Number impulse = (1 + restitution) * 4 / (1 + 1 / mass), equal = 12 * inertia / (1 + 1 / mass),
                             exchanged = std::min(resistance * impulse, equal) / inertia;
                EXPECT_LE(std::abs(world->motion(0).w.x - (9 - exchanged)), 1e-4L);
                EXPECT_LE(std::abs(world->motion(1).w.x - (exchanged / mass - 3)), 1e-4L);

                setup.bodies[0].angular_velocity = {0, 3, 1};
                setup.bodies[1].angular_velocity = {0, -2, 4};
                const Sums before = sums_of(*build(setup, GetParam()), setup.bodies),
                           after = sums_of(*run(setup, second / 4), setup.bodies);
                EXPECT_LE(norm(after.linear - before.linear), 1e-4L);
                EXPECT_LE(norm(after.angular - before.angular), 1e-4L);
            }
        }
    }
}

// It keeps the spin of the table, which it takes on within 0.13 s.
TEST_P(Rolling, a_ball_on_a_turntable_takes_on_its_spin) {
    for (const Number start : {0.0L, 2.0L, 5.0L}) {
        SceneSetup setup = rolling_floor(0, 0.01L);
        setup.planes.clear();
        BodySpec table = placed(box(10, {4, 0.5, 4}), {0, -0.25L, 0}, {}, {0, 2, 0});
        table.fixed = true;
        setup.bodies = {placed(sphere(1, 0.125), {0, 0.125L, 0}, {}, {0, start, 0}), table};
        EXPECT_LE(norm(run(setup, second / 2)->motion(0).w - Vector{0, 2, 0}), 1e-4L) << start;
    }
}

// Statics hold the tower, and the ball's contact is solved by itself.
TEST_P(Rolling, a_heavy_ball_rolls_on_a_tower_that_stands) {
    for (const Number mass : {1.0L, 100.0L}) {
        for (const Number resistance : {0.0L, 0.002L}) {
            SceneSetup setup = rolling_floor(resistance);
            setup.step = Seconds{1, 64};
            for (int i = 0; i < 6; ++i) setup.bodies.push_back(placed(box(1, {1, 0.5, 1}), {0, 0.25L + 0.5L * i, 0}));
            setup.bodies.push_back(rolling_ball(mass, 0.125L, {0.5L, 0, 0}, 3));
            setup.bodies.back().position.x = -0.25;
            const auto world = run(setup, 64);
            for (int b = 0; b < 6; ++b)
                EXPECT_LE(norm(world->motion(b).x - vector(setup.bodies[static_cast<std::size_t>(b)].position)), 1e-6L);
            const Number slower = slowing(resistance, 0.125L, 0.4L * 0.125L * 0.125L);
            EXPECT_LE(norm(world->motion(6).v - Vector{0.5L - slower, 0, 0}), allowed());
            EXPECT_TRUE(world->status().ok());
        }
    }
}

TEST_P(Rolling, values_mix_as_the_world_says) {
    const struct {
        Mixing mixing;
        Number of_04_and_09;
    } mixings[] = {{Mixing::larger, 0.9L},
                   {Mixing::smaller, 0.4L},
                   {Mixing::mean, 0.65L},
                   {Mixing::geometric_mean, 0.6L},
                   {Mixing::product, 0.36L}};
    for (const auto& [mixing, expected] : mixings) {
        SceneSetup bounce = space(0.9L, 0, {placed(sphere(1, 0.125), {0, 0.25L, 0}, {0, -2, 0})});
        bounce.planes = {{.restitution = 0.4}};
        bounce.bodies[0].restitution = mixing == Mixing::larger ? 0.9 : -1;  // the world's
        bounce.world.contact.restitution_mixing = mixing;
        EXPECT_LE(norm(run(bounce, second / 4)->motion(0).v - Vector{0, 2 * expected, 0}), 1e-5L);

        SceneSetup slide = floor(0, 0.9L, {placed(box(2, {1, 0.25, 1}), {0, 0.125L, 0}, {4, 0, 0})});
        slide.planes = {{.friction = 0.4}};
        slide.world.contact.friction_mixing = mixing;
        EXPECT_LE(norm(run(slide, second / 4)->motion(0).v - Vector{4 - expected * g / 4, 0, 0}), 1e-4L);
    }
}

}  // namespace
}  // namespace tumble::test
