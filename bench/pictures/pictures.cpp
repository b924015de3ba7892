// Draws rows of work against precision: one picture a problem, one panel a core. All panels have the same axes:
// estimated cycles where the core has a timing table, instructions where it has none. The front of a panel is, at each
// error, the cheapest run over all methods and number systems. The eight curves that hold most of it are colored by
// number system and labelled at their ends. The twelve other curves whose cost comes closest to the front's are grey;
// the rest is not drawn. A curve keeps only runs that gain accuracy for their cost: where rounding stops a method, its
// curve ends.
#include "host/host_rows.hpp"
#include "pictures/drawing.hpp"
#include "pictures/labels.hpp"
#include "pictures/ladder.hpp"
#include "pictures/long_run_rows.hpp"
#include "rows/rows.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace {

using tumble::bench::numbers_of, tumble::bench::Row, tumble::bench::Point, tumble::bench::Box, tumble::bench::text;
using tumble::bench::NumberStyle, tumble::bench::number_styles, tumble::bench::start_of_picture,
    tumble::bench::logarithmic_axes;
namespace fs = std::filesystem;

// An orientation wrong by a radian, or a position by a metre, is no answer to any of the problems.
constexpr double useless_error = 1;
constexpr std::size_t most_labels = 8, most_grey = 12;

struct ErrorKind {
    const char *key, *axis;
};
constexpr std::array<ErrorKind, 2> error_kinds{
    {{"orientation_error_rad", "largest orientation error, rad (smaller to the right)"},
     {"position_error_m", "largest position error, m (smaller to the right)"}}};

const NumberStyle& style_of(const std::string& numbers) {
    const auto* found = std::find_if(std::begin(number_styles), std::end(number_styles),
                                     [&](const NumberStyle& style) { return style.numbers == numbers; });
    if (found == std::end(number_styles)) throw std::runtime_error{"no color for number system '" + numbers + "'"};
    return *found;
}

struct Run {
    double error, cost;
};
struct Curve {
    std::string method, numbers;
    std::vector<Run> runs;   // each more accurate than any cheaper one
    std::vector<Run> front;  // those of them that are the cheapest of all methods at some error
    double decades_on_front = 0;

    [[nodiscard]] std::string name() const { return method + " " + numbers; }
    [[nodiscard]] std::string label() const { return method + style_of(numbers).word; }
};
struct Panel {
    std::string core;
    std::vector<Curve> curves;  // first those with a label
    bool in_cycles = false;
    std::size_t labelled = 0;
};

bool cheaper(const Run& a, const Run& b) { return a.cost != b.cost ? a.cost < b.cost : a.error < b.error; }

// Leaves runs that are more accurate than any cheaper one.
void keep_what_gains(std::vector<Run>& runs) {
    std::sort(runs.begin(), runs.end(), cheaper);
    double best = std::numeric_limits<double>::infinity();
    std::erase_if(runs, [&](const Run& run) {
        if (!(run.error < best)) return true;
        best = run.error;
        return false;
    });
}

// Ends a curve where rounding begins: at the last run that is on the front, or whose error shrinks at least by the
// square root of the factor by which its cost grows.
void end_at_rounding(Curve& curve) {
    std::vector<Run>& runs = curve.runs;
    while (runs.size() > 1 && (curve.front.empty() || runs.back().error < curve.front.back().error)) {
        const Run &last = runs.back(), &before = runs[runs.size() - 2];
        if (before.error / last.error > std::sqrt(last.cost / before.cost)) break;
        runs.pop_back();
    }
}

// The least that a curve costs at some error, as a multiple of the front's cost there. The front's runs ascend in cost.
double distance_from(const std::vector<Run>& front, const Curve& curve) {
    double least = std::numeric_limits<double>::infinity();
    for (const Run& run : curve.runs) {
        if (!(run.error < useless_error)) continue;
        for (const Run& best : front) {
            if (best.error > run.error) continue;
            least = std::min(least, run.cost / best.cost);
            break;
        }
    }
    return least;
}

// Finds the front of a panel, and keeps the curves to draw: the labelled ones first, then the grey ones.
void find_front(Panel& panel) {
    struct Entry {
        Run run;
        Curve* curve;
    };
    std::vector<Entry> entries;
    for (Curve& curve : panel.curves) {
        keep_what_gains(curve.runs);
        for (const Run& run : curve.runs) entries.push_back({run, &curve});
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const Entry& a, const Entry& b) { return cheaper(a.run, b.run); });
    std::vector<Run> front;
    double best = useless_error;
    for (const auto& [run, curve] : entries) {
        if (!(run.error < best)) continue;
        front.push_back(run);
        curve->front.push_back(run);
        curve->decades_on_front += std::log10(best / run.error);
        best = run.error;
    }
    std::stable_sort(panel.curves.begin(), panel.curves.end(),
                     [](const Curve& a, const Curve& b) { return a.decades_on_front > b.decades_on_front; });
    for (Curve& curve : panel.curves) end_at_rounding(curve);
    while (panel.labelled < std::min(most_labels, panel.curves.size()) && !panel.curves[panel.labelled].front.empty())
        ++panel.labelled;
    const auto grey = panel.curves.begin() + static_cast<std::ptrdiff_t>(panel.labelled);
    std::stable_sort(grey, panel.curves.end(),
                     [&](const Curve& a, const Curve& b) { return distance_from(front, a) < distance_from(front, b); });
    panel.curves.erase(grey + std::min<std::ptrdiff_t>(most_grey, panel.curves.end() - grey), panel.curves.end());
}

std::string file_name(std::string scene) {
    for (char& c : scene) c = std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '_';
    return "work_precision_" + scene + ".svg";
}

class Picture {
public:
    Picture(const std::string& scene, const std::vector<Row>& rows) : scene_(scene) {
        for (const Row& row : rows)
            if (row.at("scene") == scene) add(row);
        for (Panel& panel : panels_) {
            find_front(panel);
            for (std::size_t i = 0; i < panel.labelled; ++i) {
                for (const Run& run : panel.curves[i].runs) {
                    if (!(run.error < useless_error)) continue;
                    least_ = {std::min(least_.error, run.error), std::min(least_.cost, run.cost)};
                    largest_cost_ = std::max(largest_cost_, run.cost);
                }
            }
        }
        // Room for labels beyond the last run.
        least_.error = std::pow(10, std::floor(std::log10(least_.error)) - 2);
        least_.cost = std::pow(10, std::floor(std::log10(least_.cost / 1.5)));
        largest_cost_ = std::pow(10, std::ceil(std::log10(largest_cost_ * 1.5)));
    }

    void draw(const fs::path& svg) const { tumble::bench::draw(script(), svg); }

private:
    void add(const Row& row) {
        if (row.contains("failure")) return;
        for (const ErrorKind& kind : error_kinds)
            if (row.contains(kind.key)) kind_ = &kind;
        const auto cost = tumble::bench::cost_of_simulated_second(row);
        const Run run{row.at(kind_->key), cost.expected};
        if (!(run.error > 0)) return;  // exact: no place on a logarithmic axis
        const std::string core = row.at("core"), method = row.at("integrator"), numbers = numbers_of(row);
        auto panel = std::find_if(panels_.begin(), panels_.end(), [&](const Panel& p) { return p.core == core; });
        if (panel == panels_.end()) panel = panels_.insert(panel, Panel{core, {}, cost.in_cycles});
        if (panel->in_cycles != cost.in_cycles)
            throw std::runtime_error{scene_ + ", " + core + ": some rows have cycles and some have none"};
        auto& curves = panel->curves;
        auto curve = std::find_if(curves.begin(), curves.end(),
                                  [&](const Curve& c) { return c.method == method && c.numbers == numbers; });
        if (curve == curves.end()) curve = curves.insert(curve, Curve{method, numbers, {}, {}});
        curve->runs.push_back(run);
    }

    static constexpr double panel_width = 490, panel_height = 330, left = 75, right = 40, top = 90, bottom = 60,
                            gap = 32;
    static constexpr const char *cycles_axis = "cycles per simulated second, estimate, zero wait states",
                                *insn_axis = "instructions per simulated second";
    static constexpr double font_size = 13, character = 0.62 * font_size;
    [[nodiscard]] std::size_t panel_rows() const { return (panels_.size() + 1) / 2; }
    [[nodiscard]] double width() const { return left + 2 * panel_width + gap + right; }
    [[nodiscard]] double height() const {
        return top + static_cast<double>(panel_rows()) * (panel_height + gap) - gap + bottom;
    }
    // Where a run stands in its panel, in pixels from the lower left corner.
    [[nodiscard]] Point place(const Run& run) const {
        return {panel_width * std::log10(run.error / useless_error) / std::log10(least_.error / useless_error),
                panel_height * std::log10(run.cost / least_.cost) / std::log10(largest_cost_ / least_.cost)};
    }

    // Without runs that stand within half a pixel of the line between their neighbours.
    [[nodiscard]] std::vector<Run> simplified(const std::vector<Run>& runs) const {
        std::vector<Run> kept;
        std::size_t last = 0;
        for (std::size_t i = 0; i < runs.size(); ++i) {
            bool straight = i > 0 && i + 1 < runs.size();
            for (std::size_t k = last + 1; straight && k <= i; ++k) {
                const Point a = place(runs[last]), b = place(runs[i + 1]), p = place(runs[k]);
                const double across = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
                straight = std::abs(across) < 0.5 * distance_between(a, b);
            }
            if (straight) continue;
            kept.push_back(runs[i]);
            last = i;
        }
        return kept;
    }

    [[nodiscard]] std::string script() const {
        std::string out =
            start_of_picture(width(), height(), font_size) + logarithmic_axes + "set tics textcolor 'black'\n" +
            text("set xrange [%g:%g]\nset yrange [%g:%g]\n", useless_error, least_.error, least_.cost, largest_cost_) +
            "set xtics (1";
        for (double tick = 0.01 * useless_error; tick > 0.9 * least_.error; tick /= 100) out += text(", %g", tick);
        out += ")\n";
        legend(out);
        for (std::size_t i = 0; i < panels_.size(); ++i) panel(out, i);
        return out + "unset multiplot\n";
    }

    // The title, and what colors and marks mean.
    void legend(std::string& out) const {
        tumble::bench::Legend labels{out, width(), height(), character, 12, left};
        labels.add(scene_, 22, "font ',18'");
        labels.x = left;
        for (const NumberStyle& style : number_styles) {
            if (!is_labelled(style)) continue;
            labels.x += 5;
            labels.add("", 48, text("point pointtype %d pointsize 0.7 linecolor '%s'", style.mark, style.color));
            labels.add(style.numbers, 48, text("textcolor '%s'", style.text_color));
            labels.x += 10;
        }
        labels.add("marks: cheapest at some error; grey: the twelve next cheapest curves of a panel", 48,
                   "textcolor '#606060'");
    }
    [[nodiscard]] bool is_labelled(const NumberStyle& style) const {
        for (const Panel& panel : panels_)
            for (std::size_t i = 0; i < panel.labelled; ++i)
                if (panel.curves[i].numbers == style.numbers) return true;
        return false;
    }

    void panel(std::string& out, std::size_t index) const {
        const Panel& panel = panels_[index];
        const std::size_t row = index / 2;
        const double x = left + static_cast<double>(index % 2) * (panel_width + gap),
                     y = height() - top - static_cast<double>(row) * (panel_height + gap) - panel_height;
        out += tumble::bench::panel_at(x, y, panel_width, panel_height, width(), height());
        out += "set title '" + panel.core + "' offset 0,-0.6\n";
        // The axes are the same: they are written once a row and once a column. Their units may not be.
        const std::string unit = std::string{"'"} + (panel.in_cycles ? cycles_axis : insn_axis) + "' font ',10.5'\n";
        out += index % 2 == 0 ? "set ylabel " + unit + "unset y2label\nset format y '10^{%L}'\n"
                              : "unset ylabel\nset format y ''\n";
        if (index % 2 == 1 && panel.in_cycles != panels_[index - 1].in_cycles) out += "set y2label " + unit;
        else out += "unset y2label\n";
        out += index + 2 >= panels_.size() ? std::string("set xlabel '") + kind_->axis + "'\nset format x '10^{%L}'\n"
                                           : "unset xlabel\nset format x ''\n";

        std::string grey, lines, marks, data, marks_data;
        for (std::size_t i = 0; i < panel.curves.size(); ++i) {
            const Curve& curve = panel.curves[i];
            const std::string points = lines_of(simplified(curve.runs));
            if (i >= panel.labelled) {
                grey += points + "\n";
                continue;
            }
            const NumberStyle& style = style_of(curve.numbers);
            lines += text(", '-' with lines linewidth 1.5 linecolor '%s' title '%s' noenhanced", style.color,
                          curve.name().c_str());
            data += points + "e\n";
            marks +=
                text(", '-' with points pointtype %d pointsize 0.7 linecolor '%s' notitle", style.mark, style.color);
            marks_data += lines_of(curve.front) + "e\n";
        }
        label_ends(out, panel);
        out += "plot '-' with lines linecolor '#cfcfcf' notitle" + lines + marks + "\n" + grey + "e\n" + data +
               marks_data + "unset label\nunset arrow\n";
    }

    static std::string lines_of(const std::vector<Run>& runs) {
        std::string lines;
        for (const Run& run : runs) lines += text("%.4g %.4g\n", run.error, run.cost);
        return lines;
    }

    void label_ends(std::string& out, const Panel& panel) const {
        std::vector<tumble::bench::LabelledPath> paths;
        for (std::size_t i = 0; i < panel.curves.size(); ++i) {
            tumble::bench::LabelledPath path;
            for (const Run& run : panel.curves[i].runs) path.points.push_back(place(run));
            if (i < panel.labelled)
                path.size = {character * static_cast<double>(panel.curves[i].label().size()) + 4, font_size * 1.2};
            paths.push_back(std::move(path));
        }
        const auto boxes = place_labels(paths, panel.labelled, Box{{3, 3}, {panel_width - 3, panel_height - 3}});
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            const Box& box = boxes[i];
            const Point end = paths[i].points.back(), tip = box.nearest(end);
            const NumberStyle& style = style_of(panel.curves[i].numbers);
            if (distance_between(tip, end) > 11)
                out += text("set arrow from graph %.4f,%.4f to graph %.4f,%.4f nohead linewidth 0.7 linecolor '%s'\n",
                            end.x / panel_width, end.y / panel_height, tip.x / panel_width, tip.y / panel_height,
                            style.color);
            out += text("set label '%s' noenhanced center textcolor '%s' at graph %.4f,%.4f\n",
                        panel.curves[i].label().c_str(), style.text_color, (box.low.x + box.high.x) / 2 / panel_width,
                        (box.low.y + box.high.y) / 2 / panel_height);
        }
    }

    std::string scene_;
    std::vector<Panel> panels_;
    const ErrorKind* kind_ = &error_kinds.front();
    Run least_{useless_error, std::numeric_limits<double>::infinity()};
    double largest_cost_ = 0;
};

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    CLI::App app{"Draws rows of work against precision, a picture a problem, and those of the feature ladder, long "
                 "runs and the host."};
    std::vector<fs::path> files;
    fs::path directory = "build/results", ladder, long_runs, host;
    app.add_option("rows", files, "Files of rows");
    app.add_option("--directory", directory, "Where the pictures go");
    app.add_option("--ladder", ladder, "A file of rows of the feature ladder");
    app.add_option("--long-runs", long_runs, "A file of rows of long runs");
    app.add_option("--host", host, "A file of rows of bench/host");
    CLI11_PARSE(app, argc, argv);
    fs::create_directories(directory);
    for (const fs::path& file : files) {
        const auto rows = tumble::bench::read_rows(file);
        std::vector<std::string> scenes;
        for (const Row& row : rows) {
            const std::string scene = row.at("scene");
            if (std::find(scenes.begin(), scenes.end(), scene) != scenes.end()) continue;
            scenes.push_back(scene);
            Picture{scene, rows}.draw(directory / file_name(scene));
        }
    }
    if (!ladder.empty())
        tumble::bench::draw_ladders(tumble::bench::ladders_of(tumble::bench::read_rows(ladder)),
                                    directory / "ladder.svg");
    if (!long_runs.empty())
        tumble::bench::draw_long_runs(tumble::bench::read_rows(long_runs), directory / "long_runs.svg");
    if (!host.empty())
        tumble::bench::draw_host(tumble::bench::HostRows{tumble::bench::read_rows(host)}, directory / "host.svg");
    return 0;
} catch (...) { return tumble::bench::report_failure("tumble_pictures"); }
