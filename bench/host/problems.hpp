// The problems of bench/host.
#pragma once

#include "engines/contender.hpp"

namespace tumble::bench {

// Those of one body or a small scene, and of 1 to `most` bodies, ten times as many each time.
[[nodiscard]] std::vector<Problem> problems(int most);

}  // namespace tumble::bench
