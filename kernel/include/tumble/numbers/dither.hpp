// Dither: rounding offsets for quantities that every step would round the same way.
// A constant spin that is rounded to nearest has a constant error, which adds up over the steps. With an offset from a
// low-discrepancy sequence in place of 1/2, the mean of the rounded values is exact: after N steps the sum is off by
// O(log N) units instead of N/2.
// The sequences are Weyl's, n * alpha mod 1, with the alphas of M. Roberts' R3 sequence, so that the three roundings of
// a step do not correlate. They depend on the number of the step alone, so they are the same on every machine and in
// every replay.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

struct Dither {
    std::uint32_t angle, delta, turn;  // fractions of a unit, in 2^-32

    [[nodiscard]] static constexpr Dither of_step(std::uint32_t step) {
        return {step * factor(0xd1b54a33u), step * factor(0xabc98389u), step * factor(0x8cb92ba7u)};
    }

private:
    // Hides the factor from the compiler, which would make 15 shifts and sums of a product that takes one cycle.
    [[nodiscard]] TUMBLE_INLINE static constexpr std::uint32_t factor(std::uint32_t value) {
#if defined(__ARM_ARCH_6M__)
        if (!std::is_constant_evaluated()) asm("" : "+r"(value));
#endif
        return value;
    }
};

}  // namespace tumble
