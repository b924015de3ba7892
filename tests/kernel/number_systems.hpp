// The number systems that every test of a whole world covers. One line a system, named as in the tests; the build makes
// a translation unit of each line.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble::test::systems {

using q32_near = Q32<NearRange>;
using q32_field = Q32<FieldRange>;
using q32_plain = Q32<NearRange, false>;
using f32 = F32;
using f32_plain = F32Plain;
using f64 = F64;
using f64_carried = F64Carried;

}  // namespace tumble::test::systems
