// What loads add up: a force and a torque per body, in SI units and working numbers; and the frame changes they share.
#pragma once

#include <tumble/integrators/method.hpp>

namespace tumble {

template <class N>
using WorkVec3 = Vec3<typename N::Work>;

template <class N>
[[nodiscard]] constexpr WorkVec3<N> zero_vector() {
    return WorkVec3<N>::Constant(typename N::Work(0));
}

// q v q*, body to world: (w^2 - |u|^2) v + 2 (u . v) u + 2 w u x v with q = (w, u). Of a q that rounding has left a
// little off unit length it is still a rotation, times |q|^2; the form that is shorter by a product is not.
template <class Work>
[[nodiscard]] inline Vec3<Work> rotate(const Quat<Work>& q, const Vec3<Work>& v) {
    const Work along = q.w * q.w - dot(q.v, q.v), twice_dot = dot(q.v, v) * Work(2), twice_w = q.w * Work(2);
    const Vec3<Work> c = cross<Work>(q.v, v);
    const auto component = [&](int i) { return mul_add(mul_add(along * v[i], twice_dot, q.v[i]), twice_w, c[i]); };
    return {component(0), component(1), component(2)};
}
// World to body.
template <class Work>
[[nodiscard]] inline Vec3<Work> rotate_back(const Quat<Work>& q, const Vec3<Work>& v) {
    return rotate(q.conjugate(), v);
}

template <class Work>
[[nodiscard]] inline Vec3<Work> scaled_by(const Vec3<Work>& v, Work s) {
    return {v.x() * s, v.y() * s, v.z() * s};
}

template <class N>
[[nodiscard]] constexpr WorkVec3<N> work_vector(RealVec3 v) {
    using Work = typename N::Work;
    return {N::template constant<Work>(v.x), N::template constant<Work>(v.y), N::template constant<Work>(v.z)};
}

template <class N>
[[nodiscard]] inline Quat<typename N::Work> work_quaternion(const Quat<typename N::Unit>& q) {
    return {N::work(q.w), {N::work(q.v.x()), N::work(q.v.y()), N::work(q.v.z())}};
}
template <class N>
[[nodiscard]] inline WorkVec3<N> work_unit(const Vec3<typename N::Unit>& n) {
    return {N::work(n.x()), N::work(n.y()), N::work(n.z())};
}

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
