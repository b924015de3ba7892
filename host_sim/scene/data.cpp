#include "scene/data.hpp"

#include <algorithm>
#include <string_view>

namespace tumble::host {
namespace {

RealVec3 vector_of(const Triple& v) { return {v[0], v[1], v[2]}; }
Real or_default(const std::optional<double>& value) { return value ? Real{*value} : Real{-1}; }

// The nearest double: what a header can say.
Real rounded(Real value) { return value.to_double(); }
InertiaTensor rounded(const InertiaTensor& i) {
    return {rounded(i.xx), rounded(i.yy), rounded(i.zz), rounded(i.xy), rounded(i.xz), rounded(i.yz)};
}

// The centre of mass is at `position` whatever the shape, a cloud of points included.
BodySpec body_of(const BodyDescription& body) {
    BodySpec spec;
    spec.shape = shape_of(body.shape);
    if (body.shape.kind == ShapeKind::points) {
        const PointCloud cloud = cloud_of(body.shape.points);
        spec.mass = rounded(cloud.mass);
        spec.inertia = rounded(cloud.inertia);
    } else {
        spec.mass = body.mass ? Real{*body.mass} : rounded(Real{body.density.value()} * volume_of(spec.shape));
        spec.inertia = inertia_of(spec.shape, spec.mass);
    }
    if (body.inertia) spec.inertia = tensor_of(*body.inertia);
    spec.position = vector_of(body.position);
    spec.velocity = vector_of(body.velocity);
    spec.orientation = {body.orientation[0], {body.orientation[1], body.orientation[2], body.orientation[3]}};
    spec.angular_velocity = vector_of(body.angular_velocity);
    spec.restitution = or_default(body.restitution);
    spec.friction = or_default(body.friction);
    spec.fixed = body.fixed;
    return spec;
}

Seconds step_of(const StepSize& step) {
    if (step.denominator == 0) return Seconds{Real{step.decimal}};
    return Seconds{Real::scaled(step.numerator, 0) / Real::scaled(step.denominator, 0)};
}

void check(const SceneDescription& scene) {
    const auto fits = [&](const char* key, std::size_t count, int room) {
        if (count > static_cast<std::size_t>(room))
            throw UnsupportedScene(scene.path + ": " + key + ": got " + std::to_string(count) + ", expected at most " +
                                   std::to_string(room));
    };
    fits("body", scene.bodies.size(), max_bodies);
    fits("plane", scene.planes.size(), max_planes);
    fits("spring", scene.springs.size(), max_springs);
}

// Contacts by springs know no sleep.
SleepSpec sleep_of(const ContactDescription& contact) {
    if (!contact.sleep || contact.response != ContactResponse::impulse) return {};
    return {true, contact.sleep->speed, contact.sleep->angular_speed, contact.sleep->time};
}

bool touches_bodies(const BodySpec& body) {
    return body.shape.kind == ShapeKind::sphere || body.shape.kind == ShapeKind::box;
}

}  // namespace

Shape shape_of(const ShapeDescription& shape) {
    return {shape.kind == ShapeKind::points ? ShapeKind::none : shape.kind, vector_of(shape.size)};
}

InertiaTensor tensor_of(const std::array<double, 6>& i) { return {i[0], i[1], i[2], i[3], i[4], i[5]}; }

PointCloud cloud_of(const std::vector<PointDescription>& points) {
    std::vector<PointMass> masses;
    for (const PointDescription& point : points) masses.push_back({vector_of(point.position), point.mass});
    return point_cloud(masses.data(), static_cast<int>(masses.size()));
}

SceneData build_scene(const SceneDescription& scene) {
    check(scene);
    SceneData data;
    data.name = scene.name;
    data.step = step_of(scene.step);
    data.steps = static_cast<std::uint32_t>(scene.steps());
    data.world.gravity = vector_of(scene.gravity);
    data.world.gravitation = scene.gravitation;
    data.world.linear_drag = scene.linear_drag;
    data.world.angular_drag = scene.angular_drag;
    const ContactDescription& contact = scene.contact;
    data.world.contact = {contact.response, contact.restitution, contact.restitution_threshold,
                          contact.friction, contact.tolerance,   contact.stiffness,
                          contact.damping,  contact.barrier,     sleep_of(contact)};
    for (const BodyDescription& body : scene.bodies) data.bodies.push_back(body_of(body));
    for (const PlaneDescription& plane : scene.planes) {
        if (contact.response != ContactResponse::none)
            data.planes.push_back(
                {vector_of(plane.normal), plane.offset, or_default(plane.restitution), or_default(plane.friction)});
    }
    for (const SpringDescription& s : scene.springs) {
        data.springs.push_back(
            {s.body, vector_of(s.point), s.to_body, vector_of(s.to), s.stiffness, s.damping, s.rest_length});
    }
    for (const ImpulseDescription& i : scene.impulses) {
        data.impulses.push_back(
            {i.time, i.body, i.frame, vector_of(i.impulse), vector_of(i.point), vector_of(i.angular_impulse)});
    }
    for (const ForceDescription& f : scene.forces) {
        data.forces.push_back(
            {f.body, f.from, f.until, f.frame, vector_of(f.force), vector_of(f.point), vector_of(f.torque)});
    }
    return data;
}

bool SceneData::drags() const { return world.linear_drag > Real{} || world.angular_drag > Real{}; }
bool SceneData::gravitates() const { return world.gravitation > Real{} && bodies.size() > 1; }
bool SceneData::has_pairs_in_touch() const {
    if (world.contact.response == ContactResponse::none) return false;
    const auto moves = [](const BodySpec& body) { return touches_bodies(body) && !body.fixed; };
    return std::count_if(bodies.begin(), bodies.end(), touches_bodies) > 1 &&
           std::any_of(bodies.begin(), bodies.end(), moves);
}
bool SceneData::has_boxes_in_touch() const {
    const auto is_box = [](const BodySpec& body) { return body.shape.kind == ShapeKind::box; };
    return touches(world.contact.response) && std::any_of(bodies.begin(), bodies.end(), is_box);
}
bool SceneData::has_cylinders_in_touch() const {
    const auto moves = [](const BodySpec& body) {
        const ShapeKind kind = body.shape.kind;
        return !body.fixed && (kind == ShapeKind::cylinder || kind == ShapeKind::capsule || kind == ShapeKind::hoop);
    };
    return !planes.empty() && std::any_of(bodies.begin(), bodies.end(), moves);
}
bool SceneData::rubs() const {
    const auto rough = [](const auto& side) { return side.friction > Real{}; };
    return has_contact_impulses() &&
           (world.contact.friction > Real{} || std::any_of(bodies.begin(), bodies.end(), rough) ||
            std::any_of(planes.begin(), planes.end(), rough));
}
bool SceneData::sleeps() const { return world.contact.sleep.on && world.contact.response == ContactResponse::impulse; }
bool SceneData::turns() const {
    return std::any_of(bodies.begin(), bodies.end(), [](const BodySpec& body) {
        const RealVec3& w = body.angular_velocity;
        return body.fixed && !(w.x.is_zero() && w.y.is_zero() && w.z.is_zero());
    });
}
bool SceneData::has_contact_springs() const { return touches(ContactResponse::spring); }
bool SceneData::has_contact_impulses() const { return touches(ContactResponse::impulse); }
// Planes are there only with a response.
bool SceneData::touches(ContactResponse response) const {
    return world.contact.response == response && (!planes.empty() || has_pairs_in_touch());
}

}  // namespace tumble::host
