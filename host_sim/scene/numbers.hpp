// Visits all numbers of a scene that decide its motion, for code that changes them one by one.
#pragma once

#include "scene/description.hpp"

namespace tumble::host {

// The quantity of a number: a length, a velocity, a part of a quaternion, a spin; or a factor such as a mass or a size.
enum class Measure { position, velocity, angle, spin, factor };

// Calls visit(double&, Measure) with every number that sets the motion. Moments of inertia stay as they are, because
// few changes keep their triangle inequality.
template <class Visit>
void for_each_number(SceneDescription& scene, const Visit& visit) {
    const auto all = [&](auto& numbers, Measure measure) {
        for (double& x : numbers) visit(x, measure);
    };
    ContactDescription& contact = scene.contact;
    all(scene.gravity, Measure::factor);
    all(scene.wind, Measure::velocity);
    if (scene.gravity_gradient) {
        visit(scene.gravity_gradient->orbit_rate, Measure::factor);
        all(scene.gravity_gradient->to_centre, Measure::angle);
    }
    for (double* x : {&scene.gravitation, &scene.softening, &scene.linear_drag, &scene.angular_drag,
                      &contact.restitution, &contact.friction, &contact.rolling_resistance,
                      &contact.spinning_resistance, &contact.stiffness, &contact.damping})
        visit(*x, Measure::factor);
    for (auto& plane : scene.planes) {
        all(plane.normal, Measure::angle);
        visit(plane.offset, Measure::position);
    }
    for (auto& body : scene.bodies) {
        visit(*body.mass, Measure::factor);
        all(body.shape.size, Measure::factor);
        all(body.position, Measure::position);
        all(body.velocity, Measure::velocity);
        all(body.orientation, Measure::angle);
        all(body.angular_velocity, Measure::spin);
        visit(body.linear_drag, Measure::factor);
        visit(body.quadratic_drag, Measure::factor);
        all(body.wheel_momentum, Measure::factor);
    }
    for (auto& spring : scene.springs) {
        for (double* x : {&spring.stiffness, &spring.damping, &spring.rest_length}) visit(*x, Measure::factor);
        all(spring.to, Measure::position);
    }
    for (auto& joint : scene.joints) {
        all(joint.anchor, Measure::position);
        all(joint.axis, Measure::angle);
        all(joint.to_axis, Measure::angle);
        all(joint.to_point, Measure::position);
    }
    for (auto& impulse : scene.impulses)
        for (auto* numbers : {&impulse.impulse, &impulse.angular_impulse}) all(*numbers, Measure::factor);
    for (auto& force : scene.forces)
        for (auto* numbers : {&force.force, &force.torque}) all(*numbers, Measure::factor);
}

}  // namespace tumble::host
