#include "command/plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/reader.hpp"
#include "tools/gnuplot.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

// The colors of Okabe and Ito, which color-blind readers can distinguish, with grey instead of yellow.
constexpr std::array<const char*, Plot::most_bodies> colors{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                            "#e69f00", "#56b4e9", "#000000", "#999999"};

// The picture in pixels: two columns of panels, each with three low panels above a high one. The high one on the right
// holds the names.
constexpr double width = 1000, height = 880, left = 95, right = 20, top = 90, bottom = 62, gap_x = 105, gap_y = 20;
constexpr double panel_width = (width - left - right - gap_x) / 2, last_height = 200,
                 panel_height = (height - top - bottom - 4 * gap_y - last_height) / 3, line_height = 18;
constexpr std::size_t longest_name = 44;  // characters beside a line of the list of names

std::string in_gnuplot_quotes(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? "''" : c == '\n' ? " " : std::string(1, c);
    return quoted + "'";
}

struct Panel {
    std::size_t column, row;

    // From the left and from the top.
    [[nodiscard]] double x() const { return left + static_cast<double>(column) * (panel_width + gap_x); }
    [[nodiscard]] double y() const {
        // The last row shows another quantity, so it has a larger gap.
        return top + static_cast<double>(row) * (panel_height + gap_y) + (row == 3 ? gap_y : 0);
    }
    [[nodiscard]] double high() const { return row == 3 ? last_height : panel_height; }
    [[nodiscard]] std::string margins() const {
        const auto margin = [](const char* name, double share) {
            return "set " + std::string(name) + " at screen " + few_digits(share) + "\n";
        };
        return margin("lmargin", x() / width) + margin("rmargin", (x() + panel_width) / width) +
               margin("tmargin", 1 - y() / height) + margin("bmargin", 1 - (y() + high()) / height);
    }
};

std::string on_screen(double x, double y) { return few_digits(x / width) + "," + few_digits(1 - y / height); }

std::string label(const std::string& text, double x, double y, const std::string& more = {}) {
    return "set label " + in_gnuplot_quotes(text) + " noenhanced at screen " + on_screen(x, y) + " " + more + "\n";
}

// A line from left to right.
std::string arrow(double from, double to, double y, const std::string& style) {
    return "set arrow from screen " + on_screen(from, y) + " to screen " + on_screen(to, y) + " nohead" + style + "\n";
}

struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -low;

    void add(double value) {
        if (!std::isfinite(value)) return;
        low = std::min(low, value);
        high = std::max(high, value);
    }
    [[nodiscard]] double span() const { return low <= high ? high - low : 0; }
};

// The distance of about four ticks over a range: 1, 2 or 5 times a power of ten.
std::string y_axis(const Panel& panel, const std::string& name, const Range& range, double least_span) {
    const double middle = range.low <= range.high ? (range.low + range.high) / 2 : 0,
                 span = 1.1 * std::max(range.span(), least_span), ten = std::pow(10, std::floor(std::log10(span / 4)));
    const double step = ten * (span / 4 < 1.5 * ten ? 1 : span / 4 < 3.5 * ten ? 2 : span / 4 < 7.5 * ten ? 5 : 10);
    return label(name, panel.x() - 74, panel.y() + panel.high() / 2, "center rotate by 90") + "set yrange [" +
           seventeen_digits(middle - span / 2) + ":" + seventeen_digits(middle + span / 2) + "]\nset ytics " +
           few_digits(step) + "\n";
}

std::string time_axis(bool is_written) {
    return is_written ? "set xlabel 'time, s' noenhanced offset 0,0.4\nset format x '%g'\n"
                      : "unset xlabel\nset format x ''\n";
}

std::string line_style(std::size_t track) {
    return " linewidth 1.5 linecolor '" + std::string(colors[track]) + "' dashtype " + (track < 4 ? "1" : "'-'");
}
constexpr const char* impulse_mark = " pointtype 8 pointsize 0.9";
constexpr const char* contact_mark = " pointtype 6 pointsize 0.7";

}  // namespace

Plot::Plot(const Simulation& simulation, const SceneDescription& scene)
    : title_{scene.name.empty() ? scene.path : scene.name}, every_{std::max<std::int64_t>(1, simulation.steps() / 500)},
      has_contact_springs_{scene.contact.response == ContactResponse::spring}, bodies_{simulation.body_count()} {
    subtitle_ = std::string(simulation.integrator()) + ", " + std::string(simulation.numbers()) + ", " +
                std::to_string(simulation.steps()) + " steps of " + step_text(scene.step) + " s";
    duration_ = static_cast<double>(simulation.steps()) * static_cast<double>(simulation.step_length());

    for (std::size_t b = 0; b < scene.bodies.size() && tracks_.size() < most_bodies; ++b) {
        if (scene.bodies.size() > most_bodies && scene.bodies[b].fixed) continue;
        Track track{static_cast<int>(b), scene.bodies[b].name, {}, 0, 0, {}, {}, {}};
        for (const ImpulseDescription& impulse : scene.impulses)
            if (impulse.body == track.body) track.impulse_times.push_back(impulse.time);
        std::sort(track.impulse_times.begin(), track.impulse_times.end());
        tracks_.push_back(std::move(track));
    }
}

void Plot::sample(const Simulation& simulation, const Energy& energy, bool last) {
    const bool is_kept = last || simulation.steps_taken() % every_ == 0;
    const double time = static_cast<double>(simulation.time());
    if (last && time > 0) duration_ = time;
    for (Track& track : tracks_) {
        const BodySnapshot body = simulation.body(track.body);
        State state{time, {}};
        for (std::size_t i = 0; i < 3; ++i) {
            state.numbers[i] = static_cast<double>(body.position[i]);
            state.numbers[i + 3] = static_cast<double>(body.angular_velocity[i]);
        }
        const auto mark = [&](std::vector<State>& marks) {
            if (marks.empty() || time - marks.back().time >= duration_ / 100) marks.push_back(state);
        };
        for (; track.impulses_seen < track.impulse_times.size(); ++track.impulses_seen) {
            if (track.impulse_times[track.impulses_seen] > time) break;
            mark(track.impulses);
        }
        if (body.contacts > track.contact_points) mark(track.contacts);
        track.contact_points = body.contacts;
        if (is_kept) track.states.push_back(state);
    }
    if (!is_kept) return;
    energies_.push_back({time, static_cast<double>(energy.kinetic), static_cast<double>(energy.potential),
                         static_cast<double>(energy.total())});
}

std::string Plot::data() const {
    std::string data;
    const auto numbers = [&](const auto& row) {
        for (const double number : row) data += few_digits(number) + " ";
    };
    const auto states = [&](const char* name, std::size_t track, const std::vector<State>& rows) {
        data += "$" + std::string(name) + std::to_string(track) + " << EOD\n";
        for (const State& state : rows) {
            data += few_digits(state.time) + " ";
            numbers(state.numbers);
            data += "\n";
        }
        data += "EOD\n";
    };
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
        states("body", i, tracks_[i].states);
        states("impulses", i, tracks_[i].impulses);
        states("contacts", i, tracks_[i].contacts);
    }
    data += "$energy << EOD\n";
    for (const auto& row : energies_) {
        numbers(row);
        data += "\n";
    }
    return data + "EOD\n";
}

std::string Plot::motion_panels() const {
    std::string out;
    for (std::size_t column = 0; column < 2; ++column) {
        std::array<Range, 3> ranges;
        double widest = 0;
        for (std::size_t row = 0; row < 3; ++row) {
            for (const Track& track : tracks_)
                for (const State& state : track.states) ranges[row].add(state.numbers[3 * column + row]);
            widest = std::max(widest, ranges[row].span());
        }
        for (std::size_t row = 0; row < 3; ++row) {
            const Panel panel{column, row};
            const std::string axis(1, "xyz"[row]);
            // The panel is at least so high that rounding of a large motion looks flat.
            out += panel.margins() + time_axis(column == 1 && row == 2) +
                   y_axis(panel, column == 0 ? axis + ", m" : "about " + axis + ", rad/s", ranges[row],
                          widest > 0 ? 1e-3 * widest : 2);
            std::string curves, marks;
            for (std::size_t i = 0; i < tracks_.size(); ++i) {
                const std::string number = std::to_string(i), use = " using 1:" + std::to_string(3 * column + row + 2),
                                  color = " linecolor '" + std::string(colors[i]) + "'";
                curves += ", $body" + number + use + " with lines" + line_style(i) + " title " +
                          in_gnuplot_quotes(tracks_[i].name) + " noenhanced";
                if (!tracks_[i].impulses.empty())
                    marks += ", $impulses" + number + use + " with points" + impulse_mark + color;
                if (!tracks_[i].contacts.empty())
                    marks += ", $contacts" + number + use + " with points" + contact_mark + color;
            }
            out += "plot " + (curves.empty() ? "1/0" : (curves + marks).substr(2)) + "\nunset label\n";
        }
    }
    return out;
}

// The names and the meaning of the marks, in the place of the last panel on the right.
std::string Plot::key() const {
    const Panel panel{1, 3};
    const double x = panel.x();
    double y = panel.y() + 26;
    std::string out;
    const auto line = [&](const std::string& text) {
        out += label(text, x + 42, y);
        y += line_height;
    };
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
        out += arrow(x, x + 34, y, line_style(i));
        line(shortened(tracks_[i].name, longest_name));
    }
    const auto any = [&](std::vector<State> Track::*marks) {
        return std::any_of(tracks_.begin(), tracks_.end(), [&](const Track& track) { return !(track.*marks).empty(); });
    };
    const auto mark = [&](const char* style, const char* meaning) {
        out += label("", x + 17, y, "point" + std::string(style) + " linecolor 'black'");
        line(meaning);
    };
    if (any(&Track::impulses)) mark(impulse_mark, "an impulse acts");
    if (any(&Track::contacts)) mark(contact_mark, "a contact begins");
    if (has_contact_springs_) line("contacts by springs have no marks");
    if (static_cast<std::size_t>(bodies_) > tracks_.size())
        line("the first " + std::to_string(tracks_.size()) + " of " + std::to_string(bodies_) +
             " bodies that are not fixed");
    return out;
}

std::string Plot::script() const {
    std::string out = "set terminal svg size " + few_digits(width) + "," + few_digits(height) +
                      " font 'sans-serif,13' background 'white'\n" + data() + "set multiplot\n" +
                      "set border linecolor '#808080'\nset tics scale 0.5 textcolor 'black'\n" +
                      "set grid linecolor '#e0e0e0' linetype 1\nset format y '%.4g'\nunset key\nset xrange [0:" +
                      few_digits(duration_) + "]\n";
    out += label(shortened(title_, 80), left, 24, "font ',18'") + label(subtitle_, left, 47, "textcolor '#606060'") +
           label("position in the world", left, top - 13) +
           label("angular velocity about the body's axes", left + panel_width + gap_x, top - 13) + motion_panels();

    const Panel panel{0, 3};
    Range range;
    for (const auto& row : energies_)
        for (std::size_t i = 1; i < row.size(); ++i) range.add(row[i]);
    // Rounding looks flat here too.
    const double largest = std::max(std::abs(range.low), std::abs(range.high));
    out += panel.margins() + time_axis(true) + key() +
           y_axis(panel, "energy, J", range, std::isfinite(largest) && largest > 0 ? 1e-3 * largest : 2);
    const std::array<std::array<const char*, 2>, 3> parts{{{"kinetic", " linecolor '#0072b2'"},
                                                           {"potential", " linecolor '#d55e00'"},
                                                           {"total", " linecolor 'black' linewidth 1.5"}}};
    std::string plot;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto [name, style] = parts[i];
        const double x = panel.x() + static_cast<double>(i) * 125, y = panel.y() - 13;
        out += arrow(x, x + 34, y, style) + label(name, x + 42, y);
        plot += ", $energy using 1:" + std::to_string(i + 2) + " with lines" + style;
    }
    out += "plot " + plot.substr(2) + "\n";
    return out + "unset multiplot\n";
}

std::string Plot::drawn() const { return svg_by_gnuplot(script()); }

}  // namespace tumble::host
