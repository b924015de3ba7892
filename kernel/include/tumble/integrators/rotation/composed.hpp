// Compositions: a symmetric rotation of order 2, in parts of a step whose leading errors cancel.
#pragma once

#include <tumble/body/orientation.hpp>
#include <tumble/body/stage.hpp>

namespace tumble {

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
    };

    template <class N>
    static void flow(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia, const StepInfo<N>& step) {
        for (int part = 0; part < Parts::count; ++part) flow_part<N>(body, inertia, part, step);
    }
    // Out of line: inlined copies would cost more flash than the calls cost time.
    template <class N>
    [[gnu::noinline]] static void flow_part(BodyState<N, Spin::angular_momentum>& body, const Inertia<N>& inertia,
                                            int part, const StepInfo<N>& step) {
        Flow::template flow<N>(body, inertia.part[Parts::kind(part)], step);
    }
};

}  // namespace tumble
