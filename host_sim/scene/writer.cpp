#include "scene/writer.hpp"

#include <string>

#include "scene/fields.hpp"
#include "scene/reader.hpp"
#include "scene/words.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

std::string frame_text(Frame of) { return toml_line("frame", of == Frame::body ? json_text("body") : ""); }

// Where a joint holds its sides, and its range.
std::string ends_text(const JointDescription& joint) {
    if (joint.kind != JointKind::distance)
        return toml_line("anchor", joint.anchor) +
               (joint.has_ends() ? toml_line("limits", std::array{joint.least, joint.most}) : "");
    return toml_line("point", joint.anchor) + toml_line("to_point", joint.to_point) +
           (joint.is_rod() ? toml_line("length", joint.most)
                           : toml_line("least", joint.least) + toml_line("most", joint.most));
}

std::string spring_text(const JointSpringDescription& spring, JointKind kind) {
    if (!spring.acts()) return "";
    const std::string rest = rest_key(kind);
    return "{ stiffness = " + in_toml(spring.stiffness) + ", damping = " + in_toml(spring.damping) +
           (spring.rest != 0 ? ", " + rest + " = " + in_toml(spring.rest) : "") + " }";
}

}  // namespace

std::string scene_text(const SceneDescription& scene) {
    const auto name_of = [&](int body) { return json_text(scene.body(body).name); };
    const std::string step =
        scene.step.denominator == 0 ? in_toml(scene.step.decimal) : json_text(step_text(scene.step));
    std::string text = toml_line("name", json_text(scene.name));
    text += "\n[world]\n" + toml_line("step", step) + toml_line("duration", scene.duration) +
            toml_fields<WorldSpec>(scene) + toml_line("softening", scene.softening) + toml_line("wind", scene.wind);
    if (const auto& gradient = scene.gravity_gradient)
        text += "\n[gravity_gradient]\n" + toml_line("orbit_rate", gradient->orbit_rate) +
                toml_line("to_centre", gradient->to_centre);
    // A range that is written is declared: it binds floating point too.
    if (scene.range.is_declared)
        text += "\n[range]\n" + toml_line("position", scene.range.position) +
                toml_line("velocity", scene.range.velocity) +
                toml_line("angular_velocity", scene.range.angular_velocity);
    text += "\n[contact]\n" + toml_fields<ContactSpec>(scene.contact);
    for (const PlaneDescription& p : scene.planes)
        text += "\n[[plane]]\n" + toml_line("name", json_text(p.name)) + toml_fields<PlaneSpec>(p);
    for (const BodyDescription& b : scene.bodies)
        text += "\n[[body]]\n" + toml_line("name", json_text(b.name)) + toml_fields<BodySpec>(b) +
                toml_line("density", b.density) + toml_line("linear_drag", b.linear_drag) +
                toml_line("quadratic_drag", b.quadratic_drag) +
                toml_line("wheel_momentum", b.is_point_mass() ? std::string() : in_toml(b.wheel_momentum));
    for (const SpringDescription& s : scene.springs)
        text += "\n[[spring]]\n" + toml_line("body", name_of(s.body)) + toml_line("point", s.point) +
                (s.to_body < 0 ? toml_line("to", s.to)
                               : toml_line("to_body", name_of(s.to_body)) + toml_line("to_point", s.to)) +
                toml_line("stiffness", s.stiffness) + toml_line("damping", s.damping) +
                toml_line("rest_length", s.rest_length);
    for (const JointDescription& j : scene.joints)
        text += "\n[[joint]]\n" + toml_line("name", json_text(j.name)) + toml_line("kind", json_text(word_of(j.kind))) +
                toml_line("body", name_of(j.body)) + (j.to_body < 0 ? "" : toml_line("to_body", name_of(j.to_body))) +
                ends_text(j) + (j.axis == Triple{} ? "" : toml_line("axis", j.axis)) +
                (j.to_axis == Triple{} ? "" : toml_line("to_axis", j.to_axis)) +
                toml_line("spring", spring_text(j.spring, j.kind)) +
                toml_line("to_spring", spring_text(j.to_spring, j.kind)) +
                (j.break_force > 0 ? toml_line("break_force", j.break_force) : "") +
                (j.break_torque > 0 ? toml_line("break_torque", j.break_torque) : "");
    for (const ImpulseDescription& impulse : scene.impulses) text += impulse_text(impulse, scene);
    for (const ForceDescription& f : scene.forces)
        text += "\n[[force]]\n" + toml_line("body", name_of(f.body)) + toml_line("from", f.from) +
                toml_line("until", f.until) + toml_line("force", f.force) + frame_text(f.frame) +
                toml_line("point", f.point) + toml_line("torque", f.torque);
    for (const EventDescription& event : scene.events) text += event_text(event, scene);
    if (scene.expected) text += expectation_text(*scene.expected);
    return text;
}

std::string impulse_text(const ImpulseDescription& impulse, const SceneDescription& scene) {
    return "\n[[impulse]]\n" + toml_line("time", impulse.time) +
           toml_line("body", json_text(scene.body(impulse.body).name)) + toml_line("impulse", impulse.impulse) +
           frame_text(impulse.frame) + toml_line("point", impulse.point) +
           (impulse.angular_impulse == Triple{} ? "" : toml_line("angular_impulse", impulse.angular_impulse));
}

std::string expectation_text(const Expectation& expected) {
    return "\n[expect]\n" + toml_line("integrator", json_text(expected.integrator)) +
           toml_line("numbers", json_text(expected.numbers)) +
           toml_line("carry", expected.carry ? std::string(*expected.carry ? "true" : "false") : "") +
           toml_line("steps", std::to_string(expected.steps)) + toml_line("tumble_bits", expected.bits) +
           toml_line("hash", json_text(hex(expected.hash)));
}

std::string event_text(const EventDescription& event, const SceneDescription& scene) {
    const std::string head =
        "\n[[event]]\n" + toml_line("time", event.time) + toml_line("kind", json_text(name_of(event.kind)));
    if (has_joint(event.kind))
        return head + toml_line("joint", json_text(scene.joints[static_cast<std::size_t>(event.joint)].name));
    return head + (has_body(event.kind) ? toml_line("body", json_text(scene.body(event.body).name)) : "") +
           toml_line("value", event.value) + frame_text(event.frame) +
           (event.point == Triple{} ? "" : toml_line("point", event.point)) +
           (event.kind == EventKind::pose && !scene.body(event.body).is_point_mass()
                ? toml_line("orientation", event.orientation)
                : "");
}

}  // namespace tumble::host
