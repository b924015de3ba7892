// A run as an animated scene of glTF 2.0 (Khronos, "glTF 2.0 Specification"), for Blender and other viewers: one file
// with everything in it. Lengths are metres, times are seconds, and y points up as in the scene.
#pragma once

#include <string>
#include <vector>

#include "simulation/simulation.hpp"

namespace tumble::host {

class Gltf {
public:
    // `every`: steps between key frames.
    Gltf(const SceneDescription& scene, std::int64_t every)
        : scene_{scene}, every_{every}, poses_(scene.bodies.size()) {}
    // Call it before the first step and after each step. A state that is not finite is left out, and so is one whose
    // time a float does not tell from that of the key frame before.
    void sample(const Simulation& simulation, bool last);

    [[nodiscard]] std::string text() const;

private:
    struct Pose {
        std::array<float, 3> position;     // m, world
        std::array<float, 4> orientation;  // x, y, z, w, of unit length
    };
    const SceneDescription& scene_;
    std::int64_t every_;
    std::vector<float> times_;              // s, rising
    std::vector<std::vector<Pose>> poses_;  // of each body at each time
};

}  // namespace tumble::host
