// The features of the host's worlds.
#pragma once

#include "scene/data.hpp"

namespace tumble::host {

// Every feature of the kernel, with the host's room.
inline constexpr Features host_features =
    Features{.bodies = max_bodies, .planes = max_planes, .springs = max_springs, .near_pairs = max_near_pairs}
        .with_everything();

}  // namespace tumble::host
