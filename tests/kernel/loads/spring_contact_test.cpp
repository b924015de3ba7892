// Contacts by springs: what a bounce takes and leaves, with and without damping, behind a barrier, and up to which
// step.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

constexpr Number step = 1.0L / 1024;  // s, of scenes that do not say otherwise

// A floor of springs.
SceneSetup soft_floor(Number stiffness, Number damping = 0, Number barrier = 0) {
    SceneSetup setup{.name = "springs", .step = Seconds{1, 1024}};
    setup.world.contact = {.response = ContactResponse::spring,
                           .stiffness = real(stiffness),
                           .damping = real(damping),
                           .barrier = real(barrier)};
    setup.planes = {{}};
    return setup;
}
BodySpec falling(BodySpec body, Number height, Number speed) {
    body.position = {0, real(height), 0};
    body.velocity = {0, real(-speed), 0};
    return body;
}

// A contact of the first body seen from outside, where it flies free: how long it lasts and how fast it leaves.
struct Bounce {
    Number time = 0, speed = 0;
    bool pulled = false;  // slower on its way out than it had been
};
// Along x -> gap, before and after; `gap` must be straight in time outside the contact.
template <class Gap>
Bounce bounce(AnyWorld& world, Gap&& gap) {
    Bounce result;
    Number start = 0, last_speed = 0;
    for (int i = 1; i < 4096; ++i) {
        const Number before = gap();
        world.step();
        const Number after = gap(), speed = (after - before) / step, now = static_cast<Number>(i) * step;
        if (before > 0 && after > 0 && speed < 0) start = now + after / -speed;  // when it will touch
        if (before > 0 && after > 0 && speed > 0) {
            result.time = now - after / speed - start;
            result.speed = speed;
            return result;
        }
        // The mean speed over a step does not fall in a contact that only pushes.
        if (before < 0) result.pulled = result.pulled || speed < last_speed - 1e-4L;
        last_speed = speed;
    }
    return result;
}

class Springs : public CaseTest {
protected:
    static Bound rounding() { return tolerance::spring_rounding.of(system()); }
};
INSTANTIATE_TEST_SUITE_P(every, Springs, testing::ValuesIn(contact_cases()), NameOf{});

TEST_P(Springs, a_penalty_bounce_lasts_half_a_period_and_keeps_its_speed) {
    for (const Number stiffness : {256.0L, 1024.0L, 4096.0L}) {
        for (const Number speed : {0.5L, 2.0L}) {
            for (int phase = 0; phase < 8; ++phase) {
                SceneSetup setup = soft_floor(stiffness);
                setup.bodies = {falling(sphere(1, 0.5), 0.5L + speed * step * (4 + phase / 8.0L), speed)};
                const auto world = build(setup, GetParam());
                const Bounce made = bounce(*world, [&] { return world->motion(0).x.y - 0.5L; });
                const Number omega = std::sqrt(stiffness), wh = omega * step;
                EXPECT_LE(std::abs(made.time / (pi / omega) - 1), tolerance::spring_time(wh) + rounding() * (1 / speed))
                    << "k " << stiffness << ", v " << speed;
                EXPECT_LE(std::abs(made.speed / speed - 1), tolerance::spring_speed(wh) + rounding() * (1 / speed))
                    << "k " << stiffness << ", v " << speed;
                EXPECT_FALSE(made.pulled);
                EXPECT_TRUE(world->status().ok());
            }
        }
    }
}

TEST_P(Springs, a_box_that_lands_flat_is_carried_by_a_spring_at_each_corner) {
    SceneSetup setup = soft_floor(512);
    setup.bodies = {falling(box(2, {1, 0.5, 0.75}), 0.2578125L, 2)};
    const auto world = build(setup, GetParam());
    const Bounce made = bounce(*world, [&] { return world->motion(0).x.y - 0.25L; });
    const Number omega = std::sqrt(4 * 512 / Number(2)), wh = omega * step;
    EXPECT_LE(std::abs(made.time / (pi / omega) - 1), tolerance::spring_time(wh) + rounding());
    EXPECT_LE(std::abs(made.speed / 2 - 1), tolerance::spring_speed(wh) + rounding());
    EXPECT_LE(norm(world->motion(0).w), 64 * rounding());
}

TEST_P(Springs, two_spheres_bounce_with_their_reduced_mass_and_keep_their_momentum) {
    SceneSetup setup = soft_floor(768);
    setup.planes.clear();
    const Vector along{2 / 7.0L, -3 / 7.0L, 6 / 7.0L};
    setup.bodies = {placed(sphere(1, 0.25), along * 0.755L, along * -1.5L), placed(sphere(3, 0.5), {}, along * 0.5L)};
    const auto world = build(setup, GetParam());
    const auto momentum = [&] { return world->motion(0).v + world->motion(1).v * 3; };
    const Vector start = momentum();
    const Bounce made = bounce(*world, [&] { return norm(world->motion(0).x - world->motion(1).x) - 0.75L; });
    const Number omega = std::sqrt(768 / 0.75L), wh = omega * step;
    EXPECT_LE(std::abs(made.time / (pi / omega) - 1), tolerance::spring_time(wh) + 2 * rounding());
    EXPECT_LE(std::abs(made.speed / 2 - 1), tolerance::spring_speed(wh) + 2 * rounding());
    EXPECT_LE(norm(momentum() - start), tolerance::pair_momentum.of(system()));
    // 2 m/s apart: each with the other's share of the mass.
    EXPECT_LE(norm(world->motion(0).v - (start * 0.25L + along * 1.5L)),
              2 * (tolerance::spring_speed(wh) + 2 * rounding()));
}

// A force that may only push ends before the spring is straight, where k d = c v. With z the damping ratio, the body
// leaves with exp(-z / s (pi - atan2(2 z s, 1 - 2 z^2))), s = sqrt(1 - z^2), of its speed: a little more than
// exp(-pi z / s), what a force that may pull would leave (Schwager and Poeschel 2007).
TEST_P(Springs, a_damped_bounce_leaves_the_closed_form_and_never_pulls) {
    constexpr Number omega = 32;
    for (const Number z : {0.03125L, 0.125L, 0.25L}) {
        for (int phase = 0; phase < 8; ++phase) {
            SceneSetup setup = soft_floor(2 * omega * omega, 2 * z * omega * 2);  // 2 kg
            setup.bodies = {falling(sphere(2, 0.5), 0.5L + 2 * step * (4 + phase / 8.0L), 2)};
            const auto world = build(setup, GetParam());
            const Bounce made = bounce(*world, [&] { return world->motion(0).x.y - 0.5L; });
            const Number s = std::sqrt(1 - z * z),
                         left = std::exp(-z / s * (pi - std::atan2(2 * z * s, 1 - 2 * z * z)));
            EXPECT_LE(std::abs(made.speed / (2 * left) - 1), tolerance::damped_speed(z, omega * step) + rounding())
                << "damping ratio " << z;
            EXPECT_FALSE(made.pulled) << "damping ratio " << z;
        }
    }
}

TEST_P(Springs, a_damped_ball_and_box_come_to_rest_at_the_depth_that_carries_their_weight) {
    for (const bool boxed : {false, true}) {
        SceneSetup setup = soft_floor(512, 16);
        setup.world.gravity = gravity;
        setup.bodies = {falling(boxed ? box(2, {1, 1, 1}) : sphere(2, 0.5), 0.75L, 0)};
        const auto world = run(setup, 8 * 1024);
        const Number depth = 2 * g / (boxed ? 4 * 512 : 512);
        EXPECT_LE(std::abs((0.5L - world->motion(0).x.y) / depth - 1), tolerance::rest_depth)
            << (boxed ? "box" : "ball");
        EXPECT_LE(norm(world->motion(0).v) + norm(world->motion(0).w), tolerance::creep) << (boxed ? "box" : "ball");
    }
}

// Energy: m v^2 / 2 + B / d is constant.
TEST_P(Springs, a_barrier_stops_a_ball_where_its_energy_is_used_up_and_returns_the_energy) {
    constexpr Number barrier = 0.25L;
    for (const Number speed : {2.0L, 4.0L}) {
        SceneSetup setup = soft_floor(0, 0, barrier);
        setup.bodies = {falling(sphere(1, 0.25), 2.25L, speed)};
        const auto world = build(setup, GetParam());
        const Number energy = speed * speed / 2 + barrier / 2;
        Number nearest = 2, leaves = 0;
        for (int step = 0; step < 4096 && leaves == 0; ++step) {
            world->step();
            const Motion m = world->motion(0);
            nearest = std::min(nearest, m.x.y - 0.25L);
            if (m.v.y > 0 && m.x.y > 2.25L) leaves = m.v.y * m.v.y / 2 + barrier / (m.x.y - 0.25L);
        }
        EXPECT_LE(std::abs(nearest / (barrier / energy) - 1), tolerance::closest_approach) << speed;
        EXPECT_LE(std::abs(leaves / energy - 1), tolerance::barrier_energy + 4 * rounding()) << speed;
        EXPECT_TRUE(world->status().ok());
    }
}

TEST_P(Springs, a_barrier_keeps_two_spheres_apart_by_their_reduced_mass) {
    constexpr Number barrier = 0.25L;
    SceneSetup setup = soft_floor(0, 0, barrier);
    setup.planes.clear();
    setup.bodies = {placed(sphere(1, 0.25), {2.75, 0, 0}, {-3, 0, 0}), placed(sphere(3, 0.5), {}, {1, 0, 0})};
    const auto world = build(setup, GetParam());
    const Number energy = 0.75L * 16 / 2 + barrier / 2;
    Number nearest = 2;
    for (int step = 0; step < 1024; ++step) {
        world->step();
        nearest = std::min(nearest, world->motion(0).x.x - world->motion(1).x.x - 0.75L);
        EXPECT_LE(norm(world->motion(0).v + world->motion(1).v * 3), tolerance::pair_momentum.of(system()));
    }
    EXPECT_LE(std::abs(nearest / (barrier / energy) - 1), tolerance::closest_approach);
}

// Far beyond the size of both, where lengths of contacts are coarse.
TEST_P(Springs, a_barrier_reaches_from_a_box_to_a_ball_far_away) {
    constexpr Number barrier = 4;
    for (const Number gap : {0.5L, 3.0L, 12.0L}) {
        SceneSetup setup = soft_floor(0, 0, barrier);
        setup.planes.clear();
        setup.bodies = {placed(sphere(1, 0.25), {gap + 0.5L, 0, 0}), fixed(box(1, {0.5, 0.5, 0.5}))};
        const auto world = run(setup, 1024);
        const Motion m = world->motion(0);
        const Number gained = barrier / gap - barrier / (m.x.x - 0.5L);
        EXPECT_LE(std::abs(m.v.x * m.v.x / 2 / gained - 1), tolerance::barrier_energy + 64 * rounding()) << gap;
        EXPECT_TRUE(world->status().ok());
    }
}

TEST_P(Springs, a_ball_hovers_where_the_barrier_carries_its_weight) {
    SceneSetup setup = soft_floor(0, 0, 0.5L);
    setup.world.gravity = gravity;
    const Number height = std::sqrt(0.5L / g);
    setup.bodies = {falling(sphere(1, 0.25), 0.25L + height, 0)};
    const auto world = run(setup, 2048);
    EXPECT_LE(std::abs(world->motion(0).x.y - 0.25L - height), tolerance::barrier_height + 4 * rounding());
}

// --- the largest safe step: against 2 / w, w the fastest oscillation of a body on its springs ---------------------

// A ball of 1 kg on springs of 1000 N/m, w = 31.6 rad/s, 10 % deeper than it would rest; and with the given step.
SceneSetup oscillator(Number step, Number damping = 0) {
    SceneSetup setup = soft_floor(1000, damping);
    setup.step = Seconds{real(step)};
    setup.world.gravity = gravity;
    setup.bodies = {falling(sphere(1, 0.5), 0.5L - 1.1L * g / 1000, 0)};
    return setup;
}
const Number limit = 2 / std::sqrt(Number(1000));

Number safe_step(const SceneSetup& setup, const Case& c) {
    const auto world = build(setup, c);
    world->step();
    return world->largest_safe_step();
}

TEST_P(Springs, the_largest_safe_step_is_near_that_of_an_oscillator_and_does_not_depend_on_the_step) {
    for (const Number share : {0.125L, 0.5L, 1.25L}) {
        const Number safe = safe_step(oscillator(share * limit), GetParam());
        EXPECT_GE(safe, tolerance::safe_step_least * limit) << share;
        EXPECT_LE(safe, tolerance::safe_step_most * limit) << share;
    }
}

TEST_P(Springs, the_largest_safe_step_of_two_spheres_is_that_of_their_reduced_mass) {
    SceneSetup setup = soft_floor(1000);
    setup.planes.clear();
    setup.bodies = {placed(sphere(1, 0.25), {0.4375, 0, 0}), sphere(3, 0.25)};
    const Number safe = safe_step(setup, GetParam()), pair = 2 / std::sqrt(1000 / 0.75L);
    EXPECT_GE(safe, tolerance::safe_step_least * pair);
    EXPECT_LE(safe, tolerance::safe_step_most * pair);
}

// Half of the oscillator's limit 2 / w.
TEST_P(Springs, the_largest_safe_step_is_half_the_limit_of_the_fastest_oscillation) {
    constexpr Number stiffness = 1000;
    SceneSetup setup{.name = "springs", .step = Seconds{1, 1024}};
    setup.world.contact = {.response = ContactResponse::spring, .stiffness = real(stiffness)};
    const auto safe = [&] { return run(setup, 1)->largest_safe_step(); };
    setup.planes = {{}};
    for (const Number mass : {0.5L, 1.0L, 8.0L}) {
        setup.bodies = {placed(sphere(real(mass), 0.5), {0, 1, 0})};
        EXPECT_LE(std::abs(safe() * std::sqrt(stiffness / mass) - 1), tolerance::safe_step)
            << "a ball of " << mass << " kg";
        for (const Vector edges : {Vector{1, 1, 1}, {2, 1, 1}, {0.25L, 3, 0.5L}, {4, 4, 0.125L}}) {
            setup.bodies = {placed(box(real(mass), real(edges)), {0, 4, 0})};
            // Four springs: lifting, and tilting about edge i by springs that are half an edge j away, for every face
            // below.
            Number fastest = 4 * stiffness / mass;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    if (i != j)
                        fastest =
                            std::max(fastest, 4 * stiffness * edges[j] * edges[j] / 4 / moments_of(setup.bodies[0])[i]);
            EXPECT_LE(std::abs(safe() * std::sqrt(fastest) - 1), tolerance::safe_step)
                << mass << " kg, edges " << edges.x << ", " << edges.y << ", " << edges.z << " m";
        }
    }
    // In a row of touching bodies, neighbours move against each other in the fastest oscillation: 3 k / m for three
    // equal bodies.
    setup.planes.clear();
    setup.bodies.clear();
    for (int i = 0; i < 3; ++i) setup.bodies.push_back(placed(sphere(2, 0.25), {0.5L * i, 0, 0}));
    EXPECT_LE(safe(), 1 / std::sqrt(3 * stiffness / 2));
}

TEST_P(Springs, a_step_beyond_the_limit_is_reported_and_one_within_it_is_not) {
    const Number safe = safe_step(oscillator(limit / 8), GetParam());
    for (const Number share : {0.5L, 0.9L, 1.1L, 2.5L}) {
        const auto world = run(oscillator(share * safe), 8);
        EXPECT_EQ(world->status().has(Issue::step_too_long), share > 1) << share;
        EXPECT_EQ(world->status().first_body, 0);
    }
    const auto world = run(oscillator(1.1L * limit), 8);
    EXPECT_TRUE(world->status().has(Issue::step_too_long));
}

TEST_P(Springs, at_nine_tenths_of_the_largest_safe_step_an_oscillation_does_not_grow) {
    const Number step = 0.9L * safe_step(oscillator(limit / 8), GetParam());
    const auto world = build(oscillator(step), GetParam());
    const Number rest = 0.5L - g / 1000;
    for (int i = 0; i < 2000; ++i) {
        world->step();
        ASSERT_LE(std::abs(world->motion(0).x.y - rest), tolerance::stable_growth * (0.1L * g / 1000)) << "step " << i;
    }
    EXPECT_FALSE(world->status().has(Issue::step_too_long));
}

// A bounce touches down at any moment of a step, and what a symmetric method gains there it loses elsewhere; beyond
// about half the oscillator's limit it gains more.
TEST_P(Springs, at_nine_tenths_of_the_largest_safe_step_a_bouncing_ball_does_not_run_away) {
    const Number step = 0.9L * safe_step(oscillator(limit / 8), GetParam());
    SceneSetup setup = oscillator(step);
    setup.bodies[0].position.y = 1.5;
    const auto world = build(setup, GetParam());
    int bounces = 0;
    Number highest = 0;
    bool falling = true;
    for (int i = 0; i < 4000 && bounces < 20; ++i) {
        world->step();
        const Motion m = world->motion(0);
        if (falling && m.v.y > 0) ++bounces;
        falling = m.v.y <= 0;
        if (m.x.y > 0.5L) highest = std::max(highest, m.x.y - 0.5L + m.v.y * m.v.y / 2 / g);
    }
    EXPECT_LE(highest, tolerance::stable_growth) << "after " << bounces << " bounces from 1 m";
}

TEST_P(Springs, at_nine_tenths_of_the_largest_safe_step_a_damped_ball_comes_to_rest) {
    for (const Number z : {0.25L, 1.0L, 2.0L}) {
        const Number damping = 2 * z * std::sqrt(Number(1000));
        const Number step = 0.9L * safe_step(oscillator(limit / 64, damping), GetParam());
        SceneSetup setup = oscillator(step, damping);
        setup.bodies[0].position.y = 0.625;
        const auto world = run(setup, 4000);
        EXPECT_LE(std::abs((0.5L - world->motion(0).x.y) / (g / 1000) - 1), tolerance::rest_depth)
            << "damping ratio " << z;
        EXPECT_LE(norm(world->motion(0).v), tolerance::creep) << "damping ratio " << z;
        EXPECT_FALSE(world->status().has(Issue::step_too_long)) << "damping ratio " << z;
    }
}

}  // namespace
}  // namespace tumble::test
