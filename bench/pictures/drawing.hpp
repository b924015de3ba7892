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

// Colors of Okabe and Ito, which color-blind readers tell apart, and for text a darker shade of the light ones. Each
// has a mark of its own too (gnuplot's point types), and the light ones a word in their labels.
struct NumberStyle {
    const char *numbers, *color, *text_color;
    int mark;
    const char* word;
};
inline constexpr NumberStyle number_styles[]{{"q32 carry", "#0072b2", "#0072b2", 7, ""},
                                             {"q32 plain", "#56b4e9", "#2f83b5", 6, " plain"},
                                             {"f32 plain", "#d55e00", "#c25500", 5, ""},
                                             {"f32 carry", "#e69f00", "#a06e00", 4, " carry"},
                                             {"f64", "#009e73", "#00835f", 9, ""}};

// Gnuplot's commands that start a picture of several panels; sizes in pixels.
[[nodiscard]] inline std::string start_of_picture(double width, double height, double font_size) {
    return text("set terminal svg size %g,%g font 'sans-serif,%g' background 'white'\n", width, height, font_size) +
           "set multiplot\nunset key\nset tics scale 0\nset border linecolor '#808080'\nset mxtics 1\n";
}

// Gnuplot's commands for axes of powers of ten.
inline constexpr const char* logarithmic_axes =
    "set logscale xy\nset format '10^{%L}'\nset mytics 1\nset grid linecolor '#e4e4e4' linetype 1\n";

// Gnuplot's commands for a panel at x and y, pixels from the lower left corner of the picture.
[[nodiscard]] inline std::string panel_at(double x, double y, double panel_width, double panel_height, double width,
                                          double height) {
    return text(
        "set lmargin at screen %g\nset rmargin at screen %g\nset bmargin at screen %g\nset tmargin at screen %g\n",
        x / width, (x + panel_width) / width, y / height, (y + panel_height) / height);
}

// Labels from the left to the right; sizes in pixels.
struct Legend {
    std::string& script;    // to which gnuplot's commands are added
    double width, height;   // of the picture
    double character, gap;  // what a label takes: each character, and behind it
    double x;               // of the next label

    void add(const std::string& what, double from_top, const std::string& more) {
        script += text("set label '%s' noenhanced at screen %g,%g %s\n", what.c_str(), x / width, 1 - from_top / height,
                       more.c_str());
        x += character * static_cast<double>(what.size()) + gap;
    }
};

// Writes to `svg` what svg_by_gnuplot() draws, in fewer characters: tenths of a pixel, and no groups of nothing.
void draw(const std::string& script, const std::filesystem::path& svg);

}  // namespace tumble::bench
