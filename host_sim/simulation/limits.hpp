// Limits of methods and number systems that a scene's step is known to be beyond before it is run. What is said is
// certain at the start of the scene; that nothing is said promises nothing of what happens later.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/description.hpp"

namespace tumble::host {

struct Limit {
    std::string where;    // spring[0], body "b", force[0], gravity
    std::string what;     // spring, contact spring, damper, drag, gravitation, force, spin, range, impact, load, place
    double value, limit;  // what the step makes of it, and what method and number system stand: without unit where a
                          // step is multiplied by a rate, rad/s of spins, ranges and impacts, m/s of loads, m of places
    double largest_step;  // s: safe, and not far below what is not; 0: no step is. At the shortest nothing more is told
    std::string sentence;  // all of it, without a full stop
};

// Those that the scene's step exceeds, the worst of each place. `carry` empty: the number system's default.
[[nodiscard]] std::vector<Limit> exceeded_limits(const SceneDescription& scene, std::string_view integrator,
                                                 std::string_view numbers, std::optional<bool> carry = {});

}  // namespace tumble::host
