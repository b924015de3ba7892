// What a method gets wrong, against an integration in long double that shares no code with the kernel.
#pragma once

#include "scene_description.hpp"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace tumble::bench {

struct FlightError {
    double position_m = 0, orientation_rad = 0;  // the largest over all steps of the flight
};

// The true flight of the first body of a scene, step by step, until it first touches a plane or the scene ends. For
// scenes of one box under gravity and scripted impulses; throws std::invalid_argument for others.
class Flight {
public:
    explicit Flight(const host::SceneDescription& scene);
    ~Flight();

    [[nodiscard]] FlightError error_of(const std::string& integrator, const std::string& numbers, bool carry) const;

private:
    struct Motions;
    const host::SceneDescription& scene_;
    std::unique_ptr<Motions> motions_;
};

using Quaternion = std::array<long double, 4>;  // w, x, y, z

// The true orientation of a scene's one body at 0, 1/samples, 2/samples, ... of its duration. For scenes whose only
// loads are gravity and forces at points that last for the whole run; throws std::invalid_argument for others.
[[nodiscard]] std::vector<Quaternion> reference_orientations(const host::SceneDescription& scene, int samples);

// The angle between two orientations, rad.
[[nodiscard]] double angle_between_orientations(const Quaternion& a, const Quaternion& b);

}  // namespace tumble::bench
