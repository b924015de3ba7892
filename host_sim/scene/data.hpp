// The scene as the kernel takes it: the data of a Replay. Every number is a double, or made from doubles by the
// kernel's own constexpr functions, so a header that is written from it has exactly the same numbers.
#pragma once

#include <tumble/events/script.hpp>
#include <tumble/joints/list.hpp>
#include <tumble/loads/air.hpp>
#include <tumble/loads/gravity_gradient.hpp>
#include <tumble/loads/wheels.hpp>
#include <tumble/scene.hpp>

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "scene/description.hpp"

namespace tumble::host {

// The room of the host's worlds.
inline constexpr int max_bodies = 64;
inline constexpr int max_planes = 16;
inline constexpr int max_springs = 64;
inline constexpr int max_joints = 64;
inline constexpr int max_near_pairs = 512;

// A scene that is well formed but that this build cannot replay; what() names file, key and what was expected.
class UnsupportedScene : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// A joint of any kind, as a Replay takes it.
struct AnyJointSpec : std::variant<HingeSpec, BallSpec, FixedSpec, SliderSpec, UniversalSpec, DistanceSpec> {
    using variant::variant;
    // Calls f(spec).
    void visit(const auto& f) const { std::visit(f, static_cast<const variant&>(*this)); }
    void visit(const auto& f) { std::visit(f, static_cast<variant&>(*this)); }
};

// A joint with the fields that the kernel names. The description has both ends of a distance and limits under one name.
struct NamedJoint : JointDescription {
    Triple point = anchor;
    JointLimits limits{least, most};
};

struct SceneData {
    std::string name;
    Seconds step{1, 256};
    std::uint32_t steps = 0;
    WorldSpec world;
    std::vector<BodySpec> bodies;
    std::vector<PlaneSpec> planes;  // none without a contact response
    std::vector<SpringSpec> springs;
    std::vector<AnyJointSpec> joints;
    Real softening = 0;              // m, of gravitation
    RealVec3 wind{};                 // m/s, for the bodies of `drags`
    std::vector<DragSpec> drags;     // of the bodies that have one
    std::vector<WheelsSpec> wheels;  // of the bodies that have some
    OrbitSpec orbit;                 // for the gravity gradient
    std::vector<EventSpec> events;   // then those of impulses and forces
};

// Throws UnsupportedScene for what exceeds the host's capacities.
[[nodiscard]] SceneData build_scene(const SceneDescription& scene);

// The scene with its events in the order of the steps before which they act. Events of one step keep their order.
[[nodiscard]] SceneData with_events_in_order(SceneData scene);

// The features that a world must have for the scene, and no others.
[[nodiscard]] Features needs(const SceneData& scene);

// True if the kernel simulates contacts between the two kinds of shapes, in either order.
[[nodiscard]] bool shapes_meet(ShapeKind a, ShapeKind b);

// A joint in the kernel's numbers.
[[nodiscard]] AnyJointSpec joint_of(const JointDescription& joint);

// Calls f(field, value) with the fields that joints of its kind have, and their values in the description.
void for_each_field(const JointDescription& joint, auto&& f) {
    const NamedJoint named{joint};
    joint_of(joint).visit([&](const auto& spec) {
        spec.each([&](Field field, const auto&, const auto& value) { f(field, value); }, spec, named);
    });
}

// An event in the kernel's numbers.
[[nodiscard]] EventSpec event_of(const EventDescription& event);

// The kernel's shape. `points` become a body without a shape, which has the cloud's mass properties.
[[nodiscard]] Shape shape_of(const ShapeDescription& shape);

// The tensor of Ixx, Iyy, Izz, Ixy, Ixz, Iyz; and that of points, about their centre of mass.
[[nodiscard]] InertiaTensor tensor_of(const std::array<double, 6>& elements);
[[nodiscard]] PointCloud cloud_of(const std::vector<PointDescription>& points);

}  // namespace tumble::host
