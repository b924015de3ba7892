// VectorBlock and AxisOrder: the vectors that a program gives to a world in fixed point and reads from it. Every
// rounding is compared with exact arithmetic.
#include <tumble/tumble.hpp>

#include "random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

TEST(Sums, times_a_power_of_two_are_rounded_to_nearest_and_held_at_the_widest_sum) {
    Random random{6};
    const auto widest = static_cast<long double>(N::widest);
    for (int n = 0; n < 6300; ++n) {
        const auto raw = static_cast<std::int64_t>(
            std::ldexp(static_cast<long double>(random.uniform(-1, 1)), random.between(1, 62)));
        const int up = random.between(-70, 70);
        const long double right = std::clamp(nearest(std::ldexp(static_cast<long double>(raw), up)), -widest, widest);
        EXPECT_EQ(static_cast<long double>(N::shifted(raw, up)), right) << raw << " * 2^" << up;
    }
}

struct Rates {
    Scaled of[3];
    [[nodiscard]] Scaled per_half_turn(int i) const { return of[i]; }
};
TEST(Blocks, of_turns_times_rates_are_right_to_28_bits_of_the_largest) {
    Random random{3};
    const N::Scale scale = N::Scale::of(Real{1} / Real{256}, Real{1} / Real{256});
    for (int n = 0; n < 6000; ++n) {
        N::TurnSum turns[3];
        Rates rates;
        long double expected[3], largest = 0;
        for (int i = 0; i < 3; ++i) {
            turns[i].raw = static_cast<std::int64_t>(std::ldexp(static_cast<long double>(random.uniform(-1, 1)), 62)) >>
                           random.between(0, 61);
            rates.of[i] = Scaled{std::ldexp(1 + random.uniform(0, 1), random.between(0, 12))};
            expected[i] = std::ldexp(static_cast<long double>(turns[i].raw), -(64 + scale.turn_shift)) *
                          static_cast<long double>(static_cast<double>(rates.of[i]));
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

// Any finite float: mantissas with few digits, which make ties, as often as with many.
float any_float(Random& random) {
    const auto bits = static_cast<std::uint32_t>(random.bits()) & (0xff800000u | 0xffffffffu << random.between(0, 23));
    return std::isfinite(std::bit_cast<float>(bits)) ? std::bit_cast<float>(bits) : 1;
}

TEST(Blocks, are_the_same_from_floats_by_instructions_and_by_shifts) {
    Random random{11};
    for (int n = 0; n < 200000; ++n) {
        const float x = any_float(random);
        // The others within 40 powers of two of it, above and below.
        float other[2];
        for (float& c : other) {
            c = std::ldexp(any_float(random), random.between(-3, 3));
            if (n % 8 != 0) {
                int ignored = 0;
                c = std::ldexp(std::frexp(c, &ignored), (x == 0 ? 0 : std::ilogb(x)) + random.between(-40, 2));
            }
            if (!std::isfinite(c)) c = 0;
        }
        const Block shifts = Block::of<false>(other[0], x, other[1]),
                    instructions = Block::of<true>(other[0], x, other[1]);
        ASSERT_EQ(shifts.exponent, instructions.exponent);
        for (int i = 0; i < 3; ++i)
            ASSERT_EQ(shifts.mantissa[i], instructions.mantissa[i]) << other[0] << ' ' << x << ' ' << other[1];
    }
}

TEST(Blocks, become_the_same_floats_by_instructions_and_by_shifts) {
    Random random{12};
    const auto word = [&] { return random.int32() >> random.between(0, 31); };
    for (int n = 0; n < 200000; ++n) {
        const int exponent = random.between(-200, 130);
        const std::int32_t a = word(), b = word(), c = word();
        const Block block{{a / 2, b / 2, c / 2}, exponent};
        const Vector3<float> shifts = block.floats<false>(), instructions = block.floats<true>();
        ASSERT_TRUE(shifts == instructions) << a << ' ' << b << ' ' << c << ' ' << exponent;
        ASSERT_EQ(detail::to_float<false>(a, exponent), detail::to_float<true>(a, exponent)) << a << ' ' << exponent;
        const std::int64_t wide = (std::int64_t{a} * 0x100000000 + b) >> random.between(0, 31) | (n & 1);
        ASSERT_EQ(detail::to_float<false>(wide, exponent), detail::to_float<true>(wide, exponent))
            << wide << ' ' << exponent;
    }
}

TEST(Blocks, of_a_format_are_exact_to_29_bits_and_come_back_to_the_nearest) {
    Random random{13};
    using Q = Fixed<20>;
    for (int n = 0; n < 20000; ++n) {
        const int size = random.between(0, 31);
        Q v[3];
        for (Q& c : v) c = Q::from_raw(random.int32() >> size);
        const Block block = Block::of(v[0], v[1], v[2]);
        const Vector3<Q> back = block.as<Q>();
        for (int i = 0; i < 3; ++i) {
            const long double exact = std::ldexp(static_cast<long double>(v[i].raw), -20);
            EXPECT_EQ(block.mantissa[i], nearest(std::ldexp(exact, -block.exponent)));
            EXPECT_EQ(back[i].raw, size < 3 ? nearest(std::ldexp(value(block, i), 20)) : v[i].raw);
        }
    }
    EXPECT_EQ((Block{{1 << 28, -(1 << 28), 0}, -10}.as<Q>().x.raw), INT32_MAX) << "saturates";
    EXPECT_EQ((Block{{1 << 28, -(1 << 28), 0}, -10}.as<Q>().y.raw), -INT32_MAX) << "saturates";
}

TEST(Products, of_a_format_round_to_nearest) {
    using Q = Fixed<20>;
    constexpr auto of = [](double x) { return Q::from(Real{x}); };
    EXPECT_EQ(of(1.5) * of(-2.25), of(-3.375));
    EXPECT_EQ(Q{3} * of(0.5), Q{2}) << "ties upwards";
    EXPECT_EQ(Q{-3} * of(0.5), Q{-1});
    EXPECT_EQ((Quaternion<Q>{}.w), of(1));
    const Quaternion<Q> turn{of(0.5), {of(0.5), of(0.5), of(0.5)}};  // x to y, y to z, z to x
    EXPECT_TRUE((turn.rotate({of(1), of(2), of(3)}) == Vector3<Q>{of(3), of(1), of(2)}));
    EXPECT_TRUE((turn.conjugate() * turn == Quaternion<Q>{}));
}

TEST(Orientations, that_a_program_sets_are_normalised_to_their_rounding) {
    Random random{14};
    for (int n = 0; n < 20000; ++n) {
        // Of any length; the components differ by up to 40 powers of two.
        long double c[4], norm = 0;
        Scaled q[4];
        const int length = random.between(-1000, 1000);
        for (int i = 0; i < 4; ++i) {
            q[i] = Scaled{random.uniform(-1, 1)}.times_power_of_two(n % 4 == 0 ? random.between(-40, 0) : 0);
            c[i] = static_cast<double>(q[i]);
            norm += c[i] * c[i];
            q[i] = q[i].times_power_of_two(length);
        }
        norm = std::sqrt(norm);
        const Quaternion<Scaled> given{q[0], {q[1], q[2], q[3]}};
        // Before the last correction the length is 1 to 2^-22, and to the rounding of 30 bits after it.
        const Quat<N::Unit> unit = detail::unit_of<N>(given);
        EXPECT_LE(std::abs(static_cast<long double>(static_cast<double>(unit.w)) - c[0] / norm), 0x1p-21L);
        IntegratedQuat<N> state;
        set_product<N>(state, given, {N::Unit::from(1), {N::Unit{}, N::Unit{}, N::Unit{}}});
        const auto component = [](const auto& number) {
            return std::ldexp(static_cast<long double>(number.sum().raw), -62);
        };
        const long double got[4]{component(state.w), component(state.x), component(state.y), component(state.z)};
        // A component of the rounded quaternion is off by 2^-31, its mantissa by as much, and its length is corrected.
        for (int i = 0; i < 4; ++i) EXPECT_LE(std::abs(got[i] - c[i] / norm), 0x1p-29L) << n;
    }
}

}  // namespace
}  // namespace tumble::test
