// Kick-drift-kick with the splitting of the rotation into turns about the three body axes: here to compare with.
#pragma once

#include <tumble/integrators/kick_drift_kick.hpp>
#include <tumble/integrators/rotation/three_axis.hpp>

namespace tumble::integrators {

// Three-axis splitting: order 2; no division, no square root.
struct Strang : KickDriftKick<ThreeAxisFlow> {
    static constexpr const char* name = "strang";
    static constexpr int order = 2;
    static constexpr bool keeps_the_spin_of_spheres = false;  // its turns do not commute
};

}  // namespace tumble::integrators
