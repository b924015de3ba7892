#include "command/near_pairs.hpp"

#include <tumble/replay.hpp>
#include <tumble/tumble.hpp>

#include <algorithm>
#include <memory>

#include "simulation/host_features.hpp"

namespace tumble::host {
namespace {

// The count ends after so many steps, in which a pile comes to rest.
constexpr std::uint32_t most_steps = 16384;

using Counted = Replay<SceneOf<NumbersOf<"f64", RoomRange>, integrators::Verlet, host_features>, SceneData>;

int most_near_pairs(const SceneData& scene) {
    const auto replay = std::make_unique<Counted>(with_events_in_order(scene));
    int most = 0;
    for (std::uint32_t step = 0; step < std::min(scene.steps, most_steps); ++step) {
        const Status status = replay->step();
        most = std::max(most, replay->world().near_pair_count());
        if (status.has(Issue::range_left)) break;
    }
    return most;
}

}  // namespace

int near_pairs_for(const SceneData& scene) {
    const Features features = needs(scene);
    const int usual = features.room_for_pairs();
    const int bodies = features.bodies, all = bodies * features.planes + bodies * (bodies - 1) / 2;
    if (!features.pairs || !features.contacts() || usual >= all) return 0;
    const int most = most_near_pairs(scene), room = std::min(all, most + (most + 7) / 8);
    return room > usual ? room : 0;
}

}  // namespace tumble::host
