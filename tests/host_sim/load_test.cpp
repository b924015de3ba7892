// Air, wheels and the gravity gradient of scene files: closed forms of motion under them, the reference beside the
// kernel, what a firmware's header holds, and the bits of a core.
#include <cmath>

#include "command/command.hpp"
#include "command_runner.hpp"
#include "scene/data.hpp"
#include "scene/reader.hpp"
#include "scene/writer.hpp"
#include "simulation/simulation.hpp"
#include "truth/smooth_motion.hpp"
#include "verdict/accuracy.hpp"
#include "verdict/verdict.hpp"

namespace tumble::host {
namespace {

const std::string near_range = "[range]\nposition = 64.0\nvelocity = 32.0\nangular_velocity = 32.0\n";

std::string world_with(const std::string& keys, const std::string& step, const std::string& duration) {
    return "[world]\nstep = \"" + step + "\"\nduration = " + duration + "\n" + keys + near_range;
}
std::string body_with(const std::string& name, const std::string& keys) {
    return "[[body]]\nname = \"" + name + "\"\n" + keys;
}

const std::string ball = "shape = { sphere = 0.1 }\nmass = 0.5\nvelocity = [9.0, 0.0, 1.0]\n",
                  windy = world_with("wind = [1.0, 0.0, 1.0]\n", "1/256", "2.0") + "[contact]\nresponse = \"none\"\n" +
                          body_with("blunt", ball + "quadratic_drag = 0.25\n") +
                          body_with("slow", ball + "linear_drag = 0.25\n") + body_with("free", ball),
                  gyrostat = world_with("", "1/256", "3.0") +
                             body_with("gyrostat", "shape = \"none\"\nmass = 1.0\ninertia = [0.3, 0.3, 0.2]\n"
                                                   "angular_velocity = [0.2, 0.0, 0.5]\n"
                                                   "wheel_momentum = [0.0, 0.0, 0.35]\n"),
                  rod = world_with("", "1/64", "10.0") +
                        "[gravity_gradient]\norbit_rate = 0.5\nto_centre = [0.0, -2.0, 0.0]\n" +
                        body_with("rod", "shape = \"none\"\nmass = 3.0\ninertia = [0.4, 0.1, 0.45]\n"
                                         "orientation = [1.0, 0.0, 0.0, 0.005]\n"),
                  // Moments about axes that are not the user's, and a body in wind, with wheels and in orbit.
    all = world_with("wind = [2.0, 0.5, -1.0]\n", "1/256", "2.0") +
          "[gravity_gradient]\norbit_rate = 0.8\nto_centre = [1.0, 2.0, -0.5]\n" +
          body_with("tilted", "shape = \"none\"\nmass = 2.0\n"
                              "inertia = [0.4, 0.3, 0.5, 0.05, -0.02, 0.03]\n"
                              "orientation = [0.9, 0.1, -0.3, 0.2]\n"
                              "velocity = [4.0, -3.0, 1.0]\nangular_velocity = [0.5, 1.0, -0.7]\n"
                              "linear_drag = 0.1\nquadratic_drag = 0.05\n"
                              "wheel_momentum = [0.3, -0.2, 0.1]\n");

BodySnapshot end_of(const std::string& text, int body = 0, const char* numbers = "q32") {
    const auto simulation = make_simulation(read_scene_text(text, "scene.toml"), "suzuki4", numbers);
    (void)finish(*simulation);
    EXPECT_TRUE(simulation->troubles().empty());
    return simulation->body(body);
}

// Two bodies that pass through each other: they begin at rest on a line, and attract each other by softened
// gravitation.
const std::string pair_that_meets =
    world_with("gravitation = 2.0\nsoftening = 0.5\n", "1/256", "8.0") + "[contact]\nresponse = \"none\"\n" +
    body_with("left", "shape = { sphere = 0.1 }\nmass = 1.0\nposition = [-1.0, 0.0, 0.0]\n") +
    body_with("right", "shape = \"none\"\nmass = 3.0\nposition = [0.25, 0.0, 0.0]\n");

// Of suzuki4 in q32 with carry over some seconds at these steps: rounding of motions of a few metres and radians.
constexpr double tolerance = 2e-6;

void expect_near(long double got, long double wanted) {
    EXPECT_NEAR(static_cast<double>(got), static_cast<double>(wanted), tolerance);
}

// v' = -(c / m) v^2 through the air: x = t wind + (m / c) ln(1 + v0 t c / m).
TEST(LoadsOfScenes, air_slows_each_body_by_its_own_coefficients) {
    const long double linear = 2 + 8 * 2 * (1 - std::exp(-1.0L)), quadratic = 2 + 2 * std::log(1 + 8 * 2 / 2.0L);
    expect_near(end_of(windy, 0).position[0], quadratic);
    expect_near(end_of(windy, 1).position[0], linear);
    expect_near(end_of(windy, 1).position[2], 2);
    expect_near(end_of(windy, 2).position[0], 18);  // a body without drag does not feel the wind
}

// The transverse spin of a symmetric body turns in it with the rate (h + (I_z - I) w_z) / I.
TEST(LoadsOfScenes, wheels_make_the_transverse_spin_precess) {
    const long double angle = (0.35L + (0.2L - 0.3L) * 0.5L) / 0.3L * 3;
    const BodySnapshot end = end_of(gyrostat);
    expect_near(end.angular_velocity[0], 0.2L * std::cos(angle));
    expect_near(end.angular_velocity[1], 0.2L * std::sin(angle));
    expect_near(end.angular_velocity[2], 0.5L);
}

// Swings of 0.01 rad in a plane, about the attitude in which the axis of the least moment points to the centre: the
// frequency is w sqrt(3 (I_x - I_y) / I_z) (1 - a^2 / 4) for the amplitude a, since the torque is that of sin(2 a) / 2.
TEST(LoadsOfScenes, the_gravity_gradient_swings_a_long_body) {
    const long double tilt = 2 * std::atan(0.005L),
                      frequency = 0.5L * std::sqrt(3 * (0.4L - 0.1L) / 0.45L) * (1 - tilt * tilt / 4);
    const BodySnapshot end = end_of(rod);
    expect_near(2 * std::atan2(end.orientation[3], end.orientation[0]), tilt * std::cos(frequency * 10));
    expect_near(end.orientation[1], 0);
}

// Bodies on a circle of radius r about each other: w^2 = G (m1 + m2) / (r^2 + e^2)^(3/2).
TEST(LoadsOfScenes, softened_gravitation_has_slower_circular_orbits) {
    const double rate = std::sqrt(2.0 * 4 / std::pow(1 + 0.75 * 0.75, 1.5));
    const auto speed = [&](double of) { return "velocity = [0.0, " + std::to_string(of * rate) + ", 0.0]\n"; };
    const BodySnapshot end = end_of(
        world_with("gravitation = 2.0\nsoftening = 0.75\n", "1/256", "4.0") + "[contact]\nresponse = \"none\"\n" +
            body_with("light", "shape = \"none\"\nmass = 1.0\nposition = [0.75, 0.0, 0.0]\n" + speed(0.75)) +
            body_with("heavy", "shape = \"none\"\nmass = 3.0\nposition = [-0.25, 0.0, 0.0]\n" + speed(-0.25)),
        0);
    // The speeds of the file have six decimals.
    EXPECT_NEAR(static_cast<double>(end.position[0]), 0.75 * std::cos(4 * rate), 1e-5);
    EXPECT_NEAR(static_cast<double>(end.position[1]), 0.75 * std::sin(4 * rate), 1e-5);
}

TEST(LoadsOfScenes, the_reference_has_every_load_of_the_kernel) {
    for (const std::string& text : {windy, gyrostat, rod, all, pair_that_meets}) {
        SceneDescription scene = read_scene_text(text, "scene.toml");
        scene.step = {1, 4096, 0};
        const auto simulation = make_simulation(scene, "rk4", "f64", false);
        (void)finish(*simulation);
        SmoothMotion motion(scene, shapes_meet);
        motion.advance_to(simulation->steps());
        for (int b = 0; b < simulation->body_count(); ++b) {
            const reference::Motion body = motion_of(simulation->body(b));
            const reference::Motion& truth = motion.bodies()[static_cast<std::size_t>(b)];
            EXPECT_LE(static_cast<double>(norm(body.x - truth.x)), 1e-9) << text;
            EXPECT_LE(static_cast<double>(angle_between(body.q, truth.q)), 1e-9) << text;
        }
    }
}

// Wheels, the gravity gradient and softened gravitation conserve the energy that the simulator reports. Wind adds
// energy, and the verdict does not call that an error.
TEST(LoadsOfScenes, energy_is_kept_where_only_wheels_gravity_gradient_and_softened_gravitation_act) {
    for (const std::string& text : {gyrostat, rod, pair_that_meets}) {
        const auto simulation = make_simulation(read_scene_text(text, "scene.toml"), "suzuki4", "f64");
        const long double start = simulation->energy().total();
        (void)finish(*simulation);
        EXPECT_LE(static_cast<double>(std::abs(simulation->energy().total() / start - 1)), 1e-9) << text;
    }
}
TEST(LoadsOfScenes, a_run_that_the_wind_speeds_up_is_right) {
    const SceneDescription scene = read_scene_text(
        world_with("wind = [10.0, 0.0, 0.0]\n", "1/256", "2.0") +
            body_with("leaf", "shape = { sphere = 0.1 }\nmass = 0.1\nlinear_drag = 0.1\nquadratic_drag = 0.02\n"),
        "scene.toml");
    const Method method{"verlet", "q32", true};
    const Verdict verdict = verdict_of(scene, method);
    EXPECT_EQ(verdict.kind, Verdict::Kind::right) << sentence_of(verdict, scene, method);
}

TEST(LoadsOfScenes, the_header_of_a_firmware_holds_the_loads_that_act_and_no_others) {
    const auto header = [](const std::string& text) {
        return compiled_scene(read_scene_text(text, "scene.toml"), Choice{}, "");
    };
    const std::string air = header(windy), wheels = header(gyrostat), gradient = header(rod),
                      soft = header(pair_that_meets),
                      none = header(world_with("", "1/256", "1.0") + body_with("free", ball));
    for (const char* part : {".air = true", "wind{1.0, 0.0, 1.0}", "DragSpec, 2> drags", ".quadratic = 0.25"})
        EXPECT_TRUE(has(air, part)) << part << "\n" << air;
    for (const char* part : {".wheels = true", "WheelsSpec, 1> wheels", ".momentum = {0.0, 0.0, 0.35}"})
        EXPECT_TRUE(has(wheels, part)) << part << "\n" << wheels;
    for (const char* part :
         {".gravity_gradient = true", "OrbitSpec orbit{\n        .rate = 0.5,", ".to_centre = {0.0, -2.0, 0.0}"})
        EXPECT_TRUE(has(gradient, part)) << part << "\n" << gradient;
    for (const char* part : {".softening = true", "Real softening{0.5}"})
        EXPECT_TRUE(has(soft, part)) << part << "\n" << soft;
    for (const char* part : {"softening", "air", "wind", "drags", "wheels", "gradient", "orbit"}) {
        EXPECT_FALSE(has(none, part)) << part << "\n" << none;
        EXPECT_LE(has(air, part) + has(wheels, part) + has(gradient, part) + has(soft, part), 1) << part;
    }
}

// A recording of a live run is such a file.
TEST(LoadsOfScenes, a_scene_that_is_written_has_the_same_loads) {
    const SceneDescription scene = read_scene_text(all, "scene.toml"),
                           again = read_scene_text(scene_text(scene), "scene.toml");
    EXPECT_EQ(again.wind, scene.wind);
    ASSERT_TRUE(again.gravity_gradient);
    EXPECT_EQ(again.gravity_gradient->orbit_rate, 0.8);
    EXPECT_EQ(again.gravity_gradient->to_centre, (Triple{1.0, 2.0, -0.5}));
    const BodyDescription& body = again.bodies.at(0);
    EXPECT_EQ(body.linear_drag, 0.1);
    EXPECT_EQ(body.quadratic_drag, 0.05);
    EXPECT_EQ(body.wheel_momentum, (Triple{0.3, -0.2, 0.1}));
}

}  // namespace
}  // namespace tumble::host
