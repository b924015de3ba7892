// Float<T, carry>: the number systems of float and double, IEEE 754 arithmetic without contraction. A number carries a
// power of two of its own, so formats, blocks and scales are plain numbers here; the functions are those of q32.hpp
// and q32_block.hpp.
#pragma once

#include <tumble/numbers/carried.hpp>
#include <tumble/numbers/dither.hpp>
#include <tumble/numbers/functions.hpp>

namespace tumble {

// IEEE 754 arithmetic without contraction. Units are plain: turns in rad, drift in metres, so Scale is empty.
template <class T, bool with_carry>
struct Float {
    static constexpr const char* name = sizeof(T) == 4 ? "f32" : "f64";
    static constexpr bool carry = with_carry;
    static constexpr bool fixed_point = false;

    using Position = T;
    using Drift = T;
    using Turn = T;
    using Angle = T;
    using Unit = T;
    using Coefficient = T;
    template <int>
    using CoefficientOf = T;
    using TurnProduct = T;
    using AngleSum = T;
    using PositionSum = T;
    using DriftSum = T;
    using TurnSum = T;
    using Work = T;
    template <class V>
    using Integrated = Carried<V, carry>;
    using IntegratedUnit = Carried<T, carry, true>;

    struct Scale {
        [[nodiscard]] static constexpr Scale of(Real, Real) { return {}; }
        [[nodiscard]] constexpr Real drift_units(Real metres) const { return metres; }
        [[nodiscard]] constexpr Real turn_units(Real angle) const { return angle; }
        [[nodiscard]] constexpr Real metres(Real drift) const { return drift; }
        [[nodiscard]] constexpr Real angle(Real turn) const { return turn; }
    };

    // Floating point carries a power of two with every number.
    struct Block {
        [[nodiscard]] TUMBLE_INLINE static constexpr Block of(T, T, T, int, int, Scale) { return {}; }
        [[nodiscard]] static constexpr int most_up(Scale, int) { return 0; }
        [[nodiscard]] static constexpr bool is_out_of_range() { return false; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T turn(T t, Dither, int = 0) { return t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T down(T t, int) { return t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T turn(T p) { return p; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T turn_up(T p, int) { return p; }
        TUMBLE_INLINE static constexpr void lower(auto& state, T p) { state.add(-p); }
        [[nodiscard]] TUMBLE_INLINE static constexpr T square(T p) { return p; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T half_angle(T t) { return t * T(0.5); }
        [[nodiscard]] TUMBLE_INLINE static constexpr T half_angle(T t, Dither) { return t * T(0.5); }
        [[nodiscard]] TUMBLE_INLINE static constexpr T half_square(T t, Dither) { return t * t * T(0.5); }
        // Kept less one: 1 + c would lose c's digits.
        [[nodiscard]] TUMBLE_INLINE static constexpr T angle_per_turn(T c, Dither) { return c; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T times_cosine(T factor, T c, std::uint32_t) {
            return factor + c + factor * c;
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr T angle(T t, T factor) { return t + t * factor; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T add_angle(T sum, T t, T factor) {
            return sum + (t + t * factor);
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr T widen(T a, std::uint32_t) { return a; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T stretched(T t, T c, std::uint32_t) { return t + t * c; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T share(T c, T t, Dither) { return c * t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T twice_share(T c, T t, Dither) { return T(2) * c * t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr bool vanishes_times_itself(const auto& change, const auto& c) {
            return is_rounding(change, c);
        }
        [[nodiscard]] TUMBLE_INLINE static constexpr T twice(T c, T t, Dither) { return T(2) * c * t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T times(T c, T t) { return c * t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T rest(T a, T d, T p, T j, T c, int) { return a - j * c + d * p; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T whole_angle(T t, Dither) { return t; }
    };

    template <class V>
    [[nodiscard]] static constexpr V constant(Real value) {
        return from_real<V>(value);
    }

    [[nodiscard]] static constexpr T sum(const Integrated<T>& x) { return x.value(); }
    [[nodiscard]] static constexpr T metres(T x) { return x; }
    [[nodiscard]] static constexpr T metres(T d, Scale) { return d; }
    [[nodiscard]] static constexpr T half_turn(T t, Scale) { return t; }
    [[nodiscard]] static constexpr T turn_product(T p, Scale) { return p; }
    [[nodiscard]] static constexpr T work(T u) { return u; }
    [[nodiscard]] static constexpr T position_sum(T metres) { return metres; }
    [[nodiscard]] static constexpr T drift_sum(T metres, Scale) { return metres; }
    [[nodiscard]] static constexpr T turn_sum(T half_turn, Scale) { return half_turn; }

    [[nodiscard]] static constexpr bool is_rounding(const auto& correction, const auto& t) {
        const T size = magnitude(t[0]) + magnitude(t[1]) + magnitude(t[2]);
        return magnitude(correction[0]) + magnitude(correction[1]) + magnitude(correction[2]) <= size * rounding_unit();
    }
    [[nodiscard]] static constexpr T rounding_unit() { return sizeof(T) == 4 ? T(0x1p-21) : T(0x1p-48); }
    [[nodiscard]] static constexpr T magnitude(T a) { return a < T(0) ? -a : a; }

    [[nodiscard]] static constexpr T half_of(T w) { return w * T(0.5); }
    [[nodiscard]] static constexpr T times_power_of_two(T w, int) {
        return w;
    }  // formats that shift are of fixed point
    template <int>
    [[nodiscard]] static constexpr T factor(T w) {
        return w;
    }

    using Fraction = T;
    [[nodiscard]] static constexpr T fraction(T w) { return w; }
    [[nodiscard]] static constexpr T part(T a, T f) { return a * f; }

    using AlongSum = T;
    [[nodiscard]] static constexpr T metres_along(T x) { return x; }
    [[nodiscard]] static constexpr T along(const T (&x)[3], const auto& n) {
        return x[0] * n[0] + x[1] * n[1] + x[2] * n[2];
    }

    // True if a number is not finite: zero times a finite sum is zero; infinities and NaN give NaN. Drift and spin need
    // not be looked at: the position and every component of the orientation take them over within a step.
    template <class Body>
    [[nodiscard]] TUMBLE_INLINE static constexpr bool out_of_range(const Body& b) {
        const T sum = (b.x_w.x.value() + b.x_w.y.value() + b.x_w.z.value()) + b.q_wb.w.value();
        return !(sum * T(0) == T(0));
    }
    static constexpr void leave_range(auto&) {}
    template <class Body>
    static constexpr void saturate(Body&) {}

    [[nodiscard]] static constexpr T fall(Real metres) { return constant<T>(metres); }
    TUMBLE_INLINE static constexpr void add_any(auto& number, T change, Scale) { number.add(change); }
    [[nodiscard]] TUMBLE_INLINE static constexpr T limited(T kick, bool&) { return kick; }
    TUMBLE_INLINE static constexpr void move(Integrated<T>& x, T drift, Scale) { x.add(drift); }
    [[nodiscard]] TUMBLE_INLINE static constexpr T half(T sum) { return sum * T(0.5); }
    TUMBLE_INLINE static constexpr void coast(Integrated<T>& x, const Integrated<T>& d, T extra, Scale) {
        if constexpr (carry) x.add(d.residual());
        x.add(d.value() + extra);
    }
    [[nodiscard]] static constexpr T displaced(T x, T d, Scale) { return x + d; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T narrow_turn(T t) { return t; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T half_angle(T a) { return a * T(0.5); }
    [[nodiscard]] TUMBLE_INLINE static constexpr T mul_sum(T t, T c) { return t * c; }
    TUMBLE_INLINE static constexpr void add(Integrated<T>& d, T increment) { d.add(increment); }

    [[nodiscard]] TUMBLE_INLINE static constexpr T angle(T t, Scale, Dither) { return t; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T round_angle(T a, Dither) { return a; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T stage_turn(T c, T p, Scale) { return c * p; }
    TUMBLE_INLINE static constexpr void add_turn(Integrated<T>& t, T c, T p, Scale) { t.add(c * p); }
};

}  // namespace tumble
