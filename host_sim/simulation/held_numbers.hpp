// Finds the number of a body's state that has reached the limit of its number system. Included only by worlds.
#pragma once

#include <tumble/body/bodies.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "simulation/motion_of.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

// The spin about principal axis i, rad/s, of a half turn in a step, rad.
template <class N, Spin spin, int capacity, bool points>
[[nodiscard]] double spin_of_half_turn(const Bodies<N, spin, capacity, points>& bodies, const PrincipalAxes& axes,
                                       double half_turn, int i) {
    const double rate = 2 * half_turn / static_cast<double>(host::number(bodies.step_length));
    if constexpr (spin == Spin::angular_momentum) return rate * static_cast<double>(axes.moments.y / axes.moments[i]);
    else return rate;
}

// A body with the powers of two for which the method's rotation leaves room about its third axis.
struct HeldBody {
    int index;
    const PrincipalAxes& axes;
    int z_room;

    [[nodiscard]] int room(int axis) const { return axis == 2 ? z_room : 0; }
};

// rad/s about principal axis i, in a scale of spins; infinite in floating point.
template <class N, Spin spin, int capacity, bool points>
[[nodiscard]] double held_spin(const Bodies<N, spin, capacity, points>& bodies, const HeldBody& body, int i,
                               typename N::Scale scale) {
    if constexpr (spin != Spin::none && N::fixed_point) {
        if (bodies.rotates(body.index))
            return spin_of_half_turn(
                bodies, body.axes,
                std::ldexp(static_cast<double>(host::number(scale.angle(N::largest_turn))), -body.room(i)), i);
    }
    return std::numeric_limits<double>::infinity();
}
// The same in the shortest parts of a step.
template <class N, Spin spin, int capacity, bool points>
[[nodiscard]] double held_spin(const Bodies<N, spin, capacity, points>& bodies, const HeldBody& body, int i) {
    if constexpr (N::fixed_point) return held_spin(bodies, body, i, bodies.scale.halved(bodies.scale.most_halvings));
    else return held_spin(bodies, body, i, bodies.scale);
}

// The number at its limit, of a body that has just left the range. None if a number is not finite.
template <class N, Spin spin, int capacity, bool points>
[[nodiscard]] std::optional<HeldNumber> number_at_limit(const Bodies<N, spin, capacity, points>& bodies,
                                                        const HeldBody& body) {
    const int b = body.index;
    [[maybe_unused]] const PrincipalAxes& axes = body.axes;
    const auto& state = bodies.state[b];
    if constexpr (N::fixed_point) {
        const auto is_at = [](std::int64_t limit, const auto& component) {
            const std::int64_t raw = component.sum().raw;
            return raw >= limit || raw <= -limit;
        };
        const auto is_at_limit = [&](const auto& component) { return is_at((std::int64_t{1} << 62) - 1, component); };
        const double velocity =
            static_cast<double>(host::number(bodies.scale.metres(N::largest_drift) / bodies.step_length));
        for (int i = 0; i < 3; ++i) {
            if (is_at_limit(state.x_w[i])) return HeldNumber{"position", N::Range::position, "m"};
            if (is_at_limit(state.d_w[i])) return HeldNumber{"velocity", velocity, "m/s"};
            if constexpr (spin != Spin::none)
                if (bodies.rotates(b) && (is_at_limit(state.t_b[i]) ||
                                          (i == 2 && is_at(N::largest_turn_with_room(body.z_room).raw, state.t_b.z))))
                    return HeldNumber{"angular velocity", held_spin(bodies, body, i), "rad/s"};
        }
        // A load's change in a step is held within a quarter of the range.
        double spin_change = 0;
        if constexpr (spin != Spin::none) {
            const HeldBody momentum{b, axes, 0};
            if (bodies.rotates(b))
                spin_change = std::min({held_spin(bodies, momentum, 0, bodies.scale),
                                        held_spin(bodies, momentum, 1, bodies.scale),
                                        held_spin(bodies, momentum, 2, bodies.scale)}) /
                              4;
        }
        return HeldNumber{"change of velocity in a step", velocity / 4, "m/s", false, spin_change};
    } else {
        if constexpr (spin != Spin::none) {
            if (!bodies.rotates(b)) return {};
            const reference::Motion motion = host::motion_of(bodies, axes, b);
            if (!std::isfinite(norm(motion.x)) || !std::isfinite(norm(motion.v)) || !std::isfinite(norm(motion.w)))
                return {};
            // As in Advance::check_range, which limits the momentum over the middle moment where the method keeps that.
            constexpr bool of_momentum = spin == Spin::angular_momentum;
            const double most_turn = of_momentum ? 1.5 : 0.5;  // rad, half of the turn in a step
            const reference::Vector w = spin_of(bodies, axes, b),
                                    limited = of_momentum ? times(axes.moments, w) * (1 / axes.moments.y) : w;
            const double share = std::min(1.0, static_cast<double>(norm(w) / norm(limited)));
            return HeldNumber{"angular velocity",
                              share * 2 * most_turn / static_cast<double>(host::number(bodies.step_length)), "rad/s"};
        }
        return {};
    }
}

}  // namespace tumble::host
