// The worlds of a number system are four modules, shared libraries: one of the methods of most runs, one of the rest,
// and two of all methods for scenes with joints, without contacts and with them. A run loads the modules that it needs,
// and builds a missing one first, which takes about ten seconds.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "scene/data.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

// A simulation in the index-th system of number_system_list; null for an integrator that does not run in it. Several
// threads may ask at once. Throws std::runtime_error where the module can be neither loaded nor built.
[[nodiscard]] std::unique_ptr<Simulation> make_in_module(std::size_t index, SceneData data,
                                                         std::string_view integrator);

// Is the module there? make_in_module() builds a missing one first.
[[nodiscard]] bool is_module_built(std::size_t index, const SceneData& data, std::string_view integrator);

}  // namespace tumble::host
