// WorldSetup<Scene>: bodies, planes, springs and joints are added to a world.
#pragma once

#include <tumble/world/world_parts.hpp>

namespace tumble {

template <class S>
class WorldSetup : protected WorldParts<S> {
    using Base = WorldParts<S>;

protected:
    using Base::features, Base::has_contacts, Base::has_imu, Base::advance_, Base::contacts_, Base::places_;
    using Base::remember, Base::refuse_to_record, Base::note, Base::disturb, Base::touches;
    using typename Base::Advance, typename Base::Required;
    constexpr WorldSetup(const WorldSpec& spec, Seconds step) : Base{spec, step} {}

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
    JointId add(const Spec& spec) requires(features.has_joints()) {
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
