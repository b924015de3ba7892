// Writes a SceneDescription as a scene file (TOML), which `tumble run` takes.
#pragma once

#include <string>

#include "scene/description.hpp"

namespace tumble::host {

// read_scene_text() makes the same scene of it, numbers to their last bit. Shapes `points` are not written.
[[nodiscard]] std::string scene_text(const SceneDescription& scene);
// A table [[event]] of the scene, which may follow the text of its file.
[[nodiscard]] std::string event_text(const EventDescription& event, const SceneDescription& scene);
// A table [[impulse]], and the table [expect]; the same.
[[nodiscard]] std::string impulse_text(const ImpulseDescription& impulse, const SceneDescription& scene);
[[nodiscard]] std::string expectation_text(const Expectation& expected);

}  // namespace tumble::host
