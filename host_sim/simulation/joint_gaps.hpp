// How far joints are open, and what their springs store, in long double, from the states of the bodies and the scene
// alone: a measure that shares no code with the kernel's.
#pragma once

#include <algorithm>
#include <array>
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
    // Of an angle or a travel from the start, rad or m; of a distance, m.
    struct Range {
        Number least = 0, most = 0;
        [[nodiscard]] bool has_ends() const { return least != most; }
    };
    [[nodiscard]] static Range range_of([[maybe_unused]] const auto& spec) {
        if constexpr (requires { spec.limits; }) return {number(spec.limits.least), number(spec.limits.most)};
        else if constexpr (requires { spec.to_point; }) return {number(spec.least), number(spec.most)};
        else return {};
    }

    // `motion_at(b)`: where body b is when the joints are added.
    JointGaps(const std::vector<AnyJointSpec>& joints, const auto& motion_at) {
        for (const AnyJointSpec& joint : joints)
            joint.visit([&]<class Spec>(const Spec& spec) {
                Joint made{.body = spec.body, .to_body = spec.to_body, .range = range_of(spec)};
                const Motion own = side(made.body, motion_at), other = side(made.to_body, motion_at);
                made.arm = own.q.rotate_back(vector(detail::anchor_of(spec, 0)) - own.x);
                made.to_arm = other.q.rotate_back(vector(detail::anchor_of(spec, 1)) - other.x);
                for (int i = 0; i < 2; ++i) made.springs[static_cast<std::size_t>(i)] = detail::spring_of(spec, i);
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
        if (joint.kind == JointKinds::number_of<DistanceSpec>) {
            const Number length = norm(apart);
            return {static_cast<double>(std::max({joint.range.least - length, length - joint.range.most, Number(0)})),
                    0};
        }
        Number lean = 0;
        if (joint.kind == JointKinds::number_of<HingeSpec>)
            lean = std::atan2(norm(cross(axis, to_axis)), dot(axis, to_axis));
        else if (joint.kind == JointKinds::number_of<UniversalSpec>) lean = std::abs(std::asin(dot(axis, to_axis)));
        else if (joint.kind != JointKinds::number_of<BallSpec>)
            lean = angle_between(other.q.conjugate() * own.q, joint.turn);
        return {static_cast<double>(norm(apart)), static_cast<double>(lean)};
    }

    [[nodiscard]] bool has_spring(int j) const {
        const Joint& joint = joints_[static_cast<std::size_t>(j)];
        return joint.springs[0].acts() || joint.springs[1].acts();
    }
    // J, by the springs of joint j.
    [[nodiscard]] Number stored_in(int j, const auto& motion_at) const {
        const Joint& joint = joints_[static_cast<std::size_t>(j)];
        const Motion own = side(joint.body, motion_at), other = side(joint.to_body, motion_at);
        const auto of = [](const JointSpring& spring, Number x) {
            const Number stretch = x - number(spring.rest);
            return number(spring.stiffness) * stretch * stretch / 2;
        };
        const Vector apart = own.x + own.q.rotate(joint.arm) - other.x - other.q.rotate(joint.to_arm);
        if (joint.kind == JointKinds::number_of<DistanceSpec>) return of(joint.springs[0], norm(apart));
        if (joint.kind == JointKinds::number_of<SliderSpec>)
            return of(joint.springs[0], dot(apart, other.q.rotate(joint.to_axis)));
        // The turn since the start, in the axes of `to_body`; the axis of `body` there, then and now.
        const reference::Rotation turned = (other.q.conjugate() * own.q * joint.turn.conjugate()).normalized();
        const Vector before = joint.turn.rotate(joint.axis), now = turned.rotate(before);
        if (joint.kind == JointKinds::number_of<BallSpec>)
            return of(joint.springs[0], 2 * std::atan2(norm(turned.v), std::abs(turned.w)));
        if (joint.kind == JointKinds::number_of<HingeSpec>) {
            const Number half = std::atan2(dot(turned.v, before), turned.w), pi = std::acos(Number(-1));
            return of(joint.springs[0], half > pi / 2     ? 2 * half - 2 * pi
                                        : half <= -pi / 2 ? 2 * half + 2 * pi
                                                          : 2 * half);
        }
        // It turns about to_axis, and then about its own axis as that stands now.
        const Vector across = cross(before, joint.to_axis), back = turned.rotate_back(joint.to_axis);
        return of(joint.springs[0], std::atan2(-dot(back, across), dot(back, joint.to_axis))) +
               of(joint.springs[1], std::atan2(-dot(now, across), dot(now, before)));
    }

private:
    struct Joint {
        int body = 0, to_body = -1;
        int kind = 0;
        Range range{};
        std::array<JointSpring, 2> springs{};
        Vector arm{}, to_arm{};      // of the anchor, m, the bodies' axes
        Vector axis{}, to_axis{};    // unit, the bodies' axes
        reference::Rotation turn{};  // of `body` in the axes of `to_body`
    };

    // The world stays at the origin.
    [[nodiscard]] static Motion side(int body, const auto& motion_at) { return body < 0 ? Motion{} : motion_at(body); }
    // The unit vector along the part of v across an axis.
    [[nodiscard]] static Vector across(const Vector& v, const Vector& axis) {
        const Vector direction = unit(v);
        return unit(direction - dot(direction, axis) * axis);
    }

    std::vector<Joint> joints_;
};

}  // namespace tumble::host
