// WorldEvents<Scene>: what events do to a world, at once or when a script says so.
#pragma once

#include <tumble/world/world_setup.hpp>

namespace tumble {

template <class S>
class WorldEvents : protected WorldSetup<S> {
    using Base = WorldSetup<S>;

protected:
    using Base::contains, Base::joint_reader, Base::steps_per_second, Base::seconds, Base::remember_all, Base::place_of,
        Base::now, Base::tell_gravity, Base::has_changed, Base::replaced, Base::disturb;
    using Base::features, Base::has_contacts, Base::advance_, Base::contacts_, Base::recording_, Base::digest_,
        Base::places_;
    using typename Base::N, typename Base::Work, typename Base::Advance, typename Base::State, typename Base::Required;
    constexpr WorldEvents(const WorldSpec& spec, Seconds step) : Base{spec, step} {}

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
    void apply(const Event<N>& e) {
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
        for (int j = 0; j < features.joints; ++j)
            is_overloaded[j] = advance_.joints.holds(j) && advance_.joints.strength(j).has_limits() &&
                               joint_reader(j).exceeds(advance_.joints.strength(j));
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
    void apply(const Impulse<N>& event) {
        const int b = advance_.bodies.index_of(event.body);
        if (!advance_.bodies.constants[b].fixed()) detail::apply_impulse(advance_.bodies, event);
        has_changed(b);
    }

private:
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
};

}  // namespace tumble
