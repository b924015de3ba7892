// Tables of loads: springs, impulses and forces.
#include <algorithm>

#include "scene/reading.hpp"

namespace tumble::host {
namespace {

constexpr Quantity newtons{Quantity::any, "N", "x, y, z"};
constexpr Quantity newton_metres{Quantity::any, "N m", "x, y, z"};
constexpr Quantity newton_seconds{Quantity::any, "N s", "x, y, z"};
constexpr Quantity newton_metre_seconds{Quantity::any, "N m s", "x, y, z"};

// A point mass has no axes, so the frame of its impulses and forces cannot be "body".
void refuse_body_frame(Table& table, Frame frame, const BodyDescription& body) {
    if (body.is_point_mass() && frame == Frame::body)
        table.at("frame").fail("body " + in_quotes(body.name) + " is a point mass, which has no axes of its own",
                               "\"world\" or no frame");
}

// Turns `face` and `strength` into an impulse at the centre of that face of a box, pushing inwards.
void push_face(Table& table, const std::pair<std::size_t, double>& face, double strength, const SceneDescription& scene,
               ImpulseDescription& impulse) {
    const ShapeDescription& shape = scene.body(impulse.body).shape;
    if (shape.kind != ShapeKind::box)
        table.at("face").fail("only a box has faces", "a body whose shape is a box, or impulse and point");
    for (const char* key : {"impulse", "point"})
        if (table.has(key))
            table.at(key).fail("given together with face", "either face and strength, or impulse and point");
    if (table.has("frame") && impulse.frame == Frame::world)
        table.at("frame").refuse("\"body\" or nothing: a face is pushed along the body's axes");
    const auto [axis, side] = face;
    impulse.frame = Frame::body;
    impulse.impulse[axis] = -side * strength;
    impulse.point[axis] = 0.5 * side * shape.size[axis];
}

}  // namespace

int resolve(Table& table, const std::string& key, const std::string& name, const SceneDescription& scene) {
    const auto& bodies = scene.bodies;
    const auto found =
        std::find_if(bodies.begin(), bodies.end(), [&](const BodyDescription& body) { return body.name == name; });
    if (found == bodies.end()) {
        std::vector<std::string> names;
        for (const BodyDescription& body : bodies) names.push_back(body.name);
        table.at(key).fail("got " + in_quotes(name) + suggestion(name, names), "the name of a body: " + listed(names));
    }
    return static_cast<int>(found - bodies.begin());
}

void check_time(Table& table, const std::string& key, double when, const SceneDescription& scene) {
    if (when > scene.duration)
        table.at(key).refuse("a time from 0 to the end of the run, " + shown(scene.duration) + " (s)");
}

SpringDescription read_spring(Table table, const SceneDescription& scene, RangeDescription& range) {
    SpringDescription spring;
    std::string body, to_body;
    Triple to_point{};
    table.required("body", body);
    table.required("stiffness", spring.stiffness, stiffness);
    read_fields<SpringSpec>(table, spring);
    const bool to_world = table.has("to");
    const bool to_other = table.optional("to_body", to_body);
    const bool has_to_point = table.optional("to_point", to_point, metres);
    table.finish();

    check_range(table, "point", spring.point, "position", range);
    check_range(table, "to", spring.to, "position", range);
    check_range(table, "to_point", to_point, "position", range);
    spring.body = resolve(table, "body", body, scene);
    refuse_to_turn(table, "point", spring.point, scene.body(spring.body));
    const std::string ends = "either to = [x, y, z] (m, a world point) or to_body = \"name\"";
    if (to_world && to_other) table.at("to_body").fail("to and to_body are both given", ends);
    if (!to_world && !to_other) table.fail("to", "missing", ends);
    if (has_to_point && !to_other)
        table.at("to_point").fail("given without to_body", "to_body = \"name\" beside it, or no to_point");
    if (to_other) {
        spring.to_body = resolve(table, "to_body", to_body, scene);
        spring.to = to_point;
        refuse_to_turn(table, "to_point", to_point, scene.body(spring.to_body));
        if (spring.to_body == spring.body)
            table.at("to_body").fail("got " + in_quotes(to_body) + ", the spring's own body", "another body");
    }
    return spring;
}

ImpulseDescription read_impulse(Table table, const SceneDescription& scene) {
    static const Words<std::pair<std::size_t, double>> faces{{"-x", {0, -1.0}}, {"+x", {0, 1.0}},  {"-y", {1, -1.0}},
                                                             {"+y", {1, 1.0}},  {"-z", {2, -1.0}}, {"+z", {2, 1.0}}};
    ImpulseDescription impulse;
    std::string body;
    std::pair<std::size_t, double> face;
    double strength = 0.0;
    table.required("time", impulse.time, seconds);
    table.required("body", body);
    const bool has_impulse = table.optional("impulse", impulse.impulse, newton_seconds);
    table.optional("frame", impulse.frame, words<Frame>);
    table.optional("point", impulse.point, metres);
    const bool has_face = table.optional("face", face, faces);
    const bool has_strength = table.optional("strength", strength, Quantity{Quantity::positive, "N s"});
    const bool has_angular = table.optional("angular_impulse", impulse.angular_impulse, newton_metre_seconds);
    table.finish();
    if (has_angular && !has_impulse && !has_face && table.has("point"))
        table.at("point").fail("given without impulse", "impulse = [x, y, z] (N s) beside it, or no point");

    impulse.body = resolve(table, "body", body, scene);
    check_time(table, "time", impulse.time, scene);
    refuse_to_turn(table, "point", impulse.point, scene.body(impulse.body));
    refuse_to_turn(table, "angular_impulse", impulse.angular_impulse, scene.body(impulse.body));
    refuse_body_frame(table, impulse.frame, scene.body(impulse.body));
    if (has_face) push_face(table, face, strength, scene, impulse);
    if (has_face && !has_strength)
        table.fail("strength", "missing", Quantity{Quantity::positive, "N s"}.expected() + " beside face");
    if (!has_face && has_strength)
        table.at("strength").fail("given without face", "face = " + listed(keys_of(faces)) + " beside it");
    if (!has_face && !has_impulse && !has_angular)
        table.fail("impulse", "missing",
                   "impulse = [x, y, z] (N s), face and strength (N s), or angular_impulse = [x, y, z] (N m s)");
    return impulse;
}

ForceDescription read_force(Table table, const SceneDescription& scene) {
    ForceDescription force;
    std::string body;
    table.required("body", body);
    table.optional("from", force.from, seconds);
    table.required("until", force.until, seconds);
    const bool has_force = table.optional("force", force.force, newtons);
    table.optional("frame", force.frame, words<Frame>);
    table.optional("point", force.point, metres);
    const bool has_torque = table.optional("torque", force.torque, newton_metres);
    table.finish();
    if (has_torque && !has_force && table.has("point"))
        table.at("point").fail("given without force", "force = [x, y, z] (N) beside it, or no point");

    force.body = resolve(table, "body", body, scene);
    refuse_to_turn(table, "point", force.point, scene.body(force.body));
    refuse_to_turn(table, "torque", force.torque, scene.body(force.body));
    refuse_body_frame(table, force.frame, scene.body(force.body));
    check_time(table, "from", force.from, scene);
    check_time(table, "until", force.until, scene);
    if (force.until <= force.from) table.at("until").refuse("a time after from = " + shown(force.from) + " (s)");
    if (!has_force && !has_torque) table.fail("force", "missing", "force = [x, y, z] (N) or torque = [x, y, z] (N m)");
    return force;
}

}  // namespace tumble::host
