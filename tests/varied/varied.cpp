// Runs random scenes of the kinds in kinds.cpp and reports each whose result is wrong, with the scene and what repeats
// it.
#include "varied.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "scene/writer.hpp"

namespace tumble::test {

using host::Quadruple;

double Draw::magnitude(double low, double high) {
    const int exponent = between(std::ilogb(low), std::ilogb(high));
    return std::clamp(std::ldexp(uniform(1.0, 2.0), exponent), low, high);
}

namespace {

BodyDescription& add_body(SceneDescription& scene, double mass, const Triple& position) {
    BodyDescription& body = scene.bodies.emplace_back();
    body.name = "b" + std::to_string(scene.bodies.size() - 1);
    body.position = position;
    body.mass = mass > 0 ? mass : 1;
    body.fixed = !(mass > 0);
    return body;
}

bool turns_a_body(EventKind kind) {
    return kind == EventKind::angular_impulse || kind == EventKind::torque || kind == EventKind::step_torque ||
           kind == EventKind::angular_velocity;
}

// Calls visit with each vector of the world's frame, with whether a mirror reverses it as it does a turn, and with each
// orientation.
template <class Vectors, class Orientations>
void for_each_direction(SceneDescription& scene, const Vectors& vector, const Orientations& orientation) {
    vector(scene.gravity, false);
    vector(scene.wind, false);
    for (auto& plane : scene.planes) vector(plane.normal, false);
    for (auto& body : scene.bodies) {
        vector(body.position, false);
        vector(body.velocity, false);
        orientation(body.orientation);
    }
    for (auto& spring : scene.springs)
        if (spring.to_body < 0) vector(spring.to, false);
    for (auto& force : scene.forces) {
        if (force.frame != Frame::world) continue;
        vector(force.force, false);
        vector(force.torque, true);
    }
    for (auto& impulse : scene.impulses) {
        if (impulse.frame != Frame::world) continue;
        vector(impulse.impulse, false);
        vector(impulse.angular_impulse, true);
    }
    for (auto& event : scene.events) {
        if (event.kind == EventKind::pose) orientation(event.orientation);
        if (event.frame == Frame::world) vector(event.value, turns_a_body(event.kind));
    }
}

}  // namespace

Quadruple product(const Quadruple& p, const Quadruple& q) {
    return {
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3], p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1], p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]};
}

BodyDescription& add_box(SceneDescription& scene, double mass, const Triple& edges, const Triple& position) {
    BodyDescription& body = add_body(scene, mass, position);
    body.shape = {.kind = ShapeKind::box, .size = edges, .points = {}};
    return body;
}
BodyDescription& add_sphere(SceneDescription& scene, double mass, double radius, const Triple& position) {
    BodyDescription& body = add_body(scene, mass, position);
    body.shape = {.kind = ShapeKind::sphere, .size = {radius, 0, 0}, .points = {}};
    return body;
}

Triple rotated(const Quadruple& by, const Triple& v) {
    const Quadruple r = product(product(by, {0, v[0], v[1], v[2]}), {by[0], -by[1], -by[2], -by[3]});
    return {r[1], r[2], r[3]};
}
Triple rotated_back(const Quadruple& by, const Triple& v) { return rotated({by[0], -by[1], -by[2], -by[3]}, v); }

void turn(SceneDescription& scene, const Quadruple& by) {
    for_each_direction(
        scene, [&](Triple& v, bool) { v = rotated(by, v); }, [&](Quadruple& q) { q = product(by, q); });
}

void mirror(SceneDescription& scene, int axis) {
    const auto i = static_cast<std::size_t>(axis);
    // A turn keeps its part along the axis and reverses the others.
    const auto reverse = [&](double* v, bool turns) {
        for (std::size_t k = 0; k < 3; ++k)
            if ((k == i) != turns) v[k] = -v[k];
    };
    for_each_direction(
        scene, [&](Triple& v, bool turns) { reverse(v.data(), turns); },
        [&](Quadruple& q) { reverse(q.data() + 1, true); });
    for (auto& body : scene.bodies) {
        reverse(body.angular_velocity.data(), true);
        reverse(body.wheel_momentum.data(), true);
    }
    for (auto& spring : scene.springs) {
        reverse(spring.point.data(), false);
        if (spring.to_body >= 0) reverse(spring.to.data(), false);
    }
    for (auto& force : scene.forces) {
        reverse(force.point.data(), false);
        if (force.frame != Frame::body) continue;
        reverse(force.force.data(), false);
        reverse(force.torque.data(), true);
    }
    for (auto& impulse : scene.impulses) {
        reverse(impulse.point.data(), false);
        if (impulse.frame != Frame::body) continue;
        reverse(impulse.impulse.data(), false);
        reverse(impulse.angular_impulse.data(), true);
    }
    for (auto& event : scene.events) {
        reverse(event.point.data(), false);
        if (event.frame == Frame::body) reverse(event.value.data(), turns_a_body(event.kind));
    }
}

Quadruple any_turn(Draw& draw) {
    const int choice = draw.between(1, 3);
    Quadruple q{1, 0, 0, 0};
    for (double size = 0; choice > 1 && !(size > 0.1 && size <= 1);) {
        for (double& x : q) x = draw.uniform(-1, 1);
        if (choice == 2) q[1] = q[3] = 0;
        size = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        for (double& x : q) x /= size > 0 ? size : 1;
    }
    return q;
}

Triple Placement::back(const Triple& v) const {
    Triple made = rotated_back(turned, v);
    if (mirrored >= 0) made[static_cast<std::size_t>(mirrored)] *= -1;
    return made;
}
Placement place_anywhere(Draw& draw, SceneDescription& scene) {
    Placement placement;
    if (draw.one_in(2)) {
        placement.mirrored = draw.between(0, 2);
        mirror(scene, placement.mirrored);
    }
    placement.turned = any_turn(draw);
    turn(scene, placement.turned);
    return placement;
}

namespace {

Triple triple(const std::array<long double, 3>& v) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

}  // namespace

Triple position_of(const Simulation& simulation, int body) { return triple(simulation.body(body).position); }
Triple velocity_of(const Simulation& simulation, int body) { return triple(simulation.body(body).velocity); }
Triple spin_of(const Simulation& simulation, int body) { return triple(simulation.body(body).angular_velocity); }
Quadruple orientation_of(const Simulation& simulation, int body) {
    const auto q = simulation.body(body).orientation;
    return {static_cast<double>(q[0]), static_cast<double>(q[1]), static_cast<double>(q[2]), static_cast<double>(q[3])};
}
double length_of(const Triple& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
double distance(const Triple& a, const Triple& b) { return length_of({a[0] - b[0], a[1] - b[1], a[2] - b[2]}); }

std::unique_ptr<Simulation> start(const Case& scene) {
    return host::make_simulation(scene.scene, scene.integrator, scene.numbers);
}

namespace {

Case draw_case(Draw& draw) {
    std::vector<std::string> methods;
    for (const auto& method : host::integrators())
        if (method.is_usual && method.name != "explicit_euler")
            methods.insert(methods.end(), method.name == "verlet" ? 3U : 1U, method.name);
    Case drawn;
    drawn.integrator = draw.of(methods);
    drawn.numbers = draw.of<std::string>({"q32", "q32", "f32", "f64"});
    const std::string step = draw.of<std::string>({"1/60", "1/120", "1/256", "1/1000"});
    drawn.scene.step = *host::parse_step(step);
    drawn.step = drawn.scene.step.seconds();
    drawn.scene.range = {.position = 64, .velocity = 32, .angular_velocity = 32, .is_declared = true};
    return drawn;
}

// How many of the scenes are wrong.
int run(const Kind& kind, std::uint64_t seed, std::uint64_t first, std::uint64_t count, const std::string& write) {
    int wrong = 0;
    for (std::uint64_t i = first; i < first + count; ++i) {
        Draw draw{seed, i};
        Case drawn = draw_case(draw);
        std::string what;
        try {
            drawn.scene.name = kind.name;
            what = kind.judge(draw, drawn);
        } catch (const std::exception& error) { what = error.what(); }
        if (what.empty()) continue;
        ++wrong;
        std::cout << "WRONG " << kind.name << ", seed " << seed << ", scene " << i << " (--integrator "
                  << drawn.integrator << " --numbers " << drawn.numbers << "): " << what << "\n";
        if (write.empty()) continue;
        std::filesystem::create_directories(write);
        std::ofstream{std::filesystem::path(write) / (std::string(kind.name) + "-" + std::to_string(i) + ".toml")}
            << "# " << what << "\n"
            << host::scene_text(drawn.scene);
    }
    std::cout << count << " scenes, " << wrong << " wrong: " << kind.name << std::endl;
    return wrong;
}

}  // namespace
}  // namespace tumble::test

int main(int argc, char** argv) try {
    using namespace tumble::test;
    std::uint64_t seed = 1, first = 0, scenes = 200;
    std::string write, part;
    CLI::App app{"Runs random scenes of kinds in which results have been wrong, and holds them against right values."};
    app.add_option("--seed", seed, "seed of the scenes")->capture_default_str();
    app.add_option("--first", first, "number of the first scene");
    app.add_option("--scenes", scenes, "scenes of each kind")->capture_default_str();
    app.add_option("--kind", part, "only kinds whose name has this part");
    app.add_option("--write", write, "directory for the wrong scenes");
    CLI11_PARSE(app, argc, argv);
    int wrong = 0, run_kinds = 0;
    for (const Kind& kind : kinds) {
        if (std::string(kind.name).find(part) == std::string::npos) continue;
        ++run_kinds;
        wrong += run(kind, seed, first, scenes, write);
    }
    if (run_kinds == 0) {
        std::cerr << "no kind has \"" << part << "\" in its name\n";
        return 2;
    }
    return wrong > 0 ? 1 : 0;
} catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 2;
}
