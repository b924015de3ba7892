#include "accuracy/closed_form.hpp"

#include "truth/motion.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

namespace tumble::bench {

namespace {

using reference::Number;
using reference::Vector;
using reference::vector_of;
using Motion = std::function<Vector(Number)>;  // position, m, at a time, s

// Two-body motion from position and velocity by the difference of eccentric anomalies (R. Bate, D. Mueller, J. White,
// Fundamentals of Astrodynamics, section 4.4). mu in m^3/s^2.
Motion kepler(Vector r, Vector v, Number mu) {
    const Number distance = norm(r), a = 1 / (2 / distance - dot(v, v) / mu);
    if (!(a > 0)) throw std::invalid_argument{"the orbit is not an ellipse"};
    const Number rate = std::sqrt(mu / (a * a * a)), along = dot(r, v) / std::sqrt(mu * a), rest = 1 - distance / a;
    return [=](Number t) {
        Number e = rate * t;  // Newton's iteration; the function is monotonic
        for (int i = 0; i < 100; ++i) {
            const Number error = e - rest * std::sin(e) + along * (1 - std::cos(e)) - rate * t;
            const Number change = error / (1 - rest * std::cos(e) + along * std::sin(e));
            e -= change;
            if (std::abs(change) < 1e-18L * (1 + std::abs(e))) break;
        }
        const Number f = 1 - a / distance * (1 - std::cos(e)), g = t - (e - std::sin(e)) / rate;
        return r * f + v * g;
    };
}

// x'' = -w^2 (x - rest) - 2 damping x'.
Motion oscillation(Vector axis, Vector origin, Number x, Number v, Number rest, Number w2, Number damping) {
    const Number w = std::sqrt(w2 - damping * damping), a = x - rest, b = (v + damping * a) / w;
    return [=](Number t) {
        const Number now = rest + std::exp(-damping * t) * (a * std::cos(w * t) + b * std::sin(w * t));
        return origin + axis * now;
    };
}

// v' = g - v / time.
Motion drag(Vector x, Vector v, Vector gravity, Number time) {
    const Vector terminal = gravity * time;
    return [=](Number t) { return x + terminal * t + (v - terminal) * (-time * std::expm1(-t / time)); };
}

// A height that starts at `gap` and is thrown up by `restitution` at every impact; sideways motion is uniform.
Motion bounces(Vector x, Vector v, Vector up, Number gap, Number gravity, Number restitution) {
    return [=](Number t) {
        Number height = gap, speed = dot(v, up), rest = t;
        while (true) {
            // The time until the height is zero again.
            const Number fall = (speed + std::sqrt(speed * speed + 2 * gravity * height)) / gravity;
            if (fall >= rest) break;
            rest -= fall;
            speed = -restitution * (speed - gravity * fall);
            height = 0;
            if (speed * speed < 1e-12L) throw std::invalid_argument{"the ball has come to rest before the end"};
        }
        height += speed * rest - gravity * rest * rest / 2;
        return x + (v - up * dot(v, up)) * t + up * (height - gap);
    };
}

std::optional<Motion> motion_of(const host::SceneDescription& scene) {
    const auto moves = [](const host::BodyDescription& b) { return !b.fixed; };
    if (std::count_if(scene.bodies.begin(), scene.bodies.end(), moves) != 1 || !scene.impulses.empty() ||
        !scene.forces.empty())
        return {};
    const auto& body = *std::find_if(scene.bodies.begin(), scene.bodies.end(), moves);
    if (!body.mass) return {};
    const Vector x = vector_of(body.position), v = vector_of(body.velocity), gravity = vector_of(scene.gravity);
    const Number mass = *body.mass;
    const bool touches = !scene.planes.empty() && scene.contact.response != ContactResponse::none;

    if (scene.gravitation > 0 && scene.bodies.size() == 2 && scene.springs.empty() && !touches) {
        const auto& sun = scene.bodies[scene.bodies[0].fixed ? 0 : 1];
        const Vector center = vector_of(sun.position);
        const Motion relative = kepler(x - center, v, static_cast<Number>(scene.gravitation) * *sun.mass);
        return [=](Number t) { return center + relative(t); };
    }
    if (scene.springs.size() == 1 && scene.linear_drag == 0 && !touches) {
        const auto& spring = scene.springs[0];
        const Vector anchor = vector_of(spring.to), reach = x - anchor;
        const Vector axis = reach * (1 / norm(reach));
        const bool on_a_line = norm(cross(axis, v)) == 0 && norm(cross(axis, gravity)) == 0;
        if (spring.to_body >= 0 || spring.point != host::Triple{} || !on_a_line) return {};
        const Number w2 = spring.stiffness / mass, damping = spring.damping / (2 * mass);
        return oscillation(axis, anchor, norm(reach), dot(v, axis), spring.rest_length + dot(gravity, axis) / w2, w2,
                           damping);
    }
    if (scene.linear_drag > 0 && scene.springs.empty() && !touches)
        return drag(x, v, gravity, mass / scene.linear_drag);
    if (touches && scene.planes.size() == 1 && body.shape.kind == ShapeKind::sphere && scene.springs.empty()) {
        const auto& plane = scene.planes[0];
        const Vector normal = vector_of(plane.normal), up = normal * (1 / norm(normal));
        if (norm(cross(up, gravity)) != 0 || body.restitution || scene.contact.friction > 0 || plane.friction ||
            norm(vector_of(body.angular_velocity)) != 0)
            return {};
        return bounces(x, v, up, dot(up, x) + plane.offset - body.shape.size[0], norm(gravity),
                       plane.restitution.value_or(scene.contact.restitution));
    }
    return {};
}

}  // namespace

std::optional<std::vector<Position>> closed_form(const host::SceneDescription& scene, long double interval,
                                                 int samples) {
    const auto motion = motion_of(scene);
    if (!motion) return {};
    std::vector<Position> positions;
    for (int i = 0; i <= samples; ++i) {
        const Vector x = (*motion)(interval * i);
        positions.push_back({x.x, x.y, x.z});
    }
    return positions;
}

}  // namespace tumble::bench
