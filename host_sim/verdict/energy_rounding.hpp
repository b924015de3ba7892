// The energy that rounding may change: places have a spacing, and joints a bound within which they count as closed.
#pragma once

#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

class EnergyRounding {
public:
    explicit EnergyRounding(const SceneDescription& scene);

    // J, where the bodies are now. Each term of the potential changes with a place by its force. The terms may cancel
    // where bodies rest, and then this is all the energy that changes.
    [[nodiscard]] long double of(const Simulation& simulation) const;

private:
    // What joints leave open lowers what hangs on them, J.
    [[nodiscard]] long double of_joints(const Simulation& simulation, long double weight) const;

    SceneDescription scene_;
    std::vector<long double> mass_;  // kg; 0: fixed
};

}  // namespace tumble::host
