// Mechanisms that every engine of the contest of joints builds: chains of bodies, each on a hinge or a ball joint of
// the one before, the first one on the world. Gravity is 9.81 m/s^2 along -y.
#pragma once

#include <string>
#include <vector>

#include "truth/motion.hpp"

namespace tumble::bench {

inline constexpr double gravity = 9.81;  // m/s^2

struct Link {
    double mass = 0;              // kg
    reference::Vector moments;    // kg m^2, about the axes of the body
    reference::Motion start;      // the frame is at the centre of mass, along the principal axes
    reference::Vector anchor;     // m, world, at the start: the joint with the link before
    reference::Vector axis{};     // of a hinge, world, at the start, of unit length; zero: a ball joint
    reference::Vector to_own{};   // m, from the centre of mass to that joint, in its own axes
    reference::Vector to_next{};  // to the joint with the next link

    [[nodiscard]] bool is_hinge() const { return dot(axis, axis) > 0; }
    [[nodiscard]] reference::Vector own_axis() const { return start.q.rotate_back(axis); }
};

struct Mechanism {
    std::string name;
    double seconds;  // of the run whose error is measured: a sixteenth of it is a number of steps of 1/64 s
    double length;   // m, of the mechanism when it is stretched
    std::vector<Link> links;

    // J: the energy in which changes are measured, m g l of its whole mass and length.
    [[nodiscard]] double energy_scale() const;
    [[nodiscard]] double energy(const std::vector<reference::Motion>& motions) const;  // J
    // m: the largest distance of the two anchors of a joint.
    [[nodiscard]] double gap(const std::vector<reference::Motion>& motions) const;
    // Sets the velocities from the poses and from what each joint turns at, rad/s in the axes of its link.
    void set_velocities(std::vector<reference::Motion>& motions, const std::vector<reference::Vector>& turns) const;
};

// A pendulum, a double pendulum, a chain of ten balls that circles, and an arm of six hinges that circles and falls.
[[nodiscard]] std::vector<Mechanism> mechanisms();
// A rod of 1 m and 1 kg on a hinge, let go at 2.5 rad from hanging; on a ball joint, at 1 rad and thrown sideways.
[[nodiscard]] Mechanism pendulum();
[[nodiscard]] Mechanism spherical_pendulum();

}  // namespace tumble::bench
