// The scene as the kernel takes it: the data of a Replay, with every number a double or made from doubles by the
// kernel's own constexpr functions, so that a header written from it says exactly the same.
#pragma once

#include <tumble/scene.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "scene_description.hpp"

namespace tumble::host {

struct SceneData {
    std::string name;
    Seconds step{1, 256};
    std::uint32_t steps = 0;
    WorldSpec world;
    std::vector<BodySpec> bodies;
    std::vector<PlaneSpec> planes;  // none without a contact response
    std::vector<SpringSpec> springs;
    std::vector<ImpulseSpec> impulses;
    std::vector<ForceSpec> forces;

    // Features that the scene needs, as in a minimal tumble::Scene.
    [[nodiscard]] bool drags() const;
    [[nodiscard]] bool gravitates() const;
    [[nodiscard]] bool has_boxes_in_touch() const;
    [[nodiscard]] bool rubs() const;
};

// Throws UnsupportedScene for what no kernel can replay yet, and for what exceeds the host's capacities.
[[nodiscard]] SceneData build_scene(const SceneDescription& scene);

// The kernel's shape; `points` become a body without one, whose mass properties are the cloud's.
[[nodiscard]] Shape shape_of(const ShapeDescription& shape);

}  // namespace tumble::host
