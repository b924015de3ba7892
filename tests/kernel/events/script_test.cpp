// Scripts of events and recordings of them, in every kind of number system and in worlds with and without contacts.
#include <tumble/tumble.hpp>

#include "kinds.hpp"
#include "snapshots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace tumble::test {
namespace {

using ScriptNumbers = Tested<testing::Types<Q32<NearRange>>, testing::Types<F64, Q32<NearRange, false>, F32>>;

constexpr Features scripts_on_a_floor{.bodies = 2,
                                      .planes = 1,
                                      .drag = true,
                                      .control = true,
                                      .script = true,
                                      .recording = true,
                                      .imu = true,
                                      .pairs = true,
                                      .boxes = true,
                                      .friction = true,
                                      .sleep = true};
constexpr Features only_scripts{.control = true, .script = true, .recording = true};

template <class N>
class Scripts : public testing::Test {
protected:
    using E = Event<N>;
    template <Features features>
    using WorldOf = World<SceneOf<N, integrators::Verlet, features>>;

    template <Features features>
    [[nodiscard]] static WorldOf<features> set_up() {
        WorldOf<features> world{
            Seconds{1, 256},
            {.gravity = {0, -9.81, 0}, .linear_drag = 0, .contact = {.friction = 0.4, .sleep = {.on = true}}}};
        BodySpec body = box(2, {0.5, 0.25, 0.75});
        body.position = {0, 0.125, 0};
        (void)world.add(body);
        body.position = {1, 0.125, 0};
        if constexpr (features.bodies > 1) (void)world.add(body);
        if constexpr (features.planes > 0) (void)world.add(PlaneSpec{});
        return world;
    }
    // Each kind of event in turn, with floats and doubles.
    template <class World>
    static void command(World& world, int step) {
        const BodyId id{step % 3 == 0 ? world.body_count() - 1 : 0};
        const auto s = static_cast<float>(step);
        switch (step % 40) {
        case 1: world.apply_impulse(id, {0.1F, 1.0F + s / 512, 0.0F}, {0.1F, 0.0F, 0.2F}, Frame::body); break;
        case 5: world.apply_angular_impulse(id, {0.01, 0.02, 0.03}, Frame::world); break;
        case 9: world.set_force(id, {1.0F, 20.0F, 0.3F}, Frame::body, {0.0F, 0.1F, 0.0F}); break;
        case 14: world.set_torque(id, {0.01F, 0.02F, 0.0F}, Frame::world); break;
        case 20: world.set_force(id, {}, Frame::world); break;
        case 21: world.set_torque(id, {}, Frame::body); break;
        case 22: world.apply_force(id, {2.5, 1, 0}, Frame::body); break;
        case 23:
            world.apply_torque(id, {0.1, 0, 0}, Frame::world);
            world.apply_torque(id, {0, 0.1, 0}, Frame::body);
            break;
        case 26: world.set_gravity({0.25F, -9.0F - s / 512, -0.5F}); break;
        case 30: world.set_velocity(id, {0.25, 0.5, -0.125}, Frame::body); break;
        case 33: world.set_angular_velocity(id, {0.5F, 1.0F, s / 256}); break;
        case 37: world.set_pose(id, {s / 128, 0.6F, 0.1F}, Quaternion<double>{1, {0.1, 0.2, 0.3}}); break;
        default: break;
        }
    }
    // The hashes after each step of a run, also under live commands.
    static std::vector<std::uint64_t> run_live(auto& world, int steps) { return run(world, steps, true); }
    static std::vector<std::uint64_t> run(auto& world, int steps, bool live = false) {
        std::vector<std::uint64_t> hashes;
        for (int i = 0; i < steps; ++i) {
            if (live) command(world, static_cast<int>(world.steps_taken()));
            world.step();
            hashes.push_back(world.hash());
        }
        return hashes;
    }
};
TYPED_TEST_SUITE(Scripts, ScriptNumbers);

TYPED_TEST(Scripts, a_recording_replays_to_the_same_state) {
    const auto trial = [&]<Features features>() {
        auto live = this->template set_up<features>(), replayed = live;
        Recorder<TypeParam, 256> recorder;
        live.record(&recorder);
        const auto expected = this->run_live(live, 320);
        EXPECT_EQ(recorder.count(), 8 * 13) << "each command is one event";
        EXPECT_EQ(recorder.lost(), 0u);
        replayed.set_script(recorder.script());
        EXPECT_EQ(this->run(replayed, 320), expected);
        EXPECT_EQ(live.status().bits, replayed.status().bits);
    };
    trial.template operator()<only_scripts>();
    trial.template operator()<scripts_on_a_floor>();
}

TYPED_TEST(Scripts, a_world_with_every_feature_replays_the_recording_of_a_minimal_one) {
    auto live = this->template set_up<only_scripts>();
    Recorder<TypeParam, 256> recorder;
    live.record(&recorder);
    const auto expected = this->run_live(live, 120);
    World<SceneOf<TypeParam, integrators::Verlet, everything>> full{
        Seconds{1, 256}, {.gravity = {0, -9.81, 0}, .contact = {.friction = 0.4, .sleep = {.on = true}}}};
    BodySpec body = box(2, {0.5, 0.25, 0.75});
    body.position = {0, 0.125, 0};
    (void)full.add(body);
    full.set_script(recorder.script());
    EXPECT_EQ(this->run(full, 120), expected);
}

TYPED_TEST(Scripts, a_recording_that_begins_at_a_snapshot_replays_from_there) {
    auto live = this->template set_up<scripts_on_a_floor>();
    Recorder<TypeParam, 64> recorder;
    live.record(&recorder);
    (void)this->run_live(live, 100);
    auto snapshot = live;
    snapshot.record(nullptr);
    recorder.clear();
    const auto expected = this->run_live(live, 100);
    snapshot.set_script(recorder.script());
    EXPECT_EQ(this->run(snapshot, 100), expected);
}

TYPED_TEST(Scripts, a_world_that_goes_back_forgets_the_events_after_that_step) {
    auto live = this->template set_up<scripts_on_a_floor>();
    const auto start = live;
    Recorder<TypeParam, 64> recorder;
    live.record(&recorder);
    (void)this->run_live(live, 60);
    const auto snapshot = live;
    (void)this->run_live(live, 40);
    live = snapshot;
    recorder.forget_from(60);
    live.apply_impulse(BodyId{0}, {0, 3, 0}, {}, Frame::world);
    const auto end = this->run(live, 40).back();
    auto replayed = start;
    replayed.set_script(recorder.script());
    EXPECT_EQ(this->run(replayed, 100).back(), end);
}

TYPED_TEST(Scripts, a_full_recording_loses_its_oldest_events_and_counts_them) {
    auto world = this->template set_up<only_scripts>();
    Recorder<TypeParam, 3> recorder;
    world.record(&recorder);
    for (int i = 0; i < 8; ++i) {
        world.set_velocity(BodyId{0}, {static_cast<float>(i + 1), 0.0F, 0.0F});
        world.step();
        EXPECT_EQ(recorder.count(), i < 3 ? i + 1 : 3);
        EXPECT_EQ(recorder.lost(), i < 3 ? 0u : static_cast<std::uint32_t>(i - 2));
    }
    for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(recorder[k].step, static_cast<std::uint64_t>(5 + k));
        EXPECT_EQ(recorder[k].value.block().template as<float>().x, static_cast<float>(6 + k));
    }
    recorder.forget_from(7);
    EXPECT_EQ(recorder.count(), 2);
    EXPECT_EQ(recorder[1].step, 6u);
    EXPECT_DEATH((void)recorder.script(), "") << "it lacks its first events";
    EXPECT_DEATH((void)recorder[2], "");
    recorder.clear();
    EXPECT_EQ(recorder.script().count, 0);
}

TYPED_TEST(Scripts, an_event_that_is_written_as_doubles_is_the_same_event) {
    auto live = this->template set_up<scripts_on_a_floor>(), replayed = live;
    Recorder<TypeParam, 256> recorder;
    live.record(&recorder);
    const auto expected = this->run_live(live, 320);
    std::vector<EventSpec> specs;
    for (const Event<TypeParam>& event : recorder.script()) {
        const auto real = [](const Vector3<double>& v) { return RealVec3{v.x, v.y, v.z}; };
        const auto q = event.orientation.template as<double>();
        specs.push_back({Real{static_cast<int>(event.step)} * Real::scaled(1, -8),
                         event.kind,
                         event.body,
                         event.frame,
                         real(event.value.block().template as<double>()),
                         real(event.point.block().template as<double>()),
                         {q.w, real(q.v)}});
    }
    std::swap(specs.front(), specs.back());  // prepare_sorted() sorts by step
    std::vector<Event<TypeParam>> events;
    replayed.set_script(prepare_sorted(events, specs, replayed.bodies()));
    EXPECT_EQ(this->run(replayed, 320), expected);
}

// A scene whose events are constants of the program, out of order, and one whose events are read at run time.
struct ConstantScript {
    static constexpr Seconds step{1, 256};
    static constexpr WorldSpec world{};
    static constexpr std::array bodies{box(2, {0.5, 0.25, 0.75})};
    static constexpr std::array<PlaneSpec, 0> planes{};
    static constexpr std::array<SpringSpec, 0> springs{};
    static constexpr std::array events{
        EventSpec{.time = 0.5, .kind = EventKind::torque, .frame = Frame::body, .value = {0.01, 0.1, -0.3}},
        EventSpec{.time = 0.1, .kind = EventKind::force, .value = {1, 2, 3}, .point = {0.1, 0, 0.3}},
        EventSpec{.time = 0.25, .kind = EventKind::angular_velocity, .value = {1, 2, 3}},
        EventSpec{.time = 0.25, .kind = EventKind::pose, .value = {1, 2, 3}, .orientation = {0.5, {0.1, 0.3, 0.7}}},
        EventSpec{.time = 0.3, .kind = EventKind::gravity, .body = 77, .value = {1, -9.81, 3}}};
};
struct ReadScript : ConstantScript {
    std::vector<EventSpec> events{ConstantScript::events.begin(), ConstantScript::events.end()};
};

TYPED_TEST(Scripts, events_that_are_constants_take_no_memory_and_have_the_same_bits) {
    using Config = SceneOf<TypeParam, integrators::Verlet, only_scripts>;
    using Constant = Replay<Config, ConstantScript>;
    if constexpr (TypeParam::fixed_point) {
        EXPECT_LE(sizeof(Constant), sizeof(World<Config>) + alignof(World<Config>)) << "and two empty lists";
    }
    Constant constant;
    const ReadScript data;
    Replay<Config, ReadScript> read{data};
    for (int step = 0; step < 200; ++step) {
        constant.step();
        read.step();
        ASSERT_EQ(constant.world().hash(), read.world().hash()) << step;
    }
    EXPECT_NE(static_cast<double>(constant.world().gravity().x), 0) << "the events have acted";
}

TYPED_TEST(Scripts, records_of_a_program_become_the_same_events_when_they_are_due) {
    struct Record {
        std::uint16_t step;
        std::int16_t torque[3];  // N m / 4096
    };
    static_assert(sizeof(Record) == 8);
    std::vector<Record> records;
    std::vector<Event<TypeParam>> events;
    const auto torque_of = [](const Record& r) {
        return InputVector<TypeParam>{r.torque[0] / 4096.0F, r.torque[1] / 4096.0F, r.torque[2] / 4096.0F};
    };
    for (int i = 0; i < 60; ++i) {
        const int value = 37 * i % 101 - 50;
        records.push_back({static_cast<std::uint16_t>(5 * i / 2),
                           {static_cast<std::int16_t>(value), static_cast<std::int16_t>(-3 * value), 25}});
        events.push_back({.kind = EventKind::torque,
                          .frame = Frame::body,
                          .body = BodyId{0},
                          .value = torque_of(records.back()),
                          .step = records.back().step});
    }
    auto whole = this->template set_up<only_scripts>(), walked = whole;
    whole.set_script({events.data(), 60});
    const auto expected = this->run(whole, 200);
    Script<Record> script;
    script.set({records.data(), 60}, walked.steps_taken());
    for (int step = 0; step < 200; ++step) {
        script.for_each_due(walked.steps_taken(),
                            [&](const Record& r) { walked.set_torque(BodyId{0}, torque_of(r), Frame::body); });
        walked.step();
        ASSERT_EQ(walked.hash(), expected[static_cast<std::size_t>(step)]) << step;
    }
}

TYPED_TEST(Scripts, a_script_starts_at_the_present_step) {
    auto world = this->template set_up<only_scripts>();
    const Event<TypeParam> events[] = {{.kind = EventKind::velocity, .body = BodyId{0}, .value = {8, 0, 0}, .step = 1},
                                       {.kind = EventKind::velocity, .body = BodyId{0}, .value = {1, 0, 0}, .step = 4},
                                       {.kind = EventKind::velocity, .body = BodyId{0}, .value = {2, 0, 0}, .step = 4}};
    for (int i = 0; i < 3; ++i) world.step();
    world.set_script({events, 3});
    const auto speed = [&] { return static_cast<double>(world.velocity(BodyId{0}).x); };
    world.step();
    EXPECT_EQ(speed(), 0) << "the event of step 1 is over";
    world.step();
    EXPECT_EQ(speed(), 2) << "events of one step keep their order";
}

TYPED_TEST(Scripts, what_no_event_holds_is_misuse_while_a_world_records) {
    auto world = this->template set_up<scripts_on_a_floor>();
    Recorder<TypeParam, 4> recorder;
    world.record(&recorder);
    EXPECT_DEATH((void)world.add(sphere(1, 1)), "");
    EXPECT_DEATH((void)world.add(PlaneSpec{}), "");
    EXPECT_EQ(recorder.count(), 0);
    world.apply_impulse(BodyId{0}, {1, 0, 0});
    world.record(nullptr);
    world.apply_impulse(BodyId{0}, {1, 0, 0});
    EXPECT_EQ(recorder.count(), 1);
    const Event<TypeParam> unsorted[] = {{.body = BodyId{0}, .step = 2}, {.body = BodyId{0}, .step = 1}},
                           of_nobody[] = {{.body = BodyId{2}}};
    EXPECT_DEATH(world.set_script({unsorted, 2}), "");
    EXPECT_DEATH(world.set_script({of_nobody, 1}), "");
}

TYPED_TEST(Scripts, gravity_is_an_event_without_a_body) {
    auto world = this->template set_up<only_scripts>();
    Recorder<TypeParam, 4> recorder;
    world.record(&recorder);
    world.set_gravity({0, -2, 0});
    ASSERT_EQ(recorder.count(), 1);
    EXPECT_EQ(recorder[0].kind, EventKind::gravity);
    EXPECT_FALSE(recorder[0].body);
    EXPECT_FALSE(has_body(recorder[0].kind));
    EXPECT_STREQ(name_of(recorder[0].kind), "gravity");
    const Event<TypeParam> in_the_body = {.kind = EventKind::gravity, .frame = Frame::body};
    EXPECT_DEATH(world.apply(in_the_body), "");
    // Its body, whatever it is, is not looked at.
    std::vector<Event<TypeParam>> events;
    const std::vector<EventSpec> specs{{.kind = EventKind::gravity, .body = 77, .value = {0, 8, 0}}};
    world.set_script(prepare_sorted(events, specs, world.bodies()));
    world.step();
    EXPECT_NEAR(static_cast<double>(world.velocity(BodyId{0}).y), 8.0 / 256, 1e-6);
    EXPECT_EQ(recorder.count(), 2);
}

// Forces that begin and end, in a world that a program also controls.
template <class N, class Method = integrators::Verlet>
using Pushed = World<SceneOf<N, Method, Features{.forces = true, .control = true}>>;
BodySpec skew_top() {
    return {.mass = 2,
            .inertia = {0.2, 0.15, 0.175, 0.025, -0.0125, 0.0375},
            .position = {1, 2, 3},
            .velocity = {0.5, 0, -1},
            .angular_velocity = {0.5, -1, 0.75}};
}
template <class Kind>
class TimedForces : public testing::Test {};
using TimedForceNumbers = testing::Types<Q32<NearRange>, F32, F64>;
TYPED_TEST_SUITE(TimedForces, TimedForceNumbers);

TYPED_TEST(TimedForces, that_overlap_are_as_forces_of_each_step_and_leave_nothing) {
    struct Push {
        EventKind begin;
        Frame frame;
        RealVec3 value, point;
        int from, until;
    };
    using enum EventKind;
    const std::array pushes{Push{begin_force, Frame::world, {0.5, 1, -0.25}, {0.1, 0.2, -0.3}, 3, 90},
                            Push{begin_force, Frame::world, {-0.3, 0.1, 0.7}, {0, 0.2, 0}, 10, 60},
                            Push{begin_force, Frame::world, {3, 0.1, 0.2}, {}, 10, 11},
                            Push{begin_force, Frame::body, {0.1, 0.7, 0.3}, {0.3, 0, 0.1}, 20, 100},
                            Push{begin_force, Frame::body, {0.1, 0, -0.2}, {}, 50, 55},
                            Push{begin_torque, Frame::world, {0.1, 0, 0.3}, {}, 7, 80},
                            Push{begin_torque, Frame::body, {0, 0.1, -0.2}, {}, 30, 70}};
    Pushed<TypeParam> timed{Seconds{1, 256}}, by_hand{Seconds{1, 256}};
    const BodyId id = timed.add(skew_top());
    (void)by_hand.add(skew_top());
    std::vector<EventSpec> specs;
    for (const Push& p : pushes) {
        specs.push_back({Real{p.from} / Real{256}, p.begin, 0, p.frame, p.value, p.point});
        specs.push_back(
            {Real{p.until} / Real{256}, p.begin == begin_force ? end_force : end_torque, 0, p.frame, p.value, p.point});
    }
    std::vector<Event<TypeParam>> events;
    timed.set_script(prepare_sorted(events, specs, timed.bodies()));
    const auto distance = [&](const auto& a, const auto& b) {
        double most = 0;
        for (int i = 0; i < 3; ++i)
            most = std::max(most, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
        return most;
    };
    for (int step = 0; step < 128; ++step) {
        for (const Push& p : pushes) {
            if (step < p.from || step >= p.until) continue;
            if (p.begin == begin_force) by_hand.apply_force(id, p.value, p.frame, p.point);
            else by_hand.apply_torque(id, p.value, p.frame);
        }
        const auto v = timed.velocity(id);
        timed.step();
        by_hand.step();
        ASSERT_LE(distance(timed.velocity(id), by_hand.velocity(id)), 2e-5) << step;
        ASSERT_LE(distance(timed.angular_velocity(id), by_hand.angular_velocity(id)), 2e-5) << step;
        if (step >= 100) { ASSERT_EQ(distance(timed.velocity(id), v), 0) << step; }
    }
}

TYPED_TEST(TimedForces, whose_times_lie_between_steps_give_the_impulse_of_the_nearest_steps) {
    Pushed<TypeParam> world{Seconds{1, 256}};
    const BodyId id = world.add(skew_top());
    const RealVec3 force{64, -32, 16};
    const std::array specs{EventSpec{.time = 10.4 / 256, .kind = EventKind::begin_force, .value = force},
                           EventSpec{.time = 20.6 / 256, .kind = EventKind::end_force, .value = force}};
    std::vector<Event<TypeParam>> events(2);
    world.set_script(prepare_sorted(events, specs, world.bodies()));
    for (int step = 0; step < 32; ++step) {
        world.step();
        const int pushed = std::clamp(step - 9, 0, 11);  // in the steps 10 to 20
        const auto v = world.velocity(id);
        ASSERT_EQ(static_cast<double>(v.x), 0.5 + pushed * 0.125) << step;
        ASSERT_EQ(static_cast<double>(v.y), -pushed * 0.0625) << step;
        ASSERT_EQ(static_cast<double>(v.z), -1 + pushed * 0.03125) << step;
    }
}

TYPED_TEST(TimedForces, of_a_script_that_is_set_late_act_where_they_have_begun) {
    Pushed<TypeParam> world{Seconds{1, 256}};
    const BodyId id = world.add(skew_top());
    const std::array specs{
        EventSpec{.time = 0, .kind = EventKind::begin_force, .value = {64, 0, 0}},
        EventSpec{.time = 200.0 / 256, .kind = EventKind::end_force, .value = {64, 0, 0}},
        EventSpec{.time = 100.0 / 256, .kind = EventKind::begin_force, .value = {0, 32, 0}},
        EventSpec{.time = 300.0 / 256, .kind = EventKind::end_force, .value = {0, 32, 0}},
        EventSpec{.time = 10.0 / 256, .kind = EventKind::begin_force, .value = {0, 0, 16}},
        EventSpec{.time = 20.0 / 256, .kind = EventKind::end_force, .value = {0, 0, 16}},
    };
    std::vector<Event<TypeParam>> events;
    const auto script = prepare_sorted(events, specs, world.bodies());
    for (int step = 0; step < 150; ++step) world.step();
    // Twice is as once.
    world.set_script(script);
    world.set_script(script);
    for (int step = 150; step < 400; ++step) world.step();
    const auto v = world.velocity(id);
    EXPECT_EQ(static_cast<double>(v.x), 0.5 + 50 * 0.125);
    EXPECT_EQ(static_cast<double>(v.y), 150 * 0.0625);
    EXPECT_EQ(static_cast<double>(v.z), -1);
}

TYPED_TEST(TimedForces, go_on_in_a_script_of_later_events_alone) {
    Pushed<TypeParam> world{Seconds{1, 256}};
    const BodyId id = world.add(skew_top());
    const auto event = [&](int step, EventKind kind) {
        Event<TypeParam> e = world.prepare({.kind = kind, .value = {64, 0, 0}});
        e.step = static_cast<std::uint64_t>(step);
        return e;
    };
    const std::array pieces{event(3, EventKind::begin_force), event(9, EventKind::end_force)};
    world.set_script({&pieces[0], 1});
    for (int step = 0; step < 6; ++step) world.step();
    world.set_script({&pieces[1], 1});
    for (int step = 6; step < 20; ++step) world.step();
    EXPECT_EQ(static_cast<double>(world.velocity(id).x), 0.5 + 6 * 0.125);
}

TYPED_TEST(TimedForces, act_by_the_script_after_a_snapshot_of_bodies) {
    using Saved = World<SceneOf<TypeParam, integrators::Verlet, Features{.forces = true, .snapshots = true}>>;
    Saved world{Seconds{1, 256}}, other{Seconds{1, 256}};
    for (Saved* w : {&world, &other}) (void)w->add(skew_top());
    const std::array specs{
        EventSpec{.time = 10.0 / 256, .kind = EventKind::begin_force, .value = {64, 0, 0}},
        EventSpec{.time = 90.0 / 256, .kind = EventKind::end_force, .value = {64, 0, 0}},
        EventSpec{.time = 30.0 / 256, .kind = EventKind::begin_torque, .value = {0, 0.5, 0.25}},
        EventSpec{.time = 70.0 / 256, .kind = EventKind::end_torque, .value = {0, 0.5, 0.25}},
    };
    std::vector<Event<TypeParam>> events;
    for (Saved* w : {&world, &other}) w->set_script(prepare_sorted(events, specs, w->bodies()));
    std::vector<SavedBytes> saved;
    for (int step = 0; step < 128; ++step) {
        saved.push_back(save(world, SnapshotPart::bodies));
        world.step();
    }
    for (const std::size_t from : {5u, 40u, 80u, 100u, 20u, 0u}) {
        ASSERT_EQ(restore(other, saved[from]), SnapshotFault::none);
        for (std::size_t step = from; step < 128; ++step) other.step();
        EXPECT_EQ(other.hash(), world.hash()) << from;
    }
}

TEST(TimedForce, that_turns_a_body_beyond_its_range_is_reported) {
    for (const auto& [kind, value, point] : {std::tuple{EventKind::begin_torque, RealVec3{0, 0, 1e5}, RealVec3{}},
                                             {EventKind::begin_force, {0, 1e5, 0}, {1, 0, 0}}}) {
        for (const Frame frame : {Frame::world, Frame::body}) {
            Pushed<Q32<NearRange>> world{Seconds{1, 256}};
            (void)world.add(box(1, {1, 2, 3}));
            world.apply(world.prepare({.kind = kind, .frame = frame, .value = value, .point = point}));
            EXPECT_TRUE(world.step().has(Issue::range_left));
        }
    }
}

TEST(TimedForce, has_the_order_of_the_method) {
    const auto end_of = [](int steps) {
        Pushed<F64, integrators::Suzuki4> world{Seconds{1, steps}};
        const BodyId id = world.add(skew_top());
        world.apply(world.prepare({.kind = EventKind::begin_force, .value = {1, 2, 0.5}, .point = {0.1, 0.3, 0}}));
        world.apply(world.prepare({.kind = EventKind::begin_torque, .value = {0, 0.1, 0.2}}));
        for (int step = 0; step < steps; ++step) world.step();
        return world.angular_velocity(id);
    };
    const auto exact = end_of(1024);
    double error[2];
    for (int i = 0; i < 2; ++i) {
        const auto w = end_of(32 << i);
        error[i] = std::hypot(w.x - exact.x, w.y - exact.y, w.z - exact.z);
    }
    EXPECT_GT(error[1], 1e-12);
    EXPECT_NEAR(error[0] / error[1], 16, 2);
}

TEST(TimedForce, that_has_not_begun_ends_nothing) {
    Pushed<Q32<>> world{Seconds{1, 256}}, other{Seconds{1, 256}};
    const BodyId id = world.add(skew_top());
    (void)other.add(skew_top());
    world.set_force(id, {0, 1, 0}, Frame::world);
    other.set_force(id, {0, 1, 0}, Frame::world);
    world.apply(world.prepare({.kind = EventKind::end_force, .value = {0, 1, 0}}));
    for (int step = 0; step < 8; ++step) {
        world.step();
        other.step();
    }
    EXPECT_EQ(world.hash(), other.hash());
}

}  // namespace
}  // namespace tumble::test
