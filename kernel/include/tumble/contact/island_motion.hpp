// An island while it steps: its bodies, its pairs, and how they are moved. That is through one function pointer, so
// that worlds with different methods share this code.
#pragma once

#include <tumble/contact/contact_state.hpp>
#include <tumble/contact/impact_search.hpp>
#include <tumble/contact/resting.hpp>
#include <tumble/contact/schedule.hpp>
#include <tumble/solver/flight.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
struct IslandMotion {
    using State = ContactState<N, spin, features>;
    using Bodies = typename NarrowPhase<N, spin, features>::Bodies;
    using BodyGroup = SomeBodies<features.bodies>;
    using Island = tumble::Island<features>;
    using Work = typename N::Work;
    using C = ContactNumbers<N>;
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
    // and others may be near. changed(b): of which body that is true.
    template <class Changed>
    void find_near_pairs(Changed&& changed) {
        BroadPhase<N, spin, features> broad_phase{contacts.shapes, contacts.pairs, contacts.times, bodies};
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
    void check_range() {
        for (int k = 0; k < island.group.count; ++k) bodies.check_range(island.group.id[k]);
    }
};

}  // namespace tumble
