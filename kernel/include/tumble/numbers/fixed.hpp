// Fixed<F>: a 32-bit signed number with F fraction bits; Wide<F>: the 64-bit accumulator that products live in.
// A product is exact, sums of products stay wide, and one rounding to nearest brings the result back (narrow).
// Truncation would bias every update by half a unit and costs a hundred times the accuracy in free rotation.
#pragma once

#include <tumble/config.hpp>
#include <tumble/numbers/real.hpp>

#include <compare>
#include <cstdint>
#include <type_traits>

namespace tumble {

template <int F>
struct Wide;

template <int F>
struct Fixed {
    static constexpr int fraction_bits = F;

    std::int32_t raw = 0;

    [[nodiscard]] static constexpr Fixed from_raw(std::int32_t raw_value) { return Fixed{raw_value}; }
    // Nearest; saturates at the format's ends.
    [[nodiscard]] static constexpr Fixed from(Real value) { return Fixed{static_cast<std::int32_t>(value.to_fixed(F))}; }
    // Exact: a double holds every Fixed. For hosts and tests; a firmware that calls it pulls in double arithmetic.
    [[nodiscard]] explicit constexpr operator double() const { return Real::scaled(raw, -F).to_double(); }
    [[nodiscard]] explicit constexpr operator float() const { return Real::scaled(raw, -F).to_float(); }

    // Sums wrap at 2^32 instead of being undefined; formats leave a bit above the declared range so that they do not.
    friend constexpr Fixed operator+(Fixed a, Fixed b) { return {wrap(bits(a) + bits(b))}; }
    friend constexpr Fixed operator-(Fixed a, Fixed b) { return {wrap(bits(a) - bits(b))}; }
    constexpr Fixed operator-() const { return {wrap(0u - bits(*this))}; }
    constexpr Fixed& operator+=(Fixed b) { return *this = *this + b; }
    constexpr Fixed& operator-=(Fixed b) { return *this = *this - b; }
    friend constexpr bool operator==(Fixed, Fixed) = default;
    friend constexpr auto operator<=>(Fixed a, Fixed b) { return a.raw <=> b.raw; }

private:
    static constexpr std::uint32_t bits(Fixed a) { return static_cast<std::uint32_t>(a.raw); }
    static constexpr std::int32_t wrap(std::uint32_t v) { return static_cast<std::int32_t>(v); }
};

template <int F>
struct Wide {
    static constexpr int fraction_bits = F;

    std::int64_t raw = 0;

    friend constexpr Wide operator+(Wide a, Wide b) { return {wrap(bits(a) + bits(b))}; }
    friend constexpr Wide operator-(Wide a, Wide b) { return {wrap(bits(a) - bits(b))}; }
    constexpr Wide operator-() const { return {wrap(0u - bits(*this))}; }
    constexpr Wide& operator+=(Wide b) { return *this = *this + b; }
    constexpr Wide& operator-=(Wide b) { return *this = *this - b; }
    friend constexpr bool operator==(Wide, Wide) = default;

private:
    static constexpr std::uint64_t bits(Wide a) { return static_cast<std::uint64_t>(a.raw); }
    static constexpr std::int64_t wrap(std::uint64_t v) { return static_cast<std::int64_t>(v); }
};

namespace detail {

// a * b and sum + a * b with all 64 bits. Compilers that see a sign extension used twice make a 64 x 64 bit product of
// it, four instructions for one; the assembly says what is meant. Cores without the instruction use plain C++.
[[nodiscard]] TUMBLE_INLINE constexpr std::int64_t multiply(std::int32_t a, std::int32_t b) {
#if defined(__thumb2__)
    if (!std::is_constant_evaluated() && !__builtin_constant_p(a) && !__builtin_constant_p(b)) {
        std::int64_t product = 0;
        asm("smull %Q0, %R0, %1, %2" : "=r"(product) : "r"(a), "r"(b));
        return product;
    }
#endif
    return static_cast<std::int64_t>(a) * b;
}
[[nodiscard]] TUMBLE_INLINE constexpr std::int64_t multiply_add(std::int64_t sum, std::int32_t a, std::int32_t b) {
#if defined(__thumb2__)
    if (!std::is_constant_evaluated()) {
        asm("smlal %Q0, %R0, %1, %2" : "+r"(sum) : "r"(a), "r"(b));
        return sum;
    }
#endif
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(sum) + static_cast<std::uint64_t>(static_cast<std::int64_t>(a) * b));
}

}  // namespace detail

// The exact product, and sums of products: one SMULL or SMLAL each where the core has them.
template <int A, int B>
[[nodiscard]] TUMBLE_INLINE constexpr Wide<A + B> mul(Fixed<A> a, Fixed<B> b) {
    return {detail::multiply(a.raw, b.raw)};
}
template <int A, int B>
[[nodiscard]] TUMBLE_INLINE constexpr Wide<A + B> mul_add(Wide<A + B> sum, Fixed<A> a, Fixed<B> b) {
    return {detail::multiply_add(sum.raw, a.raw, b.raw)};
}
template <int A, int B>
[[nodiscard]] TUMBLE_INLINE constexpr Wide<A + B> mul_sub(Wide<A + B> sum, Fixed<A> a, Fixed<B> b) {
    return {detail::multiply_add(sum.raw, (-a).raw, b.raw)};
}

// Nearest Fixed, ties upwards. The caller's ranges guarantee that the result fits.
template <class To, int F>
[[nodiscard]] TUMBLE_INLINE constexpr To narrow(Wide<F> a) {
    constexpr int shift = F - To::fraction_bits;
    static_assert(shift >= 1 && shift < 64, "narrow() drops at least one bit");
    const auto half = std::uint64_t{1} << (shift - 1);
    return To::from_raw(static_cast<std::int32_t>(static_cast<std::int64_t>(static_cast<std::uint64_t>(a.raw) + half) >> shift));
}

}  // namespace tumble
