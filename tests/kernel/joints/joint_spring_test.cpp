// Springs and dampers along the free directions of joints. The oracles are the closed forms of oscillators, conserved
// quantities, and springs between the same points.
#include "joint_cases.hpp"
#include "snapshots.hpp"

#include <cmath>
#include <vector>

namespace tumble::test::joint_springs {
namespace {

inline constexpr Features sprung{.bodies = 4,
                                 .springs = 1,
                                 .joints = 4,
                                 .distances = true,
                                 .joint_springs = true,
                                 .removal = true,
                                 .snapshots = true};
using SpringKinds = JointKinds<Kind<F64, integrators::Strang>>;

using joint_cases::length;
using joint_cases::momenta;
using joint_cases::spin;

template <class W>
class JointSprings : public JointCases<W, sprung> {
protected:
    using Base = JointCases<W, sprung>;
    using Base::is_single;
    using Base::order;
    using Base::run;
    using typename Base::World;

    // Of coordinate(world) after a second, and how many times smaller it is at half the step.
    template <class Make, class Coordinate>
    static void expect_order(Make&& make, Coordinate&& coordinate, double expected, double most_error) {
        std::vector<double> errors;
        for (const int rate : {256, 512}) {
            auto world = make(Seconds{1, rate});
            run(world, rate);
            errors.push_back(std::abs(coordinate(world) - expected));
            EXPECT_TRUE(world.status().ok());
        }
        EXPECT_LT(errors[0], most_error);
        if (!is_single) { EXPECT_NEAR(errors[0] / errors[1], 1 << order, 0.6); }
    }
    static constexpr double inertia = 1.25 / 12;  // kg m^2, of a box of 1 kg with edges of 1 m and 0.5 m across
};
TYPED_TEST_SUITE(JointSprings, SpringKinds);

// About its centre: the angle is 0.5 (1 - cos(w t)), with w^2 = k / I.
TYPED_TEST(JointSprings, a_sprung_hinge_swings_as_an_oscillator) {
    const double w = 12, k = w * w * this->inertia;
    const auto make = [&](Seconds step) {
        auto world = this->floating(step);
        const BodyId id = world.add(at(box(1, {1, 0.5, 0.25}), {}));
        (void)world.add(HingeSpec{.body = id, .spring = {.stiffness = k, .rest = 0.5}});
        return world;
    };
    const auto angle = [&](const auto& world) { return this->joint(world).angle; };
    this->expect_order(make, angle, 0.5 * (1 - std::cos(w)), 0.002);
}

TYPED_TEST(JointSprings, the_energy_of_a_sprung_arm_has_no_trend) {
    auto world = this->floating();
    const BodyId upper = world.add(at(box(1, {1, 0.25, 0.25}), {0.5, 0, 0})),
                 lower = world.add(at(box(0.5, {1, 0.25, 0.25}), {1.5, 0, 0}));
    (void)world.add(HingeSpec{.body = upper, .spring = {.stiffness = 20, .rest = 0.75}});
    (void)world.add(BallSpec{.body = lower, .to_body = upper, .anchor = {1, 0, 0}, .spring = {.stiffness = 5}});
    const auto energy = [&] {
        double sum = 0;
        for (const BodyId id : {upper, lower}) sum += static_cast<double>(world.kinetic_energy(id));
        const double angle = this->joint(world).angle - 0.75;
        const auto p = world.orientation(upper).template as<double>(),
                   q = world.orientation(lower).template as<double>();
        const auto relative = p.conjugate() * q;
        const double turn = 2 * std::atan2(std::sqrt(dot(relative.v, relative.v)), std::abs(relative.w));
        return sum + 0.5 * 20 * angle * angle + 0.5 * 5 * turn * turn;
    };
    const double start = energy();
    EXPECT_NEAR(start, 10 * 0.75 * 0.75, 1e-5);
    const auto [first, last] = joint_cases::mean_energies(world, energy, 2048, 20000);
    EXPECT_NEAR(first, start, 0.01 * start);
    EXPECT_NEAR(last, first, 1e-3 * start);
    EXPECT_TRUE(world.status().ok());
}

// x = 0.5 (1 - exp(-d t) (cos(v t) + d / v sin(v t))), d = c / 2 I, v^2 = k / I - d^2.
TYPED_TEST(JointSprings, a_damper_takes_energy_as_its_oscillator_does) {
    const double k = 100 * this->inertia, c = 4 * this->inertia, d = 2, v = std::sqrt(100 - 4);
    const auto make = [&](Seconds step) {
        auto world = this->floating(step);
        const BodyId id = world.add(at(box(1, {1, 0.5, 0.25}), {}));
        (void)world.add(HingeSpec{.body = id, .spring = {.stiffness = k, .damping = c, .rest = 0.5}});
        return world;
    };
    const auto angle = [&](const auto& world) { return this->joint(world).angle; };
    this->expect_order(make, angle, 0.5 * (1 - std::exp(-d) * (std::cos(v) + d / v * std::sin(v))), 0.002);
}

// A rod on a hinge at its end stops where its spring holds the weight, k (a - rest) = -m g / 2 cos a, however strong
// the damper is. Loads that see the half kicks of joints as velocities stop it up to 0.02 rad beside that, at a speed.
TYPED_TEST(JointSprings, a_damped_rod_stops_where_its_spring_holds_it) {
    if (this->order > 2) return;  // its flights are symmetric, and see the half kicks
    for (const double damping : {1.0, 4.0, 10.0, 30.0})
        for (const int rate : {64, 256, 1000}) {
            SCOPED_TRACE(testing::Message() << damping << " N m s, 1/" << rate << " s");
            auto world = this->falling({1, rate});
            const BodyId id = world.add(at(box(1, {1, 0.125, 0.125}), {0.5, 0, 0}));
            (void)world.add(HingeSpec{
                .body = id, .axis = {0, 0, 1}, .spring = {.stiffness = 20, .damping = damping, .rest = 0.25}});
            int corrections = 0;
            for (int i = 0; i < 20 * rate; ++i) {
                (void)world.step();
                corrections = std::max(corrections, this->joint(world).corrections);
            }
            const auto joint = this->joint(world);
            EXPECT_NEAR(20 * (joint.angle - 0.25), -9.81 / 2 * std::cos(joint.angle), 1e-4);
            EXPECT_NEAR(joint.speed, 0, 2e-5);
            EXPECT_LE(corrections, 4 * std::max(1.0, damping * 256 / rate / 4));  // 1 in a part, and more at the start
            EXPECT_TRUE(world.status().ok());
        }
}

// Moving, it is of order two: against steps of 1/8192 s.
TYPED_TEST(JointSprings, a_damped_rod_that_falls_is_of_the_order_of_its_method) {
    const auto angle_after_a_second = [&](int rate) {
        auto world = this->falling({1, rate});
        const BodyId id = world.add(at(box(1, {1, 0.125, 0.125}), {0.5, 0, 0}));
        (void)world.add(HingeSpec{.body = id, .axis = {0, 0, 1}, .spring = {.damping = 0.5}});
        for (int i = 0; i < rate; ++i) (void)world.step();
        return this->joint(world).angle;
    };
    if (this->is_single) return;
    const double exact = angle_after_a_second(8192), error = std::abs(angle_after_a_second(128) - exact),
                 half = std::abs(angle_after_a_second(256) - exact);
    EXPECT_LT(half, 1e-4);
    EXPECT_NEAR(error / half, 1 << this->order, this->order > 2 ? 4 : 0.2);
}

// Two bodies of 1 kg and 3 kg on an axis across their way: the travel swings with the reduced mass of 3/4 kg.
TYPED_TEST(JointSprings, a_sprung_slider_swings_with_the_reduced_mass) {
    const double w = 10;
    const auto make = [&](Seconds step) {
        auto world = this->floating(step);
        const BodyId a = world.add(at(box(1, {0.5, 0.5, 0.5}), {})),
                     b = world.add(at(box(3, {1, 0.5, 0.5}), {2, 0, 0}));
        (void)world.add(SliderSpec{
            .body = a, .to_body = b, .axis = {1, 0, 0}, .spring = {.stiffness = 0.75 * w * w, .rest = 0.25}});
        return world;
    };
    const auto travel = [&](const auto& world) {
        EXPECT_NEAR(static_cast<double>(world.velocity(BodyId{0}).x),
                    -3 * static_cast<double>(world.velocity(BodyId{1}).x), 1e-5);
        return this->joint(world).travel;
    };
    this->expect_order(make, travel, 0.25 * (1 - std::cos(w)), 0.001);
}

// A ball turns about any axis alike.
TYPED_TEST(JointSprings, a_sprung_ball_joint_swings_about_every_axis) {
    const double moment = 0.4 * 2 * 0.25, w = 9, speed = 6;
    const auto make = [&](Seconds step) {
        auto world = this->floating(step);
        const BodyId id = world.add(at(sphere(2, 0.5), {}, {}, {2, 4, 4}));
        (void)world.add(BallSpec{.body = id, .spring = {.stiffness = moment * w * w}});
        return world;
    };
    const auto turn = [&](const auto& world) {
        const auto q = world.orientation(BodyId{0}).template as<double>();
        EXPECT_NEAR(q.v.y, 2 * q.v.x, 1e-4);
        return 2 * std::atan2((q.v.x + 2 * q.v.y + 2 * q.v.z) / 3, q.w);
    };
    this->expect_order(make, turn, speed / w * std::sin(w), 0.003);
}

TYPED_TEST(JointSprings, both_axes_of_a_universal_joint_have_springs) {
    for (const bool to : {false, true}) {
        auto world = this->floating();
        // About x, the axis of the body, or y, that of the world.
        const BodyId id = world.add(at(box(1, {1, 1, 0.25}), {}));
        const double moment = 1.0625 / 12, w = 8;
        const tumble::JointSpring spring{.stiffness = moment * w * w, .rest = 0.25};
        (void)world.add(UniversalSpec{.body = id,
                                      .spring = to ? tumble::JointSpring{} : spring,
                                      .to_spring = to ? spring : tumble::JointSpring{}});
        this->run(world, 256);
        const auto joint = this->joint(world);
        EXPECT_NEAR(to ? joint.to_angle : joint.angle, 0.25 * (1 - std::cos(w)), 0.002) << to;
        EXPECT_NEAR(to ? joint.angle : joint.to_angle, 0, 1e-5) << to;
    }
}

// Along a distance: what a spring between the same points does.
TYPED_TEST(JointSprings, a_spring_along_a_distance_is_a_spring_between_its_points) {
    auto along = this->floating(), between = this->floating();
    for (auto* world : {&along, &between}) {
        (void)world->add(at(box(1, {0.5, 0.25, 0.25}), {0.5, 0.25, 0}, {}, {0, 1, 2}));
        (void)world->add(at(box(2, {0.5, 0.5, 0.25}), {-0.75, 0, 0.25}));
    }
    (void)along.add(DistanceSpec{.body = 0,
                                 .to_body = 1,
                                 .point = {0.75, 0.25, 0},
                                 .to_point = {-0.75, 0.25, 0.25},
                                 .most = 8,
                                 .spring = {.stiffness = 30, .damping = 0.5, .rest = 1}});
    (void)between.add(SpringSpec{.body = 0,
                                 .point = {0.25, 0, 0},
                                 .to_body = 1,
                                 .to = {0, 0.25, 0},
                                 .stiffness = 30,
                                 .damping = 0.5,
                                 .rest_length = 1});
    this->run(along, 256);
    this->run(between, 256);
    for (const BodyId id : {BodyId{0}, BodyId{1}}) {
        const auto x = along.position(id).template as<double>() - between.position(id).template as<double>();
        EXPECT_LT(std::sqrt(dot(x, x)), this->is_single ? 1e-4 : 1e-5);
    }
}

// Of all kinds, in a tree that flies freely.
TYPED_TEST(JointSprings, springs_of_joints_keep_momentum_and_angular_momentum) {
    auto world = this->floating();
    std::vector<BodyId> ids;
    for (int i = 0; i < 4; ++i)
        ids.push_back(
            world.add(at(box(1 + i, {0.5, 0.25, 0.375}), {Real{i}, 0.125 * i, 0}, {}, {0.5, 1 - i, 0.25 * i})));
    const tumble::JointSpring spring{.stiffness = 10, .damping = 0.25};
    (void)world.add(BallSpec{.body = ids[1], .to_body = ids[0], .anchor = {0.5, 0, 0}, .spring = spring});
    (void)world.add(UniversalSpec{
        .body = ids[2], .to_body = ids[1], .anchor = {1.5, 0.125, 0}, .spring = spring, .to_spring = spring});
    (void)world.add(SliderSpec{.body = ids[3],
                               .to_body = ids[2],
                               .anchor = {2.5, 0.25, 0},
                               .axis = {1, 1, 0},
                               .spring = {.stiffness = 40, .rest = 0.25}});
    this->run(world, 1);  // ends the rates across the joints
    const auto before = momenta(world);
    this->run(world, 512);
    const auto after = momenta(world);
    constexpr bool is_coarse = TestFixture::N::fixed_point || TestFixture::is_single;  // in a tree of 10 kg
    EXPECT_LT(length(after[0] - before[0]), is_coarse ? 3e-4 : 5e-6);
    EXPECT_LT(length(after[1] - before[1]), is_coarse ? 2e-3 : 2e-5);
    EXPECT_TRUE(world.status().ok());
}

// The limit of Stormer and Verlet is h w = 2.
TYPED_TEST(JointSprings, a_spring_that_the_step_cannot_follow_is_reported) {
    if (!std::is_same_v<typename TypeParam::Integrator, integrators::Verlet>) return;
    for (const double part : {0.9, 1.1}) {
        const double limit = 4 * 256.0 * 256.0 * part;
        auto hinge = this->floating(), slider = this->floating(), ball = this->floating();
        for (auto* world : {&hinge, &slider, &ball}) (void)world->add(at(box(1, {1, 0.5, 0.25}), {}));
        (void)hinge.add(HingeSpec{.body = 0, .spring = {.stiffness = limit * this->inertia}});
        (void)slider.add(SliderSpec{.body = 0, .spring = {.stiffness = limit}});
        // About x its moment is the least.
        (void)ball.add(BallSpec{.body = 0, .spring = {.stiffness = limit * (0.25 + 0.0625) / 12}});
        for (auto* world : {&hinge, &slider, &ball}) {
            this->run(*world, 1);
            EXPECT_EQ(world->status().has(Issue::step_too_long), part > 1) << part;
        }
    }
}

TYPED_TEST(JointSprings, springs_that_cannot_be_are_refused) {
    auto world = this->floating();
    const BodyId id = world.add(at(box(1, {1, 0.5, 0.25}), {}));
    EXPECT_EQ(world.fault_of(HingeSpec{.body = id, .spring = {.stiffness = -1}}), JointFault::bad_spring);
    EXPECT_EQ(world.fault_of(HingeSpec{.body = id, .spring = {.damping = -1}}), JointFault::bad_spring);
    EXPECT_EQ(world.fault_of(HingeSpec{.body = id, .spring = {.stiffness = 1, .rest = 3.5}}), JointFault::bad_spring);
    EXPECT_EQ(world.fault_of(BallSpec{.body = id, .spring = {.stiffness = 1, .rest = 0.5}}), JointFault::bad_spring);
    EXPECT_EQ(world.fault_of(UniversalSpec{.body = id, .to_spring = {.stiffness = -1}}), JointFault::bad_spring);
    EXPECT_EQ(world.fault_of(
                  DistanceSpec{.body = id, .to_point = {1, 0, 0}, .most = 2, .spring = {.stiffness = 1, .rest = -1}}),
              JointFault::bad_spring);
    EXPECT_EQ(world.fault_of(SliderSpec{.body = id, .spring = {.stiffness = 1, .rest = 100}}), JointFault::none);
    EXPECT_STREQ(name_of(JointFault::bad_spring), "bad_spring");
#ifndef __SANITIZE_ADDRESS__
    tumble::World<SceneOf<typename TestFixture::N, integrators::Verlet, Features{.joints = 1}>> without{
        Seconds{1, 256}};
    (void)without.add(at(box(1, {1, 0.5, 0.25}), {}));
    EXPECT_DEATH((void)without.add(HingeSpec{.body = 0, .spring = {.stiffness = 1}}), "");
    EXPECT_DEATH((void)world.add(HingeSpec{.body = id, .spring = {.stiffness = -1}}), "");
#endif
}

TYPED_TEST(JointSprings, a_spring_goes_with_its_joint_and_is_in_snapshots) {
    const auto make = [&](double k) {
        auto world = this->floating();
        (void)world.add(at(box(1, {1, 0.5, 0.25}), {}));
        (void)world.add(HingeSpec{.body = 0, .spring = {.stiffness = k, .damping = 0.125, .rest = 0.5}});
        return world;
    };
    auto saved = make(10), same = make(10), other = make(11);
    this->run(saved, 50);
    const auto bytes = save(saved);
    ASSERT_EQ(restore(same, bytes), SnapshotFault::none);
    EXPECT_EQ(restore(other, bytes), SnapshotFault::other_scene);
    this->run(saved, 100);
    this->run(same, 100);
    EXPECT_EQ(saved.hash(), same.hash());
    saved.remove(JointId{0});
    const double speed = spin(saved, BodyId{0}).z;
    this->run(saved, 100);
    EXPECT_NEAR(spin(saved, BodyId{0}).z, speed, 1e-6);
}

}  // namespace
}  // namespace tumble::test::joint_springs
