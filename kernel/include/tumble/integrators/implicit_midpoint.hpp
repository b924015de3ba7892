// The implicit midpoint rule: everything in the middle of the step. Order 2, symmetric in time, A-stable without
// damping; of a free body it conserves energy, the momentum's norm and the world's angular momentum to the solver's
// rounding. In floating point a step takes a square root and a division.
#pragma once

#include <tumble/integrators/one_stage_implicit.hpp>

namespace tumble::integrators {

struct ImplicitMidpoint : OneStageImplicit<Stage::middle> {
    static constexpr const char* name = "implicit_midpoint";
    static constexpr int order = 2;
    static constexpr const char* needs = "sqrt and division in floating point";
};

}  // namespace tumble::integrators
