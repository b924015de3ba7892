// The motion of a mechanism in the coordinates that its joints leave free, in long double: no engine's code, no gap. It
// is that of the reference by which scenes with joints are judged.
#pragma once

#include "mechanism.hpp"

namespace tumble::bench {

// The motions of all links at `samples` equal distances in the run of the mechanism. Throws std::runtime_error if a run
// with twice the step differs by more than 1e-9 m, or if the energy changes by more than 1e-9 of its scale.
[[nodiscard]] std::vector<std::vector<reference::Motion>> truth_of(const Mechanism& mechanism, int samples);

}  // namespace tumble::bench
