// The picture of the feature ladder: a row for each feature, panels for flash, RAM, stack and cycles, a bar for each
// core. The dark end of a bar is the amount that the feature adds to the rung above.
#include "pictures/ladder.hpp"

#include <array>
#include <cmath>

#include "pictures/drawing.hpp"

namespace tumble::bench {
namespace {

// Colors of Okabe and Ito, which color-blind readers tell apart, and a light tint of each. The bars of a feature stand
// in the order of the legend too.
struct Shade {
    const char *dark, *light;
};
constexpr std::array<Shade, 4> shades{
    {{"#0072b2", "#b3d5e8"}, {"#d55e00", "#f2cfb3"}, {"#009e73", "#b3e2d5"}, {"#e69f00", "#f8e2b3"}}};

struct Panel {
    const char *axis, *format;
    double (*of)(const Row&);
    bool logarithmic;
    const char* mark;  // key of the value that a mark shows; none: ""
};
constexpr std::array<Panel, 4> panels{{
    {"flash, KiB", "%+.1f", [](const Row& row) { return row.at("text_bytes").get<double>() / 1024; }, false, ""},
    {"RAM, bytes", "%+.0f", [](const Row& row) { return row.at("ram_bytes").get<double>(); }, false, ""},
    {"stack of a step, bytes", "%+.0f", [](const Row& row) { return row.at("step_stack_bytes").get<double>(); }, false,
     ""},
    {"cycles a step, zero wait states", "%+.0f",
     [](const Row& row) { return row.at("cycles_per_step_est").get<double>(); }, true, "cycles_worst_step_max"},
}};

// Pixels.
constexpr double left = 128, panel_width = 205, gap = 22, right = 14, top = 74, bottom = 52, font_size = 12;
constexpr double bar = 6, row_gap = 10;

// The share of a panel beyond the longest bar, for the numbers of the added amounts.
constexpr double numbers_share = 0.31;

class LadderPicture {
public:
    explicit LadderPicture(const std::vector<Ladder>& ladders) : ladders_(ladders) {
        if (ladders.size() > shades.size())
            throw std::runtime_error{"no color for the feature ladder of " + ladders[shades.size()].name()};
        // The ladder whose numbers are written.
        for (std::size_t i = 0; i < ladders.size(); ++i)
            if (ladders[i].core == "cortex-m3") written_ = i;
    }

    [[nodiscard]] std::string script() const {
        std::string out = start_of_picture(width(), height(), font_size) +
                          "set grid xtics linecolor '#e4e4e4' linetype 1\n" + text("set yrange [%g:0]\n", -rungs());
        legend(out);
        for (std::size_t i = 0; i < panels.size(); ++i) panel(out, i);
        return out + "unset multiplot\n";
    }

private:
    [[nodiscard]] double rungs() const { return static_cast<double>(ladders_.front().rungs.size()); }
    [[nodiscard]] double row_height() const { return bar * static_cast<double>(ladders_.size()) + row_gap; }
    [[nodiscard]] static double width() {
        return left + static_cast<double>(panels.size()) * (panel_width + gap) - gap + right;
    }
    [[nodiscard]] double height() const { return top + rungs() * row_height() + bottom; }

    void legend(std::string& out) const {
        Legend labels{out, width(), height(), 0.58 * font_size, 14, left};
        for (std::size_t i = 0; i < ladders_.size(); ++i) {
            labels.add("", 20, text("point pointtype 5 pointsize 1 linecolor '%s'", shades[i].dark));
            labels.add(ladders_[i].name(), 20, "");
        }
        labels.x = left - 8;
        labels.add("dark: what the feature adds to those above it, in numbers for " + ladders_[written_].name() +
                       "; upright line: the worst step",
                   44, "textcolor '#606060'");
    }

    void panel(std::string& out, std::size_t index) const {
        const Panel& panel = panels[index];
        const double x = left + static_cast<double>(index) * (panel_width + gap);
        out += panel_at(x, bottom, panel_width, height() - bottom - top, width(), height());
        double least = panel.of(ladders_.front().rungs.front()), most = 0;
        for (const Ladder& ladder : ladders_) {
            for (const Row& row : ladder.rungs) {
                least = std::min(least, panel.of(row));
                most = std::max(most, std::max(panel.of(row), marked(panel, row)));
            }
        }
        // Bars begin at zero or at the power of ten below all of them.
        const double start = panel.logarithmic ? std::pow(10, std::floor(std::log10(least))) : 0;
        const double end =
            panel.logarithmic ? std::pow(most / start, 1 / (1 - numbers_share)) * start : most / (1 - numbers_share);
        out += panel.logarithmic
                   ? "set logscale x\nset format x '10^{%L}'\nset xtics 100 textcolor 'black'\n"
                   : "unset logscale\nset format x '%g'\n" + text("set xtics %g textcolor 'black'\n", tic_of(most));
        out += text("set xrange [%g:%g]\nset xlabel '%s'\n", start, end, panel.axis);
        out += index == 0 ? "set ytics (" + features() + ") textcolor 'black'\n" : "unset ytics\n";

        std::string plots, data;
        const auto add = [&](const std::string& how, const std::string& lines) {
            if (lines.empty()) return;
            plots += (plots.empty() ? "plot " : ", ") + ("'-' " + how + " notitle");
            data += lines + "e\n";
        };
        for (std::size_t l = 0; l < ladders_.size(); ++l) {
            std::string total, added, marks;
            double before = start;
            for (std::size_t r = 0; r < ladders_[l].rungs.size(); ++r) {
                const Row& row = ladders_[l].rungs[r];
                const double now = panel.of(row), low = bar_end(l, r, 1), high = bar_end(l, r, 0);
                const auto rectangle = [&](double from, double to) {
                    return text("%.6g %.6g %.6g %.6g %.6g %.6g\n", to, low, from, to, low, high);
                };
                if (before > start) total += rectangle(start, std::min(before, now));
                if (now > before) added += rectangle(before, now);
                if (*panel.mark != 0) marks += text("%.6g %.6g 0 %.6g\n", marked(panel, row), low, high - low);
                before = now;
            }
            const std::string rectangles = "with boxxyerror fillstyle solid noborder linecolor ";
            add(rectangles + "'" + shades[l].light + "'", total);
            add(rectangles + "'" + shades[l].dark + "'", added);
            add(std::string{"with vectors nohead linewidth 1.5 linecolor '"} + shades[l].dark + "'", marks);
        }
        for (std::size_t r = 0; r < ladders_.front().rungs.size(); ++r) {
            const auto& rungs = ladders_[written_].rungs;
            const double more = panel.of(rungs[r]) - (r == 0 ? 0 : panel.of(rungs[r - 1]));
            out +=
                text("set label '%s' at graph 0.985,first %g right\n", text(panel.format, more).c_str(), middle_of(r));
        }
        out += plots + "\n" + data + "unset label\n";
    }

    // Between the labels of an axis: a power of ten, or twice or five times one; at most four of them up to the most.
    [[nodiscard]] static double tic_of(double most) {
        for (double unit = std::pow(10, std::floor(std::log10(most)) - 1);; unit *= 10)
            for (const double tic : {unit, 2 * unit, 5 * unit})
                if (4 * tic >= most) return tic;
    }
    [[nodiscard]] static double marked(const Panel& panel, const Row& row) {
        return *panel.mark == 0 ? 0 : row.at(panel.mark).get<double>();
    }
    // Names at the middle of their rows.
    [[nodiscard]] std::string features() const {
        std::string tics;
        for (std::size_t r = 0; r < ladders_.front().rungs.size(); ++r)
            tics += text("%s'%s' %g", r == 0 ? "" : ", ", ladders_.front().feature(r).c_str(), middle_of(r));
        return tics;
    }
    // The middle of a rung's row, and where one of its bars begins (0) or ends (1): rows from the top, negative.
    [[nodiscard]] static double middle_of(std::size_t rung) { return -(static_cast<double>(rung) + 0.5); }
    [[nodiscard]] double bar_end(std::size_t ladder, std::size_t rung, double end) const {
        return -(static_cast<double>(rung) * row_height() + row_gap / 2 + (static_cast<double>(ladder) + end) * bar) /
               row_height();
    }

    const std::vector<Ladder>& ladders_;
    std::size_t written_ = 0;
};

}  // namespace

void draw_ladders(const std::vector<Ladder>& ladders, const std::filesystem::path& svg) {
    draw(LadderPicture{ladders}.script(), svg);
}

}  // namespace tumble::bench
