// Mechanisms that every engine of the contest of joints builds: chains of bodies, each on a hinge or a ball joint of
// the one before, the first one on the world. Gravity is 9.81 m/s^2 along -y.
#pragma once

#include "contest.hpp"

namespace tumble::bench {

struct Mechanism {
    double length;  // m, when it is stretched
    // The duration is that of the run whose error is measured: a sixteenth of it is a number of steps of 1/64 s.
    host::SceneDescription scene;

    // With steps of 1 / `rate` s.
    [[nodiscard]] Problem problem(int rate) const;
    [[nodiscard]] double mass(std::size_t body) const { return scene.bodies[body].mass.value(); }  // kg
    // J: the energy in which changes are measured, m g l of its whole mass and length.
    [[nodiscard]] double energy_scale() const;
    [[nodiscard]] double energy(const Motions& motions) const;  // J
};

// m: the largest distance of the two anchors of a joint.
[[nodiscard]] double gap(const std::vector<Joint>& joints, const Motions& motions);

// A pendulum, a double pendulum, a chain of ten balls that circles, and an arm of six hinges that circles and falls.
[[nodiscard]] std::vector<Mechanism> mechanisms();
// A rod of 1 m and 1 kg on a hinge, let go at 2.5 rad from hanging; on a ball joint, at 1 rad and thrown sideways.
[[nodiscard]] Mechanism pendulum();
[[nodiscard]] Mechanism spherical_pendulum();

}  // namespace tumble::bench
