// The picture of a map: a block of panels for each method, or for methods with the same cells, and a panel for each
// number system. A cell's color and letter are its outcome; a line is the limit of the method.
#pragma once

#include <string>
#include <vector>

#include "rows/rows.hpp"
#include "stress/map.hpp"

namespace tumble::bench::stress {

// An SVG file. `axes` is the map's row of axes, `rows` are its others.
[[nodiscard]] std::string picture_of(const Map& map, const Row& axes, const std::vector<Row>& rows);

}  // namespace tumble::bench::stress
