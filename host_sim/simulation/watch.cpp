#include "simulation/watch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "scene/data.hpp"
#include "simulation/long_double.hpp"
#include "tools/text.hpp"
#include "truth/smooth_motion.hpp"

namespace tumble::host {
namespace {

// Of a range: initial values may lie at its end, and rounding takes them beyond.
constexpr double rounding_of_range = 1.0 / 1024;

// The smallest that is not below x > 0.
double next_power_of_two(double x) {
    int exponent = 0;
    return std::frexp(x, &exponent) == 0.5 ? x : std::ldexp(1.0, exponent);
}

// Gains in times of what the motion had: of a moment, and of all of the last steps. Stable steps of kick-drift-kick and
// of semi-implicit Euler swing by 1/(1 - (h w)^2/4) and 1/(1 - h w/2) times the energy at most, and back; what has
// left a contact spring does not, and where boxes are deep in each other the contact's axis may change, and the energy.
constexpr long double most_growth = 100, most_lasting_growth = 3, most_lasting_growth_of_bounces = 0.25L,
                      most_lasting_growth_of_boxes = 1;
// Of the motion, where it can only lose energy; and how far impacts of what rests may lift it, in contact tolerances.
constexpr long double most_bounced = 0.25L, most_hop = 8;
// m/s: of a motion that is not taken to be rounding.
constexpr long double slowest = 1e-5L;

// The distance of neighbouring numbers, of orientations and, times the scene's size, of places.
struct Resolution {
    long double place;  // m
    long double turn;   // rad
};
Resolution resolution(const SceneDescription& scene, const Simulation& simulation) {
    if (!simulation.range().empty()) {
        constexpr long double of_range = 0x1p-30L;
        return {held_by(simulation.range()).position * of_range, of_range};
    }
    double farthest = 0;
    const auto reach = [&](const Triple& x) {
        for (const double component : x) farthest = std::max(farthest, std::abs(component));
    };
    for (const BodyDescription& body : scene.bodies) reach(body.position);
    for (const SpringDescription& spring : scene.springs) reach(spring.to);
    const long double spacing =
        simulation.numbers() == "f32" ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon();
    return {farthest * spacing, spacing};
}

// Of contacts by springs: those of spheres and boxes with planes, and of spheres, have an energy that is known. Others
// keep what they take where the watch does not see it.
class SpringContacts {
public:
    SpringContacts(const SceneDescription& scene, const SmoothMotion& at_start) {
        for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
            const BodyDescription& body = scene.bodies[b];
            const ShapeKind kind = body.shape.kind;
            if (!body.fixed && !scene.planes.empty() && kind != ShapeKind::none && kind != ShapeKind::points)
                some_unknown_ = some_unknown_ || !is_known_on_planes(kind);
            for (std::size_t a = 0; a < b; ++a) {
                const ShapeKind other = scene.bodies[a].shape.kind;
                if ((body.fixed && scene.bodies[a].fixed) || !shapes_meet(kind, other)) continue;
                some_unknown_ = some_unknown_ || !is_known_pair(kind, other);
                boxes_meet_ = boxes_meet_ || (kind == ShapeKind::box && other == ShapeKind::box);
            }
        }
        for (const auto& overlap : at_start.overlaps()) {
            const ShapeKind kind = scene.bodies[overlap.body].shape.kind;
            const bool is_known = overlap.with_plane ? is_known_on_planes(kind)
                                                     : is_known_pair(kind, scene.bodies[overlap.other].shape.kind);
            starts_unknown_ = starts_unknown_ || !is_known;
        }
    }

    // May one give what the watch has not seen it take: from before the start, at a distance, or in steps that are
    // counted as those of events?
    [[nodiscard]] bool may_give(const SceneDescription& scene) const {
        const bool has_events = !scene.forces.empty() || !scene.impulses.empty();
        return starts_unknown_ || (some_unknown_ && (scene.contact.barrier > 0 || has_events));
    }
    [[nodiscard]] long double most_lasting_growth_of(const SceneDescription& scene) const {
        if (!scene.springs.empty() || scene.gravitation > 0) return most_lasting_growth;
        return boxes_meet_ ? most_lasting_growth_of_boxes : most_lasting_growth_of_bounces;
    }

private:
    [[nodiscard]] static bool is_known_on_planes(ShapeKind kind) {
        return kind == ShapeKind::sphere || kind == ShapeKind::box;
    }
    [[nodiscard]] static bool is_known_pair(ShapeKind a, ShapeKind b) {
        return a == ShapeKind::sphere && b == ShapeKind::sphere;
    }

    bool some_unknown_ = false, starts_unknown_ = false, boxes_meet_ = false;
};

}  // namespace

int fastest_body(const Simulation& simulation) {
    // Of those that do not move, what turns fastest.
    const auto speed = [&](int body) {
        const BodySnapshot at = simulation.body(body);
        const auto &v = at.velocity, &w = at.angular_velocity;
        return std::pair{std::hypot(v[0], v[1], v[2]), std::hypot(w[0], w[1], w[2])};
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
    : is_on_{scene.range.is_declared && simulation.range().empty()} {
    const RangeDescription held = held_by(find_number_system(scene, "q32", {}).range);
    const auto step = static_cast<double>(simulation.step_length());
    const double velocity = next_power_of_two(held.velocity * step) / step;
    // The state holds half turns, of the angular momentum those of twice the spin.
    const double of_spin = find_integrator(simulation.integrator()).spin == Spin::angular_momentum ? step : step / 2;
    const double spin = next_power_of_two(held.angular_velocity * of_spin) * 2 / step;
    bounds_ = {{{"position", &BodySnapshot::position, held.position, "m"},
                {"velocity", &BodySnapshot::velocity, velocity, "m/s"},
                {"angular velocity", &BodySnapshot::angular_velocity, spin, "rad/s"}}};
}

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
                            " that q32 holds of the declared [range] at this step. Declare a larger one, or take a "
                            "smaller step where the motion has blown up"};
            return;
        }
    }
}

EnergyGrowthWatch::EnergyGrowthWatch(const SceneDescription& scene, const Simulation& simulation)
    : is_gravitation_alone_{scene.gravitation > 0 && scene.springs.empty() && scene.gravity == Triple{}}, swing_{0},
      push_{0}, rounding_{0} {
    const Energy start = simulation.energy();
    start_ = before_ = start.total();
    most_kept_ = motion_at_start_ = start.kinetic;
    const SmoothMotion at_start(scene, shapes_meet);
    const bool may_touch = scene.contact.response != ContactResponse::none && at_start.can_touch(),
               by_impulses = may_touch && scene.contact.response == ContactResponse::impulse;
    std::optional<SpringContacts> springs;
    if (may_touch && !by_impulses) springs.emplace(scene, at_start);
    is_on_ = !(springs && springs->may_give(scene)) &&
             std::none_of(scene.bodies.begin(), scene.bodies.end(),
                          [](const BodyDescription& body) { return body.fixed && body.angular_velocity != Triple{}; });
    only_loses_ = by_impulses && scene.springs.empty() && scene.gravitation == 0 &&
                  find_integrator(simulation.integrator()).order > 1;
    if (springs) most_lasting_ = springs->most_lasting_growth_of(scene);
    else most_lasting_ = by_impulses ? std::numeric_limits<long double>::infinity() : most_lasting_growth;
    for (const ImpulseDescription& impulse : scene.impulses) {
        const std::int64_t step = nearest_step(impulse.time, scene.step);
        fed_.push_back({step, step + 1});
    }
    for (const ForceDescription& force : scene.forces)
        fed_.push_back({nearest_step(force.from, scene.step), nearest_step(force.until, scene.step) + 1});
    std::sort(fed_.begin(), fed_.end(), [](const Steps& a, const Steps& b) { return a.first < b.first; });

    // What is too deep for contacts by impulses leaves by an eighth of the tolerance a step.
    const long double tolerance = simulation.contact_tolerance(), leaves = tolerance / 8 / simulation.step_length();
    long double depth = only_loses_ ? most_hop * tolerance : tolerance;
    if (by_impulses)
        for (const auto& overlap : at_start.overlaps()) depth = std::max(depth, overlap.depth);
    const auto& g = scene.gravity;
    const Resolution least = resolution(scene, simulation);
    const long double speed = least.place / simulation.step_length(), spin = least.turn / simulation.step_length();
    for (const BodySpec& body : build_scene(scene).bodies) {
        if (body.fixed) continue;
        const auto moments = vector(principal_inertia(body.inertia).moments);
        const long double mass = number(body.mass);
        rounding_ += 4 * (mass * speed * speed + std::max({moments.x, moments.y, moments.z}) * spin * spin);
        push_ += mass * slowest * slowest;
        if (by_impulses) push_ += mass * (leaves * leaves + std::hypot(g[0], g[1], g[2]) * depth);
    }
}

bool EnergyGrowthWatch::is_fed(std::int64_t step) {
    for (; begun_ < fed_.size() && fed_[begun_].first <= step; ++begun_)
        fed_until_ = std::max(fed_until_, fed_[begun_].end);
    return step < fed_until_;
}

void EnergyGrowthWatch::see(const Simulation& simulation, const Energy& now) {
    if (!is_on_ || trouble_) return;
    const std::int64_t taken = simulation.steps_taken();
    if (is_fed(taken - 1)) {
        start_ += now.total() - before_;
        most_kept_ += std::abs(now.total() - before_);
    }
    before_ = now.total();
    most_kept_ = std::max(most_kept_, start_ - now.potential);
    const long double gained = now.total() - start_;
    gains_[static_cast<std::size_t>(taken) % gains_.size()] = gained;
    const long double spare = push_ + rounding_ * static_cast<long double>(taken);
    const bool is_rounding = !(gained > 1e-6L * std::abs(now.potential));
    if (only_loses_) {
        if (!is_rounding && gained > most_bounced * most_kept_ + spare)
            tell(simulation, gained, few_digits(most_kept_) + " J");
        return;
    }
    if (taken <= first_steps) {
        swing_ = std::max({swing_, now.kinetic, std::abs(gained)});
        return;
    }
    const long double motion = std::max(most_kept_, swing_), had = motion + spare;
    const long double lasting =
        taken < first_steps + lasting_steps ? 0 : *std::min_element(gains_.begin(), gains_.end());
    const bool is_much = gained > most_growth * had || lasting > most_lasting_ * had;
    // Not at a close point, where a method's energy swings with the potential.
    const bool is_unbound = is_gravitation_alone_ && start_ < 0 && gained > std::abs(now.potential) / 8 &&
                            lasting > std::max(-start_, motion_at_start_) + push_;
    if (!(is_much || is_unbound) || is_rounding) return;
    tell(simulation, gained, is_much ? few_digits(motion) + " J" : few_digits(start_) + " J, which bound the bodies");
}

void EnergyGrowthWatch::tell(const Simulation& simulation, long double gained, const std::string& had) {
    trouble_ = {"step_too_long", fastest_body(simulation), simulation.steps_taken() - 1,
                "the method has added " + few_digits(gained) + " J where the motion had " + had +
                    "; take a smaller step, or a method that keeps the energy"};
}

}  // namespace tumble::host
