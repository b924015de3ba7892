// Square roots and the rotation series against the processor and long double.
#include <tumble/numbers/functions.hpp>

#include "random.hpp"
#include "tolerances.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tumble::test {
namespace {

template <class T, class Bits, int fraction_bits, int bias>
void expect_root_of_every_pattern(std::uint64_t seed) {
    Random random{seed};
    const auto check = [](T a) {
        const T expected = a > T(0) ? std::sqrt(a) : T(0);
        ASSERT_EQ(std::bit_cast<Bits>(detail::ieee_sqrt<T, Bits, fraction_bits, bias>(a) + T(0)),
                  std::bit_cast<Bits>(expected))
            << a;
        ASSERT_EQ(std::bit_cast<Bits>(tumble::sqrt(a) + T(0)), std::bit_cast<Bits>(expected)) << a;
    };
    for (int i = 0; i < tests::many; ++i) {
        const auto a = std::bit_cast<T>(static_cast<Bits>(random.bits()));
        if (std::isnan(a)) continue;
        check(a);
        check(std::abs(a));
        const T r = std::abs(std::bit_cast<T>(static_cast<Bits>(random.bits() >> 2)));  // squares and numbers near them
        if (std::isfinite(r * r)) {
            check(r * r);
            check(std::nextafter(r * r, T(0)));
            check(std::nextafter(r * r, std::numeric_limits<T>::max()));
        }
        check(std::ldexp(T(1), random.between(-bias - fraction_bits, bias)));
        check(std::ldexp(T(random.between(1, 4095)), -bias - fraction_bits + 1));  // subnormal
    }
    for (const T a : {T(0), -T(0), T(-1), std::numeric_limits<T>::denorm_min(), std::numeric_limits<T>::min(),
                      std::numeric_limits<T>::max(), std::numeric_limits<T>::infinity(),
                      -std::numeric_limits<T>::infinity(), T(1), T(2), T(4)})
        check(a);
}

TEST(functions, square_root_of_a_float_equals_that_of_the_processor) {
    expect_root_of_every_pattern<float, std::uint32_t, 23, 127>(1);
}
TEST(functions, square_root_of_a_double_equals_that_of_the_processor) {
    expect_root_of_every_pattern<double, std::uint64_t, 52, 1023>(2);
}

TEST(functions, square_root_is_a_constant_expression) {
    static_assert(tumble::sqrt(2.0f) == 1.41421354f);
    static_assert(tumble::sqrt(9.0) == 3.0);
    static_assert(integer_sqrt(0xffffffffffffffffu) == 0xffffffffu);
}

TEST(functions, integer_square_root_is_the_floor) {
    Random random{3};
    for (int i = 0; i < tests::many; ++i) {
        const std::uint64_t a = random.bits() >> random.between(0, 63);
        const auto r = static_cast<unsigned __int128>(integer_sqrt(a));
        ASSERT_TRUE(r * r <= a && (r + 1) * (r + 1) > a) << a;
    }
    EXPECT_EQ(integer_sqrt(0), 0u);
}

template <class T>
void expect_series(T z, const Bound& worst) {
    const long double x = std::sqrt(static_cast<long double>(z));
    const long double one_minus_sinc =
        x < 1e-3L ? x * x / 6 * (1 - x * x / 20 * (1 - x * x / 42)) : 1 - std::sin(x) / x;
    const long double s = std::sin(x / 2);
    const auto series = SinCosSeries<T>::of(z);
    ASSERT_LE(std::abs(static_cast<long double>(series.sinc_less_one) + one_minus_sinc), worst) << z;
    ASSERT_LE(std::abs(static_cast<long double>(series.cos_less_one) + 2 * s * s), worst) << z;
}

TEST(functions, rotation_series_of_floats_agree_with_long_double) {
    Random random{4};
    for (int i = 0; i < tests::many / 10; ++i) {
        expect_series(static_cast<float>(random.uniform(0, 1)), tolerance::series_f32);
        expect_series(random.uniform(0, 1), tolerance::series_f64);
        expect_series(static_cast<float>(random.uniform(1, 40)), tolerance::series_beyond_f32);
        expect_series(random.uniform(1, 40), tolerance::series_beyond_f64);
    }
    EXPECT_EQ(SinCosSeries<double>::of(0.0).sinc_less_one, 0);
    EXPECT_EQ(SinCosSeries<float>::of(0.0f).cos_less_one, 0);
}

TEST(functions, rotation_series_of_fixed_numbers_agree_with_long_double) {
    Random random{5};
    const auto check = [](Fixed<32> z) {
        const long double exact = static_cast<long double>(z.raw) * 0x1p-32L, x = std::sqrt(exact);
        const long double sinc = exact == 0 ? 0 : 1 - std::sin(x) / x, s = std::sin(x / 2);
        const auto series = SinCosSeries<Fixed<32>>::of(z);
        ASSERT_LE(std::abs(static_cast<long double>(series.sinc_less_one.raw) * 0x1p-32L + sinc), tolerance::series_q32)
            << z.raw;
        ASSERT_LE(std::abs(static_cast<long double>(series.cos_less_one.raw) * 0x1p-32L + 2 * s * s),
                  tolerance::series_q32)
            << z.raw;
    };
    for (int i = 0; i < tests::many / 10; ++i) check(Fixed<32>::from_raw(random.between(0, 1 << 28)));
    for (int raw = 0; raw < 1000; ++raw) check(Fixed<32>::from_raw(raw));
    check(Fixed<32>::from_raw(1 << 28));
}

}  // namespace
}  // namespace tumble::test
