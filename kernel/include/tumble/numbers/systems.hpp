// Number systems: Q32<Range> (integers only), F32 and F64. Each names the type of every physical quantity and the few
// operations that differ between fixed and floating point, so that loads, integrators and contacts are written once.
//
// Inside a world time is counted in steps, not seconds. Velocity is kept as `Drift`, the displacement per step, and
// spin as `Turn`, half the angle turned per step: position += drift, and a half turn is what a quaternion needs. The
// step size then enters only when constants are made, so a step such as 0.005 s costs no accuracy and no cycles.
#pragma once

#include <tumble/numbers/ieee.hpp>
#include <tumble/numbers/named_list.hpp>
#include <tumble/numbers/q32_block.hpp>
#include <tumble/numbers/q32_contact.hpp>

namespace tumble {

// 64 m, 32 m/s, 32 rad/s.
using NearRange = Range<64, 32, 32>;
// 1024 m, 128 m/s, 64 rad/s: the default.
using RoomRange = Range<>;
// 32768 m, 2048 m/s, 256 rad/s.
using FieldRange = Range<32768, 2048, 256>;
// The ranges to choose from, the smallest first, under the names that scenes use.
using Ranges = NamedList<NamedRange<"near", NearRange>, NamedRange<"room", RoomRange>, NamedRange<"field", FieldRange>>;

// The list of number systems: builds (lists.cmake), the simulator, firmware and tests take theirs from here, so a new
// one is its type and one entry. Of those of one type, the first is what a scene gets that asks neither for a carried
// residual nor for none.
// clang-format off
using NumberSystems = NamedList<
    FixedPoint<"q32", Q32, true>,
    FixedPoint<"q32_plain", Q32, false>,
    FloatingPoint<"f32", float, true>,
    FloatingPoint<"f32_plain", float, false>,
    FloatingPoint<"f64", double, false>,
    FloatingPoint<"f64_carried", double, true, Runs::on_the_host>>;
// clang-format on

// The type of the number system of a name, for the range that a scene declares: NumbersOf<"q32", NearRange>.
template <detail::Name name, class Range>
using NumbersOf = typename NumberSystems::Named<name>::template Numbers<Range>;
// The range of a name: RangeOf<"near">.
template <detail::Name name>
using RangeOf = typename Ranges::Named<name>::Range;

// Float with compensated sums: carried residuals.
using F32 = Float<float, true>;
// Float as it is, the fastest with an FPU.
using F32Plain = Float<float, false>;
// Double.
using F64 = Float<double, false>;
// Double with compensated sums.
using F64Carried = Float<double, true>;

}  // namespace tumble
