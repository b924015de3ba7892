// Real against long double and 113-bit numbers.
#include "random.hpp"
#include "tolerances.hpp"
#include "worlds.hpp"

#include <tumble/numbers/functions.hpp>

#include <cmath>
#include <limits>

namespace tumble::test {
namespace {

using Quad = __float128;

// A Real with all 64 mantissa bits random, and its value.
struct RandomReal {
    Real real;
    Number value;
};
RandomReal random_real(Random& random, int least_exponent, int greatest_exponent) {
    const std::int64_t high = random.int64();
    const int e = random.between(least_exponent, greatest_exponent);
    const int odd = random.between(0, 1);
    const Real r = Real::scaled(high >> 1, e + 1) + Real::scaled(odd, e);
    return {r, std::ldexp(static_cast<Number>(high >> 1), e + 1) + std::ldexp(static_cast<Number>(odd), e)};
}
Quad magnitude(Quad a) { return a < 0 ? -a : a; }
Quad quad(Real a) { return static_cast<Quad>(number(a)); }

TEST(real, holds_every_double_exactly) {
    Random random{1};
    for (int i = 0; i < tests::many; ++i) {
        const auto d = std::bit_cast<double>(random.bits());
        if (!std::isfinite(d)) continue;
        ASSERT_EQ(std::bit_cast<std::uint64_t>(Real{d}.to_double() + 0.0), std::bit_cast<std::uint64_t>(d + 0.0)) << d;
    }
    for (const double d :
         {0.0, 1.0, -1.0, 4.9e-324, -2.2e-308, std::numeric_limits<double>::max(), std::numeric_limits<double>::min()})
        EXPECT_EQ(Real{d}.to_double(), d);
}

TEST(real, sums_and_differences_are_within_three_units_of_the_larger_operand) {
    Random random{2};
    for (int i = 0; i < tests::many; ++i) {
        const auto a = random_real(random, -40, 40), b = random_real(random, -40, 40);
        const Quad larger = std::max(magnitude(a.value), magnitude(b.value));
        const Quad sum = static_cast<Quad>(a.value) + static_cast<Quad>(b.value);
        ASSERT_LE(static_cast<double>(magnitude(quad(a.real + b.real) - sum) / larger), tolerance::real_sum);
        const Quad difference = static_cast<Quad>(a.value) - static_cast<Quad>(b.value);
        ASSERT_LE(static_cast<double>(magnitude(quad(a.real - b.real) - difference) / larger), tolerance::real_sum);
    }
}

TEST(real, products_and_quotients_are_within_a_unit) {
    Random random{3};
    for (int i = 0; i < tests::many; ++i) {
        const auto a = random_real(random, -200, 200), b = random_real(random, -200, 200);
        if (b.real.is_zero() || a.real.is_zero()) continue;
        const Quad product = static_cast<Quad>(a.value) * static_cast<Quad>(b.value);
        ASSERT_LE(static_cast<double>(magnitude(quad(a.real * b.real) / product - 1)), tolerance::real_unit);
        const Quad quotient = static_cast<Quad>(a.value) / static_cast<Quad>(b.value);
        ASSERT_LE(static_cast<double>(magnitude(quad(a.real / b.real) / quotient - 1)), tolerance::real_unit);
    }
}

TEST(real, square_root_squares_back) {
    Random random{4};
    for (int i = 0; i < tests::many / 10; ++i) {
        const Real a = abs(random_real(random, -600, 600).real);
        const Quad root = quad(sqrt(a));
        ASSERT_LE(static_cast<double>(magnitude(root * root / quad(a) - 1)), tolerance::real_root);
    }
    EXPECT_EQ(sqrt(Real{}), Real{});
    EXPECT_EQ(sqrt(Real{144}).to_double(), 12);
    EXPECT_EQ(sqrt(Real{0.25}).to_double(), 0.5);
}

TEST(real, rounds_to_the_nearest_fixed_with_ties_away_from_zero_and_clamps) {
    Random random{6};
    for (int i = 0; i < tests::many; ++i) {
        const auto a = random_real(random, -70, -20);
        const int bits = random.between(-4, 40);
        const Number scaled = std::ldexp(a.value, bits);
        const Number limit = std::numeric_limits<std::int32_t>::max();
        const Number expected = std::min(std::max(std::round(scaled), -limit), limit);
        ASSERT_EQ(static_cast<Number>(a.real.to_fixed(bits)), expected) << scaled;
    }
    EXPECT_EQ(Real{0.5}.to_fixed(0), 1);
    EXPECT_EQ(Real{-0.5}.to_fixed(0), -1);
    EXPECT_EQ(Real{1.5}.to_fixed(0), 2);
    EXPECT_EQ(Real{0.49999999999999994}.to_fixed(0), 0);
    EXPECT_EQ(Real::scaled(1, 200).to_fixed(0), 0x7fffffff);
    EXPECT_EQ(Real::scaled(-1, 200).to_fixed(0), -0x7fffffff);
    EXPECT_EQ(Real::scaled(1, -200).to_fixed(0), 0);
    EXPECT_EQ(Real::scaled(-1, 62).to_fixed(0, 64), -(std::int64_t{1} << 62));
    EXPECT_EQ(Real::scaled(1, 63).to_fixed(0, 64), std::numeric_limits<std::int64_t>::max());
    EXPECT_EQ((Real::scaled(1, 63) - Real{1}).to_fixed(0, 64), std::numeric_limits<std::int64_t>::max());
}

TEST(real, small_integers_become_fixed_exactly) {
    for (int i = -1000; i <= 1000; ++i) ASSERT_EQ(Real{i}.to_fixed(0), i);
    EXPECT_EQ(Real{3}.to_fixed(20), 3 << 20);
    EXPECT_EQ(Real{1}.to_fixed(40, 64), std::int64_t{1} << 40);
}

// The processor's conversion from 64 mantissa bits rounds correctly, to even, into the subnormals and to infinity.
TEST(real, rounds_to_double_and_float_like_the_processor) {
    Random random{7};
    for (int i = 0; i < tests::many; ++i) {
        const auto d = random_real(random, -1150, 970);
        ASSERT_EQ(d.real.to_double(), static_cast<double>(d.value)) << static_cast<double>(d.value);
        const auto f = random_real(random, -220, 80);
        ASSERT_EQ(f.real.to_float(), static_cast<float>(f.value)) << static_cast<double>(f.value);
        // Ties and their neighbours, down to the last subnormal.
        const std::int64_t tie =
            (static_cast<std::int64_t>(random.bits() >> 41) << 1 | 1) * 128 + random.between(-1, 1);
        const int e = random.between(-200, 60);
        ASSERT_EQ(Real::scaled(tie, e).to_float(), static_cast<float>(std::ldexp(static_cast<Number>(tie), e)));
    }
    EXPECT_EQ(Real::scaled(1, -150).to_float(), 0.0f);  // a tie with zero: to even
    EXPECT_EQ(Real::scaled(3, -151).to_float(), std::numeric_limits<float>::denorm_min());
    EXPECT_EQ(Real::scaled(1, -1075).to_double(), 0.0);
    EXPECT_EQ(Real::scaled(3, -1076).to_double(), std::numeric_limits<double>::denorm_min());
    EXPECT_EQ(Real::scaled(1, 128).to_float(), std::numeric_limits<float>::infinity());
    EXPECT_EQ(Real::scaled(0x1ffffff, 103).to_float(), std::numeric_limits<float>::infinity());
    EXPECT_EQ(Real::scaled(-1, 3000).to_double(), -std::numeric_limits<double>::infinity());
    EXPECT_EQ(Real::scaled(1, -5000).to_double(), 0.0);
    EXPECT_EQ(Real::scaled(1, 5000).to_float(), std::numeric_limits<float>::infinity());
}

TEST(real, orders_like_long_double) {
    Random random{8};
    for (int i = 0; i < tests::many; ++i) {
        const auto a = random_real(random, -2, 2), b = random_real(random, -2, 2);
        ASSERT_EQ(a.real < b.real, a.value < b.value);
        ASSERT_EQ(a.real <= b.real, a.value <= b.value);
        ASSERT_EQ(a.real == b.real, a.value == b.value);
    }
    EXPECT_TRUE(Real{-1} < Real{});
    EXPECT_FALSE(Real{} < -Real{});
    EXPECT_EQ(Real{}, -Real{});
}

TEST(real, bounds_itself_by_powers_of_two) {
    EXPECT_EQ(Real{1}.ceil_log2(), 1);
    EXPECT_EQ(Real{1}.ceil_log2_bound(), 0);
    EXPECT_EQ(Real{0.75}.ceil_log2(), 0);
    EXPECT_EQ(Real{0.75}.ceil_log2_bound(), 0);
    EXPECT_EQ(Real{-8}.ceil_log2_bound(), 3);
    EXPECT_EQ(Real{9}.ceil_log2_bound(), 4);
}

TEST(real, is_a_constant_expression_with_the_same_bits) {
    constexpr Real third = Real{1} / Real{3}, root = sqrt(Real{2});
    constexpr double third_d = third.to_double();
    constexpr float root_f = root.to_float();
    static_assert(third_d == 1.0 / 3.0);
    static_assert(Real{0.1}.to_fixed(31) == 214748365);
    volatile int one = 1, two = 2, three = 3;
    EXPECT_EQ(Real{one} / Real{three}, third);
    EXPECT_EQ(sqrt(Real{two}), root);
    EXPECT_EQ(root_f, std::sqrt(2.0f));
}

TEST(real, quaternions_rotate_like_the_reference) {
    Random random{9};
    for (int i = 0; i < 1000; ++i) {
        const auto component = [&] { return Real{random.uniform(-1, 1)}; };
        const RealQuat q = normalized(RealQuat{component(), {component(), component(), component()}});
        const RealVec3 r{component(), component(), component()};
        EXPECT_LE(std::abs(rotation(q).norm2() - 1), tolerance::real_vector);
        EXPECT_LE(norm(vector(q.rotate(r)) - rotation(q).rotate(vector(r))), tolerance::real_vector);
        EXPECT_LE(norm(vector(q.conjugate().rotate(q.rotate(r))) - vector(r)), tolerance::real_vector);
    }
}

TEST(real, a_rotation_about_an_axis_turns_by_its_angle) {
    Random random{10};
    for (int i = 0; i < 1000; ++i) {
        const Vector axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        const Number angle = number(Real{random.uniform(-20, 20)});
        const RealQuat q = rotation_about(real(axis), real(angle));
        const Vector v = vector(q.v), expected = axis * (std::sin(angle / 2) / norm(axis));
        EXPECT_LE(std::abs(number(q.w) - std::cos(angle / 2)), tolerance::real_vector) << angle;
        EXPECT_LE(norm(v - expected), tolerance::real_vector) << angle;
    }
    constexpr RealQuat quarter = rotation_about({0, 0, 2}, 90_deg), none = rotation_about({1, 0, 0}, 0);
    EXPECT_LE(norm(vector(quarter.rotate({1, 0, 0})) - Vector{0, 1, 0}), tolerance::real_vector);
    EXPECT_TRUE(none == RealQuat{});
    EXPECT_LE(std::abs(number(180_deg) - pi), tolerance::real_vector);
}

template <class T>
void expect_vectors_to_compute() {
    using V = Vector3<T>;
    V v{T(3), T(0), T(4)};
    EXPECT_EQ(norm(v), T(5));
    v += V{T(1), T(2), T(0)};
    EXPECT_EQ(v, (V{T(4), T(2), T(4)}));
    v -= {T(0), T(1), T(2)};
    EXPECT_EQ(v, (V{T(4), T(1), T(2)}));
    v *= T(2);
    EXPECT_EQ(v, T(2) * (V{T(4), T(1), T(2)}));
    v /= T(4);
    EXPECT_EQ(v, (V{T(4), T(1), T(2)}) / T(2));
}
TEST(real, vectors_compute_in_every_number) {
    expect_vectors_to_compute<float>();
    expect_vectors_to_compute<double>();
    expect_vectors_to_compute<Real>();
    expect_vectors_to_compute<Scaled>();
}

}  // namespace
}  // namespace tumble::test
