// Random scenes, and the method and the number system in which each is run. A trial follows from two numbers alone, on
// every machine: no function is used whose last bit depends on a library.
#pragma once

#include <cstdint>
#include <string>

#include "scene/description.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::test {

struct Trial {
    host::SceneDescription scene;
    std::string kind;  // of scene
    host::Method method;
};

// The distance of the farthest point of a body's shape from its centre, m; without a shape its radius of gyration, and
// 1 for a point mass.
[[nodiscard]] double reach(const host::BodyDescription& body);

[[nodiscard]] Trial draw_trial(std::uint64_t seed, std::uint64_t index);

// As a file for `tumble run`: the reader makes the same scene of it, numbers to their last bit. Not of shapes `points`.
[[nodiscard]] std::string scene_text(const host::SceneDescription& scene);

// What a number measures: a length, a velocity, a part of a quaternion, a spin; or a factor such as a mass or a size.
enum class Quantity { position, velocity, angle, spin, factor };

// Calls visit(double&, Quantity) with every number that sets the motion. Moments of inertia stay as they are, because
// few changes keep their triangle inequality.
template <class Visit>
void for_each_number(host::SceneDescription& scene, const Visit& visit) {
    const auto all = [&](auto& numbers, Quantity quantity) {
        for (double& x : numbers) visit(x, quantity);
    };
    host::ContactDescription& contact = scene.contact;
    all(scene.gravity, Quantity::factor);
    for (double* x : {&scene.gravitation, &scene.linear_drag, &scene.angular_drag, &contact.restitution,
                      &contact.friction, &contact.stiffness, &contact.damping})
        visit(*x, Quantity::factor);
    for (auto& plane : scene.planes) {
        all(plane.normal, Quantity::angle);
        visit(plane.offset, Quantity::position);
    }
    for (auto& body : scene.bodies) {
        visit(*body.mass, Quantity::factor);
        all(body.shape.size, Quantity::factor);
        all(body.position, Quantity::position);
        all(body.velocity, Quantity::velocity);
        all(body.orientation, Quantity::angle);
        all(body.angular_velocity, Quantity::spin);
    }
    for (auto& spring : scene.springs) {
        for (double* x : {&spring.stiffness, &spring.damping, &spring.rest_length}) visit(*x, Quantity::factor);
        all(spring.to, Quantity::position);
    }
    for (auto& impulse : scene.impulses)
        for (auto* numbers : {&impulse.impulse, &impulse.angular_impulse}) all(*numbers, Quantity::factor);
    for (auto& force : scene.forces)
        for (auto* numbers : {&force.force, &force.torque}) all(*numbers, Quantity::factor);
}

}  // namespace tumble::test
