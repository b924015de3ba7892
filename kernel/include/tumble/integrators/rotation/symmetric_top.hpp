// Free rotation by splitting off a symmetric top (Touma & Wisdom 1994; McLachlan 1993). The Hamiltonian |m|^2 / 2I_y of
// a sphere with the middle moment is exact and common to all axes. The rest turns about the x axis (largest moment) and
// the z axis (smallest): sphere for h, x for h/2, z for h, x for h/2. |m|^2 commutes with everything, so the map is
// symmetric in time wherever the sphere's turn stands. Order 2. |m| and the world's angular momentum are exact to
// rounding. Exact for spheres and symmetric tops. No division, no square root. Error constant: |1/I_x - 1/I_y| |1/I_z -
// 1/I_y|.
#pragma once

#include <tumble/integrators/rotation/axis_turn.hpp>
#include <tumble/integrators/rotation/composed.hpp>

namespace tumble {

template <class N, template <class> class Part = WholeStep>
struct SymmetricTopInertia {
    typename N::template CoefficientOf<32>
        x_angle;                           // I_y/I_x - 1, in [-1/2, 0]: angle of the half step about x, per turn
    typename N::Coefficient z_half_angle;  // (I_y/I_z - 1) / 2^z_shift: half angle of the full step about z, per turn
    std::int8_t z_shift;                   // a thin rod has a large spin for its momentum; 0 up to I_y = 2 I_z
    std::int8_t most_up;                   // for N::Block
    [[no_unique_address]] Part<N> part;

    // The flow follows a spin about z that has room times 2^z_room.
    [[nodiscard]] constexpr int z_room() const { return z_shift; }
    // The spin is h/2 L / I_y; moments are sorted downwards. `step` is the part of a step, in [-1, 1].
    [[nodiscard]] static constexpr SymmetricTopInertia of(RealVec3 moments, typename N::Scale scale, Real step = 1) {
        const Real z = moments.y / moments.z - Real{1};
        const int shift = N::fixed_point && z > Real{1} ? z.ceil_log2_bound() : 0;
        return {N::template constant<typename N::template CoefficientOf<32>>((moments.y / moments.x - Real{1}) * step),
                N::template constant<typename N::Coefficient>(z * step * Real::scaled(1, -shift)),
                static_cast<std::int8_t>(shift), static_cast<std::int8_t>(N::Block::most_up(scale, shift)),
                Part<N>::of(step)};
    }
};

struct SymmetricTopFlow {
    template <class N>
    using Inertia = SymmetricTopInertia<N>;
    template <class N>
    using PartInertia = SymmetricTopInertia<N, PartOfStep>;

    template <class N, template <class> class Part>
    TUMBLE_INLINE static Turned flow(BodyState<N, Spin::angular_momentum>& body,
                                     const SymmetricTopInertia<N, Part>& inertia, const StepInfo<N>& step) {
        using namespace detail;
        using Turn = typename N::Turn;
        using Angle = typename N::Angle;
        using Block = typename N::Block;
        using Series = SinCosSeries<Angle>;
        const Dither d = step.dither;
        const auto square_of = [](Angle a) { return mul_upper(a, a); };
        const auto block = Block::of(N::sum(body.t_b.x), N::sum(body.t_b.y), N::sum(body.t_b.z), inertia.z_shift,
                                     inertia.most_up, step.scale);
        if (block.is_out_of_range()) [[unlikely]]
            return Turned::too_far;
        // All turns below share the block's power of two. The factor 2^z_shift keeps the digits of a rod's spin about
        // z.
        const Turn z_up = block.turn(N::sum(body.t_b.z), d, inertia.z_shift);
        const Turn x = block.turn(N::sum(body.t_b.x), d), y = block.turn(N::sum(body.t_b.y), d),
                   z = block.down(z_up, inertia.z_shift);

        // Each turn is m <- R(-angle) m:  m_j -= (1 - cos) m_j - sin m_k,  m_k -= sin m_j + (1 - cos) m_k.  The versine
        // is computed from the same sine and dithered, so |m| stays the same to a unit over any number of steps. x for
        // half a step: |half angle| <= 1/16 because I_x <= I_y + I_z.
        const Turn angle1 = block.share(inertia.x_angle, x, d);
        const auto x1 = AxisTurn<N>::of(angle1, Series::of_small(square_of(block.half_angle(angle1))), block, d);
        auto less_z = mul_add(mul(x1.sine, y), x1.versine, z);
        auto less_y = mul_sub(mul(x1.versine, y), x1.sine, z);

        // z for a step
        const Turn angle2 = block.twice_share(inertia.z_half_angle, z_up - block.turn_up(less_z, inertia.z_shift), d);
        const auto z1 = AxisTurn<N>::of(angle2, Series::of(square_of(block.half_angle(angle2))), block, d);
        const Turn y_mid = y - block.turn(less_y);
        const auto less_x = mul_sub(mul(z1.versine, x), z1.sine, y_mid);
        less_y = mul_add(mul_add(less_y, z1.sine, x), z1.versine, y_mid);

        // x for half a step
        const Turn x_end = x - block.turn(less_x);
        forget_loaded();
        block.lower(body.t_b.x, less_x);
        const Turn angle3 = block.share(inertia.x_angle, x_end, d);
        const auto x2 = AxisTurn<N>::of(angle3, Series::of_small(square_of(block.half_angle(angle3))), block, d);
        const Turn y_late = y - block.turn(less_y), z_late = z - block.turn(less_z);
        less_z = mul_add(mul_add(less_z, x2.sine, y_late), x2.versine, z_late);
        less_y = mul_sub(mul_add(less_y, x2.versine, y_late), x2.sine, z_late);
        const Vec3<Turn> end{inertia.part(x_end, d), inertia.part(y - block.turn(less_y), d),
                             inertia.part(z - block.turn(less_z), d)};
        block.lower(body.t_b.y, less_y);
        block.lower(body.t_b.z, less_z);
        forget_loaded();

        // The three turns together, with the half angles a1, b, a2: (cos b cos(a1 + a2), cos b sin(a1 + a2), sin b
        // sin(a2 - a1), sin b cos(a2 - a1)), with the first component less one.
        const Angle s1 = x1.half_sine, s2 = x2.half_sine, c1 = x1.cosine_less_one, c2 = x2.cosine_less_one;
        const Angle u1 = Block::stretched(s1, c2, d.delta), u2 = Block::stretched(s2, c1, d.delta);
        const Angle cosines = c1 + c2 + mul_upper(c1, c2), sines = mul_upper(s1, s2);
        const Angle cosine_of_sum = cosines - sines;
        const Angle p_w = cosine_of_sum + z1.cosine_less_one + mul_upper(cosine_of_sum, z1.cosine_less_one);
        const Vec3<Angle> p{Block::stretched(u1 + u2, z1.cosine_less_one, d.turn),
                            Block::angle(z1.half_sine, u2 - u1, d.turn),
                            Block::stretched(z1.half_sine, cosines + sines, d.delta)};

        // The sphere's turn by the momentum at the end, (1 + e_w, e) with e = sinc * end:
        // (1 + p_w, p) (1 + e_w, e) = (.., p + p e_w + sinc (1 + p_w) end + p x e), less one.
        const auto sphere = Series::of(block.square(dot(end, end)));
        const Angle e_w = sphere.cos_less_one;
        const auto sinc = block.angle_per_turn(sphere.sinc_less_one, d);
        const auto sinc_p = Block::times_cosine(sinc, p_w, d.turn);
        const Vec3<Angle> e{Block::angle(end.x(), sinc), Block::angle(end.y(), sinc), Block::angle(end.z(), sinc)};
        const Angle w =
            e_w + p_w + upper_word(mul_sub(mul_sub(mul_sub(mul(e_w, p_w), p.x(), e.x()), p.y(), e.y()), p.z(), e.z()));
        const auto component = [&](auto axis) {
            constexpr int i = axis;
            return upper_word(add_cross_component<i>(
                mul_add(Block::add_angle(Block::widen(p[i], d.angle), end[i], sinc_p), p[i], e_w), p, e));
        };
        turn<N>(body.q_wb,
                Delta<N>{w,
                         {component(std::integral_constant<int, 0>{}), component(std::integral_constant<int, 1>{}),
                          component(std::integral_constant<int, 2>{})}});
        return Turned::done;
    }
};

}  // namespace tumble
