// The bounds that a step may reach: rounds of impacts, bodies that are examined, ranges and barriers. What is beyond
// them is reported, and nothing else is.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

using StepBounds = ImpactCases;
INSTANTIATE_TEST_SUITE_P(every, StepBounds, testing::ValuesIn(contact_cases()), NameOf{});

// A heavy ball strikes a light one of 1 kg, which touches a plane.
SceneSetup squeeze(Number ratio, Vector normal, Number speed) {
    SceneSetup setup = space(1, 0,
                             {placed(sphere(real(ratio), 0.25), normal * (0.75L + 0.001953125L), normal * -speed),
                              placed(sphere(1, 0.25), normal * 0.25L)});
    setup.planes = {{.normal = real(normal)}};
    return setup;
}
// The light ball goes to and fro until it has turned the heavy one round, which takes pi sqrt(ratio) impacts.
TEST_P(StepBounds, a_ball_that_is_squeezed_for_too_many_rounds_is_reported_and_another_turns_the_heavy_one_round) {
    for (const Vector n : normals) {
        for (const Number ratio : {3.0L, 1e4L}) {
            const auto world = run(squeeze(ratio, n, 2), 1);
            EXPECT_EQ(world->status().has(Issue::step_bound_hit), ratio > 100);
            const Number energy = (ratio * norm(world->motion(0).v) * norm(world->motion(0).v) +
                                   norm(world->motion(1).v) * norm(world->motion(1).v)) /
                                  2;
            EXPECT_LE(energy, 2 * ratio * (1 + 1e-4L));
            if (ratio < 100) {
                EXPECT_GE(energy, 2 * ratio * (1 - 1e-4L));
                EXPECT_GT(dot(world->motion(0).v, n), 0);
            }
        }
    }
}

// Each body that the ball flies past is examined, because along the direction from that body at the start the ball has
// passed.
TEST_P(StepBounds, passing_more_bodies_in_a_step_than_are_examined_is_reported_and_passing_few_is_not) {
    for (const Vector along : {Vector{1, 0, 0}, {0, 0, -1}, {0.6L, 0, 0.8L}}) {
        for (const int passed : {3, 4, 5, 7}) {
            SceneSetup setup{.name = "past", .step = Seconds{1, 4}};
            setup.bodies = {placed(sphere(1, 0.125), along * -1, along * 30)};
            for (int i = 0; i < passed; ++i) {
                const Number side = i % 2 == 0 ? 0.5L : -0.5L;
                setup.bodies.push_back(fixed(placed(sphere(1, 0.125), along * (i * 0.75L) + Vector{0, side, 0})));
            }
            const auto world = run(setup, 1);
            EXPECT_EQ(world->status().has(Issue::step_bound_hit), passed > 4) << passed;
            if (passed <= 4) { EXPECT_LE(norm(world->motion(0).v - along * 30), rounding()) << passed; }
        }
    }
}

// Boxes that fall by a few centimetres onto each other, off the centre.
SceneSetup falling_boxes(int count, Number restitution, Number mass) {
    SceneSetup setup{.name = "pile"};
    setup.world = {.gravity = {0, -9.81, 0}, .contact = {.restitution = real(restitution), .friction = 0.5}};
    setup.planes = {{}};
    for (int i = 0; i < count; ++i) {
        const Number x = i % 2 == 0 ? 0.02L : -0.02L;
        setup.bodies.push_back(placed(box(real(mass), {0.5, 0.4, 0.5}), {x, 0.25L + 0.45L * i, 0.01L * i}));
    }
    return setup;
}
// A box that falls in a random pose onto another that lies there.
SceneSetup box_onto_a_box(Number mass) {
    SceneSetup setup{.name = "pile"};
    setup.world = {.gravity = {0, -9.81, 0}, .contact = {.restitution = 0.3, .friction = 0.3}};
    setup.planes = {{}};
    setup.bodies = {placed(box(real(mass), {0.4, 0.3, 0.5}), {0, 0.15L, 0}),
                    placed(box(real(mass), {0.4, 0.3, 0.5}), {0.0096L, 1, -0.0736L})};
    setup.bodies[1].orientation = {0.4149, {-0.1772, -0.7190, 0.5287}};
    return setup;
}
SceneSetup balls_in_a_pit(Number restitution) {
    SceneSetup setup{.name = "pit"};
    setup.world = {.gravity = {0, -9.81, 0}, .contact = {.restitution = real(restitution), .friction = 0.3}};
    setup.planes = {{},
                    {.normal = {1, 0, 0}, .offset = 0.4},
                    {.normal = {-1, 0, 0}, .offset = 0.4},
                    {.normal = {0, 0, 1}, .offset = 0.4},
                    {.normal = {0, 0, -1}, .offset = 0.4}};
    for (int i = 0; i < 7; ++i) {
        const Number x = 0.15L * std::sin(Number(2 * i)), z = 0.15L * std::cos(Number(3 * i));
        setup.bodies.push_back(placed(sphere(1, real(0.11L + 0.005L * i)), {x, 0.2L + 0.3L * i, z}));
    }
    return setup;
}
// The same scene mirrored in x and turned about the vertical.
SceneSetup turned_scene(SceneSetup setup, bool mirrored, Number angle) {
    const Number c = std::cos(angle / 2), s = std::sin(angle / 2);
    const RealQuat turn{real(c), {0, real(s), 0}};
    for (BodySpec& body : setup.bodies) {
        if (mirrored) {
            body.position.x = -body.position.x;
            body.orientation.v.y = -body.orientation.v.y;
            body.orientation.v.z = -body.orientation.v.z;
        }
        body.position = turn.rotate(body.position);
        body.orientation = turn * body.orientation;
    }
    return setup;
}

// A bouncing body comes to rest after infinitely many bounces. Bounces slower than the speed of rest are cut off.
TEST_P(StepBounds, piles_that_come_to_rest_report_nothing) {
    if (order() == 4) GTEST_SKIP() << "contacts are those of the default method";
    std::vector<SceneSetup> scenes;
    for (const int count : {2, 3, 4})
        for (const Number restitution : {0.1L, 0.3L})
            if (count < 4 || restitution < 0.2L) scenes.push_back(falling_boxes(count, restitution, 2));
    scenes.push_back(turned_scene(falling_boxes(3, 0.1L, 0.4L), true, 0.7L));
    for (const bool mirrored : {false, true})
        scenes.push_back(turned_scene(box_onto_a_box(1), mirrored, mirrored ? 0.7L : 0));
    for (const Number restitution : {0.3L, 0.6L}) scenes.push_back(balls_in_a_pit(restitution));
    for (SceneSetup& setup : scenes) {
        for (const Seconds step : {Seconds{1, 60}, {1, 256}, {1, 1000}, {1, 1024}}) {
            setup.step = step;
            const auto world = run(setup, static_cast<int>((Real{3} / step.value).to_fixed(0)));
            const Status status = world->status();
            EXPECT_TRUE(status.ok()) << setup.name << " of " << setup.bodies.size() << ", step "
                                     << step.value.to_double() << ": " << int{status.bits};
            if (setup.bodies.size() > 4) continue;  // balls roll on
            for (int b = 0; b < world->body_count(); ++b) {
                EXPECT_LE(norm(world->motion(b).v), 0.01L)
                    << setup.bodies.size() << ", step " << step.value.to_double();
            }
        }
    }
}

// Without gravity a light ball between two heavy ones that come on bounces without end in finite time, and then all
// three go on together. What is cut off is a small part of their approach.
TEST_P(StepBounds, the_end_of_an_inelastic_collapse_is_no_alarm) {
    for (const Number restitution : {0.05L, 0.2L}) {
        for (const Number mass : {0.25L, 0.5L}) {
            for (const Vector along : {Vector{1, 0, 0}, {0, -0.6L, 0.8L}}) {
                SceneSetup setup = space(restitution);
                setup.bodies = {placed(sphere(2, 0.125), along * -0.5L, along * 1),
                                placed(sphere(real(mass), 0.0625), along * -0.125L),
                                placed(sphere(2, 0.125), along * 0.5L, along * -0.75L)};
                const auto world = run(setup, second);
                EXPECT_TRUE(world->status().ok())
                    << static_cast<double>(restitution) << " " << static_cast<double>(mass);
                const Sums after = sums_of(*world, setup.bodies);
                EXPECT_LE(norm(after.linear - along * 0.5L), 1e-5L);
                EXPECT_LE(after.energy, 1 + 0.5625L);
                EXPECT_LE(norm(world->motion(0).v - world->motion(2).v), 0.1L);
            }
        }
    }
}

// In a narrow wedge a ball bounces more often than a moment has rounds. The speed that is left is an error for a fast
// ball. It is none for a ball that approaches the planes more slowly than the speed of rest.
TEST_P(StepBounds, a_fast_bounce_that_is_cut_off_is_reported_under_gravity_and_a_slow_one_is_not) {
    for (const Number speed : {4.0L, 0.5L / 64}) {
        SceneSetup setup = squeeze(1e4L, {0, 1, 0}, speed);
        setup.bodies[0].position = {0, 0.75, 0};
        setup.world.gravity = gravity;
        const auto world = run(setup, 1);
        EXPECT_EQ(world->status().has(Issue::step_bound_hit), speed > 1) << speed;
    }
}

TEST_P(StepBounds, jumping_over_a_barrier_in_one_step_is_reported) {
    for (const Vector n : normals) {
        for (const Number speed : {16.0L, 30.0L}) {
            SceneSetup setup = plane(n, 0.5L, {placed(sphere(1, 0.25), n * (0.25L + speed / 32), n * -speed)});
            setup.step = Seconds{1, 16};
            // The barrier is too weak to act, and to be too stiff, at the beginning and at the end of the step.
            setup.world.contact = {.response = ContactResponse::spring, .stiffness = 1, .barrier = 1e-6};
            const auto world = run(setup, 2);
            EXPECT_TRUE(world->status().has(Issue::step_too_long)) << speed;
        }
    }
}

TEST_P(StepBounds, a_start_outside_the_range_is_reported_before_the_first_step) {
    if (!system().fixed_point) GTEST_SKIP() << "floating point holds any start that is finite";
    for (const auto& [position, velocity] :
         {std::pair<Vector, Vector>{{0, 80, 0}, {}}, {{-65, 0, 0}, {}}, {{}, {0, 0, 40}}, {{}, {-33, 0, 0}}}) {
        SceneSetup setup{.name = "far"};
        setup.bodies = {placed(sphere(1, 0.25), {}), placed(sphere(1, 0.25), position, velocity)};
        const auto world = build(setup, GetParam());
        EXPECT_TRUE(world->status().has(Issue::range_left));
        EXPECT_EQ(world->status().first_body, 1);
    }
}

// Gravity drives the ball out of the range on its way to a floor, which stops it in the same step.
TEST_P(StepBounds, leaving_the_range_on_the_way_to_an_impact_is_reported) {
    if (!system().fixed_point) GTEST_SKIP() << "floating point has no such range";
    for (const Vector n : {Vector{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}}) {
        for (const Number speed : {29.0L, 31.5L}) {
            constexpr Number h = 1.0L / 16, pull = 32;
            const Number way = speed * 0.75L * h + pull * 0.75L * h * 0.75L * h / 2;
            SceneSetup setup = plane(n, 0, {placed(sphere(1, 0.5), n * (0.5L + way), n * -speed)});
            setup.step = Seconds{1, 16};
            setup.world.gravity = real(n * -pull);
            const auto world = run(setup, 1);
            EXPECT_EQ(world->status().has(Issue::range_left), speed > 30) << speed;
            EXPECT_LE(norm(world->motion(0).v), pull * h);
        }
    }
}

// A heavy ball from behind drives a light one out of the range, and gravity brings it back within the same step.
TEST_P(StepBounds, leaving_the_range_by_an_impact_is_reported_even_if_the_rest_of_the_step_returns) {
    if (!system().fixed_point) GTEST_SKIP() << "floating point has no such range";
    for (const Vector n : {Vector{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}}) {
        for (const Number speed : {10.0L, 24.0L}) {  // of the heavy one; half of the approach is added to it
            SceneSetup setup{.name = "driven out", .step = Seconds{1, 16}};
            setup.world = {.gravity = real(n * -320), .contact = {.restitution = 0.5}};
            setup.bodies = {placed(sphere(1000, 0.25), {}, n * speed),
                            placed(sphere(1, 0.25), n * (0.5L + (speed + 10) / 160), n * -10)};
            const auto world = run(setup, 1);
            EXPECT_EQ(world->status().has(Issue::range_left), speed > 20) << speed;
            EXPECT_LT(norm(world->motion(1).v), 30);
        }
    }
}

}  // namespace
}  // namespace tumble::test
