// The features that values of a scene need. A value that its world would ignore is misuse, and the assertion names the
// feature. A value that nothing could feel needs none: a shape or a friction in a world where no body touches anything.
#pragma once

#include <tumble/events/event.hpp>
#include <tumble/scene.hpp>

namespace tumble::detail {

// Of a world with these features.
template <Features features>
struct Required {
    // Ends the program where a value has no effect for want of a feature. Likewise below.
    TUMBLE_COLD static constexpr void by([[maybe_unused]] const WorldSpec& spec) {
        if constexpr (features.bodies > 0) {
            TUMBLE_ASSERT(features.drag || !has_drag(spec));
            TUMBLE_ASSERT(features.gravitation || features.bodies < 2 || spec.gravitation.is_zero());
            TUMBLE_ASSERT(!spec.linear_drag.is_negative() && !spec.angular_drag.is_negative());
            TUMBLE_ASSERT(!spec.gravitation.is_negative());
        }
        if constexpr (features.touches()) by(spec.contact);
    }
    TUMBLE_COLD static constexpr void by([[maybe_unused]] const BodySpec& spec) {
        TUMBLE_ASSERT(features.rotation || is_point_mass(spec));
        TUMBLE_ASSERT(features.point_masses || !is_point_mass(spec));
        TUMBLE_ASSERT(features.kinematic || !spec.kinematic);
        TUMBLE_ASSERT(features.turntables || !is_turntable(spec));
        if constexpr (features.touches()) {
            TUMBLE_ASSERT(features.boxes || !touches_as_box(spec));
            TUMBLE_ASSERT(features.round_shapes || !touches_as_round_shape(spec));
            TUMBLE_ASSERT(features.layers || spec.layers == BodySpec::all_layers);
            of_surface(spec);
        }
    }
    static constexpr void by([[maybe_unused]] const PlaneSpec& spec) {
        if constexpr (features.touches()) of_surface(spec);
    }
    static constexpr void by([[maybe_unused]] EventKind kind) {
        TUMBLE_ASSERT(features.forces || !is_timed(kind));
        TUMBLE_ASSERT(features.control || is_timed(kind) || (!is_wrench(kind) && kind != EventKind::gravity));
        TUMBLE_ASSERT(features.removal || (kind != EventKind::remove && kind != EventKind::remove_joint));
        TUMBLE_ASSERT(features.has_joints() || !has_joint(kind));
        TUMBLE_ASSERT(features.joint_breaks || kind != EventKind::break_joint);
    }
    // Whether a script may have events of a kind.
    [[nodiscard]] static constexpr bool may_script(EventKind kind) {
        if (is_timed(kind)) return features.forces || features.script;
        if (kind == EventKind::impulse || kind == EventKind::angular_impulse)
            return features.impulses || features.script;
        return features.script;
    }

private:
    static constexpr void by(const ContactSpec& spec) {
        using enum ContactResponse;
        TUMBLE_ASSERT(features.contact_impulses || spec.response != impulse);
        TUMBLE_ASSERT(features.contact_springs || spec.response != spring);
        if (spec.response != impulse) return;
        TUMBLE_ASSERT(features.friction || spec.friction.is_zero());
        TUMBLE_ASSERT(features.rolling_resistance || !resists(spec));
        TUMBLE_ASSERT(features.mixing || spec.mixes_as_usual());
        TUMBLE_ASSERT(features.sleep || !spec.sleep.on);
        TUMBLE_ASSERT(features.impact_bounds || !spec.has_bounds());
        TUMBLE_ASSERT(features.bounded_steps || spec.exact_bodies == ContactSpec::few ||
                      spec.exact_bodies == ContactSpec::any);
        TUMBLE_ASSERT(features.exact_steps || spec.exact_bodies == 0);
    }
    // The values of a body's or a plane's surface, which contacts by springs do not have.
    static constexpr void of_surface([[maybe_unused]] const auto& spec) {
        if constexpr (!features.contacts()) return;
        TUMBLE_ASSERT(features.friction || !is_positive(spec.friction));
        TUMBLE_ASSERT(features.rolling_resistance || !resists(spec));
    }

    // Without the subtraction of a comparison.
    [[nodiscard]] static constexpr bool is_positive(Real a) { return !a.is_zero() && !a.is_negative(); }
    [[nodiscard]] static constexpr bool has_drag(const WorldSpec& spec) {
        return !spec.linear_drag.is_zero() || !spec.angular_drag.is_zero();
    }
    [[nodiscard]] static constexpr bool resists(const auto& spec) {
        return is_positive(spec.rolling_resistance) || is_positive(spec.spinning_resistance);
    }
    // A fixed body that turns; a kinematic one turns without the feature.
    [[nodiscard]] static constexpr bool is_turntable(const BodySpec& spec) {
        return spec.fixed && !spec.kinematic && !spec.angular_velocity.is_zero();
    }
    // Nothing that never moves touches a plane.
    [[nodiscard]] static constexpr bool may_touch(const BodySpec& spec) { return features.pairs || !spec.is_fixed(); }
    [[nodiscard]] static constexpr bool touches_as_box(const BodySpec& spec) {
        return spec.shape.kind == ShapeKind::box && may_touch(spec);
    }
    // Round shapes touch planes alone.
    [[nodiscard]] static constexpr bool touches_as_round_shape(const BodySpec& spec) {
        const ShapeKind kind = spec.shape.kind;
        return features.planes > 0 && !spec.is_fixed() &&
               (kind == ShapeKind::cylinder || kind == ShapeKind::hoop || kind == ShapeKind::capsule);
    }
};

}  // namespace tumble::detail
