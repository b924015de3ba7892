// What cases of joints share, in worlds with the features that a case needs.
#pragma once

#include <tumble/tumble.hpp>

#include "kinds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tumble::test {

namespace joint_cases {
inline constexpr double g = 9.81;  // m/s^2
// In the quick set all cases share a world, which takes ten seconds to compile. In the deep set a world has the
// features of its case alone.
inline constexpr Features shared{.bodies = 6,
                                 .springs = 1,
                                 .joints = 6,
                                 .distances = true,
                                 .joint_springs = true,
                                 .joint_limits = true,
                                 .joint_breaks = true,
                                 .control = true,
                                 .script = true,
                                 .recording = true,
                                 .removal = true,
                                 .snapshots = true};
#ifdef TUMBLE_EVERY_KIND
template <Features own>
inline constexpr Features features_of = own;
#else
template <Features own>
inline constexpr Features features_of = shared;
#endif
// s: of a pendulum that is let go at the angle a, 2 pi / agm(1, cos(a / 2)) times the root of I / (m g d).
[[nodiscard]] inline double pendulum_period(double angle, double inertia, double moment) {
    double a = 1, b = std::cos(angle / 2);
    for (int i = 0; i < 8; ++i) {
        const double mean = (a + b) / 2;
        b = std::sqrt(a * b);
        a = mean;
    }
    return 2 * std::numbers::pi * std::sqrt(inertia / moment) / a;
}

// In doubles, in axes of the world.
[[nodiscard]] inline double length(const Vector3<double>& x) { return std::sqrt(dot(x, x)); }
[[nodiscard]] Vector3<double> place(const auto& world, BodyId id) {
    const auto& x = world.state(id).x_w;
    return {x.x.to_real().to_double(), x.y.to_real().to_double(), x.z.to_real().to_double()};
}
[[nodiscard]] Vector3<double> velocity(const auto& world, BodyId id) {
    return world.velocity(id).template as<double>();
}
[[nodiscard]] Vector3<double> spin(const auto& world, BodyId id) {
    return rotate(world.orientation(id).template as<double>(), world.angular_velocity(id).template as<double>());
}
// N s, and N m s about the origin, of all bodies.
[[nodiscard]] std::array<Vector3<double>, 2> momenta(const auto& world) {
    Vector3<double> p{}, l{};
    for (int b = 0; b < world.body_count(); ++b) {
        const BodyId id{b};
        const auto of_body = velocity(world, id) * static_cast<double>(world.mass(id));
        const Vector3<double> w = world.angular_velocity(id).template as<double>();
        const InertiaTensor i = world.inertia(id);
        const Vector3<double> of_spin{i.xx.to_double() * w.x + i.xy.to_double() * w.y + i.xz.to_double() * w.z,
                                      i.xy.to_double() * w.x + i.yy.to_double() * w.y + i.yz.to_double() * w.z,
                                      i.xz.to_double() * w.x + i.yz.to_double() * w.y + i.zz.to_double() * w.z};
        p += of_body;
        l += cross(place(world, id), of_body) + rotate(world.orientation(id).template as<double>(), of_spin);
    }
    return {p, l};
}
// J, of all bodies.
[[nodiscard]] double energy(const auto& world) {
    double sum = 0;
    for (int b = 0; b < world.body_count(); ++b)
        sum += static_cast<double>(world.kinetic_energy(BodyId{b})) +
               static_cast<double>(world.potential_energy(BodyId{b}));
    return sum;
}

// The mean energies in `window` steps, and in as many after `between` steps.
[[nodiscard]] std::array<double, 2> mean_energies(auto& world, const auto& energy, int window, int between) {
    const auto mean = [&] {
        double sum = 0;
        for (int i = 0; i < window; ++i) {
            (void)world.step();
            sum += energy();
        }
        return sum / window;
    };
    const double first = mean();
    for (int i = 0; i < between; ++i) (void)world.step();
    return {first, mean()};
}
// In so many steps, after each of which `check` is called with its number.
struct EnergyChange {
    double rise;  // J, the largest above the least energy before
    double fall;  // J, from the start to the least energy
};
[[nodiscard]] EnergyChange energy_change(auto& world, int steps, const auto& check) {
    const double start = energy(world);
    double least = start, rise = 0;
    for (int step = 0; step < steps; ++step) {
        (void)world.step();
        const double now = energy(world);
        rise = std::max(rise, now - least);
        least = std::min(least, now);
        check(step);
    }
    return {rise, start - least};
}
}  // namespace joint_cases

// The kinds of worlds of these cases; `More` those of the deep set besides.
template <class... More>
using JointKinds = Tested<testing::Types<Kind<Q32<>, integrators::Verlet>, Kind<F64, integrators::Verlet>>,
                          testing::Types<Kind<F32, integrators::Verlet>, Kind<F64, integrators::Suzuki4>, More...>>;

template <class W, Features features>
class JointCases : public testing::Test {
protected:
    using N = typename W::Numbers;
    using World = tumble::World<SceneOf<N, typename W::Integrator, joint_cases::features_of<features>>>;
    static constexpr bool is_single = !N::fixed_point && sizeof(typename N::Unit) == 4;
    static constexpr int order = W::Integrator::order;

    [[nodiscard]] static World falling(Seconds step = {1, 256}) {
        return World{step, {.gravity = {0, -joint_cases::g, 0}}};
    }
    [[nodiscard]] static World floating(Seconds step = {1, 256}) { return World{step, {}}; }
    static void run(World& world, int steps) {
        for (int i = 0; i < steps; ++i) (void)world.step();
    }
    [[nodiscard]] static auto joint(const World& world, int j = 0) { return world.template joint<double>(JointId{j}); }
};

}  // namespace tumble::test
