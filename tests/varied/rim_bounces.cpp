// A hoop or a cylinder lands tilted on a smooth floor, in the last part of a step. Its impact is that of the point that
// touches, by Newton's law: the other points of the rim are above the floor until the step ends.
#include <cmath>

#include "kinds.hpp"

namespace tumble::test::rim_bounces {

std::string land(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    scene.contact.restitution = draw.one_in(3) ? 0 : draw.uniform(0, 1);
    scene.contact.friction = 0;
    scene.range.angular_velocity = 256;
    scene.planes.emplace_back().name = "floor";
    const bool is_hoop = draw.one_in(2);
    const double m = draw.magnitude(0.01, 5), radius = draw.magnitude(0.08, 0.5),
                 half = is_hoop ? 0 : radius * draw.magnitude(0.03, 0.5),
                 inertia = is_hoop ? m * radius * radius / 2 : m * (3 * radius * radius + 4 * half * half) / 12;
    // The quarter points of the rim are 2 to 4 mm above the floor. The rest of the step is too short for them.
    // The lowest point is the same in the whole flight, and no other comes down in it: the tilt stays above 1 mrad.
    const double tilt = draw.uniform(0.002, 0.004) / radius, speed = draw.uniform(0.2, 2),
                 flown = std::fmax(drawn.step / 2, drawn.step - 0.0005 / (4 * speed) * draw.uniform(0.2, 1)),
                 share = draw.uniform(0.2, 0.8), usual = share * speed / radius,
                 spin = draw.one_in(2) ? std::fmin(usual, share * (tilt - 0.001) / flown) : -usual;
    const double arm = radius * std::cos(tilt) - half * std::sin(tilt),
                 height = radius * std::sin(tilt) + half * std::cos(tilt), tilt_at_start = tilt - spin * flown;
    BodyDescription& body = add_sphere(scene, m, radius, {0, height + speed * flown, 0});
    body.shape.kind = is_hoop ? ShapeKind::hoop : ShapeKind::cylinder;
    body.shape.size = {radius, 2 * half, 0};
    const double angle = tilt_at_start - std::acos(0.0);
    body.orientation = {std::cos(angle / 2), std::sin(angle / 2), 0, 0};
    body.velocity = {0, -speed, 0};
    body.angular_velocity = {spin, 0, 0};
    const auto turned = any_turn(draw);
    turn(scene, turned);

    const auto simulation = test::start(drawn);
    simulation->step();
    const double change = (1 + scene.contact.restitution) * (speed + spin * arm) / (1 + m * arm * arm / inertia),
                 v = rotated_back(turned, velocity_of(*simulation, 0))[1], w = spin_of(*simulation, 0)[0],
                 right_v = change - speed, right_w = spin - m * change * arm / inertia;
    if (!(std::abs(v - right_v) < 0.01 * speed))
        return "leaves at " + std::to_string(v) + " m/s, right is " + std::to_string(right_v) + " m/s";
    if (!(std::abs(w - right_w) < 0.02 * speed / radius))
        return "turns at " + std::to_string(w) + " rad/s, right is " + std::to_string(right_w) + " rad/s";
    return {};
}

}  // namespace tumble::test::rim_bounces
