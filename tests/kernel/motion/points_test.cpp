// Point masses: they move like the centre of mass of any body, and have no rotation. skipping_test.cpp shows that a
// world of point masses only has the same bits as one with every feature.
#include "references.hpp"
#include "tolerances.hpp"

#include <tumble/tumble.hpp>

#include <cmath>

namespace tumble::test {
namespace {

class Points : public CaseTest {};
INSTANTIATE_TEST_SUITE_P(every, Points, testing::ValuesIn(every_case()), NameOf{});

// The scene with a sphere of the same mass in place of each point mass.
SceneSetup with_spheres(SceneSetup setup, RealVec3 spin) {
    for (BodySpec& body : setup.bodies) {
        if (!is_point_mass(body)) continue;
        BodySpec other = placed(sphere(body.mass, 0.0625), vector(body.position), vector(body.velocity));
        other.fixed = body.fixed;
        other.angular_velocity = spin;
        body = other;
    }
    return setup;
}

void expect_one_motion(const SceneSetup& one, const SceneSetup& other, const Case& c) {
    const auto a = build(one, c), b = build(other, c);
    for (int step = 0; step < 400; ++step) {
        a->step();
        b->step();
        ASSERT_EQ(a->status().bits, b->status().bits) << "differs after step " << step;
        for (int body = 0; body < a->body_count(); ++body) {
            const Motion x = a->motion(body), y = b->motion(body);
            ASSERT_TRUE(x.x == y.x && x.v == y.v) << "body " << body << " differs after step " << step;
        }
    }
}

TEST_P(Points, fly_with_the_same_bits_as_spinning_bodies) {
    SceneSetup setup{.name = "thrown"};
    setup.world = {.gravity = {0, -9.81, 0}};
    setup.bodies = {placed(point_mass(0.3), {-3, 7, 0.1}, {2, 5, -1})};
    expect_one_motion(setup, with_spheres(setup, {1, -2, 0.5}), GetParam());
}

TEST_P(Points, move_under_loads_with_the_same_bits_as_bodies_that_do_not_turn) {
    SceneSetup setup{.name = "loaded"};
    setup.world = {
        .gravity = {0, -1, 0}, .gravitation = 2, .linear_drag = 0.05, .contact = {.response = ContactResponse::none}};
    setup.bodies = {fixed(point_mass(6)), placed(point_mass(0.5), {3, 0.5, 0}, {0, 1.5, 0.25}),
                    placed(point_mass(1), {-4, 0, 1}, {0, -1, 0})};
    setup.springs = {{.body = 1, .to_body = 2, .stiffness = 3, .damping = 0.125, .rest_length = 2},
                     {.body = 2, .to = {-3, 4, 0}, .stiffness = 2}};
    setup.forces = {{.body = 1, .from = 0.25, .until = 1.0, .force = {0, 0.5, 0.25}}};
    setup.impulses = {{.time = 0.5, .body = 2, .impulse = {0.25, 0, -0.125}}};
    expect_one_motion(setup, with_spheres(setup, {}), GetParam());
}

TEST_P(Points, thrown_follow_the_parabola) {
    SceneSetup setup{.name = "parabola"};
    setup.world = {.gravity = {0, -8, 0}};
    setup.bodies = {placed(point_mass(0.7), {}, {3, 8, -1})};
    const auto world = run(setup, 512);
    const Motion m = world->motion(0);
    const Vector expected{6, 0, -2};
    // A method of order 1 advances by the velocity of one end of the step: the error is g t h / 2.
    const Bound of_method = order() == 1 ? tolerance::method_error(1, 8.0L / 512, 2) : Bound{};
    EXPECT_LE(norm(m.x - expected), of_method + tolerance::coasting.of(system()));
    EXPECT_LE(norm(m.v - Vector{3, -8, -1}), tolerance::coasting.of(system()));
}

TEST_P(Points, on_an_orbit_keep_their_energy_and_angular_momentum) {
    // About a fixed mass: a = 4 m, G M = 64, period 2 pi, eccentricity 1/4, from the perihelion.
    SceneSetup setup{.name = "orbit", .step = Seconds{1, 512}};
    setup.world.gravitation = 0.5;
    setup.bodies = {fixed(point_mass(128)),
                    placed(point_mass(1), {3, 0, 0}, {0, std::sqrt(64 * (2 / Number(3) - 1 / Number(4))), 0})};
    const auto world = build(setup, GetParam());
    const Vector start = cross(world->motion(1).x, world->motion(1).v);
    world->run(3217);  // one turn
    const Motion m = world->motion(1);
    const Bound allowed =
        16 * tolerance::method_error(order(), 3.0L / 512, 12) + 20 * tolerance::loaded_flight.of(system());
    EXPECT_LE(std::abs((dot(m.v, m.v) / 2 - 64 / norm(m.x)) / -8 - 1), allowed);
    EXPECT_LE(norm(cross(m.x, m.v) - start), norm(start) * allowed);
    EXPECT_TRUE(world->status().ok());
}

TEST_P(Points, pull_a_body_and_do_not_rotate) {
    SceneSetup setup{.name = "mixed"};
    setup.world = {.angular_drag = 0.25};
    setup.bodies = {placed(point_mass(2), {1, 0, 0}, {0, 0.5, 0.25}),
                    top({3, 2, 1}, {0.25, 0.5, 0.125}, 3, {-1, 0.5, 0})};
    setup.springs = {{.body = 0, .to_body = 1, .to = {0, -0.25, 0.5}, .stiffness = 10, .damping = 0.25}};
    const auto world = build(setup, GetParam());
    const auto momentum = [&] { return 2 * world->motion(0).v + 3 * world->motion(1).v; };
    const Vector start = momentum();
    const Motion before = world->motion(1);
    world->run(256);
    EXPECT_LE(norm(momentum() - start), 16 * tolerance::loaded_flight.of(system()));
    EXPECT_GT(norm(world->motion(1).w - before.w), 0.1L);
    for (const Motion& point : {world->motion(0), world->reported(0)}) {
        EXPECT_TRUE(point.q == (Rotation{1, {0, 0, 0}}));
        EXPECT_TRUE(point.w == (Vector{0, 0, 0}));
    }
}

struct Cloud : Scene {
    static constexpr Features features{
        .bodies = 2, .springs = 2, .rotation = false, .point_masses = true, .forces = true, .impulses = true};
};
struct Mixed : Scene {
    static constexpr Features features{
        .bodies = 2, .springs = 2, .point_masses = true, .forces = true, .impulses = true};
};

// Position and velocity in three carried numbers each.
static_assert(sizeof(World<Cloud>::State) == 6 * 8);
template <class W>
concept HasOrientation = requires(typename W::State state) {
    state.q_wb;
};
static_assert(!HasOrientation<World<Cloud>> && HasOrientation<World<Mixed>>);

template <class S>
class PointMisuse : public testing::Test {
protected:
    PointMisuse() { (void)world_.add(point_mass(1)); }
    World<S> world_{Seconds{1, 256}};
};
template <class S>
using PointMisuseDeathTest = PointMisuse<S>;
TYPED_TEST_SUITE_P(PointMisuseDeathTest);

TYPED_TEST_P(PointMisuseDeathTest, of_a_rotation_of_a_point_mass_ends_the_program) {
    auto& world = this->world_;
    const BodyId id{0};
    EXPECT_DEATH(world.apply_impulse(id, {1, 0, 0}, {0, 0.5, 0}), "");
    world.apply_impulse(id, {1, 0, 0}, {});
    const auto apply = [&](const EventSpec& event) { world.apply(world.prepare(event)); };
    for (const EventKind kind : {EventKind::impulse, EventKind::begin_force}) {
        apply({.kind = kind, .value = {1, 0, 0}});
        EXPECT_DEATH(apply({.kind = kind, .value = {1, 0, 0}, .point = {0, 1, 0}}), "");
        EXPECT_DEATH(apply({.kind = kind, .frame = Frame::body, .value = {1, 0, 0}}), "");
    }
    EXPECT_DEATH(apply({.kind = EventKind::angular_impulse, .value = {0, 0, 1}}), "");
    EXPECT_DEATH(apply({.kind = EventKind::begin_torque, .value = {0, 0, 1}}), "");
    EXPECT_DEATH((void)world.add(SpringSpec{.point = {1, 0, 0}, .stiffness = 1}), "");
    BodySpec turned = point_mass(1);
    turned.orientation = {1, {0, 0, 1}};
    EXPECT_DEATH((void)world.add(turned), "");
    BodySpec spinning = placed(point_mass(1), {}, {}, {0, 0, 1});
    EXPECT_DEATH((void)world.add(spinning), "");
    EXPECT_TRUE(world.add(SpringSpec{.to = {1, 0, 0}, .stiffness = 1}));
    EXPECT_TRUE(world.add(point_mass(1)));
    EXPECT_DEATH((void)world.add(SpringSpec{.to_body = 1, .to = {1, 0, 0}, .stiffness = 1}), "");
    EXPECT_TRUE(world.add(SpringSpec{.to_body = 1, .stiffness = 1}));
}
REGISTER_TYPED_TEST_SUITE_P(PointMisuseDeathTest, of_a_rotation_of_a_point_mass_ends_the_program);
using WorldsOfPoints = testing::Types<Cloud, Mixed>;
INSTANTIATE_TYPED_TEST_SUITE_P(worlds, PointMisuseDeathTest, WorldsOfPoints);

TEST(PointsDeathTest, only_worlds_with_point_masses_take_them_and_only_those_with_rotation_take_others) {
    BodySpec rod = point_mass(1);
    rod.inertia = {1, 1, 0, 0, 0, 0};
    World<Cloud> cloud{Seconds{1, 256}};
    World<Mixed> mixed{Seconds{1, 256}};
    World<Scene> bodies{Seconds{1, 256}};
    EXPECT_DEATH((void)cloud.add(sphere(1, 1)), "");
    EXPECT_DEATH((void)cloud.add(rod), "");
    EXPECT_DEATH((void)mixed.add(rod), "");
    EXPECT_DEATH((void)bodies.add(point_mass(1)), "");
    EXPECT_TRUE(cloud.add(point_mass(1)));
    EXPECT_TRUE(mixed.add(sphere(1, 1)));
    EXPECT_TRUE(bodies.add(sphere(1, 1)));
}

TEST(PointWorlds, a_world_of_point_masses_has_the_hash_of_a_mixed_world) {
    World<Cloud> cloud{Seconds{1, 256}};
    World<Mixed> mixed{Seconds{1, 256}};
    (void)cloud.add(point_mass(1));
    (void)mixed.add(point_mass(1));
    EXPECT_EQ(cloud.hash(), mixed.hash());
    cloud.apply_impulse(BodyId{0}, {1, 2, 3});
    EXPECT_NE(cloud.hash(), mixed.hash());
    mixed.apply_impulse(BodyId{0}, {1, 2, 3});
    EXPECT_EQ(cloud.hash(), mixed.hash());
}

}  // namespace
}  // namespace tumble::test
