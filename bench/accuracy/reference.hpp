// Errors of a method against the host's reference in long double, which shares no code with the kernel.
#pragma once

#include "scene/description.hpp"
#include "verdict/accuracy.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tumble::bench {

// The true flight of a scene's bodies, step by step, until the first contact or the end of the scene.
class Flight {
public:
    explicit Flight(const host::SceneDescription& scene);

    // The largest error of all bodies in the flight, until the first contact of the method's own run.
    struct Error {
        host::Errors largest;
        std::int64_t steps = 0;  // compared; fewer than the scene has if a contact ended the flight
    };
    [[nodiscard]] Error error_of(const std::string& integrator, const std::string& numbers, bool carry) const;

private:
    const host::SceneDescription& scene_;
    std::vector<std::vector<reference::Motion>> after_step_;
};

using Quaternion = std::array<long double, 4>;  // w, x, y, z

// The true orientation of a scene's first body at 0, 1/samples, 2/samples, ... of its duration. The scene has no
// impulses, and its forces last for the whole run; throws std::invalid_argument otherwise.
[[nodiscard]] std::vector<Quaternion> reference_orientations(const host::SceneDescription& scene, int samples);

// The angle between two orientations, rad.
[[nodiscard]] double angle_between_orientations(const Quaternion& a, const Quaternion& b);

}  // namespace tumble::bench
