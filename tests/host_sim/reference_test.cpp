// The reference against motions that are known in closed form, and against the kernel on every load at once.
#include <cmath>
#include <numbers>

#include "command_runner.hpp"
#include "scene/data.hpp"
#include "scene/scene_file.hpp"
#include "simulation/simulation.hpp"
#include "truth/smooth_motion.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host::of_reference {
namespace {

using reference::exponential, reference::Motion, reference::Number, reference::Rotation, reference::Vector;

// Of motions of a few metres and radians, after a few thousand evaluations in long double.
constexpr Number tolerance = 1e-14L;

const std::string ball = "[[body]]\nname = \"ball\"\nshape = { sphere = 0.5 }\nmass = 2.0\n";

SceneDescription description_of(const std::string& world, const std::string& rest) {
    return read_scene_text("name = \"test\"\n[world]\nstep = \"1/64\"\nduration = 4.0\n" + world + rest, "test.toml");
}

// After 2 s.
Motion at_two_seconds(const SceneDescription& scene, std::size_t body = 0) {
    SmoothMotion motion(scene, shapes_meet);
    motion.advance_to(nearest_step(2.0, scene.step));
    return motion.bodies()[body];
}

void expect_near(const Vector& got, const Vector& expected) {
    EXPECT_LE(static_cast<double>(norm(got - expected)), static_cast<double>(tolerance * (1 + norm(expected))));
}
void expect_near(const Rotation& got, const Rotation& expected) {
    EXPECT_LE(static_cast<double>(angle_between(got, expected)), static_cast<double>(tolerance));
}

TEST(SmoothMotion, thrown_ball_flies_a_parabola) {
    const Motion end =
        at_two_seconds(description_of("gravity = [0.0, -10.0, 0.0]\n", ball + "velocity = [3.0, 4.0, 0.0]\n"));
    expect_near(end.x, {6, -12, 0});
    expect_near(end.v, {3, -16, 0});
}

TEST(SmoothMotion, drag_slows_exponentially) {
    const Motion end =
        at_two_seconds(description_of("linear_drag = 0.5\nangular_drag = 0.25\n",
                                      ball + "velocity = [3.0, 0.0, 0.0]\nangular_velocity = [0.0, 0.0, 5.0]\n"));
    const Number left = std::exp(Number(-0.5)), spin_left = std::exp(Number(-2.5));  // I = 0.2 kg m^2
    expect_near(end.v, {3 * left, 0, 0});
    expect_near(end.x, {3 * (1 - left) * 4, 0, 0});
    expect_near(end.w, {0, 0, 5 * spin_left});
    expect_near(end.q, exponential<Number>({0, 0, 5 * (1 - spin_left) * Number(0.8)}));
}

TEST(SmoothMotion, symmetric_top_precesses_about_its_angular_momentum) {
    const SceneDescription scene = description_of(
        "", "[[body]]\nname = \"hoop\"\nshape = { hoop = 1.0 }\nmass = 1.0\nangular_velocity = [1.0, 0.0, 3.0]\n");
    // Moments 1/2, 1/2, 1: q = exp(L t / I1) exp(e3 w3 (1 - I3 / I1) t).
    const Vector momentum{0.5L, 0, 3};
    expect_near(at_two_seconds(scene).q, exponential(momentum * 4) * exponential<Number>({0, 0, -6}));
}

TEST(SmoothMotion, spring_swings_harmonically) {
    const std::string spring = "[[spring]]\nbody = \"ball\"\nto = [0.0, 0.0, 0.0]\nstiffness = 8.0\n";
    const Motion end = at_two_seconds(description_of("", ball + "position = [1.0, 0.0, 0.0]\n" + spring));
    expect_near(end.x, {std::cos(Number(4)), 0, 0});
    expect_near(end.v, {-2 * std::sin(Number(4)), 0, 0});
}

TEST(SmoothMotion, damped_spring_between_bodies_moves_their_distance_alone) {
    const Motion end = at_two_seconds(description_of(
        "", ball + "position = [1.5, 0.0, 0.0]\n[[body]]\nname = \"other\"\nshape = { sphere = 0.5 }\nmass = "
                   "2.0\n[[spring]]\nbody = \"ball\"\nto_body = \"other\"\nto_point = [0.0, 0.0, "
                   "0.0]\nstiffness = 5.0\ndamping = 2.0\nrest_length = 1.0\n"));
    // Reduced mass 1 kg: s'' + 2 s' + 5 s = 0 for the stretch s from 1/2 at rest.
    const Number stretch = std::exp(Number(-2)) * (std::cos(Number(4)) + std::sin(Number(4)) / 2) / 2;
    expect_near(end.x, {Number(1.25) + stretch / 2, 0, 0});
}

TEST(SmoothMotion, two_bodies_circle_their_centre_of_mass) {
    const Motion end = at_two_seconds(description_of(
        "gravitation = 2.0\n", ball + "position = [1.0, 0.0, 0.0]\nvelocity = [0.0, 1.0, 0.0]\n[[body]]\nname = "
                                      "\"other\"\nshape = { sphere = 0.5 }\nmass = 2.0\nposition = [-1.0, 0.0, "
                                      "0.0]\nvelocity = [0.0, -1.0, 0.0]\n"));
    expect_near(end.x, {std::cos(Number(2)), std::sin(Number(2)), 0});
}

TEST(SmoothMotion, force_off_the_centre_in_the_body_frame_spins_up_while_it_is_on) {
    // 0.2 N m about z from 0.505 s to 1.495 s, which are the steps 32 and 96, that is 1 s.
    const std::string couple =
        "[[force]]\nbody = \"ball\"\nfrom = 0.505\nuntil = 1.495\nforce = [0.0, 0.4, 0.0]\nframe = \"body\"\npoint = "
        "[0.5, 0.0, 0.0]\n[[force]]\nbody = \"ball\"\nfrom = 0.505\nuntil = 1.495\nforce = [0.0, -0.4, 0.0]\nframe = "
        "\"body\"\n[[force]]\nbody = \"ball\"\nfrom = 0.0\nuntil = 1.0\nforce = [2.0, 0.0, 0.0]\n[[force]]\nbody = "
        "\"ball\"\nfrom = 0.0\nuntil = 1.0\ntorque = [0.0, 0.0, 0.2]\n";
    const Motion end = at_two_seconds(description_of("", ball + couple));
    expect_near(end.w, {0, 0, 2});  // both torques for 1 s each, at 1 rad/s^2
    expect_near(end.q, exponential<Number>({0, 0, Number(0.5) + 1 + Number(0.5) + Number(0.5)}));
    expect_near(end.x, {1.5L, 0, 0});
}

TEST(SmoothMotion, impulses_act_at_the_nearest_step_at_their_point) {
    const std::string hit =
        "[[impulse]]\ntime = 1.001\nbody = \"ball\"\nimpulse = [4.0, 0.0, 0.0]\npoint = [0.0, 0.25, "
        "0.0]\nangular_impulse = [0.4, 0.0, 0.0]\nframe = \"body\"\n";
    const SceneDescription scene =
        description_of("", ball + "orientation = [0.0, 0.0, 0.0, 1.0]\n" + hit);  // half a turn about z
    const Motion end = at_two_seconds(scene);
    expect_near(end.x, {-2, 0, 0});
    expect_near(end.w, {2, 0, -5});
    SmoothMotion motion(scene, shapes_meet);
    motion.advance_to(64);
    expect_near(motion.bodies()[0].v, {0, 0, 0});  // not yet: it acts when the step begins
}

TEST(SmoothMotion, bodies_have_the_inertia_of_their_shape) {
    // Drag about an axis slows the spin by exp(-c t / I): the moment follows from what is left.
    const auto moment = [](const std::string& shape, const char* spin, int axis) {
        const Motion end = at_two_seconds(description_of(
            "angular_drag = 0.5\n", "[[body]]\nname = \"body\"\n" + shape + "angular_velocity = " + spin + "\n"));
        return static_cast<double>(-1 / std::log(end.w[axis]));
    };
    const char *about_x = "[1.0, 0.0, 0.0]", *about_z = "[0.0, 0.0, 1.0]";
    EXPECT_NEAR(moment("shape = { box = [1.0, 2.0, 3.0] }\nmass = 12.0\n", about_x, 0), 13.0, 1e-12);
    EXPECT_NEAR(moment("shape = { cylinder = [1.0, 3.0] }\nmass = 12.0\n", about_x, 0), 12.0, 1e-12);
    EXPECT_NEAR(moment("shape = { cylinder = [1.0, 3.0] }\nmass = 12.0\n", about_z, 2), 6.0, 1e-12);
    EXPECT_NEAR(moment("shape = { hoop = 2.0 }\nmass = 3.0\n", about_z, 2), 12.0, 1e-12);
    EXPECT_NEAR(moment("shape = { sphere = 2.0 }\ndensity = 10.0\n", about_x, 0),
                0.4 * 4.0 * 10.0 * 4.0 / 3.0 * std::numbers::pi * 8.0, 1e-9);
    // A capsule, summed over thin discs, the moment across by the theorem of parallel axes.
    double along = 0, across = 0;
    constexpr int discs = 20000;
    for (int i = 0; i < discs; ++i) {
        const double z = (i + 0.5) / discs * 4.0 - 2.0, cap = std::max(0.0, std::abs(z) - 1.0);
        const double r2 = 1.0 - cap * cap, mass = std::numbers::pi * r2 * 4.0 / discs;
        along += mass * r2 / 2;
        across += mass * (r2 / 4 + z * z);
    }
    const std::string capsule = "shape = { capsule = [1.0, 2.0] }\ndensity = 1.0\n";
    EXPECT_NEAR(moment(capsule, about_z, 2), along, 1e-6);
    EXPECT_NEAR(moment(capsule, about_x, 0), across, 1e-6);
    EXPECT_NEAR(moment("shape = { points = [[1.0, 0.0, 5.0, 1.0], [-1.0, 0.0, 5.0, 1.0], [0.0, 2.0, 5.0, 1.0], [0.0, "
                       "-2.0, 5.0, 1.0]] }\n",
                       about_z, 2),
                10.0, 1e-12);
}

TEST(SmoothMotion, fixed_bodies_stay) {
    const Motion end = at_two_seconds(description_of("gravity = [0.0, -10.0, 0.0]\n", ball + "fixed = true\n"));
    expect_near(end.x, {0, 0, 0});
}

TEST(SmoothMotion, clearance_is_that_of_the_lowest_vertex) {
    const std::string box = body_of("box", "box = [2.0, 2.0, 2.0]", "[0.0, 5.0, 0.0]") +
                            "orientation = [0.92387953251128674, 0.0, 0.0, 0.38268343236508977]\n";
    const std::string plane = "[[plane]]\nname = \"floor\"\nnormal = [0.0, 2.0, 0.0]\noffset = -1.0\n";
    EXPECT_NEAR(static_cast<double>(SmoothMotion(description_of("", plane + box), shapes_meet).clearance()),
                4.0 - std::sqrt(2.0), 1e-15);
    EXPECT_GT(static_cast<double>(SmoothMotion(description_of("", box), shapes_meet).clearance()), 1e29);
}

TEST(SmoothMotion, clearance_is_that_of_every_shape_that_touches_planes) {
    // Above the floor y = 0; the axis is turned by `angle` from z towards the vertical.
    const auto clearance = [](const std::string& shape, double angle, const std::string& contact = "") {
        const std::string plane = "[[plane]]\nname = \"floor\"\nnormal = [0.0, 1.0, 0.0]\n",
                          turn = "orientation = [" + std::to_string(std::cos(angle / 2)) + ", " +
                                 std::to_string(-std::sin(angle / 2)) + ", 0.0, 0.0]\n",
                          body = body_of("body", shape, "[0.0, 5.0, 0.0]") + turn;
        return static_cast<double>(SmoothMotion(description_of("", contact + plane + body), shapes_meet).clearance());
    };
    const double quarter = std::numbers::pi / 2, eighth = quarter / 2, diagonal = std::sqrt(0.5);
    const double rounding = 1e-5;  // of the orientation's text
    EXPECT_NEAR(clearance("cylinder = [1.0, 3.0]", 0), 4.0, rounding);
    EXPECT_NEAR(clearance("cylinder = [1.0, 3.0]", quarter), 3.5, rounding);
    EXPECT_NEAR(clearance("cylinder = [1.0, 3.0]", eighth), 5.0 - 2.5 * diagonal, rounding);
    EXPECT_NEAR(clearance("hoop = 1.0", 0), 4.0, rounding);
    EXPECT_NEAR(clearance("hoop = 1.0", quarter), 5.0, rounding);
    EXPECT_NEAR(clearance("capsule = [1.0, 3.0]", 0), 4.0, rounding);
    EXPECT_NEAR(clearance("capsule = [1.0, 3.0]", quarter), 2.5, rounding);
    EXPECT_GT(clearance("hoop = 1.0", 0, "[contact]\nresponse = \"none\"\n"), 1e29);
}

TEST(SmoothMotion, clearance_of_two_bodies_is_their_distance_or_less) {
    const auto clearance = [](const std::string& bodies, const std::string& contact = "") {
        return static_cast<double>(SmoothMotion(description_of("", contact + bodies), shapes_meet).clearance());
    };
    const std::string far_ball = body_of("other", "sphere = 1.0", "[3.0, 4.0, 0.0]"),
                      table = body_of("other", "box = [20.0, 2.0, 20.0]", "[5.0, -4.0, 5.0]");
    EXPECT_NEAR(clearance(ball + far_ball), 3.5, 1e-15);
    EXPECT_NEAR(clearance(ball + table + "fixed = true\n"), 2.5, 1e-15);
    // Corner to corner: sqrt(3) apart, of which a face shows 1.
    const double corners = clearance(body_of("other", "box = [2.0, 2.0, 2.0]", "[2.5, 2.5, 2.5]") +
                                     body_of("cube", "box = [1.0, 1.0, 1.0]"));
    EXPECT_LE(corners, std::sqrt(3.0) + 1e-15);
    EXPECT_GE(corners, 1.0);
    EXPECT_NEAR(clearance(ball + body_of("other", "sphere = 1.0", "[0.0, 0.0, 0.0]")), -1.5, 1e-15);
    EXPECT_GT(clearance(ball + "fixed = true\n" + table + "fixed = true\n"), 1e29);
    EXPECT_GT(clearance(ball + body_of("other", "hoop = 1.0", "[3.0, 4.0, 0.0]")), 1e29);
    EXPECT_GT(clearance(ball + far_ball, "[contact]\nresponse = \"none\"\n"), 1e29);
}

TEST(SmoothMotion, fixed_body_turns_at_a_constant_angular_velocity) {
    const std::string table = body_of("table", "box = [1.0, 2.0, 3.0]", "[1.0, 0.0, 0.0]") +
                              "velocity = [1.0, 0.0, 0.0]\nangular_velocity = [0.5, 0.0, 1.0]\nfixed = true\n";
    const Motion end = at_two_seconds(description_of("gravity = [0.0, -10.0, 0.0]\nangular_drag = 0.5\n", table));
    expect_near(end.x, {1, 0, 0});
    expect_near(end.w, {0.5L, 0, 1});
    expect_near(end.q, exponential<Number>({1, 0, 2}));
}

// Every load of the format is in one of them; a method of order 4 at a short step is right to 1e-9.
TEST(SmoothMotion, kernel_agrees_on_every_scene_without_contacts) {
    for (const auto* name : {"brick", "free", "orbit", "oscillators", "pendulum", "projectile", "satellite", "stone"}) {
        SceneDescription scene = read_scene(shipped(name));
        scene.step = {1, 4096, 0};
        scene.duration = std::min(scene.duration, 4.0);
        const auto simulation = make_simulation(scene, "rk4", "f64", false);
        while (simulation->steps_taken() < simulation->steps()) simulation->step();
        SmoothMotion motion(scene, shapes_meet);
        motion.advance_to(simulation->steps());
        for (int b = 0; b < simulation->body_count(); ++b) {
            const Motion body = motion_of(simulation->body(b));
            const Motion& truth = motion.bodies()[static_cast<std::size_t>(b)];
            EXPECT_LE(static_cast<double>(norm(body.x - truth.x)), 1e-9) << name;
            EXPECT_LE(static_cast<double>(angle_between(body.q, truth.q)), 1e-9) << name;
        }
    }
}

}  // namespace
}  // namespace tumble::host::of_reference
