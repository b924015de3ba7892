// A body with a part of the step as the unit of time, so that the code of a step moves it over the part.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/body/momentum.hpp>

namespace tumble {

// The motion of a body: its drift, its spin, and the halvings of the spin's scale.
template <class State>
struct KeptMotion {
    decltype(State::d_w) d_w;
    decltype(State::t_b) t_b;
    std::int8_t halvings;
};
template <class N>
struct KeptMotion<BodyState<N, Spin::none>> {
    decltype(BodyState<N, Spin::none>::d_w) d_w;
};

// Drift and spin shrink with the unit. Afterwards only their changes are scaled back, so that what does not change
// stays exact.
template <class Bodies>
class StateInUnit {
    using N = typename Bodies::Numbers;
    using Work = typename N::Work;
    using Fraction = typename N::Fraction;

public:
    StateInUnit() {}  // NOLINT(modernize-use-equals-default): without this it would be set to zero

    // The change of a drift or a spin in a part of the step as that in the whole one.
    TUMBLE_INLINE static void shrink(auto& change, Fraction part) {
        change.add(N::part(N::sum(change), part) - N::sum(change));
    }
    // Takes the drift of body b into a unit of this part of the step. Below: and back, with 1 / part.
    void shrink_drift(Bodies& bodies, int b, Fraction part) {
        auto& d_w = bodies.state[b].d_w;
        whole_.d_w = d_w;
        for (int i = 0; i < 3; ++i) shrink(d_w[i], part);
        shrunk_.d_w = d_w;
    }
    void restore_drift(Bodies& bodies, int b, Work inverse) const {
        auto& d_w = bodies.state[b].d_w;
        for (int i = 0; i < 3; ++i) {
            const Work change = N::metres(N::sum(d_w[i]) - N::sum(shrunk_.d_w[i]), bodies.scale) * inverse;
            d_w[i] = whole_.d_w[i];
            d_w[i].add(N::drift_sum(change, bodies.scale));
        }
    }
    // The same of a spin. It may have got halvings in the part.
    void shrink_spin(Bodies& bodies, int b, Fraction part, bool shrinks = true) requires(Bodies::rotation) {
        auto& t_b = bodies.state[b].t_b;
        whole_.t_b = t_b;
        whole_.halvings = static_cast<std::int8_t>(bodies.halvings_of(b));
        for (int i = 0; shrinks && i < 3; ++i) shrink(t_b[i], part);
        shrunk_.t_b = t_b;
    }
    // of_step(change): a change in the part, rad, as that in the step.
    template <class OfStep>
    void restore_spin(Bodies& bodies, int b, OfStep&& of_step) requires(Bodies::rotation) {
        follow_halvings(bodies, b);
        auto& t_b = bodies.state[b].t_b;
        for (int i = 0; i < 3; ++i) {
            const Work change = of_step(N::half_turn(N::sum(t_b[i]) - N::sum(shrunk_.t_b[i]), bodies.scale));
            t_b[i] = whole_.t_b[i];
            t_b[i].add(N::turn_sum(change, bodies.scale));
        }
    }
    // Of a body that rotated freely from the orientation `from`: an angular momentum, which stays in the world.
    void restore_momentum(Bodies& bodies, int b, const auto& from) requires(Bodies::rotation) {
        follow_halvings(bodies, b);
        auto& s = bodies.state[b];
        s.t_b = whole_.t_b;
        typename N::TurnSum t[3]{N::sum(s.t_b.x), N::sum(s.t_b.y), N::sum(s.t_b.z)};
        turn_momentum<N>(t, bodies.spin_scale(b), from, s.q_wb.value());
        for (int i = 0; i < 3; ++i) s.t_b[i].add(t[i] - N::sum(s.t_b[i]));
    }

private:
    void follow_halvings(const Bodies& bodies, int b) {
        bodies.to_scale_of(b, whole_.t_b, whole_.halvings);
        bodies.to_scale_of(b, shrunk_.t_b, whole_.halvings);
    }

    KeptMotion<typename Bodies::State> whole_, shrunk_;  // shrunk_ without halvings
};

}  // namespace tumble
