// Which approaches bounce, and how fast what bounces leaves.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

using Restitution = ImpactCases;
INSTANTIATE_TEST_SUITE_P(every, Restitution, testing::ValuesIn(contact_cases()), NameOf{});

TEST_P(Restitution, an_approach_below_the_restitution_threshold_does_not_bounce) {
    for (const Number threshold : {0.25L, 1.0L, 3.0L}) {
        for (const Vector n : normals) {
            for (const Number share : {0.5L, 0.96L, 1.04L, 2.0L}) {
                const Number speed = share * threshold;
                SceneSetup setup = plane(n, 0.75L, {placed(sphere(3, 0.25), n * (0.25L + speed / 10), n * -speed)});
                setup.world.contact.restitution_threshold = real(threshold);
                const auto world = run(setup, second / 4);
                const Number leaves = share > 1 ? 0.75L * speed : 0;
                EXPECT_LE(norm(world->motion(0).v - n * leaves), 4 * rounding() * speed) << threshold << ", " << speed;
                EXPECT_TRUE(world->status().ok());
            }
        }
    }
}

TEST_P(Restitution, the_threshold_applies_to_the_relative_speed_of_two_bodies) {
    for (const Number share : {0.9L, 1.1L}) {
        SceneSetup setup = space(1, 0,
                                 {placed(sphere(1, 0.25), {-0.375L, 0, 0}, {1.5L * share, 0, 0}),
                                  placed(sphere(3, 0.25), {0.375L, 0, 0}, {-0.5L * share, 0, 0})});
        setup.world.contact.restitution_threshold = 2;
        const auto world = run(setup, second);
        // The centre of mass is at rest: the bodies turn back or stay together.
        const Number leaves = share > 1 ? share : 0;
        EXPECT_LE(norm(world->motion(0).v + Vector{1.5L * leaves, 0, 0}), 4 * rounding());
        EXPECT_LE(norm(world->motion(1).v - Vector{0.5L * leaves, 0, 0}), 4 * rounding());
    }
}

// A ball lands 0.95 of a step after its release. Its bounce would last 2 e v / g: more or less than the rest of the
// step.
TEST_P(Restitution, a_bounce_that_would_end_within_its_step_is_the_last) {
    constexpr Number h = 1.0L / 16, landing = 0.95L * h;
    for (const Number share : {0.02L, 0.045L, 0.055L, 0.1875L}) {
        const Number speed = g * landing, restitution = share * g * h / (2 * speed);
        SceneSetup setup = floor(restitution, 0, {placed(sphere(1, 0.5), {0, 0.5L + g * landing * landing / 2, 0})});
        setup.step = Seconds{1, 16};
        const auto world = run(setup, 1);
        const Number left = h * share > h - landing ? restitution * speed - g * (h - landing) : 0;
        EXPECT_LE(std::abs(world->motion(0).v.y - left), tolerance::brief_bounce * speed) << share << " of a step";
    }
}

// The last bounces are shorter than a step, and as high as the tolerance.
TEST_P(Restitution, a_ball_that_bounces_comes_to_rest_on_the_floor) {
    for (const Number restitution : {0.5L, 0.8L, 0.95L}) {
        for (const int rate : {30, 50}) {
            for (const Number height : {0.003L, 0.1L}) {
                SceneSetup setup = floor(restitution, 0.5L, {placed(sphere(1, 0.125), {0, 0.125L + height, 0})});
                setup.step = Seconds{1, rate};
                const auto world = run(setup, rate * 10);
                const Motion m = world->motion(0);
                EXPECT_LE(m.x.y - 0.125L, tolerance::contact_band) << restitution << ", " << rate << ", " << height;
                EXPECT_EQ(norm(m.v), 0) << restitution << ", " << rate << ", " << height;
            }
        }
    }
}

// The moment of an impact is found for any flight, here from rest in a step of up to 1/8 s. The ball rises until after
// the end of the step.
TEST_P(Restitution, an_elastic_ball_keeps_its_energy_wherever_in_the_second_half_of_a_long_step_it_lands) {
    for (const Number h : {0.125L, 0.0625L}) {
        for (int place = 10; place < 20; ++place) {
            const Number landing = h * static_cast<Number>(place) / 20, drop = g * landing * landing / 2;
            SceneSetup setup = floor(1, 0, {placed(sphere(1, 0.25), {0, 0.25L + drop, 0})});
            setup.step = Seconds{real(h)};
            const auto world = run(setup, 1);
            const Motion m = world->motion(0);
            const Number apex = m.x.y - 0.25L + m.v.y * m.v.y / (2 * g);
            EXPECT_LE(std::abs(apex - drop), tolerance::landing.of(system()))
                << "at " << place << "/20 of " << h << " s";
        }
    }
}

}  // namespace
}  // namespace tumble::test
