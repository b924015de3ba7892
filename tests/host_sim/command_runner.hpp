// Runs the command `tumble` as a user does.
#pragma once

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
// Checks the exit status and a part of the output.
inline void expect_outcome(const Outcome& outcome, int status, const std::string& part) {
    EXPECT_EQ(outcome.status, status) << outcome.text;
    EXPECT_TRUE(has(outcome.text, part)) << outcome.text << "\nexpected: " << part;
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

// A scene of 26 steps with a floor below its bodies.
[[nodiscard]] inline std::string scene_of(const std::string& contact, const std::string& bodies) {
    return "name = \"test\"\n[world]\nstep = \"1/256\"\nduration = 0.1\n" + contact +
           "[[plane]]\nname = \"floor\"\nnormal = [0.0, 1.0, 0.0]\noffset = 10.0\n" + bodies;
}
// Of 1 kg; at the origin where no position is given.
[[nodiscard]] inline std::string body_of(const std::string& name, const std::string& shape,
                                         const std::string& position = "") {
    return "[[body]]\nname = \"" + name + "\"\nshape = { " + shape + " }\nmass = 1.0\n" +
           (position.empty() ? "" : "position = " + position + "\n");
}

}  // namespace tumble::host
