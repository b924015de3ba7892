// Draws rows of work against precision: one picture a problem, with a panel for each core and one for the legend, so
// that integers, float and double of all methods are seen together. A run that failed is a mark on the left edge. The
// order in the legend is the median of what halving the step has gained, over the steps where it gained something.
#include "rows.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <limits>
#include <map>
#include <string>

namespace {

using tumble::bench::numbers_of, tumble::bench::Row;
namespace fs = std::filesystem;

const std::array<const char*, 2> error_keys = {"orientation_error_rad", "position_error_m"};

struct Series {
    std::string method, numbers;
    std::map<std::string, std::string> points, failures;  // by core, as gnuplot reads them
    std::vector<double> orders;                           // of one core: they are the same on all

    // Empty where halving the step has never helped.
    [[nodiscard]] std::string order() const {
        const auto median = tumble::bench::median_order(orders);
        if (!median) return {};
        char text[32];
        std::snprintf(text, sizeof text, ", order %.1f", *median);
        return text;
    }
};

std::string file_name(std::string scene) {
    for (char& c : scene) c = std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '_';
    return "work_precision_" + scene + ".svg";
}

void draw(const fs::path& svg, const std::string& scene, const std::vector<Row>& rows,
          const std::vector<std::string>& numbers) {
    std::vector<std::string> cores, methods;
    std::vector<Series> all;
    std::string error_key;
    double largest = 0, smallest = std::numeric_limits<double>::infinity();
    const auto note = [](std::vector<std::string>& names, const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    for (const Row& row : rows) {
        if (row.at("scene") != scene) continue;
        const std::string n = numbers_of(row), method = row.at("integrator"), core = row.at("core");
        if (std::find(numbers.begin(), numbers.end(), n) == numbers.end()) continue;
        note(cores, core);
        note(methods, method);
        auto found =
            std::find_if(all.begin(), all.end(), [&](const Series& s) { return s.method == method && s.numbers == n; });
        if (found == all.end()) found = all.insert(all.end(), Series{method, n, {}, {}, {}});
        char text[64];
        const double cost = row.at("insn_per_simulated_second");
        if (row.contains("failure")) {
            std::snprintf(text, sizeof text, "%.6g\n", cost);
            found->failures[core] += text;
            continue;
        }
        for (const char* key : error_keys)
            if (row.contains(key)) error_key = key;
        const double error = row.at(error_key);
        if (!(error > 0)) continue;  // exact: no place on a logarithmic axis
        if (error < 100) largest = std::max(largest, error);
        smallest = std::min(smallest, error);
        std::snprintf(text, sizeof text, "%.6g %.6g\n", error, cost);
        found->points[core] += text;
        if (core == cores.front() && row.contains("observed_order")) found->orders.push_back(row.at("observed_order"));
    }
    if (all.empty()) return;
    const double left = std::pow(10.0, std::ceil(std::log10(largest)) + 1),
                 right = std::pow(10.0, std::floor(std::log10(smallest)));

    const std::size_t panel_rows = (cores.size() + 2) / 2;  // two panels a row, and one more for the legend
    std::string script = "set terminal svg size 1500," + std::to_string(575 * panel_rows) +
                         " font 'sans,11' background 'white'\nset output '" + svg.string() +
                         "'\nset multiplot layout " + std::to_string(panel_rows) + ",2 title '" + scene +
                         "' noenhanced\nset logscale xy\nset format '10^{%L}'\nset grid\nunset key\n";
    char range[96];
    std::snprintf(range, sizeof range, "set xrange [%g:%g]\n", left, right);
    script += range;
    // A color is a method, a line style a number system.
    const auto style = [&](const Series& s) {
        const auto color = std::find(methods.begin(), methods.end(), s.method) - methods.begin();
        const auto dash = std::find(numbers.begin(), numbers.end(), s.numbers) - numbers.begin();
        char text[128];
        // Around the color wheel, every other color darker.
        std::snprintf(text, sizeof text, "dashtype %d pointtype %d pointsize 0.6 linecolor rgb hsv2rgb(%.3f, 1, %.2f)",
                      static_cast<int>(dash) + 1, static_cast<int>(dash) * 2 + 5,
                      static_cast<double>(color) / static_cast<double>(methods.size()), color % 2 == 0 ? 0.9 : 0.55);
        return std::string{text};
    };
    const auto curves = [&](const auto& write) {
        std::string plot = "plot ", data;
        for (const Series& s : all) write(s, plot, data);
        script += plot.substr(0, plot.size() - 2) + "\n" + data;
    };
    for (const std::string& core : cores) {
        script += "set title '" + core + "'\nset xlabel '" +
                  (error_key == error_keys[0] ? "orientation error, rad" : "position error, m") +
                  "'\nset ylabel 'instructions per simulated second'\n";
        curves([&](const Series& s, std::string& plot, std::string& data) {
            if (const auto found = s.points.find(core); found != s.points.end()) {
                plot += "'-' with linespoints " + style(s) + ", ";
                data += found->second + "e\n";
            }
            if (const auto found = s.failures.find(core); found != s.failures.end()) {
                plot += "'-' using (" + std::to_string(left) + "):1 with points " + style(s) + ", ";
                data += found->second + "e\n";
            }
        });
    }
    script += "set title 'failed runs stand on the left edge'\nunset xlabel\nunset ylabel\nunset border\nunset tics\n"
              "unset grid\nset key center center maxcols 2 maxrows 40 samplen 3\n";
    script += "set yrange [1:10]\n";
    curves([&](const Series& s, std::string& plot, std::string&) {
        plot += "1/0 with linespoints " + style(s) + " title '" + s.method + ", " + s.numbers + s.order() +
                "' noenhanced, ";
    });
    script += "unset multiplot\n";
    FILE* gnuplot = popen("gnuplot", "w");
    if (gnuplot == nullptr) throw std::runtime_error{"cannot run gnuplot"};
    std::fputs(script.c_str(), gnuplot);
    if (pclose(gnuplot) != 0) throw std::runtime_error{"gnuplot failed for " + svg.string()};
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{"Draws rows of work against precision, a picture a problem."};
    std::vector<fs::path> files;
    std::vector<std::string> numbers = {"q32 carry", "f32 plain", "f64"};
    fs::path directory = "build/results";
    app.add_option("rows", files, "Files of rows")->required();
    app.add_option("--numbers", numbers, "Number systems to draw, as \"q32 carry\"")->delimiter(',');
    app.add_option("--directory", directory, "Where the pictures go");
    CLI11_PARSE(app, argc, argv);
    fs::create_directories(directory);
    for (const fs::path& file : files) {
        const auto rows = tumble::bench::read_rows(file);
        std::vector<std::string> scenes;
        for (const Row& row : rows) {
            const std::string scene = row.at("scene");
            if (std::find(scenes.begin(), scenes.end(), scene) != scenes.end()) continue;
            scenes.push_back(scene);
            draw(directory / file_name(scene), scene, rows, numbers);
        }
    }
    return 0;
} catch (const std::exception& error) {
    std::cerr << "tumble_pictures: " << error.what() << '\n';
    return 1;
}
