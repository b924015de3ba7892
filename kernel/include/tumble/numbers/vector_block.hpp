// VectorBlock<N>: a vector for what a program gives to a world and reads from it. In fixed point its three mantissas
// share one exponent: rotations and products are sums of 64 bits, and only the ends of a calculation shift. It holds 29
// bits of the largest component. In floating point it is a plain vector.
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
        visit(self.mantissa, self.exponent);
    }

    [[nodiscard, gnu::noinline]] static constexpr VectorBlock of(float x, float y, float z) {
        const std::uint32_t bits[3]{std::bit_cast<std::uint32_t>(x), std::bit_cast<std::uint32_t>(y),
                                    std::bit_cast<std::uint32_t>(z)};
        const auto field = [&](int i) { return static_cast<int>((bits[i] >> 23) & 0xff); };
        int most = field(0) > field(1) ? field(0) : field(1);
        if (field(2) > most) most = field(2);
        TUMBLE_ASSERT(most != 0xff);
        if (most == 0) return {};                            // zero; denormals are below every format
        const auto component = [&](int i) -> std::int32_t {  // 24 bits, moved to below 2^29 and down
            const int drop = most - field(i);
            if (drop > 29 || field(i) == 0) return 0;
            const auto m = static_cast<std::int32_t>((((bits[i] & 0x7fffff) | 0x800000) << 5 >> drop));
            return (bits[i] >> 31) != 0 ? -m : m;
        };
        return {{component(0), component(1), component(2)}, most - 155};
    }
    // Three numbers of any type.
    template <class X, class Y, class Z>
    [[nodiscard, gnu::noinline]] static constexpr VectorBlock of(X x, Y y, Z z) {
        const Scaled v[3]{static_cast<Scaled>(x), static_cast<Scaled>(y), static_cast<Scaled>(z)};
        int most = lowest;
        for (const Scaled& c : v)
            if (!c.is_zero() && c.exponent() > most) most = c.exponent();
        VectorBlock block;
        block.exponent = most + 2;
        for (int i = 0; i < 3; ++i) {
            const int drop = block.exponent - v[i].exponent();
            if (!v[i].is_zero() && drop < 32) block.mantissa[i] = ((v[i].mantissa() >> (drop - 1)) + 1) >> 1;
        }
        return block;
    }
    // raw * 2^exponent, each below 2^63.
    [[nodiscard, gnu::noinline]] static constexpr VectorBlock of_sums(const std::int64_t (&raw)[3], int exponent) {
        std::uint64_t bits = 0;
        for (int i = 0; i < 3; ++i) bits |= static_cast<std::uint64_t>(raw[i] ^ (raw[i] >> 63));
        const int drop = 64 - 29 - std::countl_zero(bits);
        VectorBlock block;
        block.exponent = exponent + drop;
        for (int i = 0; i < 3; ++i)
            block.mantissa[i] = static_cast<std::int32_t>(drop > 0 ? ((raw[i] >> (drop - 1)) + 1) >> 1
                                                                   : raw[i] * (std::int64_t{1} << -drop));
        return block;
    }
    // Changes of drift, m, and of half a turn, rad, from the units of the state.
    [[nodiscard]] static constexpr VectorBlock of_drifts(const typename N::DriftSum (&d)[3], typename N::Scale s) {
        return of_sums({d[0].raw, d[1].raw, d[2].raw}, -(Position::fraction_bits + 32 + s.drift_shift));
    }
    [[nodiscard]] static constexpr VectorBlock of_turns(const typename N::TurnSum (&t)[3], typename N::Scale s) {
        return of_sums({t[0].raw, t[1].raw, t[2].raw}, -(64 + s.turn_shift));
    }
    // Back to the units of the state, times a factor. Held far below the end of a sum.
    [[nodiscard]] constexpr typename N::DriftSum drift(int i, Scaled factor, typename N::Scale s) const {
        return {sum(i, factor, Position::fraction_bits + 32 + s.drift_shift)};
    }
    [[nodiscard]] constexpr typename N::TurnSum turn(int i, Scaled factor, typename N::Scale s) const {
        return {sum(i, factor, 64 + s.turn_shift)};
    }
    // m.
    [[nodiscard]] constexpr typename N::PositionSum position(int i) const {
        return {shifted(mantissa[i], exponent + N::PositionSum::fraction_bits)};
    }

    [[nodiscard]] constexpr bool is_zero() const { return (mantissa[0] | mantissa[1] | mantissa[2]) == 0; }
    [[nodiscard, gnu::noinline]] constexpr VectorBlock rotated(const Quat<Unit>& q) const {
        const std::int32_t across[3]{rounded<30>(cross_sum<0>(q.v, mantissa)), rounded<30>(cross_sum<1>(q.v, mantissa)),
                                     rounded<30>(cross_sum<2>(q.v, mantissa))};
        const auto component = [&]<int i>() {  // v + 2 w (u x v) + 2 u x (u x v)
            return mantissa[i] + rounded<29>(detail::multiply_add(cross_sum<i>(q.v, across), q.w.raw, across[i]));
        };
        return {{component.template operator()<0>(), component.template operator()<1>(),
                 component.template operator()<2>()},
                exponent};
    }
    [[nodiscard]] constexpr VectorBlock rotated_back(const Quat<Unit>& q) const { return rotated(q.conjugate()); }
    // v + u x v: the rotation by a small angle u to first order.
    [[nodiscard]] constexpr VectorBlock turned(const Vec3<Unit>& u) const {
        return {{mantissa[0] + rounded<30>(cross_sum<0>(u, mantissa)),
                 mantissa[1] + rounded<30>(cross_sum<1>(u, mantissa)),
                 mantissa[2] + rounded<30>(cross_sum<2>(u, mantissa))},
                exponent};
    }
    // Half the angle of a turn, rad, held at 1/2. `rate` is that of SpinUnits, of steps.
    [[nodiscard]] static constexpr Unit half_angle(typename N::Turn t, Scaled rate, typename N::Scale s) {
        constexpr std::int64_t limit = std::int64_t{1} << 29;
        const std::int64_t raw =
            shifted(detail::multiply(t.raw, rate.mantissa()), rate.exponent() - 1 - (32 + s.turn_shift) + 30);
        return {static_cast<std::int32_t>(raw > limit ? limit : raw < -limit ? -limit : raw)};
    }
    [[nodiscard]] constexpr VectorBlock times(Scaled s) const {
        VectorBlock r{{}, exponent + s.exponent() + 31};
        for (int i = 0; i < 3; ++i) r.mantissa[i] = rounded<31>(detail::multiply(mantissa[i], s.mantissa()));
        return r;
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
    [[nodiscard]] friend constexpr VectorBlock cross(const VectorBlock& a, const VectorBlock& b) {
        const Vec3<Unit> u{Unit{a.mantissa[0]}, Unit{a.mantissa[1]}, Unit{a.mantissa[2]}};
        return of_sums({cross_sum<0>(u, b.mantissa), cross_sum<1>(u, b.mantissa), cross_sum<2>(u, b.mantissa)},
                       a.exponent + b.exponent);
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
        return {number<T>(mantissa[0]), number<T>(mantissa[1]), number<T>(mantissa[2])};
    }

private:
    template <int bits>
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int32_t rounded(std::int64_t sum) {
        return static_cast<std::int32_t>((sum + (std::int64_t{1} << (bits - 1))) >> bits);
    }
    template <int i>
    [[nodiscard]] TUMBLE_INLINE static constexpr std::int64_t cross_sum(const Vec3<Unit>& u,
                                                                        const std::int32_t (&m)[3]) {
        constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
        return detail::multiply_add(detail::multiply(u[j].raw, m[k]), -u[k].raw, m[j]);
    }
    // raw * 2^up, rounded, for |raw| < 2^62. Held at the widest sum.
    [[nodiscard, gnu::noinline]] static constexpr std::int64_t shifted(std::int64_t raw, int up) {
        if (up < 0) return up < -62 ? 0 : ((raw >> (-up - 1)) + 1) >> 1;
        if (raw == 0 || up < std::countl_zero(static_cast<std::uint64_t>(raw ^ (raw >> 63))) - 1)
            return raw == 0 ? 0 : raw * (std::int64_t{1} << up);
        return raw < 0 ? -N::widest : N::widest;
    }
    [[nodiscard]] constexpr std::int64_t sum(int i, Scaled factor, int fraction_bits) const {
        return shifted(detail::multiply(mantissa[i], factor.mantissa()), exponent + factor.exponent() + fraction_bits);
    }
    template <class T>
    [[nodiscard]] constexpr T number(std::int32_t m) const {
        if constexpr (std::is_same_v<T, float>) return detail::to_float(m, exponent);
        else return static_cast<T>(Scaled::of(m, exponent));
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
    [[nodiscard]] T drift(int i, T factor, typename N::Scale) const { return v[i] * factor; }
    [[nodiscard]] T turn(int i, T factor, typename N::Scale) const { return v[i] * factor; }
    [[nodiscard]] T position(int i) const { return v[i]; }
    [[nodiscard]] bool is_zero() const { return v[0] == T(0) && v[1] == T(0) && v[2] == T(0); }
    [[nodiscard]] VectorBlock rotated(const Quat<T>& q) const { return {rotate(q, v)}; }
    [[nodiscard]] VectorBlock rotated_back(const Quat<T>& q) const { return {rotate_back(q, v)}; }
    [[nodiscard]] VectorBlock turned(const Vec3<T>& u) const { return {v + tumble::cross<T>(u, v)}; }
    [[nodiscard]] static T half_angle(T t, T rate, typename N::Scale) { return t * rate * T(0.5); }
    [[nodiscard]] VectorBlock times(T s) const { return {scaled_by(v, s)}; }
    [[nodiscard]] VectorBlock times(const Vector3<T>& s) const { return {{v[0] * s.x, v[1] * s.y, v[2] * s.z}}; }
    [[nodiscard]] friend VectorBlock cross(const VectorBlock& a, const VectorBlock& b) {
        return {tumble::cross<T>(a.v, b.v)};
    }
    [[nodiscard]] friend VectorBlock operator+(const VectorBlock& a, const VectorBlock& b) { return {a.v + b.v}; }
    template <class To>
    [[nodiscard]] Vector3<To> as() const {
        return {static_cast<To>(v[0]), static_cast<To>(v[1]), static_cast<To>(v[2])};
    }
};

}  // namespace tumble
