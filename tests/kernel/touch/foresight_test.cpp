// What is clear of contact for a time is found sooner where a load or an event changes its motion.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

using Foresight = ImpactCases;
INSTANTIATE_TEST_SUITE_P(every, Foresight, testing::ValuesIn(contact_cases()), NameOf{});

// The gap is in no step deeper than the tolerance.
template <class Gap>
void expect_not_deep(AnyWorld& world, int steps, Gap&& gap, Number distance) {
    for (int step = 0; step < steps; ++step) {
        world.step();
        ASSERT_LE(-gap(), tolerance::depth) << "from " << distance << " m, step " << step;
    }
}
// A load may change a closing speed within a step, though the body was far enough to be clear of contact at the earlier
// speed.
TEST_P(Foresight, a_body_that_a_force_drives_on_within_a_step_does_not_come_deeper_than_the_tolerance) {
    constexpr Number speed = 4, push = 3.875L * 256;
    for (const Vector n : {normals[0], normals[3]}) {
        for (int place = 0; place < 32; ++place) {
            const Number gap = speed / 256 * (1 + place / 20.0L);
            SceneSetup setup = plane(n, 0, {placed(sphere(1, 0.25), n * (0.25L + gap), n * -speed)});
            setup.forces = {{.body = 0, .from = 0.0, .until = 8.0, .force = real(n * -push)}};
            const auto world = build(setup, GetParam());
            expect_not_deep(
                *world, 4, [&] { return dot(world->motion(0).x, n) - 0.25L; }, gap);
        }
    }
}

// The same for two bodies, with either of them driven.
TEST_P(Foresight, bodies_that_a_force_drives_at_each_other_within_a_step_do_not_come_deeper_than_the_tolerance) {
    constexpr Number speed = 4, push = 3.875L * 256;
    for (const Vector n : normals) {
        for (const int driven : {0, 1}) {
            for (int place = 0; place < 16; ++place) {
                const Number gap = speed / 256 * (1 + place / 10.0L);
                SceneSetup setup = space(0, 0, {placed(sphere(1, 0.25), n * (0.5L + gap)), sphere(1, 0.25)});
                const Vector along = driven == 0 ? -n : n;
                setup.bodies[static_cast<std::size_t>(driven)].velocity = real(along * speed);
                setup.forces = {{.body = driven, .from = 0.0, .until = 8.0, .force = real(along * push)}};
                const auto world = build(setup, GetParam());
                const auto now = [&] { return dot(world->motion(0).x - world->motion(1).x, n) - 0.5L; };
                expect_not_deep(*world, 4, now, gap);
            }
        }
    }
}

// A body hovers above a floor and has been clear of contact for half a second. Another body touches it softly, and a
// force on that one presses both down.
TEST_P(Foresight, a_body_pressed_by_another_does_not_come_deeper_than_the_tolerance) {
    for (const Vector n : normals) {
        for (const bool reversed : {false, true}) {
            for (const Number push : {1.5L, 3.0L, 64.0L, 200.0L}) {
                const Number above = push < 10 ? 0.05L : 0.3L;
                constexpr Number apart = 0.002L, drift = 0.04L;
                SceneSetup setup = plane(n, 0,
                                         {placed(sphere(1, 0.25), n * (0.25L + above)),
                                          placed(sphere(1, 0.25), n * (0.75L + above + apart), n * -drift)});
                if (reversed) std::swap(setup.bodies[0], setup.bodies[1]);
                const int lower = reversed ? 1 : 0;
                setup.forces = {{.body = 1 - lower,
                                 .from = real(10 / 256.0L),  // half a millimetre apart
                                 .until = 8.0,
                                 .force = real(n * -push)}};
                const auto world = build(setup, GetParam());
                expect_not_deep(
                    *world, second, [&] { return dot(world->motion(lower).x, n) - 0.25L; }, above);
            }
        }
    }
}

// A slope deflects gravity towards a wall that is parallel to gravity.
TEST_P(Foresight, a_body_that_slides_down_a_slope_to_a_wall_does_not_come_deeper_than_the_tolerance) {
    for (const Number mirror : {1.0L, -1.0L}) {
        for (int place = 0; place < 24; ++place) {
            const Number gap = 0.0015L * (1 + place * place / 8.0L), x = 0.25L + gap;
            SceneSetup setup = space(0, 0, {placed(sphere(1, 0.25), {mirror * x, (0.25L + 0.6L * x) / 0.8L, 0})});
            setup.world.gravity = gravity * Real{4};
            setup.planes = {{.normal = {real(-0.6L * mirror), 0.8, 0}}, {.normal = {real(mirror), 0, 0}}};
            const auto world = build(setup, GetParam());
            expect_not_deep(
                *world, second / 2, [&] { return mirror * world->motion(0).x.x - 0.25L; }, gap);
            EXPECT_LE(norm(world->motion(0).v), tolerance::rest_speed);
        }
    }
}

TEST_P(Foresight, new_gravity_stops_a_body_at_a_plane_that_was_not_tested) {
    for (const Vector n : normals) {
        const auto world = build(plane(n, 0, {placed(sphere(1, 0.25), n * 2.25L)}), GetParam());
        world->run(3);  // at rest, with a bound on the time to contact of half a second
        world->set_gravity(n * -25);
        // It falls for 0.4 s.
        expect_not_deep(
            *world, second, [&] { return dot(world->motion(0).x, n) - 0.25L; }, 2);
        EXPECT_LE(std::abs(dot(world->motion(0).x, n) - 0.25L), tolerance::place);
        EXPECT_TRUE(world->status().ok());
    }
}

TEST_P(Foresight, a_plane_added_during_a_run_stops_a_body_that_was_clear_of_contact) {
    for (const Vector n : normals) {
        const auto world = run(space(0.5L, 0, {placed(sphere(1, 0.25), n * 2.25L, n * -8)}), 3);
        ASSERT_TRUE(world->add(PlaneSpec{.normal = real(n)}));
        world->run(second / 2);
        EXPECT_LE(norm(world->motion(0).v - n * 4), 8 * rounding());
    }
}

}  // namespace
}  // namespace tumble::test
