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
    using Flight = typename Motion::Flight;
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Length = typename NarrowPhase::Length;
    using Pair = typename NarrowPhase::Pair;
    using Work = typename N::Work;

    BoundedStep(State& contacts, auto& schedule, Bodies& bodies, Island& island, const Mover& mover)
        : motion_{contacts, schedule, bodies, island, mover} {
        if constexpr (features.impact_bounds) contacts.velocities.sweeps_left = {};
    }

    // True of an island that was at rest and is unchanged.
    [[gnu::noinline]] bool take() {
        motion_.move({.group = motion_.island.group, .loads = &motion_.contacts.loads});
        const bool corrects = !motion_.contacts.watch.are_held(motion_.island.group) && solver().overlap();
        if (motion_.resting().is_unchanged(motion_.contacts.loads, motion_.contacts.forces, corrects)) {
            motion_.contacts.solution = {.unchanged = true, .at_rest = true};
            return true;
        }
        if constexpr (features.contact_readout)
            motion_.contacts.log.start_island(motion_.contacts.pairs, motion_.island);
        if (is_at_rest_on_what_it_touches()) {
            stop();
            return false;
        }
        if constexpr (features.control)
            if (motion_.contacts.at_rest.has_other_gravity()) look_again();
        fly();
        return false;
    }

private:
    using Saved = typename Motion::Saved;
    using Solver = BoundedSolver<N, spin, features>;
    using Changes = typename Solver::Changes;

    // What was at rest did not look for others when the step began, under other gravity.
    void look_again() requires(features.control) {
        bool any = false;
        for (int k = 0; k < motion_.island.group.count; ++k)
            any = any || motion_.contacts.at_rest.was_at_rest(motion_.island.group.id[k]);
        if (any) motion_.find_near_pairs([](int) { return true; });
    }
    // True where bodies that have not moved for a while only tremble, under gravity alone, and overlap by no more than
    // at rest.
    [[nodiscard]] bool tremble(const Changes& changes) const {
        bool all = changes.trembles && !motion_.contacts.solution.lifts &&
                   motion_.contacts.watch.are_at_rest(motion_.bodies, motion_.island.group);
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
        motion_.contacts.solution = {.unchanged = true, .at_rest = true};
    }
    void stop() {
        motion_.log_forces(Work(1));
        motion_.resting().stop_all();
        motion_.take_over_spins();
    }
    // True of an island in which nothing moves and what touches already holds each body: then no points are looked for.
    [[nodiscard]] bool is_at_rest_on_what_it_touches() {
        bool still = true;
        for (int k = 0; k < motion_.island.group.count; ++k)
            still = still && motion_.bodies.is_at_rest(motion_.island.group.id[k]);
        motion_.contacts.pairs.for_each(motion_.island,
                                        [&](const Pair& pair) { still = still && !pair.surface_moves; });
        if (!still) return false;
        Changes changes;
        (void)solve(changes, true);
        return motion_.contacts.solution.at_rest;
    }
    // Where the flight brings bodies deeper into each other than one step takes them out again, the step is taken anew
    // in two parts or four: what contacts set spinning has turned too far for the rows of its start.
    void fly() {
        Saved start;
        motion_.save(start);
        const Status status = motion_.bodies.status;
        const bool deepens = fly_part(start);
        if (motion_.contacts.solution.at_rest) {
            stop();
            motion_.search.find();  // points that were found for the step, but do not touch, go
            return;
        }
        if (deepens) fly_in_parts(start, status);
        motion_.search.find();
        report_overlaps();
        motion_.contacts.watch.note(motion_.contacts.shapes, motion_.bodies, motion_.island.group, start);
    }
    [[gnu::noinline, gnu::cold]] void fly_in_parts(const Saved& start, const Status& status) {
        bool deepens = true;
        for (int halvings = 1; deepens && halvings <= contact::most_halvings; ++halvings) {
            go_back(start, status);
            deepens = false;
            halvings_ = halvings;
            part_ = N::half_of(part_);
            from_ = Work(0);
            for (int i = 0; i < 1 << halvings; ++i) {
                motion_.move({.group = motion_.island.group, .loads = &motion_.contacts.loads});
                Saved begin;
                motion_.save(begin);
                deepens = fly_part(begin) || deepens;
                from_ += part_;
            }
        }
    }
    // To the start of the step, as if it had not been flown.
    void go_back(const Saved& start, const Status& status) {
        motion_.restore(start);
        Flight to_start{.group = motion_.island.group, .new_spins = true};
        if constexpr (features.kinematic) to_start.places = true;
        motion_.move(to_start);
        motion_.search.measure();
        motion_.find_near_pairs([](int) { return true; }, true);
        if constexpr (features.contact_readout)
            motion_.contacts.log.restart_island(motion_.contacts.pairs, motion_.island);
        motion_.bodies.status = status;
    }
    // Flies part of the step, from `begin`. True where it brings bodies too deep into each other. Where the island
    // is at rest, nothing is flown.
    bool fly_part(const Saved& begin) {
        note_ways();
        motion_.contacts.pairs.for_each(motion_.island, [&](Pair& pair) { find_points(pair, closing_of(pair)); });
        const bool touches = solve(begin);
        if (motion_.contacts.solution.at_rest) return false;
        if (touches) solver().log(motion_.contacts.log);
        const bool lifts = motion_.contacts.solution.lifts;
        if (lifts) motion_.lift(false);
        Flight flight{.group = motion_.island.group, .new_spins = touches, .portion = {halvings_ == 0, part_}};
        if constexpr (features.kinematic) flight.from = from_;
        motion_.move(flight);
        if (lifts) motion_.lift(true);
        if (glides_ && motion_.mover.coasting != Coasting::end) motion_.push(Work(1), true, true, &begin);
        for (int k = 0; touches && !glides_ && k < motion_.island.group.count; ++k) push(k, &begin);
        if (touches) motion_.take_over_spins();
        motion_.contacts.pairs.for_each(motion_.island, [](Pair& pair) { pair.start_gap = pair.gap; });
        motion_.search.measure();
        return deepens();
    }
    [[nodiscard]] bool deepens() const {
        const Length most = ContactBounds<N>::most_correction(motion_.contacts.shapes.tolerance());
        bool any = false;
        motion_.contacts.pairs.for_each(motion_.island, [&](const Pair& pair) {
            any = any || pair.gap + most < (pair.start_gap < Length{} ? pair.start_gap : Length{});
        });
        return any;
    }
    [[nodiscard]] Solver solver() {
        return {motion_.contacts.shapes,
                motion_.contacts.pairs,
                motion_.contacts.velocities,
                motion_.bodies,
                motion_.island,
                motion_.contacts.threshold,
                halvings_};
    }
    Touch solve(Changes& changes, bool only_at_rest) {
        for (int k = 0; k < motion_.island.group.count; ++k)
            motion_.contacts.pairs.forget_points_of(motion_.island.group.id[k]);
        return solver().solve(motion_.contacts.loads, motion_.contacts.forces, motion_.contacts.solution, changes,
                              only_at_rest);
    }
    // Solves for the contacts and pushes the bodies to the velocities of the end. Where they then come to something to
    // which they would not have come without contacts, solves once more. True where something touches.
    bool solve(const Saved& start) {
        glides_ = false;
        Changes changes;
        for (bool again = false;; again = true) {
            if (solve(changes, false) == Touch::nothing) return false;
            if (motion_.contacts.solution.at_rest) return true;
            if (halvings_ == 0 && tremble(changes)) {
                hold();
                return true;
            }
            glides_ = changes.glides;
            if (glides_) {
                if (motion_.mover.coasting != Coasting::start) motion_.push(Work(1), true, false);
                return true;
            }
            for (int k = 0; k < motion_.island.group.count; ++k) push(k, nullptr);
            find_others(changes, again || halvings_ > 0);
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
            if (halvings_ > 0) of_load = N::part(of_load, N::fraction(part_));
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
        note_ways();
        motion_.contacts.pairs.for_each(motion_.island, [&](Pair& pair) {
            if (pair.count > 0) return;
            const Length closing = closing_of(pair);
            if (!(closing > pair.gap)) return;
            find_points(pair, closing);
            any = any || pair.count > 0;
        });
        return any;
    }
    // How far a body goes in a step, but for loads: its centre, and its surface by the spin at most.
    struct Way {
        Vec3<Length> drift;
        Length turn;
    };
    [[nodiscard]] Way way_of(int b) const {
        const NarrowPhase& shapes = motion_.contacts.shapes;
        return {shapes.drift(motion_.bodies, b), shapes.way_of_turn(motion_.bodies, b)};
    }
    // Call where the velocities have changed.
    void note_ways() {
        for (int k = 0; k < motion_.island.group.count; ++k) {
            const int b = motion_.island.group.id[k];
            way_[b] = way_of(b);
        }
    }
    // By how much the bodies of a pair come closer in this part at most, but for loads.
    [[nodiscard]] Length closing_of(const Pair& pair) const {
        Way way = way_[pair.a];
        const auto subtract = [&](const Way& of_b) {
            way.drift -= of_b.drift;
            way.turn += of_b.turn;
        };
        if (pair.moves_b()) subtract(way_[pair.b]);
        else if (pair.surface_moves) subtract(way_of(pair.b));
        Length closing = way.turn - narrow<Length>(dot(pair.normal, way.drift));
        for (int i = 0; i < halvings_; ++i) closing = C::half(closing);
        return closing;
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
    Way way_[features.bodies];
    int halvings_ = 0;        // the part of the step that is flown is 2^-halvings of it
    Work part_{1}, from_{0};  // it, and where in the step it begins
    bool glides_ = false;     // the forces of contacts act as the loads do
};

}  // namespace tumble
