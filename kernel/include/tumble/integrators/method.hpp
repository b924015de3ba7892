// What every integration method provides, and the small types they share.
//
// A method is a struct with:
//   name, order                     for the command line and for tests
//   spin                            what the state's spin is: see Spin below
//   coasting                        how position advances under constant acceleration
//   Inertia<N>::of(moments, step, scale)   the constants of a body that its rotation needs
//   rotate<N>(body, inertia, step)         one step of torque-free rotation
//   inertia.prepare(body, scale)           only where those constants depend on the spin: called whenever it is changed
//   free_order                      only where torque-free rotation has another order than the rest
//   needs                           only where a step needs sqrt, division or trigonometry: says so to the user
//   not_in_fixed_point              only where it is for floating point alone: says why to the user; see runs_in
//   advance<N, capacity>(group, evaluate, step)   one step of bodies whose loads depend on their state
// A new method is one such header and one line in integrators/list.hpp.
#pragma once

#include <tumble/body/orientation.hpp>

namespace tumble {

// position += the velocity at the step's start, at its end, or their mean (exact for a constant acceleration).
enum class Coasting : std::uint8_t { start, end, mean };

// The free_order of a rotation without truncation error.
inline constexpr int no_truncation = 0x7fffffff;

// Does a method run in a number system? All loops over methods and number systems ask this, and builds ask the same
// member of the headers (lists.cmake).
template <class Method, class N>
inline constexpr bool runs_in = !(N::fixed_point && requires { Method::not_in_fixed_point; });

// What a step needs besides the bodies.
template <class N>
struct StepInfo {
    typename N::Scale scale;
    Dither dither;
};

// A body as the loads see it in the middle of a step.
template <class N>
struct StageState {
    typename N::PositionSum x_w[3];
    typename N::DriftSum d_w[3];
    Quat<typename N::Unit> q_wb;
    Vec3<typename N::Turn> t_b;
};

// The change of drift and spin over a whole step that loads would make at their present strength.
template <class N>
struct Kick {
    typename N::DriftSum linear[3]{};
    typename N::TurnSum angular[3]{};
};

// The same in working numbers, m and rad: for a solver, whose trials may lie far outside a format's range.
template <class N>
struct WorkKick {
    Vec3<typename N::Work> linear, angular;
};

// Bodies that must be staged together, because loads couple them; or one body alone.
template <class N, Spin spin, class Inertia, int capacity>
struct Group {
    int count = 0;
    BodyState<N, spin>* body[capacity]{};
    Inertia* inertia[capacity]{};
};

template <class N, Spin spin>
[[nodiscard]] TUMBLE_INLINE StageState<N> stage_of(const BodyState<N, spin>& body) {
    StageState<N> s;
    for (int i = 0; i < 3; ++i) {
        s.x_w[i] = N::sum(body.x_w[i]);
        s.d_w[i] = N::sum(body.d_w[i]);
    }
    s.q_wb = body.q_wb.value();
    s.t_b = body.t_b.value();
    return s;
}

// q (1 + delta), rounded to unit-quaternion components; not renormalised.
template <class N>
[[nodiscard]] TUMBLE_INLINE Quat<typename N::Unit> turned(const Quat<typename N::Unit>& q, const Delta<N>& delta) {
    using Unit = typename N::Unit;
    return {
        q.w + narrow<Unit>(mul(q.w, delta.w) - dot(q.v, delta.v)),
        {q.v.x() + narrow<Unit>(add_cross_component<0>(mul_add(mul(q.w, delta.v.x()), q.v.x(), delta.w), q.v, delta.v)),
         q.v.y() + narrow<Unit>(add_cross_component<1>(mul_add(mul(q.w, delta.v.y()), q.v.y(), delta.w), q.v, delta.v)),
         q.v.z() +
             narrow<Unit>(add_cross_component<2>(mul_add(mul(q.w, delta.v.z()), q.v.z(), delta.w), q.v, delta.v))}};
}

// The angles of three turns.
template <class N>
[[nodiscard]] TUMBLE_INLINE Vec3<typename N::Angle> angles(const Vec3<typename N::Turn>& t, const StepInfo<N>& step) {
    return {N::angle(t.x(), step.scale, step.dither), N::angle(t.y(), step.scale, step.dither),
            N::angle(t.z(), step.scale, step.dither)};
}

}  // namespace tumble
