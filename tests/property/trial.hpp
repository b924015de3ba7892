// Random scenes, and what each is run with. A trial follows from two numbers alone, on every machine: what is drawn are
// short decimals, made without functions whose last bit a library may choose.
#pragma once

#include <cstdint>
#include <string>

#include "scene/description.hpp"

namespace tumble::test {

// A scene, and the run of it that is held against one in double precision.
struct Trial {
    host::SceneDescription scene;
    std::string kind;  // of scene
    std::string integrator, numbers;
    bool carry = false;
};

// The farthest point of a body's shape from its centre, m; without a shape its radius of gyration, and 1 of a point
// mass.
[[nodiscard]] double reach(const host::BodyDescription& body);

[[nodiscard]] Trial draw_trial(std::uint64_t seed, std::uint64_t index);

}  // namespace tumble::test
