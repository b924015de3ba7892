// What loads add up: a force and a torque per body, in SI units and working numbers; and the frame changes they share.
#pragma once

#include <tumble/integrators/method.hpp>

namespace tumble {

template <class N>
using WorkVec3 = Vec3<typename N::Work>;

template <class N>
[[nodiscard]] constexpr WorkVec3<N> zero_vector() { return WorkVec3<N>::Constant(typename N::Work(0)); }

// v + 2 w (q x v) + 2 q x (q x v): body to world.
template <class Work>
[[nodiscard]] inline Vec3<Work> rotate(const Quat<Work>& q, const Vec3<Work>& v) {
    Vec3<Work> t = cross<Work>(q.v, v);
    t += t;
    const Vec3<Work> u = cross<Work>(q.v, t);
    return {mul_add(v.x() + u.x(), q.w, t.x()), mul_add(v.y() + u.y(), q.w, t.y()), mul_add(v.z() + u.z(), q.w, t.z())};
}
// World to body.
template <class Work>
[[nodiscard]] inline Vec3<Work> rotate_back(const Quat<Work>& q, const Vec3<Work>& v) { return rotate(q.conjugate(), v); }

template <class Work>
[[nodiscard]] inline Vec3<Work> scaled_by(const Vec3<Work>& v, Work s) { return {v.x() * s, v.y() * s, v.z() * s}; }

template <class N>
[[nodiscard]] constexpr WorkVec3<N> work_vector(RealVec3 v) {
    using Work = typename N::Work;
    return {N::template constant<Work>(v.x), N::template constant<Work>(v.y), N::template constant<Work>(v.z)};
}

// A body as loads see it: the stage's state in SI units, and the sums they add to.
template <class N>
struct LoadedBody {
    using Work = typename N::Work;

    const StageState<N>* stage = nullptr;
    Quat<Work> q_wb;                              // principal axes to world
    WorkVec3<N> v_w, w_b;                         // m/s, rad/s
    WorkVec3<N> force_w, torque_b;                // N, N m about the centre of mass

    // A force at a point of the body (principal axes, m).
    void push(const WorkVec3<N>& f_w, const WorkVec3<N>& r_b) {
        force_w += f_w;
        torque_b += cross<Work>(r_b, rotate_back(q_wb, f_w));
    }
};

}  // namespace tumble
