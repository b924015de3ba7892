// VectorBlock<N>: a vector for what a program gives to a world and reads from it. In fixed point its three mantissas
// share one exponent: rotations and products are sums of 64 bits, and only the ends of a calculation shift. It holds 29
// bits of the largest component. Every rounding is to nearest, ties upwards; where a block is made of numbers, ties
// away from zero. In floating point it is a plain vector.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

template <class N>
struct VectorBlock;

template <class N>
requires(N::fixed_point) struct VectorBlock<N> {
    using Unit = typename N::Unit;
    using Position = typename N::Position;

    // The components are mantissa * 2^exponent. Up to 2^29 where a block is made; its length is then at most sqrt(3)
    // 2^29, rotated or not, and 1.4 times that after turned(): always below 2^31.
    std::int32_t mantissa[3]{};
    int exponent = 0;
    static constexpr int lowest = -0x10000;  // below the exponent of every number but zero
    // Calls visit with the members that a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        constexpr int most = 5 << 28;  // see above
        for (auto& component : self.mantissa) visit.within(component, -most, most);
        visit.within(self.exponent, 2 * lowest, -2 * lowest);
    }

    // `by_float_unit`: the core's instructions take the place of shifts, for the same bits. 2^(156 - most) is exact and
    // brings the largest component below 2^30, in halves of a unit, of which the conversion drops all that is smaller.
    template <bool by_float_unit = detail::has_float_unit>
    [[nodiscard, gnu::noinline]] static constexpr VectorBlock of(float x, float y, float z) {
        const std::uint32_t bits[3]{std::bit_cast<std::uint32_t>(x), std::bit_cast<std::uint32_t>(y),
                                    std::bit_cast<std::uint32_t>(z)};
        const auto field = [&](int i) { return static_cast<int>((bits[i] >> 23) & 0xff); };
        int most = field(0) > field(1) ? field(0) : field(1);
        if (field(2) > most) most = field(2);
        TUMBLE_ASSERT(most != 0xff);
        if constexpr (by_float_unit) {
            if (most >= 32) [[likely]] {
                const auto scale = std::bit_cast<float>(static_cast<std::uint32_t>(156 + 127 - most) << 23);
                const auto component = [&](float value) {
                    const auto halves = static_cast<std::int32_t>(value * scale);
                    return (halves + 1 + (halves >> 31)) >> 1;
                };
                return {{component(x), component(y), component(z)}, most - 155};
            }
        }
        if (most == 0) return {};  // zero; denormals are below every format
        // The field of a component that counts is above 0 and at most 29 below `most`.
        const int farthest = most > 29 ? 29 : most - 1;
        const auto component = [&](int i) -> std::int32_t {  // 24 bits, moved to below 2^29 and down
            const int drop = most - field(i);
            if (drop > farthest) return 0;
            const auto sign = static_cast<std::int32_t>(bits[i]) >> 31;
            return (static_cast<std::int32_t>(((0x80000000u | bits[i] << 8) >> (drop + 2)) + 1) >> 1 ^ sign) - sign;
        };
        return {{component(0), component(1), component(2)}, most - 155};
    }
    // Three numbers in a program's format.
    template <int F>
    [[nodiscard]] static constexpr VectorBlock of(Fixed<F> x, Fixed<F> y, Fixed<F> z) {
        return of_words(x.raw, y.raw, z.raw, -F);
    }
    // raw * 2^exponent.
    [[nodiscard, gnu::noinline]] static constexpr VectorBlock of_words(std::int32_t x, std::int32_t y, std::int32_t z,
                                                                       int exponent) {
        const auto digits = static_cast<std::uint32_t>((x ^ (x >> 31)) | (y ^ (y >> 31)) | (z ^ (z >> 31)));
        const int up = std::countl_zero(digits) - 3;  // to below 2^29
        if (up >= 0) return {{x * (1 << up), y * (1 << up), z * (1 << up)}, exponent - up};
        const auto rounded = [&](std::int32_t raw) { return ((raw >> (-up - 1)) + 1) >> 1; };
        return {{rounded(x), rounded(y), rounded(z)}, exponent - up};
    }
    // Three numbers of any type.
    template <class X, class Y, class Z>
    [[nodiscard]] static constexpr VectorBlock of(X x, Y y, Z z) {
        return of_numbers({static_cast<Scaled>(x), static_cast<Scaled>(y), static_cast<Scaled>(z)});
    }
    [[nodiscard, gnu::noinline]] static constexpr VectorBlock of_numbers(const Scaled (&v)[3]) {
        int most = lowest;
        for (const Scaled& c : v)
            if (!c.is_zero() && c.exponent() > most) most = c.exponent();
        VectorBlock block;
        block.exponent = most + 2;
        for (int i = 0; i < 3; ++i) {
            const int drop = block.exponent - v[i].exponent();
            if (v[i].is_zero() || drop > 31) continue;
            const std::int32_t m = v[i].mantissa(), magnitude = m < 0 ? -m : m,
                               rounded = ((magnitude >> (drop - 1)) + 1) >> 1;
            block.mantissa[i] = m < 0 ? -rounded : rounded;
        }
        return block;
    }
    // raw * 2^exponent, each below 2^63.
    [[nodiscard, gnu::noinline, gnu::pure]] static constexpr VectorBlock of_sums(const std::int64_t (&raw)[3],
                                                                                 int exponent) {
        const std::int32_t x = upper_of(raw[0]), y = upper_of(raw[1]), z = upper_of(raw[2]);
        const auto high = static_cast<std::uint32_t>((x ^ (x >> 31)) | (y ^ (y >> 31)) | (z ^ (z >> 31)));
        if (high == 0) [[unlikely]]
            return of_small_sums(raw, exponent);
        const int drop = 64 - 29 - std::countl_zero(high);  // 4 to 34
        // The result fits one word, so it comes from the words of the sum.
        if (drop < 32) [[likely]]
            return {{lower_shifted(raw[0], drop), lower_shifted(raw[1], drop), lower_shifted(raw[2], drop)},
                    exponent + drop};
        const auto rounded = [&](std::int64_t sum) {
            return static_cast<std::int32_t>(((sum >> (drop - 1)) + 1) >> 1);
        };
        return {{rounded(raw[0]), rounded(raw[1]), rounded(raw[2])}, exponent + drop};
    }
    // Changes of drift, m, and of half a turn, rad, from the units of the state.
    [[nodiscard]] static constexpr VectorBlock of_drifts(const typename N::DriftSum (&d)[3], typename N::Scale s) {
        return of_sums({d[0].raw, d[1].raw, d[2].raw}, -(Position::fraction_bits + 32 + s.drift_shift));
    }
    [[nodiscard]] static constexpr VectorBlock of_turns(const typename N::TurnSum (&t)[3], typename N::Scale s) {
        return of_sums({t[0].raw, t[1].raw, t[2].raw}, -(64 + s.turn_shift));
    }
    // Turns times the rate of each axis, units.per_half_turn(), rounded to 30 bits each before they share an exponent.
    [[nodiscard, gnu::pure]] static constexpr VectorBlock of_turns(const typename N::TurnSum (&t)[3],
                                                                   typename N::Scale s, const auto& units) {
        const Product x = Product::of(t[0].raw, units.per_half_turn(0)),
                      y = Product::of(t[1].raw, units.per_half_turn(1)),
                      z = Product::of(t[2].raw, units.per_half_turn(2));
        int most = x.exponent > y.exponent ? x.exponent : y.exponent;
        if (z.exponent > most) most = z.exponent;
        const std::int32_t a = x.below(most), b = y.below(most), c = z.below(most);
        const int drop = ((a ^ (a >> 31)) | (b ^ (b >> 31)) | (c ^ (c >> 31))) >> 30 != 0 ? 2 : 1;
        const auto rounded = [&](std::int32_t m) { return ((m >> (drop - 1)) + 1) >> 1; };
        return {{rounded(a), rounded(b), rounded(c)}, most + 31 + 32 - (64 + s.turn_shift) + drop};
    }
    // Back to the units of the state, times a factor. Held far below the end of a sum.
    [[nodiscard]] TUMBLE_INLINE constexpr typename N::DriftSum drift(int i, Scaled factor, typename N::Scale s) const {
        return {sum(i, factor, Position::fraction_bits + 32 + s.drift_shift)};
    }
    [[nodiscard]] TUMBLE_INLINE constexpr typename N::TurnSum turn(int i, Scaled factor, typename N::Scale s) const {
        return {sum(i, factor, 64 + s.turn_shift)};
    }
    // Calls take(i, change, is_small) for the three changes of drift, or of turn; `units` has the factors. is_small is
    // std::true_type where changes are below 2^60: they fit N::limited(), and a state in its range plus one cannot
    // wrap. Of the opposite: ties are rounded downwards, so that it is the exact opposite.
    template <class F>
    TUMBLE_INLINE constexpr void each_drift(Scaled factor, typename N::Scale s, bool opposite, F&& take) const {
        each_sum<typename N::DriftSum>(factor, Position::fraction_bits + 32 + s.drift_shift, opposite, take);
    }
    template <class Units, class F>
    TUMBLE_INLINE constexpr void each_turn(const Units& units, typename N::Scale s, bool opposite, F&& take) const {
        using Sum = typename N::TurnSum;
        const int bits = 64 + s.turn_shift;
        if constexpr (Units::has_one_factor) {
            each_sum<Sum>(units.per_impulse(0), bits, opposite, take);
        } else {
            const auto one = [&](int i) __attribute__((always_inline)) {
                const Change change{*this, units.per_impulse(i), bits, opposite};
                if (change.is_small()) [[likely]]
                    take(i, Sum{change.small(mantissa[i])}, std::true_type{});
                else take(i, Sum{change.any(mantissa[i])}, std::false_type{});
            };
            one(0);
            one(1);
            one(2);
        }
    }
    // m.
    [[nodiscard]] constexpr typename N::PositionSum position(int i) const {
        return {N::shifted(mantissa[i], exponent + N::PositionSum::fraction_bits)};
    }

    [[nodiscard]] TUMBLE_INLINE constexpr bool is_zero() const {
        return (mantissa[0] | mantissa[1] | mantissa[2]) == 0;
    }
    // True of one of a vector and its opposite.
    [[nodiscard]] TUMBLE_INLINE constexpr bool is_negative() const {
        if (mantissa[0] != 0) return mantissa[0] < 0;
        return mantissa[1] != 0 ? mantissa[1] < 0 : mantissa[2] < 0;
    }
    [[nodiscard]] TUMBLE_INLINE constexpr VectorBlock operator-() const {
        return {{-mantissa[0], -mantissa[1], -mantissa[2]}, exponent};
    }
    // From the user's axes to principal axes and back, by the order of the axes.
    [[nodiscard]] TUMBLE_INLINE constexpr VectorBlock ordered(const auto& order) const {
        return {{order.principal(mantissa, 0), order.principal(mantissa, 1), order.principal(mantissa, 2)}, exponent};
    }
    [[nodiscard]] TUMBLE_INLINE constexpr VectorBlock ordered_back(const auto& order) const {
        VectorBlock user{{}, exponent};
        order.place(user.mantissa, mantissa);
        return user;
    }
    template <class Vector>
    [[nodiscard, gnu::noinline, gnu::pure]] constexpr VectorBlock rotated(const Quat<Unit, Vector>& q) const {
        const std::int32_t across[3]{rounded<30>(cross_sum<0>(q.v, mantissa)), rounded<30>(cross_sum<1>(q.v, mantissa)),
                                     rounded<30>(cross_sum<2>(q.v, mantissa))};
        const auto component = [&]<int i>() {  // v + 2 w (u x v) + 2 u x (u x v)
            return mantissa[i] + rounded<29>(detail::multiply_add(cross_sum<i>(q.v, across), q.w.raw, across[i]));
        };
        return {{component.template operator()<0>(), component.template operator()<1>(),
                 component.template operator()<2>()},
                exponent};
    }
    template <class Vector>
    [[nodiscard]] TUMBLE_INLINE constexpr VectorBlock rotated_back(const Quat<Unit, Vector>& q) const {
        return rotated(Quat<Unit, Vector>{-q.w, q.v});
    }
    // v + u x v: the rotation by a small angle u to first order.
    [[nodiscard]] constexpr VectorBlock turned(const Vec3<Unit>& u) const {
        return {{mantissa[0] + rounded<30>(cross_sum<0>(u, mantissa)),
                 mantissa[1] + rounded<30>(cross_sum<1>(u, mantissa)),
                 mantissa[2] + rounded<30>(cross_sum<2>(u, mantissa))},
                exponent};
    }
    // Half the angle of a turn, rad, held at 1/2. `rate` is that of SpinUnits, of steps.
    [[nodiscard]] TUMBLE_INLINE static constexpr Unit half_angle(typename N::Turn t, Scaled rate, typename N::Scale s) {
        constexpr std::int32_t limit = 1 << 29;
        const std::int64_t product = detail::multiply(t.raw, rate.mantissa());
        const int down = 32 + s.turn_shift + 1 - 30 - rate.exponent();
        std::int64_t raw = 0;
        if (down >= 33 && down <= 62) [[likely]]  // of the upper word, rounded
            raw = ((upper_of(product) >> (down - 33)) + 1) >> 1;
        else raw = N::shifted(product, -down);
        return {static_cast<std::int32_t>(raw > limit ? limit : raw < -limit ? -limit : raw)};
    }
    // Exact where s is a power of two.
    TUMBLE_INLINE constexpr void multiply_by(Scaled s) {
        exponent += s.exponent() + 30;
        if (s.mantissa() != 1 << 30) *this = times_mantissa(s.mantissa());
    }
    // The same as a copy, which stays in registers where s is a power of two.
    [[nodiscard]] TUMBLE_INLINE constexpr VectorBlock times(Scaled s) const {
        if (s.mantissa() == 1 << 30) return {{mantissa[0], mantissa[1], mantissa[2]}, exponent + s.exponent() + 30};
        VectorBlock product = *this;
        product.multiply_by(s);
        return product;
    }
    // Each component times its factor.
    [[nodiscard, gnu::noinline]] constexpr VectorBlock times(const Vector3<Scaled>& s) const {
        int most = lowest;
        for (int i = 0; i < 3; ++i)
            if (s[i].exponent() > most) most = s[i].exponent();
        std::int64_t raw[3]{};
        for (int i = 0; i < 3; ++i) {
            const int drop = most - s[i].exponent();
            raw[i] = detail::multiply(mantissa[i], s[i].mantissa()) >> (drop > 63 ? 63 : drop);
        }
        return of_sums(raw, exponent + most);
    }
    // To 2^-30 of the product of the lengths.
    [[nodiscard]] friend constexpr VectorBlock cross(const VectorBlock& a, const VectorBlock& b) {
        const StoredVec3<Unit> u{Unit{a.mantissa[0]}, Unit{a.mantissa[1]}, Unit{a.mantissa[2]}};
        return {{rounded<30>(cross_sum<0>(u, b.mantissa)), rounded<30>(cross_sum<1>(u, b.mantissa)),
                 rounded<30>(cross_sum<2>(u, b.mantissa))},
                a.exponent + b.exponent + 30};
    }
    [[nodiscard]] friend constexpr VectorBlock operator+(const VectorBlock& a, const VectorBlock& b) {
        if (a.is_zero()) return b;
        if (b.is_zero()) return a;
        const VectorBlock &large = a.exponent >= b.exponent ? a : b, &small = a.exponent >= b.exponent ? b : a;
        const int gap = large.exponent - small.exponent, up = gap > 30 ? 30 : gap, down = gap - up > 63 ? 63 : gap - up;
        std::int64_t raw[3]{};
        for (int i = 0; i < 3; ++i)
            raw[i] = large.mantissa[i] * (std::int64_t{1} << up) + (std::int64_t{small.mantissa[i]} >> down);
        return of_sums(raw, large.exponent - up);
    }
    template <class T>
    [[nodiscard]] constexpr Vector3<T> as() const {
        if constexpr (std::is_same_v<T, float>) return floats();
        else if constexpr (detail::is_fixed<T>) return words<T>();
        else
            return {static_cast<T>(Scaled::of(mantissa[0], exponent)),
                    static_cast<T>(Scaled::of(mantissa[1], exponent)),
                    static_cast<T>(Scaled::of(mantissa[2], exponent))};
    }

    // The nearest floats, ties to even. They are normal numbers unless the exponent is extreme.
    template <bool by_float_unit = detail::has_float_unit>
    [[nodiscard, gnu::noinline, gnu::pure]] constexpr Vector3<float> floats() const {
        const int field = exponent + 31 + 127;
        if (field < 32 || field > 254) [[unlikely]]
            return {detail::to_float(mantissa[0], exponent), detail::to_float(mantissa[1], exponent),
                    detail::to_float(mantissa[2], exponent)};
        if constexpr (by_float_unit) {
            const auto unit = std::bit_cast<float>(static_cast<std::uint32_t>(field - 31) << 23);  // 2^exponent
            return {static_cast<float>(mantissa[0]) * unit, static_cast<float>(mantissa[1]) * unit,
                    static_cast<float>(mantissa[2]) * unit};
        } else {
            return {normal_float(mantissa[0], field), normal_float(mantissa[1], field),
                    normal_float(mantissa[2], field)};
        }
    }

private:
    // The nearest numbers of a program's format, ties upwards. Saturates at the ends of the format.
    template <class T>
    [[nodiscard, gnu::noinline, gnu::pure]] constexpr Vector3<T> words() const {
        const int down = -(exponent + T::fraction_bits);
        if (down >= 1 && down <= 31) [[likely]] {
            const auto rounded = [&](int i) { return T{((mantissa[i] >> (down - 1)) + 1) >> 1}; };
            return {rounded(0), rounded(1), rounded(2)};
        }
        const auto clamped = [&](int i) {
            const std::int64_t raw = N::shifted(mantissa[i], -down), limit = INT32_MAX;
            return T{static_cast<std::int32_t>(raw > limit ? limit : raw < -limit ? -limit : raw)};
        };
        return {clamped(0), clamped(1), clamped(2)};
    }
    // A sum times a factor: 30 bits or 31, or zero.
    struct Product {
        std::int32_t mantissa = 0;
        int exponent = lowest;

        [[nodiscard]] TUMBLE_INLINE static constexpr Product of(std::int64_t raw, Scaled factor) {
            if (raw == 0) return {};
            const std::int32_t upper = upper_of(raw), sign = upper >> 31;
            const auto high = static_cast<std::uint32_t>(upper ^ sign);
            // The upper word of raw * 2^up, whose leading bit is 30.
            int up = 31;
            std::uint32_t leading = 0;
            if (high >> 1 != 0) [[likely]] {
                up = std::countl_zero(high) - 1;
                leading = static_cast<std::uint32_t>(upper) << up | lower_of(raw) >> 1 >> (31 - up);
            } else {
                up = std::countl_zero(static_cast<std::uint64_t>(raw ^ (raw >> 63))) - 1;
                leading = static_cast<std::uint32_t>((static_cast<std::uint64_t>(raw) << up) >> 32);
            }
            return {rounded<31>(detail::multiply(static_cast<std::int32_t>(leading), factor.mantissa())),
                    factor.exponent() - up};
        }
        // The mantissa with a larger exponent.
        [[nodiscard]] TUMBLE_INLINE constexpr std::int32_t below(int most) const {
            const int drop = most - exponent;
            return drop > 31 ? 0 : mantissa >> drop;
        }
    };
    // raw / 2^drop, rounded, for results of one word and 1 <= drop <= 31.
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int32_t lower_shifted(std::int64_t raw, int drop) {
        const std::uint32_t lower = lower_of(raw), upper = static_cast<std::uint32_t>(upper_of(raw));
        return static_cast<std::int32_t>((upper << (32 - drop) | lower >> drop) + ((lower >> (drop - 1)) & 1));
    }
    // Of sums whose magnitudes fit one word.
    [[nodiscard, gnu::noinline, gnu::pure]] static constexpr VectorBlock of_small_sums(const std::int64_t (&raw)[3],
                                                                                       int exponent) {
        std::uint32_t low = 0;
        for (int i = 0; i < 3; ++i) low |= lower_of(raw[i] ^ (raw[i] >> 63));
        const int drop = 32 - 29 - std::countl_zero(low);
        VectorBlock block{{}, exponent + drop};
        for (int i = 0; i < 3; ++i)
            block.mantissa[i] =
                drop > 0 ? lower_shifted(raw[i], drop) : static_cast<std::int32_t>(lower_of(raw[i]) << -drop);
        return block;
    }
    // Of m * 2^(field - 158), by adding half a unit, less where the result is even.
    [[nodiscard]] TUMBLE_INLINE static constexpr float normal_float(std::int32_t m, int field) {
        if (m == 0) return 0;
        const std::uint32_t sign = static_cast<std::uint32_t>(m) & 0x80000000u,
                            magnitude = sign != 0 ? 0u - static_cast<std::uint32_t>(m) : static_cast<std::uint32_t>(m);
        const int up = std::countl_zero(magnitude);
        const std::uint32_t upper = magnitude << up;
        const std::uint32_t rounded = (upper >> 8) + (((upper & 0xff) + 0x7f + ((upper >> 8) & 1)) >> 8);
        return std::bit_cast<float>(sign | (rounded + (static_cast<std::uint32_t>(field - 1 - up) << 23)));
    }
    [[nodiscard, gnu::noinline, gnu::pure]] constexpr VectorBlock times_mantissa(std::int32_t m) const {
        return {{rounded<31>(detail::multiply(mantissa[0], m)), rounded<31>(detail::multiply(mantissa[1], m)),
                 rounded<31>(detail::multiply(mantissa[2], m))},
                exponent + 1};
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int32_t upper_of(std::int64_t raw) {
        return static_cast<std::int32_t>(raw >> 32);
    }
    [[nodiscard]] TUMBLE_INLINE static constexpr std::uint32_t lower_of(std::int64_t raw) {
        return static_cast<std::uint32_t>(raw);
    }
    template <int bits>
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int32_t rounded(std::int64_t sum) {
        return static_cast<std::int32_t>((sum + (std::int64_t{1} << (bits - 1))) >> bits);
    }
    template <int i>
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int64_t cross_sum(const auto& u, const std::int32_t (&m)[3]) {
        constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
        return detail::multiply_add(detail::multiply(u[j].raw, m[k]), -u[k].raw, m[j]);
    }
    // How a component times a factor becomes a sum of the state, or its opposite.
    struct Change {
        std::int32_t factor;
        int drop;
        std::uint32_t half;  // half a unit of the result; less where ties are rounded downwards
        bool opposite;

        TUMBLE_INLINE constexpr Change(const VectorBlock& block, Scaled by, int fraction_bits, bool is_opposite)
            : factor{is_opposite ? -by.mantissa() : by.mantissa()},
              drop{-(block.exponent + by.exponent() + fraction_bits)}, half{(std::uint32_t{1} << ((drop - 1) & 31)) -
                                                                            static_cast<std::uint32_t>(is_opposite)},
              opposite{is_opposite} {}

        // The usual change is a shift to the right by less than a word. It leaves less than 2^60, because a component
        // is at most sqrt(3) 2^29.
        [[nodiscard]] TUMBLE_INLINE constexpr bool is_small() const { return drop >= 1 && drop <= 31; }
        [[nodiscard]] TUMBLE_INLINE constexpr std::int64_t small(std::int32_t m) const {
            return detail::shift_right(detail::multiply(m, factor) + std::int64_t{half}, drop);
        }
        [[nodiscard]] constexpr std::int64_t any(std::int32_t m) const {
            const std::int64_t raw = detail::multiply(m, factor);
            return opposite ? -N::shifted(-raw, -drop) : N::shifted(raw, -drop);
        }
    };
    [[nodiscard]] TUMBLE_INLINE constexpr std::int64_t sum(int i, Scaled factor, int fraction_bits) const {
        const Change change{*this, factor, fraction_bits, false};
        if (change.is_small()) [[likely]]
            return change.small(mantissa[i]);
        return change.any(mantissa[i]);
    }
    template <class Sum, class F>
    TUMBLE_INLINE constexpr void each_sum(Scaled factor, int fraction_bits, bool opposite, F&& take) const {
        const Change change{*this, factor, fraction_bits, opposite};
        if (change.is_small()) [[likely]] {
            take(0, Sum{change.small(mantissa[0])}, std::true_type{});
            take(1, Sum{change.small(mantissa[1])}, std::true_type{});
            take(2, Sum{change.small(mantissa[2])}, std::true_type{});
        } else {
            for (int i = 0; i < 3; ++i) take(i, Sum{change.any(mantissa[i])}, std::false_type{});
        }
    }
};

template <class N>
requires(!N::fixed_point) struct VectorBlock<N> {
    using T = typename N::Work;

    Vec3<T> v = Vec3<T>::Constant(T(0));
    // Calls visit with the members that a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        visit(self.v);
    }

    template <class X, class Y, class Z>
    [[nodiscard]] static VectorBlock of(X x, Y y, Z z) {
        return {{static_cast<T>(x), static_cast<T>(y), static_cast<T>(z)}};
    }
    [[nodiscard]] static VectorBlock of_drifts(const T (&d)[3], typename N::Scale) { return {{d[0], d[1], d[2]}}; }
    [[nodiscard]] static VectorBlock of_turns(const T (&t)[3], typename N::Scale) { return {{t[0], t[1], t[2]}}; }
    [[nodiscard]] static VectorBlock of_turns(const T (&t)[3], typename N::Scale, const auto& units) {
        return {{t[0] * units.per_half_turn(0), t[1] * units.per_half_turn(1), t[2] * units.per_half_turn(2)}};
    }
    [[nodiscard]] T drift(int i, T factor, typename N::Scale) const { return v[i] * factor; }
    [[nodiscard]] T turn(int i, T factor, typename N::Scale) const { return v[i] * factor; }
    template <class F>
    TUMBLE_INLINE void each_drift(T factor, typename N::Scale, bool, F&& take) const {
        take(0, v[0] * factor, std::false_type{});
        take(1, v[1] * factor, std::false_type{});
        take(2, v[2] * factor, std::false_type{});
    }
    template <class Units, class F>
    TUMBLE_INLINE void each_turn(const Units& units, typename N::Scale, bool, F&& take) const {
        take(0, v[0] * units.per_impulse(0), std::false_type{});
        take(1, v[1] * units.per_impulse(1), std::false_type{});
        take(2, v[2] * units.per_impulse(2), std::false_type{});
    }
    [[nodiscard]] T position(int i) const { return v[i]; }
    [[nodiscard]] TUMBLE_INLINE bool is_zero() const { return v[0] == T(0) && v[1] == T(0) && v[2] == T(0); }
    // Floating point rounds opposites to opposites.
    [[nodiscard]] TUMBLE_INLINE static constexpr bool is_negative() { return false; }
    [[nodiscard]] VectorBlock operator-() const { return {-v}; }
    [[nodiscard]] TUMBLE_INLINE VectorBlock ordered(const auto& order) const {
        return {{order.principal(v, 0), order.principal(v, 1), order.principal(v, 2)}};
    }
    [[nodiscard]] TUMBLE_INLINE VectorBlock ordered_back(const auto& order) const {
        VectorBlock user;
        order.place(user.v, v);
        return user;
    }
    [[nodiscard]] VectorBlock rotated(const Quat<T>& q) const { return {rotate(q, v)}; }
    [[nodiscard]] TUMBLE_INLINE VectorBlock rotated_back(const Quat<T>& q) const { return rotated(q.conjugate()); }
    [[nodiscard]] VectorBlock turned(const Vec3<T>& u) const { return {v + tumble::cross<T>(u, v)}; }
    [[nodiscard]] static T half_angle(T t, T rate, typename N::Scale) { return t * rate * T(0.5); }
    [[nodiscard]] VectorBlock times(T s) const { return {scaled_by(v, s)}; }
    TUMBLE_INLINE void multiply_by(T s) { v = scaled_by(v, s); }
    [[nodiscard]] VectorBlock times(const Vector3<T>& s) const { return {{v[0] * s.x, v[1] * s.y, v[2] * s.z}}; }
    [[nodiscard]] TUMBLE_INLINE friend VectorBlock cross(const VectorBlock& a, const VectorBlock& b) {
        return {tumble::cross<T>(a.v, b.v)};
    }
    [[nodiscard]] friend VectorBlock operator+(const VectorBlock& a, const VectorBlock& b) { return {a.v + b.v}; }
    template <class To>
    [[nodiscard]] Vector3<To> as() const {
        return {static_cast<To>(v[0]), static_cast<To>(v[1]), static_cast<To>(v[2])};
    }
};

}  // namespace tumble
