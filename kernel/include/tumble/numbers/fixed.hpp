// Fixed<F>: a 32-bit signed number with F fraction bits. Wide<F>: the 64-bit accumulator of its products.
// A product is exact, sums of products stay 64 bits wide, and narrow() rounds the result once, to nearest. Truncation
// would bias every update by half a unit and cost a hundred times the accuracy in free rotation.
#pragma once

#include <tumble/config.hpp>
#include <tumble/numbers/real.hpp>

namespace tumble {

template <int F>
struct Wide;

template <int F>
struct Fixed {
    static constexpr int fraction_bits = F;

    std::int32_t raw;  // not initialised by default, so that arrays of stages cost nothing; Fixed{} is zero

    [[nodiscard]] static constexpr Fixed from_raw(std::int32_t raw_value) { return Fixed{raw_value}; }
    // Rounds to nearest. Saturates at the ends of the format.
    [[nodiscard]] static constexpr Fixed from(Real value) {
        return Fixed{static_cast<std::int32_t>(value.to_fixed(F))};
    }
    // Exact: a double holds every Fixed. For hosts and tests: a firmware that calls it links double arithmetic.
    [[nodiscard]] explicit constexpr operator double() const { return Real::scaled(raw, -F).to_double(); }
    [[nodiscard]] explicit constexpr operator float() const { return Real::scaled(raw, -F).to_float(); }

    // Sums wrap at 2^32, which is defined. Formats have one bit more than the declared range needs, so sums within the
    // range do not wrap.
    friend constexpr Fixed operator+(Fixed a, Fixed b) { return {wrap(bits(a) + bits(b))}; }
    friend constexpr Fixed operator-(Fixed a, Fixed b) { return {wrap(bits(a) - bits(b))}; }
    constexpr Fixed operator-() const { return {wrap(0u - bits(*this))}; }
    constexpr Fixed& operator+=(Fixed b) { return *this = *this + b; }
    constexpr Fixed& operator-=(Fixed b) { return *this = *this - b; }
    friend constexpr bool operator==(Fixed, Fixed) = default;
    friend constexpr auto operator<=>(Fixed a, Fixed b) { return a.raw <=> b.raw; }

private:
    TUMBLE_INLINE static constexpr std::uint32_t bits(Fixed a) { return static_cast<std::uint32_t>(a.raw); }
    TUMBLE_INLINE static constexpr std::int32_t wrap(std::uint32_t v) { return static_cast<std::int32_t>(v); }
};

template <int F>
struct Wide {
    static constexpr int fraction_bits = F;

    std::int64_t raw;

    friend constexpr Wide operator+(Wide a, Wide b) { return {wrap(bits(a) + bits(b))}; }
    friend constexpr Wide operator-(Wide a, Wide b) { return {wrap(bits(a) - bits(b))}; }
    constexpr Wide operator-() const { return {wrap(0u - bits(*this))}; }
    constexpr Wide& operator+=(Wide b) { return *this = *this + b; }
    constexpr Wide& operator-=(Wide b) { return *this = *this - b; }
    friend constexpr bool operator==(Wide, Wide) = default;
    friend constexpr auto operator<=>(Wide a, Wide b) { return a.raw <=> b.raw; }

private:
    TUMBLE_INLINE static constexpr std::uint64_t bits(Wide a) { return static_cast<std::uint64_t>(a.raw); }
    TUMBLE_INLINE static constexpr std::int64_t wrap(std::uint64_t v) { return static_cast<std::int64_t>(v); }
};

namespace detail {

template <int F>
inline constexpr Fixed<F> one<Fixed<F>> = Fixed<F>::from_raw(std::int32_t{1} << F);

template <class T>
inline constexpr bool is_fixed = false;
template <int F>
inline constexpr bool is_fixed<Fixed<F>> = true;

// Whether a long product, 32 x 32 bits with all 64 bits of the result, costs no more than a few instructions. A
// Cortex-M0 has none, and one takes up to seven cycles on a Cortex-M3: there, powers of two are shifts.
#if defined(__ARM_ARCH_6M__) || defined(__ARM_ARCH_7M__)
inline constexpr bool long_products_are_fast = false;
#else
inline constexpr bool long_products_are_fast = true;
#endif

#if defined(__ARM_ARCH_6M__)
// GCC looks into a function for the registers that it leaves alone and the arguments that it uses, and sees none of
// them in assembly: `noipa` keeps it from looking. Clang does not look.
#if defined(__clang__)
#define TUMBLE_ASSEMBLY [[nodiscard, gnu::naked, gnu::noinline]]
#else
#define TUMBLE_ASSEMBLY [[nodiscard, gnu::naked, gnu::noipa]]
#endif
// For a core with 32-bit products only: a * b from four products of halves, 26 cycles with the call on a Cortex-M0. The
// compiler's code for the same takes 39, and the library's 64 x 64-bit product 80. A function, because 100 copies would
// take 3 kB.
TUMBLE_ASSEMBLY inline std::int64_t multiply_halves(std::int32_t /*a*/, std::int32_t /*b*/) {
    asm(".syntax unified\n\t"
        "mov ip, r4\n\t"
        "uxth r2, r0\n\t"
        "uxth r3, r1\n\t"
        "asrs r0, r0, #16\n\t"
        "asrs r1, r1, #16\n\t"
        "movs r4, r0\n\t"
        "muls r4, r3, r4\n\t"  // upper half of a by lower half of b
        "muls r3, r2, r3\n\t"  // lower by lower
        "muls r2, r1, r2\n\t"  // lower by upper
        "muls r1, r0, r1\n\t"  // upper by upper
        "lsls r0, r4, #16\n\t"
        "asrs r4, r4, #16\n\t"
        "adds r0, r0, r3\n\t"
        "adcs r1, r1, r4\n\t"
        "lsls r3, r2, #16\n\t"
        "asrs r2, r2, #16\n\t"
        "adds r0, r0, r3\n\t"
        "adcs r1, r1, r2\n\t"
        "mov r4, ip\n\t"
        "bx lr");
}
// a * a: three products, 18 cycles.
TUMBLE_ASSEMBLY inline std::int64_t square_halves(std::int32_t /*a*/) {
    asm(".syntax unified\n\t"
        "uxth r2, r0\n\t"
        "asrs r0, r0, #16\n\t"
        "movs r1, r0\n\t"
        "muls r1, r0, r1\n\t"  // upper by upper
        "movs r3, r2\n\t"
        "muls r3, r2, r3\n\t"  // lower by lower
        "muls r0, r2, r0\n\t"  // upper by lower, which counts twice
        "asrs r2, r0, #15\n\t"
        "lsls r0, r0, #17\n\t"
        "adds r0, r0, r3\n\t"
        "adcs r1, r1, r2\n\t"
        "bx lr");
}
#undef TUMBLE_ASSEMBLY
#endif

// a * b, and sum + a * b, with all 64 bits. Where a sign extension is used twice, compilers make a 64 x 64-bit product:
// four instructions in place of one. The assembly avoids this. It names both words, which keeps registers free that a
// 64-bit operand would bind in pairs. It is volatile, because a scheduler that moves products away from their uses
// spills a sixth more. Other cores use plain C++ and give the same bits.
[[nodiscard]] TUMBLE_INLINE constexpr std::int64_t multiply(std::int32_t a, std::int32_t b) {
#if defined(__thumb2__)
    if (!std::is_constant_evaluated() && !__builtin_constant_p(a) && !__builtin_constant_p(b)) {
        std::uint32_t low = 0, high = 0;
        asm volatile("smull %0, %1, %2, %3" : "=r"(low), "=r"(high) : "r"(a), "r"(b));
        return static_cast<std::int64_t>((static_cast<std::uint64_t>(high) << 32) | low);
    }
#elif defined(__ARM_ARCH_6M__)
    if (!std::is_constant_evaluated()) {
        const bool is_square = a == b;
        if (__builtin_constant_p(is_square) && is_square) return square_halves(a);
        return multiply_halves(a, b);
    }
#endif
    return static_cast<std::int64_t>(a) * b;
}
[[nodiscard]] TUMBLE_INLINE constexpr std::int64_t multiply_add(std::int64_t sum, std::int32_t a, std::int32_t b) {
#if defined(__thumb2__)
    if (!std::is_constant_evaluated()) {
        auto low = static_cast<std::uint32_t>(sum),
             high = static_cast<std::uint32_t>(static_cast<std::uint64_t>(sum) >> 32);
        asm volatile("smlal %0, %1, %2, %3" : "+r"(low), "+r"(high) : "r"(a), "r"(b));
        return static_cast<std::int64_t>((static_cast<std::uint64_t>(high) << 32) | low);
    }
#endif
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(sum) + static_cast<std::uint64_t>(multiply(a, b)));
}

// The upper word of a * b.
[[nodiscard]] TUMBLE_INLINE constexpr std::int32_t multiply_upper(std::int32_t a, std::int32_t b) {
#if defined(__thumb2__) && defined(__ARM_FEATURE_DSP)
    if (!std::is_constant_evaluated()) {
        std::int32_t high = 0;
        asm volatile("smmul %0, %1, %2" : "=r"(high) : "r"(a), "r"(b));
        return high;
    }
#endif
    return static_cast<std::int32_t>(multiply(a, b) >> 32);
}
// The upper word of sum + 2^32 upper + lower.
[[nodiscard]] TUMBLE_INLINE constexpr std::int32_t upper_of_sum(std::int64_t sum, std::int32_t upper,
                                                                std::uint32_t lower) {
#if defined(__ARM_ARCH_6M__)
    // Compilers would keep both words of the second number in memory, also where the upper one is zero.
    if (!std::is_constant_evaluated()) {
        auto low = static_cast<std::uint32_t>(sum);
        auto high = static_cast<std::int32_t>(sum >> 32);
        asm(".syntax unified\n\tadds %0, %0, %2\n\tadcs %1, %1, %3"
            : "+&l"(low), "+l"(high)  // `low` changes before `upper` is read, which may have its value
            : "l"(lower), "l"(upper)
            : "cc");
        return high;
    }
#endif
    const std::uint64_t other = (static_cast<std::uint64_t>(static_cast<std::uint32_t>(upper)) << 32) | lower;
    return static_cast<std::int32_t>(static_cast<std::int64_t>(static_cast<std::uint64_t>(sum) + other) >> 32);
}
// The upper word of 2^32 upper + lower + a * b. On a Cortex-M3 a sum is as fast as SMLAL, which would need copies of
// both words.
[[nodiscard]] TUMBLE_INLINE constexpr std::int32_t multiply_add_upper(std::int32_t upper, std::uint32_t lower,
                                                                      std::int32_t a, std::int32_t b) {
#if defined(__ARM_ARCH_7M__)
    if (!std::is_constant_evaluated()) {
        std::uint32_t low = 0;
        std::int32_t high = 0;
        asm volatile("smull %0, %1, %2, %3\n\tadds %0, %0, %4\n\tadc %1, %1, %5"
                     : "=&r"(low), "=&r"(high)
                     : "r"(a), "r"(b), "r"(lower), "rI"(upper)
                     : "cc");
        return high;
    }
#endif
    if constexpr (!long_products_are_fast) return upper_of_sum(multiply(a, b), upper, lower);
    const auto sum =
        static_cast<std::int64_t>((static_cast<std::uint64_t>(static_cast<std::uint32_t>(upper)) << 32) | lower);
    return static_cast<std::int32_t>(multiply_add(sum, a, b) >> 32);
}

// Loads a constant into a register as a whole. As an operand, compilers split it into up to four short constants.
[[nodiscard]] TUMBLE_INLINE constexpr std::int32_t whole(std::int32_t constant) {
#if defined(__thumb2__)
    if (!std::is_constant_evaluated()) asm volatile("" : "+r"(constant));
#endif
    return constant;
}

// Makes the compiler load words from memory again. It would keep a loaded word for a later use, which costs a store and
// a load where registers are few.
TUMBLE_INLINE constexpr void forget_loaded() {
#if defined(__thumb2__)
    if (!std::is_constant_evaluated()) asm volatile("" ::: "memory");
#endif
}

// Keeps copies of words apart. Compilers would merge them into a call of memmove, which costs four times as much.
TUMBLE_INLINE constexpr void keep_apart() {
#if defined(__arm__) || defined(__riscv)
    if (!std::is_constant_evaluated()) asm volatile("" ::: "memory");
#endif
}

}  // namespace detail

// The exact product, and sums of products: one SMULL or SMLAL each on a core that has them.
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

// Rounds to the nearest Fixed, ties upwards. The caller's ranges guarantee that the result fits.
template <class To, int F>
[[nodiscard]] TUMBLE_INLINE constexpr To narrow(Wide<F> a) {
    constexpr int shift = F - To::fraction_bits;
    static_assert(shift >= 1 && shift < 64, "narrow() drops at least one bit");
    const auto half = std::uint64_t{1} << (shift - 1);
    return To::from_raw(
        static_cast<std::int32_t>(static_cast<std::int64_t>(static_cast<std::uint64_t>(a.raw) + half) >> shift));
}

// A product in the format of its factors, rounded to nearest, for a program that computes in one format. The kernel
// rounds sums of products once.
template <int F>
[[nodiscard]] TUMBLE_INLINE constexpr Fixed<F> operator*(Fixed<F> a, Fixed<F> b) {
    return narrow<Fixed<F>>(mul(a, b));
}

// The upper word of a product, rounded down, which is free on a 32-bit core. For small corrections, in which a bias of
// half a unit does not matter.
template <int F>
[[nodiscard]] TUMBLE_INLINE constexpr Fixed<F - 32> upper_word(Wide<F> a) {
    return {static_cast<std::int32_t>(a.raw >> 32)};
}
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] TUMBLE_INLINE constexpr T upper_word(T a) { return a; }
// upper_word() of a * b.
template <int A, int B>
[[nodiscard]] TUMBLE_INLINE constexpr Fixed<A + B - 32> mul_upper(Fixed<A> a, Fixed<B> b) {
    return {detail::multiply_upper(a.raw, b.raw)};
}
template <class T>
requires std::is_floating_point_v<T>
[[nodiscard]] TUMBLE_INLINE constexpr T mul_upper(T a, T b) { return a * b; }

}  // namespace tumble
