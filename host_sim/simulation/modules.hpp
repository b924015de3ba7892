// The worlds of a number system are a module, a shared library: a run loads those that it needs, and where one has not
// been built yet it is built first, which takes a quarter of a minute.
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

}  // namespace tumble::host
