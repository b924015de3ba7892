// Verlet: kick-drift-kick with the symmetric-top splitting of the rotation. The default method: order 2, reversible in
// time, momentum norm exact to rounding, bounded energy error over any number of steps. No division, no square root.
#pragma once

#include <tumble/integrators/kick_drift_kick.hpp>
#include <tumble/integrators/rotation/symmetric_top.hpp>

namespace tumble::integrators {

// The default method: order 2, reversible in time, bounded energy error. No division, no square root.
struct Verlet : KickDriftKick<SymmetricTopFlow> {
    static constexpr const char* name = "verlet";
    static constexpr int order = 2;
    static constexpr bool exact_for_spheres = true;
};

}  // namespace tumble::integrators
