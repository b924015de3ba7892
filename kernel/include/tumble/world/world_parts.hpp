// WorldParts<Scene>: what a world is made of, how something is added to it, and how a change of one part is told to the
// others. The first layer of World. A layer is a class that derives from the one before it; World, the last, is what a
// program calls.
#pragma once

#include <tumble/advance/advance.hpp>
#include <tumble/body/places.hpp>
#include <tumble/contact/contacts.hpp>
#include <tumble/events/readout.hpp>
#include <tumble/events/script.hpp>
#include <tumble/joints/readout.hpp>
#include <tumble/required.hpp>

namespace tumble {

template <class S>
class WorldParts {
    static_assert(detail::IsNumberSystem<typename S::Numbers>,
                  "the scene's Numbers are a number system: tumble::Q32<>, tumble::F32 or tumble::F64");

protected:
    using Checked = typename detail::WithNumbers<S>::type;  // the scene
    using N = typename Checked::Numbers;
    using Integrator = typename S::Integrator;
    using Work = typename N::Work;
    using Advance = tumble::Advance<Checked>;
    using State = typename Advance::State;
    using Bodies = typename Advance::Bodies;
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
    static constexpr Features features = S::features;
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
    static constexpr bool has_contacts = features.contacts();
    static constexpr bool has_events = features.has_script() || features.recording;
    static constexpr bool has_imu = features.imu && features.bodies > 0;
    using Required = tumble::detail::Required<features>;
    using Contacts = tumble::Contacts<N, Integrator::spin, features>;

    constexpr WorldParts(const WorldSpec& spec, Seconds step)
        : advance_{step, spec}, contacts_{step.value, spec.contact} {
        if constexpr (features.touches()) TUMBLE_ASSERT(is_valid(spec.contact));
        Required::by(spec);
        set_up_gravity(spec.gravity);
        if constexpr (features.snapshots) digest_.add(step.value);
        note(spec);
    }

    // Bodies, planes, springs and joints. World documents these functions.
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
            detail::run_once([&] { added = advance_.loads.contacts().add(spec, advance_.bodies) && added; });
        advance_.disturb();
        if constexpr (has_contacts) count = contacts_.plane_count();
        else if constexpr (features.springs_touch()) count = advance_.loads.contacts().plane_count();
        if (added) note(spec);
        return added ? PlaneId{count - 1} : PlaneId{};
    }
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
        return SpringId{advance_.loads.springs().count() - 1};
    }
    template <JointSpec Spec>
    constexpr JointId add(const Spec& spec) requires(features.has_joints()) {
        refuse_to_record();
        JointId id;
        detail::run_once([&] { id = add_joint(spec); });
        return id;
    }
    template <JointSpec Spec>
    TUMBLE_COLD constexpr JointId add_joint(const Spec& spec) requires(features.has_joints()) {
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
    template <JointSpec Spec>
    [[nodiscard]] constexpr JointFault fault_of(const Spec& spec) const requires(features.has_joints()) {
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
    [[nodiscard]] bool contains(JointId id) const requires(features.has_joints()) {
        return advance_.joints.contains(id);
    }
    [[nodiscard]] bool contains(BodyId id) const {
        if constexpr (features.removal) return places_.contains(id);
        else return id && id.index() < advance_.bodies.count && id.generation() == 0;
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
    [[nodiscard]] auto joint_reader(int j) const {
        return tumble::detail::JointReader<N, features, Bodies, typename Advance::Pieces>{
            advance_.joints, advance_.bodies, j, steps_per_second()};
    }
    // Keeps the motion of a body, for imu().
    constexpr void remember(int b) requires has_imu {
        before_[b].d_w = advance_.bodies.state[b].d_w;
        if constexpr (features.rotation) {
            before_[b].t_b = advance_.bodies.state[b].t_b;
            before_[b].halvings = static_cast<std::int8_t>(advance_.bodies.halvings_of(b));
        }
    }
    constexpr void remember_all() {
        if constexpr (has_imu)
            for (int b = 0; b < features.bodies && b < advance_.bodies.count; ++b) remember(b);
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
    // Notes what is constant, for snapshots.
    constexpr void note([[maybe_unused]] const auto& spec) {
        if constexpr (features.snapshots) digest_.add(spec);
    }
    // The motion or the pose of a body is another.
    void has_changed(int b) {
        advance_.check_range(b);
        advance_.spin_changed(b);
        if constexpr (has_imu) remember(b);
        if constexpr (Advance::has_joints) advance_.joints.velocity_changed(b);
        disturb(b);
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
        if constexpr (features.springs_touch()) return advance_.loads.contacts().touches(b);
        else return false;
    }
    // For ContactRange.
    [[nodiscard]] int logged_count() const { return contacts_.logged_count(); }
    [[nodiscard]] bool is_logged(int i, int b) const { return contacts_.is_logged(i, b); }
    [[nodiscard]] Contact<Work> logged(int i, int b) const {
        return contacts_.logged(i, b, advance_.bodies, steps_per_second(), [&](int place) {
            if constexpr (features.removal) return places_.id_of(place);
            else return BodyId{place};
        });
    }

    [[no_unique_address]] Advance advance_;
    [[no_unique_address]] If<has_contacts, Contacts, 1> contacts_;
    [[no_unique_address]] If<features.has_script(), Script<Event<N>>, 3> script_{};
    [[no_unique_address]] If<features.recording, Recording<N>*, 8> recording_{};
    [[no_unique_address]] If<features.snapshots, tumble::detail::Digest, 10> digest_{};
    [[no_unique_address]] If<features.removal, Places<(features.bodies > 0 ? features.bodies : 1)>, 9> places_{};
    [[no_unique_address]] If<has_imu, typename tumble::detail::RoomFor<KeptMotion<State>, features.bodies>::Array, 7>
        before_{};
    [[no_unique_address]] If<has_events, std::uint32_t, 5> wraps_{};  // how often the number of steps began anew

private:
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
};

}  // namespace tumble
