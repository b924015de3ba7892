// The features of the host's worlds.
#pragma once

#include "scene/data.hpp"

namespace tumble::host {

// Every feature that a scene file can ask for, with the host's room. Control and its sensor are for programs.
inline constexpr Features host_features = [] {
    Features f =
        Features{.bodies = max_bodies, .planes = max_planes, .springs = max_springs, .near_pairs = max_near_pairs}
            .with_everything();
    f.control = f.imu = false;
    return f;
}();

}  // namespace tumble::host
