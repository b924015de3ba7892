// One step of an island of bodies that may touch each other or planes, with its impacts. It moves the bodies through
// one function pointer, so that worlds with different methods share this code.
#pragma once

#include <tumble/body/momentum.hpp>
#include <tumble/contact/contact_state.hpp>
#include <tumble/contact/impact.hpp>
#include <tumble/contact/impact_search.hpp>
#include <tumble/contact/resting.hpp>
#include <tumble/contact/schedule.hpp>
#include <tumble/numbers/vector_block.hpp>
#include <tumble/solver/flight.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class IslandStep {
public:
    using State = ContactState<N, spin, features>;
    using Bodies = typename NarrowPhase<N, spin, features>::Bodies;
    using BodyGroup = SomeBodies<features.bodies>;
    using Island = tumble::Island<features>;
    using Work = typename N::Work;
    using C = ContactNumbers<N>;
    using Bounds = ContactBounds<N>;
    using Mover = tumble::Mover<N, features>;
    using Flight = tumble::Flight<N, features>;
    static constexpr bool has_edges = ImpactSearch<N, spin, features>::has_edges;

    // `schedule`: with links, if bodies touch each other.
    IslandStep(State& contacts, auto& schedule, Bodies& bodies, Island& island, const Mover& mover)
        : contacts_{contacts}, schedule_{&schedule}, bodies_{bodies}, island_{island}, mover_{mover},
          search_{contacts.shapes, contacts.pairs, bodies, island} {
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
    // True of an island that stood still before and stands as it did.
    bool take() {
        const bool stood = take_whole();
        if constexpr (features.impact_bounds)
            if (contacts_.velocities.sweeps_left.missing) bodies_.report(Issue::left_over, island_.root);
        return stood;
    }

private:
    using Saved = SavedMotions<Bodies>;
    // A flight of the island from `start`, under the contact forces, which are for `span` of the step.
    struct Attempt {
        const Saved& start;
        Work span;   // the rest of the step, as a part of it
        bool whole;  // no impact has interrupted the step so far
        bool held;
    };

    [[gnu::noinline]] bool take_whole() {
        move({.group = island_.group, .loads = &contacts_.loads});
        if (resting().still_stands(contacts_.loads, contacts_.forces)) {
            contacts_.solution = {.settled = true, .stands = true};
            return true;
        }
        if constexpr (features.contact_readout) contacts_.log.start_island(contacts_.pairs, island_);
        for (int k = 0; k < island_.group.count; ++k) contacts_.pairs.forget_points_of(island_.group.id[k]);
        if constexpr (features.control)
            if (contacts_.standing.has_other_gravity() && stands_anew()) return true;
        Work span(1);
        [[maybe_unused]] bool ended = false;  // a contact has ended at an edge
        for (int impact = 0;; ++impact) {
            search_.start_flight();
            if constexpr (has_edges)
                if (ended) [[unlikely]]
                    search_.end_selected();
            Touch touch = solve_resting(span, impact == 0, false);
            if (contacts_.solution.stands) {
                log_forces(Work(1));
                resting().stop_all();
                take_over_spins();
                return false;
            }
            if (touch == Touch::strikes && !is_spent()) touch = strike(span, impact == 0);
            Saved start;
            save(start);
            const Attempt attempt{start, span, impact == 0, touch == Touch::rests};
            if (attempt.held) log_forces(Work(1));
            fly(attempt, span, false);
            search_.measure();
            search_.note_seams();
            span = finish(attempt, impact, ended);
            if (!(span > Bounds::min_portion())) return false;
            move({.group = island_.group, .loads = &contacts_.loads});
        }
    }
    // Resolves what strikes where a flight is to begin, and finds the forces after it.
    TUMBLE_INLINE Touch strike(Work span, bool whole) {
        resolve(false, span);
        find_near_pairs();
        search_.start_flight();
        return solve_resting(span, whole, true);
    }
    // After a flight: where bodies met something in it, goes back to that moment and resolves the impact. Returns the
    // rest of the step that is to be flown.
    TUMBLE_INLINE Work finish(const Attempt& attempt, int impact, bool& ended) {
        const bool spent = is_spent();
        const Work length = features.pairs ? stop_before_crossing(attempt) : attempt.span;
        const bool crossed = length < attempt.span, deep = search_.is_too_deep();
        if (!crossed && !deep) {
            ended = has_edges && attempt.held && impact < contact::max_impacts && !spent && ends_at_edge();
            Work rest(0);
            if constexpr (has_edges)
                if (ended) [[unlikely]]
                    rest = attempt.span - fly_to_end(attempt);
            search_.find();
            return rest;
        }
        ended = false;
        if (spent && !crossed && !search_.is_on_the_other_side()) {
            search_.find();
            bodies_.report(Issue::left_over, island_.root);
            return Work(0);
        }
        const bool last = spent || (!has_bounds() && impact == contact::max_impacts);
        const bool far_below = last && deep && (spent || search_.is_far_too_deep());
        Work flown = length;
        if (deep && (far_below || !last)) flown = find_impact(attempt, length);
        // The step ends at a surface: the rest of its time is lost.
        if (last && (crossed || far_below)) bodies_.report(Issue::step_bound_hit, island_.root);
        log_not_flown(attempt, flown);
        const Work rest = last ? Work(0) : attempt.span - flown;
        resolve(last && !spent, rest);
        if constexpr (features.impact_bounds) --left_.impacts;
        // Always, however short the rest of the step is: an impact ends the bounds on the time to contact.
        find_near_pairs();
        return rest;
    }
    // Under other gravity: whether the island stood and still stands, on the points on which it stood. Where it does
    // not, its bodies look for others, since they did not when the step began.
    [[gnu::noinline]] bool stands_anew() requires(features.control) {
        bool all = contacts_.pairs.are_balanced(island_), any = false;
        for (int k = 0; k < island_.group.count; ++k) {
            const bool stood = contacts_.standing.stood(island_.group.id[k]);
            all = all && stood;
            any = any || stood;
        }
        if (all) {
            (void)solve_resting(Work(1), true, false, true);
            if (contacts_.solution.stands) {
                log_forces(Work(1));
                return true;
            }
        }
        if (any) find_near_pairs();
        return false;
    }
    [[nodiscard]] bool has_bounds() const {
        if constexpr (features.impact_bounds) return contacts_.most.are_set();
        else return false;
    }
    // True where the bounds of the scene are used up.
    [[nodiscard]] bool is_spent() const {
        if constexpr (features.impact_bounds)
            return has_bounds() &&
                   (left_.impacts <= 0 || left_.searches <= 0 || contacts_.velocities.sweeps_are_spent());
        else return false;
    }
    // Whether a search that has redone so many flights may redo another. Each may redo one, however many are left.
    [[nodiscard]] bool may_search(int redone) {
        if constexpr (features.impact_bounds)
            if (has_bounds() && left_.searches-- <= 0) return redone == 0;
        return redone < contact::max_resteps;
    }

    void move(const Flight& flight) { mover_.move(mover_.method, flight); }
    void take_over_spins() { move({.group = island_.group, .new_spins = true}); }
    [[nodiscard]] Resting<N, spin, features> resting() {
        return {contacts_.shapes, contacts_.pairs, contacts_.velocities, bodies_, island_};
    }
    // `struck`: the impact has been resolved. `stands`: nothing is computed unless the island stands.
    Touch solve_resting(Work span, bool whole, bool struck, bool stands = false) {
        return resting().solve(contacts_.loads, span, whole, struck, mover_.coasting, contacts_.forces,
                               contacts_.solution, stands);
    }
    // `share`: of the time for which the forces are solved.
    void log_forces([[maybe_unused]] Work share) {
        if constexpr (features.contact_readout)
            contacts_.log.add_forces(contacts_.pairs, island_, contacts_.shapes, bodies_, share);
    }
    // Takes off what was noted for the rest of a flight that ended before.
    void log_not_flown(const Attempt& attempt, Work flown) {
        if (attempt.held && flown < attempt.span) log_forces(flown / attempt.span - Work(1));
    }
    void lift(bool off) {
        resting().lift(off);
        take_over_spins();
    }
    // After an impact the bodies' bounds on the time to contact hold no longer, and other bodies may be near.
    void find_near_pairs() {
        BroadPhase<N, spin, features> broad_phase{contacts_.shapes, contacts_.pairs, contacts_.times, bodies_};
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            contacts_.times.end(b, contacts_.shapes.plane_count(), bodies_.steps_taken);
            if constexpr (features.pairs) broad_phase.update(b, contacts_.marks, contacts_.sleepers, schedule_->wakes);
            else broad_phase.update(b, contacts_.marks);
        }
        if constexpr (features.pairs) {
            contacts_.pairs.link(*schedule_);
            island_.first_pair = schedule_->first_pair[island_.root];
        } else {
            contacts_.pairs.link();
        }
    }

    void save(Saved& saved) const {
        for (int k = 0; k < island_.group.count; ++k) saved.save(k, bodies_, island_.group.id[k]);
    }
    void restore(const Saved& saved) {
        for (int k = 0; k < island_.group.count; ++k) saved.restore(k, bodies_, island_.group.id[k]);
    }

    [[gnu::noinline]] void fly(const Attempt& attempt, Work length, bool restart) {
        const BodyGroup& group = island_.group;
        if (restart) {
            if constexpr (Bodies::has_parts) {
                if (attempt.held && mover_.coasting != Coasting::end)
                    for (int k = 0; k < group.count; ++k)
                        contacts_.forces.rescale(group.id[k],
                                                 attempt.start.halvings(k) - bodies_.parts.halvings[group.id[k]]);
            }
            restore(attempt.start);
        }
        const bool all = length == attempt.span;
        const Work part = all ? Work(1) : length / attempt.span;
        // Contact forces act as gravity does in the method: before the drift, after it, or half before and half after.
        const bool before = attempt.held && mover_.coasting != Coasting::start;
        if (before) push(part, all, false);
        bool carries = false;
        if constexpr (features.moving_surfaces()) carries = attempt.held && contacts_.velocities.surfaces.carry;
        const bool lifts = attempt.held && contacts_.solution.lifts && !carries;
        if (lifts) lift(false);
        if (carries) carry(part, all, nullptr);
        Flight flight{
            .group = group, .new_spins = restart || before || carries, .portion = {attempt.whole && all, length}};
        if constexpr (features.kinematic) flight.from = Work(1) - attempt.span;
        move(flight);
        if (lifts) lift(true);
        if (carries) carry(part, all, &attempt.start);
        if (attempt.held && mover_.coasting != Coasting::end) {
            push(part, all, true, &attempt.start);
            take_over_spins();
        }
    }
    // `start`: of the flight that has ended. The kicks, which still have the scale of its spins, get that of now. They
    // act in its axes, so the change of spin is turned into the axes of now: a torque has its direction in the world.
    // A body that turns is an exception. Its rows are made for the middle of the flight: both halves of its kick have
    // the same components in its axes.
    void push(Work part, bool all, bool second, const Saved* start = nullptr) {
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            if constexpr (Bodies::has_parts)
                if (start != nullptr) contacts_.forces.rescale(b, bodies_.parts.halvings[b] - start->halvings(k));
            Kick<N> kick = contacts_.forces[b];
            if (start != nullptr && !contacts_.velocities.turns(b)) turn(kick, b, (*start)[k].q_wb.value());
            const auto share = [&](auto sum) {
                if (!all) sum = N::part(sum, N::fraction(part));
                if (mover_.coasting != Coasting::mean) return sum;
                return second ? sum - N::half(sum) : N::half(sum);
            };
            for (int i = 0; i < 3; ++i) {
                N::add(bodies_.state[b].d_w[i], share(kick.linear[i]));
                bodies_.state[b].t_b[i].add(share(kick.angular[i]));
            }
            if (!second) (void)bodies_.fit_parts(b);
        }
    }

    // Adds the motion of Resting::find_taken_along() before the flight, or takes it off after the flight from `start`,
    // so that it leaves no momentum. In a part of the time the forces do a part of their work, so that more is missing.
    void carry([[maybe_unused]] Work part, [[maybe_unused]] bool all, [[maybe_unused]] const Saved* start) {
        if constexpr (features.moving_surfaces()) {
            for (int k = 0; k < island_.group.count; ++k) {
                const int b = island_.group.id[k];
                Kick<N> kick;
                const auto& moves = contacts_.velocities.added()[b];
                if (!contacts_.velocities.write(
                        kick, [&](int i) { return moves.linear[i]; }, [&](int i) { return moves.angular[i]; }, bodies_,
                        contacts_.shapes.weights()[b], b))
                    bodies_.report(Issue::range_left, b);
                if (start != nullptr) turn(kick, b, (*start)[k].q_wb.value());
                const auto share = [&](auto sum) {
                    if (!all) sum = sum + sum - N::part(sum, N::fraction(part));
                    return start != nullptr ? -sum : sum;
                };
                for (int i = 0; i < 3; ++i) {
                    N::add(bodies_.state[b].d_w[i], share(kick.linear[i]));
                    bodies_.state[b].t_b[i].add(share(kick.angular[i]));
                }
                if (start == nullptr) (void)bodies_.fit_parts(b);
            }
            if (start != nullptr) take_over_spins();
        }
    }
    // Turns a change of spin from the axes at q into those of now. Angular momentum turns, not angular velocity.
    void turn(Kick<N>& kick, int b, const Quat<typename N::Unit>& q) const {
        const auto& now = bodies_.state[b].q_wb.value();
        if (q.w == now.w && q.v == now.v) return;
        if constexpr (spin == Spin::angular_momentum) {
            turn_momentum<N>(kick.angular, bodies_.spin_scale(b), q, now);
        } else {
            using Vector = VectorBlock<N>;
            const BodyWeight<N>& weight = contacts_.shapes.weights()[b];
            const auto scaled = [](const Vector& v, const Work(&by)[3]) {
                return v.times(Vector3<Work>{by[0] * by[0], by[1] * by[1], by[2] * by[2]});
            };
            Vector change = Vector::of_turns(kick.angular, bodies_.spin_scale(b));
            if (change.is_zero()) return;
            change = scaled(scaled(change, weight.of_turn).rotated(q).rotated_back(now), weight.per_turn);
            for (int i = 0; i < 3; ++i) kick.angular[i] = change.turn(i, Work(1), bodies_.spin_scale(b));
        }
    }

    // Conservative advancement (Mirtich 1996) of pairs that may have passed through each other. The flight is redone up
    // to the moment when the separation along its first direction runs out. From there it is redone again, until the
    // bodies touch or have gone past each other. Returns the part of the step flown, which is less than the span where
    // a pair is stopped at its surface.
    [[gnu::noinline]] Work stop_before_crossing(const Attempt& attempt) {
        const auto crossing = search_.find_crossing();
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
                const Work part = search_.part_apart(crossing);
                passes = part < Work(0);
                if (passes) break;
                from += (end - from) * part;
                if (from < Bounds::min_portion()) from = Bounds::min_portion();
                fly(attempt, from, true);
                search_.measure();
                if (!search_.is_close(crossing)) continue;
                passes = !search_.has_points(crossing);
                break;
            }
            if (passes) {
                crossing.pair->passed = true;
                fly(attempt, end, true);
                search_.measure();
            } else {
                end = from;  // at the surface, or surely before it
            }
            crossing = search_.find_crossing();
            if (crossing.pair == nullptr) return end;
            if (pair == contact::max_crossings) break;
        }
        bodies_.report(Issue::step_bound_hit, island_.root);
        return end;
    }

    // Redoes the flight until the least gap is at its level; returns the portion of the step flown.
    [[gnu::noinline, gnu::cold]] Work find_impact(const Attempt& attempt, Work longest) {
        search_.select();
        if constexpr (features.pairs)
            if (!search_.is_to_flat()) return find_by_secant(attempt, longest);
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
        const Length tolerance = contacts_.shapes.tolerance(), resting = Bounds::resting_gap(tolerance),
                     close = Bounds::resting_gap(resting);
        const Unit shortest = C::unit(Bounds::min_portion());
        auto path = search_.first_gap(attempt.start, longest);
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
                if (is_spent() || !search_.is_far_too_deep()) return at;
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
            search_.measure();
            gap = search_.least_gap(false);
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
        const auto least_gap = [&](bool at_start) { return search_.metres(search_.least_gap(at_start)); };
        Work low(0), high = longest;
        Work gap_low = least_gap(true), gap_high = least_gap(false);
        if (!(gap_low > Work(0))) gap_low = N::half_of(search_.tolerance());
        const Work close_enough = Bounds::search_gap(search_.tolerance());
        const Work shortest = Bounds::min_portion();
        Work at = high;
        int side = 0;
        for (int i = 0; may_search(i) || (i < contact::max_resteps && search_.is_on_the_other_side()); ++i) {
            // Where rounding has left no difference, halfway.
            const Work apart = gap_low - gap_high;
            at = low + (apart > Work(0) ? (high - low) * (gap_low / apart) : N::half_of(high - low));
            if (at < low + shortest) at = low + shortest;
            if (at > high) at = high;
            fly(attempt, at, true);
            search_.measure();
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
        if (!is_spent() && search_.is_far_too_deep()) {
            at = low > shortest ? low : shortest;
            fly(attempt, at, true);
            search_.measure();
        }
        return at;
    }

    // Whether a contact has ended at an edge in the flight. The search considers the first one.
    [[nodiscard]] bool ends_at_edge() {
        if constexpr (has_edges) return search_.select_ended(contacts_.loads);
        else return false;
    }
    // Redoes the flight up to the time at which a contact ended at an edge. Its force is off from there on. Returns the
    // portion of the step flown.
    [[gnu::noinline, gnu::cold]] Work fly_to_end(const Attempt& attempt) requires(has_edges) {
        Work at = find_by_secant(attempt, attempt.span);
        const Work since = search_.time_since_open();
        if (since > Work(0)) {
            at = at > since + Bounds::min_portion() ? at - since : Bounds::min_portion();
            fly(attempt, at, true);
            search_.measure();
        }
        log_not_flown(attempt, at);
        return at;
    }
    // The range is checked at once: another impact of the same step may bring a body back into it. `rest`: of the step,
    // after the impact.
    void resolve(bool stop, Work rest) {
        check_range();
        move({.group = island_.group, .loads = &contacts_.loads});
        search_.find();
        contacts_.solution = {};
        Impact<N, spin, features>{contacts_.shapes,    contacts_.pairs, contacts_.velocities, bodies_, island_,
                                  contacts_.threshold, fastest_,        contacts_.log}
            .resolve(contacts_.loads, stop, rest);
        check_range();
        take_over_spins();
    }
    void check_range() {
        for (int k = 0; k < island_.group.count; ++k) bodies_.check_range(island_.group.id[k]);
    }

    State& contacts_;
    [[no_unique_address]] If<features.pairs, Schedule<features.bodies>*, 2> schedule_;
    Bodies& bodies_;
    Island& island_;
    const Mover& mover_;
    ImpactSearch<N, spin, features> search_;
    Work fastest_{};                                                            // approach of the step
    [[no_unique_address]] If<features.impact_bounds, ImpactBounds, 0> left_{};  // of those of the scene
};

}  // namespace tumble
