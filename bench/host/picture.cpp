// Draws the time of a step, divided by the number of bodies, against that number, a panel a scene: this kernel in each
// number system and each engine's fastest method.
#include "host/host_rows.hpp"
#include "pictures/drawing.hpp"

#include <optional>

namespace tumble::bench {
namespace {

struct Style {
    const char *name, *engine, *numbers, *color;
    int mark;  // gnuplot's point type
};
// Colors of Okabe and Ito; this kernel's are those of the pictures of work against precision.
constexpr Style styles[]{{"tumble q32", "tumble", "q32 carry", "#0072b2", 7},
                         {"tumble f32 plain", "tumble", "f32 plain", "#d55e00", 5},
                         {"tumble f64", "tumble", "f64", "#009e73", 9},
                         {"Boost.Odeint", "Boost.Odeint", "", "#707070", 1},
                         {"Bullet", "Bullet", "", "#cc79a7", 2},
                         {"ODE", "ODE", "", "#a06e00", 3},
                         {"MuJoCo", "MuJoCo", "", "#2f83b5", 4}};

constexpr double panel_width = 400, panel_height = 250, left = 75, top = 90, bottom = 60, gap = 45, row_gap = 72,
                 right = 25;
constexpr double width = left + 2 * panel_width + gap + right;

std::optional<double> ns(const HostRows& rows, const std::string& scene, int bodies, const Style& style) {
    const bool own = style.engine == std::string{HostRows::own};
    const Row* row =
        own ? rows.kernel(scene, bodies, style.numbers, "verlet") : rows.fastest(scene, bodies, style.engine);
    if (row == nullptr || !row->contains(HostRows::time)) return {};
    return row->at(HostRows::time).get<double>();
}

std::string script(const HostRows& rows) {
    const auto scenes = rows.scenes(true);
    if (scenes.empty()) throw std::runtime_error{"no scene has rows of several numbers of bodies"};
    const std::size_t lines = (scenes.size() + 1) / 2;
    const double height = top + static_cast<double>(lines) * (panel_height + row_gap) - row_gap + bottom;
    std::string out = start_of_picture(width, height, 13) + logarithmic_axes +
                      text("set label 'time of a step, divided by the bodies' at screen %g,%g font ',18'\n",
                           left / width, 1 - 22 / height);
    double x = left;
    for (const Style& style : styles) {
        out += text("set label '' at screen %g,%g point pointtype %d pointsize 0.7 linecolor '%s'\n", (x + 5) / width,
                    1 - 50 / height, style.mark, style.color);
        out += text("set label '%s' noenhanced at screen %g,%g textcolor '%s'\n", style.name, (x + 15) / width,
                    1 - 50 / height, style.color);
        x += 8.1 * static_cast<double>(std::string{style.name}.size()) + 38;
    }
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const double from_left = left + static_cast<double>(i % 2) * (panel_width + gap),
                     from_bottom = height - top - static_cast<double>(i / 2) * (panel_height + row_gap) - panel_height;
        out += panel_at(from_left, from_bottom, panel_width, panel_height, width, height);
        out += "set title '" + scenes[i] + "' noenhanced offset 0,-0.6\n";
        out += i % 2 == 0 ? "set ylabel 'ns'\n" : "unset ylabel\n";
        out += i / 2 + 1 == lines ? "set xlabel 'bodies in the world'\n" : "unset xlabel\n";
        std::string curves, data;
        for (const Style& style : styles) {
            std::string points;
            for (const int bodies : rows.sizes(scenes[i]))
                if (const auto time = ns(rows, scenes[i], bodies, style)) points += text("%d %.4g\n", bodies, *time);
            if (points.empty()) continue;
            curves += text(
                "%s'-' with linespoints linewidth 1.5 pointsize 0.7 pointtype %d linecolor '%s' title '%s' noenhanced",
                curves.empty() ? "" : ", ", style.mark, style.color, style.name);
            data += points + "e\n";
        }
        out += "plot " + curves + "\n" + data + "unset label\n";
    }
    return out + "unset multiplot\n";
}

}  // namespace

void draw_host(const HostRows& rows, const std::filesystem::path& svg) { draw(script(rows), svg); }

}  // namespace tumble::bench
