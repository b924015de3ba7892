#include "reference.hpp"

#include "simulation.hpp"
#include "trajectory.hpp"

#include <algorithm>
#include <stdexcept>

namespace tumble::bench {

namespace {

using namespace tumble::reference;

Vector vector_of(const host::Triple& t) { return {t[0], t[1], t[2]}; }

struct Kick {
    std::int64_t step;
    host::ImpulseDescription impulse;
};

// The height of the body's lowest point over the nearest plane.
Number clearance(const host::SceneDescription& scene, const Motion& m) {
    const auto& shape = scene.bodies[0].shape;
    Number least = 1e30L;
    for (const auto& plane : scene.planes) {
        const Vector given = vector_of(plane.normal), n = given * (1 / norm(given));
        Number reach = 0;
        if (shape.kind == host::ShapeKind::box) {
            const Vector in_body = m.q.normalized().rotate_back(n);
            for (int i = 0; i < 3; ++i) reach += std::abs(in_body[i]) * shape.size[static_cast<std::size_t>(i)] / 2;
        } else if (shape.kind == host::ShapeKind::sphere) {
            reach = shape.size[0];
        }
        least = std::min(least, dot(n, m.x) + plane.offset - reach);
    }
    return least;
}

}  // namespace

struct Flight::Motions {
    std::vector<Motion> after_step;
};

Flight::Flight(const host::SceneDescription& scene) : scene_{scene}, motions_{std::make_unique<Motions>()} {
    const auto& body = scene.bodies.at(0);
    if (scene.bodies.size() != 1 || !scene.springs.empty() || !scene.forces.empty() || scene.linear_drag > 0 ||
        scene.angular_drag > 0 || !body.mass || body.inertia || body.shape.kind != host::ShapeKind::box) {
        throw std::invalid_argument{"flight errors are for scenes of one box under gravity and impulses"};
    }
    const Number mass = *body.mass, a = body.shape.size[0], b = body.shape.size[1], c = body.shape.size[2];
    const Body reference_body{
        mass, Vector{mass * (b * b + c * c) / 12, mass * (a * a + c * c) / 12, mass * (a * a + b * b) / 12}};
    const Rotation q{body.orientation[0], {body.orientation[1], body.orientation[2], body.orientation[3]}};
    Motion now{vector_of(body.position), vector_of(body.velocity), q.normalized(), vector_of(body.angular_velocity)};

    const Number h = scene.step.denominator == 0
                         ? static_cast<Number>(scene.step.decimal)
                         : static_cast<Number>(scene.step.numerator) / static_cast<Number>(scene.step.denominator);
    std::vector<Kick> kicks;
    for (const auto& impulse : scene.impulses)
        kicks.push_back({std::llround(static_cast<long double>(impulse.time) / h), impulse});
    std::stable_sort(kicks.begin(), kicks.end(), [](const Kick& x, const Kick& y) { return x.step < y.step; });

    const Vector weight = vector_of(scene.gravity) * mass;
    std::size_t next = 0;
    for (std::int64_t step = 0; step < scene.steps(); ++step) {
        for (; next < kicks.size() && kicks[next].step <= step; ++next) {
            const auto& k = kicks[next].impulse;
            const bool in_body = k.frame == host::Frame::body;
            const Vector j_w = in_body ? now.q.rotate(vector_of(k.impulse)) : vector_of(k.impulse);
            const Vector j_b = now.q.rotate_back(j_w);
            const Vector l_b = in_body ? vector_of(k.angular_impulse) : now.q.rotate_back(vector_of(k.angular_impulse));
            now.v = now.v + j_w * (1 / mass);
            now.w = now.w + over(cross(vector_of(k.point), j_b) + l_b, reference_body.moments);
        }
        now = trajectory(reference_body, now, {0, h}, [&](const Motion&, Number) { return Wrench{weight, {}}; })[1];
        if (!scene.planes.empty() && clearance(scene, now) < 0) break;
        motions_->after_step.push_back(now);
    }
}

Flight::~Flight() = default;

FlightError Flight::error_of(const std::string& integrator, const std::string& numbers, bool carry) const {
    const auto simulation = host::make_simulation(scene_, integrator, numbers, carry);
    FlightError error;
    for (const Motion& expected : motions_->after_step) {
        simulation->step();
        const host::BodySnapshot seen = simulation->body(0);
        const Vector x{seen.position[0], seen.position[1], seen.position[2]};
        const Rotation p{seen.orientation[0], {seen.orientation[1], seen.orientation[2], seen.orientation[3]}};
        error.position_m = std::max(error.position_m, static_cast<double>(norm(x - expected.x)));
        error.orientation_rad = std::max(error.orientation_rad, static_cast<double>(angle_between(expected.q, p)));
    }
    return error;
}

std::vector<Quaternion> reference_orientations(const host::SceneDescription& scene, int samples) {
    const auto& body = scene.bodies.at(0);
    if (scene.bodies.size() != 1 || !scene.springs.empty() || !scene.impulses.empty() || scene.linear_drag > 0 ||
        scene.angular_drag > 0 || !body.mass || !body.inertia || !body.inertia_is_diagonal) {
        throw std::invalid_argument{
            scene.path + ": rotation problems are of one body with a diagonal inertia under gravity and forces"};
    }
    for (const auto& force : scene.forces) {
        if (force.from > 0 || force.until < scene.duration)
            throw std::invalid_argument{scene.path + ": forces last for the whole run"};
    }
    const Body reference_body{*body.mass, Vector{(*body.inertia)[0], (*body.inertia)[1], (*body.inertia)[2]}};
    const Rotation q{body.orientation[0], {body.orientation[1], body.orientation[2], body.orientation[3]}};
    const Motion start{vector_of(body.position), vector_of(body.velocity), q.normalized(),
                       vector_of(body.angular_velocity)};
    const auto load = [&](const Motion& m, Number) {
        Wrench sum{vector_of(scene.gravity) * reference_body.mass, {}};
        for (const auto& force : scene.forces) {
            const bool in_body = force.frame == host::Frame::body;
            const Vector f_b = in_body ? vector_of(force.force) : m.q.rotate_back(vector_of(force.force));
            const Vector torque_b = in_body ? vector_of(force.torque) : m.q.rotate_back(vector_of(force.torque));
            sum.force_w = sum.force_w + m.q.rotate(f_b);
            sum.torque_b = sum.torque_b + cross(vector_of(force.point), f_b) + torque_b;
        }
        return sum;
    };
    std::vector<Quaternion> orientations;
    for (const Motion& m : trajectory(reference_body, start,
                                      sample_times(static_cast<Number>(scene.duration) / samples, samples), load)) {
        orientations.push_back({m.q.w, m.q.v.x, m.q.v.y, m.q.v.z});
    }
    return orientations;
}

double angle_between_orientations(const Quaternion& a, const Quaternion& b) {
    return static_cast<double>(angle_between(Rotation{a[0], {a[1], a[2], a[3]}}, Rotation{b[0], {b[1], b[2], b[3]}}));
}

}  // namespace tumble::bench
