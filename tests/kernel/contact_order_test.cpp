// Contacts of bodies that turn: torques have their direction in the world, and what a turntable carries follows its
// surface to second order in the step.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

using ContactOrder = CaseTest;
INSTANTIATE_TEST_SUITE_P(every, ContactOrder, testing::ValuesIn(contact_cases()), NameOf{});

// A spin about the normal of a point contact does nothing.
TEST_P(ContactOrder, a_ball_that_spins_about_the_vertical_slides_straight) {
    for (const Number spin : {20.0L, -12.0L}) {
        for (const Number radius : {0.1L, 0.25L}) {
            for (const Number heading : {0.0L, 2.0L}) {
                const Vector along{std::cos(heading), 0, std::sin(heading)}, across{-along.z, 0, along.x};
                BodySpec ball = placed(sphere(1.3, real(radius)), {0, radius, 0}, along * 3);
                ball.angular_velocity = real(Vector{0, spin, 0});
                const auto world = run(floor(0, 0.25L, {ball}), second);
                EXPECT_LE(std::abs(dot(world->motion(0).x, across)), 1e-5L) << spin;
                EXPECT_LE(std::abs(dot(world->motion(0).v, across)), 1e-5L) << spin;
                EXPECT_LE(std::abs(dot(world->motion(0).v, along) - 3 * 5 / 7.0L), 1e-4L) << spin;
            }
        }
    }
}

// Its centre goes round a circle at 2/7 of the table's rate (Gersten, Soodak and Tiersten 1992).
TEST_P(ContactOrder, a_ball_that_rolls_on_a_turntable_goes_round_at_two_sevenths_of_its_rate) {
    for (const Number rate : {2.0L, -1.5L}) {
        for (const Number radius : {0.25L, 0.4L}) {
            const Number speed = 0.5L, circling = rate * 2 / 7, time = 2;
            SceneSetup setup = floor(0, 0.9L);
            setup.planes.clear();
            BodySpec table = fixed(placed(box(1, {30, 0.5, 30}), {0, -0.25L, 0}));
            table.angular_velocity = real(Vector{0, rate, 0});
            // v + w x arm is the velocity of the table at (1, 0, 0).
            BodySpec ball = placed(sphere(2, real(radius)), {1, radius, 0}, {0, 0, speed});
            ball.angular_velocity = real(Vector{(speed + rate) / radius, 0, 0});
            setup.bodies = {table, ball};
            const auto world = run(setup, second * 2);
            const Number angle = circling * time;
            const Vector x{1 + speed * (1 - std::cos(angle)) / circling, radius, speed * std::sin(angle) / circling};
            EXPECT_LE(norm(world->motion(1).x - x), 1e-4L) << rate;
            EXPECT_LE(norm(world->motion(1).v - Vector{speed * std::sin(angle), 0, speed * std::cos(angle)}), 1e-4L)
                << rate;
        }
    }
}

// Off the middle a box circles with its table. What friction holds does not creep.
TEST_P(ContactOrder, a_box_that_a_turntable_carries_comes_back_after_a_turn) {
    for (const Number rate : {2.0L, -2.5L}) {
        for (const Number place : {0.5L, 0.75L}) {
            for (const int steps : {128, 256}) {
                SceneSetup setup = floor(0, 0.9L);
                setup.planes.clear();
                setup.step = Seconds{1, steps};
                BodySpec table = fixed(placed(box(1, {8, 0.5, 8}), {0, -0.25L, 0}));
                table.angular_velocity = real(Vector{0, rate, 0});
                BodySpec body = placed(box(3, {0.2, 0.1, 0.25}), {place, 0.05L, 0}, {0, 0, -rate * place});
                body.angular_velocity = real(Vector{0, rate, 0});
                setup.bodies = {table, body};
                const Number turn = 2 * pi / std::abs(rate);
                const auto world = run(setup, static_cast<std::int64_t>(std::lround(turn * steps)));
                const Vector x = world->motion(1).x;
                EXPECT_LE(std::abs(std::hypot(x.x, x.z) - place), 2e-4L) << rate << ", 1/" << steps << " s";
            }
        }
    }
}

}  // namespace
}  // namespace tumble::test
