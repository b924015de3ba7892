// Sleepers with a load that a fixed or kinematic body changes: a spring whose other end moves, turns or is placed
// elsewhere, and the attraction of a mass that comes near. Right values are Coulomb's law and an integration of one
// equation of motion.
#include <cmath>
#include <numbers>

#include "kinds.hpp"

// A namespace of its own: files are compiled together.
namespace tumble::test::sleepers_and_loads {

namespace {

constexpr double gravity = 9.81;      // m/s^2
constexpr double falls_asleep = 0.6;  // s: after 0.5 s at rest, and some steps
constexpr double stands = 0.002;      // m: a body that friction holds moves by no more

// A box on a floor, which falls asleep. Its centre is at the origin, and up is y.
struct Floor {
    double mass = 1, friction = 0.5;
    int box = 0, other = 1;  // bodies

    Floor(Draw& draw, SceneDescription& scene) : mass{draw.magnitude(0.1, 10)}, friction{draw.uniform(0.2, 0.8)} {
        const double height = draw.uniform(0.1, 0.2);  // so low that it does not tip
        scene.gravity = {0, -gravity, 0};
        scene.contact.restitution = 0;
        scene.contact.friction = friction;
        scene.contact.sleep.emplace();
        scene.planes.emplace_back().name = "floor";
        scene.planes.back().offset = height / 2;
        const auto add = [&] { add_box(scene, mass, {draw.uniform(0.2, 0.4), height, draw.uniform(0.2, 0.4)}, {}); };
        if (draw.one_in(2)) {
            add();
            add_sphere(scene, 0, 0.02, {});
        } else {
            add_sphere(scene, 0, 0.02, {});
            add();
            std::swap(box, other);
        }
    }
    BodyDescription& mover(SceneDescription& scene) const { return scene.bodies[static_cast<std::size_t>(other)]; }
    // m/s^2: what friction holds of the box.
    double held() const { return friction * gravity; }
};

Triple end_of_spring(const SceneDescription& scene, const Simulation& simulation, int other) {
    const Triple centre = position_of(simulation, other),
                 arm = rotated(orientation_of(simulation, other), scene.springs[0].to);
    return {centre[0] + arm[0], centre[1] + arm[1], centre[2] + arm[2]};
}

}  // namespace

// The other end of the spring goes off at a speed, from the start or by an event, jumps, or sits on a fixed body that
// turns. The box is awake while the end moves, and asleep where the end stands. It rests while the spring pulls by less
// than friction holds. Where it pulls by more, the box comes along.
std::string pulled(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    const Floor floor{draw, scene};
    const double slack = draw.uniform(0.04, 0.15),  // m: the pull of friction
        stiffness = floor.held() * floor.mass / slack, swing = std::sqrt(stiffness / floor.mass),
                 damping_ratio = draw.one_in(2) ? 0 : draw.uniform(0, 0.25);
    const double speed = draw.uniform(0.3, 0.8) * slack, angle = draw.uniform(0, 6.28), length = draw.uniform(0.5, 1.5);
    const Triple along{std::cos(angle), 0, std::sin(angle)};
    const auto times = [](const Triple& v, double by) { return Triple{v[0] * by, v[1] * by, v[2] * by}; };
    BodyDescription& mover = floor.mover(scene);
    scene.springs = {{.body = floor.box,
                      .to_body = floor.other,
                      .stiffness = stiffness,
                      .damping = 2 * damping_ratio * floor.mass * swing,
                      .rest_length = length}};
    mover.position = times(along, length);
    double begin = 0, jump = 0;  // s, m
    const int how = draw.between(0, 3);
    if (how == 3) {
        // The end is a radius away from the middle of a body that turns by half a turn.
        const double radius = slack * draw.uniform(1.5, 3);
        mover.position = times(along, length + radius);
        mover.shape = {.kind = ShapeKind::box, .size = {0.04, 0.04, 0.04}, .points = {}};
        mover.angular_velocity = {0, draw.one_in(2) ? speed / radius : -speed / radius, 0};
        scene.springs[0].to = times(along, -radius);
        scene.duration = 2.5 * radius / speed;
        mover.kinematic = draw.one_in(2);
    } else {
        mover.kinematic = true;
        begin = how == 0 ? 0 : draw.uniform(falls_asleep + 0.1, 2.5);
        scene.duration = begin + draw.uniform(2, 4) * slack / speed;
        if (how == 0) mover.velocity = times(along, speed);
        else if (how == 1)
            scene.events = {
                {.time = begin, .kind = EventKind::velocity, .body = floor.other, .value = times(along, speed)}};
        else {
            // By a method of order one, what a damped spring pulls creeps after a slide.
            if (drawn.integrator == "semi_implicit_euler") drawn.integrator = "verlet";
            jump = slack * draw.uniform(1.2, 2);
            scene.events = {
                {.time = begin, .kind = EventKind::pose, .body = floor.other, .value = times(along, length + jump)}};
        }
    }
    place_anywhere(draw, scene);

    const auto simulation = start(drawn);
    const auto steps = static_cast<int>(scene.duration / drawn.step);
    // The end has moved on by a step, and a box that starts to slip swings about the end's speed.
    const double margin = 1.5 * speed / swing + speed * drawn.step + 0.03 * slack + stands;
    double stretched = 0, moved = 0;
    bool slips = false;
    for (int i = 0; i < steps; ++i) {
        const double before = i * drawn.step;  // s: when the step begins
        const bool was_asleep = simulation->body(floor.box).asleep;
        if (before < begin && before > falls_asleep && !was_asleep)
            return "the box is awake at rest after " + few_digits(before) + " s";
        simulation->step();
        if (before < begin - drawn.step) {
            if (length_of(position_of(*simulation, floor.box)) > 0) return "the box moves before anything pulls";
            continue;
        }
        if (jump == 0 && before > begin && simulation->body(floor.box).asleep)
            return "the box sleeps while the end of its spring moves, at " + few_digits(before) + " s";
        stretched =
            distance(end_of_spring(scene, *simulation, floor.other), position_of(*simulation, floor.box)) - length;
        moved = length_of(position_of(*simulation, floor.box));
        // The damper pulls too.
        slips = slips || stretched + 2 * damping_ratio * speed / swing > 0.98 * slack;
        if (!slips && moved > stands)
            return "the box moves by " + few_digits(moved) + " m though the spring pulls by " +
                   few_digits(stretched / slack) + " of what friction holds";
    }
    if (!simulation->troubles().empty()) return "status " + simulation->troubles().front().issue;
    if (stretched > slack + margin)
        return "the spring pulls by " + few_digits(stretched / slack) + " of what friction holds, expected at most " +
               few_digits(1 + margin / slack);
    if (jump == 0) return slips ? "" : "the spring never pulls by what friction holds";
    // The box slides for half a swing about the place where the spring pulls by what friction holds, and stops. The
    // slide begins and ends within a step.
    const double decay = std::numbers::pi * damping_ratio / std::sqrt(1 - damping_ratio * damping_ratio),
                 way = (jump - slack) * (1 + std::exp(-decay)),
                 allowed = 0.02 * way + 0.2 * swing * (jump - slack) * drawn.step;
    if (!(std::abs(moved - way) <= allowed))
        return "the box moves by " + few_digits(moved) + " m, expected " + few_digits(way) + " m within " +
               few_digits(allowed) + " m";
    if (!simulation->body(floor.box).asleep) return "the box is awake at the end";
    return "";
}

// A mass comes near at a constant speed and attracts the box, which slides as soon as it is attracted by more than
// friction holds: x'' = P / (D - v t - x)^2 - mu g, here integrated by Heun's method.
std::string attracted(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    const Floor floor{draw, scene};
    const double slips_at = draw.uniform(1, 2), speed = draw.uniform(0.05, 0.3),
                 start_at = slips_at + draw.uniform(1.5, 3) * speed, pull = floor.held() * slips_at * slips_at,
                 angle = draw.uniform(0, 6.28);
    BodyDescription& mover = floor.mover(scene);
    mover.mass = draw.magnitude(10, 1000);
    scene.gravitation = pull / *mover.mass;
    const Triple along{std::cos(angle), 0, std::sin(angle)};
    mover.kinematic = true;
    for (std::size_t i = 0; i < 3; ++i) {
        mover.position[i] = along[i] * start_at;
        mover.velocity[i] = -along[i] * speed;
    }
    double x = 0, v = 0, time = 0;
    const double dt = 1e-4;
    const auto rate = [&](double at, double moved) {
        const double r = start_at - speed * at - moved;
        return pull / (r * r) - floor.held();
    };
    for (; x < 0.1 * slips_at; time += dt) {
        const double a = rate(time, x);
        if (v <= 0 && a <= 0) continue;
        const double b = rate(time + dt, x + v * dt + a * dt * dt / 2);
        x += v * dt + a * dt * dt / 2;
        v += (a + b) / 2 * dt;
    }
    scene.duration = time;
    place_anywhere(draw, scene);

    const auto simulation = start(drawn);
    const auto steps = static_cast<int>(scene.duration / drawn.step);
    for (int i = 0; i < steps; ++i) {
        simulation->step();
        if (simulation->body(floor.box).asleep)
            return "the box sleeps while the mass moves, at " + few_digits(i * drawn.step) + " s";
    }
    const double moved = length_of(position_of(*simulation, floor.box)),
                 late = time - steps * drawn.step + 2 * drawn.step;  // it slips within a step
    if (!simulation->troubles().empty()) return "status " + simulation->troubles().front().issue;
    if (std::abs(moved - x) > 0.02 * x + v * late)
        return "the box moves by " + few_digits(moved) + " m, expected " + few_digits(x) + " m";
    return "";
}

// Nothing changes the load: the other end stands, has come to rest, turns about the point where the spring is fixed, or
// another kinematic body moves.
std::string asleep(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    const Floor floor{draw, scene};
    const double slack = draw.uniform(0.04, 0.15), stiffness = floor.held() * floor.mass / slack;
    BodyDescription& mover = floor.mover(scene);
    mover.kinematic = true;
    mover.position = {1, 0, 0};
    scene.springs = {{.body = floor.box, .to_body = floor.other, .stiffness = stiffness, .rest_length = 1}};
    scene.duration = 3;
    const int how = draw.between(0, 3);
    if (how == 1) {
        mover.velocity = {0.5 * slack, 0, 0};
        scene.events = {{.time = 1, .kind = EventKind::velocity, .body = floor.other, .value = {}}};
    }
    if (how == 2) mover.angular_velocity = {draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1)};
    if (how == 3) {
        BodyDescription& away = add_sphere(scene, 0, 0.1, {-3, 1, 0});
        away.kinematic = true;
        away.velocity = {0, 0, draw.uniform(0.1, 1)};
    }
    place_anywhere(draw, scene);

    const auto simulation = start(drawn);
    const auto steps = static_cast<int>(scene.duration / drawn.step);
    for (int i = 0; i < steps; ++i) {
        simulation->step();
        if (how == 1 && (i + 1) * drawn.step < 1 && simulation->body(floor.box).asleep)
            return "the box sleeps while the end of its spring moves, at " + few_digits(i * drawn.step) + " s";
    }
    if (!simulation->troubles().empty()) return "status " + simulation->troubles().front().issue;
    if (!simulation->body(floor.box).asleep) return "the box is awake after " + few_digits(scene.duration) + " s";
    return "";
}

// A box that has tumbled to rest, and a ball that a strong damper brings to rest beside it.
std::string asleep_beside_a_ball(Draw& draw, Case& drawn) {
    SceneDescription& scene = drawn.scene;
    scene.gravity = {0, -gravity, 0};
    scene.contact.restitution = draw.uniform(0, 0.4);
    scene.contact.friction = 0.5;
    scene.contact.sleep = host::SleepDescription{.speed = 0.05, .angular_speed = 0.5, .time = 0.25};
    scene.angular_drag = 0.01;
    scene.planes.emplace_back().name = "floor";
    const double height = draw.uniform(0.1, 0.2);
    auto& box = add_box(scene, 1, {draw.uniform(0.2, 0.6), height, draw.uniform(0.2, 0.6)}, {0, 3 * height, 0});
    box.angular_velocity = {draw.uniform(-2, 2), draw.uniform(-3, 3), draw.uniform(-2, 2)};
    add_sphere(scene, 1, 0.2, {draw.uniform(1.2, 1.6), draw.uniform(0.2, 0.25), 0}).velocity = {-1, 0, 0};
    scene.springs = {{.body = 0, .to_body = 1, .stiffness = 20, .damping = draw.uniform(6, 9), .rest_length = 1}};
    scene.duration = 10;  // the damper does not slow a ball that goes round the box
    place_anywhere(draw, scene);
    const auto simulation = start(drawn);
    for (int i = 0; i < static_cast<int>(scene.duration / drawn.step); ++i) simulation->step();
    for (int b = 0; b < 2; ++b)
        if (!simulation->body(b).asleep)
            return "body " + std::to_string(b) + " is awake after " + few_digits(scene.duration) + " s";
    return "";
}

}  // namespace tumble::test::sleepers_and_loads
