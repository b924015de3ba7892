// The motion of one rigid body, its mass and its loads, in long double and SI units.
#pragma once

#include "truth/algebra.hpp"

namespace tumble::reference {

using Number = long double;
using Vector = Vec<Number>;
using Rotation = Quaternion<Number>;

// The error of a step of an integration, absolute and relative.
inline constexpr Number tolerance = 1e-17L;

// From arrays x, y, z and w, x, y, z.
[[nodiscard]] Vector vector_of(const auto& array) { return {array[0], array[1], array[2]}; }
[[nodiscard]] Rotation rotation_of(const auto& array) { return {array[0], {array[1], array[2], array[3]}}; }

// World frame: x (m), v (m/s). Body frame along the principal axes: w (rad/s).
struct Motion {
    Vector x{}, v{};
    Rotation q{};
    Vector w{};
};

struct Wrench {
    Vector force_w{}, torque_b{};  // N, N m
};

struct Body {
    Number mass = 1;          // kg
    Vector moments{1, 1, 1};  // kg m^2
};

}  // namespace tumble::reference
