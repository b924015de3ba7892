// Bodies that leave a world: what they leave behind, and who takes their place. The oracle is a world without the body.
#include <tumble/tumble.hpp>

#include "kinds.hpp"

#include <vector>

namespace tumble::test {
namespace {

using LeavingWays = Tested<testing::Types<Kind<Q32<NearRange>, integrators::Verlet>>,
                           testing::Types<Kind<F64, integrators::Rk4>, Kind<Q32<NearRange, false>, integrators::Rk4>,
                                          Kind<Q32<NearRange>, integrators::Pdmv6>, Kind<F32, integrators::Verlet>>>;

constexpr Features everything_that_leaves = [] {
    Features f = Features{.bodies = 5, .planes = 2, .springs = 3}.with_everything();
    f.contact_springs = false;
    return f;
}();
constexpr Features only_leaving{.removal = true};

template <class W>
class Removal : public testing::Test {
protected:
    template <Features features>
    using WorldOf = World<SceneOf<typename W::Numbers, typename W::Integrator, features>>;
    using Full = WorldOf<everything_that_leaves>;

    [[nodiscard]] static Full world(Real gravitation = 0) {
        Full world{Seconds{1, 256},
                   {.gravity = {0, -9.81, 0},
                    .gravitation = gravitation,
                    .contact = {.restitution = 0.25, .friction = 0.4, .sleep = {.on = true}}}};
        (void)world.add(PlaneSpec{});
        return world;
    }
    template <class World>
    static void run(World& world, int steps) {
        for (int i = 0; i < steps; ++i) world.step();
    }
};
TYPED_TEST_SUITE(Removal, LeavingWays);

TYPED_TEST(Removal, the_others_move_as_if_the_body_had_never_been_there) {
    auto with = this->world(4), without = this->world(4);
    const BodySpec box = tumble::box(1, {0.5, 0.5, 0.5}), ball = sphere(2, 0.25);
    const BodyId first = with.add(at(box, {0, 0.5, 0})), gone = with.add(at(ball, {0.2, 0.4, 0})),
                 last = with.add(at(ball, {2, 0.5, 0.1}));
    const BodyId a = without.add(at(box, {0, 0.5, 0})), b = without.add(at(ball, {2, 0.5, 0.1}));
    SpringSpec tie;
    tie.stiffness = 10;
    tie.body = gone;
    tie.to_body = last;
    (void)with.add(tie);
    tie.body = first;
    (void)with.add(tie);
    tie.body = a;
    tie.to_body = b;
    (void)without.add(tie);
    with.set_force(gone, {100, 0, 0}, Frame::world);
    with.remove(gone);
    EXPECT_EQ(with.body_count(), 2);
    EXPECT_FALSE(with.contains(gone));
    for (int i = 0; i < 256; ++i) {
        with.step();
        without.step();
        ASSERT_TRUE(with.state(first) == without.state(a) && with.state(last) == without.state(b)) << i;
    }
    EXPECT_EQ(with.contact_count(first), without.contact_count(a));
    EXPECT_EQ(with.near_pair_count(), without.near_pair_count());
    EXPECT_EQ(with.status().bits, without.status().bits);
}

// A spring ties the box on the table to one on the floor, which goes on standing.
TYPED_TEST(Removal, a_box_falls_when_its_table_goes_though_what_it_is_tied_to_stands) {
    const BodySpec box = tumble::box(1, {1, 1, 1});
    BodySpec table = box;
    table.fixed = true;
    for (const bool moves : {false, true}) {
        auto world = this->world();
        const BodyId low = world.add(at(box, {0, 0.5, 0})), support = world.add(at(table, {4, 0.5, 0})),
                     high = world.add(at(box, {4, 1.5, 0}));
        SpringSpec tie;
        tie.stiffness = 0.25F;
        tie.rest_length = Real{4};
        tie.body = low;
        tie.to_body = high;
        (void)world.add(tie);
        this->run(world, 16);
        EXPECT_EQ(world.contact_count(high), 4);
        if (moves) world.set_pose(support, {4, 0.5, 8});
        else world.remove(support);
        this->run(world, 32);
        EXPECT_LT(static_cast<double>(world.position(high).y), 1.45);
        EXPECT_NEAR(static_cast<double>(world.position(low).y), 0.5, 1e-3);
    }
}

TYPED_TEST(Removal, the_place_is_used_again_under_another_id) {
    auto world = this->world();
    const BodySpec ball = sphere(1, 0.25);
    std::vector<BodyId> ids;
    for (int i = 0; i < 5; ++i) ids.push_back(world.add(at(ball, {i, 2, 0})));
    EXPECT_FALSE(world.add(ball));
    EXPECT_TRUE(world.status().has(Issue::world_full));
    this->run(world, 8);
    world.remove(ids[3]);
    world.remove(ids[1]);
    this->run(world, 8);
    const BodyId again = world.add(at(ball, {9, 2, 0}));
    EXPECT_EQ(again.index(), 1) << "the first free place";
    EXPECT_NE(again, ids[1]);
    EXPECT_EQ(again.generation(), 1);
    EXPECT_TRUE(world.contains(again));
    EXPECT_FALSE(world.contains(ids[1]));
    EXPECT_EQ(world.add(at(ball, {8, 2, 0})).index(), 3);
    EXPECT_FALSE(world.add(ball));
    EXPECT_EQ(world.body_count(), 5);
    EXPECT_EQ(static_cast<double>(world.position(again).x), 9);
    EXPECT_EQ(static_cast<double>(world.velocity(again).y), 0);
}

TYPED_TEST(Removal, a_body_in_a_used_place_moves_as_one_in_a_new_place) {
    auto used = this->world(), fresh = this->world();
    const BodySpec box = at(tumble::box(1, {0.5, 0.4, 0.3}), {0, 0.5, 0});
    BodySpec other = at(sphere(3, 0.5), {5, 0.5, 0});
    other.velocity = {1, 2, 3};
    other.angular_velocity = {3, 2, 1};
    const BodyId old = used.add(other);
    used.set_force(old, {1, 2, 3}, Frame::body, {0.1, 0, 0});
    this->run(used, 64);
    this->run(fresh, 64);
    used.remove(old);
    const BodyId a = used.add(box), b = fresh.add(box);
    EXPECT_EQ(used.contact_count(a), 0);
    for (int i = 0; i < 512; ++i) {
        used.step();
        fresh.step();
        ASSERT_TRUE(used.state(a) == fresh.state(b)) << i;
        ASSERT_EQ(used.asleep(a), fresh.asleep(b)) << i;
    }
    EXPECT_EQ(used.hash(), fresh.hash());
}

TYPED_TEST(Removal, a_sleeping_body_falls_when_what_it_rests_on_is_removed) {
    auto world = this->world();
    const BodyId below = world.add(at(box(2, {1, 0.5, 1}), {0, 0.25, 0})),
                 above = world.add(at(box(1, {0.5, 0.5, 0.5}), {0, 0.75, 0}));
    this->run(world, 600);
    EXPECT_TRUE(world.asleep(above));
    world.remove(below);
    EXPECT_FALSE(world.asleep(above));
    this->run(world, 32);
    EXPECT_NEAR(static_cast<double>(world.position(above).y), 0.75 - 9.81 / 128, 0.02);
}

TYPED_TEST(Removal, a_removed_body_counts_in_the_hash_and_a_copy_keeps_it) {
    auto world = this->world();
    (void)world.add(at(sphere(1, 0.25), {0, 3, 0}));
    const BodyId gone = world.add(at(sphere(1, 0.25), {1, 3, 0}));
    const auto before = world;
    world.remove(gone);
    EXPECT_NE(world.hash(), before.hash());
    auto copy = world;
    this->run(world, 16);
    this->run(copy, 16);
    EXPECT_EQ(copy.hash(), world.hash());
    EXPECT_TRUE(before.contains(gone));
    EXPECT_FALSE(copy.contains(gone));
}

TYPED_TEST(Removal, a_recording_has_the_removal_and_a_script_skips_events_of_removed_bodies) {
    using E = Event<typename TypeParam::Numbers>;
    auto live = this->world(), replayed = live;
    BodyId ids[2];
    for (auto* world : {&live, &replayed})
        for (int i = 0; i < 2; ++i) ids[i] = world->add(at(sphere(1, 0.25), {i, 3, 0}));
    Recorder<typename TypeParam::Numbers, 4> recorder;
    live.record(&recorder);
    this->run(live, 5);
    live.remove(ids[0]);
    this->run(live, 5);
    ASSERT_EQ(recorder.count(), 1);
    std::vector<E> events{recorder[0], recorder[0]};
    events[1] = E{.kind = EventKind::velocity, .body = ids[0], .value = {1, 2, 3}, .step = 7};
    replayed.set_script({events.data(), 2});
    this->run(replayed, 10);
    EXPECT_EQ(replayed.hash(), live.hash());
}

TYPED_TEST(Removal, a_minimal_world_can_be_emptied_and_filled) {
    typename TestFixture::template WorldOf<only_leaving> world{Seconds{1, 256}, {.gravity = {0, -9.81, 0}}};
    for (int i = 0; i < 3; ++i) {
        const BodyId id = world.add(at(sphere(1, 0.5), {i, 3, 0}));
        EXPECT_EQ(id.generation(), i);
        this->run(world, 4);
        EXPECT_LT(static_cast<double>(world.velocity(id).y), 0);
        world.remove(id);
        this->run(world, 4);
        EXPECT_EQ(world.body_count(), 0);
    }
    EXPECT_TRUE(world.status().ok());
}

TYPED_TEST(Removal, the_id_of_a_removed_body_is_misuse) {
    auto world = this->world();
    const BodyId gone = world.add(sphere(1, 0.25));
    const BodyId kept = world.add(at(sphere(1, 0.25), {1, 0, 0}));
    world.remove(gone);
    EXPECT_DEATH(world.remove(gone), "");
    EXPECT_DEATH((void)world.position(gone), "");
    EXPECT_DEATH(world.set_force(gone, {1, 0, 0}, Frame::world), "");
    EXPECT_DEATH(world.apply_impulse(gone, {1, 0, 0}), "");
    SpringSpec tie;
    tie.body = kept;
    tie.to_body = gone;
    tie.stiffness = 1;
    EXPECT_DEATH((void)world.add(tie), "");
    (void)world.add(sphere(1, 0.25));
    EXPECT_DEATH((void)world.position(gone), "") << "another body is in its place";
}

}  // namespace
}  // namespace tumble::test
