// Kick-drift-kick with the exact rotation of a free rigid body, by Jacobi's elliptic functions. Without torques a step
// may have any length, over any number of turns and flips, and its only error is rounding. With torques the order is 2,
// because the kicks are of order 2. Floating point only.
#pragma once

#include <tumble/integrators/kick_drift_kick.hpp>
#include <tumble/integrators/rotation/exact_flow.hpp>

namespace tumble::integrators {

// The exact rotation of a free body, of order 2 with torques. Floating point only.
struct Exact : KickDriftKick<ExactFlow> {
    static constexpr const char* name = "exact";
    static constexpr int order = 2;
    static constexpr int free_order = no_truncation;
    static constexpr bool exact_for_spheres = true;
    static constexpr bool follows_any_turn = true;
    static constexpr const char* needs = "sqrt and division a step; several, sine and cosine when the spin changes";
    static constexpr const char* not_in_fixed_point =
        "its constants take several square roots, divisions, sine and cosine whenever the spin changes, for what "
        "pdmv10 reaches without them: the rounding of q32";
};

}  // namespace tumble::integrators
