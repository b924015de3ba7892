// Free rotation by splitting off a symmetric top (Touma & Wisdom 1994; McLachlan 1993). The Hamiltonian |m|^2 / 2I_y of a
// sphere with the middle moment is exact and common to all axes; what is left turns about the x axis (largest moment)
// and the z axis (smallest):  sphere for h, x for h/2, z for h, x for h/2.  |m|^2 commutes with everything, so where the
// sphere's turn stands does not matter: the map is symmetric in time. Order 2, |m| and the world's angular momentum exact
// to rounding, exact for spheres and symmetric tops. No division, no square root.
// Error constant: |1/I_x - 1/I_y| |1/I_z - 1/I_y|.
#pragma once

#include <tumble/integrators/method.hpp>

namespace tumble {

template <class N>
struct SymmetricTopInertia {
    typename N::template CoefficientOf<32> x_angle;   // I_y/I_x - 1, in [-1/2, 0]: angle of the half step about x, per turn
    typename N::Coefficient z_half_angle;   // (I_y/I_z - 1) / 2^z_shift: half angle of the full step about z, per turn
    std::int8_t z_shift;                    // a thin rod's spin is large for its momentum: 0 up to I_y = 2 I_z
    std::int8_t most_up;                    // for N::Block

    // The spin is h/2 L / I_y; moments are sorted downwards.
    [[nodiscard]] static constexpr SymmetricTopInertia of(RealVec3 moments, typename N::Scale scale) {
        const Real z = moments.y / moments.z - Real{1};
        const int shift = N::fixed_point && z > Real{1} ? z.ceil_log2_bound() : 0;
        return {N::template constant<typename N::template CoefficientOf<32>>(moments.y / moments.x - Real{1}),
                N::template constant<typename N::Coefficient>(z * Real::scaled(1, -shift)), static_cast<std::int8_t>(shift),
                static_cast<std::int8_t>(N::Block::most_up(scale, shift))};
    }
};

namespace detail {

// A turn about a body axis, by twice the half angle that its quaternion needs.
template <class N>
struct AxisTurn {
    typename N::Turn twice_sine;          // of the half angle
    typename N::Angle cosine_less_one;    // of the half angle

    [[nodiscard]] TUMBLE_INLINE static AxisTurn of(typename N::Turn angle, const SinCosSeries<typename N::Angle>& series, Dither d) {
        return {N::Block::stretched(angle, series.sinc_less_one, d.angle), series.cos_less_one};
    }
};

// m <- R(-angle) m about axis i, with the half angle's sine s and cosine c:  dm_j = 2s (c m_k - s m_j),
// dm_k = -2s (c m_j + s m_k).  Written so, an error of one unit in s or c changes |m| by only s units.
// These are the two brackets.
template <class N>
struct Across {
    typename N::Turn j, k;

    [[nodiscard]] TUMBLE_INLINE static Across of(typename N::Turn m_j, typename N::Turn m_k, const AxisTurn<N>& t, typename N::Block block, Dither d) {
        const auto sine = block.half_angle(t.twice_sine, d);
        return {upper_word(mul_add(mul_add(N::Block::widen(m_k), t.cosine_less_one, m_k), -sine, m_j)),
                upper_word(mul_add(mul_add(N::Block::widen(m_j), t.cosine_less_one, m_j), sine, m_k))};
    }
};

}  // namespace detail

struct SymmetricTopFlow {
    template <class N>
    using Inertia = SymmetricTopInertia<N>;

    template <class N>
    TUMBLE_INLINE static void flow(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia, const StepInfo<N>& step) {
        using namespace detail;
        using Turn = typename N::Turn;
        using Angle = typename N::Angle;
        using Block = typename N::Block;
        using Series = SinCosSeries<Angle>;
        const Dither d = step.dither;
        const auto block = Block::of(N::sum(body.t_b.x), N::sum(body.t_b.y), N::sum(body.t_b.z), inertia.z_shift, inertia.most_up, step.scale);
        // All turns below share the block's power of two. z times 2^z_shift keeps the digits that a rod's spin needs.
        const Turn z_up = block.turn(N::sum(body.t_b.z), d, inertia.z_shift);
        const Turn x = block.turn(N::sum(body.t_b.x), d), y = block.turn(N::sum(body.t_b.y), d), z = block.down(z_up, inertia.z_shift);

        // x for half a step, |half angle| <= 1/16 because I_x <= I_y + I_z
        const Turn angle1 = block.share(inertia.x_angle, x, d);
        const auto x1 = AxisTurn<N>::of(angle1, Series::of_small(block.quarter_square(mul(angle1, angle1))), d);
        const auto a1 = Across<N>::of(y, z, x1, block, d);
        auto dz = mul(-x1.twice_sine, a1.k);
        auto dy = mul(x1.twice_sine, a1.j);

        // z for a step
        const Turn angle2 = block.twice_share(inertia.z_half_angle, z_up + block.turn_up(dz, inertia.z_shift), d);
        const auto z1 = AxisTurn<N>::of(angle2, Series::of(block.quarter_square(mul(angle2, angle2))), d);
        const auto a2 = Across<N>::of(x, y + block.turn(dy), z1, block, d);
        const auto dx = mul(z1.twice_sine, a2.j);
        dy = mul_sub(dy, z1.twice_sine, a2.k);

        // x for half a step
        const Turn x_end = x + block.turn(dx);
        const Turn angle3 = block.share(inertia.x_angle, x_end, d);
        const auto x2 = AxisTurn<N>::of(angle3, Series::of_small(block.quarter_square(mul(angle3, angle3))), d);
        const auto a3 = Across<N>::of(y + block.turn(dy), z + block.turn(dz), x2, block, d);
        dz = mul_sub(dz, x2.twice_sine, a3.k);
        dy = mul_add(dy, x2.twice_sine, a3.j);
        const Vec3<Turn> end{x_end, y + block.turn(dy), z + block.turn(dz)};
        body.t_b.x.add(block.increment(dx));
        body.t_b.y.add(block.increment(dy));
        body.t_b.z.add(block.increment(dz));

        // The three turns together: (cos b cos(a1 + a2), cos b sin(a1 + a2), sin b sin(a2 - a1), sin b cos(a2 - a1)) with
        // the half angles a1, b, a2: less one, and twice the vector.
        const Turn u1 = Block::stretched(x1.twice_sine, x2.cosine_less_one, d.delta);
        const Turn u2 = Block::stretched(x2.twice_sine, x1.cosine_less_one, d.delta);
        const Angle cosines = x1.cosine_less_one + x2.cosine_less_one + upper_word(mul(x1.cosine_less_one, x2.cosine_less_one));
        const Angle sines = block.quarter_square(mul(x1.twice_sine, x2.twice_sine));
        const Angle cosine_of_sum = cosines - sines;
        const Angle p_w = cosine_of_sum + z1.cosine_less_one + upper_word(mul(cosine_of_sum, z1.cosine_less_one));
        const Vec3<Turn> p{Block::stretched(u1 + u2, z1.cosine_less_one, d.turn), block.half_turn(mul(z1.twice_sine, u2 - u1)),
                           Block::stretched(z1.twice_sine, cosines + sines, d.delta)};

        // The sphere's turn, by the momentum at the end.
        const auto sphere = Series::of(block.square(dot(end, end)));
        const Vec3<Turn> e{Block::stretched(end.x(), sphere.sinc_less_one, d.delta), Block::stretched(end.y(), sphere.sinc_less_one, d.delta),
                           Block::stretched(end.z(), sphere.sinc_less_one, d.delta)};
        const Angle e_w = sphere.cos_less_one;

        // (1 + p_w, p / 2) (1 + e_w, e), less one
        const Vec3<Angle> ea{block.angle(e.x()), block.angle(e.y()), block.angle(e.z())};
        const Vec3<Angle> pa{block.half_angle(p.x()), block.half_angle(p.y()), block.half_angle(p.z())};
        const auto component = [&](auto axis) {
            constexpr int i = axis;
            return upper_word(add_cross_component<i>(mul_add(mul_add(block.angle_sum(e[i], p[i], d), pa[i], e_w), ea[i], p_w), pa, ea));
        };
        const Angle w = e_w + p_w + upper_word(mul_sub(mul_sub(mul_sub(mul(e_w, p_w), ea.x(), pa.x()), ea.y(), pa.y()), ea.z(), pa.z()));
        turn<N>(body.q_wb, Delta<N>{w, {component(std::integral_constant<int, 0>{}), component(std::integral_constant<int, 1>{}),
                                        component(std::integral_constant<int, 2>{})}});
    }
};

}  // namespace tumble
