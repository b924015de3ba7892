// Contacts of bodies that turn: torques have their direction in the world, what a turntable carries follows its
// surface, and what rolls, tips or stands on a corner keeps its energy, all to second order in the step.
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

// J, kinetic and of gravity.
Number energy_of(const AnyWorld& world, const BodySpec& body) {
    const Motion m = world.motion(0);
    return number(body.mass) * (dot(m.v, m.v) / 2 + number(Real(9.81)) * m.x.y) + spin_energy(m, moments_of(body));
}
RealQuat about(Vector axis, Number angle) {
    const Vector v = axis * (std::sin(angle / 2) / norm(axis));
    return {real(std::cos(angle / 2)), real(v)};
}

// A hoop that leans by b and rolls on a floor. Its centre goes round a circle of radius R at the rate W with
// g tan(b) = W^2 (2 R + a sin(b) / 2), a the radius of the hoop: Euler's equations about the centre.
TEST_P(ContactOrder, a_hoop_that_leans_stays_in_its_circle_and_keeps_its_energy) {
    for (const Number lean : {0.26L, 0.4L}) {
        for (const Number side : {1.0L, -1.0L}) {
            for (const auto& [radius, circle, mass] :
                 {std::array{0.5L, 12.0L, 1.2L}, std::array{0.3L, 4.0L, 0.2L}, std::array{0.4L, 8.0L, 30.0L}}) {
                const Number g = number(Real(9.81)),
                             rate = side * std::sqrt(g * std::tan(lean) / (2 * circle + radius * std::sin(lean) / 2));
                SceneSetup setup = floor(0, 2);
                const Vector axis{0, std::sin(lean), std::cos(lean)};
                BodySpec hoop = oriented(tumble::hoop(real(mass), real(radius)), about({1, 0, 0}, -lean));
                hoop = placed(hoop, {0, radius * std::cos(lean), circle}, {rate * circle, 0, 0});
                const Vector spin = Vector{0, rate, 0} - axis * (rate * (circle / radius + std::sin(lean)));
                hoop.angular_velocity = real(rotation(hoop.orientation).normalized().rotate_back(spin));
                setup.bodies = {hoop};
                const Number before = energy_of(*build(setup, GetParam()), hoop);
                const auto world = run(setup, 4 * second);
                const Vector x = world->motion(0).x;
                EXPECT_LE(std::abs(std::hypot(x.x, x.z) - circle), 5e-4L * circle) << lean << ", " << radius;
                EXPECT_LE(std::abs(energy_of(*world, hoop) - before), 5e-5L * before) << lean << ", " << radius;
            }
        }
    }
}

// The angle of its axis from the vertical is `lean`.
TEST_P(ContactOrder, a_coin_that_spins_on_its_rim_gains_no_energy) {
    for (const Number lean : {1.2L, 1.35L}) {
        for (const Number spin : {8.0L, -9.0L}) {
            for (const Number size : {1.0L, 2.5L}) {
                SceneSetup setup = floor(0.1L, 0.4L);
                setup.step = Seconds{1, 512};
                BodySpec coin = oriented(cylinder(real(0.3L * size), real(0.1L * size), real(0.01L * size)),
                                         about({1, 0, 0}, pi / 2 - lean));
                coin = placed(coin, {0, 0.12L * size, 0}, {}, Vector{0, spin / std::sqrt(size), 0});
                setup.bodies = {coin};
                const auto world = run(setup, 512);
                const Number before = energy_of(*world, coin);
                for (int k = 0; k < 8; ++k) {
                    world->run(128);
                    EXPECT_LE(energy_of(*world, coin), before * (1 + 3e-4L)) << lean << ", " << spin << ", " << size;
                }
            }
        }
    }
}

// Over the edge on which it stands it turns as a pendulum does: I w^2 / 2 is what it falls by.
TEST_P(ContactOrder, a_box_that_tips_over_an_edge_keeps_its_energy) {
    for (const Number side : {1.0L, -1.0L}) {
        for (const auto& [width, height, beyond] :
             {std::array{0.3L, 0.3L, 0.05L}, std::array{0.2L, 0.5L, 0.1L}, std::array{0.4L, 0.3L, 0.03L}}) {
            SceneSetup setup = floor(0, 2);
            setup.step = Seconds{1, 128};
            const Number tilt = std::atan2(width, height) + beyond, reach = std::hypot(width, height) / 2;
            BodySpec body = oriented(box(real(2), real(Vector{width, height, 0.3L})), about({0, 0, 1}, -side * tilt));
            setup.bodies = {placed(body, {0, reach * std::cos(beyond), 0})};
            const Number before = energy_of(*build(setup, GetParam()), body);
            const auto world = run(setup, 40);
            EXPECT_GE(norm(world->motion(0).w), 0.3L);
            EXPECT_LE(std::abs(energy_of(*world, body) - before), 1e-4L * before) << width << ", " << height;
        }
    }
}

}  // namespace
}  // namespace tumble::test
