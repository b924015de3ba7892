// Every map is made by a function of its own file.
#pragma once

#include <memory>

#include "stress/map.hpp"

namespace tumble::bench::stress {

[[nodiscard]] std::unique_ptr<Map> make_free_rotation();
[[nodiscard]] std::unique_ptr<Map> make_springs();
[[nodiscard]] std::unique_ptr<Map> make_pendulum();
[[nodiscard]] std::unique_ptr<Map> make_heavy_top();
[[nodiscard]] std::unique_ptr<Map> make_orbits();
[[nodiscard]] std::unique_ptr<Map> make_drag();
[[nodiscard]] std::unique_ptr<Map> make_bounce_speed();
[[nodiscard]] std::unique_ptr<Map> make_bounce_restitution();
[[nodiscard]] std::unique_ptr<Map> make_friction();
[[nodiscard]] std::unique_ptr<Map> make_mass_ratio_impact();
[[nodiscard]] std::unique_ptr<Map> make_mass_ratio_pile();
[[nodiscard]] std::unique_ptr<Map> make_stack();

}  // namespace tumble::bench::stress
