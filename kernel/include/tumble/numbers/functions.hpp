// Square roots and small-angle sines that give the same bits everywhere: integers for Scaled and Fixed, correctly
// rounded IEEE operations for float and double. No library mathematics.
#pragma once

#include <tumble/numbers/scaled.hpp>

namespace tumble {

// floor(sqrt(a)), one result bit a round: 32 rounds of shift, compare and subtract.
[[nodiscard, gnu::noinline]] constexpr std::uint32_t integer_sqrt(std::uint64_t a) {
    std::uint64_t rest = a, root = 0;
    for (std::uint64_t bit = std::uint64_t{1} << 62; bit != 0; bit >>= 2) {
        if (rest >= root + bit) {
            rest -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return static_cast<std::uint32_t>(root);
}

// a >= 0 (a negative argument, which only rounding can produce, counts as zero).
[[nodiscard]] constexpr Scaled sqrt(Scaled a) {
    if (a <= Scaled{}) return {};
    const int odd = a.exponent() & 1;
    const auto radicand = static_cast<std::uint64_t>(a.mantissa()) << (32 + odd);
    return Scaled::of(integer_sqrt(radicand), (a.exponent() - odd - 32) / 2);
}

namespace detail {

// Correctly rounded sqrt from the bits of an IEEE number: what hardware gives, for cores that have none.
template <class T, class Bits, int fraction_bits, int bias>
[[nodiscard]] constexpr T ieee_sqrt(T a) {
    const auto bits = std::bit_cast<Bits>(a);
    constexpr Bits one = 1;
    constexpr int exponent_mask = 2 * bias + 1;
    const auto field = static_cast<int>(bits >> fraction_bits);
    if (!(a > T(0)) || field == exponent_mask) return a > T(0) || a == T(0) ? a : T(0);
    Bits mantissa = bits & ((one << fraction_bits) - 1);
    int exponent = field;
    if (field == 0) {
        exponent = 1;
        while ((mantissa >> fraction_bits) == 0) { mantissa <<= 1; --exponent; }
    } else {
        mantissa |= one << fraction_bits;
    }
    exponent -= bias;
    if ((exponent & 1) != 0) { mantissa <<= 1; --exponent; }
    // Digit by digit: fraction_bits + 2 result bits, the last of them for rounding.
    Bits root = 0, rest = 0;
    for (int i = fraction_bits + 1; i >= 0; --i) {
        const int position = 2 * i - (fraction_bits + 2);   // of the next two radicand bits within the mantissa
        const Bits next = position >= 0 ? (mantissa >> position) & 3 : position == -1 ? (mantissa << 1) & 3 : 0;
        rest = (rest << 2) | next;
        const Bits trial = (root << 2) | 1;
        root <<= 1;
        if (rest >= trial) { rest -= trial; root |= 1; }
    }
    // A root is never halfway: the last bit decides, whatever the rest.
    const Bits rounded = (root >> 1) + (root & 1);
    return std::bit_cast<T>(static_cast<Bits>(rounded + (static_cast<Bits>(exponent / 2 + bias - 1) << fraction_bits)));
}

}  // namespace detail

// IEEE square root, ties to even; negative arguments give 0.
[[nodiscard]] constexpr float sqrt(float a) {
#if defined(__SSE2__) || (defined(__ARM_FP) && (__ARM_FP & 4))
    if (!std::is_constant_evaluated()) return a > 0 ? __builtin_sqrtf(a) : 0.0f;
#endif
    return detail::ieee_sqrt<float, std::uint32_t, 23, 127>(a);
}
[[nodiscard]] constexpr double sqrt(double a) {
#if defined(__SSE2__) || (defined(__ARM_FP) && (__ARM_FP & 8))
    if (!std::is_constant_evaluated()) return a > 0 ? __builtin_sqrt(a) : 0.0;
#endif
    return detail::ieee_sqrt<double, std::uint64_t, 52, 1023>(a);
}

// The even series of a rotation by the half angle x, in z = x^2, kept relative to identity so that nothing cancels:
// cosine = 1 - one_minus_cos(z), sine = x - x * one_minus_sinc(z).
//
// Fixed: for |x| <= 1/4 (z <= 1/16), truncation below 2^-33. 3 and 3 multiplications, no division, no square root.
[[nodiscard]] constexpr Fixed<32> one_minus_sinc(Fixed<32> z) {
    constexpr auto c1 = Fixed<32>::from(Real{1} / Real{6}), c2 = Fixed<32>::from(Real{1} / Real{120}),
                   c3 = Fixed<32>::from(Real{1} / Real{5040});
    return narrow<Fixed<32>>(mul(z, c1 - narrow<Fixed<32>>(mul(z, c2 - narrow<Fixed<32>>(mul(z, c3))))));
}
[[nodiscard]] constexpr Fixed<32> one_minus_cos(Fixed<32> z) {
    constexpr auto c2 = Fixed<32>::from(Real{1} / Real{24}), c3 = Fixed<32>::from(Real{1} / Real{720});
    const auto rest = narrow<Fixed<32>>(mul(z, c2 - narrow<Fixed<32>>(mul(z, c3))));
    return narrow<Fixed<32>>(mul(z, Fixed<32>::from_raw(0x7fffffff) - rest));   // 1/2 less 2^-32, times z < 2^-4
}

namespace detail {

// sum over n of (-1)^n z^n first / (...): Horner with the exact ratios of a Taylor series of sine or cosine.
template <class T, int terms, int start>
[[nodiscard]] TUMBLE_INLINE constexpr T alternating_series(T z) {
    T sum = 0;
    for (int n = terms; n >= 0; --n) {
        const int k = start + 2 * n;
        sum = (T(1) - sum) * z * (T(1) / static_cast<T>(k * (k + 1)));
    }
    return sum;
}

}  // namespace detail

// float and double: to the last bits for |x| <= 1 by series; larger angles by halving and doubling back.
template <class T>
struct SinCosSeries {
    T one_minus_sinc, one_minus_cos;

    [[nodiscard]] static constexpr SinCosSeries of(T z) {
        constexpr int terms = sizeof(T) == 4 ? 4 : 8;
        if (z > T(1)) [[unlikely]] {
            // sinc 2x = sinc x cos x;  1 - cos 2x = 2 sin^2 x
            const SinCosSeries half = of(z * T(0.25));
            const T sinc = T(1) - half.one_minus_sinc;
            return {half.one_minus_sinc + half.one_minus_cos * sinc, sinc * sinc * z * T(0.5)};
        }
        return {detail::alternating_series<T, terms, 2>(z), detail::alternating_series<T, terms, 1>(z)};
    }
};
[[nodiscard]] constexpr float one_minus_sinc(float z) { return SinCosSeries<float>::of(z).one_minus_sinc; }
[[nodiscard]] constexpr float one_minus_cos(float z) { return SinCosSeries<float>::of(z).one_minus_cos; }
[[nodiscard]] constexpr double one_minus_sinc(double z) { return SinCosSeries<double>::of(z).one_minus_sinc; }
[[nodiscard]] constexpr double one_minus_cos(double z) { return SinCosSeries<double>::of(z).one_minus_cos; }

// 1 / sqrt(a), a > 0: two roundings.
template <class T>
[[nodiscard]] constexpr T rsqrt(T a) { return T(1) / sqrt(a); }

}  // namespace tumble
