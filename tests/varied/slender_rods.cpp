// Slender bodies whose spin leaves the declared range in fixed point: they are followed up to its end at least, held
// where they leave it, and the message names the number at which they are held. Right values are the closed form of a
// constant torque and the range itself.
#include <algorithm>
#include <cmath>

#include "kinds.hpp"

// A namespace of its own: files are compiled together.
namespace tumble::test::slender_rods {

// A rod, disc or brick in space is turned faster and faster about a principal axis by a torque that begins and ends
// with the run, by an event, or both, beside a drag that is too weak to matter.
std::string driven(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    drawn.numbers = "q32";
    const bool is_wide = draw.one_in(2);
    const double range = is_wide ? 256 : 32;
    scene.range = {.position = 64, .velocity = 32, .angular_velocity = range, .is_declared = true};
    BodyDescription& body = add_box(scene, draw.magnitude(0.1, 10), {1, 1, 1}, {});
    const double mass = *body.mass, size = draw.magnitude(0.3, 1), ratio = draw.magnitude(2, 200);
    const int shape = draw.between(0, 2);
    Triple moments{};
    if (shape == 0) {
        const double radius = size / ratio;
        body.shape = {.kind = ShapeKind::cylinder, .size = {radius, size, 0}, .points = {}};
        moments[0] = moments[1] = mass * (3 * radius * radius + size * size) / 12;
        moments[2] = mass * radius * radius / 2;
    } else if (shape == 1) {
        const double height = size / ratio;
        body.shape = {.kind = ShapeKind::cylinder, .size = {size, height, 0}, .points = {}};
        moments[0] = moments[1] = mass * (3 * size * size + height * height) / 12;
        moments[2] = mass * size * size / 2;
    } else {
        const Triple edges{size, size / draw.magnitude(1, 20), size / ratio};
        body.shape = {.kind = ShapeKind::box, .size = edges, .points = {}};
        for (std::size_t i = 0; i < 3; ++i) {
            const double a = edges[(i + 1) % 3], b = edges[(i + 2) % 3];
            moments[i] = mass * (a * a + b * b) / 12;
        }
    }
    const auto axis = static_cast<std::size_t>(draw.between(0, 2));
    const double sign = draw.one_in(2) ? 1 : -1, first = sign * draw.uniform(0.5, 0.9) * range,
                 most_rate = 0.02 / (drawn.step * drawn.step),  // rad/s^2: of a change that the formats hold in a step
        rate = sign * std::min(range / draw.uniform(0.5, 2), most_rate);
    body.angular_velocity[axis] = first;
    Triple torque{};
    torque[axis] = moments[axis] * rate;
    scene.duration = 30;
    if (draw.one_in(2)) scene.forces = {{.body = 0, .from = 0, .until = 30, .frame = Frame::body, .torque = torque}};
    else scene.events = {{.time = 0, .kind = EventKind::torque, .body = 0, .frame = Frame::body, .value = torque}};
    if (draw.one_in(3)) scene.linear_drag = 1e-6 * mass;

    const auto simulation = start(drawn);
    const auto steps = static_cast<int>(30 / drawn.step);
    int held_for = 0;
    for (int i = 0; i < steps && held_for < 20; ++i) {
        simulation->step();
        const double now = sign * spin_of(*simulation, 0)[axis],
                     expected = sign * (first + rate * (i + 1) * drawn.step);
        if (simulation->troubles().empty()) {
            if (std::abs(now - expected) > 1e-3 * range)
                return "the spin is " + few_digits(now) + " rad/s, expected " + few_digits(expected) + " rad/s";
            continue;
        }
        const host::Trouble& trouble = simulation->troubles().front();
        if (trouble.issue != "range_left") return "status " + trouble.issue;
        if (!trouble.number || trouble.number->name != "angular velocity")
            return "the message names " + (trouble.number ? trouble.number->name : "no number") +
                   ", expected the angular velocity";
        const double most = trouble.number->most;
        if (++held_for == 1 && expected < range)
            return "the run ends at " + few_digits(expected) + " rad/s, expected at least " + few_digits(range) +
                   " rad/s";
        if (most < range || most > 8 * range)
            return "the message names " + few_digits(most) + " rad/s, expected one to eight times " + few_digits(range);
        if (std::abs(now - most) > 1e-3 * most)
            return "the spin is held at " + few_digits(now) + " rad/s, expected " + few_digits(most) +
                   " rad/s as the message says";
    }
    if (held_for == 0) return "a spin of " + few_digits(first + rate * 30) + " rad/s is not reported";
    return "";
}

// A rod rolls down a slope until its spin leaves the range.
std::string rolling(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    drawn.numbers = "q32";
    const double range = 32, radius = draw.uniform(0.03, 0.05), tilt = draw.uniform(0.25, 0.4),
                 spin = draw.uniform(20, 28);
    scene.gravity = {9.81 * std::sin(tilt), -9.81 * std::cos(tilt), 0};
    scene.contact.restitution = 0;
    scene.contact.friction = 0.6;
    scene.planes.emplace_back().name = "slope";
    BodyDescription& body = add_box(scene, draw.magnitude(0.2, 5), {1, 1, 1}, {-60, radius, 0});
    body.shape = {.kind = ShapeKind::cylinder, .size = {radius, radius * draw.uniform(3, 12), 0}, .points = {}};
    body.velocity = {spin * radius, 0, 0};
    body.angular_velocity = {0, 0, -spin};
    scene.duration = 4;

    const auto simulation = start(drawn);
    const double rate = 9.81 * std::sin(tilt) * 2 / 3 / radius;
    const auto steps = static_cast<int>(8.5 * range / rate / drawn.step);
    for (int i = 0; i < steps; ++i) {
        simulation->step();
        const double now = -spin_of(*simulation, 0)[2], expected = spin + rate * (i + 1) * drawn.step;
        if (simulation->troubles().empty()) {
            if (std::abs(now - expected) > 0.02 * range)
                return "the spin is " + few_digits(now) + " rad/s, expected " + few_digits(expected) + " rad/s";
            continue;
        }
        const host::Trouble& trouble = simulation->troubles().front();
        if (trouble.issue != "range_left" || !trouble.number) return "status " + trouble.issue;
        if (trouble.number->name != "angular velocity")
            return "the message names the " + trouble.number->name + ", expected the angular velocity";
        const double most = trouble.number->most;
        if (expected < range || most < range || most > 8 * range)
            return "the run ends at " + few_digits(expected) + " rad/s with a message of " + few_digits(most) +
                   " rad/s";
        if (now > most * 1.001 || now < range * 0.98)
            return "the spin is " + few_digits(now) + " rad/s, expected " + few_digits(most) +
                   " rad/s as the message says";
        return "";
    }
    return "a spin of " + few_digits(spin + rate * steps * drawn.step) + " rad/s is not reported";
}

}  // namespace tumble::test::slender_rods
