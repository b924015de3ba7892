// World<Scene>: the only thing that steps. It owns bodies, loads and contacts in fixed-size arrays and advances them by
// one fixed step at a time with the scene's method. Nothing is allocated; nothing throws.
//
// What is computed depends on what the scene contains (a body without loads is advanced without stages), never on what
// is compiled in, so a minimal firmware and a host with every feature give the same bits.
#pragma once

#include <tumble/contact/island_step.hpp>
#include <tumble/contact/sleep.hpp>
#include <tumble/integrators/verlet.hpp>
#include <tumble/loads/load_set.hpp>

namespace tumble {

template <class S>
class World {
public:
    using Numbers = typename S::Numbers;
    using Integrator = typename S::Integrator;
    using N = Numbers;
    using Work = typename N::Work;
    using State = BodyState<N, Integrator::spin>;
    static_assert(
        !requires { S::bodies; } && !requires { S::planes; } && !requires { S::springs; },
        "what a scene has room for stands in `static constexpr tumble::Features features{.bodies = ...}`");
    static_assert(runs_in<Integrator, N>,
                  "the scene's Integrator runs in floating point only: not_in_fixed_point says why");
    static_assert(Method<Integrator, N>, "the scene's Integrator lacks what integrators/method.hpp asks of a method");
    static constexpr Features features = S::features;
    static constexpr bool has_contacts = features.contacts();
    static constexpr bool has_loads = features.loads();

    // A world without bodies. `step` is the length of every step.
    explicit World(Seconds step, const WorldSpec& spec = {})
        : bodies_{step}, loads_{step.value, spec}, contacts_{step.value, spec.contact}, sleepers_{step.value,
                                                                                                  spec.contact.sleep} {
        set_gravity(spec.gravity);
    }

    // m/s^2, world frame.
    void set_gravity(RealVec3 gravity) {
        const Real h2 = bodies_.step_length * bodies_.step_length;
        if constexpr (has_contacts) {
            contacts_.set_gravity(gravity * h2);
            for (int b = 0; b < bodies_.count; ++b) disturb(b);
        }
        for (int i = 0; i < 3; ++i) {
            const Real fall = bodies_.scale.drift_units(gravity[i] * h2);
            gravity_[i] = N::fall(fall_in_halves ? fall * Real::scaled(1, -1) : fall);
        }
    }

    // Adds a body; false (and Issue::world_full) when there is no room. Mass and moments must be positive. A start that
    // leaves the range is told in status().
    BodyId add(const BodySpec& spec) {
        if (bodies_.count >= features.bodies) {
            bodies_.report(Issue::world_full, bodies_.count);
            return {};
        }
        const PrincipalInertia inertia = principal_inertia(spec.inertia);
        const int b = bodies_.add(spec, inertia);
        inertia_[b] = Inertia::of(inertia.moments, bodies_.scale);
        prepare_spin(b);
        if constexpr (has_loads) loads_.set_body(b, spec, inertia, bodies_);
        if constexpr (has_contacts) {
            contacts_.set_shape(b, spec, inertia, bodies_.constants[b].units);
            if (!spec.fixed) sleepers_.add(b);
            for (int other = 0; other <= b; ++other) disturb(other);
        }
        return BodyId{b};
    }

    // Adds a plane; false when there is no room.
    bool add(const PlaneSpec& spec) requires(features.planes > 0) {
        bool added = true;
        if constexpr (has_contacts) {
            added = contacts_.add(spec);
            for (int b = 0; b < bodies_.count; ++b) disturb(b);
        }
        if constexpr (features.springs_touch()) added = loads_.add(spec, bodies_) && added;
        return added;
    }

    // Adds a spring between bodies already added; false when there is no room.
    bool add(const SpringSpec& spec) requires(features.springs > 0) { return loads_.add(spec, bodies_); }

    // Set-up values as this world's numbers, for arrays of events that outlive it.
    [[nodiscard]] Impulse<N> prepare(const ImpulseSpec& spec) const { return tumble::prepare(bodies_, spec); }
    [[nodiscard]] TimedForce<N> prepare(const ForceSpec& spec) const { return tumble::prepare(bodies_, spec); }
    // The arrays must be sorted by step and stay where they are.
    void set_impulses(Span<Impulse<N>> impulses) requires(features.impulses) { impulses_ = impulses; }
    void set_forces(Span<TimedForce<N>> forces) requires(features.forces) { loads_.set_forces(forces); }

    // Changes the body's momentum by `impulse` (N s, world frame) at a point of it (m, user's body axes); at once, and
    // once. The position is unchanged.
    void apply_impulse(BodyId id, RealVec3 impulse, RealVec3 point = {}) {
        const int b = bodies_.index_of(id);
        apply({0, static_cast<std::int16_t>(b), Frame::world, work_vector<N>(impulse), zero_vector<N>(),
               bodies_.principal_vector(b, point)});
    }

    // Takes one step of every body: events that are due, loads, motion, contacts. Returns the sticky status.
    Status step() {
        if constexpr (features.impulses) {
            while (next_event_ < impulses_.count && impulses_.first[next_event_].step <= bodies_.steps_taken)
                apply(impulses_.first[next_event_++]);
        }
        const StepInfo<N> info{bodies_.scale, Dither::of_step(bodies_.steps_taken)};
        if constexpr (has_contacts) {
            step_islands(info);
        } else if constexpr (has_loads) {
            step_units(info);
        } else if constexpr (features.bodies == 1) {
            advance_free(0, info);  // a constant index: every address is known
        } else {
            for (int b = 0; b < bodies_.count; ++b) advance_free(b, info);
        }
        ++bodies_.steps_taken;
        return bodies_.status;
    }

    [[nodiscard]] int body_count() const { return bodies_.count; }
    [[nodiscard]] std::uint32_t steps_taken() const { return bodies_.steps_taken; }
    [[nodiscard]] Status status() const { return bodies_.status; }
    void clear_status() { bodies_.status = {}; }

    // The body's state as the step keeps it. x_w is in metres; the accessors below give the rest in SI units.
    [[nodiscard]] const State& state(BodyId id) const { return bodies_.state[bodies_.index_of(id)]; }
    [[nodiscard]] WorkVec3<N> position(BodyId id) const { return bodies_.position(bodies_.index_of(id)); }
    // m/s, world frame.
    [[nodiscard]] WorkVec3<N> velocity(BodyId id) const { return bodies_.velocity(bodies_.index_of(id)); }
    // rad/s, user's body axes.
    [[nodiscard]] WorkVec3<N> angular_velocity(BodyId id) const {
        return bodies_.angular_velocity(bodies_.index_of(id));
    }
    // User's body axes to world; of unit length to rounding.
    [[nodiscard]] Quat<Work> orientation(BodyId id) const { return bodies_.orientation(bodies_.index_of(id)); }

    // Digest of every body's state.
    [[nodiscard]] std::uint64_t hash() const { return bodies_.hash(); }

    // The bodies whatever the method; for readers that want more digits than working numbers have (the host).
    using Bodies = tumble::Bodies<N, Integrator::spin, features.bodies>;
    [[nodiscard]] const Bodies& bodies() const { return bodies_; }

    // Does the body rest, at no cost, until something touches or pushes it?
    [[nodiscard]] bool asleep([[maybe_unused]] BodyId id) const {
        if constexpr (has_contacts) return sleepers_.is_asleep(bodies_.index_of(id));
        else return false;
    }
    // The largest step at which contacts by springs are stable, s; zero where none of them limits the step.
    [[nodiscard]] Real largest_safe_step() const {
        if constexpr (features.springs_touch()) return loads_.largest_safe_step();
        else return {};
    }
    // Contact points of the body in the last step.
    [[nodiscard]] int contact_count(BodyId id) const {
        if constexpr (has_contacts) return contacts_.count(bodies_.index_of(id));
        else return 0;
    }

private:
    using Inertia = typename Integrator::template Inertia<N>;
    using DriftSum = typename N::DriftSum;
    using Unit = tumble::Unit<features.bodies>;
    using Loads = LoadSet<N, Integrator::spin, features>;
    using Contacts = ContactSet<N, Integrator::spin, features>;
    using Island = typename Contacts::Island;
    using Sleepers = tumble::Sleepers<N, Integrator::spin, features>;
    // Where sums are exact, gravity is kept and added in halves: the position moves with the mean drift between them.
    static constexpr bool fall_in_halves = Integrator::coasting == Coasting::mean && N::fixed_point && N::carry;
    [[nodiscard]] static constexpr DriftSum whole_fall(DriftSum f) { return fall_in_halves ? f + f : f; }

    using Portion = tumble::Portion<Work>;

    void apply(const Impulse<N>& event) {
        tumble::apply(event, bodies_);
        prepare_spin(event.body);
        disturb(event.body);
    }
    // The body's motion has changed, or will, otherwise than by flying and touching.
    void disturb([[maybe_unused]] int b) {
        if constexpr (has_contacts) {
            contacts_.startle(b, bodies_.steps_taken);
            wake(b);
        }
    }
    // The spin has changed otherwise than by free rotation.
    TUMBLE_INLINE void prepare_spin([[maybe_unused]] int b) {
        if constexpr (requires(Inertia & inertia) { inertia.prepare(bodies_.state[0], bodies_.scale); })
            inertia_[b].prepare(bodies_.state[b], bodies_.scale);
    }
    void prepare_spins(const Unit& unit) {
        for (int k = 0; k < unit.count; ++k) prepare_spin(unit.id[k]);
    }

    TUMBLE_INLINE void advance_free(int b, const StepInfo<N>& info) {
        if (turns_in_place(b, info)) return;
        coast(b, gravity_);
        rotate(b, info);
        bodies_.check_range(b);
    }

    // Motion under a constant acceleration, exact for methods of order two and more.
    TUMBLE_INLINE void coast(int b, const DriftSum (&fall)[3]) {
        State& s = bodies_.state[b];
        const auto axis = [&](auto& x, auto& d, DriftSum f) {
            if constexpr (Integrator::coasting == Coasting::mean && !fall_in_halves)
                N::coast(x, d, N::half(f), bodies_.scale);
            if constexpr (Integrator::coasting == Coasting::start) N::coast(x, d, {}, bodies_.scale);
            N::add(d, f);
            if constexpr (fall_in_halves) {
                N::coast(x, d, {}, bodies_.scale);
                N::add(d, f);
            }
            if constexpr (Integrator::coasting == Coasting::end) N::coast(x, d, {}, bodies_.scale);
        };
        axis(s.x_w.x, s.d_w.x, fall[0]);
        axis(s.x_w.y, s.d_w.y, fall[1]);
        axis(s.x_w.z, s.d_w.z, fall[2]);
    }
    TUMBLE_INLINE void rotate(int b, const StepInfo<N>& info) {
        const auto run = [&] { return Integrator::template rotate<N>(bodies_.state[b], inertia_[b], info); };
        if constexpr (std::is_void_v<decltype(run())>) run();
        else if (!run()) bodies_.report(Issue::step_bound_hit, b);
    }

    void step_units(const StepInfo<N>& info) {
        Unit coupled;
        for (int b = 0; b < bodies_.count; ++b) {
            if (turns_in_place(b, info)) continue;
            if (is_coupled(b)) {
                coupled.add(b);
                continue;
            }
            advance_unit(Unit::of(b), info);
        }
        if (coupled.count > 0) advance_unit(coupled, info);
    }
    // Is the body fixed? Then it moves no further than that.
    TUMBLE_INLINE bool turns_in_place(int b, [[maybe_unused]] const StepInfo<N>& info) {
        if (!bodies_.constants[b].fixed) return false;
        if constexpr (features.turntables)
            if (bodies_.is_turning(b)) rotate(b, info);
        return true;
    }
    void advance_unit(const Unit& unit, const StepInfo<N>& info) {
        fly(unit, info, {});
        check_range(unit);
    }
    void check_range(const Unit& unit) {
        for (int k = 0; k < unit.count; ++k) bodies_.check_range(unit.id[k]);
    }

    // Free motion and loads of a unit for a portion of the step.
    void fly(const Unit& unit, const StepInfo<N>& info, const Portion& portion) {
        if (portion.whole) {
            fly_scaled(unit, info, gravity_, Work(1));
            return;
        }
        // In units of the portion, drift and spin shrink with it and accelerations with its square; the same code then
        // steps over the portion. Only the changes are scaled back, so that what did not change stays exact.
        const auto part = N::fraction(portion.length);
        const Work inverse = Work(1) / portion.length;
        StateCopies<State, features.bodies> whole, scaled;
        for (int k = 0; k < unit.count; ++k) {
            State& s = bodies_.state[unit.id[k]];
            whole.keep(k, s);
            for (int i = 0; i < 3; ++i) {
                N::add(s.d_w[i], N::part(N::sum(s.d_w[i]), part) - N::sum(s.d_w[i]));
                s.t_b[i].add(N::part(N::sum(s.t_b[i]), part) - N::sum(s.t_b[i]));
            }
            scaled.keep(k, s);
        }
        prepare_spins(unit);
        DriftSum fall[3];
        for (int i = 0; i < 3; ++i) fall[i] = N::part(N::part(gravity_[i], part), part);
        fly_scaled(unit, info, fall, portion.length);
        for (int k = 0; k < unit.count; ++k) {
            State& s = bodies_.state[unit.id[k]];
            for (int i = 0; i < 3; ++i) {
                const Work linear = N::metres(N::sum(s.d_w[i]) - N::sum(scaled[k].d_w[i]), bodies_.scale) * inverse;
                const Work angular = N::half_turn(N::sum(s.t_b[i]) - N::sum(scaled[k].t_b[i]), bodies_.scale) * inverse;
                s.d_w[i] = whole[k].d_w[i];
                s.t_b[i] = whole[k].t_b[i];
                N::add(s.d_w[i], N::drift_sum(linear, bodies_.scale));
                s.t_b[i].add(N::turn_sum(angular, bodies_.scale));
            }
        }
        prepare_spins(unit);
    }

    void fly_scaled(const Unit& unit, const StepInfo<N>& info, const DriftSum (&fall)[3], Work length) {
        if constexpr (has_loads) {
            Unit coupled;
            for (int k = 0; k < unit.count; ++k) {
                const int b = unit.id[k];
                if (is_coupled(b)) coupled.add(b);
                else if (loads_.is_loaded(bodies_, b)) fly_loaded(Unit::of(b), info, fall, length);
                else fly_free(b, info, fall);
            }
            if (coupled.count > 0) fly_loaded(coupled, info, fall, length);
        } else {
            for (int k = 0; k < unit.count; ++k) fly_free(unit.id[k], info, fall);
        }
    }
    void fly_free(int b, const StepInfo<N>& info, const DriftSum (&fall)[3]) {
        coast(b, fall);
        rotate(b, info);
    }
    void fly_loaded(const Unit& unit, const StepInfo<N>& info, const DriftSum (&fall)[3],
                    Work length) requires has_loads {
        const DriftSum whole[3]{whole_fall(fall[0]), whole_fall(fall[1]), whole_fall(fall[2])};
        const auto evaluate = loads_.evaluation(bodies_, unit, length, whole);
        if (unit.count == 1) advance_loaded<1>(unit, evaluate, info);
        else advance_loaded<features.bodies>(unit, evaluate, info);
    }

    template <int group_capacity, class Evaluate>
    void advance_loaded(const Unit& unit, const Evaluate& evaluate, const StepInfo<N>& info) {
        Group<N, Integrator::spin, Inertia, group_capacity> group;
        group.count = unit.count;
        for (int k = 0; k < unit.count; ++k) {
            group.body[k] = &bodies_.state[unit.id[k]];
            group.inertia[k] = &inertia_[unit.id[k]];
        }
        if (!Integrator::template advance<N, group_capacity>(group, evaluate, info))
            bodies_.report(Issue::step_bound_hit, unit.id[0]);
        prepare_spins(unit);
    }

    // --- contacts ------------------------------------------------------------------------------------------------

    // One step of a world with contacts. Bodies that can touch nothing in it fly freely; the others advance together
    // with those they may touch.
    void step_islands(const StepInfo<N>& info) {
        const std::uint32_t now = bodies_.steps_taken;
        if constexpr (features.turntables) {
            for (int b = 0; b < bodies_.count; ++b) (void)turns_in_place(b, info);
        }
        if constexpr (features.forces) {
            loads_.for_each_change(now, [&](int b) { disturb(b); });
        }
        // Waking appends to the list.
        for (int k = 0; k < sleepers_.awake_count(); ++k) {
            const int b = sleepers_.awake(k);
            if (!contacts_.is_foreseen(b, now)) look_around(b);
        }
        bool islands = false;
        for (int k = 0; k < sleepers_.awake_count(); ++k) {
            const int b = sleepers_.awake(k);
            if (contacts_.is_near(b) || is_coupled(b)) {
                islands = true;
            } else if (is_loaded(b)) {
                advance_unit(Unit::of(b), info);
            } else {
                advance_free(b, info);
            }
        }
        if (islands) [[unlikely]]
            advance_islands(info);
    }
    [[gnu::noinline]] void look_around(int b) {
        contacts_.look_around(
            bodies_, b, [&](int other) { return is_loaded(other); },
            [&](int other) { return bodies_.constants[other].fixed || sleepers_.is_asleep(other); },
            [&](int other) { wake(other); });
    }
    [[nodiscard]] bool is_loaded([[maybe_unused]] int b) const {
        if constexpr (has_loads) return loads_.is_loaded(bodies_, b);
        else return false;
    }
    [[nodiscard]] bool is_coupled([[maybe_unused]] int b) const {
        if constexpr (has_loads) return loads_.is_coupled(bodies_, b);
        else return false;
    }
    // Wakes the body and all that rest on each other with it.
    void wake([[maybe_unused]] int b) {
        if constexpr (features.sleep) {
            if (!sleepers_.is_asleep(b)) return;
            sleepers_.wake(b);
            contacts_.startle(b, bodies_.steps_taken);
            contacts_.for_each_touching([&](int p, int q) {
                if (p == b) wake(q);
                if (q == b) wake(p);
            });
            if constexpr (has_loads) loads_.for_each_coupled(bodies_, b, [&](int other) { wake(other); });
        }
    }

    [[gnu::noinline]] void advance_islands(const StepInfo<N>& info) {
        Islands<features.bodies> islands;
        islands.clear(bodies_.count);
        // Those that have not flown freely. Who comes near something because of an impact in this step, or is woken by
        // it, joins in the next.
        bool joins[features.bodies]{};
        int coupled = -1;
        for (int k = 0; k < sleepers_.awake_count(); ++k) {
            const int b = sleepers_.awake(k);
            const bool is_tied = is_coupled(b);
            joins[b] = contacts_.is_near(b) || is_tied;
            if (!is_tied) continue;
            if (coupled >= 0) islands.connect(coupled, b);
            coupled = b;
        }
        contacts_.connect(islands, bodies_, [&](int b) { return !sleepers_.is_asleep(b); });
        Asked asked{*this, info};
        IslandStep<N, Integrator::spin, features> step{bodies_, contacts_, islands, flyer(asked)};
        // Sleeping changes the list of those awake: first all islands fly.
        Unit to_sleep;
        for (int root = 0; root < bodies_.count; ++root) {
            if (!joins[root] || islands.root(root) != root) continue;
            Unit unit;
            for (int b = root; b < bodies_.count; ++b)
                if (joins[b] && islands.root(b) == root) unit.add(b);
            Island island{unit, root, contacts_.list(islands, root)};
            if (island.first_pair < 0) fly(unit, info, {});
            else step.take(island);
            check_range(unit);
            if constexpr (features.sleep) {
                if (sleepers_.may_sleep(bodies_, unit, contacts_.presses(island)))
                    for (int k = 0; k < unit.count; ++k) to_sleep.add(unit.id[k]);
            }
        }
        if constexpr (features.sleep) {
            for (int k = 0; k < to_sleep.count; ++k) {
                sleepers_.put_to_sleep(bodies_, to_sleep.id[k]);
                prepare_spin(to_sleep.id[k]);
            }
        }
    }

    // What an island's step asks of the world.
    struct Asked {
        World& world;
        const StepInfo<N>& info;

        static Asked& of(void* asked) { return *static_cast<Asked*>(asked); }
    };
    [[nodiscard]] static constexpr auto flyer(Asked& asked) {
        return Flyer<Work, features.bodies>{
            &asked,
            Integrator::coasting,
            [](void* to, const Unit& unit, const Portion& portion) {
                Asked::of(to).world.fly(unit, Asked::of(to).info, portion);
            },
            [](void* to, const Unit& unit) { Asked::of(to).world.prepare_spins(unit); },
            [](void* to, const Unit& unit) { Asked::of(to).world.foresee_loads(unit); },
            [](void* to, int b) { Asked::of(to).world.look_around(b); },
        };
    }

    // What loads will change in the whole step, into the contacts' kick(): gravity, and what else acts at its present
    // strength.
    void foresee_loads(const Unit& unit) {
        const DriftSum whole[3]{whole_fall(gravity_[0]), whole_fall(gravity_[1]), whole_fall(gravity_[2])};
        Unit loaded;
        for (int k = 0; k < unit.count; ++k) {
            const int b = unit.id[k];
            Kick<N>& kick = contacts_.kick(b);
            kick = {};
            for (int i = 0; i < 3; ++i) kick.linear[i] = whole[i];
            if (is_loaded(b)) loaded.add(b);
        }
        if constexpr (has_loads) {
            if (loaded.count == 0) return;
            StageState<N> stages[features.bodies];
            Kick<N> kicks[features.bodies];
            for (int k = 0; k < loaded.count; ++k) stages[k] = stage_of(bodies_.state[loaded.id[k]]);
            loads_.evaluation(bodies_, loaded, Work(1), whole)(stages, kicks);
            for (int k = 0; k < loaded.count; ++k) contacts_.kick(loaded.id[k]) = kicks[k];
        }
    }

    DriftSum gravity_[3]{};  // change of drift a step, or half of it: see fall_in_halves
    Inertia inertia_[features.bodies]{};
    Bodies bodies_;
    [[no_unique_address]] If<has_loads, Loads, 0> loads_;
    [[no_unique_address]] If<has_contacts, Contacts, 1> contacts_;
    [[no_unique_address]] If<has_contacts, Sleepers, 4> sleepers_;
    [[no_unique_address]] If<features.impulses, Span<Impulse<N>>, 2> impulses_{};
    [[no_unique_address]] If<features.impulses, int, 3> next_event_{};
};

}  // namespace tumble
