#include "verdict/energy_budget.hpp"

#include <algorithm>
#include <cmath>

#include "scene/data.hpp"
#include "simulation/energy.hpp"
#include "simulation/long_double.hpp"
#include "truth/smooth_motion.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {
EnergyBudget::EnergyBudget(const SceneDescription& scene, const Simulation& simulation, double most_gain)
    : scene_(scene), most_gain_(most_gain) {
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
    for (const BodySpec& body : build_scene(scene).bodies) mass_.push_back(body.is_fixed() ? 0 : number(body.mass));
    if (touches && !by_springs)
        for (const long double mass : mass_) tolerance_energy_ += mass * gravity * simulation.contact_tolerance();
    rounding_ = rounding(simulation);
}

// Positions have a spacing, and each term of the potential changes with a position by its force. The terms may cancel
// where bodies rest, and then this is all the energy that changes.
long double EnergyBudget::rounding(const Simulation& simulation) const {
    const long double held = simulation.range().empty() ? 0 : held_by(simulation.range()).position * 0x1p-30L,
                      unit = simulation.numbers() == "f32"   ? 0x1p-23L
                             : simulation.numbers() == "f64" ? 0x1p-52L
                                                             : 0;
    std::vector<reference::Motion> now;
    for (int b = 0; b < simulation.body_count(); ++b) now.push_back(motion_of(simulation.body(b)));
    const auto at = [&](int b) -> const reference::Motion& { return now[static_cast<std::size_t>(b)]; };
    long double sum = 0, weight = 0;
    const auto add = [&](long double force, long double place) { sum += force * (unit * place + held); };
    for (std::size_t b = 0; b < now.size(); ++b) {
        const long double own = mass_[b] * scene_.most_gravity();
        weight += own;
        add(own, norm(now[b].x));
    }
    for (const SpringDescription& spring : scene_.springs) {
        const auto end = [&](int b, const Triple& p) {
            return at(b).x + at(b).q.normalized().rotate(reference::vector_of(p));
        };
        const reference::Vector one = end(spring.body, spring.point), other = spring.to_body < 0
                                                                                  ? reference::vector_of(spring.to)
                                                                                  : end(spring.to_body, spring.to);
        // An end is placed by a centre of mass and an arm, and the stretch is what is left of the distance.
        const long double places = norm(one) + norm(other) + norm(one - at(spring.body).x) + spring.rest_length;
        add(spring.stiffness * std::abs(norm(one - other) - spring.rest_length), places);
    }
    // Contact springs hold about the weight of all bodies, at their distance from the origin. Where surfaces just
    // touch, the rounding of two bodies makes them overlap by up to two spacings s, which stores k (2 s)^2 / 2 at up to
    // four points of each pair.
    if (scene_.contact.response == ContactResponse::spring) {
        const auto pairs = static_cast<long double>(scene_.planes.size() + now.size() - 1);
        for (const reference::Motion& body : now) {
            const long double spacing = unit * norm(body.x) + held;
            sum += weight * spacing + 4 * pairs * 2 * scene_.contact.stiffness * spacing * spacing;
        }
    }
    return sum;
}

void EnergyBudget::see(const Simulation& simulation, bool is_driven) {
    if (!is_on_ || is_exceeded_) return;
    const Energy now = simulation.energy();
    const long double total = now.total(), change = total - before_;
    before_ = total;
    largest_kinetic_ = std::max(largest_kinetic_, now.kinetic);
    if (is_driven) level_ += is_known_ ? change : std::max(0.0L, change);
    rounding_ = std::max(rounding_, rounding(simulation));
    // Rounding counts twice: in the energy now, and in the level.
    is_exceeded_ = total - level_ > most_gain_ * largest_kinetic_ + tolerance_energy_ + 2 * rounding_;
    if (is_known_) level_ = std::min(level_, total);
}

}  // namespace tumble::host
