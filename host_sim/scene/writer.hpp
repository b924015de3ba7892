// Writes a SceneDescription as a scene file (TOML), which `tumble run` takes.
#pragma once

#include <string>

#include "scene/description.hpp"

namespace tumble::host {

// read_scene_text() makes the same scene of it, numbers to their last bit. Shapes `points` are not written.
[[nodiscard]] std::string scene_text(const SceneDescription& scene);
// A table [[event]] of the scene, which may follow the text of its file.
[[nodiscard]] std::string event_text(const EventDescription& event, const SceneDescription& scene);

}  // namespace tumble::host
