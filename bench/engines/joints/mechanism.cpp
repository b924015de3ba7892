#include "mechanism.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace tumble::bench {

namespace {

using reference::Motion, reference::Number, reference::Rotation, reference::Vector;

// A box with this size along its axes, m.
Link box_link(double mass, Vector size, Vector centre, Rotation q, Vector anchor, Vector axis) {
    const auto moment = [&](Number a, Number b) { return mass / 12 * (a * a + b * b); };
    Link link{mass, {moment(size.y, size.z), moment(size.x, size.z), moment(size.x, size.y)}, {}, anchor, axis};
    link.start.x = centre;
    link.start.q = q;
    return link;
}
Rotation about_z(Number angle) { return reference::exponential(Vector{0, 0, angle}); }
// Along a rod that hangs at an angle.
Vector down_at(Number angle) { return {std::sin(angle), -std::cos(angle), 0}; }
// A rod whose upper end is at `from`.
Link rod(double mass, Vector size, Vector from, Number angle, Vector axis) {
    return box_link(mass, size, from + down_at(angle) * (size.y / 2), about_z(angle), from, axis);
}
Mechanism made(const std::string& name, double seconds, double length, std::vector<Link> links) {
    for (std::size_t i = 0; i < links.size(); ++i) {
        const auto from_centre = [&](Link& link, Vector anchor) {
            return link.start.q.rotate_back(anchor - link.start.x);
        };
        links[i].to_own = from_centre(links[i], links[i].anchor);
        if (i > 0) links[i - 1].to_next = from_centre(links[i - 1], links[i].anchor);
    }
    return {name, seconds, length, std::move(links)};
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
        links.push_back(spun(box_link(masses[i], size, at + along * 0.5L, {}, at, axes[i]), about_the_vertical));
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

double Mechanism::energy_scale() const {
    double mass = 0;
    for (const Link& link : links) mass += link.mass;
    return mass * gravity * length;
}
double Mechanism::energy(const std::vector<Motion>& motions) const {
    Number sum = 0;
    for (std::size_t i = 0; i < links.size(); ++i) {
        const Motion& now = motions[i];
        sum += links[i].mass * (dot(now.v, now.v) / 2 + gravity * now.x.y) +
               dot(times(links[i].moments, now.w), now.w) / 2;
    }
    return static_cast<double>(sum);
}
double Mechanism::gap(const std::vector<Motion>& motions) const {
    Number largest = 0;
    for (std::size_t i = 0; i < links.size(); ++i) {
        const Vector other =
            i == 0 ? links[0].anchor : motions[i - 1].x + motions[i - 1].q.rotate(links[i - 1].to_next);
        largest = std::max(largest, norm(motions[i].x + motions[i].q.rotate(links[i].to_own) - other));
    }
    return static_cast<double>(largest);
}
void Mechanism::set_velocities(std::vector<Motion>& motions, const std::vector<Vector>& turns) const {
    Vector anchor{}, spin{};  // the velocity of the joint, and the spin of the link before; world
    for (std::size_t i = 0; i < links.size(); ++i) {
        Motion& now = motions[i];
        spin = spin + now.q.rotate(turns[i]);
        now.w = now.q.rotate_back(spin);
        now.v = anchor - cross(spin, now.q.rotate(links[i].to_own));
        anchor = now.v + cross(spin, now.q.rotate(links[i].to_next));
    }
}

}  // namespace tumble::bench
