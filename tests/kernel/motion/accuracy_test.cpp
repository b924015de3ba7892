// Accuracy of a tumbling top after 100 s, against an independent integration in long double.
#include "references.hpp"
#include "tolerances.hpp"

#include <utility>

namespace tumble::test {
namespace {

constexpr int steps_per_sample = 64;  // a quarter of a second

const std::vector<Motion>& reference_of_the_top() {
    static const std::vector<Motion> motions = [] {
        const SceneSetup setup = free_top({1, 256});
        return reference::free_trajectory(reference_body(setup.bodies[0]), start_of(setup.bodies[0]),
                                          reference::sample_times(0.25L, 400));
    }();
    return motions;
}

Number error_of(std::string_view method, std::string_view system, Seconds step = {1, 256},
                int steps = steps_per_sample) {
    const auto world = build(free_top(step), method, system);
    const Number error = orientation_error(*world, reference_of_the_top(), steps);
    EXPECT_TRUE(world->status().ok());
    testing::Test::RecordProperty("orientation_error_rad", std::to_string(error * 1e9L) + "e-9");
    std::printf("%.*s %.*s: orientation error %.3Lg rad\n", static_cast<int>(method.size()), method.data(),
                static_cast<int>(system.size()), system.data(), error);
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
    const Rotation expected =
        exponential(momentum * (t / 2)) * exponential(Vector{0, 0, start.w.z * (1 - 1 / Number(2)) * t});
    EXPECT_LE(angle_between(reference::free_trajectory(body, start, {t}).back().q, expected), tolerance::reference);
}

TEST(accuracy, rk4_q32_orients_the_top_to_2e_6_rad_after_100_s) {
    EXPECT_LE(error_of("rk4", "q32_near"), tolerance::top_after_100_s.of(number_system("q32_near")));
}
TEST(accuracy, pdmv6_q32_orients_the_top_to_1e_5_rad_after_100_s) {
    EXPECT_LE(error_of("pdmv6", "q32_near"), tolerance::top_after_100_s.of(number_system("q32_near")));
}
TEST(accuracy, rk4_f32_orients_the_top_to_5e_5_rad_after_100_s) {
    EXPECT_LE(error_of("rk4", "f32"), tolerance::top_after_100_s.of(number_system("f32")));
}
TEST(accuracy, rk4_f64_orients_the_top_to_2e_9_rad_after_100_s) {
    EXPECT_LE(error_of("rk4", "f64"), tolerance::top_after_100_s.of(number_system("f64")));
}
TEST(accuracy, verlet_q32_orients_the_top_as_well_as_verlet_f64) {
    const Number exact_arithmetic = error_of("verlet", "f64");
    EXPECT_LE(exact_arithmetic, tolerance::top_after_100_s.of(number_system("f64")));
    EXPECT_LE(std::abs(error_of("verlet", "q32_near") / exact_arithmetic - 1), tolerance::top_excess);
}

// 0.005 s has no finite binary expansion.
Number error_at_5_ms(std::string_view method, std::string_view system) {
    return error_of(method, system, Seconds{Real{0.005}}, 50);
}
TEST(accuracy, verlet_q32_orients_the_top_as_well_as_verlet_f64_at_a_decimal_step) {
    EXPECT_LE(std::abs(error_at_5_ms("verlet", "q32_near") / error_at_5_ms("verlet", "f64") - 1),
              tolerance::top_excess);
}
TEST(accuracy, rk4_q32_orients_the_top_at_a_decimal_step_as_at_a_binary_one) {
    EXPECT_LE(error_at_5_ms("rk4", "q32_near"), tolerance::top_growth * error_of("rk4", "q32_near"));
}

// The generic top, rates (1, 1, 1), 20 s.
Number error_of_the_generic_top(std::string_view method, Seconds step) {
    SceneSetup setup = free_top(step);
    setup.bodies[0].angular_velocity = {1, 1, 1};
    const int samples = 20, steps_per_second = static_cast<int>(std::lround(1 / number(step.value)));
    static const auto reference = reference::free_trajectory(reference_body(setup.bodies[0]), start_of(setup.bodies[0]),
                                                             reference::sample_times(1, samples));
    const auto world = build(setup, method, "f64");
    return orientation_error(*world, reference, steps_per_second);
}
TEST(accuracy, preprocessed_moser_veselov_orients_the_generic_top_at_a_step_of_50_ms) {
    EXPECT_LE(error_of_the_generic_top("pdmv6", Seconds{1, 20}), tolerance::generic_top.of_order(6));
    EXPECT_LE(error_of_the_generic_top("pdmv8", Seconds{1, 20}), tolerance::generic_top.of_order(8));
    EXPECT_LE(error_of_the_generic_top("pdmv10", Seconds{1, 20}), tolerance::generic_top.of_order(10));
}

TEST(accuracy, suzuki4_orients_the_heavy_top_at_a_step_of_10_ms) {
    // Moments 0.02, 0.025, 0.01 and M g l = 0.981: gravity as a force at a point of the axis, 2 s.
    SceneSetup setup{
        .name = "heavy_top", .step = Seconds{1, 100}, .bodies = {top({0.02, 0.025, 0.01}, {0.5, 0.5, 30})}};
    setup.forces = {{.body = 0, .from = 0.0, .until = 10.0, .force = {0, 0, -0.981}, .point = {0, 0, 1}}};
    const auto reference = reference::trajectory(
        reference_body(setup.bodies[0]), start_of(setup.bodies[0]), reference::sample_times(0.1L, 20),
        [](const Motion& m, Number) {
            return reference::Wrench{{0, 0, -0.981}, cross(Vector{0, 0, 1}, m.q.rotate_back({0, 0, -0.981}))};
        });
    const auto world = build(setup, "suzuki4", "f64");
    EXPECT_LE(orientation_error(*world, reference, 10), tolerance::heavy_top);
}

TEST(accuracy, integers_and_carried_floats_beat_plain_float) {
    if (!has_number_system("f32_plain")) GTEST_SKIP() << "the deep set has plain floats";
    for (const Case& c : cases_in("f32_plain")) {
        if (c.method.order < 2) continue;
        // The method's own error is larger than both.
        const Number own = error_of(c.method.name, "f64"), plain = error_of(c.method.name, "f32_plain");
        if (number_system("q32_near").has(c.method.name)) {
            EXPECT_LE(error_of(c.method.name, "q32_near"), std::max(plain / 100, 1.5L * own)) << c.method.name;
        }
        EXPECT_LE(error_of(c.method.name, "f32"), std::max(plain / 3, 1.5L * own)) << c.method.name;
    }
}

TEST(accuracy, rk4_q32_orients_the_top_to_1e_4_rad_after_1000_s) {
    SceneSetup setup = free_top(Seconds{1, 256});
    const auto reference = reference::free_trajectory(reference_body(setup.bodies[0]), start_of(setup.bodies[0]),
                                                      reference::sample_times(10, 100));
    const auto world = build(setup, "rk4", "q32_near");
    EXPECT_LE(orientation_error(*world, reference, 2560), tolerance::top_after_1000_s);
}

TEST(accuracy, pdmv_keeps_energy_over_a_million_steps) {
    const std::pair<const char*, const char*> cases[] = {
        {"pdmv6", "q32_near"}, {"pdmv4", "f64"}, {"pdmv6", "f64"}, {"pdmv8", "f64"}, {"pdmv10", "f64"}};
    for (const auto& [method, system] : cases) {
        const Vector moments{1, 2, 3};
        const auto world = build(free_top({1, 256}), method, system);
        const Number start = spin_energy(world->motion(0), moments);
        Number worst = 0;
        for (int i = 0; i < 100; ++i) {
            world->run(10000);
            worst = std::max(worst, std::abs(spin_energy(world->motion(0), moments) / start - 1));
        }
        std::printf("%s %s: energy off by %.2Lg at most in 1e6 steps\n", method, system, worst);
        EXPECT_LE(worst, tolerance::million_steps_energy.of(number_system(system))) << method << " " << system;
        EXPECT_TRUE(world->status().ok());
    }
}

// Discs, hoops and plates have a largest modified moment of more than twice the middle one. The smallest moment of rods
// is lost beside the middle one. The bodies turn about each of their axes: q32 against the same method in double.
TEST(accuracy, pdmv_q32_orients_flat_and_slender_bodies_as_pdmv_f64) {
    const std::pair<Vector, Vector> bodies[] = {
        {{1, 1, 2}, {0.5L, 0.2L, 6}},        {{1, 1, 2}, {1, -0.4L, 12}},
        {{0.01L, 0.01L, 0.02L}, {3, 7, -9}}, {{1, 1.00001L, 2.00001L}, {-2, 5, 10}},
        {{1, 1.01L, 2}, {4, -3, 9}},         {{5, 5, 9.9999L}, {0.1L, 0.1L, -11}},
        {{0.5L, 0.7L, 1.2L}, {5, 5, 5}},     {{1, 1, 1e-5L}, {1, 0.5L, 20}},
        {{1, 1, 1e-5L}, {12, 9, 3}},         {{1.000004L, 1, 1e-5L}, {-5, 3, 20}},
        {{3.0012L, 3, 3e-3L}, {5, -3, 20}},  {{2e-4L, 2e-4L, 2e-6L}, {-8, 8, -8}},
        {{1.03L, 1, 0.1L}, {5, 3, -20}},     {{1, 1, 0.17L}, {-5, 3, 20}},
    };
    Number worst = 0;
    for (const auto& [moments, spin] : bodies) {
        for (const int steps_per_second : {256, 384, 640}) {
            const int turned = steps_per_second / 128 % 3;  // the axis that becomes the body's third
            const auto about = [&](Vector v) {
                return Vector{v[turned % 3], v[(turned + 1) % 3], v[(turned + 2) % 3]};
            };
            SceneSetup setup{.name = "shape", .step = Seconds{1, steps_per_second}};
            setup.bodies = {top(real(about(moments)), real(about(spin)))};
            for (const char* method : {"pdmv4", "pdmv6", "pdmv8", "pdmv10"}) {
                const auto truth = build(setup, method, "f64");
                std::vector<Motion> motions{truth->motion(0)};
                for (int i = 0; i < 20; ++i) {
                    truth->run(steps_per_second / 4);
                    motions.push_back(truth->motion(0));
                }
                const auto world = build(setup, method, "q32_near");
                const Number error = orientation_error(*world, motions, steps_per_second / 4);
                worst = std::max(worst, error);
                EXPECT_LE(error, tolerance::pdmv_of_any_shape)
                    << method << ", moments " << moments.x << " " << moments.y << " " << moments.z << ", "
                    << steps_per_second << " Hz";
                EXPECT_TRUE(world->status().ok());
                if (method == std::string_view{"pdmv10"}) {
                    const auto exact = build(setup, "exact", "f64");
                    EXPECT_LE(orientation_error(*exact, motions, steps_per_second / 4), tolerance::pdmv10_of_any_shape)
                        << moments.x << " " << moments.y << " " << moments.z;
                }
            }
        }
    }
    std::printf("pdmv in q32 and in f64: %.2Lg rad apart at most\n", worst);
}

}  // namespace
}  // namespace tumble::test
