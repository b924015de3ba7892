// A hinge: one free rotation, about an axis that both bodies keep.
#pragma once

#include <tumble/joints/joint.hpp>

namespace tumble::joints {

struct Hinge {
    using Spec = HingeSpec;
    static constexpr const char* name = "hinge";
    static constexpr bool Features::*feature = &Features::hinges;
    static constexpr int turns = 1, slides = 0, axes = 1;

    [[nodiscard]] static constexpr detail::JointAxes axes_of(const Spec& spec) { return detail::axes_about(spec.axis); }
    [[nodiscard]] static constexpr JointFault fault_of(const Spec& spec) {
        return spec.axis.is_zero() ? JointFault::zero_axis : JointFault::none;
    }
};

}  // namespace tumble::joints
