#include "pictures/long_run_rows.hpp"

#include "pictures/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace tumble::bench {
namespace {

// Splittings: their energy error is bounded, and their angular momentum changes by rounding only.
const std::set<std::string> conserving{"verlet", "strang", "suzuki4", "pdmv4", "pdmv6", "pdmv8", "pdmv10"};
// Splittings whose energy of a free rotation changes by rounding only.
[[nodiscard]] bool keeps_free_energy(const std::string& integrator) { return integrator.starts_with("pdmv"); }

// A unit of the number system is 2^-bits.
int bits_of(const std::string& numbers) {
    return numbers.starts_with("q32") ? 31 : numbers.starts_with("f32") ? 24 : 53;
}

// Of the values of a key, or its only one.
double largest(const Row& row, const char* key) {
    double most = 0;
    for (const Row& value : row.at(key)) most = std::max(most, value.get<double>());
    return most;
}

}  // namespace

double rounding_floor(const std::string& numbers, double steps) {
    return std::ldexp(8 * std::sqrt(steps), -bits_of(numbers));
}
double biased_floor(const std::string& numbers, double steps) { return std::ldexp(steps / 16, -bits_of(numbers)); }

std::string Promise::text() const {
    return quantity + (kind == Kind::below ? bench::text(" at most %.1e", bound)
                                           : bench::text(" in the last tenth at most twice the first and %.1e", bound));
}

std::vector<Promise> promises_of(const Row& row) {
    std::vector<Promise> promises;
    if (row.contains("failure")) return promises;
    const std::string scene = row.at("scene"), integrator = row.at("integrator"), numbers = numbers_of(row);
    const double steps = row.at("steps");
    double floor = rounding_floor(numbers, steps);
    const auto below = [&](const char* key, double bound) {
        promises.push_back({key, Promise::Kind::below, bound, largest(row, key), bound});
    };
    const bool in_contact = row.contains("penetration_m");
    if (in_contact) {
        // Touching bodies overlap by less than the default tolerance of contacts, 1 mm.
        below("penetration_m", 1e-3);
        // Each impact rounds the energy too.
        below("energy", row.contains("shift_m") ? 1e-3 : 16 * floor);
        if (row.contains("shift_m")) below("shift_m", 1e-3);
    } else if (conserving.contains(integrator)) {
        const bool free = scene == "generic top", by_pdmv = keeps_free_energy(integrator);
        // With loads a pdmv prepares constants at each step. Their rounding is a drift, not a random walk.
        if (by_pdmv && !free) floor = std::max(floor, biased_floor(numbers, steps));
        const double first = row.at("energy_first_tenth"), last = row.at("energy_last_tenth");
        promises.push_back({"energy", Promise::Kind::steady, floor, last, 2 * first + floor});
        if (by_pdmv && free) {
            if (numbers == "f64") below("energy", 1e-9);
            if (numbers == "q32 carry") below("energy", 1e-5);
        }
        below("momentum", floor);
    }
    return promises;
}

std::vector<std::string> broken_promises(const std::vector<Row>& rows) {
    std::vector<std::string> broken;
    for (const Row& row : rows) {
        const std::string of = row.at("scene").get<std::string>() + ", " + row.at("integrator").get<std::string>() +
                               " " + numbers_of(row) + ": ";
        if (row.contains("failure") && (conserving.contains(row.at("integrator")) || row.contains("penetration_m")))
            broken.push_back(of + row.at("failure").get<std::string>());
        for (const Promise& promise : promises_of(row))
            if (!promise.is_kept()) broken.push_back(of + promise.text() + text(", measured %.2e", promise.measured));
    }
    return broken;
}

namespace {

// Each method has its own mark and dashes, and its own shade of a number system's color: below 0 towards black, above 0
// towards white.
struct MethodStyle {
    const char* integrator;
    int mark, dashes;
    double shade;
};
constexpr MethodStyle method_styles[]{{"verlet", 7, 1, 0},
                                      {"suzuki4", 5, 2, -0.5},
                                      {"pdmv6", 9, 4, 0.45},
                                      {"rk4", 2, 3, -0.25},
                                      {"semi_implicit_euler", 4, 5, 0.25}};

// "#rrggbb"
std::string shaded(const std::string& color, double shade) {
    std::string result = "#";
    for (std::size_t i = 1; i < 7; i += 2) {
        const int channel = std::stoi(color.substr(i, 2), nullptr, 16), end = shade < 0 ? 0 : 255;
        result += text("%02x", channel + static_cast<int>(std::abs(shade) * (end - channel)));
    }
    return result;
}

struct PanelKind {
    const char *scene, *key, *title, *axis;
};
constexpr PanelKind panels[]{{"generic top", "energy", "free top: energy", "largest relative error"},
                             {"heavy top", "energy", "heavy top: energy", ""},
                             {"Kepler orbit", "energy", "Kepler orbit: energy", ""},
                             {"elastic box", "energy", "elastic box: energy", ""},
                             {"generic top", "momentum", "free top: angular momentum", "largest relative error"},
                             {"heavy top", "momentum", "heavy top: vertical angular momentum", ""},
                             {"Kepler orbit", "momentum", "Kepler orbit: angular momentum", ""},
                             {"elastic box", "penetration_m", "elastic box: penetration, m", ""},
                             {"ten-box stack", "energy", "ten boxes awake: energy", "largest relative error"},
                             {"ten-box stack", "penetration_m", "ten boxes awake: penetration, m", ""},
                             {"ten boxes asleep", "energy", "ten boxes asleep: energy", ""},
                             {"ten boxes asleep", "penetration_m", "ten boxes asleep: penetration, m", ""}};
constexpr int columns = 4, panel_rows = 3;
static_assert(std::size(panels) == columns * panel_rows);

class LongRunPicture {
public:
    explicit LongRunPicture(const std::vector<Row>& rows) : rows_(rows) {}

    [[nodiscard]] std::string script() const {
        std::string out =
            start_of_picture(width(), height(), font_size) + logarithmic_axes + "set tics textcolor 'black'\n";
        legend(out);
        for (std::size_t i = 0; i < std::size(panels); ++i) panel(out, i);
        return out + "unset multiplot\n";
    }

private:
    static constexpr double panel_width = 265, panel_height = 200, left = 75, right = 20, top = 104, bottom = 55,
                            gap = 48, row_gap = 62, font_size = 12;
    static double width() { return left + columns * (panel_width + gap) - gap + right; }
    static double height() { return top + panel_rows * (panel_height + row_gap) - row_gap + bottom; }

    void legend(std::string& out) const {
        Legend labels{out, width(), height(), 0.6 * font_size, 16, left};
        labels.add("What is conserved, over the number of steps", 20, "font ',16'");
        labels.x = left;
        for (const NumberStyle& style : number_styles) {
            const auto of_style = [&](const Row& row) { return numbers_of(row) == style.numbers; };
            if (!std::any_of(rows_.begin(), rows_.end(), of_style)) continue;
            labels.add("", 44, text("point pointtype 5 pointsize 0.9 linecolor '%s'", style.color));
            labels.add(style.numbers, 44, text("textcolor '%s'", style.text_color));
        }
        labels.x += 30;
        for (const MethodStyle& style : method_styles) {
            labels.add("", 44,
                       text("point pointtype %d pointsize 0.7 linecolor '%s'", style.mark,
                            shaded("#606060", style.shade).c_str()));
            labels.x -= 4;
            labels.add(style.integrator, 44, "textcolor '#404040'");
            labels.x += 8;
        }
        labels.x = left;
        labels.add(
            "each point: the largest since the point before; zero has no point; a method has its own shade of the "
            "color",
            62, "textcolor '#606060' font ',11'");
    }

    void panel(std::string& out, std::size_t index) const {
        const PanelKind& kind = panels[index];
        const auto column = static_cast<double>(index % columns), row_of = static_cast<double>(index / columns);
        const double x = left + column * (panel_width + gap),
                     y = height() - top - row_of * (panel_height + row_gap) - panel_height;
        out += panel_at(x, y, panel_width, panel_height, width(), height());
        out += std::string{"set title '"} + kind.title + "' offset 0,-0.7\n";
        out += *kind.axis == 0 ? std::string{"unset ylabel\n"} : std::string{"set ylabel '"} + kind.axis + "'\n";
        out += index / columns + 1 == panel_rows ? "set xlabel 'steps' offset 0,0.5\n" : "unset xlabel\n";
        std::string plots, data;
        double least = 1, most = 1e-30;
        bool has_rows = false;
        for (const MethodStyle& method : method_styles) {
            for (const NumberStyle& style : number_styles) {
                for (const Row& row : rows_) {
                    if (row.at("scene") != kind.scene || row.at("integrator") != method.integrator ||
                        numbers_of(row) != style.numbers || !row.contains(kind.key))
                        continue;
                    has_rows = true;
                    std::string points;
                    const Row &at = row.at("at"), &values = row.at(kind.key);
                    double value = 0;
                    for (std::size_t i = 0; i < at.size(); ++i) {
                        value = std::max(value, values[i].get<double>());
                        const bool shown = (at.size() - 1 - i) % 3 == 0;  // three spans are one point
                        if (!shown || !(value > 0)) continue;
                        least = std::min(least, value);
                        most = std::max(most, value);
                        points += text("%.4g %.3g\n", at[i].get<double>(), value);
                        value = 0;
                    }
                    if (points.empty()) continue;
                    plots += (plots.empty() ? "plot " : ", ") +
                             text("'-' with linespoints linewidth 1 dashtype %d pointtype %d pointsize 0.45 "
                                  "pointinterval 7 linecolor '%s' title '%s %s' noenhanced",
                                  method.dashes, method.mark, shaded(style.color, method.shade).c_str(),
                                  method.integrator, style.numbers);
                    data += points + "e\n";
                }
            }
        }
        if (!has_rows) throw std::runtime_error{std::string{"no rows for the panel "} + kind.title};
        if (plots.empty()) {
            plots = "set label 'zero whenever measured' at graph 0.5,0.5 center\nplot 1e-12 notitle";
            least = 1e-9, most = 1e-3;
        }
        const int low = static_cast<int>(std::floor(std::log10(least))),
                  high = static_cast<int>(std::ceil(std::log10(most))), decades = std::max(high - low, 1);
        out += text("set xrange [50:1e7]\nset xtics 100\nset yrange [1e%d:1e%d]\nset ytics %g\n", low, low + decades,
                    std::pow(10, std::max(1, (decades + 4) / 5)));
        out += plots + "\n" + data;
        out += "unset label\n";
    }

    const std::vector<Row>& rows_;
};

}  // namespace

void draw_long_runs(const std::vector<Row>& rows, const std::filesystem::path& svg) {
    draw(LongRunPicture{rows}.script(), svg);
}

}  // namespace tumble::bench
