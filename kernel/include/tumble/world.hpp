// World<Scene> owns bodies, loads and contacts in fixed-size arrays. step() advances them by one fixed step with the
// scene's method. It allocates nothing and throws nothing.
//
// The computation depends on what the scene contains (a body without loads has no stages), never on what is compiled
// in. So a minimal firmware and a host with every feature give the same bits.
#pragma once

#include <tumble/world/world_snapshots.hpp>

namespace tumble {

// Bodies, loads and contacts, with the capacities of the scene type S. A world is a value: a copy goes on with the same
// bits. The array of set_script() and the recording of record() are not copied; both worlds point to them.
template <class S>
class World : WorldSnapshots<S> {
    using Base = WorldSnapshots<S>;
    using Base::advance_, Base::contacts_, Base::script_, Base::recording_, Base::places_, Base::before_, Base::wraps_,
        Base::has_events;
    using Base::disturb, Base::refuse_to_record, Base::require_bodies, Base::has_target, Base::now, Base::place_of,
        Base::plain, Base::steps_per_second;
    using typename Base::Advance, typename Base::Required;

public:
    using N = typename Base::N;                        // the number system
    using Numbers = N;                                 // the number system
    using Integrator = typename S::Integrator;         // the method
    using Work = typename N::Work;                     // of accessors: Scaled in fixed point, else float or double
    using State = typename Advance::State;             // of a body, as a step keeps it
    static constexpr Features features = S::features;  // room, and what can happen
    static constexpr bool has_contacts = features.contacts();  // the code of contacts by impulses is there
    static constexpr bool has_loads = detail::has_loads<S>;    // the code of loads is there
    static constexpr bool has_step = requires { S::step; };    // the scene has the step, as `static constexpr Seconds`

    // A world without bodies. `step` is the length of every step, positive; a power of two is exact in binary.
    constexpr explicit World(Seconds step, const WorldSpec& spec = {}) requires(!has_step) : Base{spec, step} {}
    // The same where the scene has a `step`. Where bodies fly freely, the program then holds what follows from the step
    // as constants.
    constexpr explicit World(const WorldSpec& spec = {}) requires has_step : Base{spec, S::step} {}
    // Does not compile, and says why: a number is no duration.
    template <detail::IsPlainNumber Step>
    constexpr explicit World(Step, const WorldSpec& = {}) : Base{WorldSpec{}, Seconds{1, 256}} {
        static_assert(!sizeof(Step), "the step is a duration: World{Seconds{1, 256}}, or World{Seconds{0.01}}");
    }
    // Does not compile, and says why: a step beside that of the scene.
    template <std::same_as<Seconds> Step>
    constexpr explicit World(Step step, const WorldSpec& = {}) requires(has_step) : Base{WorldSpec{}, step} {
        static_assert(!sizeof(Step), "the scene has a step: World{} or World{spec}, without another");
    }

    // Gravity from the next step on, m/s^2, world frame. Wakes all bodies. With Features::control it is an event: see
    // below.
    constexpr void set_gravity(RealVec3 gravity) requires(!features.control) {
        refuse_to_record();
        Base::set_up_gravity(gravity);
    }

    // Softens the attraction between bodies from the next step on: F = G m1 m2 r / (r^2 + e^2)^(3/2) with the length e,
    // m, not negative. Wakes all bodies.
    constexpr void set_softening(Real length) {
        static_assert(features.gravitation && features.softening,
                      "set_softening() needs .gravitation = true and .softening = true among the scene's features");
        refuse_to_record();
        TUMBLE_ASSERT(!length.is_negative());
        for (int b = 0; b < advance_.bodies.count; ++b) disturb(b);
        advance_.loads.gravitation().set_softening(length);
    }

    // Adds a body at the first free place; false (and Issue::world_full) when there is no room. Mass and moments must
    // be positive; a point mass has no moments. status() reports a start outside the range.
    constexpr BodyId add(const BodySpec& spec) requires(features.bodies > 0) { return Base::add(spec); }
    // Adds a plane; false when there is no room. In fixed point its offset is at most four times the range of
    // positions.
    constexpr PlaneId add(const PlaneSpec& spec) requires(features.planes > 0) { return Base::add(spec); }
    // Adds a spring between bodies already added; false when there is no room. status() reports a step that is surely
    // too long for it.
    constexpr SpringId add(const SpringSpec& spec) requires(features.springs > 0) { return Base::add(spec); }
    // Adds a joint between bodies already added, or of a body and the world, where they are now: HingeSpec, BallSpec,
    // FixedSpec, SliderSpec, UniversalSpec or DistanceSpec. The id of nothing (and Issue::world_full) where there is no
    // room, or where it closes a loop of joints: fault_of() says which. Other faults are misuse. The next step ends the
    // velocities across the joint, as an impact without restitution would.
    template <JointSpec Spec>
    constexpr JointId add(const Spec& spec) requires(features.has_joints()) {
        static_assert(features.*JointKinds::Of<Spec>::feature,
                      "a joint needs its kind among the scene's features: .hinges, .balls, .fixed_joints, .sliders, "
                      ".universals, or .distances for rods and ropes, = true");
        return Base::add(spec);
    }
    // Does not compile, and says why, in a scene without room for a plane, a spring or a joint.
    template <class Spec>
    constexpr PlaneId add(const Spec&) requires(std::same_as<Spec, PlaneSpec> || std::same_as<Spec, SpringSpec> ||
                                                (JointSpec<Spec> && !features.has_joints())) {
        static_assert(!std::same_as<Spec, PlaneSpec>,
                      "a plane needs room: .planes = 1 or more among the scene's features");
        static_assert(!std::same_as<Spec, SpringSpec>,
                      "a spring needs room: .springs = 1 or more among the scene's features");
        static_assert(!JointSpec<Spec>, "a joint needs room: .joints = 1 or more among the scene's features");
        return {};
    }
    // Why a joint cannot be added now; `none` where it can.
    template <JointSpec Spec>
    [[nodiscard]] constexpr JointFault fault_of(const Spec& spec) const requires(features.has_joints()) {
        return Base::fault_of(spec);
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

    // Converts an event of a scene to this world's numbers, for set_script().
    [[nodiscard]] constexpr Event<N> prepare(const EventSpec& spec) const {
        return tumble::prepare(advance_.bodies, spec);
    }
    // Sets the script for the steps to come, in place of the one before: events of every kind, sorted by step, in an
    // array that outlives their use. Each step first applies its events, as apply() does. Events before the next step
    // are skipped. Where there are any, the forces act that they have begun and not ended, in place of all others that
    // have begun; else those go on. The bodies must have been added. With Features::impulses or Features::forces in
    // place of Features::script, it has events of these kinds alone.
    constexpr void set_script(Span<Event<N>> events) {
        static_assert(
            features.has_script(),
            "set_script() needs .script = true, .impulses = true or .forces = true among the scene's features");
        for (const Event<N>& event : events) {
            TUMBLE_ASSERT(Required::may_script(event.kind));
            Required::by(event.kind);
        }
        require_bodies(events);
        script_.set(events, now());
        if constexpr (features.forces)
            if (script_.has_passed()) {
                Base::begin_forces_again();
                for (int b = 0; b < advance_.bodies.count; ++b) Base::disturb(b);
            }
    }
    // Appends every event from now on, live or of the script, to `recording`; null: no longer. The recording is a
    // script that brings a copy of this world to the same state. What no event holds is misuse meanwhile: to add
    // something, and to set gravity without Features::control.
    void record(Recording<N>* recording) {
        static_assert(features.recording, "record() needs .recording = true among the scene's features");
        recording_ = recording;
    }

    // Applies an event before the next step. Every call below is one event. It wakes the body. A fixed body takes a
    // pose and an angular velocity, a kinematic one velocities too; they ignore the rest. Misuse: of a point mass,
    // anything but a linear event at its centre in the world's frame. Gravity has no body.
    void apply(const Event<N>& event) { Base::apply(event); }
    // Applies an impulse (N s, in `frame`) at once, at a point of the body (m, user's body axes). The position does not
    // change.
    void apply_impulse(BodyId id, const InputVector<N>& impulse, const InputVector<N>& point = {},
                       Frame frame = Frame::world) {
        Base::template act<EventKind::impulse>(id, frame, impulse, point);
    }
    // Applies an angular impulse (N m s, in `frame`) at once.
    void apply_angular_impulse(BodyId id, const InputVector<N>& impulse, Frame frame) {
        Base::template act<EventKind::angular_impulse>(id, frame, impulse);
    }
    // Sets the force (N, in `frame`) that acts from the next step on at a point of the body (m, user's body axes), in
    // place of the force before. In the frame of the body it turns with the body.
    void set_force(BodyId id, const InputVector<N>& force, Frame frame, const InputVector<N>& point = {}) {
        static_assert(features.control, "set_force() needs .control = true among the scene's features");
        Base::template act<EventKind::force>(id, frame, force, point);
    }
    // Sets the torque (N m, in `frame`) that acts from the next step on, in place of the torque before.
    void set_torque(BodyId id, const InputVector<N>& torque, Frame frame) {
        static_assert(features.control, "set_torque() needs .control = true among the scene's features");
        Base::template act<EventKind::torque>(id, frame, torque);
    }
    // Adds a force for the next step alone.
    void apply_force(BodyId id, const InputVector<N>& force, Frame frame, const InputVector<N>& point = {}) {
        static_assert(features.control, "apply_force() needs .control = true among the scene's features");
        Base::template act<EventKind::step_force>(id, frame, force, point);
    }
    // Adds a torque for the next step alone.
    void apply_torque(BodyId id, const InputVector<N>& torque, Frame frame) {
        static_assert(features.control, "apply_torque() needs .control = true among the scene's features");
        Base::template act<EventKind::step_torque>(id, frame, torque);
    }
    // Sets the gravity that acts from the next step on, m/s^2, world frame. Wakes all bodies. Islands that stand are
    // solved anew where they stand: one that friction still holds stays at rest. Gravity that is what it was changes
    // nothing.
    void set_gravity(const InputVector<N>& gravity) requires(features.control) { Base::act_on_world(gravity); }
    // Sets the velocity, m/s, in `frame`.
    void set_velocity(BodyId id, const InputVector<N>& velocity, Frame frame = Frame::world) {
        Base::template act<EventKind::velocity>(id, frame, velocity);
    }
    // Sets the angular velocity, rad/s, in `frame`.
    void set_angular_velocity(BodyId id, const InputVector<N>& velocity, Frame frame = Frame::body) {
        Base::template act<EventKind::angular_velocity>(id, frame, velocity);
    }
    // Sets the position (m, world) and the orientation (user's body axes to world; normalised here; zero is misuse).
    // The velocity stays in the world's axes, the angular velocity in the body's. Wakes all bodies.
    template <class T = Real>
    void set_pose(BodyId id, const InputVector<N>& position, const Quaternion<T>& orientation = {}) {
        Base::template act<EventKind::pose>(id, Frame::world, position, {}, orientation.template as<Work>());
    }

    // Removes a body at once. Its joints and springs go with it, and the springs behind them move up; so do its forces,
    // its contacts and what is known of its sleep, and all bodies wake. The place counts in the hash as one without a
    // body. The next body that is added takes the first free place, with another id. The old id is misuse from now on,
    // but an event of a script that names it is skipped.
    void remove(BodyId id) {
        static_assert(features.removal, "remove() needs .removal = true among the scene's features");
        Base::template act<EventKind::remove>(id, Frame::world, {});
    }
    // Removes a joint at once. Its bodies go on with the velocities that they have. The next joint that is added takes
    // the first free place, with another id. The old id is misuse from now on; an event of a script that names it is
    // skipped.
    void remove(JointId id) requires(features.has_joints()) {
        static_assert(features.removal, "remove() needs .removal = true among the scene's features");
        Base::template act_on_joint<EventKind::remove_joint>(id);
    }
    // Breaks a joint at once, as a load beyond its strength does at the start of the next step. It holds nothing any
    // more, keeps its place and its id until it is removed, and joint() says so.
    void break_joint(JointId id) requires(features.has_joints()) {
        static_assert(features.joint_breaks, "break_joint() needs .joint_breaks = true among the scene's features");
        Base::template act_on_joint<EventKind::break_joint>(id);
    }

    // True of a joint that has been added and not been removed. It goes with either of its bodies.
    [[nodiscard]] bool contains(JointId id) const requires(features.has_joints()) { return Base::contains(id); }
    // True of a body that has been added and not been removed.
    [[nodiscard]] bool contains(BodyId id) const { return Base::contains(id); }

    // Advances every body by one step: events that are due, loads, motion, contacts. Returns the sticky status.
    Status step() {
        if constexpr (features.has_script())
            script_.for_each_due(now(), [&](const Event<N>& event) {
                if (has_target(event)) Base::apply_scripted(event);
            });
        if constexpr (features.has_joints() && features.joint_breaks) Base::break_overloaded();
        Base::remember_all();
        if constexpr (Advance::has_wrenches) advance_.wrenches.start_step(advance_.bodies);
        const StepInfo<N> info{advance_.bodies.scale,
                               N::fixed_point ? Dither::of_step(advance_.bodies.steps_taken) : Dither{}};
        if constexpr (has_contacts) {
            contacts_.step(advance_, info);
        } else if constexpr (has_loads || Advance::has_joints) {
            advance_.step_all(info, [&](int b) { return Base::touches(b); });
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
            if (!advance_.joints.acts(id.index())) return {.broken = true};
        return Base::joint_reader(id.index()).template read<T>();
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
        return Base::snapshot_size(part);
    }
    // Writes a snapshot, which restore() takes on any machine; returns its size, or 0 where there is no room for it.
    // The array of set_script(), the recording, and the values of the scene's own loads are not in it. Call
    // change_load() before restore(): after it it drops the kick that the last step has left, and the next step differs
    // in its last bits where springs or drag act. A snapshot of a whole world has the forces and torques that act, and
    // with Features::control its gravity; one of bodies alone leaves those of the world that takes it.
    [[nodiscard]] int save(std::uint8_t* to, int room, SnapshotPart part = SnapshotPart::world) const {
        static_assert(features.snapshots, "save() needs .snapshots = true among the scene's features");
        return Base::save(to, room, part);
    }
    // Takes over a snapshot of a world with the same scene: the same number system, step, world values, and the same
    // bodies, planes and springs, added in the same order and removed at the same places between; of a whole world also
    // the same features and method, and without Features::control the same gravity. It may be followed by other bytes.
    // Where it says why not, the world is as before. Of bodies alone it sets their states and the number of steps: all
    // wake, and contacts are found anew.
    [[nodiscard]] SnapshotFault restore(const std::uint8_t* from, int count) {
        static_assert(features.snapshots, "restore() needs .snapshots = true among the scene's features");
        return Base::restore(from, count);
    }

    // Digest of every body's state.
    [[nodiscard]] std::uint64_t hash() const { return advance_.bodies.hash(); }

    // The bodies, for readers that need more digits than working numbers have.
    using Bodies = typename Advance::Bodies;
    // The bodies as they are stored.
    [[nodiscard]] constexpr const Bodies& bodies() const { return advance_.bodies; }

    // True where the body sleeps: it rests at no cost until something touches or pushes it.
    [[nodiscard]] bool asleep([[maybe_unused]] BodyId id) const {
        if constexpr (has_contacts) return contacts_.is_asleep(place_of(id));
        else return false;
    }
    // The largest safe step for contacts by springs, s; zero where they do not limit the step.
    [[nodiscard]] Real largest_safe_step() const {
        if constexpr (features.springs_touch()) return advance_.loads.contacts().largest_safe_step();
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
    // True of a body that the last step moved in bounded time, with many others. One at rest did not move.
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
    friend class ContactRange<World>;
};

}  // namespace tumble
