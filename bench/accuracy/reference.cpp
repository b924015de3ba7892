#include "accuracy/reference.hpp"

#include "scene/data.hpp"
#include "simulation/simulation.hpp"
#include "truth/smooth_motion.hpp"

#include <algorithm>
#include <stdexcept>

namespace tumble::bench {

using reference::Rotation;

Flight::Flight(const host::SceneDescription& scene) : scene_{scene} {
    host::SmoothMotion truth{scene, host::shapes_meet};
    for (std::int64_t step = 1; step <= scene.steps(); ++step) {
        truth.advance_to(step);
        if (truth.clearance() < 0) break;
        after_step_.push_back(truth.bodies());
    }
}

Flight::Error Flight::error_of(const std::string& integrator, const std::string& numbers, bool carry) const {
    const auto simulation = host::make_simulation(scene_, integrator, numbers, carry);
    Error error;
    for (const auto& expected : after_step_) {
        simulation->step();
        std::vector<host::BodySnapshot> bodies;
        for (std::size_t b = 0; b < expected.size(); ++b) bodies.push_back(simulation->body(static_cast<int>(b)));
        // A method that falls too low touches before the true motion does. Its motion after that is no error of flight.
        if (std::any_of(bodies.begin(), bodies.end(), [](const auto& body) { return body.contacts > 0; })) break;
        for (std::size_t b = 0; b < expected.size(); ++b) error.largest.see(expected[b], host::motion_of(bodies[b]));
        ++error.steps;
    }
    return error;
}

std::vector<Quaternion> reference_orientations(const host::SceneDescription& scene, int samples) {
    if (!scene.impulses.empty()) throw std::invalid_argument{scene.path + ": rotation problems are without impulses"};
    for (const auto& force : scene.forces) {
        if (force.from > 0 || force.until < scene.duration)
            throw std::invalid_argument{scene.path + ": forces last for the whole run"};
    }
    host::SceneDescription sampled = scene;
    sampled.step = {1, 0, scene.duration / samples};
    host::SmoothMotion truth{sampled, host::shapes_meet};
    std::vector<Quaternion> orientations;
    for (int sample = 0; sample <= samples; ++sample) {
        truth.advance_to(sample);
        const Rotation& q = truth.bodies().at(0).q;
        orientations.push_back({q.w, q.v.x, q.v.y, q.v.z});
    }
    return orientations;
}

double angle_between_orientations(const Quaternion& a, const Quaternion& b) {
    return static_cast<double>(angle_between(Rotation{a[0], {a[1], a[2], a[3]}}, Rotation{b[0], {b[1], b[2], b[3]}}));
}

}  // namespace tumble::bench
