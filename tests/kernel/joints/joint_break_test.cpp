// Joints that break, by a load or by a program, and what is recorded of joints. The oracles are closed forms of the
// load, free flight, and the hash of a replay.
#include "joint_cases.hpp"
#include "snapshots.hpp"

#include <array>

namespace tumble::test::joint_breaks {
namespace {

inline constexpr Features brittle = joint_cases::shared;
using joint_cases::g;

template <class W>
class Breaks : public JointCases<W, brittle> {
protected:
    using Base = JointCases<W, brittle>;
    using typename Base::World;

    [[nodiscard]] static double height(const World& world, BodyId id) {
        return static_cast<double>(world.position(id).y);
    }
    // Links on hinges and a sprung ball joint, from the origin on; the joints bear so much.
    static void add_chain(World& world, double force) {
        for (int i = 0; i < 4; ++i) {
            (void)world.add(at(box(1, {0.5, 0.125, 0.125}), {0.25 + 0.5 * i, 0, 0}));
            if (i == 2)
                (void)world.add(BallSpec{.body = i,
                                         .to_body = i - 1,
                                         .anchor = {0.5 * i, 0, 0},
                                         .spring = {.stiffness = 2, .damping = 0.125},
                                         .break_force = force});
            else
                (void)world.add(
                    HingeSpec{.body = i, .to_body = i - 1, .anchor = {0.5 * i, 0, 0}, .break_force = force});
        }
    }
};
TYPED_TEST_SUITE(Breaks, JointKinds<>);

// From the horizontal the rod bears 3 m g sin(a): 2 m g where the ball is 2/3 of its length below.
TYPED_TEST(Breaks, a_rod_breaks_where_its_force_exceeds_what_it_bears) {
    auto world = this->falling(), flight = this->falling();
    const BodyId ball = world.add(at(sphere(2, 0.1), {1, 0, 0}));
    const JointId rod =
        world.add(DistanceSpec{.body = ball, .point = {1, 0, 0}, .least = 1, .most = 1, .break_force = 2 * 2 * g});
    int steps = 0;
    double before = 0;
    while (!this->joint(world, 0).broken && steps++ < 512) {
        before = this->joint(world, 0).force.y;
        this->run(world, 1);
    }
    EXPECT_NEAR(this->height(world, ball), -2.0 / 3, 0.03);
    EXPECT_GT(before, 0);
    EXPECT_TRUE(world.contains(rod));
    EXPECT_EQ(this->joint(world, 0).force.y, 0);
    // From there on it flies as a body without a joint.
    const BodyId free = flight.add(at(sphere(2, 0.1), {1, 0, 0}));
    flight.set_pose(free, world.position(ball), world.orientation(ball));
    flight.set_velocity(free, world.velocity(ball));
    flight.set_angular_velocity(free, world.angular_velocity(ball));
    this->run(world, 100);
    this->run(flight, 100);
    EXPECT_NEAR(this->height(world, ball), this->height(flight, free), 1e-4);
    EXPECT_TRUE(world.status().ok());
}

// A beam of 1 kg and 1 m, fixed at its end: m g / 2 N m and m g N.
TYPED_TEST(Breaks, a_fixed_beam_breaks_by_its_torque_or_its_force_alone) {
    for (const auto& [force, torque, breaks] :
         {std::tuple{0.0, 0.51 * g, false}, std::tuple{0.0, 0.49 * g, true}, std::tuple{1.02 * g, 0.0, false},
          std::tuple{0.98 * g, 0.0, true}, std::tuple{0.0, 0.0, false}}) {
        auto world = this->falling();
        const BodyId beam = world.add(at(box(1, {1, 0.1, 0.1}), {0.5, 0, 0}));
        (void)world.add(FixedSpec{.body = beam, .break_force = force, .break_torque = torque});
        this->run(world, 1);
        EXPECT_FALSE(this->joint(world, 0).broken);  // it goes at the start of the next step
        this->run(world, 1);
        EXPECT_EQ(this->joint(world, 0).broken, breaks) << force << " " << torque;
        this->run(world, 254);
        EXPECT_EQ(this->joint(world, 0).broken, breaks) << force << " " << torque;
        EXPECT_NEAR(this->height(world, beam), breaks ? -g / 2 * 255 / 256 : 0, 0.05);
    }
}

// What hangs below falls, what is above stays.
TYPED_TEST(Breaks, a_chain_goes_on_above_and_below_a_broken_joint) {
    auto world = this->falling();
    this->add_chain(world, 0);
    this->run(world, 10);
    world.break_joint(JointId{2});
    this->run(world, 30);
    EXPECT_TRUE(this->joint(world, 2).broken);
    EXPECT_EQ(world.joint_count(), 4);
    for (const int j : {0, 1, 3}) EXPECT_FALSE(this->joint(world, j).broken);
    // Of the two below: they fly freely, held together.
    double sum = 0;
    for (const int b : {2, 3}) sum += static_cast<double>(world.velocity(BodyId{b}).y);
    this->run(world, 64);
    double later = 0;
    for (const int b : {2, 3}) later += static_cast<double>(world.velocity(BodyId{b}).y);
    EXPECT_NEAR(later - sum, -2 * g / 4, 1e-3);
    EXPECT_TRUE(world.status().ok());
    // It may be added again once it is removed, and not before: its place is taken.
    EXPECT_EQ(world.fault_of(BallSpec{.body = 2, .to_body = 1, .anchor = {1, 0, 0}}), JointFault::none);
    world.remove(JointId{2});
    EXPECT_EQ(world.joint_count(), 3);
    EXPECT_FALSE(world.contains(JointId{2}));
}

// Live calls, and joints that break by themselves, which the recording has too: so the replay breaks nothing itself.
TYPED_TEST(Breaks, a_recording_of_joints_replays_to_the_same_hash) {
    Recorder<typename TestFixture::N, 16> recorder;
    auto live = this->falling(), replayed = this->falling();
    for (auto* world : {&live, &replayed}) this->add_chain(*world, 60);
    live.record(&recorder);
    this->run(live, 20);
    live.apply_impulse(BodyId{1}, {0, 1, 0.5});
    this->run(live, 60);
    live.apply_impulse(BodyId{3}, {4, -8, 0});
    this->run(live, 100);
    live.break_joint(JointId{0});
    live.remove(JointId{0});
    live.remove(BodyId{2});
    this->run(live, 100);
    int of_joints = 0;
    for (int i = 0; i < recorder.count(); ++i) of_joints += has_joint(recorder[i].kind) ? 1 : 0;
    EXPECT_GT(of_joints, 2);  // more than the calls
    replayed.set_script(recorder.script());
    this->run(replayed, 280);
    EXPECT_EQ(live.hash(), replayed.hash());
    EXPECT_EQ(live.joint_count(), replayed.joint_count());
    // Without its script the copy breaks by itself as the live world did, up to the second blow.
    EXPECT_STREQ(name_of(EventKind::break_joint), "break_joint");
    EXPECT_STREQ(name_of(EventKind::remove_joint), "remove_joint");
}

TYPED_TEST(Breaks, a_script_breaks_a_joint_at_its_time) {
    auto world = this->falling();
    this->add_chain(world, 0);
    const std::array events{world.prepare({.time = 0.25, .kind = EventKind::break_joint, .body = 1}),
                            world.prepare({.time = 0.5, .kind = EventKind::remove_joint, .body = 1}),
                            world.prepare({.time = 0.75, .kind = EventKind::break_joint, .body = 1})};
    world.set_script({events.data(), 3});
    this->run(world, 64);
    EXPECT_FALSE(this->joint(world, 1).broken);
    this->run(world, 1);
    EXPECT_TRUE(this->joint(world, 1).broken);
    this->run(world, 64);
    EXPECT_FALSE(world.contains(JointId{1}));
    this->run(world, 128);  // the last event names a joint that is gone
    EXPECT_EQ(world.joint_count(), 3);
    EXPECT_TRUE(world.status().ok());
}

// Forth and back over a break, with springs and ropes.
TYPED_TEST(Breaks, a_snapshot_knows_what_has_broken) {
    const auto make = [&](double force) {
        auto world = this->falling();
        this->add_chain(world, force);
        (void)world.add(at(sphere(1, 0.1), {2.25, 0.5, 0}));
        (void)world.add(
            DistanceSpec{.body = 4, .to_body = 3, .point = {2.25, 0.5, 0}, .to_point = {2, 0, 0}, .most = 0.75});
        return world;
    };
    auto world = make(0);
    this->run(world, 40);
    const auto whole = save(world);
    world.break_joint(JointId{2});
    this->run(world, 40);
    auto broken = save(world);
    EXPECT_EQ(whole.size(), broken.size());
    this->run(world, 40);
    const std::uint64_t end = world.hash();
    auto other = make(0);
    ASSERT_EQ(restore(other, broken), SnapshotFault::none);
    EXPECT_TRUE(this->joint(other, 2).broken);
    this->run(other, 40);
    EXPECT_EQ(other.hash(), end);
    for (auto* from_start : {&world, &other}) {
        ASSERT_EQ(restore(*from_start, whole), SnapshotFault::none);
        EXPECT_FALSE(this->joint(*from_start, 2).broken);
        from_start->break_joint(JointId{2});
        this->run(*from_start, 80);
        EXPECT_EQ(from_start->hash(), end);
    }
    auto stronger = make(1000);
    EXPECT_EQ(restore(stronger, whole), SnapshotFault::other_scene);
    broken[40] ^= 1;
    EXPECT_EQ(restore(other, broken), SnapshotFault::corrupted);
}

// Joints go and come back at steps that the seed chooses; events are recorded, so a world that went back replays them.
TYPED_TEST(Breaks, a_world_goes_back_over_joints_that_broke_or_were_removed) {
    using World = typename TestFixture::World;
    for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
        auto random = [state = seed]() mutable { return (state = state * 1664525u + 1013904223u) >> 16; };
        World world = this->falling();
        this->add_chain(world, seed % 2 == 0 ? 60 : 0);
        if (seed % 3 == 0) world.remove(BodyId{3});
        const World start = world;
        Recorder<typename TestFixture::N, 32> recorder;
        world.record(&recorder);
        struct Saved {
            SavedBytes bytes;
            int step = 0, joints = 0;
        };
        std::vector<Saved> saved;
        std::vector<std::uint64_t> hashes;
        for (int step = 0; step < 120; ++step) {
            if (step % 30 == 10) saved.push_back({save(world), step, world.joint_count()});
            const JointId id{static_cast<int>(random() % 4)};
            if (step % 30 == 20 && world.contains(id)) {
                if (random() % 3 != 0) world.remove(id);
                else world.break_joint(id);
            }
            if (random() % 8 == 0) world.apply_impulse(BodyId{static_cast<int>(random() % 3)}, {0, 0.25, 0.125});
            this->run(world, 1);
            hashes.push_back(world.hash());
        }
        EXPECT_LT(world.joint_count(), start.joint_count()) << seed;
        world.record(nullptr);
        for (World going : {world, start}) {
            going.set_script(recorder.script());
            for (const auto& [bytes, step, joints] : saved) {
                ASSERT_EQ(restore(going, bytes), SnapshotFault::none) << seed << " " << step;
                EXPECT_EQ(going.joint_count(), joints) << seed << " " << step;
                for (int k = step; k < 120; ++k) {
                    this->run(going, 1);
                    ASSERT_EQ(going.hash(), hashes[static_cast<std::size_t>(k)]) << seed << " " << step << " " << k;
                }
            }
        }
        // The joints stay those of the world where bodies alone go back.
        const int left = world.joint_count();
        ASSERT_EQ(restore(world, save(start, SnapshotPart::bodies)), SnapshotFault::none);
        EXPECT_EQ(world.joint_count(), left);
        this->run(world, 10);
        // A body that goes takes its joints along for good: it is of the scene.
        World less = start;
        less.remove(BodyId{2});
        const std::uint64_t before = less.hash();
        EXPECT_EQ(restore(less, saved[0].bytes), SnapshotFault::other_scene);
        EXPECT_EQ(less.hash(), before);
    }
}

// Bytes with a right check word that name joints which no world of this scene had.
TYPED_TEST(Breaks, forged_joints_are_refused) {
    auto world = this->falling();
    this->add_chain(world, 0);
    world.break_joint(JointId{3});
    // It has the place of a broken one beside it: both at once would close a loop.
    (void)world.add(HingeSpec{.body = 3, .to_body = 2, .anchor = {1.5, 0, 0}});
    const auto bytes = save(world);
    // The states of six joints follow each other: there, there, there, there and broken, there, none.
    const std::array<std::uint32_t, 6> states{1, 1, 1, 3, 1, 0};
    std::size_t at = 0;
    const auto word = [&](std::size_t i) { return tumble::detail::word_at(bytes.data() + i); };
    for (std::size_t i = 32; at == 0 && i + 24 <= bytes.size(); i += 4) {
        bool is_here = true;
        for (std::size_t k = 0; k < 6; ++k) is_here = is_here && word(i + 4 * k) == states[k];
        if (is_here) at = i;
    }
    ASSERT_GT(at, 0u);
    const auto fault_with = [&](std::size_t joint, std::uint8_t state) {
        auto forged = bytes;
        forged[at + 4 * joint] = state;
        tumble::detail::Crc32 crc;
        for (std::size_t i = 0; i + 4 < forged.size(); ++i) crc.add(forged[i]);
        for (std::size_t i = 0; i < 4; ++i)
            forged[forged.size() - 4 + i] = static_cast<std::uint8_t>(crc.value() >> (8 * i));
        auto other = world;
        const SnapshotFault fault = restore(other, forged);
        EXPECT_TRUE(fault == SnapshotFault::none || other.hash() == world.hash());
        this->run(other, 2);
        return fault;
    };
    EXPECT_EQ(fault_with(2, 1), SnapshotFault::none);
    EXPECT_EQ(fault_with(2, 0), SnapshotFault::none);       // it is removed there
    EXPECT_EQ(fault_with(3, 1), SnapshotFault::corrupted);  // a loop
    EXPECT_EQ(fault_with(5, 1), SnapshotFault::corrupted);  // there never was one
    EXPECT_EQ(fault_with(5, 2), SnapshotFault::none);       // nothing that is broken
}

TYPED_TEST(Breaks, a_strength_that_cannot_be_is_refused) {
    auto world = this->falling();
    (void)world.add(at(box(1, {1, 0.5, 0.25}), {}));
    EXPECT_EQ(world.fault_of(HingeSpec{.body = 0, .break_force = -1}), JointFault::bad_strength);
    EXPECT_EQ(world.fault_of(FixedSpec{.body = 0, .break_torque = -1}), JointFault::bad_strength);
    EXPECT_STREQ(name_of(JointFault::bad_strength), "bad_strength");
#ifndef __SANITIZE_ADDRESS__
    tumble::World<SceneOf<typename TestFixture::N, integrators::Verlet, Features{.joints = 1}>> without{
        Seconds{1, 256}};
    (void)without.add(at(box(1, {1, 0.5, 0.25}), {}));
    EXPECT_DEATH((void)without.add(HingeSpec{.body = 0, .break_force = 1}), "");
    EXPECT_DEATH(world.break_joint(JointId{0}), "");
    EXPECT_DEATH(without.apply(Event<typename TestFixture::N>::of_joint(EventKind::break_joint, JointId{0})), "");
#endif
}

}  // namespace
}  // namespace tumble::test::joint_breaks
