// Reads the text of a scene (TOML) into a SceneDescription and checks every rule of the format.
// The first error is thrown as a SceneError that names file, line, key and the expected value.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "scene/description.hpp"
#include "scene/error.hpp"

namespace tumble::host {

// A run may not take more steps than this.
inline constexpr std::int64_t max_steps = std::int64_t{1} << 31;

// A scene without [[body]] is nearly always a mistake. It is meant where the cost of an empty world is measured.
enum class BodyCount { at_least_one, any };

// Reads and checks TOML in memory. `name` takes the place of the file in messages and in SceneDescription::path.
[[nodiscard]] SceneDescription read_scene_text(std::string_view toml, std::string_view name,
                                               BodyCount bodies = BodyCount::at_least_one);

}  // namespace tumble::host
