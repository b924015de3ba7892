// What a method gets wrong, against the host's reference in long double, which shares no code with the kernel.
#pragma once

#include "scene/description.hpp"
#include "verdict/accuracy.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace tumble::bench {

// The true flight of a scene's bodies, step by step, until one first touches or the scene ends.
class Flight {
public:
    explicit Flight(const host::SceneDescription& scene);

    // The largest over all bodies and the steps of the flight, until the method itself has a body touch.
    struct Error {
        host::Errors largest;
        std::int64_t steps = 0;  // that were compared; fewer than the scene has where a contact has ended the flight
    };
    [[nodiscard]] Error error_of(const std::string& integrator, const std::string& numbers, bool carry) const;

private:
    const host::SceneDescription& scene_;
    std::vector<std::vector<reference::Motion>> after_step_;
};

using Quaternion = std::array<long double, 4>;  // w, x, y, z

// The true orientation of a scene's first body at 0, 1/samples, 2/samples, ... of its duration. For scenes without
// impulses whose forces last for the whole run; throws std::invalid_argument for others.
[[nodiscard]] std::vector<Quaternion> reference_orientations(const host::SceneDescription& scene, int samples);

// The angle between two orientations, rad.
[[nodiscard]] double angle_between_orientations(const Quaternion& a, const Quaternion& b);

}  // namespace tumble::bench
