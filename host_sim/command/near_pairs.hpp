// Room for the pairs of a scene that are near each other at one time.
#pragma once

#include "scene/data.hpp"

namespace tumble::host {

// Features::near_pairs of a firmware that replays the scene: 0 where the usual room does; else an eighth more than the
// most that a run in double precision has had at the end of a step, since other numbers, methods and the middle of a
// step may have a few more.
[[nodiscard]] int near_pairs_for(const SceneData& scene);

}  // namespace tumble::host
