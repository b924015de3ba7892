// Kick-drift-kick: half a kick by forces and torques, a drift of the centre of mass with a torque-free rotation, and
// half a kick. Order 2, reversible in time. RotationFlow is the rotation. Without loads only the drift and the rotation
// run. Loads that depend on velocity (drag, damping) keep the symmetry: the first half kick is that of explicit Euler,
// the second that of implicit Euler, its adjoint. It is solved in closed form where the evaluation can
// (ends_in_closed_form(), at_end()), and else by fixed-point iteration. An evaluation may correct the velocities at
// the start and at the end of a part (correct_velocities()). The kick that ends a step, once solved, is also the one
// that begins the next (kept_kick()): it has the loads at the same place and velocity.
//
// Composed<RotationFlow, Parts> consists of several such steps, whose lengths are parts of a step that cancel the
// leading errors. The kick that ends a part begins the next one likewise.
#pragma once

#include <tumble/integrators/method.hpp>
#include <tumble/integrators/rotation/composed.hpp>
#include <tumble/integrators/stability.hpp>

namespace tumble {

namespace detail {

// A whole step, as a composition of one part.
struct OnePart {
    static constexpr int count = 1;
    [[nodiscard]] static constexpr Real of(int) { return 1; }
};

// Fixed-point iterations for the half kick that ends a part, at most: they end where no sum changes any more.
inline constexpr int end_kick_iterations = 6;

// The half kick that ends a part, for loads that depend on velocity: kick = the loads at the velocity after the kick.
// Returns whether it is solved.
template <class N, int capacity, class Group, class Evaluate, class HalfOf>
bool solve_end_kick(const Group& group, const typename Group::Stage (&state)[capacity], typename Group::Kick* kick,
                    Evaluate& evaluate, HalfOf&& half) {
    bool changes = true;
    for (int iteration = 0; iteration < end_kick_iterations && changes; ++iteration) {
        typename Group::Stage end[capacity];
        typename Group::Kick before[capacity];
        for (int b = 0; b < group.count; ++b) {
            copy_stage(end[b], state[b]);
            for (int i = 0; i < 3; ++i) {
                before[b].linear[i] = kick[b].linear[i];
                end[b].d_w[i] += half(kick[b].linear[i]);
                if constexpr (Group::rotation) {
                    before[b].angular[i] = {};  // for GCC, which does not see that it is read where it is written
                    if (!group.rotates(b)) continue;
                    before[b].angular[i] = kick[b].angular[i];
                    end[b].t_b[i] += N::narrow_turn(half(kick[b].angular[i]));
                }
            }
        }
        evaluate(end, kick);
        changes = false;
        for (int b = 0; b < group.count; ++b)
            for (int i = 0; i < 3; ++i) {
                changes = changes || !(before[b].linear[i] == kick[b].linear[i]);
                if constexpr (Group::rotation)
                    changes = changes || (group.rotates(b) && !(before[b].angular[i] == kick[b].angular[i]));
            }
    }
    return !changes;
}

// Half a kick, a drift and half a kick of each part, on the oscillator. The kick that ends a part has the velocity from
// the iterations above; without damping they change nothing.
template <class Parts>
struct KickDriftKickOnOscillator {
    struct Lengths {
        consteval Lengths() {
            for (int i = 0; i < Parts::count; ++i) of[i] = Parts::of(i).to_double();
        }
        double of[Parts::count]{};  // lengths of the parts, in steps
    };
    static constexpr Lengths lengths{};

    static constexpr OscillatorStep step(double k, double c) {
        OscillatorStep all;
        for (int part = 0; part < Parts::count; ++part) {
            const double length = lengths.of[part], half = length / 2;
            OscillatorStep kick = OscillatorStep::of_equation(k, c);  // its lower row is used
            for (int iteration = 0; iteration < end_kick_iterations; ++iteration)
                kick = {0, 1, -k - c * half * kick.vx, -c - c * half * kick.vv};
            const OscillatorStep begin{1, 0, -half * k, 1 - half * c}, drift{1, length, 0, 1},
                end{1, 0, half * kick.vx, 1 + half * kick.vv};
            all = end * drift * begin * all;
        }
        return all;
    }
};

}  // namespace detail

namespace integrators {

template <class RotationFlow, class Parts = tumble::detail::OnePart>
struct KickDriftKick : Stability<tumble::detail::KickDriftKickOnOscillator<Parts>> {
    static constexpr Spin spin = Spin::angular_momentum;
    static constexpr Coasting coasting = Coasting::mean;
    static constexpr bool keeps_kick = true;

    template <class N>
    using Inertia = typename RotationFlow::template Inertia<N>;

    template <class N>
    TUMBLE_INLINE static auto rotate(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia,
                                     const StepInfo<N>& step) {
        return RotationFlow::template flow<N>(body, inertia, step);
    }

    template <class N>
    [[gnu::noinline]] static auto rotate_called(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia,
                                                const StepInfo<N>& step) {
        return rotate<N>(body, inertia, step);
    }

    // True if the constants of the flow depend on the spin. Code that changes the spin then calls prepare.
    template <class N>
    static constexpr bool needs_preparation = requires(Inertia<N>& inertia, const BodyState<N, spin>& body,
                                                       typename N::Scale scale) {
        inertia.prepare(body, scale);
    };

    template <class N, int capacity, class Group, class Evaluate>
    static bool advance(const Group& group, Evaluate&& evaluate, const StepInfo<N>& step) {
        constexpr bool corrects_velocities = requires(typename Group::Stage * stages) {
            evaluate.correct_velocities(stages, true);
        };
        group.has_bodies();
        typename Group::Stage state[capacity];
        typename Group::Kick new_kick[capacity], *kick = new_kick;
        bool is_known = false;
        if constexpr (capacity == 1 && requires { evaluate.kept_kick(); })
            if (evaluate.keeps()) {
                kick = evaluate.kept_kick();
                is_known = evaluate.is_known();
            }
        // Evaluates the loads at the present state, which ends a part or begins one.
        [[maybe_unused]] bool ends = false;
        const auto look = [&] {
            group.has_bodies();
            for (int b = 0; b < group.count; ++b) group.take(b, state[b]);
            if constexpr (corrects_velocities) evaluate.correct_velocities(state, ends);
            evaluate(state, kick);
        };
        const auto kick_bodies = [&](auto&& share) {
            for (int b = 0; b < group.count; ++b) {
                tumble::detail::for_axes<N>([&](int i) __attribute__((always_inline)) {
                    N::add(group.body[b]->d_w[i], share(kick[b].linear[i]));
                });
                if constexpr (Group::rotation)
                    for (int i = 0; i < 3 && group.rotates(b); ++i)
                        group.body[b]->t_b[i].add(share(kick[b].angular[i]));
            }
        };
        const bool velocity_matters = evaluate.depends_on_velocity();
        bool converged = true;
        for (int part = 0; part < Parts::count; ++part) {
            const auto half = [&](auto sum) { return half_of_part<N>(sum, part); };
            ends = false;
            if (!is_known) look();
            kick_bodies(half);
            for (int b = 0; b < group.count; ++b) {
                auto& body = *group.body[b];
                tumble::detail::for_axes<N>([&](int i) __attribute__((always_inline)) {
                    drift<N>(body.x_w[i], body.d_w[i], part, step.scale);
                });
                if constexpr (Group::rotation) {
                    if (!group.rotates(b)) continue;
                    const Turned turned = turn_part<N>(body, *group.inertia[b], part, step);
                    if (turned == Turned::not_converged) converged = false;
                    if (turned == Turned::too_far) group.too_fast = b;
                }
            }
            if constexpr (Parts::count == 1 && requires { evaluate.ends_in_closed_form(); }) {
                if (velocity_matters && evaluate.ends_in_closed_form()) {
                    for (int b = 0; b < group.count; ++b) group.take(b, state[b]);
                    if constexpr (corrects_velocities) evaluate.correct_velocities(state, true);
                    evaluate.at_end(state, kick);
                    kick_bodies(half);
                    is_known = true;
                    continue;
                }
            }
            ends = true;
            look();
            is_known =
                !velocity_matters || tumble::detail::solve_end_kick<N, capacity>(group, state, kick, evaluate, half);
            kick_bodies(half);
        }
        if constexpr (capacity == 1 && requires { evaluate.kept_kick(); }) evaluate.keep(is_known);
        return converged;
    }

private:
    // The parts in the numbers of a step, computed by the compiler.
    template <class N>
    struct Fractions {
        consteval Fractions() {
            for (int i = 0; i < Parts::count; ++i) of[i] = N::template constant<typename N::Fraction>(Parts::of(i));
        }
        typename N::Fraction of[Parts::count]{};
    };
    template <class N>
    static constexpr Fractions<N> fractions{};

    template <class N>
    [[nodiscard]] static auto half_of_part(auto sum, int part) {
        if constexpr (Parts::count == 1) return N::half(sum);
        else return N::half(N::part(sum, fractions<N>.of[part]));
    }
    template <class N>
    TUMBLE_INLINE static void drift(typename N::template Integrated<typename N::Position>& x,
                                    const typename N::template Integrated<typename N::Drift>& d, int part,
                                    typename N::Scale scale) {
        if constexpr (Parts::count == 1) N::coast(x, d, {}, scale);
        else N::move(x, N::part(N::sum(d), fractions<N>.of[part]), scale);
    }
    // A flow of one part has no part number. A flow that cannot fail returns nothing.
    template <class N>
    [[nodiscard]] TUMBLE_INLINE static Turned turn_part(BodyState<N, Spin::angular_momentum>& body, Inertia<N>& inertia,
                                                        [[maybe_unused]] int part, const StepInfo<N>& step) {
        const auto run = [&] {
            if constexpr (needs_preparation<N>) inertia.prepare(body, step.scale);
            if constexpr (Parts::count == 1) return rotate_called<N>(body, inertia, step);
            else return RotationFlow::template flow_part<N>(body, inertia, part, step);
        };
        if constexpr (std::is_void_v<decltype(run())>) {
            run();
            return Turned::done;
        } else if constexpr (N::fixed_point) {
            return run_in_parts<N>(body, run);
        } else {
            return run();
        }
    }
};

}  // namespace integrators
}  // namespace tumble
