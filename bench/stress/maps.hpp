// Every map is made by a function of its own file.
#pragma once

#include <memory>

#include "stress/map.hpp"

namespace tumble::bench::stress {

[[nodiscard]] std::unique_ptr<Map> make_springs();

}  // namespace tumble::bench::stress
