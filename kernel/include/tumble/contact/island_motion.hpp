// An island while it steps: its bodies, its pairs, and how they are moved. That is through one function pointer, so
// that worlds with different methods share this code.
#pragma once

#include <tumble/body/momentum.hpp>
#include <tumble/contact/contact_state.hpp>
#include <tumble/contact/impact_search.hpp>
#include <tumble/contact/resting.hpp>
#include <tumble/contact/schedule.hpp>
#include <tumble/numbers/vector_block.hpp>
#include <tumble/solver/flight.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
struct IslandMotion {
    using State = ContactState<N, spin, features>;
    using Bodies = typename NarrowPhase<N, spin, features>::Bodies;
    using BodyGroup = SomeBodies<features.bodies>;
    using Island = tumble::Island<features>;
    using Work = typename N::Work;
    using Mover = tumble::Mover<N, features>;
    using Flight = tumble::Flight<N, features>;
    using Saved = SavedMotions<Bodies>;

    State& contacts;
    [[no_unique_address]] If<features.pairs, Schedule<features.bodies>*, 2> schedule;
    Bodies& bodies;
    Island& island;
    const Mover& mover;
    ImpactSearch<N, spin, features> search;

    // `links`: of the bodies that touch each other.
    IslandMotion(State& state, auto& links, Bodies& all, Island& of, const Mover& by)
        : contacts{state}, schedule{&links}, bodies{all}, island{of}, mover{by}, search{state.shapes, state.pairs, all,
                                                                                        of} {}

    void move(const Flight& flight) { mover.move(mover.method, flight); }
    void take_over_spins() { move({.group = island.group, .new_spins = true}); }
    [[nodiscard]] Resting<N, spin, features> resting() {
        return {contacts.shapes, contacts.pairs, contacts.velocities, bodies, island};
    }
    // `share`: of the time for which the forces are solved.
    void log_forces([[maybe_unused]] Work share) {
        if constexpr (features.contact_readout)
            contacts.log.add_forces(contacts.pairs, island, contacts.shapes, bodies, share);
    }
    void lift(bool off) {
        resting().lift(off);
        take_over_spins();
    }
    // Call where bodies have other velocities than by their flight: their bounds on the time to contact hold no longer,
    // and others may be near. changed(b): of which body that is true. `keeps`: pairs that are apart then stay in the
    // list for this step, since their points are part of its solution.
    template <class Changed>
    void find_near_pairs(Changed&& changed, bool keeps = false) {
        BroadPhase<N, spin, features> broad_phase{contacts.shapes, contacts.pairs, contacts.times, bodies, keeps};
        for (int k = 0; k < island.group.count; ++k) {
            const int b = island.group.id[k];
            if (!changed(b)) continue;
            contacts.times.end(b, contacts.shapes.plane_count(), bodies.steps_taken);
            if constexpr (features.pairs) broad_phase.update(b, contacts.marks, contacts.sleepers, schedule->wakes);
            else broad_phase.update(b, contacts.marks);
        }
        if constexpr (features.pairs) {
            contacts.pairs.link(*schedule);
            island.first_pair = schedule->first_pair[island.root];
        } else {
            contacts.pairs.link();
        }
    }
    void save(Saved& saved) const {
        for (int k = 0; k < island.group.count; ++k) saved.save(k, bodies, island.group.id[k]);
    }
    void restore(const Saved& saved) {
        for (int k = 0; k < island.group.count; ++k) saved.restore(k, bodies, island.group.id[k]);
    }
    // Adds the forces of contacts over `part` of the time of which they are solved, or over `all` of it, where and as
    // the method needs them: before the drift, `second` after it, or half before and half after. `start`: of the flight
    // that has ended. The kicks, which still have the scale of its spins, get that of now. They act in its axes, so the
    // change of spin is turned into the axes of now: a torque has its direction in the world. A body that turns is an
    // exception. Its rows are made for the middle of the flight: both halves of its kick have the same components in
    // its axes.
    void push(Work part, bool all, bool second, const Saved* start = nullptr) {
        for (int k = 0; k < island.group.count; ++k) {
            const int b = island.group.id[k];
            if constexpr (Bodies::has_parts)
                if (start != nullptr) contacts.forces.rescale(b, bodies.parts.halvings[b] - start->halvings(k));
            Kick<N> kick = contacts.forces[b];
            if (start != nullptr && !contacts.velocities.turns(b)) turn(kick, b, (*start)[k].q_wb.value());
            const auto share = [&](auto sum) {
                if (!all) sum = N::part(sum, N::fraction(part));
                if (mover.coasting != Coasting::mean) return sum;
                return second ? sum - N::half(sum) : N::half(sum);
            };
            for (int i = 0; i < 3; ++i) {
                N::add(bodies.state[b].d_w[i], share(kick.linear[i]));
                bodies.state[b].t_b[i].add(share(kick.angular[i]));
            }
            if (!second) (void)bodies.fit_parts(b);
        }
    }

    // Turns a change of spin from the axes at q into those of now. Angular momentum turns, not angular velocity.
    void turn(Kick<N>& kick, int b, const Quat<typename N::Unit>& q) const {
        const auto& now = bodies.state[b].q_wb.value();
        if (q.w == now.w && q.v == now.v) return;
        if constexpr (spin == Spin::angular_momentum) {
            turn_momentum<N>(kick.angular, bodies.spin_scale(b), q, now);
        } else {
            using Vector = VectorBlock<N>;
            const BodyWeight<N>& weight = contacts.shapes.weights()[b];
            const auto scaled = [](const Vector& v, const Work(&by)[3]) {
                return v.times(Vector3<Work>{by[0] * by[0], by[1] * by[1], by[2] * by[2]});
            };
            Vector change = Vector::of_turns(kick.angular, bodies.spin_scale(b));
            if (change.is_zero()) return;
            change = scaled(scaled(change, weight.of_turn).rotated(q).rotated_back(now), weight.per_turn);
            for (int i = 0; i < 3; ++i) kick.angular[i] = change.turn(i, Work(1), bodies.spin_scale(b));
        }
    }
    void check_range() {
        for (int k = 0; k < island.group.count; ++k) bodies.check_range(island.group.id[k]);
    }
};

}  // namespace tumble
