// How accurate a tumbling top is after 100 s, against an independent integration in long double.
#include "references.hpp"
#include "tolerances.hpp"

namespace tumble::test {
namespace {

constexpr int steps_per_sample = 64;   // a quarter of a second

const std::vector<Motion>& reference_of_the_top() {
    static const std::vector<Motion> motions = [] {
        const SceneSetup setup = free_top({1, 256});
        return reference::free_trajectory(reference_body(setup.bodies[0]), start_of(setup.bodies[0]), reference::sample_times(0.25L, 400));
    }();
    return motions;
}

Number error_of(std::string_view method, std::string_view system) {
    const auto world = build(free_top({1, 256}), method, system);
    const Number error = orientation_error(*world, reference_of_the_top(), steps_per_sample);
    EXPECT_TRUE(world->status().ok());
    testing::Test::RecordProperty("orientation_error_rad", std::to_string(error * 1e9L) + "e-9");
    std::printf("%.*s %.*s: orientation error %.3Lg rad\n", static_cast<int>(method.size()), method.data(), static_cast<int>(system.size()), system.data(), error);
    return error;
}

TEST(reference, conserves_angular_momentum_and_energy_to_its_tolerance) {
    const Vector moments{1, 2, 3};
    const auto& motions = reference_of_the_top();
    const Vector momentum = angular_momentum(motions.front(), moments);
    for (const Motion& m : motions) {
        ASSERT_LE(norm(angular_momentum(m, moments) - momentum), tolerance::reference);
        ASSERT_LE(std::abs(spin_energy(m, moments) - spin_energy(motions.front(), moments)), tolerance::reference);
        ASSERT_LE(std::abs(m.q.norm2() - 1), tolerance::reference);
    }
}

TEST(reference, turns_a_symmetric_top_as_its_closed_form_does) {
    // Moments 2, 2, 1: the figure axis precesses about L at |L| / I_x while the body turns about its axis.
    const reference::Body body{1, {2, 2, 1}};
    const Motion start{{}, {}, {}, {0.3L, -0.2L, 1.5L}};
    const Vector momentum = times(body.moments, start.w);
    const Number t = 20;
    const Rotation expected = exponential(momentum * (t / 2)) * exponential(Vector{0, 0, start.w.z * (1 - 1 / Number(2)) * t});
    EXPECT_LE(angle_between(reference::free_trajectory(body, start, {t}).back().q, expected), tolerance::reference);
}

TEST(accuracy, rk4_q32_orients_the_top_to_5e_6_rad_after_100_s) { EXPECT_LE(error_of("rk4", "q32_near"), tolerance::top_rk4_q32); }
TEST(accuracy, rk4_f32_orients_the_top_to_5e_5_rad_after_100_s) { EXPECT_LE(error_of("rk4", "f32"), tolerance::top_rk4_f32); }
TEST(accuracy, rk4_f64_orients_the_top_to_2e_9_rad_after_100_s) { EXPECT_LE(error_of("rk4", "f64"), tolerance::top_rk4_f64); }
TEST(accuracy, verlet_q32_orients_the_top_as_well_as_verlet_f64) {
    const Number exact_arithmetic = error_of("verlet", "f64");
    EXPECT_LE(exact_arithmetic, tolerance::top_verlet_f64);
    EXPECT_LE(std::abs(error_of("verlet", "q32_near") / exact_arithmetic - 1), tolerance::top_verlet_q32_excess);
}

}  // namespace
}  // namespace tumble::test
