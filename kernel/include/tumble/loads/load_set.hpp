// The loads of a world: drag, springs, gravitation, timed forces and contacts by springs, and their sum at a stage of a
// step. Gravity is no load: it is constant and needs no stages.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/loads/contact_spring.hpp>
#include <tumble/loads/drag.hpp>
#include <tumble/loads/gravitation.hpp>
#include <tumble/loads/spring.hpp>
#include <tumble/loads/timed_force.hpp>

namespace tumble {

// The bodies of one group as a load sees them. find(b) returns the loaded body, or null where b is not in the group.
// other_end(b) returns it for a body outside the group too, such as a fixed one.
template <class Group, class Body, class Bodies, class Find, class OtherEnd>
struct LoadedGroup {
    const Group& members;
    Body* loaded;
    Bodies& bodies;
    const Find& find;
    const OtherEnd& other_end;
};
template <class Group, class Body, class Bodies, class Find, class OtherEnd>
LoadedGroup(const Group&, Body*, Bodies&, const Find&, const OtherEnd&)
    -> LoadedGroup<Group, Body, Bodies, Find, OtherEnd>;

// A load has its header, its set-up here, a line in any() and a member. Its functions:
//   acts_on(bodies, b)                 true of a body that feels it in this step
//   apply_to(group)                    adds to the forces and torques of a LoadedGroup
//   couples(bodies, b), for_each_coupled(bodies, b, f)   only where a body feels another
//   depends_on_velocity()              only where it may
//   set_body(b, spec, inertia, bodies) only where it keeps something of each body
template <class N, Spin spin, Features features>
class LoadSet {
public:
    using Work = typename N::Work;
    using DriftSum = typename N::DriftSum;
    static constexpr bool rotation = features.rotation;
    using Bodies = tumble::Bodies<N, spin, features.bodies, features.mixed()>;
    using BodyGroup = tumble::BodyGroup<features.bodies>;
    using Stage = StageState<N, rotation>;
    using Loaded = LoadedBody<N, rotation, features.mixed()>;

    LoadSet(Real step, const WorldSpec& spec)
        : seconds_{N::template constant<Work>(step)}, steps_per_second_{N::template constant<Work>(Real{1} / step)},
          drag_{step, spec}, springs_{step, spec}, gravitation_{step, spec}, forces_{step, spec}, contacts_{step,
                                                                                                            spec} {}

    // Call when a body has been added.
    void set_body([[maybe_unused]] int b, [[maybe_unused]] const BodySpec& spec,
                  [[maybe_unused]] const PrincipalInertia& inertia, [[maybe_unused]] Bodies& bodies) {
        (void)any(*this, [&](auto& load) {
            if constexpr (requires { load.set_body(b, spec, inertia, bodies); })
                load.set_body(b, spec, inertia, bodies);
            return false;
        });
    }
    // Call when a body has been removed: its place loads nothing, and its springs go.
    void remove(int b, Bodies& bodies) {
        BodySpec nobody;
        nobody.mass = 0;
        nobody.fixed = true;
        set_body(b, nobody, {}, bodies);
        if constexpr (features.springs > 0) springs_.remove_from(b);
    }
    // False when there is no room.
    bool add(const PlaneSpec& spec, Bodies& bodies) requires(features.springs_touch()) {
        return contacts_.add(spec, bodies);
    }
    [[nodiscard]] int plane_count() const requires(features.springs_touch()) { return contacts_.plane_count(); }
    [[nodiscard]] int spring_count() const requires(features.springs > 0) { return springs_.count(); }
    [[nodiscard]] Real largest_safe_step() const requires(features.springs_touch()) {
        return contacts_.largest_safe_step();
    }
    // Adds a spring; false when there is no room. Reports a step that is surely too long for the spring, together with
    // the springs, dampers and drag beside it.
    [[gnu::noinline, gnu::cold]] bool add(const SpringSpec& spec, Bodies& bodies,
                                          const SpringBounds<N>& bounds) requires(features.springs > 0) {
        if (!springs_.add(spec, bodies)) return false;
        const bool is_straight = !spec.rest_length.is_zero();
        for (int axis = is_straight ? 3 : 0; axis < (is_straight ? 4 : 3); ++axis) {
            const Evaluate at_rest{bodies, *this, {}, seconds_, Work{}, {}};  // no steps a second: no velocities
            Loaded loaded[features.bodies];
            Stage stage[features.bodies];
            for (int b = 0; b < bodies.count; ++b) {
                stage[b] = stage_of(bodies.state[b]);
                load(loaded[b], b, stage[b], at_rest);
            }
            const int b = springs_.body_beyond(bounds, bodies, loaded, drag_, seconds_, axis);
            if (b < 0) continue;
            bodies.report(Issue::step_too_long, b);
            break;
        }
        return true;
    }
    // Reports a step that is too long for the drag of a body that has been added.
    void check_drag(int b, const BodySpec& spec, const PrincipalInertia& inertia, Bodies& bodies,
                    const StepBounds& bounds) const requires(features.drag) {
        if (!spec.fixed && drag_.is_too_strong(spec, inertia, bodies.rotates(b), bounds.of_damper[1]))
            bodies.report(Issue::step_too_long, b);
    }
    // Calls changed(body) for every force that acts in step `now`.
    template <class F>
    void set_forces(Span<TimedForce<N>> forces, std::uint64_t now, F&& changed) requires(features.forces) {
        forces_.set(forces, now, changed);
    }

    // Call when the world has gone to step `now`.
    void seek(std::uint64_t now) requires(features.forces) { forces_.seek(now); }

    // True of a body that feels anything but gravity in this step.
    [[nodiscard]] bool is_loaded([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b) const {
        return any(*this, [&](const auto& load) { return load.acts_on(bodies, b); });
    }
    // True of a body that feels another moving body.
    [[nodiscard]] bool is_coupled([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b) const {
        return any(*this, [&](const auto& load) {
            if constexpr (requires { load.couples(bodies, b); }) return load.couples(bodies, b);
            else return false;
        });
    }
    // Calls f(other) for every body that a spring or gravitation ties to b.
    template <class F>
    void for_each_coupled([[maybe_unused]] const Bodies& bodies, [[maybe_unused]] int b, [[maybe_unused]] F&& f) const {
        (void)any(*this, [&](const auto& load) {
            if constexpr (requires { load.for_each_coupled(bodies, b, f); }) load.for_each_coupled(bodies, b, f);
            return false;
        });
    }
    // Call before step `now` is taken; calls changed(body) for every timed force that begins or ends at it.
    template <class F>
    void start_step(std::uint64_t now, F&& changed) requires(features.forces) {
        forces_.start_step(now, changed);
    }

    // The loads of one group of bodies, as the methods call them.
    struct Evaluate {
        static constexpr bool may_depend_on_velocity = features.drag || features.springs > 0 ||
                                                       features.springs_touch();

        Bodies& bodies;
        const LoadSet& loads;
        const BodyGroup& group;
        Work seconds, steps_per_second;  // of this portion of a step
        DriftSum fall[3];                // gravity's change of drift in it

        void operator()(const Stage* stages, Kick<N, rotation>* kicks) const {
            loads.evaluate(*this, stages, [&](int k, const WorkVec3<N>& linear, const auto&... angular) {
                bool within = true;
                for (int i = 0; i < 3; ++i)
                    kicks[k].linear[i] = N::limited(fall[i] + N::drift_sum(linear[i], bodies.scale), within);
                if constexpr (rotation) {  // two conditions, because Clang 14 instantiates the body of a combined one
                    if constexpr (sizeof...(angular) > 0)
                        for (int i = 0; i < 3; ++i)
                            kicks[k].angular[i] = N::limited(N::turn_sum((angular[i], ...), bodies.scale), within);
                }
                if (!within) bodies.report(Issue::range_left, group.id[k]);
            });
        }
        // The same in working numbers, whose range is not limited: m and rad.
        void operator()(const Stage* stages, WorkKick<N, rotation>* kicks) const {
            loads.evaluate(*this, stages, [&](int k, const WorkVec3<N>& linear, const auto&... angular) {
                for (int i = 0; i < 3; ++i) kicks[k].linear[i] = linear[i] + N::metres(fall[i], bodies.scale);
                if constexpr (rotation) {
                    if constexpr (sizeof...(angular) > 0) kicks[k].angular = (angular, ...);
                }
            });
        }
        [[nodiscard]] bool depends_on_velocity() const {
            return any(loads, [](const auto& load) {
                if constexpr (requires { load.depends_on_velocity(); }) return load.depends_on_velocity();
                else return false;
            });
        }
    };
    // `length` is the portion's, of a step; `fall` gravity's change of drift in it.
    [[nodiscard]] Evaluate evaluation(Bodies& bodies, const BodyGroup& group, Work length,
                                      const DriftSum (&fall)[3]) const {
        return {bodies,
                *this,
                group,
                seconds_ * length,
                length == Work(1) ? steps_per_second_ : steps_per_second_ / length,
                {fall[0], fall[1], fall[2]}};
    }

private:
    // Calls ask(load) for each load of the scene, in the order of the sum, until it is true.
    template <class Self, class F>
    TUMBLE_INLINE static bool any([[maybe_unused]] Self& loads, [[maybe_unused]] F&& ask) {
        if constexpr (features.drag)
            if (ask(loads.drag_)) return true;
        if constexpr (features.springs > 0)
            if (ask(loads.springs_)) return true;
        if constexpr (features.gravitation)
            if (ask(loads.gravitation_)) return true;
        if constexpr (features.forces)
            if (ask(loads.forces_)) return true;
        if constexpr (features.springs_touch())
            if (ask(loads.contacts_)) return true;
        return false;
    }

    // Calls kick(place in the group, change of drift in m, change of half turn in rad) for each body; without the last
    // for a point mass.
    template <class F>
    void evaluate(const Evaluate& e, const Stage* stages, F&& kick) const {
        Loaded loaded[features.bodies];
        for (int k = 0; k < e.group.count; ++k) load(loaded[k], e.group.id[k], stages[k], e);
        const auto find = [&](int b) -> Loaded* {
            if constexpr (features.bodies == 1) return loaded;
            for (int k = 0; k < e.group.count; ++k)
                if (e.group.id[k] == b) return &loaded[k];
            return nullptr;
        };
        Stage still_stage;  // a fixed body at the other end of a load
        Loaded still;
        const auto other_end = [&](int b) -> Loaded* {
            if constexpr (features.bodies == 1) return find(b);
            if (Loaded* found = find(b)) return found;
            still_stage = stage_of(e.bodies.state[b]);
            load(still, b, still_stage, e);
            return &still;
        };
        const LoadedGroup group{e.group, loaded, e.bodies, find, other_end};
        (void)any(
            *this, [&](const auto& load) __attribute__((always_inline)) {
                load.apply_to(group);
                return false;
            });
        // Force to change of drift: F h^2 / m. The portion's own length enters squared.
        const Work part = e.seconds * e.seconds * steps_per_second_;
        for (int k = 0; k < e.group.count; ++k) {
            const auto& body = e.bodies.constants[e.group.id[k]];
            const auto linear = [&] { return scaled_by(loaded[k].force_w, body.drift_per_impulse * part); };
            if (!loaded[k].rotates()) {
                kick(k, linear());
            } else if constexpr (rotation) {
                WorkVec3<N> angular;
                for (int i = 0; i < 3; ++i) angular[i] = loaded[k].torque_b[i] * (body.units.per_impulse(i) * part);
                kick(k, linear(), angular);
            }
        }
    }

    static void load(Loaded& loaded, [[maybe_unused]] int b, const Stage& stage, const Evaluate& e) {
        loaded.stage = &stage;
        loaded.force_w = zero_vector<N>();
        if constexpr (Evaluate::may_depend_on_velocity)
            for (int i = 0; i < 3; ++i) loaded.v_w[i] = N::metres(stage.d_w[i], e.bodies.scale) * e.steps_per_second;
        if constexpr (features.mixed()) {
            loaded.is_point = !e.bodies.rotates(b);
            if (loaded.is_point) return;
        }
        if constexpr (rotation) {
            loaded.q_wb = work_quaternion<N>(stage.q_wb);
            loaded.torque_b = zero_vector<N>();
            if constexpr (Evaluate::may_depend_on_velocity)
                for (int i = 0; i < 3; ++i)
                    loaded.w_b[i] = N::half_turn(stage.t_b[i], e.bodies.scale) *
                                    e.bodies.constants[b].units.rate(i, e.steps_per_second);
        }
    }

    Work seconds_, steps_per_second_;
    [[no_unique_address]] If<features.drag, Drag<N>, 0> drag_;
    [[no_unique_address]] If<(features.springs > 0), Springs<N, features.springs>, 1> springs_;
    [[no_unique_address]] If<features.gravitation, Gravitation<N, features.bodies>, 2> gravitation_;
    [[no_unique_address]] If<features.forces, TimedForces<N>, 3> forces_;
    [[no_unique_address]] If<features.springs_touch(), ContactSprings<N, spin, features>, 4> contacts_;
};

}  // namespace tumble
