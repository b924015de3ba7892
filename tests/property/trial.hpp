// Random scenes, and the method and the number system in which each is run. A trial follows from two numbers alone, on
// every machine: each drawn number is a short decimal, made without functions whose last bit depends on a library.
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

// What a number of a scene measures: a length, a velocity, an angle (a part of a quaternion), a spin, or a factor of
// the motion such as a mass, a stiffness or a size.
enum class Quantity { position, velocity, angle, spin, factor };

// Calls visit(double&, Quantity) with every number that sets the motion. Moments of inertia stay as they are, because
// no other change keeps their triangle inequality.
template <class Visit>
void for_each_number(host::SceneDescription& scene, const Visit& visit) {
    const auto each = [&](auto& array, Quantity quantity) {
        for (double& x : array) visit(x, quantity);
    };
    each(scene.gravity, Quantity::factor);
    for (double* x : {&scene.gravitation, &scene.linear_drag, &scene.angular_drag, &scene.contact.restitution,
                      &scene.contact.friction, &scene.contact.stiffness, &scene.contact.damping})
        visit(*x, Quantity::factor);
    for (host::PlaneDescription& plane : scene.planes) {
        each(plane.normal, Quantity::angle);
        visit(plane.offset, Quantity::position);
    }
    for (host::BodyDescription& body : scene.bodies) {
        visit(*body.mass, Quantity::factor);
        each(body.shape.size, Quantity::factor);
        each(body.position, Quantity::position);
        each(body.velocity, Quantity::velocity);
        each(body.orientation, Quantity::angle);
        each(body.angular_velocity, Quantity::spin);
    }
    for (host::SpringDescription& spring : scene.springs) {
        for (double* x : {&spring.stiffness, &spring.damping, &spring.rest_length}) visit(*x, Quantity::factor);
        each(spring.to, Quantity::position);
    }
    for (host::ImpulseDescription& impulse : scene.impulses) {
        each(impulse.impulse, Quantity::factor);
        each(impulse.angular_impulse, Quantity::factor);
    }
    for (host::ForceDescription& force : scene.forces) {
        each(force.force, Quantity::factor);
        each(force.torque, Quantity::factor);
    }
}

}  // namespace tumble::test
