// A distance: two points keep theirs, as by a rod, or keep it in a range, as by a rope.
#pragma once

#include <tumble/joints/joint.hpp>

namespace tumble::joints {

struct Distance {
    using Spec = DistanceSpec;
    static constexpr const char* name = "distance";
    static constexpr bool Features::*feature = &Features::distances;
    static constexpr int turns = 3, slides = 2, axes = 0;

    [[nodiscard]] static constexpr detail::JointAxes axes_of(const Spec&) { return detail::axes_about({0, 0, 1}); }
    TUMBLE_COLD [[nodiscard]] static constexpr JointFault fault_of(const Spec& spec) {
        if (spec.least.is_negative() || !(spec.most > Real{}) || spec.least > spec.most) return JointFault::empty_range;
        const RealVec3 apart = spec.point - spec.to_point;
        const Real square = dot(apart, apart), near = Real{1} + Real::scaled(1, -20),
                   far = Real{1} - Real::scaled(1, -20);
        const Real most = spec.most * near, least = spec.least * far;
        return square > most * most || square < least * least ? JointFault::outside_range : JointFault::none;
    }
};

}  // namespace tumble::joints
