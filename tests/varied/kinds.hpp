// The kinds of varied scenes: each is one source file, one declaration here and one line in kinds.cpp.
#pragma once

#include "varied.hpp"

namespace tumble::test {

std::string judge_flat_falls(Draw& draw, Case& drawn);
std::string judge_resistance(Draw& draw, Case& drawn);
// seams.cpp
std::string box_slides_over_flush_blocks(Draw& draw, Case& run);
std::string body_falls_along_flush_blocks(Draw& draw, Case& run);
std::string body_slides_over_a_row_of_free_boxes(Draw& draw, Case& run);
std::string ball_rolls_over_flush_blocks(Draw& draw, Case& run);
std::string step_stops_a_box(Draw& draw, Case& run);
std::string ball_bounces_on_flush_blocks_as_on_one(Draw& draw, Case& run);

namespace moving_surfaces {  // carried.cpp
std::string carried(Draw& draw, Case& run);
std::string pushed(Draw& draw, Case& run);
std::string turned(Draw& draw, Case& run);
}  // namespace moving_surfaces

namespace edges {
std::string leaving_ball(Draw& draw, Case& run);
std::string tipping_box(Draw& draw, Case& run);
}  // namespace edges
// sleepers_and_loads.cpp
std::string sleeper_pulled_by_a_spring(Draw& draw, Case& scene);
std::string sleeper_attracted_by_a_mass(Draw& draw, Case& scene);
std::string sleeper_beside_a_constant_load(Draw& draw, Case& scene);
// steady_spins.cpp
std::string body_that_turns_by_itself(Draw& draw, Case& scene);
std::string box_on_a_tilted_plate_that_turns(Draw& draw, Case& scene);
// slender_rods.cpp
std::string spin_that_leaves_its_range(Draw& draw, Case& scene);
std::string rod_that_rolls_out_of_its_range(Draw& draw, Case& scene);
std::string boxes_on_a_tray_that_tilts(Draw& draw, Case& drawn);
std::string balls_on_a_tray_that_tilts(Draw& draw, Case& drawn);

}  // namespace tumble::test
