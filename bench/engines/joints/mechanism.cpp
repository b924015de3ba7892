#include "mechanism.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tumble::bench {

namespace {

using reference::Motion, reference::Number, reference::Rotation, reference::Vector;

constexpr double gravity = 9.81;  // m/s^2

struct Link {
    double mass;    // kg
    Vector size;    // m, of a box, along its axes
    Motion start;   // of the centre of mass
    Vector anchor;  // m, world: the joint with the link before
    Vector axis;    // of a hinge, world, of unit length; zero: a ball joint
};
Rotation about_z(Number angle) { return reference::exponential(Vector{0, 0, angle}); }
// Along a rod that hangs at an angle.
Vector down_at(Number angle) { return {std::sin(angle), -std::cos(angle), 0}; }
// A rod whose upper end is at `from`.
Link rod(double mass, Vector size, Vector from, Number angle, Vector axis) {
    return {mass, size, {from + down_at(angle) * (size.y / 2), {}, about_z(angle), {}}, from, axis};
}
host::Triple triple(const Vector& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
Mechanism made(const std::string& name, double seconds, double length, const std::vector<Link>& links) {
    Mechanism made{length, {}};
    made.scene.name = name;
    made.scene.gravity = {0, -gravity, 0};
    made.scene.duration = seconds;
    for (const Link& link : links) {
        host::BodyDescription& body = made.scene.bodies.emplace_back();
        body.mass = link.mass;
        const auto moment = [&](Number a, Number b) { return static_cast<double>(link.mass / 12 * (a * a + b * b)); };
        const Vector& size = link.size;
        body.inertia = std::array<double, 6>{moment(size.y, size.z), moment(size.x, size.z), moment(size.x, size.y)};
        body.position = triple(link.start.x);
        body.velocity = triple(link.start.v);
        const host::Triple q = triple(link.start.q.v);
        body.orientation = {static_cast<double>(link.start.q.w), q[0], q[1], q[2]};
        body.angular_velocity = triple(link.start.w);
        host::JointDescription& joint = made.scene.joints.emplace_back();
        joint.kind = dot(link.axis, link.axis) > 0 ? host::JointKind::hinge : host::JointKind::ball;
        joint.body = static_cast<int>(made.scene.joints.size()) - 1;
        joint.to_body = joint.body - 1;
        joint.anchor = triple(link.anchor);
        joint.axis = triple(link.axis);
    }
    return made;
}
constexpr Vector z_axis{0, 0, 1}, rod_size{0.1L, 1, 0.1L};

Mechanism double_pendulum() {
    return made("double pendulum", 2, 2, {rod(1, rod_size, {}, 2, z_axis), rod(1, rod_size, down_at(2), 2.4L, z_axis)});
}
// About the point where the mechanism ties to the world, as one body.
Link spun(Link link, Vector spin) {
    link.start.v = cross(spin, link.start.x);
    link.start.w = link.start.q.rotate_back(spin);
    return link;
}
constexpr Vector about_the_vertical{0, 2, 0};  // rad/s
// Links of 0.1 m on ball joints, aslant, that turn about the vertical at the start.
Mechanism chain() {
    std::vector<Link> links;
    for (int i = 0; i < 10; ++i)
        links.push_back(spun(rod(0.1, {0.02L, 0.1L, 0.03L}, down_at(0.5L) * (0.1L * i), 0.5L, {}), about_the_vertical));
    return made("chain of ten", 1, 1, links);
}
// A column and five links that stretch out of it. All turn about the vertical as one body at the start, and fall.
Mechanism arm() {
    constexpr std::array<double, 6> lengths{0.2, 0.4, 0.35, 0.12, 0.1, 0.08}, masses{4, 3.5, 2.5, 1.2, 0.8, 0.4};
    const std::array<Vector, 6> axes{Vector{0, 1, 0}, z_axis, z_axis, {1, 0, 0}, z_axis, {1, 0, 0}};
    std::vector<Link> links;
    Vector at{};
    for (std::size_t i = 0; i < 6; ++i) {
        const Number l = lengths[i];
        const Vector along = i == 0 ? Vector{0, l, 0} : Vector{l, 0, 0};
        const Vector size = i == 0 ? Vector{0.08L, l, 0.08L} : Vector{l, 0.06L, 0.07L};
        links.push_back(spun({masses[i], size, {at + along * 0.5L, {}, {}, {}}, at, axes[i]}, about_the_vertical));
        at = at + along;
    }
    return made("arm of six", 0.5, 1.25, links);
}

}  // namespace

Mechanism pendulum() { return made("pendulum", 4, 1, {rod(1, rod_size, {}, 2.5L, z_axis)}); }
Mechanism spherical_pendulum() {
    const Link link = rod(1, {0.1L, 1, 0.2L}, {}, 1, {});
    // 1 m/s sideways, 0.5 m from the joint
    return made("spherical pendulum", 4, 1, {spun(link, cross(link.start.x, Vector{0, 0, 1}) * 4)});
}
std::vector<Mechanism> mechanisms() { return {pendulum(), double_pendulum(), chain(), arm()}; }

Problem Mechanism::problem(int rate) const {
    host::SceneDescription at_rate = scene;
    at_rate.step = {1, rate, 0};
    Problem problem = problem_of(at_rate);
    Motion before;
    for (std::size_t i = 0; i < scene.joints.size(); ++i) {
        const Motion start = start_of(problem.scene.bodies[i]);
        Joint& joint = problem.joints.emplace_back();
        joint.anchor = reference::vector_of(scene.joints[i].anchor);
        joint.axis = reference::vector_of(scene.joints[i].axis);
        joint.on_own = start.q.rotate_back(joint.anchor - start.x);
        joint.on_other = before.q.rotate_back(joint.anchor - before.x);
        joint.own_axis = start.q.rotate_back(joint.axis);
        joint.spin = start.w - start.q.rotate_back(before.q.rotate(before.w));
        before = start;
    }
    return problem;
}
double Mechanism::energy_scale() const {
    double all = 0;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) all += mass(i);
    return all * gravity * length;
}
double Mechanism::energy(const Motions& motions) const {
    Number sum = 0;
    for (std::size_t i = 0; i < motions.size(); ++i) {
        const Motion& now = motions[i];
        sum += mass(i) * (dot(now.v, now.v) / 2 + gravity * now.x.y) +
               dot(times(reference::vector_of(*scene.bodies[i].inertia), now.w), now.w) / 2;
    }
    return static_cast<double>(sum);
}
double gap(const std::vector<Joint>& joints, const Motions& motions) {
    Number largest = 0;
    Motion before;
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const Vector other = before.x + before.q.rotate(joints[i].on_other);
        largest = std::max(largest, norm(motions[i].x + motions[i].q.rotate(joints[i].on_own) - other));
        before = motions[i];
    }
    return static_cast<double>(largest);
}

}  // namespace tumble::bench
