// Dither: rounding offsets for quantities that would be rounded the same way at every step.
// A constant spin rounded to nearest has a constant error, which grows with time. A low-discrepancy sequence in place
// of the one half makes the mean of the rounded values exact: after N steps the sum is off by O(log N) units, not N/2.
// The sequences are Weyl's, n * alpha mod 1, with the alphas of M. Roberts' R3 sequence so that three roundings in one
// step do not correlate. They depend on the step number alone, so every machine and every replay uses the same ones.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

struct Dither {
    std::uint32_t angle, delta, turn;  // fractions of a unit, in 2^-32

    [[nodiscard]] static constexpr Dither of_step(std::uint32_t step) {
        return {step * 0xd1b54a33u, step * 0xabc98389u, step * 0x8cb92ba7u};
    }
};

}  // namespace tumble
