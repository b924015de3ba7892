#include <tumble/body/mass.hpp>
#include <tumble/shapes/pairs.hpp>

#include <algorithm>
#include <cmath>

#include "scene/data.hpp"
#include "simulation/long_double.hpp"
#include "simulation/simulation.hpp"
#include "simulation/start_impact.hpp"
#include "tools/text.hpp"
#include "truth/smooth_motion.hpp"

namespace tumble::host {
namespace {

std::string acts_on_fixed(const BodyDescription& body) {
    return "acts on body \"" + body.name + "\", which is fixed, so it has no effect";
}

// The name of a shape that touches no bodies, for a warning; empty for all others. A body without a shape is named as a
// point mass, because a warning is given for no other.
std::string passing_shape(ShapeKind shape) {
    if (touches_bodies(shape)) return "";
    return shape == ShapeKind::points ? "a cloud of points"
           : shape == ShapeKind::none ? "a point mass"
                                      : "a " + word_of(shape);
}

// The planes and bodies through which a body of such a shape may pass; empty: none. A body with moments and no shape is
// meant to touch nothing, so there is no warning.
std::string passed_by(const BodyDescription& body, const SceneDescription& scene) {
    const bool passes_planes = body.shape.kind == ShapeKind::points || body.is_point_mass();
    const bool planes = passes_planes && !body.fixed && !scene.planes.empty();
    const bool others =
        body.shape.kind != ShapeKind::none &&
        std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const BodyDescription& other) {
            return &other != &body && other.shape.kind != ShapeKind::none && !(body.fixed && other.fixed);
        });
    return std::string(planes ? "planes" : "") + (planes && others ? " and " : "") + (others ? "other bodies" : "");
}

// A force's impulse that differs by more than this part of its size gets a warning.
constexpr double impulse_tolerance = 0.1;

// The warning about a force that the end of the run cuts, or whose impulse differs by more because it acts in whole
// steps, between those nearest to its times. Empty for any other force.
std::string other_impulse(const ForceDescription& force, const SceneDescription& scene) {
    const double step = scene.step.seconds();
    const std::int64_t from = nearest_step(force.from, scene.step), end = nearest_step(force.until, scene.step),
                       until = std::min(end, scene.steps());
    if (from >= scene.steps()) return "begins when the last step has been taken, so it has no effect";
    const double wanted = force.until - force.from, given = static_cast<double>(until - from) * step;
    if (until == end && std::abs(given - wanted) <= impulse_tolerance * wanted) return {};
    const auto impulse = [&](double seconds) {
        const auto length = [](const Triple& v) { return std::hypot(v[0], v[1], v[2]); };
        const double linear = length(force.force), angular = length(force.torque);
        return (linear > 0 ? few_digits(linear * seconds) + " N s" : "") + (linear > 0 && angular > 0 ? " and " : "") +
               (angular > 0 ? few_digits(angular * seconds) + " N m s" : "");
    };
    if (impulse(wanted).empty()) return {};
    if (until < end)
        return "has not ended when the last step has been taken, so its impulse is " + impulse(given) + " instead of " +
               impulse(wanted);
    return "acts in " + std::to_string(until - from) + (until - from == 1 ? " step" : " steps") + " of " +
           few_digits(step) + " s, so its impulse is " + impulse(given) + " instead of " + impulse(wanted) +
           "; take a shorter step" + (until == from ? " or an impulse" : "");
}

// A joint's side that hangs on it: the bodies that the joint and what hangs on it alone hold.
struct Hanging {
    double mass = 0;       // kg
    int heaviest = -1;     // body
    bool is_held = false;  // by the world or a fixed body, past other joints
};
// Adds body b and what joints tie to it, but for joint `by`.
void add_hanging(const SceneDescription& scene, const SceneData& data, int b, std::size_t by, Hanging& to) {
    if (b < 0 || scene.body(b).fixed) {
        to.is_held = true;
        return;
    }
    const auto mass_of = [&](int body) { return data.bodies[static_cast<std::size_t>(body)].mass.to_double(); };
    to.mass += mass_of(b);
    if (to.heaviest < 0 || mass_of(b) > mass_of(to.heaviest)) to.heaviest = b;
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        const JointDescription& joint = scene.joints[j];
        if (j != by && joint.body == b) add_hanging(scene, data, joint.to_body, j, to);
        if (j != by && joint.to_body == b) add_hanging(scene, data, joint.body, j, to);
    }
}

// rad/s^2 per N: the most that a force at a joint's anchor swings a body about a principal axis, |e x r| / I.
double swing_of(const BodySpec& body, const Triple& anchor) {
    const PrincipalInertia inertia = principal_inertia(body.inertia);
    const reference::Rotation to_world = rotation(body.orientation).normalized() * rotation(inertia.principal);
    const reference::Vector arm = to_world.rotate_back(reference::vector_of(anchor) - vector(body.position)),
                            moments = vector(inertia.moments);
    double most = 0;
    for (int i = 0; i < 3; ++i)
        most = std::max(most, static_cast<double>(std::hypot(arm[(i + 1) % 3], arm[(i + 2) % 3]) / moments[i]));
    return most;
}

// The light link that joints swing the fastest under the weight of what hangs on it, where a step cannot follow: h^2
// times the sum of |f| |e x r| / I is beyond its bound in the shortest part of a step (kernel/JOINTS.md).
void add_light_link(const SceneDescription& scene, std::vector<std::string>& list) {
    constexpr int most_halvings = detail::most_joint_halvings;
    const double most_load = std::ldexp(1.0, detail::joint_load_log2);
    const double g = std::hypot(scene.gravity[0], scene.gravity[1], scene.gravity[2]), h = scene.step.seconds();
    const SceneData data = build_scene(scene);
    std::vector<double> load(data.bodies.size()), swing(data.bodies.size());
    std::vector<int> heaviest(data.bodies.size(), -1);
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        const JointDescription& joint = scene.joints[j];
        Hanging sides[2];
        add_hanging(scene, data, joint.body, j, sides[0]);
        add_hanging(scene, data, joint.to_body, j, sides[1]);
        if (sides[0].is_held == sides[1].is_held) continue;  // a tree that flies freely has no weight
        const Hanging& hanging = sides[sides[0].is_held ? 1 : 0];
        for (const int b : {joint.body, joint.to_body}) {
            if (b < 0 || scene.body(b).fixed) continue;
            const auto link = static_cast<std::size_t>(b);
            const double of_joint = swing_of(data.bodies[link], joint.anchor_on(b));
            load[link] += g * hanging.mass * of_joint;
            swing[link] = std::max(swing[link], of_joint);
            const auto mass_of = [&](int body) { return data.bodies[static_cast<std::size_t>(body)].mass; };
            if (heaviest[link] < 0 || mass_of(heaviest[link]) < mass_of(hanging.heaviest))
                heaviest[link] = hanging.heaviest;
        }
    }
    const auto worst = std::max_element(load.begin(), load.end());
    const int halvings = *worst > 0 ? static_cast<int>(std::ceil(std::log2(h * std::sqrt(*worst / most_load)))) : 0;
    if (halvings <= most_halvings) return;
    const auto link = static_cast<std::size_t>(worst - load.begin());
    const auto weight = static_cast<std::size_t>(heaviest[link]);
    const auto named = [&](std::size_t b) {
        return in_quotes(scene.bodies[b].name) + " of " + few_digits(data.bodies[b].mass.to_double()) + " kg";
    };
    list.push_back(named(weight) + " on " + named(link) + ": forces above " +
                   few_digits(most_load / (h * h * swing[link])) + " N swing it faster than a step of " +
                   step_text(scene.step) + " s follows. The step is divided by up to " +
                   std::to_string(1 << most_halvings) + ", and at rest under gravity " +
                   std::to_string(std::int64_t{1} << std::min(halvings, 62)) + " would be needed; use step = \"" +
                   step_text(scaled(scene.step, -halvings)) + "\" or heavier links");
}

// Start velocities that a joint does not allow.
void add_start_impact(const SceneDescription& scene, std::vector<std::string>& list) {
    const StartImpact impact = impact_at_start(scene);
    if (impact.joint < 0) return;
    const auto both = [](bool first, const std::string& one, bool second, const std::string& other) {
        return (first ? one : "") + (first && second ? " and " : "") + (second ? other : "");
    };
    const auto triple = [](const Triple& v) {
        return "[" + few_digits(v[0]) + ", " + few_digits(v[1]) + ", " + few_digits(v[2]) + "]";
    };
    const bool moves = impact.speed > 0, turns = impact.spin > 0;
    const BodyDescription& body = scene.body(impact.body);
    std::string others;
    if (impact.others == 1) others = ", and there is one more such joint";
    if (impact.others > 1) others = ", and there are " + std::to_string(impact.others) + " more such joints";
    list.push_back("joint " + in_quotes(scene.joints[static_cast<std::size_t>(impact.joint)].name) +
                   ": at the start its sides differ by " +
                   both(moves, few_digits(impact.speed) + " m/s", turns, few_digits(impact.spin) + " rad/s") +
                   ", which it does not allow" + others + ". The first step ends this with " +
                   few_digits(impact.energy) + " J of kinetic energy. Use " +
                   both(turns, "angular_velocity = " + triple(impact.angular_velocity),
                        impact.velocity != body.velocity, "velocity = " + triple(impact.velocity)) +
                   " for body " + in_quotes(body.name));
}

// The bodies that overlap others or planes at the start, deeper than contacts allow.
void add_overlaps(const SceneDescription& scene, std::vector<std::string>& list) {
    for (const auto& overlap : SmoothMotion(scene, shapes_meet).overlaps()) {
        if (overlap.depth <= scene.contact.tolerance) continue;
        list.push_back("body \"" + scene.bodies[overlap.body].name + "\" begins " + few_digits(overlap.depth) +
                       " m inside " + (overlap.with_plane ? "plane" : "body") + " \"" +
                       (overlap.with_plane ? scene.planes[overlap.other].name : scene.bodies[overlap.other].name) +
                       "\", which pushes it out slowly");
    }
}

}  // namespace

std::vector<std::string> limitations(const SceneDescription& scene) {
    std::vector<std::string> list;
    const auto number_of_steps = scene.steps();
    if (number_of_steps == 1 && scene.step.seconds() > scene.duration)
        list.push_back("world.step is " + few_digits(scene.step.seconds()) + " s, longer than the whole run of " +
                       few_digits(scene.duration) + " s; 256 steps a second are step = \"1/256\"");
    for (std::size_t i = 0; i < scene.impulses.size(); ++i) {
        const double step = scene.impulses[i].time / scene.step.seconds();
        const BodyDescription& body = scene.bodies[static_cast<std::size_t>(scene.impulses[i].body)];
        const std::string impulse = "impulse[" + std::to_string(i) + "] ";
        if (body.fixed) list.push_back(impulse + acts_on_fixed(body));
        else if (step >= static_cast<double>(number_of_steps) - 0.5)
            list.push_back(impulse + "comes when the last step has been taken, so it has no effect");
    }
    for (std::size_t i = 0; i < scene.forces.size(); ++i) {
        const BodyDescription& body = scene.bodies[static_cast<std::size_t>(scene.forces[i].body)];
        const std::string other = body.fixed ? acts_on_fixed(body) : other_impulse(scene.forces[i], scene);
        if (!other.empty()) list.push_back("force[" + std::to_string(i) + "] " + other);
    }
    for (std::size_t i = 0; i < scene.events.size(); ++i) {
        const EventDescription& event = scene.events[i];
        const BodyDescription* const body = has_body(event.kind) ? &scene.body(event.body) : nullptr;
        const bool moves_fixed = event.kind == EventKind::pose || event.kind == EventKind::angular_velocity ||
                                 (event.kind == EventKind::velocity && body->kinematic);
        const std::string name = "event[" + std::to_string(i) + "] ";
        if (body != nullptr && body->fixed && !moves_fixed) list.push_back(name + acts_on_fixed(*body));
        else if (nearest_step(event.time, scene.step) >= number_of_steps)
            list.push_back(name + "comes when the last step has been taken, so it has no effect");
    }
    for (const BodyDescription& body : scene.bodies)
        if (body.fixed && !body.kinematic && body.velocity != Triple{})
            list.push_back("body \"" + body.name + "\" is fixed, so its velocity has no effect");
    if (!scene.joints.empty()) {
        add_light_link(scene, list);
        add_start_impact(scene, list);
    }
    if (scene.contact.response == ContactResponse::none) return list;
    if (scene.contact.response == ContactResponse::impulse) add_overlaps(scene, list);
    if (scene.contact.response == ContactResponse::spring) {
        const auto rough = [](const auto& side) { return side.friction.value_or(0.0) > 0; };
        if (scene.contact.friction > 0 || std::any_of(scene.bodies.begin(), scene.bodies.end(), rough) ||
            std::any_of(scene.planes.begin(), scene.planes.end(), rough))
            list.emplace_back("friction is not simulated with contact.response = \"spring\"");
        if (scene.contact.sleep) list.emplace_back("contact.sleep has no effect with contact.response = \"spring\"");
    }
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        const BodyDescription& body = scene.bodies[b];
        const std::string shape = passing_shape(body.shape.kind), passed = passed_by(body, scene);
        if (scene.layers_of(static_cast<int>(b)) != 0 && !shape.empty() && !passed.empty())
            list.push_back("body \"" + body.name + "\": contacts of " + shape + " with " + passed +
                           " are not simulated, it passes through");
    }
    return list;
}

}  // namespace tumble::host
