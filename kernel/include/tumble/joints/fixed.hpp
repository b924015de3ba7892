// A fixed joint: no free direction.
#pragma once

#include <tumble/joints/joint.hpp>

namespace tumble::joints {

// The turn that brings the axes of the body to those of the other, to first order: a x b of the first axes, and the
// part along the first axis of that of the second ones.
template <class View>
[[nodiscard]] TUMBLE_INLINE auto whole_lean(const View& at) {
    const auto lean = at.across(at.own(0), at.other(0)), about = at.across(at.own(1), at.other(1));
    return at.sum(lean, at.along(at.own(0), about));
}

struct Fixed {
    using Spec = FixedSpec;
    static constexpr const char* name = "fixed";
    static constexpr int turns = 0, slides = 0, axes = 2;

    [[nodiscard]] static constexpr detail::JointAxes axes_of(const Spec&) { return detail::axes_about({0, 0, 1}); }
    [[nodiscard]] static constexpr JointFault fault_of(const Spec&) { return JointFault::none; }
    template <class View>
    [[nodiscard]] TUMBLE_INLINE static auto lean(const View& at) {
        return whole_lean(at);
    }
};

}  // namespace tumble::joints
