// Plots of a run as SVG: positions, angular velocities and energies over time. Marks show where impulses act and where
// contacts begin. Contact springs get no marks, since a world does not report where they begin.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "simulation/simulation.hpp"

namespace tumble::host {

class Plot {
public:
    // At most so many bodies are drawn: the first in the file that are not fixed.
    static constexpr std::size_t most_bodies = 8;

    // Keeps about five hundred samples of a run.
    Plot(const Simulation& simulation, const SceneDescription& scene);
    // Call it before the first step and after each step. The last call ends the time axis.
    void sample(const Simulation& simulation, const Energy& energy, bool last);

    // The SVG, drawn by gnuplot; throws std::runtime_error when that fails.
    [[nodiscard]] std::string drawn() const;

private:
    struct State {
        double time;                    // s
        std::array<double, 6> numbers;  // position, m, world; angular velocity, rad/s, user's body axes
    };
    struct Track {
        int body;
        std::string name;
        std::vector<double> impulse_times;  // s, rising
        std::size_t impulses_seen = 0;
        int contact_points = 0;
        // Less than a hundredth of the run after a mark of its kind there is no other.
        std::vector<State> states, impulses, contacts;
    };
    // For gnuplot.
    [[nodiscard]] std::string script() const;
    [[nodiscard]] std::string data() const;
    [[nodiscard]] std::string motion_panels() const;
    [[nodiscard]] std::string key() const;

    std::string title_, subtitle_;
    std::int64_t every_;
    double duration_;  // s, of the whole run, or until its last sample
    bool has_contact_springs_;
    int bodies_;
    std::vector<Track> tracks_;
    std::vector<std::array<double, 4>> energies_;  // time, s; kinetic, potential, total, J
};

}  // namespace tumble::host
