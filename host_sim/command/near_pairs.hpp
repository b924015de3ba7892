// How many pairs of a scene are near each other at one time.
#pragma once

#include "scene/description.hpp"

namespace tumble::host {

// Features::near_pairs of a firmware that replays the scene; 0 where the default is enough. The number is an eighth
// larger than the most pairs at the end of a step of a run in double precision, since other numbers and methods, and
// the middle of a step, may have a few more.
[[nodiscard]] int near_pairs_for(const SceneDescription& scene);

}  // namespace tumble::host
