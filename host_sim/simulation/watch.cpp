#include "simulation/watch.hpp"

#include <algorithm>
#include <cmath>

#include "scene/data.hpp"
#include "simulation/long_double.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

// Of a range: initial values may lie at its end, and rounding takes them beyond.
constexpr double rounding_of_range = 1.0 / 1024;

constexpr long double most_growth = 100;
// m/s: of a motion that is not taken to be rounding.
constexpr long double slowest = 1e-5L;

// True where nothing but springs, gravity, gravitation and drag changes the energy of the motion.
bool keeps_energy(const SceneDescription& scene) {
    const auto is_fed = [&](const BodyDescription& body) { return body.fixed && body.angular_velocity != Triple{}; };
    const auto touches = [&](const BodyDescription& body) {
        return std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const BodyDescription& other) {
            return &other != &body && shapes_meet(other.shape.kind, body.shape.kind);
        });
    };
    const bool may_touch = scene.contact.response != ContactResponse::none &&
                           (!scene.planes.empty() || std::any_of(scene.bodies.begin(), scene.bodies.end(), touches));
    return !may_touch && scene.forces.empty() && scene.impulses.empty() &&
           std::none_of(scene.bodies.begin(), scene.bodies.end(), is_fed);
}

}  // namespace

int fastest_body(const Simulation& simulation) {
    const auto speed = [&](int body) {
        const auto v = simulation.body(body).velocity;
        return std::hypot(v[0], v[1], v[2]);
    };
    int fastest = 0;
    for (int b = 1; b < simulation.body_count(); ++b)
        if (speed(b) > speed(fastest)) fastest = b;
    return fastest;
}

std::vector<Trouble> with(std::vector<Trouble> troubles, const std::optional<Trouble>& found) {
    const auto is_same = [&](const Trouble& trouble) { return trouble.issue == found->issue; };
    if (found && std::none_of(troubles.begin(), troubles.end(), is_same)) troubles.push_back(*found);
    return troubles;
}

RangeWatch::RangeWatch(const SceneDescription& scene, const Simulation& simulation)
    : bounds_{{{"position", &BodySnapshot::position, scene.range.position, "m"},
               {"velocity", &BodySnapshot::velocity, scene.range.velocity, "m/s"},
               {"angular velocity", &BodySnapshot::angular_velocity, scene.range.angular_velocity, "rad/s"}}},
      is_on_{scene.range.is_declared && simulation.range().empty()} {}

void RangeWatch::see(const Simulation& simulation) {
    if (!is_on_ || trouble_) return;
    for (int b = 0; b < simulation.body_count(); ++b) {
        const BodySnapshot body = simulation.body(b);
        for (const Bound& bound : bounds_) {
            const auto& now = body.*bound.what;
            const long double most = bound.most * (1 + rounding_of_range);
            if (std::none_of(now.begin(), now.end(), [&](long double x) { return std::abs(x) > most; })) continue;
            trouble_ = {"range_left", b, simulation.steps_taken() - 1,
                        "a component of the " + bound.of + " left the " + few_digits(bound.most) + " " + bound.unit +
                            " of the declared [range]. Declare a larger one, or take a smaller step where the motion "
                            "has blown up"};
            return;
        }
    }
}

EnergyGrowthWatch::EnergyGrowthWatch(const SceneDescription& scene, const Energy& start)
    : is_on_{keeps_energy(scene)}, start_{start.total()}, most_kept_{start.kinetic}, rounding_{0} {
    const SceneData data = build_scene(scene);
    for (const BodySpec& body : data.bodies) rounding_ += number(body.mass) * slowest * slowest;
}

void EnergyGrowthWatch::see(const Simulation& simulation, const Energy& now) {
    if (!is_on_ || trouble_) return;
    most_kept_ = std::max(most_kept_, start_ - now.potential);
    const long double gained = now.total() - start_;
    if (!(gained > most_growth * (most_kept_ + rounding_) && gained > 1e-6L * std::abs(now.potential))) return;
    trouble_ = {"step_too_long", fastest_body(simulation), simulation.steps_taken() - 1,
                "the method has added " + few_digits(gained) + " J where the motion had " + few_digits(most_kept_) +
                    " J; take a smaller step, or a method that keeps the energy"};
}

}  // namespace tumble::host
