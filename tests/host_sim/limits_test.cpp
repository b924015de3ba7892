// Limits that are told before a run: what they call safe is safe, and a fifth more is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

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

}  // namespace
}  // namespace tumble::host
