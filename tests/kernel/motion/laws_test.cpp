// Laws of motion, for every integrator in every number system.
#include "random.hpp"
#include "references.hpp"
#include "tolerances.hpp"

#include <cmath>

namespace tumble::test {
namespace {

class Laws : public CaseTest {};
INSTANTIATE_TEST_SUITE_P(every, Laws, testing::ValuesIn(every_case()), NameOf{});

// A body with general axes: a full tensor, an orientation, a velocity.
BodySpec general_body() {
    return {.mass = 2.5,
            .inertia = {2, 1.5, 1.75, 0.25, -0.125, 0.375},
            .position = {1, -2, 3},
            .velocity = {0.5, 0.25, -1},
            .orientation = {0.5, {-0.5, 0.1, 0.3}},
            .angular_velocity = {0.5, -1, 0.75}};
}
Vector momentum_of(const InertiaTensor& i, Vector w) {
    const Vector rows[3] = {{number(i.xx), number(i.xy), number(i.xz)},
                            {number(i.xy), number(i.yy), number(i.yz)},
                            {number(i.xz), number(i.yz), number(i.zz)}};
    return {dot(rows[0], w), dot(rows[1], w), dot(rows[2], w)};
}

TEST_P(Laws, a_body_starts_at_its_given_position) {
    SceneSetup setup{.name = "start", .bodies = {general_body()}};
    const auto world = build(setup, GetParam());
    EXPECT_LE(distance(world->motion(0), start_of(setup.bodies[0])), tolerance::start.of(system()));
}

TEST_P(Laws, accessors_report_the_state_to_the_digits_of_working_numbers) {
    const auto world = run(SceneSetup{.name = "start", .bodies = {general_body()}}, 10);
    EXPECT_LE(distance(world->motion(0), world->reported(0)), tolerance::reported.of(system()));
}

TEST_P(Laws, an_impulse_off_centre_gives_the_textbook_velocity_and_spin) {
    SceneSetup setup{.name = "impulse", .bodies = {general_body()}};
    const BodySpec& body = setup.bodies[0];
    const auto world = build(setup, GetParam());
    const Motion before = world->motion(0);
    const Vector impulse{1, -2, 0.5L}, point{0.25L, 0.5L, -0.75L};
    world->apply_impulse(0, impulse, point);
    const Motion after = world->motion(0);
    EXPECT_LE(norm(after.v - before.v - impulse * (1 / number(body.mass))), tolerance::impulse.of(system()));
    // The angular momentum grows by r x J, in the body's axes. An impulse adds to the momentum and never replaces it.
    const Vector gained = momentum_of(body.inertia, after.w) - momentum_of(body.inertia, before.w);
    EXPECT_LE(norm(gained - cross(point, before.q.rotate_back(impulse))), tolerance::impulse.of(system()));
    EXPECT_EQ(before.x, after.x);
    EXPECT_EQ(before.q, after.q);
}

TEST_P(Laws, an_impulse_and_its_opposite_leave_the_motion_as_it_was) {
    const auto world = build(SceneSetup{.name = "impulse", .bodies = {general_body()}}, GetParam());
    const Motion before = world->motion(0);
    world->apply_impulse(0, {1, -2, 0.5L}, {0.25L, 0.5L, -0.75L});
    world->apply_impulse(0, {-1, 2, -0.5L}, {0.25L, 0.5L, -0.75L});
    EXPECT_LE(distance(world->motion(0), before), tolerance::impulse.of(system()));
}

TEST_P(Laws, an_impulse_of_zero_changes_no_bit) {
    const auto world = run(SceneSetup{.name = "impulse", .bodies = {general_body()}}, 3);
    const std::uint64_t hash = world->hash();
    world->apply_impulse(0, {}, {1, 2, 3});
    EXPECT_EQ(world->hash(), hash);
}

TEST_P(Laws, masses_over_twelve_decades_obey_the_same_impulse_formula) {
    for (const double mass : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
        const auto world = build(SceneSetup{.name = "masses", .bodies = {box(mass, {0.5, 0.25, 1})}}, GetParam());
        const Number m = static_cast<Number>(mass);
        world->apply_impulse(0, Vector{1, -2, 0.5L} * m, {0.125L, 0.25L, 0});
        EXPECT_LE(norm(world->motion(0).v - Vector{1, -2, 0.5L}), tolerance::impulse.of(system())) << mass;
        const Vector moments{m * (0.0625L + 1) / 12, m * (0.25L + 1) / 12, m * (0.25L + 0.0625L) / 12};
        EXPECT_LE(norm(world->motion(0).w - over(cross(Vector{0.125L, 0.25L, 0}, Vector{1, -2, 0.5L} * m), moments)),
                  16 * tolerance::impulse.of(system()))
            << mass;
        EXPECT_TRUE(world->step().ok());
    }
}

// Steps of 1/256 s, 5 s.
TEST_P(Laws, free_flight_keeps_the_orientation_of_unit_length) {
    const auto world = build(free_top({1, 256}), GetParam());
    for (int i = 0; i < 1280; ++i) {
        world->step();
        ASSERT_LE(std::abs(std::sqrt(world->motion(0).q.norm2()) - 1), tolerance::unit_length(order(), system()));
    }
}

TEST_P(Laws, free_flight_conserves_angular_momentum_to_the_methods_order) {
    const auto world = build(free_top({1, 256}), GetParam());
    const Vector moments{1, 2, 3}, start = angular_momentum(world->motion(0), moments);
    world->run(1280);
    const Number drift = norm(angular_momentum(world->motion(0), moments) - start) / norm(start);
    const Bound of_method = GetParam().method.conserves ? Bound{} : tolerance::method_error(order(), 2.0L / 256, 5);
    EXPECT_LE(drift, of_method + tolerance::flight_rounding.of(system()));
    EXPECT_TRUE(world->status().ok());
}

TEST_P(Laws, momentum_is_the_same_after_a_free_flight) {
    const auto world = build(SceneSetup{.name = "drift", .bodies = {general_body()}}, GetParam());
    const Vector before = world->motion(0).v, x = world->motion(0).x;
    world->run(1000);
    EXPECT_EQ(world->motion(0).v, before);
    EXPECT_LE(norm(world->motion(0).x - x - before * (1000.0L / 256)), tolerance::coasting.of(system()));
}

TEST_P(Laws, a_body_without_spin_never_turns) {
    SceneSetup setup{.name = "still", .bodies = {oriented(general_body(), {0, {0, 0.6, 0.8}})}};  // w = 0
    setup.bodies[0].angular_velocity = {};
    const auto world = build(setup, GetParam());
    const Motion before = world->motion(0);
    world->run(1000);
    EXPECT_LE(angle_between(world->motion(0).q, before.q), tolerance::start.of(system()));
    EXPECT_EQ(world->motion(0).w, before.w);
}

TEST_P(Laws, an_orientation_with_w_zero_turns_like_any_other) {
    SceneSetup there = free_top({1, 256}), here = there;
    here.bodies[0].orientation = {0, {0.48, 0.6, 0.64}};
    const auto a = run(here, 512), b = run(there, 512);
    const Rotation q = rotation(normalized(here.bodies[0].orientation));
    EXPECT_LE(angle_between(a->motion(0).q, q * b->motion(0).q), tolerance::same_flight.of(system()));
}

TEST_P(Laws, a_sphere_keeps_its_spin_and_turns_uniformly) {
    SceneSetup setup{.name = "sphere", .bodies = {placed(sphere(2, 0.5), {}, {}, {1, 2, -2})}};
    const auto world = build(setup, GetParam());
    const Vector w = world->motion(0).w;
    world->run(512);
    const Bound of_spin =
        GetParam().method.keeps_the_spin_of_spheres ? Bound{} : tolerance::method_error(2, 3.0L / 256, 3);
    EXPECT_LE(norm(world->motion(0).w - w), of_spin + tolerance::flight_rounding.of(system()));
    const Bound of_method = GetParam().method.exact_for_spheres
                                ? Bound{}
                                : tolerance::method_error(GetParam().method.free_order, 3.0L / 512, 6);
    EXPECT_LE(angle_between(world->motion(0).q, exponential(w * 2)), of_method + tolerance::same_flight.of(system()));
}

// --- shapes of inertia and spins that break methods ----------------------------------------------------------------

struct Extreme {
    const char* name;
    RealVec3 moments, spin;
};
const Extreme extremes[] = {
    {"sphere", {1, 1, 1}, {3, -2, 1}},
    {"nearly flat", {1, 1, 1.999}, {1, 2, 3}},
    {"plate, I1 + I2 = I3", {1, 2, 3}, {1, 2, 3}},
    {"disc", {1, 1, 2}, {1, 2, 3}},
    {"rod 1e5 : 1", {1, 1, 1e-5}, {0.5, -1, 2}},
    {"rod across", {1e-5, 1, 1}, {2, 0.5, -1}},
    {"nearly symmetric", {1, 1.0001, 2}, {1, 2, 3}},
    {"unstable axis, 1e-3", {1, 2, 3}, {1e-3, 2, 0}},
    {"unstable axis, 1e-6", {1, 2, 3}, {1e-6, 2, 0}},
    {"unstable axis, 1e-9", {1, 2, 3}, {1e-9, 2, 0}},
    {"tiny", {1e-9, 2e-9, 2.5e-9}, {1, 2, 3}},
    {"huge", {1e9, 2e9, 2.5e9}, {1, 2, 3}},
};

TEST_P(Laws, bodies_of_extreme_inertia_keep_momentum_energy_and_unit_length) {
    for (const Extreme& extreme : extremes) {
        for (const Seconds step : {Seconds{1, 256}, Seconds{Real{0.005}}, Seconds{1, 60}}) {
            SceneSetup setup{.name = extreme.name, .step = step, .bodies = {top(extreme.moments, extreme.spin)}};
            const auto world = build(setup, GetParam());
            const Vector moments = vector(extreme.moments);
            const Motion start = world->motion(0);
            const Number h = number(step.value), w = norm(start.w);
            world->run(256);
            const Motion end = world->motion(0);
            const Bound of_method = tolerance::method_error(order(), h * w, 256 * h * w);
            const Number momentum = norm(angular_momentum(start, moments)), energy = spin_energy(start, moments);
            const Bound allowed = tolerance::flight_rounding.of(system()) + of_method;
            EXPECT_LE(norm(angular_momentum(end, moments) - angular_momentum(start, moments)) / momentum,
                      GetParam().method.conserves ? tolerance::flight_rounding.of(system()) : allowed)
                << extreme.name;
            EXPECT_LE(std::abs(spin_energy(end, moments) / energy - 1), allowed) << extreme.name;
            EXPECT_LE(std::abs(std::sqrt(end.q.norm2()) - 1),
                      tolerance::unit_length(order(), system()) * std::max(Number(1), std::pow(h * w * 128, Number(4))))
                << extreme.name;
            EXPECT_TRUE(world->status().ok()) << extreme.name;
        }
    }
}

TEST_P(Laws, spins_near_the_limit_stay_in_range_and_turn_right) {
    // 30 rad/s of NearRange's 32, at 1/128 s: 0.12 rad of half turn a step.
    for (const RealVec3& spin : {RealVec3{30, 0, 0}, RealVec3{0, 30, 0}, RealVec3{0, 0, 30}, RealVec3{-17, 17, -17}}) {
        SceneSetup setup{.name = "fast", .step = Seconds{1, 128}, .bodies = {top({2, 2, 2}, spin)}};
        const auto world = build(setup, GetParam());
        const Vector w = vector(spin);
        EXPECT_TRUE(world->run(64).ok());
        const Bound of_spin =
            GetParam().method.keeps_the_spin_of_spheres ? Bound{} : tolerance::method_error(2, norm(w) / 128, norm(w));
        EXPECT_LE(norm(world->motion(0).w - w), of_spin + tolerance::flight_rounding.of(system()) * norm(w));
        const Bound of_method = GetParam().method.exact_for_spheres
                                    ? Bound{}
                                    : tolerance::method_error(GetParam().method.free_order, norm(w) / 128, norm(w) / 2);
        EXPECT_LE(angle_between(world->motion(0).q, exponential(w * 0.5L)),
                  of_method + tolerance::same_flight.of(system()) * norm(w));
    }
}

TEST_P(Laws, a_fixed_body_that_does_not_turn_never_moves) {
    SceneSetup setup{.name = "fixed", .bodies = {fixed(general_body()), sphere(1, 0.25)}};
    setup.bodies[0].angular_velocity = {};
    setup.world.gravity = {0, -10, 0};
    setup.world.linear_drag = 1;
    setup.world.gravitation = 1;
    setup.springs = {{.body = 1, .point = {0.25, 0, 0}, .to_body = 0, .to = {0.5, 0, 0}, .stiffness = 10}};
    setup.impulses = {{.time = 0.0, .body = 0, .impulse = {1, 1, 1}, .angular_impulse = {1, 1, 1}}};
    setup.forces = {{.body = 0, .from = 0.0, .until = 1.0, .force = {1, 1, 1}, .torque = {1, 1, 1}}};
    const auto world = build(setup, GetParam());
    const Motion before = world->motion(0), other = world->motion(1);
    world->apply_impulse(0, {1, 2, 3}, {1, 1, 1});
    world->run(100);
    EXPECT_EQ(distance(world->motion(0), before), 0);
    EXPECT_EQ(norm(before.v) + norm(before.w), 0);
    EXPECT_GT(norm(world->motion(1).x - other.x), 0.01L);
}

// A method prepares its constants anew after an impulse: a body that is struck in flight moves like one that starts
// with the motion after the impulse.
TEST_P(Laws, a_struck_body_moves_like_one_that_starts_with_its_motion) {
    for (const Vector impulse : {Vector{0, 0, 2}, {1, -0.5L, 0.25L}, {-2, 1, 3}}) {
        SceneSetup setup{.name = "struck", .bodies = {placed(box(2, {0.5, 1, 0.75}), {}, {}, {1, -2, 0.5})}};
        const auto struck = run(setup, 37);
        struck->apply_impulse(0, impulse, {0.25L, 0.5L, -0.125L});
        const Motion m = struck->motion(0);
        setup.bodies[0].position = real(m.x);
        setup.bodies[0].velocity = real(m.v);
        setup.bodies[0].orientation = real(m.q);
        setup.bodies[0].angular_velocity = real(m.w);
        struck->run(128);
        const auto started = run(setup, 128);
        EXPECT_LE(angle_between(struck->motion(0).q, started->motion(0).q), 16 * tolerance::same_flight.of(system()));
        EXPECT_LE(norm(struck->motion(0).w - started->motion(0).w),
                  16 * tolerance::same_flight.of(system()) * norm(m.w));
    }
}

std::vector<Case> splitting_cases() {
    std::vector<Case> cases;
    for (const char* method : {"verlet", "strang", "suzuki4"})
        for (const Case& c : cases_of(method)) cases.push_back(c);
    return cases;
}
class Splitting : public CaseTest {};
INSTANTIATE_TEST_SUITE_P(every, Splitting, testing::ValuesIn(splitting_cases()), NameOf{});

TEST_P(Splitting, conserves_the_norm_of_angular_momentum_over_1e5_steps_and_bounds_the_energy_error) {
    const auto world = build(free_top({1, 256}), GetParam());
    const Vector moments{1, 2, 3};
    const Number start = norm(times(moments, world->motion(0).w)), energy = spin_energy(world->motion(0), moments);
    Number worst = 0, early = 0, late = 0;
    for (int i = 0; i < 100000; ++i) {
        world->step();
        const Motion m = world->motion(0);
        worst = std::max(worst, std::abs(norm(times(moments, m.w)) / start - 1));
        Number& half = i < 50000 ? early : late;
        half = std::max(half, std::abs(spin_energy(m, moments) / energy - 1));
    }
    std::printf("%s: |L| drift %.3Lg, energy error %.3Lg then %.3Lg\n", name_of(GetParam()).c_str(), worst, early,
                late);
    EXPECT_LE(worst, tolerance::momentum_norm.of(system()));
    for (const Number error : {early, late})
        EXPECT_LE(error, tolerance::splitting_energy.of(system()) + 2 * tolerance::momentum_norm.of(system()));
}

class Default : public CaseTest {};
INSTANTIATE_TEST_SUITE_P(every, Default, testing::ValuesIn(cases_of("verlet")), NameOf{});

TEST_P(Default, verlet_run_backward_returns_to_the_start) {
    SceneSetup setup = free_top({1, 256});
    BodySpec& body = setup.bodies[0];
    body.inertia = {3, 2, 1, 0, 0, 0};
    body.position = {1, 2, 3};
    body.velocity = {0.5, 1, -0.25};
    setup.world.gravity = {0, -1, 0};
    setup.springs = {{.point = {0.25, 0.5, 0}, .to = {0, 3, 0}, .stiffness = 2, .rest_length = 0.5}};
    const auto forward = run(setup, 500);
    const Motion turned = forward->motion(0), start = start_of(body);
    EXPECT_GT(angle_between(turned.q, start.q), 0.1L);
    body.position = real(turned.x);
    body.orientation = real(turned.q);
    body.velocity = real(-turned.v);
    body.angular_velocity = real(-turned.w);
    const auto backward = run(setup, 500);
    const Motion back = backward->motion(0);
    EXPECT_LE(distance({back.x, -back.v, back.q, -back.w}, start), tolerance::there_and_back.of(system()));
}

}  // namespace
}  // namespace tumble::test
