// Scaled: a run-time number with a 31-bit mantissa and an exponent, in integers: what a Q32 world uses where magnitudes
// span many decades and the cost of normalising is bearable (loads other than gravity, contacts). Twice the digits of
// float (relative rounding 2^-31) and no range to leave. About 10 instructions a product and 25 a sum on a Cortex-M3.
#pragma once

#include <tumble/numbers/fixed.hpp>

namespace tumble {

// A number of a Q32 world's accessors: mantissa * 2^exponent, to 31 bits.
class Scaled {
public:
    constexpr Scaled() = default;  // zero
    // To 31 bits.
    constexpr Scaled(int value)
        : Scaled{of(value, 0)} {}  // NOLINT(google-explicit-constructor): 0, 1, -1 read as numbers
    // A set-up number, to 31 bits.
    [[nodiscard]] static constexpr Scaled from(Real value) {
        // Nearest at 31 bits: place the leading bit at 2^30, round, and let `of` renormalise a carry.
        if (value.is_zero()) return {};
        const int up = 31 - value.ceil_log2();
        return of(value.to_fixed(up, 64), -up);
    }
    // raw * 2^exponent, rounded to 31 bits, ties away from zero.
    [[nodiscard, gnu::noinline]] static constexpr Scaled of(std::int64_t raw, int exponent) {
        if (raw == 0) return {};
        const bool negative = raw < 0;
        std::uint64_t magnitude = negative ? 0u - static_cast<std::uint64_t>(raw) : static_cast<std::uint64_t>(raw);
        int drop = 33 - std::countl_zero(magnitude);
        if (drop > 0) {
            magnitude = (magnitude + (std::uint64_t{1} << (drop - 1))) >> drop;
            if (magnitude == std::uint64_t{1} << 31) {
                magnitude >>= 1;
                ++drop;
            }
        } else {
            magnitude <<= -drop;
        }
        const auto m = static_cast<std::int32_t>(magnitude);
        return Scaled{negative ? -m : m, exponent + drop};
    }
    // Of fixed point, exact.
    template <int F>
    [[nodiscard]] static constexpr Scaled of(Fixed<F> a) {
        return of(a.raw, -F);
    }
    // Of a sum in fixed point, to 31 bits.
    template <int F>
    [[nodiscard]] static constexpr Scaled of(Wide<F> a) {
        return of(a.raw, -F);
    }

    // The number as a 64-bit sum with F fraction bits, rounded; saturates below 2^62, so that a sum of two cannot wrap,
    // or at `limit`.
    template <int F>
    [[nodiscard]] constexpr Wide<F> to_wide() const {
        return {to_sum(F)};
    }
    // The same with the number of fraction bits known at run time, as the raw sum.
    [[nodiscard, gnu::noinline]] constexpr std::int64_t to_sum(int fraction_bits,
                                                               std::int64_t limit = (std::int64_t{1} << 62) - 1) const {
        const int up = exponent_ + fraction_bits;
        if (mantissa_ == 0 || up < -31) return 0;
        if (up >= 0) {
            if (up > 32) return mantissa_ < 0 ? -limit : limit;
            const std::int64_t sum = static_cast<std::int64_t>(mantissa_) * (std::int64_t{1} << up);
            return sum > limit ? limit : sum < -limit ? -limit : sum;
        }
        return (static_cast<std::int64_t>(mantissa_) + (std::int64_t{1} << (-up - 1))) >> -up;
    }
    // Nearest Fixed; saturates at the format's ends.
    template <class To>
    [[nodiscard]] constexpr To to_fixed() const {
        const std::int64_t raw = to_wide<To::fraction_bits>().raw;
        constexpr std::int64_t limit = 0x7fffffff;
        return To::from_raw(static_cast<std::int32_t>(raw > limit ? limit : raw < -limit ? -limit : raw));
    }
    // As a set-up number, exact.
    [[nodiscard]] constexpr Real to_real() const { return Real::scaled(mantissa_, exponent_); }
    // As a double, exact; in integers.
    [[nodiscard]] explicit constexpr operator double() const { return to_real().to_double(); }

    // 2^30 <= |mantissa| < 2^31, or 0.
    [[nodiscard]] constexpr std::int32_t mantissa() const { return mantissa_; }
    // Of two; 0 of zero.
    [[nodiscard]] constexpr int exponent() const { return exponent_; }
    // There is one zero.
    [[nodiscard]] constexpr bool is_zero() const { return mantissa_ == 0; }
    // value * 2^n, exact.
    [[nodiscard]] constexpr Scaled times_power_of_two(int n) const {
        return mantissa_ == 0 ? Scaled{} : Scaled{mantissa_, exponent_ + n};
    }

    constexpr Scaled operator-() const { return Scaled{-mantissa_, exponent_}; }
    [[gnu::noinline]] friend constexpr Scaled operator+(Scaled a, Scaled b) {
        if (a.mantissa_ == 0) return b;
        if (b.mantissa_ == 0) return a;
        if (a.exponent_ < b.exponent_) {
            const Scaled t = a;
            a = b;
            b = t;
        }
        const int gap = a.exponent_ - b.exponent_;
        if (gap > 32) return a;
        const std::int64_t sum = static_cast<std::int64_t>(a.mantissa_) * (std::int64_t{1} << 31) +
                                 ((static_cast<std::int64_t>(b.mantissa_) * (std::int64_t{1} << 31)) >> gap);
        return of(sum, a.exponent_ - 31);
    }
    friend constexpr Scaled operator-(Scaled a, Scaled b) { return a + (-b); }
    friend constexpr Scaled operator*(Scaled a, Scaled b) {
        return of(static_cast<std::int64_t>(a.mantissa_) * b.mantissa_, a.exponent_ + b.exponent_);
    }
    // b must not be zero.
    [[gnu::noinline]] friend constexpr Scaled operator/(Scaled a, Scaled b) {
        TUMBLE_ASSERT(b.mantissa_ != 0);
        return of((static_cast<std::int64_t>(a.mantissa_) * (std::int64_t{1} << 32)) / b.mantissa_,
                  a.exponent_ - b.exponent_ - 32);
    }
    constexpr Scaled& operator+=(Scaled b) { return *this = *this + b; }
    constexpr Scaled& operator-=(Scaled b) { return *this = *this - b; }
    constexpr Scaled& operator*=(Scaled b) { return *this = *this * b; }
    friend constexpr bool operator==(Scaled, Scaled) = default;  // numbers are kept normalised
    friend constexpr bool operator<(Scaled a, Scaled b) {
        if ((a.mantissa_ < 0) != (b.mantissa_ < 0)) return a.mantissa_ < 0;
        if (a.mantissa_ == 0 || b.mantissa_ == 0 || a.exponent_ == b.exponent_) return a.mantissa_ < b.mantissa_;
        return (a.exponent_ < b.exponent_) == (a.mantissa_ > 0);
    }
    friend constexpr bool operator>(Scaled a, Scaled b) { return b < a; }
    friend constexpr bool operator<=(Scaled a, Scaled b) { return !(b < a); }
    friend constexpr bool operator>=(Scaled a, Scaled b) { return !(a < b); }

private:
    constexpr Scaled(std::int32_t mantissa, int exponent) : mantissa_{mantissa}, exponent_{exponent} {}

    std::int32_t mantissa_ = 0;  // 2^30 <= |mantissa| < 2^31, or zero with exponent 0
    std::int32_t exponent_ = 0;
};

}  // namespace tumble
