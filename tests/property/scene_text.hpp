// A scene as the TOML that it could have been read from: what a test has made up, as a file that `tumble run` takes.
#pragma once

#include <string>

#include "scene/description.hpp"

namespace tumble::host {

// read_scene_text() of it gives the same description, numbers to their last bit. Shapes `points` are not written.
[[nodiscard]] std::string scene_text(const SceneDescription& scene);

}  // namespace tumble::host
