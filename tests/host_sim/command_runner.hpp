// Runs the command `tumble` as a user does.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tools/process.hpp"

namespace tumble::host {

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

}  // namespace tumble::host
