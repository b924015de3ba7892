// What the first step ends of the velocities that a scene gives to jointed bodies: an impact without restitution, which
// keeps the momentum along the free directions of all joints.
#pragma once

#include "scene/description.hpp"
#include "truth/motion.hpp"

namespace tumble::host {

struct StartImpact {
    reference::Number energy = 0;  // J, kinetic, that ends
    // The joint of the largest difference that counts: more than a thousandth of the speeds of its sides. -1: there is
    // none. Then the energy is what the rounding of a file's numbers leaves.
    int joint = -1;
    int others = 0;                         // joints with a difference that counts, beside it
    reference::Number speed = 0, spin = 0;  // m/s, rad/s: what the joint does not allow; 0: does not count
    int body = -1;                          // a side that moves
    Triple velocity{}, angular_velocity{};  // of this body, with which the joint's other side fits; as in a scene
};
// Ends of ropes and of limits are left out: they may be hit on purpose.
[[nodiscard]] StartImpact impact_at_start(const SceneDescription& scene);

}  // namespace tumble::host
