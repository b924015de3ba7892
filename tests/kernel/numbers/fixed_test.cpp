// Fixed, Wide, Scaled and Eigen's storage of them against exact integers and long double.
#include <tumble/numbers/scaled.hpp>
#include <tumble/numbers/systems.hpp>

#include "random.hpp"
#include "tolerances.hpp"
#include "worlds.hpp"

#include <cmath>
#include <limits>

namespace tumble::test {
namespace {

constexpr std::int32_t lowest = std::numeric_limits<std::int32_t>::min(),
                       highest = std::numeric_limits<std::int32_t>::max();

TEST(fixed, converts_from_real_to_the_nearest_and_saturates) {
    static_assert(Fixed<8>::from(Real{1.5}).raw == 384);
    static_assert(Fixed<30>::from(Real{100}).raw == highest);
    static_assert(Fixed<30>::from(Real{-100}).raw == -highest);
    static_assert(Fixed<0>::from(Real{2.5}).raw == 3 && Fixed<0>::from(Real{-2.5}).raw == -3);
    Random random{1};
    for (int i = 0; i < tests::many; ++i) {
        const double d = random.uniform(-4, 4);
        const double expected = std::min(std::max(std::round(d * 0x1p30), -0x1.fffffffcp30), 0x1.fffffffcp30);
        ASSERT_EQ(static_cast<double>(Fixed<30>::from(Real{d}).raw), expected);
    }
}

TEST(fixed, converts_to_double_exactly_and_to_float_nearest) {
    Random random{2};
    for (int i = 0; i < tests::many; ++i) {
        const auto a = Fixed<27>::from_raw(random.int32());
        ASSERT_EQ(static_cast<double>(a), std::ldexp(static_cast<double>(a.raw), -27));
        ASSERT_EQ(static_cast<float>(a), static_cast<float>(std::ldexp(static_cast<double>(a.raw), -27)));
    }
    EXPECT_EQ(static_cast<double>(Fixed<32>::from_raw(lowest)), -0.5);
}

TEST(fixed, sums_wrap_at_two_to_the_32) {
    constexpr auto top = Fixed<16>::from_raw(highest), bottom = Fixed<16>::from_raw(lowest),
                   unit = Fixed<16>::from_raw(1);
    static_assert((top + unit) == bottom);
    static_assert((bottom - unit) == top);
    static_assert(-bottom == bottom);
    Random random{3};
    for (int i = 0; i < tests::many; ++i) {
        const std::int32_t a = random.int32(), b = random.int32();
        ASSERT_EQ((Fixed<5>{a} + Fixed<5>{b}).raw, static_cast<std::int32_t>(static_cast<std::int64_t>(a) + b));
        ASSERT_EQ((Fixed<5>{a} - Fixed<5>{b}).raw, static_cast<std::int32_t>(static_cast<std::int64_t>(a) - b));
        ASSERT_EQ(Fixed<5>{a} < Fixed<5>{b}, a < b);
    }
}

TEST(fixed, products_are_exact_and_their_sums_wrap_at_two_to_the_64) {
    Random random{4};
    for (int i = 0; i < tests::many; ++i) {
        const std::int32_t a = random.int32(), b = random.int32();
        const std::int64_t s = random.int64(), product = static_cast<std::int64_t>(a) * b;
        ASSERT_EQ(mul(Fixed<30>{a}, Fixed<20>{b}).raw, product);
        ASSERT_EQ(mul_add(Wide<50>{s}, Fixed<30>{a}, Fixed<20>{b}).raw,
                  static_cast<std::int64_t>(static_cast<std::uint64_t>(s) + static_cast<std::uint64_t>(product)));
        if (a != lowest) {
            ASSERT_EQ(mul_sub(Wide<50>{s}, Fixed<30>{a}, Fixed<20>{b}).raw,
                      static_cast<std::int64_t>(static_cast<std::uint64_t>(s) - static_cast<std::uint64_t>(product)));
        }
        ASSERT_EQ((Wide<3>{s} + Wide<3>{product}).raw,
                  static_cast<std::int64_t>(static_cast<std::uint64_t>(s) + static_cast<std::uint64_t>(product)));
        ASSERT_EQ((-Wide<3>{s}).raw, static_cast<std::int64_t>(0u - static_cast<std::uint64_t>(s)));
    }
    EXPECT_EQ(mul(Fixed<31>{lowest}, Fixed<31>{lowest}).raw, std::int64_t{1} << 62);
}

TEST(fixed, narrows_to_the_nearest_with_ties_upwards) {
    EXPECT_EQ(narrow<Fixed<0>>(Wide<1>{1}).raw, 1);    // 0.5
    EXPECT_EQ(narrow<Fixed<0>>(Wide<1>{-1}).raw, 0);   // -0.5
    EXPECT_EQ(narrow<Fixed<0>>(Wide<1>{-3}).raw, -1);  // -1.5
    Random random{5};
    for (int i = 0; i < tests::many; ++i) {
        const std::int64_t raw = random.int64() >> 2;
        const Number exact = std::ldexp(static_cast<Number>(raw), -32);
        ASSERT_EQ(static_cast<Number>(narrow<Fixed<10>>(Wide<42>{raw}).raw), std::floor(exact + Number(0.5)));
    }
}

TEST(fixed, mean_rounding_error_of_narrow_is_zero) {
    std::int64_t sum = 0;
    for (int i = 0; i < 1 << 16; ++i) sum += (static_cast<std::int64_t>(narrow<Fixed<16>>(Wide<24>{i}).raw) << 8) - i;
    EXPECT_EQ(sum, (1 << 16) / 2);  // only the ties, one in 256, are rounded half a unit (128) up
}

// Numbers of many magnitudes, with extremes among them.
Scaled random_scaled(Random& random, int least_exponent = -60, int greatest_exponent = 60) {
    return Scaled::of(random.int64() >> random.between(0, 62), random.between(least_exponent, greatest_exponent));
}
Number exactly(Scaled a) { return std::ldexp(static_cast<Number>(a.mantissa()), a.exponent()); }
Number relative_error(Scaled a, Number exact) {
    return exact == 0 ? std::abs(exactly(a)) : std::abs(exactly(a) / exact - 1);
}

TEST(scaled, keeps_31_bits_of_everything) {
    Random random{6};
    for (int i = 0; i < tests::many; ++i) {
        const std::int64_t raw = random.int64() >> random.between(0, 63);
        ASSERT_LE(relative_error(Scaled::of(raw, 7), std::ldexp(static_cast<Number>(raw), 7)), tolerance::scaled_unit);
        const Scaled a = random_scaled(random), b = random_scaled(random);
        const Number x = exactly(a), y = exactly(b);
        ASSERT_LE(relative_error(a * b, x * y), tolerance::scaled_unit);
        if (!b.is_zero()) { ASSERT_LE(relative_error(a / b, x / y), tolerance::scaled_quotient); }
        ASSERT_LE(std::abs(exactly(a + b) - (x + y)),
                  tolerance::scaled_sum *
                      std::max(std::abs(x + y), Number(0x1p-31) * std::max(std::abs(x), std::abs(y))));
        ASSERT_LE(std::abs(exactly(a - b) - (x - y)),
                  tolerance::scaled_sum *
                      std::max(std::abs(x - y), Number(0x1p-31) * std::max(std::abs(x), std::abs(y))));
        ASSERT_EQ(exactly(-a), -x);
        ASSERT_EQ(exactly(a.times_power_of_two(-9)), x / 512);
    }
}

TEST(scaled, stays_normalised_at_the_extremes) {
    for (const std::int64_t raw : {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(),
                                   std::int64_t{1}, std::int64_t{-1}, std::int64_t{0x7fffffff},
                                   std::int64_t{0x80000000}, std::int64_t{0xffffffff}, -std::int64_t{0x80000000}}) {
        const Scaled a = Scaled::of(raw, 0);
        EXPECT_LE(relative_error(a, static_cast<Number>(raw)), tolerance::scaled_unit);
        const std::int64_t m = std::abs(static_cast<std::int64_t>(a.mantissa()));
        EXPECT_TRUE(m >= 1 << 30 && m <= 0x7fffffff) << raw;
    }
    EXPECT_EQ(Scaled::of(0, 99), Scaled{});
    EXPECT_EQ(Scaled{1} - Scaled{1}, Scaled{});
    EXPECT_EQ(Scaled{3} * Scaled{}, Scaled{});
    EXPECT_EQ(static_cast<double>(Scaled{-7}), -7);
    EXPECT_EQ(Scaled::from(Real{}), Scaled{});
}

// A comparison with 0.009 is one with 0 where the literal becomes an int.
template <class T>
concept ComparesWith = requires(Scaled a, T b) {
    a < b;
};
TEST(scaled, takes_whole_numbers_but_no_fraction_in_silence) {
    static_assert(ComparesWith<int> && ComparesWith<std::int16_t> && ComparesWith<bool> && ComparesWith<Scaled>);
    static_assert(!ComparesWith<double> && !ComparesWith<float> && !std::is_convertible_v<double, Scaled>);
    EXPECT_EQ(Scaled(std::int16_t{-7}), Scaled{-7});
}

TEST(scaled, agrees_with_real_both_ways) {
    Random random{7};
    for (int i = 0; i < tests::many; ++i) {
        const double d = std::ldexp(random.uniform(-1, 1), random.between(-300, 300));
        ASSERT_LE(relative_error(Scaled::from(Real{d}), static_cast<Number>(d)), tolerance::scaled_unit);
        const Scaled a = random_scaled(random);
        ASSERT_EQ(number(a.to_real()), exactly(a));
        ASSERT_EQ(Scaled::from(a.to_real()), a);
    }
}

TEST(scaled, orders_like_long_double) {
    Random random{8};
    for (int i = 0; i < tests::many; ++i) {
        const Scaled a = random_scaled(random, -3, 3), b = random.between(0, 9) == 0 ? a : random_scaled(random, -3, 3);
        ASSERT_EQ(a < b, exactly(a) < exactly(b));
        ASSERT_EQ(a > b, exactly(a) > exactly(b));
        ASSERT_EQ(a <= b, exactly(a) <= exactly(b));
        ASSERT_EQ(a >= b, exactly(a) >= exactly(b));
        ASSERT_EQ(a == b, exactly(a) == exactly(b));
    }
    const Scaled zero{};
    EXPECT_FALSE(zero < zero);
    EXPECT_TRUE(Scaled{-1} < zero && zero < Scaled{1});
    EXPECT_TRUE(Scaled::of(1, -200) > zero && Scaled::of(-1, -200) < zero);
}

TEST(scaled, square_root_keeps_31_bits_and_negative_counts_as_zero) {
    Random random{9};
    for (int i = 0; i < tests::many; ++i) {
        Scaled a = random_scaled(random);
        if (a < Scaled{}) a = -a;
        ASSERT_LE(relative_error(sqrt(a), std::sqrt(exactly(a))), tolerance::scaled_root) << static_cast<double>(a);
    }
    EXPECT_EQ(sqrt(Scaled{-1}), Scaled{});
    EXPECT_EQ(sqrt(Scaled{}), Scaled{});
    EXPECT_EQ(sqrt(Scaled{4}), Scaled{2});
    EXPECT_EQ(sqrt(Scaled::of(9, -42)), Scaled::of(3, -21));
}

TEST(scaled, becomes_a_sum_rounded_and_saturated) {
    Random random{10};
    for (int i = 0; i < tests::many; ++i) {
        const Scaled a = random_scaled(random, -90, 20);
        const Number limit = 0x1p62L - 1, scaled = std::ldexp(exactly(a), 30);
        const Number expected = std::min(std::max(std::floor(scaled + Number(0.5)), -limit), limit);
        ASSERT_EQ(static_cast<Number>(a.to_wide<30>().raw), expected) << static_cast<double>(a);
        const Number narrow =
            std::min(std::max(std::floor(std::ldexp(exactly(a), 20) + Number(0.5)), Number(-highest)), Number(highest));
        ASSERT_EQ(static_cast<Number>(a.to_fixed<Fixed<20>>().raw), narrow);
    }
    EXPECT_EQ(Scaled::of(1, 500).to_wide<0>().raw, (std::int64_t{1} << 62) - 1);
    EXPECT_EQ(Scaled::of(-1, 500).to_wide<0>().raw, 1 - (std::int64_t{1} << 62));
    EXPECT_EQ(Scaled::of(1, -500).to_wide<0>().raw, 0);
    EXPECT_EQ(Scaled::of(-1, -500).to_wide<0>().raw, 0);
}

TEST(scaled, rounding_is_the_same_for_both_signs) {
    Random random{11};
    for (int i = 0; i < tests::many; ++i) {
        const Scaled a = random_scaled(random), b = random_scaled(random);
        ASSERT_EQ((-a) * b, -(a * b));
        if (!b.is_zero()) { ASSERT_EQ((-a) / b, -(a / b)); }
    }
}

TEST(eigen, stores_fixed_numbers_and_sums_them_element_by_element) {
    using F = Fixed<20>;
    Random random{12};
    for (int i = 0; i < 1000; ++i) {
        const auto component = [&] { return F::from_raw(random.int32() >> 2); };
        const Vec3<F> a{component(), component(), component()}, b{component(), component(), component()};
        const Eigen::Vector3d sum = a.cast<double>() + b.cast<double>(),
                              difference = a.cast<double>() - b.cast<double>();
        ASSERT_EQ((a + b).cast<double>(), sum);
        ASSERT_EQ((a - b).cast<double>(), difference);
        ASSERT_EQ((-a).cast<double>(), -a.cast<double>());
        ASSERT_EQ(a.cast<float>()[1], static_cast<float>(a[1]));
        // A dot product is exact, and rounded once.
        const __int128 exact = static_cast<__int128>(a[0].raw) * b[0].raw + static_cast<__int128>(a[1].raw) * b[1].raw +
                               static_cast<__int128>(a[2].raw) * b[2].raw;
        ASSERT_EQ(dot(a, b).raw, static_cast<std::int64_t>(exact));
        const Vec3<F> c = cross<F>(a, b);
        ASSERT_EQ(c[0], narrow<F>(mul(a[1], b[2]) - mul(a[2], b[1])));
        ASSERT_EQ(c[1], narrow<F>(mul(a[2], b[0]) - mul(a[0], b[2])));
        ASSERT_EQ(c[2], narrow<F>(mul(a[0], b[1]) - mul(a[1], b[0])));
        Eigen::Matrix<F, 6, 1> both;
        both << a, b;
        ASSERT_TRUE((both.segment<3>(3) == b));
        ASSERT_TRUE((Eigen::Map<const Vec3<F>>{a.data()} == a));
    }
}

}  // namespace
}  // namespace tumble::test
