// Scaled: a run-time number in integers, with a 31-bit mantissa and an exponent. A Q32 world uses it for numbers that
// span many decades and are computed rarely enough: constants, accessors, contacts. It has twice the digits of float
// (relative rounding error 2^-31) and no range. About 31 instructions for a product and 47 for a sum on a Cortex-M3.
#pragma once

#include <tumble/numbers/fixed.hpp>

namespace tumble {

namespace detail {

// Integers no longer than int.
template <class T>
concept HeldByInt = std::integral<T> && sizeof(T) <= sizeof(int);

}  // namespace detail

// The numbers that a Q32 world's accessors return: mantissa * 2^exponent, 31 bits.
class Scaled {
public:
    constexpr Scaled() = default;  // zero
    // Rounded to 31 bits. Inlined: of a constant, nothing is left to compute. A float or double is none of these: it
    // would lose its fraction in silence.
    template <detail::HeldByInt Integer>
    TUMBLE_INLINE constexpr Scaled(Integer integer) {  // NOLINT(google-explicit-constructor): 0, 1, -1 read as numbers
        const auto value = static_cast<int>(integer);
        if (value == 0) return;
        const bool negative = value < 0;
        const std::uint32_t magnitude =
            negative ? 0u - static_cast<std::uint32_t>(value) : static_cast<std::uint32_t>(value);
        const int up = std::countl_zero(magnitude) - 1;  // -1 of -2^31
        const auto mantissa = static_cast<std::int32_t>(up < 0 ? magnitude >> 1 : magnitude << up);
        mantissa_ = negative ? -mantissa : mantissa;
        exponent_ = -up;
    }
    // Exact, by shifts. NaN and infinity are misuse.
    explicit constexpr Scaled(float value) {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        const int exponent = static_cast<int>((bits >> 23) & 0xff);
        TUMBLE_ASSERT(exponent != 0xff);
        if (exponent == 0) {  // zero, or below the normal numbers
            *this = from(Real{value});
            return;
        }
        const auto magnitude = static_cast<std::int32_t>(((bits & 0x7fffff) | 0x800000) << 7);
        mantissa_ = (bits >> 31) != 0 ? -magnitude : magnitude;
        exponent_ = exponent - 157;
    }
    // Rounded to 31 bits. NaN and infinity are misuse.
    explicit constexpr Scaled(double value) {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        const int exponent = static_cast<int>((bits >> 52) & 0x7ff);
        TUMBLE_ASSERT(exponent != 0x7ff);
        const auto fraction = static_cast<std::int64_t>(bits & ((std::uint64_t{1} << 52) - 1));
        const std::int64_t magnitude = exponent == 0 ? fraction : fraction | (std::int64_t{1} << 52);
        *this = of((bits >> 63) != 0 ? -magnitude : magnitude, (exponent == 0 ? 1 : exponent) - 1075);
    }
    // A fixed-point number, exact.
    template <int F>
    explicit constexpr Scaled(Fixed<F> value) : Scaled{of(value)} {}
    // A set-up number, rounded to 31 bits.
    explicit constexpr Scaled(Real value) : Scaled{from(value)} {}
    // A set-up number, rounded to 31 bits.
    [[nodiscard]] static constexpr Scaled from(Real value) {
        // The leading bit goes to 2^30, rounded to nearest, ties away from zero. A carry out of 31 bits leaves 2^31.
        if (value.is_zero()) return {};
        const std::uint32_t bits = value.leading_bits(), rounded = (bits >> 1) + (bits & 1), carry = rounded >> 31;
        const auto magnitude = static_cast<std::int32_t>(rounded >> carry);
        return Scaled{value.is_negative() ? -magnitude : magnitude,
                      value.leading_exponent() + 1 + static_cast<int>(carry)};
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
    // A fixed-point number, exact.
    template <int F>
    [[nodiscard]] static constexpr Scaled of(Fixed<F> a) {
        return of(a.raw, -F);
    }
    // A sum in fixed point, rounded to 31 bits.
    template <int F>
    [[nodiscard]] static constexpr Scaled of(Wide<F> a) {
        return of(a.raw, -F);
    }

    // The number as a 64-bit sum with F fraction bits, rounded. Saturates below 2^62, so that a sum of two cannot wrap,
    // or at `limit`.
    template <int F>
    [[nodiscard]] constexpr Wide<F> to_wide() const {
        return {to_sum(F)};
    }
    // The same, as a raw sum, with the number of fraction bits known at run time.
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
    // The nearest Fixed. Saturates at the ends of the format.
    template <class To>
    [[nodiscard]] constexpr To to_fixed() const {
        const std::int64_t raw = to_wide<To::fraction_bits>().raw;
        constexpr std::int64_t limit = 0x7fffffff;
        return To::from_raw(static_cast<std::int32_t>(raw > limit ? limit : raw < -limit ? -limit : raw));
    }
    // The number as a set-up number, exact.
    [[nodiscard]] constexpr Real to_real() const { return Real::scaled(mantissa_, exponent_); }
    // The number as a set-up number, exact.
    [[nodiscard]] explicit constexpr operator Real() const { return to_real(); }
    // The nearest float. By shifts.
    [[nodiscard]] explicit constexpr operator float() const { return detail::to_float(mantissa_, exponent_); }
    // The nearest fixed-point number. Saturates at the ends of the format.
    template <int F>
    [[nodiscard]] explicit constexpr operator Fixed<F>() const {
        return to_fixed<Fixed<F>>();
    }
    // The number as a double, exact. Computed in integers.
    [[nodiscard]] explicit constexpr operator double() const { return to_real().to_double(); }

    // 2^30 <= |mantissa| < 2^31, or 0.
    [[nodiscard]] constexpr std::int32_t mantissa() const { return mantissa_; }
    // The exponent of 2. 0 for zero.
    [[nodiscard]] constexpr int exponent() const { return exponent_; }
    // True of zero. There is one zero.
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
    // The quotient. b must not be zero.
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

    template <class, int>
    friend class Stored;
};

// Working numbers as a world stores them.
template <class Work, int count>
class Stored {
public:
    // Number i.
    [[nodiscard]] TUMBLE_INLINE constexpr Work operator[](int i) const { return value_[i]; }
    // Sets number i.
    constexpr void set(int i, Work value) { value_[i] = value; }

private:
    Work value_[count]{};
};
// With exponents of 16 bits they take a quarter less. Misuse: a number beyond 2^32767.
template <int count>
class Stored<Scaled, count> {
public:
    // Number i.
    [[nodiscard]] TUMBLE_INLINE constexpr Scaled operator[](int i) const { return Scaled{mantissa_[i], exponent_[i]}; }
    // Sets number i.
    constexpr void set(int i, Scaled value) {
        mantissa_[i] = value.mantissa_;
        exponent_[i] = static_cast<std::int16_t>(value.exponent_);
        TUMBLE_ASSERT(exponent_[i] == value.exponent_);
    }

private:
    std::int32_t mantissa_[count]{};
    std::int16_t exponent_[count]{};
};

}  // namespace tumble
