// How far joints are open, in long double, from the states of the bodies and the scene alone: a measure that shares no
// code with the kernel's.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "scene/data.hpp"
#include "simulation/long_double.hpp"

namespace tumble::host {

class JointGaps {
    using Number = reference::Number;
    using Vector = reference::Vector;
    using Motion = reference::Motion;

public:
    using Gap = std::pair<double, double>;  // m, between the anchors; rad, between the orientations

    // `motion_at(b)`: where body b is when the joints are added.
    JointGaps(const std::vector<AnyJointSpec>& joints, const auto& motion_at) {
        for (const AnyJointSpec& joint : joints)
            joint.visit([&]<class Spec>(const Spec& spec) {
                const Vector anchor = vector(spec.anchor);
                Joint made{.body = spec.body, .to_body = spec.to_body};
                const Motion own = side(made.body, motion_at), other = side(made.to_body, motion_at);
                made.arm = own.q.rotate_back(anchor - own.x);
                made.to_arm = other.q.rotate_back(anchor - other.x);
                made.turn = other.q.conjugate() * own.q;
                made.kind = JointKinds::number_of<Spec>;
                if constexpr (requires { spec.axis; }) {
                    made.axis = own.q.rotate_back(unit(vector(spec.axis)));
                    made.to_axis = other.q.rotate_back(unit(vector(spec.axis)));
                }
                if constexpr (requires { spec.to_axis; })
                    made.to_axis = other.q.rotate_back(across(vector(spec.to_axis), unit(vector(spec.axis))));
                joints_.push_back(made);
            });
    }

    [[nodiscard]] Gap of(int j, const auto& motion_at) const {
        const Joint& joint = joints_[static_cast<std::size_t>(j)];
        const Motion own = side(joint.body, motion_at), other = side(joint.to_body, motion_at);
        const Vector axis = own.q.rotate(joint.axis), to_axis = other.q.rotate(joint.to_axis);
        Vector apart = own.x + own.q.rotate(joint.arm) - other.x - other.q.rotate(joint.to_arm);
        if (joint.kind == JointKinds::number_of<SliderSpec>) apart = apart - dot(apart, to_axis) * to_axis;
        Number lean = 0;
        if (joint.kind == JointKinds::number_of<HingeSpec>)
            lean = std::atan2(norm(cross(axis, to_axis)), dot(axis, to_axis));
        else if (joint.kind == JointKinds::number_of<UniversalSpec>) lean = std::abs(std::asin(dot(axis, to_axis)));
        else if (joint.kind != JointKinds::number_of<BallSpec>)
            lean = angle_between(other.q.conjugate() * own.q, joint.turn);
        return {static_cast<double>(norm(apart)), static_cast<double>(lean)};
    }

private:
    struct Joint {
        int body = 0, to_body = -1;
        int kind = 0;
        Vector arm{}, to_arm{};      // of the anchor, m, the bodies' axes
        Vector axis{}, to_axis{};    // unit, the bodies' axes
        reference::Rotation turn{};  // of `body` in the axes of `to_body`
    };

    // The world stays at the origin.
    [[nodiscard]] static Motion side(int body, const auto& motion_at) { return body < 0 ? Motion{} : motion_at(body); }
    [[nodiscard]] static Vector unit(const Vector& v) { return v * (1 / norm(v)); }
    // The unit vector along the part of v across an axis.
    [[nodiscard]] static Vector across(const Vector& v, const Vector& axis) {
        const Vector direction = unit(v);
        return unit(direction - dot(direction, axis) * axis);
    }

    std::vector<Joint> joints_;
};

}  // namespace tumble::host
