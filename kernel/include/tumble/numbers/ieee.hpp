// Float<T, carry>: the number systems of float and double, in IEEE 754 arithmetic without contraction. Floating point
// needs no scales, so formats, blocks and scales are plain numbers here. The functions are those of q32.hpp,
// q32_block.hpp and q32_contact.hpp.
#pragma once

#include <tumble/numbers/carried.hpp>
#include <tumble/numbers/dither.hpp>
#include <tumble/numbers/functions.hpp>
#include <tumble/numbers/vectors.hpp>

namespace tumble {

// IEEE 754 arithmetic without contraction. Turns are in rad and drifts in metres, so Scale is empty.
template <class T, bool with_carry>
struct Float {
    static constexpr const char* name = sizeof(T) == 4 ? "f32" : "f64";
    static constexpr const char* what = sizeof(T) == 4 ? "IEEE 754 single precision" : "IEEE 754 double precision";
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

    // A block of turns. Every floating-point number has its own exponent, so these functions are plain arithmetic.
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
        // The result is less one: 1 + c would lose digits of c.
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
        [[nodiscard]] TUMBLE_INLINE static constexpr T angle(T a, T b, std::uint32_t) { return a * b; }
        [[nodiscard]] TUMBLE_INLINE static constexpr T twice_share(T c, T t, Dither) { return T(2) * c * t; }
        [[nodiscard]] TUMBLE_INLINE static constexpr bool holds_twice(T, int) { return true; }
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
    [[nodiscard]] static constexpr T apart(T to, T from) { return to - from; }
    [[nodiscard]] static constexpr T metres(T d, Scale) { return d; }
    [[nodiscard]] static constexpr T half_turn(T t, Scale) { return t; }
    [[nodiscard]] static constexpr T turn_product(T p, Scale) { return p; }
    [[nodiscard]] static constexpr T work(T u) { return u; }
    [[nodiscard]] static constexpr T position_sum(T metres) { return metres; }
    [[nodiscard]] static constexpr T unit_sum(T u) { return u; }
    [[nodiscard]] static constexpr T drift_sum(T metres, Scale) { return metres; }
    [[nodiscard]] static constexpr T turn_sum(T half_turn, Scale) { return half_turn; }

    // Not where both have run away to infinity.
    [[nodiscard]] static constexpr bool is_rounding(const auto& correction, const auto& t) {
        const T size = magnitude(t[0]) + magnitude(t[1]) + magnitude(t[2]);
        return magnitude(correction[0]) + magnitude(correction[1]) + magnitude(correction[2]) <=
                   size * rounding_unit() &&
               size <= std::numeric_limits<T>::max();
    }
    [[nodiscard]] static constexpr T rounding_unit() { return sizeof(T) == 4 ? T(0x1p-21) : T(0x1p-48); }
    [[nodiscard]] static constexpr T magnitude(T a) { return a < T(0) ? -a : a; }

    [[nodiscard]] static constexpr T half_of(T w) { return w * T(0.5); }
    // Only the formats of fixed point shift.
    [[nodiscard]] static constexpr T times_power_of_two(T w, int) { return w; }
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

    // True if a number is not finite, if |q|^2 is off 1 by more than 2^-9, or if the half turn of a step is longer than
    // `most_turn`, rad (0: no limit). The first-order renormalisation of |q|^2 fails for turns from 1 rad (Euler's
    // methods) up to half a turn, depending on the method. The sum less itself is zero for finite sums and NaN for
    // infinities and NaN, which fails every comparison.
    template <class Body>
    [[nodiscard]] TUMBLE_INLINE static constexpr bool out_of_range(const Body& b, double most_turn) {
        constexpr T most_excess = T(0x1p-9);
        T sum = three(b.x_w) + three(b.d_w), excess = 0;
        if constexpr (requires { b.q_wb; }) {
            const T w = b.q_wb.w.value();
            excess = absolute(w * w + square_of(b.q_wb) - T(1));
            if (most_turn > 0) {
                excess += square_of(b.t_b) * T(0x1p-9 / (most_turn * most_turn));
            } else {
                sum += three(b.t_b);
            }
        }
        return !(excess + (sum - sum) <= most_excess);
    }
    // True of a positive number that has all its digits, and a finite inverse. A smaller one has neither.
    [[nodiscard]] TUMBLE_INLINE static constexpr bool is_divisor(T a) { return a >= std::numeric_limits<T>::min(); }
    // True of a positive number that has all its digits and is finite.
    [[nodiscard]] TUMBLE_INLINE static constexpr bool is_normal(T a) {
        using Limits = std::numeric_limits<T>;
        const auto bits = [](T value) {
            return std::bit_cast<std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>(value);
        };
        return bits(a) - bits(Limits::min()) < bits(Limits::infinity()) - bits(Limits::min());
    }
    // True of the square of a length whose cube has an inverse far inside the range of the type: it is above 2^-40 m in
    // float, 2^-320 m in double.
    [[nodiscard]] TUMBLE_INLINE static constexpr bool has_inverse_cube(T square) {
        return square > (sizeof(T) == 4 ? T(0x1p-80) : T(0x1p-640));
    }
    // magnitude() in one instruction, for a number whose sign does not matter if it is zero.
    [[nodiscard]] TUMBLE_INLINE static constexpr T absolute(T a) {
        if constexpr (sizeof(T) == 4) return __builtin_fabsf(a);
        else return __builtin_fabs(a);
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr T three(const auto& v) {
        return v.x.value() + v.y.value() + v.z.value();
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr T square_of(const auto& v) {
        const T x = v.x.value(), y = v.y.value(), z = v.z.value();
        return x * x + y * y + z * z;
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr T halved(T change, int) { return change; }
    static constexpr void leave_range(auto&) {}
    template <class Body>
    static constexpr void saturate(Body&) {}

    [[nodiscard]] static constexpr T fall(Real metres) { return constant<T>(metres); }
    TUMBLE_INLINE static constexpr void add_any(auto& number, T change, Scale) { number.add(change); }
    TUMBLE_INLINE static constexpr void add_sum(auto& number, T change) { number.add(change); }
    [[nodiscard]] TUMBLE_INLINE static constexpr T held_sum(T a, T b) { return a + b; }
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

// The numbers of contacts, as in q32_contact.hpp. Floating point needs no scales.
template <class N>
struct ContactNumbers;

template <class N>
requires(!N::fixed_point) struct ContactNumbers<N> {
    using T = typename N::Work;
    using Work = T;
    using Unit = T;
    using Length = T;
    using Lever = T;
    using Speed = T;
    using Friction = T;

    struct LengthScale {
        [[nodiscard]] static constexpr LengthScale of(Real) { return {}; }
        [[nodiscard]] static constexpr int bits() { return 0; }
        [[nodiscard]] static constexpr T length(Real metres) { return N::template constant<T>(metres); }
        [[nodiscard]] static constexpr T length(T metres) { return metres; }
        [[nodiscard]] static constexpr T between(T a, T b) { return a - b; }
        [[nodiscard]] static constexpr T metres(T l) { return l; }
        [[nodiscard]] static constexpr bool is_cut(T) { return false; }
        [[nodiscard]] static constexpr T drift(T d, typename N::Scale) { return d; }
        [[nodiscard]] static constexpr T fall(T d, typename N::Scale) { return d; }
        [[nodiscard]] static constexpr bool fits(Real) { return true; }
        // m, of contacts: sixteen rounding errors of the largest length.
        [[nodiscard]] static constexpr Real least_tolerance(Real largest) {
            return largest * Real::scaled(1, sizeof(T) == 4 ? -20 : -49);
        }
        [[nodiscard]] static constexpr T coarser(T l, const LengthScale&) { return l; }
    };
    struct PerLength {
        T inverse{};
        [[nodiscard]] static constexpr PerLength of(Real length, const LengthScale&) {
            return {N::template constant<T>(Real{1} / length)};
        }
        [[nodiscard]] TUMBLE_INLINE constexpr T operator()(T l) const { return l * inverse; }
        constexpr void rescale(const LengthScale&, const LengthScale&) {}
    };
    class SpeedScale {
    public:
        // Calls visit with the members that a snapshot holds.
        template <class Self, class Visit>
        static void each(Self& self, Visit& visit) {
            visit(self.enough_at_rest_, self.enough_in_impact_);
        }
        [[nodiscard]] static SpeedScale of(T largest, int bodies, int) {
            SpeedScale s;
            s.enough_at_rest_ = largest * sqrt(T(6 * bodies)) * (sizeof(T) == 4 ? T(0x1p-20) : T(0x1p-40));
            s.enough_in_impact_ = largest * (sizeof(T) == 4 ? T(0x1p-23) : T(0x1p-51));
            return s;
        }
        [[nodiscard]] static T speed(T w) { return w; }
        [[nodiscard]] static T speed(T sum, int, T weight) { return sum * weight; }
        [[nodiscard]] static T sum(T s, int, T weight, bool&) { return s * weight; }
        [[nodiscard]] static T work(T s) { return s; }
        [[nodiscard]] static T speed(T l, T weight, LengthScale) { return l * weight; }
        [[nodiscard]] static T from(T s, SpeedScale) { return s; }
        [[nodiscard]] T enough_at_rest() const { return enough_at_rest_; }
        [[nodiscard]] T enough_in_impact() const { return enough_in_impact_; }
        [[nodiscard]] T rounding() const { return enough_in_impact_; }
        [[nodiscard]] T noise() const { return enough_at_rest_; }
        friend constexpr bool operator==(SpeedScale, SpeedScale) = default;

    private:
        T enough_at_rest_ = 0, enough_in_impact_ = 0;
    };
    [[nodiscard]] static T size(T sum, int, T weight) { return magnitude_of(sum) * weight; }
    [[nodiscard]] static T size(T l, const LengthScale&, T weight) { return magnitude_of(l) * weight; }
    [[nodiscard]] static constexpr T nothing() { return T(0); }
    [[nodiscard]] static constexpr int log2(T) { return 0; }
    [[nodiscard]] static constexpr int drift_bits(typename N::Scale) { return 0; }
    [[nodiscard]] static constexpr int turn_bits(typename N::Scale) { return 0; }
    [[nodiscard]] static T raw(T sum) { return sum; }
    template <class Sum>
    [[nodiscard]] static T as(T sum) {
        return sum;
    }

    [[nodiscard]] static T travel(T speed, T fall, int k) { return (speed + fall * T(k)) * T(k); }
    [[nodiscard]] static bool exceeds(T travel, T gap) { return travel >= gap; }
    [[nodiscard]] static bool reaches(T travel, T touch, T distance2) {
        return (travel + touch) * (travel + touch) >= distance2;
    }
    [[nodiscard]] static T rounded_up(T l) { return l * T(1.001) + T(1e-6); }
    [[nodiscard]] static T power_of_two(const LengthScale&, int log2) { return power_of_two(log2); }
    // A coordinate that is not finite is in the first cell.
    [[nodiscard]] static std::int32_t cell(T x, int log2) {
        constexpr T most = T(1 << 30);
        const T cells = x * power_of_two(-log2);
        if (!(cells > -most)) return -(1 << 30);
        if (!(cells < most)) return 1 << 30;
        const auto cell = static_cast<std::int32_t>(cells);
        return cells < T(cell) ? cell - 1 : cell;
    }
    [[nodiscard]] static bool meet(T radius, T other, T distance2) { return reaches(radius, other, distance2); }

    [[nodiscard]] static constexpr T one() { return T(1); }
    [[nodiscard]] static constexpr T longest() { return std::numeric_limits<T>::max(); }
    // False where the square of the length has lost digits, or is zero.
    [[nodiscard]] static bool has_direction(const Vec3<T>& v) { return N::is_divisor(dot(v, v)); }
    [[nodiscard]] static constexpr StoredVec3<T> direction(const StoredVec3<T>& v) {
        const T inverse = T(1) / sqrt(dot(v, v));
        return {v.x() * inverse, v.y() * inverse, v.z() * inverse};
    }
    [[nodiscard]] static T inverse_root_of_one_and(T squares) { return T(1) / sqrt(T(1) + squares); }
    [[nodiscard]] static T inverse_root_of(T squares) { return T(1) / sqrt(squares); }
    [[nodiscard]] static T unit(T q, T factor) { return q * factor; }
    [[nodiscard]] static T unit(T w) { return w; }
    [[nodiscard]] static T lever(T u) { return u; }
    [[nodiscard]] static int to_quarter(T l) {
        if constexpr (sizeof(T) == 4) return 127 - 3 - static_cast<int>(std::bit_cast<std::uint32_t>(l) >> 23);
        else return 1023 - 3 - static_cast<int>(std::bit_cast<std::uint64_t>(l) >> 52);
    }
    [[nodiscard]] static T times_power(T l, int log2) { return l * power_of_two(log2); }
    [[nodiscard]] static T inverse_root(T w) { return T(1) / sqrt(w); }
    [[nodiscard]] static T product(T a, T b) { return a * b; }
    [[nodiscard]] static T speed(T sum) { return sum; }
    [[nodiscard]] static T half(T a) { return a * T(0.5); }
    [[nodiscard]] static T eighth(T a) { return a * T(0.125); }
    [[nodiscard]] static T times_friction(T mu, T s) { return mu * s; }
    [[nodiscard]] static T work(T mu) { return mu; }
    [[nodiscard]] static T friction(T mu) { return mu; }
    [[nodiscard]] static T share(T limit, T squares) { return limit / sqrt(squares); }
    [[nodiscard]] static bool fits(T) { return true; }
    [[nodiscard]] static T over_square(T s, T u) { return s / (u * u); }
    [[nodiscard]] static T ratio(T a, T b) { return a / b; }
    [[nodiscard]] static T ratio_of_squares(T a, T b) { return a / b; }
    // rad: the square of a smaller turn is rounding.
    [[nodiscard]] static constexpr T least_turn() { return sizeof(T) == 4 ? T(0x1p-12) : T(0x1p-26); }
    [[nodiscard]] static constexpr T nearly_parallel() { return T(1) - T(0x1p-21); }
    [[nodiscard]] static T over_sine(T l, T c) { return l / sqrt(T(1) - c * c); }
    [[nodiscard]] static T hair(T l) { return l * T(0x1p-16); }
    [[nodiscard]] static T sixteenth(T l) { return l * T(0.0625); }
    [[nodiscard]] static T unit_norm(const Vec3<T>& v) { return sqrt(dot(v, v)); }
    [[nodiscard]] static constexpr T flat() { return T(0x1p-16); }

private:
    // For -126 < log2 < 128.
    [[nodiscard]] static constexpr T power_of_two(int log2) {
        if constexpr (sizeof(T) == 4) return std::bit_cast<T>(static_cast<std::uint32_t>(127 + log2) << 23);
        else return std::bit_cast<T>(static_cast<std::uint64_t>(1023 + log2) << 52);
    }
};

}  // namespace tumble
