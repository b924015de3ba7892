// One step of an island of many bodies in bounded time: one flight, one solution of its contacts, and no impact at its
// own time.
#pragma once

#include <tumble/contact/bounded_solver.hpp>
#include <tumble/contact/island_motion.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class BoundedStep {
public:
    using Motion = IslandMotion<N, spin, features>;
    using State = typename Motion::State;
    using Bodies = typename Motion::Bodies;
    using Island = typename Motion::Island;
    using C = ContactNumbers<N>;
    using Mover = typename Motion::Mover;
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Length = typename NarrowPhase::Length;
    using Pair = typename NarrowPhase::Pair;
    using Work = typename N::Work;

    BoundedStep(State& contacts, auto& schedule, Bodies& bodies, Island& island, const Mover& mover)
        : motion_{contacts, schedule, bodies, island, mover} {
        if constexpr (features.impact_bounds) contacts.velocities.sweeps_left = {};
    }

    // True of an island that stood still before and stands as it did.
    [[gnu::noinline]] bool take() {
        motion_.move({.group = motion_.island.group, .loads = &motion_.contacts.loads});
        const bool corrects = !motion_.contacts.watch.are_held(motion_.island.group) && solver().overlap();
        if (motion_.resting().still_stands(motion_.contacts.loads, motion_.contacts.forces, corrects)) {
            motion_.contacts.solution = {.settled = true, .stands = true};
            return true;
        }
        if constexpr (features.contact_readout)
            motion_.contacts.log.start_island(motion_.contacts.pairs, motion_.island);
        if constexpr (features.control)
            if (motion_.contacts.standing.has_other_gravity()) look_again();
        fly();
        return false;
    }

private:
    using Saved = typename Motion::Saved;
    using Solver = BoundedSolver<N, spin, features>;
    using Changes = typename Solver::Changes;

    // What stood did not look for others when the step began, under other gravity.
    void look_again() requires(features.control) {
        bool any = false;
        for (int k = 0; k < motion_.island.group.count; ++k)
            any = any || motion_.contacts.standing.stood(motion_.island.group.id[k]);
        if (any) motion_.find_near_pairs([](int) { return true; });
    }
    // True where bodies that have not moved for a while only tremble, under gravity alone.
    [[nodiscard]] bool tremble(const Changes& changes) const {
        bool all = changes.trembles && motion_.contacts.watch.rest(motion_.bodies, motion_.island.group);
        for (int k = 0; k < motion_.island.group.count; ++k)
            all = all && motion_.contacts.marks[motion_.island.group.id[k]].none();
        motion_.contacts.pairs.for_each(motion_.island, [&](const Pair& pair) { all = all && !pair.surface_moves; });
        return all;
    }
    // Holds the bodies: forces cancel the loads.
    void hold() {
        for (int k = 0; k < motion_.island.group.count; ++k) {
            const int b = motion_.island.group.id[k];
            for (int i = 0; i < 3; ++i) {
                motion_.contacts.forces[b].linear[i] = -motion_.contacts.loads[b].linear[i];
                motion_.contacts.forces[b].angular[i] = -motion_.contacts.loads[b].angular[i];
            }
        }
        motion_.contacts.watch.hold(motion_.island.group);
        motion_.contacts.pairs.set_balanced(motion_.island, true);
        motion_.contacts.solution = {.settled = true, .stands = true};
    }
    // The bodies stand. Points that were found for the step, but do not touch, go.
    void stop() {
        motion_.log_forces(Work(1));
        motion_.resting().stop_all();
        motion_.take_over_spins();
        motion_.search.find();
    }
    void fly() {
        motion_.contacts.pairs.for_each(motion_.island, [&](Pair& pair) { find_points(pair, closing_of(pair)); });
        Saved start;
        motion_.save(start);
        const bool touches = solve(start);
        if (motion_.contacts.solution.stands) return stop();
        if (touches) solver().log(motion_.contacts.log);
        const bool lifts = motion_.contacts.solution.lifts;
        if (lifts) motion_.lift(false);
        motion_.move({.group = motion_.island.group, .new_spins = touches, .portion = {true, Work(1)}});
        if (lifts) motion_.lift(true);
        if (glides_ && motion_.mover.coasting != Coasting::end) motion_.push(Work(1), true, true, &start);
        for (int k = 0; touches && !glides_ && k < motion_.island.group.count; ++k) push(k, &start);
        if (touches) motion_.take_over_spins();
        motion_.search.measure();
        motion_.search.find();
        report_overlaps();
        motion_.contacts.watch.note(motion_.contacts.shapes, motion_.bodies, motion_.island.group, start);
    }
    [[nodiscard]] Solver solver() {
        return {motion_.contacts.shapes, motion_.contacts.pairs, motion_.contacts.velocities,
                motion_.bodies,          motion_.island,         motion_.contacts.threshold};
    }
    // Solves for the contacts and pushes the bodies to the velocities of the end. Where they then come to something to
    // which they would not have come without contacts, solves once more. True where something touches.
    bool solve(const Saved& start) {
        glides_ = false;
        Changes changes;
        for (bool again = false;; again = true) {
            for (int k = 0; k < motion_.island.group.count; ++k)
                motion_.contacts.pairs.forget_points_of(motion_.island.group.id[k]);
            if (solver().solve(motion_.contacts.loads, motion_.contacts.forces, motion_.contacts.solution, changes) ==
                Touch::nothing)
                return false;
            if (motion_.contacts.solution.stands) return true;
            if (tremble(changes)) {
                hold();
                return true;
            }
            glides_ = changes.glides;
            if (glides_) {
                if (motion_.mover.coasting != Coasting::start) motion_.push(Work(1), true, false);
                return true;
            }
            for (int k = 0; k < motion_.island.group.count; ++k) push(k, nullptr);
            find_others(changes, again);
            if (again || !come_nearer()) return true;
            motion_.restore(start);
        }
    }
    // Before the flight: adds to the motion of body k of the island what contacts change, and the part of the loads
    // that the method adds after the flight. After the flight from `start`: takes this part off again.
    void push(int k, const Saved* start) {
        const int b = motion_.island.group.id[k];
        Kick<N>& load = motion_.contacts.loads[b];
        if constexpr (Bodies::has_parts)
            if (start != nullptr)
                motion_.contacts.loads.rescale(b, motion_.bodies.parts.halvings[b] - start->halvings(k));
        const auto change = [&](auto force, auto of_load) {
            if (motion_.mover.coasting == Coasting::end) of_load = {};
            else if (motion_.mover.coasting == Coasting::mean) of_load = N::half(of_load);
            return start == nullptr ? force + of_load : -of_load;
        };
        const Kick<N>& force = motion_.contacts.forces[b];
        for (int i = 0; i < 3; ++i) {
            N::add(motion_.bodies.state[b].d_w[i], change(force.linear[i], load.linear[i]));
            motion_.bodies.state[b].t_b[i].add(change(force.angular[i], load.angular[i]));
        }
        if (start == nullptr) (void)motion_.bodies.fit_parts(b);
    }
    // With the velocities of the end: looks for others around the bodies whose change exceeds the bounds on the time to
    // contact, or around all, where these bounds are for the velocities of another solution.
    void find_others(const Changes& changes, bool all) {
        if (all || changes.any_exceeds(motion_.island.group))
            motion_.find_near_pairs([&](int b) { return all || changes.exceed[b]; }, true);
    }
    // True where pairs without points come to each other with these velocities. Finds their points.
    [[nodiscard]] bool come_nearer() {
        bool any = false;
        motion_.contacts.pairs.for_each(motion_.island, [&](Pair& pair) {
            if (pair.count > 0) return;
            const Length closing = closing_of(pair);
            if (!(closing > pair.gap)) return;
            find_points(pair, closing);
            any = any || pair.count > 0;
        });
        return any;
    }
    // By how much the bodies of a pair come closer in a step at most, but for loads.
    [[nodiscard]] Length closing_of(const Pair& pair) const {
        const NarrowPhase& shapes = motion_.contacts.shapes;
        Vec3<Length> drift = shapes.drift(motion_.bodies, pair.a);
        Length turn = shapes.way_of_turn(motion_.bodies, pair.a);
        if (pair.moves_b() || pair.surface_moves) {
            drift -= shapes.drift(motion_.bodies, pair.b);
            turn += shapes.way_of_turn(motion_.bodies, pair.b);
        }
        return turn - narrow<Length>(dot(pair.normal, drift));
    }
    // Finds the points that may touch within the step. Something may push one of two bodies that fall alike. Bodies
    // that slide onto another over a seam do not come to its side.
    void find_points(Pair& pair, Length closing) {
        NarrowPhase& shapes = motion_.contacts.shapes;
        if (closing > pair.gap && motion_.search.slides_onto(pair)) {
            pair.count = 0;
            return;
        }
        closing += shapes.fall_bound() + shapes.fall_bound();
        shapes.find_within(motion_.bodies, pair, shapes.tolerance() + (closing > Length{} ? closing : Length{}));
    }
    void report_overlaps() {
        const Pair* found = nullptr;
        const Length most = ContactBounds<N>::most_correction(motion_.contacts.shapes.tolerance());
        motion_.contacts.pairs.for_each(motion_.island, [&](const Pair& pair) {
            if (pair.gap < -most) found = &pair;
        });
        if (found != nullptr) motion_.bodies.report(Issue::left_over, found->a);
    }

    Motion motion_;
    bool glides_ = false;  // the forces of contacts act as the loads do
};

}  // namespace tumble
