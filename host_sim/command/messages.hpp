// What the command says of a run that went wrong.
#pragma once

#include <string>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

// What happened, to which body, when, what it means for the result, and the one thing to do: `cure` of the run's
// `first` trouble, options that are known to help, or else what helps by rule.
[[nodiscard]] std::string message_of(const Trouble& trouble, const Trouble& first, const SceneDescription& scene,
                                     const Simulation& simulation, const std::string& cure = {});

// What a fixed-point run promises of spins, where the file's [range] asks for more than the step can hold. Empty where
// it holds them.
[[nodiscard]] std::string unheld_spin(const SceneDescription& scene, const Simulation& simulation);

}  // namespace tumble::host
