// Limits of hinges and sliders: ends at which a joint is held and not pulled. The oracles are statics, closed forms of
// the way to the end, and what is conserved.
#include "joint_cases.hpp"
#include "snapshots.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tumble::test::joint_limits {
namespace {

inline constexpr Features limited{
    .bodies = 4, .joints = 4, .joint_springs = true, .joint_limits = true, .removal = true, .snapshots = true};
using joint_cases::g;

template <class W>
class Limits : public JointCases<W, limited> {
protected:
    using Base = JointCases<W, limited>;
    using Base::falling;
    using Base::is_single;
    using typename Base::World;
    static constexpr double close = is_single ? 1e-5 : 1e-7;
    // rad/s and N m: where an end is met to 4e-7 rad in a step of 1/256 s, as in single precision.
    static constexpr double speed = is_single ? 1e-4 : 1e-5, torque = is_single ? 1e-2 : 1e-3;

    // Of 1 m, with an end at the origin, at this angle from hanging.
    [[nodiscard]] static BodySpec rod(double mass, double angle) {
        BodySpec body = at(box(mass, {0.1, 1, 0.1}), {std::sin(angle) / 2, -std::cos(angle) / 2, 0});
        body.orientation = rotation_about({0, 0, 1}, angle);
        return body;
    }
    // A rod of 1 kg on a hinge at the origin.
    [[nodiscard]] static World pendulum(double angle, const JointLimits& limits) {
        auto world = falling();
        (void)world.add(rod(1, angle));
        (void)world.add(HingeSpec{.body = 0, .limits = limits});
        return world;
    }
};
TYPED_TEST_SUITE(Limits, JointKinds<>);

// From 1 rad it swings to 0.4 rad and stays, as on a stop that bears m g / 2 sin(0.4) N m.
TYPED_TEST(Limits, a_hinge_stays_at_its_limit) {
    for (const int side : {1, -1}) {
        auto world = this->pendulum(side, side > 0 ? JointLimits{-0.6, 0.1} : JointLimits{-0.1, 0.6});
        double before = 0;
        for (int step = 0; step < 512; ++step) {
            if (this->joint(world).at_limit == 0) before = std::abs(this->joint(world).speed);
            this->run(world, 1);
            EXPECT_GT(side * this->joint(world).angle, -0.6 - this->close);
        }
        // I w^2 / 2 = m g / 2 (cos(0.4) - cos(1))
        EXPECT_NEAR(before, std::sqrt(g * (std::cos(0.4) - std::cos(1.0)) / (1.01 / 12 + 0.25)), 0.1);
        const auto joint = this->joint(world);
        EXPECT_EQ(joint.at_limit, -side);
        EXPECT_NEAR(joint.angle, -0.6 * side, this->close);
        EXPECT_NEAR(joint.speed, 0, 1e-5);
        EXPECT_NEAR(joint.torque.z, side * g / 2 * std::sin(0.4), this->torque);
        EXPECT_TRUE(world.status().ok());
    }
}

// Free of its ends it swings as without: only what is held costs energy.
TYPED_TEST(Limits, a_hinge_between_its_limits_is_free) {
    auto with = this->pendulum(0.5, {-1.5, 0.25}), without = this->pendulum(0.5, {});
    this->run(with, 2000);
    this->run(without, 2000);
    EXPECT_EQ(with.hash(), without.hash());
    EXPECT_EQ(this->joint(with).at_limit, 0);
}

TYPED_TEST(Limits, a_blow_away_from_the_limit_is_not_held) {
    auto world = this->pendulum(0.5, {-0.1, 2});
    world.set_angular_velocity(BodyId{0}, {0, 0, -4});
    for (int i = 0; i < 64 && this->joint(world).at_limit == 0; ++i) this->run(world, 1);
    EXPECT_EQ(this->joint(world).at_limit, -1);
    EXPECT_NEAR(this->joint(world).angle, -0.1, this->close);
    world.apply_angular_impulse(BodyId{0}, {0, 0, 3 * (1.01 / 12 + 0.25)}, Frame::body);  // the whole rod about its end
    this->run(world, 8);
    EXPECT_EQ(this->joint(world).at_limit, 0);
    EXPECT_GT(this->joint(world).speed, 2.5);
}

// Within its range it stays there, beyond it comes to the end on its side: at any angle, from an end too, and where
// either body is the root of the tree.
TYPED_TEST(Limits, a_hinge_that_is_posed_beyond_a_limit_comes_to_it) {
    using Limits = std::array<double, 2>;
    for (const auto& [least, most] : {Limits{-0.5, 1}, Limits{-2.5, 1}, Limits{-1, 0.5}, Limits{-0.5, 2.5}})
        for (const double other : {0.0, 0.3, 3.0})  // kg; 0: the world
            for (const bool was_held : {false, true})
                for (const double angle : {0.2, -0.3, 1.2, 1.5, 2.0, 2.8, 3.1, -0.7, -1.5, -2.8}) {
                    auto world = this->floating();
                    (void)world.add(this->rod(1, 0));
                    if (other > 0) (void)world.add(this->rod(other, 3));
                    (void)world.add(HingeSpec{.body = 0, .to_body = other > 0 ? 1 : -1, .limits = {least, most}});
                    world.set_angular_velocity(BodyId{0}, {0, 0, was_held ? 8 : 0});
                    for (int i = 0; was_held && i < 200 && this->joint(world).at_limit == 0; ++i) this->run(world, 1);
                    for (int b = 0; b < (other > 0 ? 2 : 1); ++b) {
                        const BodySpec posed = b == 0 ? this->rod(1, angle) : this->rod(other, 3);
                        world.set_pose(BodyId{b}, posed.position, posed.orientation);
                        world.set_velocity(BodyId{b}, {});
                        world.set_angular_velocity(BodyId{b}, {});
                    }
                    this->run(world, 1);
                    EXPECT_NEAR(this->joint(world).angle, std::clamp(angle, least, most), 20 * this->close)
                        << least << " " << most << " " << other << " " << was_held << " " << angle;
                    EXPECT_TRUE(world.status().ok());
                }
}

// It falls by 1 m along its axis.
TYPED_TEST(Limits, a_slider_stops_at_its_limit) {
    for (const bool down : {false, true}) {
        auto world = this->falling();
        (void)world.add(at(box(2, {0.5, 0.5, 0.5}), {0.25, 3, 0}));
        (void)world.add(SliderSpec{.body = 0,
                                   .anchor = {0, 3, 0},
                                   .axis = {0, down ? -1 : 1, 0},
                                   .limits = down ? JointLimits{-0.5, 1} : JointLimits{-1, 0.5}});
        int stopped = 0;
        for (int step = 1; step <= 300; ++step) {
            this->run(world, 1);
            if (stopped == 0 && this->joint(world).at_limit != 0) stopped = step;
            EXPECT_LT(std::abs(this->joint(world).travel), 1 + this->close);
        }
        EXPECT_NEAR(stopped / 256.0, std::sqrt(2 / g), 2.0 / 256);
        EXPECT_EQ(this->joint(world).at_limit, down ? 1 : -1);
        EXPECT_NEAR(static_cast<double>(world.position(BodyId{0}).y), 2, this->close);
        EXPECT_NEAR(this->joint(world).force.y, 2 * g, 0.01);
        EXPECT_TRUE(world.status().ok());
    }
}

// Two bodies that turn against each other on a hinge, in both orders: the tree grows from the first.
TYPED_TEST(Limits, a_limit_between_two_bodies_keeps_angular_momentum_in_either_order) {
    for (const bool reversed : {false, true}) {
        auto world = this->floating();
        BodySpec a = at(box(1, {1, 0.5, 0.25}), {}), b = at(box(2, {0.5, 0.5, 0.25}), {});
        a.angular_velocity = {0, 0, 2};
        b.angular_velocity = {0, 0, -1};
        const BodyId first = world.add(reversed ? b : a), second = world.add(reversed ? a : b);
        (void)world.add(HingeSpec{
            .body = reversed ? second : first, .to_body = reversed ? first : second, .limits = {-0.25, 0.75}});
        this->run(world, 256);
        const double of_a = 1.25 / 12, of_b = 2 * 0.5 / 12, w = (2 * of_a - of_b) / (of_a + of_b);
        for (const BodyId id : {first, second})
            EXPECT_NEAR(static_cast<double>(world.angular_velocity(id).z), w, 1e-4) << reversed;
        EXPECT_NEAR(this->joint(world).angle, 0.75, this->speed) << reversed;  // a second after it
    }
}

TYPED_TEST(Limits, a_limit_between_two_bodies_keeps_momentum_in_either_order) {
    for (const bool reversed : {false, true}) {
        auto world = this->floating();
        BodySpec a = at(box(1, {0.5, 0.5, 0.5}), {}), b = at(box(3, {0.5, 0.5, 0.5}), {1, 0, 0});
        a.velocity = {-1, 0, 0};
        b.velocity = {1, 0, 0};
        const BodyId first = world.add(reversed ? b : a), second = world.add(reversed ? a : b);
        (void)world.add(SliderSpec{.body = reversed ? second : first,
                                   .to_body = reversed ? first : second,
                                   .axis = {1, 0, 0},
                                   .limits = {-0.5, 0.125}});
        this->run(world, 256);
        for (const BodyId id : {first, second})
            EXPECT_NEAR(static_cast<double>(world.velocity(id).x), 0.5, 1e-5) << reversed;
        EXPECT_NEAR(this->joint(world).travel, -0.5, 1e-5) << reversed;
    }
}

// An arm whose elbow bends one way alone.
TYPED_TEST(Limits, the_energy_at_limits_never_rises) {
    auto world = this->falling();
    (void)world.add(at(box(1, {1, 0.2, 0.2}), {0.5, 0, 0}));
    (void)world.add(at(box(1, {1, 0.1, 0.1}), {1.5, 0, 0}));
    (void)world.add(HingeSpec{.body = 0});
    (void)world.add(HingeSpec{.body = 1, .to_body = 0, .anchor = {1, 0, 0}, .limits = {-0.25, 1.5}});
    bool was_held = false;
    const auto [rise, fall] = joint_cases::energy_change(world, 8192, [&](int) {
        was_held = was_held || this->joint(world, 1).at_limit != 0;
        EXPECT_GT(this->joint(world, 1).angle, -0.25 - 2 * this->close);
        EXPECT_LT(this->joint(world, 1).angle, 1.5 + 2 * this->close);
    });
    EXPECT_TRUE(was_held);
    EXPECT_LT(rise / (2 * g), 0.01);
    EXPECT_GT(fall, 1);
    EXPECT_EQ(world.status().bits, 0);
}

TYPED_TEST(Limits, limits_that_cannot_be_are_refused) {
    auto world = this->falling();
    (void)world.add(at(box(1, {1, 0.5, 0.25}), {}));
    const auto hinge = [&](double least, double most) {
        return world.fault_of(HingeSpec{.body = 0, .limits = {least, most}});
    };
    EXPECT_EQ(hinge(0.1, 1), JointFault::bad_limits);
    EXPECT_EQ(hinge(-1, -0.1), JointFault::bad_limits);
    EXPECT_EQ(hinge(1, -1), JointFault::bad_limits);
    EXPECT_EQ(hinge(-3, 1), JointFault::bad_limits);
    EXPECT_EQ(hinge(0, 2.7), JointFault::bad_limits);
    EXPECT_EQ(hinge(-2.5, 2.5), JointFault::none);
    EXPECT_EQ(world.fault_of(SliderSpec{.body = 0, .limits = {-20, 30}}), JointFault::none);
    EXPECT_EQ(world.fault_of(SliderSpec{.body = 0, .limits = {0.1, 30}}), JointFault::bad_limits);
    EXPECT_STREQ(name_of(JointFault::bad_limits), "bad_limits");
#ifndef __SANITIZE_ADDRESS__
    tumble::World<SceneOf<typename TestFixture::N, integrators::Verlet, Features{.joints = 1}>> without{
        Seconds{1, 256}};
    (void)without.add(at(box(1, {1, 0.5, 0.25}), {}));
    EXPECT_DEATH((void)without.add(HingeSpec{.body = 0, .limits = {-1, 1}}), "");
#endif
}

TYPED_TEST(Limits, a_snapshot_knows_which_joints_are_at_their_limits) {
    auto saved = this->pendulum(1, {-0.6, 0.1}), restored = this->pendulum(1, {-0.6, 0.1}),
         other = this->pendulum(1, {-0.6, 0.2});
    this->run(saved, 200);
    EXPECT_EQ(this->joint(saved).at_limit, -1);
    const auto bytes = save(saved);
    EXPECT_EQ(restore(other, bytes), SnapshotFault::other_scene);
    ASSERT_EQ(restore(restored, bytes), SnapshotFault::none);
    for (auto* world : {&saved, &restored}) {
        world->apply_angular_impulse(BodyId{0}, {0, 0, 0.5}, Frame::body);
        this->run(*world, 200);
    }
    EXPECT_EQ(saved.hash(), restored.hash());
}

// A slider that is out by metres is as long where it is held as where it slides.
TYPED_TEST(Limits, a_world_goes_on_from_a_snapshot_of_a_slider_at_its_limit) {
    for (const double most : {0.25, 1.0, 8.0}) {
        const auto make = [&] {
            auto world = this->falling();
            (void)world.add(at(box(1, {0.3, 0.3, 0.3}), {0.1, 0, 0}));
            (void)world.add(at(box(1, {0.3, 0.3, 0.3}), {0.1, -0.4, 0}));
            (void)world.add(HingeSpec{.body = 0, .anchor = {0, 0.05, 0}});
            (void)world.add(SliderSpec{
                .body = 1, .to_body = 0, .anchor = {0.1, -0.2, 0}, .axis = {0, -1, 0}, .limits = {-0.1, most}});
            return world;
        };
        auto world = make(), other = make();
        this->run(world, 900);
        EXPECT_EQ(this->joint(world, 1).at_limit, 1);
        ASSERT_EQ(restore(other, save(world)), SnapshotFault::none);
        for (int step = 0; step < 300; ++step) {
            this->run(world, 1);
            this->run(other, 1);
            ASSERT_EQ(world.hash(), other.hash()) << most << ", " << step;
        }
        EXPECT_TRUE(other.status().ok());
    }
}

}  // namespace
}  // namespace tumble::test::joint_limits
