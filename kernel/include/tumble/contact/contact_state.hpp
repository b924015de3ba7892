// What contacts keep from step to step.
#pragma once

#include <tumble/contact/broad_phase.hpp>
#include <tumble/contact/contact_log.hpp>
#include <tumble/contact/islands_at_rest.hpp>
#include <tumble/contact/rest_watch.hpp>
#include <tumble/contact/resting.hpp>
#include <tumble/contact/sleepers.hpp>
#include <tumble/solver/kicks.hpp>
#include <tumble/solver/marks.hpp>
#include <tumble/solver/velocities.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
struct ContactState {
    using Work = typename N::Work;

    constexpr ContactState(Real step, const ContactSpec& spec)
        : shapes{step, spec}, sleepers{step, spec.sleep}, threshold{N::template constant<Work>(
                                                              spec.restitution_threshold * step)} {
        if constexpr (features.bounded_steps) {
            exact_bodies = spec.exact_bodies;
            watch = RestWatch<N, spin, features>{step};
        }
        if constexpr (features.impact_bounds) most = {spec.most_impacts, spec.most_searches, spec.most_sweeps};
    }

    NarrowPhase<N, spin, features> shapes;
    PairList<N, features> pairs{};
    ClearTimes<N, features> times{};
    Sleepers<N, spin, features> sleepers;
    Marks<features.bodies> marks{};
    [[no_unique_address]] If<features.contact_readout, ContactLog<N, spin, features>, 0> log{};
    Work threshold;  // of restitution, m a step
    [[no_unique_address]] If<features.impact_bounds, ImpactBounds, 1> most{};
    [[no_unique_address]] If<features.bounded_steps, int, 2> exact_bodies{};  // larger islands step in bounded time
    [[no_unique_address]] If<features.bounded_steps, RestWatch<N, spin, features>, 3> watch{};
    // While an island is solved.
    SolverVelocities<N, spin, features> velocities{};
    Solution solution{};
    IslandsAtRest<features> at_rest{};
    // By gravity and loads over the whole step. Of a fixed body: by how much its velocities have changed since the last
    // step, other than by rotation.
    Kicks<N, features.bodies> loads{};
    Kicks<N, features.bodies> forces{};  // by the contacts over the rest of the step
};

}  // namespace tumble
