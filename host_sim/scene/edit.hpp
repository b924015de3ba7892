// Changes of the text of a scene file, which keep the rest of it as it was written.
#pragma once

#include <string>

#include "scene/description.hpp"

namespace tumble::host {

// The text without the table [expect].
[[nodiscard]] std::string without_expectation(const std::string& text);

// The text with another value of a key of a table; unchanged where it has no such key.
[[nodiscard]] std::string with_value(const std::string& text, const char* table, const char* key,
                                     const std::string& value);

// s: the duration of the scene, or the latest time that it names if that is later. The reader refuses times after the
// end.
[[nodiscard]] double readable_duration(const SceneDescription& scene);

}  // namespace tumble::host
