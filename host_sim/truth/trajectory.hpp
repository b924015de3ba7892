// The reference for the accuracy of methods: equations of motion in long double, integrated by Boost.Odeint's
// Runge-Kutta-Fehlberg 7(8). Its error is far below that of any kernel method. It includes nothing of the kernel; the
// command, tests and benchmarks use it.
#pragma once

#include "truth/motion.hpp"

// Odeint copies its steppers' scratch arrays before their first use.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>
#pragma GCC diagnostic pop

#include <array>
#include <stdexcept>
#include <vector>

#include "tools/raise.hpp"

namespace tumble::reference {

inline constexpr long most_steps = 10'000'000;

// Advances a state (an array or a vector of Number) from one time to another, s. equations(state, rate, time) sets the
// rate, which must be smooth between the two times. Throws std::runtime_error where the motion is singular (bodies that
// fall into each other) or takes more than most_steps.
template <class State, class Equations>
void integrate(const Equations& equations, State& state, Number from, Number to, Number most_error = tolerance) {
    namespace odeint = boost::numeric::odeint;
    if (!(to > from)) return;
    using Stepper = odeint::runge_kutta_fehlberg78<State, Number, State, Number>;
    long steps = 0;
    const auto watch = [&](const State& now, Number) {
        bool finite = true;
        for (const Number x : now) finite = finite && std::isfinite(x);
        if (!finite || ++steps > most_steps) host::raise(std::runtime_error("the motion is singular or too stiff"));
    };
    odeint::integrate_adaptive(odeint::make_controlled<Stepper>(most_error, most_error), equations, state, from, to,
                               Number(1) / 256, watch);
}

namespace detail {

using Packed = std::array<Number, 13>;

inline Packed pack(const Motion& m) {
    return {m.x.x, m.x.y, m.x.z, m.v.x, m.v.y, m.v.z, m.q.w, m.q.v.x, m.q.v.y, m.q.v.z, m.w.x, m.w.y, m.w.z};
}
inline Motion unpack(const Packed& p) {
    return {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], {p[7], p[8], p[9]}}, {p[10], p[11], p[12]}};
}

}  // namespace detail

// The motion of one body at each of the times (s, ascending, from 0), under load(motion, time) -> Wrench.
template <class Load>
[[nodiscard]] std::vector<Motion> trajectory(const Body& body, const Motion& start, const std::vector<Number>& at,
                                             Load&& load) {
    const auto equations = [&](const detail::Packed& state, detail::Packed& rate, Number t) {
        const Motion m = detail::unpack(state);
        const Wrench wrench = load(m, t);
        const Vector gyroscopic = cross(m.w, times(body.moments, m.w));
        rate = detail::pack({m.v, wrench.force_w * (1 / body.mass), m.q * Rotation{0, m.w} * Number(0.5),
                             over(wrench.torque_b - gyroscopic, body.moments)});
    };
    detail::Packed state = detail::pack(start);
    std::vector<Motion> motions;
    Number now = 0;
    for (const Number until : at) {
        integrate(equations, state, now, until);
        now = until;
        motions.push_back(detail::unpack(state));
    }
    return motions;
}

// The same without loads.
[[nodiscard]] inline std::vector<Motion> free_trajectory(const Body& body, const Motion& start,
                                                         const std::vector<Number>& times) {
    return trajectory(body, start, times, [](const Motion&, Number) { return Wrench{}; });
}

// The times 0, interval, 2 interval, ... up to and including the end.
[[nodiscard]] inline std::vector<Number> sample_times(Number interval, int count) {
    std::vector<Number> times;
    for (int i = 0; i <= count; ++i) times.push_back(interval * static_cast<Number>(i));
    return times;
}

}  // namespace tumble::reference
