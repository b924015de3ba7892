// Number systems: Q32<Range> (integers only), F32 and F64. Each names the type of every physical quantity and the few
// operations that differ between fixed and floating point, so that loads, integrators and contacts are written once.
//
// Inside a world time is counted in steps, not seconds. Velocity is kept as `Drift`, the displacement per step, and
// spin as `Turn`, half the angle turned per step: position += drift, and a half turn is what a quaternion needs. The
// step size then enters only when constants are made, so a step such as 0.005 s costs no accuracy and no cycles.
#pragma once

#include <tumble/numbers/ieee.hpp>
#include <tumble/numbers/q32_block.hpp>
#include <tumble/numbers/q32_contact.hpp>

namespace tumble {

using NearRange = Range<64, 32, 32>;
using RoomRange = Range<>;
using FieldRange = Range<32768, 2048, 256>;

using F32 = Float<float, true>;
using F32Plain = Float<float, false>;
using F64 = Float<double, false>;
using F64Carried = Float<double, true>;

}  // namespace tumble
