// One step of an island of bodies that may touch each other or planes, with its impacts. It calls the method through
// Flyer only, so that worlds with different methods share this code.
#pragma once

#include <tumble/contact/solver.hpp>

namespace tumble {

template <class Work, int bodies>
struct Flyer {
    using BodyGroup = tumble::BodyGroup<bodies>;

    void* world;
    Coasting coasting;
    void (*fly)(void* world, const BodyGroup& group, const Portion<Work>& portion);  // free motion and loads
    void (*spins_changed)(void* world, const BodyGroup& group);                      // call after any but fly()
    void (*foresee_loads)(void* world, const BodyGroup& group);                      // into the contacts' kick()
    void (*look_around)(void* world, int body);
};

template <class N, Spin spin, Features features>
class IslandStep {
public:
    using Contacts = ContactSet<N, spin, features>;
    using Bodies = typename Contacts::Bodies;
    using Island = typename Contacts::Island;
    using BodyGroup = typename Contacts::BodyGroup;
    using Work = typename N::Work;
    using Bounds = ContactBounds<N>;
    using State = typename Bodies::State;

    IslandStep(Bodies& bodies, Contacts& contacts, Islands<features.bodies>& islands,
               const Flyer<Work, features.bodies>& flyer)
        : bodies_{bodies}, contacts_{contacts}, islands_{islands}, flyer_{flyer} {}

    // One step of an island, with its impacts. Where a pair comes too deep in a flight, or passes through, the flight
    // is redone up to the impact. Then the rest of the step follows. A ball that comes to rest bounces without end in
    // finite time, so max_impacts bounds the search: the rest of the step is then flown without a search, and the
    // points that still approach are stopped. Where the rest ends far below a surface, the step ends at that surface.
    [[gnu::noinline]] void take(Island& island) {
        const BodyGroup& group = island.group;
        contacts_.forget_touching(group);
        Work span(1);
        for (int impact = 0;; ++impact) {
            const bool whole = impact == 0;
            flyer_.foresee_loads(flyer_.world, group);
            auto touch = contacts_.press(bodies_, island, span, whole, false);
            if (touch == Contacts::Touch::strikes) {
                resolve(island, false);
                look_again(island);
                touch = contacts_.press(bodies_, island, span, whole, true);
            }
            Saved start;
            save(group, start);
            const Flight flight{island, start, span, whole, touch == Contacts::Touch::presses};
            fly(flight, span, false);
            contacts_.measure(bodies_, island);
            const Work length = stop_before_crossing(flight);
            const bool crossed = length < span;
            const bool deep = contacts_.is_too_deep(island);
            if (!crossed && !deep) {
                contacts_.find(bodies_, island);
                break;
            }
            const bool last = impact == contact::max_impacts;
            Work landed = length;
            if (last) {
                const bool far_below = deep && contacts_.is_far_too_deep(island);
                if (far_below) (void)land(flight, length);
                // The step ends at a surface: the rest of its time is lost.
                if (crossed || far_below) bodies_.report(Issue::step_bound_hit, island.root);
            } else if (deep) {
                landed = land(flight, length);
            }
            resolve(island, last);
            // Always, however short the rest of the step is: an impact ends the bounds on the time to contact.
            look_again(island);
            span -= landed;
            if (last || !(span > Bounds::min_portion())) break;
        }
    }

private:
    // After an impact the bodies' bounds on the time to contact hold no longer, and other bodies may be near.
    void look_again(Island& island) {
        for (int k = 0; k < island.group.count; ++k) {
            contacts_.startle(island.group.id[k], bodies_.steps_taken);
            flyer_.look_around(flyer_.world, island.group.id[k]);
        }
        island.first_pair = contacts_.list(islands_, island.root);
    }

    struct Saved {
        StateCopies<State, features.bodies> state;
        [[no_unique_address]]
        typename detail::RoomFor<std::int8_t, Bodies::has_parts ? features.bodies : 0>::Array halvings;
    };
    void save(const BodyGroup& group, Saved& saved) const {
        for (int k = 0; k < group.count; ++k) {
            saved.state.keep(k, bodies_.state[group.id[k]]);
            if constexpr (Bodies::has_parts) saved.halvings[k] = bodies_.parts.halvings[group.id[k]];
        }
    }
    void restore(const BodyGroup& group, const Saved& saved) {
        for (int k = 0; k < group.count; ++k) {
            bodies_.state[group.id[k]] = saved.state[k];
            if constexpr (Bodies::has_parts) bodies_.parts.halvings[group.id[k]] = saved.halvings[k];
        }
    }

    // A flight of an island from `start`, under the contact forces in kick(), which are for `span` of the step.
    struct Flight {
        const Island& island;
        const Saved& start;
        Work span;   // the rest of the step, as a part of it
        bool whole;  // no impact has interrupted the step so far
        bool pressed;
    };
    void fly(const Flight& flight, Work length, bool restart) {
        const BodyGroup& group = flight.island.group;
        if (restart) {
            if constexpr (Bodies::has_parts) {
                if (flight.pressed && flyer_.coasting != Coasting::end)
                    for (int k = 0; k < group.count; ++k)
                        contacts_.rescale_kick(group.id[k],
                                               flight.start.halvings[k] - bodies_.parts.halvings[group.id[k]]);
            }
            restore(group, flight.start);
            flyer_.spins_changed(flyer_.world, group);
        }
        const bool all = length == flight.span;
        const Work part = all ? Work(1) : length / flight.span;
        // Contact forces act as gravity does in the method: before the drift, after it, or half before and half after.
        if (flight.pressed && flyer_.coasting != Coasting::start) push(group, part, all, false);
        flyer_.fly(flyer_.world, group, {flight.whole && all, length});
        if (flight.pressed && flyer_.coasting != Coasting::end) push(group, part, all, true, &flight.start);
    }
    // `start`: where the kicks still have the scale that the spins had at the start of the flight. They get that of
    // now.
    void push(const BodyGroup& group, Work part, bool all, bool second, const Saved* start = nullptr) {
        for (int k = 0; k < group.count; ++k) {
            const int b = group.id[k];
            if constexpr (Bodies::has_parts)
                if (start != nullptr) contacts_.rescale_kick(b, bodies_.parts.halvings[b] - start->halvings[k]);
            const Kick<N>& kick = contacts_.kick(b);
            const auto share = [&](auto sum) {
                if (!all) sum = N::part(sum, N::fraction(part));
                if (flyer_.coasting != Coasting::mean) return sum;
                return second ? sum - N::half(sum) : N::half(sum);
            };
            for (int i = 0; i < 3; ++i) {
                N::add(bodies_.state[b].d_w[i], share(kick.linear[i]));
                bodies_.state[b].t_b[i].add(share(kick.angular[i]));
            }
            if (!second) (void)bodies_.fit_parts(b);
        }
        flyer_.spins_changed(flyer_.world, group);
    }

    // Conservative advancement (Mirtich 1996) of pairs that may have passed through each other. The flight is redone up
    // to the moment when the separation along its first direction runs out. From there it is redone again, until the
    // bodies touch or have gone past each other. Returns the part of the step flown, which is less than the span where
    // a pair is stopped at its surface.
    Work stop_before_crossing(const Flight& flight) {
        Work end = flight.span;
        for (int pair = 0; pair < contact::max_crossings; ++pair) {
            auto crossing = contacts_.find_crossing(bodies_, flight.island);
            if (crossing.pair == nullptr) return end;
            Work from(0);
            bool passes = false;
            crossing.at_start();
            for (int i = 0; i < contact::max_resteps; ++i) {
                const Work part = contacts_.part_apart(crossing);
                passes = part < Work(0);
                if (passes) break;
                from += (end - from) * part;
                if (from < Bounds::min_portion()) from = Bounds::min_portion();
                fly(flight, from, true);
                contacts_.measure(bodies_, flight.island);
                if (contacts_.is_close(crossing)) break;
            }
            if (passes) {
                crossing.pair->passed = true;
                fly(flight, end, true);
                contacts_.measure(bodies_, flight.island);
            } else {
                end = from;  // at the surface, or surely before it
            }
        }
        if (contacts_.find_crossing(bodies_, flight.island).pair != nullptr)
            bodies_.report(Issue::step_bound_hit, flight.island.root);
        return end;
    }

    // Redoes the flight until the least gap is at its level; returns the portion of the step flown. Illinois' variant
    // of the secant method: the bracket [0, longest] has gaps of opposite sign and never loses the root. A pair that
    // starts at the level or below it has no such bracket: half the tolerance stands for its gap, so that the search
    // begins near the start.
    Work land(const Flight& flight, Work longest) {
        contacts_.seek(flight.island);
        Work low(0), high = longest;
        Work gap_low = contacts_.least_gap(flight.island, true), gap_high = contacts_.least_gap(flight.island, false);
        if (!(gap_low > Work(0))) gap_low = N::half_of(contacts_.tolerance());
        const Work close_enough = Bounds::search_gap(contacts_.tolerance());
        const Work shortest = Bounds::min_portion();
        Work at = high;
        int side = 0;
        for (int i = 0; i < contact::max_resteps; ++i) {
            // Where rounding has left no difference, halfway.
            const Work apart = gap_low - gap_high;
            at = low + (apart > Work(0) ? (high - low) * (gap_low / apart) : N::half_of(high - low));
            if (at < low + shortest) at = low + shortest;
            if (at > high) at = high;
            fly(flight, at, true);
            contacts_.measure(bodies_, flight.island);
            const Work gap = contacts_.least_gap(flight.island, false);
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
        // shortest flight. The next search starts from there.
        if (contacts_.least_gap(flight.island, false) < -Bounds::failed_search_depth(contacts_.tolerance())) {
            at = low > shortest ? low : shortest;
            fly(flight, at, true);
            contacts_.measure(bodies_, flight.island);
        }
        return at;
    }

    // The range is checked at once: another impact of the same step may bring a body back into it.
    void resolve(const Island& island, bool stop) {
        check_range(island.group);
        flyer_.foresee_loads(flyer_.world, island.group);
        contacts_.resolve(bodies_, island, stop);
        check_range(island.group);
        flyer_.spins_changed(flyer_.world, island.group);
    }
    void check_range(const BodyGroup& group) {
        for (int k = 0; k < group.count; ++k) bodies_.check_range(group.id[k]);
    }

    Bodies& bodies_;
    Contacts& contacts_;
    Islands<features.bodies>& islands_;
    Flyer<Work, features.bodies> flyer_;
};

}  // namespace tumble
