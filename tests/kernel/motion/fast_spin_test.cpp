// Bodies that turn far in a step. In fixed point such a step is divided into 2 to 64 parts.
#include <tumble/tumble.hpp>

#include "references.hpp"
#include "tolerances.hpp"

#include <cmath>

namespace tumble::test {
namespace {

class FastSpin : public CaseTest {
protected:
    // The spin, rad/s, up to which a step of 1/60 s must be followed: that of the declared range, or half a radian.
    static Number followed() { return is_field() ? 101 : 31.5L; }
    // rad/s, of the range of the number system.
    static Number declared() {
        const std::string_view name = system().name;
        const auto has = [&](const char* range) { return name.find(range) != std::string_view::npos; };
        const bool near = has("near") || has("q32_plain");
        return near ? NearRange::spin : has("field") ? FieldRange::spin : RoomRange::spin;
    }
    static bool is_field() { return std::string_view{system().name}.find("field") != std::string_view::npos; }
    // The longest turn, rad, of a part of a step of 1/60 s.
    static Number turn_of_a_part(Number spin) {
        return system().fixed_point ? std::min(spin / 60, Number(0.25)) : spin / 60;
    }
};
INSTANTIATE_TEST_SUITE_P(every, FastSpin, testing::ValuesIn(every_case()), NameOf{});
class FastSpinInParts : public FastSpin {};
INSTANTIATE_TEST_SUITE_P(every, FastSpinInParts,
                         testing::ValuesIn(cases_where([](const Case& c) { return c.system.fixed_point; })), NameOf{});

struct Body {
    const char* name;
    BodySpec body;
};
std::vector<Body> bodies() {
    return {{"sphere", sphere(2, 0.1)},
            {"brick", box(3, {0.1, 0.2, 0.3})},
            {"disc", cylinder(0.5, 0.1, 0.005)},
            {"needle", cylinder(0.1, 0.002, 0.4)}};
}

TEST_P(FastSpin, about_a_principal_axis_turns_a_body_as_the_closed_form_says_or_is_reported) {
    for (const Body& each : bodies()) {
        for (const Number speed : {10.0L, 20.0L, 31.0L, 45.0L, 59.0L, 100.0L}) {
            for (const Number spin : {speed, -speed}) {
                for (int axis = 0; axis < 3; ++axis) {
                    Vector w;
                    w[axis] = spin;
                    for (const bool is_fixed : {false, true}) {
                        SceneSetup setup{.name = each.name, .step = Seconds{1, 60}, .bodies = {each.body}};
                        setup.bodies[0].angular_velocity = real(w);
                        setup.bodies[0].fixed = is_fixed;
                        const auto world = build(setup, GetParam());
                        const Number energy = spin_energy(world->motion(0), moments_of(each.body));
                        const std::string where = each.name + std::string(", axis ") + std::to_string(axis) + ", " +
                                                  std::to_string(static_cast<double>(spin)) + " rad/s";
                        if (!world->run(60).ok()) {
                            EXPECT_GT(speed, followed()) << where;
                            continue;
                        }
                        const Motion end = world->motion(0);
                        const int n = GetParam().method.free_order;
                        const Bound of_method =
                            n == no_truncation ? Bound{} : tolerance::method_error(n, turn_of_a_part(speed), speed);
                        EXPECT_LE(angle_between(end.q, exponential(w)),
                                  of_method + tolerance::fast_turn.of(system()) * speed)
                            << where;
                        EXPECT_LE(norm(end.w - w) / speed, tolerance::fast_spin.of(system())) << where;
                        EXPECT_LE(std::abs(spin_energy(end, moments_of(each.body)) / energy - 1),
                                  2 * tolerance::fast_spin.of(system()))
                            << where;
                        EXPECT_LE(distance(world->reported(0), end), speed * tolerance::reported.of(system())) << where;
                    }
                }
            }
        }
    }
}

// A sixth of a second: later the errors of order 2 are turns.
TEST_P(FastSpin, of_a_tumbling_body_keeps_energy_and_momentum_and_turns_as_the_exact_motion) {
    const int n = GetParam().method.free_order;
    if (n < 2) GTEST_SKIP() << "a step of order 1 is off by a tenth of its turn";
    for (const Body& each : bodies()) {
        for (const Number speed : {10.0L, 20.0L, 31.0L, 45.0L, 59.0L}) {
            // In floating point, methods of order 2 make of 1/2 rad a spin that they do not follow.
            if (speed > (system().fixed_point ? followed() : 25)) continue;
            for (const Vector& along : {Vector{0.48L, 0.6L, 0.64L}, {-0.6L, 0.64L, 0.48L}, {0.64L, -0.48L, -0.6L}}) {
                SceneSetup setup{.name = each.name, .step = Seconds{1, 60}, .bodies = {each.body}};
                setup.bodies[0].angular_velocity = real(along * speed);
                const auto world = build(setup, GetParam());
                const Vector moments = moments_of(each.body);
                const Motion start = world->motion(0);
                ASSERT_TRUE(world->run(10).ok()) << each.name << ", " << speed << " rad/s";
                const Motion end = world->motion(0);
                const Motion exact =
                    reference::free_trajectory(reference_body(setup.bodies[0]), start_of(setup.bodies[0]), {1.0L / 6})
                        .back();
                const Bound of_method = tolerance::method_error(n, turn_of_a_part(speed), speed / 6);
                const Number momentum = norm(angular_momentum(start, moments));
                if (n > 2) {  // with order 2 the error is as large as the turn
                    EXPECT_LE(angle_between(end.q, exact.q), of_method + tolerance::fast_turn.of(system()) * speed)
                        << each.name << ", " << speed << " rad/s";
                }
                EXPECT_LE(norm(angular_momentum(end, moments) - angular_momentum(start, moments)) / momentum,
                          (GetParam().method.conserves ? Bound{} : of_method) + tolerance::fast_spin.of(system()))
                    << each.name << ", " << speed << " rad/s";
                EXPECT_LE(std::abs(spin_energy(end, moments) / spin_energy(start, moments) - 1),
                          of_method + tolerance::fast_spin.of(system()))
                    << each.name << ", " << speed << " rad/s";
            }
        }
    }
}

class FastSpinOfMoserVeselov : public FastSpin {};
INSTANTIATE_TEST_SUITE_P(every, FastSpinOfMoserVeselov, testing::ValuesIn(cases_where([](const Case& c) {
                             return !c.system.fixed_point && std::string_view{c.method.name}.starts_with("pdmv");
                         })),
                         NameOf{});
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(FastSpinOfMoserVeselov);  // with sanitizers

TEST_P(FastSpinOfMoserVeselov, beyond_the_solution_of_its_equation_is_finite_and_reported) {
    for (const Body& each : bodies()) {
        for (const Number speed : {36.0L, 40.0L, 50.0L, 88.0L, 200.0L}) {
            for (const Vector& way :
                 {Vector{0, 0, 1}, Vector{0, -1, 0}, Vector{0.6L, 0, 0.8L}, Vector{0.5L, 0.7L, -0.5L}}) {
                SceneSetup setup{.name = each.name, .step = Seconds{1, 30}, .bodies = {each.body}};
                setup.bodies[0].angular_velocity = real(way * speed);
                const auto world = build(setup, GetParam());
                world->run(30);
                const Motion end = world->motion(0);
                EXPECT_TRUE(std::isfinite(norm(end.w) + end.q.w + norm(end.q.v)))
                    << each.name << ", " << speed << " rad/s";
                // At 1.2 rad a step a float's 24 bits may agree on a solution before the bound of iterations.
                if (speed > 36 || system().bits == 64) {
                    EXPECT_FALSE(world->status().ok()) << each.name << ", " << speed << " rad/s";
                }
            }
        }
    }
}

// Parts of a step are steps of a world with a shorter step, up to dither. So are loads, which act in parts too.
TEST_P(FastSpinInParts, moves_as_with_a_step_of_the_length_of_a_part) {
    for (const int halvings : {1, 2}) {
        if (halvings == 2 && !is_field()) continue;  // beyond the declared range
        for (const bool loaded : {false, true}) {
            SceneSetup setup{.name = "parts", .step = Seconds{1, 60}};
            const Number speed = halvings == 1 ? 0.5L : 1;
            const Vector w = Vector{32, -31, 30} * speed;
            setup.bodies = {top({2, 2.5, 3}, real(w), 5, {}, {1, 2, -1})};
            if (loaded) {
                setup.world = {.gravity = {0, -9.81, 0}, .linear_drag = 0.5, .angular_drag = 1.5};
                setup.springs = {{.point = {0.1, 0.2, -0.1}, .to = {1, 1, 0}, .stiffness = 200, .damping = 2}};
                setup.forces = {{.from = 0.0, .until = 10.0, .frame = Frame::body, .torque = {20, -10, 15}}};
            }
            const auto in_parts = build(setup, GetParam());
            setup.step = Seconds{1, 60 << halvings};
            const auto with_short_steps = build(setup, GetParam());
            const bool follows = in_parts->run(6).ok() && with_short_steps->run(6 << halvings).ok();
            EXPECT_TRUE(follows || GetParam().method.name == std::string_view{"explicit_euler"});  // it gains energy
            if (!follows) continue;
            const Motion a = in_parts->motion(0), b = with_short_steps->motion(0);
            EXPECT_LE(angle_between(a.q, b.q), tolerance::parts_turn.of(system()) * norm(w)) << halvings << loaded;
            EXPECT_LE(norm(a.w - b.w), tolerance::parts_spin.of(system()) * norm(w)) << halvings << loaded;
            if (!loaded) continue;  // the centre of mass alone has the whole step
            EXPECT_LE(norm(a.x - b.x) + norm(a.v - b.v), tolerance::parts_drift.of(system())) << halvings;
        }
    }
}

TEST_P(FastSpinInParts, beyond_its_range_is_held_and_reported) {
    for (const Number spin : {110.0L, -130.0L, 1e4L}) {
        SceneSetup setup{.name = "too fast", .step = Seconds{1, 60}, .bodies = {sphere(1, 0.1)}};
        setup.bodies[0].angular_velocity = {0, real(spin), 0};
        const auto world = build(setup, GetParam());
        world->run(60);
        const Number held = std::abs(world->motion(0).w.y);
        EXPECT_EQ(world->status().has(Issue::range_left), held < std::abs(spin) - 1) << spin;
        EXPECT_LE(std::min(std::abs(spin), declared()) - held, tolerance::saturated) << spin;
        EXPECT_LE(held, std::min(std::abs(spin) + 1, 8 * declared())) << spin;
    }
}

// Its momentum about its long axis is small, and so are the turns that the formats hold of it.
TEST_P(FastSpinInParts, of_a_rod_about_its_long_axis_is_held_at_the_end_of_the_range) {
    for (const BodySpec& body : {cylinder(1, 0.05, 0.5), capsule(1, 0.005, 1)}) {
        for (const Seconds step : {Seconds{1, 256}, Seconds{1, 512}}) {
            for (const Number sign : {1.0L, -1.0L}) {
                SceneSetup setup{.name = "rod", .step = step, .bodies = {body}};
                const Number start = 0.9L * declared(), rate = declared();
                setup.bodies[0].angular_velocity = {0, 0, real(sign * start)};
                setup.forces = {{.from = 0.0,
                                 .until = 10.0,
                                 .frame = Frame::body,
                                 .torque = {0, 0, real(sign * rate * number(body.inertia.zz))}}};
                const auto world = build(setup, GetParam());
                int steps = 0;
                for (; !world->status().has(Issue::range_left) && steps < 2048; ++steps) world->run(1);
                const Number held = sign * world->motion(0).w.z, reached = start + rate * number(step.value) * steps;
                EXPECT_GE(reached, declared());
                EXPECT_GE(held, declared() * 0.999L);
                EXPECT_LE(held, 8 * declared());
                world->run(16);
                EXPECT_LE(std::abs(sign * world->motion(0).w.z - held), 1e-3L * held);
            }
        }
    }
}

TEST_P(FastSpin, of_a_ball_that_slides_until_it_rolls_follows_friction) {
    const Number radius = 0.1L, speed = followed() > 40 ? 5.6L : 2.8L;
    for (const Vector& along : {Vector{1, 0, 0}, {0, 0, -1}, {-0.6L, 0, 0.8L}}) {
        SceneSetup setup{.name = "ball", .step = Seconds{1, 60}};
        setup.world = {.gravity = {0, -9.8125, 0}, .contact = {.restitution = 0, .friction = 0.5}};
        setup.planes = {{}};
        setup.bodies = {placed(sphere(3, real(radius)), {0, radius, 0}, along * speed)};
        const auto world = build(setup, GetParam());
        ASSERT_TRUE(world->run(90).ok());
        const Motion m = world->motion(0);
        // It rolls at 5/7 of its speed.
        EXPECT_LE(norm(m.v - along * (speed * 5 / 7)), tolerance::rolling.of(system()));
        EXPECT_LE(norm(m.q.rotate(m.w) - cross(Vector{0, 1, 0}, along) * (speed * 5 / 7 / radius)),
                  (1 / radius) * tolerance::rolling.of(system()));
    }
}

// --- events and torques of a program ------------------------------------------------------------------------------

template <class Method>
struct Steered {
    using Numbers = Q32<FieldRange>;
    using Integrator = Method;
    static constexpr Features features{.control = true, .imu = true};
};

template <class F>
void for_each_fixed_point_method(F&& f) {
    Integrators::for_each_in<Q32<FieldRange>>(f);
}

// A sphere of I = 0.02 kg m^2 about the y axis.
template <class Method>
struct SteeredTop {
    World<Steered<Method>> world{Seconds{1, 64}};
    BodyId id;

    SteeredTop() {
        BodySpec body = top({0.02, 0.02, 0.02}, {});
        id = world.add(body);
    }
    double spin() const { return world.template motion<double>(id).angular_velocity.y; }
    // Its turn about y since the start, within (-pi, pi].
    double angle() const {
        const auto q = world.template pose<double>(id).orientation;
        return 2 * std::atan2(q.v.y, q.w);
    }
};

TEST(FastSpinEvents, of_any_size_give_the_spin_and_slow_spins_get_whole_steps_again) {
    for_each_fixed_point_method([]<class Method>() {
        SteeredTop<Method> top;
        for (const double spin : {50.0, -60.0, 100.0, 3.0, -110.0, 0.5, 7.0}) {
            top.world.set_angular_velocity(top.id, {0.0, spin, 0.0});
            EXPECT_NEAR(top.spin(), spin, 1e-6) << Method::name;
            for (int i = 0; i < 4; ++i) EXPECT_TRUE(top.world.step().ok()) << Method::name << " " << spin;
            EXPECT_NEAR(top.spin(), spin, 1e-6) << Method::name;
            EXPECT_NEAR(top.world.template imu<double>(top.id).angular_velocity.y, spin, 1e-6) << Method::name;
            EXPECT_EQ(top.world.bodies().halvings_of(0) > 0, std::abs(spin) > 16) << Method::name << " " << spin;
            top.world.apply_angular_impulse(top.id, {0.0, -0.02 * spin, 0.0}, Frame::body);
            EXPECT_NEAR(top.spin(), 0, 1e-6) << Method::name;
            top.world.apply_angular_impulse(top.id, {0.0, 0.02 * spin, 0.0}, Frame::world);
            EXPECT_NEAR(top.spin(), spin, 1e-6) << Method::name;
        }
        top.world.apply_angular_impulse(top.id, {0.0, 1e9, 0.0}, Frame::body);
        EXPECT_TRUE(top.world.status().has(Issue::range_left)) << Method::name;
        EXPECT_NEAR(top.spin(), Method::spin == Spin::angular_momentum ? 512 : 256, 0.01) << Method::name;
    });
}

// Also beyond what a method follows in the shortest parts.
TEST(FastSpinEvents, a_load_that_does_not_turn_a_body_leaves_its_spin_as_it_is_alone) {
    for_each_fixed_point_method([]<class Method>() {
        // The energy of the spin grows with order 1, and of the needle with strang at 60 rad/s.
        if (Method::order < 2 || std::is_same_v<Method, integrators::Strang>) return;
        for (const Body& each : bodies())
            for (const double spin : {10.0, 60.0, -120.0})
                for (const int axis : {0, 2}) {  // whose rotation is stable
                    World<SceneOf<Q32<FieldRange>, Method, Features{}>> free{Seconds{1, 64}};
                    World<SceneOf<Q32<FieldRange>, Method, Features{.springs = 1}>> loaded{Seconds{1, 64}};
                    BodySpec body = each.body;
                    body.position = {1, 0, 0};
                    body.angular_velocity = {0.1, 0.2, 0.1};
                    body.angular_velocity[axis] = spin;
                    (void)free.add(body);
                    (void)loaded.add(body);
                    (void)loaded.add(SpringSpec{.body = 0, .stiffness = 1});
                    const std::string where = Method::name + std::string(" ") + each.name + " " + std::to_string(axis) +
                                              " " + std::to_string(spin);
                    for (int step = 0; step < 32; ++step) {
                        free.step();
                        loaded.step();
                        ASSERT_EQ(loaded.bodies().halvings_of(0), free.bodies().halvings_of(0)) << where;
                    }
                    EXPECT_EQ(loaded.status().bits, free.status().bits) << where;
                    for (int i = 0; i < 3; ++i) {
                        const double w = static_cast<double>(free.angular_velocity(BodyId{0})[i]);
                        EXPECT_NEAR(static_cast<double>(loaded.angular_velocity(BodyId{0})[i]), w,
                                    1e-3 * (1 + std::abs(w)))
                            << where;
                    }
                }
    });
}

// 32 rad/s^2 for two seconds and back, through every number of parts: w = 32 t, and an angle of 16 t^2.
TEST(FastSpinEvents, a_torque_drives_a_spin_up_and_down_as_the_closed_form_says) {
    for_each_fixed_point_method([]<class Method>() {
        SteeredTop<Method> top;
        double angle = 0, error = 0;
        top.world.set_torque(top.id, {0.0, 0.64, 0.0}, Frame::body);
        for (int step = 1; step <= 256; ++step) {
            if (step == 129) top.world.set_torque(top.id, {0.0, -0.64, 0.0}, Frame::body);
            ASSERT_TRUE(top.world.step().ok()) << Method::name << ", step " << step;
            const double t = step / 64.0, back = t > 2 ? t - 2 : 0;
            EXPECT_NEAR(top.spin(), 32 * t - 64 * back, 1e-5) << Method::name << ", step " << step;
            angle = 16 * t * t - 32 * back * back;
            error = std::remainder(top.angle() - angle, 2 * 3.14159265358979323846);
            if constexpr (requires { Method::exact_for_spheres; }) {
                ASSERT_LE(std::abs(error), 1e-5) << Method::name << ", step " << step;
            }
        }
        EXPECT_EQ(top.world.bodies().halvings_of(0), 0) << Method::name;
    });
}

}  // namespace
}  // namespace tumble::test
