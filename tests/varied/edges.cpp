// Bodies that slide or roll over the edge of a table. A contact that ends within a step pushes until it ends. Right
// values are free fall, and the integration of a box that tips over an edge without friction.
#include <cmath>

#include "kinds.hpp"

namespace tumble::test::edges {

namespace {

constexpr double gravity = 9.81, tolerance = 0.001;  // m/s^2, m

// Places the scene anywhere, runs it for a number of steps, and says how far a body is from where it should be in the
// frame in which the scene was made.
std::string hold(Draw& draw, Case& run, int body, int steps, const Triple& right, double allowed) {
    const Placement placement = place_anywhere(draw, run.scene);
    const auto simulation = start(run);
    for (int i = 0; i < steps; ++i) simulation->step();
    const Triple x = placement.back(position_of(*simulation, body));
    const double off = distance(x, right);
    if (off <= allowed) return "";
    return "the body is " + few_digits(off) + " m off, limit " + few_digits(allowed) + " m, at (" + few_digits(x[0]) +
           ", " + few_digits(x[1]) + ", " + few_digits(x[2]) + ")";
}

// A table with its edge at x = 0 and its upper side at y = 0: fixed, kinematic or heavy. Returns its velocity.
double add_table(Draw& draw, Case& run) {
    const int held = draw.between(0, 2);
    const double speed = held == 1 ? draw.uniform(-0.5, 0.5) : 0;
    BodyDescription& table = add_box(run.scene, held == 2 ? 1e4 : 0, {2, 0.4, 2}, {-1, -0.2, 0});
    table.fixed = held < 2;
    table.kinematic = held == 1;
    table.velocity = {speed, 0, 0};
    if (held == 2) {
        host::PlaneDescription& ground = run.scene.planes.emplace_back();
        ground.offset = 0.4;
        ground.friction = 1;
    }
    return speed;
}

// A box without friction that slides at this speed. Its centre of mass is over an edge at the start.
struct TippingBox {
    double half_length, half_height;  // m
    double way = 0, speed = 0;        // of the centre past the edge, along the box
    double angle = 0, spin = 0, time = 0;

    // Lagrange's equations in `way` and `angle`.
    struct Change {
        double speed, spin;
    };
    [[nodiscard]] Change change(double s, double v, double w, double a) const {
        const double inertia = (half_length * half_length + half_height * half_height) / 3;
        const double spin = (gravity * s * std::cos(a) - 2 * s * v * w - half_height * s * w * w) / (s * s + inertia);
        return {s * w * w + gravity * std::sin(a) - half_height * spin, spin};
    }
    // To the end of the contact, by the midpoint method.
    void leave() {
        for (constexpr double h = 2e-5; way < half_length; time += h) {
            const Change now = change(way, speed, spin, angle);
            const double push =
                gravity * std::cos(angle) - half_height * spin * spin - 2 * speed * spin - way * now.spin;
            if (push < 0) return;
            const double v = speed + h / 2 * now.speed, w = spin + h / 2 * now.spin;
            const Change middle = change(way + h / 2 * speed, v, w, angle + h / 2 * spin);
            way += h * v;
            angle += h * w;
            speed += h * middle.speed;
            spin += h * middle.spin;
        }
    }
    // At a later time.
    [[nodiscard]] Triple place(double later) const {
        const double t = later - time, s = std::sin(angle), c = std::cos(angle), along = half_height * spin + speed;
        return {half_height * s + way * c + (along * c - way * spin * s) * t,
                half_height * c - way * s - (along * s + way * spin * c) * t - gravity * t * t / 2, 0};
    }
};

}  // namespace

// It is so fast that it flies at once: v^2 > g r. It slides without friction or rolls.
std::string leaving_ball(Draw& draw, Case& run) {
    auto& scene = run.scene;
    // Its free fall is of first order.
    if (run.integrator == "semi_implicit_euler") run.integrator = "verlet";
    const bool rolls = draw.one_in(3);
    const double tilt = rolls ? 0 : draw.uniform(0, 0.4), pull = gravity * std::sin(tilt),
                 fall = gravity * std::cos(tilt);
    scene.gravity = {pull, -fall, 0};
    scene.contact.friction = rolls ? 0.5 : 0;
    scene.contact.restitution = draw.one_in(2) ? 0 : draw.uniform(0, 0.8);
    const double radius = draw.magnitude(0.02, 0.2), speed = std::sqrt(gravity * radius) * draw.uniform(1.3, 3),
                 way = draw.uniform(0.1, 0.5);
    double carried = 0;
    if (tilt > 0 || !draw.one_in(2)) {
        BodyDescription& table = add_box(scene, 0, {2, 0.4, 2}, {-1, -0.2, 0});
        table.fixed = true;
    } else {
        carried = add_table(draw, run);
    }
    BodyDescription& ball = add_sphere(scene, draw.magnitude(0.2, 4), radius, {-way, radius, 0});
    ball.velocity = {speed + carried, 0, 0};
    if (rolls) ball.angular_velocity = {0, 0, -speed / radius};
    scene.range.angular_velocity = 256;
    const double edge = pull > 0 ? (std::sqrt(speed * speed + 2 * pull * way) - speed) / pull : way / speed;
    const int steps = static_cast<int>((edge + draw.uniform(0.1, 0.25)) / run.step);
    const double time = steps * run.step, t = time - edge;
    const Triple right{-way + (speed + carried) * time + pull * time * time / 2, radius - fall * t * t / 2, 0};
    // Of a gap below 1/256 of the tolerance no contact knows whether it is open.
    const double blind = std::sqrt(2 * radius * tolerance / 256) / speed;
    return hold(draw, run, static_cast<int>(scene.bodies.size()) - 1, steps, right, 3e-4 + gravity * t * blind);
}

// Order two: the force at the edge acts where the edge is in the middle of the step.
std::string tipping_box(Draw& draw, Case& run) {
    auto& scene = run.scene;
    // Kicks at one end of the step are of first order.
    if (run.integrator == "semi_implicit_euler") run.integrator = "verlet";
    scene.gravity = {0, -gravity, 0};
    scene.contact.friction = 0;
    scene.contact.restitution = 0;
    TippingBox box{draw.uniform(0.05, 0.2), draw.uniform(0.05, 0.2)};
    const double speed = draw.uniform(0.8, 3), way = draw.uniform(0.1, 0.5);
    box.speed = speed;
    BodyDescription& table = add_box(scene, 0, {2, 0.4, 2}, {-1, -0.2, 0});
    table.fixed = true;
    add_box(scene, draw.magnitude(0.2, 4), {2 * box.half_length, 2 * box.half_height, draw.uniform(0.1, 0.4)},
            {-way, box.half_height, 0})
        .velocity = {speed, 0, 0};
    box.leave();
    const double edge = way / speed;
    const int steps = static_cast<int>((edge + box.time + draw.uniform(0.1, 0.2)) / run.step);
    const double parts = 60 * run.step;
    return hold(draw, run, 1, steps, box.place(steps * run.step - edge), 1e-3 + 0.03 * parts * parts);
}

}  // namespace tumble::test::edges
