// The longest step of a method that does not add energy to springs, dampers and drag: x'' = -k x - c x'. Each method
// gives its own step of this equation, and its limits follow from that at compile time (E. Hairer, C. Lubich and G.
// Wanner, Geometric Numerical Integration, I.1 and VI; E. Hairer and G. Wanner, Solving Ordinary Differential Equations
// II, IV.2). A program that does not use the limits contains none of this.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

// A linear map of position and velocity, both in metres: (x, v) becomes (xx x + xv v, vx x + vv v), with v in metres a
// step.
struct OscillatorStep {
    double xx = 1, xv = 0, vx = 0, vv = 1;

    [[nodiscard]] constexpr double determinant() const { return xx * vv - xv * vx; }
    [[nodiscard]] constexpr double trace() const { return xx + vv; }
    // True if repeated steps stay bounded: both eigenvalues lie in the unit circle (Jury). A growth of less than 1e-12
    // in a step counts as rounding.
    [[nodiscard]] constexpr bool is_stable() const {
        constexpr double rounding = 1e-12;
        const double d = determinant(), t = trace() < 0 ? -trace() : trace();
        return -d <= 1 + rounding && d <= 1 + rounding && t <= 1 + d + rounding;
    }

    // The equation itself, with time in steps: k = (h w)^2, c = h c / m.
    [[nodiscard]] static constexpr OscillatorStep of_equation(double k, double c) { return {0, 1, -k, -c}; }

    friend constexpr OscillatorStep operator+(const OscillatorStep& a, const OscillatorStep& b) {
        return {a.xx + b.xx, a.xv + b.xv, a.vx + b.vx, a.vv + b.vv};
    }
    friend constexpr OscillatorStep operator*(double s, const OscillatorStep& a) {
        return {s * a.xx, s * a.xv, s * a.vx, s * a.vv};
    }
    // The map b followed by the map a.
    friend constexpr OscillatorStep operator*(const OscillatorStep& a, const OscillatorStep& b) {
        return {a.xx * b.xx + a.xv * b.vx, a.xx * b.xv + a.xv * b.vv, a.vx * b.xx + a.vv * b.vx,
                a.vx * b.xv + a.vv * b.vv};
    }
};

namespace detail {

// The largest z up to which step_of is stable from 0 on. 0 if it is not stable for small z. Beyond 64 it counts as
// stable for every z: no explicit method comes near that.
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

// Bounds beyond which a step is surely too long. A spring and a damper have K = (h w)^2 and C = h c/m; a bound is
// exceeded if its of_spring K + of_damper C is above 1. A bound with two zeros is unused.
struct StepBounds {
    static constexpr int sums = 3;
    double of_spring[sums]{}, of_damper[sums]{};
};

namespace detail {

// The bounds of a method. For a method that adds to every oscillation, the bound is the K at which it adds a 512th of
// the amplitude in a step (a factor e in 512 steps), less the damping that undoes it. For other methods it is the limit
// of stability. The largest damping falls with K, rises with K (the slower of two motions) or does not depend on it.
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
        // For larger K, the growth that damping undoes is at most the tangent at K = 1.
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

// The limits of a method. Linear::step(k, c) is its step of x'' = -k x - c x', with time in steps.
template <class Linear>
struct Stability {
    static constexpr OscillatorStep oscillator_step(double k, double c) { return Linear::step(k, c); }

    // The largest h w with which an oscillation without damping does not grow, for a spring with w^2 = k/m. 0 if it
    // grows at every step, infinity if it grows at none.
    static constexpr double oscillation_limit =
        detail::end_of_stability([](double z) { return Linear::step(z * z, 0); });
    // The largest h c/m with which a velocity under drag does not grow.
    static constexpr double drag_limit = detail::end_of_stability([](double z) { return Linear::step(0, z); });
    // The bounds beyond which the world reports Issue::step_too_long.
    static constexpr StepBounds step_bounds = detail::step_bounds<Linear>(oscillation_limit, drag_limit);
};

}  // namespace tumble
