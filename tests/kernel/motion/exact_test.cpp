// The exact free rotation against an independent integration in long double: motions that are difficult for its
// elliptic functions, and steps that are too long for every other method.
#include "references.hpp"
#include "tolerances.hpp"

#include <cmath>

namespace tumble::test {
namespace {

struct Flight {
    const char* name;
    RealVec3 moments, spin;
    Real step = Real::scaled(1, -4);
    int steps = 320;
    Number growth = 1;  // growth of a small error in the flight: by instability, a rod's fast spin, many turns
};

const Flight flights[] = {
    {"generic", {1, 2, 3}, {1, 1, 1}},
    {"other_order_of_axes", {2, 3, 1}, {0.5, -1, 0.7}},
    {"near_unstable_axis", {1, 2, 3}, {0.01, 5, 0.01}, Real::scaled(1, -4), 160, 1000},
    {"beside_the_separatrix", {1, 2, 3}, {1, 1, 0.5773502691896258}, Real::scaled(1, -4), 160, 10},
    {"nearly_symmetric", {1, 1.05, 1.6}, {1, 1, 4}},
    {"almost_symmetric", {1, 1.000000001, 1.6}, {1, 1, 4}},
    {"oblate", {1, 1, 1.75}, {1, -1, 3}},
    {"prolate", {0.25, 1, 1}, {4, 1, 0.5}},
    {"sphere", {2, 2, 2}, {1, 2, -3}},
    {"almost_a_sphere", {1, 1.0000001, 1.0000002}, {1, 2, -3}},
    {"rod", {0.0078125, 1, 1.00390625}, {3, 1, 0.125}, Real::scaled(1, -4), 320, 10},
    {"plate", {1, 2, 3}, {0, 1, 2}},
    {"about_the_least_moment", {1, 2, 3}, {3, 0, 0}},
    {"about_the_middle_moment", {1, 2, 3}, {0, 3, 0}},
    {"about_the_greatest_moment", {1, 2, 3}, {0, 0, 3}},
    {"almost_about_an_axis", {1, 2, 3}, {3, 1e-9, 1e-12}},
    {"hardly", {1, 2, 3}, {1e-15, 2e-15, 1e-20}},
    {"at_rest", {1, 2, 3}, {0, 0, 0}},
    // Up to 20 rad in one step, and a step from one side of the unstable axis to the other.
    {"one_step_of_10_s", {1, 2, 3}, {1, 1.25, 0.75}, 10, 1},
    {"steps_of_10_s", {1, 2, 3}, {1.5, 0.25, 0.75}, 10, 4},
    {"one_step_over_a_flip", {1, 2, 3}, {0.015625, 2, 0.015625}, 8, 1},
    {"one_step_of_100_s", {1, 2, 3}, {1, 1.25, 0.75}, 100, 1, 10},
    {"a_sphere_in_one_step", {1, 1, 1}, {1, 1.25, 0.75}, 10, 1},
    {"a_rod_in_one_step", {0.0078125, 1, 1.00390625}, {3, 1, 0.125}, 10, 1, 10},
};

class ExactRotation : public testing::TestWithParam<std::tuple<Flight, const char*>> {};
INSTANTIATE_TEST_SUITE_P(exact, ExactRotation,
                         testing::Combine(testing::ValuesIn(flights), testing::Values("f64", "f32")),
                         [](const auto& info) {
                             return std::string{std::get<0>(info.param).name} + "_" + std::get<1>(info.param);
                         });

TEST_P(ExactRotation, has_no_error_but_rounding) {
    const auto& [flight, name_of_system] = GetParam();
    const System& system = number_system(name_of_system);
    SceneSetup setup{.name = flight.name, .step = Seconds{flight.step}, .bodies = {top(flight.moments, flight.spin)}};
    const int samples = std::min(flight.steps, 20);
    const auto reference =
        reference::free_trajectory(reference_body(setup.bodies[0]), start_of(setup.bodies[0]),
                                   reference::sample_times(number(flight.step) * flight.steps / samples, samples));
    const auto world = build(setup, "exact", system.name);
    const Vector moments = vector(flight.moments);
    const Motion start = world->motion(0);
    const Bound allowed = tolerance::exact_rotation.of(system) * flight.growth;
    for (const Motion& expected : reference) {
        if (&expected != &reference.front()) world->run(flight.steps / samples);
        ASSERT_TRUE(world->status().ok());
        const Motion m = world->motion(0);
        EXPECT_LE(angle_between(m.q, expected.q), allowed);
        EXPECT_LE(norm(m.w - expected.w), allowed * std::max(Number(1), norm(start.w)));
        const Number momentum = norm(angular_momentum(start, moments));
        EXPECT_LE(norm(angular_momentum(m, moments) - angular_momentum(start, moments)),
                  tolerance::exact_rotation.of(system) * momentum);
        EXPECT_LE(std::abs(std::sqrt(m.q.norm2()) - 1), tolerance::unit_rounding.of(system));
    }
}

TEST(exact, keeps_energy_and_momentum_over_a_million_steps) {
    for (const Seconds step : {Seconds{1, 256}, Seconds{10, 1}}) {
        SceneSetup setup = free_top(step);
        const Vector moments{1, 2, 3};
        const auto world = build(setup, "exact", "f64");
        const Number energy = spin_energy(world->motion(0), moments);
        const Vector momentum = angular_momentum(world->motion(0), moments);
        Number worst = 0, worst_momentum = 0;
        for (int i = 0; i < 100; ++i) {
            EXPECT_TRUE(world->run(10000).ok());
            const Motion m = world->motion(0);
            worst = std::max(worst, std::abs(spin_energy(m, moments) / energy - 1));
            worst_momentum = std::max(worst_momentum, std::abs(norm(times(moments, m.w)) / norm(momentum) - 1));
        }
        std::printf("exact f64, %Lg s: energy off by %.2Lg, |m| by %.2Lg at most in 1e6 steps\n", number(step.value),
                    worst, worst_momentum);
        const bool is_long = step.value > Real{1};
        EXPECT_LE(worst, is_long ? tolerance::million_long_steps_energy : tolerance::million_steps_energy);
        EXPECT_LE(worst_momentum, tolerance::million_steps_momentum);
    }
}

TEST(exact, many_short_steps_equal_one_long_step) {
    for (const char* system : {"f64", "f32"}) {
        SceneSetup setup{.name = "spans", .step = Seconds{1, 64}, .bodies = {top({1, 2, 3}, {1, 1.25, 0.75})}};
        const auto small = build(setup, "exact", system);
        small->run(640);
        setup.step = Seconds{10, 1};
        const auto large = build(setup, "exact", system);
        large->step();
        EXPECT_LE(distance(small->motion(0), large->motion(0)), tolerance::exact_rotation.of(number_system(system)));
    }
}

TEST(exact, is_finite_for_every_spin_and_span) {
    // Spins and moments of all sizes and proportions, on the separatrix and near it.
    const Real sizes[] = {0, 1e-300, 1e-160, 1e-30, 1e-12, 1e-3, 1, 1e3, 1e9};
    const RealVec3 moments[] = {{1, 2, 3}, {1, 1, 1}, {1, 1, 2}, {1, 2, 2}, {1e-9, 1, 1}, {1e-6, 1, 1.0000005}};
    for (const char* system : {"f64", "f32"}) {
        for (const RealVec3& m : moments) {
            for (const Real& x : sizes) {
                for (const Real& y : sizes) {
                    for (const Real& z : sizes) {
                        SceneSetup setup{.name = "any", .step = Seconds{1, 1}};
                        // On the separatrix alpha m_x^2 = beta m_z^2: for moments 1, 2, 3 if w_x^2 = 3 w_z^2.
                        setup.bodies = {top(m, {x * Real{1.7320508075688772}, y, -z})};
                        const auto world = build(setup, "exact", system);
                        world->run(4);
                        const Motion end = world->motion(0);
                        ASSERT_TRUE(std::isfinite(end.q.norm2()) && std::isfinite(norm(end.w)))
                            << system << " " << number(m.x) << " " << number(m.y) << " " << number(m.z) << ": "
                            << number(x) << " " << number(y) << " " << number(z);
                        ASSERT_LE(std::abs(end.q.norm2() - 1), tolerance::unit);
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace tumble::test
