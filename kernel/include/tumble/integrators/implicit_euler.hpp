// Implicit (backward) Euler: everything at the end of the step. Order 1, A-stable, damps. No square root for a free
// body.
#pragma once

#include <tumble/integrators/one_stage_implicit.hpp>

namespace tumble::integrators {

struct ImplicitEuler : OneStageImplicit<Stage::end> {
    static constexpr const char* name = "implicit_euler";
    static constexpr int order = 1;
};

}  // namespace tumble::integrators
