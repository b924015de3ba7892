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

// What a step is surely too long for: a spring and a damper with K = (h w)^2 and C = h c/m where one of the sums
// of_spring K + of_damper C is above 1. None where both numbers are 0.
struct StepBounds {
    static constexpr int sums = 3;
    double of_spring[sums]{}, of_damper[sums]{};
};

namespace detail {

// Of a method that adds to every oscillation, the K at which it adds a 512th in a step, an e-fold in 512; damping
// undoes as much. Others have their limit. The most of damping falls with K, rises with it (the slower of two motions)
// or neither.
template <class Linear>
[[nodiscard]] constexpr StepBounds step_bounds(double oscillation_limit, double drag_limit) {
    constexpr double infinite = std::numeric_limits<double>::infinity(), growth = 1.0 / 256;
    StepBounds bounds;
    if (oscillation_limit == infinite || drag_limit == infinite) return bounds;
    double most = oscillation_limit * oscillation_limit;
    if (oscillation_limit == 0) {
        double little = 0;
        most = 16;
        for (int halving = 0; halving < 45; ++halving) {
            const double middle = (little + most) / 2;
            (Linear::step(middle, 0).determinant() > 1 + growth ? most : little) = middle;
        }
        bounds.of_damper[0] = -1 / growth;
        // Faster than that, damping undoes no more than the tangent at K = 1 of what it undoes.
        const auto undone = [](double k) {
            double less = 0, more = 1;
            for (int halving = 0; halving < 45; ++halving) {
                const double middle = (less + more) / 2;
                (Linear::step(k, middle).determinant() > 1 ? less : more) = middle;
            }
            return more;
        };
        const double at_one = undone(1), slope = (undone(1.0 + 1.0 / 64) - at_one) * 64;
        if (slope - at_one > growth) {
            bounds.of_spring[2] = slope / (slope - at_one);
            bounds.of_damper[2] = -1 / (slope - at_one);
        }
    }
    bounds.of_spring[0] = 1 / most;
    bounds.of_damper[1] = 1 / drag_limit;
    if (oscillation_limit == 0 || Linear::step(most / 2, drag_limit * 1.25).is_stable()) {
        bounds.of_spring[1] = -1 / (drag_limit * drag_limit);
    } else if (!Linear::step(most / 2, drag_limit * 0.75).is_stable()) {
        bounds.of_damper[0] = 1 / drag_limit;
        bounds.of_spring[1] = 1 / most;
    }
    return bounds;
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
    // What the world reports as Issue::step_too_long.
    static constexpr StepBounds step_bounds = detail::step_bounds<Linear>(oscillation_limit, drag_limit);
};

}  // namespace tumble
