// Worlds that the compiler sets up. The oracle is the same world, set up when the program runs.
#include <tumble/tumble.hpp>

#include "kinds.hpp"

#include <algorithm>
#include <array>
#include <memory>

namespace tumble::test {
namespace {

// A scene with the step as a constant.
template <class Scene>
struct Stepped : Scene {
    static constexpr Seconds step{1, 250};
};
template <class N, class Method>
using Free = SceneOf<N, Method, Features{.bodies = 2}>;
using Loaded = SceneOf<Q32<NearRange>, integrators::Verlet, Features{.drag = true}>;
using Landing = SceneOf<Q32<NearRange>, integrators::Verlet, Features{.planes = 1, .boxes = true}>;

constexpr BodySpec thrown() {
    BodySpec body = box(0.3, {0.1, 0.4, 0.9});
    body.inertia.xy = 0.0003;
    body.position = {1, -2, 0.5};
    body.velocity = {0.25, 3, -1};
    body.orientation = {0.5, {0.5, -0.25, 0.75}};
    body.angular_velocity = {0.3, 7, 0.01};
    return body;
}

template <class Scene>
constexpr World<Scene> set_up() {
    constexpr WorldSpec spec{.gravity = {0.1, -9.81, 0}};
    World<Scene> world = [&] {
        if constexpr (World<Scene>::has_step) return World<Scene>{spec};
        else return World<Scene>{Seconds{1, 250}, spec};
    }();
    BodySpec body = thrown();
    world.add(body);
    body.mass = 4;
    body.angular_velocity = {20, 0.5, -9};
    world.add(body);
    return world;
}

template <class W>
class ConstantWorld : public testing::Test {};
using Constant = Tested<testing::Types<Kind<Q32<NearRange>, integrators::Verlet>>,
                        testing::Types<Kind<F64, integrators::Exact>, Kind<Q32<NearRange, false>, integrators::Rk4>,
                                       Kind<Q32<>, integrators::Pdmv6>, Kind<F32, integrators::Suzuki4>>>;
TYPED_TEST_SUITE(ConstantWorld, Constant);

template <class Scene>
constinit World<Scene> constant_world = set_up<Scene>();

template <class W>
std::uint64_t hash_after(W& world, int steps) {
    for (int i = 0; i < steps; ++i) world.step();
    EXPECT_TRUE(world.status().ok());
    return world.hash();
}

// Of worlds or replays: their statuses and hashes after each step.
void expect_the_same_steps(auto& one, auto& other, int steps) {
    const auto hash = [](const auto& stepped) {
        if constexpr (requires { stepped.world(); }) return stepped.world().hash();
        else return stepped.hash();
    };
    for (int i = 0; i < steps; ++i) {
        ASSERT_EQ(one.step().bits, other.step().bits) << i;
        ASSERT_EQ(hash(one), hash(other)) << i;
    }
}

TYPED_TEST(ConstantWorld, a_world_that_the_compiler_set_up_has_the_bits_of_one_set_up_at_run_time) {
    using Scene = Free<typename TypeParam::Numbers, typename TypeParam::Integrator>;
    auto world = set_up<Scene>();
    EXPECT_EQ(world.hash(), constant_world<Scene>.hash());
    EXPECT_EQ(hash_after(world, 500), hash_after(constant_world<Scene>, 500));
}

TYPED_TEST(ConstantWorld, a_step_of_the_scene_gives_the_bits_of_a_step_of_the_world) {
    using Scene = Free<typename TypeParam::Numbers, typename TypeParam::Integrator>;
    auto world = set_up<Scene>();
    EXPECT_EQ(hash_after(world, 500), hash_after(constant_world<Stepped<Scene>>, 500));
    EXPECT_LT(sizeof(constant_world<Stepped<Scene>>), sizeof(world));
}

// Where the program needs no parts of a rotation, its code has none: the spin of the range turns by 1/4 rad at most.
TEST(ConstantWorld, parts_of_a_rotation_are_compiled_only_where_the_step_of_the_scene_may_need_them) {
    using Slow = Stepped<Free<Q32<Range<64, 32, 16>>, integrators::Verlet>>;  // 16 rad/s, 1/250 s
    using Fast = Stepped<Free<Q32<>, integrators::Verlet>>;                   // 64 rad/s, 1/250 s
    EXPECT_FALSE(World<Slow>::Bodies::has_parts);
    EXPECT_TRUE(World<Fast>::Bodies::has_parts);
}

// A spin far beyond the declared range, which the method cannot follow.
template <class Method>
void expect_the_report_of_a_fast_spin() {
    using Scene = SceneOf<Q32<Range<64, 32, 16>>, Method, Features{}>;
    BodySpec body;
    body.inertia = {1, 0.640833, 0.359467, 0, 0, 0};
    bool is_reported = false;
    for (const RealVec3& spin : {RealVec3{0, -60, 50}, RealVec3{23, -57, -46}, RealVec3{-32, 0.5, 90}}) {
        body.angular_velocity = spin;
        World<Scene> world{Seconds{1, 250}};
        World<Stepped<Scene>> stepped{WorldSpec{}};
        world.add(body);
        stepped.add(body);
        expect_the_same_steps(stepped, world, 100);
        is_reported = is_reported || !stepped.status().ok();
    }
    EXPECT_TRUE(is_reported);
}
TEST(ConstantWorld, a_spin_that_the_method_cannot_follow_is_reported_where_no_parts_are_compiled) {
    expect_the_report_of_a_fast_spin<integrators::Verlet>();
    expect_the_report_of_a_fast_spin<integrators::Pdmv6>();
    expect_the_report_of_a_fast_spin<integrators::Strang>();
}

template <Features what>
constinit World<SceneOf<Q32<>, integrators::Verlet, what>> with_feature = [] {
    World<SceneOf<Q32<>, integrators::Verlet, what>> world{Seconds{1, 250}, {.gravity = {0, -9.81, 0}}};
    if constexpr (what.rotation) world.add(thrown());
    if constexpr (what.point_masses) world.add(point_mass(0.2));
    return world;
}();
TEST(ConstantWorld, the_compiler_sets_up_a_world_of_free_bodies_with_every_feature_but_loads) {
    EXPECT_EQ(with_feature<(Features{.control = true})>.body_count(), 1);
    EXPECT_EQ(with_feature<(Features{.bodies = 2, .point_masses = true, .removal = true})>.body_count(), 2);
    EXPECT_EQ(with_feature<(Features{.rotation = false, .point_masses = true})>.body_count(), 1);
    EXPECT_EQ(with_feature<(Features{.impulses = true, .script = true, .recording = true})>.body_count(), 1);
    auto& saved = with_feature<(Features{.snapshots = true, .imu = true})>;
    auto world = std::remove_reference_t<decltype(saved)>{Seconds{1, 250}, {.gravity = {0, -9.81, 0}}};
    world.add(thrown());
    std::uint8_t bytes[1024];
    EXPECT_EQ(world.restore(bytes, saved.save(bytes, sizeof bytes)), SnapshotFault::none);
    EXPECT_EQ(world.hash(), saved.hash());
}

template <Features what>
constexpr WorldSpec falls{.gravity = {0.1, -9.81, 0},
                          .contact = {.restitution = 0.3,
                                      .friction = what.friction ? Real{0.5} : Real{},
                                      .rolling_resistance = what.rolling_resistance ? Real{0.001} : Real{},
                                      .friction_mixing = what.mixing ? Mixing::smaller : Mixing::geometric_mean,
                                      .sleep = {.on = what.sleep},
                                      .most_impacts = what.impact_bounds ? 5 : 0}};
// Bodies above two planes, as far as there is room.
template <class N, Features what>
constexpr World<SceneOf<N, integrators::Verlet, what>> set_up_contacts() {
    World<SceneOf<N, integrators::Verlet, what>> world{Seconds{1, 250}, falls<what>};
    (void)world.add(PlaneSpec{});
    BodySpec body = thrown();
    body.position.y = 1;
    body.shape = {ShapeKind::box, {0.1, 0.4, 0.9}};
    (void)world.add(body);
    if constexpr (what.bodies > 2) {
        body = sphere(0.5, 0.3);
        body.position = {1, 3, 0.5};
        (void)world.add(body);
        body = cylinder(0.5, 0.1, 0.3);
        body.position = {-1, 3, 0.5};
        (void)world.add(body);
        body = box(1, {3, 0.1, 3});
        body.kinematic = true;
        body.velocity = {0.1, 0, 0};
        (void)world.add(body);
        body.kinematic = false;
        body.fixed = true;
        body.position.z = 4;
        body.angular_velocity = {0, 1, 0};
        (void)world.add(body);
    }
    if constexpr (what.planes > 1) (void)world.add(PlaneSpec{.normal = {-1, 0.3, 0.05}, .offset = 3, .friction = 0.9});
    return world;
}
template <class N, Features what>
constinit auto constant_contacts = set_up_contacts<N, what>();
template <class N, Features what>
void expect_the_bits_of_run_time(int steps) {
    auto world = set_up_contacts<N, what>();
    EXPECT_EQ(world.hash(), (constant_contacts<N, what>.hash()));
    EXPECT_EQ(hash_after(world, steps), hash_after(constant_contacts<N, what>, steps));
}

template <class N>
class ConstantWorldIn : public testing::Test {};
using ConstantSystems = Tested<testing::Types<Q32<NearRange>>, testing::Types<F32, Q32<NearRange, false>, F64>>;
TYPED_TEST_SUITE(ConstantWorldIn, ConstantSystems);

TYPED_TEST(ConstantWorldIn, a_box_on_planes_that_the_compiler_set_up_has_the_bits_of_one_set_up_at_run_time) {
    constexpr Features what{.planes = 2, .boxes = true, .friction = true, .sleep = true};
    expect_the_bits_of_run_time<TypeParam, what>(1000);
}
// Other tests compare the steps of such worlds.
TEST(ConstantWorld, the_compiler_sets_up_a_world_with_every_feature_of_contacts) {
    constexpr Features what{.bodies = 5,
                            .planes = 2,
                            .script = true,
                            .recording = true,
                            .removal = true,
                            .snapshots = true,
                            .imu = true,
                            .pairs = true,
                            .boxes = true,
                            .round_shapes = true,
                            .friction = true,
                            .rolling_resistance = true,
                            .mixing = true,
                            .sleep = true,
                            .turntables = true,
                            .kinematic = true,
                            .contact_readout = true,
                            .impact_bounds = true};
    constexpr Features many{.bodies = 70,
                            .planes = 2,
                            .pairs = true,
                            .boxes = true,
                            .round_shapes = true,
                            .friction = true,
                            .turntables = true,
                            .kinematic = true};
    const auto run_time = set_up_contacts<F32, what>();
    std::uint8_t bytes[8192], constant_bytes[8192];
    const int size = run_time.save(bytes, sizeof bytes);
    ASSERT_GT(size, 0);
    EXPECT_EQ((constant_contacts<F32, what>.save(constant_bytes, sizeof constant_bytes)), size);
    EXPECT_TRUE(std::equal(bytes, bytes + size, constant_bytes));
    EXPECT_EQ((constant_contacts<Q32<>, many>.body_count()), 5);
}

// A tree of all kinds of joints, with all that they may have.
template <class N>
constexpr auto set_up_joints() {
    constexpr Features what{.bodies = 7,
                            .joints = 6,
                            .distances = true,
                            .joint_springs = true,
                            .joint_limits = true,
                            .joint_breaks = true,
                            .removal = true,
                            .snapshots = true};
    World<SceneOf<N, integrators::Verlet, what>> world{Seconds{1, 250}, {.gravity = {0, -9.81, 0}}};
    BodyId id[6];
    for (int i = 0; i < 6; ++i) {
        BodySpec body = thrown();
        body.mass = 0.3 + i;
        body.position = {0.3 * i, -i, 0.1};
        body.orientation = rotation_about({1, 2, 3}, 0.2 * i);
        body.fixed = i == 4;
        if (body.fixed) body.velocity = body.angular_velocity = {};
        id[i] = world.add(body);
    }
    const JointSpring spring{.stiffness = 0.5, .damping = 0.01};
    const JointLimits limits{.least = -0.5, .most = 1};
    (void)world.add(HingeSpec{.body = id[0], .anchor = {0.1, 0.2, 0.3}, .axis = {1, 0, 2}, .limits = limits});
    (void)world.add(BallSpec{.body = id[1], .to_body = id[0], .anchor = {0, -1, 0}, .spring = spring});
    (void)world.add(FixedSpec{.body = id[2], .to_body = id[1], .anchor = {0, -2, 0}, .break_force = 50});
    (void)world.add(SliderSpec{.body = id[3], .to_body = id[4], .axis = {0, 1, 0}, .spring = spring, .limits = limits});
    (void)world.add(
        DistanceSpec{.body = id[5], .to_body = id[3], .point = {1, -5, 0}, .to_point = {1, -3, 0}, .most = 3});
    BodySpec last = thrown();
    last.position = {3, 0, 0};
    const BodyId shaft = world.add(last);
    (void)world.add(UniversalSpec{.body = shaft, .anchor = {3, 0.5, 0}, .to_spring = spring});
    return world;
}
template <class N>
constinit auto constant_joints = set_up_joints<N>();
TYPED_TEST(ConstantWorldIn, joints_that_the_compiler_set_up_have_the_bits_of_some_set_up_at_run_time) {
    auto world = set_up_joints<TypeParam>();
    auto& constant = constant_joints<TypeParam>;
    ASSERT_EQ(world.joint_count(), 6);
    std::uint8_t bytes[4096], constant_bytes[4096];
    for (int i = 0; i < 500; ++i) {
        ASSERT_EQ(world.step().bits, constant.step().bits);
        ASSERT_EQ(world.hash(), constant.hash());
        const int size = world.save(bytes, sizeof bytes);
        ASSERT_GT(size, 0);
        ASSERT_EQ(constant.save(constant_bytes, sizeof constant_bytes), size);
        ASSERT_TRUE(std::equal(bytes, bytes + size, constant_bytes));
    }
    EXPECT_TRUE(world.template joint<float>(JointId{2}).broken);
    EXPECT_FALSE(world.status().has(Issue::joint_open));
}

// A scene of `tumble compile`, with an impulse and events.
struct Scripted {
    static constexpr const char* name = "scripted";
    static constexpr Seconds step{1, 250};
    static constexpr std::uint32_t steps = 500;
    static constexpr WorldSpec world = falls<Features{.friction = true}>;
    static constexpr std::array<BodySpec, 1> bodies{thrown()};
    static constexpr std::array<PlaneSpec, 1> planes{PlaneSpec{.offset = 3}};
    static constexpr std::array<SpringSpec, 0> springs{};
    static constexpr std::array<EventSpec, 4> events{
        {{.time = 0.5, .body = 0, .value = {0, 0.1, 0}, .point = {0.1, 0, 0}},
         {.time = 0.1, .body = 0, .frame = Frame::body, .value = {0, 0.1, 0.2}, .point = {0.1, 0, 0}},
         {.time = 1, .kind = EventKind::pose, .body = 0, .value = {0, 1, 0}, .orientation = {0.5, {0, 0.5, 1}}},
         {.time = 0.9, .kind = EventKind::velocity, .body = 0, .frame = Frame::body, .value = {0, 3, 0}}}};
    struct Config : Scene {
        using Numbers = Q32<NearRange>;
        static constexpr Features features{
            .planes = 1, .impulses = true, .script = true, .boxes = true, .friction = true};
    };
};
constinit Replay<Scripted::Config, Scripted> constant_replay;
TEST(ConstantWorld, the_compiler_sets_up_the_impulses_and_events_of_a_scene) {
    const auto replay = std::make_unique<Replay<Scripted::Config, Scripted>>();
    EXPECT_EQ(replay->world().hash(), constant_replay.world().hash());
    expect_the_same_steps(*replay, constant_replay, Scripted::steps);
    EXPECT_TRUE(replay->world().status().ok());
}

// A load of the program's own, which lifts a body by what it keeps of its mass.
template <class N>
struct Lift {
    using Work = typename N::Work;
    Work per_body[2]{};  // N

    constexpr void set_body(int b, const BodySpec& spec, const auto&, const auto&) {
        per_body[b] = static_cast<Work>(spec.is_fixed() ? Real{} : spec.mass * Real{0.25});
    }
    [[nodiscard]] bool acts_on(const auto&, int b) const { return per_body[b] > Work(0); }
    void apply_to(const auto& group) const {
        for (int k = 0; k < group.count; ++k) group.push(k, Vector3<Work>{Work(0), per_body[group.id[k]], Work(0)});
    }
};

// A scene of `tumble compile` with every load but contacts by springs, above a plane. `without`: the number of a load
// that it lacks.
template <class N>
struct AllLoads {
    static constexpr const char* name = "all loads";
    static constexpr int count = 9;
    static constexpr Seconds step{1, 250};
    static constexpr std::uint32_t steps = 300;
    WorldSpec world{.gravity = {0.1, -1, 0}, .gravitation = 0.2, .linear_drag = 0.05, .angular_drag = 0.0004};
    std::array<BodySpec, 2> bodies{thrown(), thrown()};
    std::array<PlaneSpec, 1> planes{PlaneSpec{.offset = 9}};
    std::array<SpringSpec, 3> springs{{
        {.body = 0, .point = {0.02, 0.1, 0}, .to_body = 1, .to = {0, 0.1, 0.3}, .stiffness = 4, .rest_length = 0.5},
        {.body = 1, .point = {0, 0.1, 0.2}, .to = {1, 3, 0}, .stiffness = 2, .damping = 0.1, .rest_length = 0.25},
        {.body = 1, .to = {0, 0, 0.5}, .stiffness = 1},
    }};
    std::array<EventSpec, 7> events{
        {{.time = 0.1, .body = 0, .frame = Frame::body, .value = {0, 0.1, 0.2}, .point = {0.1, 0, 0}},
         {.time = 0.2, .kind = EventKind::begin_force, .body = 1, .frame = Frame::body, .value = {0.3, 0, 1}},
         {.time = 0.7, .kind = EventKind::end_force, .body = 1, .frame = Frame::body, .value = {0.3, 0, 1}},
         {.time = 0, .kind = EventKind::begin_force, .body = 0, .value = {0.5, 0, 0.1}, .point = {0, 0.1, 0}},
         {.time = 0, .kind = EventKind::begin_torque, .body = 0, .value = {0.01, 0, 0}},
         {.time = 0.3, .kind = EventKind::torque, .body = 0, .frame = Frame::body, .value = {0, 0.01, 0}},
         {.time = 0.2, .kind = EventKind::force, .body = 1, .frame = Frame::body, .value = {0, 0.3, 0}}}};
    RealVec3 wind{0.5, 0, -1};
    std::array<DragSpec, 1> drags{{{.body = 0, .linear = 0.01, .quadratic = 0.02}}};
    std::array<WheelsSpec, 1> wheels{{{.body = 1, .momentum = {0.1, 0, -0.2}}}};
    OrbitSpec orbit{.rate = 3, .to_centre = {0.3, -1, 0.2}};
    Real softening = 0.125;

    constexpr explicit AllLoads(int without = -1) {
        bodies[1].position = {0, 1, 1.5};
        if (without == 0) world.linear_drag = world.angular_drag = 0;
        if (without == 1)
            for (SpringSpec& spring : springs) spring.stiffness = spring.damping = 0;
        if (without == 2) world.gravitation = 0;
        if (without == 3) softening = 0;
        if (without == 4) drags[0].linear = drags[0].quadratic = 0;
        if (without == 5) wheels[0].momentum = {};
        if (without == 6) orbit.rate = 0;
        if (without == 7)
            for (EventSpec& event : events)
                if (is_timed(event.kind)) event.value = {};
        if (without == 8)
            for (EventSpec& event : events)
                if (!is_timed(event.kind)) event.value = {};
    }
    struct Config : Scene {
        using Numbers = N;
        using Loads = LoadList<Lift<N>>;
        static constexpr Features features{.bodies = 2,
                                           .planes = 1,
                                           .springs = 3,
                                           .drag = true,
                                           .gravitation = true,
                                           .softening = true,
                                           .air = true,
                                           .gravity_gradient = true,
                                           .wheels = true,
                                           .forces = true,
                                           .impulses = true,
                                           .control = true,
                                           .script = true,
                                           .boxes = true};
    };
};
template <class N>
constinit Replay<typename AllLoads<N>::Config, AllLoads<N>> constant_loads;
// A world with the loads that the compiler sets up in floating point too.
template <class N>
struct LoadsWithoutBlocks
    : SceneOf<N, integrators::Verlet,
              Features{
                  .bodies = 2, .drag = true, .gravitation = true, .softening = true, .air = true, .wheels = true}> {
    using Loads = LoadList<Lift<N>>;
};
// `without`: the number of a load that the world lacks.
template <class N>
constexpr auto set_up_loads_without_blocks(int without = -1) {
    World<LoadsWithoutBlocks<N>> world{Seconds{1, 250},
                                       {.gravity = {0.1, -1, 0},
                                        .gravitation = without == 0 ? 0 : 0.2,
                                        .linear_drag = without == 1 ? 0 : 0.05,
                                        .angular_drag = without == 2 ? 0 : 0.0004}};
    BodySpec body = thrown();
    (void)world.add(body);
    body.position = {0, 1, 1.5};
    (void)world.add(body);
    if (without != 3) world.set_softening(0.125);
    Air<N, 2>& air = world.template change_load<Air<N, 2>>();
    air.set_wind({0.5, 0, -1});
    if (without != 4) air.set_drag(0, 0.01, 0.02);
    if (without != 5) world.template change_load<Wheels<N, 2>>().set_momentum(1, RealVec3{0.1, 0, -0.2});
    if (without == 6) world.template change_load<Lift<N>>() = {};
    return world;
}
template <class N>
constinit auto constant_loads_without_blocks = set_up_loads_without_blocks<N>();

// Two boxes that lie on a plane and on each other by springs, with a barrier.
template <class N>
constexpr auto set_up_springs_that_touch() {
    constexpr Features what{.bodies = 2,
                            .planes = 1,
                            .point_masses = true,
                            .pairs = true,
                            .boxes = true,
                            .contact_impulses = false,
                            .contact_springs = true};
    using enum ContactResponse;
    World<SceneOf<N, integrators::Verlet, what>> world{
        Seconds{1, 500},
        {.gravity = {0, -9.81, 0}, .contact = {.response = spring, .stiffness = 200, .damping = 0.5, .barrier = 1e-4}}};
    BodySpec body = box(0.3, {0.4, 0.3, 0.5});
    body.inertia.xy = 0.0003;
    body.position = {0, 0.25, 0};
    (void)world.add(body);
    (void)world.add(PlaneSpec{.normal = {0.1, 1, 0}});
    body = sphere(0.2, 0.25);
    body.position = {0.05, 0.75, 0.1};
    (void)world.add(body);
    return world;
}
template <class N>
constinit auto constant_springs_that_touch = set_up_springs_that_touch<N>();

// Springs, orbits, forces and events keep blocks, which the compiler sets up in fixed point only.
template <class N>
class ConstantBlocks : public testing::Test {};
using SystemsWithBlocks = Tested<testing::Types<Q32<NearRange>>, testing::Types<Q32<NearRange, false>>>;
TYPED_TEST_SUITE(ConstantBlocks, SystemsWithBlocks);

TYPED_TEST(ConstantBlocks, every_load_that_the_compiler_set_up_has_the_bits_of_one_set_up_at_run_time) {
    using Loads = AllLoads<TypeParam>;
    using AtRunTime = Replay<typename Loads::Config, Loads>;
    const auto replay = std::make_unique<AtRunTime>(Loads{});
    expect_the_same_steps(*replay, constant_loads<TypeParam>, Loads::steps);
    EXPECT_TRUE(replay->world().status().ok());
    for (int without = 0; without < Loads::count; ++without) {
        const auto other = std::make_unique<AtRunTime>(Loads{without});
        for (std::uint32_t i = 0; i < Loads::steps; ++i) other->step();
        EXPECT_NE(other->world().hash(), replay->world().hash()) << without;
    }
}
TYPED_TEST(ConstantWorldIn, drag_and_gravitation_that_the_compiler_set_up_have_the_bits_of_some_set_up_at_run_time) {
    auto world = set_up_loads_without_blocks<TypeParam>();
    auto& constant = constant_loads_without_blocks<TypeParam>;
    expect_the_same_steps(world, constant, 300);
    EXPECT_TRUE(world.status().ok());
    for (int without = 0; without < 7; ++without) {
        auto other = set_up_loads_without_blocks<TypeParam>(without);
        EXPECT_NE(hash_after(other, 300), world.hash()) << without;
    }
}
TYPED_TEST(ConstantWorldIn, contacts_by_springs_that_the_compiler_set_up_have_the_bits_of_some_set_up_at_run_time) {
    auto world = set_up_springs_that_touch<TypeParam>();
    auto& constant = constant_springs_that_touch<TypeParam>;
    EXPECT_EQ(world.largest_safe_step(), constant.largest_safe_step());
    expect_the_same_steps(world, constant, 500);
    EXPECT_EQ(world.largest_safe_step(), constant.largest_safe_step());
}
// The step is 26 times too long for the spring: both worlds say so.
TYPED_TEST(ConstantBlocks, the_compiler_reports_a_step_that_is_too_long_for_a_spring) {
    static constexpr auto set_up = [] {
        World<SceneOf<TypeParam, integrators::Verlet, Features{.springs = 1}>> world{Seconds{1, 250}};
        world.add(thrown());
        world.add(SpringSpec{.body = 0, .point = {0.05, 0.2, 0}, .to = {1, -2, 1}, .stiffness = 1e7});
        return world;
    };
    static constinit auto constant = set_up();
    EXPECT_EQ(constant.status().bits, set_up().status().bits);
    EXPECT_TRUE(constant.status().has(Issue::step_too_long));
}

// Loads and contacts take the step of the scene too, as a number of the world.
TEST(ConstantWorld, a_scene_with_loads_or_contacts_may_name_its_step) {
    const auto run = [](auto world, auto same) {
        BodySpec body = thrown();
        body.position.y = 1;
        world.add(body);
        same.add(body);
        if constexpr (decltype(world)::features.planes > 0) {
            world.add(PlaneSpec{});
            same.add(PlaneSpec{});
        }
        EXPECT_EQ(hash_after(world, 300), hash_after(same, 300));
    };
    constexpr WorldSpec falls{.gravity = {0, -9.81, 0}}, drags{.gravity = {0, -9.81, 0}, .linear_drag = 0.1};
    run(World<Stepped<Loaded>>{drags}, World<Loaded>{{1, 250}, drags});
    run(World<Stepped<Landing>>{falls}, World<Landing>{{1, 250}, falls});
}

}  // namespace
}  // namespace tumble::test
