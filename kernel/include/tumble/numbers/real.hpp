// Real: a software floating-point number with a 64-bit mantissa, for set-up only (masses, inertia, constants of a
// step). It uses integers only, so constants have the same bits at compile time, at run time and on every core, and a
// firmware without double arithmetic can still add bodies. Results are within one unit of 2^-63, but not always the
// nearest.
#pragma once

#include <tumble/numbers/vector.hpp>

namespace tumble {

// Set-up runs once, so its functions are compiled for size.
class Real {
public:
    constexpr Real() = default;
    // Exact. Reads the bits of the double without a floating-point instruction. NaN and infinity are misuse.
    constexpr Real(double value) {  // NOLINT(google-explicit-constructor): literals read as numbers
        const auto bits = std::bit_cast<std::uint64_t>(value);
        const auto exponent = static_cast<int>((bits >> 52) & 0x7ff);
        const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
        TUMBLE_ASSERT(exponent != 0x7ff);
        *this = make((bits >> 63) != 0, exponent == 0 ? fraction : fraction | (std::uint64_t{1} << 52),
                     (exponent == 0 ? 1 : exponent) - 1075);
    }
    // Exact. NaN and infinity are misuse.
    constexpr Real(float value) {  // NOLINT(google-explicit-constructor)
        const auto bits = std::bit_cast<std::uint32_t>(value);
        const auto exponent = static_cast<int>((bits >> 23) & 0xff);
        const std::uint32_t fraction = bits & 0x7fffff;
        TUMBLE_ASSERT(exponent != 0xff);
        *this = make((bits >> 31) != 0, exponent == 0 ? fraction : fraction | 0x800000,
                     (exponent == 0 ? 1 : exponent) - 150);
    }
    // Exact.
    constexpr Real(int value)  // NOLINT(google-explicit-constructor)
        : Real{make(value < 0, value < 0 ? 0u - static_cast<std::uint32_t>(value) : static_cast<std::uint32_t>(value),
                    0)} {}

    // mantissa * 2^exponent, exact.
    [[nodiscard]] static constexpr Real scaled(std::int64_t mantissa, int exponent) {
        const bool negative = mantissa < 0;
        const auto magnitude = static_cast<std::uint64_t>(mantissa);
        return make(negative, negative ? 0u - magnitude : magnitude, exponent);
    }

    // There is one zero, without a sign.
    [[nodiscard]] constexpr bool is_zero() const { return mantissa_ == 0; }
    // True below zero.
    [[nodiscard]] constexpr bool is_negative() const { return negative_; }

    [[nodiscard]] constexpr Real operator-() const {
        Real r = *this;
        r.negative_ = mantissa_ != 0 && !negative_;
        return r;
    }
    TUMBLE_SET_UP friend constexpr Real operator+(Real a, Real b) {
        if (a.mantissa_ == 0) return b;
        if (b.mantissa_ == 0) return a;
        if (a.exponent_ < b.exponent_) {
            const Real t = a;
            a = b;
            b = t;
        }
        const int gap = a.exponent_ - b.exponent_;
        if (gap > 64) return a;
        // One bit of headroom for the carry: both mantissas are shifted down by one.
        const std::uint64_t x = a.mantissa_ >> 1;
        const std::uint64_t y = gap >= 63 ? 0 : (b.mantissa_ >> 1) >> gap;
        if (a.negative_ == b.negative_) return make(a.negative_, x + y, a.exponent_ + 1);
        if (gap == 0) {  // cancellation: keeps the lowest bit, so that the difference of neighbours is exact
            if (a.mantissa_ >= b.mantissa_) return make(a.negative_, a.mantissa_ - b.mantissa_, a.exponent_);
            return make(b.negative_, b.mantissa_ - a.mantissa_, a.exponent_);
        }
        // gap >= 1: the top bit of a's mantissa is set, so the difference is positive; the bit that b loses is below
        // a's unit.
        const std::uint64_t z = gap >= 64 ? 0 : b.mantissa_ >> gap;
        return make(a.negative_, a.mantissa_ - z, a.exponent_);
    }
    friend constexpr Real operator-(Real a, Real b) { return a + (-b); }
    TUMBLE_SET_UP friend constexpr Real operator*(Real a, Real b) {
        if (a.mantissa_ == 0 || b.mantissa_ == 0) return {};
        const std::uint64_t a1 = a.mantissa_ >> 32, a0 = a.mantissa_ & 0xffffffffu;
        const std::uint64_t b1 = b.mantissa_ >> 32, b0 = b.mantissa_ & 0xffffffffu;
        const std::uint64_t low = a0 * b0, mid = a1 * b0 + (low >> 32), mid2 = a0 * b1 + (mid & 0xffffffffu);
        const std::uint64_t high = a1 * b1 + (mid >> 32) + (mid2 >> 32);
        const std::uint64_t rest = (mid2 << 32) | (low & 0xffffffffu);
        const bool negative = a.negative_ != b.negative_;
        const int exponent = a.exponent_ + b.exponent_ + 64;
        if ((high >> 63) != 0) return rounded(negative, high, (rest >> 63) != 0, exponent);
        return rounded(negative, (high << 1) | (rest >> 63), ((rest >> 62) & 1) != 0, exponent - 1);
    }
    // Long division, 65 rounds. b must not be zero.
    TUMBLE_SET_UP friend constexpr Real operator/(Real a, Real b) {
        TUMBLE_ASSERT(b.mantissa_ != 0);
        if (a.mantissa_ == 0) return {};
        int exponent = a.exponent_ - b.exponent_ - 63;
        std::uint64_t remainder = a.mantissa_, quotient = 0;
        bool carry = false;
        if (remainder < b.mantissa_) {
            carry = (remainder >> 63) != 0;
            remainder <<= 1;
            --exponent;
        }
        for (int i = 0; i < 64; ++i) {
            quotient <<= 1;
            if (carry || remainder >= b.mantissa_) {
                remainder -= b.mantissa_;
                quotient |= 1;
            }
            carry = (remainder >> 63) != 0;
            remainder <<= 1;
        }
        return rounded(a.negative_ != b.negative_, quotient, carry || remainder >= b.mantissa_, exponent);
    }
    constexpr Real& operator+=(Real b) { return *this = *this + b; }
    constexpr Real& operator-=(Real b) { return *this = *this - b; }
    constexpr Real& operator*=(Real b) { return *this = *this * b; }
    constexpr Real& operator/=(Real b) { return *this = *this / b; }
    friend constexpr bool operator==(Real a, Real b) { return (a - b).is_zero(); }
    TUMBLE_SET_UP friend constexpr bool operator<(Real a, Real b) { return (a - b).is_negative(); }
    friend constexpr bool operator>(Real a, Real b) { return b < a; }
    friend constexpr bool operator<=(Real a, Real b) { return !(b < a); }
    friend constexpr bool operator>=(Real a, Real b) { return !(a < b); }

    // The nearest integer to value * 2^fraction_bits, ties away from zero, held at +-(2^(bits-1) - 1).
    TUMBLE_SET_UP [[nodiscard]] constexpr std::int64_t to_fixed(int fraction_bits, int bits = 32) const {
        const std::int64_t limit = static_cast<std::int64_t>((std::uint64_t{1} << (bits - 1)) - 1);
        if (mantissa_ == 0) return 0;
        const int shift = -(exponent_ + fraction_bits);  // right shift of the mantissa
        if (shift <= 0) return negative_ ? -limit : limit;
        std::uint64_t magnitude = 0;
        if (shift < 64) magnitude = (mantissa_ >> shift) + ((mantissa_ >> (shift - 1)) & 1);
        else if (shift == 64) magnitude = mantissa_ >> 63;
        if (magnitude > static_cast<std::uint64_t>(limit)) return negative_ ? -limit : limit;
        return negative_ ? -static_cast<std::int64_t>(magnitude) : static_cast<std::int64_t>(magnitude);
    }
    // The 32 leading bits of the magnitude, the first of which is set unless the number is zero.
    [[nodiscard]] constexpr std::uint32_t leading_bits() const { return static_cast<std::uint32_t>(mantissa_ >> 32); }
    // The power of two of their unit.
    [[nodiscard]] constexpr int leading_exponent() const { return exponent_ + 32; }
    // The exponent of the power of two above the magnitude: the least result with |value| < 2^result. Zero gives a very
    // small number.
    [[nodiscard]] constexpr int ceil_log2() const { return mantissa_ == 0 ? -100000 : exponent_ + 64; }

    // The least n with |value| <= 2^n. An exact power of two is its own bound.
    [[nodiscard]] constexpr int ceil_log2_bound() const {
        return mantissa_ == std::uint64_t{1} << 63 ? exponent_ + 63 : ceil_log2();
    }

    // The nearest double, ties to even. Built from bits, without floating-point instructions.
    [[nodiscard]] constexpr double to_double() const { return std::bit_cast<double>(ieee(52, 1023)); }
    // The nearest float, ties to even. Built from bits.
    [[nodiscard]] constexpr float to_float() const {
        return std::bit_cast<float>(static_cast<std::uint32_t>(ieee(23, 127)));
    }
    // The nearest double.
    [[nodiscard]] explicit constexpr operator double() const { return to_double(); }
    // The nearest float.
    [[nodiscard]] explicit constexpr operator float() const { return to_float(); }

private:
    static constexpr Real make(bool negative, std::uint64_t mantissa, int exponent) {
        Real r;
        if (mantissa == 0) return r;
        const int up = std::countl_zero(mantissa);
        r.mantissa_ = mantissa << up;
        r.exponent_ = exponent - up;
        r.negative_ = negative;
        return r;
    }
    static constexpr Real rounded(bool negative, std::uint64_t mantissa, bool up, int exponent) {
        if (up && ++mantissa == 0) {
            mantissa = std::uint64_t{1} << 63;
            ++exponent;
        }
        return make(negative, mantissa, exponent);
    }
    [[nodiscard]] constexpr std::uint64_t ieee(int fraction_bits, int bias) const {
        const std::uint64_t sign = static_cast<std::uint64_t>(negative_) << (bias == 1023 ? 63 : 31);
        if (mantissa_ == 0) return sign;
        int exponent = exponent_ + 63 + bias;  // biased exponent of the leading bit
        int drop = 63 - fraction_bits;         // bits below the fraction
        if (exponent <= 0) {
            drop += 1 - exponent;
            exponent = 0;
        }
        if (drop > 64) return sign;
        const std::uint64_t kept = drop == 64 ? 0 : mantissa_ >> drop;
        const std::uint64_t half = std::uint64_t{1} << (drop - 1);
        const std::uint64_t below = drop == 64 ? mantissa_ : mantissa_ & ((half << 1) - 1);
        std::uint64_t bits = kept + ((below > half || (below == half && (kept & 1) != 0)) ? 1 : 0);
        // The leading 1 of a normal number adds one to the exponent field. So does a carry out of the fraction.
        bits += static_cast<std::uint64_t>(exponent == 0 ? 0 : exponent - 1) << fraction_bits;
        const std::uint64_t infinity = static_cast<std::uint64_t>(2 * bias + 1) << fraction_bits;
        return sign | (bits > infinity ? infinity : bits);
    }

    std::uint64_t mantissa_ = 0;  // top bit set unless the number is zero
    int exponent_ = 0;            // value = mantissa_ * 2^exponent_
    bool negative_ = false;
};

// The absolute value.
[[nodiscard]] constexpr Real abs(Real a) { return a.is_negative() ? -a : a; }

// Square root by Newton's iteration from a power of two; negative arguments are misuse.
TUMBLE_SET_UP [[nodiscard]] constexpr Real sqrt(Real a) {
    TUMBLE_ASSERT(!a.is_negative());
    if (a.is_zero()) return a;
    Real y = Real::scaled(1, (a.ceil_log2() + 1) / 2);
    for (int i = 0; i < 8; ++i) y = (y + a / y) * Real::scaled(1, -1);
    return y;
}

// A vector of set-up numbers.
using RealVec3 = Vector3<Real>;
// The vector with length 1. a must not be zero.
[[nodiscard]] constexpr RealVec3 normalized(RealVec3 a) { return a * (Real{1} / sqrt(dot(a, a))); }
// A quaternion of set-up numbers.
using RealQuat = Quaternion<Real>;
namespace detail {

TUMBLE_COLD constexpr void normalize(RealQuat& q) {
    const Real s = Real{1} / sqrt(q.w * q.w + (q.v.x * q.v.x + q.v.y * q.v.y + q.v.z * q.v.z));
    for (Real* component : {&q.w, &q.v.x, &q.v.y, &q.v.z}) *component *= s;
}

}  // namespace detail

// The quaternion with length 1. q must not be zero.
[[nodiscard]] constexpr RealQuat normalized(RealQuat q) {
    detail::run_once([&] { detail::normalize(q); });
    return q;
}

namespace detail {

// Whether the core has instructions for floats. Conversions then use them, for the bits that shifts give: an IEEE
// conversion of an integer rounds to the nearest float, ties to even, and a product by a power of two is exact.
#if defined(__ARM_FP)
inline constexpr bool has_float_unit = (__ARM_FP & 4) != 0;
#else
inline constexpr bool has_float_unit = false;
#endif

// raw * 2^exponent as the nearest float, ties to even.
template <bool by_float_unit = has_float_unit>
[[nodiscard, gnu::noinline]] constexpr float to_float(std::int64_t raw, int exponent) {
    if (raw == 0) return 0;
    if constexpr (by_float_unit) {
        // The upper word with the leading digit in bit 30; its last bit tells whether bits below it are set.
        const std::int64_t sign = raw >> 63;
        const int up = std::countl_zero(static_cast<std::uint64_t>(raw ^ sign)) - 1, field = exponent + 32 - up + 127;
        if (field < 1 || field > 254 - 31) return Real::scaled(raw, exponent).to_float();
        const auto top = static_cast<std::int64_t>(static_cast<std::uint64_t>(raw) << up);
        const auto upper = static_cast<std::int32_t>(top >> 32) | (static_cast<std::uint32_t>(top) != 0 ? 1 : 0);
        return static_cast<float>(upper) * std::bit_cast<float>(static_cast<std::uint32_t>(field) << 23);
    }
    const std::uint64_t magnitude = raw < 0 ? 0u - static_cast<std::uint64_t>(raw) : static_cast<std::uint64_t>(raw);
    const int up = std::countl_zero(magnitude), field = exponent + 63 - up + 127;
    if (field < 1 || field > 254) return Real::scaled(raw, exponent).to_float();  // not a normal number
    const std::uint64_t top = magnitude << up;
    const auto upper = static_cast<std::uint32_t>(top >> 32);
    std::uint32_t bits = upper >> 8;
    const bool is_above_half = (upper & 0x7f) != 0 || static_cast<std::uint32_t>(top) != 0;
    if ((upper & 0x80) != 0 && (is_above_half || (bits & 1) != 0)) ++bits;
    // The leading 1 adds one to the exponent's field. So does a carry out of the fraction.
    bits += static_cast<std::uint32_t>(field - 1) << 23;
    return std::bit_cast<float>(raw < 0 ? bits | 0x80000000u : bits);
}

// The same of one word.
template <bool by_float_unit = has_float_unit>
[[nodiscard, gnu::noinline]] constexpr float to_float(std::int32_t raw, int exponent) {
    if (raw == 0) return 0;
    if constexpr (by_float_unit) {
        const int field = exponent + 127;
        if (field < 1 || field > 254 - 32) return Real::scaled(raw, exponent).to_float();
        return static_cast<float>(raw) * std::bit_cast<float>(static_cast<std::uint32_t>(field) << 23);
    }
    const std::uint32_t magnitude = raw < 0 ? 0u - static_cast<std::uint32_t>(raw) : static_cast<std::uint32_t>(raw);
    const int up = std::countl_zero(magnitude), field = exponent + 31 - up + 127;
    if (field < 1 || field > 254) return Real::scaled(raw, exponent).to_float();  // not a normal number
    const std::uint32_t upper = magnitude << up, half = 0x7f + ((upper >> 8) & 1);
    // Adding half a unit, less where the result is even, carries where the number rounds up.
    const std::uint32_t rounded = (upper >> 8) + (((upper & 0xff) + half) >> 8);
    const std::uint32_t bits = rounded + (static_cast<std::uint32_t>(field - 1) << 23);
    return std::bit_cast<float>(raw < 0 ? bits | 0x80000000u : bits);
}

}  // namespace detail

}  // namespace tumble
