// LoadNumbers<N>: the arithmetic of loads. A load is a vector, taken from differences of the state, times a factor. In
// fixed point the vector is a block (three mantissas of 30 bits with one exponent), the factor is a mantissa of 31 bits
// with an exponent, and their products are added to the state's own 64-bit sums. Nothing is normalised between the
// operations on a vector. In floating point vector and factor are plain numbers.
#pragma once

#include <tumble/numbers/vector_block.hpp>

namespace tumble {

template <class N>
struct LoadNumbers;

template <class N>
requires(N::fixed_point) struct LoadNumbers<N> {
    using Work = typename N::Work;
    using Vector = VectorBlock<N>;
    // mantissa * 2^exponent, with 2^30 <= |mantissa| < 2^31; zero has the mantissa 0 and any exponent.
    struct Factor {
        std::int32_t mantissa = 0;
        int exponent = 0;
    };

    [[nodiscard]] TUMBLE_INLINE static constexpr Factor factor(Work w) { return {w.mantissa(), w.exponent()}; }
    [[nodiscard]] static constexpr Work work(Factor f) { return Work::of(f.mantissa, f.exponent); }
    [[nodiscard]] TUMBLE_INLINE static constexpr Factor one() { return {1 << 30, -30}; }
    [[nodiscard]] TUMBLE_INLINE static constexpr bool is_zero(Factor f) { return f.mantissa == 0; }

    // a * b, rounded to nearest. A mantissa just below 2^30 may be left: rounding must not carry.
    [[nodiscard]] TUMBLE_INLINE static constexpr Factor product(Factor a, Factor b) {
        const std::int64_t raw = detail::multiply(a.mantissa, b.mantissa);  // 2^60 to 2^62, or zero
        const auto upper = static_cast<std::uint32_t>(static_cast<std::uint64_t>(raw) >> 32);
        const int exponent = a.exponent + b.exponent;
        if (upper + 0x1fffffffu < 0x3ffffffeu)  // below 2^61 - 2^32
            return {static_cast<std::int32_t>((raw + (std::int64_t{1} << 29)) >> 30), exponent + 30};
        return {static_cast<std::int32_t>((raw + (std::int64_t{1} << 30)) >> 31), exponent + 31};
    }
    // a + b, rounded to nearest, with what the smaller one has down to 2^-60 of the larger.
    [[nodiscard, gnu::noinline]] static constexpr Factor sum(Factor a, Factor b) {
        if (a.mantissa == 0) return b;
        if (b.mantissa == 0) return a;
        const bool swapped = a.exponent < b.exponent;
        const Factor large = swapped ? b : a, small = swapped ? a : b;
        const int gap = large.exponent - small.exponent;
        const std::int64_t raw = detail::multiply(large.mantissa, 1 << 30);
        if (gap <= 30) [[likely]]
            return normal(detail::multiply_add(raw, small.mantissa, 1 << (30 - gap)), large.exponent - 30);
        return normal(raw + (small.mantissa >> (gap > 61 ? 31 : gap - 30)), large.exponent - 30);
    }
    // 1 - f.
    [[nodiscard]] TUMBLE_INLINE static constexpr Factor one_less(Factor f) {
        if (f.exponent <= -30 && f.exponent >= -60) [[likely]]
            return normal((std::int64_t{1} << 60) - detail::multiply(f.mantissa, 1 << (f.exponent + 60)), -60);
        return sum(one(), negative(f));
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Factor negative(Factor f) { return {-f.mantissa, f.exponent}; }
    // f > 2^n.
    template <int n>
    [[nodiscard]] TUMBLE_INLINE static constexpr bool exceeds_power_of_two(Factor f) {
        return f.mantissa > 0 && (f.exponent + 30 > n || (f.exponent + 30 == n && f.mantissa > std::int32_t{1} << 30));
    }

    // A sum of up to four positions and components of points beside them, with either sign: the sum modulo 2^64, and
    // its upper word in quarters, up to 4 below, which tells whether the sum has more than 64 bits.
    struct Place {
        std::int64_t sum;
        std::int32_t quarters;

        TUMBLE_INLINE friend constexpr Place operator+(Place a, Place b) {
            return {(Wide<0>{a.sum} + Wide<0>{b.sum}).raw, a.quarters + b.quarters};
        }
        TUMBLE_INLINE friend constexpr Place operator-(Place a, Place b) {
            return {(Wide<0>{a.sum} - Wide<0>{b.sum}).raw, a.quarters - b.quarters};
        }
    };
    [[nodiscard]] TUMBLE_INLINE static constexpr Place place(typename N::PositionSum x) {
        return {x.raw, N::upper(x.raw) >> 2};
    }
    [[nodiscard]] static constexpr Place place(const Vector& v, int i) { return place(v.position(i)); }
    // The vector of these places, m.
    [[nodiscard]] TUMBLE_INLINE static constexpr Vector between(const Place (&places)[3]) {
        const auto magnitude = [&](int i) { return places[i].quarters ^ (places[i].quarters >> 31); };
        if ((magnitude(0) | magnitude(1) | magnitude(2)) >= (1 << 29) - 8) [[unlikely]]
            return across(places);
        return of_sums({places[0].sum, places[1].sum, places[2].sum}, -N::PositionSum::fraction_bits);
    }
    // The difference of two drifts, in quarters of a sum's unit: no difference in the range overflows.
    using Span = std::int64_t;
    [[nodiscard]] TUMBLE_INLINE static constexpr Span span(typename N::DriftSum d) { return d.raw >> 2; }
    // m in a step.
    [[nodiscard]] TUMBLE_INLINE static Vector velocity(const Span (&raw)[3], typename N::Scale s) {
        return of_sums(raw, 2 - drift_bits(s));
    }
    // A velocity, m in a step, as spans.
    [[nodiscard]] static constexpr Span span_of_velocity(const Vector& v, int i, typename N::Scale s) {
        return v.drift(i, work(one()), s).raw >> 2;
    }

    // The half turns of a step, rad.
    [[nodiscard]] static Vector half_turns(const Vec3<typename N::Turn>& t, typename N::Scale s) {
        return Vector::of_sums({t.x().raw, t.y().raw, t.z().raw}, -(32 + s.turn_shift));
    }

    [[nodiscard]] TUMBLE_INLINE static constexpr bool is_zero(const Vector& v) { return v.is_zero(); }
    // Whether 1 / |v|^3 is in the range of a factor.
    [[nodiscard]] TUMBLE_INLINE static constexpr bool has_inverse_cube(const Vector& v) { return !v.is_zero(); }
    // 1 / |v|, within 2^-31 of it, for a vector that is not zero. A quadratic seed (2.4 %) and a step of Newton's
    // iteration in 16 bits, a step in 32 bits (1.3e-6), and a step whose residual has 59 bits.
    [[nodiscard, gnu::noinline]] static constexpr Factor inverse_length(const Vector& v) {
        const std::uint64_t square = static_cast<std::uint64_t>(square_of(v));  // 2^58 to 2^62
        const int up = square < std::uint64_t{1} << 60 ? 4 : 2;
        const std::uint64_t x = square << up;  // [2^62, 2^64): [1/4, 1) with 64 bits
        const auto x16 = static_cast<std::uint32_t>(x >> 48);
        const auto x31 = static_cast<std::int32_t>(x >> 33), low = static_cast<std::int32_t>((x >> 2) & 0x7fffffff);
        // 2.6708 - 3.2854 x + 1.6386 x^2, with 14 bits: the polynomial of least relative error on [1/4, 1].
        const std::uint32_t seed = 43759 - ((x16 * (53827 - ((x16 * 26846) >> 16))) >> 16);
        const std::uint32_t excess16 = ((seed * seed) >> 15) * x16;                                 // x y^2, 29 bits
        const auto y16 = static_cast<std::int32_t>(((((3u << 29) - excess16) >> 15) * seed) << 1);  // 30 bits
        const std::int32_t excess = detail::multiply_upper(detail::multiply_upper(y16, y16), x31);  // x y^2, 27 bits
        const std::int32_t twice = detail::multiply_upper(y16, (3 * (1 << 27) - excess) * 4);       // 2 y, 27 bits
        const std::int32_t y = twice < 1 << 29 ? twice * 4 : INT32_MAX;                             // 30 bits
        const std::int64_t y2 = detail::multiply(y, y);                                             // 60 bits
        const auto y2_upper = static_cast<std::int32_t>(y2 >> 32),
                   y2_lower = static_cast<std::int32_t>((y2 & 0xffffffff) >> 1);
        const std::int64_t whole = detail::multiply(x31, y2_upper) + (detail::multiply(x31, y2_lower) >> 31) +
                                   (detail::multiply(low, y2_upper) >> 31);  // x y^2, 59 bits
        const auto rest = static_cast<std::int32_t>(((std::int64_t{1} << 59) - whole) >> 10);
        const std::int64_t root = y + ((detail::multiply(y, rest) + (std::int64_t{1} << 49)) >> 50);
        return {root > INT32_MAX ? INT32_MAX : static_cast<std::int32_t>(root), up / 2 - 62 - v.exponent};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr Factor dot(const Vector& a, const Vector& b) {
        std::int64_t raw = detail::multiply(a.mantissa[0], b.mantissa[0]);
        raw = detail::multiply_add(raw, a.mantissa[1], b.mantissa[1]);
        raw = detail::multiply_add(raw, a.mantissa[2], b.mantissa[2]);
        return normal(raw, a.exponent + b.exponent);
    }
    // q v q*, body to world: (w^2 - |u|^2) v + 2 (u . v) u + 2 w u x v with q = (w, u). For a q whose length is off 1
    // it is still a rotation, times |q|^2, as in working numbers. A component is at most |v|, which 31 bits hold.
    template <class Q>
    [[nodiscard, gnu::noinline]] static constexpr Vector rotated(const Quat<typename N::Unit, Q>& q, const Vector& v) {
        const std::int32_t w = q.w.raw, u[3]{q.v.x().raw, q.v.y().raw, q.v.z().raw};
        const std::int32_t(&m)[3] = v.mantissa;
        std::int64_t square = detail::multiply(w, w), along = detail::multiply(u[0], m[0]);
        for (int i = 0; i < 3; ++i) square = detail::multiply_add(square, -u[i], u[i]);
        for (int i = 1; i < 3; ++i) along = detail::multiply_add(along, u[i], m[i]);
        const std::int32_t cosine = rounded(square), share = rounded(along);  // 30 bits; as v
        const auto component = [&](int i, int j, int k) {
            const std::int32_t across = rounded(detail::multiply_add(detail::multiply(u[j], m[k]), -u[k], m[j]));
            const std::int64_t half = detail::multiply_add(detail::multiply(share, u[i]), w, across);
            return rounded(detail::multiply_add(half * 2, cosine, m[i]));
        };
        return {{component(0, 1, 2), component(1, 2, 0), component(2, 0, 1)}, v.exponent};
    }
    // World to body.
    template <class Q>
    [[nodiscard]] static constexpr Vector rotated_back(const Quat<typename N::Unit, Q>& q, const Vector& v) {
        return rotated(Quat<typename N::Unit, Q>{-q.w, q.v}, v);
    }
    // a x b, not normalised: a lever, made with 29 bits, and a block of 30 bits, rotated or not.
    [[nodiscard]] TUMBLE_INLINE static Vector cross(const Vector& a, const Vector& b) {
        const auto component = [&](int j, int k) {
            constexpr std::int64_t half = std::int64_t{1} << 29;
            return static_cast<std::int32_t>(
                detail::multiply_add(detail::multiply_add(half, a.mantissa[j], b.mantissa[k]), -a.mantissa[k],
                                     b.mantissa[j]) >>
                30);
        };
        return {{component(1, 2), component(2, 0), component(0, 1)}, a.exponent + b.exponent + 30};
    }

    // The sums that loads are added to have 8 bits more above the state's range than a kick, and 8 bits less below it:
    // strong loads may cancel each other. They are the kick's own words until settle() moves them to their place.
    static constexpr int headroom = 8;
    // sum[i] += v[i] f, in metres of drift.
    TUMBLE_INLINE static constexpr void add(typename N::DriftSum (&sum)[3], const Vector& v, Factor f,
                                            typename N::Scale s) {
        const int down = -(v.exponent + f.exponent + drift_bits(s) - headroom);
        for (int i = 0; i < 3; ++i) add_product(sum[i], v.mantissa[i], f.mantissa, down);
    }
    // sum += change, which is such a sum.
    TUMBLE_INLINE static void add(typename N::DriftSum (&sum)[3], const typename N::DriftSum (&change)[3],
                                  typename N::Scale) {
        for (int i = 0; i < 3; ++i) sum[i] = N::held_sum(sum[i], change[i]);
    }
    TUMBLE_INLINE static void add(typename N::TurnSum& sum, const Vector& v, int i, Factor f, typename N::Scale s) {
        add_product(sum, v.mantissa[i], f.mantissa, -(v.exponent + f.exponent + turn_bits(s) - headroom));
    }
    // sum += f d, with d in the units of the state and all its 64 bits, and the same of a turn.
    TUMBLE_INLINE static void add_share(typename N::DriftSum& sum, typename N::DriftSum d, Factor f,
                                        typename N::Scale) {
        add_shifted(sum, N::mul_sum({d.raw}, Fixed<31>{f.mantissa}).raw, headroom - (f.exponent + 32));
    }
    TUMBLE_INLINE static void add_share(typename N::TurnSum& sum, typename N::Turn t, Factor f, typename N::Scale) {
        add_product(sum, t.raw, f.mantissa, headroom - (f.exponent + 32));
    }
    // f d, for 0 <= f < 1/4.
    [[nodiscard]] TUMBLE_INLINE static constexpr typename N::DriftSum share(typename N::DriftSum d, Factor f) {
        const int down = -(f.exponent + 32);
        return {N::mul_sum({d.raw}, Fixed<31>{f.mantissa}).raw >> (down > 63 ? 63 : down)};
    }
    // Adds a change of drift (m) or of half a turn (rad) in working numbers.
    static void add(typename N::DriftSum (&sum)[3], int i, Work metres, typename N::Scale s) {
        sum[i] = N::held_sum(sum[i], {N::drift_sum(metres, s).raw >> headroom});
    }
    static void add(typename N::TurnSum (&sum)[3], int i, Work half_turn, typename N::Scale s) {
        sum[i] = N::held_sum(sum[i], {N::turn_sum(half_turn, s).raw >> headroom});
    }
    static void add(Vec3<Work>& sum, int i, Work change, typename N::Scale) { sum[i] += change; }
    // The sum as the kick of a step, held within a quarter of the range. Clears `within` at its ends.
    template <int F>
    [[nodiscard]] TUMBLE_INLINE static constexpr Wide<F> clamped(Wide<F> sum, Wide<F> constant, bool& within) {
        const auto is_below = [](Wide<F> a, int bits) {  // the magnitude, of 32 + bits bits
            return static_cast<std::uint32_t>(N::upper(a.raw)) + (1u << bits) < 2u << bits;
        };
        // A constant has at most 62 bits and a little: the sum below cannot wrap.
        const Wide<F> kick =
            constant + Wide<F>{static_cast<std::int64_t>(static_cast<std::uint64_t>(sum.raw) << headroom)};
        if (is_below(sum, 21) && is_below(kick, 28)) [[likely]]
            return kick;
        const Wide<F> clamped = clamped_far(sum, constant);
        if (clamped.raw == limit || clamped.raw == -limit) within = false;
        return clamped;
    }
    // The same in working numbers, of any size.
    static void add(Vec3<Work>& sum, const typename N::DriftSum (&change)[3], typename N::Scale s) {
        for (int i = 0; i < 3; ++i) sum[i] += N::times_power_of_two(N::metres(change[i], s), headroom);
    }
    static void add(Vec3<Work>& sum, const Vector& v, Factor f, typename N::Scale) {
        for (int i = 0; i < 3; ++i) sum[i] += product_of(v.mantissa[i], f, v.exponent);
    }
    static void add(Work& sum, const Vector& v, int i, Factor f, typename N::Scale) {
        sum += product_of(v.mantissa[i], f, v.exponent);
    }
    static void add_share(Work& sum, typename N::DriftSum d, Factor f, typename N::Scale s) {
        sum += N::metres(d, s) * work(f);
    }
    static void add_share(Work& sum, typename N::Turn t, Factor f, typename N::Scale s) {
        sum += N::half_turn(t, s) * work(f);
    }

private:
    static constexpr std::int64_t limit = std::int64_t{1} << 60;
    template <int F>
    [[nodiscard, gnu::noinline, gnu::cold]] static constexpr Wide<F> clamped_far(Wide<F> sum, Wide<F> constant) {
        constexpr std::int64_t most = limit >> headroom;
        const Wide<F> total = N::held_sum(sum, Wide<F>{constant.raw >> headroom});
        bool within = true;
        if (total.raw <= most && total.raw >= -most)
            return N::limited(
                constant + Wide<F>{static_cast<std::int64_t>(static_cast<std::uint64_t>(sum.raw) << headroom)}, within);
        return {total.raw < 0 ? -limit : limit};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr int drift_bits(typename N::Scale s) {
        return N::Position::fraction_bits + 32 + s.drift_shift;
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr int turn_bits(typename N::Scale s) { return 64 + s.turn_shift; }
    [[nodiscard]] static Work product_of(std::int32_t mantissa, Factor f, int exponent) {
        return Work::of(detail::multiply(mantissa, f.mantissa), exponent + f.exponent);
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int64_t square_of(const Vector& v) {
        std::int64_t raw = detail::multiply(v.mantissa[0], v.mantissa[0]);
        raw = detail::multiply_add(raw, v.mantissa[1], v.mantissa[1]);
        return detail::multiply_add(raw, v.mantissa[2], v.mantissa[2]);
    }
    // Without the 30 fraction bits of a factor.
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int32_t rounded(std::int64_t sum) {
        return static_cast<std::int32_t>((sum + (std::int64_t{1} << 29)) >> 30);
    }
    // raw * 2^exponent, rounded to 31 bits. A mantissa of 2^31 is held at the end of its format, half a unit below.
    [[nodiscard]] TUMBLE_INLINE static constexpr Factor normal(std::int64_t raw, int exponent) {
        const std::int32_t high = N::upper(raw);
        const auto size = static_cast<std::uint32_t>(high ^ (high >> 31));
        if (size == 0) [[unlikely]]
            return normal_of_low(raw, exponent);
        const int up = std::countl_zero(size) - 1;  // 0 to 30
        const auto low = static_cast<std::uint32_t>(raw);
        const std::uint32_t upper =
            (static_cast<std::uint32_t>(high) << up | low >> 1 >> (31 - up)) + (low << up >> 31);
        return {raw > 0 && upper >> 31 != 0 ? INT32_MAX : static_cast<std::int32_t>(upper), exponent + 32 - up};
    }
    // The same of a sum of one word.
    [[nodiscard, gnu::noinline]] static constexpr Factor normal_of_low(std::int64_t raw, int exponent) {
        if (raw == 0) return {};
        const int up = std::countl_zero(static_cast<std::uint64_t>(raw ^ (raw >> 63))) - 1;
        const std::uint64_t moved = static_cast<std::uint64_t>(raw) << up;
        const std::uint32_t upper = static_cast<std::uint32_t>(moved >> 32) + (static_cast<std::uint32_t>(moved) >> 31);
        return {raw > 0 && upper >> 31 != 0 ? INT32_MAX : static_cast<std::int32_t>(upper), exponent + 32 - up};
    }
    // Three sums as a block of 30 bits, rounded to nearest, ties upwards.
    [[nodiscard]] TUMBLE_INLINE static constexpr Vector of_sums(const std::int64_t (&raw)[3], int exponent) {
        const auto size = [&](int i) {
            const std::int32_t high = N::upper(raw[i]);
            return static_cast<std::uint32_t>(high ^ (high >> 31));
        };
        const int drop = 64 - 30 - std::countl_zero(size(0) | size(1) | size(2));
        if (drop >= 3 && drop <= 31) [[likely]] {  // one of the upper words is not zero
            const auto component = [&](int i) {
                const auto low = static_cast<std::uint32_t>(raw[i]),
                           high = static_cast<std::uint32_t>(N::upper(raw[i]));
                return static_cast<std::int32_t>((high << (32 - drop) | low >> drop) + ((low >> (drop - 1)) & 1));
            };
            return {{component(0), component(1), component(2)}, exponent + drop};
        }
        return far(raw, exponent);
    }
    // The vector of places at opposite ends of the range, in quarters of a unit: their upper words tell the bits that
    // the sums have lost.
    [[nodiscard, gnu::noinline]] static constexpr Vector across(const Place (&places)[3]) {
        std::int64_t raw[3];
        for (int i = 0; i < 3; ++i) {
            const std::uint64_t low = static_cast<std::uint64_t>(places[i].sum) >> 2;  // without the upper two bits
            const auto missing = static_cast<std::uint32_t>(places[i].quarters) - static_cast<std::uint32_t>(low >> 32);
            raw[i] = static_cast<std::int64_t>(low + (std::uint64_t{(missing + (1u << 29)) & 0xc0000000u} << 32));
        }
        return of_sums(raw, 2 - N::PositionSum::fraction_bits);
    }
    // The same where a body is far away or very near.
    [[nodiscard, gnu::noinline]] static constexpr Vector far(const std::int64_t (&raw)[3], int exponent) {
        const auto size = [&](int i) { return static_cast<std::uint64_t>(raw[i] ^ (raw[i] >> 63)); };
        const int drop = 64 - 30 - std::countl_zero(size(0) | size(1) | size(2));
        Vector v{{}, exponent + drop};
        for (int i = 0; i < 3; ++i)
            v.mantissa[i] = static_cast<std::int32_t>(drop > 0 ? ((raw[i] >> (drop - 1)) + 1) >> 1
                                                               : raw[i] * (std::int64_t{1} << -drop));
        return v;
    }
    template <int F>
    TUMBLE_INLINE static constexpr void add_product(Wide<F>& sum, std::int32_t a, std::int32_t b, int down) {
        add_shifted(sum, detail::multiply(a, b), down);
    }
    // sum += raw / 2^down, rounded to nearest, for |raw| < 2^62. A sum that would overflow is held at its end.
    template <int F>
    TUMBLE_INLINE static constexpr void add_shifted(Wide<F>& sum, std::int64_t raw, int down) {
        if (down >= 1 && down <= 31) [[likely]]
            sum = N::held_sum(sum, Wide<F>{detail::shift_right(raw + (std::uint32_t{1} << (down - 1)), down)});
        else sum = N::held_sum(sum, Wide<F>{N::shifted(raw, -down)});
    }
};

template <class N>
requires(!N::fixed_point) struct LoadNumbers<N> {
    using T = typename N::Work;
    using Vector = VectorBlock<N>;
    using Factor = T;
    using Span = T;

    [[nodiscard]] TUMBLE_INLINE static constexpr T factor(T w) { return w; }
    [[nodiscard]] static constexpr T work(T f) { return f; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T one() { return T(1); }
    [[nodiscard]] TUMBLE_INLINE static constexpr bool is_zero(T f) { return f == T(0); }
    [[nodiscard]] TUMBLE_INLINE static constexpr T product(T a, T b) { return a * b; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T sum(T a, T b) { return a + b; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T one_less(T f) { return T(1) - f; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T negative(T f) { return -f; }
    template <int n>
    [[nodiscard]] TUMBLE_INLINE static constexpr bool exceeds_power_of_two(T f) {
        constexpr T limit = from_real<T>(Real::scaled(1, n));
        return f > limit;
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr T span(T x) { return x; }
    using Place = T;
    [[nodiscard]] TUMBLE_INLINE static constexpr T place(T x) { return x; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T place(const Vector& v, int i) { return v.v[i]; }
    [[nodiscard]] TUMBLE_INLINE static Vector between(const T (&sums)[3]) { return {{sums[0], sums[1], sums[2]}}; }
    [[nodiscard]] TUMBLE_INLINE static Vector velocity(const T (&raw)[3], typename N::Scale) {
        return {{raw[0], raw[1], raw[2]}};
    }
    [[nodiscard]] TUMBLE_INLINE static T span_of_velocity(const Vector& v, int i, typename N::Scale) { return v.v[i]; }
    [[nodiscard]] static Vector half_turns(const Vec3<T>& t, typename N::Scale) { return {t}; }
    // True where the square of the length underflows, too.
    [[nodiscard]] TUMBLE_INLINE static bool is_zero(const Vector& v) { return !N::is_divisor(tumble::dot(v.v, v.v)); }
    [[nodiscard]] TUMBLE_INLINE static bool has_inverse_cube(const Vector& v) {
        return N::has_inverse_cube(tumble::dot(v.v, v.v));
    }
    [[nodiscard]] TUMBLE_INLINE static T inverse_length(const Vector& v) { return T(1) / sqrt(tumble::dot(v.v, v.v)); }
    [[nodiscard]] TUMBLE_INLINE static T dot(const Vector& a, const Vector& b) { return tumble::dot(a.v, b.v); }
    [[nodiscard]] static Vector rotated(const Quat<T>& q, const Vector& v) { return v.rotated(q); }
    [[nodiscard]] static Vector rotated_back(const Quat<T>& q, const Vector& v) { return v.rotated_back(q); }
    [[nodiscard]] TUMBLE_INLINE static Vector cross(const Vector& a, const Vector& b) {
        return {tumble::cross<T>(a.v, b.v)};
    }
    TUMBLE_INLINE static void add(auto& sum, const Vector& v, T f, typename N::Scale) {
        detail::for_axes<N>([&](int i) { sum[i] += v.v[i] * f; });
    }
    TUMBLE_INLINE static void add(auto& sum, const T (&change)[3], typename N::Scale) {
        detail::for_axes<N>([&](int i) { sum[i] += change[i]; });
    }
    TUMBLE_INLINE static void add(auto& sum, int i, T change, typename N::Scale) { sum[i] += change; }
    TUMBLE_INLINE static void add(T& sum, const Vector& v, int i, T f, typename N::Scale) { sum += v.v[i] * f; }
    TUMBLE_INLINE static void add_share(T& sum, T d, T f, typename N::Scale) { sum += d * f; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T share(T d, T f) { return d * f; }
    [[nodiscard]] TUMBLE_INLINE static constexpr T clamped(T sum, T constant, bool&) { return constant + sum; }
};

}  // namespace tumble
