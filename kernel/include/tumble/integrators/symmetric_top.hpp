// Free rotation by splitting off a symmetric top (Touma & Wisdom 1994; McLachlan 1993). The Hamiltonian |m|^2 / 2I_y of a
// sphere with the middle moment is exact and common to all axes; what is left turns about the x axis (largest moment)
// and the z axis (smallest):  x for h/2, sphere for h, z for h, x for h/2.  Order 2, symmetric in time, |m| and the
// world's angular momentum exact to rounding, exact for spheres and symmetric tops. No division, no square root.
// Error constant: |1/I_x - 1/I_y| |1/I_z - 1/I_y|.
#pragma once

#include <tumble/integrators/method.hpp>

namespace tumble {

template <class N>
struct SymmetricTopInertia {
    using Turn = typename N::Turn;

    typename N::template CoefficientOf<32> x_half_angle;   // (I_y/I_x - 1) / 2: half angle of the half step about x, per turn
    typename N::Coefficient z_angle;        // (I_y/I_z - 1) / 2^z_shift: half angle of the full step about z, per turn
    std::int8_t z_shift;                    // a thin rod's spin is large for its momentum: 0 up to I_y = 2 I_z

    // The spin is h/2 L / I_y; moments are sorted downwards.
    [[nodiscard]] static constexpr SymmetricTopInertia of(RealVec3 moments, typename N::Scale) {
        const Real z = moments.y / moments.z - Real{1};
        const int shift = N::fixed_point && z > Real{1} ? z.ceil_log2_bound() : 0;
        return {N::template constant<typename N::template CoefficientOf<32>>((moments.y / moments.x - Real{1}) * Real::scaled(1, -1)),
                N::template constant<typename N::Coefficient>(z * Real::scaled(1, -shift)), static_cast<std::int8_t>(shift)};
    }
};

namespace detail {

// A turn about one body axis, from its half angle: what the quaternion needs (angles) and what the momentum needs.
template <class N>
struct AxisTurn {
    typename N::Angle sine, one_minus_cosine;   // of the half angle
    typename N::TurnSum twice_sine;             // of the half angle, scaled as turns are, all digits

    [[nodiscard]] TUMBLE_INLINE static AxisTurn of(typename N::TurnSum half, const StepInfo<N>& step) {
        const auto h = N::narrow_turn(half);
        const auto z = N::square(mul(h, h), step.scale);
        const auto sine = mul_sub(half, h, one_minus_sinc(z));
        return {N::angle(sine, step.scale, step.dither), one_minus_cos(z), sine + sine};
    }
};

// The momentum's change when the frame turns about axis i: m <- R(-angle) m, as exact products.
// With the half angle's sine s and cosine c:  dm_j = 2s (c m_k - s m_j),  dm_k = -2s (c m_j + s m_k).  Written so, an
// error of one unit in s or c changes |m| by only s units.
template <int i, class N>
struct MomentumChange {
    typename N::TurnProduct j, k;

    [[nodiscard]] TUMBLE_INLINE static MomentumChange of(const Vec3<typename N::Turn>& m, const AxisTurn<N>& t) {
        using Turn = typename N::Turn;
        constexpr int a = (i + 1) % 3, b = (i + 2) % 3;
        const Turn along_j = m[b] - narrow<Turn>(mul_add(mul(t.one_minus_cosine, m[b]), t.sine, m[a]));
        const Turn along_k = narrow<Turn>(mul_sub(mul(t.one_minus_cosine, m[a]), t.sine, m[b])) - m[a];
        return {N::mul_sum(t.twice_sine, along_j), N::mul_sum(t.twice_sine, along_k)};
    }
};

// (1 + delta) (cos + sin e_i): a turn about a body axis after `delta`.
template <int i, class N>
[[nodiscard]] TUMBLE_INLINE Delta<N> then_turn(const Delta<N>& delta, const AxisTurn<N>& t, Dither d) {
    constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
    const auto& [w, v] = delta;
    Delta<N> r;
    r.w = w - t.one_minus_cosine - N::round_angle(mul_add(mul(w, t.one_minus_cosine), v[i], t.sine), d);
    r.v[i] = v[i] + t.sine + N::round_angle(mul_sub(mul(w, t.sine), v[i], t.one_minus_cosine), d);
    r.v[j] = v[j] + N::round_angle(mul_sub(mul(v[k], t.sine), v[j], t.one_minus_cosine), d);
    r.v[k] = v[k] - N::round_angle(mul_add(mul(v[j], t.sine), v[k], t.one_minus_cosine), d);
    return r;
}

// (cos + sin e_i) (1 + delta): a turn about a body axis before `delta`.
template <int i, class N>
[[nodiscard]] TUMBLE_INLINE Delta<N> turn_then(const AxisTurn<N>& t, const Delta<N>& delta, Dither d) {
    constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
    const auto& [w, v] = delta;
    Delta<N> r;
    r.w = w - t.one_minus_cosine - N::round_angle(mul_add(mul(w, t.one_minus_cosine), v[i], t.sine), d);
    r.v[i] = v[i] + t.sine + N::round_angle(mul_sub(mul(w, t.sine), v[i], t.one_minus_cosine), d);
    r.v[j] = v[j] - N::round_angle(mul_add(mul(v[k], t.sine), v[j], t.one_minus_cosine), d);
    r.v[k] = v[k] + N::round_angle(mul_sub(mul(v[j], t.sine), v[k], t.one_minus_cosine), d);
    return r;
}

// exp of the half turn vector, relative to identity.
template <class N>
[[nodiscard]] TUMBLE_INLINE Delta<N> exponential(const typename N::TurnSum (&sum)[3], const StepInfo<N>& step) {
    using Turn = typename N::Turn;
    using TurnSum = typename N::TurnSum;
    const Vec3<Turn> t{N::narrow_turn(sum[0]), N::narrow_turn(sum[1]), N::narrow_turn(sum[2])};
    const auto z = N::square(dot(t, t), step.scale);
    const auto oms = one_minus_sinc(z);
    const auto component = [&](Turn a, TurnSum all) { return N::angle(mul_sub(all, a, oms), step.scale, step.dither); };
    return {-one_minus_cos(z), {component(t.x(), sum[0]), component(t.y(), sum[1]), component(t.z(), sum[2])}};
}

}  // namespace detail

struct SymmetricTopFlow {
    template <class N>
    using Inertia = SymmetricTopInertia<N>;

    template <class N>
    TUMBLE_INLINE static void flow(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia, const StepInfo<N>& step) {
        using namespace detail;
        const auto scale = step.scale;
        typename N::TurnSum m[3] = {N::sum(body.t_b.x), N::sum(body.t_b.y), N::sum(body.t_b.z)};
        const auto rounded = [&] { return Vec3<typename N::Turn>{N::narrow_turn(m[0]), N::narrow_turn(m[1]), N::narrow_turn(m[2])}; };

        const auto x1 = AxisTurn<N>::of(N::share(inertia.x_half_angle, m[0]), step);
        const auto c1 = MomentumChange<0, N>::of(rounded(), x1);
        m[1] += N::turn_increment(c1.j, scale);
        m[2] += N::turn_increment(c1.k, scale);

        const auto sphere = exponential<N>(m, step);
        const auto z = AxisTurn<N>::of(N::share(inertia.z_angle, N::scaled_up(m[2], inertia.z_shift)), step);
        const auto c2 = MomentumChange<2, N>::of(rounded(), z);
        m[0] += N::turn_increment(c2.j, scale);
        m[1] += N::turn_increment(c2.k, scale);

        const auto x2 = AxisTurn<N>::of(N::share(inertia.x_half_angle, m[0]), step);
        const auto c3 = MomentumChange<0, N>::of(rounded(), x2);

        turn<N>(body.q_wb, then_turn<0, N>(then_turn<2, N>(turn_then<0, N>(x1, sphere, step.dither), z, step.dither), x2, step.dither));
        body.t_b.x.add(N::turn_increment(c2.j, scale));
        body.t_b.y.add(N::turn_increment(c1.j + c2.k + c3.j, scale));
        body.t_b.z.add(N::turn_increment(c1.k + c3.k, scale));
    }
};

}  // namespace tumble
