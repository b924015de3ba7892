// `tumble run --live`.
#pragma once

#include <string>

#include "command/command.hpp"

namespace tumble::host {

// Runs the scene under events that come as JSON lines on standard input, and writes its state as JSON lines to standard
// output. `record`: a file for the scene with these events; empty: none. Returns the exit status.
[[nodiscard]] int run_live(const Choice& choice, const std::string& record);

}  // namespace tumble::host
