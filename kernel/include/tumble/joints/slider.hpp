// A slider: one free translation. The anchor of the body stays on an axis that the other body keeps.
#pragma once

#include <tumble/joints/joint.hpp>

namespace tumble::joints {

struct Slider {
    using Spec = SliderSpec;
    static constexpr const char* name = "slider";
    static constexpr bool Features::*feature = &Features::sliders;
    static constexpr int turns = 0, slides = 1, axes = 2;

    [[nodiscard]] static constexpr detail::JointAxes axes_of(const Spec& spec) { return detail::axes_about(spec.axis); }
    [[nodiscard]] static constexpr JointFault fault_of(const Spec& spec) {
        return spec.axis.is_zero() ? JointFault::zero_axis : JointFault::none;
    }
};

}  // namespace tumble::joints
