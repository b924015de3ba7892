// Data that a step passes between a method, the loads and the contacts: a body in the middle of a step, and the change
// of its motion.
#pragma once

#include <tumble/body/state.hpp>

namespace tumble {

// The velocity by which a position advances: that of the step's start, that of its end, or their mean, which is exact
// for a constant acceleration.
enum class Coasting : std::uint8_t { start, end, mean };

// The data of a step besides the bodies.
template <class N>
struct StepInfo {
    typename N::Scale scale;
    Dither dither;
};

// A part of a step, for steps that an impact interrupts. Whole steps cost nothing extra.
template <class Work>
struct Portion {
    bool whole = true;
    Work length = Work(1);  // of the step, (0, 1]
};

// A body in the middle of a step, as loads see it. The version without rotation is for worlds of point masses.
template <class N, bool rotation = true>
struct StageState {
    typename N::PositionSum x_w[3];
    typename N::DriftSum d_w[3];
    Quat<typename N::Unit> q_wb;
    Vec3<typename N::Turn> t_b;
};
template <class N>
struct StageState<N, false> {
    typename N::PositionSum x_w[3]{};
    typename N::DriftSum d_w[3]{};
};

// The change of drift and spin in a whole step that the loads would make at their present strength. The spin's part is
// unused for a point mass.
template <class N, bool rotation = true>
struct Kick {
    typename N::DriftSum linear[3]{};
    typename N::TurnSum angular[3]{};
};
template <class N>
struct Kick<N, false> {
    typename N::DriftSum linear[3]{};
};

// The same in working numbers, m and rad. For a solver, whose trial values may lie far outside the range of a format.
template <class N, bool rotation = true>
struct WorkKick {
    Vec3<typename N::Work> linear, angular;
};
template <class N>
struct WorkKick<N, false> {
    Vec3<typename N::Work> linear;
};

template <class N, Spin spin>
[[nodiscard]] TUMBLE_INLINE StageState<N, spin != Spin::none> stage_of(const BodyState<N, spin>& body) {
    StageState<N, spin != Spin::none> s;
    for (int i = 0; i < 3; ++i) {
        s.x_w[i] = N::sum(body.x_w[i]);
        s.d_w[i] = N::sum(body.d_w[i]);
    }
    if constexpr (spin != Spin::none) {
        s.q_wb = body.q_wb.value();
        s.t_b = body.t_b.value();
    }
    return s;
}

// The angles of three turns.
template <class N>
[[nodiscard]] TUMBLE_INLINE Vec3<typename N::Angle> angles(const Vec3<typename N::Turn>& t, const StepInfo<N>& step) {
    return {N::angle(t.x(), step.scale, step.dither), N::angle(t.y(), step.scale, step.dither),
            N::angle(t.z(), step.scale, step.dither)};
}

}  // namespace tumble
