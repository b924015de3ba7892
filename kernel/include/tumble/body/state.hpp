// BodyState: all that a step writes of one body. It is plain data with a fixed layout, trivially copyable, so it can be
// stored, rolled back, hashed and sent. Its units are those of a World's step (numbers/systems.hpp); World returns
// metres per second and radians per second.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

// Three carried numbers as a vector.
template <class N, class T>
struct IntegratedVec3 {
    typename N::template Integrated<T> x, y, z;

    [[nodiscard]] TUMBLE_INLINE Vec3<T> value() const { return {x.value(), y.value(), z.value()}; }
    [[nodiscard]] constexpr auto& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    [[nodiscard]] constexpr const auto& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    friend constexpr bool operator==(const IntegratedVec3&, const IntegratedVec3&) = default;
};

template <class N>
struct IntegratedQuat {
    typename N::IntegratedUnit w, x, y, z;

    template <class Vector = Vec3<typename N::Unit>>
    [[nodiscard]] TUMBLE_INLINE constexpr Quat<typename N::Unit, Vector> value() const {
        return {w.value(), {x.value(), y.value(), z.value()}};
    }
    friend constexpr bool operator==(const IntegratedQuat&, const IntegratedQuat&) = default;
};

// The spin in the state of a body. Angular velocity makes Euler's equations cheap: their coefficients lie in [-1, 1]
// for every body. Angular momentum makes rotations cheap and keeps its norm exactly; divided by the middle moment, it
// is at most twice the spin. None: for point masses, which have no orientation either.
enum class Spin : std::uint8_t { angular_velocity, angular_momentum, none };

// The spin about the three body axes. An angular velocity drives its own change by its rounded value, so that value is
// shaped (numbers/carried.hpp).
template <class N, Spin spin>
using SpinNumber = std::conditional_t<spin == Spin::angular_velocity, Shaped<typename N::Turn, N::carry>,
                                      Carried<typename N::Turn, N::carry>>;

template <class N, Spin spin>
struct SpinVec3 {
    SpinNumber<N, spin> x, y, z;

    [[nodiscard]] TUMBLE_INLINE Vec3<typename N::Turn> value() const { return {x.value(), y.value(), z.value()}; }
    [[nodiscard]] TUMBLE_INLINE Vec3<typename N::Turn> take() { return {x.take(), y.take(), z.take()}; }
    [[nodiscard]] constexpr auto& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    [[nodiscard]] constexpr const auto& operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    friend constexpr bool operator==(const SpinVec3&, const SpinVec3&) = default;
};

// All that a step writes of one body.
template <class N, Spin spin>
struct BodyState {
    IntegratedVec3<N, typename N::Position> x_w;  // m, of the centre of mass
    IntegratedVec3<N, typename N::Drift> d_w;     // velocity, as displacement per step
    IntegratedQuat<N> q_wb;                       // unit quaternion; body (principal axes) to world
    SpinVec3<N, spin> t_b;                        // half the angle in a step, rad: h/2 omega, or h/2 L / I_y

    friend constexpr bool operator==(const BodyState&, const BodyState&) = default;
};
// The state of a point mass, in a world that has only point masses.
template <class N>
struct BodyState<N, Spin::none> {
    IntegratedVec3<N, typename N::Position> x_w;  // m
    IntegratedVec3<N, typename N::Drift> d_w;     // velocity, as displacement per step

    friend constexpr bool operator==(const BodyState&, const BodyState&) = default;
};

}  // namespace tumble
