// Drawings by gnuplot.
#pragma once

#include <string>

namespace tumble::host {

// What gnuplot draws by a script whose terminal is svg and which names no output. Throws std::runtime_error.
[[nodiscard]] std::string svg_by_gnuplot(const std::string& script);

}  // namespace tumble::host
