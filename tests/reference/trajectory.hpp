// The reference that accuracy is measured against: the equations of motion of one rigid body in long double, integrated
// by Boost.Odeint's Runge-Kutta-Fehlberg 7(8) with error control far below anything a kernel method can reach. Nothing
// here includes the kernel, so tests and benchmarks share it.
#pragma once

#include "motion.hpp"

// Odeint copies its steppers' scratch arrays before their first use.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#include <boost/numeric/odeint.hpp>
#pragma GCC diagnostic pop

#include <array>
#include <vector>

namespace tumble::reference {

inline constexpr Number tolerance = 1e-17L;  // of each step, absolute and relative

namespace detail {

using Packed = std::array<Number, 13>;

inline Packed pack(const Motion& m) {
    return {m.x.x, m.x.y, m.x.z, m.v.x, m.v.y, m.v.z, m.q.w, m.q.v.x, m.q.v.y, m.q.v.z, m.w.x, m.w.y, m.w.z};
}
inline Motion unpack(const Packed& p) {
    return {{p[0], p[1], p[2]}, {p[3], p[4], p[5]}, {p[6], {p[7], p[8], p[9]}}, {p[10], p[11], p[12]}};
}

}  // namespace detail

// The motion at each of the times (s, ascending, from 0), under load(motion, time) -> Wrench.
template <class Load>
[[nodiscard]] std::vector<Motion> trajectory(const Body& body, const Motion& start, const std::vector<Number>& at,
                                             Load&& load) {
    namespace odeint = boost::numeric::odeint;
    const auto equations = [&](const detail::Packed& state, detail::Packed& rate, Number t) {
        const Motion m = detail::unpack(state);
        const Wrench wrench = load(m, t);
        const Vector gyroscopic = cross(m.w, times(body.moments, m.w));
        rate = detail::pack({m.v, wrench.force_w * (1 / body.mass), m.q * Rotation{0, m.w} * Number(0.5),
                             over(wrench.torque_b - gyroscopic, body.moments)});
    };
    using Stepper = odeint::runge_kutta_fehlberg78<detail::Packed, Number, detail::Packed, Number>;
    const auto stepper = odeint::make_controlled<Stepper>(tolerance, tolerance);
    detail::Packed state = detail::pack(start);
    std::vector<Motion> motions;
    Number now = 0;
    for (const Number until : at) {
        if (until > now) odeint::integrate_adaptive(stepper, equations, state, now, until, Number(1) / 256);
        now = until;
        motions.push_back(detail::unpack(state));
    }
    return motions;
}

// Without loads.
[[nodiscard]] inline std::vector<Motion> free_trajectory(const Body& body, const Motion& start,
                                                         const std::vector<Number>& times) {
    return trajectory(body, start, times, [](const Motion&, Number) { return Wrench{}; });
}

// 0, interval, 2 interval, ... up to and including the end.
[[nodiscard]] inline std::vector<Number> sample_times(Number interval, int count) {
    std::vector<Number> times;
    for (int i = 0; i <= count; ++i) times.push_back(interval * static_cast<Number>(i));
    return times;
}

}  // namespace tumble::reference
