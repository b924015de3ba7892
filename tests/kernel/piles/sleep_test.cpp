// Sleep: what falls asleep and when, and what wakes whom.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

using Sleep = ImpactCases;
INSTANTIATE_TEST_SUITE_P(every, Sleep, testing::ValuesIn(contact_cases()), NameOf{});

BodySpec cube(Number x, Number height) { return placed(box(2, {1, 1, 1}), {x, height, 0}); }

// A box of 2 kg that has lain still for a second.
BodySpec sleeper() { return standing(box(2, {1, 0.5, 1}), 0, 0.25L); }
void expect_falls_asleep(AnyWorld& world, int body = 0) {
    world.run(second);
    ASSERT_TRUE(world.asleep(body));
    const std::uint64_t hash = world.hash();
    world.run(second / 2);
    ASSERT_EQ(world.hash(), hash);
}

TEST_P(Sleep, a_sleeper_that_is_pushed_slides_as_far_as_one_that_never_slept) {
    Number distance[2]{};
    for (const bool sleep : {false, true}) {
        SceneSetup setup = sleep ? sleepy_floor() : floor(0, 0.5L);
        setup.bodies = {sleeper()};
        const auto world = run(setup, 2 * second);
        EXPECT_EQ(world->asleep(0), sleep);
        const Vector start = world->motion(0).x;
        world->apply_impulse(0, {4, 0, 0});
        world->run(second);
        distance[sleep ? 1 : 0] = world->motion(0).x.x - start.x;
        EXPECT_LE(std::abs(distance[sleep ? 1 : 0] / (4 / g) - 1), tolerance::sliding);  // v^2 / (2 mu g)
    }
    EXPECT_LE(std::abs(distance[1] - distance[0]), tolerance::creep);
}

TEST_P(Sleep, a_timed_force_wakes_a_sleeper_when_it_begins) {
    SceneSetup setup = sleepy_floor(0.5L, {sleeper()});
    setup.forces = {{.body = 0, .from = 2.0, .until = 3.0, .force = {30, 0, 0}}};
    const auto world = build(setup, GetParam());
    expect_falls_asleep(*world);
    world->run(second / 2);
    EXPECT_TRUE(world->asleep(0));  // up to the moment that the force begins
    const Vector start = world->motion(0).x;
    world->run(second);
    EXPECT_FALSE(world->asleep(0));
    // (F - mu m g) / m, for a second.
    const Number distance = (30 - 0.5L * 2 * g) / 2 / 2;
    EXPECT_LE(std::abs((world->motion(0).x.x - start.x) / distance - 1), tolerance::sliding);
    world->run(4 * second);
    EXPECT_TRUE(world->asleep(0));
}

TEST_P(Sleep, a_force_that_begins_wakes_a_sleeper_and_stops_at_the_floor) {
    SceneSetup setup = sleepy_floor(0.5L, {sleeper()});
    const auto world = build(setup, GetParam());
    expect_falls_asleep(*world);
    const Vector start = world->motion(0).x;
    world->apply({.kind = EventKind::begin_force, .value = {0, 0, -30}});
    world->run(second);
    const Number distance = (30 - 0.5L * 2 * g) / 2 / 2;
    EXPECT_LE(std::abs((start.z - world->motion(0).x.z) / distance - 1), tolerance::sliding);

    setup.world.gravity = {};
    setup.bodies = {standing(sphere(2, 0.25), 0, 0.75L)};
    const auto floating = run(setup, 3);
    floating->apply({.kind = EventKind::begin_force, .value = {0, -100, 0}});
    floating->run(second);
    EXPECT_LE(0.25L - floating->motion(0).x.y, tolerance::depth);
}

TEST_P(Sleep, contacts_and_sleep_continue_when_a_step_counter_wraps) {
    // A sleeper that a force pushes for a while, a ball that bounces, one on a spring, and one that rolls to the
    // sleeper.
    const auto scene = [&](std::uint64_t start) {
        const auto at = [&](int step) { return real((static_cast<Number>(start) + step) / second); };
        SceneSetup setup = sleepy_floor();
        setup.start = static_cast<std::uint32_t>(start);
        setup.bodies = {sleeper(), standing(sphere(1, 0.25), 4, 1), standing(sphere(0.5, 0.125), 8, 0.25L),
                        standing(sphere(2, 0.25), -8, 0.25L, {4, 0, 0})};
        setup.bodies[1].restitution = 1;
        setup.bodies[3].friction = 0;
        setup.springs = {{.body = 2, .to = {8.0, 1.0, 0.0}, .stiffness = 40, .damping = 0.5, .rest_length = 0.5}};
        setup.forces = {{.body = 0, .from = 0, .until = real(64.0L / second), .force = {0, 50, 0}},
                        {.body = 0, .from = at(700), .until = at(800), .force = {0, 0, 30}}};
        return setup;
    };
    SceneSetup plain = scene(0);
    plain.forces.erase(plain.forces.begin());
    constexpr int steps = 1100;
    for (const std::uint64_t turn : {std::uint64_t{1} << 16, std::uint64_t{1} << 31, std::uint64_t{1} << 32}) {
        for (const int before : {100, 640}) {
            const std::uint64_t start = turn - static_cast<std::uint64_t>(before);
            const auto early = build(plain, GetParam()), late = build(scene(start), GetParam());
            bool slept = false, woke = false;
            for (int step = 0; step < steps; ++step) {
                early->step();
                late->step();
                slept = slept || late->asleep(0);
                woke = woke || (slept && !late->asleep(0));
                if (system().fixed_point) {  // rounding is dithered by the number of the step
                    for (int body = 0; body < 4; ++body)
                        ASSERT_LE(norm(late->motion(body).x - early->motion(body).x), tolerance::place)
                            << turn << " - " << before << " + " << step << ": body " << body;
                } else {
                    ASSERT_EQ(late->hash(), early->hash()) << turn << " - " << before << " + " << step;
                }
            }
            EXPECT_TRUE(slept && woke);
        }
    }
}

TEST_P(Sleep, a_sleeper_wakes_when_the_force_that_held_it_ends) {
    SceneSetup setup = sleepy_floor();
    setup.planes[0] = {.normal = {0, -1, 0}, .offset = 3};  // a ceiling
    setup.bodies = {standing(box(2, {1, 0.5, 1}), 0, 2.75L)};
    setup.forces = {{.body = 0, .from = 0.0, .until = 2.0, .force = {0, 40, 0}}};
    const auto world = build(setup, GetParam());
    expect_falls_asleep(*world);
    world->run(second / 2);
    EXPECT_LE(std::abs(world->motion(0).x.y - 2.75L), tolerance::creep);
    world->run(second);
    EXPECT_FALSE(world->asleep(0));
    EXPECT_LE(std::abs((2.75L - world->motion(0).x.y) / (g / 2) - 1), tolerance::sliding);
}

TEST_P(Sleep, a_force_that_does_not_move_a_sleeper_moves_nothing) {
    SceneSetup setup = sleepy_floor(0.5L, {sleeper()});
    setup.forces = {{.body = 0, .from = 2.0, .until = 4.0, .force = {5, 0, 0}}};  // friction holds 9.8 N
    const auto world = run(setup, 5 * second);
    EXPECT_LE(farthest_from_start(*world, setup), tolerance::creep);
    EXPECT_TRUE(world->asleep(0));
}

TEST_P(Sleep, a_touching_body_wakes_a_sleeper_and_a_passing_one_does_not) {
    for (const bool touches : {true, false}) {
        SceneSetup setup = sleepy_floor();
        // 7.25 m to go: it is there at 1.8125 s.
        setup.bodies = {sleeper(), placed(sphere(2, 0.25), {-8, 0.25L, touches ? 0.0L : 1.0L}, {4, 0, 0})};
        setup.bodies[1].friction = 0;
        const auto world = run(setup, second);
        EXPECT_TRUE(world->asleep(0));
        const Motion before = world->motion(0);
        world->run(second / 2 + second / 4);
        EXPECT_TRUE(world->asleep(0));
        EXPECT_FALSE(world->asleep(1));
        EXPECT_EQ(norm(world->motion(0).x - before.x), 0);
        world->run(second / 8);
        EXPECT_EQ(world->asleep(0), !touches);
        world->run(second);
        const Number moved = norm(world->motion(0).x - before.x);
        if (touches) {
            // The sphere's 8 N s; both then go at most at 2 m/s together.
            EXPECT_GT(moved, 0.1L);
            EXPECT_LE(std::abs(world->motion(1).v.x) - 2, tolerance::rest_speed);
        } else {
            EXPECT_EQ(moved, 0);
            EXPECT_LE(std::abs(world->motion(1).v.x - 4), tolerance::creep);
        }
    }
}

TEST_P(Sleep, a_body_that_loses_its_support_falls) {
    const auto world = build(sleepy_floor(0, {sleeper(), standing(box(1, {0.5, 0.5, 0.5}), 0, 0.75L)}), GetParam());
    expect_falls_asleep(*world, 1);
    world->apply_impulse(0, {16, 0, 0});  // 8 m/s: away after 0.1 s, and without friction
    world->run(second);
    EXPECT_LE(std::abs(world->motion(0).v.x - 8), 0.5L);
    EXPECT_LT(world->motion(1).x.y, 0.5L);
    EXPECT_GT(world->motion(1).x.y, 0.2L);
}

TEST_P(Sleep, a_body_slightly_faster_than_the_limit_never_sleeps) {
    SceneSetup setup = sleepy_floor(0);
    setup.bodies = {standing(sphere(1, 0.25), 0, 0.25L, {0.0625, 0, 0}),       // slides
                    standing(sphere(1, 0.25), 2, 0.25L, {}, {0, 0.0625, 0})};  // spins where it stands
    const auto world = run(setup, 4 * second);
    EXPECT_FALSE(world->asleep(0));
    EXPECT_FALSE(world->asleep(1));
    EXPECT_LE(std::abs(world->motion(0).x.x - 0.25L), tolerance::creep);
    EXPECT_LE(norm(world->motion(1).w - Vector{0, 0.0625L, 0}), tolerance::creep);
}

TEST_P(Sleep, nothing_sleeps_in_the_air) {
    SceneSetup setup = sleepy_floor();
    setup.world.gravity = {0, -0.0078125, 0};
    // Slower than the limit for 5.8 s, and at its height after 2 s.
    setup.bodies = {standing(sphere(1, 0.25), 0, 2, {0, 0.015625, 0})};
    const auto world = run(setup, 4 * second);
    EXPECT_FALSE(world->asleep(0));
    EXPECT_LE(std::abs(world->motion(0).x.y - 2), tolerance::creep);
    EXPECT_LE(std::abs(world->motion(0).v.y + 0.015625L), tolerance::creep);
}

// Cubes on each other, in any order in the world.
TEST_P(Sleep, a_pushed_body_wakes_all_bodies_below_it) {
    for (const bool reversed : {false, true}) {
        for (int pushed = 0; pushed < 3; ++pushed) {
            SceneSetup setup = sleepy_floor(0.5L);
            for (int i = 0; i < 3; ++i) setup.bodies.push_back(cube(0, (reversed ? 2 - i : i) + 0.5L));
            setup.bodies.push_back(cube(3, 0.5L));
            const auto world = run(setup, second);
            for (int b = 0; b < 4; ++b) ASSERT_TRUE(world->asleep(b)) << b;
            world->apply_impulse(pushed, {0.5L, 0, 0});
            for (int b = 0; b < 3; ++b) EXPECT_FALSE(world->asleep(b)) << b << " when " << pushed << " is pushed";
            EXPECT_TRUE(world->asleep(3));
        }
    }
}

TEST_P(Sleep, a_spring_wakes_the_body_at_its_other_end) {
    for (const int pushed : {0, 1}) {
        for (const bool reversed : {false, true}) {
            SceneSetup setup = sleepy_floor(0.5L, {cube(0, 0.5L), cube(4, 0.5L), cube(8, 0.5L)});
            SpringSpec spring{.body = reversed ? 1 : 0, .stiffness = 4};
            spring.to_body = 1 - spring.body;
            spring.rest_length = 4;
            setup.springs = {spring};
            const auto world = run(setup, second);
            for (int b = 0; b < 3; ++b) ASSERT_TRUE(world->asleep(b)) << b;
            world->apply_impulse(pushed, {0.125L, 0, 0});
            EXPECT_FALSE(world->asleep(0)) << pushed;
            EXPECT_FALSE(world->asleep(1)) << pushed;
            EXPECT_TRUE(world->asleep(2));
        }
    }
}

// A body hovers ahead of a sleeping one and has been clear of contact for half a second. An impulse from behind the
// sleeping body arrives sooner. Three elastic balls of one mass in a row: the last takes all momentum. Forces hold the
// first two on a smooth floor, and the last, which is smaller, does not touch it.
TEST_P(Sleep, a_body_woken_with_its_neighbour_hits_a_body_that_was_clear_of_contact) {
    for (const Vector n : normals) {
        for (const bool reversed : {false, true}) {
            SceneSetup setup =
                space(1, 0, {sphere(1, 0.25), placed(sphere(1, 0.25), n * 0.5L), placed(sphere(1, 0.2), n * 1.7L)});
            const Vector up = std::abs(n.x) < 0.9L ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0});
            setup.planes = {{.normal = real(up), .offset = 0.25}};
            for (int b = 0; b < 2; ++b)
                setup.forces.push_back({.body = b, .from = 0, .until = 100, .force = real(up * -8)});
            setup.world.contact.sleep.on = true;
            if (reversed) std::swap(setup.bodies[0], setup.bodies[1]);
            const int pushed = reversed ? 1 : 0;
            const auto world = run(setup, second + 4);
            ASSERT_TRUE(world->asleep(0) && world->asleep(1));
            world->apply_impulse(pushed, n * 8);
            EXPECT_FALSE(world->asleep(0) || world->asleep(1));
            world->run(second / 2);  // 4 m of flight, of which 0.75 m to the last
            EXPECT_LE(norm(world->motion(2).v - n * 8), 64 * rounding());
            EXPECT_LE(norm(world->motion(0).v) + norm(world->motion(1).v), 64 * rounding());
        }
    }
}

// Slower than the speed limit of sleep, and without friction, it goes on for the whole sleep time.
TEST_P(Sleep, a_woken_body_stays_awake_for_the_whole_sleep_time) {
    const auto world = run(sleepy_floor(0, {cube(0, 0.5L)}), second);
    ASSERT_TRUE(world->asleep(0));
    const Vector start = world->motion(0).x;
    world->apply_impulse(0, {0.03125L, 0, 0});  // 1/64 m/s
    world->run(second / 2 - 1);
    EXPECT_FALSE(world->asleep(0));
    EXPECT_LE(std::abs(world->motion(0).x.x - start.x - 127 / (64 * 256.0L)), tolerance::still);
    world->run(4);
    EXPECT_TRUE(world->asleep(0));
}

TEST_P(Sleep, sleep_begins_with_the_step_that_completes_its_time_and_stops_all_motion) {
    for (const int steps : {16, 128, 300}) {
        SceneSetup setup = sleepy_floor(0);
        setup.world.contact.sleep.time = real(steps / 256.0L);
        setup.bodies = {placed(sphere(1, 0.25), {0, 0.25L, 0}, {0.015625L, 0, 0}, {0, 0.03125, 0})};
        const auto world = run(setup, steps - 1);
        EXPECT_FALSE(world->asleep(0)) << steps;
        EXPECT_GT(norm(world->motion(0).v), 0);
        world->step();
        EXPECT_TRUE(world->asleep(0)) << steps;
        EXPECT_EQ(norm(world->motion(0).v) + norm(world->motion(0).w), 0) << steps;
    }
}

// A force holds the body 0.05 mm above the gap of a contact, for longer than the sleep time. Then it sinks.
TEST_P(Sleep, the_sleep_time_counts_from_the_contact) {
    for (const Number mass : {1.0L, 4.0L}) {
        SceneSetup setup = sleepy_floor(0.25L);
        setup.bodies = {placed(sphere(real(mass), 0.25), {0, 0.25L + tolerance::contact_band + 5e-5L, 0})};
        const Number weight = mass * g;
        setup.forces = {{.body = 0, .from = 0.0, .until = 1.0, .force = {0, real(weight), 0}},
                        {.body = 0, .from = 1.0, .until = 9.0, .force = {0, real(0.99L * weight), 0}}};
        const auto world = run(setup, second);
        ASSERT_FALSE(world->asleep(0));
        int steps = 0;
        for (; steps < second && !world->asleep(0); ++steps) world->step();
        EXPECT_GE(steps, second / 2) << mass;
        EXPECT_LE(steps, second / 2 + 16) << mass;  // 8 of them until it touches
    }
}

TEST_P(Sleep, new_gravity_wakes_sleepers) {
    const auto world = run(sleepy_floor(0.25L, {cube(0, 0.5L), cube(4, 0.5L)}), second);
    ASSERT_TRUE(world->asleep(0));
    world->set_gravity({4.90625L, -9.8125L, 0});
    EXPECT_FALSE(world->asleep(0));
    EXPECT_FALSE(world->asleep(1));
    const Vector start = world->motion(0).x;
    world->run(second);
    EXPECT_LE(std::abs((world->motion(0).x.x - start.x) / (g / 8) - 1), 2 * tolerance::sliding);  // (g/2 - g/4) / 2
}

TEST_P(Sleep, a_plane_added_during_a_run_wakes_sleepers) {
    const auto world = run(sleepy_floor(0.5L, {cube(0, 0.5L)}), second);
    ASSERT_TRUE(world->asleep(0));
    ASSERT_TRUE(world->add(PlaneSpec{.normal = {1, 0, 0}, .offset = 4}));
    EXPECT_FALSE(world->asleep(0));
    world->run(second);
    EXPECT_TRUE(world->asleep(0));
}

// The body moves with the table, more slowly than the speed limit of sleep.
TEST_P(Sleep, nothing_sleeps_on_a_turntable) {
    for (const Number turns : {0.015625L, -0.015625L}) {
        SceneSetup setup = sleepy_floor(1);
        setup.planes.clear();
        setup.bodies = {fixed(placed(box(100, {8, 0.5, 8}), {0, -0.25L, 0}, {}, {0, turns, 0})),
                        placed(box(1, {0.5, 0.25, 0.5}), {1, 0.125L, 0}, {0, 0, -turns}, {0, turns, 0})};
        const auto world = run(setup, 4 * second);
        EXPECT_FALSE(world->asleep(1));
        EXPECT_LE(norm(world->motion(1).x - Vector{std::cos(4 * turns), 0.125L, -std::sin(4 * turns)}),
                  4 * tolerance::still + tolerance::creep)
            << turns;
    }
}

// In fixed point a step of 2^-16 s is one of the shortest in which a ball feels gravity.
TEST(SleepTime, begins_after_its_time_for_any_number_of_steps) {
    for (const char* system : {"q32_near", "f64"}) {
        for (const int steps : {70000, 140000}) {
            SceneSetup setup = sleepy_floor();
            setup.step = Seconds{1, 65536};
            setup.world.contact.sleep.time = Real{steps} / Real{65536};
            setup.bodies = {standing(sphere(1, 0.25), 0, 0.25L)};
            const auto world = build(setup, "verlet", system);
            world->run(steps - 1);
            EXPECT_FALSE(world->asleep(0)) << system;
            world->run(16);
            EXPECT_TRUE(world->asleep(0)) << system << ", " << steps << " steps";
        }
    }
}

}  // namespace
}  // namespace tumble::test
