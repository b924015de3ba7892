// The contacts of a world by impulses. They own their step: the broad phase finds the pairs that may touch, bodies that
// can touch nothing fly freely, the others step in islands, and islands that rest fall asleep (SOLVER.md has the
// stages). `Advance` moves the bodies; what is compiled for each method is here, and the islands' step is not.
#pragma once

#include <tumble/contact/bounded_step.hpp>
#include <tumble/contact/island_step.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class Contacts {
public:
    using Bodies = typename NarrowPhase<N, spin, features>::Bodies;
    using BodyGroup = tumble::BodyGroup<features.bodies>;
    using Work = typename N::Work;
    using C = ContactNumbers<N>;

    constexpr Contacts(Real step, const ContactSpec& spec) : state_{step, spec} {}

    // Gravity's change of drift in a step.
    constexpr void set_gravity(const typename N::DriftSum (&change)[3], typename N::Scale unit) {
        state_.shapes.set_gravity(change, unit);
    }
    // Call after new gravity. Ends all bounds on the time to contact and wakes all bodies. The next step first solves
    // anew what was at rest in the last one. Only what no longer is looks for other bodies.
    template <class Advance>
    void gravity_changed(const Advance& advance) requires(features.control) {
        if constexpr (features.sleep)
            for (int b = 0; b < advance.bodies.count; ++b)
                if (is_asleep(b)) {
                    state_.at_rest.end();
                    wake(advance, b);
                }
        state_.at_rest.gravity_changed();
        state_.times.end_all(advance.bodies.steps_taken);
    }
    // True of a body with a shape, where contacts are by impulses.
    [[nodiscard]] constexpr bool touches(int b) const {
        return state_.shapes.response() == ContactResponse::impulse && !state_.shapes.shape(b).is(ShapeKind::none);
    }
    // Adds a plane; false when there is no room.
    constexpr bool add(const PlaneSpec& spec) { return state_.shapes.add(spec); }
    // Adds a body at its place.
    constexpr void add(int b, const BodySpec& spec, const PrincipalInertia& inertia, const SpinUnits<N, spin>& units) {
        set_shape(b, spec, inertia, units);
        state_.marks[b] = {};
        if (!spec.is_fixed()) state_.sleepers.add(b);
        if constexpr (features.grid()) state_.times.many.come = true;
    }
    // Leaves the place without a body: `nobody` has no shape.
    void remove(int b, const BodySpec& nobody, const PrincipalInertia& inertia, const SpinUnits<N, spin>& units) {
        set_shape(b, nobody, inertia, units);
        state_.sleepers.remove(b);
        if constexpr (features.grid()) state_.times.many.grid.remove(b);
        if constexpr (features.contact_readout) state_.log.remove(b);
    }

    [[nodiscard]] constexpr int plane_count() const { return state_.shapes.plane_count(); }
    // Near pairs.
    [[nodiscard]] int pair_count() const { return state_.pairs.count(); }
    // The most of them that there have been at one time.
    [[nodiscard]] int most_pairs() const { return state_.pairs.most(); }
    // Contact points of the body in the last step.
    [[nodiscard]] int points_of(int b) const { return state_.pairs.points_of(b); }
    [[nodiscard]] bool is_asleep(int b) const { return state_.sleepers.is_asleep(b); }
    // m: the band in which bodies touch, and the depth at which a step is redone.
    [[nodiscard]] Work tolerance() const { return state_.shapes.scale().metres(state_.shapes.tolerance()); }

    // True of a body that moved in bounded time in the last step.
    [[nodiscard]] bool stepped_bounded([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b) const {
        if constexpr (features.bounded_steps) return state_.watch.was_noted(b, bodies.steps_taken);
        else return false;
    }
    // m: the deepest overlap of such a body now.
    [[nodiscard]] Work deepest_overlap([[maybe_unused]] const Bodies& bodies) const {
        typename C::Length deepest{};
        if constexpr (features.bounded_steps)
            state_.pairs.for_each_pair([&](const auto& pair) {
                if (stepped_bounded(bodies, pair.a) && -pair.gap > deepest) deepest = -pair.gap;
            });
        return state_.shapes.scale().metres(deepest);
    }

    // What the log holds of the last step, and which of it is of body b.
    [[nodiscard]] int logged_count() const requires(features.contact_readout) { return state_.log.count(); }
    [[nodiscard]] bool is_logged(int i, int b) const requires(features.contact_readout) { return state_.log[i].has(b); }
    template <class IdOf>
    [[nodiscard]] Contact<Work> logged(int i, int b, const Bodies& bodies, Work rate, IdOf&& id_of) const
        requires(features.contact_readout) {
        return state_.log.contact(i, b, state_.pairs, state_.shapes, bodies, rate, id_of);
    }

    // Call where the body's motion changes other than by a step: ends the bounds on the time to contact of the body and
    // of all that it may push, and wakes it.
    template <class Advance>
    constexpr void disturb(const Advance& advance, int b) {
        const std::uint32_t now = advance.bodies.steps_taken;
        state_.at_rest.end();
        end_times(b, now);
        if constexpr (features.bounded_steps) state_.watch.forget(b, now);
        if constexpr (features.kinematic && features.sleep)
            if (advance.bodies.constants[b].kinematic()) {
                state_.pairs.for_each_touching([&](int a, int other) {
                    if (other == b) wake(advance, a);
                });
                if constexpr (Advance::has_loads)
                    advance.loads.for_each_coupled(advance.bodies, b, [&](int other) { wake(advance, other); });
            }
        if constexpr (features.grid()) {
            if (state_.pairs.is_near(b)) state_.times.many.near = true;
        } else if constexpr (features.pairs) {
            for (int other = 0; state_.pairs.is_near(b) && other < features.bodies; ++other)
                if (state_.pairs.is_near(other)) end_times(other, now);
        }
        wake(advance, b);
    }
    // Call after the velocities of a body have changed other than by a step. `before`: its state then, of which the
    // spin had so many halvings.
    constexpr void note_surface(const Bodies& bodies, int b, const typename Bodies::State& before,
                                int halvings) requires(features.moving_surfaces()) {
        if (!bodies.constants[b].fixed()) return;
        Kick<N>& change = state_.loads[b];
        for (int i = 0; i < 3; ++i) {
            change.linear[i] += N::sum(bodies.state[b].d_w[i]) - N::sum(before.d_w[i]);
            change.angular[i] +=
                N::halved(N::sum(bodies.state[b].t_b[i]), bodies.most_halvings() - bodies.halvings_of(b)) -
                N::halved(N::sum(before.t_b[i]), bodies.most_halvings() - halvings);
        }
        state_.velocities.surfaces.changed = true;
    }
    // Removes the pairs of a body that is elsewhere now. They are found anew.
    void forget_pairs_of(const Bodies& bodies, int b) {
        if constexpr (features.grid()) {
            state_.pairs.for_each_near(b, [&](int other) { state_.times.set(other, bodies.steps_taken); });
            state_.times.many.grid.remove(b);
            state_.times.many.come = true;
        }
        state_.pairs.forget_pairs_of(b);
        state_.times.unlist_pairs_of(b);
        if constexpr (features.contact_readout) state_.log.clear_impulses_of(b);
    }
    // Wakes the body and all sleeping bodies that touch it, directly or through others.
    template <class Advance>
    constexpr void wake([[maybe_unused]] const Advance& advance, [[maybe_unused]] int b) {
        if constexpr (features.sleep) {
            if (!state_.sleepers.is_asleep(b)) return;
            if constexpr (connects<Advance>) wake_all_with(advance, b);
            else wake_alone(b, advance.bodies.steps_taken);
        }
    }

    // One step of a world with contacts. Bodies that can touch nothing in this step fly freely. The others advance
    // together with the bodies that they may touch.
    template <class Advance>
    void step(Advance& advance, const StepInfo<N>& info) {
        auto& pairs = state_.pairs;
        auto& times = state_.times;
        auto& sleepers = state_.sleepers;
        auto& marks = state_.marks;
        if constexpr (features.contact_readout) state_.log.start_step();
        if constexpr (features.turntables) {
            for (int b = 0; b < advance.bodies.count; ++b)
                if (advance.bodies.constants[b].fixed()) advance.step_turntable(b, info);
        }
        if constexpr (features.pairs) broad_phase(advance.bodies).begin(sleepers);
        if constexpr (Advance::has_joints) advance.find_bodies_of_trees([&](int b) { return touches(b); });
        mark_awake(advance);
        typename Advance::Kinematics kinematic;
        if constexpr (features.kinematic) {
            advance.note_moving(kinematic);
            for (int k = 0; (features.sleep || features.grid()) && k < kinematic.group.count; ++k) {
                const int b = kinematic.group.id[k];
                if (!times.is_clear(b, advance.bodies.steps_taken)) update(advance, b);
            }
        }
        // What is at rest moves to nothing: what moves looks for it, but for kinematic bodies.
        bool kinematic_moves = false;
        if constexpr (features.kinematic) kinematic_moves = kinematic.group.count > 0;
        // Waking appends to the list.
        for (int k = 0; k < sleepers.awake_count(); ++k) {
            const int b = sleepers.awake(k);
            if (times.is_clear(b, advance.bodies.steps_taken) || advance.steps_with_trees(b)) continue;
            if (kinematic_moves || !pairs.is_near(b) || !pairs.is_linked() || !state_.at_rest.was_at_rest(b))
                update(advance, b);
        }
        if constexpr (features.contact_readout) state_.log.start_islands(state_.pairs);
        if constexpr (features.kinematic && Advance::has_loads) advance.place(kinematic, info, N::half_of(Work(1)));
        bool islands = false, unchanged = state_.at_rest.all() && pairs.is_linked();
        for (int k = 0; k < sleepers.awake_count(); ++k) {
            const int b = sleepers.awake(k);
            if (advance.steps_with_trees(b)) {
                continue;
            } else if (pairs.is_near(b) || marks[b].coupled) {
                islands = true;
            } else if (marks[b].loaded) {
                if constexpr (Advance::has_loads) advance.alone(b, info);
            } else {
                advance.free_body(b, info);
            }
        }
        if constexpr (Advance::has_joints) advance.step_trees(info);
        if (islands && !unchanged) [[unlikely]]
            step_islands(advance, info, kinematic);
        advance.end(kinematic, info);
        if constexpr (features.moving_surfaces())
            if (state_.velocities.surfaces.changed) [[unlikely]]
                forget_changes(advance.bodies);
        if constexpr (features.contact_readout) state_.log.end_step(state_.pairs, state_.shapes, advance.bodies);
    }

    // Writes or reads what a snapshot holds.
    template <class Self, class Archive>
    static void archive(Self& self, const Bodies& bodies, Archive& to) {
        auto& state = self.state_;
        bool balanced[features.bodies]{}, may_rest[features.bodies]{};  // a step asks for its loads and forces
        to.template each_bits<4>(
            features.bodies,
            [&](int b) { return state.marks[b].bits() | static_cast<std::uint32_t>(state.pairs.is_balanced(b)) << 3; },
            [&](int b, std::uint32_t bits) {
                balanced[b] = (bits >> 3 & 1) != 0;
                may_rest[b] = Mark::of(bits).coupled || balanced[b];
                if constexpr (Archive::reads) state.marks[b] = Mark::of(bits);
            });
        IslandsAtRest<features>::archive(state.at_rest, to);
        Sleepers<N, spin, features>::archive(state.sleepers, bodies, to);
        NarrowPhase<N, spin, features>::archive(state.shapes, to);
        ClearTimes<N, features>::archive(state.times, to);
        if constexpr (Archive::reads) {
            state.times.unlist_all();
            state.velocities.forget_turns();
        }
        PairList<N, features>::archive(
            state.pairs, to, [&](int a, int b) { return state.shapes.may_touch(bodies, a, b); },
            [&](auto& pair) { state.shapes.set_up(pair, bodies); },
            [&](auto& pair) {
                if constexpr (Archive::reads) {
                    state.times.list(pair.a, pair.b);
                    self.make_rows(pair, bodies);
                }
            });
        if constexpr (Archive::reads)
            for (int b = 0; b < features.bodies; ++b) state.pairs.set_balanced(b, balanced[b]);
        for (int b = 0; b < features.bodies; ++b)
            if (may_rest[b] && !bodies.constants[b].fixed()) to(state.velocities.loaded[b], state.forces[b]);
        if constexpr (features.bounded_steps) RestWatch<N, spin, features>::archive(state.watch, bodies, to);
        if constexpr (features.moving_surfaces()) {
            to(state.velocities.surfaces.changed);
            for (int b = 0; b < bodies.count; ++b)
                if (bodies.constants[b].fixed()) to(state.loads[b]);
        }
        if constexpr (features.contact_readout)
            ContactLog<N, spin, features>::archive(state.log, to, bodies.count, state.shapes.plane_count());
    }
    // Call where all bodies are elsewhere: forgets what contacts did in the last step, and the changes of velocities
    // that surfaces have had since.
    void forget_last_step([[maybe_unused]] const Bodies& bodies) {
        if constexpr (features.contact_readout) state_.log.clear();
        if constexpr (features.moving_surfaces()) forget_changes(bodies);
    }

private:
    using Island = tumble::Island<features>;
    // Whether bodies may be neighbours: they touch each other, or a load couples them.
    template <class Advance>
    static constexpr bool connects = features.pairs || Advance::may_couple;

    [[gnu::noinline, gnu::cold]] void forget_changes(const Bodies& bodies) requires(features.moving_surfaces()) {
        for (int b = 0; b < bodies.count; ++b)
            if (bodies.constants[b].fixed()) state_.loads[b] = {};
        state_.velocities.surfaces.changed = false;
    }
    [[nodiscard]] BroadPhase<N, spin, features> broad_phase(Bodies& bodies) {
        return {state_.shapes, state_.pairs, state_.times, bodies};
    }

    constexpr void set_shape(int b, const BodySpec& spec, const PrincipalInertia& inertia,
                             const SpinUnits<N, spin>& units) {
        if (state_.shapes.set_shape(b, spec, inertia, units)) {
            state_.pairs.forget_all();
            state_.times.unlist_all();
        }
        state_.pairs.forget_points_of(b);
        if constexpr (features.moving_surfaces()) state_.loads[b] = {};
    }
    constexpr void end_times(int b, std::uint32_t now) { state_.times.end(b, state_.shapes.plane_count(), now); }
    // Marks what acts on each awake body. A load may begin to act by itself: the bounds, which did not foresee it, end
    // of the body and of all that it may push.
    template <class Advance>
    void mark_awake(const Advance& advance) {
        const std::uint32_t now = advance.bodies.steps_taken;
        bool may_push = false;
        for (int k = 0; k < state_.sleepers.awake_count(); ++k) {
            const int b = state_.sleepers.awake(k);
            Mark& mark = state_.marks[b];
            const bool begins = !mark.driven;
            mark = advance.steps_with_trees(b) ? Mark{} : advance.mark(b);
            if (!mark.none() && state_.pairs.is_near(b) && state_.at_rest.was_at_rest(b)) state_.at_rest.end();
            if (!Advance::has_own_loads || !begins || !mark.driven) continue;
            end_times(b, now);
            may_push = may_push || state_.pairs.is_near(b);
        }
        for (int b = 0; may_push && b < features.bodies; ++b)
            if (state_.pairs.is_near(b)) end_times(b, now);
    }
    template <class Advance>
    [[gnu::noinline]] void update(Advance& advance, int b) {
        if constexpr (features.grid()) state_.at_rest.look(b);
        if constexpr (features.pairs) {
            BodyGroup wakes;
            broad_phase(advance.bodies).update(b, state_.marks, state_.sleepers, wakes);
            wake(advance, wakes);
        } else {
            broad_phase(advance.bodies).update(b, state_.marks);
        }
    }
    template <class Advance>
    void wake(const Advance& advance, const BodyGroup& group) {
        for (int k = 0; k < group.count; ++k) wake(advance, group.id[k]);
    }
    // Of a body without neighbours.
    constexpr void wake_alone(int b, std::uint32_t now) requires(features.sleep) {
        state_.sleepers.wake(b);
        end_times(b, now);
    }
    // Depth first, without recursion. Out of line, because it is rare.
    template <class Advance>
    [[gnu::noinline]] void wake_all_with(const Advance& advance, int b) requires(features.sleep) {
        // The path from b to the body that woke last, from neighbour to neighbour.
        BodyGroup path;
        int next = b;
        do {
            if (next >= 0) {
                state_.sleepers.wake(next);
                end_times(next, advance.bodies.steps_taken);
                path.add(next);
            } else {
                --path.count;
            }
            next = path.count > 0 ? sleeping_neighbour(advance, path.id[path.count - 1]) : -1;
        } while (path.count > 0);
    }
    // The first sleeping body that touches b or is coupled to it; -1 if there is none.
    template <class Advance>
    [[nodiscard]] int sleeping_neighbour(const Advance& advance, int b) const requires(features.sleep) {
        int found = -1;
        const auto look = [&](int other) {
            if (found < 0 && state_.sleepers.is_asleep(other)) found = other;
        };
        state_.pairs.for_each_touching([&](int p, int q) {
            if (p == b) look(q);
            if (q == b) look(p);
        });
        if constexpr (Advance::has_loads) advance.loads.for_each_coupled(advance.bodies, b, look);
        return found;
    }

    // Makes the rows of a pair that has been read anew, where they were valid.
    void make_rows(typename NarrowPhase<N, spin, features>::Pair& pair, const Bodies& bodies) {
        if (!pair.rows_are_valid()) return;
        for (int i = 0; i < pair.count; ++i) pair.point[i].rows_are_valid = false;
        const SomeBodies<features.bodies> nobody{};
        const Island island{nobody, 0, {}};
        ContactRows<N, spin, features>{state_.shapes, state_.pairs, state_.velocities, bodies, island}.make_rows(pair);
    }
    // Connects the bodies that do not fly freely to islands. A body that wakes or comes near something in this step
    // joins in the next.
    void connect(Schedule<features.bodies>& schedule, [[maybe_unused]] Bodies& bodies) {
        schedule.islands.clear(bodies.count);
        int coupled = -1;
        for (int k = 0; k < state_.sleepers.awake_count(); ++k) {
            const int b = state_.sleepers.awake(k);
            const bool is_coupled = state_.marks[b].coupled;
            schedule.joins[b] = state_.pairs.is_near(b) || is_coupled;
            if (!is_coupled) continue;
            if (coupled >= 0) schedule.islands.connect(coupled, b);
            coupled = b;
        }
        if constexpr (features.pairs) broad_phase(bodies).connect(schedule.islands, state_.sleepers);
        schedule.chain(bodies.count);
        if constexpr (features.pairs) {
            state_.pairs.unlink();
            state_.pairs.link(schedule);
        } else {
            state_.pairs.link();
        }
    }
    // Calls step(first body, bodies) for each island.
    template <class Advance, class F>
    void for_each_island(Advance& advance, auto& schedule, F&& step) {
        if constexpr (connects<Advance>) {
            connect(schedule, advance.bodies);
            schedule.for_each_island(advance.bodies.count, step);
        } else {
            state_.pairs.link();
            schedule.for_each_island(
                advance.bodies.count, [&](int b) { return state_.pairs.is_near(b) && !is_asleep(b); }, step);
        }
    }
    template <class Advance>
    [[gnu::noinline]] void step_islands(Advance& advance, const StepInfo<N>& info,
                                        const typename Advance::Kinematics& kinematic) {
        std::conditional_t<connects<Advance>, Schedule<features.bodies>, LoneBodies<features.bodies>> schedule;
        struct Asked {
            Advance& advance;
            const StepInfo<N>& info;
            const Marks<features.bodies>& marks;
            const typename Advance::Kinematics& kinematic;
        } asked{advance, info, state_.marks, kinematic};
        const Mover<N, features> mover{&asked,
                                       [](void* to, const Flight<N, features>& flight) {
                                           Asked& method = *static_cast<Asked*>(to);
                                           if constexpr (features.kinematic)
                                               method.advance.move(flight, method.info, method.marks, method.kinematic);
                                           else method.advance.move(flight, method.info, method.marks);
                                       },
                                       Advance::Integrator::coasting};
        bool all_at_rest = !state_.sleepers.is_on();
        // Sleep changes the list of awake bodies, so it waits until all islands have flown.
        BodyGroup to_sleep;
        for_each_island(advance, schedule, [&](int root, const SomeBodies<features.bodies>& group) {
            Island island{group, root, {}};
            if constexpr (features.pairs) island.first_pair = schedule.first_pair[root];
            if (state_.pairs.has_pairs(island) && state_.at_rest.is_unchanged(group) &&
                state_.pairs.are_balanced(island))
                state_.solution = {.unchanged = true, .at_rest = true};
            else if (!step_island(advance, info, kinematic, schedule, island, mover)) all_at_rest = false;
            if constexpr (features.sleep) {
                if (state_.sleepers.have_been_slow(advance.bodies, group, presses(island)) &&
                    !advance.has_moving_end(group) && may_sleep(advance.bodies, island))
                    for (int k = 0; k < group.count; ++k) to_sleep.add(group.id[k]);
            }
        });
        if constexpr (features.pairs) wake(advance, schedule.wakes);
        state_.at_rest.end_step(all_at_rest, state_.pairs.are_complete());
        if constexpr (features.sleep) {
            state_.sleepers.put_to_sleep(advance.bodies, to_sleep);
            advance.spins_changed(to_sleep);
            // What sleeps is not examined any more: others look for it.
            const std::uint32_t now = advance.bodies.steps_taken;
            if constexpr (features.grid())
                for (int k = 0; k < to_sleep.count; ++k) broad_phase(advance.bodies).examine_around(to_sleep.id[k]);
            if constexpr (features.kinematic)
                for (int k = 0; to_sleep.count > 0 && k < kinematic.group.count; ++k)
                    state_.times.set(kinematic.group.id[k], now);
        }
    }
    // One step of an island that is not known to be at rest. True where it is at rest in the next step.
    template <class Advance>
    bool step_island(Advance& advance, const StepInfo<N>& info,
                     [[maybe_unused]] const typename Advance::Kinematics& kinematic, auto& schedule, Island& island,
                     const Mover<N, features>& mover) {
        const auto& group = island.group;
        const auto reports = advance.bodies.status.count;
        const bool near = state_.pairs.has_pairs(island);
        bool at_rest = false;
        if constexpr (features.kinematic) place(advance, info, kinematic, near ? Work(0) : N::half_of(Work(1)));
        if (near) at_rest = take_step(advance.bodies, schedule, island, mover);
        else advance.portion(group, info, {});
        advance.check_range(group);
        for (int k = 0; k < group.count; ++k) at_rest = at_rest && state_.marks[group.id[k]].none();
        if constexpr (features.turntables)
            state_.pairs.for_each(island, [&](const auto& pair) { at_rest = at_rest && !pair.surface_moves; });
        at_rest = at_rest && advance.bodies.status.count == reports;
        // From now on it starts no search, and bodies near it may have counted on its search in this step.
        if constexpr (features.grid())
            for (int k = 0; at_rest && k < group.count; ++k)
                if (state_.at_rest.has_looked(group.id[k])) broad_phase(advance.bodies).examine_around(group.id[k]);
        state_.at_rest.set(group, at_rest);
        return at_rest;
    }
    // Whether an island is few or many follows from the scene alone.
    TUMBLE_INLINE bool take_step(Bodies& bodies, auto& schedule, Island& island, const Mover<N, features>& mover) {
        if constexpr (features.bounded_steps)
            if (!features.exact_steps || !steps_exactly(island.group))
                return BoundedStep<N, spin, features>{state_, schedule, bodies, island, mover}.take();
        if constexpr (features.exact_steps)
            return IslandStep<N, spin, features>{state_, schedule, bodies, island, mover}.take();
        else return false;
    }
    [[nodiscard]] bool steps_exactly(const BodyGroup& group) const requires(features.bounded_steps) {
        bool all_spheres = true;
        for (int k = 0; k < group.count; ++k)
            all_spheres = all_spheres && state_.shapes.shape(group.id[k]).is(ShapeKind::sphere);
        return ContactSpec::steps_exactly(state_.exact_bodies, group.count, all_spheres);
    }
    // Places the kinematic bodies: at the start of an island's flights, or halfway, for loads alone.
    template <class Advance>
    void place(Advance& advance, const StepInfo<N>& info, const typename Advance::Kinematics& kinematic,
               Work time) requires(features.kinematic) {
        advance.place(kinematic, info, time);
        for (int k = 0; k < kinematic.group.count; ++k) state_.shapes.place(advance.bodies, kinematic.group.id[k]);
    }
    // True where the island touches something, and no surface that moves. A correction of penetrations puts its sleep
    // off, in may_sleep(), but it does not count as motion: what sinks by rounding is corrected again and again.
    [[nodiscard]] bool presses(const Island& island) const {
        bool any = false, surface_moves = false;
        state_.pairs.for_each(island, [&](const auto& pair) {
            any = any || pair.count > 0;
            surface_moves = surface_moves || (pair.count > 0 && pair.surface_moves);
        });
        return any && !surface_moves;
    }
    [[nodiscard]] bool may_sleep(Bodies& bodies, const Island& island) requires(features.sleep) {
        return Resting<N, spin, features>{state_.shapes, state_.pairs, state_.velocities, bodies, island}.may_sleep(
            state_.solution);
    }

    ContactState<N, spin, features> state_;
};

}  // namespace tumble
