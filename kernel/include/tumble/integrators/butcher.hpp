// Butcher tables of explicit Runge-Kutta methods, and weighted sums whose weights are known at compile time: a zero
// entry costs nothing, a power of two costs a shift. One stepping function (runge_kutta.hpp) runs every table.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

// A fraction known at compile time, for example an entry of a Butcher table.
struct Rational {
    int numerator = 0;
    int denominator = 1;
    [[nodiscard]] constexpr bool is_zero() const { return numerator == 0; }
    [[nodiscard]] constexpr bool is_dyadic() const { return (denominator & (denominator - 1)) == 0; }
    friend constexpr bool operator==(Rational, Rational) = default;
    friend constexpr Rational operator+(Rational a, Rational b) {
        return reduced(a.numerator * b.denominator + b.numerator * a.denominator, a.denominator * b.denominator);
    }
    friend constexpr Rational operator*(Rational a, Rational b) {
        return reduced(a.numerator * b.numerator, a.denominator * b.denominator);
    }

    // The fraction in lowest terms, so that 2/2 is 1.
    [[nodiscard]] static constexpr Rational reduced(int numerator, int denominator) {
        int a = numerator < 0 ? -numerator : numerator, b = denominator;
        while (b != 0) {
            const int t = a % b;
            a = b;
            b = t;
        }
        return a == 0 ? Rational{} : Rational{numerator / a, denominator / a};
    }
};

// The least common denominator of fractions.
template <int count>
[[nodiscard]] constexpr int common_denominator(const Rational (&fractions)[count]) {
    int d = 1;
    for (const Rational& r : fractions) d = Rational::reduced(d, r.denominator).numerator * r.denominator;
    return d;
}

template <int S>
struct ButcherTable {
    static constexpr int stages = S;
    Rational a[S][S];  // strictly lower triangular
    Rational b[S];

    // Nystroem's form of the table, for positions. They follow from the kicks and from the drift d at the start: stage
    // s is at x + node(s) d + sum_j of_kick(s, j) kick_j, and the step ends at x + d + sum_j arrivals().of[j] kick_j
    // (E. Hairer, S. P. Noersett and G. Wanner, Solving Ordinary Differential Equations I, section II.14).
    [[nodiscard]] constexpr Rational node(int s) const {
        Rational c;
        for (int j = 0; j < s; ++j) c = c + a[s][j];
        return c;
    }
    [[nodiscard]] constexpr Rational of_kick(int s, int j) const {
        Rational sum;
        for (int i = j + 1; i < s; ++i) sum = sum + a[s][i] * a[i][j];
        return sum;
    }
    struct Weights {
        Rational of[S];
        // The least common denominator, and a weight times it.
        [[nodiscard]] constexpr int denominator() const { return common_denominator(of); }
        [[nodiscard]] constexpr Rational whole(int i) const { return of[i] * Rational{denominator(), 1}; }
    };
    [[nodiscard]] constexpr Weights arrivals() const {
        Weights sum;
        for (int j = 0; j < S; ++j)
            for (int s = j + 1; s < S; ++s) sum.of[j] = sum.of[j] + b[s] * a[s][j];
        return sum;
    }
    // The least common denominator of the weights; b[i] is weight(i) / denominator().
    [[nodiscard]] constexpr int denominator() const { return common_denominator(b); }
    [[nodiscard]] constexpr int weight(int i) const { return b[i].numerator * (denominator() / b[i].denominator); }
    // The first stage that stage s uses, or s. Below: the first that has a weight, and the first with stage i's weight.
    [[nodiscard]] constexpr int first_before(int s) const {
        int first = 0;
        while (first < s && a[s][first].is_zero()) ++first;
        return first;
    }
    [[nodiscard]] constexpr int first_weighted() const {
        int first = 0;
        while (b[first].is_zero()) ++first;
        return first;
    }
    [[nodiscard]] constexpr int first_of_weight(int i) const {
        int first = 0;
        while (!(b[first] == b[i])) ++first;
        return first;
    }
};

inline constexpr ButcherTable<1> euler_table{{{{}}}, {{1, 1}}};
inline constexpr ButcherTable<2> midpoint_table{{{{}, {}}, {{1, 2}, {}}}, {{}, {1, 1}}};
inline constexpr ButcherTable<2> heun_table{{{{}, {}}, {{1, 1}, {}}}, {{1, 2}, {1, 2}}};
inline constexpr ButcherTable<4> rk4_table{
    {{{}, {}, {}, {}}, {{1, 2}, {}, {}, {}}, {{}, {1, 2}, {}, {}}, {{}, {}, {1, 1}, {}}},
    {{1, 6}, {1, 3}, {1, 3}, {1, 6}}};

namespace detail {

// Calls f with std::integral_constant 0 .. N-1, so that table entries are constants in each call.
template <int N, class F>
TUMBLE_INLINE void unroll(F&& f) {
    [&]<int... i>(std::integer_sequence<int, i...>) { (f(std::integral_constant<int, i>{}), ...); }
    (std::make_integer_sequence<int, N>{});
}

// 2^bits * r, rounded to nearest.
[[nodiscard]] constexpr std::int64_t scaled_rational(Rational r, int bits) {
    return (Real{r.numerator} / Real{r.denominator}).to_fixed(bits, 64);
}

// r * a: a shift for dyadic r, otherwise one division by a small constant (a libgcc call on a 32-bit core).
template <Rational r, int F>
[[nodiscard]] TUMBLE_INLINE Wide<F> times(Wide<F> a) {
    if constexpr (r == Rational{1, 1}) return a;
    else if constexpr (r.is_dyadic())
        return {
            static_cast<std::int64_t>(static_cast<std::uint64_t>(a.raw) * static_cast<std::uint64_t>(r.numerator)) >>
            log2_of(r.denominator)};
    else return {a.raw / r.denominator * r.numerator};
}
// r * a, as an accumulator with 32 more fraction bits.
template <Rational r, int F>
[[nodiscard]] TUMBLE_INLINE Wide<F + 32> weighted(Fixed<F> a) {
    if constexpr (r.is_dyadic()) {
        constexpr std::int64_t factor = scaled_rational(r, 32);
        return {static_cast<std::int64_t>(a.raw) * factor};
    } else {
        static_assert(
            2 * r.numerator < r.denominator && -2 * r.numerator < r.denominator,
            "an entry of a Butcher table that is no dyadic fraction must be below 1/2 in fixed point, and one "
            "of `a` below 1/4");
        return mul(a, Fixed<32>::from_raw(static_cast<std::int32_t>(scaled_rational(r, 32))));
    }
}
template <Rational r, int F>
[[nodiscard]] TUMBLE_INLINE Fixed<F> times(Fixed<F> a) {
    if constexpr (r == Rational{1, 1}) return a;
    else if constexpr (r.is_dyadic()) return {(a.raw * r.numerator) >> log2_of(r.denominator)};
    else return narrow<Fixed<F>>(weighted<r>(a));
}
template <Rational r, class T>
[[nodiscard]] TUMBLE_INLINE T times(T a) {
    if constexpr (r == Rational{1, 1}) return a;
    else return a * (static_cast<T>(r.numerator) / static_cast<T>(r.denominator));
}
template <Rational r, class T>
[[nodiscard]] TUMBLE_INLINE T weighted(T a) {
    return times<r>(a);
}

}  // namespace detail
}  // namespace tumble
