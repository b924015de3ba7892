// Loads and events through a whole world: closed forms, momentum, frames, time windows and the order of events.
#include "random.hpp"
#include "references.hpp"
#include "tolerances.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tumble::test {
namespace {

class Loads : public CaseTest {
protected:
    static bool has_drag_limit() { return std::isfinite(GetParam().method.drag_limit); }
    static bool has_oscillation_limit() {
        const double limit = GetParam().method.oscillation_limit;
        return limit > 0 && std::isfinite(limit);
    }
};
INSTANTIATE_TEST_SUITE_P(every, Loads, testing::ValuesIn(every_case()), NameOf{});

TEST_P(Loads, a_dragged_projectile_flies_its_closed_form) {
    SceneSetup setup{.name = "projectile", .bodies = {placed(sphere(2, 0.125), {}, {10, 10, 0}, {0, 0, 4})}};
    setup.world = {.gravity = {0, -9.8125, 0}, .linear_drag = 1, .angular_drag = 0.0125};
    const auto world = build(setup, GetParam());
    world->run(512);
    const Number c = 0.5L, g = 9.8125L, t = 2, e = std::exp(-c * t);
    const Vector x{10 * (1 - e) / c, (10 + g / c) * (1 - e) / c - g * t / c, 0}, v{10 * e, (10 + g / c) * e - g / c, 0};
    const Bound of_method = 20 * tolerance::method_error(order(), 1.0L / 256, 1);
    EXPECT_LE(norm(world->motion(0).x - x), of_method + 20 * tolerance::loaded_flight.of(system()));
    EXPECT_LE(norm(world->motion(0).v - v), of_method + 20 * tolerance::loaded_flight.of(system()));
    EXPECT_LE(std::abs(world->motion(0).w.z - 4 * std::exp(-t)),
              of_method + 20 * tolerance::loaded_flight.of(system()));
}

// Linear drag is the only load: methods of order two and more have no truncation error, whatever the step, and however
// fast the body turns.
TEST_P(Loads, a_body_under_linear_drag_and_constant_forces_alone_has_no_error_of_the_method) {
    if (order() < 2) GTEST_SKIP() << "order 1";
    const Vector fast = system().fixed_point ? Vector{-20, 10, 0} : Vector{-4, 2, 0};  // in parts, in fixed point
    for (const Number share : {1e-4L, 0.01L, 0.2L, 0.2499L})                           // h c/m
        for (const auto& [start, spin] :
             {std::pair{Vector{10, 10, -3}, Vector{1, 2, 4}}, std::pair{Vector{-6, 0, 2}, fast}}) {
            const Number h = 1.0L / 32, mass = 2, c = share / h, g = 9.8125L, t = 2, e = std::exp(-c * t);
            SceneSetup setup{
                .name = "projectile", .step = Seconds{1, 32}, .bodies = {placed(sphere(2, 0.125), {}, start, spin)}};
            setup.world = {.gravity = {0, -9.8125, 0}, .linear_drag = real(c * mass)};
            const auto world = build(setup, GetParam());
            world->run(64);
            const Vector end{0, -g / c, 0}, change = start - end;
            const Vector x = end * t + change * ((1 - e) / c), v = end + change * e;
            EXPECT_LE(norm(world->motion(0).x - x), 20 * tolerance::loaded_flight.of(system())) << share;
            EXPECT_LE(norm(world->motion(0).v - v), 20 * tolerance::loaded_flight.of(system())) << share;
            EXPECT_TRUE(world->status().ok());
        }
}

TEST_P(Loads, a_spring_oscillates_with_its_period) {
    SceneSetup setup{.name = "oscillator", .bodies = {placed(sphere(0.5, 0.125), {2.5, 0, 0})}};
    setup.springs = {{.to = {1, 0, 0}, .stiffness = 8, .rest_length = 1}};  // about x = 2, omega 4
    const auto world = build(setup, GetParam());
    world->run(1024);
    const Bound of_method = 2 * tolerance::method_error(order(), 4.0L / 256, 16);
    EXPECT_LE(std::abs(world->motion(0).x.x - (2 + std::cos(Number(16)) / 2)),
              of_method + 4 * tolerance::loaded_flight.of(system()));
    EXPECT_LE(std::abs(world->motion(0).v.x + 2 * std::sin(Number(16))),
              4 * of_method + 16 * tolerance::loaded_flight.of(system()));
}

TEST_P(Loads, an_orbit_closes_after_its_period_and_keeps_its_energy) {
    // About a fixed mass: a = 4 m, G M = 64: period 2 pi; eccentricity 1/4, from the perihelion.
    SceneSetup setup{.name = "orbit", .step = Seconds{1, 512}};
    setup.world.gravitation = 0.5;
    setup.bodies = {fixed(sphere(128, 0.125)), placed(sphere(1, 0.125), {3, 0, 0})};
    const Number speed = std::sqrt(64 * (2 / Number(3) - 1 / Number(4)));
    setup.bodies[1].velocity = {0, real(speed), 0};
    const auto world = build(setup, GetParam());
    world->run(3217);  // 2 pi s is 3216.99 steps
    const Number late = 3217.0L / 512 - 2 * std::acos(Number(-1));
    const Motion m = world->motion(1);
    const Bound of_method = 16 * tolerance::method_error(order(), 3.0L / 512, 12);
    const Vector expected{3 - 64 / Number(9) * late * late / 2, speed * late, 0};
    EXPECT_LE(norm(m.x - expected), of_method + 200 * tolerance::loaded_flight.of(system()));
    const Number energy = dot(m.v, m.v) / 2 - 64 / norm(m.x);
    EXPECT_LE(std::abs(energy / -8 - 1), of_method + 20 * tolerance::loaded_flight.of(system()));
    EXPECT_TRUE(world->status().ok());
}

TEST_P(Loads, a_spring_between_bodies_conserves_momentum_and_angular_momentum) {
    SceneSetup setup{.name = "pair"};
    setup.bodies = {top({3, 2, 1}, {0.25, 0.5, 0.125}, 2, {1, 0, 0}, {0, 0.5, 0.25}),
                    top({2, 1.5, 1}, {0, -0.5, 0.25}, 3, {-1, 0.5, 0}, {0.25, 0, -0.25})};
    setup.springs = {{.body = 0,
                      .point = {0.25, 0.5, 0},
                      .to_body = 1,
                      .to = {0, -0.25, 0.5},
                      .stiffness = 10,
                      .damping = 0.25,
                      .rest_length = 0.5}};
    const auto world = build(setup, GetParam());
    const auto momentum = [&] { return 2 * world->motion(0).v + 3 * world->motion(1).v; };
    const auto angular = [&] {
        const Motion a = world->motion(0), b = world->motion(1);
        return angular_momentum(a, {3, 2, 1}) + angular_momentum(b, {2, 1.5, 1}) + cross(a.x, a.v * Number(2)) +
               cross(b.x, b.v * Number(3));
    };
    const Vector p = momentum(), l = angular();
    const Vector start = world->motion(0).v;
    world->run(512);
    EXPECT_GT(norm(world->motion(0).v - start), 0.1L);
    EXPECT_LE(norm(momentum() - p), tolerance::pair_momentum.of(system()));
    EXPECT_LE(norm(angular() - l),
              8 * tolerance::method_error(order(), 3.0L / 256, 6) + 4 * tolerance::pair_momentum.of(system()));
    EXPECT_TRUE(world->status().ok());
}

TEST_P(Loads, gravitation_between_bodies_conserves_momentum_and_angular_momentum) {
    SceneSetup setup{.name = "binary", .step = Seconds{1, 128}};
    setup.world.gravitation = 2;
    setup.bodies = {placed(sphere(2, 0.125), {2, 0, 0}, {0, 1, 0}), placed(sphere(3, 0.125), {-2, 0, 0}, {0, -1, 0.25}),
                    placed(sphere(1, 0.125), {0, 6, 0}, {1, 0, 0})};
    const Number masses[] = {2, 3, 1};
    const auto world = build(setup, GetParam());
    const auto sums = [&] {
        std::pair<Vector, Vector> s;
        for (int b = 0; b < 3; ++b) {
            const Motion m = world->motion(b);
            s.first = s.first + masses[b] * m.v;
            s.second = s.second + cross(m.x, masses[b] * m.v);
        }
        return s;
    };
    const auto before = sums();
    world->run(512);
    const auto after = sums();
    EXPECT_LE(norm(after.first - before.first), tolerance::pair_momentum.of(system()));
    EXPECT_LE(norm(after.second - before.second),
              32 * tolerance::method_error(order(), 1.0L / 128, 4) + 16 * tolerance::pair_momentum.of(system()));
}

TEST_P(Loads, bodies_at_the_same_place_do_not_attract_each_other_and_are_reported) {
    SceneSetup setup{.name = "same_place"};
    setup.world = {.gravitation = 1, .contact = {.response = ContactResponse::none}};
    setup.bodies = {sphere(1, 0.5), sphere(1, 0.5)};
    const auto world = build(setup, GetParam());
    world->run(16);
    EXPECT_EQ(norm(world->motion(0).x) + norm(world->motion(1).x), 0);
    EXPECT_TRUE(world->status().has(Issue::step_too_long));  // no step is short enough to tell how they would part
}

TEST_P(Loads, a_body_frame_force_turns_with_the_body_and_a_world_frame_force_does_not) {
    // A sphere turning at pi rad/s about z, for 2 s: a force fixed in it brings it back to rest where it was displaced.
    SceneSetup setup{.name = "timed force", .step = Seconds{1, 512}};
    const Number pi = std::acos(Number(-1));
    BodySpec body = placed(sphere(2, 0.5), {}, {}, {0, 0, pi});
    setup.bodies = {body};
    setup.forces = {{.from = 0.0, .until = 10.0, .frame = Frame::body, .force = {4, 0, 0}}};
    const Bound of_method = 2 * tolerance::method_error(order(), pi / 512, 2 * pi);
    auto world = build(setup, GetParam());
    world->run(1024);
    EXPECT_LE(norm(world->motion(0).v), of_method + 2 * tolerance::loaded_flight.of(system()));
    EXPECT_LE(norm(world->motion(0).x - Vector{0, 4 / pi, 0}), of_method + 4 * tolerance::loaded_flight.of(system()));
    setup.forces[0].frame = Frame::world;
    world = build(setup, GetParam());
    world->run(1024);
    EXPECT_LE(norm(world->motion(0).v - Vector{4, 0, 0}), tolerance::loaded_flight.of(system()));
}

TEST_P(Loads, a_force_off_centre_and_a_torque_turn_the_body) {
    SceneSetup setup{.name = "torque", .bodies = {sphere(5, 0.5)}};  // moments 0.5
    setup.forces = {{.from = 0.0,
                     .until = 1.0,
                     .frame = Frame::body,
                     .force = {0, 2, 0},
                     .point = {0.25, 0, 0},
                     .torque = {0, 0, 0.5}}};
    const auto world = build(setup, GetParam());
    world->run(256);
    EXPECT_LE(norm(world->motion(0).w - Vector{0, 0, 2}), 4 * tolerance::loaded_flight.of(system()));
    setup.forces[0].frame = Frame::world;
    setup.forces[0].force = {};
    setup.bodies[0].orientation = {1, {1, 0, 0}};  // a quarter turn about x
    const auto turned = build(setup, GetParam());
    turned->run(256);
    const Motion m = turned->motion(0);
    EXPECT_LE(norm(m.q.rotate(m.w) - Vector{0, 0, 1}),
              tolerance::method_error(order(), 1.0L / 256, 1) + 4 * tolerance::loaded_flight.of(system()));
}

TEST_P(Loads, a_timed_force_acts_from_its_first_step_until_before_its_last) {
    SceneSetup setup{.name = "window", .bodies = {sphere(2, 0.5)}};
    // Steps 64 to 127 and nothing before or after; an empty window; one from step 0.
    setup.forces = {{.from = 0.25, .until = 0.5, .force = {128, 0, 0}},
                    {.from = 0.5, .until = 0.5, .force = {0, 128, 0}},
                    {.from = 0.0, .until = Real{1} / Real{256}, .force = {0, 0, 128}}};
    const auto world = build(setup, GetParam());
    for (int step = 0; step < 256; ++step) {
        world->step();
        const Vector v = world->motion(0).v;
        const int pushed = std::min(std::max(step + 1 - 64, 0), 64);
        ASSERT_LE(std::abs(v.x - static_cast<Number>(pushed) / 4), 64 * tolerance::loaded_flight.of(system())) << step;
        ASSERT_EQ(v.y, 0) << step;
        ASSERT_LE(std::abs(v.z - 0.25L), tolerance::loaded_flight.of(system())) << step;
    }
}

TEST_P(Loads, an_impulse_of_the_script_does_what_one_applied_by_hand_does) {
    SceneSetup plain{.name = "impulses"};
    plain.bodies = {top({3, 2, 1}, {0.5, 1, -0.5}, 2), sphere(1, 0.5)};
    SceneSetup scripted = plain;
    // At step 0; rounded to the nearest step; two in one step; beyond the end of another body's life in range.
    scripted.impulses = {{.time = 0.0, .body = 0, .impulse = {1, 2, 3}, .point = {0.25, 0.5, 0}},
                         {.time = 2.4 / 256, .body = 1, .impulse = {0, 1, 0}},
                         {.time = 2.6 / 256, .body = 0, .impulse = {0, 0, 1}, .point = {0, 0.5, 0}},
                         {.time = 3.0 / 256, .body = 0, .impulse = {1, 0, 0}, .point = {0, 0, 0.5}}};
    const auto timed = build(scripted, GetParam()), hand = build(plain, GetParam());
    for (int step = 0; step < 8; ++step) {
        if (step == 0) hand->apply_impulse(0, {1, 2, 3}, {0.25L, 0.5L, 0});
        if (step == 2) hand->apply_impulse(1, {0, 1, 0});
        if (step == 3) {
            hand->apply_impulse(0, {0, 0, 1}, {0, 0.5L, 0});
            hand->apply_impulse(0, {1, 0, 0}, {0, 0, 0.5L});
        }
        hand->step();
        timed->step();
        ASSERT_EQ(timed->hash(), hand->hash()) << step;
    }
}

TEST_P(Loads, impulses_set_during_a_run_replace_those_of_the_steps_to_come) {
    for (const int set : {1, 9, 30}) {
        const auto world = build(SceneSetup{.name = "late", .bodies = {sphere(2, 0.5)}}, GetParam());
        world->run(set);
        std::vector<EventSpec> impulses;
        for (const int step : {0, 8, 9, 29, 30, 31, 40})
            impulses.push_back({.time = real(step / 256.0L), .value = {1, 0, 0}});
        world->set_events(impulses);
        for (int step = set; step < 48; ++step) {
            world->step();
            const auto due = std::count_if(impulses.begin(), impulses.end(), [&](const EventSpec& i) {
                const Number at = number(i.time) * 256;
                return at >= set && at <= step;
            });
            EXPECT_LE(std::abs(world->motion(0).v.x - 0.5L * static_cast<Number>(due)),
                      tolerance::loaded_flight.of(system()))
                << set << ", " << step;
        }
    }
}

TEST_P(Loads, impulses_in_one_step_are_applied_in_the_order_of_the_script) {
    if (system().name != std::string_view{"q32_near"}) GTEST_SKIP() << "only saturation tells the order";
    SceneSetup setup{.name = "order", .bodies = {sphere(1, 0.5)}};
    setup.impulses = {{.time = 0.0, .impulse = {24, 0, 0}},
                      {.time = 0.0, .impulse = {24, 0, 0}},
                      {.time = 0.0, .impulse = {-24, 0, 0}}};
    const auto saturated = build(setup, GetParam());  // 24, held at 32, 8
    saturated->step();
    EXPECT_LE(std::abs(saturated->motion(0).v.x - 8), tolerance::saturated);
    EXPECT_TRUE(saturated->status().has(Issue::range_left));
    std::swap(setup.impulses[1], setup.impulses[2]);
    const auto within = build(setup, GetParam());  // 24, 0, 24
    within->step();
    EXPECT_LE(std::abs(within->motion(0).v.x - 24), tolerance::saturated);
    EXPECT_TRUE(within->status().ok());
}

TEST_P(Loads, a_body_frame_impulse_is_the_world_frame_impulse_turned) {
    SceneSetup setup{.name = "frames"};
    const BodySpec body = oriented(top({3, 2, 1}, {0.5, 1, -0.5}, 2), {0.9, {0.1, -0.3, 0.2}});
    setup.bodies = {body};
    const Rotation q = rotation(normalized(body.orientation));
    setup.impulses = {{.time = 0.0,
                       .frame = Frame::body,
                       .impulse = {1, 2, -1},
                       .point = {0.25, 0, 0.5},
                       .angular_impulse = {0.5, 0.25, 0}}};
    const auto in_body = build(setup, GetParam());
    setup.impulses[0].frame = Frame::world;
    setup.impulses[0].impulse = real(q.rotate({1, 2, -1}));
    setup.impulses[0].angular_impulse = real(q.rotate({0.5L, 0.25L, 0}));
    const auto in_world = build(setup, GetParam());
    in_body->step();
    in_world->step();
    EXPECT_LE(distance(in_body->motion(0), in_world->motion(0)), 4 * tolerance::impulse.of(system()));
}

TEST_P(Loads, events_keep_their_steps_when_the_step_counter_wraps) {
    constexpr int steps = 48, for_ever = std::numeric_limits<int>::max();
    const Number h = system().bits == 64 ? 0.01L : 1.0L / 128;
    // Forces of the bodies, on from a step until another; impulses at a step. `turn` is where the count begins anew.
    const auto scene = [&](std::uint64_t start, int turn) {
        const auto at = [&](int step) { return real((static_cast<Number>(start) + static_cast<Number>(step)) * h); };
        SceneSetup setup{.name = "late events", .step = Seconds{real(h)}, .start = static_cast<std::uint32_t>(start)};
        setup.bodies = {sphere(2, 0.5), sphere(0.75, 0.25)};
        const auto force = [&](int body, int from, int until, RealVec3 f) {
            setup.forces.push_back(
                {.body = body, .from = at(from), .until = until == for_ever ? Real{1e30} : at(until), .force = f});
        };
        if (start > 0) {  // what has ended long ago
            setup.forces = {{.body = 0, .from = 0, .until = real(26 * h), .force = {0, 9, 0}},
                            {.body = 1, .from = real(3 * h), .until = at(-1), .force = {0, 0, -7}}};
        }
        force(0, 0, for_ever, {1, 0, 0});
        force(1, 3, turn + 5, {0, -2, 0});
        force(0, turn - 3, turn, {0, 0, 3});
        force(1, turn, turn + 4, {4, 0, 0});
        force(0, turn + 2, turn + 9, {0, -5, 0});
        force(1, turn + 3, for_ever, {0, 0, 0.5});
        const auto impulse = [&](int body, int step, RealVec3 p) {
            setup.impulses.push_back({.time = at(step), .body = body, .impulse = p});
        };
        impulse(0, 2, {0, 0, -1});
        impulse(1, turn - 1, {0, 1, 0});
        impulse(1, turn, {0, 0, 2});
        impulse(0, turn + 5, {-3, 0, 0});
        impulse(1, turn + 31, {-1, 1, 0});
        return setup;
    };
    for (const std::uint64_t turn : {std::uint64_t{1} << 31, std::uint64_t{1} << 32}) {
        for (const int before : {4, 13}) {
            const std::uint64_t start = turn - static_cast<std::uint64_t>(before);
            const auto early = build(scene(0, before), GetParam()), late = build(scene(start, before), GetParam());
            for (int step = 0; step < steps; ++step) {
                early->step();
                late->step();
                for (int body : {0, 1}) {
                    const Motion expected = early->motion(body), got = late->motion(body);
                    ASSERT_EQ(norm(got.v - expected.v), 0) << turn << " - " << before << " + " << step << ": " << body;
                    ASSERT_EQ(norm(got.x - expected.x), 0) << turn << " - " << before << " + " << step << ": " << body;
                }
            }
        }
    }
}

class Stiff : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(every, Stiff, testing::ValuesIn(cases_of("implicit_euler")), NameOf{});

TEST_P(Stiff, implicit_euler_is_stable_and_damps_where_k_h2_over_m_is_100) {
    SceneSetup setup{.name = "stiff", .bodies = {top({0.5, 0.5, 0.5}, {}, 1, {0.0078125, 0, 0})}};
    setup.springs = {{.stiffness = 6553600}};  // k h^2 / m = 100
    const auto world = build(setup, GetParam());
    Number last = 1;
    for (int step = 0; step < 20; ++step) {
        world->step();
        const Motion m = world->motion(0);
        // |R| = 1 / sqrt(1 + z^2) with z^2 = 100, in the norm x^2 + v^2 / omega^2.
        const Number size = std::sqrt(m.x.x * m.x.x + m.v.x * m.v.x / 6553600) / 0.0078125L;
        ASSERT_LE(size - last / std::sqrt(Number(101)) * 1.01L, tolerance::stiff_floor.of(GetParam().system)) << step;
        last = size;
    }
    EXPECT_TRUE(world->status().ok()) << "first at step " << world->status().first_step;
}

TEST_P(Stiff, implicit_euler_holds_a_hanging_body_on_a_stiff_damped_spring) {
    SceneSetup setup{.name = "hanging", .bodies = {top({3, 2, 1}, {0.1, 0.2, 0.1}, 2)}};
    setup.world.gravity = {0, -10, 0};
    setup.springs = {{.point = {0, 0.5, 0}, .to = {0, 1.5, 0}, .stiffness = 1e6, .damping = 1e3, .rest_length = 1}};
    const auto world = build(setup, GetParam());
    world->run(2560);
    const Motion m = world->motion(0);
    const Vector tip = m.x + m.q.rotate({0, 0.5L, 0});
    EXPECT_LE(std::abs(norm(tip - Vector{0, 1.5L, 0}) - 1), tolerance::stiff_length.of(GetParam().system));
    EXPECT_LE(norm(m.v), 1);
    EXPECT_TRUE(world->status().ok()) << "first at step " << world->status().first_step;
}

// --- steps that are too long for a load ------------------------------------------------------------------------------

// Springs that start a millimetre from rest, and the stiffness that each needs for h w = 1.
struct StiffScene {
    const char* name;
    SceneSetup setup;
    Number per_stiffness;  // (h w)^2 / k
};
std::vector<StiffScene> stiff_scenes() {
    constexpr Number h = 1.0L / 256;
    const auto scene = [](std::vector<SpringSpec> springs) {
        SceneSetup setup{.name = "stiff",
                         .bodies = {top({0.02, 0.03, 0.04}, {}, 2, {1.001, 0, 0}), top({1, 1, 1}, {}, 0.5, {0, 4, 0})}};
        setup.springs = std::move(springs);
        return setup;
    };
    const SpringSpec to_world{.rest_length = 1};
    std::vector<StiffScene> scenes{
        {"to the world", scene({to_world}), h * h / 2},
        {"of two bodies", scene({{.body = 1, .to_body = 0, .rest_length = 4.124}}), h * h * (0.5L + 2)},
        {"with an arm across", scene({{.point = {0, 0.1, 0}, .to = {0, 0.1, 0}, .rest_length = 1}}),
         h * h * (0.5L + 0.01L / 0.04L)},
        {"with an arm along", scene({{.point = {0.1, 0, 0}, .to = {0.1, 0, 0}, .rest_length = 1}}), h * h / 2},
        {"three beside each other", scene({to_world, to_world, to_world}), 3 * h * h / 2},
        {"from both sides", scene({to_world, {.to = {2, 0, 0}, .rest_length = 1}}), 2 * h * h / 2},
        {"without a rest length", scene({{.point = {0, 0.1, 0}, .to = {1, 0.1, 0}}}), h * h * (0.5L + 0.01L / 0.02L)},
        {"in a chain",
         scene({{.body = 0, .to_body = 1, .rest_length = 4.124}, {.body = 1, .to = {0, 8, 0}, .rest_length = 4}}), 0},
    };
    // Two springs on the lighter body: x'' of it is -k (n n^T + y y^T) x / m, the other's far slower.
    const Number slant = 4 / std::sqrt(Number(17)), a = 2.5L, b = 2, both = 2 * slant;
    scenes.back().per_stiffness = h * h * ((a + b) / 2 + std::sqrt((a - b) * (a - b) / 4 + both * both));
    scenes.push_back({"to a light fixed body", scene({{.body = 0, .to_body = 1, .rest_length = 4.124}}), h * h / 2});
    scenes.back().setup.bodies[1].fixed = true;
    return scenes;
}

TEST_P(Loads, a_spring_beyond_its_step_bound_is_reported_when_it_is_added_and_no_other) {
    const Method& method = GetParam().method;
    const bool has_limit = method.oscillation_limit > 0 && std::isfinite(method.oscillation_limit);
    const Number limit = has_limit ? method.oscillation_limit : 1;
    for (const StiffScene& stiff : stiff_scenes()) {
        for (const Number share : {0.95L, 1.05L, 1.5L}) {
            for (const Number damping : {0.0L, 0.1L, 1.0L}) {  // ratio
                SceneSetup setup = stiff.setup;
                const Number k = share * share * limit * limit / stiff.per_stiffness;
                const Number w = share * limit * 256;
                for (SpringSpec& spring : setup.springs) {
                    spring.stiffness = real(k);
                    spring.damping = real(2 * damping * k / w);
                }
                const auto world = build(setup, GetParam());
                const std::string what = std::string{stiff.name} + ", " + std::to_string(static_cast<double>(share)) +
                                         " of the limit, damping " + std::to_string(static_cast<double>(damping));
                if (has_limit && damping == 0) {
                    EXPECT_EQ(world->status().has(Issue::step_too_long), share > 1) << what;
                }
                if (!has_limit && method.oscillation_limit > 0) { EXPECT_TRUE(world->status().ok()) << what; }
                Number furthest = 0;
                for (int i = 0; i < 60 && std::isfinite(method.oscillation_limit); ++i) {
                    world->step();
                    for (int b = 0; b < 2; ++b)
                        furthest = std::max(furthest, norm(world->motion(b).x -
                                                           vector(setup.bodies[static_cast<std::size_t>(b)].position)));
                    if (!(furthest < 0.5L)) break;
                }
                const bool blew_up = !(furthest < 0.5L);
                EXPECT_FALSE(blew_up && world->status().ok()) << what;
            }
        }
    }
}

// A spring without a rest length pulls as hard across itself, where its damper does nothing.
TEST_P(Loads, growth_across_a_damped_spring_is_reported_for_methods_that_add_to_every_oscillation) {
    const bool adds = GetParam().method.oscillation_limit == 0;
    for (const auto& [k, c] : {std::pair{20000.0L, 40.0L}, std::pair{12000.0L, 4.0L}}) {
        for (const Vector along : {Vector{1, 0, 0}, {0, -0.6L, 0.8L}}) {
            SceneSetup setup{.name = "damped"};
            setup.world.contact.response = ContactResponse::none;
            setup.bodies = {placed(sphere(1, 0.25), along * 0.5L)};
            setup.springs = {{.body = 0, .stiffness = real(k), .damping = real(c)}};
            const auto world = build(setup, GetParam());
            EXPECT_EQ(world->status().has(Issue::step_too_long), adds) << k << " N/m, " << c << " N s/m";
        }
    }
}

// The damper acts on the centre of mass, or on a point across from it.
TEST_P(Loads, a_damper_beyond_its_step_bound_is_reported_when_it_is_added_and_no_other) {
    const Method& method = GetParam().method;
    if (!std::isfinite(method.drag_limit) || !std::isfinite(method.oscillation_limit)) GTEST_SKIP() << "no limit";
    for (const Number share : {0.9L, 0.97L, 1.03L, 1.5L}) {
        for (const Number arm : {0.0L, 0.1L}) {
            SceneSetup setup{.name = "damper", .bodies = {top({0.02, 0.03, 0.04}, {}, 2)}};
            const Number moved = 0.5L + arm * arm / 0.04L;  // by a force of 1
            setup.springs = {{.point = {0, real(arm), 0},
                              .to = {1, real(arm), 0},
                              .damping = real(share * method.drag_limit * 256 / moved),
                              .rest_length = 1}};
            EXPECT_EQ(build(setup, GetParam())->status().has(Issue::step_too_long), share > 1) << share << ", " << arm;
        }
    }
}

// The ends coincide, as in a hinge, or the damper has no rest length: it acts along whatever way they part.
TEST_P(Loads, a_damper_of_a_hinge_is_checked_at_its_full_length) {
    const Method& method = GetParam().method;
    if (!std::isfinite(method.drag_limit) || !std::isfinite(method.oscillation_limit)) GTEST_SKIP() << "no limit";
    for (const Number share : {0.9L, 0.97L, 1.03L, 1.5L, 20.0L}) {
        for (const Number arm : {0.0L, 0.125L}) {
            for (const Number rest_length : {0.0L, 1.0L}) {
                SceneSetup setup{.name = "hinge", .bodies = {top({0.02, 0.03, 0.04}, {}, 2)}};
                const Number moved = 0.5L + arm * arm / 0.02L;  // by a force of 1 across the arm, where it moves most
                setup.springs = {{.point = {0, real(arm), 0},
                                  .to = {0, real(arm), 0},
                                  .damping = real(share * method.drag_limit * 256 / moved),
                                  .rest_length = real(rest_length)}};
                EXPECT_EQ(build(setup, GetParam())->status().has(Issue::step_too_long), share > 1)
                    << share << ", " << arm << ", " << rest_length;
            }
        }
        for (const Vector along : {Vector{1, 0, 0}, {0.6L, 0, -0.8L}, {2 / 7.0L, -3 / 7.0L, 6 / 7.0L}}) {
            SceneSetup setup{.name = "slant", .bodies = {top({0.02, 0.03, 0.04}, {}, 2)}};
            setup.springs = {{.to = real(along), .damping = real(share * method.drag_limit * 256 * 2)}};
            EXPECT_EQ(build(setup, GetParam())->status().has(Issue::step_too_long), share > 1) << share;
        }
    }
}

// Enough damping along a spring undoes what a method adds to every oscillation.
TEST_P(Loads, a_damped_spring_whose_motion_dies_away_is_not_reported) {
    if (!std::isfinite(GetParam().method.oscillation_limit)) GTEST_SKIP() << "adds to nothing";
    for (const Number wh : {0.1L, 0.2L, 0.4L}) {
        for (const Vector along : {Vector{1, 0, 0}, {0, -0.6L, 0.8L}}) {
            SceneSetup setup{.name = "damped", .bodies = {top({1, 1, 1}, {}, 2, along * 1.01L)}};
            const Number w = wh * 256;
            setup.springs = {{.stiffness = real(2 * w * w),
                              .damping = real(2 * 0.5L * 2 * w),
                              .rest_length = 1}};  // half of critical
            const auto world = build(setup, GetParam());
            world->run(256);
            EXPECT_TRUE(world->status().ok()) << wh;
            EXPECT_LE(std::abs(norm(world->motion(0).x) - 1), tolerance::stiff_length.of(GetParam().system)) << wh;
        }
    }
}

// A body on a spring with (h w)^2 = K. A damper and drag beside the spring take the given shares of its speed in a
// step. A spring is checked together with those before it, so the stiff one is the last.
SceneSetup damped_beside(Number K, Number damper, Number drag, Number mass) {
    SceneSetup setup{.name = "beside", .bodies = {top({1, 2, 2.5}, {}, real(mass), {0.1, 0, 0})}};
    setup.world.linear_drag = real(drag * mass * 256);
    setup.springs = {{.to = {0.35, 0, 0}, .stiffness = 1e-3, .damping = real(damper * mass * 256), .rest_length = 0.25},
                     {.to = {0, 0, 0}, .stiffness = real(K * mass * 256 * 256), .rest_length = 0.09375}};
    return setup;
}
TEST_P(Loads, growth_that_other_damping_removes_is_not_reported) {
    if (GetParam().method.oscillation_limit > 0) GTEST_SKIP() << "does not add to every oscillation";
    for (const Number K : {0.14L, 0.17L}) {
        for (const Number mass : {0.5L, 3.0L}) {
            const Number undone = 1.5L * (order() > 1 ? K * K / 4 : K);
            EXPECT_TRUE(build(damped_beside(K, 0, 0, mass), GetParam())->status().has(Issue::step_too_long));
            EXPECT_TRUE(build(damped_beside(K, undone, 0, mass), GetParam())->status().ok());
            EXPECT_TRUE(build(damped_beside(K, 0, undone, mass), GetParam())->status().ok());
        }
    }
}
TEST_P(Loads, damping_and_drag_that_are_too_strong_together_are_reported) {
    const Method& method = GetParam().method;
    if (!has_drag_limit()) GTEST_SKIP() << "no limit";
    for (const Number share : {0.35L, 0.6L}) {
        for (const Number mass : {0.5L, 3.0L}) {
            const Number C = share * method.drag_limit;
            EXPECT_EQ(build(damped_beside(1e-3L, C, C, mass), GetParam())->status().has(Issue::step_too_long),
                      share > 0.5L);
            EXPECT_TRUE(build(damped_beside(1e-3L, C, 0, mass), GetParam())->status().ok());
        }
    }
}

TEST_P(Loads, springs_that_hold_a_body_along_three_axes_are_checked_axis_by_axis) {
    const Method& method = GetParam().method;
    if (!has_oscillation_limit()) GTEST_SKIP() << "no limit";
    for (const Vector turn : {Vector{}, {0.3L, -0.5L, 0.4L}}) {
        for (const Number share : {0.97L, 1.03L}) {
            SceneSetup setup{.name = "three axes", .bodies = {top({1, 2, 2.5}, {}, 2)}};
            const Number w = share * method.oscillation_limit * 256;
            for (const Vector axis : {Vector{1, 0, 0}, {0, -1, 0}, {0, 0, 1}})
                setup.springs.push_back(
                    {.to = real(exponential(turn).rotate(axis)), .stiffness = real(2 * w * w), .rest_length = 0.75});
            EXPECT_EQ(build(setup, GetParam())->status().has(Issue::step_too_long), share > 1) << share;
        }
    }
}

// Two bodies and three springs between two walls: 3 k/m is the stiffest motion's. A pull of the middle spring has that
// with all three springs, and 5/2 k/m where the last one is missing.
TEST_P(Loads, a_chain_of_springs_is_reported_by_the_pull_of_its_newest_spring_and_never_falsely) {
    const Method& method = GetParam().method;
    if (!has_oscillation_limit()) GTEST_SKIP() << "no limit";
    for (const bool middle_last : {true, false}) {
        for (const Number share : {0.98L, 1.02L, 1.12L}) {
            SceneSetup setup{.name = "chain"};
            setup.world.contact.response = ContactResponse::none;
            setup.bodies = {placed(sphere(1, 0.125), {1, 0, 0}), placed(sphere(1, 0.125), {2, 0, 0})};
            const Number w = share * method.oscillation_limit * 256;
            const SpringSpec link{.stiffness = real(w * w / 3), .rest_length = 1};
            setup.springs = {link, link, link};
            SpringSpec &middle = setup.springs[middle_last ? 2 : 1], &last = setup.springs[middle_last ? 1 : 2];
            middle.to_body = 1;
            last.body = 1;
            last.to = {3, 0, 0};
            EXPECT_EQ(build(setup, GetParam())->status().has(Issue::step_too_long), share > (middle_last ? 1 : 1.1L))
                << middle_last << ", " << share;
        }
    }
}

TEST_P(Loads, a_spring_added_after_the_first_steps_is_checked_too) {
    const Method& method = GetParam().method;
    if (!has_oscillation_limit()) GTEST_SKIP() << "no limit";
    for (const Number share : {0.97L, 1.03L}) {
        SceneSetup setup{.name = "late",
                         .bodies = {top({1, 2, 2.5}, {}, 2, {1, 0, 0}), top({1, 2, 2.5}, {}, 0.5, {1, 2, 0})}};
        setup.springs = {{.stiffness = 1, .rest_length = 1}};
        const auto world = build(setup, GetParam());
        world->run(100);
        EXPECT_TRUE(world->status().ok());
        const Number w = share * method.oscillation_limit * 256;
        EXPECT_TRUE(world->add({.body = 1, .to_body = 0, .stiffness = real(w * w / 2.5L), .rest_length = 2}));
        EXPECT_EQ(world->status().has(Issue::step_too_long), share > 1) << share;
        if (share > 1) { EXPECT_EQ(world->status().first_step, 100u); }
    }
}

// Whichever of the bodies and of the springs comes first; a fixed end is not the one.
TEST_P(Loads, a_spring_beyond_its_step_bound_is_reported_with_a_body_that_it_moves) {
    if (!has_drag_limit()) GTEST_SKIP() << "no limit";
    for (const bool to_fixed : {false, true}) {
        for (const int stiff : {0, 1}) {
            for (const bool stiff_first : {false, true}) {
                SceneSetup setup{.name = "two springs"};
                setup.world.contact.response = ContactResponse::none;
                setup.bodies = {sphere(1, 0.125), placed(sphere(1, 0.125), {4, 0, 0}),
                                fixed(placed(sphere(1, 0.125), {2, 2, 0}))};
                for (const bool is_stiff : {stiff_first, !stiff_first}) {
                    const int body = is_stiff ? stiff : 1 - stiff;
                    SpringSpec spring{.body = body,
                                      .to = {body == 0 ? 0.0 : 4.0, 0.25, 0},
                                      .stiffness = is_stiff ? 1024.0 * 1024 : 1,  // h w = 4, beyond every limit
                                      .rest_length = 0.25};
                    if (to_fixed) {
                        spring.body = 2;
                        spring.to_body = body;
                        spring.to = {};
                        spring.rest_length = 2.8125;
                    }
                    setup.springs.push_back(spring);
                }
                const auto world = build(setup, GetParam());
                EXPECT_TRUE(world->status().has(Issue::step_too_long)) << to_fixed;
                EXPECT_EQ(world->status().first_body, stiff) << to_fixed << stiff_first;
            }
        }
    }
}

// A fixed body attracts by its mass, and is not moved by the other's.
TEST_P(Loads, the_mass_of_a_free_body_does_not_make_it_too_near_to_a_fixed_body) {
    for (const bool fixed_first : {true, false}) {
        SceneSetup setup{.name = "fixed"};
        setup.world = {.gravitation = 0.01, .contact = {.response = ContactResponse::none}};
        setup.bodies = {fixed(sphere(1, 0.125)), placed(sphere(3e6, 0.125), {0.5, 0, 0})};
        if (!fixed_first) std::swap(setup.bodies[0], setup.bodies[1]);
        const auto world = build(setup, GetParam());
        world->run(16);
        EXPECT_TRUE(world->status().ok()) << fixed_first;
        setup.bodies[fixed_first ? 0 : 1].mass = 3e6;
        const auto heavy = build(setup, GetParam());
        heavy->run(1);
        EXPECT_TRUE(heavy->status().has(Issue::step_too_long)) << fixed_first;
    }
}

TEST_P(Loads, drag_beyond_its_step_bound_is_reported_and_no_other) {
    const Method& method = GetParam().method;
    if (!has_drag_limit()) GTEST_SKIP() << "no limit";
    for (const Number share : {0.9L, 1.1L}) {
        for (const bool turns : {false, true}) {
            SceneSetup setup{.name = "drag", .bodies = {top({0.5, 0.25, 0.4}, {}, 2)}};
            const Real strength = real(share * method.drag_limit * 256);
            if (turns) setup.world.angular_drag = strength * Real{0.25};
            else setup.world.linear_drag = strength * Real{2};
            EXPECT_EQ(build(setup, GetParam())->status().has(Issue::step_too_long), share > 1) << share;
            setup.bodies[0].fixed = true;
            EXPECT_TRUE(build(setup, GetParam())->status().ok());
        }
    }
}

TEST_P(Loads, bodies_that_fall_into_each_other_are_reported_when_their_energy_is_wrong) {
    if (order() < 2) GTEST_SKIP() << "does not keep an orbit's energy";
    for (const int count : {2, 3}) {
        for (const Number sideways : {0.0L, 0.05L, 0.8L}) {
            for (const Number apart : {1.0L, 1.3L}) {
                SceneSetup setup{.name = "fall"};
                setup.world.gravitation = 1;
                for (int b = 0; b < count; ++b) {
                    const Number angle = 2 * std::acos(Number(-1)) * b / count, r = apart / 2;
                    setup.bodies.push_back(top({1, 1, 1}, {}));
                    setup.bodies.back().position = real(Vector{r * std::cos(angle), r * std::sin(angle), 0});
                    setup.bodies.back().velocity =
                        real(Vector{-sideways * std::sin(angle), sideways * std::cos(angle), 0});
                }
                const auto world = build(setup, GetParam());
                const auto energy = [&] {
                    Number sum = 0;
                    for (int a = 0; a < count; ++a) {
                        sum += dot(world->motion(a).v, world->motion(a).v) / 2;
                        for (int b = 0; b < a; ++b) sum -= 1 / norm(world->motion(a).x - world->motion(b).x);
                    }
                    return sum;
                };
                const Number start = energy();
                bool is_lost = false;
                for (int i = 0; i < 768; ++i) {
                    world->step();
                    is_lost |= std::abs(energy() / start - 1) > 0.5L;
                }
                EXPECT_FALSE(is_lost && world->status().ok()) << count << " bodies, " << sideways << " m/s";
                EXPECT_EQ(world->status().has(Issue::step_too_long), sideways < 0.5L) << count << " " << sideways;
            }
        }
    }
}

TEST_P(Loads, a_spring_pulls_the_right_way_across_the_whole_range) {
    if (!system().fixed_point) GTEST_SKIP() << "floating point has no ends";
    Random random{5};
    const double end = system().name == std::string_view{"q32_field"} ? 32768 : 64;
    for (int trial = 0; trial < 10; ++trial) {
        SceneSetup setup{.name = "wide", .bodies = {top({1, 1, 1}, {})}};
        RealVec3 anchor;
        for (int i = 0; i < 3; ++i) {
            setup.bodies[0].position[i] = random.uniform(-0.98, 0.98) * end;
            anchor[i] = trial < 2 ? (trial == 0 ? end : -end) : random.uniform(-1, 1) * end;
        }
        setup.springs = {{.to = anchor, .stiffness = 0.1, .rest_length = random.uniform(0, 1)}};
        const auto world = build(setup, GetParam()), truth = build(setup, GetParam().method.name, "f64");
        world->run(4);
        truth->run(4);
        EXPECT_LE(norm(world->motion(0).v - truth->motion(0).v),
                  tolerance::wide_spring.of(system()) * norm(truth->motion(0).v))
            << trial;
    }
}

}  // namespace
}  // namespace tumble::test
