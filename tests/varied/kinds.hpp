// The kinds of varied scenes. Each source file has a namespace of its name, with its judges.
#pragma once

#include "varied.hpp"

namespace tumble::test {

namespace carried {
Judge by_friction_or_weight, by_a_wall_on_ice, by_a_platform;
}
namespace edges {
Judge leaving_ball, tipping_box;
}
namespace flat_falls {
Judge fall;
}
namespace rim_bounces {
Judge land;
}
namespace resistance {
Judge slowed;
}
namespace seams {
Judge box_slides, box_slides_between_walls, body_falls, body_slides_over_free_boxes, ball_rolls, step_stops_a_box,
    ball_bounces;
}
namespace sleepers_and_loads {
Judge pulled, attracted, asleep, asleep_beside_a_ball;
}
namespace slender_rods {
Judge driven, rolling;
}
namespace steady_spins {
Judge turning, carried;
}
namespace tilts {
Judge boxes, balls;
}

}  // namespace tumble::test
