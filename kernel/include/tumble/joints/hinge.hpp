// A hinge: one free rotation, about an axis that both bodies keep.
#pragma once

#include <tumble/joints/joint.hpp>

namespace tumble::joints {

struct Hinge {
    using Spec = HingeSpec;
    static constexpr const char* name = "hinge";
    static constexpr int turns = 1, slides = 0, axes = 1;

    [[nodiscard]] static constexpr detail::JointAxes axes_of(const Spec& spec) { return detail::axes_about(spec.axis); }
    [[nodiscard]] static constexpr JointFault fault_of(const Spec& spec) {
        return spec.axis.is_zero() ? JointFault::zero_axis : JointFault::none;
    }
    template <class View>
    [[nodiscard]] TUMBLE_INLINE static auto turn(const View& at, int) {
        return at.own(0);
    }
    // Brings the body's axis to the other's: a x b, whose length is the sine of the angle between them.
    template <class View>
    [[nodiscard]] TUMBLE_INLINE static auto lean(const View& at) {
        return at.across(at.own(0), at.other(0));
    }
};

}  // namespace tumble::joints
