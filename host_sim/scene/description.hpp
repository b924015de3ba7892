// The content of a scene file: SI units, the user's body axes, names of bodies as indices.
// The reader fills it and checks it; the builder turns it into a World; the compiler prints it as a firmware header.
// read_scene() has checked every value here by the rules of the format.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/events/script.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scene/error.hpp"
#include "scene/step_size.hpp"
#include "scene/words.hpp"

namespace tumble::host {

using Triple = std::array<double, 3>;     // x, y, z
using Quadruple = std::array<double, 4>;  // quaternion: w, x, y, z

struct PointDescription {
    Triple position{};  // m
    double mass = 0.0;  // kg
};

struct ShapeDescription {
    ShapeKind kind = ShapeKind::none;
    Triple size{};  // box: full edges; sphere: {radius}; cylinder: {radius, height}; hoop: {radius}; capsule: {radius,
                    // length}
    std::vector<PointDescription> points;  // kind == points only
};

struct BodyDescription {
    std::string name;
    ShapeDescription shape;
    std::optional<double> mass;     // kg; exactly one of mass and density, neither for `points`, whose sum it is
    std::optional<double> density;  // kg/m^3
    std::optional<std::array<double, 6>>
        inertia;  // Ixx, Iyy, Izz, Ixy, Ixz, Iyz; three given numbers leave the products 0
    bool inertia_is_diagonal = true;
    Triple position{}, velocity{};
    Quadruple orientation{1.0, 0.0, 0.0, 0.0};  // as written; not yet normalised
    Triple angular_velocity{};                  // body frame, user's axes
    std::optional<double> restitution, friction, rolling_resistance, spinning_resistance;
    double linear_drag = 0.0, quadratic_drag = 0.0;  // kg/s and kg/m, against the air
    Triple wheel_momentum{};                         // N m s, body frame, user's axes
    bool fixed = false;                              // nothing pushes it; true of a kinematic body too
    bool kinematic = false;                          // moves as its velocity says
    std::optional<int> layers{};                     // mask of 16 bits; none: see SceneDescription::layers_of()

    // True of a body without rotation.
    [[nodiscard]] bool is_point_mass() const { return shape.kind == ShapeKind::none && !inertia; }
};

struct PlaneDescription {
    std::string name;
    Triple normal{0.0, 1.0, 0.0};  // as written; not yet normalised
    double offset = 0.0;           // of the plane n.x + offset = 0 with n normalised
    std::optional<double> restitution{}, friction{}, rolling_resistance{}, spinning_resistance{};
};

struct SpringDescription {
    int body = 0;  // index into bodies
    Triple point{};
    int to_body = -1;  // -1: the world point `to`
    Triple to{};       // world point, or point in to_body's frame
    double stiffness = 0.0, damping = 0.0, rest_length = 0.0;
};

// A spring and a damper along a free direction of a joint.
struct JointSpringDescription {
    double stiffness = 0.0;  // N m/rad, of a slider and a distance N/m
    double damping = 0.0;    // N m s/rad, of a slider and a distance N s/m
    double rest = 0.0;       // rad or m from the start; of a distance its length, m

    [[nodiscard]] bool acts() const { return stiffness > 0.0 || damping > 0.0; }
};

struct JointDescription {
    std::string name;
    JointKind kind = JointKind::hinge;
    int body = 0;       // index into bodies
    int to_body = -1;   // -1: the world
    Triple anchor{};    // m, world, at the start; of a distance the point of `body`
    Triple to_point{};  // likewise; of a distance the point of `to_body`
    Triple axis{};      // world, at the start; as written, not yet normalised; of hinge, slider and universal
    Triple to_axis{};   // likewise; of universal
    double least = 0.0, most = 0.0;  // limits of a hinge, rad, or a slider, m, from the start, both 0: none; of a
                                     // distance its range, m
    JointSpringDescription spring{}, to_spring{};  // to_spring: of universal, about to_axis
    double break_force = 0.0, break_torque = 0.0;  // N and N m; 0: none breaks it

    [[nodiscard]] bool is_rod() const { return kind == JointKind::distance && least == most; }
    // Is it held at the ends of a range alone?
    [[nodiscard]] bool has_ends() const { return !is_rod() && (least != 0.0 || most != 0.0); }
    [[nodiscard]] bool may_break() const { return break_force > 0.0 || break_torque > 0.0; }
    // The point at which it holds a side, m, world, at the start.
    [[nodiscard]] const Triple& anchor_on(int side) const {
        return kind == JointKind::distance && side == to_body ? to_point : anchor;
    }
};

struct ImpulseDescription {
    double time = 0.0;
    int body = 0;
    Frame frame = Frame::world;
    Triple impulse{};          // N s, in `frame`
    Triple point{};            // body frame, user's axes
    Triple angular_impulse{};  // N m s, in `frame`
};  // `face`/`strength` is resolved by the reader: frame body, impulse inwards, point at the face's centre

struct ForceDescription {
    int body = 0;
    double from = 0.0, until = 0.0;  // s; acts while from <= t < until
    Frame frame = Frame::world;
    Triple force{};   // N, in `frame`
    Triple point{};   // body frame, user's axes
    Triple torque{};  // N m, in `frame`
};

struct EventDescription {
    double time = 0.0;  // s; of a live event: none
    EventKind kind = EventKind::impulse;
    int body = -1;                              // none of gravity and of a joint
    Frame frame = Frame::world;                 // of `value`
    Triple value{};                             // see EventKind
    Triple point{};                             // body frame, user's axes
    Quadruple orientation{1.0, 0.0, 0.0, 0.0};  // of a pose; normalised when applied
    int joint = -1;                             // of an event of a joint: index into joints
};

struct RangeDescription {
    double position = 1024.0, velocity = 128.0, angular_velocity = 64.0;
    bool is_declared = false;                    // the file has [range]
    std::optional<SceneError> beyond_default{};  // the file has none, and a number that these do not hold
};

struct SleepDescription {
    double speed = 0.03, angular_speed = 0.05, time = 0.5;
};

struct ContactDescription {
    ContactResponse response = ContactResponse::impulse;
    double restitution = 0.5, restitution_threshold = 0.0, friction = 0.0, rolling_resistance = 0.0,
           spinning_resistance = 0.0, tolerance = 0.001;
    Mixing restitution_mixing = Mixing::larger, friction_mixing = Mixing::geometric_mean;
    double stiffness = 10000.0, damping = 0.0, barrier = 0.0;
    int most_impacts = 0, most_searches = 0, most_sweeps = 0;  // 0: the usual bounds
    int exact_bodies = ContactSpec::few;
    std::optional<SleepDescription> sleep{};
};

struct GravityGradientDescription {
    double orbit_rate = 0.0;  // rad/s
    Triple to_centre{};       // world; as written, not yet normalised
};

// How a recorded run ended.
struct Expectation {
    std::string integrator, numbers;  // numbers: q32, f32 or f64
    std::optional<bool> carry{};      // none: the number system's default
    std::int64_t steps = 0;
    int bits = 0;  // TUMBLE_BITS
    std::uint64_t hash = 0;
};

struct SceneDescription {
    std::string name;
    std::string path;  // the file it came from, as given
    Triple gravity{};
    StepSize step;
    double duration = 0.0;  // s
    double gravitation = 0.0, linear_drag = 0.0, angular_drag = 0.0;
    double softening = 0.0;  // m, of gravitation
    Triple wind{};           // m/s
    std::optional<GravityGradientDescription> gravity_gradient;
    RangeDescription range;
    ContactDescription contact;
    std::vector<PlaneDescription> planes;
    std::vector<BodyDescription> bodies;
    std::vector<SpringDescription> springs;
    std::vector<JointDescription> joints;      // trees; no loops
    std::vector<ImpulseDescription> impulses;  // file order
    std::vector<ForceDescription> forces;
    std::vector<EventDescription> events;  // file order
    std::optional<Expectation> expected{};

    [[nodiscard]] const BodyDescription& body(int index) const { return bodies[static_cast<std::size_t>(index)]; }

    // True of a body that a joint ties.
    [[nodiscard]] bool is_jointed(int index) const {
        return std::any_of(joints.begin(), joints.end(),
                           [&](const auto& joint) { return joint.body == index || joint.to_body == index; });
    }

    // The layers of a body: those that it names, else all of them; of a jointed body that moves none, since such bodies
    // touch nothing yet.
    [[nodiscard]] int layers_of(int index) const {
        const BodyDescription& b = body(index);
        return b.layers ? *b.layers : is_jointed(index) && !b.fixed ? 0 : BodySpec::all_layers;
    }

    // False where all bodies are point masses: nothing can turn.
    [[nodiscard]] bool has_rotation() const {
        return bodies.empty() ||
               !std::all_of(bodies.begin(), bodies.end(), [](const auto& b) { return b.is_point_mass(); });
    }

    // The largest gravity that acts in the run, m/s^2.
    [[nodiscard]] double most_gravity() const {
        const auto size = [](const Triple& v) { return std::hypot(v[0], v[1], v[2]); };
        double most = size(gravity);
        for (const EventDescription& event : events)
            if (event.kind == EventKind::gravity) most = std::max(most, size(event.value));
        return most;
    }

    // Number of steps: the last step ends at or just after `duration`.
    [[nodiscard]] std::int64_t steps() const;
};

// Calls f(time) with each time at which something acts, begins or ends, s.
void for_each_time(auto& scene, auto&& f) {
    for (auto& impulse : scene.impulses) f(impulse.time);
    for (auto& force : scene.forces) {
        f(force.from);
        f(force.until);
    }
    for (auto& event : scene.events) f(event.time);
}

}  // namespace tumble::host
