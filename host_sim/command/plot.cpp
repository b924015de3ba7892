#include "command/plot.hpp"

#include <algorithm>
#include <fstream>

#include "tools/process.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

std::string in_gnuplot_quotes(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? "''" : c == '\n' ? " " : std::string(1, c);
    return quoted + "'";
}

}  // namespace

Plot::Plot(const Simulation& simulation)
    : every_(std::max<std::int64_t>(1, simulation.steps() / 1000)), bodies_(simulation.body_count()),
      body_rows_(static_cast<std::size_t>(bodies_)) {}

void Plot::sample(const Simulation& simulation, const Energy& energy) {
    if (simulation.steps_taken() % every_ != 0 && simulation.steps_taken() != simulation.steps()) return;
    const std::string time = few_digits(simulation.time());
    for (int b = 0; b < bodies_; ++b) {
        const BodySnapshot body = simulation.body(b);
        std::string& rows = body_rows_[static_cast<std::size_t>(b)];
        rows += time;
        for (const long double x : body.position) rows += " " + few_digits(x);
        for (const long double w : body.angular_velocity) rows += " " + few_digits(w);
        rows += "\n";
    }
    energy_rows_ += time;
    for (const long double part : {energy.kinetic, energy.potential, energy.total()})
        energy_rows_ += " " + few_digits(part);
    energy_rows_ += "\n";
}

void Plot::write(const std::string& path, const SceneDescription& scene) const {
    std::string script = "set terminal svg size 900,1000 background 'white'\n";
    for (std::size_t b = 0; b < body_rows_.size(); ++b)
        script += "$body" + std::to_string(b) + " << EOD\n" + body_rows_[b] + "EOD\n";
    script += "$energy << EOD\n" + energy_rows_ + "EOD\n";
    script += "set multiplot layout 3,1 title " + in_gnuplot_quotes(scene.name.empty() ? scene.path : scene.name) +
              " noenhanced\nset key outside right noenhanced\nset grid\n";
    const auto panel = [&](const char* label, const char* axes, int first) {
        script += "set ylabel '" + std::string(label) + "'\nplot ";
        for (std::size_t b = 0; b < body_rows_.size(); ++b) {
            for (int i = 0; i < 3; ++i) {
                script += (b + static_cast<std::size_t>(i) == 0 ? "" : ", ") + std::string("$body") +
                          std::to_string(b) + " using 1:" + std::to_string(first + i) + " with lines title " +
                          in_gnuplot_quotes(scene.bodies[b].name + " " + std::string(1, axes[i]));
            }
        }
        script += "\n";
    };
    panel("position, m", "xyz", 2);
    panel("angular velocity, rad/s", "xyz", 5);
    script += "set xlabel 'time, s'\nset ylabel 'energy, J'\n"
              "plot $energy using 1:2 with lines title 'kinetic', '' using 1:3 with lines title 'potential', '' using "
              "1:4 with lines title 'total'\n"
              "unset multiplot\n";
    Process gnuplot({"gnuplot"}, script, Process::Errors::keep);
    std::string svg;
    const int status = gnuplot.wait(&svg);
    if (status == 127)
        throw std::runtime_error("--plot: gnuplot not found; install it (Debian: apt install gnuplot-nox)");
    if (status != 0) throw std::runtime_error("--plot: gnuplot failed:\n" + gnuplot.errors());
    // Gnuplot itself would not say that its file could not be written.
    std::ofstream file(path);
    file << svg;
    file.close();
    if (!file) throw std::runtime_error("--plot: writing " + path + " failed");
}

}  // namespace tumble::host
