// Kinematic bodies: they move as their velocities say, whatever they meet, and carry, drag and strike what they touch.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

class Kinematic : public CaseTest {
protected:
    // m and m/s after a second: what sweeps and rounding leave.
    static Number allowed() { return system().bits == 64 ? 1e-7L : 1e-4L; }

    static BodySpec kinematic(BodySpec body, Vector position, Vector velocity, Vector spin = {}) {
        BodySpec moving = placed(body, position, velocity, spin);
        moving.kinematic = true;
        return moving;
    }
    // Its upper side is at y = 0.
    static BodySpec platform(Vector velocity) { return kinematic(box(1, {4, 0.5, 4}), {0, -0.25L, 0}, velocity); }
    static SceneSetup under_gravity(Number friction) {
        SceneSetup setup = sleepy_floor(friction);
        setup.planes.clear();
        return setup;
    }
};
INSTANTIATE_TEST_SUITE_P(every, Kinematic, testing::ValuesIn(contact_cases()), NameOf{});

TEST_P(Kinematic, a_body_keeps_its_velocity_whatever_pushes_it) {
    SceneSetup setup = floor(0.5L, 0.5L);
    setup.planes = {
        {.normal = {1, 0, 0}, .offset = 2}};  // it passes through planes and other bodies that nothing pushes
    setup.bodies = {kinematic(box(2, {1, 2, 1}), {0, 3, 0}, {-3, 0.5L, 0}, {0, 4, 0}),
                    kinematic(sphere(1, 0.5), {-2, 3, 0}, {1, 0, 0}), placed(sphere(50, 0.5), {-1.5L, 4, 1}, {})};
    setup.impulses = {{.time = 0.5, .body = 0, .impulse = {0, 5, 0}, .point = {0.5, 0, 0}}};
    setup.forces = {{.body = 1, .from = 0, .until = 1, .force = {0, 0, 9}}};
    const auto world = run(setup, second);
    EXPECT_LE(norm(world->motion(0).x - Vector{-3, 3.5L, 0}), allowed() / 10);
    EXPECT_LE(norm(world->motion(1).x - Vector{-1, 3, 0}), allowed() / 10);
    EXPECT_LE(norm(world->motion(0).v - Vector{-3, 0.5L, 0}), allowed() / 10);
    EXPECT_LE(angle_between(world->motion(0).q, exponential(Vector{0, 4, 0})), allowed());
    EXPECT_EQ(world->contact_count(0), 0);
}

class KinematicTurns : public Kinematic {};
INSTANTIATE_TEST_SUITE_P(every, KinematicTurns, testing::ValuesIn(cases_where([](const Case& c) {
                             const std::string_view system = c.system.name;
                             return system == "f64" || system == "q32_near";
                         })),
                         NameOf{});

// Whatever its moments, and though a kinematic body is also placed within its step.
TEST_P(KinematicTurns, a_body_turns_steadily_about_the_axis_that_it_was_given) {
    for (const Vector& spin : {Vector{3, 2, 1}, {-0.5L, 1, 0.3L}, {1e-5L, -2e-5L, 3e-5L}, {0, 2, 1e-9L}}) {
        for (const bool is_kinematic : {false, true}) {
            SceneSetup setup = space(0.5L);
            const Vector velocity = is_kinematic ? Vector{0.5L, 0.25L, -1} : Vector{};
            setup.bodies = {placed(box(1, {1, 0.5, 0.25}), {}, velocity, spin)};
            setup.bodies[0].kinematic = is_kinematic;
            setup.bodies[0].fixed = !is_kinematic;
            setup.bodies.push_back(placed(sphere(1, 0.25), {0.5L, 0.125L, -0.875L}));  // which it meets
            setup.bodies.push_back(placed(sphere(1, 0.25), {0, 4, 0}));
            setup.springs = {{.body = 2, .to_body = 0, .stiffness = 4}};
            const auto world = run(setup, 4 * second);
            const Motion end = world->motion(0);
            // Methods of low order turn by twice the tangent of half the angle, or split the turn.
            const Number in_step = norm(spin) / second, of_method = 4 * norm(spin) * in_step * in_step;
            EXPECT_LE(norm(end.x - velocity * 4), allowed());
            EXPECT_LE(angle_between(end.q, exponential(spin * 4)), of_method + allowed());
            EXPECT_LE(norm(end.w - spin), allowed());
        }
    }
}

TEST_P(Kinematic, a_lift_carries_a_stack) {
    for (const Vector way : {Vector{0, 1, 0}, Vector{0, -1.5L, 0}, Vector{-2, 0, 1}, Vector{1, 0.5L, -0.75L}}) {
        for (const int count : {1, 2, 6}) {
            for (const bool is_last : {false, true}) {
                for (const Seconds step : {Seconds{1, 256}, Seconds{1, 60}}) {
                    SceneSetup setup = under_gravity(0.5L);
                    setup.step = step;
                    for (int i = 0; i < count; ++i)
                        setup.bodies.push_back(
                            placed(box(1 + i % 2, {0.5, 0.25, 0.5}), {0, 0.125L + 0.25L * i, 0}, way));
                    setup.bodies.insert(is_last ? setup.bodies.end() : setup.bodies.begin(), platform(way));
                    const int steps = static_cast<int>(number(Real{1} / step.value) + 0.5L);
                    const auto world = run(setup, steps);
                    const Vector moved = way * (number(step.value) * steps);
                    for (int b = 0; b < count; ++b) {
                        const Vector start{0, 0.125L + 0.25L * b, 0};
                        EXPECT_LE(norm(world->motion(is_last ? b : b + 1).x - start - moved), allowed() / 10);
                        EXPECT_FALSE(world->asleep(is_last ? b : b + 1));
                    }
                    EXPECT_TRUE(world->status().ok());
                }
            }
        }
    }
}

TEST_P(Kinematic, a_lift_that_sets_out_takes_a_box_along) {
    for (const Number speed : {0.5L, 2.0L}) {
        SceneSetup setup = under_gravity(0.5L);
        setup.bodies = {placed(box(2, {0.5, 0.5, 0.5}), {0, 0.25L, 0}), platform({0, speed, 0})};
        const auto world = run(setup, second);
        EXPECT_LE(norm(world->motion(0).x - Vector{0, 0.25L + speed, 0}), allowed());
        EXPECT_LE(norm(world->motion(0).v - Vector{0, speed, 0}), allowed());
        EXPECT_TRUE(world->status().ok());
    }
}

// By mu g, until it has its speed. Then it stays on it.
TEST_P(Kinematic, a_platform_drags_what_lies_on_it_up_to_its_speed) {
    for (const Number friction : {0.25L, 0.5L}) {
        for (const Vector way : {Vector{1, 0, 0}, Vector{-0.6L, 0, 0.8L}}) {
            for (const bool is_stack : {false, true}) {
                SceneSetup setup = under_gravity(friction);
                setup.bodies = {platform(way), placed(box(2, {0.5, 0.125, 0.5}), {0, 0.0625L, 0})};
                if (is_stack) setup.bodies.push_back(placed(box(1, {0.5, 0.125, 0.5}), {0, 0.1875L, 0}));
                const auto world = build(setup, GetParam());
                const int half = static_cast<int>(second / (friction * g) / 2);
                world->run(half);
                EXPECT_LE(norm(world->motion(1).v - way * (friction * g * half / second)), allowed());
                world->run(second - half);
                const Vector end = way * (1 - 1 / (2 * friction * g));
                EXPECT_LE(norm(world->motion(1).x - end - Vector{0, 0.0625L, 0}), 1e-4L);
                EXPECT_LE(norm(world->motion(1).v - way), allowed());
            }
        }
    }
}

TEST_P(Kinematic, a_ball_comes_to_roll_on_a_platform_at_two_sevenths_of_its_speed) {
    SceneSetup setup = under_gravity(0.5L);
    setup.bodies = {placed(sphere(3, 0.25), {0, 0.25L, 0}), platform({1, 0, 0})};
    const auto world = run(setup, second);
    EXPECT_LE(norm(world->motion(0).v - Vector{2.0L / 7, 0, 0}), allowed());
    EXPECT_LE(norm(world->motion(0).w - Vector{0, 0, 5.0L / 7 / 0.25L}), 10 * allowed());
}

// Seen from the wall, Newton's law holds. Nothing touches it when the body starts.
TEST_P(Kinematic, a_wall_strikes_by_its_own_speed) {
    for (const Number wall : {1.0L, -0.5L}) {
        for (const Number speed : {0.0L, -2.0L, -0.75L}) {
            for (const Number restitution : {0.0L, 0.5L, 1.0L}) {
                for (const bool is_box : {false, true}) {
                    if (!(speed < wall)) continue;
                    SceneSetup setup = space(restitution);
                    const Vector off{0.375L, 0.25L + 0.3125L, 0.25L};
                    setup.bodies = {placed(is_box ? box(2, {0.5, 0.5, 0.5}) : sphere(2, 0.25), off, {0, speed, 0}),
                                    platform({0, wall, 0})};
                    const auto world = run(setup, 2 * second);
                    const Number when = 0.3125L / (wall - speed), after = wall + restitution * (wall - speed);
                    EXPECT_LE(norm(world->motion(0).v - Vector{0, after, 0}), allowed());
                    EXPECT_LE(norm(world->motion(0).x - off - Vector{0, speed * when + after * (2 - when), 0}),
                              2 * allowed());
                    EXPECT_TRUE(world->status().ok());
                }
            }
        }
    }
}

// It meets the ball where the ball's distance from the middle of the paddle is the sum of its radius and half the
// thickness.
TEST_P(Kinematic, a_paddle_that_turns_strikes_by_the_speed_of_its_surface) {
    for (const Number restitution : {0.5L, 1.0L}) {
        for (const Number rate : {2.0L, -3.0L}) {
            const Number side = rate > 0 ? 1 : -1;
            SceneSetup setup = space(restitution);
            setup.bodies = {kinematic(box(1, {4, 0.25, 1}), {}, {}, {0, 0, rate}),
                            placed(sphere(2, 0.25), {1.5L, side * 0.625L, 0})};
            const auto world = run(setup, second / 4);
            const Number distance = std::hypot(1.5L, 0.625L),
                         angle = std::atan2(0.625L, 1.5L) - std::asin(0.375L / distance),
                         arm = std::sqrt(distance * distance - 0.375L * 0.375L),
                         speed = (1 + restitution) * std::abs(rate) * arm;
            const Vector after = Vector{-std::sin(angle), side * std::cos(angle), 0} * speed;
            EXPECT_LE(norm(world->motion(1).v - after), speed * 1e-4L);
            EXPECT_LE(
                norm(world->motion(1).x - Vector{1.5L, side * 0.625L, 0} - after * (0.25L - angle / std::abs(rate))),
                1e-4L);
        }
    }
}

// The ball comes along the paddle, which throws it with twice the speed of its surface at this place.
TEST_P(Kinematic, a_ball_that_comes_along_a_paddle_is_struck_by_the_surface_where_it_meets_it) {
    for (const Number speed : {0.0L, 8.0L, -3.0L}) {
        SceneSetup setup = space(1);
        const Number rate = 5, angle = 0.25L, time = angle / rate;  // when they meet
        const Vector normal{-std::sin(angle), std::cos(angle), 0}, along{std::cos(angle), std::sin(angle), 0};
        const Vector met = along * 1.25L + normal * 0.375L, start = met - Vector{speed * time, 0, 0};
        setup.bodies = {placed(sphere(2, 0.25), start, {speed, 0, 0}),
                        kinematic(box(1, {4, 0.25, 1}), {}, {}, {0, 0, rate})};
        const auto world = run(setup, second / 8);
        const Vector before{speed, 0, 0}, after = before + normal * (2 * (rate * 1.25L - dot(before, normal)));
        EXPECT_LE(norm(world->motion(0).v - after), 0.01L * norm(after)) << speed;
    }
}

// A box that spins strikes it as it strikes a floor that stands, whatever the step.
TEST_P(Kinematic, a_rough_impact_does_not_depend_on_the_speed_of_the_floor) {
    for (const Vector way : {Vector{0.0009765625L, 0, 0}, Vector{2, 0, -1}, Vector{1, 0.5L, 0}}) {
        for (const Number spin : {2.0L, -10.0L}) {
            const auto struck = [&](Vector moved) {
                SceneSetup setup = space(0.5L, 0.9L);
                BodySpec slab = kinematic(box(1, {8, 0.5, 8}), {0, -0.25L, 0}, moved);
                setup.bodies = {
                    placed(box(2, {0.5, 0.25, 0.5}), {0, 0.75L, 0}, Vector{0.5L, -4, 0} + moved, {0, 0, spin}), slab};
                return run(setup, second / 4);
            };
            const auto still = struck({}), moving = struck(way);
            EXPECT_LE(norm(moving->motion(0).x - still->motion(0).x - way * 0.25L), allowed());
            EXPECT_LE(norm(moving->motion(0).v - still->motion(0).v - way), 10 * allowed());
            EXPECT_LE(norm(moving->motion(0).w - still->motion(0).w), 100 * allowed());
        }
    }
}

// They sleep when it arrives after 2 s, and again when it has pushed them off and left.
TEST_P(Kinematic, what_sleeps_wakes_when_something_comes) {
    for (const Number side : {1.0L, -1.0L}) {
        SceneSetup setup = sleepy_floor(0.5L);
        setup.bodies = {placed(box(2, {0.5, 0.5, 0.5}), {0, 0.25L, 0}), placed(box(2, {0.5, 0.5, 0.5}), {0, 0.75L, 0}),
                        kinematic(box(1, {1, 0.75, 4}), {side * -4.75L, 0.625L, 0}, {side * 2, 0, 0})};
        const auto world = run(setup, 2 * second - 16);
        EXPECT_TRUE(world->asleep(0) && world->asleep(1));
        world->run(second + 16);
        for (int b = 0; b < 2; ++b) {
            EXPECT_LE(norm(world->motion(b).x - Vector{side * 2, 0.25L + 0.5L * b, 0}), 1e-3L);
            EXPECT_LE(norm(world->motion(b).v - Vector{side * 2, 0, 0}), 1e-3L);
        }
        EXPECT_TRUE(world->status().ok());
    }
}

// Seen from its upper end, which has the speed V, the body swings about V t: it lags by V / w sin w t.
TEST_P(Kinematic, a_spring_follows_its_end_on_a_kinematic_body_to_second_order) {
    Number before = 0;
    for (const int steps : {64, 128, 256}) {
        SceneSetup setup = space(0);
        setup.step = Seconds{1, steps};
        setup.bodies = {placed(sphere(2, 0.125), {0, -1, 0}), kinematic(box(1, {0.25, 0.25, 0.25}), {}, {1, 0, 0})};
        setup.springs = {{.body = 0, .to_body = 1, .stiffness = 32, .rest_length = 0}};
        setup.springs[0].to = {0, -1, 0};
        const auto world = run(setup, steps);
        const Number error = norm(world->motion(0).x - Vector{1 - std::sin(4.0L) / 4, -1, 0});
        EXPECT_LE(error, 3.0L / (steps * steps)) << steps;
        if (before > 1e-5L) { EXPECT_LE(error, before / 3) << steps; }
        before = error;
    }
}

// The spring pulls by what friction holds after a second, when the box sleeps. Then the box slips, and swings about the
// speed of the other end.
TEST_P(Kinematic, a_sleeper_comes_along_when_the_other_end_of_its_spring_moves) {
    const Number speed = 0.1L, slack = 0.5L * g / 50;
    SceneSetup setup = sleepy_floor(0.5L);
    setup.bodies = {placed(box(1, {0.25, 0.25, 0.25}), {0, 0.125L, 0}),
                    kinematic(sphere(1, 0.0625), {1, 0.125L, 0}, {speed, 0, 0})};
    setup.springs = {{.body = 0, .to_body = 1, .stiffness = 50, .damping = 1, .rest_length = 1}};
    const auto world = run(setup, 3 * second);
    EXPECT_LE(norm(world->motion(0).x - Vector{3 * speed - slack, 0.125L, 0}), speed / std::sqrt(50.0L));
    EXPECT_FALSE(world->asleep(0));
}

// It has nowhere to go, so it is pressed into both bodies. The status says so, and it moves hardly faster than they do.
TEST_P(Kinematic, a_body_between_two_that_close_on_it_is_not_thrown) {
    for (const auto& [speed, rate] : {std::tuple{0.25L, 60}, {1.0L, 60}, {1.0L, 256}}) {
        for (const BodySpec& body : {box(1, {0.5, 0.5, 0.5}), box(30, {0.5, 0.5, 0.4}), sphere(2, 0.25)}) {
            const Vector along = rate == 60 ? Vector{0, 0, 1} : Vector{1, 0, 0};
            SceneSetup setup = floor(0, rate == 60 ? 3 : 0.5L);
            setup.step = Seconds{1, rate};
            setup.bodies = {kinematic(box(1, {1, 2, 1}), along * -0.8L + Vector{0, 1, 0}, along * speed),
                            kinematic(box(1, {1, 2, 1}), along * 0.8L + Vector{0, 1, 0}, along * -speed),
                            placed(body, along * 0.01L + Vector{0, 0.25L, 0})};
            const auto world = build(setup, GetParam());
            const int steps = static_cast<int>(0.2L * rate / speed);
            Number fastest = 0;
            for (int i = 0; i < steps; ++i) {
                world->step();
                fastest = std::max(fastest, norm(world->motion(2).v));
            }
            EXPECT_TRUE(world->status().has(Issue::step_bound_hit)) << speed << ", 1/" << rate;
            EXPECT_LE(fastest, 3 * speed) << speed << ", 1/" << rate;
        }
    }
}

}  // namespace
}  // namespace tumble::test
