#include "stress/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <stdexcept>

#include "pictures/drawing.hpp"

namespace tumble::bench::stress {
namespace {

// Colors of Okabe and Ito, which color-blind readers tell apart; and the color of a letter on each.
struct Look {
    Outcome outcome;
    const char *fill, *letter;
};
constexpr std::array looks{
    Look{Outcome::accurate, "#009e73", "#fff"}, Look{Outcome::drifts, "#f0e442", "#000"},
    Look{Outcome::blows_up, "#d55e00", "#fff"}, Look{Outcome::range_left, "#56b4e9", "#000"},
    Look{Outcome::told, "#0072b2", "#fff"},     Look{Outcome::silent, "#000", "#fff"},
};

// Pixels.
constexpr double panel_width = 132, panel_height = 96, panel_gap = 8, block_gap = 34, row_gap = 26;
constexpr double top = 92, bottom = 46, right = 14, letter_size = 11, font_size = 12, small_size = 11;
// Approximate width of a letter.
constexpr double letter_width = 0.56;

struct Shown {
    const char* numbers;
    bool carry;
};
// As in the pages' tables.
constexpr std::array shown{Shown{"q32", true}, Shown{"f32", false}, Shown{"f64", false}};

std::string escaped(const std::string& plain) {
    std::string out;
    for (const char c : plain) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    return out;
}

// The axis of a row of cells: value i is at the middle of cell i.
class Scale {
public:
    Scale(const Row& axes, const std::string& name, const Axis& axis)
        : values_(axes.at(name + "_values").get<std::vector<double>>()),
          logarithmic_{axis.logarithmic}, label_{axis.label + (axis.unit.empty() ? "" : ", " + axis.unit)} {
        if (axes.contains(name + "_names")) names_ = axes.at(name + "_names").get<std::vector<std::string>>();
    }

    [[nodiscard]] std::size_t count() const { return values_.size(); }
    [[nodiscard]] const std::string& label() const { return label_; }
    [[nodiscard]] bool has_names() const { return !names_.empty(); }

    // In cells from the start.
    [[nodiscard]] double place_of(double value) const {
        if (values_.size() < 2) return 0.5;
        std::size_t i = 0;
        while (i + 2 < values_.size() && value > values_[i + 1]) ++i;
        const double low = number(values_[i]), high = number(values_[i + 1]);
        return static_cast<double>(i) + 0.5 + (number(value) - low) / (high - low);
    }

    struct Tic {
        double place;
        std::string text;
    };
    // At most as many as given, at round numbers; names have one each.
    [[nodiscard]] std::vector<Tic> tics(std::size_t most) const {
        std::vector<Tic> tics;
        for (std::size_t i = 0; i < names_.size(); ++i) tics.push_back({static_cast<double>(i) + 0.5, names_[i]});
        if (has_names()) return tics;
        const double first = values_.front(), last = values_.back();
        const std::vector<std::vector<double>> ladders = logarithmic_
                                                             ? std::vector<std::vector<double>>{{1, 2, 5}, {1, 3}, {1}}
                                                             : std::vector<std::vector<double>>{{}};
        for (const auto& ladder : ladders) {
            tics.clear();
            if (logarithmic_) {
                for (int power = static_cast<int>(std::floor(std::log10(first))); std::pow(10, power) <= last; ++power)
                    for (const double digit : ladder) add(tics, digit * std::pow(10, power));
            } else {
                const double stride = round_stride((last - first) / static_cast<double>(most));
                for (double at = std::ceil(first / stride - 1e-9) * stride; at <= last + 1e-9 * stride; at += stride)
                    add(tics, std::abs(at) < stride / 2 ? 0 : at);
            }
            if (tics.size() <= most) return tics;
        }
        // Powers of ten: each second of them, or third, ...
        std::vector<Tic> fewer;
        const std::size_t stride = (tics.size() + most - 1) / most;
        for (std::size_t i = 0; i < tics.size(); i += stride) fewer.push_back(tics[i]);
        return fewer;
    }

private:
    [[nodiscard]] double number(double value) const { return logarithmic_ ? std::log(value) : value; }
    void add(std::vector<Tic>& tics, double value) const {
        const double place = place_of(value);
        if (place >= 0 && place <= static_cast<double>(count())) tics.push_back({place, text("%g", value)});
    }
    [[nodiscard]] static double round_stride(double least) {
        const double power = std::pow(10, std::floor(std::log10(least)));
        for (const double digit : {1.0, 2.0, 5.0})
            if (digit * power >= least) return digit * power;
        return 10 * power;
    }

    std::vector<double> values_;
    bool logarithmic_;
    std::string label_;
    std::vector<std::string> names_;
};

struct Rectangle {
    std::size_t x, y, width, height;  // cells
    [[nodiscard]] std::size_t area() const { return width * height; }
};

// Rectangles that cover the cells of each letter once.
std::map<char, std::vector<Rectangle>> rectangles_of(const std::string& cells, std::size_t columns) {
    std::map<char, std::vector<Rectangle>> found;
    std::vector<bool> taken(cells.size());
    const std::size_t rows = cells.size() / columns;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (taken[i]) continue;
        const std::size_t x = i % columns, y = i / columns;
        Rectangle r{x, y, 1, 1};
        const auto is_free = [&](std::size_t at_x, std::size_t at_y) {
            const std::size_t at = at_y * columns + at_x;
            return cells[at] == cells[i] && !taken[at];
        };
        while (x + r.width < columns && is_free(x + r.width, y)) ++r.width;
        const auto row_is_free = [&](std::size_t at_y) {
            for (std::size_t k = 0; k < r.width; ++k)
                if (!is_free(x + k, at_y)) return false;
            return true;
        };
        while (y + r.height < rows && row_is_free(y + r.height)) ++r.height;
        for (std::size_t k = 0; k < r.area(); ++k) taken[(y + k / r.width) * columns + x + k % r.width] = true;
        found[cells[i]].push_back(r);
    }
    return found;
}

// Methods with the same cells in all number systems that are shown.
struct Block {
    std::vector<std::string> methods;
    std::array<const Row*, shown.size()> panels{};

    [[nodiscard]] bool does_as(const Block& other) const {
        for (std::size_t i = 0; i < panels.size(); ++i) {
            if ((panels[i] == nullptr) != (other.panels[i] == nullptr)) return false;
            if (panels[i] != nullptr &&
                (panels[i]->at("cells") != other.panels[i]->at("cells") ||
                 panels[i]->value("limit_x", Row{}) != other.panels[i]->value("limit_x", Row{})))
                return false;
        }
        return true;
    }
};
std::vector<Block> blocks_of(const std::vector<Row>& rows) {
    std::vector<Block> methods, blocks;
    for (const Row& row : rows) {
        if (methods.empty() || methods.back().methods.front() != row.at("integrator"))
            methods.push_back({{row.at("integrator")}, {}});
        for (std::size_t i = 0; i < shown.size(); ++i)
            if (row.at("numbers") == shown[i].numbers && row.at("carry") == shown[i].carry)
                methods.back().panels[i] = &row;
    }
    for (const Block& method : methods) {
        const auto same = std::find_if(blocks.begin(), blocks.end(), [&](const Block& b) { return b.does_as(method); });
        if (same == blocks.end()) blocks.push_back(method);
        else same->methods.push_back(method.methods.front());
    }
    return blocks;
}

class Picture {
public:
    Picture(const Map& map, const Row& axes, const std::vector<Row>& rows)
        : map_{map}, x_{axes, "x", map.x()}, y_{axes, "y", map.y()}, blocks_{blocks_of(rows)}, left_{margin()},
          rows_{(blocks_.size() + columns - 1) / columns} {}

    [[nodiscard]] std::string draw() {
        out_ = text("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%g\" height=\"%g\" font-family=\"sans-serif\" "
                    "font-size=\"%g\">\n",
                    width(), height(), font_size);
        out_ += "<title>" + escaped(map_.title()) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
        // Classes of panels: cells without gaps, frame and limit; small text, centered and right-aligned.
        out_ += text("<style>.c{shape-rendering:crispEdges}.f{fill:none;stroke:#808080}.l{fill:none;stroke:#000;"
                     "stroke-width:1.6;stroke-dasharray:5 3}.h{fill:none;stroke:#fff;stroke-width:3.2}"
                     ".m{text-anchor:middle;font-size:%gpx}.e{text-anchor:end;font-size:%gpx}</style>\n",
                     small_size, small_size);
        legend();
        for (std::size_t i = 0; i < blocks_.size(); ++i) block(i);
        return out_ + "</svg>\n";
    }

private:
    static constexpr std::size_t columns = 2;
    static constexpr double block_width = shown.size() * (panel_width + panel_gap) - panel_gap;

    // Width of the tics and the label of y.
    [[nodiscard]] double margin() const {
        std::size_t longest = 0;
        for (const auto& tic : y_.tics(most_y_tics)) longest = std::max(longest, tic.text.size());
        return 30 + letter_width * small_size * static_cast<double>(longest);
    }
    [[nodiscard]] double width() const {
        return columns * (left_ + block_width) + (columns - 1) * (block_gap - 20) + right;
    }
    [[nodiscard]] double height() const { return top + static_cast<double>(rows_) * (panel_height + row_gap) + bottom; }

    void write(double x, double y, const std::string& what, const std::string& more = {}) {
        out_ += text("<text x=\"%.4g\" y=\"%.4g\"", x, y) + (more.empty() ? "" : " " + more) + ">" + escaped(what) +
                "</text>\n";
    }

    void legend() {
        write(14, 22, map_.title(), "font-size=\"15\"");
        double x = 14;
        for (const Look& look : looks) {
            out_ += text("<rect x=\"%.4g\" y=\"35\" width=\"16\" height=\"16\" fill=\"%s\"/>\n", x, look.fill);
            write(x + 8, 47, std::string(1, static_cast<char>(look.outcome)),
                  text("class=\"m\" fill=\"%s\"", look.letter));
            const std::string words = words_of(look.outcome);
            write(x + 21, 47, words);
            x += 34 + 0.53 * font_size * static_cast<double>(words.size());
        }
        bool has_limits = false;
        for (const Block& block : blocks_)
            for (const Row* row : block.panels) has_limits = has_limits || (row != nullptr && row->contains("limit_x"));
        if (has_limits) {
            out_ += text("<path class=\"l\" d=\"M%.4g 43h26\"/>\n", x);
            write(x + 32, 47, "limit of the method");
        }
    }

    void block(std::size_t index) {
        const Block& block = blocks_[index];
        // Down the first column, then the second.
        const std::size_t column = index / rows_, row = index % rows_;
        const double x = left_ + static_cast<double>(column) * (block_width + left_ + block_gap - 20);
        const double y = top + static_cast<double>(row) * (panel_height + row_gap);
        const bool is_last = row + 1 == rows_ || index + 1 == blocks_.size();
        std::string names;
        for (const auto& method : block.methods) names += (names.empty() ? "" : ", ") + method;
        write(x, y - 5, names, "font-weight=\"bold\"");
        for (std::size_t i = 0; i < shown.size(); ++i) {
            const double at = x + static_cast<double>(i) * (panel_width + panel_gap), middle = at + panel_width / 2;
            if (row == 0) write(middle, y - 20, host::numbers_text(shown[i].numbers, shown[i].carry), "class=\"m\"");
            panel(block.panels[i], at, y);
            if (!is_last) continue;
            double end = -1;  // of the text before
            for (const auto& tic : x_.tics(most_x_tics)) {
                const double half = letter_width * small_size * static_cast<double>(tic.text.size()) / 2,
                             place = tic.place * cell_width();
                if (place - half < end) continue;
                end = place + half + 4;
                write(at + place, y + panel_height + 14, tic.text, "class=\"m\"");
            }
        }
        if (is_last) write(x + block_width / 2, y + panel_height + 32, x_.label(), "text-anchor=\"middle\"");
        double below = -small_size;
        for (const auto& tic : y_.tics(most_y_tics)) {
            const double place = tic.place * cell_height();
            if (place < below + small_size) continue;
            below = place;
            write(x - 4, y + panel_height - place + 4, tic.text, "class=\"e\"");
        }
        if (row == 0) {
            const double rows = static_cast<double>(std::min(rows_, blocks_.size() - index)), at_x = x - left_ + 14,
                         at_y = y + (rows * (panel_height + row_gap) - row_gap) / 2;
            write(at_x, at_y, y_.label(),
                  text("text-anchor=\"middle\" transform=\"rotate(-90 %.4g %.4g)\"", at_x, at_y));
        }
    }

    [[nodiscard]] double cell_width() const { return panel_width / static_cast<double>(x_.count()); }
    [[nodiscard]] double cell_height() const { return panel_height / static_cast<double>(y_.count()); }

    void panel(const Row* row, double x, double y) {
        const std::string frame = text("<rect class=\"f\" x=\"%.4g\" y=\"%.4g\" width=\"%g\" height=\"%g\"/>\n", x, y,
                                       panel_width, panel_height);
        if (row == nullptr) {
            out_ += frame;
            write(x + panel_width / 2, y + panel_height / 2 + 4, "not in fixed point", "class=\"m\" fill=\"#606060\"");
            return;
        }
        const std::string cells = row->at("cells");
        if (cells.size() != x_.count() * y_.count())
            throw std::runtime_error{map_.name() + ": a row has " + std::to_string(cells.size()) + " cells"};
        // In cells, y up.
        out_ += text("<g class=\"c\" transform=\"matrix(%.5g 0 0 %.5g %.5g %.5g)\">", cell_width(), -cell_height(), x,
                     y + panel_height);
        const auto found = rectangles_of(cells, x_.count());
        std::string letters;
        for (const Look& look : looks) {
            const auto of_letter = found.find(static_cast<char>(look.outcome));
            if (of_letter == found.end()) continue;
            out_ += text("<path fill=\"%s\" d=\"", look.fill);
            const Rectangle* largest = nullptr;
            for (const Rectangle& r : of_letter->second) {
                out_ += "M" + std::to_string(r.x) + " " + std::to_string(r.y) + "h" + std::to_string(r.width) + "v" +
                        std::to_string(r.height) + "h-" + std::to_string(r.width) + "z";
                const auto room = [&](const Rectangle& rectangle) {
                    return std::min(static_cast<double>(rectangle.width) * cell_width(),
                                    static_cast<double>(rectangle.height) * cell_height());
                };
                if (largest == nullptr || room(r) > room(*largest)) largest = &r;
            }
            out_ += "\"/>";
            const double wide = static_cast<double>(largest->width) * cell_width(),
                         high = static_cast<double>(largest->height) * cell_height();
            if (wide < letter_size * 0.8 || high < letter_size) continue;
            letters += text("<text class=\"m\" x=\"%.4g\" y=\"%.4g\" fill=\"%s\">%c</text>",
                            x + static_cast<double>(largest->x) * cell_width() + wide / 2,
                            y + panel_height - static_cast<double>(largest->y) * cell_height() - high / 2 + 4,
                            look.letter, static_cast<char>(look.outcome));
        }
        out_ += "</g>\n" + letters + (letters.empty() ? "" : "\n") + frame;
        if (row->contains("limit_x")) limit(row->at("limit_x"), x, y);
    }

    // Vertical through each row of cells, and from one row to the next. Rows without a limit on the map have no line.
    void limit(const Row& limits, double x, double y) {
        std::string path;
        bool is_down = false;
        for (std::size_t i = 0; i < limits.size(); ++i) {
            const double place = limits[i].is_null() ? -1 : x_.place_of(limits[i]);
            if (place < 0 || place > static_cast<double>(x_.count())) {
                is_down = false;
                continue;
            }
            path += text("%s%.4g %.4gv%.3g", is_down ? "L" : "M", x + place * cell_width(),
                         y + panel_height - static_cast<double>(i) * cell_height(), -cell_height());
            is_down = true;
        }
        if (path.empty()) return;
        out_ += "<path class=\"h\" d=\"" + path + "\"/><path class=\"l\" d=\"" + path + "\"/>\n";
    }

    static constexpr std::size_t most_x_tics = 5, most_y_tics = 6;

    const Map& map_;
    Scale x_, y_;
    std::vector<Block> blocks_;
    double left_;
    std::size_t rows_;
    std::string out_;
};

}  // namespace

std::string picture_of(const Map& map, const Row& axes, const std::vector<Row>& rows) {
    return Picture{map, axes, rows}.draw();
}

}  // namespace tumble::bench::stress
