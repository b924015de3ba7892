// The list of features, the requirements on a scene type, and misuse that ends in TUMBLE_ASSERT.
#include <tumble/tumble.hpp>

#include "members.hpp"
#include "references.hpp"

#include <set>
#include <string>

namespace tumble::test {
namespace {

TEST(Features, the_list_names_every_member_once) {
    std::set<std::string> names;
    std::size_t count = 0;
    Features::for_each([&](const char* name, auto) {
        names.insert(name);
        ++count;
    });
    EXPECT_EQ(count, count_of_members<Features>());
    EXPECT_EQ(names.size(), count);
}

TEST(Features, each_member_is_visited_on_its_own) {
    Features::for_each([]<class T>(const char* name, T Features::*member) {
        Features one;
        one.*member = static_cast<T>(!static_cast<bool>(one.*member));
        EXPECT_FALSE(one == Features{}) << name;
        int differ = 0;
        Features::for_each([&](const char*, auto other) { differ += one.*other != Features{}.*other ? 1 : 0; });
        EXPECT_EQ(differ, 1) << name;
    });
}

TEST(Features, a_union_has_room_for_both) {
    constexpr Features a{.bodies = 2, .planes = 3, .drag = true, .contact_impulses = false},
        b{.bodies = 5, .planes = 1, .sleep = true};
    constexpr Features both{.bodies = 5, .planes = 3, .drag = true, .sleep = true};
    EXPECT_TRUE(a.united_with(b) == both);
    EXPECT_TRUE(b.united_with(a) == both);
}

TEST(Features, united_scenes_have_room_for_the_pairs_of_each) {
    constexpr Features usual{.bodies = 9, .planes = 1, .pairs = true}, few{.bodies = 3, .near_pairs = 2, .pairs = true};
    for (const Features& both : {usual.united_with(few), few.united_with(usual)})
        EXPECT_EQ(both.room_for_pairs(), usual.room_for_pairs());
    EXPECT_EQ(few.united_with(few).near_pairs, 2);
}

// Half of six spheres about each, and half a pair more for each plane at which it may be; at most every pair.
TEST(Features, the_usual_room_is_that_of_a_heap_of_spheres_in_a_corner) {
    EXPECT_EQ((Features{.bodies = 13, .planes = 5, .pairs = true}.room_for_pairs()), 58);
    EXPECT_EQ((Features{.bodies = 64, .planes = 1, .pairs = true}.room_for_pairs()), 224);
    EXPECT_EQ((Features{.bodies = 40, .pairs = true}.room_for_pairs()), 120);
    EXPECT_EQ((Features{.bodies = 3, .planes = 2, .pairs = true}.room_for_pairs()), 9);
    EXPECT_EQ((Features{.bodies = 13, .planes = 5}.room_for_pairs()), 65);
    EXPECT_EQ((Features{.bodies = 13, .planes = 5, .near_pairs = 20, .pairs = true}.room_for_pairs()), 20);
    EXPECT_EQ((Features{.bodies = 10000, .planes = 1, .pairs = true}.room_for_pairs()), 32767) << "the most of a world";
}

TEST(Features, a_scene_with_every_feature_keeps_its_room) {
    constexpr Features all = Features{.bodies = 7, .near_pairs = 9, .contact_impulses = false}.with_everything();
    Features::for_each([&]<class T>(const char* name, T Features::*member) {
        const bool is_on = !std::is_same_v<T, bool> || all.*member;
        EXPECT_TRUE(is_on) << name;
    });
    EXPECT_EQ(all.bodies, 7);
    EXPECT_EQ(all.near_pairs, 9);
    EXPECT_EQ(all.planes, 0);
}

// A scene without bodies, with any other features.
struct Bodiless : Scene {
    static constexpr Features features{
        .bodies = 0, .planes = 1, .drag = true, .forces = true, .impulses = true, .pairs = true, .sleep = true};
};

TEST(Features, a_world_without_room_for_bodies_only_counts_its_steps) {
    World<Bodiless> world{Seconds{1, 256}};
    const std::uint64_t hash = world.hash();
    for (int step = 0; step < 10; ++step) EXPECT_TRUE(world.step().ok());
    EXPECT_EQ(world.steps_taken(), 10u);
    EXPECT_EQ(world.body_count(), 0);
    EXPECT_EQ(world.hash(), hash);
    const World<Scene> without_one{Seconds{1, 256}};
    EXPECT_EQ(world.hash(), without_one.hash());
    EXPECT_LE(sizeof(World<Bodiless>) + sizeof(World<Scene>::State), sizeof(World<Scene>));
    EXPECT_FALSE(World<Bodiless>::has_contacts);
    EXPECT_FALSE(World<Bodiless>::has_loads);
}

// A method without a step.
struct Stepless {
    static constexpr const char* name = "stepless";
    static constexpr int order = 1;
    static constexpr Spin spin = Spin::angular_momentum;
    static constexpr Coasting coasting = Coasting::end;
    template <class N>
    using Inertia = integrators::Verlet::Inertia<N>;
};
// The missing step, which does not return whether it converged.
struct Mute : Stepless {
    template <class N>
    static void rotate(BodyState<N, spin>&, const Inertia<N>&, const StepInfo<N>&);
    template <class N, int capacity, class Evaluate>
    static void advance(const Group<N, spin, Inertia<N>, capacity>&, const Evaluate&, const StepInfo<N>&);
};
struct Complete : Mute {
    template <class N, int capacity, class Evaluate>
    static bool advance(const Group<N, spin, Inertia<N>, capacity>&, const Evaluate&, const StepInfo<N>&);
};
static_assert(!tumble::Method<int, Q32<>> && !tumble::Method<Stepless, Q32<>> && !tumble::Method<Mute, Q32<>> &&
              tumble::Method<Complete, Q32<>> && tumble::Method<Complete, F64>);

TEST(Method, every_listed_integrator_satisfies_the_concept) {
    int count = 0;
    const auto check = [&]<class N>() {
        Integrators::for_each_in<N>([&]<class M>() {
            EXPECT_TRUE((tumble::Method<M, N>)) << M::name;
            ++count;
        });
    };
    check.operator()<Q32<>>();
    check.operator()<F32>();
    check.operator()<F64>();
    EXPECT_GT(count, 3);
}

struct Pair : Scene {
    static constexpr Features features{.bodies = 2, .springs = 4, .forces = true, .impulses = true};
};
class Misuse : public testing::Test {
protected:
    Misuse() { (void)world_.add(sphere(Real{1}, Real{1})); }

    World<Pair> world_{Seconds{1, 256}};
};
using MisuseDeathTest = Misuse;

TEST_F(MisuseDeathTest, of_a_body_that_is_not_there_ends_the_program) {
    // 65536 and similar numbers would be existing bodies in 16 bits.
    for (const int index : {-1, 1, -2, 1000, 32768, 65536, 65537, -65536, -0x7fffffff - 1}) {
        const BodyId id{index};
        EXPECT_EQ(static_cast<bool>(id), index == 1 || index == 1000) << index;
        EXPECT_DEATH((void)world_.state(id), "") << id.index();
        EXPECT_DEATH((void)world_.position(id), "") << id.index();
        EXPECT_DEATH((void)world_.velocity(id), "") << id.index();
        EXPECT_DEATH((void)world_.angular_velocity(id), "") << id.index();
        EXPECT_DEATH((void)world_.orientation(id), "") << id.index();
        EXPECT_DEATH(world_.apply_impulse(id, {1, 0, 0}), "") << id.index();
    }
    EXPECT_TRUE(world_.state(BodyId{0}) == world_.bodies().state[0]);
}

TEST_F(MisuseDeathTest, of_a_spring_between_bodies_that_are_not_there_ends_the_program) {
    const auto spring = [](int body, int to_body) {
        return SpringSpec{.body = body, .to_body = to_body, .stiffness = 1};
    };
    EXPECT_DEATH((void)world_.add(spring(1, -1)), "");
    EXPECT_DEATH((void)world_.add(spring(-1, -1)), "");
    EXPECT_DEATH((void)world_.add(spring(0, 1)), "");
    EXPECT_DEATH((void)world_.add(spring(0, -2)), "");
    EXPECT_TRUE(world_.add(spring(0, -1)));
    for (int i = 0; i < 3; ++i) {
        for (const Real& far : {Real{1024.5}, Real{-3000}, Real{1e300}}) {
            SpringSpec beyond = spring(0, -1);
            beyond.to[i] = far;
            EXPECT_DEATH((void)world_.add(beyond), "") << i;
            beyond = spring(0, -1);
            beyond.point[i] = far;
            EXPECT_DEATH((void)world_.add(beyond), "") << i;
        }
    }
    (void)world_.add(sphere(Real{1}, Real{1}));
    EXPECT_TRUE(world_.add(spring(0, 1)));
}

TEST_F(MisuseDeathTest, of_an_event_of_a_body_that_is_not_there_ends_the_program) {
    for (const int body : {-1, 1, 32768, 65536}) EXPECT_DEATH((void)world_.prepare({.body = body}), "") << body;
    EXPECT_EQ(world_.prepare({.body = 0}).body.index(), 0);
}

TEST(Events, happen_at_the_step_nearest_to_their_time_however_late) {
    World<Pair> world{Seconds{1, 256}};
    (void)world.add(sphere(Real{1}, Real{1}));
    constexpr double turn = 4294967296.0;
    for (const double step : {0.0, 5.0, turn - 1, turn, turn + 5, 3 * turn + 5, 1e6 * turn})
        for (const double off : {-0.25, 0.25})
            EXPECT_EQ(world.prepare({.time = Real{(step + off) / 256}}).step, static_cast<std::uint64_t>(step)) << off;
    EXPECT_EQ(world.prepare({.time = Real{-1e30}}).step, 0u);
    EXPECT_EQ(world.prepare({.time = Real{1e30}}).step, (std::uint64_t{1} << 63) - 1);
}

// A force that ends early, one that acts while the step counter wraps, and an impulse after it.
struct Late {
    static constexpr const char* name = "late";
    static constexpr Seconds step{1, 256};
    static constexpr WorldSpec world{};
    static constexpr std::array bodies{sphere(Real{2}, Real{1})};
    static constexpr std::array<PlaneSpec, 0> planes{};
    static constexpr std::array<SpringSpec, 0> springs{};
    static constexpr std::array events{
        EventSpec{.time = Real{4294967301.0 / 256}, .value = {0, 1, 0}},
        EventSpec{.time = 4294967290.0 / 256, .kind = EventKind::begin_force, .value = {128, 0, 0}},
        EventSpec{.time = 4294967299.0 / 256, .kind = EventKind::end_force, .value = {128, 0, 0}},
        EventSpec{.time = 0.0, .kind = EventKind::begin_force, .value = {0, 0, 512}},
        EventSpec{.time = 26.0 / 256, .kind = EventKind::end_force, .value = {0, 0, 512}}};
};

TEST(Events, of_a_replay_keep_their_steps_when_the_step_counter_wraps) {
    Replay<Pair, Late> replay;
    auto& world = replay.world();
    using Bodies = std::remove_cvref_t<decltype(world.bodies())>;
    const_cast<Bodies&>(world.bodies()).steps_taken = 0xfffffff0u;  // 16 before the counter wraps
    for (int step = 0; step < 40; ++step) {
        EXPECT_EQ(world.steps_taken(), 0xfffffff0u + static_cast<std::uint32_t>(step));
        replay.step();
        const auto v = world.velocity(BodyId{0});
        const int pushed = std::clamp(step - 9, 0, 9);  // number of changes by 1/4 m/s
        EXPECT_EQ(static_cast<double>(v.x), pushed * 0.25) << step;
        EXPECT_EQ(static_cast<double>(v.y), step >= 21 ? 0.5 : 0.0) << step;
        EXPECT_EQ(static_cast<double>(v.z), 0) << step;
    }
}

TEST_F(MisuseDeathTest, of_events_that_are_not_sorted_of_no_body_or_of_another_kind_ends_the_program) {
    using N = World<Pair>::Numbers;
    Event<N> events[3]{};
    for (int i = 0; i < 3; ++i) {
        events[i].body = BodyId{0};
        events[i].step = static_cast<std::uint32_t>(7 * i);
    }
    events[1].kind = EventKind::begin_force;
    world_.set_script({events, 3});
    for (const int body : {-1, 1, 300}) {
        events[1].body = BodyId{body};
        EXPECT_DEATH(world_.set_script({events, 3}), "") << body;
    }
    events[1].body = BodyId{0};
    events[1].kind = EventKind::velocity;
    EXPECT_DEATH(world_.set_script({events, 3}), "");
    events[1].kind = EventKind::end_torque;
    events[2].step = 6;
    EXPECT_DEATH(world_.set_script({events, 3}), "");
}

TEST(Script, a_new_script_is_read_from_its_beginning) {
    using N = World<Pair>::Numbers;
    World<Pair> world{Seconds{1, 256}};
    (void)world.add(sphere(Real{1}, Real{1}));
    const auto push = [&](int step) { return world.prepare({.time = Real{step} / Real{256}, .value = {1, 0, 0}}); };
    const Event<N> first[] = {push(0), push(2), push(3)}, second[] = {push(1), push(6)};
    world.set_script({first, 3});
    for (int i = 0; i < 5; ++i) world.step();
    EXPECT_EQ(static_cast<double>(world.velocity(BodyId{0}).x), 3);
    world.set_script({second, 2});
    world.step();
    EXPECT_EQ(static_cast<double>(world.velocity(BodyId{0}).x), 3) << "what lies before the present is left out";
    world.step();
    EXPECT_EQ(static_cast<double>(world.velocity(BodyId{0}).x), 4);
}

TEST(SetUpMisuseDeathTest, of_impossible_steps_sizes_and_moments_ends_the_program) {
    for (const Real& step : {Real{}, Real{-1}, Real{-1e-9}}) EXPECT_DEATH((World<Pair>{Seconds{step}}), "");
    const auto add = [](const BodySpec& body) {
        World<Pair> world{Seconds{1, 256}};
        (void)world.add(body);
    };
    const ShapeKind kinds[] = {ShapeKind::sphere, ShapeKind::box, ShapeKind::cylinder, ShapeKind::hoop,
                               ShapeKind::capsule};
    const int sizes[] = {1, 3, 2, 1, 2};  // number of sizes that the shape has
    for (int k = 0; k < 5; ++k) {
        BodySpec body = body_of({kinds[k], {1, 2, 1}}, 1);
        add(body);
        for (int i = 0; i < sizes[k]; ++i) {
            const Real kept = body.shape.size[i];
            for (const Real& bad : {Real{}, Real{-2}}) {
                if (kinds[k] == ShapeKind::capsule && i == 1 && bad.is_zero()) continue;  // a ball
                body.shape.size[i] = bad;
                EXPECT_DEATH(add(body), "") << k << ", size " << i;
            }
            body.shape.size[i] = kept;
        }
    }
    for (int i = 0; i < 3; ++i) {
        RealVec3 moments{1, 1, 1};
        moments[i] = 2;
        add(top(moments, {}));
        for (const Real& bad : {Real{2.001}, Real{-1}}) {
            moments[i] = bad;
            EXPECT_DEATH(add(top(moments, {})), "") << i;
        }
    }
}

struct Floor : Scene {
    static constexpr Features features{.planes = 1, .sleep = true};
};
TEST(ContactMisuseDeathTest, of_a_body_that_is_not_there_ends_the_program) {
    World<Floor> world{Seconds{1, 256}};
    EXPECT_DEATH((void)world.asleep({}), "");
    EXPECT_DEATH((void)world.contact_count({}), "");
    const BodyId id = world.add(sphere(Real{1}, Real{1}));
    EXPECT_FALSE(world.asleep(id));
    EXPECT_EQ(world.contact_count(id), 0);
}

}  // namespace
}  // namespace tumble::test
