// Kick-drift-kick with the splitting of the rotation into turns about the three body axes. For comparison.
#pragma once

#include <tumble/integrators/kick_drift_kick.hpp>
#include <tumble/integrators/rotation/three_axis.hpp>

namespace tumble::integrators {

// Three-axis splitting: order 2. No division, no square root.
struct Strang : KickDriftKick<ThreeAxisFlow> {
    static constexpr const char* name = "strang";
    static constexpr int order = 2;
    static constexpr bool keeps_the_spin_of_spheres = false;  // the turns of a sphere do not commute
};

}  // namespace tumble::integrators
