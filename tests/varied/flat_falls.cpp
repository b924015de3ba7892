// Thin round bodies, plates and cylinders fall, tilt over and rattle flat. A flight that ends deeper than the tolerance
// is redone, so the lowest point of the exact shape is never much deeper. Nothing but rounding, and corrections of the
// height by less than the tolerance, adds energy.
#include <algorithm>
#include <cmath>

#include "kinds.hpp"

namespace tumble::test::flat_falls {
namespace {

constexpr double g = 9.81;

struct Body {
    ShapeKind kind;
    double mass, radius, height;  // of a box: half of its longest edge, and the shortest
    Triple moments;
};

// The depth of the lowest point below y = 0, m, for the vertical in the axes of the body.
double depth_of(const Body& body, double height, const Triple& up) {
    const double flat = std::hypot(up[0], up[1]);
    if (body.kind == ShapeKind::box)
        return body.radius * std::abs(up[0]) + 0.75 * body.radius * std::abs(up[1]) +
               body.height / 2 * std::abs(up[2]) - height;
    return body.radius * flat + body.height / 2 * std::abs(up[2]) - height;
}

Body add_flat(Draw& draw, SceneDescription& scene) {
    Body body{};
    body.kind = draw.of<ShapeKind>({ShapeKind::hoop, ShapeKind::cylinder, ShapeKind::cylinder, ShapeKind::box});
    body.mass = draw.magnitude(0.01, 5);
    body.radius = draw.magnitude(0.03, 0.45);
    body.height = body.kind == ShapeKind::hoop ? 0 : body.radius * draw.magnitude(0.03, 1.5);
    const double r2 = body.radius * body.radius, h2 = body.height * body.height, m = body.mass;
    BodyDescription* description = nullptr;
    if (body.kind == ShapeKind::box) {
        description = &add_box(scene, m, {2 * body.radius, 1.5 * body.radius, body.height}, {0, 0, 0});
        body.moments = {m * (2.25 * r2 + h2) / 12, m * (4 * r2 + h2) / 12, m * 6.25 * r2 / 12};
    } else {
        description = &add_sphere(scene, m, body.radius, {0, 0, 0});
        description->shape.kind = body.kind;
        description->shape.size = {body.radius, body.height, 0};
        const double across = body.kind == ShapeKind::hoop ? m * r2 / 2 : m * (3 * r2 + h2) / 12;
        body.moments = {across, across, body.kind == ShapeKind::hoop ? m * r2 : m * r2 / 2};
    }
    double size = 0;
    while (!(size > 0.2)) {
        for (double& x : description->orientation) x = draw.uniform(-1, 1);
        size = 0;
        for (const double x : description->orientation) size += x * x;
    }
    for (double& x : description->orientation) x /= std::sqrt(size);
    for (double& w : description->angular_velocity) w = draw.uniform(-4, 4);
    description->velocity = {draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1)};
    description->position = {0, 1.5 * body.radius + body.height + draw.uniform(0.01, 0.6), 0};
    return body;
}

}  // namespace

std::string fall(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    // Longer steps change the point on which the body stands by more.
    if (draw.one_in(2)) {
        scene.step = *host::parse_step("1/60");
        drawn.step = scene.step.seconds();
    }
    // Its kicks act at one end of a step, so a body that rolls sinks to first order in it.
    if (drawn.integrator == "semi_implicit_euler") drawn.integrator = "verlet";
    scene.gravity = {0, -g, 0};
    scene.contact.restitution = draw.one_in(4) ? 0 : draw.uniform(0, 0.8);
    scene.contact.friction = draw.uniform(0, 0.8);
    if (draw.one_in(2)) scene.contact.sleep.emplace();
    scene.range.angular_velocity = 256;
    const Body body = add_flat(draw, scene);
    // A plate may fall on the top of a fixed box, too.
    if (body.kind == ShapeKind::box && draw.one_in(2)) add_box(scene, 0, {16, 1, 16}, {0, -0.5, 0});
    else scene.planes.emplace_back().name = "floor";
    const auto turned = any_turn(draw);
    turn(scene, turned);

    const Triple up_in_world = rotated(turned, {0, 1, 0});
    const auto simulation = start(drawn);
    const double tolerance = static_cast<double>(simulation->contact_tolerance());
    const int steps = static_cast<int>(2.5 / drawn.step);
    double deepest = 0, least = INFINITY, gained = 0;
    for (int i = 0; i < steps; ++i) {
        simulation->step();
        const double height = rotated_back(turned, position_of(*simulation, 0))[1];
        const Triple v = velocity_of(*simulation, 0), w = spin_of(*simulation, 0);
        const double depth = depth_of(body, height, rotated_back(orientation_of(*simulation, 0), up_in_world));
        deepest = std::max(deepest, depth);
        double energy = body.mass * g * height;
        for (std::size_t k = 0; k < 3; ++k) energy += (body.mass * v[k] * v[k] + body.moments[k] * w[k] * w[k]) / 2;
        if (!std::isfinite(depth + energy)) return "a number is not finite";
        gained = std::max(gained, energy - least);
        least = std::min(least, energy);
    }
    // What is above the tolerance is left by corrections, which move bodies after the search.
    if (deepest > 1.25 * tolerance)
        return "the lowest point is up to " + std::to_string(1000 * deepest) + " mm deep, right is at most " +
               std::to_string(1250 * tolerance) + " mm";
    // Contacts of a body that turns are of first order in the step.
    const double allowed = body.mass * g * (8 * tolerance + 0.1 * body.radius);
    if (gained > allowed)
        return "the energy rises by " + std::to_string(gained) + " J, right is at most " + std::to_string(allowed) +
               " J";
    return {};
}

}  // namespace tumble::test::flat_falls
