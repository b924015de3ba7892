// Compositions: a symmetric rotation of order 2, in parts of a step whose leading errors cancel.
#pragma once

#include <tumble/body/orientation.hpp>
#include <tumble/body/stage.hpp>

namespace tumble {

// Runs a flow that turns too far in 2, 4 or 8 parts, and gives the spin back in the unit that it had. run() is one
// flow.
template <class N, class Run>
[[nodiscard]] Turned run_in_parts(BodyState<N, Spin::angular_momentum>& body, Run&& run) {
    constexpr int most_halvings = 3;
    int halvings = 0;
    Turned all = Turned::done;
    for (int left = 1; left > 0;) {
        const Turned turned = run();
        if (turned == Turned::too_far) {
            if (halvings == most_halvings) {
                all = turned;
                break;
            }
            if constexpr (N::fixed_point) N::halve(body.t_b);
            ++halvings;
            left *= 2;
        } else {
            if (turned == Turned::not_converged) all = turned;
            --left;
        }
    }
    if constexpr (N::fixed_point)
        for (; halvings > 0; --halvings) N::twice(body.t_b);
    return all;
}

// The length of a flow: a whole step, or a part of a step in a composition.
template <class N>
struct WholeStep {
    [[nodiscard]] static constexpr WholeStep of(Real) { return {}; }
    [[nodiscard]] TUMBLE_INLINE constexpr typename N::Turn operator()(typename N::Turn turn, Dither) const {
        return turn;
    }
};
template <class N>
struct PartOfStep {
    typename N::Coefficient half;  // half of the part; the part may be negative, |part| < 1

    [[nodiscard]] static constexpr PartOfStep of(Real part) {
        return {N::template constant<typename N::Coefficient>(part * Real::scaled(1, -1))};
    }
    [[nodiscard]] TUMBLE_INLINE constexpr typename N::Turn operator()(typename N::Turn turn, Dither d) const {
        return N::Block::twice_share(half, turn, d);
    }
};

// Parts has count and of(i), in order, and the kinds of different length, kind(i) and of_kind(k).
template <class Flow, class Parts>
struct Composed {
    template <class N>
    struct Inertia {
        typename Flow::template PartInertia<N> part[Parts::kinds];

        [[nodiscard]] static constexpr Inertia of(RealVec3 moments, typename N::Scale scale) {
            Inertia inertia{};
            for (int k = 0; k < Parts::kinds; ++k)
                inertia.part[k] = Flow::template PartInertia<N>::of(moments, scale, Parts::of_kind(k));
            return inertia;
        }
        [[nodiscard]] constexpr int z_room() const { return part[0].z_room(); }
    };

    // Nothing has changed where the first part turns too far. A later part is then run in parts of its own: a flow adds
    // at most a quarter of the limit to the spin about z.
    template <class N>
    static Turned flow(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia, const StepInfo<N>& step) {
        for (int part = 0; part < Parts::count; ++part) {
            if (flow_part<N>(body, inertia, part, step) != Turned::too_far) [[likely]]
                continue;
            if (part == 0) return Turned::too_far;
            (void)run_in_parts<N>(body, [&] { return flow_part<N>(body, inertia, part, step); });
        }
        return Turned::done;
    }
    // Out of line: inlined copies would cost more flash than the calls cost time.
    template <class N>
    [[gnu::noinline]] static Turned flow_part(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia,
                                              int part, const StepInfo<N>& step) {
        return Flow::template flow<N>(body, inertia.part[Parts::kind(part)], step);
    }
};

}  // namespace tumble
