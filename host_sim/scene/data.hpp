// The scene as the kernel takes it: the data of a Replay, with every number a double or made from doubles by the
// kernel's own constexpr functions, so that a header written from it says exactly the same.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/scene.hpp>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene/description.hpp"

namespace tumble::host {

// What the host's worlds have room for.
inline constexpr int max_bodies = 64;
inline constexpr int max_planes = 16;
inline constexpr int max_springs = 64;
inline constexpr int max_near_pairs = 512;

// A scene that is well formed but that this build cannot replay; what() names file, key and what was expected.
class UnsupportedScene : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

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
};

// Throws UnsupportedScene for what exceeds the host's capacities.
[[nodiscard]] SceneData build_scene(const SceneDescription& scene);

// With the events in the order of the steps in which they begin to act, which a world brings them into one by one;
// those of one step keep their order.
[[nodiscard]] SceneData with_events_in_order(SceneData scene);

// What a world must have compiled in for the scene, and nothing else.
[[nodiscard]] Features needs(const SceneData& scene);

// Which kinds of shapes touch each other in the kernel, in either order: what is not simulated is no contact.
[[nodiscard]] bool shapes_meet(ShapeKind a, ShapeKind b);

// The kernel's shape; `points` become a body without one, whose mass properties are the cloud's.
[[nodiscard]] Shape shape_of(const ShapeDescription& shape);

// Of Ixx, Iyy, Izz, Ixy, Ixz, Iyz; and of points, about their centre of mass.
[[nodiscard]] InertiaTensor tensor_of(const std::array<double, 6>& elements);
[[nodiscard]] PointCloud cloud_of(const std::vector<PointDescription>& points);

}  // namespace tumble::host
