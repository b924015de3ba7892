// Semi-implicit Euler: velocity first, then position with the new velocity; the same for spin and orientation. Game
// engines use it; this version has the gyroscopic term. Order 1. No division, no square root.
#pragma once

#include <tumble/integrators/method.hpp>
#include <tumble/integrators/rotation/euler_equations.hpp>
#include <tumble/integrators/stability.hpp>

namespace tumble::detail {

struct SemiImplicitOnOscillator {
    static constexpr OscillatorStep step(double k, double c) {
        return OscillatorStep{1, 1, 0, 1} * OscillatorStep{1, 0, -k, 1 - c};
    }
};

}  // namespace tumble::detail

namespace tumble::integrators {

// Order 1: velocity first, then position with the new velocity.
struct SemiImplicitEuler : Stability<tumble::detail::SemiImplicitOnOscillator> {
    static constexpr const char* name = "semi_implicit_euler";
    static constexpr int order = 1;
    static constexpr Spin spin = Spin::angular_velocity;
    static constexpr Coasting coasting = Coasting::end;

    template <class N>
    using Inertia = EulerInertia<N, 1>;

    template <class N>
    TUMBLE_INLINE static void rotate(BodyState<N, Spin::angular_velocity>& body, const Inertia<N>& inertia,
                                     const StepInfo<N>& step) {
        const auto products = TurnProducts<N>::of(body.t_b.value());
        N::add_turn(body.t_b.x, inertia.summed[0], products.v[0], step.scale);
        N::add_turn(body.t_b.y, inertia.summed[1], products.v[1], step.scale);
        N::add_turn(body.t_b.z, inertia.summed[2], products.v[2], step.scale);
        turn<N>(body.q_wb, Delta<N>::of(angles<N>(body.t_b.take(), step)));
    }

    template <class N, int capacity, class Group, class Evaluate>
    static bool advance(const Group& group, Evaluate&& evaluate, const StepInfo<N>& step) {
        group.has_bodies();
        typename Group::Stage state[capacity];
        typename Group::Kick kick[capacity];
        for (int b = 0; b < group.count; ++b) group.take(b, state[b]);
        evaluate(state, kick);
        for (int b = 0; b < group.count; ++b) {
            auto& body = *group.body[b];
            for (int i = 0; i < 3; ++i) {
                N::add(body.d_w[i], kick[b].linear[i]);
                N::coast(body.x_w[i], body.d_w[i], {}, step.scale);
            }
            if constexpr (Group::rotation) {
                if (!group.rotates(b)) continue;
                const auto products = TurnProducts<N>::of(state[b].t_b);
                for (int i = 0; i < 3; ++i) {
                    N::add_turn(body.t_b[i], group.inertia[b]->summed[i], products.v[i], step.scale);
                    body.t_b[i].add(kick[b].angular[i]);
                }
                turn<N>(body.q_wb, Delta<N>::of(angles<N>(body.t_b.take(), step)));
            }
        }
        return true;
    }
};

}  // namespace tumble::integrators
