// Bodies on surfaces whose velocity changes from step to step: lifts, carriers, pushers and turning platforms. A
// kinematic body moves by its velocity times the step. What rests on it keeps its place on it.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinds.hpp"

namespace tumble::test::carried {

using host::Quadruple;

namespace {

constexpr double gravity = 9.81, tolerance = 0.001;  // m/s^2, m

// A speed as a function of time that begins at 0: it rises to a value and stays, rises and falls to 0 again, or is a
// sine.
struct Course {
    int form = 0;
    double acceleration = 0, most = 0;  // m/s^2 and m/s, or of a spin

    double at(double time) const {
        const double rise = most / acceleration;
        if (form == 0) return std::min(most, acceleration * time);
        if (form == 1) return std::clamp(acceleration * (rise - std::abs(time - rise)), 0.0, most);
        return most * std::sin(acceleration / most * time);
    }
};
Course draw_course(Draw& draw, double acceleration, double most) { return {draw.between(0, 2), acceleration, most}; }

// The event of each step that gives the body the speed which it has at the end of the step.
void drive(Case& run, int body, const Course& course, const Triple& along, bool turns, double time) {
    const auto steps = static_cast<int>(std::lround(time / run.step));
    for (int i = 0; i < steps; ++i) {
        host::EventDescription& event = run.scene.events.emplace_back();
        event.time = i * run.step;
        event.kind = turns ? EventKind::angular_velocity : EventKind::velocity;
        event.frame = Frame::world;
        event.body = body;
        const double speed = course.at((i + 1) * run.step);
        for (std::size_t k = 0; k < 3; ++k) event.value[k] = speed * along[k];
    }
}

Triple difference(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

// Runs the scene, and says how far a body leaves its place on the carrier. `normal`: where only the way along it
// counts.
std::string ride(const Case& run, int carrier, double time, const std::vector<int>& riders,
                 const Triple* normal = nullptr) {
    const auto simulation = start(run);
    const Quadruple turned = orientation_of(*simulation, carrier);
    std::vector<Triple> places;
    for (const int rider : riders)
        places.push_back(difference(position_of(*simulation, rider), position_of(*simulation, carrier)));
    const auto steps = static_cast<int>(std::lround(time / run.step));
    for (int i = 0; i < steps; ++i) {
        simulation->step();
        const Quadruple now = orientation_of(*simulation, carrier);
        for (std::size_t k = 0; k < riders.size(); ++k) {
            const Triple reach = difference(position_of(*simulation, riders[k]), position_of(*simulation, carrier));
            const Triple off = difference(rotated(turned, rotated_back(now, reach)), places[k]);
            double size = length_of(off);
            if (normal != nullptr)
                size = std::abs(off[0] * (*normal)[0] + off[1] * (*normal)[1] + off[2] * (*normal)[2]);
            if (!(size <= tolerance))
                return "body " + std::to_string(riders[k]) + " is " + few_digits(size) + " m from its place on body " +
                       std::to_string(carrier) + " after " + few_digits((i + 1) * run.step) + " s, limit " +
                       few_digits(tolerance) + " m";
        }
    }
    return "";
}

}  // namespace

// It keeps its place on a lift that pushes it by less than its weight, and on a carrier that friction makes it follow.
std::string by_friction_or_weight(Draw& draw, Case& run) {
    auto& scene = run.scene;
    scene.gravity = {0, -gravity, 0};
    const bool is_ball = draw.one_in(4), is_first = draw.one_in(2);
    const double friction = draw.uniform(0.3, 1), size = draw.magnitude(0.1, 0.5), thickness = draw.uniform(0.1, 0.4);
    scene.contact.friction = friction;
    scene.contact.restitution = draw.one_in(2) ? 0 : draw.uniform(0, 0.5);
    Triple along{0, draw.one_in(2) ? 1.0 : -1.0, 0};
    double most = 0.7 * gravity;
    if (!is_ball && draw.one_in(2)) {
        const double angle = draw.uniform(0, 2 * std::numbers::pi), rise = draw.one_in(2) ? 0 : draw.uniform(-0.5, 0.5);
        along = {std::cos(angle), rise, std::sin(angle)};
        // The cone of friction, and the edge over which the stack would tip.
        most = 0.5 * gravity * std::min(friction, 0.5) / (1 + std::abs(rise));
    }
    const double acceleration = draw.uniform(0.1, 1) * most;
    const Course course = draw_course(draw, acceleration, draw.uniform(0.3, 2));
    const int count = is_ball ? 1 : draw.between(1, 3);
    std::vector<int> riders;
    const auto add_carrier = [&] {
        BodyDescription& body = add_box(scene, 0, {2, thickness, 2}, {0, -thickness / 2, 0});
        body.fixed = body.kinematic = true;
        return static_cast<int>(scene.bodies.size()) - 1;
    };
    int carrier = is_first ? add_carrier() : 0;
    double top = 0;
    for (int i = 0; i < count; ++i) {
        riders.push_back(static_cast<int>(scene.bodies.size()));
        const double mass = draw.magnitude(0.2, 4), height = is_ball ? 2 * size : size * draw.uniform(0.2, 0.3);
        if (is_ball) add_sphere(scene, mass, size, {0.1, top + size, 0.2});
        else add_box(scene, mass, {size, height, size}, {0.1, top + height / 2, 0.2});
        top += height;
    }
    if (!is_first) carrier = add_carrier();
    const double time = 2 * course.most / course.acceleration + 0.3;
    drive(run, carrier, course, along, false, std::min(time, 1.5));
    place_anywhere(draw, run.scene);
    return ride(run, carrier, std::min(time, 1.5), riders);
}

// A box or a ball on ice, before a wall that accelerates.
std::string by_a_wall_on_ice(Draw& draw, Case& run) {
    auto& scene = run.scene;
    scene.gravity = {0, -gravity, 0};
    scene.contact.friction = 0;
    scene.contact.restitution = 0;
    scene.planes.emplace_back();
    const bool is_ball = draw.one_in(2);
    const double size = draw.magnitude(0.1, 0.5);
    BodyDescription& wall = add_box(scene, 0, {0.2, 4 * size, 2}, {-0.1 - size / 2, 2 * size, 0});
    wall.fixed = wall.kinematic = true;
    if (is_ball) add_sphere(scene, draw.magnitude(0.2, 4), size / 2, {0, size / 2, 0});
    else add_box(scene, draw.magnitude(0.2, 4), {size, size, size}, {0, size / 2, 0});
    const Course course{0, draw.uniform(0.5, 9), draw.uniform(0.3, 2)};
    const double time = course.most / course.acceleration;
    drive(run, 0, course, {1, 0, 0}, false, time);
    place_anywhere(draw, run.scene);
    return ride(run, 0, time, {1});
}

// A box on a platform whose spin changes, kinematic or a turntable.
std::string by_a_platform(Draw& draw, Case& run) {
    auto& scene = run.scene;
    // Kicks at one end of the step are of first order on what turns.
    if (run.integrator == "semi_implicit_euler") run.integrator = "verlet";
    scene.gravity = {0, -gravity, 0};
    scene.contact.friction = 0.9;
    scene.contact.restitution = 0;
    BodyDescription& platform = add_box(scene, 0, {2, 0.2, 2}, {0, -0.1, 0});
    platform.fixed = true;
    platform.kinematic = draw.one_in(2);
    const double radius = draw.uniform(0, 0.4), size = draw.uniform(0.1, 0.3), height = size * draw.uniform(0.2, 0.5),
                 angle = draw.uniform(0, 2 * std::numbers::pi);
    add_box(scene, draw.magnitude(0.2, 4), {size, height, size},
            {radius * std::cos(angle), height / 2, radius * std::sin(angle)});
    const Course course = draw_course(draw, draw.uniform(0.5, 4), draw.uniform(0.3, 1.5));
    drive(run, 0, course, {0, draw.one_in(2) ? 1.0 : -1.0, 0}, true, 1);
    place_anywhere(draw, run.scene);
    return ride(run, 0, 1, {1});
}

}  // namespace tumble::test::carried
