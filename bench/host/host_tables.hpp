// Tables of the rows of bench/host.
#pragma once

#include "tables/table.hpp"

namespace tumble::bench {

// The problems of one size: the errors of this kernel, and its time as a multiple of each engine's, whose error stands
// beside it.
[[nodiscard]] Table host_table(const Rows& all);

// Many bodies: the time of the default method in each number system as a multiple of each engine's.
[[nodiscard]] Table host_many_table(const Rows& all);

// The time of a body's step as a multiple of that of one body alone: this kernel's, and each engine's fastest.
[[nodiscard]] Table host_growth_table(const Rows& all);

}  // namespace tumble::bench
