// Square roots and small-angle sines with the same bits everywhere: in integers for Scaled and Fixed, in correctly
// rounded IEEE operations for float and double. No library mathematics.
#pragma once

#include <tumble/numbers/scaled.hpp>

namespace tumble {

// floor(sqrt(a)): 32 rounds of shift, compare and subtract, one bit of the result each.
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

// a >= 0. A negative argument, which only rounding can produce, counts as zero.
[[nodiscard]] constexpr Scaled sqrt(Scaled a) {
    if (a <= Scaled{}) return {};
    const int odd = a.exponent() & 1;
    const auto radicand = static_cast<std::uint64_t>(a.mantissa()) << (32 + odd);
    return Scaled::of(integer_sqrt(radicand), (a.exponent() - odd - 32) / 2);
}

namespace detail {

// The correctly rounded square root, computed from the bits of an IEEE number, for cores without a hardware root. Equal
// to the hardware's.
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
        while ((mantissa >> fraction_bits) == 0) {
            mantissa <<= 1;
            --exponent;
        }
    } else {
        mantissa |= one << fraction_bits;
    }
    exponent -= bias;
    if ((exponent & 1) != 0) {
        mantissa <<= 1;
        --exponent;
    }
    // Digit by digit: fraction_bits + 2 result bits, the last of which decides the rounding.
    Bits root = 0, rest = 0;
    for (int i = fraction_bits + 1; i >= 0; --i) {
        const int position = 2 * i - (fraction_bits + 2);  // place of the next two radicand bits within the mantissa
        const Bits next = position >= 0 ? (mantissa >> position) & 3 : position == -1 ? (mantissa << 1) & 3 : 0;
        rest = (rest << 2) | next;
        const Bits trial = (root << 2) | 1;
        root <<= 1;
        if (rest >= trial) {
            rest -= trial;
            root |= 1;
        }
    }
    // A root is never halfway between two numbers, so the last bit decides, whatever the rest.
    const Bits rounded = (root >> 1) + (root & 1);
    return std::bit_cast<T>(static_cast<Bits>(rounded + (static_cast<Bits>(exponent / 2 + bias - 1) << fraction_bits)));
}

}  // namespace detail

// IEEE square root, ties to even. Negative arguments give 0.
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

// The length of a vector.
template <class T>
[[nodiscard]] constexpr T norm(const Vector3<T>& v) {
    return sqrt(dot(v, v));
}

// The angle of the direction (x, y), rad, in (-pi, pi]; 0 of no direction. By a quotient of at most 1, three halvings
// of its angle, tan(a / 2) = t / (1 + sqrt(1 + t^2)), and eight terms of the series, of which the next is below 2^-57.
template <class T>
[[nodiscard]] constexpr T arc_tangent(T y, T x) {
    const auto size = [](T a) { return a < T(0) ? -a : a; };
    const auto constant = [](const Real& value) { return static_cast<T>(value); };
    if (size(x) < size(y)) {
        const T quarter = constant(Real::scaled(0x3243f6a8885a308d, -61));
        return (y < T(0) ? -quarter : quarter) - arc_tangent(y < T(0) ? -x : x, size(y));
    }
    if (!(size(x) > T(0))) return T(0);
    T t = y / x;
    for (int i = 0; i < 3; ++i) t = t / (T(1) + sqrt(T(1) + t * t));
    const T square = t * t;
    T sum(0);
    for (int n = 7; n >= 0; --n) sum = constant(Real{1} / Real{2 * n + 1}) - square * sum;
    const T angle = t * sum * T(8), half = constant(Real::scaled(0x3243f6a8885a308d, -60));
    if (x > T(0)) return angle;
    return y < T(0) ? angle - half : angle + half;
}

// The series of sine and cosine of the half angle x, in z = x^2. The leading terms are left out, so that nothing
// cancels: cosine = 1 + cos_less_one, sine = x + x * sinc_less_one. Both come from the same z.
template <class T>
struct SinCosSeries;

// For |x| <= 1/4, with an error below 2^-33: 3 and 3 multiplications. For |x| <= 1/16: 2 and 2.
template <>
struct SinCosSeries<Fixed<32>> {
    using T = Fixed<32>;
    T sinc_less_one, cos_less_one;

    [[nodiscard]] TUMBLE_INLINE static constexpr SinCosSeries of(T z) {
        return {mul_upper(z, mul_upper(z, over<120>() - mul_upper(z, over<5040>())) - over<6>()),
                mul_upper(z, mul_upper(z, over<24>() - mul_upper(z, over<720>()))) - half(z)};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr SinCosSeries of_small(T z) {
        // z^3 / 720 is left out: it is at most 2^-33.5.
        return {mul_upper(z, mul_upper(z, over<120>()) - over<6>()), mul_upper(z, mul_upper(z, over<24>())) - half(z)};
    }

private:
    template <int n>
    static constexpr T over() {
        constexpr T constant = T::from(Real{1} / Real{n});
        return {detail::whole(constant.raw)};
    }
    static constexpr T half(T z) { return {z.raw >> 1}; }
};

// float and double, for any x. The series serves |x| <= 1/4 to rounding. Larger angles are halved and then doubled
// back.
template <class T>
struct SinCosSeries {
    T sinc_less_one, cos_less_one;

    // An infinite z gives NaN.
    [[nodiscard]] TUMBLE_INLINE static constexpr SinCosSeries of(T z) {
        if (is_large(z)) [[unlikely]]
            return of_large(z);
        return series(z);
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr SinCosSeries of_small(T z) { return of(z); }

private:
    // z > 1/16, for z >= 0. As integers, single numbers need no constant from memory and no move of the FPU's flags.
    [[nodiscard]] TUMBLE_INLINE static constexpr bool is_large(T z) {
        if constexpr (sizeof(T) == 4) return std::bit_cast<std::int32_t>(z) > std::bit_cast<std::int32_t>(T(0.0625));
        else return z > T(0.0625);
    }
    // Out of line: inlined copies would be most of the code of a step.
    [[nodiscard, gnu::noinline, gnu::cold]] static constexpr SinCosSeries of_large(T z) {
        if (!(z - z == T(0))) return {z - z, z - z};
        int doublings = 0;
        while (z > T(0.0625)) {
            z *= T(0.25);
            ++doublings;
        }
        SinCosSeries s = series(z);
        for (; doublings > 0; --doublings) {
            // sinc 2x = sinc x cos x;  cos 2x - 1 = -2 sin^2 x
            const T sinc = T(1) + s.sinc_less_one;
            s = {s.sinc_less_one + s.cos_less_one * sinc, -(sinc * sinc * z * T(2))};
            z *= T(4);
        }
        return s;
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr SinCosSeries series(T z) {
        return {horner<3>(z) * z, horner<2>(z) * z};
    }
    // The sum over n of -(-z)^n / (first + 2n)!.
    template <int first, int n = 0>
    [[nodiscard]] TUMBLE_INLINE static constexpr T horner(T z) {
        constexpr int last = sizeof(T) == 4 ? 2 : 6;  // the next term is below half a unit in the last place
        constexpr T c = signed_reciprocal(first, n);
        if constexpr (n == last) return c;
        else return c + z * horner<first, n + 1>(z);
    }
    [[nodiscard]] static constexpr T signed_reciprocal(int first, int n) {
        double product = n % 2 == 0 ? -1 : 1;
        for (int i = 2; i <= first + 2 * n; ++i) product *= i;
        return static_cast<T>(1 / product);
    }
};

}  // namespace tumble
