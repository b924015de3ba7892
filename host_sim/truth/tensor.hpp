// A symmetric tensor of second order, by its rows.
#pragma once

#include "truth/motion.hpp"

namespace tumble::reference {

struct Tensor {
    Vector x, y, z;

    [[nodiscard]] Vector operator*(const Vector& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
    // The adjugate divided by the determinant.
    [[nodiscard]] Tensor inverse() const {
        const Vector a = cross(y, z), b = cross(z, x), c = cross(x, y);
        const Number scale = 1 / dot(x, a);
        return {a * scale, b * scale, c * scale};
    }
};

}  // namespace tumble::reference
