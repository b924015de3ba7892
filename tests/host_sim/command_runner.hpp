// Runs the command `tumble` as a user does.
#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tools/process.hpp"

namespace tumble::host {

using Json = nlohmann::json;

[[nodiscard]] inline bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}
[[nodiscard]] inline std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

inline const std::filesystem::path source_directory = TUMBLE_SOURCE_DIR;

[[nodiscard]] inline std::string shipped(const std::string& name) {
    return (source_directory / "host_sim/scenes" / (name + ".toml")).string();
}

// All shipped scene files.
[[nodiscard]] inline std::vector<std::string> shipped_scenes() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(source_directory / "host_sim/scenes"))
        if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
    return names;
}

struct Outcome {
    int status;
    std::string text;
};
[[nodiscard]] inline Outcome tumble(std::vector<std::string> arguments,
                                    Process::Errors errors = Process::Errors::merge) {
    arguments.insert(arguments.begin(), TUMBLE_COMMAND);
    Outcome outcome{};
    Process process(arguments, {}, errors);
    outcome.status = process.wait(&outcome.text);
    return outcome;
}

// What the command prints with --json. The test prints the messages of the command.
[[nodiscard]] inline Json json_of(std::vector<std::string> arguments, int status = 0) {
    arguments.emplace_back("--json");
    const Outcome outcome = tumble(std::move(arguments), Process::Errors::pass);
    EXPECT_EQ(outcome.status, status) << outcome.text;
    return Json::parse(outcome.text);
}
// Checks that a text has all these parts.
inline void expect_parts(const std::string& text, const std::vector<std::string>& parts) {
    for (const std::string& part : parts) EXPECT_TRUE(has(text, part)) << text << "\nexpected: " << part;
}
// Checks the exit status and parts of the output.
inline void expect_outcome(const Outcome& outcome, int status, const auto&... parts) {
    EXPECT_EQ(outcome.status, status) << outcome.text;
    expect_parts(outcome.text, {std::string(parts)...});
}
// What the command prints, errors too, when it ends with this status.
[[nodiscard]] inline std::string text_of(const std::vector<std::string>& arguments, int status = 0) {
    const Outcome outcome = tumble(arguments);
    EXPECT_EQ(outcome.status, status) << outcome.text;
    return outcome.text;
}
// Arguments, followed by others.
[[nodiscard]] inline std::vector<std::string> with(std::vector<std::string> arguments,
                                                   const std::vector<std::string>& others) {
    arguments.insert(arguments.end(), others.begin(), others.end());
    return arguments;
}

// Runs a function in a process of its own, which leaves no core file. Returns its status, as waitpid() tells it.
template <class Body>
[[nodiscard]] int status_in_a_process(const Body& body) {
    const pid_t program = fork();
    if (program == 0) {
        const rlimit no_core{0, 0};
        setrlimit(RLIMIT_CORE, &no_core);
        body();
        _exit(0);
    }
    int status = 0;
    EXPECT_EQ(waitpid(program, &status, 0), program);
    return status;
}

// A file of this test alone.
[[nodiscard]] inline std::string temporary(const std::string& name) {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    std::string stem = std::string(test->test_suite_name()) + "." + test->name();
    for (char& c : stem) c = c == '/' ? '_' : c;
    const std::filesystem::path directory = std::filesystem::path(testing::TempDir()) / stem;
    std::filesystem::create_directories(directory);
    return (directory / name).string();
}
[[nodiscard]] inline std::string written(const std::string& name, const std::string& text) {
    const std::string path = temporary(name);
    std::ofstream(path) << text;
    return path;
}
[[nodiscard]] inline std::string contents(const std::string& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

// --- parts of scenes -------------------------------------------------------------------------------------------------

inline const std::string floor_plane = "[[plane]]\nname = \"floor\"\nnormal = [0.0, 1.0, 0.0]\n",
                         smallest_range = "[range]\nposition = 64.0\nvelocity = 32.0\nangular_velocity = 32.0\n";

// With gravity along y, m/s^2.
[[nodiscard]] inline std::string world_of(const std::string& gravity, const std::string& step,
                                          const std::string& duration) {
    return "[world]\ngravity = [0.0, " + gravity + ", 0.0]\nstep = \"" + step + "\"\nduration = " + duration + "\n";
}
// A scene of 26 steps with a floor below its bodies.
[[nodiscard]] inline std::string scene_of(const std::string& contact, const std::string& bodies) {
    return "name = \"test\"\n[world]\nstep = \"1/256\"\nduration = 0.1\n" + contact + floor_plane + "offset = 10.0\n" +
           bodies;
}
// At the origin where no position is given; the mass in kg.
[[nodiscard]] inline std::string body_of(const std::string& name, const std::string& shape,
                                         const std::string& position = "", const std::string& mass = "1.0") {
    return "[[body]]\nname = \"" + name + "\"\nshape = { " + shape + " }\nmass = " + mass + "\n" +
           (position.empty() ? "" : "position = " + position + "\n");
}
// n by n boxes side by side on a floor. They have more neighbours than a heap of spheres: four by four 58 pairs.
[[nodiscard]] inline std::string packed_boxes(int n, const std::string& duration) {
    std::string scene =
        world_of("-9.81", "1/256", duration) + "[contact]\nrestitution = 0.0\nfriction = 0.5\n" + floor_plane;
    for (int i = 0; i < n * n; ++i)
        scene += body_of("b" + std::to_string(i), "box = [0.5, 0.5, 0.5]",
                         "[" + std::to_string(0.5 * (i / n)) + ", 0.25, " + std::to_string(0.5 * (i % n)) + "]");
    return scene;
}
// The keys of [[joint]] for one of this kind; without `to`, with the world.
[[nodiscard]] inline std::string joint_of(const std::string& kind, const std::string& body, const std::string& to,
                                          const std::string& anchor, const std::string& axes = "") {
    return "[[joint]]\nkind = \"" + kind + "\"\nbody = \"" + body + "\"\n" +
           (to.empty() ? "" : "to_body = \"" + to + "\"\n") + "anchor = " + anchor + "\n" + axes;
}
// Two trees of 2 s with a joint of each kind: links on a hinge, a ball and a universal joint, and a carriage with a
// load fixed to it, which slides down a slope of 45 degrees.
inline const std::string scene_of_every_joint =
    world_of("-9.81", "1/256", "2.0") + smallest_range + body_of("a", "box = [0.5, 0.1, 0.1]", "[0.25, 0.0, 0.0]") +
    body_of("b", "box = [0.5, 0.1, 0.2]", "[0.75, 0.0, 0.0]") +
    body_of("c", "box = [0.5, 0.2, 0.1]", "[1.25, 0.0, 0.0]") + body_of("carriage", "sphere = 0.2", "[0.0, 3.0, 0.0]") +
    body_of("load", "box = [0.1, 0.2, 0.3]", "[0.5, 3.5, 0.0]") +
    joint_of("hinge", "a", "", "[0.0, 0.0, 0.0]", "axis = [0.0, 0.0, 1.0]\n") +
    joint_of("ball", "b", "a", "[0.5, 0.0, 0.0]") +
    joint_of("universal", "c", "b", "[1.0, 0.0, 0.0]", "axis = [0.0, 1.0, 0.0]\nto_axis = [0.0, 0.0, 1.0]\n") +
    joint_of("slider", "carriage", "", "[0.0, 3.0, 0.0]", "axis = [-2.0, -2.0, 0.0]\n") +
    joint_of("fixed", "load", "carriage", "[0.5, 3.0, 0.0]");
// A joint of this kind that keeps the distance of a point of a body and a point of the world; without `to`.
[[nodiscard]] inline std::string distance_of(const std::string& body, const std::string& point,
                                             const std::string& to_point, const std::string& range) {
    return "[[joint]]\nkind = \"distance\"\nbody = \"" + body + "\"\npoint = " + point + "\nto_point = " + to_point +
           "\n" + range + "\n";
}

// Bodies of 2 s, each on a joint of its own: with a spring about each axis and along each line, and no damper. The
// distance is the last.
inline const std::string scene_of_springs =
    world_of("-9.81", "1/1024", "2.0") + smallest_range + body_of("door", "box = [1, 2, 0.1]", "[0.5, 0, 0]", "2.5") +
    "velocity = [0, 0, -1]\nangular_velocity = [0, 2, 0]\n" + body_of("arm", "box = [1, 0.2, 0.1]", "[5.5, 0, 0]") +
    body_of("cross", "box = [0.5, 0.25, 0.75]", "[10, 0.25, 0.125]", "1.5") +
    body_of("drawer", "box = [0.5, 0.25, 0.75]", "[15, 0, 0]", "4.0") +
    body_of("weight", "sphere = 0.2", "[20, -1, 0]") + "layers = 0\n" +
    joint_of("hinge", "door", "", "[0, 0, 0]", "axis = [0, 1, 0]\nspring = { stiffness = 12, angle = -0.75 }\n") +
    joint_of("ball", "arm", "", "[5, 0, 0]", "spring = { stiffness = 9 }\n") +
    joint_of("universal", "cross", "", "[10, 0, 0]",
             "axis = [1, 0, 0]\nto_axis = [0, 0, 1]\nspring = { stiffness = 8, angle = 0.5 }\n"
             "to_spring = { stiffness = 5, angle = -0.25 }\n") +
    joint_of("slider", "drawer", "", "[15, 0, 0]", "axis = [1, 1, 0]\nspring = { stiffness = 150, travel = 0.125 }\n") +
    distance_of("weight", "[20, -1, 0]", "[20.5, 0, 0]", "most = 3\nspring = { stiffness = 60, rest_length = 0.75 }");

}  // namespace tumble::host
