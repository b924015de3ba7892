// Kick-drift-kick: half a kick by forces and torques, a drift of the centre of mass with a torque-free rotation, and
// half a kick. Order 2, reversible in time. RotationFlow supplies the rotation; with no loads only it and the drift run.
// Velocity-dependent loads (drag, damping) keep the symmetry: the first half kick is explicit Euler's, the second is
// implicit Euler's, its adjoint, solved by fixed-point iteration.
#pragma once

#include <tumble/integrators/method.hpp>

namespace tumble::integrators {

template <class RotationFlow>
struct KickDriftKick {
    static constexpr Spin spin = Spin::angular_momentum;
    static constexpr Coasting coasting = Coasting::mean;

    template <class N>
    using Inertia = typename RotationFlow::template Inertia<N>;

    template <class N>
    TUMBLE_INLINE static void rotate(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia, const StepInfo<N>& step) {
        RotationFlow::template flow<N>(body, inertia, step);
    }

    template <class N, int capacity, class Evaluate>
    static bool advance(const Group<N, spin, Inertia<N>, capacity>& group, Evaluate&& evaluate, const StepInfo<N>& step) {
        StageState<N> state[capacity];
        Kick<N> kick[capacity];
        const auto kick_bodies = [&] {
            for (int b = 0; b < group.count; ++b) {
                for (int i = 0; i < 3; ++i) {
                    N::add(group.body[b]->d_w[i], N::half(kick[b].linear[i]));
                    group.body[b]->t_b[i].add(N::half_turn_sum(kick[b].angular[i]));
                }
            }
        };
        for (int b = 0; b < group.count; ++b) state[b] = stage_of(*group.body[b]);
        evaluate(state, kick);
        kick_bodies();
        for (int b = 0; b < group.count; ++b) {
            BodyState<N, Spin::angular_momentum>& body = *group.body[b];
            for (int i = 0; i < 3; ++i) N::coast(body.x_w[i], body.d_w[i], {}, step.scale);
            RotationFlow::template flow<N>(body, *group.inertia[b], step);
            state[b] = stage_of(body);
        }
        evaluate(state, kick);
        if (evaluate.depends_on_velocity()) {
            constexpr int iterations = 6;
            for (int iteration = 0; iteration < iterations; ++iteration) {
                StageState<N> end[capacity];
                for (int b = 0; b < group.count; ++b) {
                    end[b] = state[b];
                    for (int i = 0; i < 3; ++i) {
                        end[b].d_w[i] += N::half(kick[b].linear[i]);
                        end[b].t_b[i] += N::narrow_turn(N::half_turn_sum(kick[b].angular[i]));
                    }
                }
                evaluate(end, kick);
            }
        }
        kick_bodies();
        return true;
    }
};

}  // namespace tumble::integrators
