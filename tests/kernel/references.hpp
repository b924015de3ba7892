// The references for the first body of a world: the same scene in the reference, and its conserved quantities.
#pragma once

#include "worlds.hpp"

#include "truth/trajectory.hpp"

#include <algorithm>

namespace tumble::test {

// The fixture of tests that every case runs.
class CaseTest : public testing::TestWithParam<Case> {
protected:
    static const System& system() { return GetParam().system; }
    static int order() { return GetParam().method.order; }
    // The world of a scene after this number of steps.
    static std::unique_ptr<AnyWorld> run(const SceneSetup& setup, std::int64_t steps) {
        auto world = build(setup, GetParam());
        world->run(steps);
        return world;
    }
};
// The cases of which is_one(case) is true.
[[nodiscard]] std::vector<Case> cases_where(const auto& is_one) {
    std::vector<Case> cases = every_case();
    std::erase_if(cases, [&](const Case& c) { return !is_one(c); });
    return cases;
}

// A body of the given mass and principal moments along its own axes, without a shape.
[[nodiscard]] inline BodySpec top(RealVec3 moments, RealVec3 spin, Real mass = 1, Vector position = {},
                                  Vector velocity = {}) {
    BodySpec body;
    body.mass = mass;
    body.inertia = {moments.x, moments.y, moments.z, 0, 0, 0};
    body.position = real(position);
    body.velocity = real(velocity);
    body.angular_velocity = spin;
    return body;
}

// A body at a place (m), with a velocity (m/s) and a spin (rad/s, body frame).
[[nodiscard]] inline BodySpec placed(BodySpec body, Vector position, Vector velocity = {}, Vector spin = {}) {
    body.position = real(position);
    body.velocity = real(velocity);
    body.angular_velocity = real(spin);
    return body;
}

[[nodiscard]] inline BodySpec oriented(BodySpec body, RealQuat orientation) {
    body.orientation = orientation;
    return body;
}
// The moments of a body whose tensor is diagonal in its own axes.
[[nodiscard]] inline Vector moments_of(const BodySpec& body) {
    return {number(body.inertia.xx), number(body.inertia.yy), number(body.inertia.zz)};
}

// A top that tumbles: it turns about its middle axis, which is unstable.
[[nodiscard]] inline SceneSetup free_top(Seconds step) {
    return {.name = "free_top", .step = step, .bodies = {top({1, 2, 3}, {0.1, 2, 0.1})}};
}

[[nodiscard]] inline reference::Body reference_body(const BodySpec& body) {
    return {number(body.mass), {number(body.inertia.xx), number(body.inertia.yy), number(body.inertia.zz)}};
}
// Gravity, drag and springs to points of the world, on the first body.
[[nodiscard]] inline auto reference_load(const SceneSetup& setup) {
    const Number mass = number(setup.bodies[0].mass);
    return [=](const Motion& m, Number) {
        const Number linear = number(setup.world.linear_drag), angular = number(setup.world.angular_drag);
        reference::Wrench sum{vector(setup.world.gravity) * mass - m.v * linear, m.w * -angular};
        for (const SpringSpec& spring : setup.springs) {
            const Vector point = vector(spring.point), reach = vector(spring.to) - m.x - m.q.rotate(point);
            const Number length = norm(reach), stiffness = number(spring.stiffness);
            const Vector along = reach * (1 / length), velocity = m.v + m.q.rotate(cross(m.w, point));
            const Vector pull = along * (stiffness * (length - number(spring.rest_length)) -
                                         number(spring.damping) * dot(velocity, along));
            sum.force_w = sum.force_w + pull;
            sum.torque_b = sum.torque_b + cross(point, m.q.rotate_back(pull));
        }
        return sum;
    };
}
[[nodiscard]] inline Motion start_of(const BodySpec& body) {
    return {vector(body.position), vector(body.velocity), rotation(body.orientation).normalized(),
            vector(body.angular_velocity)};
}

// The largest of the differences in m, m/s, rad and rad/s.
[[nodiscard]] inline Number distance(const Motion& a, const Motion& b) {
    return std::max({norm(a.x - b.x), norm(a.v - b.v), angle_between(a.q, b.q), norm(a.w - b.w)});
}

// The largest orientation error of the first body, rad, over samples at equal numbers of steps.
[[nodiscard]] inline Number orientation_error(AnyWorld& world, const std::vector<Motion>& reference,
                                              int steps_per_sample) {
    Number worst = 0;
    for (const Motion& expected : reference) {
        if (&expected != &reference.front()) world.run(steps_per_sample);
        worst = std::max(worst, angle_between(world.motion(0).q, expected.q));
    }
    return worst;
}

// N m s, world axes, about the centre of mass.
[[nodiscard]] inline Vector angular_momentum(const Motion& m, Vector moments) {
    return m.q.normalized().rotate(times(moments, m.w));
}
[[nodiscard]] inline Number spin_energy(const Motion& m, Vector moments) { return dot(m.w, times(moments, m.w)) / 2; }

}  // namespace tumble::test
