#include "command/near_pairs.hpp"

#include <algorithm>

#include "scene/data.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {
namespace {

// The count ends after so many steps, in which a pile comes to rest.
constexpr std::int64_t most_steps = 16384;

int most_near_pairs(const SceneDescription& scene) {
    const auto simulation = make_simulation(scene, "verlet", "f64");
    int most = 0;
    for (std::int64_t step = 0; step < std::min(scene.steps(), most_steps); ++step) {
        simulation->step();
        most = std::max(most, simulation->near_pair_count());
        if (simulation->has_trouble("range_left")) break;
    }
    return most;
}

}  // namespace

int near_pairs_for(const SceneDescription& scene) {
    const Features features = needs(build_scene(scene));
    const int usual = features.room_for_pairs();
    const int bodies = features.bodies, all = bodies * features.planes + bodies * (bodies - 1) / 2;
    if (!features.pairs || !features.contacts() || usual >= all) return 0;
    const int most = most_near_pairs(scene), room = std::min(all, most + (most + 7) / 8);
    return room > usual ? room : 0;
}

}  // namespace tumble::host
