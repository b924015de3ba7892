// What the programs that measure loop over: number systems, integrators, and both processors.
#pragma once

#include "firmware.hpp"
#include "parallel.hpp"
#include "simulation.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tumble::bench {

using Variant = host::NumberVariant;
using host::in_parallel;
inline const std::vector<Variant>& variants = host::number_variants();

[[nodiscard]] inline std::vector<std::string> variant_names() {
    std::vector<std::string> names;
    for (const Variant& v : variants) names.push_back(v.name);
    return names;
}
[[nodiscard]] inline std::vector<std::string> integrator_names() {
    std::vector<std::string> names;
    for (const auto& integrator : host::integrators()) names.push_back(integrator.name);
    return names;
}
// The variants of these names, in this order; throws std::invalid_argument for a name that is none.
[[nodiscard]] inline std::vector<Variant> variants_named(const std::vector<std::string>& names) {
    std::vector<Variant> chosen;
    for (const std::string& name : names) {
        const auto found =
            std::find_if(variants.begin(), variants.end(), [&](const Variant& v) { return v.name == name; });
        if (found == variants.end()) throw std::invalid_argument{"no number system '" + name + "'"};
        chosen.push_back(*found);
    }
    return chosen;
}

// Null where the method does not exist in the number system.
[[nodiscard]] inline std::unique_ptr<host::Simulation>
simulation_or_null(const host::SceneDescription& scene, const std::string& method, const Variant& variant) {
    try {
        return host::make_simulation(scene, method, variant.numbers, variant.carry);
    } catch (const std::invalid_argument&) { return nullptr; }
}

}  // namespace tumble::bench
