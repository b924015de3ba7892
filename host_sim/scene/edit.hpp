// Changes of the text of a scene file, which keep the rest of it as it was written.
#pragma once

#include <string>

namespace tumble::host {

// The text without the table [expect].
[[nodiscard]] std::string without_expectation(const std::string& text);

// The text with another value of a key of a table; unchanged where it has no such key.
[[nodiscard]] std::string with_value(const std::string& text, const char* table, const char* key,
                                     const std::string& value);

}  // namespace tumble::host
