#include "kinds.hpp"

namespace tumble::test {

const std::vector<Kind> kinds{
    {"resistance_slows_a_body_by_its_law_and_leaves_finite_numbers", judge_resistance},
    {"what_rests_on_a_surface_that_accelerates_keeps_its_place", moving_surfaces::carried},
    {"what_a_wall_pushes_over_ice_stays_at_the_wall", moving_surfaces::pushed},
    {"a_box_keeps_its_place_on_a_platform_whose_spin_changes", moving_surfaces::turned},
    {"a_ball_that_leaves_an_edge_falls_freely", edges::leaving_ball},
    {"a_box_tips_over_an_edge_in_order_two", edges::tipping_box},
};

}  // namespace tumble::test
