// The peer: a free top integrated by Boost.Odeint in float or double, as its documentation shows, with a renormalised
// quaternion. The same source is timed on cores and measured for error on the host.
#pragma once

#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/modified_midpoint.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>

#include <array>
#include <cmath>

namespace tumble::bench {

// Orientation (w, x, y, z, body to world) and angular velocity (body axes, rad/s).
template <class T>
using TopState = std::array<T, 7>;

// Moments in kg m^2.
template <class T>
struct TopEquations {
    std::array<T, 3> moments;

    void operator()(const TopState<T>& s, TopState<T>& rate, T) const {
        const T half = T(0.5);
        const T w = s[0], x = s[1], y = s[2], z = s[3], a = s[4], b = s[5], c = s[6];
        rate[0] = -half * (x * a + y * b + z * c);
        rate[1] = half * (w * a + y * c - z * b);
        rate[2] = half * (w * b + z * a - x * c);
        rate[3] = half * (w * c + x * b - y * a);
        rate[4] = (moments[1] - moments[2]) / moments[0] * b * c;
        rate[5] = (moments[2] - moments[0]) / moments[1] * c * a;
        rate[6] = (moments[0] - moments[1]) / moments[2] * a * b;
    }
};

template <class T>
using OdeintEuler = boost::numeric::odeint::euler<TopState<T>, T, TopState<T>, T>;
template <class T>
using OdeintMidpoint = boost::numeric::odeint::modified_midpoint<TopState<T>, T, TopState<T>, T>;
template <class T>
using OdeintRk4 = boost::numeric::odeint::runge_kutta4<TopState<T>, T, TopState<T>, T>;

// One step and a renormalisation by one step of Newton's iteration.
template <template <class> class Stepper, class T>
class OdeintTop {
public:
    OdeintTop(std::array<T, 3> moments, std::array<T, 3> spin, T step)
        : equations_{moments}, state_{1, 0, 0, 0, spin[0], spin[1], spin[2]}, step_{step} {}

    void step() {
        stepper_.do_step(equations_, state_, T(0), step_);
        const T excess = state_[0] * state_[0] + state_[1] * state_[1] + state_[2] * state_[2] + state_[3] * state_[3];
        const T scale = T(1.5) - T(0.5) * excess;
        for (std::size_t i = 0; i < 4; ++i) state_[i] *= scale;
    }
    [[nodiscard]] const TopState<T>& state() const { return state_; }

private:
    TopEquations<T> equations_;
    TopState<T> state_;
    T step_;
    Stepper<T> stepper_;
};

}  // namespace tumble::bench
