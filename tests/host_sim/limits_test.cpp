// Limits that are told before a run: what they call safe is safe, and a fifth more is not.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "command_runner.hpp"
#include "scene/reader.hpp"
#include "simulation/limits.hpp"
#include "simulation/simulation.hpp"

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
}

}  // namespace
}  // namespace tumble::host
