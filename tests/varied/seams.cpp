// Bodies on flush blocks: what slides, rolls or falls over a seam without a gap moves as on one long block. Right
// values are Coulomb's law, free fall, and the same scene with one block in place of many.
#include <algorithm>
#include <cmath>

#include "kinds.hpp"

namespace tumble::test::seams {

using host::Quadruple;

namespace {

constexpr double gravity = 9.81;  // m/s^2

// A frame of axes along which blocks are laid: x along the way, y up, z aside.
struct Blocks {
    double top = 0, from = 0, to = 0, width = 1, depth = 0.4;  // m; the ends along x
};

Quadruple about(int axis, double angle) {
    Quadruple q{std::cos(angle / 2), 0, 0, 0};
    q[static_cast<std::size_t>(axis) + 1] = std::sin(angle / 2);
    return q;
}

// Lays blocks side by side along x, of random lengths, in one row or in two with a seam along z = 0. Blocks of free
// bodies have a mass. With `whole` lays one block instead.
void lay(Draw& draw, SceneDescription& scene, const Blocks& blocks, bool whole, double least = 0.1, double most = 1,
         int rows = 0) {
    if (whole) {
        add_box(scene, 0, {blocks.to - blocks.from, blocks.depth, blocks.width},
                {(blocks.from + blocks.to) / 2, blocks.top - blocks.depth / 2, 0});
        return;
    }
    if (rows == 0) rows = draw.between(1, 2);
    for (int row = 0; row < rows; ++row) {
        const double width = blocks.width / rows, z = rows == 1 ? 0 : (row == 0 ? -width / 2 : width / 2);
        // Equal blocks or blocks of any length; of any thickness.
        const bool equal = draw.one_in(2);
        const double length = draw.uniform(least, most);
        for (double x = blocks.from; x < blocks.to - 1e-9;) {
            double next = x + (equal ? length : draw.uniform(least, most));
            if (next > blocks.to - least / 2) next = blocks.to;
            const double depth = draw.one_in(2) ? blocks.depth : blocks.depth * draw.uniform(0.2, 1);
            add_box(scene, 0, {next - x, depth, width}, {(x + next) / 2, blocks.top - depth / 2, z});
            x = next;
        }
    }
}

// Lays blocks of a wall beside the way, whose face is at this z, and which lies on this side of it: 1 or -1. It stands
// on the floor, or beside it.
void lay_wall(Draw& draw, SceneDescription& scene, const Blocks& blocks, double z, double least, int side = 1) {
    SceneDescription wall;
    lay(draw, wall, blocks, false, least, 1.2, 1);
    const double low = draw.one_in(2) ? 0 : -0.3, high = 0.5;
    for (auto& block : wall.bodies) {
        block.shape.size[1] = high - low;
        block.shape.size[2] = 0.3;
        block.position[1] = (low + high) / 2;
        block.position[2] = z + side * 0.15;
        scene.bodies.push_back(block);
    }
}

// Puts the bodies into a random order; returns the place of the body that was at this place.
int shuffle(Draw& draw, SceneDescription& scene, int body) {
    for (std::size_t i = scene.bodies.size() - 1; i > 0; --i) {
        const auto j = static_cast<std::size_t>(draw.between(0, static_cast<int>(i)));
        std::swap(scene.bodies[i], scene.bodies[j]);
        if (body == static_cast<int>(i)) body = static_cast<int>(j);
        else if (body == static_cast<int>(j)) body = static_cast<int>(i);
    }
    return body;
}

// The placement of a scene with the body that a judge looks at.
struct Placed : Placement {
    int body = 0;
};
Placed place(Draw& draw, Case& run, int body) {
    const Placement placement = place_anywhere(draw, run.scene);
    return {placement, shuffle(draw, run.scene, body)};
}

// Runs for a time, and says how far the body is from where it should be.
std::string hold(const Case& run, const Placed& placed, double time, const Triple& right, double allowed,
                 double most_spin) {
    const auto simulation = start(run);
    const auto steps = static_cast<int>(std::lround(time / run.step));
    for (int i = 0; i < steps; ++i) simulation->step();
    const Triple x = placed.back(position_of(*simulation, placed.body));
    const double off = distance(x, right), spin = length_of(spin_of(*simulation, placed.body));
    if (!(off <= allowed))
        return "the body is " + few_digits(off) + " m off, limit " + few_digits(allowed) + " m, at (" +
               few_digits(x[0]) + ", " + few_digits(x[1]) + ", " + few_digits(x[2]) + ")";
    if (!(spin <= most_spin))
        return "the body turns at " + few_digits(spin) + " rad/s, limit " + few_digits(most_spin) + " rad/s";
    return "";
}

// m: the way under a constant acceleration, which friction ends. A method of order one, which moves a body by its
// velocity at the end of the step, is half a step ahead.
double way_of(const Case& run, double speed, double drive, double friction, double time) {
    const double ahead = run.integrator == "semi_implicit_euler" ? run.step / 2 : 0, a = drive - friction;
    if (speed + a * time < 0 || (speed == 0 && a <= 0)) time = a < 0 ? speed / -a : 0;
    return speed * time + a * time * (time / 2 + ahead);
}

}  // namespace

// A floor or ramp of fixed blocks, or of kinematic ones that move alike; some with a wall to which gravity presses the
// box as well.
std::string box_slides(Draw& draw, Case& run) {
    auto& scene = run.scene;
    const bool walled = draw.one_in(4);
    // Friction on a wall turns the box.
    const double slope = draw.one_in(3) ? 0 : draw.uniform(0, 0.8),
                 friction = walled || draw.one_in(4) ? 0 : draw.uniform(0, 0.6);
    const double time = draw.uniform(0.3, 1);
    const double speed = draw.one_in(4) ? 0 : draw.one_in(4) ? draw.uniform(4, 12) : draw.uniform(0, 4);
    const double aside = walled ? draw.uniform(0, 1) : 0;  // of gravity, over the part that presses on the floor
    const double down = gravity * std::cos(slope);
    scene.gravity = {gravity * std::sin(slope), -down, aside * down};
    scene.contact = {.restitution = draw.of<double>({0, 0, 0.5, 1}),
                     .friction = friction,
                     .tolerance = draw.one_in(4) ? 2e-4 : 1e-3};
    scene.duration = time;
    const double drift = friction > 0 || walled ? 0 : draw.uniform(-0.3, 0.3);
    const double drive = gravity * std::sin(slope), held = friction * down;
    const double way = way_of(run, speed, drive, held, time);
    Triple edges{draw.uniform(0.05, 0.4), draw.uniform(0.05, 0.2), draw.uniform(0.05, 0.4)};
    // Friction does not tip it over.
    edges[1] = std::min(edges[1], 0.8 * std::min(edges[0], edges[2]) / std::max(friction, 0.1));
    const double least = std::max(draw.uniform(0.04, 0.4), way / 30);
    const Blocks blocks{.from = -0.5, .to = way + 0.7, .width = 2};
    lay(draw, scene, blocks, false, least, 1.2);
    const double z = draw.uniform(-0.2, 0.2);
    if (walled) lay_wall(draw, scene, blocks, z + edges[2] / 2, std::max(least, way / 15));
    const Triple carried = draw.one_in(4) ? Triple{draw.uniform(-1, 1), 0, draw.uniform(-1, 1)} : Triple{};
    if (length_of(carried) > 0)
        for (auto& block : scene.bodies) {
            block.kinematic = true;
            block.velocity = carried;
        }
    auto& box = add_box(scene, draw.magnitude(0.1, 10), edges, {0, edges[1] / 2, z});
    if (!walled) box.orientation = about(1, draw.one_in(2) ? 0 : draw.uniform(-3, 3));
    box.velocity = {speed + carried[0], 0, drift + carried[2]};
    const double elapsed = std::round(time / run.step) * run.step;
    const Triple right{way_of(run, speed, drive, held, elapsed) + carried[0] * elapsed, box.position[1],
                       box.position[2] + (drift + carried[2]) * elapsed};
    // A step that ends a slide is one step long.
    const double allowed = 1e-3 + gravity * run.step * run.step;
    const Placed placed = place(draw, run, static_cast<int>(scene.bodies.size()) - 1);
    return hold(run, placed, elapsed, right, allowed, 1e-2);
}

// Between two walls at which a box fits exactly the floor alone slows it: nothing presses it to either wall.
std::string box_slides_between_walls(Draw& draw, Case& run) {
    auto& scene = run.scene;
    const double slope = draw.one_in(3) ? 0 : draw.uniform(0, 0.6), friction = draw.uniform(0.05, 0.5);
    const double time = draw.uniform(0.3, 0.8), speed = draw.uniform(0.5, 5);
    scene.gravity = {gravity * std::sin(slope), -gravity * std::cos(slope), 0};
    scene.contact = {.restitution = draw.of<double>({0, 0.5}), .friction = friction};
    scene.duration = time;
    const double drive = gravity * std::sin(slope), held = friction * gravity * std::cos(slope);
    const double way = way_of(run, speed, drive, held, time);
    Triple edges{draw.uniform(0.1, 0.4), draw.uniform(0.05, 0.2), draw.uniform(0.1, 0.4)};
    // Friction does not tip it over.
    edges[1] = std::min(edges[1], 0.8 * std::min(edges[0], edges[2]) / std::max(friction, 0.1));
    const double least = std::max(draw.uniform(0.1, 0.4), way / 12), z = draw.uniform(-0.2, 0.2);
    const Blocks blocks{.from = -0.5, .to = way + 0.7, .width = 2};
    lay(draw, scene, blocks, false, least, 1.2);
    for (const int side : {-1, 1})
        lay_wall(draw, scene, blocks, z + side * edges[2] / 2, std::max(least, way / 8), side);
    add_box(scene, draw.magnitude(0.1, 10), edges, {0, edges[1] / 2, z}).velocity = {speed, 0, 0};
    const double elapsed = std::round(time / run.step) * run.step;
    const Triple right{way_of(run, speed, drive, held, elapsed), edges[1] / 2, z};
    const Placed placed = place(draw, run, static_cast<int>(scene.bodies.size()) - 1);
    return hold(run, placed, elapsed, right, 1e-3 + gravity * run.step * run.step, 1e-2);
}

// Blocks above each other whose side a box or a ball touches without a force, on one side or on both.
std::string body_falls(Draw& draw, Case& run) {
    auto& scene = run.scene;
    const double time = draw.uniform(0.3, 0.8), down = draw.uniform(0, 1), aside = draw.uniform(-1, 1);
    scene.contact = {.restitution = draw.of<double>({0, 0.5, 1}),
                     .friction = draw.one_in(2) ? 0 : draw.uniform(0, 0.6)};
    scene.gravity = {gravity, 0, 0};
    scene.duration = time;
    const double way = down * time + gravity * time * time / 2;
    const Triple edges{draw.uniform(0.05, 0.4), draw.uniform(0.05, 0.4), draw.uniform(0.05, 0.4)};
    const int walls = draw.between(1, 2);
    lay(draw, scene, {.from = -0.5, .to = way + 0.7, .width = 3}, false, draw.uniform(0.1, 0.4), 1.2);
    if (walls == 2) lay(draw, scene, {.top = edges[1] + 0.4, .from = -0.5, .to = way + 0.7, .width = 3}, true);
    const double mass = draw.magnitude(0.1, 10), z = draw.uniform(-0.2, 0.2);
    auto& box = draw.one_in(3) ? add_sphere(scene, mass, edges[1] / 2, {0, edges[1] / 2, z})
                               : add_box(scene, mass, edges, {0, edges[1] / 2, z});
    box.velocity = {down, 0, aside};
    const double elapsed = std::round(time / run.step) * run.step;
    const Triple right{way_of(run, down, gravity, 0, elapsed), box.position[1], box.position[2] + aside * elapsed};
    const Placed placed = place(draw, run, static_cast<int>(scene.bodies.size()) - 1);
    return hold(run, placed, elapsed, right, 1e-3 + gravity * run.step * run.step, 1e-2);
}

// Boxes side by side on a floor without friction carry a body that slides over them.
std::string body_slides_over_free_boxes(Draw& draw, Case& run) {
    auto& scene = run.scene;
    const double time = draw.uniform(0.3, 1), speed = draw.uniform(0.1, 3);
    scene.gravity = {0, -gravity, 0};
    scene.contact = {.restitution = draw.of<double>({0, 0.5})};
    scene.duration = time;
    const double height = draw.uniform(0.1, 0.4), length = draw.uniform(0.15, 0.5), block = draw.magnitude(0.25, 4);
    const int count = std::min(10, static_cast<int>((speed * time + 1) / length) + 1);
    scene.planes.push_back({.name = "floor", .offset = height});
    for (int i = 0; i < count; ++i)
        add_box(scene, block, {length, height, 1}, {-0.5 + (i + 0.5) * length, -height / 2, 0});
    const double end = -0.5 + count * length;
    const Triple edges{draw.uniform(0.1, 0.3), draw.uniform(0.05, 0.2), draw.uniform(0.1, 0.3)};
    const double mass = draw.magnitude(0.25, 2), z = draw.uniform(-0.1, 0.1);
    auto& box = draw.one_in(3) ? add_sphere(scene, mass, edges[1] / 2, {0, edges[1] / 2, z})
                               : add_box(scene, mass, edges, {0, edges[1] / 2, z});
    box.orientation = about(1, draw.one_in(2) ? 0 : draw.uniform(-3, 3));
    box.velocity = {speed, 0, 0};
    // It stays on the row.
    const double elapsed =
        std::floor(std::min(time, (end - 0.5 * std::hypot(edges[0], edges[2]) - 0.05) / speed) / run.step) * run.step;
    const Triple right{speed * elapsed, box.position[1], box.position[2]};
    const Placed placed = place(draw, run, static_cast<int>(scene.bodies.size()) - 1);
    return hold(run, placed, elapsed, right, 2e-3, 3e-2);
}

// A ball that rolls, or slides without friction.
std::string ball_rolls(Draw& draw, Case& run) {
    auto& scene = run.scene;
    const bool rolls = draw.one_in(2);
    const double slope = draw.one_in(2) ? 0 : draw.uniform(0, 0.5), time = draw.uniform(0.3, 1);
    const double radius = draw.magnitude(0.03, 0.4), speed = draw.uniform(0, std::min(4.0, 20 * radius));
    scene.gravity = {gravity * std::sin(slope), -gravity * std::cos(slope), 0};
    scene.contact = {.restitution = draw.of<double>({0, 0.5, 1}), .friction = rolls ? 0.8 : 0};
    scene.duration = time;
    const double pull = gravity * std::sin(slope) * (rolls ? 5 / 7. : 1);
    const double limit = (-speed + std::sqrt(speed * speed + 2 * pull * 3)) / std::max(pull, 1e-3);
    const double elapsed =
        std::floor(std::min({time, limit, (25 * radius - speed) / std::max(pull, 1e-3)}) / run.step) * run.step;
    const double way = way_of(run, speed, pull, 0, elapsed), drift = rolls ? 0 : draw.uniform(-0.3, 0.3);
    lay(draw, scene, {.from = -0.5, .to = way + 0.7, .width = 2}, false, draw.uniform(0.1, 0.4), 1.2);
    auto& ball = add_sphere(scene, draw.magnitude(0.1, 10), radius, {0, radius, draw.uniform(-0.2, 0.2)});
    ball.velocity = {speed, 0, drift};
    if (rolls) ball.angular_velocity = {0, 0, -speed / radius};
    const Triple right{way, radius, ball.position[2] + drift * elapsed};
    const Placed placed = place(draw, run, static_cast<int>(scene.bodies.size()) - 1);
    return hold(run, placed, elapsed, right, 5e-4 + 1e-4 * way + 2 * pull * run.step * run.step, 1e9);
}

// A block that is higher than its neighbour by more than the tolerance.
std::string step_stops_a_box(Draw& draw, Case& run) {
    auto& scene = run.scene;
    const double speed = draw.uniform(0.3, 2), edge = draw.uniform(0.3, 0.8), rise = draw.uniform(2e-3, 0.05);
    scene.gravity = {0, -gravity, 0};
    scene.contact = {.restitution = 0};
    const Triple edges{draw.uniform(0.2, 0.4), draw.uniform(0.1, 0.2), draw.uniform(0.1, 0.4)};
    lay(draw, scene, {.from = -0.5, .to = edge, .width = 2}, false, 0.1, 0.4);
    lay(draw, scene, {.top = rise, .from = edge, .to = 1.5, .width = 2}, false, 0.1, 0.4);
    auto& box = add_box(scene, 1, edges, {0, edges[1] / 2, draw.uniform(-0.2, 0.2)});
    box.velocity = {speed, 0, 0};
    const double time = (edge - edges[0] / 2) / speed;
    scene.duration = time + 0.5;
    const int last = static_cast<int>(scene.bodies.size()) - 1;
    const Placed placed = place(draw, run, last);
    const auto simulation = start(run);
    // It may turn over the edge later: only the stop is judged.
    for (int i = 0; i <= static_cast<int>(time / run.step) + 2; ++i) simulation->step();
    // It turns about the edge at the most: its centre keeps less than half of its speed.
    const double v = placed.back(velocity_of(*simulation, placed.body))[0],
                 x = placed.back(position_of(*simulation, placed.body))[0],
                 most = edge - edges[0] / 2 + 2e-3 + speed * run.step;
    if (!(v <= 0.5 * speed)) return "the box moves on at " + few_digits(v) + " m/s of " + few_digits(speed) + " m/s";
    return x <= most ? "" : "the box came to " + few_digits(x) + " m, limit " + few_digits(most) + " m";
}

// A ball that falls on blocks, on seams and on free edges, and rolls off the end, moves as on one block.
std::string ball_bounces(Draw& draw, Case& run) {
    const double restitution = draw.of<double>({0, 0.3, 0.6, 1}), friction = draw.of<double>({0, 0.3, 0.7});
    const double time = draw.uniform(0.2, 0.5), radius = draw.uniform(0.05, 0.2), lowest = draw.uniform(0.05, 0.2);
    const double slope = draw.one_in(3) ? 0 : draw.uniform(-0.6, 0.6);
    const Triple position{draw.uniform(-0.6, 0.6), radius + draw.uniform(0, 0.3), draw.uniform(-0.3, 0.3)};
    const Triple velocity{draw.uniform(-3, 3), draw.uniform(-2, 0), draw.uniform(-0.5, 0.5)};
    const Triple spin{draw.uniform(-9, 9), draw.uniform(-9, 9), draw.uniform(-9, 9)};
    const Draw blocks = draw;
    const auto make = [&](bool whole) {
        Case made = run;
        made.scene.contact = {.restitution = restitution, .friction = friction};
        made.scene.duration = time;
        Draw laid = blocks;
        lay(laid, made.scene, {.from = -0.7, .to = 0.7, .width = 1}, whole, lowest, 0.5);
        auto& ball = add_sphere(made.scene, 1, radius, position);
        ball.velocity = velocity;
        ball.angular_velocity = spin;
        turn(made.scene, about(2, slope));
        made.scene.gravity = {0, -gravity, 0};
        return made;
    };
    const Case many = make(false), one = make(true);
    run.scene = many.scene;
    const auto of_many = start(many), of_one = start(one);
    double off = 0;
    for (int i = 0; i < std::lround(time / run.step); ++i) {
        of_many->step();
        of_one->step();
        const double apart = distance(position_of(*of_many, static_cast<int>(many.scene.bodies.size()) - 1),
                                      position_of(*of_one, static_cast<int>(one.scene.bodies.size()) - 1));
        if (!std::isfinite(apart)) return "a place is not finite";
        off = std::max(off, apart);
    }
    const double allowed = 3e-3;
    return off > allowed ? "the ball is " + few_digits(off) + " m from where it is on one block, limit " +
                               few_digits(allowed) + " m"
                         : "";
}

}  // namespace tumble::test::seams
