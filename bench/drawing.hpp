// Shared by the pictures: formatted text, and a drawing by gnuplot as a small SVG file.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string>

namespace tumble::bench {

[[nodiscard]] inline std::string text(const char* format, auto... values) {
    char buffer[256];
    std::snprintf(buffer, sizeof buffer, format, values...);
    return buffer;
}

// Writes to `svg` what svg_by_gnuplot() draws, in fewer characters: tenths of a pixel, and no groups of nothing.
void draw(const std::string& script, const std::filesystem::path& svg);

}  // namespace tumble::bench
