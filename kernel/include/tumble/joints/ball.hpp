// A ball joint: all rotations about a point that both bodies keep.
#pragma once

#include <tumble/joints/joint.hpp>

namespace tumble::joints {

struct Ball {
    using Spec = BallSpec;
    static constexpr const char* name = "ball";
    static constexpr bool Features::*feature = &Features::balls;
    static constexpr int turns = 3, slides = 0, axes = 0;

    [[nodiscard]] static constexpr detail::JointAxes axes_of(const Spec&) { return detail::axes_about({0, 0, 1}); }
    [[nodiscard]] static constexpr JointFault fault_of(const Spec&) { return JointFault::none; }
};

}  // namespace tumble::joints
