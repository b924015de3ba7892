// What loads add up: a force and a torque per body, in SI units and working numbers.
#pragma once

#include <tumble/body/stage.hpp>
#include <tumble/numbers/vectors.hpp>

namespace tumble {

// A body as loads see it: the stage's state in SI units, and the sums they add to.
template <class N>
struct LoadedBody {
    using Work = typename N::Work;

    const StageState<N>* stage = nullptr;
    Quat<Work> q_wb;                // principal axes to world
    WorkVec3<N> v_w, w_b;           // m/s, rad/s
    WorkVec3<N> force_w, torque_b;  // N, N m about the centre of mass

    // m/s, world, of a point of the body (principal axes, m).
    [[nodiscard]] WorkVec3<N> velocity_at(const WorkVec3<N>& r_b) const {
        return v_w + rotate(q_wb, cross<Work>(w_b, r_b));
    }
    // A force at a point of the body (principal axes, m).
    void push(const WorkVec3<N>& f_w, const WorkVec3<N>& r_b) {
        force_w += f_w;
        torque_b += cross<Work>(r_b, rotate_back(q_wb, f_w));
    }
};

}  // namespace tumble
