// Sums without rounding loss: Carried, Shaped and Dither.
#include <tumble/integrators/butcher.hpp>
#include <tumble/numbers/systems.hpp>

#include "random.hpp"
#include "tolerances.hpp"
#include "worlds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tumble::test {
namespace {

constexpr int steps = 1000000;

TEST(carried, a_million_constant_fixed_increments_lose_nothing) {
    auto x = Carried<Fixed<24>, true>::from(Real{1});
    auto biased = Carried<Fixed<24>, true, true>::from(Real{1});
    const std::int64_t increment = 123456789;  // 0.029 units of the value's last place
    for (int i = 0; i < steps; ++i) {
        x.add({increment});
        biased.add({increment});
    }
    const std::int64_t exact = (std::int64_t{1} << 56) + increment * steps;
    EXPECT_EQ(x.sum().raw, exact);
    EXPECT_EQ(biased.sum().raw, exact);
    EXPECT_EQ(number(x.to_real()), std::ldexp(static_cast<Number>(exact), -56));
}

TEST(carried, reads_the_nearest_value_biased_or_not) {
    Random random{1};
    for (int i = 0; i < tests::many; ++i) {
        const Wide<52> sum{random.int64() >> 1};
        const auto nearest = static_cast<std::int32_t>((sum.raw + (std::int64_t{1} << 31)) >> 32);
        const auto plain = Carried<Fixed<20>, true>::from_sum(sum);
        const auto biased = Carried<Fixed<20>, true, true>::from_sum(sum);
        ASSERT_EQ(plain.sum(), sum);
        ASSERT_EQ(biased.sum(), sum);
        ASSERT_EQ(plain.value().raw, nearest);
        ASSERT_EQ(biased.value().raw, nearest);
        ASSERT_EQ((Carried<Fixed<20>, false>::from_sum(sum).value().raw), nearest);
    }
    EXPECT_EQ((Carried<Fixed<20>, true, true>{}.value().raw), 0);
    EXPECT_EQ((Carried<Fixed<20>, true>{}.sum().raw), 0);
}

TEST(carried, without_carry_a_fixed_sum_rounds_every_increment) {
    auto x = Carried<Fixed<24>, false>::from(Real{});
    for (int i = 0; i < 1000; ++i) x.add({std::int64_t{3} << 30});  // 3/4 of a unit
    EXPECT_EQ(x.value().raw, 1000);
    auto y = Carried<Fixed<24>, false>::from(Real{});
    for (int i = 0; i < 1000; ++i) y.add({std::int64_t{1} << 30});  // 1/4
    EXPECT_EQ(y.value().raw, 0);
}

template <class T>
void expect_kahan(const Bound& worst) {
    const T increment = T(0.1);
    auto compensated = Carried<T, true>::from(Real{1000});
    auto plain = Carried<T, false>::from(Real{1000});
    for (int i = 0; i < steps; ++i) {
        compensated.add(increment);
        plain.add(increment);
    }
    const Number exact = 1000 + static_cast<Number>(increment) * steps;
    EXPECT_LE(std::abs(number(compensated.to_real()) / exact - 1), worst);
    EXPECT_GT(std::abs(number(plain.to_real()) / exact - 1),
              10 * static_cast<Number>(std::numeric_limits<T>::epsilon()));
}
TEST(carried, a_million_float_increments_keep_twice_the_digits) { expect_kahan<float>(tolerance::kahan_f32); }
TEST(carried, a_million_double_increments_keep_twice_the_digits) { expect_kahan<double>(tolerance::kahan_f64); }

TEST(carried, starts_with_more_digits_than_its_value_has) {
    const Real third = Real{1} / Real{3};
    EXPECT_LE(std::abs(number((Carried<float, true>::from(third).to_real()) - third)), tolerance::residual);
    EXPECT_LE(std::abs(number((Carried<Fixed<30>, true>::from(third).to_real()) - third)), tolerance::residual);
    EXPECT_EQ((Carried<double, false>::from(third).value()), 1.0 / 3.0);
}

TEST(carried, float_conversions_to_real_are_exact) {
    Random random{2};
    for (int i = 0; i < tests::many; ++i) {
        const auto f = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits()));
        if (!std::isfinite(f)) continue;
        ASSERT_EQ(to_real(f).to_float(), f);
        ASSERT_EQ(to_real(f).to_double(), static_cast<double>(f));
    }
}

TEST(shaped, the_mean_of_the_values_taken_is_the_sum_itself) {
    Random random{3};
    for (int trial = 0; trial < 100; ++trial) {
        const Wide<64> sum{random.int64() >> 2};
        auto x = Shaped<Fixed<32>, true>::from_sum(sum);
        std::int64_t taken = 0;
        const int n = 100000;
        for (int i = 0; i < n; ++i) taken += x.take().raw;
        const Number exact = std::ldexp(static_cast<Number>(sum.raw), -32) * n;
        ASSERT_LE(std::abs(static_cast<Number>(taken) - exact), tolerance::shaped_units);
        ASSERT_EQ(x.sum(), sum);  // take() does not change the sum
    }
}

TEST(shaped, follows_a_changing_sum) {
    auto x = Shaped<Fixed<32>, true>::from(Real{0.01});
    std::int64_t taken = 0;
    Number exact = 0;
    for (int i = 0; i < 100000; ++i) {
        taken += x.take().raw;
        exact += std::ldexp(static_cast<Number>(x.sum().raw), -32);
        x.add({(i % 7 - 3) * std::int64_t{987654321}});
    }
    EXPECT_LE(std::abs(static_cast<Number>(taken) - exact), tolerance::shaped_units);
}

// The largest distance of the sum of floor(value + dither) from the exact sum, in units, over the steps.
Number worst_dither_error(Number value, std::uint32_t Dither::*sequence) {
    Number worst = 0;
    std::int64_t sum = 0;
    for (std::uint32_t step = 0; step < 100000; ++step) {
        sum += static_cast<std::int64_t>(
            std::floor(value + static_cast<Number>(Dither::of_step(step).*sequence) * 0x1p-32L));
        worst = std::max(worst, std::abs(static_cast<Number>(sum) - value * static_cast<Number>(step + 1)));
    }
    return worst;
}

TEST(dither, the_sum_of_rounded_constants_stays_within_a_few_units) {
    Random random{4};
    std::vector<Number> values{0.5L, 0.25L, 1 / 3.0L, 0.0L};
    for (int i = 0; i < 30; ++i) values.push_back(random.uniform(-5, 5));
    for (const Number value : values) {
        for (const auto sequence : {&Dither::angle, &Dither::delta, &Dither::turn})
            EXPECT_LE(worst_dither_error(value, sequence), tolerance::dither_units) << static_cast<double>(value);
    }
}

TEST(dither, the_three_sequences_do_not_correlate) {
    const auto correlation = [](std::uint32_t Dither::*a, std::uint32_t Dither::*b) {
        const int n = 100000;
        Number sum = 0;
        for (std::uint32_t step = 0; step < n; ++step) {
            const Dither d = Dither::of_step(step);
            sum += (static_cast<Number>(d.*a) * 0x1p-32L - 0.5L) * (static_cast<Number>(d.*b) * 0x1p-32L - 0.5L);
        }
        return std::abs(sum / n * 12);
    };
    EXPECT_LE(correlation(&Dither::angle, &Dither::delta), tolerance::dither_correlation);
    EXPECT_LE(correlation(&Dither::angle, &Dither::turn), tolerance::dither_correlation);
    EXPECT_LE(correlation(&Dither::delta, &Dither::turn), tolerance::dither_correlation);
}

TEST(range, every_rational_of_a_table_knows_whether_it_is_dyadic) {
    static_assert(Rational{1, 2}.is_dyadic() && Rational{3, 8}.is_dyadic() && !Rational{1, 6}.is_dyadic());
    static_assert(Rational{}.is_zero());
}

}  // namespace
}  // namespace tumble::test
