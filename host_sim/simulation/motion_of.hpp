// States of the kernel in long double, SI units and the user's axes.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/body/mass.hpp>

#include <concepts>

#include "simulation/long_double.hpp"

namespace tumble::host {

// Value and residual of a carried number; floating point may be infinite or not a number.
template <class Carried>
requires requires { typename Carried::Value; }
[[nodiscard]] reference::Number number(const Carried& carried) {
    if constexpr (std::floating_point<typename Carried::Value>)
        return static_cast<reference::Number>(carried.value()) + static_cast<reference::Number>(carried.residual());
    else return number(carried.to_real());
}

struct PrincipalAxes {
    explicit PrincipalAxes(const PrincipalInertia& inertia)
        : moments{vector(inertia.moments)}, to_user{rotation(inertia.principal)} {}

    reference::Vector moments;    // kg m^2
    reference::Rotation to_user;  // principal axes to the user's
};

// rad/s, principal axes; zero of a point mass.
template <class N, Spin spin, int capacity, bool points>
[[nodiscard]] reference::Vector spin_of(const Bodies<N, spin, capacity, points>& bodies,
                                        [[maybe_unused]] const PrincipalAxes& axes, int body) {
    reference::Vector w;
    if (!bodies.rotates(body)) return w;
    if constexpr (spin != Spin::none) {
        const auto& turn = bodies.state[body].t_b;
        const reference::Number unit = number(bodies.spin_scale(body).angle(Real{1})),
                                step = number(bodies.step_length);
        for (int i = 0; i < 3; ++i) {
            w[i] = number(turn[i]) * unit * 2 / step;
            if constexpr (spin == Spin::angular_momentum) w[i] *= axes.moments.y / axes.moments[i];
        }
    }
    return w;
}

// The motion in SI units and the user's axes; a point mass has the world's axes.
template <class N, Spin spin, int capacity, bool points>
[[nodiscard]] reference::Motion motion_of(const Bodies<N, spin, capacity, points>& bodies, const PrincipalAxes& axes,
                                          int body) {
    const auto& state = bodies.state[body];
    const reference::Number unit = number(bodies.scale.metres(Real{1})), step = number(bodies.step_length);
    reference::Motion motion;
    for (int i = 0; i < 3; ++i) {
        motion.x[i] = number(state.x_w[i]);
        motion.v[i] = number(state.d_w[i]) * unit / step;
    }
    if (!bodies.rotates(body)) return motion;
    if constexpr (spin != Spin::none) {
        const auto& q = state.q_wb;
        motion.q = reference::Rotation{number(q.w), {number(q.x), number(q.y), number(q.z)}} * axes.to_user.conjugate();
        motion.w = axes.to_user.rotate(spin_of(bodies, axes, body));
    }
    return motion;
}

}  // namespace tumble::host
