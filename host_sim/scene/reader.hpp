// Reads a scene file (TOML) into a SceneDescription and checks every rule of the format.
// The first thing wrong is thrown as a SceneError that names file, line, key and what was expected.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "scene/description.hpp"
#include "scene/error.hpp"

namespace tumble::host {

// A run may not take more steps than this.
inline constexpr std::int64_t max_steps = std::int64_t{1} << 31;

// A scene without [[body]] is nearly always a mistake; whoever measures what a world costs before its first body means
// it.
enum class BodyCount { at_least_one, any };

// Reads and checks a scene file.
[[nodiscard]] SceneDescription read_scene(const std::filesystem::path& path,
                                          BodyCount bodies = BodyCount::at_least_one);

// The same for TOML that is already in memory; `name` stands for the file in messages and in SceneDescription::path.
[[nodiscard]] SceneDescription read_scene_text(std::string_view toml, std::string_view name,
                                               BodyCount bodies = BodyCount::at_least_one);

}  // namespace tumble::host
