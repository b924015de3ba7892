// Number systems: Q32<Range> (integers only), F32 and F64. Each names the type of every physical quantity, and has the
// few operations that differ between fixed and floating point. Loads, integrators and contacts are therefore written
// once.
//
// A world counts time in steps, not in seconds. It keeps a velocity as `Drift`, the displacement in a step, and a spin
// as `Turn`, half the angle in a step: position += drift, and quaternions contain half angles. The step then enters
// only the constants, so a step such as 0.005 s costs no accuracy and no cycles.
#pragma once

#include <tumble/numbers/ieee.hpp>
#include <tumble/numbers/named_list.hpp>
#include <tumble/numbers/q32_block.hpp>
#include <tumble/numbers/q32_contact.hpp>

namespace tumble {

namespace detail {

// Calls f(i) for the three axes: a loop in fixed point, and three calls in floating point, where an axis is a few
// instructions.
template <class N, class F>
TUMBLE_INLINE constexpr void for_axes(F&& f) {
    if constexpr (N::fixed_point) {
        for (int i = 0; i < 3; ++i) f(i);
    } else {
        f(0);
        f(1);
        f(2);
    }
}

}  // namespace detail

// 64 m, 32 m/s, 32 rad/s.
using NearRange = Range<64, 32, 32>;
// 1024 m, 128 m/s, 64 rad/s: the default.
using RoomRange = Range<>;
// 32768 m, 2048 m/s, 256 rad/s.
using FieldRange = Range<32768, 2048, 256>;
// The ranges to choose from, the smallest first, with their names in scenes.
using Ranges = NamedList<NamedRange<"near", NearRange>, NamedRange<"room", RoomRange>, NamedRange<"field", FieldRange>>;

// The list of number systems. Builds (lists.cmake), the simulator, firmware and tests read it, so a new system is its
// type and one entry. Among systems of one type, the first is the default of a scene that does not choose a carried
// residual.
// clang-format off
using NumberSystems = NamedList<
    FixedPoint<"q32", Q32, true>,
    FixedPoint<"q32_plain", Q32, false>,
    FloatingPoint<"f32", float, true>,
    FloatingPoint<"f32_plain", float, false>,
    FloatingPoint<"f64", double, false>,
    FloatingPoint<"f64_carried", double, true, Runs::on_the_host>>;
// clang-format on

// The number system of this name, for a scene's range: NumbersOf<"q32", NearRange>.
template <detail::Name name, class Range>
using NumbersOf = typename NumberSystems::Named<name>::template Numbers<Range>;
// The range of this name: RangeOf<"near">.
template <detail::Name name>
using RangeOf = typename Ranges::Named<name>::Range;

// Float with carried residuals, by compensated sums.
using F32 = Float<float, true>;
// Plain float: the fastest system with an FPU.
using F32Plain = Float<float, false>;
// Double.
using F64 = Float<double, false>;
// Double with carried residuals, by compensated sums.
using F64Carried = Float<double, true>;

}  // namespace tumble
