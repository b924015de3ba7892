#include "scene/writer.hpp"

#include <optional>
#include <string>

#include "scene/reader.hpp"
#include "scene/words.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

std::string text_of(double value) { return cpp_number(value); }
std::string text_of(int value) { return std::to_string(value); }
std::string text_of(const std::optional<double>& value) { return value ? cpp_number(*value) : ""; }
template <std::size_t n>
std::string text_of(const std::array<double, n>& values, std::size_t count = n) {
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + cpp_number(values[i]);
    return text + "]";
}
// A key and its value; nothing where there is none.
std::string line(const char* key, const std::string& value) {
    return value.empty() ? "" : std::string(key) + " = " + value + "\n";
}
std::string line(const char* key, const auto& value) { return line(key, text_of(value)); }

std::string frame_text(Frame of) { return line("frame", of == Frame::body ? json_text("body") : ""); }

std::string shape_text(const ShapeDescription& shape) {
    switch (shape.kind) {
    case ShapeKind::box: return "{ box = " + text_of(shape.size) + " }";
    case ShapeKind::sphere: return "{ sphere = " + text_of(shape.size[0]) + " }";
    case ShapeKind::cylinder: return "{ cylinder = " + text_of(shape.size, 2) + " }";
    case ShapeKind::hoop: return "{ hoop = " + text_of(shape.size[0]) + " }";
    case ShapeKind::capsule: return "{ capsule = " + text_of(shape.size, 2) + " }";
    case ShapeKind::points: {
        std::string points;
        for (const auto& [p, mass] : shape.points)
            points += (points.empty() ? "" : ", ") + text_of(std::array{p[0], p[1], p[2], mass});
        return "{ points = [" + points + "] }";
    }
    default: return json_text("none");
    }
}

std::string contact_text(const ContactDescription& c) {
    std::string sleep;
    if (c.sleep)
        sleep = "{ speed = " + text_of(c.sleep->speed) + ", angular_speed = " + text_of(c.sleep->angular_speed) +
                ", time = " + text_of(c.sleep->time) + " }";
    return "\n[contact]\n" + line("response", json_text(word_of(responses, c.response))) +
           line("restitution", c.restitution) + line("restitution_threshold", c.restitution_threshold) +
           line("friction", c.friction) + line("rolling_resistance", c.rolling_resistance) +
           line("spinning_resistance", c.spinning_resistance) +
           line("restitution_mixing", json_text(word_of(mixings, c.restitution_mixing))) +
           line("friction_mixing", json_text(word_of(mixings, c.friction_mixing))) + line("tolerance", c.tolerance) +
           line("stiffness", c.stiffness) + line("damping", c.damping) + line("barrier", c.barrier) +
           line("most_impacts", c.most_impacts) + line("most_searches", c.most_searches) +
           line("most_sweeps", c.most_sweeps) +
           (c.exact_bodies == ContactSpec::few ? std::string() : line("exact_bodies", c.exact_bodies)) +
           line("sleep", sleep);
}

// Where a joint holds its sides, and its range.
std::string ends_text(const JointDescription& joint) {
    if (joint.kind != JointKind::distance)
        return line("anchor", joint.anchor) +
               (joint.has_ends() ? line("limits", std::array{joint.least, joint.most}) : "");
    return line("point", joint.anchor) + line("to_point", joint.to_point) +
           (joint.is_rod() ? line("length", joint.most) : line("least", joint.least) + line("most", joint.most));
}

std::string spring_text(const JointSpringDescription& spring, JointKind kind) {
    if (!spring.acts()) return "";
    const std::string rest = rest_key(kind);
    return "{ stiffness = " + text_of(spring.stiffness) + ", damping = " + text_of(spring.damping) +
           (spring.rest != 0 ? ", " + rest + " = " + text_of(spring.rest) : "") + " }";
}

}  // namespace

std::string scene_text(const SceneDescription& scene) {
    const auto name_of = [&](int body) { return json_text(scene.body(body).name); };
    const std::string step =
        scene.step.denominator == 0 ? text_of(scene.step.decimal) : json_text(step_text(scene.step));
    std::string text = line("name", json_text(scene.name));
    text += "\n[world]\n" + line("step", step) + line("duration", scene.duration) + line("gravity", scene.gravity) +
            line("gravitation", scene.gravitation) + line("softening", scene.softening) +
            line("linear_drag", scene.linear_drag) + line("angular_drag", scene.angular_drag) +
            line("wind", scene.wind);
    if (const auto& gradient = scene.gravity_gradient)
        text += "\n[gravity_gradient]\n" + line("orbit_rate", gradient->orbit_rate) +
                line("to_centre", gradient->to_centre);
    // A range that is written is declared: it binds floating point too.
    if (scene.range.is_declared)
        text += "\n[range]\n" + line("position", scene.range.position) + line("velocity", scene.range.velocity) +
                line("angular_velocity", scene.range.angular_velocity);
    text += contact_text(scene.contact);
    for (const PlaneDescription& p : scene.planes)
        text += "\n[[plane]]\n" + line("name", json_text(p.name)) + line("normal", p.normal) +
                line("offset", p.offset) + line("restitution", p.restitution) + line("friction", p.friction) +
                line("rolling_resistance", p.rolling_resistance) + line("spinning_resistance", p.spinning_resistance);
    for (const BodyDescription& b : scene.bodies)
        text += "\n[[body]]\n" + line("name", json_text(b.name)) + line("shape", shape_text(b.shape)) +
                line("mass", b.mass) + line("density", b.density) +
                line("inertia", b.inertia ? text_of(*b.inertia) : "") + line("position", b.position) +
                line("velocity", b.velocity) + line("orientation", b.orientation) +
                line("angular_velocity", b.angular_velocity) + line("restitution", b.restitution) +
                line("friction", b.friction) + line("rolling_resistance", b.rolling_resistance) +
                line("spinning_resistance", b.spinning_resistance) + line("linear_drag", b.linear_drag) +
                line("quadratic_drag", b.quadratic_drag) +
                line("wheel_momentum", b.is_point_mass() ? std::string() : text_of(b.wheel_momentum)) +
                line("fixed", b.fixed && !b.kinematic ? std::string("true") : "") +
                line("kinematic", b.kinematic ? std::string("true") : "") +
                line("layers", b.layers ? std::to_string(*b.layers) : "");
    for (const SpringDescription& s : scene.springs)
        text += "\n[[spring]]\n" + line("body", name_of(s.body)) + line("point", s.point) +
                (s.to_body < 0 ? line("to", s.to) : line("to_body", name_of(s.to_body)) + line("to_point", s.to)) +
                line("stiffness", s.stiffness) + line("damping", s.damping) + line("rest_length", s.rest_length);
    for (const JointDescription& j : scene.joints)
        text += "\n[[joint]]\n" + line("name", json_text(j.name)) +
                line("kind", json_text(word_of(joint_kinds, j.kind))) + line("body", name_of(j.body)) +
                (j.to_body < 0 ? "" : line("to_body", name_of(j.to_body))) + ends_text(j) +
                (j.axis == Triple{} ? "" : line("axis", j.axis)) +
                (j.to_axis == Triple{} ? "" : line("to_axis", j.to_axis)) +
                line("spring", spring_text(j.spring, j.kind)) + line("to_spring", spring_text(j.to_spring, j.kind)) +
                (j.break_force > 0 ? line("break_force", j.break_force) : "") +
                (j.break_torque > 0 ? line("break_torque", j.break_torque) : "");
    for (const ImpulseDescription& impulse : scene.impulses) text += impulse_text(impulse, scene);
    for (const ForceDescription& f : scene.forces)
        text += "\n[[force]]\n" + line("body", name_of(f.body)) + line("from", f.from) + line("until", f.until) +
                line("force", f.force) + frame_text(f.frame) + line("point", f.point) + line("torque", f.torque);
    for (const EventDescription& event : scene.events) text += event_text(event, scene);
    if (scene.expected) text += expectation_text(*scene.expected);
    return text;
}

std::string impulse_text(const ImpulseDescription& impulse, const SceneDescription& scene) {
    return "\n[[impulse]]\n" + line("time", impulse.time) + line("body", json_text(scene.body(impulse.body).name)) +
           line("impulse", impulse.impulse) + frame_text(impulse.frame) + line("point", impulse.point) +
           (impulse.angular_impulse == Triple{} ? "" : line("angular_impulse", impulse.angular_impulse));
}

std::string expectation_text(const Expectation& expected) {
    return "\n[expect]\n" + line("integrator", json_text(expected.integrator)) +
           line("numbers", json_text(expected.numbers)) +
           line("carry", expected.carry ? std::string(*expected.carry ? "true" : "false") : "") +
           line("steps", std::to_string(expected.steps)) + line("tumble_bits", expected.bits) +
           line("hash", json_text(hex(expected.hash)));
}

std::string event_text(const EventDescription& event, const SceneDescription& scene) {
    const std::string head = "\n[[event]]\n" + line("time", event.time) + line("kind", json_text(name_of(event.kind)));
    if (has_joint(event.kind))
        return head + line("joint", json_text(scene.joints[static_cast<std::size_t>(event.joint)].name));
    return head + (has_body(event.kind) ? line("body", json_text(scene.body(event.body).name)) : "") +
           line("value", event.value) + frame_text(event.frame) +
           (event.point == Triple{} ? "" : line("point", event.point)) +
           (event.kind == EventKind::pose && !scene.body(event.body).is_point_mass()
                ? line("orientation", event.orientation)
                : "");
}

}  // namespace tumble::host
