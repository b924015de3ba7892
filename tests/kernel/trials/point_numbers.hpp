// The numbers of PointSolver: FixedPointNumbers has the formats of a fixed-point system's contacts; FloatNumbers<T> are
// floats or doubles. The solver is written once, with these functions.
//
// In fixed point the caller decides the binary point of speeds and impulses. Every rounding is to nearest with ties
// away from zero: a sign that is changed everywhere changes no other bit, and the mirror image of a problem has the
// mirror image of its solution. A number that does not fit is held at the end of its format, which happens only on the
// way to no solution.
#pragma once

#include <tumble/numbers/q32_contact.hpp>

namespace tumble {

struct FixedPointNumbers {
    using Unit = Fixed<30>;       // a component of a direction; a share
    using Lever = Fixed<24>;      // below 64
    using Friction = Fixed<24>;   // below 128
    using Speed = Fixed<30>;      // Fixed for its operations only
    using Entry = Fixed<30>;      // of a matrix, below 2
    using Sum = std::int64_t;     // of speeds
    using Square = std::int64_t;  // of a row; of speeds
    static constexpr std::int32_t most = (1 << 30) - 1;

    // x / 2^down. `down` may be negative.
    [[nodiscard]] static std::int32_t rounded(std::int64_t x, int down) {
        if (down > 0) x = round_off(x, down > 62 ? 62 : down);
        else if (x < most && x > -most) x *= std::int64_t{1} << (down < -32 ? 32 : -down);
        return static_cast<std::int32_t>(x > most ? most : x < -most ? -most : x);
    }
    [[nodiscard, gnu::noinline]] static Speed shifted(Speed s, int up) { return {rounded(s.raw, -up)}; }
    [[nodiscard]] static Speed shifted(Sum s, int up) { return {rounded(s, -up)}; }
    [[nodiscard]] static Speed sum(Speed a, Speed b) { return {rounded(std::int64_t{a.raw} + b.raw, 0)}; }
    [[nodiscard]] static Sum wide(Speed s) { return s.raw; }
    [[nodiscard]] static constexpr Speed largest() { return {most}; }
    [[nodiscard]] static bool fits(Sum s) { return s < most && s > -most; }
    [[nodiscard]] static Speed size(Speed s) { return s < Speed{} ? -s : s; }
    // a b in the format of b.
    template <int F, class T>
    [[nodiscard]] static T product(Fixed<F> a, T b) {
        return {rounded(detail::multiply(a.raw, b.raw), F)};
    }
    template <int F>
    [[nodiscard]] static Speed dot(const Fixed<F> (&a)[3], const Speed* b) {
        return {rounded(exact_dot(a, b), F)};
    }
    // Adds a^T b.
    template <int F>
    static void add_transposed(Sum* sum, const Fixed<F> (&a)[3][3], const Speed* b) {
        for (int j = 0; j < 3; ++j) {
            const Fixed<F> column[3] = {a[0][j], a[1][j], a[2][j]};
            sum[j] += round_off(exact_dot(column, b), F);
        }
    }

    // 1 + l . l
    [[nodiscard]] static Square one_and_square(const Lever (&l)[3]) {
        Square sum = Square{1} << 48;
        for (const Lever c : l) sum = detail::multiply_add(sum, c.raw, c.raw);
        return sum;
    }
    // The power of two that is not above it.
    [[nodiscard]] static int log2(Square s) {
        return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(s))) - 49;
    }
    // The power of two above 1 + mu.
    [[nodiscard]] static int log2_above(Friction mu) {
        return static_cast<int>(std::bit_width(static_cast<std::uint32_t>(mu.raw) + (1u << 24))) - 24;
    }
    // The power of two above a lever of at least 1/2.
    [[nodiscard]] static int log2_above_lever(Lever l) {
        return static_cast<int>(std::bit_width(static_cast<std::uint32_t>(l.raw < 0 ? -l.raw : l.raw))) - 24;
    }
    [[nodiscard]] static Entry power(int log2) { return {log2 < -30 ? 1 : 1 << (30 + log2)}; }
    // A component of a row, over 2^down.
    [[nodiscard]] static Entry entry(Unit d, int down) { return {rounded(d.raw, down)}; }
    [[nodiscard]] static Entry entry(Lever l, int down) { return {rounded(l.raw, down - 6)}; }
    // By how many bits a speed may be scaled up to stay below 2^bits.
    [[nodiscard]] static int room(Speed largest, int bits) {
        return bits - static_cast<int>(std::bit_width(static_cast<std::uint32_t>(largest.raw)));
    }

    // 1 / x, for any x but 0, to 2^-29. No division: a straight line, wrong by 1/17 at most, and three Newton steps.
    class Inverse {
    public:
        Inverse() = default;
        explicit Inverse(Entry e) {
            const std::int32_t x = size(e).raw < 0 ? 0x7fffffff : size(e).raw;  // -2^31 has no positive
            const int up = std::countl_zero(static_cast<std::uint32_t>(x)) - 1;
            const std::int32_t m = x << up;  // [2^30, 2^31)
            // y = 2^60 / m: 2^29 (48 - 32 m / 2^31) / 17, then y <- y + y (1 - m y)
            std::int32_t y = 1515870810 - detail::multiply_upper(m, 2021161080);
            for (int i = 0; i < 3; ++i) {
                const std::int64_t left = (std::int64_t{1} << 60) - detail::multiply(m, y);
                y += static_cast<std::int32_t>(detail::multiply(y, static_cast<std::int32_t>(left >> 30)) >> 30);
            }
            mantissa_ = e.raw < 0 ? -y : y;
            down_ = 30 - up;
        }
        // a / x times 2^up, in the format of a.
        template <class T>
        [[nodiscard]] T times(T a, int up = 0) const {
            return {rounded(detail::multiply(a.raw, mantissa_), down_ - up)};
        }

    private:
        std::int32_t mantissa_;
        int down_;
    };
    // a / b times 2^up for a >= 0 and b > 0, at most 1.
    [[nodiscard]] static Unit ratio(Speed a, Speed b, int up) { return Inverse{b}.times(a, up); }
    // The direction of (a, b), or zero. Returns the length.
    [[nodiscard]] static Speed direction(Speed a, Speed b, Unit (&d)[2]) {
        const std::int64_t square = detail::multiply_add(detail::multiply(a.raw, a.raw), b.raw, b.raw);
        const auto root = detail::inverse_root(static_cast<std::uint64_t>(square));
        for (int k = 0; k < 2; ++k)
            d[k] = {rounded(detail::multiply(k == 0 ? a.raw : b.raw, root.raw), -(root.exponent + 30))};
        return {rounded(detail::multiply_add(detail::multiply(a.raw, d[0].raw), b.raw, d[1].raw), 30)};
    }
    // Adds a b; six of them fit.
    static void add_energy(Square& sum, Speed a, Speed b) { sum += detail::multiply(a.raw, b.raw) >> 5; }
    // a / b, at least 0 and at most 1.
    [[nodiscard]] static Unit ratio_of_energies(Square a, Square b) {
        if (!(a > 0)) return {0};
        if (a >= b) return {1 << 30};
        const int down = 35 - std::countl_zero(static_cast<std::uint64_t>(b));
        return ratio({rounded(a, down)}, {rounded(b, down)}, 0);
    }

private:
    // x / 2^down, for down > 0.
    [[nodiscard]] TUMBLE_INLINE static std::int64_t round_off(std::int64_t x, int down) {
        return (x + (std::int64_t{1} << (down - 1)) + (x >> 63)) >> down;
    }
    template <int F>
    [[nodiscard]] static std::int64_t exact_dot(const Fixed<F> (&a)[3], const Speed* b) {
        return detail::multiply_add(detail::multiply_add(detail::multiply(a[0].raw, b[0].raw), a[1].raw, b[1].raw),
                                    a[2].raw, b[2].raw);
    }
};

template <class T>
struct FloatNumbers {
    using Unit = T;
    using Lever = T;
    using Friction = T;
    using Speed = T;
    using Entry = T;
    using Sum = T;
    using Square = T;

    [[nodiscard]] static T power(int log2) { return std::bit_cast<T>(static_cast<Bits>(bias + log2) << fraction_bits); }
    [[nodiscard]] static T shifted(T s, int up) { return s * power(up); }
    [[nodiscard]] static T sum(T a, T b) { return a + b; }
    [[nodiscard]] static T wide(T s) { return s; }
    [[nodiscard]] static constexpr T largest() { return std::numeric_limits<T>::max(); }
    [[nodiscard]] static bool fits(T s) { return s - s == T(0); }
    [[nodiscard]] static T size(T s) { return s < T(0) ? -s : s; }
    [[nodiscard]] static T product(T a, T b) { return a * b; }
    [[nodiscard]] static T dot(const T (&a)[3], const T* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
    static void add_transposed(T* sum, const T (&a)[3][3], const T* b) {
        for (int j = 0; j < 3; ++j) sum[j] += a[0][j] * b[0] + a[1][j] * b[1] + a[2][j] * b[2];
    }
    [[nodiscard]] static T one_and_square(const T (&l)[3]) { return T(1) + dot(l, l); }
    [[nodiscard]] static int log2(T s) { return static_cast<int>(std::bit_cast<Bits>(s) >> fraction_bits) - bias; }
    [[nodiscard]] static int log2_above_lever(T l) { return log2(size(l) + T(0)) + 1; }
    [[nodiscard]] static int log2_above(T mu) { return log2(T(1) + mu) + 1; }
    [[nodiscard]] static T entry(T a, int down) { return shifted(a, -down); }
    [[nodiscard]] static int room(T, int) { return 0; }
    class Inverse {
    public:
        Inverse() = default;
        explicit Inverse(T x) : inverse_{T(1) / x} {}
        [[nodiscard]] T times(T a) const { return a * inverse_; }

    private:
        T inverse_;
    };
    [[nodiscard]] static T ratio(T a, T b, int up) {
        const T scaled = shifted(a, up);
        return scaled < b ? scaled / b : T(1);
    }
    [[nodiscard]] static T direction(T a, T b, T (&d)[2]) {
        const T length = tumble::sqrt(a * a + b * b), inverse = length > T(0) ? T(1) / length : T(0);
        d[0] = a * inverse;
        d[1] = b * inverse;
        return length;
    }
    static void add_energy(T& sum, T a, T b) { sum += a * b; }
    [[nodiscard]] static T ratio_of_energies(T a, T b) { return !(a > T(0)) ? T(0) : a < b ? a / b : T(1); }

private:
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    static constexpr int fraction_bits = sizeof(T) == 4 ? 23 : 52, bias = sizeof(T) == 4 ? 127 : 1023;
};

}  // namespace tumble
