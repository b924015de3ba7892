// Layers: which bodies touch each other, and worlds in which mechanisms and contacts stand beside each other. The
// oracle of the latter is the same mechanism, and the same bodies, alone: not a bit may differ.
#include <tumble/tumble.hpp>

#include "kinds.hpp"
#include "snapshots.hpp"

#include <vector>

namespace tumble::test::joint_layers {
namespace {

inline constexpr Features layered = [] {
    Features all = touching(8, 1);
    all.springs = 2;
    all.joints = 4;
    all.control = all.layers = all.sleep = all.turntables = all.kinematic = true;
    all.bounded_steps = all.contact_springs = true;
    return all;
}();
template <class W, Features features = layered>
using WorldOf = World<SceneOf<typename W::Numbers, typename W::Integrator, features>>;

template <class W>
class Layered : public testing::Test {};
using LayeredKinds = Tested<testing::Types<Kind<Q32<>, integrators::Verlet>>,
                            testing::Types<Kind<F32, integrators::Verlet>, Kind<F64, integrators::Strang>>>;
TYPED_TEST_SUITE(Layered, LayeredKinds);

constexpr Seconds step{1, 256};
constexpr WorldSpec falling{.gravity = {0, -9.81, 0}};

[[nodiscard]] BodySpec placed(BodySpec body, const RealVec3& position, unsigned layers = BodySpec::all_layers) {
    body.position = position;
    body.layers = static_cast<std::uint16_t>(layers);
    return body;
}
void run(auto& world, int steps) {
    for (int i = 0; i < steps; ++i) (void)world.step();
}
[[nodiscard]] double height(const auto& world, BodyId id) { return static_cast<double>(world.position(id).y); }

// By impulses in exact and in bounded steps, and by springs.
[[nodiscard]] std::vector<WorldSpec> responses() {
    WorldSpec bounded = falling, springs = falling;
    bounded.contact.exact_bodies = 0;
    springs.contact.response = ContactResponse::spring;
    springs.contact.stiffness = 2000;
    springs.contact.damping = 20;
    return {falling, bounded, springs};
}

TYPED_TEST(Layered, bodies_without_a_common_layer_pass_through_each_other) {
    for (const WorldSpec& spec : responses()) {
        for (const bool meet : {false, true}) {
            for (const char held : {'m', 'f', 'k', 't'}) {
                WorldOf<TypeParam> world{step, spec};
                BodySpec table = placed(box(10, {2, 0.5, 2}), {0, 0.25, 0}, 0x0006);
                if (held == 'f' || held == 't') table.fixed = true;
                if (held == 't') table.angular_velocity = {0, 1, 0};
                if (held == 'k') table.kinematic = true;
                if (held == 'k') table.velocity = {0.125, 0, 0};
                const BodyId ball = world.add(placed(sphere(1, 0.25), {0, 1.25, 0}, meet ? 0x8002 : 0x8001));
                (void)world.add(table);
                (void)world.add(PlaneSpec{});
                run(world, 512);
                // On the table, or in it and on the ground.
                EXPECT_NEAR(height(world, ball), meet ? 0.75 : 0.25, 0.02) << held << meet;
                EXPECT_TRUE(world.status().ok());
            }
        }
    }
}

TYPED_TEST(Layered, a_body_in_no_layer_falls_through_bodies_and_planes) {
    for (const WorldSpec& spec : responses()) {
        WorldOf<TypeParam> world{step, spec};
        (void)world.add(PlaneSpec{});
        const BodyId ghost = world.add(placed(box(1, {0.5, 0.5, 0.5}), {0, 2, 0}, 0));
        const BodyId ball = world.add(placed(sphere(1, 0.25), {0, 0.25, 0}));
        run(world, 256);
        EXPECT_NEAR(height(world, ghost), 2 - 9.81 / 2, 1e-3);
        EXPECT_NEAR(height(world, ball), 0.25, 0.01);
        EXPECT_EQ(world.contact_count(ghost), 0);
    }
}

// A mask names pairs alone: all other results are those of a world without layers.
TYPED_TEST(Layered, all_bodies_in_one_layer_move_as_without_layers) {
    constexpr Features plain = [] {
        Features features = layered;
        features.layers = false;
        return features;
    }();
    for (const WorldSpec& spec : responses()) {
        WorldOf<TypeParam> with{step, spec};
        WorldOf<TypeParam, plain> without{step, spec};
        const auto fill = [](auto& world, unsigned layers) {
            (void)world.add(PlaneSpec{});
            for (int i = 0; i < 4; ++i)
                (void)world.add(placed(box(1, {0.5, 0.25, 0.5}), {0.0625 * i, 0.375 + 0.375 * i, 0}, layers));
        };
        fill(with, 0x0100);
        fill(without, BodySpec::all_layers);
        run(with, 200);
        run(without, 200);
        EXPECT_EQ(with.hash(), without.hash());
    }
}

// A double pendulum over a falling heap, through which it swings.
template <class W, Features features>
struct Beside {
    WorldOf<W, features> world;
    std::vector<BodyId> heap, mechanism;

    Beside(const WorldSpec& spec, bool has_heap, bool has_mechanism) : world{step, spec} {
        for (int i = 0; has_heap && i < 4; ++i) {
            if constexpr (features.planes > 0) {
                if (i == 0) (void)world.add(PlaneSpec{});
                heap.push_back(world.add(placed(box(1, {0.5, 0.25, 0.5}), {0.03125 * i, 0.375 + 0.375 * i, 0})));
            }
        }
        if (!has_mechanism) return;
        for (int i = 0; i < 2; ++i)
            mechanism.push_back(world.add(placed(box(1, {1, 0.125, 0.125}), {0.5 + i, 1, 0}, 0)));
        mechanism.push_back(world.add(placed(sphere(1, 0.125), {2.5, 1, 0}, 0)));
        (void)world.add(HingeSpec{.body = mechanism[0], .anchor = {0, 1, 0}});
        (void)world.add(BallSpec{.body = mechanism[1], .to_body = mechanism[0], .anchor = {1, 1, 0}});
        // The sphere has no joint: a spring ties it to the pendulum.
        (void)world.add(SpringSpec{.body = mechanism[2],
                                   .to_body = mechanism[1],
                                   .to = {0.5, 0, 0},
                                   .stiffness = 50,
                                   .damping = 0.5,
                                   .rest_length = 0.25});
    }
    // Of the motion of these bodies.
    [[nodiscard]] std::uint64_t hash(const std::vector<BodyId>& ids) const {
        Hash sum;
        for (const BodyId id : ids) sum.add<typename W::Numbers>(world.state(id));
        return sum.value();
    }
};

TYPED_TEST(Layered, mechanisms_and_contacts_beside_each_other_keep_their_bits) {
    constexpr Features alone{.bodies = 3, .springs = 1, .joints = 2};
    for (WorldSpec spec : responses()) {
        spec.contact.friction = 0.5;
        spec.contact.restitution = 0.25;
        spec.contact.sleep.on = spec.contact.response == ContactResponse::impulse;
        Beside<TypeParam, layered> both{spec, true, true}, heap{spec, true, false};
        Beside<TypeParam, alone> mechanism{falling, false, true};
        run(both.world, 600);
        run(heap.world, 600);
        run(mechanism.world, 600);
        EXPECT_EQ(both.hash(both.heap), heap.hash(heap.heap));
        EXPECT_EQ(both.hash(both.mechanism), mechanism.hash(mechanism.mechanism));
        for (const BodyId id : both.heap) EXPECT_EQ(both.world.asleep(id), spec.contact.sleep.on);
        EXPECT_FALSE(both.world.asleep(both.mechanism[0]));
        EXPECT_EQ(both.world.status().bits, heap.world.status().bits | mechanism.world.status().bits);
        EXPECT_NE(static_cast<double>(both.world.template joint<float>(JointId{0}).speed), 0);
    }
}

TYPED_TEST(Layered, a_jointed_body_that_would_touch_is_refused) {
    WorldOf<TypeParam> world{step, falling};
    (void)world.add(PlaneSpec{});
    const BodyId in = world.add(placed(sphere(1, 0.25), {0, 2, 0}, 1));
    const BodyId out = world.add(placed(sphere(1, 0.25), {1, 2, 0}, 0));
    const BodyId far = world.add(placed(sphere(1, 0.25), {2, 2, 0}, 0));
    const BodyId base = world.add(fixed(placed(box(1, {1, 1, 1}), {0, 4, 0})));
    BodySpec mover = placed(box(1, {1, 1, 1}), {0, 6, 0}), table = fixed(placed(box(1, {1, 1, 1}), {0, 8, 0}));
    mover.kinematic = true;
    table.angular_velocity = {0, 1, 0};
    const BodyId moving = world.add(mover), turning = world.add(table);
    EXPECT_EQ(world.fault_of(BallSpec{.body = in}), JointFault::in_a_layer);
    EXPECT_EQ(world.fault_of(BallSpec{.body = base, .to_body = in}), JointFault::in_a_layer);
    EXPECT_EQ(world.fault_of(BallSpec{.body = out, .to_body = in}), JointFault::in_a_layer);
    EXPECT_EQ(world.fault_of(BallSpec{.body = out, .to_body = moving}), JointFault::moving_base);
    EXPECT_EQ(world.fault_of(BallSpec{.body = out, .to_body = turning}), JointFault::moving_base);
    EXPECT_EQ(world.fault_of(BallSpec{.body = out, .to_body = base}), JointFault::none);
    EXPECT_STREQ(name_of(JointFault::in_a_layer), "in_a_layer");
    EXPECT_STREQ(name_of(JointFault::moving_base), "moving_base");
    // A spring from a body that touches to one that does not: the latter has no joint, either.
    (void)world.add(SpringSpec{.body = in, .to_body = far, .stiffness = 1, .rest_length = 2});
    EXPECT_EQ(world.fault_of(BallSpec{.body = far}), JointFault::in_a_layer);
    EXPECT_EQ(world.fault_of(BallSpec{.body = out, .to_body = far}), JointFault::in_a_layer);
    EXPECT_TRUE(world.add(BallSpec{.body = out, .to_body = base, .anchor = {0, 3, 0}}));
    run(world, 16);
    EXPECT_TRUE(world.status().ok());
#ifndef __SANITIZE_ADDRESS__
    EXPECT_DEATH((void)world.add(BallSpec{.body = in}), "");
    EXPECT_DEATH((void)world.add(BallSpec{.body = far, .to_body = moving}), "");
    EXPECT_DEATH((void)world.add(SpringSpec{.body = in, .to_body = out, .stiffness = 1}), "");
    EXPECT_DEATH(world.set_angular_velocity(base, {0, 1, 0}), "");
#endif
}

TYPED_TEST(Layered, a_snapshot_of_mechanisms_and_contacts_goes_on_with_the_same_bits) {
    WorldSpec spec = falling;
    spec.contact.sleep.on = true;
    Beside<TypeParam, layered> saved{spec, true, true}, restored{spec, true, true};
    run(saved.world, 100);
    ASSERT_EQ(restore(restored.world, save(saved.world)), SnapshotFault::none);
    run(saved.world, 400);
    run(restored.world, 400);
    EXPECT_EQ(saved.world.hash(), restored.world.hash());
}

// The body that comes after one that was removed has layers of its own.
TYPED_TEST(Layered, a_place_forgets_the_layers_of_a_removed_body) {
    WorldOf<TypeParam> world{step, falling};
    (void)world.add(PlaneSpec{});
    const BodyId first = world.add(placed(sphere(1, 0.25), {0, 2, 0}, 0));
    const BodyId table = world.add(fixed(placed(box(1, {1, 0.5, 1}), {0, 0.25, 0}, 4)));
    run(world, 10);
    world.remove(first);
    const BodyId second = world.add(placed(sphere(1, 0.25), {0, 2, 0}, 4));
    run(world, 400);
    EXPECT_NEAR(height(world, second), 0.75, 0.02);
    world.remove(table);
    (void)world.add(fixed(placed(box(1, {1, 0.5, 1}), {0, 0.25, 0}, 3)));
    run(world, 400);
    EXPECT_NEAR(height(world, second), 0.25, 0.02);
}

// A mechanism of bodies that are removed, and one of those whose joint is.
TYPED_TEST(Layered, bodies_whose_joints_go_fly_on) {
    Beside<TypeParam, layered> both{falling, true, true};
    run(both.world, 50);
    both.world.remove(JointId{0});
    run(both.world, 50);
    both.world.remove(both.mechanism[1]);
    const double before = height(both.world, both.mechanism[0]);
    run(both.world, 50);
    EXPECT_EQ(both.world.joint_count(), 0);
    EXPECT_LT(height(both.world, both.mechanism[0]), before - 0.1);
    EXPECT_TRUE(both.world.status().ok());
}

}  // namespace
}  // namespace tumble::test::joint_layers
