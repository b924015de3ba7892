// Set-up numbers in long double, with all their bits, in the vectors of truth/motion.hpp.
#pragma once

#include <tumble/numbers/real.hpp>

#include "truth/motion.hpp"

namespace tumble::host {

// Exact where a long double has 64 bits.
[[nodiscard]] inline reference::Number number(Real value) {
    const double upper = value.to_double();
    return static_cast<reference::Number>(upper) + static_cast<reference::Number>((value - Real{upper}).to_double());
}
[[nodiscard]] inline reference::Vector vector(const RealVec3& v) { return {number(v.x), number(v.y), number(v.z)}; }
[[nodiscard]] inline reference::Rotation rotation(const RealQuat& q) { return {number(q.w), vector(q.v)}; }

}  // namespace tumble::host
