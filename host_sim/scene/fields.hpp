// What the host makes of the fields of a spec, by their list in the kernel. A field that is added to the list is handed
// to the kernel, written and compiled, and read by read_fields(). A value of a new type needs an overload of
// in_kernel(), in_toml() and in_cpp().
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "scene/data.hpp"
#include "scene/words.hpp"
#include "tools/text.hpp"

namespace tumble::host {

// Values of a description in the kernel's types. A number that is not given is -1.
inline Real in_kernel(double x) { return x; }
inline Real in_kernel(const std::optional<double>& x) { return x.value_or(-1); }
inline RealVec3 in_kernel(const Triple& v) { return {v[0], v[1], v[2]}; }
inline RealQuat in_kernel(const Quadruple& q) { return {q[0], {q[1], q[2], q[3]}}; }
inline Shape in_kernel(const ShapeDescription& shape) { return shape_of(shape); }
inline InertiaTensor in_kernel(const std::optional<std::array<double, 6>>& i) {
    return i ? tensor_of(*i) : InertiaTensor{};
}
inline std::uint16_t in_kernel(const std::optional<int>& layers) {
    return static_cast<std::uint16_t>(layers.value_or(BodySpec::all_layers));
}
inline SleepSpec in_kernel(const std::optional<SleepDescription>& sleep) {
    return sleep ? SleepSpec{true, sleep->speed, sleep->angular_speed, sleep->time} : SleepSpec{};
}
inline JointSpring in_kernel(const JointSpringDescription& spring) {
    return {spring.stiffness, spring.damping, spring.rest};
}
template <class T>
T in_kernel(const T& value) {
    return value;
}
// A response has its own values alone.
ContactSpec in_kernel(const ContactDescription& description);

// Sets all fields of a spec.
void set_fields(auto& spec, const auto& description) {
    spec.each([](Field, auto& to, const auto& from) { to = in_kernel(from); }, spec, description);
}
template <class Spec>
Spec spec_of(const auto& description) {
    Spec spec;
    set_fields(spec, description);
    return spec;
}

// Values of a description in a scene file; empty: no key.
inline std::string in_toml(double value) { return cpp_number(value); }
inline std::string in_toml(int value) { return value < 0 ? "" : std::to_string(value); }
inline std::string in_toml(bool value) { return value ? "true" : ""; }
template <std::size_t n>
std::string in_toml(const std::array<double, n>& values, std::size_t count = n) {
    std::string text = "[";
    for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + cpp_number(values[i]);
    return text + "]";
}
template <class T>
requires std::is_enum_v<T> std::string in_toml(T value) { return json_text(word_of(value)); }
inline std::string in_toml(const JointLimits& limits) {
    return limits.acts() ? in_toml(std::array{limits.least.to_double(), limits.most.to_double()}) : "";
}
inline std::string in_toml(const SleepDescription& sleep) {
    return "{ speed = " + in_toml(sleep.speed) + ", angular_speed = " + in_toml(sleep.angular_speed) +
           ", time = " + in_toml(sleep.time) + " }";
}
template <class T>
std::string in_toml(const std::optional<T>& value) {
    return value ? in_toml(*value) : "";
}
inline std::string in_toml(const ShapeDescription& shape) {
    if (shape.kind == ShapeKind::none) return json_text("none");
    const auto sizes = static_cast<std::size_t>(
        std::count_if(shape.size.begin(), shape.size.end(), [](double size) { return size > 0; }));
    std::string text = sizes == 1 ? in_toml(shape.size[0]) : in_toml(shape.size, sizes);
    if (shape.kind == ShapeKind::points) {
        text.clear();
        for (const auto& [p, mass] : shape.points)
            text += (text.empty() ? "[" : ", ") + in_toml(std::array{p[0], p[1], p[2], mass});
        text += "]";
    }
    return "{ " + word_of(shape.kind) + " = " + text + " }";
}
// A key and its value; nothing where there is none.
inline std::string toml_line(const char* key, const std::string& value) {
    return value.empty() ? "" : std::string(key) + " = " + value + "\n";
}
std::string toml_line(const char* key, const auto& value) { return toml_line(key, in_toml(value)); }
// The keys that are fields of a spec, but for bodies and for what has a table of its own.
template <class Spec>
std::string toml_fields(const auto& description) {
    std::string text;
    Spec::each(
        [&](Field field, const auto& value) {
            if constexpr (requires { in_toml(value); })
                if (field.kind != Field::body) text += toml_line(field.name, value);
        },
        description);
    return text;
}

// Values in C++.
inline std::string in_cpp(const Real& value) { return cpp_number(value.to_double()); }
inline std::string in_cpp(const RealVec3& v) {
    return "{" + in_cpp(v.x) + ", " + in_cpp(v.y) + ", " + in_cpp(v.z) + "}";
}
inline std::string in_cpp(const RealQuat& q) { return "{" + in_cpp(q.w) + ", " + in_cpp(q.v) + "}"; }
inline std::string in_cpp(bool value) { return value ? "true" : "false"; }
inline std::string in_cpp(int value) { return std::to_string(value); }
inline std::string in_cpp(EventKind value) { return std::string("tumble::EventKind::") + name_of(value); }
inline std::string in_cpp(Frame value) { return "tumble::Frame::" + word_of(value); }
inline std::string in_cpp(ContactResponse value) { return "tumble::ContactResponse::" + word_of(value); }
inline std::string in_cpp(Mixing value) {
    std::string name = word_of(value);
    std::replace(name.begin(), name.end(), ' ', '_');
    return "tumble::Mixing::" + name;
}
inline std::string in_cpp(const Shape& shape) {
    return "{tumble::ShapeKind::" + word_of(shape.kind) + ", " + in_cpp(shape.size) + "}";
}
inline std::string in_cpp(const InertiaTensor& i, const BodySpec& of) {
    if (i == inertia_of(of.shape, of.mass))
        return "tumble::inertia_of(" + in_cpp(of.shape) + ", " + in_cpp(of.mass) + ")";
    return "{" + in_cpp(i.xx) + ", " + in_cpp(i.yy) + ", " + in_cpp(i.zz) + ", " + in_cpp(i.xy) + ", " + in_cpp(i.xz) +
           ", " + in_cpp(i.yz) + "}";
}
std::string in_cpp(const auto& value, const auto&) { return in_cpp(value); }

// The unit of a field; that of an event's value is its kind's.
inline std::string unit_of(const Field& field, const auto&) { return field.unit; }
inline std::string unit_of(const Field& field, const EventSpec& event) {
    if (field.kind == Field::body) return has_joint(event.kind) ? "the joint" : "";
    if (std::string_view{field.name} != "value") return field.unit;
    switch (event.kind) {
    case EventKind::impulse: return "N s";
    case EventKind::angular_impulse: return "N m s";
    case EventKind::torque:
    case EventKind::step_torque:
    case EventKind::begin_torque:
    case EventKind::end_torque: return "N m";
    case EventKind::velocity: return "m/s";
    case EventKind::angular_velocity: return "rad/s";
    case EventKind::gravity: return "m/s^2";
    case EventKind::pose: return "m";
    default: return "N";
    }
}

// The fields of a spec that differ from their default, masses, kinds of events, and the bodies that it names.
template <class Spec>
std::string cpp_fields(const Spec& spec, const std::string& indent = "            ") {
    static const Spec usual_spec{};
    std::string text;
    Spec::each(
        [&]<class T>(Field field, const T& value, const T& usual) {
            const std::string name = indent + "." + field.name + " = ", deeper = indent + "    ";
            const bool is_mass = std::is_same_v<Spec, BodySpec> && field.kind == Field::positive;
            if constexpr (requires { T::each([](auto&&...) {}, value); }) {
                const std::string inner = cpp_fields(value, deeper);
                if (!inner.empty()) text += name + "{\n" + inner + indent + "},\n";
            } else if (field.kind == Field::body ? in_cpp(value, spec) != "-1"
                                                 : std::is_same_v<T, EventKind> || is_mass || !(value == usual)) {
                const std::string comment = std::is_same_v<T, RealQuat> ? "w, x, y, z" : unit_of(field, spec);
                text += name + in_cpp(value, spec) + "," + (comment.empty() ? "" : "   // " + comment) + "\n";
            }
        },
        spec, usual_spec);
    return text;
}

}  // namespace tumble::host
