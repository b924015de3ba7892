// Free rotation by splitting into turns about the three body axes (McLachlan 1993, Reich 1994; the NO_SQUISH scheme of
// molecular dynamics is the same flow): x and y for h/2, z for h, y and x for h/2. The middle moment is second, the
// best order of the axes. Order 2, symmetric, |m| exact to rounding. Exact only for a body that turns about an axis.
// For comparison. No division, no square root.
#pragma once

#include <tumble/integrators/rotation/axis_turn.hpp>

namespace tumble {

template <class N>
struct ThreeAxisInertia {
    typename N::Coefficient x_half;  // I_y / 2 I_x: half the angle of the half step about x, per turn
    typename N::Coefficient z_half;  // I_y / I_z / 2^z_shift: half the angle of the step about z, per turn
    std::int8_t z_shift, most_up;

    // The flow follows a spin about z that has room times 2^z_room.
    [[nodiscard]] constexpr int z_room() const { return z_shift; }
    // The spin is h/2 L / I_y; moments are sorted downwards.
    [[nodiscard]] static constexpr ThreeAxisInertia of(RealVec3 moments, typename N::Scale scale) {
        using Coefficient = typename N::Coefficient;
        const Real z = moments.y / moments.z;
        const int shift = N::fixed_point ? z.ceil_log2_bound() : 0;  // 1 itself is held as the largest number below it
        return {N::template constant<Coefficient>(moments.y / moments.x * Real::scaled(1, -1)),
                N::template constant<Coefficient>(z * Real::scaled(1, -shift)), static_cast<std::int8_t>(shift),
                static_cast<std::int8_t>(N::Block::most_up(scale, shift))};
    }
};

struct ThreeAxisFlow {
    template <class N>
    using Inertia = ThreeAxisInertia<N>;

    template <class N>
    static Turned flow(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia, const StepInfo<N>& step) {
        using Turn = typename N::Turn;
        using Angle = typename N::Angle;
        using Block = typename N::Block;
        const Dither d = step.dither;
        const auto block = Block::of(N::sum(body.t_b.x), N::sum(body.t_b.y), N::sum(body.t_b.z), inertia.z_shift,
                                     inertia.most_up, step.scale);
        if (block.is_out_of_range()) [[unlikely]]
            return Turned::too_far;
        const Turn z_up = block.turn(N::sum(body.t_b.z), d, inertia.z_shift);
        const Turn start[3] = {block.turn(N::sum(body.t_b.x), d), block.turn(N::sum(body.t_b.y), d),
                               block.down(z_up, inertia.z_shift)};
        Turn now[3] = {start[0], start[1], start[2]};
        typename N::TurnProduct less[3]{};
        Delta<N> turned = Delta<N>::identity();

        // Turns the body about `axis`: m <- R(-angle) m, and the delta from the right.
        const auto turn_about = [&](auto axis, Turn angle) __attribute__((always_inline)) {
            constexpr int k = axis, i = (k + 1) % 3, j = (k + 2) % 3;
            const Angle half = block.half_angle(angle);
            const auto a = detail::AxisTurn<N>::of(angle, SinCosSeries<Angle>::of(mul_upper(half, half)), block, d);
            less[i] = mul_sub(mul_add(less[i], a.versine, now[i]), a.sine, now[j]);
            less[j] = mul_add(mul_add(less[j], a.sine, now[i]), a.versine, now[j]);
            now[i] = start[i] - block.turn(less[i]);
            now[j] = start[j] - block.turn(less[j]);
            // (1 + w, v) (1 + c, s e_k), less one. Each product becomes a dithered angle.
            const auto with = [&](Angle to, std::uint32_t dither, Angle p, Angle q) {
                return upper_word(mul_add(Block::widen(to, dither), p, q));
            };
            const Angle s = a.half_sine, c = a.cosine_less_one, w = turned.w;
            const Angle vi = turned.v[i], vj = turned.v[j], vk = turned.v[k];
            turned.w = with(with(w + c, d.turn, w, c), d.angle, -vk, s);
            turned.v[k] = with(with(vk + s, d.turn, vk, c), d.angle, w, s);
            turned.v[i] = with(with(vi, d.delta, vi, c), d.angle, vj, s);
            turned.v[j] = with(with(vj, d.delta, vj, c), d.angle, -vi, s);
        };
        using std::integral_constant;
        turn_about(integral_constant<int, 0>{}, Block::twice_share(inertia.x_half, now[0], d));
        turn_about(integral_constant<int, 1>{}, now[1]);
        // The turns about x and y may have moved momentum to the z axis, about which the body turns fastest.
        if (!Block::holds_twice(now[2], inertia.z_shift)) [[unlikely]]
            return Turned::too_far;
        turn_about(integral_constant<int, 2>{},
                   Block::twice_share(inertia.z_half, z_up - block.turn_up(less[2], inertia.z_shift), d));
        turn_about(integral_constant<int, 1>{}, now[1]);
        turn_about(integral_constant<int, 0>{}, Block::twice_share(inertia.x_half, now[0], d));
        block.lower(body.t_b.x, less[0]);
        block.lower(body.t_b.y, less[1]);
        block.lower(body.t_b.z, less[2]);
        turn<N>(body.q_wb, turned);
        return Turned::done;
    }
};

}  // namespace tumble
