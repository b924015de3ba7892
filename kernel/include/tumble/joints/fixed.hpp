// A fixed joint: no free direction.
#pragma once

#include <tumble/joints/joint.hpp>

namespace tumble::joints {

struct Fixed {
    using Spec = FixedSpec;
    static constexpr const char* name = "fixed";
    static constexpr bool Features::*feature = &Features::fixed_joints;
    static constexpr int turns = 0, slides = 0, axes = 2;

    [[nodiscard]] static constexpr detail::JointAxes axes_of(const Spec&) { return detail::axes_about({0, 0, 1}); }
    [[nodiscard]] static constexpr JointFault fault_of(const Spec&) { return JointFault::none; }
};

}  // namespace tumble::joints
