// Nothing that a program names is ignored: every member of every spec changes the motion of a world with every feature,
// and is misuse in a world without the feature that obeys it.
#include <tumble/tumble.hpp>

#include "members.hpp"
#include "references.hpp"
#include "worlds.hpp"

#include <set>
#include <string>
#include <vector>

namespace tumble::test::named {
namespace {

using detail::Required;

// What a program names for a world: one of each.
struct Specs {
    WorldSpec world{.gravity = {0, -10, 0}};
    BodySpec body = [] {
        BodySpec ball = sphere(1, 0.25);
        ball.position = {0, 0.25, 0};
        ball.velocity = {1, 0, 0.25};
        ball.angular_velocity = {0.5, 1, -2};
        return ball;
    }();
    PlaneSpec plane{};
    SpringSpec spring{.to = {0, 3, 0}, .stiffness = 1};
    bool pushes = true;  // an impulse and a force act
};
struct Nothing {
    constexpr void operator()(auto&) const {}
};

inline constexpr Features all = Features{.bodies = 2, .planes = 1, .springs = 1}.with_everything();
template <bool Features::*feature>
constexpr Features all_without() {
    Features features = all;
    features.*feature = false;
    return features;
}
template <Features features, class Change>
constexpr bool require(Change change) {
    Specs specs;
    change(specs);
    Required<features>::by(specs.world);
    Required<features>::by(specs.body);
    Required<features>::by(specs.plane);
    return true;
}
// True where no assertion fails.
template <Features features, class Change>
concept Accepted = requires {
    typename std::bool_constant<require<features>(Change{})>;
};
template <Features features, EventKind kind>
concept AcceptedEvent = requires {
    typename std::bool_constant<(Required<features>::by(kind), true)>;
};

// The motion of a world with every feature that has these specs, and another body.
template <class Context, class Change>
std::string motion_with(Context context, Change change, int steps) {
    Specs specs;
    SceneSetup setup{.name = "named"};
    BodySpec other = fixed(placed(box(1, {0.5, 0.5, 0.5}), {4, 0.25, 0}));
    if constexpr (requires { context(specs, other); }) context(specs, other);
    else context(specs);
    change(specs);
    setup.world = specs.world;
    setup.bodies = {specs.body, other};
    setup.planes = {specs.plane};
    setup.springs = {specs.spring};
    if (specs.pushes) {
        setup.impulses = {{.time = 0.03125, .impulse = {0.25, 0.5, 0}}};
        setup.forces = {{.from = 0.03125, .until = 0.0625, .force = {1, 0, 0}}};
    }
    const auto world = build(setup, "verlet", "q32_near");
    const Status status = world->run(steps);
    return std::to_string(world->hash()) + (world->asleep(0) ? " asleep " : " awake ") + std::to_string(status.bits);
}

class Named : public testing::Test {
protected:
    // A change of a member, and what must stand beside it so that it acts.
    template <class Change, class Context = Nothing>
    void has_effect(const std::string& member, Change change, Context context = {}, int steps = 64) {
        members_.insert(member);
        EXPECT_TRUE((Accepted<all, Change>)) << member;
        EXPECT_NE(motion_with(context, change, steps), motion_with(context, Nothing{}, steps)) << member;
    }
    // The same of a member that a feature obeys.
    template <bool Features::*feature, class Change, class Context = Nothing>
    void needs(const std::string& member, Change change, Context context = {}, int steps = 64) {
        has_effect(member, change, context, steps);
        EXPECT_FALSE((Accepted<all_without<feature>(), Change>)) << member;
    }
    // Every member of the spec has been changed.
    template <class Spec>
    void expect_all_of(const std::string& spec) const {
        std::set<std::string> changed;
        for (const std::string& member : members_)
            if (member.starts_with(spec + ".")) changed.insert(member.substr(0, member.find(' ')));
        EXPECT_EQ(changed.size(), count_of_members<Spec>()) << spec;
    }

    std::set<std::string> members_;  // that were changed
};

constexpr auto bounces = [](Specs& s) { s.body.position.y = 0.3; };
constexpr auto by_springs = [](Specs& s) { s.world.contact.response = ContactResponse::spring; };
constexpr auto slides = [](Specs& s) { s.world.contact.friction = 0.5; };
constexpr auto rests = [](Specs& s) {
    s.world.contact = {.restitution = 0, .friction = 0.5, .sleep = {.on = true}};
    s.body.velocity = s.body.angular_velocity = {};
    s.spring.stiffness = 0;
    s.pushes = false;
};
// It rolls at 0.0625 m/s and 0.25 rad/s.
constexpr auto rolls = [](Specs& s) {
    rests(s);
    s.body.velocity = {0.0625, 0, 0};
    s.body.angular_velocity = {0, 0, -0.25};
    s.world.contact.sleep = {.on = true, .speed = 0.125, .angular_speed = 0.5, .time = 0.125};
};
// It flies to and fro between the plane and a fixed body, several times in a step.
constexpr auto is_squeezed = [](Specs& s, BodySpec& other) {
    s.world.contact.restitution = 1;
    s.body.position.y = 0.2578125;
    s.body.velocity = {0, -24, 0};
    s.body.angular_velocity = {};
    other.position = {0, 0.765625, 0};
};
constexpr auto attracts = [](Specs& s, BodySpec& other) {
    s.body.velocity = {};
    other.position = {1, 0.25, 0};
};

TEST_F(Named, every_value_of_a_world_acts_or_is_misuse) {
    has_effect("WorldSpec.gravity", [](Specs& s) { s.world.gravity.x = 1; });
    needs<&Features::gravitation>(
        "WorldSpec.gravitation", [](Specs& s) { s.world.gravitation = 0.5; }, attracts);
    needs<&Features::drag>("WorldSpec.linear_drag", [](Specs& s) { s.world.linear_drag = 0.5; });
    needs<&Features::drag>("WorldSpec.angular_drag", [](Specs& s) { s.world.angular_drag = 0.5; });
    needs<&Features::contact_springs>("WorldSpec.contact", by_springs, bounces);
    expect_all_of<WorldSpec>("WorldSpec");

    needs<&Features::contact_springs>("ContactSpec.response spring", by_springs, bounces);
    needs<&Features::contact_impulses>(
        "ContactSpec.response impulse", [](Specs& s) { s.world.contact.response = ContactResponse::impulse; },
        by_springs);
    has_effect("ContactSpec.response none", [](Specs& s) { s.world.contact.response = ContactResponse::none; });
    has_effect(
        "ContactSpec.restitution", [](Specs& s) { s.world.contact.restitution = 0.875; }, bounces);
    has_effect(
        "ContactSpec.restitution_threshold", [](Specs& s) { s.world.contact.restitution_threshold = 9; }, bounces);
    needs<&Features::friction>("ContactSpec.friction", slides);
    needs<&Features::rolling_resistance>(
        "ContactSpec.rolling_resistance", [](Specs& s) { s.world.contact.rolling_resistance = 0.01; }, slides);
    needs<&Features::rolling_resistance>(
        "ContactSpec.spinning_resistance", [](Specs& s) { s.world.contact.spinning_resistance = 0.01; }, slides);
    const auto unlike = [](Specs& s) {
        bounces(s);
        s.body.velocity.x = 4;
        s.world.contact.friction = 0.5;
        s.body.restitution = s.body.friction = 0.75;
        s.plane.restitution = s.plane.friction = 0.25;
    };
    needs<&Features::mixing>(
        "ContactSpec.restitution_mixing", [](Specs& s) { s.world.contact.restitution_mixing = Mixing::product; },
        unlike);
    needs<&Features::mixing>(
        "ContactSpec.friction_mixing", [](Specs& s) { s.world.contact.friction_mixing = Mixing::smaller; }, unlike);
    has_effect(
        "ContactSpec.tolerance", [](Specs& s) { s.world.contact.tolerance = 0.03125; },
        [](Specs& s) { s.body.position.y = 0.2421875; });
    const auto falls_on_springs = [](Specs& s) {
        bounces(s);
        by_springs(s);
    };
    has_effect(
        "ContactSpec.stiffness", [](Specs& s) { s.world.contact.stiffness = 5000; }, falls_on_springs);
    has_effect(
        "ContactSpec.damping", [](Specs& s) { s.world.contact.damping = 5; }, falls_on_springs);
    has_effect(
        "ContactSpec.barrier", [](Specs& s) { s.world.contact.barrier = 0.001; }, falls_on_springs);
    needs<&Features::sleep>(
        "ContactSpec.sleep", [](Specs& s) { s.world.contact.sleep.on = true; },
        [](Specs& s) {
            rests(s);
            s.world.contact.sleep.on = false;
        },
        192);
    needs<&Features::impact_bounds>(
        "ContactSpec.most_impacts", [](Specs& s) { s.world.contact.most_impacts = 1; }, is_squeezed);
    needs<&Features::impact_bounds>(
        "ContactSpec.most_searches", [](Specs& s) { s.world.contact.most_searches = 1; }, is_squeezed);
    needs<&Features::impact_bounds>(
        "ContactSpec.most_sweeps", [](Specs& s) { s.world.contact.most_sweeps = 1; }, is_squeezed);
    needs<&Features::bounded_steps>(
        "ContactSpec.exact_bodies", [](Specs& s) { s.world.contact.exact_bodies = 0; }, is_squeezed);
    constexpr auto never_exact = [](Specs& s) { s.world.contact.exact_bodies = 0; };
    EXPECT_TRUE((Accepted<all_without<&Features::exact_steps>(), decltype(never_exact)>));
    EXPECT_FALSE((Accepted<all_without<&Features::exact_steps>(), Nothing>));
    expect_all_of<ContactSpec>("ContactSpec");

    needs<&Features::sleep>(
        "SleepSpec.on", [](Specs& s) { s.world.contact.sleep.on = true; },
        [](Specs& s) {
            rests(s);
            s.world.contact.sleep.on = false;
        },
        192);
    has_effect(
        "SleepSpec.speed", [](Specs& s) { s.world.contact.sleep.speed = 0.03125; }, rolls);
    has_effect(
        "SleepSpec.angular_speed", [](Specs& s) { s.world.contact.sleep.angular_speed = 0.125; }, rolls);
    has_effect(
        "SleepSpec.time", [](Specs& s) { s.world.contact.sleep.time = 1; }, rolls);
    expect_all_of<SleepSpec>("SleepSpec");
}

TEST_F(Named, every_value_of_a_body_acts_or_is_misuse) {
    needs<&Features::boxes>("BodySpec.shape box", [](Specs& s) { s.body.shape = {ShapeKind::box, {0.25, 0.5, 0.25}}; });
    needs<&Features::round_shapes>("BodySpec.shape cylinder", [](Specs& s) {
        s.body.shape = {ShapeKind::cylinder, {0.25, 0.25, 0}};
    });
    needs<&Features::round_shapes>("BodySpec.shape hoop", [](Specs& s) {
        s.body.shape = {ShapeKind::hoop, {0.25, 0, 0}};
    });
    needs<&Features::round_shapes>("BodySpec.shape capsule", [](Specs& s) {
        s.body.shape = {ShapeKind::capsule, {0.125, 0.25, 0}};
    });
    has_effect("BodySpec.shape sphere", [](Specs& s) { s.body.shape.size.x = 0.125; });
    needs<&Features::point_masses>("BodySpec.shape none", [](Specs& s) {
        const RealVec3 x = s.body.position;
        s.body = point_mass(1);
        s.body.position = x;
    });
    has_effect("BodySpec.mass", [](Specs& s) { s.body.mass = 2; });
    has_effect("BodySpec.inertia", [](Specs& s) { s.body.inertia.xx = 0.03125; });
    has_effect("BodySpec.position", [](Specs& s) { s.body.position.y = 0.5; });
    has_effect("BodySpec.velocity", [](Specs& s) { s.body.velocity.y = 1; });
    has_effect("BodySpec.orientation", [](Specs& s) { s.body.orientation = rotation_about({0, 0, 1}, 0.5); });
    has_effect("BodySpec.angular_velocity", [](Specs& s) { s.body.angular_velocity.x = 1; });
    has_effect(
        "BodySpec.restitution", [](Specs& s) { s.body.restitution = 0.875; }, bounces);
    needs<&Features::friction>(
        "BodySpec.friction", [](Specs& s) { s.body.friction = 0.25; }, slides);
    needs<&Features::rolling_resistance>(
        "BodySpec.rolling_resistance", [](Specs& s) { s.body.rolling_resistance = 0.01; }, slides);
    needs<&Features::rolling_resistance>(
        "BodySpec.spinning_resistance", [](Specs& s) { s.body.spinning_resistance = 0.01; }, slides);
    needs<&Features::turntables>(
        "BodySpec.fixed",
        [](Specs& s) {
            s.body.fixed = true;
            s.body.angular_velocity = {0, 1, 0};
        },
        [](Specs& s) {
            s.body.fixed = true;
            s.body.angular_velocity = {};
        });
    needs<&Features::kinematic>("BodySpec.kinematic", [](Specs& s) { s.body.kinematic = true; });
    needs<&Features::layers>(
        "BodySpec.layers", [](Specs& s) { s.body.layers = 0; }, bounces);
    EXPECT_FALSE((Accepted<all_without<&Features::rotation>(), Nothing>)) << "a body that is no point mass";
    expect_all_of<BodySpec>("BodySpec");
}

TEST_F(Named, every_value_of_a_plane_a_spring_and_a_timed_event_acts_or_is_misuse) {
    has_effect("PlaneSpec.normal", [](Specs& s) { s.plane.normal = {0, 0.8, 0.6}; });
    has_effect("PlaneSpec.offset", [](Specs& s) { s.plane.offset = 1; });
    has_effect(
        "PlaneSpec.restitution", [](Specs& s) { s.plane.restitution = 0.875; }, bounces);
    needs<&Features::friction>(
        "PlaneSpec.friction", [](Specs& s) { s.plane.friction = 0.25; }, slides);
    needs<&Features::rolling_resistance>(
        "PlaneSpec.rolling_resistance", [](Specs& s) { s.plane.rolling_resistance = 0.01; }, slides);
    needs<&Features::rolling_resistance>(
        "PlaneSpec.spinning_resistance", [](Specs& s) { s.plane.spinning_resistance = 0.01; }, slides);
    expect_all_of<PlaneSpec>("PlaneSpec");

    has_effect("SpringSpec.body", [](Specs& s) { s.spring.body = 1; });
    has_effect("SpringSpec.point", [](Specs& s) { s.spring.point = {0.125, 0, 0}; });
    has_effect("SpringSpec.to_body", [](Specs& s) { s.spring.to_body = 1; });
    has_effect("SpringSpec.to", [](Specs& s) { s.spring.to.x = 1; });
    has_effect("SpringSpec.stiffness", [](Specs& s) { s.spring.stiffness = 2; });
    has_effect("SpringSpec.damping", [](Specs& s) { s.spring.damping = 1; });
    has_effect("SpringSpec.rest_length", [](Specs& s) { s.spring.rest_length = 1; });
    expect_all_of<SpringSpec>("SpringSpec");
}

TEST(Required, events_need_the_features_that_their_kinds_name) {
    constexpr Features controlled = all_without<&Features::control>(), kept = all_without<&Features::removal>();
    EXPECT_FALSE((AcceptedEvent<controlled, EventKind::force>));
    EXPECT_FALSE((AcceptedEvent<controlled, EventKind::torque>));
    EXPECT_FALSE((AcceptedEvent<controlled, EventKind::step_force>));
    EXPECT_FALSE((AcceptedEvent<controlled, EventKind::step_torque>));
    EXPECT_FALSE((AcceptedEvent<controlled, EventKind::gravity>));
    EXPECT_FALSE((AcceptedEvent<kept, EventKind::remove>));
    EXPECT_TRUE((AcceptedEvent<kept, EventKind::force>));
    EXPECT_TRUE((AcceptedEvent<Features{}, EventKind::impulse>));
    EXPECT_TRUE((AcceptedEvent<Features{}, EventKind::pose>));
}

// What nothing could feel.
TEST(Required, values_that_nothing_could_feel_need_no_feature) {
    constexpr Features alone{}, planes{.planes = 1}, pairs{.bodies = 2, .pairs = true};
    constexpr auto flies = [](Specs& s) {
        s.body = box(1, {1, 1, 1});
        s.body.friction = s.plane.friction = s.world.contact.friction = 0.5;
        s.world.contact.sleep.on = true;
        s.world.contact.most_impacts = 1;
        s.world.gravitation = 1;
    };
    constexpr auto never_moves = [](Specs& s) {
        s.body = box(1, {1, 1, 1});
        s.body.fixed = true;
    };
    constexpr auto is_round = [](Specs& s) { s.body = cylinder(1, 1, 1); };
    constexpr auto passes_through = [](Specs& s) {
        s.world.contact = {.response = ContactResponse::none, .friction = 0.5, .sleep = {.on = true}};
    };
    EXPECT_TRUE((Accepted<alone, decltype(flies)>));
    EXPECT_FALSE((Accepted<planes, decltype(flies)>));
    EXPECT_TRUE((Accepted<planes, decltype(never_moves)>));
    EXPECT_FALSE((Accepted<pairs, decltype(never_moves)>));
    EXPECT_TRUE((Accepted<pairs, decltype(is_round)>));
    EXPECT_FALSE((Accepted<planes, decltype(is_round)>));
    EXPECT_TRUE((Accepted<planes, decltype(passes_through)>));
}

// No world obeys them: drag, damping and attraction end at zero.
TEST(Required, negative_drag_and_attraction_are_misuse_with_every_feature) {
    constexpr auto pushes = [](Specs& s) { s.world.linear_drag = -1; };
    constexpr auto spins_up = [](Specs& s) { s.world.angular_drag = -1; };
    constexpr auto repels = [](Specs& s) { s.world.gravitation = -1; };
    EXPECT_FALSE((Accepted<all, decltype(pushes)>));
    EXPECT_FALSE((Accepted<all, decltype(spins_up)>));
    EXPECT_FALSE((Accepted<all, decltype(repels)>));
}

struct Bare : Scene {
    static constexpr Features features{.bodies = 2, .planes = 1, .springs = 1, .script = true};
};
TEST(RequiredDeathTest, worlds_refuse_what_they_would_ignore) {
    const Seconds step{1, 256};
    World<Bare> world{step};
    WorldSpec rough;
    rough.contact.friction = 0.5;
    EXPECT_DEATH((World<Bare>{step, rough}), "");
    EXPECT_DEATH((World<Bare>{step, {.linear_drag = 1}}), "");
    EXPECT_DEATH((void)world.add(box(1, {1, 1, 1})), "");
    EXPECT_DEATH((void)world.add(PlaneSpec{.friction = 0.5}), "");
    BodySpec turning = sphere(1, 1);
    turning.fixed = true;
    turning.angular_velocity = {0, 1, 0};
    EXPECT_DEATH((void)world.add(turning), "");
    EXPECT_EQ(world.body_count(), 0);
    const BodyId id = world.add(sphere(1, 1));
    EXPECT_DEATH((void)world.add(SpringSpec{.stiffness = 1, .damping = -1}), "");
    EXPECT_DEATH((void)world.add(SpringSpec{.stiffness = 1, .rest_length = -1}), "");
    Event<World<Bare>::Numbers> push{.kind = EventKind::force, .body = id};
    EXPECT_DEATH(world.set_script({&push, 1}), "");
    push.kind = EventKind::remove;
    EXPECT_DEATH(world.set_script({&push, 1}), "");
    EXPECT_TRUE(world.status().ok());
}

// Data of a compiled scene, with every list and value that a scene may have.
struct Full {
    static constexpr Seconds step{1, 256};
    WorldSpec world{};
    std::vector<BodySpec> bodies{box(2, {0.25, 0.5, 0.75}), placed(box(1, {0.25, 0.25, 0.25}), {1, 0, 0})};
    std::vector<PlaneSpec> planes{};
    std::vector<SpringSpec> springs{};
    std::vector<EventSpec> events{};
    std::vector<DragSpec> drags{};
    std::vector<WheelsSpec> wheels{};
    OrbitSpec orbit{};
    RealVec3 wind{};
    Real softening{};
};
struct Loaded : Scene {
    static constexpr Features features{.bodies = 2,
                                       .gravitation = true,
                                       .softening = true,
                                       .air = true,
                                       .gravity_gradient = true,
                                       .wheels = true,
                                       .script = true};
};
// Of a world with these loads.
std::uint64_t motion_of(const Full& data) {
    tumble::Replay<Loaded, Full> replay{data};
    for (int step = 0; step < 32; ++step) replay.step();
    EXPECT_TRUE(replay.world().status().ok());
    return replay.world().hash();
}

class NamedData : public Named {
protected:
    NamedData() {
        data_.world.gravitation = 0.5;
        data_.softening = 0.125;
        data_.bodies[0].velocity = {1, 0.5, 0.25};
        data_.bodies[0].angular_velocity = {0.5, 1, -2};
        data_.bodies[0].orientation = rotation_about({0, 0, 1}, 0.5);
        data_.bodies[1].velocity = {0, 0.5, 0};
        data_.bodies[1].angular_velocity = {1, 0, 0};
        data_.events = {{.time = 0.03125, .value = {0.25, 0.5, 0}}};
        data_.drags = {{.linear = 0.5, .quadratic = 0.25}};
        data_.wheels = {{.momentum = {0.125, 0, 0}}};
        data_.orbit = {.rate = 0.5, .to_centre = {0, 0.6, 0.8}};
    }
    // A change of a member, from `data_`.
    template <class Change>
    void acts(const std::string& member, Change change) {
        members_.insert(member);
        Full changed = data_;
        change(changed);
        EXPECT_NE(motion_of(changed), motion_of(data_)) << member;
    }

    Full data_;
};
TEST_F(NamedData, every_value_of_events_and_loads_acts) {
    acts("EventSpec.time", [](Full& data) { data.events[0].time = 0.0625; });
    acts("EventSpec.kind", [](Full& data) { data.events[0].kind = EventKind::velocity; });
    acts("EventSpec.body", [](Full& data) { data.events[0].body = 1; });
    acts("EventSpec.frame", [](Full& data) { data.events[0].frame = Frame::body; });
    acts("EventSpec.value", [](Full& data) { data.events[0].value.x = 1; });
    acts("EventSpec.point", [](Full& data) { data.events[0].point.x = 0.125; });
    data_.events[0].kind = EventKind::pose;
    acts("EventSpec.orientation", [](Full& data) { data.events[0].orientation = rotation_about({1, 0, 0}, 0.5); });
    expect_all_of<EventSpec>("EventSpec");

    acts("DragSpec.body", [](Full& data) { data.drags[0].body = 1; });
    acts("DragSpec.linear", [](Full& data) { data.drags[0].linear = 1; });
    acts("DragSpec.quadratic", [](Full& data) { data.drags[0].quadratic = 1; });
    expect_all_of<DragSpec>("DragSpec");
    acts("wind", [](Full& data) { data.wind = {0, 0, 2}; });

    acts("WheelsSpec.body", [](Full& data) { data.wheels[0].body = 1; });
    acts("WheelsSpec.momentum", [](Full& data) { data.wheels[0].momentum.y = 0.125; });
    expect_all_of<WheelsSpec>("WheelsSpec");

    acts("OrbitSpec.rate", [](Full& data) { data.orbit.rate = 1; });
    acts("OrbitSpec.to_centre", [](Full& data) { data.orbit.to_centre = {0, 0.8, 0.6}; });
    expect_all_of<OrbitSpec>("OrbitSpec");
    acts("softening", [](Full& data) { data.softening = 0.25; });
}

struct Attracted : Scene {
    static constexpr Features features{.bodies = 2, .gravitation = true};
};
TEST(RequiredDeathTest, a_replay_refuses_data_that_its_world_would_ignore) {
    using Replay = tumble::Replay<Attracted, Full>;
    EXPECT_TRUE(Replay{Full{}}.step().ok());
    const auto refuses = [](auto&& fill) {
        Full data;
        fill(data);
        EXPECT_DEATH(Replay{data}, "");
    };
    refuses([](Full& data) { data.planes.resize(1); });
    refuses([](Full& data) { data.springs.resize(1); });
    refuses([](Full& data) { data.events.resize(1); });
    refuses([](Full& data) { data.drags.resize(1); });
    refuses([](Full& data) { data.wheels.resize(1); });
    refuses([](Full& data) { data.orbit.rate = 1; });
    refuses([](Full& data) { data.softening = 1; });
    // Of air that nothing feels.
    Full windy;
    windy.wind = {1, 0, 0};
    EXPECT_TRUE(Replay{windy}.step().ok());
}

}  // namespace
}  // namespace tumble::test::named
