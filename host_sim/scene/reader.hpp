// Reads a scene file (TOML) into a SceneDescription and checks every rule of the format.
// The first thing wrong is thrown as a SceneError that names file, line, key and what was expected.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "scene/description.hpp"

namespace tumble::host {

// What is wrong with a scene file; what() is "file:line: key: message, expected ...".
class SceneError : public std::runtime_error {
public:
    SceneError(std::string file, int line, std::string key, const std::string& message);

    [[nodiscard]] const std::string& file() const { return file_; }
    [[nodiscard]] int line() const { return line_; }               // 0: the file could not be read at all
    [[nodiscard]] const std::string& key() const { return key_; }  // for example body[1].mass; indices start at 0

private:
    std::string file_;
    int line_;
    std::string key_;
};

// A run may not take more steps than this.
inline constexpr std::int64_t max_steps = std::int64_t{1} << 31;

// Reads and checks a scene file.
[[nodiscard]] SceneDescription read_scene(const std::filesystem::path& path);

// The same for TOML that is already in memory; `name` stands for the file in messages and in SceneDescription::path.
[[nodiscard]] SceneDescription read_scene_text(std::string_view toml, std::string_view name);

// A step size as a person writes it: "1/256" or "0.005". Empty when it is neither, or not positive.
[[nodiscard]] std::optional<StepSize> parse_step(std::string_view text);

}  // namespace tumble::host
