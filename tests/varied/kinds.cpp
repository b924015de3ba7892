#include "kinds.hpp"

namespace tumble::test {

const std::vector<Kind> kinds{
    {"flat_falls_end_within_the_tolerance_and_gain_no_energy", judge_flat_falls},
    {"resistance_slows_a_body_by_its_law_and_leaves_finite_numbers", judge_resistance},
    {"what_rests_on_a_surface_that_accelerates_keeps_its_place", moving_surfaces::carried},
    {"what_a_wall_pushes_over_ice_stays_at_the_wall", moving_surfaces::pushed},
    {"a_box_keeps_its_place_on_a_platform_whose_spin_changes", moving_surfaces::turned},
    {"a_ball_that_leaves_an_edge_falls_freely", edges::leaving_ball},
    {"a_box_tips_over_an_edge_in_order_two", edges::tipping_box},
    {"a_box_slides_over_flush_blocks_by_coulombs_law", box_slides_over_flush_blocks},
    {"a_body_falls_freely_along_flush_blocks", body_falls_along_flush_blocks},
    {"a_body_slides_over_a_row_of_free_boxes_at_its_speed", body_slides_over_a_row_of_free_boxes},
    {"a_ball_rolls_over_flush_blocks_without_a_hop", ball_rolls_over_flush_blocks},
    {"a_step_between_blocks_stops_a_box", step_stops_a_box},
    {"a_ball_bounces_on_flush_blocks_as_on_one_block", ball_bounces_on_flush_blocks_as_on_one},
    {"a_sleeper_comes_along_when_the_other_end_of_its_spring_moves", sleeper_pulled_by_a_spring},
    {"a_sleeper_slides_when_a_mass_comes_near", sleeper_attracted_by_a_mass},
    {"a_body_with_a_constant_load_falls_asleep", sleeper_beside_a_constant_load},
    {"a_body_that_nothing_pushes_turns_steadily", body_that_turns_by_itself},
    {"a_box_goes_round_with_a_tilted_plate", box_on_a_tilted_plate_that_turns},
    {"a_spin_that_leaves_its_range_is_held_at_the_number_that_is_told", spin_that_leaves_its_range},
    {"a_rod_that_rolls_out_of_its_range_is_held_there", rod_that_rolls_out_of_its_range},
    {"boxes_slide_when_gravity_leaves_the_cone_of_friction", boxes_on_a_tray_that_tilts},
    {"balls_roll_down_the_slope_that_gravity_makes", balls_on_a_tray_that_tilts},
};

}  // namespace tumble::test
