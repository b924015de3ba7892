// Trees of joints at rest: they stay where they are, cost nothing, and move again with whatever changes.
#include "joint_cases.hpp"
#include "snapshots.hpp"

#include <cmath>
#include <functional>
#include <vector>

namespace tumble::test::joint_rest {
namespace {

inline constexpr Features resting{.bodies = 3,
                                  .springs = 1,
                                  .joints = 3,
                                  .joint_springs = true,
                                  .joint_breaks = true,
                                  .control = true,
                                  .removal = true,
                                  .snapshots = true};

template <class W>
class JointRest : public JointCases<W, resting> {
protected:
    using Base = JointCases<W, resting>;
    using Base::run;
    using typename Base::World;
    static constexpr BodyId upper{0}, lower{1};

    // Two rods of 1 m that hang on each other, with hinges askew to the axes of the world and of the rods.
    static void add_rods(World& world) {
        for (int i = 0; i < 2; ++i) {
            BodySpec rod = at(box(1, {0.125, 1, 0.125}), {0, -0.5 - i, 0});
            rod.orientation = {Real{std::cos(0.32)}, {0, Real{std::sin(0.32)}, 0}};
            HingeSpec hinge{.body = world.add(rod), .anchor = {0, -i, 0}, .axis = {0.6, 0, 0.8}};
            if (i > 0) hinge.to_body = upper;
            (void)world.add(hinge);
        }
    }
    [[nodiscard]] static bool is_still(const World& world) {
        bool still = true;
        for (int b = 0; b < world.body_count(); ++b) {
            const auto v = world.velocity(BodyId{b}), w = world.angular_velocity(BodyId{b});
            for (int i = 0; i < 3; ++i) still = still && v[i] == 0 && w[i] == 0;
        }
        return still;
    }
    // Whether the state stays what it is for 300 steps.
    [[nodiscard]] static bool stays(World& world) {
        const auto hash = world.hash();
        bool same = true;
        for (int i = 0; i < 300; ++i) {
            (void)world.step();
            same = same && world.hash() == hash;
        }
        return same;
    }
};
using RestKinds = JointKinds<Kind<F32Plain, integrators::Verlet>, Kind<Q32<NearRange>, integrators::Verlet>>;
TYPED_TEST_SUITE(JointRest, RestKinds);

TYPED_TEST(JointRest, rods_that_hang_still_stay_after_half_a_second) {
    for (const int rate : {64, 256, 1000}) {
        SCOPED_TRACE(rate);
        auto world = this->falling({1, rate});
        this->add_rods(world);
        this->run(world, rate);
        EXPECT_TRUE(this->is_still(world));
        EXPECT_TRUE(this->stays(world));
        const auto hook = this->joint(world, 0), knee = this->joint(world, 1);
        const double noise = (this->is_single ? 1e-6 : 1e-8) * rate * rate;  // of a gap that counts as closed
        EXPECT_NEAR(hook.force.y, 2 * joint_cases::g, noise);
        EXPECT_NEAR(knee.force.y, joint_cases::g, noise);
        EXPECT_EQ(hook.corrections, 0);
        EXPECT_TRUE(world.status().ok());
    }
}

// It turns until its spring holds its weight: k (a - rest) = -m g / 2 cos(a), with the angle a from the horizontal.
TYPED_TEST(JointRest, a_sprung_and_damped_rod_rests_where_its_spring_holds_it) {
    for (const double damping : {2.0, 8.0}) {
        SCOPED_TRACE(damping);
        auto world = this->falling();
        const BodyId id = world.add(at(box(1, {1, 0.125, 0.125}), {0.5, 0, 0}));
        const JointSpring spring{.stiffness = 20, .damping = damping, .rest = 0.25};
        (void)world.add(HingeSpec{.body = id, .axis = {0, 0, 1}, .spring = spring});
        this->run(world, 256 * 20);
        EXPECT_TRUE(this->is_still(world));
        EXPECT_TRUE(this->stays(world));
        const double angle = this->joint(world).angle;
        if (this->order > 2) continue;  // loads of its flights see the half kicks of joints
        EXPECT_NEAR(20 * (angle - 0.25), -joint_cases::g / 2 * std::cos(angle), 2e-4);
    }
}

TYPED_TEST(JointRest, whatever_changes_moves_it_again) {
    using World = typename TestFixture::World;
    const struct {
        const char* what;
        std::function<void(World&)> change;
    } changes[] = {
        {"a blow",
         [](World& world) {
             world.apply_impulse(BodyId{1}, {0.5, 0, 0});
         }},
        {"a velocity",
         [](World& world) {
             world.set_velocity(BodyId{0}, {0.25, 0, 0});
         }},
        {"gravity",
         [](World& world) {
             world.set_gravity({3, -9, 0});
         }},
        {"a force",
         [](World& world) {
             world.set_force(BodyId{1}, {2, 0, 0}, Frame::world);
         }},
        {"a force of one step",
         [](World& world) {
             world.apply_force(BodyId{1}, {200, 0, 0}, Frame::world);
         }},
        {"a torque",
         [](World& world) {
             world.set_torque(BodyId{0}, {0, 0, 1}, Frame::world);
         }},
        {"a pose",
         [](World& world) {
             world.set_pose(BodyId{1}, {0.25, -1.5, 0});
         }},
        {"a spring",
         [](World& world) {
             SpringSpec spring;
             spring.body = BodyId{1};
             spring.to = {3, -1.5, 0};
             spring.stiffness = 20;
             (void)world.add(spring);
         }},
        {"a joint that breaks", [](World& world) { world.break_joint(JointId{1}); }},
        {"a joint that goes", [](World& world) { world.remove(JointId{0}); }},
        {"a body that goes", [](World& world) { world.remove(BodyId{0}); }},
        {"a body that is added and tied",
         [](World& world) {
             const BodyId id = world.add(at(box(2, {0.25, 0.25, 0.25}), {0.5, -2, 0}));
             (void)world.add(FixedSpec{.body = id, .to_body = BodyId{1}, .anchor = {0, -2, 0}});
         }},
    };
    for (const auto& [what, change] : changes) {
        SCOPED_TRACE(what);
        auto world = this->falling();
        this->add_rods(world);
        this->run(world, 300);
        ASSERT_TRUE(this->is_still(world));
        const auto before = joint_cases::place(world, BodyId{1});
        change(world);
        this->run(world, 128);
        EXPECT_GT(joint_cases::length(joint_cases::place(world, BodyId{1}) - before), 0.01);
    }
}

// As one that has never rested: a world in which the blow comes before it could.
TYPED_TEST(JointRest, what_moves_again_moves_as_if_it_had_never_rested) {
    const auto after_blow_at = [&](int step) {
        auto world = this->falling();
        this->add_rods(world);
        this->run(world, step);
        world.apply_impulse(this->lower, {0.5, 0, 0.25});
        this->run(world, 256);
        return joint_cases::place(world, this->lower);
    };
    EXPECT_LT(joint_cases::length(after_blow_at(300) - after_blow_at(10)), this->is_single ? 1e-5 : 2e-7);
}

TYPED_TEST(JointRest, small_swings_and_small_forces_are_no_rest) {
    // A swing of 1e-5 rad has its period, and its energy.
    auto swing = this->falling();
    const double angle = 1e-5;
    const BodyId rod = swing.add(at(box(1, {0.125, 1, 0.125}), {0, -0.5, 0}));
    (void)swing.add(HingeSpec{.body = rod, .axis = {0, 0, 1}});
    const double period = joint_cases::pendulum_period(angle, (1 + 0.125 * 0.125) / 12 + 0.25, joint_cases::g / 2);
    const double speed = angle * 2 * std::numbers::pi / period;
    swing.set_velocity(rod, {speed / 2, 0, 0});
    swing.set_angular_velocity(rod, {0, 0, speed});
    double most = 0;
    for (int i = 0; i < 4096; ++i) {
        (void)swing.step();
        if (i >= 3072) most = std::max(most, std::abs(this->joint(swing).angle));
    }
    EXPECT_NEAR(most, angle, 0.05 * angle);
    // 1e-5 m/s^2 along a slider.
    typename TestFixture::World slope{Seconds{1, 256}, {.gravity = {1e-5, -9.81, 0}}};
    const BodyId sled = slope.add(at(box(1, {0.5, 0.5, 0.5}), {}));
    (void)slope.add(SliderSpec{.body = sled, .axis = {1, 0, 0}});
    this->run(slope, 1024);
    EXPECT_NEAR(joint_cases::place(slope, sled).x, 1e-5 * 16 / 2, 0.02 * 8e-5);
    // A drift that no step shows.
    auto drift = this->floating();
    const double slow = this->is_single ? 2e-5 : 1e-6;  // m/s
    const BodyId boat = drift.add(at(box(1, {0.5, 0.5, 0.5}), {}, {slow, 0, 0}));
    (void)drift.add(SliderSpec{.body = boat, .axis = {1, 0, 0}});
    this->run(drift, 1024);
    EXPECT_NEAR(joint_cases::place(drift, boat).x, 4 * slow, 0.02 * 4 * slow);
}

// A Pose has no upper bits, and a step may end where it began.
TYPED_TEST(JointRest, fast_motions_are_no_rest) {
    using World = typename TestFixture::World;
    const struct {
        Seconds step;
        double speed, gravity;  // m/s, m/s^2 along the slider
    } slides[] = {{{1, 64}, 16, 0},   {{1, 16}, 4, 0},   {{1, 16}, -8, 0},           {{1, 100}, 25, 0},
                  {{1, 4}, 3.75, 10}, {{1, 2}, 7.5, 10}, {{1, 2}, 0.046875, 0.0625}, {{1, 3}, 2, 4}};
    for (const auto& slide : slides) {
        SCOPED_TRACE(slide.speed);
        World world{slide.step, {.gravity = {-slide.gravity, 0, 0}}};
        const BodyId sled = world.add(at(box(1, {0.5, 0.5, 0.5}), {}, {slide.speed, 0, 0}));
        (void)world.add(SliderSpec{.body = sled, .axis = {1, 0, 0}});
        const int steps = slide.gravity == 0 ? 64 : 6;
        this->run(world, steps);
        const double time = steps * static_cast<double>(slide.step.value),
                     x = slide.speed * time - slide.gravity / 2 * time * time;
        EXPECT_NEAR(joint_cases::place(world, sled).x, x, 1e-3 * (1 + std::abs(x)));
    }
    // A wheel that turns by almost half a turn in a step.
    auto spinning = this->floating({1, 8});
    const BodyId wheel = spinning.add(at(box(1, {0.5, 0.5, 0.25}), {}, {}, {0, 0, 25}));
    (void)spinning.add(HingeSpec{.body = wheel, .axis = {0, 0, 1}});
    this->run(spinning, 64);
    EXPECT_NEAR(static_cast<double>(spinning.angular_velocity(wheel).z), 25, 0.01);
}

TYPED_TEST(JointRest, a_snapshot_of_a_tree_that_comes_to_rest_goes_on_with_the_same_bits) {
    const auto make = [&] {
        auto world = this->falling();
        this->add_rods(world);
        return world;
    };
    auto world = make();
    this->run(world, 400);
    const auto last = world.hash();
    for (const int step : {5, 60, 126, 127, 128, 129, 300}) {
        SCOPED_TRACE(step);
        auto first = make(), other = make();
        this->run(first, step);
        this->run(other, 37);
        ASSERT_EQ(restore(other, save(first)), SnapshotFault::none);
        this->run(other, 400 - step);
        EXPECT_EQ(other.hash(), last);
        // It is at rest as late as the other, too: a blow then finds the same state.
        this->run(first, 400 - step);
        EXPECT_EQ(save(other), save(first));
    }
}

// A spring to a body that flies: what the other end does is felt at once.
TYPED_TEST(JointRest, what_a_spring_couples_to_it_moves_it) {
    auto world = this->falling();
    this->add_rods(world);
    const BodyId ball = world.add(at(sphere(1, 0.25), {2, -2, 0}));
    SpringSpec spring;
    spring.body = BodyId{1};
    spring.to_body = ball;
    spring.stiffness = 10;
    spring.rest_length = 3;
    (void)world.add(spring);
    this->run(world, 300);
    EXPECT_GT(joint_cases::length(joint_cases::velocity(world, BodyId{1})), 0.01);
}

}  // namespace
}  // namespace tumble::test::joint_rest
