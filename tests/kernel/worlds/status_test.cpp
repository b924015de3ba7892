// The status names each failure, its body and its step: a range that is left, a number that is not finite, a world that
// is full.
#include "references.hpp"
#include "tolerances.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <iterator>
#include <set>

namespace tumble::test {
namespace {

class Fixed32 : public testing::TestWithParam<Case> {};
bool is_in_the_smallest_range(const Case& c) {
    return c.system.name == std::string_view{"q32_near"} || c.system.name == std::string_view{"q32_plain"};
}
INSTANTIATE_TEST_SUITE_P(near, Fixed32, testing::ValuesIn(cases_where(is_in_the_smallest_range)), NameOf{});

// Three spheres that do not touch each other; NearRange holds 64 m, 32 m/s, 32 rad/s.
SceneSetup three_spheres() {
    SceneSetup setup{.name = "three_spheres"};
    setup.world.contact.response = ContactResponse::none;
    setup.bodies = {sphere(1, 0.5), sphere(1, 0.5), sphere(1, 0.5)};
    return setup;
}

TEST_P(Fixed32, a_position_that_leaves_its_range_is_held_at_the_limit_and_reported) {
    SceneSetup setup = three_spheres();
    setup.bodies[1] = placed(sphere(1, 0.5), {0, 63, 0}, {0, 16, 0});  // 1/16 m a step: out after 16 steps, at 64 m
    setup.bodies[2].velocity = {-32, 0, 0};                            // out after 512
    const auto world = build(setup, GetParam());
    EXPECT_TRUE(world->run(15).ok());
    world->run(2);
    const Status status = world->status();
    EXPECT_TRUE(status.has(Issue::range_left));
    EXPECT_EQ(status.first_body, 1);
    EXPECT_EQ(status.first_step, 15u);
    world->run(600);
    EXPECT_LE(std::abs(world->motion(1).x.y - 64), tolerance::saturated);
    EXPECT_LE(std::abs(world->motion(2).x.x + 64), tolerance::saturated);
    EXPECT_EQ(world->status().first_body, 1);  // sticky: the first
    EXPECT_EQ(world->status().first_step, 15u);
    EXPECT_GT(world->status().count, 600);
    world->clear_status();
    EXPECT_TRUE(world->status().ok());
}

TEST_P(Fixed32, the_step_that_left_the_range_is_reported_wherever_the_step_counter_starts) {
    for (const std::uint32_t start : {0x7ffffff8u, 0xfffffff1u, 0xfffffff0u, 0xffffffeeu}) {
        SceneSetup setup = three_spheres();
        setup.start = start;
        setup.bodies[2] = placed(sphere(1, 0.5), {0, 0, 63}, {0, 0, 16});  // 1/16 m a step: out after 16 steps
        const auto world = build(setup, GetParam());
        EXPECT_TRUE(world->run(15).ok());
        world->run(2);
        EXPECT_EQ(world->status().first_body, 2);
        EXPECT_EQ(world->status().first_step, start + 15u);
    }
}

TEST_P(Fixed32, a_velocity_that_leaves_its_range_is_held_at_the_limit_and_reported) {
    SceneSetup setup = three_spheres();
    setup.world.gravity = {0, -512, 0};  // 2 m/s a step
    setup.bodies[0].fixed = setup.bodies[1].fixed = true;
    const auto world = build(setup, GetParam());
    EXPECT_TRUE(world->run(15).ok());  // 30 m/s
    world->run(2);                     // 32 m/s is the end of the range, 34 is out
    EXPECT_EQ(world->status().first_body, 2);
    EXPECT_EQ(world->status().first_step, 16u);
    EXPECT_LE(std::abs(world->motion(2).v.y + 32), tolerance::saturated);
}

TEST_P(Fixed32, an_impulse_of_any_strength_saturates_and_is_reported_at_once) {
    for (const Number strength : {40.0L, 1e3L, 1e6L, 1e12L, 1e30L}) {
        const auto world = build(three_spheres(), GetParam());
        world->run(3);
        world->apply_impulse(1, {0, -strength, 0});
        EXPECT_TRUE(world->status().has(Issue::range_left)) << strength;
        EXPECT_EQ(world->status().first_body, 1);
        EXPECT_EQ(world->status().first_step, 3u);
        EXPECT_LE(std::abs(world->motion(1).v.y + 32), tolerance::saturated) << strength;
    }
}

TEST_P(Fixed32, an_impulse_beyond_the_range_is_reported_in_both_directions) {
    for (const Number before : {-30.0L, -16.0L, 0.0L, 16.0L, 30.0L}) {
        for (const Number impulse : {-1e6L, -100.0L, -60.0L, -40.0L, 40.0L, 60.0L, 100.0L, 1e6L}) {
            SceneSetup setup = three_spheres();
            setup.bodies[0].velocity = {0, real(before), 0};
            const auto world = build(setup, GetParam());
            world->apply_impulse(0, {0, impulse, 0});
            const Number exact = before + impulse, got = world->motion(0).v.y;
            if (std::abs(exact) > 32) {
                EXPECT_TRUE(world->status().has(Issue::range_left))
                    << before << " m/s and " << impulse << " N s give " << got;
                // Held at the end that it left by.
                EXPECT_LE(std::abs(got - std::copysign(Number(32), exact)), 1e-6L)
                    << before << " m/s and " << impulse << " N s give " << got;
            } else {
                EXPECT_TRUE(std::abs(got - exact) < 1e-3L || !world->status().ok())
                    << before << " m/s and " << impulse << " N s give " << got;
            }
        }
    }
}

TEST_P(Fixed32, a_spin_beyond_its_range_is_reported_or_still_right_for_every_body) {
    // Formats may hold more than the range declares, for bodies that are easy to turn about one axis much more.
    const RealVec3 inertias[] = {{1, 1, 1}, {1, 2, 3}, {1, 1, 1.99}, {1, 1, 0.25}, {1, 1, 1e-2}, {1, 1, 1e-5}};
    for (const RealVec3& moments : inertias) {
        for (int axis = 0; axis < 3; ++axis) {
            for (const Number spin : {40.0L, 63.0L, 100.0L, 130.0L, 200.0L, 333.0L, 1000.0L, 3333.0L, 1e5L}) {
                const auto world = build(SceneSetup{.name = "spin", .bodies = {top(moments, {})}}, GetParam());
                // A couple about the axis, as two impulses.
                Vector impulse{}, point{};
                impulse[(axis + 1) % 3] = number(moments[axis]) * spin / 2;
                point[(axis + 2) % 3] = -1;
                world->apply_impulse(0, impulse, point);
                point[(axis + 2) % 3] = 1;
                world->apply_impulse(0, -impulse, point);
                world->step();
                if (world->status().has(Issue::range_left)) continue;
                Vector w{};
                w[axis] = spin;
                const Motion m = world->motion(0);
                EXPECT_LE(norm(m.w - w), 1e-3L * spin) << "moments " << number(moments.x) << " " << number(moments.y)
                                                       << " " << number(moments.z) << ", axis " << axis;
                // A first-order method turns by the tangent of the angle; a wrapped sine is far from either.
                const Number angle = spin / 256;
                EXPECT_LE(angle_between(m.q, exponential(w * (1.0L / 256))), 0.5L * std::min(angle, 6.0L) + 1e-3L)
                    << "moments " << number(moments.x) << " " << number(moments.y) << " " << number(moments.z) << ", "
                    << spin << " rad/s about axis " << axis;
            }
        }
    }
}

// Friction spins a ball within a step to more than it has at the end of it.
TEST_P(Fixed32, a_ball_that_starts_to_roll_turns_by_its_spin_or_is_reported) {
    constexpr Number h = 1.0L / 32, radius = 0.14L;
    for (int direction = 0; direction < 64; ++direction) {
        for (Number speed = 1.5L; speed < 2.3L; speed *= 1.01L) {
            SceneSetup setup{.name = "ball", .step = Seconds{1, 32}};
            setup.world = {.gravity = {0, -7.1, 0}, .contact = {.restitution = 0, .friction = 0.6}};
            setup.planes = {{}};
            setup.bodies = {placed(sphere(3, real(radius)), {0, radius, 0})};
            const Number angle = direction * 0.09817477L;
            setup.bodies[0].velocity = real(Vector{speed * std::cos(angle), 0, speed * std::sin(angle)});
            const auto world = build(setup, GetParam());
            Motion before = world->motion(0);
            for (int step = 0; step < 6; ++step) {
                world->step();
                if (!world->status().ok()) break;
                const Motion now = world->motion(0);
                const Rotation turned = before.q * exponential((before.w + now.w) * (h / 2));
                ASSERT_LE(angle_between(turned, now.q), 0.125L)
                    << speed << " m/s, direction " << direction << ", step " << step;
                before = now;
            }
        }
    }
}

TEST_P(Fixed32, gravity_beyond_the_format_is_reported) {
    for (const double gravity : {1e4, 1e5, 1e6, 1e9}) {
        SceneSetup setup = three_spheres();
        setup.world.gravity = {0, -gravity, 0};
        const auto world = build(setup, GetParam());
        EXPECT_TRUE(world->step().has(Issue::range_left)) << gravity;
    }
}

TEST_P(Fixed32, a_start_outside_the_range_is_reported_by_the_first_step) {
    for (const Real& x : {Real{65}, Real{100}, Real{200}, Real{-1e6}}) {
        SceneSetup setup = three_spheres();
        setup.bodies[0].position = {x, 0, 0};
        EXPECT_TRUE(build(setup, GetParam())->step().has(Issue::range_left)) << number(x);
        setup.bodies[0].position = {};
        setup.bodies[0].velocity = {0, x, 0};
        EXPECT_TRUE(build(setup, GetParam())->step().has(Issue::range_left)) << number(x);
    }
}

// Floating point says when the true motion leaves the range; fixed point must have said so by then.
TEST_P(Fixed32, a_load_that_drives_a_body_out_of_range_never_passes_silently) {
    for (const double stiffness : {1e2, 1e4, 3e5, 1e7, 1e10, 1e15}) {
        SceneSetup setup{.name = "explosion", .bodies = {placed(sphere(1, 0.5), {1, 0, 0})}};
        setup.springs = {{.stiffness = stiffness}};
        const auto world = build(setup, GetParam());
        const auto truth = build(setup, GetParam().method.name, "f64");
        for (int i = 0; i < 400; ++i) {
            world->step();
            truth->step();
            const Motion m = truth->motion(0);
            if (std::abs(m.x.x) < 66 && std::abs(m.v.x) < 33) continue;
            EXPECT_TRUE(world->status().has(Issue::range_left)) << "stiffness " << stiffness << ", step " << i << ", x "
                                                                << m.x.x << " against " << world->motion(0).x.x;
            break;
        }
    }
}

class Floating : public testing::TestWithParam<Case> {};
bool is_floating(const Case& c) { return !c.system.fixed_point; }
INSTANTIATE_TEST_SUITE_P(every, Floating, testing::ValuesIn(cases_where(is_floating)), NameOf{});

TEST_P(Floating, a_motion_that_is_not_finite_is_reported) {
    const bool f32 = GetParam().system.bits == 32;
    SceneSetup setup = three_spheres();
    setup.world.gravity = {0, f32 ? -3e38 : -1e308, 0};
    setup.step = Seconds{4, 1};
    setup.bodies[0].fixed = true;
    const auto world = build(setup, GetParam());
    world->run(8);
    EXPECT_TRUE(world->status().has(Issue::range_left));
    EXPECT_EQ(world->status().first_body, 1);
}

TEST_P(Floating, a_huge_spin_is_reported_and_its_step_ends) {
    const bool f32 = GetParam().system.bits == 32;
    for (const Number spin : {1e3L, 1e10L, f32 ? 1e25L : 1e200L, f32 ? 3e37L : 1e307L}) {
        SceneSetup setup{.name = "spin", .bodies = {top({1, 2, 3}, {})}};
        const auto steps = [&] {
            alarm(10);  // a step that does not end fails here
            const auto world = build(setup, GetParam());
            for (int i = 0; i < 4; ++i) {
                world->apply_impulse(0, {0, 0, spin}, {1, 1, 0});
                world->step();
            }
            const Motion m = world->status().ok() ? world->motion(0) : Motion{};
            std::exit(std::isfinite(norm(m.w)) && std::isfinite(m.q.norm2()) ? 0 : 1);
        };
        EXPECT_EXIT(steps(), testing::ExitedWithCode(0), "") << spin;
    }
}

// Whatever a body's moments and spin, and whether it moves or turns in its place: as long as the status is ok, its
// numbers are finite and its orientation is one.
TEST_P(Floating, an_orientation_that_loses_its_unit_length_is_reported_by_that_step) {
    const RealVec3 inertias[] = {{1, 1, 1}, {1, 2, 3}, {3, 1, 2.5}, {1, 1, 1.99}, {0.01, 1, 1}};
    for (const RealVec3& moments : inertias) {
        for (const bool fixed : {false, true}) {
            for (const Number angle : {0.3L, 0.5L, 1.0L, 2.0L, 3.0L, 6.0L, 12.0L, 1e4L}) {  // of a step, rad
                SceneSetup setup{.name = "spin", .step = Seconds{1, 16}};
                const Vector w = Vector{0.05L, 1, -0.02L} * (16 * angle);
                setup.bodies = {top(moments, real(w))};
                setup.bodies[0].fixed = fixed;
                const auto world = build(setup, GetParam());
                for (int i = 0; i < 200 && world->step().ok(); ++i) {
                    const Motion m = world->motion(0);
                    ASSERT_LE(std::abs(std::sqrt(m.q.norm2()) - 1), tolerance::unit_while_ok)
                        << angle << " rad a step, step " << i << (fixed ? ", fixed" : "");
                    ASSERT_TRUE(std::isfinite(norm(m.x)) && std::isfinite(norm(m.v)) && std::isfinite(norm(m.w)));
                }
                const bool is_exact = GetParam().method.name == std::string_view{"exact"};
                if (is_exact && angle < 100) {
                    EXPECT_TRUE(world->status().ok()) << "exact follows " << angle << " rad a step";
                } else if (!is_exact && angle > 3.5L && moments.y >= moments.x) {
                    EXPECT_FALSE(world->status().ok()) << angle << " rad a step" << (fixed ? ", fixed" : "");
                }
            }
        }
    }
}

TEST_P(Floating, a_speed_or_spin_that_is_not_finite_is_reported_at_once) {
    const bool f32 = GetParam().system.bits == 32;
    const Number huge = f32 ? 3e38L : 1e308L;
    SceneSetup setup{.name = "push", .step = Seconds{1, 4}};
    setup.bodies = {top({1, 2, 3}, {}), top({1e-3, 2e-3, 2.5e-3}, {}, 1e-3)};
    for (const Vector point : {Vector{}, Vector{0, 0, 1}}) {
        const auto world = build(setup, GetParam());
        world->apply_impulse(0, {1, 2, 0}, point);
        EXPECT_TRUE(world->status().ok());
        world->apply_impulse(1, {huge, huge, 0}, point);
        EXPECT_TRUE(world->status().has(Issue::range_left));
        EXPECT_EQ(world->status().first_body, 1);
    }
    setup.step = Seconds{16, 1};
    setup.bodies.pop_back();
    setup.bodies[0].velocity = {0, real(huge), 0};
    EXPECT_TRUE(build(setup, GetParam())->status().has(Issue::range_left));
    setup.bodies[0].velocity = {};
    EXPECT_TRUE(build(setup, GetParam())->status().ok());
    setup.bodies[0].angular_velocity = {0, 0, real(huge)};
    EXPECT_TRUE(build(setup, GetParam())->status().has(Issue::range_left));
}

TEST(status, a_full_world_adds_nothing_and_reports_it) {
    SceneSetup setup = three_spheres();
    for (const Case& c : every_case()) {
        const auto world = build(setup, c);
        for (int i = 3; i < everything.bodies; ++i) EXPECT_TRUE(world->add(sphere(1, 1)));
        EXPECT_TRUE(world->status().ok());
        EXPECT_FALSE(world->add(sphere(1, 1)));
        EXPECT_TRUE(world->status().has(Issue::world_full));
        EXPECT_EQ(world->body_count(), everything.bodies);
        for (int i = 0; i < everything.planes; ++i) EXPECT_TRUE(world->add(PlaneSpec{}));
        EXPECT_FALSE(world->add(PlaneSpec{}));
        for (int i = 0; i < everything.springs; ++i) EXPECT_TRUE(world->add(SpringSpec{}));
        EXPECT_FALSE(world->add(SpringSpec{}));
    }
}

TEST(status, counts_occurrences_keeps_the_first_and_never_wraps) {
    Status status;
    EXPECT_TRUE(status.ok());
    status.set(Issue::contacts_full, 3, 70000);
    status.set(Issue::range_left, 4, 70001);
    EXPECT_TRUE(status.has(Issue::contacts_full) && status.has(Issue::range_left) && !status.has(Issue::world_full));
    EXPECT_EQ(status.first_body, 3);
    EXPECT_EQ(status.first_step, 70000u);
    EXPECT_EQ(status.count, 2);
    for (int i = 0; i < 100000; ++i) status.set(Issue::range_left, 0, 0);
    EXPECT_EQ(status.count, 65535);
    Status of_many;
    of_many.set(Issue::range_left, 300, 1);
    EXPECT_EQ(of_many.first_body, 255);
    std::set<std::string_view> names;
    for (const Issue issue : all_issues) names.insert(name_of(issue));
    EXPECT_EQ(names.size(), std::size(all_issues));
    EXPECT_TRUE(names.contains("step_too_long") && names.contains("contacts_full"));
}

}  // namespace
}  // namespace tumble::test
