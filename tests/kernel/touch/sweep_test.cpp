// Sweeps over the corners of a box on a plane: to the solution where there is one, and no longer than they can help
// where the targets of the corners contradict each other.
#include <tumble/tumble.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace tumble::test {
namespace {

template <class N>
class Sweeps : public testing::Test {
public:
    using Sweep = tumble::Sweep<N, false, false>;
    using Speed = typename Sweep::Speed;
    using Unit = typename Sweep::Unit;
    using Lever = typename Sweep::Row::Lever;

    template <class T>
    [[nodiscard]] static T number(double x) {
        if constexpr (N::fixed_point) return T{static_cast<std::int32_t>(std::lround(std::ldexp(x, T::fraction_bits)))};
        else return static_cast<T>(x);
    }
    template <class T>
    [[nodiscard]] static double value(T x) {
        return static_cast<double>(x);
    }
    // A box comes with the speed 0.25 onto its lower face, whose corners are 1.5 radii of gyration from its axes.
    void fall(const double (&targets)[4]) {
        for (int i = 0; i < 4; ++i) {
            const double x = i % 2 == 0 ? 1.5 : -1.5, z = i / 2 == 0 ? 1.5 : -1.5;
            row[i][0] = {};
            row[i][0].set({number<Unit>(0), number<Unit>(1), number<Unit>(0)},
                          {number<Lever>(-z), number<Lever>(0), number<Lever>(x)});
            row[i][0].target = number<Speed>(targets[i] * value(row[i][0].inverse));
        }
        body.linear = body.angular = Vec3<Speed>::Constant(Speed{});
        body.linear.y() = number<Speed>(-0.25);
    }
    // Until no impulse changes by more than 1e-6, but at most 80. Returns how many they were.
    int sweep() {
        SweepMotion<N> motion;
        const auto for_each_block = [&](auto&& f) {
            for (auto& rows : row) f(typename Sweep::Block{.row = rows, .rows = 1, .a = body});
        };
        int left = 80;
        Sweep::run(
            for_each_block, [&](auto&& f) { f(body, motion); }, number<Speed>(1e-6), number<Speed>(1e-6), left, 1);
        return 80 - left;
    }
    // Of a corner, upwards.
    [[nodiscard]] double velocity(int i) const {
        return value(row[i][0].velocity(body, nullptr)) / value(row[i][0].inverse);
    }

    typename Sweep::Row row[4][1];
    WeightedVelocity<N> body;
};
using Systems = testing::Types<Q32<NearRange>, F32, F64>;
TYPED_TEST_SUITE(Sweeps, Systems);

TYPED_TEST(Sweeps, stop_a_face_that_lands_flat) {
    this->fall({0, 0, 0, 0});
    EXPECT_LT(this->sweep(), 40);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(this->velocity(i), 0, 1e-5) << i;
}
TYPED_TEST(Sweeps, tilt_a_face_whose_corners_want_to) {
    this->fall({0, 0.01, 0, 0.01});
    EXPECT_LT(this->sweep(), 40);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(this->velocity(i), i % 2 == 0 ? 0 : 0.01, 1e-5) << i;
}
// No motion lifts the corners of one diagonal above the others: what they want differs by `twist` in the end, and the
// impulses of the other diagonal would fall from sweep to sweep until they are used up.
TYPED_TEST(Sweeps, end_where_a_twisted_face_cannot_meet_its_corners) {
    for (const double twist : {1e-3, 1e-4, -1e-4}) {
        this->fall({twist, 0, 0, twist});
        EXPECT_LT(this->sweep(), 20) << twist;
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(this->velocity(i), 0, 2 * std::abs(twist)) << i << ", " << twist;
    }
}

template <class N>
class SweptWorlds : public testing::Test {};
template <bool kinematic>
struct Swept {
    template <class N>
    struct In : Scene {
        using Numbers = N;
        static constexpr Features features{
            .bodies = 3, .planes = 5, .pairs = true, .boxes = true, .friction = true, .kinematic = kinematic};
    };
};
using FastSystems = testing::Types<Q32<Range<64, 32, 256>>, F32, F64>;
TYPED_TEST_SUITE(SweptWorlds, FastSystems);

// Impulses that are shifted from point to point for ten sweeps before one of them is used up, and only then converge.
TYPED_TEST(SweptWorlds, of_thrown_dice_do_not_end_before_points_have_come_free) {
    std::mt19937 numbers(1);
    const auto draw = [&] { return static_cast<double>(numbers()) / 2147483648.0 - 1; };
    const auto vector = [&](double size) {
        RealVec3 v;
        for (Real* x : {&v.x, &v.y, &v.z}) *x = Real{size * draw()};
        return v;
    };
    for (int i = 0; i < 102; ++i) {
        WorldSpec spec;
        spec.gravity = {0, Real{-9.81}, 0};
        spec.contact.restitution = spec.contact.friction = Real{0.4};
        spec.contact.tolerance = Real{0.0002};
        World<Swept<false>::In<TypeParam>> world{Seconds{1, 256}, spec};
        EXPECT_TRUE(world.add(PlaneSpec{}));
        for (const RealVec3& normal : {RealVec3{1, 0, 0}, RealVec3{-1, 0, 0}, RealVec3{0, 0, 1}, RealVec3{0, 0, -1}}) {
            PlaneSpec wall;
            wall.normal = normal;
            wall.offset = Real{0.1};
            EXPECT_TRUE(world.add(wall));
        }
        for (int k = 0; k < 2; ++k) {
            BodySpec die = box(Real{0.005}, {Real{0.016}, Real{0.016}, Real{0.016}});
            die.position = vector(0.03);
            die.position.y = Real{0.1} + Real{0.05 * k} + die.position.y * Real{2} / Real{3};
            die.velocity = vector(1);
            die.velocity.y = Real{-0.5} + Real{0.3} * die.velocity.y;
            die.angular_velocity = vector(20);
            double q[4], square = 0;
            for (double& x : q) {
                x = draw();
                square += x * x;
            }
            const double norm = std::sqrt(square);
            die.orientation = {Real{q[0] / norm}, {Real{q[1] / norm}, Real{q[2] / norm}, Real{q[3] / norm}}};
            (void)world.add(die);
        }
        // Those whose sweeps once ended too early.
        if (i != 7 && i != 29 && i != 68 && i != 101) continue;
        for (int step = 0; step < 100; ++step) (void)world.step();
        EXPECT_TRUE(world.status().ok()) << i;
    }
}

// A ball strikes another that rests on a lift, and bounces off. What it leaves of the other's approach is seen from the
// lift.
TYPED_TEST(SweptWorlds, stop_a_struck_ball_on_a_lift_as_on_one_that_stands) {
    for (const int lift : {0, -4, 4}) {
        WorldSpec spec;
        spec.gravity = {};
        spec.contact.restitution = spec.contact.friction = 0;
        World<Swept<true>::In<TypeParam>> world{Seconds{1, 256}, spec};
        BodySpec floor = box(1, {2, 0.25, 2}), low = sphere(1, 0.25), top = low;
        floor.kinematic = true;
        floor.position = {0, -0.125, 0};
        low.position = {0, 0.25, 0};
        top.position = {0, Real{0.7499}, 0};
        floor.velocity = low.velocity = {0, lift, 0};
        top.velocity = {0, lift - 3, 0};
        top.restitution = 1;
        const BodyId on = world.add(floor), ball = world.add(low);
        (void)world.add(top);
        for (int step = 0; step < 4; ++step) {
            (void)world.step();
            const auto height = world.position(ball).y - world.position(on).y;
            EXPECT_NEAR(static_cast<double>(height), 0.375, 1e-5) << "in step " << step << " at " << lift;
        }
    }
}

}  // namespace
}  // namespace tumble::test
