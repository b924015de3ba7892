// A spring with damping along its length, from a point of a body to a world point or to a point of another body.
// One square root and one division unless the rest length and the damping are zero.
#pragma once

#include <tumble/loads/loaded_body.hpp>

namespace tumble {

template <class N>
struct Spring {
    using Work = typename N::Work;

    std::int16_t body = 0, to_body = -1;
    WorkVec3<N> point_b = zero_vector<N>();      // m, principal axes of `body`
    WorkVec3<N> to = zero_vector<N>();           // m, principal axes of `to_body`; unused for a world point
    typename N::PositionSum anchor_w[3]{};       // the world point
    Work stiffness{}, damping{}, rest_length{};  // N/m, N s/m, m

    // `other` is null for a world point.
    void apply(LoadedBody<N>& a, LoadedBody<N>* other) const {
        const WorkVec3<N> arm_w = rotate(a.q_wb, point_b);
        // Positions are subtracted as the state holds them, before rounding to working numbers.
        WorkVec3<N> reach;
        for (int i = 0; i < 3; ++i) {
            reach[i] = N::metres((other != nullptr ? other->stage->x_w[i] : anchor_w[i]) - a.stage->x_w[i]) - arm_w[i];
        }
        WorkVec3<N> other_arm_w = zero_vector<N>();
        if (other != nullptr) {
            other_arm_w = rotate(other->q_wb, to);
            reach += other_arm_w;
        }
        WorkVec3<N> force = scaled_by(reach, stiffness);
        if (rest_length > Work(0) || damping > Work(0)) {
            const Work length = sqrt(dot(reach, reach));
            if (!(length > Work(0))) return;  // no direction: no force
            const WorkVec3<N> along = scaled_by(reach, Work(1) / length);
            Work strength = stiffness * (length - rest_length);
            if (damping > Work(0)) {
                WorkVec3<N> rate = -a.velocity_at(point_b);
                if (other != nullptr) rate += other->velocity_at(to);
                strength = mul_add(strength, damping, dot(rate, along));
            }
            force = scaled_by(along, strength);
        }
        a.push(force, point_b);
        if (other != nullptr) other->push(-force, to);
    }
};

}  // namespace tumble
