// The true motion of problems with a closed form, in long double. No code is shared with the kernel.
#pragma once

#include "scene/description.hpp"

#include <array>
#include <optional>
#include <vector>

namespace tumble::bench {

using Position = std::array<long double, 3>;  // m, world

// The positions of the scene's one moving body at 0, interval, 2 interval, ... (s; samples + 1 positions). Empty for a
// scene without a closed form here. There is one for
//   two bodies that attract each other, one of them fixed (Kepler's problem, on an ellipse);
//   a mass on a spring to a world point, on one line with gravity, whether damped less than critically or not at all;
//   a mass under gravity with drag that grows with velocity;
//   a sphere that falls on a horizontal plane and bounces, with the plane's or the world's restitution.
[[nodiscard]] std::optional<std::vector<Position>> closed_form(const host::SceneDescription& scene,
                                                               long double interval, int samples);

}  // namespace tumble::bench
