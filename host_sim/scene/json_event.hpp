// Events of a live run: JSON objects with the keys of [[event]] but `time`.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "scene/description.hpp"

namespace tumble::host {

// A number of steps that a controller asks for: {"step": 1}.
struct StepsWanted {
    std::int64_t count = 1;
};
using LiveLine = std::variant<EventDescription, StepsWanted>;

// Reads a line of standard input. Throws SceneError, which names the line, the key and what was expected.
[[nodiscard]] LiveLine read_live_line(const std::string& text, int line, const SceneDescription& scene);

}  // namespace tumble::host
