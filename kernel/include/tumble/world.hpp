// World<Scene> owns bodies, loads and contacts in fixed-size arrays. step() advances them by one fixed step with the
// scene's method. It allocates nothing and throws nothing.
//
// The computation depends on what the scene contains (a body without loads has no stages), never on what is compiled
// in. So a minimal firmware and a host with every feature give the same bits.
#pragma once

#include <tumble/advance.hpp>
#include <tumble/body/places.hpp>
#include <tumble/contact/contacts.hpp>
#include <tumble/events/readout.hpp>
#include <tumble/events/script.hpp>
#include <tumble/joints/readout.hpp>
#include <tumble/required.hpp>

namespace tumble {

// Bodies, loads and contacts, with the capacities of the scene type S. A world is a value: a copy goes on with the same
// bits. The arrays of set_impulses(), set_forces() and set_script() and the recording of record() are not copied; both
// worlds point to them.
template <class S>
class World {
    static_assert(detail::IsNumberSystem<typename S::Numbers>,
                  "the scene's Numbers are a number system: tumble::Q32<>, tumble::F32 or tumble::F64");
    using Checked = typename detail::WithNumbers<S>::type;  // the scene

public:
    using Numbers = typename Checked::Numbers;  // the number system
    using Integrator = typename S::Integrator;  // the method
    using N = Numbers;                          // the number system
    using Work = typename N::Work;              // of accessors: Scaled in fixed point, else float or double
    using State = typename tumble::Advance<Checked>::State;  // of a body, as a step keeps it
    static_assert(
        !requires { S::bodies; } && !requires { S::planes; } && !requires { S::springs; },
        "what a scene has room for stands in `static constexpr tumble::Features features{.bodies = ...}`");
    static_assert(S::features.rotation || S::features.point_masses,
                  "without rotation all bodies are point masses: name .point_masses = true beside .rotation = false");
    static_assert(runs_in<Integrator, N>,
                  "the scene's Integrator runs in floating point only: not_in_fixed_point says why");
    static_assert(S::features.friction || !S::features.rolling_resistance,
                  "rolling resistance acts beside friction: name .friction = true too");
    static_assert(Method<Integrator, N>, "the scene's Integrator lacks what integrators/method.hpp asks of a method");
    static constexpr Features features = S::features;  // room, and what can happen
    static_assert(features.bodies >= 0 && features.bodies <= BodyId::most, "room for 32767 bodies at the most");
    static_assert(features.planes >= 0 && features.planes <= BodyId::most, "room for 32767 planes at the most");
    static_assert(features.springs >= 0 && features.springs <= BodyId::most, "room for 32767 springs at the most");
    static_assert(features.near_pairs >= 0 && (!features.contacts() || features.room_for_pairs() <= BodyId::most),
                  "room for 32767 near pairs at the most: name fewer by .near_pairs");
    static_assert(features.exact_steps || features.bounded_steps,
                  "a step is exact or bounded: .exact_steps or .bounded_steps");
    static_assert(features.joints >= 0 && features.joints <= JointId::most, "room for 32767 joints at the most");
    static_assert(!features.has_joints() || features.rotation,
                  "joints tie bodies that rotate: leave out .rotation = false, or .joints");
    static constexpr bool has_contacts = features.contacts();  // the code of contacts by impulses is there
    static constexpr bool has_loads = detail::has_loads<S>;    // the code of loads is there
    static constexpr bool has_step = requires { S::step; };    // the scene has the step, as `static constexpr Seconds`

    // A world without bodies. `step` is the length of every step, positive; a power of two is exact in binary.
    constexpr explicit World(Seconds step, const WorldSpec& spec = {}) requires(!has_step) : World{spec, step} {}
    // The same where the scene has a `step`. Where bodies fly freely, the program then holds what follows from the step
    // as constants.
    constexpr explicit World(const WorldSpec& spec = {}) requires has_step : World{spec, S::step} {}
    // Does not compile, and says why: a number is no duration.
    template <detail::IsPlainNumber Step>
    constexpr explicit World(Step, const WorldSpec& = {}) : World{WorldSpec{}, Seconds{1, 256}} {
        static_assert(!sizeof(Step), "the step is a duration: World{Seconds{1, 256}}, or World{Seconds{0.01}}");
    }
    // Does not compile, and says why: a step beside that of the scene.
    template <std::same_as<Seconds> Step>
    constexpr explicit World(Step step, const WorldSpec& = {}) requires(has_step) : World{WorldSpec{}, step} {
        static_assert(!sizeof(Step), "the scene has a step: World{} or World{spec}, without another");
    }

    // Gravity from the next step on, m/s^2, world frame. Wakes all bodies. With Features::control it is an event: see
    // below.
    constexpr void set_gravity(RealVec3 gravity) requires(!features.control) {
        refuse_to_record();
        set_up_gravity(gravity);
    }

    // Softens the attraction between bodies from the next step on: F = G m1 m2 r / (r^2 + e^2)^(3/2) with the length e,
    // m, not negative. Wakes all bodies.
    constexpr void set_softening(Real length) {
        static_assert(features.gravitation && features.softening,
                      "set_softening() needs .gravitation = true and .softening = true among the scene's features");
        refuse_to_record();
        TUMBLE_ASSERT(!length.is_negative());
        for (int b = 0; b < advance_.bodies.count; ++b) disturb(b);
        advance_.loads.set_softening(length);
    }

    // Adds a body at the first free place; false (and Issue::world_full) when there is no room. Mass and moments must
    // be positive; a point mass has no moments. status() reports a start outside the range.
    constexpr BodyId add(const BodySpec& spec) requires(features.bodies > 0) {
        refuse_to_record();
        int b = advance_.bodies.count;
        if constexpr (features.removal) b = places_.first_free();
        if (b >= features.bodies) {
            advance_.bodies.report(Issue::world_full, b);
            return {};
        }
        if constexpr (features.touches()) TUMBLE_ASSERT(is_restitution(spec.restitution));
        detail::run_once([&] { add_at(b, spec); });
        if constexpr (features.removal) return places_.take(b);
        else return BodyId{b};
    }

    // Adds a plane; false when there is no room. In fixed point its offset is at most four times the range of
    // positions.
    constexpr PlaneId add(const PlaneSpec& spec) requires(features.planes > 0) {
        refuse_to_record();
        TUMBLE_ASSERT(is_restitution(spec.restitution));
        Required::by(spec);
        bool added = true;
        int count = 1;  // where nothing can touch it
        if constexpr (has_contacts) {
            detail::run_once([&] { added = contacts_.add(spec); });
            for (int b = 0; b < advance_.bodies.count; ++b) disturb(b);
        }
        if constexpr (features.springs_touch())
            detail::run_once([&] { added = advance_.loads.add(spec, advance_.bodies) && added; });
        advance_.disturb();
        if constexpr (has_contacts) count = contacts_.plane_count();
        else if constexpr (features.springs_touch()) count = advance_.loads.plane_count();
        if (added) note(spec);
        return added ? PlaneId{count - 1} : PlaneId{};
    }

    // Does not compile, and says why, in a scene without room for planes.
    template <std::same_as<PlaneSpec> Spec>
    constexpr PlaneId add(const Spec&) requires(features.planes <= 0) {
        static_assert(!sizeof(Spec), "a plane needs room: .planes = 1 or more among the scene's features");
        return {};
    }

    // Adds a spring between bodies already added; false when there is no room. status() reports a step that is surely
    // too long for it.
    constexpr SpringId add(const SpringSpec& spec) requires(features.springs > 0) {
        refuse_to_record();
        if constexpr (features.removal)
            TUMBLE_ASSERT(places_.is_taken(spec.body) && (spec.to_body < 0 || places_.is_taken(spec.to_body)));
        bool added = false;
        detail::run_once([&] { added = advance_.add(spec); });
        if (!added) return {};
        note(spec);
        if constexpr (Advance::has_joints)
            if (!std::is_constant_evaluated()) advance_.find_bodies_of_trees([&](int b) { return touches(b); });
        if (has_contacts && advance_.bodies.steps_taken > 0) {
            disturb(spec.body);
            if (spec.to_body >= 0) disturb(spec.to_body);
        }
        return SpringId{advance_.loads.spring_count() - 1};
    }

    // Does not compile, and says why, in a scene without room for springs.
    template <std::same_as<SpringSpec> Spec>
    constexpr SpringId add(const Spec&) requires(features.springs <= 0) {
        static_assert(!sizeof(Spec), "a spring needs room: .springs = 1 or more among the scene's features");
        return {};
    }

    // Adds a joint between bodies already added, or of a body and the world, where they are now: HingeSpec, BallSpec,
    // FixedSpec, SliderSpec, UniversalSpec or DistanceSpec. The id of nothing (and Issue::world_full) where there is no
    // room, or where it closes a loop of joints: fault_of() says which. Other faults are misuse. The next step ends the
    // velocities across the joint, as an impact without restitution would.
    template <JointSpec Spec>
    JointId add(const Spec& spec) requires(features.has_joints()) {
        static_assert(features.distances || !std::is_same_v<Spec, DistanceSpec>,
                      "a rod or a rope needs .distances = true among the scene's features");
        refuse_to_record();
        const JointFault fault = fault_of(spec);
        TUMBLE_ASSERT(fault == JointFault::none || is_refused(fault));
        if (fault != JointFault::none) {
            advance_.bodies.report(Issue::world_full, spec.body);
            return {};
        }
        TUMBLE_ASSERT(features.joint_springs || !detail::spring_of(spec, 0).acts());
        TUMBLE_ASSERT(features.joint_springs || !detail::spring_of(spec, 1).acts());
        TUMBLE_ASSERT(features.joint_breaks ||
                      (detail::break_force_of(spec).is_zero() && detail::break_torque_of(spec).is_zero()));
        TUMBLE_ASSERT(features.joint_limits || !detail::limits_of(spec).acts());
        const int place = advance_.add(spec);
        if constexpr (has_contacts)
            for (const int b : {static_cast<int>(spec.body), static_cast<int>(spec.to_body)})
                if (b >= 0) disturb(b);
        return {place, advance_.joints.generation(place)};
    }
    // Does not compile, and says why, in a scene without room for joints.
    template <JointSpec Spec>
    JointId add(const Spec&) requires(!features.has_joints()) {
        static_assert(!sizeof(Spec), "a joint needs room: .joints = 1 or more among the scene's features");
        return {};
    }
    // Why a joint cannot be added now; `none` where it can.
    template <JointSpec Spec>
    [[nodiscard]] JointFault fault_of(const Spec& spec) const requires(features.has_joints()) {
        const JointFault fault = advance_.joints.fault_of(spec, advance_.bodies, [&](int b) {
            if constexpr (features.removal) return places_.is_taken(b);
            else return b >= 0 && b < advance_.bodies.count;
        });
        if constexpr (features.touches())
            for (const int b : {static_cast<int>(spec.body), static_cast<int>(spec.to_body)})
                if (fault == JointFault::none && advance_.touches_with_coupled(b, [&](int a) { return touches(a); }))
                    return JointFault::in_a_layer;
        return fault;
    }
    // Number of joints in the world.
    [[nodiscard]] int joint_count() const {
        if constexpr (features.has_joints()) return advance_.joints.count();
        else return 0;
    }

    // A load of the scene's own, as it is.
    template <class Load>
    [[nodiscard]] const Load& load() const {
        return advance_.loads.template own<Load>();
    }
    // The same to be changed, before the next step. Wakes all bodies. Call it for every change: a reference that is
    // kept and changed later wakes nobody.
    template <class Load>
    [[nodiscard]] constexpr Load& change_load() {
        refuse_to_record();
        for (int b = 0; b < advance_.bodies.count; ++b) disturb(b);
        return advance_.loads.template own<Load>();
    }

    // Converts an impulse to this world's numbers, for set_impulses().
    [[nodiscard]] constexpr Impulse<N> prepare(const ImpulseSpec& spec) const {
        return tumble::prepare(advance_.bodies, spec);
    }
    // Converts a timed force to this world's numbers, for set_forces().
    [[nodiscard]] constexpr TimedForce<N> prepare(const ForceSpec& spec) const {
        return tumble::prepare(advance_.bodies, spec);
    }
    // Converts an event of a scene to this world's numbers, for set_script().
    [[nodiscard]] constexpr Event<N> prepare(const EventSpec& spec) const {
        return tumble::prepare(advance_.bodies, spec);
    }
    // Sets the impulses for the steps to come, in place of those set before. The array is sorted by step and must
    // outlive their use. Impulses before the next step are skipped. The bodies must have been added.
    constexpr void set_impulses(Span<Impulse<N>> impulses) {
        static_assert(features.impulses, "set_impulses() needs .impulses = true among the scene's features");
        refuse_to_record();
        require_bodies(impulses);
        impulses_.set(impulses, now());
    }
    // Sets the timed forces likewise. A sorted array is faster, but need not be. Wakes the bodies that they act on.
    constexpr void set_forces(Span<TimedForce<N>> forces) {
        static_assert(features.forces, "set_forces() needs .forces = true among the scene's features");
        refuse_to_record();
        require_bodies(forces);
        advance_.disturb();
        advance_.loads.set_forces(forces, now(), [&](int b) { disturb(b); });
    }

    // Sets the script for the steps to come: events of every kind, sorted by step, in an array that outlives their use.
    // Each step first applies its events of the script, as apply() does, then its impulses of set_impulses(). Forces
    // need Features::control.
    constexpr void set_script(Span<Event<N>> events) {
        static_assert(features.script, "set_script() needs .script = true among the scene's features");
        for (const Event<N>& event : events) Required::by(event.kind);
        require_bodies(events);
        script_.set(events, now());
    }
    // Appends every event from now on, live or of the script, to `recording`; null: no longer. The recording is a
    // script that brings a copy of this world to the same state. What no event holds is misuse meanwhile: to add
    // something, to set impulses and forces of a scene, and to set gravity without Features::control.
    void record(Recording<N>* recording) {
        static_assert(features.recording, "record() needs .recording = true among the scene's features");
        recording_ = recording;
    }

    // Applies an event before the next step. Every call below is one event. It wakes the body. A fixed body takes a
    // pose and an angular velocity, a kinematic one velocities too; they ignore the rest. Misuse: of a point mass,
    // anything but a linear event at its centre in the world's frame. Gravity has no body.
    void apply(const Event<N>& event) { apply_event(event); }
    // Applies an impulse (N s, in `frame`) at once, at a point of the body (m, user's body axes). The position does not
    // change.
    void apply_impulse(BodyId id, const InputVector<N>& impulse, const InputVector<N>& point = {},
                       Frame frame = Frame::world) {
        act<EventKind::impulse>(id, frame, impulse, point);
    }
    // Applies an angular impulse (N m s, in `frame`) at once.
    void apply_angular_impulse(BodyId id, const InputVector<N>& impulse, Frame frame) {
        act<EventKind::angular_impulse>(id, frame, impulse);
    }
    // Sets the force (N, in `frame`) that acts from the next step on at a point of the body (m, user's body axes), in
    // place of the force before. In the frame of the body it turns with the body.
    void set_force(BodyId id, const InputVector<N>& force, Frame frame, const InputVector<N>& point = {}) {
        static_assert(features.control, "set_force() needs .control = true among the scene's features");
        act<EventKind::force>(id, frame, force, point);
    }
    // Sets the torque (N m, in `frame`) that acts from the next step on, in place of the torque before.
    void set_torque(BodyId id, const InputVector<N>& torque, Frame frame) {
        static_assert(features.control, "set_torque() needs .control = true among the scene's features");
        act<EventKind::torque>(id, frame, torque);
    }
    // Adds a force for the next step alone.
    void apply_force(BodyId id, const InputVector<N>& force, Frame frame, const InputVector<N>& point = {}) {
        static_assert(features.control, "apply_force() needs .control = true among the scene's features");
        act<EventKind::step_force>(id, frame, force, point);
    }
    // Adds a torque for the next step alone.
    void apply_torque(BodyId id, const InputVector<N>& torque, Frame frame) {
        static_assert(features.control, "apply_torque() needs .control = true among the scene's features");
        act<EventKind::step_torque>(id, frame, torque);
    }
    // Sets the gravity that acts from the next step on, m/s^2, world frame. Wakes all bodies. Islands that stand are
    // solved anew where they stand: one that friction still holds stays at rest. Gravity that is what it was changes
    // nothing.
    void set_gravity(const InputVector<N>& gravity) requires(features.control) { act_on_world(gravity); }
    // Sets the velocity, m/s, in `frame`.
    void set_velocity(BodyId id, const InputVector<N>& velocity, Frame frame = Frame::world) {
        act<EventKind::velocity>(id, frame, velocity);
    }
    // Sets the angular velocity, rad/s, in `frame`.
    void set_angular_velocity(BodyId id, const InputVector<N>& velocity, Frame frame = Frame::body) {
        act<EventKind::angular_velocity>(id, frame, velocity);
    }
    // Sets the position (m, world) and the orientation (user's body axes to world; normalised here; zero is misuse).
    // The velocity stays in the world's axes, the angular velocity in the body's. Wakes all bodies.
    template <class T = Real>
    void set_pose(BodyId id, const InputVector<N>& position, const Quaternion<T>& orientation = {}) {
        act<EventKind::pose>(id, Frame::world, position, {}, orientation.template as<Work>());
    }

    // Removes a body at once. Its joints and springs go with it, and the springs behind them move up; so do its forces,
    // its contacts and what is known of its sleep, and all bodies wake. The place counts in the hash as one without a
    // body. The next body that is added takes the first free place, with another id. The old id is misuse from now on,
    // but an event of a script that names it is skipped. The impulses and forces of a scene name places, not ids: they
    // act on a new body of the place, and on none where it is free.
    void remove(BodyId id) {
        static_assert(features.removal, "remove() needs .removal = true among the scene's features");
        act<EventKind::remove>(id, Frame::world, {});
    }
    // Removes a joint at once. Its bodies go on with the velocities that they have. The next joint that is added takes
    // the first free place, with another id. The old id is misuse from now on; an event of a script that names it is
    // skipped.
    void remove(JointId id) requires(features.has_joints()) {
        static_assert(features.removal, "remove() needs .removal = true among the scene's features");
        act_on_joint<EventKind::remove_joint>(id);
    }
    // Breaks a joint at once, as a load beyond its strength does at the start of the next step. It holds nothing any
    // more, keeps its place and its id until it is removed, and joint() says so.
    void break_joint(JointId id) requires(features.has_joints()) {
        static_assert(features.joint_breaks, "break_joint() needs .joint_breaks = true among the scene's features");
        act_on_joint<EventKind::break_joint>(id);
    }
    // True of a joint that has been added and not been removed. It goes with either of its bodies.
    [[nodiscard]] bool contains(JointId id) const requires(features.has_joints()) {
        return advance_.joints.contains(id);
    }
    // True of a body that has been added and not been removed.
    [[nodiscard]] bool contains(BodyId id) const {
        if constexpr (features.removal) return places_.contains(id);
        else return id && id.index() < advance_.bodies.count && id.generation() == 0;
    }

    // Advances every body by one step: events that are due, loads, motion, contacts. Returns the sticky status.
    Status step() {
        if constexpr (features.script)
            script_.for_each_due(now(), [&](const Event<N>& event) {
                if (has_target(event)) apply(event);
            });
        if constexpr (features.impulses)
            impulses_.for_each_due(now(), [&](const Impulse<N>& impulse) { apply(impulse); });
        if constexpr (features.has_joints() && features.joint_breaks) break_overloaded();
        if constexpr (features.forces && has_loads) advance_.loads.start_step(now(), [&](int b) { disturb(b); });
        remember_all();
        if constexpr (Advance::has_wrenches) advance_.wrenches.start_step(advance_.bodies);
        const StepInfo<N> info{advance_.bodies.scale,
                               N::fixed_point ? Dither::of_step(advance_.bodies.steps_taken) : Dither{}};
        if constexpr (has_contacts) {
            contacts_.step(advance_, info);
        } else if constexpr (has_loads || Advance::has_joints) {
            step_groups(info);
        } else if constexpr (features.bodies == 1) {
            advance_.free_body(0, info);  // a constant index: every address is known
        } else if constexpr (features.bodies > 1) {
            for (int b = 0; b < advance_.bodies.count; ++b) advance_.free_body(b, info);
        }
        if constexpr (Advance::has_wrenches) advance_.wrenches.end_step(advance_.bodies.count);
        ++advance_.bodies.steps_taken;
        if constexpr (has_events)
            if (advance_.bodies.steps_taken == 0) [[unlikely]]
                ++wraps_;
        return advance_.bodies.status;
    }

    // Number of bodies in the world.
    [[nodiscard]] int body_count() const {
        if constexpr (features.removal) return places_.count();
        else return advance_.bodies.count;
    }
    // Number of steps since the start, modulo 2^32. Time is this times the step.
    [[nodiscard]] std::uint32_t steps_taken() const { return advance_.bodies.steps_taken; }
    // The sticky status.
    [[nodiscard]] Status status() const { return advance_.bodies.status; }
    // Clears all bits of the status.
    void clear_status() { advance_.bodies.status = {}; }

    // The body's state in the formats of the step. The accessors below return SI units.
    [[nodiscard]] const State& state(BodyId id) const { return advance_.bodies.state[place_of(id)]; }
    // Position of the centre of mass, m, world frame.
    [[nodiscard]] Vector3<Work> position(BodyId id) const { return plain(advance_.bodies.position(place_of(id))); }
    // m/s, world frame.
    [[nodiscard]] Vector3<Work> velocity(BodyId id) const { return plain(advance_.bodies.velocity(place_of(id))); }
    // rad/s, user's body axes.
    [[nodiscard]] Vector3<Work> angular_velocity(BodyId id) const {
        return plain(advance_.bodies.angular_velocity(place_of(id)));
    }
    // User's body axes to world; of unit length to rounding. Its real part is w, its vector part v.
    [[nodiscard]] Quaternion<Work> orientation(BodyId id) const {
        const auto q = advance_.bodies.orientation(place_of(id));
        return {q.w, plain(q.v)};
    }
    // Position and orientation in the program's own numbers: float, double, Real or Work, or in fixed point Fixed<F>
    // with F below 30, which saturates. Fixed<F> is the fastest in fixed point, then float.
    template <class T>
    [[nodiscard]] Pose<T> pose(BodyId id) const {
        return detail::pose_of<T>(advance_.bodies, place_of(id));
    }
    // Velocity and angular velocity likewise, to 29 bits in fixed point. Faster where Features::control keeps the rate
    // of steps.
    template <class T>
    [[nodiscard]] TUMBLE_INLINE Motion<T> motion(BodyId id) const {
        return detail::motion_of<T>(advance_.bodies, place_of(id), steps_per_second());
    }
    // What an inertial sensor at a point of the body (m, user's body axes) measured in the last step: the means of the
    // specific force and of the angular velocity, in the axes of the middle of the step. Impacts in the step are in
    // them. From add(), from an impulse, a velocity or a pose that is set, and from new gravity, until the next step
    // the sensor measures what it measures in a body at rest.
    template <class T>
    [[nodiscard]] Imu<T> imu(BodyId id, const InputVector<N>& point = {}) const {
        static_assert(features.imu, "imu() needs .imu = true among the scene's features");
        const int b = place_of(id);
        typename N::DriftSum fall[3];
        for (int i = 0; i < 3; ++i) fall[i] = advance_.whole_fall(i);
        return detail::imu_of<T>(advance_.bodies, b, before_[b], fall, point.block(), steps_per_second());
    }

    // How a joint stands and moves, and what it carries, in the program's own numbers: float, double, Real or Work.
    template <class T>
    [[nodiscard]] JointReadout<T> joint(JointId id) const requires(features.has_joints()) {
        TUMBLE_ASSERT(contains(id));
        if constexpr (features.joint_breaks)
            if (!advance_.joints.holds(id.index())) return {.broken = true};
        const tumble::detail::JointReader<N, features, Bodies> reader{advance_.joints, advance_.bodies, id.index(),
                                                                      steps_per_second()};
        return reader.template read<T>();
    }

    // The gravity that acts in the next step, m/s^2, world frame, as the world keeps it.
    [[nodiscard]] Vector3<Work> gravity() const {
        const Work rate = steps_per_second();
        const auto component = [&](int i) {
            return N::metres(advance_.whole_fall(i), advance_.bodies.scale) * rate * rate;
        };
        return {component(0), component(1), component(2)};
    }
    // kg, as the world keeps it.
    [[nodiscard]] Work mass(BodyId id) const {
        return Work(1) / (advance_.bodies.step_per_mass(place_of(id)) * steps_per_second());
    }
    // kg m^2, about the centre of mass, user's axes; zero of a point mass.
    [[nodiscard]] InertiaTensor inertia(BodyId id) const {
        return detail::inertia_of_body(advance_.bodies, place_of(id), steps_per_second());
    }
    // J, of translation and rotation.
    [[nodiscard]] Work kinetic_energy(BodyId id) const {
        return detail::kinetic_energy(advance_.bodies, place_of(id), steps_per_second());
    }
    // J, of gravity, zero at the origin.
    [[nodiscard]] Work potential_energy(BodyId id) const {
        const Vector3<Work> x = position(id);
        const Work rate = steps_per_second();
        Work sum(0);
        for (int i = 0; i < 3; ++i) sum += N::metres(advance_.whole_fall(i), advance_.bodies.scale) * x[i];
        return -(mass(id) * sum * rate * rate);
    }

    // The size of a snapshot as bytes. That of a whole world depends on the pairs that are near each other now.
    [[nodiscard]] int snapshot_size(SnapshotPart part = SnapshotPart::world) const {
        static_assert(features.snapshots, "snapshot_size() needs .snapshots = true among the scene's features");
        detail::SnapshotWriter count;
        write(count, part, 0);
        return count.size() + 4;
    }
    // Writes a snapshot, which restore() takes on any machine; returns its size, or 0 where there is no room for it.
    // The arrays of set_impulses(), set_forces() and set_script(), the recording, and the values of the scene's own
    // loads are not in it. Call set_forces() and change_load() before restore(): after it they drop the kick that the
    // last step has left, and the next step differs in its last bits where springs or drag act. With Features::control
    // a snapshot of a whole world has its gravity; one of bodies alone leaves the gravity of the world that takes it.
    [[nodiscard]] int save(std::uint8_t* to, int room, SnapshotPart part = SnapshotPart::world) const {
        static_assert(features.snapshots, "save() needs .snapshots = true among the scene's features");
        const int size = snapshot_size(part);
        if (size > room) return 0;
        detail::SnapshotWriter bytes{to};
        write(bytes, part, static_cast<std::uint32_t>(size));
        const std::uint32_t check = bytes.check();
        bytes.word(check);
        return size;
    }
    // Takes over a snapshot of a world with the same scene: the same number system, step, world values, and the same
    // bodies, planes and springs, added in the same order and removed at the same places between; of a whole world also
    // the same features and method, and without Features::control the same gravity. It may be followed by other bytes.
    // Where it says why not, the world is as before. Of bodies alone it sets their states and the number of steps: all
    // wake, and contacts are found anew.
    [[nodiscard]] SnapshotFault restore(const std::uint8_t* from, int count) {
        static_assert(features.snapshots, "restore() needs .snapshots = true among the scene's features");
        const SnapshotFault fault = detail::SnapshotHeader::fault_of(from, count, detail::digest_of_numbers<N>());
        if (fault != SnapshotFault::none) return fault;
        const auto header = detail::SnapshotHeader::read(from);
        if (header.scene != scene_digest(header.part) ||
            (header.part == SnapshotPart::world && header.spin != Advance::spin))
            return SnapshotFault::other_scene;
        const std::uint8_t* const state = from + detail::SnapshotHeader::bytes;
        const int size = static_cast<int>(header.size) - detail::SnapshotHeader::bytes - 4;
        detail::SnapshotWriter held{state, size};
        archive(std::as_const(*this), held, header.part, header.spin);
        if (held.fault() != SnapshotFault::none) return held.fault();
        detail::SnapshotReader reader{state, size};
        archive(*this, reader, header.part, header.spin);
        if constexpr (has_events) select();
        if (header.part == SnapshotPart::world) return SnapshotFault::none;
        for (int b = 0; b < advance_.bodies.count; ++b) {
            if (header.spin != Advance::spin) advance_.check_range(b);
            advance_.spin_changed(b);
            if constexpr (has_imu) remember(b);
            replaced(b);
            disturb(b);
        }
        if constexpr (has_contacts) contacts_.forget_last_step(advance_.bodies);
        return SnapshotFault::none;
    }

    // Digest of every body's state.
    [[nodiscard]] std::uint64_t hash() const { return advance_.bodies.hash(); }

    // The bodies, for readers that need more digits than working numbers have.
    using Bodies = typename tumble::Advance<Checked>::Bodies;
    // The bodies as they are stored.
    [[nodiscard]] constexpr const Bodies& bodies() const { return advance_.bodies; }

    // True where the body sleeps: it rests at no cost until something touches or pushes it.
    [[nodiscard]] bool asleep([[maybe_unused]] BodyId id) const {
        if constexpr (has_contacts) return contacts_.is_asleep(place_of(id));
        else return false;
    }
    // The largest safe step for contacts by springs, s; zero where they do not limit the step.
    [[nodiscard]] Real largest_safe_step() const {
        if constexpr (features.springs_touch()) return advance_.loads.largest_safe_step();
        else return {};
    }
    // Number of near pairs, of a body and a plane or of two bodies. Features::near_pairs is the room for them.
    [[nodiscard]] int near_pair_count() const {
        if constexpr (has_contacts) return contacts_.pair_count();
        else return 0;
    }
    // The most near pairs that there have been at one time, also within a step. A world with the same history needs
    // this room, and one with less is `contacts_full`.
    [[nodiscard]] int most_near_pairs() const {
        if constexpr (has_contacts) return contacts_.most_pairs();
        else return 0;
    }
    // The distance within which bodies touch, m: the scene's tolerance, or the least that the number system resolves
    // beside the largest body. Zero without contacts by impulses.
    [[nodiscard]] Work contact_tolerance() const {
        if constexpr (has_contacts) return contacts_.tolerance();
        else return Work(0);
    }
    // True of a body that the last step moved in bounded time, with many others. A body that stood did not move.
    [[nodiscard]] bool stepped_bounded([[maybe_unused]] BodyId id) const {
        if constexpr (has_contacts) return contacts_.stepped_bounded(advance_.bodies, place_of(id));
        else return false;
    }
    // The deepest overlap of bodies that the last step moved in bounded time, m; zero where there is none. Its cost
    // grows with the near pairs.
    [[nodiscard]] Work deepest_overlap() const {
        if constexpr (has_contacts) return contacts_.deepest_overlap(advance_.bodies);
        else return Work(0);
    }
    // Number of points that held the body in the last step; 0 of a fixed body.
    [[nodiscard]] int contact_count(BodyId id) const {
        if constexpr (has_contacts) return contacts_.points_of(place_of(id));
        else return 0;
    }
    // What the body touches at the end of the last step, or touched in it or before it: a range of Contact, for a loop.
    // It reads the world, so it is valid until the next step or call that changes something.
    [[nodiscard]] ContactRange<World> contacts(BodyId id) const {
        static_assert(features.contact_readout, "contacts() needs .contact_readout = true among the scene's features");
        static_assert(has_contacts, "contacts() needs contacts by impulses: .planes or .pairs, and .contact_impulses");
        return {*this, place_of(id)};
    }

private:
    constexpr World(const WorldSpec& spec, Seconds step) : advance_{step, spec}, contacts_{step.value, spec.contact} {
        if constexpr (features.touches()) TUMBLE_ASSERT(is_valid(spec.contact));
        Required::by(spec);
        set_up_gravity(spec.gravity);
        if constexpr (features.snapshots) digest_.add(step.value);
        note(spec);
    }

    using Required = tumble::detail::Required<features>;
    using Advance = tumble::Advance<Checked>;
    using BodyGroup = typename Advance::BodyGroup;
    using Contacts = tumble::Contacts<N, Integrator::spin, features>;
    static constexpr bool has_events = features.impulses || features.forces || features.script || features.recording;
    static constexpr bool has_imu = features.imu && features.bodies > 0;
    using Before = detail::MotionBefore<State>;
    friend class ContactRange<World>;

    // For ContactRange.
    [[nodiscard]] int logged_count() const { return contacts_.logged_count(); }
    [[nodiscard]] bool is_logged(int i, int b) const { return contacts_.is_logged(i, b); }
    [[nodiscard]] Contact<Work> logged(int i, int b) const {
        return contacts_.logged(i, b, advance_.bodies, steps_per_second(), [&](int place) {
            if constexpr (features.removal) return places_.id_of(place);
            else return BodyId{place};
        });
    }

    // Sets up a body at a place, which is free.
    TUMBLE_COLD constexpr void add_at(int b, const BodySpec& spec) requires(features.bodies > 0) {
        Required::by(spec);
        const PrincipalInertia inertia = features.rotation ? principal_inertia(spec.inertia) : PrincipalInertia{};
        advance_.add(spec, inertia, b);
        note(spec);
        if constexpr (has_imu) remember(b);
        if constexpr (has_contacts) {
            if constexpr (features.layers)
                contacts_.add(b, as_it_touches(spec), inertia, advance_.bodies.constants[b].units);
            else contacts_.add(b, spec, inertia, advance_.bodies.constants[b].units);
            if constexpr (features.moving_surfaces())
                if (advance_.bodies.moves_by_itself(b)) contacts_.note_surface(advance_.bodies, b, {}, 0);
            // Before the first step no body has a time to contact, and none sleeps.
            if (advance_.bodies.steps_taken > 0)
                for (int other = 0; other < advance_.bodies.count; ++other) disturb(other);
        }
    }

    [[nodiscard]] static Vector3<Work> plain(const WorkVec3<N>& v) { return {v.x(), v.y(), v.z()}; }
    [[nodiscard]] Work steps_per_second() const {
        if constexpr (Advance::has_wrenches) return advance_.wrenches.steps_per_second;
        else return advance_.bodies.steps_per_second();
    }
    [[nodiscard]] Work seconds() const {
        if constexpr (Advance::has_wrenches) return advance_.wrenches.seconds;
        else return N::template constant<Work>(advance_.bodies.step_length);
    }
    // Keeps the motion of a body, for imu().
    constexpr void remember(int b) requires has_imu {
        before_[b].d_w = advance_.bodies.state[b].d_w;
        if constexpr (features.rotation) {
            before_[b].t_b = advance_.bodies.state[b].t_b;
            before_[b].halvings = static_cast<std::int8_t>(advance_.bodies.halvings_of(b));
        }
    }

    [[nodiscard]] TUMBLE_INLINE int place_of(BodyId id) const {
        if constexpr (features.removal) TUMBLE_ASSERT(places_.contains(id));
        return advance_.bodies.index_of(id);
    }
    // The next step's number, which does not wrap; events count so.
    [[nodiscard]] TUMBLE_INLINE constexpr std::uint64_t now() const requires has_events {
        return std::uint64_t{wraps_} << 32 | advance_.bodies.steps_taken;
    }

    // What a recording does not hold is misuse while the world records.
    constexpr void refuse_to_record() const {
        if constexpr (features.recording) TUMBLE_ASSERT(recording_ == nullptr);
    }
    // An event of a body that has not been added is misuse.
    template <class Timed>
    constexpr void require_bodies(Span<Timed> events) const {
        for (const Timed& event : events)
            if (!is_of_world(event) && !is_of_joint(event)) (void)advance_.bodies.index_of(event.body);
    }
    // True of an event of a joint.
    template <class Timed>
    [[nodiscard]] static constexpr bool is_of_joint([[maybe_unused]] const Timed& event) {
        if constexpr (features.has_joints() && requires { event.kind; }) return has_joint(event.kind);
        else return false;
    }
    // True of an event that has no body. Without Features::control there is none.
    template <class Timed>
    [[nodiscard]] static constexpr bool is_of_world([[maybe_unused]] const Timed& event) {
        if constexpr (features.control && requires { event.kind; }) return event.kind == EventKind::gravity;
        else return false;
    }
    // False of an event whose body has been removed.
    [[nodiscard]] bool has_target(const Event<N>& event) const {
        if constexpr (features.has_joints())
            if (is_of_joint(event)) return contains(event.joint());
        return is_of_world(event) || contains(event.body);
    }
    void apply_event(const Event<N>& e) {
        switch (e.kind) {
        case EventKind::impulse: return act<EventKind::impulse>(e.body, e.frame, e.value, e.point);
        case EventKind::angular_impulse: return act<EventKind::angular_impulse>(e.body, e.frame, e.value);
        case EventKind::force: return act<EventKind::force>(e.body, e.frame, e.value, e.point);
        case EventKind::torque: return act<EventKind::torque>(e.body, e.frame, e.value);
        case EventKind::step_force: return act<EventKind::step_force>(e.body, e.frame, e.value, e.point);
        case EventKind::step_torque: return act<EventKind::step_torque>(e.body, e.frame, e.value);
        case EventKind::velocity: return act<EventKind::velocity>(e.body, e.frame, e.value);
        case EventKind::angular_velocity: return act<EventKind::angular_velocity>(e.body, e.frame, e.value);
        case EventKind::pose: return act<EventKind::pose>(e.body, e.frame, e.value, {}, e.orientation);
        case EventKind::remove: return act<EventKind::remove>(e.body, e.frame, {});
        case EventKind::gravity:
            TUMBLE_ASSERT(features.control && e.frame == Frame::world);
            if constexpr (features.control) act_on_world(e.value);
            return;
        case EventKind::break_joint:
        case EventKind::remove_joint:
            Required::by(e.kind);
            if constexpr (features.has_joints()) {
                if (e.kind == EventKind::remove_joint) act_on_joint<EventKind::remove_joint>(e.joint());
                else act_on_joint<EventKind::break_joint>(e.joint());
            }
            return;
        }
    }
    // An event of a joint.
    template <EventKind kind>
    void act_on_joint(JointId id) requires(features.has_joints()) {
        Required::by(kind);
        TUMBLE_ASSERT(contains(id));
        if constexpr (features.recording)
            if (recording_ != nullptr) recording_->append(Event<N>::of_joint(kind, id), now());
        const auto& record = advance_.joints.record(id.index());
        const int sides[] = {record.side[0].body, record.side[1].body};
        if constexpr (kind == EventKind::remove_joint) advance_.remove_joint(id.index());
        else if constexpr (features.joint_breaks) advance_.break_joint(id.index());
        if constexpr (has_contacts)
            for (const int b : sides)
                if (b >= 0) disturb(b);
    }
    // Breaks the joints that the end of the last step has loaded beyond their strength. An event that changes
    // velocities does not count: it is shared by the tree without time.
    void break_overloaded() requires(features.joint_breaks) {
        bool is_overloaded[features.joints];
        for (int j = 0; j < features.joints; ++j) {
            is_overloaded[j] = false;
            const auto& strength = advance_.joints.strength(j);
            if (!advance_.joints.holds(j) || !strength.has_limits()) continue;
            WorkVec3<N> force, torque;
            tumble::detail::JointReader<N, features, Bodies>{advance_.joints, advance_.bodies, j, steps_per_second()}
                .load(force, torque);
            const auto exceeds = [](const WorkVec3<N>& load, Work limit) {
                return limit > Work(0) && Work(dot(load, load)) > limit * limit;
            };
            is_overloaded[j] = exceeds(force, strength.force) || exceeds(torque, strength.torque);
        }
        for (int j = 0; j < features.joints; ++j)
            if (is_overloaded[j]) act_on_joint<EventKind::break_joint>({j, advance_.joints.generation(j)});
    }
    // The event without a body.
    void act_on_world(const InputVector<N>& gravity) requires(features.control) {
        if constexpr (features.recording)
            if (recording_ != nullptr)
                recording_->append({EventKind::gravity, Frame::world, {}, gravity, {}, {}}, now());
        if constexpr (Advance::has_wrenches) {
            if (!advance_.set_gravity(gravity.block())) return;
            if constexpr (has_contacts) {
                tell_gravity();
                contacts_.gravity_changed(advance_);
            }
            remember_all();
        }
    }
    constexpr void set_up_gravity(const RealVec3& gravity) {
        advance_.set_gravity(gravity);
        if constexpr (has_contacts) {
            tell_gravity();
            for (int b = 0; b < advance_.bodies.count; ++b) disturb(b);
        }
        remember_all();
    }
    // Contacts have gravity in their own numbers.
    constexpr void tell_gravity() requires has_contacts {
        contacts_.set_gravity({advance_.whole_fall(0), advance_.whole_fall(1), advance_.whole_fall(2)},
                              advance_.bodies.scale);
    }
    constexpr void remember_all() {
        if constexpr (has_imu)
            for (int b = 0; b < features.bodies && b < advance_.bodies.count; ++b) remember(b);
    }
    // One event. The kind is known when the program is compiled, so that a call costs what its kind needs.
    template <EventKind kind>
    void act(BodyId id, [[maybe_unused]] Frame frame, [[maybe_unused]] const InputVector<N>& value,
             [[maybe_unused]] const InputVector<N>& point = {},
             [[maybe_unused]] const Quaternion<Work>& orientation = {}) {
        using Kind = EventKind;
        auto& bodies = advance_.bodies;
        const int b = place_of(id);
        constexpr bool moves_surfaces =
            has_contacts && features.moving_surfaces() && (kind == Kind::velocity || kind == Kind::angular_velocity);
        [[maybe_unused]] If<moves_surfaces, typename Advance::State, 0> before;
        [[maybe_unused]] const int halvings = bodies.halvings_of(b);
        if constexpr (moves_surfaces) before = bodies.state[b];
        if constexpr (features.recording)
            if (recording_ != nullptr) recording_->append({kind, frame, id, value, point, orientation}, now());
        if constexpr (kind == Kind::force || kind == Kind::torque || kind == Kind::step_force ||
                      kind == Kind::step_torque) {
            Required::by(kind);
            if (bodies.constants[b].fixed()) return;
            if constexpr (Advance::has_wrenches) {
                constexpr bool angular = kind == Kind::torque || kind == Kind::step_torque;
                if constexpr (kind == Kind::force || kind == Kind::torque)
                    advance_.wrenches.template set<angular>(bodies, b, frame, value.block(), point.block());
                else advance_.wrenches.template add<angular>(bodies, b, frame, value.block(), point.block());
            }
            return disturb(b);
        } else if constexpr (kind == Kind::remove) {
            Required::by(kind);
            if constexpr (features.removal) take_away(b);
            return;
        } else if constexpr (kind == Kind::impulse || kind == Kind::angular_impulse) {
            if (bodies.constants[b].fixed()) return;
            constexpr bool angular = kind == Kind::angular_impulse;
            const bool opposite = value.block().is_negative();
            detail::Push<N> push;
            detail::take_push<N, angular>(push, bodies, b, frame, opposite ? -value.block() : value.block(),
                                          point.block());
            detail::apply_push<N, angular>(bodies, b, push, opposite);
        } else if constexpr (kind == Kind::velocity) {
            detail::set_velocity(bodies, b, frame, value.block(), seconds());
        } else if constexpr (kind == Kind::angular_velocity) {
            if (bodies.constants[b].fixed() && !bodies.constants[b].kinematic() && !features.turntables) return;
            detail::set_angular_velocity(bodies, b, frame, value.block(), steps_per_second());
            // Joints tie to what does not move by itself.
            if constexpr (Advance::has_joints && features.turntables)
                TUMBLE_ASSERT(!advance_.joints.has_base(b) || !bodies.is_turning(b));
        } else {
            detail::set_pose(bodies, b, value.block(), orientation);
        }
        if (kind == Kind::pose || (bodies.constants[b].fixed() && !bodies.constants[b].kinematic())) replaced(b);
        has_changed(b);
        if constexpr (moves_surfaces) contacts_.note_surface(bodies, b, before, halvings);
    }
    // The motion or the pose of a body is another.
    void has_changed(int b) {
        advance_.check_range(b);
        advance_.spin_changed(b);
        if constexpr (has_imu) remember(b);
        if constexpr (Advance::has_joints) advance_.joints.velocity_changed(b);
        disturb(b);
    }
    void apply(const Impulse<N>& event) {
        const int b = advance_.bodies.index_of(event.body);
        if (!advance_.bodies.constants[b].fixed()) detail::apply_impulse(advance_.bodies, event);
        has_changed(b);
    }
    // Notes what is constant, for snapshots.
    constexpr void note([[maybe_unused]] const auto& spec) {
        if constexpr (features.snapshots) tumble::detail::add_to(digest_, spec);
    }
    [[nodiscard]] std::uint64_t scene_digest(SnapshotPart part) const requires(features.snapshots) {
        detail::Digest digest = digest_;
        if constexpr (features.gravitation && features.softening)
            if (advance_.loads.softening() > Work(0)) digest.add_number(advance_.loads.softening());
        if (part == SnapshotPart::bodies) return digest.value();
        digest.add(Integrator::name);
        Features::for_each([&](const char*, auto member) { digest.add(static_cast<int>(features.*member)); });
        if constexpr (tumble::detail::OwnLoads<S>::List::count > 0) {
            digest.add(tumble::detail::OwnLoads<S>::List::count);
            advance_.loads.add_own_to(digest);
        }
        advance_.add_to(digest);
        return digest.value();
    }
    void write(detail::SnapshotWriter& to, SnapshotPart part, std::uint32_t size) const requires(features.snapshots) {
        detail::SnapshotHeader{part, Advance::spin, detail::digest_of_numbers<N>(), scene_digest(part), size}.write(to);
        archive(*this, to, part, Advance::spin);
    }
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to, SnapshotPart part, Spin spin) requires(features.snapshots) {
        auto& bodies = self.advance_.bodies;
        to(bodies.steps_taken);
        for (int b = 0; b < bodies.count; ++b) {
            if constexpr (features.removal)
                if (!self.places_.is_taken(b)) continue;
            Bodies::archive(bodies, b, to, spin);
        }
        if (part == SnapshotPart::bodies) return;
        Advance::archive(self.advance_, to);
        if constexpr (Archive::reads && has_contacts && Advance::has_wrenches) self.tell_gravity();
        auto& status = bodies.status;
        to(status.first_step, status.count, status.first_body, status.bits);
        if constexpr (has_contacts) { Contacts::archive(self.contacts_, bodies, to); }
        if constexpr (has_imu)
            for (int b = 0; b < bodies.count; ++b) {
                to(self.before_[b]);
                int most_halvings = 0;
                if constexpr (Bodies::has_parts) most_halvings = bodies.scale.most_halvings;
                if constexpr (features.rotation) (void)to.within(self.before_[b].halvings, 0, most_halvings);
            }
        if constexpr (has_events) to(self.wraps_);
    }
    // Call when the world has gone to another step.
    void select() requires has_events {
        if constexpr (features.impulses) impulses_.seek(now());
        if constexpr (features.script) script_.seek(now());
        if constexpr (features.forces && has_loads) advance_.loads.seek(now());
    }
    [[gnu::noinline]] void take_away(int b) requires(features.removal) {
        disturb(b);
        replaced(b);
        if constexpr (has_contacts) {
            BodySpec nobody;
            detail::run_once([&] { contacts_.remove(b, nobody, {{1, 1, 1}, {}}, advance_.bodies.constants[b].units); });
        }
        advance_.remove(b);
        places_.leave(b);
        if constexpr (features.snapshots) digest_.add(b);
    }
    // Call after body b got another pose, or a fixed body another spin: its pairs are found anew, and every body wakes,
    // since b may have left it or come to it.
    void replaced([[maybe_unused]] int b) {
        if constexpr (has_contacts) {
            for (int other = 0; other < advance_.bodies.count; ++other) contacts_.wake(advance_, other);
            contacts_.forget_pairs_of(advance_.bodies, b);
        }
        if constexpr (Advance::has_joints) advance_.joints.pose_changed(b);
    }
    // Call after a change of the motion of body b, or of what acts on it. Drops the kicks that were kept, ends the
    // bounds on the time to contact of the body and of all that it may push, and wakes it.
    constexpr void disturb([[maybe_unused]] int b) {
        advance_.disturb();
        if constexpr (has_contacts) { contacts_.disturb(advance_, b); }
    }

    // Whether planes and bodies do not pass through body b.
    [[nodiscard]] bool touches([[maybe_unused]] int b) const {
        if constexpr (has_contacts)
            if (contacts_.touches(b)) return true;
        if constexpr (features.springs_touch()) return advance_.loads.touches(b);
        else return false;
    }
    // One step of a world with loads or joints. Bodies that loads couple advance together, those of a tree too, the
    // others one by one.
    void step_groups(const StepInfo<N>& info) {
        BodyGroup coupled;
        typename Advance::Kinematics kinematic;
        advance_.begin(kinematic, info);
        if constexpr (Advance::has_joints) advance_.find_bodies_of_trees([&](int b) { return touches(b); });
        for (int b = 0; b < advance_.bodies.count; ++b) {
            if (advance_.bodies.constants[b].fixed()) advance_.step_turntable(b, info);
            else if (advance_.steps_with_trees(b)) continue;
            else if (advance_.is_coupled(b)) coupled.add(b);
            else if constexpr (has_loads) advance_.alone(b, info);
            else advance_.free_body(b, info);
        }
        if constexpr (Advance::has_joints) advance_.step_trees(info);
        if constexpr (has_loads)
            if (coupled.count > 0) advance_.group(coupled, info);
        advance_.end(kinematic, info);
    }

    [[no_unique_address]] Advance advance_;
    [[no_unique_address]] If<has_contacts, Contacts, 1> contacts_;
    [[no_unique_address]] If<features.impulses, Script<Impulse<N>>, 2> impulses_{};
    [[no_unique_address]] If<features.script, Script<Event<N>>, 3> script_{};
    [[no_unique_address]] If<features.recording, Recording<N>*, 8> recording_{};
    [[no_unique_address]] If<features.snapshots, tumble::detail::Digest, 10> digest_{};
    [[no_unique_address]] If<features.removal, Places<(features.bodies > 0 ? features.bodies : 1)>, 9> places_{};
    [[no_unique_address]] If<has_imu, typename tumble::detail::RoomFor<Before, features.bodies>::Array, 7> before_{};
    [[no_unique_address]] If<has_events, std::uint32_t, 5> wraps_{};  // how often the number of steps began anew
};

}  // namespace tumble
