#include "scene/writer.hpp"

#include <string>

#include "scene/fields.hpp"
#include "scene/reader.hpp"
#include "scene/words.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

std::string frame_text(Frame of) { return toml_line("frame", of == Frame::body ? json_text("body") : ""); }

// Values of a scene, with its bodies by their names.
struct InToml {
    const SceneDescription& scene;
    std::string operator()(int body) const { return body < 0 ? "" : json_text(scene.body(body).name); }
    std::string operator()(const auto& value) const { return in_toml(value); }
};

std::string spring_text(const SpringDescription& spring, const InToml& text_of) {
    std::string text = "\n[[spring]]\n";
    SpringSpec::each(
        [&](Field field, const auto& value) {
            const bool is_to_point = spring.to_body >= 0 && std::string_view{field.name} == "to";
            text += toml_line(is_to_point ? "to_point" : field.name, text_of(value));
        },
        spring);
    return text;
}

std::string spring_text(const JointSpringDescription& spring, JointKind kind) {
    if (!spring.acts()) return "";
    std::string text;
    JointSpring::each(
        [&](Field field, const double& number) {
            const bool is_rest = &number == &spring.rest;
            if (!is_rest || number != 0)
                text += (text.empty() ? "{ " : ", ") + std::string(is_rest ? rest_key(kind) : field.name) + " = " +
                        in_toml(number);
        },
        spring);
    return text + " }";
}

std::string joint_text(const JointDescription& joint, const InToml& text_of) {
    std::string text =
        "\n[[joint]]\n" + toml_line("name", json_text(joint.name)) + toml_line("kind", json_text(word_of(joint.kind)));
    for_each_field(joint, [&]<class T>(Field field, const T& value) {
        const std::string_view name = field.name;
        const bool is_rod_end = joint.is_rod() && (name == "least" || name == "most");
        if constexpr (std::is_same_v<T, JointSpringDescription>) {
            text += toml_line(field.name, spring_text(value, joint.kind));
        } else if constexpr (!std::is_same_v<T, double>) {
            text += toml_line(field.name, text_of(value));
        } else if (value != 0 && !(is_rod_end && name == "least")) {
            text += toml_line(is_rod_end ? "length" : field.name, value);
        }
    });
    return text;
}

}  // namespace

std::string scene_text(const SceneDescription& scene) {
    const InToml text_of{scene};
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
    for (const SpringDescription& spring : scene.springs) text += spring_text(spring, text_of);
    for (const JointDescription& joint : scene.joints) text += joint_text(joint, text_of);
    for (const ImpulseDescription& impulse : scene.impulses) text += impulse_text(impulse, scene);
    for (const ForceDescription& f : scene.forces)
        text += "\n[[force]]\n" + toml_line("body", text_of(f.body)) + toml_line("from", f.from) +
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
    const InToml text_of{scene};
    const EventDescription usual_event;
    std::string text = "\n[[event]]\n";
    EventSpec::each(
        [&]<class T>(Field field, const T& value, const T& usual) {
            const std::string_view name = field.name;
            const bool is_required = name == "time" || name == "kind" || (name == "value" && !has_joint(event.kind));
            if (is_required || value != usual) text += toml_line(field.name, text_of(value));
        },
        event, usual_event);
    if (!has_joint(event.kind)) return text;
    return text + toml_line("joint", json_text(scene.joints[static_cast<std::size_t>(event.joint)].name));
}

}  // namespace tumble::host
