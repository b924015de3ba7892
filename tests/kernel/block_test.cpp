// VectorBlock and AxisOrder: the vectors that a program gives to a world in fixed point and reads from it. Every
// rounding is compared with exact arithmetic.
#include <tumble/tumble.hpp>

#include "random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tumble::test {
namespace {

using N = Q32<NearRange>;
using Block = VectorBlock<N>;

long double value(const Block& block, int i) {
    return std::ldexp(static_cast<long double>(block.mantissa[i]), block.exponent);
}
// The integer nearest to a number that a long double holds, ties upwards.
long double nearest(long double x) { return std::floor(x + 0.5L); }

TEST(Blocks, keep_29_bits_of_the_largest_component_to_nearest_with_ties_away_from_zero) {
    // The unit of a block whose largest component is 1 is 2^-28.
    const Block halves = Block::of(1.0F, 0x1.8p-28F, -0x1.8p-28F), small = Block::of(-1.0F, 0x1p-29F, -0x1p-29F);
    EXPECT_EQ(halves.exponent, -28);
    EXPECT_EQ(halves.mantissa[0], 1 << 28);
    EXPECT_EQ(halves.mantissa[1], 2);
    EXPECT_EQ(halves.mantissa[2], -2);
    EXPECT_EQ(small.mantissa[1], 1);
    EXPECT_EQ(small.mantissa[2], -1);
    EXPECT_TRUE(Block::of(0.0F, -0.0F, 1e-45F).is_zero()) << "numbers below the normal ones are nothing";
}

TEST(Blocks, are_the_same_from_floats_doubles_and_set_up_numbers) {
    Random random{1};
    for (int n = 0; n < 2000; ++n) {
        float v[3];
        for (float& c : v) c = std::ldexp(static_cast<float>(random.uniform(-1, 1)), random.between(-40, 40));
        const Block floats = Block::of(v[0], v[1], v[2]), doubles = Block::of(double{v[0]}, double{v[1]}, double{v[2]}),
                    reals = Block::of(Real{v[0]}, Real{v[1]}, Real{v[2]});
        for (int i = 0; i < 3; ++i) {
            EXPECT_EQ(
                value(floats, i),
                std::ldexp(std::round(std::ldexp(static_cast<long double>(v[i]), -floats.exponent)), floats.exponent));
            EXPECT_EQ(value(floats, i), value(doubles, i)) << v[0] << ' ' << v[1] << ' ' << v[2];
            EXPECT_EQ(value(floats, i), value(reals, i)) << v[0] << ' ' << v[1] << ' ' << v[2];
        }
    }
}

TEST(Blocks, of_sums_round_to_nearest_with_ties_upwards_at_every_size) {
    Random random{2};
    for (int n = 0; n < 6300; ++n) {
        std::int64_t raw[3];
        for (std::int64_t& r : raw)
            r = static_cast<std::int64_t>(std::ldexp(static_cast<long double>(random.uniform(-1, 1)), 63)) >> (n % 63);
        raw[n % 3] |= n % 2;  // ties too
        const Block block = Block::of_sums(raw, 0);
        std::int32_t bits = 0;
        for (int i = 0; i < 3; ++i) {
            EXPECT_EQ(block.mantissa[i], nearest(std::ldexp(static_cast<long double>(raw[i]), -block.exponent)));
            bits |= block.mantissa[i] ^ (block.mantissa[i] >> 31);
        }
        if (raw[0] != 0 || raw[1] != 0 || raw[2] != 0) {
            EXPECT_GE(bits, (1 << 28) - 1);
            EXPECT_LE(bits, (1 << 29));
        }
    }
}

TEST(Blocks, of_turns_times_rates_are_right_to_28_bits_of_the_largest) {
    Random random{3};
    const N::Scale scale = N::Scale::of(Real{1} / Real{256}, Real{1} / Real{256});
    for (int n = 0; n < 6000; ++n) {
        N::TurnSum turns[3];
        Scaled rates[3];
        long double expected[3], largest = 0;
        for (int i = 0; i < 3; ++i) {
            turns[i].raw = static_cast<std::int64_t>(std::ldexp(static_cast<long double>(random.uniform(-1, 1)), 62)) >>
                           random.between(0, 61);
            rates[i] = Scaled{std::ldexp(1 + random.uniform(0, 1), random.between(0, 12))};
            expected[i] = std::ldexp(static_cast<long double>(turns[i].raw), -(64 + scale.turn_shift)) *
                          static_cast<long double>(static_cast<double>(rates[i]));
            largest = std::max(largest, std::abs(expected[i]));
        }
        const Block block = Block::of_turns(turns, scale, rates);
        for (int i = 0; i < 3; ++i) EXPECT_LE(std::abs(value(block, i) - expected[i]), largest * 0x1p-28L) << n;
    }
}

TEST(Blocks, become_the_nearest_floats_with_ties_to_even) {
    Random random{4};
    for (int n = 0; n < 4000; ++n) {
        Block block;
        for (std::int32_t& m : block.mantissa)
            m = static_cast<std::int32_t>(random.uniform(-0x1p30, 0x1p30)) >> (n % 31);
        block.mantissa[n % 3] |= 0x1000001 >> (n % 25);  // ties of floats have their lowest bit here
        block.exponent = n % 5 == 0 ? random.between(-200, 140) : random.between(-90, 60);
        const Vector3<float> floats = block.as<float>();
        for (int i = 0; i < 3; ++i)
            EXPECT_EQ(floats[i], static_cast<float>(std::ldexp(static_cast<double>(block.mantissa[i]), block.exponent)))
                << block.mantissa[i] << " * 2^" << block.exponent;
    }
}

TEST(Blocks, times_a_power_of_two_are_exact_and_times_others_rounded) {
    const Block block = Block::of(1.0F, 0x1.000002p-3F, -3.0F), half = block.times(Scaled{0.5F}),
                third = block.times(Scaled{1} / Scaled{3});
    for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(value(half, i), value(block, i) / 2);
        EXPECT_LE(std::abs(value(third, i) - value(block, i) / 3), 0x1p-28L);
    }
}

TEST(AxisOrders, are_the_rotation_to_principal_axes_of_every_diagonal_tensor) {
    const Real moments[6][3] = {{3, 2, 1.5}, {3, 1.5, 2}, {2, 3, 1.5}, {1.5, 3, 2}, {2, 1.5, 3}, {1.5, 2, 3}};
    for (const auto& m : moments) {
        const PrincipalInertia inertia = principal_inertia({m[0], m[1], m[2], 0, 0, 0});
        ASSERT_TRUE(inertia.order.is_known());
        const RealVec3 user{1, 2, 4}, expected = inertia.principal.conjugate().rotate(user);
        RealVec3 principal, back;
        for (int i = 0; i < 3; ++i) {
            principal[i] = inertia.order.principal(user, i);
            EXPECT_LE(std::abs(static_cast<double>(principal[i] - expected[i])), 1e-15);
        }
        inertia.order.place(back, principal);
        EXPECT_EQ(back, user);
    }
    EXPECT_FALSE(principal_inertia({3, 2, 1.5, 0, 0.25, 0}).order.is_known());
}

}  // namespace
}  // namespace tumble::test
