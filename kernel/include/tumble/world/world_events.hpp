// WorldEvents<Scene>: what events do to a world, at once or when a script says so.
#pragma once

#include <tumble/world/world_parts.hpp>

namespace tumble {

template <class S>
class WorldEvents : protected WorldParts<S> {
    using Base = WorldParts<S>;

protected:
    using Base::contains, Base::joint_reader, Base::steps_per_second, Base::seconds, Base::remember_all, Base::place_of,
        Base::now, Base::tell_gravity, Base::has_changed, Base::replaced, Base::disturb;
    using Base::features, Base::has_contacts, Base::advance_, Base::contacts_, Base::script_, Base::recording_,
        Base::digest_, Base::places_;
    using typename Base::N, typename Base::Work, typename Base::Advance, typename Base::Required;
    constexpr WorldEvents(const WorldSpec& spec, Seconds step) : Base{spec, step} {}

    // An event of a body that has not been added is misuse.
    constexpr void require_bodies(Span<Event<N>> events) const {
        for (const Event<N>& event : events)
            if (!is_of_world(event) && !is_of_joint(event)) (void)advance_.bodies.index_of(event.body);
    }
    // True of an event of a joint.
    [[nodiscard]] static constexpr bool is_of_joint([[maybe_unused]] const Event<N>& event) {
        if constexpr (features.has_joints()) return has_joint(event.kind);
        else return false;
    }
    // True of an event that has no body. Without Features::control there is none.
    [[nodiscard]] static constexpr bool is_of_world([[maybe_unused]] const Event<N>& event) {
        if constexpr (features.control) return event.kind == EventKind::gravity;
        else return false;
    }
    // False of an event whose body has been removed.
    [[nodiscard]] bool has_target(const Event<N>& event) const {
        if constexpr (features.has_joints())
            if (is_of_joint(event)) return contains(event.joint());
        return is_of_world(event) || contains(event.body);
    }
    // Lets those forces and torques act that events of the script before the next step have begun and not ended, and no
    // others that have begun. Call disturb() for all bodies.
    void begin_forces_again() {
        if constexpr (features.forces && features.bodies > 0) {
            advance_.loads.begun_forces().clear();
            script_.for_each_passed([&](const Event<N>& e) {
                if (!is_timed(e.kind) || !contains(e.body)) return;
                const int b = place_of(e.body);
                if (!advance_.bodies.constants[b].fixed()) begin_or_end(e.kind, b, e.frame, e.value, e.point);
            });
        }
    }
    // Applies an event of any kind.
    void apply(const Event<N>& e) { apply_any<false>(e); }
    // Applies an event of a kind that a script may have. The code of the others is absent.
    void apply_scripted(const Event<N>& e) { apply_any<true>(e); }
    template <bool scripted>
    [[gnu::noinline]] void apply_any(const Event<N>& e) {
        switch (e.kind) {
        case EventKind::impulse: return apply_as<scripted, EventKind::impulse>(e);
        case EventKind::angular_impulse: return apply_as<scripted, EventKind::angular_impulse>(e);
        case EventKind::force: return apply_as<scripted, EventKind::force>(e);
        case EventKind::torque: return apply_as<scripted, EventKind::torque>(e);
        case EventKind::step_force: return apply_as<scripted, EventKind::step_force>(e);
        case EventKind::step_torque: return apply_as<scripted, EventKind::step_torque>(e);
        case EventKind::begin_force: return apply_as<scripted, EventKind::begin_force>(e);
        case EventKind::end_force: return apply_as<scripted, EventKind::end_force>(e);
        case EventKind::begin_torque: return apply_as<scripted, EventKind::begin_torque>(e);
        case EventKind::end_torque: return apply_as<scripted, EventKind::end_torque>(e);
        case EventKind::velocity: return apply_as<scripted, EventKind::velocity>(e);
        case EventKind::angular_velocity: return apply_as<scripted, EventKind::angular_velocity>(e);
        case EventKind::pose: return apply_as<scripted, EventKind::pose>(e);
        case EventKind::remove: return apply_as<scripted, EventKind::remove>(e);
        case EventKind::gravity: return apply_as<scripted, EventKind::gravity>(e);
        case EventKind::break_joint: return apply_as<scripted, EventKind::break_joint>(e);
        case EventKind::remove_joint: return apply_as<scripted, EventKind::remove_joint>(e);
        }
    }
    template <bool scripted, EventKind kind>
    void apply_as(const Event<N>& e) {
        if constexpr (scripted && !Required::may_script(kind)) return;
        Required::by(kind);
        if constexpr (has_joint(kind)) {
            if constexpr (features.has_joints()) act_on_joint<kind>(e.joint());
        } else if constexpr (has_body(kind)) {
            if constexpr (kind == EventKind::pose) act<kind>(e.body, e.frame, e.value, {}, e.orientation);
            else if constexpr (has_point(kind)) act<kind>(e.body, e.frame, e.value, e.point);
            else act<kind>(e.body, e.frame, e.value);
        } else {
            TUMBLE_ASSERT(e.frame == Frame::world);
            if constexpr (features.control) act_on_world(e.value);
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
            is_overloaded[j] = advance_.joints.acts(j) && advance_.joints.strength(j).has_limits() &&
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
    // A timed force or torque of a body that is not fixed begins or ends.
    TUMBLE_INLINE void begin_or_end(EventKind kind, int b, Frame frame, const InputVector<N>& value,
                                    const InputVector<N>& point) requires(features.forces&& features.bodies > 0) {
        auto& begun = advance_.loads.begun_forces();
        const bool ends = kind == EventKind::end_force || kind == EventKind::end_torque;
        if (kind == EventKind::begin_torque || kind == EventKind::end_torque)
            begun.template begin_or_end<true>(advance_.bodies, b, frame, value.block(), point.block(), seconds(), ends);
        else
            begun.template begin_or_end<false>(advance_.bodies, b, frame, value.block(), point.block(), seconds(),
                                               ends);
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
        if constexpr (is_wrench(kind)) {
            Required::by(kind);
            if (bodies.constants[b].fixed()) return;
            if constexpr (is_timed(kind)) {
                if constexpr (features.forces && features.bodies > 0) begin_or_end(kind, b, frame, value, point);
            } else if constexpr (Advance::has_wrenches) {
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
