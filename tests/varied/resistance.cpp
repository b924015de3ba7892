// Bodies under a resistance to rolling, to spinning, or to both. Where a body of radius R rolls over a level surface it
// loses r g / (R (1 + I / m R^2)) of its speed each second, and r = 0 takes nothing. A ball or a flat box that spins
// about the normal loses s m g / I of its spin. What tumbles keeps numbers that are finite.
#include <cmath>

#include "kinds.hpp"

namespace tumble::test::resistance {
namespace {

constexpr double g = 9.81;

bool is_finite(const Simulation& simulation) {
    for (int b = 0; b < simulation.body_count(); ++b)
        for (const Triple& v : {position_of(simulation, b), velocity_of(simulation, b), spin_of(simulation, b)})
            for (const double x : v)
                if (!std::isfinite(x)) return false;
    return true;
}

BodyDescription& add_round(SceneDescription& scene, ShapeKind kind, double mass, double radius, double height) {
    BodyDescription& body = add_sphere(scene, mass, radius, {0, radius, 0});
    body.shape.kind = kind;
    if (kind != ShapeKind::sphere) body.shape.size = {radius, kind == ShapeKind::hoop ? 0 : height, 0};
    return body;
}

// A floor at y = 0 that moves with this velocity along x: a plane, a fixed box or a kinematic one.
void add_floor(Draw& draw, SceneDescription& scene, bool may_be_box, double velocity) {
    if (!may_be_box || (velocity == 0 && draw.one_in(2))) {
        scene.planes.emplace_back().name = "floor";
        return;
    }
    BodyDescription& floor = add_box(scene, 0, {200, 1, 200}, {0, -0.5, 0});
    floor.kinematic = velocity != 0;
    floor.velocity = {velocity, 0, 0};
}

std::string off(const char* what, double value, double right, double limit, const char* unit) {
    return std::string(what) + " is " + std::to_string(value) + ", right is " + std::to_string(right) + ", within " +
           std::to_string(limit) + " " + unit;
}

std::string rolling_body(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    const ShapeKind kind =
        draw.of<ShapeKind>({ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::hoop, ShapeKind::hoop});
    const double radius = draw.magnitude(0.02, 0.5),
                 rolling = draw.one_in(6) ? 0 : radius * draw.magnitude(0.002, 0.05);
    const double speed = draw.uniform(0.2, 2) * std::fmin(1, 6 * radius), mass = draw.magnitude(0.05, 20);
    // No body but a ball rolls on another.
    const double carried = kind == ShapeKind::sphere && draw.one_in(3) ? draw.uniform(-1, 1) : 0;
    scene.gravity = {0, -g, 0};
    scene.contact.friction = draw.uniform(0.3, 0.9);
    scene.contact.restitution = draw.one_in(2) ? 0 : draw.uniform(0, 0.6);
    scene.contact.rolling_resistance = rolling;
    scene.contact.spinning_resistance = draw.one_in(2) ? 0 : radius * draw.magnitude(0.001, 0.05);
    BodyDescription& body = add_round(scene, kind, mass, radius, radius * draw.uniform(0.5, 3));
    body.velocity = {carried + speed, 0, 0};
    body.angular_velocity = {0, 0, -speed / radius};
    add_floor(draw, scene, kind == ShapeKind::sphere, carried);
    const auto turned = any_turn(draw);
    turn(scene, turned);

    const double share = kind == ShapeKind::sphere ? 0.4 : kind == ShapeKind::cylinder ? 0.5 : 1;
    const double slowing = rolling * g / (radius * (1 + share));
    const auto simulation = start(drawn);
    // A hoop that is slow falls over: it leaves its way once rounding has grown.
    const double time = draw.uniform(0.3, kind == ShapeKind::hoop ? 1.2 : 2);
    const int steps = static_cast<int>(time / drawn.step);
    for (int i = 0; i < steps; ++i) simulation->step();
    if (!is_finite(*simulation)) return "a number is not finite";
    const double t = steps * drawn.step, left = std::fmax(0, speed - slowing * t), mean = (speed + left) / 2,
                 moving = slowing > 0 ? std::fmin(t, speed / slowing) : t;
    const double v = rotated_back(turned, velocity_of(*simulation, 0))[0] - carried,
                 x = rotated_back(turned, position_of(*simulation, 0))[0] - carried * t;
    const double enough = 0.002 * speed + 2 * slowing * drawn.step;
    if (std::abs(v - left) > enough) return off("the speed", v, left, enough, "m/s");
    if (std::abs(x - mean * moving) > enough * t) return off("the way", x, mean * moving, enough * t, "m");
    return {};
}

std::string spinning_body(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    const bool is_box = draw.one_in(2);
    const double radius = draw.magnitude(0.05, 0.5),
                 spinning = draw.one_in(6) ? 0 : radius * draw.magnitude(0.001, 0.02);
    const double spin = draw.uniform(1, 6) * (draw.one_in(2) ? 1 : -1), mass = draw.magnitude(0.05, 20);
    scene.gravity = {0, -g, 0};
    scene.contact.friction = is_box ? 0 : draw.uniform(0.3, 0.9);
    scene.contact.restitution = 0;
    scene.contact.spinning_resistance = spinning;
    scene.contact.rolling_resistance = draw.one_in(2) ? 0 : radius * draw.magnitude(0.001, 0.05);
    BodyDescription& body = is_box ? add_box(scene, mass, {2 * radius, radius, 1.5 * radius}, {0, radius / 2, 0})
                                   : add_sphere(scene, mass, radius, {0, radius, 0});
    body.angular_velocity = {0, spin, 0};
    add_floor(draw, scene, true, 0);
    const auto turned = any_turn(draw);
    turn(scene, turned);

    const double moment = is_box ? (4 + 2.25) * radius * radius / 12 : 0.4 * radius * radius;
    const double slowing = spinning * g / moment;
    const auto simulation = start(drawn);
    const int steps = static_cast<int>(draw.uniform(0.2, 1.5) / drawn.step);
    for (int i = 0; i < steps; ++i) simulation->step();
    if (!is_finite(*simulation)) return "a number is not finite";
    const double right = std::fmax(0, std::abs(spin) - slowing * steps * drawn.step) * (spin < 0 ? -1 : 1),
                 value = spin_of(*simulation, 0)[1], enough = 0.002 * std::abs(spin) + 2 * slowing * drawn.step;
    if (std::abs(value - right) > enough) return off("the spin", value, right, enough, "rad/s");
    return {};
}

std::string tumbling_body(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    scene.gravity = {0, -g, 0};
    scene.contact.friction = draw.uniform(0, 0.9);
    scene.contact.restitution = draw.uniform(0, 0.6);
    const int which = draw.between(1, 3);
    if (which & 1) scene.contact.rolling_resistance = draw.magnitude(1e-4, 0.02);
    if (which & 2) scene.contact.spinning_resistance = draw.magnitude(1e-4, 0.02);
    if (draw.one_in(2)) scene.contact.sleep.emplace();
    const int count = draw.between(1, 4);
    for (int i = 0; i < count; ++i) {
        const double size = draw.magnitude(0.05, 0.3);
        const ShapeKind kind = draw.of<ShapeKind>(
            {ShapeKind::sphere, ShapeKind::cylinder, ShapeKind::hoop, ShapeKind::capsule, ShapeKind::box});
        BodyDescription& body = add_round(scene, kind, draw.magnitude(0.1, 10), size, size * draw.uniform(0.5, 2));
        if (kind == ShapeKind::box)
            body.shape.size = {size, size * draw.uniform(0.3, 1), size * draw.uniform(0.5, 1.5)};
        body.position = {0.1 * i, size + 0.7 * i + draw.uniform(0.2, 0.6), draw.uniform(-0.1, 0.1)};
        body.orientation = any_turn(draw);
        for (double& w : body.angular_velocity) w = draw.uniform(-5, 5);
        body.velocity = {draw.uniform(-0.5, 0.5), 0, draw.uniform(-0.5, 0.5)};
    }
    scene.planes.emplace_back().name = "floor";
    scene.range.angular_velocity = 256;
    turn(scene, any_turn(draw));
    const auto simulation = start(drawn);
    const int steps = static_cast<int>(2.5 / drawn.step);
    for (int i = 0; i < steps; ++i) simulation->step();
    if (!is_finite(*simulation)) return "a number is not finite";
    for (const host::Trouble& trouble : simulation->troubles())
        if (trouble.issue == "range_left" && !trouble.number) return "a number was not finite";
    return {};
}

}  // namespace

std::string slowed(Draw& draw, Case& drawn) {
    // Squares underflow in float first.
    if (draw.one_in(2)) drawn.numbers = "f32";
    switch (draw.between(1, 4)) {
    case 1: return spinning_body(draw, drawn);
    case 2: return tumbling_body(draw, drawn);
    default: return rolling_body(draw, drawn);
    }
}

}  // namespace tumble::test::resistance
