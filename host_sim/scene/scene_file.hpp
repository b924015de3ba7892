// Scenes in files.
#pragma once

#include <filesystem>

#include "scene/reader.hpp"

namespace tumble::host {

// Reads and checks a scene file. Throws a SceneError.
[[nodiscard]] SceneDescription read_scene(const std::filesystem::path& path,
                                          BodyCount bodies = BodyCount::at_least_one);

}  // namespace tumble::host
