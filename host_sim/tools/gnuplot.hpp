// Draws with gnuplot.
#pragma once

#include <string>

namespace tumble::host {

// Throws std::runtime_error where there is no gnuplot.
void require_gnuplot();

// The SVG that a script draws. The script sets the terminal svg and no output. Throws std::runtime_error.
[[nodiscard]] std::string svg_by_gnuplot(const std::string& script);

}  // namespace tumble::host
