// Limits that are told before a run: what they call safe is safe, and a fifth more is not.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "command_runner.hpp"
#include "scene/reader.hpp"
#include "simulation/limits.hpp"
#include "simulation/simulation.hpp"
#include "simulation/watch.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

// 4 s of free flight without contacts.
SceneDescription scene_of(const std::string& rest, const std::string& world = "") {
    return read_scene_text("name = \"test\"\n[world]\nstep = 0.5\nduration = 4.0\n" + world +
                               "[contact]\nresponse = \"none\"\n" + rest,
                           "test.toml");
}

SceneDescription with_step(SceneDescription scene, double seconds) {
    scene.step = {1, 0, seconds};
    return scene;
}

// How a run ends: by a status, or with this many times the energy at the start at most on the way.
struct Ended {
    bool told = false;
    double most_energy = 1;
};
Ended run(const SceneDescription& scene, const std::string& integrator, const std::string& numbers) {
    const auto simulation = make_simulation(scene, integrator, numbers);
    const long double start = simulation->energy().total();
    Ended ended;
    while (simulation->steps_taken() < simulation->steps() && !ended.told) {
        simulation->step();
        ended.told = !simulation->troubles().empty();
        ended.most_energy = std::max(ended.most_energy, static_cast<double>(simulation->energy().total() / start));
    }
    return ended;
}

template <class F>
void for_each_way(F&& f) {
    for (const IntegratorInfo& method : integrators()) {
        for (const char* numbers : {"q32", "f64"}) {
            if (!runs_in(method, numbers)) continue;
            SCOPED_TRACE(method.name + " " + numbers);
            f(method, numbers);
        }
    }
}

TEST(Limits, of_the_methods_are_those_of_the_literature) {
    constexpr double none = std::numeric_limits<double>::infinity();
    const std::map<std::string, std::pair<double, double>> known{
        {"explicit_euler", {0, 2}},
        {"midpoint", {0, 2}},
        {"heun", {0, 2}},
        {"rk4", {std::sqrt(8.0), 2.785293563}},
        {"semi_implicit_euler", {2, 2}},
        {"suzuki4", {2.721, 5.672}},
        {"implicit_euler", {none, none}},
        {"implicit_midpoint", {none, none}},
    };
    for (const IntegratorInfo& method : integrators()) {
        const auto it = known.find(method.name);
        // All others are kick-drift-kick, whose drag is limited by the iterations for its second kick.
        const auto [oscillation, drag] = it == known.end() ? std::pair{2.0, 2.614} : it->second;
        if (std::isinf(oscillation)) EXPECT_EQ(method.oscillation_limit, oscillation) << method.name;
        else EXPECT_NEAR(method.oscillation_limit, oscillation, 1e-3) << method.name;
        if (std::isinf(drag)) EXPECT_EQ(method.drag_limit, drag) << method.name;
        else EXPECT_NEAR(method.drag_limit, drag, 1e-3) << method.name;
    }
}

// Springs of all kinds: the largest safe step is told at a far longer one, and held to.
class Springs : public testing::TestWithParam<const char*> {};

TEST_P(Springs, are_safe_at_the_step_that_is_told_and_not_at_a_fifth_more) {
    for_each_way([&](const IntegratorInfo& method, const std::string& numbers) {
        const SceneDescription scene = scene_of(GetParam());
        const std::vector<Limit> limits = exceeded_limits(scene, method.name, numbers);
        if (std::isinf(method.oscillation_limit)) {
            EXPECT_TRUE(limits.empty());
            EXPECT_LT(run(scene, method.name, numbers).most_energy, 1.01);
            return;
        }
        ASSERT_EQ(limits.size(), 1u);
        EXPECT_EQ(limits[0].where, "spring[0]");
        EXPECT_GT(limits[0].value, limits[0].limit);
        const SceneDescription safe = with_step(scene, limits[0].largest_step),
                               beyond = with_step(scene, 1.2 * limits[0].largest_step);
        for (const Limit& limit : exceeded_limits(safe, method.name, numbers)) ADD_FAILURE() << limit.sentence;
        EXPECT_FALSE(exceeded_limits(beyond, method.name, numbers).empty());
        const Ended good = run(safe, method.name, numbers), bad = run(beyond, method.name, numbers);
        EXPECT_FALSE(good.told);
        const bool gains = method.oscillation_limit == 0;
        EXPECT_LT(good.most_energy, gains ? 1.105 : 20);
        EXPECT_TRUE(bad.told || bad.most_energy > (gains ? 1.105 : 100)) << bad.most_energy;
    });
}

INSTANTIATE_TEST_SUITE_P(
    Limits, Springs,
    testing::Values(
        // To a world point; with a rest length; between two bodies; at arms.
        "[[body]]\nname = \"a\"\nshape = \"none\"\nmass = 2.0\nposition = [0.1, 0.0, -0.05]\n"
        "[[spring]]\nbody = \"a\"\nto = [0.0, 0.0, 0.0]\nstiffness = 200.0\n",
        "[[body]]\nname = \"a\"\nshape = { sphere = 0.1 }\nmass = 0.5\nposition = [0.0, 1.01, 0.0]\n"
        "[[spring]]\nbody = \"a\"\nto = [0.0, 0.0, 0.0]\nstiffness = 30.0\nrest_length = 1.0\n",
        "[[body]]\nname = \"a\"\nshape = \"none\"\nmass = 1.0\nposition = [0.6, 0.1, 0.0]\n"
        "[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 3.0\nposition = [-0.4, 0.1, 0.2]\n"
        "[[spring]]\nbody = \"b\"\nto_body = \"a\"\nstiffness = 60.0\nrest_length = 1.0\n",
        "[[body]]\nname = \"a\"\nshape = { box = [1.0, 0.1, 0.1] }\nmass = 1.0\nposition = [0.0, 0.101, 0.0]\n"
        "[[spring]]\nbody = \"a\"\npoint = [0.5, 0.0, 0.0]\nto = [0.5, 0.0, 0.0]\nstiffness = 25.0\nrest_length = "
        "0.1\n"));

// Bodies of all kinds, about each axis and tumbling: the spin that is told to be held is held, a tenth more is not, and
// the step that is told holds the spin.
class Spins : public testing::TestWithParam<std::pair<const char*, Triple>> {};

TEST_P(Spins, are_held_up_to_the_limit_that_is_told) {
    const auto& [body, direction] = GetParam();
    SceneDescription scene = with_step(scene_of(std::string("[[body]]\nname = \"b\"\nmass = 0.7\n") + body), 0.01);
    scene.duration = 2;
    const auto spinning = [&, scene](double rate) {
        SceneDescription spun = scene;
        for (std::size_t i = 0; i < 3; ++i) spun.bodies[0].angular_velocity[i] = rate * direction[i];
        return spun;
    };
    for_each_way([&](const IntegratorInfo& method, const std::string& numbers) {
        if (numbers != "q32") return;  // a body in floating point is told of at other spins
        EXPECT_TRUE(exceeded_limits(spinning(5), method.name, numbers).empty());
        const std::vector<Limit> limits = exceeded_limits(spinning(60), method.name, numbers);
        ASSERT_EQ(limits.size(), 1u);
        EXPECT_EQ(limits[0].what, "spin");
        const double held = limits[0].limit / limits[0].value * 60;
        EXPECT_FALSE(run(spinning(0.99 * held), method.name, numbers).told);
        EXPECT_TRUE(run(spinning(1.1 * held), method.name, numbers).told);
        const SceneDescription mended = with_step(spinning(60), limits[0].largest_step);
        EXPECT_TRUE(exceeded_limits(mended, method.name, numbers).empty()) << limits[0].sentence;
        EXPECT_FALSE(run(mended, method.name, numbers).told);
    });
}

INSTANTIATE_TEST_SUITE_P(Limits, Spins,
                         testing::Values(std::pair{"shape = { sphere = 0.1 }\n", Triple{0.6, 0.0, 0.8}},
                                         std::pair{"shape = { hoop = 0.1 }\n", Triple{0.0, 0.0, 1.0}},
                                         std::pair{"shape = { cylinder = [0.2, 0.01] }\n", Triple{0.1, 0.0, -0.99}},
                                         std::pair{"shape = { capsule = [0.01, 0.5] }\n", Triple{0.0, 0.0, 1.0}},
                                         std::pair{"shape = { box = [1.0, 0.02, 0.03] }\n", Triple{0.3, 0.9, 0.1}},
                                         std::pair{"shape = { box = [0.5, 0.01, 0.7] }\n", Triple{0.02, 0.03, 0.99}}));

TEST(Limits, of_bodies_that_fall_around_each_other_are_told_of_the_closest_point) {
    const auto pair = [](const std::string& speed) {
        return scene_of(
            "[[body]]\nname = \"sun\"\nshape = \"none\"\nmass = 3.0\n"
            "[[body]]\nname = \"comet\"\nshape = \"none\"\nmass = 1.0\nposition = [2.0, 0.0, 0.0]\nvelocity = "
            "[0.0, 0.0, " +
                speed + "]\n",
            "gravitation = 1.0\n");
    };
    // Circular at sqrt(2) m/s; at 0.4364 m/s an ellipse that comes to 0.1 m within 1.7 s: w^2 = 4 / 0.1^3.
    for (const IntegratorInfo& method : integrators()) {
        if (method.oscillation_limit == 0) continue;  // these are told of every orbit
        EXPECT_TRUE(exceeded_limits(with_step(pair("1.4142135"), 0.125), method.name, "f64").empty());
        const auto limits = exceeded_limits(with_step(pair("0.4364358"), 0.05), method.name, "f64");
        ASSERT_EQ(limits.size(), 1u) << method.name;
        EXPECT_NEAR(limits[0].value, 0.05 * std::sqrt(4 / 1e-3), 0.05 * limits[0].value);
    }
}

TEST(Limits, are_warned_of_before_a_run_and_do_not_change_its_status) {
    // exp(h^3 w^4 T / 4) with w = 10 / s: a fifth more energy in 20 s.
    const std::string scene =
        written("gains.toml", "name = \"test\"\n[world]\nstep = \"1/64\"\nduration = 20.0\n"
                              "[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 1.0\nposition = [0.1, 0.0, 0.0]\n"
                              "[[spring]]\nbody = \"b\"\nto = [0.0, 0.0, 0.0]\nstiffness = 100.0\n");
    const Outcome gains = tumble({"run", scene, "--integrator", "heun"}), keeps = tumble({"run", scene});
    EXPECT_EQ(gains.status, 0) << gains.text;
    EXPECT_NE(gains.text.find("warning: " + scene + ": spring[0]: a step of 0.015625 s makes h w 0.15625, and heun"),
              std::string::npos)
        << gains.text;
    EXPECT_NE(gains.text.find("the largest safe step is 0.01239 s"), std::string::npos) << gains.text;
    EXPECT_EQ(keeps.text.find("warning"), std::string::npos) << keeps.text;
}

TEST(Limits, are_named_where_a_method_does_not_reach_a_tolerance) {
    const std::string scene = (source_directory / "bench/problems/stiff_spring.toml").string();
    const std::vector<std::string> search{"advise",      scene,  "--core",        "cortex-m3",
                                          "--tolerance", "1e-9", "--integrators", "explicit_euler,implicit_midpoint",
                                          "--numbers",   "q32"};
    EXPECT_NE(tumble(search).text.find("(spring of spring[0]: at most "), std::string::npos);
    std::vector<std::string> in_json = search;
    in_json.emplace_back("--json");
    const auto json = nlohmann::json::parse(tumble(in_json, Process::Errors::keep).text);
    int named = 0;
    for (const auto& row : json.at("unreached")) {
        EXPECT_EQ(row.contains("limit"), row.at("integrator") == "explicit_euler") << row;
        named += row.contains("limit") ? 1 : 0;
    }
    EXPECT_GT(named, 0);
}

// At their own steps, with methods that do not add to oscillations.
TEST(Limits, of_the_scenes_that_are_here_are_not_exceeded) {
    for (const char* directory : {"host_sim/scenes", "host_sim/scenes/contacts", "bench/problems", "bench/contacts"}) {
        for (const auto& entry : std::filesystem::directory_iterator(source_directory / directory)) {
            if (entry.path().extension() != ".toml") continue;
            const SceneDescription scene = read_scene(entry.path().string());
            for (const char* method : {"semi_implicit_euler", "implicit_midpoint", "rk4", "verlet", "suzuki4", "pdmv6"})
                for (const Limit& limit : exceeded_limits(scene, method, "q32"))
                    ADD_FAILURE() << entry.path() << ": " << limit.sentence;
        }
    }
}

// Every number of a sentence is one.
void expect_numbers(const std::string& sentence) {
    for (const char* none : {"nan", " inf", " 0 s"}) EXPECT_EQ(sentence.find(none), std::string::npos) << sentence;
}
TEST(Limits, of_the_scenes_that_are_here_are_told_in_numbers) {
    for (const char* directory : {"bench/stress/scenes", "bench/problems"}) {
        for (const auto& entry : std::filesystem::directory_iterator(source_directory / directory)) {
            if (entry.path().extension() != ".toml") continue;
            SCOPED_TRACE(entry.path());
            const SceneDescription scene = read_scene(entry.path().string());
            for (const IntegratorInfo& method : integrators())
                for (const Limit& limit : exceeded_limits(scene, method.name, "f64")) expect_numbers(limit.sentence);
        }
    }
}
// At rest and pulled outward, nothing turns it, however the work of the force is rounded.
TEST(Limits, of_forces_along_their_arms_are_told_in_numbers) {
    std::mt19937 random(3);
    const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
    for (int trial = 0; trial < 100; ++trial) {
        SceneDescription scene = with_step(scene_of("[[body]]\nname = \"b\"\nshape = { box = [0.3, 0.2, 0.4] }\n"
                                                    "mass = 2.0\n[[force]]\nbody = \"b\"\nfrom = 0.0\n"
                                                    "until = 4.0\nforce = [1.0, 0.0, 0.0]\n"),
                                           1.0 / 256);
        for (std::size_t i = 0; i < 3; ++i) {
            scene.forces[0].point[i] = uniform() / 4;
            scene.forces[0].force[i] = 3 * scene.forces[0].point[i];
        }
        for (const char* method : {"verlet", "rk4"})
            for (const Limit& limit : exceeded_limits(scene, method, "f64")) ADD_FAILURE() << limit.sentence;
    }
}

// At rest, with moments of 1, 2 and 1 kg m^2, under 16 N on an arm of 1 m: w = 4 rad/s. `to` turns it about z.
SceneDescription pendulum(double to, double step) {
    const auto number = [](double value) { return std::to_string(value); };
    return with_step(
        scene_of("[[body]]\nname = \"bob\"\nshape = \"none\"\nmass = 1.0\ninertia = [1.0, 2.0, 1.0]\norientation = [" +
                 number(std::cos(to / 2)) + ", 0.0, 0.0, " + number(std::sin(to / 2)) +
                 "]\n[[force]]\nbody = \"bob\"\nfrom = 0.0\nuntil = 4.0\nforce = [0.0, -16.0, 0.0]\n"
                 "point = [0.0, -1.0, 0.0]\n"),
        step);
}
TEST(Limits, of_forces_at_a_point_are_those_of_a_spring) {
    for (const IntegratorInfo& method : integrators()) {
        if (method.oscillation_limit == 0) continue;  // these are told of every swing
        SCOPED_TRACE(method.name);
        EXPECT_TRUE(
            exceeded_limits(pendulum(0.01, 0.8 * std::min(2.0, method.oscillation_limit) / 4), method.name, "f64")
                .empty());
        if (!std::isfinite(method.oscillation_limit)) continue;
        const auto limits = exceeded_limits(pendulum(0.01, 1.1 * method.oscillation_limit / 4), method.name, "f64");
        ASSERT_EQ(limits.size(), 1u);
        EXPECT_EQ(limits[0].what, "force");
        EXPECT_NEAR(limits[0].value, 1.1 * method.oscillation_limit, 1e-6);
    }
}
TEST(Limits, of_the_spin_that_a_force_is_enough_for_are_told_at_rest) {
    // sqrt(2 * 32 J / 1 kg m^2) from upside down.
    const auto limits = exceeded_limits(pendulum(3.14159, 0.2), "verlet", "f64");
    ASSERT_EQ(limits.size(), 1u);
    EXPECT_EQ(limits[0].what, "spin");
    EXPECT_NEAR(limits[0].value, 8, 1e-3);
    EXPECT_NEAR(limits[0].largest_step, 1.5 / 8, 1e-3);
    EXPECT_TRUE(exceeded_limits(pendulum(3.14159, 0.18), "verlet", "f64").empty());
}

TEST(Limits, of_orbits_count_the_closest_point_against_what_binds_them) {
    // From the apoapsis at 39 m with a major half axis of 20 m and an eccentricity of 0.95; G M = 4.
    const SceneDescription scene =
        scene_of("[[body]]\nname = \"sun\"\nshape = \"none\"\nmass = 4.0\nfixed = true\n"
                 "[[body]]\nname = \"comet\"\nshape = \"none\"\nmass = 1.0\nposition = [39.0, 0.0, 0.0]\n"
                 "velocity = [0.0, 0.0, 0.07161148740394328]\n",
                 "gravitation = 1.0\n");
    SceneDescription turn = scene;
    turn.duration = 300;                                   // of 281 s
    const double most = std::sqrt(1.5 * 0.05 / 1.95) / 2;  // w = 2 rad/s at 1 m
    const auto limits = exceeded_limits(with_step(turn, 1.05 * most), "verlet", "f64");
    ASSERT_EQ(limits.size(), 1u);
    EXPECT_NEAR(limits[0].limit, 2 * most, 1e-3);
    EXPECT_TRUE(exceeded_limits(with_step(turn, 0.95 * most), "verlet", "f64").empty());
    // From there on, and not on the way before it.
    SceneDescription away = turn, before = turn;
    away.bodies[1].position = {1, 0, 0};
    away.bodies[1].velocity = {0, 0, std::sqrt(4 * 1.95)};
    away.duration = 10;
    before.duration = 100;
    EXPECT_EQ(exceeded_limits(with_step(away, 1.05 * most), "verlet", "f64").size(), 1u);
    EXPECT_TRUE(exceeded_limits(with_step(away, 0.95 * most), "verlet", "f64").empty());
    EXPECT_TRUE(exceeded_limits(with_step(before, 1.05 * most), "verlet", "f64").empty());
}

// From rest two bodies at r = 1 m fall into each other after pi/2 sqrt(r^3 / (2 G M)); at 0.5 s of 1.11 they are at
// 0.87 m, where w^2 = 1 / 0.87^3.
TEST(Limits, of_bodies_that_fall_from_rest_are_told_where_they_meet_in_the_run) {
    const SceneDescription released =
        scene_of("[[body]]\nname = \"sun\"\nshape = \"none\"\nmass = 1.0\nfixed = true\n"
                 "[[body]]\nname = \"stone\"\nshape = \"none\"\nmass = 1.0\nposition = [0.0, 0.6, -0.8]\n",
                 "gravitation = 1.0\n");
    for (const IntegratorInfo& method : integrators()) {
        SCOPED_TRACE(method.name);
        for (const auto& [duration, meet] : {std::pair{0.5, false}, {1.0, false}, {1.12, true}, {5.0, true}}) {
            SceneDescription scene = with_step(released, 1.0 / 2048);
            scene.duration = duration;
            const auto limits = exceeded_limits(scene, method.name, "f64");
            ASSERT_EQ(limits.size(), meet ? 1u : 0u) << duration << ": " << (limits.empty() ? "" : limits[0].sentence);
            if (!meet) continue;
            EXPECT_NE(limits[0].sentence.find("they fall into each other"), std::string::npos) << limits[0].sentence;
            expect_numbers(limits[0].sentence);
        }
        // h w = 1.21 at 0.87 m.
        SceneDescription scene = with_step(released, 1.0);
        scene.duration = 0.5;
        const auto limits = exceeded_limits(scene, method.name, "f64");
        ASSERT_EQ(limits.size(), 1u);
        EXPECT_NEAR(limits[0].value, 1.23, 0.03) << limits[0].sentence;
        expect_numbers(limits[0].sentence);
    }
}

// Bodies that springs with dampers tie to each other and to the world, all of them near what a step bears.
SceneDescription tied(std::mt19937& random, const IntegratorInfo& method) {
    const auto uniform = [&](double least, double most) {
        return least + (most - least) * static_cast<double>(random()) / 4294967296.0;
    };
    const auto triple = [&](double size) {
        return Triple{uniform(-size, size), uniform(-size, size), uniform(-size, size)};
    };
    SceneDescription scene = scene_of("[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 1.0\n");
    scene.duration = 2;
    scene.step = {1, static_cast<std::int64_t>(uniform(50, 400)), 0};
    const double h = scene.step.seconds(), of_springs = method.oscillation_limit > 0 ? method.oscillation_limit : 0.4,
                 of_damping = method.drag_limit;
    const int bodies = static_cast<int>(uniform(1, 5)), springs = static_cast<int>(uniform(1, 7));
    const BodyDescription first = scene.bodies[0];
    scene.bodies.clear();
    for (int b = 0; b < bodies; ++b) {
        BodyDescription body = first;
        body.name += std::to_string(b);
        body.mass = std::pow(10, uniform(-1.0, 1.0));
        body.position = triple(2);
        if (random() % 2 == 0) {
            body.shape = {ShapeKind::box, {uniform(0.1, 1), uniform(0.1, 1), uniform(0.1, 1)}, {}};
            body.orientation = {1, uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
            body.angular_velocity = triple(0.5);
        }
        scene.bodies.push_back(body);
    }
    for (int s = 0; s < springs; ++s) {
        SpringDescription spring;
        spring.body = static_cast<int>(random() % static_cast<unsigned>(bodies));
        spring.to_body = static_cast<int>(random() % static_cast<unsigned>(bodies + 1)) - 1;
        if (spring.to_body == spring.body) spring.to_body = -1;
        if (spring.to_body < 0) spring.to = triple(2);
        const double m = *scene.body(spring.body).mass, share = uniform(0.1, 1.1);
        if (!scene.body(spring.body).is_point_mass()) spring.point = triple(0.3);
        spring.stiffness = m * std::pow(share * of_springs / h, 2);
        if (random() % 2 == 0) spring.damping = m / h * of_damping * uniform(0, 0.7);
        if (random() % 2 == 0) spring.rest_length = uniform(0, 3);
        scene.springs.push_back(spring);
    }
    if (random() % 3 == 0) scene.linear_drag = of_damping / h * uniform(0, 0.7) * *scene.body(0).mass;
    if (random() % 3 == 0) scene.angular_drag = of_damping / h * uniform(0, 0.01);
    return scene;
}
TEST(Limits, are_warned_of_wherever_the_kernel_tells_of_them_at_the_start) {
    std::mt19937 random(11);
    int told = 0;
    for (int trial = 0; trial < 400; ++trial) {
        const IntegratorInfo& method = integrators()[random() % integrators().size()];
        if (!std::isfinite(method.drag_limit)) continue;
        const SceneDescription scene = tied(random, method);
        if (!make_simulation(scene, method.name, "f64")->has_trouble("step_too_long")) continue;
        ++told;
        EXPECT_FALSE(exceeded_limits(scene, method.name, "f64").empty()) << method.name << " trial " << trial;
    }
    EXPECT_GT(told, 100);
}

// The shortest of the steps that are told, as it is printed, is one of which nothing is told.
bool expect_safe(const SceneDescription& scene, const IntegratorInfo& method) {
    double shortest = std::numeric_limits<double>::infinity();
    for (const Limit& limit : exceeded_limits(scene, method.name, "f64"))
        shortest = std::min(shortest, std::stod(four_digits_down(limit.largest_step)));
    if (!(shortest > 0) || std::isinf(shortest)) return false;
    const SceneDescription safe = with_step(scene, shortest);
    for (const Limit& limit : exceeded_limits(safe, method.name, "f64"))
        ADD_FAILURE() << method.name << " at " << shortest << " s: " << limit.sentence;
    EXPECT_FALSE(make_simulation(safe, method.name, "f64")->has_trouble("step_too_long")) << method.name;
    return true;
}
TEST(Limits, of_springs_tell_steps_of_which_nothing_more_is_told) {
    std::mt19937 random(23);
    int told = 0;
    for (int trial = 0; trial < 150; ++trial) {
        SCOPED_TRACE(trial);
        const IntegratorInfo& method = integrators()[random() % integrators().size()];
        if (std::isfinite(method.drag_limit)) told += expect_safe(tied(random, method), method) ? 1 : 0;
    }
    EXPECT_GT(told, 50);
    // Each spring alone bears more than what the kernel, which adds them one after another, takes of both.
    const SceneDescription pair = scene_of(
        "[[body]]\nname = \"b\"\nshape = { box = [0.5, 0.4, 0.3] }\nmass = 2.625\nposition = [0.0, 0.0646, -0.0576]\n"
        "velocity = [0.228, 0.249, 0.5]\nangular_velocity = [0.5, 0.4, -0.3]\n"
        "[[spring]]\nbody = \"b\"\npoint = [0.056, -0.197, 0.1]\nto = [0.612, 1.0, 0.0]\nstiffness = 2.57e5\n"
        "damping = 2.826\n"
        "[[spring]]\nbody = \"b\"\npoint = [0.212, -0.159, 0.1]\nto = [0.174, 1.0, 0.0]\nstiffness = 2.57e5\n"
        "rest_length = 1.0\n");
    for (const char* method : {"exact", "verlet", "pdmv6"})
        EXPECT_TRUE(expect_safe(with_step(pair, 0.004), find_integrator(method)));
}

// `bodies` of 0.3 kg in a row between two walls, `beside` springs in each gap; w^2 = 2 k/m (1 - cos(n pi / (n + 1))).
SceneDescription row_of(int bodies, int beside, double h_w, std::size_t axis) {
    SceneDescription scene = with_step(scene_of("[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 0.3\n"), 1.0 / 128);
    const BodyDescription one = scene.bodies[0];
    scene.bodies.clear();
    for (int b = 0; b < bodies; ++b) {
        scene.bodies.push_back(one);
        scene.bodies.back().name += std::to_string(b);
        scene.bodies.back().position[axis] = b + 1 + (b == 1 ? 1e-3 : 0);
    }
    const double stiffest = 2 * (1 - std::cos(bodies * std::acos(-1.0) / (bodies + 1)));
    SpringDescription spring;
    spring.stiffness = h_w * h_w * 128 * 128 * 0.3 / stiffest / beside;
    spring.rest_length = 1;
    for (int gap = 0; gap <= bodies; ++gap) {
        spring.body = std::max(0, gap - 1);
        spring.to_body = gap == 0 || gap == bodies ? -1 : gap;
        spring.to[axis] = gap == bodies ? bodies + 1 : 0;
        for (int s = 0; s < beside; ++s) scene.springs.push_back(spring);
    }
    return scene;
}
TEST(Limits, of_springs_in_rows_and_beside_each_other_are_those_of_their_fastest_motion) {
    for (const char* method : {"verlet", "semi_implicit_euler", "rk4"}) {
        const double limit = find_integrator(method).oscillation_limit;
        for (const auto& [bodies, beside] : {std::pair{1, 1}, std::pair{1, 6}, std::pair{5, 1}, std::pair{5, 4}}) {
            for (const std::size_t axis : {0u, 2u}) {
                for (const double share : {0.85, 0.97, 1.03}) {
                    const SceneDescription row = row_of(bodies, beside, share * limit, axis);
                    const bool is_told = make_simulation(row, method, "f64")->has_trouble("step_too_long");
                    EXPECT_EQ(is_told, share > 1) << method << ", " << bodies << " bodies, " << share;
                    EXPECT_EQ(exceeded_limits(row, method, "f64").empty(), share < 0.9) << method << " " << share;
                }
            }
        }
    }
}

// How `tumble run` ends a scene, whose text has been written to a file.
Outcome run_of(const std::string& text, std::vector<std::string> options) {
    options.insert(options.begin(), {"run", written("scene.toml", text)});
    return tumble(options);
}
std::string thrown(const std::string& range, const std::string& how) {
    return "name = \"thrown\"\n[world]\nstep = \"1/64\"\nduration = 20.0\ngravity = [0.0, -10.0, 0.0]\n" + range +
           "[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 2.0\ninertia = [0.1, 0.1, 0.1]\n" + how;
}
// Floating point is held to the range of fixed point that holds the declared one, as q32 is.
TEST(Limits, of_a_declared_range_are_told_in_floating_point_too) {
    const std::string near = "[range]\nposition = 64.0\nvelocity = 32.0\nangular_velocity = 32.0\n",
                      small = "[range]\nposition = 10.0\nvelocity = 30.0\nangular_velocity = 0.5\n",
                      high = "[range]\nposition = 1100.0\nvelocity = 30.0\nangular_velocity = 8.0\n",
                      fast = "velocity = [-30.0, 25.0, 0.0]\n",
                      spun = "[[force]]\nbody = \"b\"\nfrom = 0.0\nuntil = 20.0\nforce = [0.0, 0.0, 0.0]\n"
                             "torque = [0.0, -4.0, 0.0]\n";  // 40 rad/s^2
    for (const char* numbers : {"q32", "f32", "f64"}) {
        SCOPED_TRACE(numbers);
        const auto told = [&](const std::string& range, const std::string& how, const std::string& duration,
                              const char* step = "1/256") {
            const Outcome outcome =
                run_of(thrown(range, how), {"--numbers", numbers, "--duration", duration, "--step", step});
            const bool is_told = outcome.text.find("range_left") != std::string::npos;
            EXPECT_EQ(outcome.status, is_told ? 1 : 0) << outcome.text;
            EXPECT_EQ(is_told, outcome.text.find("declared [range]") != std::string::npos) << outcome.text;
            return is_told;
        };
        for (const std::string& range : {near, small}) {
            EXPECT_FALSE(told(range, fast, "2"));
            EXPECT_TRUE(told(range, fast, "2.3"));  // 69 m
            EXPECT_FALSE(told(range, "", "3.1"));   // 31 m/s
            EXPECT_TRUE(told(range, "", "3.3"));
            EXPECT_FALSE(told(range, "velocity = [0.0, 30.0, 0.0]\n", "7.4", "0.01"));  // 44 m/s, it holds 50 m/s
            EXPECT_FALSE(told(range, spun, "1.5"));
            EXPECT_TRUE(told(range, spun, "1.7"));  // 68 rad/s, it holds 64 rad/s
        }
        EXPECT_FALSE(told(high, fast, "15"));
        EXPECT_FALSE(told(high, spun, "1"));
        if (numbers != std::string{"q32"}) { EXPECT_FALSE(told("", "velocity = [-100.0, 100.0, 0.0]\n", "20")); }
    }
}

// Energy that a method has added is no result, whether or not the kernel knows how long it ran.
TEST(Limits, of_growth_in_a_whole_run_fail_it) {
    const auto oscillator = [](const std::string& more) {
        return "name = \"gains\"\n[world]\nstep = \"1/256\"\nduration = 60.0\n" + more +
               "[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 0.5\nposition = [0.0, -0.3, 0.1]\n"
               "[[spring]]\nbody = \"b\"\nto = [0.0, 0.0, 0.0]\nstiffness = 2949.12\n";  // h w = 0.3
    };
    const std::string damped = oscillator("linear_drag = 0.15\n"),
                      forced = oscillator("") +
                               "[[force]]\nbody = \"b\"\nfrom = 0.0\nuntil = 1.0\nforce = [1.0, 0.0, 0.0]\n";
    for (const std::string& text : {oscillator(""), damped, forced}) {
        for (const char* method : {"heun", "midpoint"}) {
            const Outcome outcome = run_of(text, {"--integrator", method, "--numbers", "f64"});
            EXPECT_EQ(outcome.status, 1) << method << outcome.text;
            EXPECT_NE(outcome.text.find("step_too_long"), std::string::npos) << outcome.text;
            EXPECT_NE(outcome.text.find("warning: "), std::string::npos) << outcome.text;
        }
        for (const char* method : {"verlet", "rk4", "implicit_midpoint"}) {
            const Outcome outcome = run_of(text, {"--integrator", method, "--numbers", "f64"});
            EXPECT_EQ(outcome.status, 0) << method << outcome.text;
        }
    }
}

// Does a run end with energy that only its method can have added?
bool gains(const SceneDescription& scene, const std::string& method, std::string_view numbers,
           std::optional<bool> carry = {}) {
    const auto simulation = make_simulation(scene, method, numbers, carry);
    EnergyGrowthWatch watch(scene, *simulation);
    while (simulation->steps_taken() < simulation->steps() && !watch.trouble()) {
        simulation->step();
        watch.see(*simulation, simulation->energy());
    }
    return watch.trouble().has_value();
}
// A body on a spring along x, y or z.
struct OnSpring {
    double at, anchor, stiffness, rest, mass;
    std::size_t axis = 0;
    double duration = 1;
};
SceneDescription on_spring(const OnSpring& of, const std::string& more = "", const std::string& shape = "\"none\"") {
    SceneDescription scene = read_scene_text(
        "name = \"test\"\n[world]\nstep = \"1/256\"\nduration = 4.0\n[[body]]\nname = \"b\"\nmass = 1.0\nshape = " +
            shape + "\n[[spring]]\nbody = \"b\"\nto = [0.0, 0.0, 0.0]\nstiffness = 1.0\n" + more,
        "test.toml");
    scene.duration = of.duration;
    scene.bodies[0].mass = of.mass;
    scene.bodies[0].position[of.axis] = of.at;
    scene.springs[0].to[of.axis] = of.anchor;
    scene.springs[0].stiffness = of.stiffness;
    scene.springs[0].rest_length = of.rest;
    return scene;
}

// From rest the motion has no energy at first, and a body at rest none but that of its rounding.
TEST(Limits, of_growth_are_not_met_from_rest) {
    const SceneDescription falling =
        read_scene_text("name = \"test\"\n[world]\nstep = \"1/256\"\nduration = 0.5\ngravity = [0.0, 3.0, -9.0]\n"
                        "[[body]]\nname = \"b\"\nmass = 3.0\nshape = { sphere = 0.1 }\nposition = [0.0, -1.0, 0.0]\n",
                        "test.toml");
    const SceneDescription shipped_pendulum = [] {
        SceneDescription scene = with_step(read_scene(shipped("pendulum")), 1.0 / 1024);
        scene.duration = 0.25;
        return scene;
    }();
    const SceneDescription slow = on_spring({-1.5, 0, 1, 1, 1, 1}), low = on_spring({2.25, 1, 30, 1, 2, 2, 0.5});
    const std::vector<SceneDescription> at_rest{
        on_spring({1.1, 1, 1e4, 0.1, 1}), on_spring({-5.3, -5, 1e3, 0.3, 0.1, 1}),
        on_spring({3.3, 3, 200, 0.3, 0.02, 2}), on_spring({100.1, 100, 1e4, 0.1, 1, 2})};
    std::vector<std::pair<std::string, bool>> systems;
    for (const NumberSystemInfo& system : number_systems())
        if (systems.empty() || systems.back() != std::pair{system.name, system.carry})
            systems.emplace_back(system.name, system.carry);
    for (const auto& [numbers, carry] : systems) {
        for (const IntegratorInfo& method : integrators()) {
            if (!runs_in(method, numbers)) continue;
            SCOPED_TRACE(method.name + " " + numbers + (carry ? " carry" : ""));
            for (const SceneDescription& scene : {falling, shipped_pendulum, slow, low})
                EXPECT_FALSE(gains(scene, method.name, numbers, carry));
            if (method.oscillation_limit == 0) continue;
            for (const SceneDescription& scene : at_rest) EXPECT_FALSE(gains(scene, method.name, numbers, carry));
        }
        for (const double z : {1.45, 1.6, 1.78}) {  // bounded, and 10 times the energy at the most
            for (const std::size_t axis : {0u, 2u}) {
                const OnSpring swings{1.01, 0, z * z * 65536, 1, 1, axis};
                EXPECT_FALSE(gains(on_spring(swings), "semi_implicit_euler", numbers, carry)) << numbers << z;
            }
        }
    }
}

TEST(Limits, of_growth_are_told_with_events_and_planes_too) {
    const std::string at = "body = \"b\"\n",
                      plane = "[[plane]]\nname = \"wall\"\nnormal = [0.0, 0.6, 0.8]\noffset = 9.0\n",
                      early = "[[impulse]]\ntime = 0.0\n" + at + "impulse = [0.001, 0.0, 0.0]\n",
                      late = "[[impulse]]\ntime = 3.5\n" + at + "impulse = [0.0, -0.01, 0.0]\n",
                      force = "[[force]]\nfrom = 1.0\nuntil = 2.0\n" + at + "force = [0.0, 0.2, 0.1]\n";
    for (const std::string& more : {early, late, force, early + late + force, plane + early, plane}) {
        for (const std::size_t axis : {0u, 1u}) {
            const SceneDescription soft = on_spring({0.1, 0, 127, 0, 1, axis, 31.99}, more, "{ sphere = 0.1 }"),
                                   stiff = on_spring({-0.1, 0, 11380, 0, 2, axis, 31.99}, more, "{ sphere = 0.1 }");
            EXPECT_TRUE(gains(soft, "explicit_euler", "f64")) << more;
            EXPECT_TRUE(gains(stiff, "heun", "f64")) << more;
            EXPECT_TRUE(gains(stiff, "midpoint", "f32")) << more;
            for (const char* method : {"verlet", "rk4"}) EXPECT_FALSE(gains(stiff, method, "q32")) << method << more;
        }
    }
    // What a strong kick gives at rest is its own.
    const std::string kick = "[[impulse]]\ntime = 1.0\n" + at + "impulse = [0.0, 5.0, 0.0]\n",
                      pull = "[[force]]\nfrom = 0.5\nuntil = 0.75\n" + at + "force = [0.0, 0.0, -50.0]\n";
    for (const std::string& more : {kick, pull, kick + pull})
        for (const IntegratorInfo& method : integrators())
            EXPECT_FALSE(gains(on_spring({1, 0, 40, 1, 1, 0, 1.5}, more), method.name, "f64")) << method.name << more;
}

// A bounce that is shorter than its step gains what gravity moves in an eighth of the step squared.
TEST(Limits, of_growth_are_told_of_bounces_that_end_higher_than_they_began) {
    const auto dropped = [](const std::string& normal, const std::string& gravity, const std::string& position,
                            const char* step, const std::string& more = "") {
        return read_scene_text(
            "name = \"test\"\n[world]\nduration = 20.0\nstep = " + std::string{step} + "\ngravity = " + gravity +
                "\n[contact]\nrestitution = 0.8\n[[plane]]\nname = \"floor\"\nnormal = " + normal +
                "\n[[body]]\nname = \"ball\"\nmass = 3.0\nshape = { sphere = 0.25 }\nposition = " + position + "\n" +
                more,
            "test.toml");
    };
    const std::string up = "[0.0, 1.0, 0.0]", tilted = "[-0.6, 0.0, 0.8]";
    const std::string below =
        "[[body]]\nname = \"low\"\nmass = 1.0\nshape = { sphere = 0.25 }\nposition = [0.0, 0.25, 0.0]\n";
    for (const char* numbers : {"q32", "f32", "f64"}) {
        for (const char* method : {"verlet", "rk4", "pdmv6"}) {
            SCOPED_TRACE(std::string{numbers} + " " + method);
            EXPECT_TRUE(gains(dropped(up, "[0.0, -9.8, 0.0]", "[0.0, 0.3, 0.0]", "0.5"), method, numbers));
            EXPECT_TRUE(gains(dropped(tilted, "[6.0, 0.0, -8.0]", "[-0.18, 0.0, 0.24]", "0.5"), method, numbers));
            EXPECT_TRUE(gains(dropped(up, "[0.0, -9.8, 0.0]", "[0.0, 0.8, 0.0]", "0.5", below), method, numbers));
            for (const char* step : {"0.0625", "0.015625"}) {
                EXPECT_FALSE(gains(dropped(up, "[0.0, -9.8, 0.0]", "[0.0, 0.3, 0.0]", step), method, numbers)) << step;
                EXPECT_FALSE(gains(dropped(tilted, "[6.0, 0.0, -8.0]", "[-0.6, 0.0, 0.8]", step), method, numbers))
                    << step;
                EXPECT_FALSE(gains(dropped(up, "[0.0, -9.8, 0.0]", "[0.0, 0.8, 0.0]", step, below), method, numbers))
                    << step;
            }
        }
    }
}

// A body between two walls, that contact springs push.
struct Between {
    double speed, stiffness, mass;
    std::size_t axis = 0;
    double overlap = -0.05, barrier = 0, duration = 8;
};
SceneDescription between(const Between& of, const std::string& shape = "{ sphere = 0.1 }") {
    SceneDescription scene = read_scene_text("name = \"between\"\n[world]\nstep = \"1/256\"\nduration = 8.0\n"
                                             "[contact]\nresponse = \"spring\"\n[[plane]]\nname = \"low\"\n"
                                             "normal = [1.0, 0.0, 0.0]\n[[plane]]\nname = \"high\"\nnormal = "
                                             "[1.0, 0.0, 0.0]\n[[body]]\nname = \"b\"\nmass = 1.0\nshape = " +
                                                 shape + "\n",
                                             "between.toml");
    scene.duration = of.duration;
    scene.contact.stiffness = of.stiffness;
    scene.contact.barrier = of.barrier;
    for (std::size_t p = 0; p < 2; ++p) {
        scene.planes[p].normal = {};
        scene.planes[p].normal[of.axis] = p == 0 ? 3 : -1;
        scene.planes[p].offset = 0.1 - of.overlap;
    }
    scene.bodies[0].mass = of.mass;
    scene.bodies[0].velocity[of.axis] = of.speed;
    return scene;
}
TEST(Limits, of_growth_are_told_of_contact_springs) {
    // By the watch, or in fixed point by the range that growth leaves.
    const auto is_told = [](const SceneDescription& scene, const char* method, const char* numbers) {
        const auto simulation = make_simulation(scene, method, numbers);
        (void)finish(*simulation);
        return (simulation->has_trouble("range_left") && numbers == std::string{"q32"}) ||
               gains(scene, method, numbers);
    };
    const std::string box = "{ box = [0.2, 0.2, 0.2] }";
    for (const char* numbers : {"q32", "f64"}) {
        for (const std::size_t axis : {0u, 1u, 2u}) {
            for (const double side : {1.0, -1.0}) {
                SCOPED_TRACE(std::string{numbers} + " " + std::to_string(axis) + " " + std::to_string(side));
                // h w = 1/2, of the barrier at its closest more; of a box on four springs 1/2 too.
                const SceneDescription ball = between({side * 0.5, 16384, 1, axis}),
                                       heavy = between({side * 0.5, 16384 * 7, 7, axis}),
                                       squeezed = between({side * 1e-4, 8192, 1, axis, 0.01}),
                                       flat = between({side * 0.5, 4096, 1, axis}, box),
                                       kept = between({side * 5, 16384, 1, axis, -0.5, 0.5, 4});
                SceneDescription thrown = ball;
                thrown.bodies[0].velocity = {};
                thrown.impulses.push_back({0.1, 0, Frame::world, ball.bodies[0].velocity});
                for (const char* method : {"heun", "midpoint", "explicit_euler"})
                    for (const SceneDescription& scene : {ball, heavy, squeezed, flat, thrown})
                        EXPECT_TRUE(is_told(scene, method, numbers)) << method;
                EXPECT_FALSE(gains(with_step(ball, 1.0 / 2048), "heun", numbers));
                EXPECT_TRUE(gains(kept, "explicit_euler", numbers));
                for (const char* method : {"verlet", "rk4", "semi_implicit_euler", "suzuki4"})
                    for (const SceneDescription& scene : {ball, heavy, squeezed, flat, thrown})
                        EXPECT_FALSE(gains(scene, method, numbers)) << method;
                EXPECT_FALSE(gains(with_step(ball, 1.0 / 512), "implicit_midpoint", numbers));
            }
        }
    }
}

// A body that falls to a floor of contact springs, in a scene with more.
SceneDescription dropped_on_springs(const std::string& shape, double height, double stiffness, double barrier,
                                    const std::string& more = "") {
    SceneDescription scene = read_scene_text("name = \"dropped\"\n[world]\nstep = \"1/1024\"\nduration = 4.0\n"
                                             "gravity = [0.0, -9.81, 0.0]\n[contact]\nresponse = \"spring\"\n"
                                             "[[plane]]\nname = \"floor\"\nnormal = [0.0, 1.0, 0.0]\n"
                                             "[[body]]\nname = \"b\"\nmass = 1.0\nshape = " +
                                                 shape + "\n" + more,
                                             "dropped.toml");
    scene.bodies[0].position = {0, height, 0};
    scene.contact.stiffness = stiffness;
    scene.contact.barrier = barrier;
    return scene;
}
// What contact springs have taken is no gain when they give it back, whether or not it is known.
TEST(Limits, of_growth_are_not_met_by_what_contact_springs_give_back) {
    const std::string box = "{ box = [0.4, 0.05, 0.3] }", cube = "{ box = [0.2, 0.2, 0.2] }",
                      cylinder = "{ cylinder = [0.1, 0.2] }", capsule = "{ capsule = [0.1, 0.2] }",
                      hoop = "{ hoop = 0.2 }", sphere = "{ sphere = 0.1 }",
                      below = "[[body]]\nname = \"low\"\nmass = 1.0\nfixed = true\nposition = [0.0, 0.1, 0.0]\n"
                              "shape = { box = [2.0, 0.2, 2.0] }\n";
    std::vector<SceneDescription> scenes;
    const auto turned = [](SceneDescription scene) {
        scene.bodies[0].orientation = {0.9, 0.3, -0.2, 0.25};
        scene.bodies[0].angular_velocity = {3, -1, 2};
        return scene;
    };
    for (const std::string& shape : {box, cube, cylinder, capsule, hoop, sphere}) {
        // With a barrier below it, and so soft that it sinks past its own size.
        for (const SceneDescription& scene :
             {dropped_on_springs(shape, 1, 0, 0.5), dropped_on_springs(shape, 1, 60, 0)})
            for (const SceneDescription& at : {scene, turned(scene)}) scenes.push_back(at);
        // From deep within, and pressed by a force that ends.
        scenes.push_back(turned(dropped_on_springs(shape, 0.01, 4000, 0)));
        SceneDescription pressed = dropped_on_springs(shape, 0.2, 400, 0);
        pressed.gravity = {};
        pressed.forces.push_back({0, 0, 0.1, Frame::world, {0, -20, 0}});
        scenes.push_back(pressed);
        // Impulses across the way, while it is pressed.
        SceneDescription nudged = dropped_on_springs(shape, 0.3, 10, 0);
        nudged.gravity = {};
        nudged.bodies[0].velocity = {0, -1, 0};
        for (int i = 0; i < 40; ++i) nudged.impulses.push_back({0.2 + 0.01 * i, 0, Frame::world, {1e-4, 0, 0}});
        scenes.push_back(nudged);
    }
    // On a box that stands, whose contacts with boxes may change their axis.
    for (const std::string& shape : {box, cube, sphere}) {
        scenes.push_back(dropped_on_springs(shape, 1, 1000, 0, below));
        scenes.push_back(turned(dropped_on_springs(shape, 1, 500, 0, below)));
        scenes.back().bodies[0].velocity = {0.3, -4, -0.2};
    }
    for (std::size_t s = 0; s < scenes.size(); ++s)
        for (const auto& [method, numbers] : {std::pair{"verlet", "q32"}, {"rk4", "f64"}, {"rk4", "f32"}})
            EXPECT_FALSE(gains(scenes[s], method, numbers)) << s << " " << method << " " << numbers;

    // What is not known does not hide what a method adds, nor does what is fixed or a large tolerance.
    const std::string fixed = "[[body]]\nname = \"post\"\nmass = 1.0\nfixed = true\nposition = [9.0, 0.0, 0.0]\n"
                              "shape = { cylinder = [0.1, 3.0] }\n";
    for (const std::string& shape : {cylinder, capsule, cube, sphere}) {
        const SceneDescription hops = dropped_on_springs(shape, 1, shape == sphere ? 40000 : 14000, 0);
        EXPECT_TRUE(gains(with_step(hops, 1.0 / 256), "heun", "f64")) << shape;
        EXPECT_FALSE(gains(hops, "verlet", "f64")) << shape;
    }
    // Boxes that might meet, and gravitation that does nothing, tell of a multiple.
    const std::string far = "[[body]]\nname = \"far\"\nmass = 1.0\nfixed = true\nposition = [50.0, 0.5, 0.0]\n"
                            "shape = { box = [1.0, 1.0, 1.0] }\n";
    SceneDescription beside = with_step(dropped_on_springs(cube, 1, 14000, 0, far), 1.0 / 256), drawn = beside;
    beside.duration = drawn.duration = 20;
    drawn.bodies.pop_back();
    drawn.gravitation = 1e-12;
    for (const SceneDescription& scene : {beside, drawn}) EXPECT_TRUE(gains(scene, "heun", "f64"));
    const SceneDescription barred = dropped_on_springs(sphere, 2, 4000, 0.5, fixed);
    EXPECT_TRUE(gains(barred, "explicit_euler", "f64"));
    EXPECT_FALSE(gains(barred, "verlet", "f64"));
    SceneDescription coarse = between({0.7, 62259.2, 1, 0, -0.05, 0, 60});  // h w = 0.97
    for (const double tolerance : {0.001, 0.1}) {
        coarse.contact.tolerance = tolerance;
        EXPECT_TRUE(gains(coarse, "suzuki4", "f64")) << tolerance;
    }
}

// A spring of a length whose end comes near its anchor turns about within a step.
TEST(Limits, of_growth_are_told_of_springs_that_swing_through_their_anchors) {
    const auto swung = [](double z, double step) {
        SceneDescription scene = on_spring({1.2, 0, z * z * 65536, 0.5, 1, 1, 16});
        scene.bodies[0].velocity = {0, 0, 0.5};
        return with_step(scene, step);
    };
    EXPECT_TRUE(gains(swung(0.6, 1.0 / 256), "verlet", "f64"));
    EXPECT_FALSE(gains(swung(0.6, 1.0 / 4096), "verlet", "f64"));
}

// An orbit that a method has unbound, whatever its speed at the closest point.
TEST(Limits, of_growth_are_told_of_orbits_that_end_unbound) {
    SceneDescription orbit = scene_of("[[body]]\nname = \"sun\"\nshape = \"none\"\nmass = 2.0\nfixed = true\n"
                                      "[[body]]\nname = \"stone\"\nshape = \"none\"\nmass = 0.001\n"
                                      "position = [0.0, 0.0, -1.0]\nvelocity = [0.0, 0.3, 0.0]\n",
                                      "gravitation = 0.5\n");
    orbit.duration = 20;
    for (const auto& [method, is_told] : {std::pair{"explicit_euler", true},
                                          {"heun", true},
                                          {"semi_implicit_euler", false},
                                          {"rk4", false},
                                          {"verlet", false},
                                          {"suzuki4", false}})
        EXPECT_EQ(gains(with_step(orbit, 1.0 / 256), method, "f64"), is_told) << method;
    EXPECT_FALSE(gains(with_step(orbit, 1.0 / 4096), "heun", "f64"));
}

// A die of `edge` that falls from `height`, to a table whose normal is `up`.
std::string falling_die(double edge, double height, Triple up, const std::string& shape = "") {
    const auto triple = [&](double size) {
        return "[" + std::to_string(size * up[0]) + ", " + std::to_string(size * up[1]) + ", " +
               std::to_string(size * up[2]) + "]\n";
    };
    const std::string e = std::to_string(edge);
    return "gravity = " + triple(-9.81) +
           "[contact]\nrestitution = 0.3\n[[plane]]\nname = \"table\"\nnormal = " + triple(1) +
           "[[body]]\nname = \"die\"\nmass = 0.005\nposition = " + triple(height) +
           "shape = " + (shape.empty() ? "{ box = [" + e + ", " + e + ", " + e + "] }" : shape) + "\n";
}
TEST(Limits, of_the_spin_that_an_impact_may_give_a_small_body_are_warned_of) {
    const auto warned = [](const std::string& rest, const char* numbers) {
        const auto limits = exceeded_limits(
            read_scene_text("name = \"dice\"\n[world]\nstep = \"1/256\"\nduration = 0.8\n" + rest, "dice.toml"),
            "verlet", numbers);
        return std::any_of(limits.begin(), limits.end(), [](const Limit& limit) { return limit.what == "impact"; });
    };
    for (const Triple& up : {Triple{0, 1, 0}, Triple{-1, 0, 0}, Triple{0, 0, 1}}) {
        EXPECT_TRUE(warned(falling_die(0.01, 1, up), "q32"));
        EXPECT_FALSE(warned(falling_die(0.01, 1, up), "f64"));
        EXPECT_TRUE(warned(falling_die(0.02, 0.6, up), "q32"));
        EXPECT_FALSE(warned(falling_die(0.5, 1, up), "q32"));
        EXPECT_FALSE(warned(falling_die(0.01, 0.005, up), "q32"));                    // at rest
        EXPECT_FALSE(warned(falling_die(0.01, 1, up, "{ sphere = 0.005 }"), "q32"));  // without friction
        EXPECT_TRUE(warned(falling_die(0.01, 1, up, "{ cylinder = [0.005, 0.05] }"), "q32"));
        // A marble that rolls at 5/7 of its speed.
        for (const char* v : {"0.6", "0.3"}) {
            const std::string rolling =
                std::string("{ sphere = 0.005 }\nfriction = 0.5\nvelocity = [") + v + ", " + v + ", " + v + "]";
            EXPECT_EQ(warned(falling_die(0.01, 0.005, up, rolling), "q32"), v == std::string{"0.6"});
        }
    }
}

// A ball so far from the origin, 1 m above a plane or before a box that it falls or flies to.
TEST(Limits, of_places_that_floats_hold_less_finely_than_contacts_are_found_are_warned_of) {
    struct Far {
        double away, tolerance;  // m
        int axis;
        bool plane, moves, fixed;
    };
    const auto warned = [](const Far& far, const char* numbers, bool carry = false) {
        const int up = (far.axis + 1) % 3;
        const auto triple = [&](double along, double upwards) {
            Triple t{};
            t[static_cast<std::size_t>(far.axis)] = along;
            t[static_cast<std::size_t>(up)] = upwards;
            return "[" + std::to_string(t[0]) + ", " + std::to_string(t[1]) + ", " + std::to_string(t[2]) + "]\n";
        };
        const std::string other = far.plane ? "[[plane]]\nname = \"floor\"\nnormal = " + triple(0, 1)
                                            : "[[body]]\nname = \"box\"\nmass = 1.0\nfixed = true\n"
                                              "shape = { box = [1.0, 1.0, 1.0] }\nposition = " +
                                                  triple(far.away, -0.5);
        const auto limits = exceeded_limits(
            read_scene_text("name = \"far\"\n[world]\nstep = \"1/256\"\nduration = 1.0\n[range]\nposition = 32768.0\n"
                            "velocity = 2048.0\nangular_velocity = 64.0\n[contact]\ntolerance = " +
                                std::to_string(far.tolerance) + "\n" + other +
                                "[[body]]\nname = \"ball\"\nmass = 1.0\nshape = { sphere = 0.5 }\nposition = " +
                                triple(far.away, 1) + (far.fixed ? "fixed = true\n" : "") +
                                (far.moves ? "velocity = " + triple(0, -4) : ""),
                            "far.toml"),
            "verlet", numbers, carry);
        for (const Limit& limit : limits) {
            if (limit.what != "place") continue;
            EXPECT_EQ(limit.where, "body \"ball\"");
            EXPECT_NE(limit.sentence.find("tolerance"), std::string::npos) << limit.sentence;
            return true;
        }
        return false;
    };
    for (const int axis : {0, 1, 2}) {
        for (const double side : {1.0, -1.0}) {
            for (const bool plane : {true, false}) {
                for (const bool carry : {false, true}) {
                    EXPECT_TRUE(warned({side * 22892, 0.001, axis, plane, true, false}, "f32", carry));  // 1.95 mm
                    EXPECT_TRUE(warned({side * 2048, 0.0009, axis, plane, true, false}, "f32", carry));  // 0.244 mm
                    EXPECT_FALSE(warned({side * 2047, 0.001, axis, plane, true, false}, "f32", carry));  // 0.122 mm
                    EXPECT_FALSE(warned({side * 22892, 0.01, axis, plane, true, false}, "f32", carry));
                }
                EXPECT_FALSE(warned({side * 22892, 0.001, axis, plane, true, false}, "f64"));
                EXPECT_FALSE(warned({side * 22892, 0.001, axis, plane, true, false}, "q32"));
                EXPECT_FALSE(warned({side * 22892, 0.001, axis, plane, false, false}, "f32"));  // it meets nothing
            }
            EXPECT_FALSE(warned({side * 22892, 0.001, axis, true, false, true}, "f32"));
        }
    }
    // A tolerance below what floats resolve of the shapes is raised.
    EXPECT_FALSE(warned({0.008, 0.000001, 0, true, true, false}, "f32"));
}

TEST(Limits, of_places_that_floats_hold_less_finely_than_contact_springs_are_pressed_are_warned_of) {
    // A ball between two walls `away` m from the origin, beside which it flies along the axis or across it.
    const auto far = [](double away, double speed, double stiffness, double mass, std::size_t axis, bool across) {
        SceneDescription scene = between({speed, stiffness, mass, axis});
        const std::size_t to = across ? (axis + 1) % 3 : axis;
        scene.bodies[0].position[to] = away;
        scene.range = {32768, 128, 64, true};
        if (!across)
            for (std::size_t p : {0U, 1U}) scene.planes[p].offset -= (p == 0 ? 1 : -1) * away;
        return scene;
    };
    const auto warned = [](const SceneDescription& scene, const char* numbers, bool carry = false) {
        const auto limits = exceeded_limits(scene, "verlet", numbers, carry);
        for (const Limit& limit : limits) {
            EXPECT_EQ(limit.where, "body \"b\"");
            EXPECT_EQ(limit.what, "place");
            EXPECT_NE(limit.sentence.find("contact springs"), std::string::npos) << limit.sentence;
        }
        return !limits.empty();
    };
    for (const std::size_t axis : {0U, 1U, 2U}) {
        for (const double side : {1.0, -1.0}) {
            for (const bool carry : {false, true}) {
                SCOPED_TRACE(std::to_string(axis) + " " + std::to_string(side));
                // 1.95 mm of 1.7 mm, and of 55 mm
                EXPECT_TRUE(warned(far(side * 20000, 0.3, 30000, 1, axis, false), "f32", carry));
                EXPECT_TRUE(warned(far(side * 20000, -0.3, 120000, 4, axis, false), "f32", carry));
                EXPECT_FALSE(warned(far(side * 20000, 5, 8192, 1, axis, false), "f32", carry));
                EXPECT_FALSE(warned(far(side * 20000, 0.3, 30000, 1, axis, true), "f32", carry));
                EXPECT_FALSE(warned(far(side * 500, 0.3, 30000, 1, axis, false), "f32", carry));
            }
            for (const char* numbers : {"f64", "q32"})
                EXPECT_FALSE(warned(far(side * 20000, 0.3, 30000, 1, axis, false), numbers));
            EXPECT_FALSE(warned(far(side * 20000, 0, 30000, 1, axis, false), "f32"));
        }
    }
}

// A light ball and a heavy one that hit each other.
TEST(Limits, of_masses_are_told_where_impacts_in_fixed_point_lose_the_lighter_one) {
    const auto pair = [](double ratio, std::size_t axis, bool heavy_first, bool is_box) {
        SceneDescription scene = read_scene_text(
            std::string("name = \"pair\"\n[world]\nstep = \"1/256\"\nduration = 1.0\n[contact]\nrestitution = 0.8\n"
                        "[[body]]\nname = \"a\"\nmass = 1.0\nshape = { sphere = 0.1 }\n[[body]]\nname = \"b\"\n"
                        "mass = 1.0\nshape = ") +
                (is_box ? "{ box = [0.2, 0.2, 0.2] }\n" : "{ sphere = 0.1 }\n"),
            "pair.toml");
        scene.bodies[heavy_first ? 0 : 1].mass = 0.5 * ratio;
        scene.bodies[heavy_first ? 1 : 0].mass = 0.5;
        scene.bodies[0].position[axis] = 1;
        scene.bodies[heavy_first ? 0 : 1].velocity[axis] = heavy_first ? -1 : 1;
        return scene;
    };
    const auto told = [](const SceneDescription& scene, const char* numbers, bool carry = true) {
        const auto limits = exceeded_limits(scene, "verlet", numbers, carry);
        for (const Limit& limit : limits) EXPECT_EQ(limit.what, "mass") << limit.sentence;
        return !limits.empty();
    };
    const auto bounced = [](const SceneDescription& scene, const char* numbers) {
        const auto simulation = make_simulation(scene, "verlet", numbers);
        (void)finish(*simulation);
        double fastest = 0;
        for (int b = 0; b < 2; ++b)
            for (const long double v : simulation->body(b).velocity)
                fastest = std::max(fastest, static_cast<double>(std::abs(v)));
        return fastest;
    };
    for (const std::size_t axis : {0U, 1U, 2U}) {
        for (const bool heavy_first : {false, true}) {
            for (const bool is_box : {false, true}) {
                for (const bool carry : {false, true}) {
                    EXPECT_TRUE(told(pair(1.1e4, axis, heavy_first, is_box), "q32", carry));
                    EXPECT_FALSE(told(pair(9e3, axis, heavy_first, is_box), "q32", carry));
                }
                const SceneDescription lost = pair(3e5, axis, heavy_first, is_box);
                for (const char* numbers : {"f32", "f64"}) EXPECT_FALSE(told(lost, numbers));
                SceneDescription held = lost, soft = lost, free = lost;
                held.bodies[heavy_first ? 0 : 1].fixed = true;
                held.bodies[heavy_first ? 0 : 1].velocity = {};
                soft.contact.response = ContactResponse::spring;
                soft.contact.stiffness = 100;
                free.contact.response = ContactResponse::none;
                for (const SceneDescription& scene : {held, soft, free}) EXPECT_FALSE(told(scene, "q32"));
            }
            // Of a limit that is kept the impact is right.
            EXPECT_NEAR(bounced(pair(9e3, axis, heavy_first, false), "q32"), 1.8, 1e-3);
            EXPECT_GT(std::abs(bounced(pair(3e5, axis, heavy_first, false), "q32") - 1.8), 0.1);
        }
    }
}

// A point mass that hangs on a spring under its weight, along one axis.
TEST(Limits, of_gravity_are_told_where_fixed_point_cuts_it) {
    const auto hanging = [](std::size_t axis, double g, double mass, const std::string& step) {
        SceneDescription scene = read_scene_text(
            "name = \"hanging\"\n[world]\nstep = \"" + step +
                "\"\nduration = 1.0\n[range]\nposition = 64.0\nvelocity = 32.0\nangular_velocity = 32.0\n"
                "[contact]\nresponse = \"none\"\n[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 1.0\n"
                "[[spring]]\nbody = \"b\"\nto = [0.0, 0.0, 0.0]\nstiffness = 1.0\n",
            "hanging.toml");
        scene.gravity[axis] = g;
        scene.bodies[0].mass = mass;
        scene.bodies[0].position[axis] = g > 0 ? 13.75 : -13.75;
        scene.springs[0].stiffness = mass * std::abs(g) / 13.75;
        return scene;
    };
    const auto limit_of = [](const SceneDescription& scene, const std::string& method, const char* numbers,
                             bool carry) -> std::optional<Limit> {
        for (const Limit& limit : exceeded_limits(scene, method, numbers, carry))
            if (limit.where == "gravity") return limit;
        return {};
    };
    for (const std::size_t axis : {0U, 1U, 2U}) {
        for (const double side : {1.0, -1.0}) {
            for (const char* method : {"implicit_euler", "implicit_midpoint", "verlet", "explicit_euler", "rk4"}) {
                for (const bool carry : {false, true}) {
                    SCOPED_TRACE(std::string(method) + " " + std::to_string(axis) + " " + std::to_string(carry));
                    // It holds 32 m/s at this step, and of halves of a fall twice that.
                    const int halves = carry && find_integrator(method).coasts_with_mean ? 2 : 1;
                    const SceneDescription beyond = hanging(axis, side * 9011.2 * halves, 1, "1/256");  // 35.2 m/s
                    const auto limit = limit_of(beyond, method, "q32", carry);
                    ASSERT_TRUE(limit.has_value());
                    EXPECT_NEAR(limit->value, 35.2 * halves, 1e-3);
                    EXPECT_NEAR(limit->limit, 32 * halves, 0.01 * halves);
                    EXPECT_FALSE(limit_of(with_step(beyond, limit->largest_step), method, "q32", carry));
                    EXPECT_TRUE(limit_of(hanging(axis, side * 4505.6 * halves, 70, "1/128"), method, "q32", carry));
                    SceneDescription fixed = beyond;
                    fixed.springs.clear();
                    fixed.bodies[0].fixed = true;  // feels none
                    EXPECT_FALSE(limit_of(fixed, method, "q32", carry));
                    SceneDescription within = hanging(axis, side * 8000 * halves, 1, "1/256");
                    EXPECT_FALSE(limit_of(within, method, "q32", carry));
                    within.gravity[(axis + 1) % 3] = -side * 8000 * halves;  // each component by itself
                    EXPECT_FALSE(limit_of(within, method, "q32", carry));
                    within.gravity[(axis + 1) % 3] = side * 9011.2 * halves;
                    EXPECT_TRUE(limit_of(within, method, "q32", carry));
                    for (const char* numbers : {"f32", "f64"}) EXPECT_FALSE(limit_of(beyond, method, numbers, carry));
                }
            }
        }
    }
    // Within the limit it hangs still, beyond it does not.
    const auto moved = [&](double g, const char* method, bool carry) {
        const auto simulation = make_simulation(hanging(1, g, 1, "1/256"), method, "q32", carry);
        while (simulation->steps_taken() < simulation->steps()) simulation->step();
        return std::abs(static_cast<double>(simulation->body(0).position[1]) - 13.75);
    };
    for (const bool carry : {false, true}) {
        EXPECT_LT(moved(8000, "implicit_euler", carry), 1e-6);
        EXPECT_GT(moved(9011.2, "implicit_euler", carry), 0.1);
        const int halves = carry ? 2 : 1;
        EXPECT_LT(moved(8000 * halves, "implicit_midpoint", carry), 1e-6) << carry;
        EXPECT_GT(moved(9011.2 * halves, "implicit_midpoint", carry), 0.1) << carry;
    }
}

// A force changes the velocity of what it acts on by no more than a quarter of what fixed point holds.
TEST(Limits, of_forces_are_told_where_fixed_point_takes_no_more) {
    const auto pushed = [](const Triple& acceleration, double mass, const char* frame, const Triple& gravity) {
        SceneDescription scene = read_scene_text(
            std::string("name = \"pushed\"\n[world]\nstep = \"1/256\"\nduration = 0.25\n[range]\nposition = 64.0\n"
                        "velocity = 32.0\nangular_velocity = 32.0\n[[body]]\nname = \"b\"\nshape = \"none\"\n"
                        "mass = 1.0\ninertia = [1.0, 1.0, 1.0]\n[[force]]\nbody = \"b\"\nfrom = 0.0\n"
                        "until = 0.25\nforce = [0.0, 0.0, 0.0]\nframe = \"") +
                frame + "\"\n",
            "pushed.toml");
        scene.bodies[0].mass = mass;
        scene.gravity = gravity;
        for (std::size_t i = 0; i < 3; ++i) scene.forces[0].force[i] = mass * acceleration[i];
        return scene;
    };
    const auto limit_of = [](const SceneDescription& scene, const char* method, const char* numbers,
                             bool carry = true) -> std::optional<Limit> {
        for (const Limit& limit : exceeded_limits(scene, method, numbers, carry))
            if (limit.where == "force[0]") return limit;
        return {};
    };
    const auto along = [](std::size_t axis, double size) {
        Triple v{};
        v[axis] = size;
        return v;
    };
    // It holds 32 m/s at this step, of which a quarter is 2048 m/s^2.
    for (const std::size_t axis : {0U, 1U, 2U}) {
        const std::size_t other = (axis + 1) % 3;
        for (const double side : {1.0, -1.0}) {
            for (const double mass : {0.25, 1.0, 30.0}) {
                for (const char* method : {"verlet", "rk4", "explicit_euler", "heun"}) {
                    SCOPED_TRACE(std::string(method) + " " + std::to_string(axis) + " " + std::to_string(mass));
                    const SceneDescription beyond = pushed(along(axis, side * 2150), mass, "world", {});
                    const auto limit = limit_of(beyond, method, "q32");
                    ASSERT_TRUE(limit.has_value());
                    EXPECT_EQ(limit->what, "load");
                    EXPECT_NEAR(limit->value, 2150.0 / 256, 1e-3);
                    EXPECT_NEAR(limit->limit, 8, 0.01);
                    EXPECT_NE(limit->sentence.find("body \"b\""), std::string::npos) << limit->sentence;
                    EXPECT_FALSE(limit_of(with_step(beyond, limit->largest_step), method, "q32"));
                    EXPECT_TRUE(make_simulation(beyond, method, "q32")->troubles().empty());
                    const auto ends = [&](const SceneDescription& scene) {
                        const auto simulation = make_simulation(scene, method, "q32");
                        simulation->step();
                        return simulation->has_trouble("range_left");
                    };
                    EXPECT_TRUE(ends(beyond));
                    const SceneDescription within = pushed(along(axis, side * 1950), mass, "world", {});
                    EXPECT_FALSE(limit_of(within, method, "q32"));
                    EXPECT_FALSE(ends(within));
                    for (const char* numbers : {"f32", "f64"}) EXPECT_FALSE(limit_of(beyond, method, numbers));

                    // Along gravity it adds to it, against it takes from it, across it does neither.
                    const auto with_gravity = [&](std::size_t of, double g) {
                        return limit_of(pushed(along(axis, side * 1950), mass, "world", along(of, g)), method, "q32");
                    };
                    EXPECT_TRUE(with_gravity(axis, side * 200));
                    EXPECT_FALSE(with_gravity(axis, -side * 200));
                    EXPECT_FALSE(with_gravity(other, 200));
                    EXPECT_FALSE(limit_of(pushed(along(axis, side * 2150), mass, "world", along(axis, -side * 200)),
                                          method, "q32"));

                    // Of the body's axes it is not known how they will lie: told where any way is too much.
                    Triple oblique = along(axis, side * 2150);
                    oblique[other] = 2150;
                    EXPECT_FALSE(limit_of(pushed(along(axis, side * 3400), mass, "body", {}), method, "q32"));
                    EXPECT_TRUE(limit_of(pushed(along(axis, side * 3700), mass, "body", {}), method, "q32"));
                    EXPECT_FALSE(limit_of(pushed(oblique, mass, "body", {}), method, "q32"));
                    oblique[(axis + 2) % 3] = -2150;
                    EXPECT_TRUE(limit_of(pushed(oblique, mass, "body", {}), method, "q32"));
                    EXPECT_FALSE(limit_of(pushed(oblique, mass, "body", along(other, 200)), method, "q32"));
                }
            }
            EXPECT_FALSE(limit_of(pushed(along(axis, side * 2150), 1, "world", {}), "implicit_euler", "q32"));
        }
    }
}

// A ball that bounces on a contact spring: methods that add to it say so before the run.
TEST(Limits, of_contact_springs_are_told_of_methods_that_add_to_every_oscillation) {
    const auto bouncing = [](double up, double stiffness, double mass, double damping, bool on_ball) {
        SceneDescription scene = read_scene_text(
            std::string("name = \"bouncing\"\n[world]\nstep = \"1/256\"\nduration = 8.0\n[contact]\nresponse = "
                        "\"spring\"\n[[body]]\nname = \"ball\"\nshape = { sphere = 0.1 }\nmass = 1.0\n") +
                (on_ball ? "[[body]]\nname = \"ground\"\nfixed = true\nmass = 1.0\nshape = { sphere = 1.0 }\n"
                         : "[[plane]]\nname = \"ground\"\nnormal = [0.0, 1.0, 0.0]\n"),
            "bouncing.toml");
        scene.bodies[0].position[1] = up;
        if (on_ball) scene.bodies[1].position[1] = up > 0 ? -1 : 1;
        else scene.planes[0].normal[1] = up > 0 ? 1 : -1;
        scene.gravity[1] = up > 0 ? -9.81 : 9.81;
        scene.bodies[0].mass = mass;
        scene.contact.stiffness = stiffness;
        scene.contact.damping = damping;
        return scene;
    };
    const auto is_told = [](const SceneDescription& scene, const std::string& method, const char* numbers) {
        const auto limits = exceeded_limits(scene, method, numbers);
        for (const Limit& limit : limits) {
            EXPECT_EQ(limit.where, "body \"ball\"");
            EXPECT_EQ(limit.what, "contact spring");
            EXPECT_NE(limit.sentence.find("of contact"), std::string::npos) << limit.sentence;
            EXPECT_TRUE(exceeded_limits(with_step(scene, limit.largest_step), method, numbers).empty());
        }
        return !limits.empty();
    };
    for (const char* numbers : {"q32", "f32", "f64"}) {
        for (const double up : {0.5, -0.5}) {
            for (const bool on_ball : {false, true}) {
                for (const char* method : {"heun", "midpoint", "explicit_euler"}) {
                    SCOPED_TRACE(std::string(method) + " " + numbers + " " + std::to_string(up));
                    EXPECT_TRUE(is_told(bouncing(up, 16384, 1, 0, on_ball), method, numbers));  // h w = 1/2
                    EXPECT_TRUE(is_told(bouncing(up, 1024, 0.0625, 0, on_ball), method, numbers));
                    EXPECT_FALSE(is_told(bouncing(up, 16384, 1, 100, on_ball), method, numbers));
                    EXPECT_FALSE(is_told(bouncing(up, 0, 1, 0, on_ball), method, numbers));
                }
                EXPECT_FALSE(is_told(bouncing(up, 256, 1, 0, on_ball), "heun", numbers));  // h w = 1/16
                for (const char* method : {"verlet", "rk4", "implicit_euler", "semi_implicit_euler", "pdmv8"})
                    EXPECT_FALSE(is_told(bouncing(up, 16384, 1, 0, on_ball), method, numbers)) << method;
            }
        }
        SceneDescription away = bouncing(0.5, 16384, 1, 0, false);
        away.gravity = {};
        EXPECT_FALSE(is_told(away, "heun", numbers));  // it meets nothing
        // But for what an event or a load may do.
        SceneDescription pushed = away, pulled = away, kicked = away;
        kicked.impulses.push_back({0.5, 0, Frame::world, {0, -1, 0}});
        pushed.forces.push_back({0, 0, 1, Frame::world, {0, -9.81, 0}});
        pulled.springs.push_back({0, {}, -1});
        pulled.springs[0].stiffness = 10;
        for (const SceneDescription& scene : {kicked, pushed, pulled}) EXPECT_TRUE(is_told(scene, "heun", numbers));
        // Less is added in a shorter run, and a step beyond what other loads stand is no reason.
        SceneDescription brief = bouncing(0.5, 20000, 1, 0, false);
        brief.duration = 0.03;
        EXPECT_FALSE(is_told(brief, "heun", numbers));
        // Damping goes by mass, and two that are free to move by both.
        EXPECT_TRUE(is_told(bouncing(0.5, 65536, 4, 10, false), "heun", numbers));
        EXPECT_FALSE(is_told(bouncing(0.5, 65536, 4, 40, false), "heun", numbers));
        SceneDescription pair = bouncing(0.5, 800, 1, 0, true);
        EXPECT_FALSE(is_told(pair, "heun", numbers));
        pair.gravity = {};
        pair.bodies[0].velocity = {0, -2, 0};
        pair.bodies[1].fixed = false;
        pair.bodies[1].name = "ball";
        pair.bodies[1].mass = 30;
        EXPECT_FALSE(is_told(pair, "heun", numbers));
        pair.bodies[1].mass = 0.05;
        EXPECT_TRUE(is_told(pair, "heun", numbers));
        // A rod is lifted by four springs at most, and tilted by them all the faster; and it may turn into contact.
        SceneDescription rod = bouncing(0.5, 800, 1, 0, false), turning = rod;
        EXPECT_FALSE(is_told(rod, "heun", numbers));
        for (SceneDescription* scene : {&rod, &turning}) {
            scene->bodies[0].shape = {ShapeKind::capsule, {0.02, 0.3, 0}, {}};
            scene->duration = 1;
        }
        turning.gravity = {};
        turning.bodies[0].position[1] = 0.15;
        EXPECT_FALSE(is_told(turning, "heun", numbers));
        turning.bodies[0].angular_velocity = {1, 0, 0};
        SceneDescription high = turning, round = turning;
        high.bodies[0].position[1] = 0.5;
        round.bodies[0].shape = {ShapeKind::sphere, {0.2, 0, 0}, {}};
        for (const SceneDescription& scene : {high, round}) EXPECT_FALSE(is_told(scene, "heun", numbers));
        if (numbers == std::string{"q32"}) continue;  // in which impacts may turn it too fast, besides
        for (const SceneDescription& scene : {rod, turning}) EXPECT_TRUE(is_told(scene, "heun", numbers));
    }
    // What is told: heun doubles the energy.
    const Ended of_heun = run(bouncing(0.5, 16384, 1, 0, false), "heun", "f64"),
                of_rk4 = run(bouncing(0.5, 16384, 1, 0, false), "rk4", "f64");
    EXPECT_FALSE(of_heun.told);
    EXPECT_GT(of_heun.most_energy, 1.5);
    EXPECT_LT(of_rk4.most_energy, 1.1);
}

// A small box in a scene, and what else is there: it is warned of what it meets in 1 s, and of nothing else.
TEST(Limits, of_impacts_are_told_where_something_is_met_in_the_run) {
    const auto warned = [](const std::string& gravity, const std::string& velocity, const std::string& rest,
                           const std::string& edges = "0.02, 0.02, 0.02") {
        const auto limits = exceeded_limits(
            read_scene_text("name = \"box\"\n[world]\nstep = \"1/256\"\nduration = 1.0\ngravity = [" + gravity +
                                "]\n[contact]\nrestitution = 0.3\n" + rest +
                                "[[body]]\nname = \"box\"\nmass = 0.01\nposition = [0.0, 0.0, 1.0]\nvelocity = [" +
                                velocity + "]\nshape = { box = [" + edges + "] }\n",
                            "box.toml"),
            "verlet", "q32");
        return !limits.empty();
    };
    const auto body = [](const std::string& how) {
        return "[[body]]\nname = \"other\"\nmass = 0.01\nshape = { box = [0.02, 0.02, 0.02] }\n" + how + "\n";
    };
    const std::string table = "[[plane]]\nname = \"table\"\nnormal = [0.0, 0.0, 1.0]\n", none = "0.0, 0.0, 0.0",
                      down = "0.0, 0.0, -9.81", plate = "0.2, 0.002, 0.01";
    EXPECT_TRUE(warned(down, none, table));
    EXPECT_TRUE(warned(down, "0.0, 3.0, 0.0", table));
    EXPECT_TRUE(warned(down, "0.0, 0.0, 3.5", table));
    EXPECT_FALSE(warned(down, "0.0, 0.0, 8.0", table));  // comes back after 1.7 s
    EXPECT_TRUE(warned(none, "1.0, 0.0, -4.0", table));
    EXPECT_FALSE(warned(none, "0.0, 0.0, -0.9", table));
    EXPECT_FALSE(warned(none, "0.0, 0.0, 9.0", table));
    EXPECT_FALSE(warned(none, "9.0, -5.0, 0.0", table));
    // A body that is fixed, below, beside, and in the way.
    EXPECT_TRUE(warned(down, none, body("fixed = true\nposition = [0.0, 0.0, 0.1]")));
    EXPECT_FALSE(warned(down, none, body("fixed = true\nposition = [50.0, 0.0, 0.1]")));
    EXPECT_FALSE(warned(down, none, body("fixed = true\nposition = [0.0, -0.1, 0.1]")));
    EXPECT_TRUE(warned(none, "8.0, 0.0, 0.0", body("fixed = true\nposition = [3.0, 0.0, 1.0]")));
    EXPECT_FALSE(warned(none, "-8.0, 0.0, 0.0", body("fixed = true\nposition = [3.0, 0.0, 1.0]")));
    // One that moves.
    EXPECT_TRUE(warned(none, "-4.0, 0.0, 0.0", body("position = [-3.0, 0.0, 1.0]\nvelocity = [4.0, 0.0, 0.0]")));
    EXPECT_FALSE(warned(down, "4.0, 0.0, 0.0", body("position = [-3.0, 0.0, 1.0]\nvelocity = [4.0, 0.0, 0.0]")));
    // Slow about two axes, fast about the third.
    EXPECT_TRUE(warned(down, none, table, plate));
    EXPECT_FALSE(warned(down, none, table, "0.4, 0.2, 0.3"));
}

// What is told to do about an impact is a scene that the reader takes, of which nothing more is told, and which runs.
TEST(Limits, of_impacts_tell_what_holds_them) {
    int ranges = 0;
    for (const auto& [edge, height] : {std::pair{0.02, 1.0}, {0.015, 0.8}, {0.012, 1.0}, {0.03, 1.2}, {0.02, 0.6}}) {
        for (const char* method : {"verlet", "rk4"}) {
            const auto scene_text = [&](const std::string& step, const std::string& range) {
                return "name = \"dice\"\n[world]\nstep = " + step + "\nduration = 0.8\n" +
                       falling_die(edge, height, {0, 1, 0}) + range;
            };
            const auto limits =
                exceeded_limits(read_scene_text(scene_text("\"1/256\"", ""), "dice.toml"), method, "q32");
            ASSERT_EQ(limits.size(), 1u);
            const std::string& sentence = limits[0].sentence;
            SCOPED_TRACE(sentence);
            const auto number_after = [&](const std::string& words) {
                return cpp_number(std::stod(sentence.substr(sentence.find(words) + words.size())));
            };
            const bool is_held =
                sentence.find("no [range] is sure to hold it, but floating point does") == std::string::npos;
            ranges += is_held ? 1 : 0;
            const std::string step = is_held ? number_after("and a step of ") : "\"1/256\"",
                              range = is_held ? number_after("angular_velocity of ") : "64.0";
            const Outcome outcome = run_of(scene_text(step, "[range]\nangular_velocity = " + range + "\n"),
                                           {"--integrator", method, "--numbers", is_held ? "q32" : "f64"});
            EXPECT_EQ(outcome.status, 0) << outcome.text;
            EXPECT_EQ(outcome.text.find("warning"), std::string::npos) << outcome.text;
        }
    }
    EXPECT_GE(ranges, 4);
}

// What the page of stability says in its own words.
TEST(Limits, on_the_page_of_stability_are_what_methods_do) {
    const std::string page = contents((source_directory / "bench/STABILITY.md").string());
    const auto says = [&](const char* words) { EXPECT_NE(page.find(words), std::string::npos) << words; };
    says("| springs | `verlet` for ever, `rk4` or `suzuki4` for digits | `h w < 0.1` for errors of a thousandth");
    for (const char* name : {"verlet", "rk4", "suzuki4"})
        EXPECT_NEAR(std::acos(find_integrator(name).oscillator_step(0.01, 0).trace() / 2), 0.1, 1e-4) << name;
    says("| dampers and drag | `verlet`, `rk4`; strong ones `implicit_midpoint` | `h c/m < 1` keeps the sign");
    for (const char* name : {"verlet", "rk4", "implicit_midpoint"})
        EXPECT_GT(find_integrator(name).oscillator_step(0, 1).vv, 0) << name;
    says("in `q32` a turn of 1/4 rad: `h < 1/(4 abs(w))`, half of that about the axis of a disc");
    const auto turn_held = [](const std::string& shape) {
        const SceneDescription scene = with_step(scene_of("[[body]]\nname = \"b\"\nmass = 0.7\nshape = " + shape +
                                                          "\nangular_velocity = [0.0, 0.0, 60.0]\n"),
                                                 1.0 / 128);
        const auto limits = exceeded_limits(scene, "verlet", "q32");
        return limits.size() == 1 ? limits[0].limit / 128 : 0;
    };
    EXPECT_NEAR(turn_held("{ sphere = 0.1 }"), 0.25, 0.01);
    EXPECT_NEAR(turn_held("{ hoop = 0.1 }"), 0.125, 0.005);
    says("`z = 1/16` on for `explicit_euler`, from 0.354 on for the others");
    const auto told_from = [](const char* name) {
        return 1 / std::sqrt(find_integrator(name).step_bounds.of_spring[0]);
    };
    EXPECT_NEAR(told_from("explicit_euler"), 1.0 / 16, 1e-6);
    for (const char* name : {"heun", "midpoint"}) EXPECT_NEAR(told_from(name), 0.354, 5e-4);
}

}  // namespace
}  // namespace tumble::host
