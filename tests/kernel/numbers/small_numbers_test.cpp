// Floating point where squares underflow: from finite numbers, however small, no part of a step makes an infinity or a
// NaN. Small numbers are drawn on purpose: zeros, subnormal numbers, and those whose square or cube is one.
#include <tumble/shapes/spheres.hpp>
#include <tumble/solver/cone.hpp>
#include <tumble/solver/weld.hpp>

#include "contact_cases.hpp"

#include <limits>

namespace tumble::test {
namespace {

// One in four is zero, one in four of the size of 1. The others go down to the least subnormal number; any power of two
// is as likely as another.
template <class T>
class SmallNumbers : public Random {
public:
    using Random::Random;

    T any_size() {
        const int kind = between(0, 3);
        if (kind == 0) return T(0);
        const int least = std::numeric_limits<T>::min_exponent - std::numeric_limits<T>::digits;
        return std::ldexp(static_cast<T>(uniform(0.5, 1)), kind == 1 ? 0 : between(least, 0));
    }
    T any() { return between(0, 1) == 0 ? any_size() : -any_size(); }
};

template <class N>
class SmallNumbersIn : public testing::Test {
public:
    using T = typename N::Work;
    static constexpr T least = std::numeric_limits<T>::min();
    static constexpr T rounding = 16 * std::numeric_limits<T>::epsilon();
    // Below it squares lose their digits.
    static inline const T least_squared = 16 * std::sqrt(least);

    SmallNumbers<T> random{15};
};
using FloatingNumbers = testing::Types<F32, F64>;
TYPED_TEST_SUITE(SmallNumbersIn, FloatingNumbers);

TYPED_TEST(SmallNumbersIn, friction_of_any_size_stays_within_its_limit) {
    using N = TypeParam;
    using T = typename N::Work;
    using Cone = FrictionCone<N, false>;
    auto& random = this->random;
    for (int i = 0; i < tests::many / 10; ++i) {
        typename Cone::Row row[2];
        for (auto& r : row) {
            r.inverse = static_cast<T>(random.uniform(1.0 / 64, 1));
            r.impulse = random.any();
        }
        const T excess[2] = {random.any(), random.any()}, limit = random.any_size();
        // The change is rounded as the sum of the impulse and the excess is.
        const auto within = [&](T size) {
            T largest = limit + this->least_squared / this->rounding;
            for (const T part : {row[0].impulse, row[1].impulse, excess[0], excess[1]}) largest += std::abs(part);
            return size <= limit + this->rounding * largest;
        };
        const T change = Cone::solve_one(row[0], excess[0], limit);
        ASSERT_TRUE(std::isfinite(change)) << row[0].impulse << " " << excess[0] << " " << limit;
        ASSERT_TRUE(within(std::abs((row[0].impulse + change) * row[0].inverse)))
            << row[0].impulse << " " << excess[0] << " " << limit;

        Couplings<N> couplings{};
        couplings.tangents = static_cast<T>(random.uniform(-0.5, 0.5));
        const T ratio =
            row[0].inverse < row[1].inverse ? row[0].inverse / row[1].inverse : row[1].inverse / row[0].inverse;
        couplings.slip = ratio * ratio;
        T changes[2];
        Cone::solve(row, excess, couplings, limit, changes);
        ASSERT_TRUE(std::isfinite(changes[0]) && std::isfinite(changes[1]));
        ASSERT_TRUE(within(
            std::hypot((row[0].impulse + changes[0]) * row[0].inverse, (row[1].impulse + changes[1]) * row[1].inverse)))
            << row[0].impulse << " " << row[1].impulse << " " << excess[0] << " " << excess[1] << " " << limit;
    }
}

TYPED_TEST(SmallNumbersIn, spheres_at_any_distance_have_a_normal_of_unit_length) {
    using N = TypeParam;
    using T = typename N::Work;
    auto& random = this->random;
    CollisionShape<N> shape{};
    shape.half = {T(0.25), T(0.25), T(0.25)};
    const Axes<N> axes = Axes<N>::of({T(1), {T(0), T(0), T(0)}});
    for (int i = 0; i < tests::many / 10; ++i) {
        const Vec3<T> reach{random.any(), random.any(), random.any()};
        const SphereSphere<N> spheres{PairView<N>{shape, shape, axes, axes, reach}};
        ASSERT_NEAR(std::hypot(spheres.normal.x(), spheres.normal.y(), spheres.normal.z()), 1, this->rounding)
            << reach.x() << " " << reach.y() << " " << reach.z();
        ASSERT_NEAR(spheres.gap, std::hypot(reach.x(), reach.y(), reach.z()) - T(0.5), this->rounding);
    }
}

TYPED_TEST(SmallNumbersIn, points_at_any_places_share_a_finite_load_or_are_refused) {
    using N = TypeParam;
    using T = typename N::Work;
    auto& random = this->random;
    int found = 0;
    for (int i = 0; i < tests::many / 10; ++i) {
        const int count = random.between(1, 4);
        T x[4]{}, z[4]{};
        for (int k = 0; k < count; ++k) {
            x[k] = random.any();
            z[k] = random.any();
        }
        // From their middle.
        T middle_x = 0, middle_z = 0;
        for (int k = 0; k < count; ++k) {
            middle_x += x[k] / static_cast<T>(count);
            middle_z += z[k] / static_cast<T>(count);
        }
        for (int k = 0; count > 1 && k < count; ++k) {
            x[k] -= middle_x;
            z[k] -= middle_z;
        }
        Weld<N, 4, true> weld;
        if (!weld.set(x, z, count, T(0.5))) continue;
        typename Weld<N, 4, true>::Wrench wrench;
        for (int k = 0; k < 3; ++k) {
            wrench.force[k] = random.any();
            wrench.moment[k] = random.any();
        }
        if (wrench.force[0] < T(0)) wrench.force[0] = -wrench.force[0];
        T shares[4][3];
        const T slack = random.any_size() * T(1e-5);
        if (!weld.share(wrench, true, T(0.5), slack, slack, shares)) continue;
        ++found;
        for (int k = 0; k < count; ++k)
            for (const T share : shares[k]) ASSERT_TRUE(std::isfinite(share));
    }
    EXPECT_GT(found, tests::many / 1000);
}

class SmallDistances : public CaseTest {
protected:
    static bool is_finite(const Motion& m) {
        for (const Vector& v : {m.x, m.v, m.w})
            if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) return false;
        return true;
    }
    // Between the least length that is not zero and a metre.
    static Number any_length(Random& random) {
        const int least = system().bits == 64 ? -1074 : -149;
        return std::ldexp(Number(1),
                          random.between(least, -least) < 0 ? random.between(least, 0) : -random.between(10, 80));
    }
};
INSTANTIATE_TEST_SUITE_P(every, SmallDistances, testing::ValuesIn(contact_cases()), NameOf{});

// That such forces are beyond every range is told. The gravitation is such that the bodies reach each other in a step,
// and weaker the nearer they are.
TEST_P(SmallDistances, attraction_springs_and_barriers_make_no_infinity) {
    Random random{16};
    for (int i = 0; i < 60; ++i) {
        SceneSetup setup;
        setup.world.contact.response = ContactResponse::none;
        const int kind = random.between(0, 2);
        const Number apart = any_length(random);
        const Vector way = random.between(0, 1) == 0 ? Vector{1, 0, 0} : direction(random);
        setup.bodies = {placed(sphere(1, 0.25), {0, 0, 0}), placed(sphere(1, 0.25), way * apart)};
        if (kind == 0) {
            setup.world.gravitation = real(std::pow(std::max(apart, 1e-3L), 2.0L));
        } else if (kind == 1) {
            setup.springs = {{.body = 0, .to_body = 1, .stiffness = 10, .damping = 1, .rest_length = 0.25}};
        } else {
            setup.world.contact.response = ContactResponse::spring;
            setup.world.contact.stiffness = 10;
            setup.world.contact.barrier = 1e-9;
            setup.planes = {{}};
            setup.bodies = {placed(sphere(1, 0.25), {0, 0.25L + apart, 0})};
        }
        const auto world = build(setup, GetParam());
        world->step();
        for (int b = 0; b < world->body_count(); ++b) ASSERT_TRUE(is_finite(world->motion(b))) << kind << " " << apart;
    }
}

}  // namespace
}  // namespace tumble::test
