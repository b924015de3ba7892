// Rods and ropes: DistanceSpec. The oracles are closed forms of pendulums, of free flight and of impacts, and what is
// conserved.
#include "joint_cases.hpp"
#include "random.hpp"
#include "snapshots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace tumble::test::joint_distances {
namespace {

inline constexpr Features tied{
    .bodies = 6, .springs = 1, .joints = 6, .distances = true, .control = true, .removal = true, .snapshots = true};
using DistanceKinds = JointKinds<Kind<Q32<FieldRange>, integrators::Verlet>>;

using joint_cases::energy;
using joint_cases::g;
using joint_cases::length;
using joint_cases::momenta;
using joint_cases::place;
using joint_cases::velocity;

template <class W>
class Distances : public JointCases<W, tied> {
protected:
    using Base = JointCases<W, tied>;
    using Base::is_single;
    using typename Base::N;
    using typename Base::World;
    static constexpr double closed = N::fixed_point ? 8e-9 : is_single ? 2e-6 : 4e-12;

    // A ball on a rope or a rod of its centre to the origin.
    [[nodiscard]] static BodyId hang(World& world, const RealVec3& position, const RealVec3& velocity, double least,
                                     double most) {
        const BodyId ball = world.add(at(sphere(2, 0.1), position, velocity));
        (void)world.add(DistanceSpec{.body = ball, .point = position, .least = least, .most = most});
        return ball;
    }
    [[nodiscard]] static int limit(const World& world) { return world.template joint<double>(JointId{0}).at_limit; }
};
TYPED_TEST_SUITE(Distances, DistanceKinds);

TYPED_TEST(Distances, a_ball_on_a_rod_swings_as_the_mathematical_pendulum) {
    const double period = joint_cases::pendulum_period(2.5, 1, g);
    std::vector<double> errors;
    for (const int rate : {256, 512}) {
        auto world = this->falling({1, rate});
        const BodyId ball = this->hang(world, {std::sin(2.5), -std::cos(2.5), 0}, {}, 1, 1);
        const double start = energy(world);
        double x = 1, passed = 0, passages = 0, t = 0;
        for (int step = 1; passages < 3; ++step) {
            this->run(world, 1);
            const auto at = place(world, ball);
            EXPECT_NEAR(length(at), 1, this->closed);
            if (at.y < 0 && x * at.x <= 0) {
                const double v = velocity(world, ball).x;
                t = (step - at.x / v * rate) / rate;
                if (++passages == 1) passed = t;
            }
            x = at.x;
        }
        EXPECT_NEAR(energy(world), start, 1e-3 * 2 * g);
        errors.push_back(std::abs((t - passed) / period - 1));
        EXPECT_EQ(this->limit(world), 1);
        EXPECT_TRUE(world.status().ok());
    }
    EXPECT_LT(errors[0], 2e-4);
    // The time of a passage is read from a line, which is of order two.
    if (!this->is_single && this->order == 2) { EXPECT_NEAR(errors[0] / errors[1], 4, 1); }
}

TYPED_TEST(Distances, the_energy_on_a_rod_has_no_trend) {
    auto world = this->falling();
    const BodyId box_id = world.add(at(box(1, {1, 0.25, 0.25}), {0.5, -1, 0}));
    // Off its centre, so that it swings about the point of the rod too.
    (void)world.add(DistanceSpec{.body = box_id,
                                 .point = {0, -1, 0},
                                 .to_point = {0.25, 0, 0.25},
                                 .least = std::sqrt(1.125),
                                 .most = std::sqrt(1.125)});
    const auto [first, last] = joint_cases::mean_energies(
        world, [&] { return energy(world); }, 4096, 20000);
    EXPECT_NEAR(last, first, (this->is_single ? 3e-3 : 3e-4) * g);
    EXPECT_TRUE(world.status().ok());
}

// The line of a long one is known to the last bit, or some step never closes.
TYPED_TEST(Distances, long_ropes_and_rods_close_in_every_step) {
    for (int i = 0; i < 48; ++i)
        for (const bool is_rod : {false, true}) {
            auto world = this->falling();
            const double across = 8 * std::exp2(i / 64.0), length = std::sqrt(across * across + 0.0025);
            const BodyId id = world.add(at(box(1, {0.1, 0.2, 0.15}), {across, 0, 0}, {0, 0, std::sqrt(across)}));
            (void)world.add(
                DistanceSpec{.body = id, .point = {across, 0, 0.05}, .least = is_rod ? length : 0.0, .most = length});
            this->run(world, 1000);
            EXPECT_TRUE(world.status().ok()) << across << " " << is_rod;
        }
}

TYPED_TEST(Distances, what_hangs_on_a_slack_rope_flies_freely) {
    auto world = this->falling(), alone = this->falling();
    const BodyId ball = this->hang(world, {0.5, 0.25, 0}, {1, 2, 0.5}, 0, 3);
    const BodyId free = alone.add(at(sphere(2, 0.1), {0.5, 0.25, 0}, {1, 2, 0.5}));
    this->run(world, 128);
    this->run(alone, 128);
    // A step of order four is flown in pieces, which round.
    if (this->order == 2) { EXPECT_EQ(world.hash(), alone.hash()); }
    EXPECT_LT(length(place(world, ball) - place(alone, free)), this->order == 2 ? 1e-300 : 1e-13);
    const auto joint = world.template joint<double>(JointId{0});
    EXPECT_EQ(joint.at_limit, 0);
    EXPECT_EQ(joint.force.x, 0);
    EXPECT_NEAR(joint.travel, length(place(world, ball)), 1e-6);
}

// It falls by 1 m and hangs.
TYPED_TEST(Distances, a_rope_that_goes_taut_stops_what_falls) {
    auto world = this->falling();
    const BodyId ball = this->hang(world, {0, -1, 0}, {}, 0, 2);
    int taut_at = 0;
    for (int step = 1; step <= 256; ++step) {
        this->run(world, 1);
        EXPECT_LT(length(place(world, ball)), 2 + this->closed);
        if (taut_at == 0 && this->limit(world) == 1) taut_at = step;
    }
    EXPECT_NEAR(taut_at / 256.0, std::sqrt(2 / g), 1.0 / 256);
    EXPECT_NEAR(place(world, ball).y, -2, 1e-6);
    EXPECT_NEAR(velocity(world, ball).y, 0, 1e-5);
    EXPECT_NEAR(world.template joint<double>(JointId{0}).force.y, 2 * g, 0.01);
    EXPECT_TRUE(world.status().ok());
}

// From (1.2, 0) it falls to (1.2, -0.9), where a rope of 1.5 m takes the speed along it, 3/5 of the whole.
TYPED_TEST(Distances, going_taut_ends_the_speed_along_the_rope_alone) {
    double error = 0;
    for (const int rate : {256, 1024}) {
        auto world = this->falling({1, rate});
        (void)this->hang(world, {1.2, 0, 0}, {}, 0, 1.5);
        double before = 0;
        while (this->limit(world) == 0) {
            before = energy(world);
            this->run(world, 1);
        }
        // Of 2 kg: g 0.9 m of energy, of which 9/25 go.
        const double lost = before - energy(world);
        error = std::abs(lost / (2 * g * 0.9 * 9 / 25) - 1);
        EXPECT_LT(error, 5.0 / rate);
    }
}

// At the height of l / 2 the weight alone keeps it on the circle: v^2 = g l / 2.
TYPED_TEST(Distances, a_rope_goes_slack_where_its_force_ends) {
    auto world = this->falling();
    const BodyId ball = this->hang(world, {0, -1, 0}, {std::sqrt(3.5 * g), 0, 0}, 0, 1);
    this->run(world, 4);
    EXPECT_EQ(this->limit(world), 1);
    for (int step = 0; step < 256 && this->limit(world) == 1; ++step) this->run(world, 1);
    EXPECT_NEAR(place(world, ball).y, 0.5, 0.02);
    const auto v = velocity(world, ball);
    EXPECT_NEAR(dot(v, v), g / 2, 0.2);
}

// On a strut that only presses, as on a ball without friction: it leaves at the height of 2/3 of the radius.
TYPED_TEST(Distances, a_least_distance_presses_and_does_not_pull) {
    auto world = this->falling();
    const BodyId ball = this->hang(world, {0, 1, 0}, {0.01, 0, 0}, 1, 8);
    this->run(world, 8);
    EXPECT_EQ(this->limit(world), -1);
    double y = 1;
    for (int step = 0; step < 1024 && this->limit(world) == -1; ++step) {
        y = place(world, ball).y;
        this->run(world, 1);
        EXPECT_GT(length(place(world, ball)), 1 - this->closed);
    }
    EXPECT_NEAR(y, 2.0 / 3, 0.02);
}

// Ropes that go taut and slack again and again.
TYPED_TEST(Distances, the_energy_on_ropes_never_rises) {
    auto world = this->falling();
    std::vector<BodyId> ids;
    RealVec3 from{};
    for (int i = 0; i < 4; ++i) {
        const RealVec3 to = from + RealVec3{0.4, i % 2 == 0 ? 0.3 : -0.3, 0.1};
        ids.push_back(world.add(at(box(1, {0.2, 0.1, 0.15}), to, {0, i == 3 ? 3 : 0, 1})));
        DistanceSpec rope{.body = ids.back(), .point = to, .to_point = from, .most = 0.55};
        if (i > 0) rope.to_body = ids[static_cast<std::size_t>(i) - 1];
        (void)world.add(rope);
        from = to;
    }
    const auto [rise, fall] = joint_cases::energy_change(world, 8192, [&](int step) {
        for (int j = 0; j < 4; ++j) EXPECT_LT(world.template joint<double>(JointId{j}).travel, 0.55 + 1e-5) << step;
    });
    EXPECT_LT(rise / (4 * g), 0.01);
    EXPECT_GT(fall, 0.1);
    EXPECT_FALSE(world.status().has(Issue::joint_open));
}

// Two bodies fly apart, and a rope between points off their centres turns them.
TYPED_TEST(Distances, a_rope_between_two_bodies_keeps_momentum_and_angular_momentum) {
    auto world = this->floating();
    const BodyId a = world.add(at(box(1, {0.5, 0.5, 0.5}), {-0.5, 0, 0}, {-1, 0.5, 0})),
                 b = world.add(at(box(3, {0.5, 0.25, 0.5}), {0.5, 0, 0}, {1, 0, 0.25}));
    (void)world.add(
        DistanceSpec{.body = a, .to_body = b, .point = {-0.5, 0.25, 0}, .to_point = {0.5, -0.125, 0}, .most = 1.5});
    const auto before = momenta(world);
    bool was_taut = false;
    for (int step = 0; step < 512; ++step) {
        this->run(world, 1);
        was_taut = was_taut || this->limit(world) == 1;
    }
    const auto after = momenta(world);
    EXPECT_TRUE(was_taut);
    EXPECT_GT(std::abs(static_cast<double>(world.angular_velocity(a).z)), 0.1);
    EXPECT_LT(length(after[0] - before[0]), this->is_single ? 1e-4 : 5e-6);
    EXPECT_LT(length(after[1] - before[1]), this->is_single ? 1e-3 : 1e-5);
    EXPECT_TRUE(world.status().ok());
}

// Rods and other joints in one tree, with a rod in its middle.
TYPED_TEST(Distances, rods_and_hinges_stay_closed_together) {
    auto world = this->falling();
    const BodyId arm = world.add(at(box(1, {1, 0.1, 0.1}), {0.5, 0, 0})),
                 crank = world.add(at(box(1, {0.2, 0.4, 0.2}), {1, -0.95, 0})),
                 tip = world.add(at(box(0.5, {0.5, 0.1, 0.1}), {1.25, -1.15, 0}));
    (void)world.add(HingeSpec{.body = arm});
    (void)world.add(DistanceSpec{
        .body = crank, .to_body = arm, .point = {1, -0.75, 0}, .to_point = {1, 0, 0}, .least = 0.75, .most = 0.75});
    const JointId ball = world.add(BallSpec{.body = tip, .to_body = crank, .anchor = {1, -1.15, 0}});
    const double start = energy(world);
    for (int step = 0; step < 2048; ++step) {
        this->run(world, 1);
        EXPECT_NEAR(world.template joint<double>(JointId{1}).travel, 0.75, this->is_single ? 4e-6 : 1e-7);
    }
    EXPECT_NEAR(energy(world), start, 0.02 * g);
    EXPECT_TRUE(world.contains(ball));
    EXPECT_TRUE(world.status().ok());
}

// A tree of up to six bodies of about this size, m, with all kinds of joints.
template <class World>
[[nodiscard]] World random_mechanism(Random random, double size, int rate) {
    World world{{1, rate}, {.gravity = {random.uniform(-g, g), -g, 0}}};
    const auto vector = [&](double reach) {
        const auto component = [&] { return Real{random.uniform(-reach, reach)}; };
        const Real x = component(), y = component();
        return RealVec3{x, y, component()};
    };
    std::array<RealVec3, 6> places;
    const int count = random.between(1, 6);
    for (int i = 0; i < count; ++i) {
        const int other = random.between(-1, i - 1);
        const RealVec3 from = other < 0 ? RealVec3{} : places[static_cast<std::size_t>(other)];
        const RealVec3 place = places[static_cast<std::size_t>(i)] = from + vector(size);
        const RealVec3 more_edges = vector(0.4 * size), mean_edges = RealVec3{1, 1, 1} * Real{0.6 * size};
        BodySpec body = at(box(random.uniform(0.1, 1), mean_edges + more_edges), place);
        body.orientation = {random.uniform(0.5, 2), vector(1)};
        (void)world.add(body);
        const RealVec3 anchor = place + vector((random.between(0, 2) == 0 ? 0.02 : 0.6) * size);
        const RealVec3 axis = RealVec3{0, 0, 1.5} + vector(1), to = from + vector(0.3 * size), line = anchor - to;
        const Real length = sqrt(dot(line, line));
        const auto join = [&](auto spec) {
            spec.body = i;
            spec.to_body = other;
            if constexpr (requires { spec.anchor; }) spec.anchor = anchor;
            if constexpr (requires { spec.axis; }) spec.axis = axis;
            (void)world.add(spec);
        };
        switch (random.between(0, 5)) {
        case 0: join(HingeSpec{}); break;
        case 1: join(BallSpec{}); break;
        case 2: join(FixedSpec{}); break;
        case 3: join(SliderSpec{}); break;
        case 4: join(UniversalSpec{.to_axis = {axis.y, -axis.x, 0}}); break;
        default: join(DistanceSpec{.point = anchor, .to_point = to, .least = length, .most = length});
        }
    }
    return world;
}

TYPED_TEST(Distances, random_mechanisms_of_every_size_move_as_in_double) {
    using Double = tumble::World<SceneOf<F64, typename TypeParam::Integrator, joint_cases::features_of<tied>>>;
    Random random{1};
    for (int seed = 0; seed < 200; ++seed) {
        const double size = 0.02 * std::exp2(random.uniform(0, 7));
        int rate = 256;
        while (rate * std::sqrt(size) < 256) rate *= 2;
        const Random drawn{random.bits()};
        auto world = random_mechanism<typename TestFixture::World>(drawn, size, rate);
        auto in_double = random_mechanism<Double>(drawn, size, rate);
        double largest = 0;
        for (int step = 0; step < 0.35 * std::sqrt(size) * rate; ++step) {
            (void)world.step();
            (void)in_double.step();
            for (int b = 0; b < world.body_count(); ++b) {
                const auto moved = world.position(BodyId{b});
                const auto wanted = in_double.position(BodyId{b});
                for (int k = 0; k < 3; ++k)
                    largest =
                        std::max(largest, std::abs(static_cast<double>(moved[k]) - static_cast<double>(wanted[k])));
            }
        }
        EXPECT_LT(largest, 1e-5 * size) << seed << " " << size;
        EXPECT_TRUE(world.status().ok());
    }
}

TYPED_TEST(Distances, a_distance_that_cannot_be_kept_is_refused) {
    auto world = this->falling();
    const BodyId ball = world.add(at(sphere(1, 0.1), {2, 0, 0}));
    const auto fault = [&](double least, double most) {
        return world.fault_of(DistanceSpec{.body = ball, .point = {2, 0, 0}, .least = least, .most = most});
    };
    EXPECT_EQ(fault(-1, 2), JointFault::empty_range);
    EXPECT_EQ(fault(0, 0), JointFault::empty_range);
    EXPECT_EQ(fault(3, 2), JointFault::empty_range);
    EXPECT_EQ(fault(0, 1.99), JointFault::outside_range);
    EXPECT_EQ(fault(2.01, 3), JointFault::outside_range);
    EXPECT_EQ(fault(2, 2), JointFault::none);
    EXPECT_EQ(fault(0, 2), JointFault::none);
    if (TestFixture::N::fixed_point) { EXPECT_EQ(fault(0, 5000), JointFault::too_far); }
    EXPECT_STREQ(name_of(JointFault::empty_range), "empty_range");
    EXPECT_STREQ(name_of(JointFault::outside_range), "outside_range");
#ifndef __SANITIZE_ADDRESS__
    EXPECT_DEATH((void)world.add(DistanceSpec{.body = ball, .point = {2, 0, 0}, .most = 1}), "");
#endif
}

TYPED_TEST(Distances, a_snapshot_knows_which_ropes_are_taut) {
    for (const int steps : {40, 100, 140}) {
        auto saved = this->falling(), restored = this->falling();
        for (auto* world : {&saved, &restored}) (void)this->hang(*world, {1.2, 0, 0}, {}, 0, 1.5);
        this->run(saved, steps);
        const auto bytes = save(saved);
        ASSERT_EQ(restore(restored, bytes), SnapshotFault::none);
        this->run(saved, 300);
        this->run(restored, 300);
        EXPECT_EQ(saved.hash(), restored.hash());
        auto longer = this->falling();
        (void)this->hang(longer, {1.2, 0, 0}, {}, 0, 1.75);
        EXPECT_EQ(restore(longer, bytes), SnapshotFault::other_scene);
    }
}

// The pose of a body is set beyond its rope, and within it.
TYPED_TEST(Distances, a_pose_beyond_the_rope_is_brought_back) {
    auto world = this->falling();
    const BodyId ball = this->hang(world, {0, -1, 0}, {}, 0, 1);
    this->run(world, 16);
    world.set_pose(ball, {0, -1.25, 0});
    this->run(world, 1);
    EXPECT_NEAR(length(place(world, ball)), 1, 1e-6);
    world.set_pose(ball, {0, -0.5, 0});
    this->run(world, 1);
    EXPECT_EQ(this->limit(world), 0);
    EXPECT_NEAR(place(world, ball).y, -0.5, 0.01);
    EXPECT_TRUE(world.status().ok());
}

// A blow away from a taut rope is not held by it.
TYPED_TEST(Distances, a_blow_towards_the_other_end_slackens_a_rope) {
    auto world = this->falling();
    const BodyId ball = this->hang(world, {0, -1, 0}, {}, 0, 1);
    this->run(world, 16);
    world.apply_impulse(ball, {0, 4, 0});
    this->run(world, 1);
    EXPECT_NEAR(velocity(world, ball).y, 2 - g / 256, 0.01);
    EXPECT_EQ(this->limit(world), 0);
    world.set_velocity(ball, {0, 0, 0});
    this->run(world, 256);
    EXPECT_EQ(this->limit(world), 1);
}

// Every compiler, optimisation and core gives these bits.
TEST(DistanceBits, are_the_same_everywhere) {
    World<SceneOf<Q32<>, integrators::Verlet, joint_cases::features_of<tied>>> world{Seconds{1, 256},
                                                                                     {.gravity = {0, -9.75, 0}}};
    BodySpec one = box(1, {0.5, 0.25, 0.125}), other = box(0.5, {0.25, 0.25, 0.5});
    one.position = {1, 0, 0};
    other.position = {1.5, -0.5, 0.25};
    (void)world.add(one);
    (void)world.add(other);
    (void)world.add(DistanceSpec{.body = 0, .point = {0.75, 0.125, 0}, .to_point = {0, 0, 0}, .most = 1});
    (void)world.add(DistanceSpec{.body = 1,
                                 .to_body = 0,
                                 .point = {1.5, -0.5, 0.25},
                                 .to_point = {1.25, -0.5, 0.25},
                                 .least = 0.25,
                                 .most = 0.25});
    for (int i = 0; i < 256; ++i) (void)world.step();
    EXPECT_EQ(world.hash(), 1625733861515916693u);
}

}  // namespace
}  // namespace tumble::test::joint_distances
