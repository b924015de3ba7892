// Tables of the rows of bench/engines/joints.
#pragma once

#include "tables/table.hpp"

namespace tumble::bench {

// Mechanisms in each engine: a line each with its errors at all steps, and at 1/256 s its gap, what its energy moves by
// and its cost.
[[nodiscard]] Table joints_table(const Rows& rows);

// Pendulums in this kernel for millions of steps.
[[nodiscard]] Table joints_long_table(const Rows& rows);

}  // namespace tumble::bench
