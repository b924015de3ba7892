#include "kinds.hpp"

namespace tumble::test {

const std::vector<Kind> kinds{
    {"flat_falls_are_no_deeper_than_the_tolerance_and_gain_no_energy", flat_falls::fall},
    {"a_rim_that_lands_tilted_bounces_on_the_point_that_touches", rim_bounces::land},
    {"resistance_slows_a_body_by_its_law_and_leaves_finite_numbers", resistance::slowed},
    {"what_rests_on_a_surface_that_accelerates_keeps_its_place", carried::by_friction_or_weight},
    {"what_a_wall_pushes_over_ice_stays_at_the_wall", carried::by_a_wall_on_ice},
    {"a_box_keeps_its_place_on_a_platform_whose_spin_changes", carried::by_a_platform},
    {"a_ball_that_leaves_an_edge_falls_freely", edges::leaving_ball},
    {"a_box_tips_over_an_edge_in_order_two", edges::tipping_box},
    {"a_box_slides_over_flush_blocks_by_coulombs_law", seams::box_slides},
    {"a_box_slides_between_walls_as_on_the_floor_alone", seams::box_slides_between_walls},
    {"a_body_falls_freely_along_flush_blocks", seams::body_falls},
    {"a_body_slides_over_a_row_of_free_boxes_at_its_speed", seams::body_slides_over_free_boxes},
    {"a_ball_rolls_over_flush_blocks_without_a_hop", seams::ball_rolls},
    {"a_step_between_blocks_stops_a_box", seams::step_stops_a_box},
    {"a_ball_bounces_on_flush_blocks_as_on_one_block", seams::ball_bounces},
    {"a_sleeper_comes_along_when_the_other_end_of_its_spring_moves", sleepers_and_loads::pulled},
    {"a_sleeper_slides_when_a_mass_comes_near", sleepers_and_loads::attracted},
    {"a_body_with_a_constant_load_falls_asleep", sleepers_and_loads::asleep},
    {"a_box_that_has_tumbled_falls_asleep_beside_a_ball_that_pulls_it", sleepers_and_loads::asleep_beside_a_ball},
    {"a_body_that_nothing_pushes_turns_steadily", steady_spins::turning},
    {"a_box_goes_round_with_a_tilted_plate", steady_spins::carried},
    {"a_spin_that_leaves_its_range_is_held_at_the_number_that_is_told", slender_rods::driven},
    {"a_rod_that_rolls_out_of_its_range_is_held_there", slender_rods::rolling},
    {"boxes_slide_when_gravity_leaves_the_cone_of_friction", tilts::boxes},
    {"balls_roll_down_the_slope_that_gravity_makes", tilts::balls},
};

}  // namespace tumble::test
