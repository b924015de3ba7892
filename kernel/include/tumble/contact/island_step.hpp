// One step of an island of bodies that may touch each other or planes, with its impacts at their own time.
#pragma once

#include <tumble/contact/impact.hpp>
#include <tumble/contact/island_motion.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class IslandStep {
public:
    using Motion = IslandMotion<N, spin, features>;
    using State = typename Motion::State;
    using Bodies = typename Motion::Bodies;
    using BodyGroup = typename Motion::BodyGroup;
    using Island = typename Motion::Island;
    using Work = typename N::Work;
    using C = ContactNumbers<N>;
    using Mover = typename Motion::Mover;
    using Flight = typename Motion::Flight;
    using Bounds = ContactBounds<N>;
    static constexpr bool has_edges = ImpactSearch<N, spin, features>::has_edges;

    // `schedule`: with links, if bodies touch each other.
    IslandStep(State& contacts, auto& schedule, Bodies& bodies, Island& island, const Mover& mover)
        : motion_{contacts, schedule, bodies, island, mover} {
        if constexpr (features.impact_bounds) {
            const ImpactBounds& most = contacts.most;
            constexpr int usual = contact::max_impacts * contact::max_resteps;
            left_ = {most.impacts > 0 ? most.impacts : contact::max_impacts, most.searches > 0 ? most.searches : usual};
            contacts.velocities.sweeps_left = {};
            if (most.sweeps > 0) contacts.velocities.sweeps_left.count = most.sweeps;
        }
    }

    // One step of an island, with its impacts. Where a pair comes too deep in a flight, or passes through, the flight
    // is redone up to the impact. Then the rest of the step follows. A ball that comes to rest bounces without end in
    // finite time, so max_impacts bounds the search: the rest of the step is then flown without a search, and the
    // points that still approach are stopped. Where the rest ends far below a surface, the step ends at that surface.
    // Where the scene has bounds of its own, nothing is stopped: what is left below a surface strikes it at the start
    // of the next step.
    // True of an island that was at rest and is unchanged.
    bool take() {
        const bool at_rest = take_whole();
        if constexpr (features.impact_bounds)
            if (motion_.contacts.velocities.sweeps_left.missing)
                motion_.bodies.report(Issue::left_over, motion_.island.root);
        return at_rest;
    }

private:
    using Saved = typename Motion::Saved;
    // A flight of the island from `start`, under the contact forces, which are for `span` of the step.
    struct Attempt {
        const Saved& start;
        Work span;   // the rest of the step, as a part of it
        bool whole;  // no impact has interrupted the step so far
        bool rests;
    };

    [[gnu::noinline]] bool take_whole() {
        motion_.move({.group = motion_.island.group, .loads = &motion_.contacts.loads});
        const auto resting = motion_.resting();
        if (resting.is_unchanged(motion_.contacts.loads, motion_.contacts.forces, resting.is_lifted())) {
            motion_.contacts.solution = {.unchanged = true, .at_rest = true};
            return true;
        }
        if constexpr (features.bounded_steps) motion_.contacts.watch.let_go(motion_.island.group);
        if constexpr (features.contact_readout)
            motion_.contacts.log.start_island(motion_.contacts.pairs, motion_.island);
        for (int k = 0; k < motion_.island.group.count; ++k)
            motion_.contacts.pairs.forget_points_of(motion_.island.group.id[k]);
        if constexpr (features.control)
            if (motion_.contacts.at_rest.has_other_gravity() && is_at_rest_anew()) return true;
        Work span(1);
        [[maybe_unused]] bool ended = false;  // a contact has ended at an edge
        for (int impact = 0;; ++impact) {
            motion_.search.start_flight();
            if constexpr (has_edges)
                if (ended) [[unlikely]]
                    motion_.search.end_selected();
            Touch touch = solve_resting(span, impact == 0, false);
            if (motion_.contacts.solution.at_rest) {
                motion_.log_forces(Work(1));
                motion_.resting().stop_all();
                motion_.take_over_spins();
                return false;
            }
            if (touch == Touch::strikes && !is_spent()) touch = strike(span, impact == 0);
            Saved start;
            motion_.save(start);
            const Attempt attempt{start, span, impact == 0, touch == Touch::rests};
            if (attempt.rests) motion_.log_forces(Work(1));
            fly(attempt, span, false);
            motion_.search.measure();
            motion_.search.note_seams();
            span = finish(attempt, impact, ended);
            if (!(span > Bounds::min_portion())) return false;
            motion_.move({.group = motion_.island.group, .loads = &motion_.contacts.loads});
        }
    }
    // Resolves what strikes where a flight is to begin, and finds the forces after it.
    TUMBLE_INLINE Touch strike(Work span, bool whole) {
        resolve(false, span);
        find_near_pairs();
        motion_.search.start_flight();
        return solve_resting(span, whole, true);
    }
    // After a flight: where bodies met something in it, goes back to that moment and resolves the impact. Returns the
    // rest of the step that is to be flown.
    TUMBLE_INLINE Work finish(const Attempt& attempt, int impact, bool& ended) {
        const bool spent = is_spent();
        const Work length = features.pairs ? stop_before_crossing(attempt) : attempt.span;
        const bool crossed = length < attempt.span, deep = motion_.search.is_too_deep();
        if (!crossed && !deep) {
            ended = has_edges && attempt.rests && impact < contact::max_impacts && !spent && ends_at_edge();
            Work rest(0);
            if constexpr (has_edges)
                if (ended) [[unlikely]]
                    rest = attempt.span - fly_to_end(attempt);
            motion_.search.find();
            return rest;
        }
        ended = false;
        if (spent && !crossed && !motion_.search.is_on_the_other_side()) {
            motion_.search.find();
            motion_.bodies.report(Issue::left_over, motion_.island.root);
            return Work(0);
        }
        const bool last = spent || (!has_bounds() && impact == contact::max_impacts);
        const bool far_below = last && deep && (spent || motion_.search.is_far_too_deep());
        Work flown = length;
        if (deep && (far_below || !last)) flown = find_impact(attempt, length);
        // The step ends at a surface: the rest of its time is lost.
        if (last && (crossed || far_below)) motion_.bodies.report(Issue::step_bound_hit, motion_.island.root);
        log_not_flown(attempt, flown);
        const Work rest = last ? Work(0) : attempt.span - flown;
        resolve(last && !spent, rest);
        if constexpr (features.impact_bounds) --left_.impacts;
        // Always, however short the rest of the step is: an impact ends the bounds on the time to contact.
        find_near_pairs();
        return rest;
    }
    // Under other gravity: whether the island was at rest and is so again, on the same points. Where it does
    // not, its bodies look for others, since they did not when the step began.
    [[gnu::noinline]] bool is_at_rest_anew() requires(features.control) {
        bool all = motion_.contacts.pairs.are_balanced(motion_.island), any = false;
        for (int k = 0; k < motion_.island.group.count; ++k) {
            const bool was_at_rest = motion_.contacts.at_rest.was_at_rest(motion_.island.group.id[k]);
            all = all && was_at_rest;
            any = any || was_at_rest;
        }
        if (all) {
            (void)solve_resting(Work(1), true, false, true);
            if (motion_.contacts.solution.at_rest) {
                motion_.log_forces(Work(1));
                return true;
            }
        }
        if (any) find_near_pairs();
        return false;
    }
    [[nodiscard]] bool has_bounds() const {
        if constexpr (features.impact_bounds) return motion_.contacts.most.are_set();
        else return false;
    }
    // True where the bounds of the scene are used up.
    [[nodiscard]] bool is_spent() const {
        if constexpr (features.impact_bounds)
            return has_bounds() &&
                   (left_.impacts <= 0 || left_.searches <= 0 || motion_.contacts.velocities.sweeps_are_spent());
        else return false;
    }
    // Whether a search that has redone so many flights may redo another. Each may redo one, however many are left.
    [[nodiscard]] bool may_search(int redone) {
        if constexpr (features.impact_bounds)
            if (has_bounds() && left_.searches-- <= 0) return redone == 0;
        return redone < contact::max_resteps;
    }

    // `struck`: the impact has been resolved. `only_at_rest`: nothing is computed unless the island is at rest.
    Touch solve_resting(Work span, bool whole, bool struck, bool only_at_rest = false) {
        return motion_.resting().solve(motion_.contacts.loads, span, whole, struck, motion_.mover.coasting,
                                       motion_.contacts.forces, motion_.contacts.solution, only_at_rest);
    }
    void find_near_pairs() {
        motion_.find_near_pairs([](int) { return true; });
    }
    // Takes off what was noted for the rest of a flight that ended before.
    void log_not_flown(const Attempt& attempt, Work flown) {
        if (attempt.rests && flown < attempt.span) motion_.log_forces(flown / attempt.span - Work(1));
    }
    [[gnu::noinline]] void fly(const Attempt& attempt, Work length, bool restart) {
        const BodyGroup& group = motion_.island.group;
        if (restart) {
            if constexpr (Bodies::has_parts) {
                if (attempt.rests && motion_.mover.coasting != Coasting::end)
                    for (int k = 0; k < group.count; ++k)
                        motion_.contacts.forces.rescale(group.id[k], attempt.start.halvings(k) -
                                                                         motion_.bodies.parts.halvings[group.id[k]]);
            }
            motion_.restore(attempt.start);
        }
        const bool all = length == attempt.span;
        const Work part = all ? Work(1) : length / attempt.span;
        // Contact forces act as gravity does in the method: before the drift, after it, or half before and half after.
        const bool before = attempt.rests && motion_.mover.coasting != Coasting::start;
        if (before) motion_.push(part, all, false);
        bool carries = false;
        if constexpr (features.moving_surfaces()) carries = attempt.rests && motion_.contacts.velocities.surfaces.carry;
        const bool lifts = attempt.rests && motion_.contacts.solution.lifts && !carries;
        if (lifts) motion_.lift(false);
        if (carries) carry(part, all, nullptr);
        Flight flight{
            .group = group, .new_spins = restart || before || carries, .portion = {attempt.whole && all, length}};
        if constexpr (features.kinematic) flight.from = Work(1) - attempt.span;
        motion_.move(flight);
        if (lifts) motion_.lift(true);
        if (carries) carry(part, all, &attempt.start);
        if (attempt.rests && motion_.mover.coasting != Coasting::end) {
            motion_.push(part, all, true, &attempt.start);
            motion_.take_over_spins();
        }
    }
    // Adds the motion of Resting::find_taken_along() before the flight, or takes it off after the flight from `start`,
    // so that it leaves no momentum. In a part of the time the forces do a part of their work, so that more is missing.
    void carry([[maybe_unused]] Work part, [[maybe_unused]] bool all, [[maybe_unused]] const Saved* start) {
        if constexpr (features.moving_surfaces()) {
            for (int k = 0; k < motion_.island.group.count; ++k) {
                const int b = motion_.island.group.id[k];
                Kick<N> kick;
                const auto& moves = motion_.contacts.velocities.added()[b];
                if (!motion_.contacts.velocities.write(
                        kick, [&](int i) { return moves.linear[i]; }, [&](int i) { return moves.angular[i]; },
                        motion_.bodies, motion_.contacts.shapes.weights()[b], b))
                    motion_.bodies.report(Issue::range_left, b);
                if (start != nullptr) motion_.turn(kick, b, (*start)[k].q_wb.value());
                const auto share = [&](auto sum) {
                    if (!all) sum = sum + sum - N::part(sum, N::fraction(part));
                    return start != nullptr ? -sum : sum;
                };
                for (int i = 0; i < 3; ++i) {
                    N::add(motion_.bodies.state[b].d_w[i], share(kick.linear[i]));
                    motion_.bodies.state[b].t_b[i].add(share(kick.angular[i]));
                }
                if (start == nullptr) (void)motion_.bodies.fit_parts(b);
            }
            if (start != nullptr) motion_.take_over_spins();
        }
    }
    // Conservative advancement (Mirtich 1996) of pairs that may have passed through each other. The flight is redone up
    // to the moment when the separation along its first direction runs out. From there it is redone again, until the
    // bodies touch or have gone past each other. Returns the part of the step flown, which is less than the span where
    // a pair is stopped at its surface.
    [[gnu::noinline]] Work stop_before_crossing(const Attempt& attempt) {
        const auto crossing = motion_.search.find_crossing();
        return crossing.pair == nullptr ? attempt.span : stop_before(attempt, crossing);
    }
    // The rest of it, from the first such pair on.
    [[gnu::noinline, gnu::cold]] Work stop_before(const Attempt& attempt, auto crossing) {
        Work end = attempt.span;
        for (int pair = 1;; ++pair) {
            Work from(0);
            bool passes = false;
            crossing.at_start();
            for (int i = 0; may_search(i); ++i) {
                const Work part = motion_.search.part_apart(crossing);
                passes = part < Work(0);
                if (passes) break;
                from += (end - from) * part;
                if (from < Bounds::min_portion()) from = Bounds::min_portion();
                fly(attempt, from, true);
                motion_.search.measure();
                if (!motion_.search.is_close(crossing)) continue;
                passes = !motion_.search.has_points(crossing);
                break;
            }
            if (passes) {
                crossing.pair->passed = true;
                fly(attempt, end, true);
                motion_.search.measure();
            } else {
                end = from;  // at the surface, or surely before it
            }
            crossing = motion_.search.find_crossing();
            if (crossing.pair == nullptr) return end;
            if (pair == contact::max_crossings) break;
        }
        motion_.bodies.report(Issue::step_bound_hit, motion_.island.root);
        return end;
    }

    // Redoes the flight until the least gap is at its level; returns the portion of the step flown.
    [[gnu::noinline, gnu::cold]] Work find_impact(const Attempt& attempt, Work longest) {
        motion_.search.select();
        if constexpr (features.pairs)
            if (!motion_.search.is_to_flat(attempt.start)) return find_by_secant(attempt, longest);
        return find_on_path(attempt, longest);
    }
    // Of bodies that come to flat surfaces: where their path meets the level. Each flight moves the path by the gap
    // that it leaves. Halfway, where that is not in the bracket (low, high), and after a flight that leaves more than
    // half of the gap of the one before: the path is wrong where a body turns far in the flight. Rounding may end the
    // search above `close`, below the gap of resting points: where the path does not move any more, or where a flight
    // leaves more than half of the gap of the one before. A search that fails ends like find_by_secant().
    TUMBLE_INLINE Work find_on_path(const Attempt& attempt, Work longest) {
        using Length = typename C::Length;
        using Unit = typename C::Unit;
        const Length tolerance = motion_.contacts.shapes.tolerance(), resting = Bounds::resting_gap(tolerance),
                     close = Bounds::resting_gap(resting);
        const Unit shortest = C::unit(Bounds::min_portion());
        auto path = motion_.search.first_gap(attempt.start, longest);
        // In double the flight ends a few roundings of a gap below the level, by 2^-41 of the tolerance: a body that
        // does not bounce would come down the rest of a gap by the end of the step. Other numbers round gaps to zero.
        if constexpr (std::is_same_v<Work, double>) path.add(tolerance * 0x1p-41);
        Unit low{}, high = C::one(), part = high;
        Length gap{}, last = tolerance;
        bool slow = false;
        Work at = longest;
        for (int i = 0;; ++i) {
            const bool fails = !may_search(i);
            if (fails) {
                if (is_spent() || !motion_.search.is_far_too_deep()) return at;
                part = low;
            } else {
                const Unit before = part;
                part = path.root(C::one());
                if (i > 0 && (slow || !(low < part && part < high))) {
                    if (part == before && last < resting) return at;
                    part = low + C::half(high - low);
                }
            }
            at = longest * N::work(part);
            if (at < Bounds::min_portion()) at = Bounds::min_portion();
            fly(attempt, at, true);
            motion_.search.measure();
            gap = motion_.search.least_gap(false);
            const Length size = magnitude_of(gap);
            if (fails || !(size > close) || (size < resting && size + size > last) || high - low < shortest) return at;
            slow = i > 0 && !slow && size + size > last;
            (gap > Length{} ? low : high) = part;
            path.add(gap);
            last = size;
        }
    }
    // Illinois' variant of the secant method: the bracket [0, longest] has gaps of opposite sign and never loses the
    // root. A pair that starts at the level or below it has no such bracket: half the tolerance stands for its gap, so
    // that the search begins near the start.
    [[gnu::noinline, gnu::cold]] Work find_by_secant(const Attempt& attempt, Work longest) requires(features.pairs) {
        const auto least_gap = [&](bool at_start) { return motion_.search.metres(motion_.search.least_gap(at_start)); };
        Work low(0), high = longest;
        Work gap_low = least_gap(true), gap_high = least_gap(false);
        if (!(gap_low > Work(0))) gap_low = N::half_of(motion_.search.tolerance());
        const Work close_enough = Bounds::search_gap(motion_.search.tolerance());
        const Work shortest = Bounds::min_portion();
        Work at = high;
        int side = 0;
        for (int i = 0; may_search(i) || (i < contact::max_resteps && motion_.search.is_on_the_other_side()); ++i) {
            // Where rounding has left no difference, halfway.
            const Work apart = gap_low - gap_high;
            at = low + (apart > Work(0) ? (high - low) * (gap_low / apart) : N::half_of(high - low));
            if (at < low + shortest) at = low + shortest;
            if (at > high) at = high;
            fly(attempt, at, true);
            motion_.search.measure();
            const Work gap = least_gap(false);
            if ((gap < close_enough && -close_enough < gap) || high - low < shortest) return at;
            if (gap > Work(0)) {
                low = at;
                gap_low = gap;
                if (side > 0) gap_high = N::half_of(gap_high);
                side = 1;
            } else {
                high = at;
                gap_high = gap;
                if (side < 0) gap_low = N::half_of(gap_low);
                side = -1;
            }
        }
        // Not found. Where a pair is far too deep, the flight ends at the last time when none was, or after the
        // shortest flight. The next search starts from there. A search whose flights are used up ends where it is
        // instead, so that each step comes farther.
        if (!is_spent() && motion_.search.is_far_too_deep()) {
            at = low > shortest ? low : shortest;
            fly(attempt, at, true);
            motion_.search.measure();
        }
        return at;
    }

    // Whether a contact has ended at an edge in the flight. The search considers the first one.
    [[nodiscard]] bool ends_at_edge() {
        if constexpr (has_edges) return motion_.search.select_ended(motion_.contacts.loads);
        else return false;
    }
    // Redoes the flight up to the time at which a contact ended at an edge. Its force is off from there on. Returns the
    // portion of the step flown.
    [[gnu::noinline, gnu::cold]] Work fly_to_end(const Attempt& attempt) requires(has_edges) {
        Work at = find_by_secant(attempt, attempt.span);
        const Work since = motion_.search.time_since_open();
        if (since > Work(0)) {
            at = at > since + Bounds::min_portion() ? at - since : Bounds::min_portion();
            fly(attempt, at, true);
            motion_.search.measure();
        }
        log_not_flown(attempt, at);
        return at;
    }
    // The range is checked at once: another impact of the same step may bring a body back into it. `rest`: of the step,
    // after the impact.
    void resolve(bool stop, Work rest) {
        motion_.check_range();
        motion_.move({.group = motion_.island.group, .loads = &motion_.contacts.loads});
        motion_.search.find();
        motion_.contacts.solution = {};
        Impact<N, spin, features>{motion_.contacts.shapes,
                                  motion_.contacts.pairs,
                                  motion_.contacts.velocities,
                                  motion_.bodies,
                                  motion_.island,
                                  motion_.contacts.threshold,
                                  fastest_,
                                  motion_.contacts.log}
            .resolve(motion_.contacts.loads, stop, rest);
        motion_.check_range();
        motion_.take_over_spins();
    }
    Motion motion_;
    Work fastest_{};                                                            // approach of the step
    [[no_unique_address]] If<features.impact_bounds, ImpactBounds, 0> left_{};  // of those of the scene
};

}  // namespace tumble
