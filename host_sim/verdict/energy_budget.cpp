#include "verdict/energy_budget.hpp"

#include <algorithm>

#include "scene/data.hpp"
#include "simulation/energy.hpp"
#include "simulation/long_double.hpp"
#include "truth/smooth_motion.hpp"

namespace tumble::host {
EnergyBudget::EnergyBudget(const SceneDescription& scene, const Simulation& simulation, double most_gain)
    : energy_rounding_(scene), most_gain_(most_gain) {
    const Energy start = simulation.energy();
    level_ = before_ = start.total();
    largest_kinetic_ = start.kinetic;
    const SmoothMotion at_start(scene, shapes_meet);
    const bool touches = scene.contact.response != ContactResponse::none && at_start.can_touch();
    const bool by_springs = touches && scene.contact.response == ContactResponse::spring;
    is_known_ = !by_springs || stored_energy_is_known(scene);

    const bool is_driven_by_fixed = std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const auto& b) {
        return b.kinematic || (touches && b.fixed && b.angular_velocity != Triple{});
    });
    const auto overlaps = at_start.overlaps();
    const bool begins_pushed = touches && !is_known_ && (scene.contact.barrier > 0 || !overlaps.empty());
    const bool begins_inside =
        touches && !by_springs &&
        std::any_of(overlaps.begin(), overlaps.end(), [&](const auto& o) { return o.depth > scene.contact.tolerance; });
    is_on_ = !is_driven_by_fixed && !begins_pushed && !begins_inside;

    tolerance_energy_ = 0;
    const long double gravity = scene.most_gravity();
    if (touches && !by_springs)
        for (const BodySpec& body : build_scene(scene).bodies)
            if (!body.is_fixed()) tolerance_energy_ += number(body.mass) * gravity * simulation.contact_tolerance();
    rounding_ = energy_rounding_.of(simulation);
}

void EnergyBudget::see(const Simulation& simulation, bool is_driven) {
    if (!is_on_ || is_exceeded_) return;
    const Energy now = simulation.energy();
    const long double total = now.total(), change = total - before_;
    before_ = total;
    largest_kinetic_ = std::max(largest_kinetic_, now.kinetic);
    if (is_driven) level_ += is_known_ ? change : std::max(0.0L, change);
    rounding_ = std::max(rounding_, energy_rounding_.of(simulation));
    // Rounding counts twice: in the energy now, and in the level.
    is_exceeded_ = total - level_ > most_gain_ * largest_kinetic_ + tolerance_energy_ + 2 * rounding_;
    if (is_known_) level_ = std::min(level_, total);
}

}  // namespace tumble::host
