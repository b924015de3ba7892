// World<Scene>: the only thing that steps. It owns bodies, loads and contacts in fixed-size arrays and advances them by
// one fixed step at a time with the scene's method. Nothing is allocated; nothing throws.
//
// What is computed depends on what the scene contains (a body without loads is advanced without stages), never on what
// is compiled in, so a minimal firmware and a host with every feature give the same bits.
#pragma once

#include <tumble/contact/contact_set.hpp>
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
    static constexpr Capacity capacity = capacity_of<S>;
    static constexpr bool has_contacts = capacity.contacts();
    static constexpr bool has_loads = capacity.loads();

    // Bounds of one step of one body (or of one group of coupled bodies).
    static constexpr int max_impacts = 8;   // impacts resolved at their own time within one step
    static constexpr int max_resteps = 12;  // flights redone to find one impact

    // A world without bodies. `step` is the length of every step.
    explicit World(Seconds step, const WorldSpec& spec = {})
        : bodies_{step}, loads_{step.value, spec}, contacts_{step.value, spec.contact} {
        set_gravity(spec.gravity);
    }

    // m/s^2, world frame.
    void set_gravity(RealVec3 gravity) {
        const Real h2 = bodies_.step_length * bodies_.step_length;
        if constexpr (has_contacts) contacts_.set_gravity(sqrt(dot(gravity, gravity)) * h2);
        for (int i = 0; i < 3; ++i) {
            const Real fall = bodies_.scale.drift_units(gravity[i] * h2);
            gravity_[i] = N::fall(fall_in_halves ? fall * Real::scaled(1, -1) : fall);
        }
    }

    // Adds a body; false (and Issue::world_full) when there is no room. Mass and moments must be positive. A start that
    // leaves the range is told in status().
    BodyId add(const BodySpec& spec) {
        if (bodies_.count >= S::bodies) {
            bodies_.report(Issue::world_full, bodies_.count);
            return {};
        }
        const PrincipalInertia inertia = principal_inertia(spec.inertia);
        const int b = bodies_.add(spec, inertia);
        inertia_[b] = Inertia::of(inertia.moments, bodies_.scale);
        prepare_spin(b);
        if constexpr (has_loads) loads_.set_mass(b, spec.mass);
        if constexpr (has_contacts) contacts_.set_shape(b, spec, inertia.principal);
        return BodyId{b};
    }

    // Adds a plane; false when there is no room.
    bool add(const PlaneSpec& spec) requires has_contacts { return contacts_.add(spec); }

    // Adds a spring between bodies already added; false when there is no room.
    bool add(const SpringSpec& spec) requires(S::springs > 0) { return loads_.add(spec, bodies_); }

    // Set-up values as this world's numbers, for arrays of events that outlive it.
    [[nodiscard]] Impulse<N> prepare(const ImpulseSpec& spec) const { return bodies_.prepare(spec); }
    [[nodiscard]] Thrust<N> prepare(const ForceSpec& spec) const { return bodies_.prepare(spec); }
    // The arrays must be sorted by step and stay where they are.
    void set_script(Span<Impulse<N>> impulses) requires S::script { script_ = impulses; }
    void set_forces(Span<Thrust<N>> forces) requires S::forces { loads_.set_forces(forces); }

    // Changes the body's momentum by `impulse` (N s, world frame) at a point of it (m, user's body axes); at once, and
    // once. The position is unchanged.
    void apply_impulse(BodyId id, RealVec3 impulse, RealVec3 point = {}) {
        apply({0, static_cast<std::int16_t>(id.index()), Frame::world, work_vector<N>(impulse), zero_vector<N>(),
               bodies_.principal_vector(id.index(), point)});
    }

    // Takes one step of every body: events that are due, loads, motion, contacts. Returns the sticky status.
    Status step() {
        if constexpr (S::script) {
            while (next_event_ < script_.count && script_.first[next_event_].step <= bodies_.steps_taken)
                apply(script_.first[next_event_++]);
        }
        const StepInfo<N> info{bodies_.scale, Dither::of_step(bodies_.steps_taken)};
        if constexpr (!has_loads && !has_contacts) {
            if constexpr (S::bodies == 1) {
                advance_free(0, info);  // a constant index: every address is known
            } else {
                for (int b = 0; b < bodies_.count; ++b) advance_free(b, info);
            }
        } else {
            step_units(info);
        }
        ++bodies_.steps_taken;
        return bodies_.status;
    }

    [[nodiscard]] int body_count() const { return bodies_.count; }
    [[nodiscard]] std::uint32_t steps_taken() const { return bodies_.steps_taken; }
    [[nodiscard]] Status status() const { return bodies_.status; }
    void clear_status() { bodies_.status = {}; }

    // The body's state as the step keeps it. x_w is in metres; the accessors below give the rest in SI units.
    [[nodiscard]] const State& state(BodyId id) const { return bodies_.state[id.index()]; }
    [[nodiscard]] WorkVec3<N> position(BodyId id) const { return bodies_.position(id.index()); }
    // m/s, world frame.
    [[nodiscard]] WorkVec3<N> velocity(BodyId id) const { return bodies_.velocity(id.index()); }
    // rad/s, user's body axes.
    [[nodiscard]] WorkVec3<N> angular_velocity(BodyId id) const { return bodies_.angular_velocity(id.index()); }
    // User's body axes to world; of unit length to rounding.
    [[nodiscard]] Quat<Work> orientation(BodyId id) const { return bodies_.orientation(id.index()); }

    // Digest of every body's state.
    [[nodiscard]] std::uint64_t hash() const { return bodies_.hash(); }

    // The bodies whatever the method; for readers that want more digits than working numbers have (the host).
    using Bodies = tumble::Bodies<N, Integrator::spin, S::bodies>;
    [[nodiscard]] const Bodies& bodies() const { return bodies_; }

    // Contact points of the body in the last step, at most contact::max_points.
    [[nodiscard]] int contact_count(BodyId id) const {
        if constexpr (has_contacts) return contacts_.count(id.index());
        else return 0;
    }

private:
    using Inertia = typename Integrator::template Inertia<N>;
    using DriftSum = typename N::DriftSum;
    using Unit = tumble::Unit<S::bodies>;
    using Loads = LoadSet<N, Integrator::spin, capacity>;
    using Contacts = ContactSet<N, Integrator::spin, capacity>;
    // Where sums are exact, gravity is kept and added in halves: the position moves with the mean drift between them.
    static constexpr bool fall_in_halves = Integrator::coasting == Coasting::mean && N::fixed_point && N::carry;
    [[nodiscard]] static constexpr DriftSum whole_fall(DriftSum f) { return fall_in_halves ? f + f : f; }

    // Part of a step, for steps that an impact interrupts; whole steps cost nothing extra.
    struct Portion {
        bool whole = true;
        Work length = Work(1);  // of the step, (0, 1]
    };

    void apply(const Impulse<N>& event) {
        bodies_.apply(event);
        prepare_spin(event.body);
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
        if (bodies_.constants[b].fixed) return;
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
            if (bodies_.constants[b].fixed) continue;
            if constexpr (has_loads) {
                if (loads_.is_coupled(b)) {
                    coupled.id[coupled.count++] = static_cast<std::int16_t>(b);
                    continue;
                }
            }
            Unit alone;
            alone.count = 1;
            alone.id[0] = static_cast<std::int16_t>(b);
            advance_unit(alone, info);
        }
        if (coupled.count > 0) advance_unit(coupled, info);
    }

    void advance_unit(const Unit& unit, const StepInfo<N>& info) {
        if constexpr (has_contacts) {
            if (contacts_.concerns(unit)) fly_with_contacts(unit, info);
            else fly(unit, info, {});
        } else {
            fly(unit, info, {});
        }
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
        StateCopies<State, S::bodies> whole, scaled;
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
            if (unit.count > 1 || loads_.is_loaded(bodies_, unit.id[0])) {
                const DriftSum whole[3]{whole_fall(fall[0]), whole_fall(fall[1]), whole_fall(fall[2])};
                const auto evaluate = loads_.evaluation(bodies_, unit, length, whole);
                if (unit.count == 1) advance_loaded<1>(unit, evaluate, info);
                else advance_loaded<S::bodies>(unit, evaluate, info);
                return;
            }
        }
        coast(unit.id[0], fall);
        rotate(unit.id[0], info);
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

    using Saved = StateCopies<State, S::bodies>;
    void save(const Unit& unit, Saved& saved) const {
        for (int k = 0; k < unit.count; ++k) saved.keep(k, bodies_.state[unit.id[k]]);
    }
    void restore(const Unit& unit, const Saved& saved) {
        for (int k = 0; k < unit.count; ++k) bodies_.state[unit.id[k]] = saved[k];
    }

    // One step with impacts. A flight that starts clear of the tolerance band and ends below the surface, or ends
    // deeper than the tolerance, is discarded and redone to the impact, found by a bracketed root finder on the gap;
    // then the rest of the step follows. After max_impacts (a ball coming to rest bounces without end in finite time)
    // the rest of the step is taken without another search and what still approaches is stopped.
    void fly_with_contacts(const Unit& unit, const StepInfo<N>& info) {
        contacts_.forget(unit);
        const Work tolerance = contacts_.tolerance();
        Work remaining(1);
        for (int impact = 0;; ++impact) {
            Saved start;
            save(unit, start);
            const Work gap_start = contacts_.least_gap(bodies_, unit);
            const Portion portion{impact == 0, remaining};
            fly(unit, info, portion);
            const Work gap_end = contacts_.least_gap(bodies_, unit);
            // In touch: within the band, and not on the way through it, as a ball is that a step has left above the
            // surface.
            const bool touched =
                gap_start <= tolerance && !(gap_start > Work(0) && gap_start - gap_end > contacts_.slow());
            const bool too_deep = gap_end < (touched ? -tolerance : Work(0));
            if (!too_deep || impact == max_impacts) {
                resolve(unit, {start.first(), false, touched, impact == max_impacts, too_deep && touched});
                return;
            }
            // The surface, or halfway to the tolerance for a body that was already in the band.
            const Work level = touched ? N::half_of(gap_start < Work(0) ? gap_start - tolerance : -tolerance) : Work(0);
            const Work landed = land(unit, info, start, remaining, gap_start - level, gap_end - level, level);
            resolve(unit, {start.first(), true, false, false, false});
            remaining -= landed;
            if (!(remaining > min_portion())) return;
        }
    }
    void resolve(const Unit& unit, const Touchdown<State>& end) {
        contacts_.resolve(bodies_, unit, end, [&](int b) { prepare_spin(b); });
    }
    // Below this fraction of a step the rest is not worth a flight.
    [[nodiscard]] static constexpr Work min_portion() { return N::template constant<Work>(Real::scaled(1, -20)); }

    // Redoes the flight from `start` until the gap is at `level`; returns the portion of the step flown. Illinois'
    // variant of the secant method: the bracket [0, remaining] has gaps of opposite sign and never loses the root. A
    // body that starts at the level or below it has no such bracket: half the tolerance stands for its gap, so that the
    // search begins near the start.
    Work land(const Unit& unit, const StepInfo<N>& info, const Saved& start, Work remaining, Work gap_low,
              Work gap_high, Work level) {
        Work low(0), high = remaining;
        if (!(gap_low > Work(0))) gap_low = N::half_of(contacts_.tolerance());
        const Work close_enough = contacts_.tolerance() * N::template constant<Work>(Real::scaled(1, -16));
        const Work shortest = min_portion();
        Work at = high;
        int side = 0;
        for (int i = 0; i < max_resteps; ++i) {
            at = low + (high - low) * (gap_low / (gap_low - gap_high));
            if (at < low + shortest) at = low + shortest;
            if (at > high) at = high;
            restore(unit, start);
            fly(unit, info, {false, at});
            const Work gap = contacts_.least_gap(bodies_, unit) - level;
            if ((gap < close_enough && -close_enough < gap) || high - low < shortest) break;
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
        return at;
    }

    DriftSum gravity_[3]{};  // change of drift a step, or half of it: see fall_in_halves
    Inertia inertia_[S::bodies]{};
    Bodies bodies_;
    [[no_unique_address]] If<has_loads, Loads, 0> loads_;
    [[no_unique_address]] If<has_contacts, Contacts, 1> contacts_;
    [[no_unique_address]] If<S::script, Span<Impulse<N>>, 2> script_{};
    [[no_unique_address]] If<S::script, int, 3> next_event_{};
};

}  // namespace tumble
