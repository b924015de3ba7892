#include "scene_text.hpp"

#include "scene/reader.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

// Keys and values of one table.
class Lines {
public:
    explicit Lines(const std::string& head) : text_(head + "\n") {}

    void add(const char* key, const std::string& value) { text_ += std::string(key) + " = " + value + "\n"; }
    void add(const char* key, double value) { add(key, cpp_number(value)); }
    void add(const char* key, const std::optional<double>& value) {
        if (value) add(key, *value);
    }
    template <std::size_t n>
    void add(const char* key, const std::array<double, n>& values) {
        add(key, list(values, n));
    }
    // The same, where it is not zero.
    void add_any(const char* key, double value) {
        if (value != 0.0) add(key, value);
    }
    void add_any(const char* key, const Triple& values) {
        if (values != Triple{}) add(key, values);
    }
    template <std::size_t n>
    [[nodiscard]] static std::string list(const std::array<double, n>& values, std::size_t count) {
        std::string text = "[";
        for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + cpp_number(values[i]);
        return text + "]";
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string text_;
};

std::string shape_text(const ShapeDescription& shape) {
    const auto of = [&](const char* key, std::size_t sizes) {
        return std::string("{ ") + key + " = " +
               (sizes == 1 ? cpp_number(shape.size[0]) : Lines::list(shape.size, sizes)) + " }";
    };
    switch (shape.kind) {
    case ShapeKind::box: return of("box", 3);
    case ShapeKind::sphere: return of("sphere", 1);
    case ShapeKind::cylinder: return of("cylinder", 2);
    case ShapeKind::hoop: return of("hoop", 1);
    case ShapeKind::capsule: return of("capsule", 2);
    default: return json_text("none");
    }
}

const char* response_text(ContactResponse response) {
    return response == ContactResponse::none ? "none" : response == ContactResponse::spring ? "spring" : "impulse";
}

}  // namespace

std::string scene_text(const SceneDescription& scene) {
    std::string text = "name = " + json_text(scene.name) + "\n";
    const auto finish = [&](const Lines& lines) { text += "\n" + lines.text(); };
    const auto name_of = [&](int body) { return json_text(scene.body(body).name); };

    Lines world("[world]");
    world.add("step", scene.step.denominator == 0 ? cpp_number(scene.step.decimal) : json_text(step_text(scene.step)));
    world.add("duration", scene.duration);
    world.add_any("gravity", scene.gravity);
    world.add_any("gravitation", scene.gravitation);
    world.add_any("linear_drag", scene.linear_drag);
    world.add_any("angular_drag", scene.angular_drag);
    finish(world);

    Lines range("[range]");
    range.add("position", scene.range.position);
    range.add("velocity", scene.range.velocity);
    range.add("angular_velocity", scene.range.angular_velocity);
    finish(range);

    const ContactDescription& c = scene.contact;
    Lines contact("[contact]");
    contact.add("response", json_text(response_text(c.response)));
    contact.add("restitution", c.restitution);
    contact.add("restitution_threshold", c.restitution_threshold);
    contact.add("friction", c.friction);
    contact.add("tolerance", c.tolerance);
    contact.add("stiffness", c.stiffness);
    contact.add("damping", c.damping);
    contact.add("barrier", c.barrier);
    if (c.sleep)
        contact.add("sleep", "{ speed = " + cpp_number(c.sleep->speed) + ", angular_speed = " +
                                 cpp_number(c.sleep->angular_speed) + ", time = " + cpp_number(c.sleep->time) + " }");
    finish(contact);

    for (const PlaneDescription& p : scene.planes) {
        Lines plane("[[plane]]");
        plane.add("name", json_text(p.name));
        plane.add("normal", p.normal);
        plane.add("offset", p.offset);
        plane.add("restitution", p.restitution);
        plane.add("friction", p.friction);
        finish(plane);
    }
    for (const BodyDescription& b : scene.bodies) {
        Lines body("[[body]]");
        body.add("name", json_text(b.name));
        body.add("shape", shape_text(b.shape));
        body.add("mass", b.mass);
        body.add("density", b.density);
        if (b.inertia) body.add("inertia", *b.inertia);
        body.add("position", b.position);
        body.add_any("velocity", b.velocity);
        if (b.orientation != Quadruple{1, 0, 0, 0}) body.add("orientation", b.orientation);
        body.add_any("angular_velocity", b.angular_velocity);
        body.add("restitution", b.restitution);
        body.add("friction", b.friction);
        if (b.fixed) body.add("fixed", "true");
        finish(body);
    }
    for (const SpringDescription& s : scene.springs) {
        Lines spring("[[spring]]");
        spring.add("body", name_of(s.body));
        spring.add_any("point", s.point);
        if (s.to_body >= 0) {
            spring.add("to_body", name_of(s.to_body));
            spring.add_any("to_point", s.to);
        } else {
            spring.add("to", s.to);
        }
        spring.add("stiffness", s.stiffness);
        spring.add_any("damping", s.damping);
        spring.add_any("rest_length", s.rest_length);
        finish(spring);
    }
    const auto frame = [](Lines& lines, Frame of) {
        if (of == Frame::body) lines.add("frame", json_text("body"));
    };
    for (const ImpulseDescription& i : scene.impulses) {
        Lines impulse("[[impulse]]");
        impulse.add("time", i.time);
        impulse.add("body", name_of(i.body));
        impulse.add("impulse", i.impulse);
        frame(impulse, i.frame);
        impulse.add_any("point", i.point);
        impulse.add_any("angular_impulse", i.angular_impulse);
        finish(impulse);
    }
    for (const ForceDescription& f : scene.forces) {
        Lines force("[[force]]");
        force.add("body", name_of(f.body));
        force.add("from", f.from);
        force.add("until", f.until);
        force.add("force", f.force);
        frame(force, f.frame);
        force.add_any("point", f.point);
        force.add_any("torque", f.torque);
        finish(force);
    }
    return text;
}

}  // namespace tumble::host
