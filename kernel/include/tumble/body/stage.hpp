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
    typename N::PositionSum x_w[3];
    typename N::DriftSum d_w[3];
};

// The change of drift and spin in a whole step that the loads would make at their present strength. The spin's part is
// unused for a point mass. Kick{} is zero.
template <class N, bool rotation = true>
struct Kick {
    typename N::DriftSum linear[3];
    typename N::TurnSum angular[3];
};
template <class N>
struct Kick<N, false> {
    typename N::DriftSum linear[3];
};

// The kick at the end of a body's last step, which is the kick at the start of its next one where nothing but steps has
// happened. It saves an evaluation.
template <class N, bool rotation>
struct KeptKick {
    Kick<N, rotation> kick{};
    std::uint32_t age = 0;  // the world's count of disturbances when it was kept; 0: none is kept

    // Writes or reads it, in a world with this count of disturbances.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to, std::uint32_t disturbances) {
        bool is_kept = self.age == disturbances;
        to(is_kept);
        if constexpr (Archive::reads) {
            to(self.kick);
            self.age = is_kept ? disturbances : 0;
        } else {
            to(is_kept ? self.kick : Kick<N, rotation>{});
        }
    }
};

// The same as a Kick in working numbers, m and rad. For a solver, whose trial values may lie far outside the range of a
// format.
template <class N, bool rotation = true>
struct WorkKick {
    Vec3<typename N::Work> linear, angular;
};
template <class N>
struct WorkKick<N, false> {
    Vec3<typename N::Work> linear;
};

// Writes the body as it stands to a stage, in place.
template <class N, Spin spin, bool rotation>
TUMBLE_INLINE void take_stage(StageState<N, rotation>& s, const BodyState<N, spin>& body) {
    detail::for_axes<N>([&](int i) __attribute__((always_inline)) {
        s.x_w[i] = N::sum(body.x_w[i]);
        s.d_w[i] = N::sum(body.d_w[i]);
    });
    if constexpr (rotation) {
        s.q_wb = body.q_wb.value();
        s.t_b = body.t_b.value();
    }
}
template <class N, Spin spin>
[[nodiscard]] TUMBLE_INLINE StageState<N, spin != Spin::none> stage_of(const BodyState<N, spin>& body) {
    StageState<N, spin != Spin::none> s;
    take_stage(s, body);
    return s;
}
// Copies a stage, likewise.
template <class N, bool rotation>
TUMBLE_INLINE void copy_stage(StageState<N, rotation>& to, const StageState<N, rotation>& from) {
    detail::for_axes<N>([&](int i) __attribute__((always_inline)) {
        to.x_w[i] = from.x_w[i];
        to.d_w[i] = from.d_w[i];
        if constexpr (rotation && N::fixed_point) detail::keep_apart();
    });
    if constexpr (rotation) {
        to.q_wb = from.q_wb;
        to.t_b = from.t_b;
    }
}

// The angles of three turns.
template <class N>
[[nodiscard]] TUMBLE_INLINE Vec3<typename N::Angle> angles(const Vec3<typename N::Turn>& t, const StepInfo<N>& step) {
    return {N::angle(t.x(), step.scale, step.dither), N::angle(t.y(), step.scale, step.dither),
            N::angle(t.z(), step.scale, step.dither)};
}

}  // namespace tumble
