// Tables and figures of the kernel's own constants, as its headers state them.
#pragma once

#include "tables/table.hpp"

namespace tumble::bench {

// Every method: its orders, what a step needs, and what that of a free body costs by the rows.
[[nodiscard]] Table integrators_table(const Rows& free_body);

// The range of a fixed-point quantity and the step between its values, at 1/256 s.
[[nodiscard]] Table formats_table();

// The longest step of each method.
[[nodiscard]] Table stability_table();

// The smallest and the largest value that fixed point holds in each range, at 1/64, 1/256 and 1/1024 s.
[[nodiscard]] Table resolution_table();

// Bounds of a contact step.
[[nodiscard]] Table bounds_table();

// RAM that a near pair takes in a world of `q32`, by the shapes that touch.
[[nodiscard]] Table near_pairs_table();

// What the calls cost by which a program controls a body and reads it, and the examples that are measured.
[[nodiscard]] Table control_table(const Rows& control);
[[nodiscard]] Table stories_table(const Rows& control);

// The largest angle that a body turns in a step, rad.
// Of a near pair, with the feature contact_readout.
[[nodiscard]] std::string readout_bytes(bool is_fixed_point, bool has_friction);
[[nodiscard]] std::string largest_turn();

}  // namespace tumble::bench
