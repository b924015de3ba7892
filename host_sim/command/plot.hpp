// Plots of a run: positions, spins and the change of energy over time, as SVG.
#pragma once

#include <string>
#include <vector>

#include "simulation/simulation.hpp"

namespace tumble::host {

class Plot {
public:
    // Keeps about a thousand samples of a run.
    explicit Plot(const Simulation& simulation);
    void sample(const Simulation& simulation, const Energy& energy);

    // Draws with gnuplot; throws std::runtime_error when that or writing the file fails.
    void write(const std::string& path, const SceneDescription& scene) const;

private:
    std::int64_t every_;
    int bodies_;
    std::vector<std::string> body_rows_;  // one a body: time, position, spin
    std::string energy_rows_;
};

}  // namespace tumble::host
