// How long a step a method takes on what springs, dampers and drag are made of, x'' = -k x - c x', before it adds to
// it. Every method says what a step of its own is there, and its limits follow from that, at compile time (E. Hairer,
// C. Lubich and G. Wanner, Geometric Numerical Integration, I.1 and VI; E. Hairer and G. Wanner, Solving Ordinary
// Differential Equations II, IV.2). Nothing of this is in a program that does not ask for it.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

// A linear map of place and velocity, both in metres: (x, v) becomes (xx x + xv v, vx x + vv v), v per step.
struct OscillatorStep {
    double xx = 1, xv = 0, vx = 0, vv = 1;

    [[nodiscard]] constexpr double determinant() const { return xx * vv - xv * vx; }
    [[nodiscard]] constexpr double trace() const { return xx + vv; }
    // True if no number of steps makes anything grow without bound: both eigenvalues lie in the unit circle (Jury). A
    // growth of less than 1e-12 in a step is rounding.
    [[nodiscard]] constexpr bool is_stable() const {
        constexpr double rounding = 1e-12;
        const double d = determinant(), t = trace() < 0 ? -trace() : trace();
        return -d <= 1 + rounding && d <= 1 + rounding && t <= 1 + d + rounding;
    }

    // The equation itself, whose step is in units of the method's: k = (h w)^2, c = h c / m.
    [[nodiscard]] static constexpr OscillatorStep of_equation(double k, double c) { return {0, 1, -k, -c}; }

    friend constexpr OscillatorStep operator+(const OscillatorStep& a, const OscillatorStep& b) {
        return {a.xx + b.xx, a.xv + b.xv, a.vx + b.vx, a.vv + b.vv};
    }
    friend constexpr OscillatorStep operator*(double s, const OscillatorStep& a) {
        return {s * a.xx, s * a.xv, s * a.vx, s * a.vv};
    }
    // b first.
    friend constexpr OscillatorStep operator*(const OscillatorStep& a, const OscillatorStep& b) {
        return {a.xx * b.xx + a.xv * b.vx, a.xx * b.xv + a.xv * b.vv, a.vx * b.xx + a.vv * b.vx,
                a.vx * b.xv + a.vv * b.vv};
    }
};

namespace detail {

// Up to where step_of(z) is stable for all z from 0 on; 0 where it is not for small z either. Beyond 64 it is taken to
// be stable for ever: no explicit method comes near that.
template <class StepOf>
[[nodiscard]] constexpr double end_of_stability(StepOf&& step_of) {
    constexpr int strides = 64, furthest = 64;
    int n = 1;
    while (n <= strides * furthest && step_of(static_cast<double>(n) / strides).is_stable()) ++n;
    if (n == 1) return 0;
    if (n > strides * furthest) return std::numeric_limits<double>::infinity();
    double stable = static_cast<double>(n - 1) / strides, unstable = static_cast<double>(n) / strides;
    for (int halving = 0; halving < 45; ++halving) {
        const double middle = (stable + unstable) / 2;
        (step_of(middle).is_stable() ? stable : unstable) = middle;
    }
    return stable;
}

}  // namespace detail

// What a method knows of its limits; Linear::step(k, c) is its step of x'' = -k x - c x', in units of the step.
template <class Linear>
struct Stability {
    static constexpr OscillatorStep oscillator_step(double k, double c) { return Linear::step(k, c); }

    // The largest h w with which an oscillation without damping does not grow, of a spring w^2 = k/m: 0 where it grows
    // at every step, infinity where it does at none.
    static constexpr double oscillation_limit =
        detail::end_of_stability([](double z) { return Linear::step(z * z, 0); });
    // The largest h c/m with which a velocity under drag does not grow.
    static constexpr double drag_limit = detail::end_of_stability([](double z) { return Linear::step(0, z); });
};

}  // namespace tumble
