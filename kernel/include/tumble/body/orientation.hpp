// Rotates a unit quaternion by a small delta, which is kept relative to the identity: delta = (1 + w, v), |v| < 1/2.
// Each component is rounded once a step. The renormalisation is part of the product and needs no square root.
#pragma once

#include <tumble/body/state.hpp>
#include <tumble/numbers/vectors.hpp>

namespace tumble {

// What a step of a free rotation has done. too_far: nothing, because the body turns further in the step than the
// formats of fixed point follow.
enum class Turned : std::uint8_t { done, not_converged, too_far };

// A rotation less the identity: the quaternion (1 + w, v). w is computed as minus 2 sin^2, so it stays accurate.
template <class N>
struct Delta {
    typename N::Angle w;
    Vec3<typename N::Angle> v;

    [[nodiscard]] TUMBLE_INLINE static Delta identity() {
        constexpr typename N::Angle zero{};
        return {zero, {zero, zero, zero}};
    }
    // The rotation with tan(angle/2) = |half_turn|. Its length is 1 to |half_turn|^4 / 8. For Euler's methods, with a
    // renormalisation of its own.
    [[nodiscard]] TUMBLE_INLINE static Delta of(const Vec3<typename N::Angle>& half_turn) {
        return {-N::half_angle(upper_word(dot(half_turn, half_turn))), half_turn};
    }
};

// (1 + z)^(-1/2) - 1 for 0 <= z < 1/4, which makes (1, c) a unit quaternion, z = |c|^2. In fixed point: three terms of
// the series and a Newton step. In floating point: a square root and a division.
template <class N>
[[nodiscard]] TUMBLE_INLINE typename N::Angle inverse_length_less_one(typename N::Angle z) {
    using Angle = typename N::Angle;
    if constexpr (N::fixed_point) {
        const auto times = [](Angle a, Angle b) { return mul_upper(a, b); };
        constexpr Angle c2 = Angle::from(Real{0.375}), c3 = Angle::from(Real{0.3125});
        const Angle r = times(z, times(z, c2 - times(z, c3))) - N::half_angle(z);
        // (1 + z) (1 + r)^2 = 1 + excess
        const Angle square = r + r + times(r, r), excess = z + square + times(z, square);
        const Angle half = N::half_angle(excess);
        return r - half - times(half, r);
    } else {
        const Angle root = sqrt(Angle(1) + z);
        return -z / (root * (Angle(1) + root));
    }
}

// (|q|^2 - 1) / 2, the excess of the norm to first order.
template <class N>
[[nodiscard]] TUMBLE_INLINE typename N::Angle norm_excess(const Quat<typename N::Unit>& q) {
    const auto norm2 = mul_add(mul_add(mul_add(mul(q.w, q.w), q.v.x(), q.v.x()), q.v.y(), q.v.y()), q.v.z(), q.v.z());
    if constexpr (N::fixed_point) {
        constexpr auto one = decltype(norm2){std::int64_t{1} << decltype(norm2)::fraction_bits};
        return narrow<typename N::Angle>(Wide<decltype(norm2)::fraction_bits + 1>{(norm2 - one).raw});
    } else {
        return (norm2 - typename N::Angle(1)) * typename N::Angle(0.5);
    }
}

// q <- q (1 + delta) (1 - excess). 16 multiplications, whose sums go unrounded to the carried state.
template <class N>
TUMBLE_INLINE void turn(IntegratedQuat<N>& q_wb, Delta<N> delta) {
    const Quat<typename N::Unit> q = q_wb.value();
    const auto w = delta.w - norm_excess<N>(q);
    const auto& v = delta.v;
    q_wb.w.accumulate(q.w, w, [&](auto sum) {
        return mul_sub(mul_sub(mul_sub(sum, q.v.x(), v.x()), q.v.y(), v.y()), q.v.z(), v.z());
    });
    q_wb.x.accumulate(q.w, v.x(), [&](auto sum) { return add_cross_component<0>(mul_add(sum, q.v.x(), w), q.v, v); });
    q_wb.y.accumulate(q.w, v.y(), [&](auto sum) { return add_cross_component<1>(mul_add(sum, q.v.y(), w), q.v, v); });
    q_wb.z.accumulate(q.w, v.z(), [&](auto sum) { return add_cross_component<2>(mul_add(sum, q.v.z(), w), q.v, v); });
}

// q (1 + delta), rounded to the components of a unit quaternion, without renormalisation.
template <class N>
[[nodiscard]] TUMBLE_INLINE Quat<typename N::Unit> turned(const Quat<typename N::Unit>& q, const Delta<N>& delta) {
    using Unit = typename N::Unit;
    return {
        q.w + narrow<Unit>(mul(q.w, delta.w) - dot(q.v, delta.v)),
        {q.v.x() + narrow<Unit>(add_cross_component<0>(mul_add(mul(q.w, delta.v.x()), q.v.x(), delta.w), q.v, delta.v)),
         q.v.y() + narrow<Unit>(add_cross_component<1>(mul_add(mul(q.w, delta.v.y()), q.v.y(), delta.w), q.v, delta.v)),
         q.v.z() +
             narrow<Unit>(add_cross_component<2>(mul_add(mul(q.w, delta.v.z()), q.v.z(), delta.w), q.v, delta.v))}};
}

namespace detail {

// The inverse of the root of a number of [1/4, 1), given times 2^32, to 2^-22 of it; times 2^29. A line, whose error is
// 0.086, and Newton's iteration: twice in 16 bits, which leave 3e-4, and once in 32.
[[nodiscard]] constexpr std::int32_t inverse_root(std::uint32_t a) {
    const std::uint32_t upper = a >> 16;
    std::uint32_t y = 34942 - ((19967 * upper) >> 16);  // times 2^14: 2.1327 - 1.2187 a
    for (int i = 0; i < 2; ++i) y = (y * (3 * 32768 - ((upper * ((y * y) >> 14)) >> 15))) >> 16;
    const auto square = multiply(static_cast<std::int32_t>(a >> 1), static_cast<std::int32_t>(y * y)) >> 31;
    return static_cast<std::int32_t>(
        multiply(static_cast<std::int32_t>(y), (3 << 28) - static_cast<std::int32_t>(square)) >> 14);
}

// q / |q| in the format of a state, whose length is 1 to 2^-22. A q of zero is misuse.
template <class N>
requires(N::fixed_point) [[nodiscard]] constexpr Quat<typename N::Unit> unit_of(const Quaternion<Scaled>& q) {
    const Scaled c[4]{q.w, q.v.x, q.v.y, q.v.z};
    int most = INT32_MIN;
    for (const Scaled& s : c)
        if (!s.is_zero() && s.exponent() > most) most = s.exponent();
    std::int32_t m[4]{};
    std::uint64_t norm2 = 0;  // below 2^64, and at least 2^60
    for (int i = 0; i < 4; ++i) {
        const int drop = most - c[i].exponent();
        if (c[i].is_zero() || drop > 31) continue;
        m[i] = drop == 0 ? c[i].mantissa() : ((c[i].mantissa() >> (drop - 1)) + 1) >> 1;
        norm2 += static_cast<std::uint64_t>(multiply(m[i], m[i]));
    }
    TUMBLE_ASSERT(norm2 != 0);
    const auto upper = static_cast<std::uint32_t>(norm2 >> 32);
    const bool is_small = upper >> 30 == 0;
    const std::int32_t root = inverse_root(is_small ? static_cast<std::uint32_t>(norm2 >> 30) : upper),
                       factor = is_small ? root : root >> 1;
    const auto component = [&](int i) {
        return typename N::Unit{static_cast<std::int32_t>((multiply(m[i], factor) + (std::int64_t{1} << 29)) >> 30)};
    };
    return {component(0), {component(1), component(2), component(3)}};
}

template <class T>
[[nodiscard]] TUMBLE_INLINE constexpr Quaternion<T> over(const Quaternion<T>& q, T length) {
    return {q.w / length, {q.v.x / length, q.v.y / length, q.v.z / length}};
}
// q / |q| where the squares of the components leave the range although the components do not. A q of zero is misuse.
template <class N>
[[nodiscard, gnu::noinline, gnu::cold]] constexpr Quaternion<typename N::Unit>
unit_of_extreme(Quaternion<typename N::Unit> q) {
    auto largest = N::magnitude(q.w);
    for (const auto component : {q.v.x, q.v.y, q.v.z})
        if (N::magnitude(component) > largest) largest = N::magnitude(component);
    TUMBLE_ASSERT(largest > typename N::Unit(0));
    const auto from = over(q, largest);
    return over(from, sqrt(from.w * from.w + dot(from.v, from.v)));
}

}  // namespace detail

// q_wb = q / |q| times p, a unit quaternion.
template <class N>
TUMBLE_INLINE void set_product(IntegratedQuat<N>& q_wb, const Quaternion<typename N::Work>& q,
                               const Quat<typename N::Unit>& p) {
    using Unit = typename N::Unit;
    const auto set = [](auto& number, auto value) {
        number = {};
        number.add(value);
    };
    if constexpr (N::fixed_point) {
        const Quat<Unit> u = detail::unit_of<N>(q);
        const auto excess = norm_excess<N>(u);  // of the length; 1.5 times its square is left
        const auto scaled = [&](auto sum) {
            const auto product = mul_sub(sum, upper_word(sum), excess);
            return Wide<Unit::fraction_bits + 32>{product.raw * (std::int64_t{1} << (32 - Unit::fraction_bits))};
        };
        set(q_wb.w,
            scaled(mul_sub(mul_sub(mul_sub(mul(u.w, p.w), u.v.x(), p.v.x()), u.v.y(), p.v.y()), u.v.z(), p.v.z())));
        const auto component = [&]<int i>() {
            return scaled(add_cross_component<i>(mul_add(mul(u.w, p.v[i]), u.v[i], p.w), u.v, p.v));
        };
        set(q_wb.x, component.template operator()<0>());
        set(q_wb.y, component.template operator()<1>());
        set(q_wb.z, component.template operator()<2>());
    } else {
        const Unit norm2 = q.w * q.w + dot(q.v, q.v);
        const bool is_ordinary = N::is_normal(norm2);
        const Quaternion<Unit> to = is_ordinary ? detail::over(q, sqrt(norm2)) : detail::unit_of_extreme<N>(q),
                               product = to * Quaternion<Unit>{p.w, {p.v.x(), p.v.y(), p.v.z()}};
        set(q_wb.w, product.w);
        set(q_wb.x, product.v.x);
        set(q_wb.y, product.v.y);
        set(q_wb.z, product.v.z);
    }
}

}  // namespace tumble
