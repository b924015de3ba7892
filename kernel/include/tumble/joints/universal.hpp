// A universal joint: rotations about an axis of each body. The two axes stay perpendicular.
#pragma once

#include <tumble/joints/joint.hpp>

namespace tumble::joints {

struct Universal {
    using Spec = UniversalSpec;
    static constexpr const char* name = "universal";
    static constexpr bool Features::*feature = &Features::universals;
    static constexpr int turns = 2, slides = 0, axes = 1;

    // The other's axis less its part along the body's. The second axes show the angles: each is the first of the other.
    TUMBLE_COLD [[nodiscard]] static constexpr detail::JointAxes axes_of(const Spec& spec) {
        detail::JointAxes made;
        const RealVec3 own = normalized(spec.axis), other = normalized(spec.to_axis);
        made.of_body[0] = made.of_other[1] = own;
        made.of_other[0] = made.of_body[1] = normalized(other - own * dot(own, other));
        return made;
    }
    TUMBLE_COLD [[nodiscard]] static constexpr JointFault fault_of(const Spec& spec) {
        if (spec.axis.is_zero() || spec.to_axis.is_zero()) return JointFault::zero_axis;
        const Real cosine = dot(normalized(spec.axis), normalized(spec.to_axis));
        return abs(cosine) > Real::scaled(1, -10) ? JointFault::axes_not_perpendicular : JointFault::none;
    }
};

}  // namespace tumble::joints
