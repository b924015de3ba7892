// Shared by the measuring programs: number systems and integrators to loop over, and parallel loops.
#pragma once

#include "firmware/firmware.hpp"
#include "scene/scene_file.hpp"
#include "simulation/simulation.hpp"
#include "tools/parallel.hpp"
#include "tools/progress.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
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
// The variants of these names, in this order. Throws std::invalid_argument for an unknown name.
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

// in_parallel with a progress line.
inline void in_parallel_counted(const std::string& what, std::size_t count, const auto& work) {
    host::Progress progress(static_cast<std::int64_t>(count), host::Progress::Piped::tenths);
    in_parallel(count, [&](std::size_t i) {
        work(i);
        progress.step(what);
    });
}

}  // namespace tumble::bench
