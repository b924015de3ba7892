// A body as loads see it: its state at a stage, and the sums of force and torque, in SI units and working numbers.
#pragma once

#include <tumble/body/stage.hpp>
#include <tumble/numbers/vectors.hpp>
#include <tumble/scene.hpp>

namespace tumble {

// With `points` the body may be a point mass, which torques do not turn. Without rotation it is one.
template <class N, bool has_rotation = true, bool points = false>
struct LoadedBody {
    static constexpr bool rotation = true;
    using Work = typename N::Work;

    const StageState<N>* stage = nullptr;
    Quat<Work> q_wb;                // principal axes to world
    WorkVec3<N> v_w, w_b;           // m/s, rad/s
    WorkVec3<N> force_w, torque_b;  // N, N m about the centre of mass
    [[no_unique_address]] If<points, bool, 0> is_point{};

    [[nodiscard]] TUMBLE_INLINE bool rotates() const {
        if constexpr (points) return !is_point;
        else return true;
    }
    // m/s, world, of a point of the body (principal axes, m).
    [[nodiscard]] WorkVec3<N> velocity_at(const WorkVec3<N>& r_b) const {
        if (!rotates()) return v_w;
        return v_w + rotate(q_wb, cross<Work>(w_b, r_b));
    }
    // Adds a force at a point of the body (principal axes, m).
    void push(const WorkVec3<N>& f_w, const WorkVec3<N>& r_b) {
        force_w += f_w;
        if (rotates()) torque_b += cross<Work>(r_b, rotate_back(q_wb, f_w));
    }
};
template <class N>
struct LoadedBody<N, false, false> {
    static constexpr bool rotation = false;
    using Work = typename N::Work;

    const StageState<N, false>* stage = nullptr;
    WorkVec3<N> v_w, force_w;

    [[nodiscard]] static constexpr bool rotates() { return false; }
    [[nodiscard]] WorkVec3<N> velocity_at(const WorkVec3<N>&) const { return v_w; }
    void push(const WorkVec3<N>& f_w, const WorkVec3<N>&) { force_w += f_w; }
};

}  // namespace tumble
