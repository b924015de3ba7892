// Loads that a program brings along: closed forms of motion under them, and the kernel's own loads beside the same
// written by a program.
#include <tumble/tumble.hpp>

#include "snapshots.hpp"
#include "worlds.hpp"

#include <cmath>

namespace tumble::test {
namespace {

// A spring to the origin of the world, without rest length.
struct Tether {
    Real stiffness = 0;  // N/m

    [[nodiscard]] bool acts_on(const auto&, int) const { return !stiffness.is_zero(); }
    template <class Group>
    void apply_to(const Group& group) const {
        for (int k = 0; k < group.count; ++k)
            group.push(k, group.position(k) * -static_cast<typename Group::Work>(stiffness));
    }
};

// Drag with the square of the speed against air that moves.
struct Wind {
    Real drag = 0;    // kg/m
    RealVec3 wind{};  // m/s

    [[nodiscard]] bool acts_on(const auto&, int) const { return !drag.is_zero(); }
    [[nodiscard]] bool depends_on_velocity() const { return true; }
    template <class Group>
    void apply_to(const Group& group) const {
        using Work = typename Group::Work;
        for (int k = 0; k < group.count; ++k) {
            const Vector3<Work> through = group.velocity(k) - wind.as<Work>();
            group.push(k, through * (-static_cast<Work>(drag) * sqrt(dot(through, through))));
        }
    }
};

// A torque that turns the body's z axis along the world's y axis, as a field turns a compass needle.
struct Field {
    Real moment = 0;  // N m

    [[nodiscard]] bool acts_on(const auto&, int) const { return true; }
    [[nodiscard]] bool turns(const auto& bodies, int b) const { return bodies.rotates(b); }
    template <class Group>
    void apply_to(const Group& group) const {
        using Work = typename Group::Work;
        if constexpr (Group::rotation)
            for (int k = 0; k < group.count; ++k) {
                const Vector3<Work> field = rotate_back(group.orientation(k), Vector3<Work>{Work(0), Work(1), Work(0)});
                group.turn(k, cross(Vector3<Work>{Work(0), Work(0), static_cast<Work>(moment)}, field));
            }
    }
};

// Two bodies that attract each other with a force in proportion to their distance.
struct Bond {
    Real stiffness = 0;  // N/m

    [[nodiscard]] bool acts_on(const auto&, int) const { return true; }
    [[nodiscard]] bool couples(const auto&, int) const { return true; }
    template <class F>
    void for_each_coupled(const auto&, int b, F&& f) const {
        f(1 - b);
    }
    template <class Group>
    void apply_to(const Group& group) const {
        if (group.count < 2) return;
        const auto pull = (group.position(1) - group.position(0)) * static_cast<typename Group::Work>(stiffness);
        group.push(0, pull);
        group.push(1, -pull);
    }
};

template <class W, class List, Features what = Features{}>
struct With : SceneOf<typename W::Numbers, typename W::Integrator, what> {
    using Loads = List;
};

template <class W>
class OwnLoad : public testing::Test {
protected:
    // Of a step of 1/256 s over some seconds; plain float has 24 digits, and its rounding adds up.
    static constexpr double tolerance = sizeof(typename W::Numbers::Work) == 4 ? 2e-4 : 2e-5;
};
using Kinds = testing::Types<Kind<Q32<NearRange>, integrators::Suzuki4>, Kind<F32, integrators::Rk4>>;
TYPED_TEST_SUITE(OwnLoad, Kinds);

template <class World>
double at(const World& world, BodyId id, int axis) {
    return static_cast<double>(world.position(id)[axis]);
}

TYPED_TEST(OwnLoad, a_tether_of_the_program_swings_as_a_sine) {
    World<With<TypeParam, LoadList<Tether>>> world{Seconds{1, 256}};
    BodySpec ball = sphere(2, 0.1);
    ball.position = {1.5, 0, -0.5};
    const BodyId id = world.add(ball);
    world.template change_load<Tether>() = {18};  // 3 rad/s
    for (int i = 0; i < 1024; ++i) world.step();
    EXPECT_NEAR(at(world, id, 0), 1.5 * std::cos(12), this->tolerance);
    EXPECT_NEAR(at(world, id, 2), -0.5 * std::cos(12), this->tolerance);
    EXPECT_TRUE(world.status().ok());
}

TYPED_TEST(OwnLoad, a_tether_beside_a_spring_of_the_kernel_adds_up) {
    static constexpr Features springs{.springs = 1};
    World<With<TypeParam, LoadList<Tether>, springs>> both{Seconds{1, 256}};
    World<With<TypeParam, LoadList<>, springs>> one{Seconds{1, 256}};
    BodySpec ball = sphere(1, 0.1);
    ball.position = {1, 0.25, 0};
    SpringSpec spring;
    spring.stiffness = 6;
    const BodyId id = both.add(ball);
    one.add(ball);
    both.add(spring);
    both.template change_load<Tether>() = {3};
    spring.stiffness = 9;
    one.add(spring);
    for (int i = 0; i < 512; ++i) {
        both.step();
        one.step();
    }
    EXPECT_NEAR(at(both, id, 0), at(one, id, 0), this->tolerance);
    EXPECT_NEAR(at(both, id, 1), at(one, id, 1), this->tolerance);
}

TYPED_TEST(OwnLoad, quadratic_drag_against_the_wind_has_its_closed_form) {
    World<With<TypeParam, LoadList<Wind>>> world{Seconds{1, 256}};
    BodySpec ball = sphere(0.5, 0.1);
    ball.velocity = {9, 0, 1};  // 8 m/s through the air
    const BodyId id = world.add(ball);
    world.template change_load<Wind>() = {0.25, {1, 0, 1}};
    for (int i = 0; i < 512; ++i) world.step();
    // v' = -(c / m) v^2: x = t wind + (m / c) ln(1 + v0 t c / m).
    EXPECT_NEAR(at(world, id, 0), 2 + 2 * std::log(1 + 8 * 2 / 2.0), this->tolerance);
    EXPECT_NEAR(at(world, id, 2), 2, this->tolerance);
    EXPECT_EQ(world.template load<Wind>().drag, Real{0.25});
}

TYPED_TEST(OwnLoad, a_torque_of_the_program_swings_a_body_as_a_pendulum) {
    World<With<TypeParam, LoadList<Field>>> world{Seconds{1, 256}};
    BodySpec needle;
    needle.inertia = {0.02, 0.02, 0.02, 0, 0, 0};
    // The z axis along y, tilted about x by 0.01 rad.
    const double tilt = 0.01, half = (std::acos(-1.0) / 2 - tilt) / 2;
    needle.orientation = {std::cos(half), {-std::sin(half), 0, 0}};
    const BodyId id = world.add(needle);
    world.template change_load<Field>() = {0.32};  // 4 rad/s
    double most = 0;
    for (int i = 0; i < 402; ++i) {  // a period: pi/2 s
        world.step();
        const auto q = world.orientation(id);
        const auto z = rotate(q, decltype(world.position(id)){{}, {}, typename TypeParam::Numbers::Work(1)});
        most = std::max(most, std::abs(static_cast<double>(z.z)));
        const double quarters = i == 100 ? 1 : i == 201 ? 2 : 0;
        if (quarters > 0) {
            EXPECT_NEAR(static_cast<double>(z.z), quarters > 1 ? -tilt : 0, quarters > 1 ? 2e-5 : 2e-4);
        }
    }
    EXPECT_NEAR(most, tilt, 2e-5);
}

TYPED_TEST(OwnLoad, bodies_that_a_load_couples_keep_their_momentum) {
    static constexpr Features two{.bodies = 2};
    World<With<TypeParam, LoadList<Bond>, two>> world{Seconds{1, 256}};
    BodySpec a = sphere(1, 0.1), b = sphere(3, 0.1);
    a.position = {-1.5, 0, 0};
    b.position = {0.5, 0, 0};
    const BodyId left = world.add(a), right = world.add(b);
    world.template change_load<Bond>() = {12};  // 4 rad/s of the relative motion
    for (int i = 0; i < 256; ++i) world.step();
    EXPECT_NEAR(at(world, right, 0) - at(world, left, 0), 2 * std::cos(4), this->tolerance);
    EXPECT_NEAR(at(world, left, 0) + 3 * at(world, right, 0), 0, this->tolerance);
}

// A spring to the origin that acts, couples or turns in the first 8 of every 16 steps.
enum class What { acts, couples, turns };
template <What what>
struct Flicker {
    Real stiffness = 0;  // N/m, or N m/rad

    [[nodiscard]] static bool is_on(const auto& bodies) { return bodies.steps_taken % 16 < 8; }
    [[nodiscard]] bool acts_on(const auto& bodies, int) const { return what != What::acts || is_on(bodies); }
    [[nodiscard]] bool couples(const auto& bodies, int) const { return what == What::couples && !is_on(bodies); }
    void for_each_coupled(const auto&, int, auto&&) const {}
    [[nodiscard]] bool turns(const auto& bodies, int) const { return what == What::turns && is_on(bodies); }
    template <class Group>
    void apply_to(const Group& group) const {
        using Work = typename Group::Work;
        const auto k = static_cast<Work>(stiffness);
        for (int b = 0; b < group.count; ++b) {
            if (what != What::turns) group.push(b, group.position(b) * -k);
            if constexpr (Group::rotation)
                if (turns(group.bodies, group.id[b])) group.turn(b, group.orientation(b).v * (k * Work(-2)));
        }
    }
};

// A kick that was kept before the load paused is not that of the place where it acts again.
template <class W, What what>
void expect_the_motion_without_kept_kicks(double tolerance) {
    using Scene = Kind<typename W::Numbers, integrators::Verlet>;
    World<With<Scene, LoadList<Flicker<what>>>> flicker{Seconds{1, 64}};
    World<With<Scene, LoadList<Flicker<what>>>> anew{Seconds{1, 64}};
    BodySpec ball = sphere(1, 1);
    ball.position = {1, 0, 0};
    ball.velocity = {0, 20, 0};
    ball.angular_velocity = {0, 0, 3};
    const BodyId id = flicker.add(ball), same = anew.add(ball);
    flicker.template change_load<Flicker<what>>().stiffness = 20;
    anew.template change_load<Flicker<what>>().stiffness = 20;
    for (int i = 0; i < 40; ++i) {
        flicker.step();
        anew.set_gravity({});  // drops what is kept
        anew.step();
    }
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(at(flicker, id, i), at(anew, same, i), tolerance);
        EXPECT_NEAR(static_cast<double>(flicker.angular_velocity(id)[i]),
                    static_cast<double>(anew.angular_velocity(same)[i]), tolerance);
    }
}
TYPED_TEST(OwnLoad, a_load_that_acts_in_some_steps_pushes_from_the_place_of_its_step) {
    expect_the_motion_without_kept_kicks<TypeParam, What::acts>(this->tolerance);
}
TYPED_TEST(OwnLoad, a_load_that_couples_in_some_steps_pushes_from_the_place_of_its_step) {
    expect_the_motion_without_kept_kicks<TypeParam, What::couples>(this->tolerance);
}
TYPED_TEST(OwnLoad, a_load_that_turns_in_some_steps_turns_from_the_attitude_of_its_step) {
    expect_the_motion_without_kept_kicks<TypeParam, What::turns>(this->tolerance);
}

TYPED_TEST(OwnLoad, a_snapshot_of_a_world_with_other_loads_is_refused) {
    static constexpr Features snapshots{.snapshots = true};
    World<With<TypeParam, LoadList<Tether>, snapshots>> one{Seconds{1, 256}};
    World<With<TypeParam, LoadList<Tether, Wind>, snapshots>> two{Seconds{1, 256}};
    one.add(sphere(1, 0.1));
    two.add(sphere(1, 0.1));
    const auto bytes = save(one);
    EXPECT_EQ(restore(one, bytes), SnapshotFault::none);
    EXPECT_EQ(restore(two, bytes), SnapshotFault::other_scene);
}

// A tether whose stiffness a snapshot holds.
struct SavedTether : Tether {
    float strength = 0;  // N/m

    [[nodiscard]] bool acts_on(const auto&, int) const { return strength > 0; }
    template <class Group>
    void apply_to(const Group& group) const {
        for (int k = 0; k < group.count; ++k)
            group.push(k, group.position(k) * -static_cast<typename Group::Work>(strength));
    }
    static void each(auto& load, auto& archive) { archive(load.strength); }
};
TYPED_TEST(OwnLoad, a_world_from_a_snapshot_has_the_values_of_loads_and_goes_on_with_the_same_bits) {
    using N = typename TypeParam::Numbers;
    static constexpr Features saved{.air = true, .gravity_gradient = true, .wheels = true, .snapshots = true};
    using Saved = World<With<TypeParam, LoadList<SavedTether>, saved>>;
    const auto start = [] {
        Saved world{Seconds{1, 256}};
        BodySpec crate = box(1, {1, 2, 3});
        crate.velocity = {5, 1, 0};
        crate.angular_velocity = {1, 0.5, 0.25};
        (void)world.add(crate);
        return world;
    };
    Saved one = start(), other = start();
    one.template change_load<SavedTether>().strength = 12;
    auto& air = one.template change_load<Air<N, 1>>();
    air.set_wind({1, 2, 0});
    air.set_drag(BodyId{0}, 0.25, 0.125);
    one.template change_load<Wheels<N, 1>>().set_momentum(BodyId{0}, Vector3<double>{0, 0.5, 1});
    one.template change_load<GravityGradient<N, 1>>().set_orbit(0.5, {1, 0, 2});
    for (int i = 0; i < 64; ++i) one.step();
    ASSERT_EQ(restore(other, save(one)), SnapshotFault::none);
    EXPECT_EQ(other.template load<SavedTether>().strength, 12);
    for (int i = 0; i < 64; ++i) {
        one.step();
        other.step();
    }
    EXPECT_EQ(other.hash(), one.hash());
}

// --- the kernel's loads for a list -----------------------------------------------------------------------------------

TYPED_TEST(OwnLoad, air_drags_each_body_by_its_own_coefficients) {
    using N = typename TypeParam::Numbers;
    static constexpr Features two{.bodies = 2};
    World<With<TypeParam, LoadList<Air<N, 2>>, two>> world{Seconds{1, 256}};
    BodySpec ball = sphere(0.5, 0.1);
    ball.velocity = {9, 0, 1};
    const BodyId blunt = world.add(ball), slow = world.add(ball);
    auto& air = world.template change_load<Air<N, 2>>();
    air.set_wind({1, 0, 1});
    air.set_drag(blunt, 0, 0.25);
    air.set_drag(slow, 0.25, 0);
    for (int i = 0; i < 512; ++i) world.step();
    EXPECT_NEAR(at(world, blunt, 0), 2 + 2 * std::log(1 + 8 * 2 / 2.0), this->tolerance);
    EXPECT_NEAR(at(world, slow, 0), 2 + 8 * 2 * (1 - std::exp(-1.0)), this->tolerance);
    EXPECT_NEAR(at(world, slow, 2), 2, this->tolerance);
}

// Small swings about the stable attitude, in a plane: the frequency is w sqrt(3 (I_x - I_z) / I_y) where the axis of
// the least moment points to the centre, which stands still in these axes.
TYPED_TEST(OwnLoad, a_long_body_swings_about_the_direction_to_the_centre) {
    using N = typename TypeParam::Numbers;
    World<With<TypeParam, LoadList<GravityGradient<N, 1>>>> world{Seconds{1, 64}};
    BodySpec rod;
    rod.mass = 3;
    rod.inertia = {0.4, 0.1, 0.45, 0, 0, 0};  // long along y
    const double tilt = 0.01, rate = 0.5, frequency = rate * std::sqrt(3 * (0.4 - 0.1) / 0.45);
    rod.orientation = {std::cos(tilt / 2), {0, 0, std::sin(tilt / 2)}};  // about z
    const BodyId id = world.add(rod);
    world.template change_load<GravityGradient<N, 1>>().set_orbit(rate, {0, -2, 0});
    for (int i = 0; i < 640; ++i) world.step();
    const auto q = world.orientation(id);
    EXPECT_NEAR(2 * static_cast<double>(q.v.z), tilt * std::cos(frequency * 10), this->tolerance);
    EXPECT_NEAR(static_cast<double>(q.v.x), 0, this->tolerance);
}

// A symmetric body with a wheel along its axis precesses as a spinning top without torque does: its transverse spin
// turns in the body with the rate (h + (I_z - I) w_z) / I.
TYPED_TEST(OwnLoad, a_wheel_makes_the_transverse_spin_precess) {
    using N = typename TypeParam::Numbers;
    World<With<TypeParam, LoadList<Wheels<N, 1>>>> world{Seconds{1, 256}};
    BodySpec body;
    body.inertia = {0.3, 0.3, 0.2, 0, 0, 0};
    body.angular_velocity = {0.2, 0, 0.5};
    const BodyId id = world.add(body);
    world.template change_load<Wheels<N, 1>>().set_momentum(id, Vector3<double>{0, 0, 0.35});
    const auto momentum = [&] {  // world, N m s
        const auto w = world.angular_velocity(id).template as<double>();
        return rotate(world.orientation(id).template as<double>(),
                      Vector3<double>{0.3 * w.x, 0.3 * w.y, 0.2 * w.z + 0.35});
    };
    const auto before = momentum();
    for (int i = 0; i < 768; ++i) world.step();
    const double angle = (0.35 + (0.2 - 0.3) * 0.5) / 0.3 * 3;
    const auto w = world.angular_velocity(id).template as<double>();
    EXPECT_NEAR(w.x, 0.2 * std::cos(angle), this->tolerance);
    EXPECT_NEAR(w.y, 0.2 * std::sin(angle), this->tolerance);
    EXPECT_NEAR(w.z, 0.5, this->tolerance);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(momentum()[i], before[i], this->tolerance);
}

TYPED_TEST(OwnLoad, the_next_body_at_the_place_of_a_removed_one_has_neither_its_drag_nor_its_wheels) {
    using N = typename TypeParam::Numbers;
    static constexpr Features removal{.removal = true};
    World<With<TypeParam, LoadList<Air<N, 1>, Wheels<N, 1>>, removal>> world{Seconds{1, 256}};
    BodySpec ball = sphere(1, 0.1);
    ball.velocity = {5, 0, 0};
    ball.angular_velocity = {1, 0, 0};
    const BodyId before = world.add(ball);
    world.template change_load<Air<N, 1>>().set_drag(before, 1, 1);
    world.template change_load<Wheels<N, 1>>().set_momentum(before, Vector3<double>{0, 0, 0.1});
    world.remove(before);
    const BodyId id = world.add(ball);
    for (int i = 0; i < 64; ++i) world.step();
    EXPECT_NEAR(at(world, id, 0), 5 * 0.25, this->tolerance);
    EXPECT_NEAR(static_cast<double>(world.angular_velocity(id).x), 1, this->tolerance);
}

// A feature brings the same load as the list does.
TYPED_TEST(OwnLoad, air_and_wheels_by_features_have_the_bits_of_those_by_the_list) {
    using N = typename TypeParam::Numbers;
    World<With<TypeParam, LoadList<Air<N, 1>, Wheels<N, 1>>>> listed{Seconds{1, 256}};
    World<With<TypeParam, LoadList<>, Features{.air = true, .wheels = true}>> named{Seconds{1, 256}};
    const auto run = [](auto& world) {
        BodySpec crate = box(1, {1, 2, 3});
        crate.velocity = {5, 1, 0};
        crate.angular_velocity = {1, 0.5, 0.25};
        const BodyId id = world.add(crate);
        world.template change_load<Air<N, 1>>().set_drag(id, 0.25, 0.5);
        world.template change_load<Wheels<N, 1>>().set_momentum(id, Vector3<double>{0, 0.5, 1});
        for (int i = 0; i < 128; ++i) world.step();
        return world.hash();
    };
    const auto hash = run(listed);
    EXPECT_EQ(run(named), hash);
}

// Of drag, whose end of a step has a closed form where no other load depends on the velocity, and of a spring, whose
// kick is kept from step to step.
template <class N, Features more>
std::uint64_t hash_on_a_dragged_spring() {
    static constexpr Features features = more.united_with({.springs = 1, .drag = true});
    World<SceneOf<N, integrators::Verlet, features>> world{Seconds{1, 64}, {.linear_drag = 0.25}};
    BodySpec ball = sphere(1, 0.5);
    ball.position = {1, 0.5, 0};
    ball.angular_velocity = {0, 2, 1};
    SpringSpec spring;
    spring.body = world.add(ball);
    spring.stiffness = 20;
    world.add(spring);
    for (int i = 0; i < 128; ++i) world.step();
    return world.hash();
}
TYPED_TEST(OwnLoad, features_of_loads_that_act_on_nothing_change_no_bit) {
    using N = typename TypeParam::Numbers;
    const auto hash = hash_on_a_dragged_spring<N, Features{}>();
    EXPECT_EQ((hash_on_a_dragged_spring<N, Features{.air = true, .gravity_gradient = true, .wheels = true}>()), hash);
}

// --- softened gravitation --------------------------------------------------------------------------------------------

constexpr double plummer_mass = 64, softening = 0.5;  // G M, m^3/s^2, of a fixed body at the origin; m

// The textbook method of order 4 in double, with the step of the kernel divided by 16.
struct PlummerOracle {
    double x[2], v[2];

    void advance(double h) {
        const PlummerOracle a = rate(), b = moved(a, h / 2).rate(), c = moved(b, h / 2).rate(), d = moved(c, h).rate();
        for (int i = 0; i < 2; ++i) {
            x[i] += h / 6 * (a.x[i] + 2 * b.x[i] + 2 * c.x[i] + d.x[i]);
            v[i] += h / 6 * (a.v[i] + 2 * b.v[i] + 2 * c.v[i] + d.v[i]);
        }
    }
    [[nodiscard]] double energy() const {
        return (v[0] * v[0] + v[1] * v[1]) / 2 -
               plummer_mass / std::sqrt(x[0] * x[0] + x[1] * x[1] + softening * softening);
    }

private:
    [[nodiscard]] PlummerOracle rate() const {
        const double pull = plummer_mass / std::pow(x[0] * x[0] + x[1] * x[1] + softening * softening, 1.5);
        return {{v[0], v[1]}, {-pull * x[0], -pull * x[1]}};
    }
    [[nodiscard]] PlummerOracle moved(const PlummerOracle& rate, double h) const {
        return {{x[0] + h * rate.x[0], x[1] + h * rate.x[1]}, {v[0] + h * rate.v[0], v[1] + h * rate.v[1]}};
    }
};

// 4 s of an orbit that passes the fixed body at less than the softening.
template <class N>
void expect_a_softened_orbit(double tolerance) {
    SCOPED_TRACE(N::name);
    using Orbit = SceneOf<N, integrators::Suzuki4, Features{.bodies = 2, .gravitation = true, .softening = true}>;
    World<Orbit> world{Seconds{1, 512}, {.gravitation = 0.5}};
    world.set_softening(Real{softening});
    BodySpec sun = sphere(128, 0.125), planet = sphere(1, 0.125);
    sun.fixed = true;
    planet.position = {3, 0, 0};
    planet.velocity = {0, 0.75, 0};
    (void)world.add(sun);
    const BodyId id = world.add(planet);
    PlummerOracle oracle{{3, 0}, {0, 0.75}};
    const double start = oracle.energy();
    double nearest = 3;
    for (int step = 0; step < 2048; ++step) {
        EXPECT_TRUE(world.step().ok());
        for (int part = 0; part < 16; ++part) oracle.advance(1.0 / 512 / 16);
        nearest = std::min(nearest, std::hypot(at(world, id, 0), at(world, id, 1)));
    }
    EXPECT_LT(nearest, softening);
    const auto v = world.velocity(id).template as<double>();
    const PlummerOracle end{{at(world, id, 0), at(world, id, 1)}, {v.x, v.y}};
    for (int i = 0; i < 2; ++i) EXPECT_NEAR(end.x[i], oracle.x[i], tolerance);
    EXPECT_NEAR(end.energy() / start, 1, tolerance);
}
TEST(Softening, gives_the_orbit_of_the_oracle_in_every_number_system) {
    // About four times the largest error of a coordinate, m: of the method 4e-9, then of rounding.
    expect_a_softened_orbit<F64>(2e-8);
    expect_a_softened_orbit<F32>(4e-6);
    expect_a_softened_orbit<F32Plain>(1.1e-3);
    expect_a_softened_orbit<Q32<NearRange>>(4e-8);
    expect_a_softened_orbit<Q32<RoomRange>>(4e-8);
}

TEST(Softening, leaves_bodies_at_one_place_without_force_and_without_a_report) {
    using Pair =
        SceneOf<Q32<NearRange>, integrators::Verlet, Features{.bodies = 2, .gravitation = true, .softening = true}>;
    World<Pair> world{Seconds{1, 256}, {.gravitation = 1}};
    world.set_softening(Real{1});
    const BodyId one = world.add(sphere(1, 0.1));
    const BodyId two = world.add(sphere(1, 0.1));
    for (int step = 0; step < 64; ++step) EXPECT_TRUE(world.step().ok());
    EXPECT_EQ(at(world, one, 0), 0);
    EXPECT_EQ(at(world, two, 0), 0);
}

TYPED_TEST(OwnLoad, a_load_that_acts_on_nothing_changes_no_bit) {
    static constexpr Features planes{.planes = 1};
    World<With<TypeParam, LoadList<Tether>, planes>> with{Seconds{1, 256}, {.gravity = {0, -9.81, 0}}};
    World<With<TypeParam, LoadList<>, planes>> without{Seconds{1, 256}, {.gravity = {0, -9.81, 0}}};
    BodySpec ball = sphere(1, 0.1);
    ball.position = {0, 1, 0};
    ball.angular_velocity = {3, 1, 4};
    const auto run = [&](auto& world) {
        world.add(PlaneSpec{});
        world.add(ball);
        for (int i = 0; i < 300; ++i) world.step();
        return world.hash();
    };
    EXPECT_EQ(run(with), run(without));
}

}  // namespace
}  // namespace tumble::test
