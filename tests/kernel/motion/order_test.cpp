// Order of accuracy of every integrator of the list: halving the step divides the error by 2 to the order.
#include "references.hpp"
#include "tolerances.hpp"

#include <cmath>
#include <functional>

namespace tumble::test {
namespace {

class Order : public testing::TestWithParam<Method> {
protected:
    static SceneSetup with_step(SceneSetup setup, int exponent) {
        setup.step = Seconds{Real::scaled(1, -exponent)};
        return setup;
    }
    // The error after `seconds` at two steps, and the ratio that follows from the order.
    static void expect_order(const SceneSetup& setup, int order, int seconds,
                             const std::function<Number(const Motion&)>& error) {
        const int n = tests::order_step_exponent(order);
        Number errors[2];
        for (int i = 0; i < 2; ++i) {
            const auto world = build(with_step(setup, n + i), GetParam().name, "f64");
            world->run(std::int64_t{seconds} << (n + i));
            ASSERT_TRUE(world->status().ok());
            errors[i] = error(world->motion(0));
        }
        if (std::max(errors[0], errors[1]) < tests::exactly) return;  // the method is exact for this load
        EXPECT_LE(std::abs(std::log2(errors[0] / errors[1]) - order), tolerance::order)
            << "errors " << errors[0] << " " << errors[1] << " at 2^-" << n << " s and half of it";
    }
};
INSTANTIATE_TEST_SUITE_P(every_integrator, Order, testing::ValuesIn(methods()), NameOf{});

TEST_P(Order, halving_the_step_divides_the_error_of_an_oscillator_by_2_to_the_order) {
    // x'' = -4 x from (1, 0, 0) with velocity (0, 1, 0): an ellipse.
    SceneSetup setup{.name = "oscillator", .bodies = {top({1, 1, 1}, {}, 0.5, {1, 0, 0}, {0, 1, 0})}};
    setup.springs = {{.stiffness = 2}};
    expect_order(setup, GetParam().order, 2, [](const Motion& m) {
        const Vector x{std::cos(Number(4)), std::sin(Number(4)) / 2, 0};
        const Vector v{-2 * std::sin(Number(4)), std::cos(Number(4)), 0};
        return norm(m.x - x) + norm(m.v - v);
    });
}

TEST_P(Order, halving_the_step_divides_the_error_of_a_dragged_projectile_by_2_to_the_order) {
    // With angular drag beside the linear one, no method has a closed form.
    SceneSetup setup{.name = "projectile", .bodies = {top({1, 1, 1}, {}, 1, {}, {10, 10, 0})}};
    setup.world = {.gravity = {0, -9.8125, 0}, .linear_drag = 0.5, .angular_drag = 0.25};
    expect_order(setup, GetParam().order, 2, [](const Motion& m) {
        const Number c = 0.5L, g = 9.8125L, t = 2, e = std::exp(-c * t);
        const Vector x{10 * (1 - e) / c, (10 + g / c) * (1 - e) / c - g * t / c, 0};
        return norm(m.x - x) + norm(m.v - Vector{10 * e, (10 + g / c) * e - g / c, 0});
    });
}

TEST_P(Order, halving_the_step_divides_the_error_of_a_free_top_by_2_to_the_order) {
    SceneSetup setup{.name = "top", .bodies = {top({1, 2, 3}, {0.5, 1, 0.7})}};
    const Motion end =
        reference::free_trajectory(reference_body(setup.bodies[0]), start_of(setup.bodies[0]), {2}).back();
    expect_order(setup, GetParam().free_order, 2, [&](const Motion& m) { return angle_between(m.q, end.q); });
    expect_order(setup, GetParam().free_order, 2, [&](const Motion& m) { return norm(m.w - end.w); });
}

TEST_P(Order, halving_the_step_divides_the_error_of_a_body_on_a_spring_with_drag_by_2_to_the_order) {
    // Force and torque depend on position, orientation, velocity and spin at once.
    const BodySpec body = top({1, 2, 3}, {0.5, 1, 0.7}, 2, {0.5, -0.25, 0});
    SceneSetup setup{.name = "body_on_a_spring", .bodies = {body}};
    setup.world = {.gravity = {0, -1, 0}, .linear_drag = 0.125, .angular_drag = 0.25};
    setup.springs = {
        {.point = {0.5, 0.25, -0.5}, .to = {0, 1, 0}, .stiffness = 3, .damping = 0.25, .rest_length = 0.5}};
    const Motion end = reference::trajectory(reference_body(body), start_of(body), {2}, reference_load(setup)).back();
    expect_order(setup, GetParam().order, 2, [&](const Motion& m) { return norm(m.x - end.x) + norm(m.v - end.v); });
    expect_order(setup, GetParam().order, 2,
                 [&](const Motion& m) { return angle_between(m.q, end.q) + norm(m.w - end.w); });
}

TEST_P(Order, uniform_gravity_moves_the_centre_of_mass_exactly_from_order_two_on) {
    if (GetParam().order < 2) GTEST_SKIP() << "order 1";
    SceneSetup setup{.name = "fall", .step = Seconds{1, 4}, .bodies = {top({1, 2, 3}, {1, 1, 1}, 1, {}, {1, 2, 3})}};
    setup.world.gravity = {1, -10, 0.5};
    const auto world = build(setup, GetParam().name, "f64");
    world->run(16);
    EXPECT_LE(norm(world->motion(0).x - Vector{12, -72, 16}), tolerance::rounding_of_a_fall);
    EXPECT_LE(norm(world->motion(0).v - Vector{5, -38, 5}), tolerance::rounding_of_a_fall);
}

}  // namespace
}  // namespace tumble::test
