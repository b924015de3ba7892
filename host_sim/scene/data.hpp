// The scene as the kernel takes it: the data of a Replay, with every number a double or made from doubles by the
// kernel's own constexpr functions, so that a header written from it says exactly the same.
#pragma once

#include <tumble/body/setup.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "scene/description.hpp"

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
    [[nodiscard]] bool has_pairs_in_touch() const;      // bodies that may touch each other
    [[nodiscard]] bool has_boxes_in_touch() const;      // that may touch planes or bodies
    [[nodiscard]] bool has_cylinders_in_touch() const;  // cylinders, capsules and hoops, that may touch planes
    [[nodiscard]] bool rubs() const;
    [[nodiscard]] bool sleeps() const;
    [[nodiscard]] bool turns() const;  // a fixed body does
    [[nodiscard]] bool has_contact_springs() const;
    [[nodiscard]] bool has_contact_impulses() const;

private:
    [[nodiscard]] bool touches(tumble::ContactResponse response) const;
};

// Throws UnsupportedScene for what exceeds the host's capacities.
[[nodiscard]] SceneData build_scene(const SceneDescription& scene);

// The kernel's shape; `points` become a body without one, whose mass properties are the cloud's.
[[nodiscard]] Shape shape_of(const ShapeDescription& shape);

}  // namespace tumble::host
