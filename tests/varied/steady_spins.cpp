// Fixed and kinematic bodies that turn: steadily about the axis that they were given, in the world, whatever their
// moments. Right values are closed forms.
#include <algorithm>
#include <cmath>

#include "kinds.hpp"

// A namespace of its own: files are compiled together.
namespace tumble::test::steady_spins {

using host::Quadruple;

namespace {

Triple times(const Triple& v, double by) { return {v[0] * by, v[1] * by, v[2] * by}; }

Quadruple conjugate(const Quadruple& q) { return {q[0], -q[1], -q[2], -q[3]}; }
double norm(const Quadruple& q) { return std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]); }

// The rotation about a vector by its length, rad.
Quadruple rotation(const Triple& v) {
    const double angle = length_of(v), share = angle > 0 ? std::sin(angle / 2) / angle : 0;
    return {std::cos(angle / 2), v[0] * share, v[1] * share, v[2] * share};
}
double angle_between(const Quadruple& a, const Quadruple& b) {
    const Quadruple d = product(conjugate(a), b);
    return 2 * std::atan2(std::hypot(d[1], d[2], d[3]), std::abs(d[0]));
}

Triple any_direction(Draw& draw) {
    for (;;) {
        const Triple v{draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1)};
        const double length = length_of(v);
        if (length > 0.1 && length < 1) return times(v, 1 / length);
    }
}

// rad: what the methods and rounding leave of an angle, in steps that each turn by `in_step`.
double allowed_turn(const Case& drawn, double angle, double in_step) {
    // The method of order 1 turns by twice the arc tangent of half the angle.
    const double of_method =
        drawn.integrator == "semi_implicit_euler" ? in_step * in_step / 10 : in_step * in_step * in_step * in_step / 10;
    return 1e-6 + angle * (of_method + (drawn.numbers == "f32" ? 1e-6 : 1e-7));
}

BodyDescription& add_plate(Draw& draw, SceneDescription& scene) {
    BodyDescription& body =
        add_box(scene, 0, {draw.magnitude(0.1, 2), draw.magnitude(0.1, 2), draw.magnitude(0.1, 2)}, {});
    const int shape = draw.between(0, 3);
    if (shape == 1)
        body.shape = {
            .kind = ShapeKind::cylinder, .size = {draw.magnitude(0.05, 1), draw.magnitude(0.05, 1), 0}, .points = {}};
    if (shape == 2) body.shape = {.kind = ShapeKind::capsule, .size = {0.05, draw.magnitude(0.05, 1), 0}, .points = {}};
    if (shape == 3)
        body.shape = {.kind = ShapeKind::points,
                      .size = {},
                      .points = {{{0.3, 0, 0.1}, 1}, {{-0.2, 0.1, 0}, 2}, {{0, -0.4, 0.2}, 1}, {{0.1, 0.2, -0.3}, 1}}};
    if (shape == 3) body.mass.reset();
    body.kinematic = draw.one_in(2);
    body.orientation = rotation(times(any_direction(draw), draw.uniform(0, 3)));
    return body;
}

}  // namespace

// A spin about any axis, or about a principal one, from the start and perhaps another from an event on.
std::string turning(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    BodyDescription& body = add_plate(draw, scene);
    const auto any_spin = [&] {
        Triple spin = times(any_direction(draw), draw.magnitude(1e-5, 8));
        if (draw.one_in(5)) spin[0] = spin[static_cast<std::size_t>(draw.between(1, 2))] = 0;
        return spin;
    };
    Triple spin = any_spin();
    body.angular_velocity = spin;
    Quadruple q = body.orientation;
    const double first = drawn.step * std::round(draw.uniform(0.5, 4) / drawn.step),
                 second = draw.one_in(2) ? 0 : drawn.step * std::round(draw.uniform(0.5, 4) / drawn.step);
    scene.duration = first + second;
    double angle = length_of(spin) * first, in_step = length_of(spin) * drawn.step;
    q = product(q, rotation(times(spin, first)));
    if (second > 0) {
        const bool in_world = draw.one_in(2);
        const Triple next = any_spin();
        scene.events = {{.time = first,
                         .kind = EventKind::angular_velocity,
                         .body = 0,
                         .frame = in_world ? Frame::world : Frame::body,
                         .value = next}};
        spin = in_world ? rotated_back(q, next) : next;
        q = product(q, rotation(times(spin, second)));
        angle += length_of(spin) * second;
        in_step = std::max(in_step, length_of(spin) * drawn.step);
    }
    add_sphere(scene, 1, 0.1, {20, 0, 0});

    const auto simulation = start(drawn);
    const auto steps = static_cast<int>(std::lround(scene.duration / drawn.step));
    for (int i = 0; i < steps; ++i) simulation->step();
    if (!simulation->troubles().empty()) return "status " + simulation->troubles().front().issue;
    const Quadruple end = orientation_of(*simulation, 0);
    const double off = angle_between(q, end), most = allowed_turn(drawn, angle, in_step);
    if (off > most)
        return "the orientation is " + few_digits(off) + " rad off, expected at most " + few_digits(most) + " rad";
    const double change = distance(spin_of(*simulation, 0), spin);
    if (change > (1e-5 + most) * length_of(spin) + 2e-6)
        return "the angular velocity is off by " + few_digits(change) + " rad/s of " + few_digits(length_of(spin));
    if (std::abs(norm(end) - 1) > 1e-6 + in_step * in_step * in_step * in_step)
        return "the orientation has the length 1 + " + few_digits(norm(end) - 1);
    return "";
}

// A box lies on a plate that is tilted by less than the friction angle and turns about the vertical. It goes round with
// the plate.
std::string carried(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    const double tilt = draw.uniform(0.05, 0.25), spin = (draw.one_in(2) ? 1 : -1) * draw.uniform(0.1, 0.6),
                 side = draw.uniform(0, 6.28), thick = draw.uniform(0.05, 0.3), height = draw.uniform(0.05, 0.15);
    scene.gravity = {0, -9.81, 0};
    scene.contact.restitution = 0;
    scene.contact.friction = 0.8;
    BodyDescription plate = add_box(scene, 0, {draw.uniform(1.2, 2), thick, draw.uniform(1.2, 2)}, {});
    plate.kinematic = true;
    plate.orientation = rotation({tilt * std::cos(side), 0, tilt * std::sin(side)});
    plate.angular_velocity = rotated_back(plate.orientation, {0, spin, 0});
    const Triple place{draw.uniform(-0.3, 0.3), (thick + height) / 2, draw.uniform(-0.3, 0.3)};
    const Triple at = rotated(plate.orientation, place);
    scene.bodies.clear();
    BodyDescription box = add_box(scene, draw.magnitude(0.1, 10), {0.2, height, 0.15}, at);
    box.orientation = plate.orientation;
    box.velocity = {spin * at[2], 0, -spin * at[0]};
    box.angular_velocity = plate.angular_velocity;
    const bool plate_first = draw.one_in(2);
    scene.bodies = plate_first ? std::vector{plate, box} : std::vector{box, plate};
    scene.bodies[0].name = "b0";
    scene.bodies[1].name = "b1";
    const int of_plate = plate_first ? 0 : 1, of_box = 1 - of_plate;
    scene.duration = draw.uniform(1, 4);
    const Quadruple turned = any_turn(draw);
    turn(scene, turned);

    const auto simulation = start(drawn);
    const auto steps = static_cast<int>(scene.duration / drawn.step);
    for (int i = 0; i < steps; ++i) simulation->step();
    const double angle = spin * steps * drawn.step;
    const Triple expected = rotated(turned, rotated(rotation({0, angle, 0}), at));
    const double off = distance(position_of(*simulation, of_box), expected);
    // What rests on a surface while it turns is of first order in the step.
    const double most = 0.001 + 0.3 * std::abs(spin) * drawn.step * (1 + std::abs(angle));
    if (off > most)
        return "the box is " + few_digits(off) + " m off its place on the plate, expected at most " + few_digits(most);
    return "";
}

}  // namespace tumble::test::steady_spins
