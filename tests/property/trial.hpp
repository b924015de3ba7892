// Random scenes, and the method and the number system in which each is run. A trial follows from two numbers alone, on
// every machine: no function is used whose last bit depends on a library.
#pragma once

#include <cstdint>
#include <string>

#include "scene/numbers.hpp"
#include "scene/writer.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::test {

using host::for_each_number, host::Measure, host::scene_text;

struct Trial {
    host::SceneDescription scene;
    std::string kind;  // of scene
    host::Method method;
    std::uint64_t index = 0;  // of a random scene
};

// The distance of the farthest point of a body's shape from its centre, m; without a shape its radius of gyration, and
// 1 for a point mass.
[[nodiscard]] double reach(const host::BodyDescription& body);

// `has_joints`: of bodies on joints. The others have none.
[[nodiscard]] Trial draw_trial(std::uint64_t seed, std::uint64_t index, bool has_joints);

}  // namespace tumble::test
