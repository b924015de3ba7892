// Tables of joints.
#include <tumble/joints/universal.hpp>
#include <tumble/shapes/pairs.hpp>

#include <algorithm>
#include <cmath>

#include "scene/data.hpp"
#include "scene/reading.hpp"

namespace tumble::host {
namespace {

// m, from the centre of mass of a body: what fixed point holds, less the rounding of a position.
constexpr double longest_arm = 4096 * (1 - 1e-6);

// What a kind's axis is for; empty: the kind has none. `instead`: why it has none.
struct KindRow {
    const char* axis;
    const char* instead;
};
const KindRow& row_of(JointKind kind) {
    static constexpr KindRow hinge{"a hinge turns about it", ""}, ball{"", "a ball turns about any axis"},
        fixed{"", "a fixed joint has no free direction"}, slider{"a slider moves along it", ""},
        universal{"a universal joint turns about it, and about to_axis", ""};
    switch (kind) {
    case JointKind::ball: return ball;
    case JointKind::fixed: return fixed;
    case JointKind::slider: return slider;
    case JointKind::universal: return universal;
    default: return hinge;
    }
}

// Words of other programs, and what they are called here.
constexpr std::pair<std::string_view, const char*> other_kinds[] = {
    {"revolute", "a revolute joint is a hinge"},
    {"pin", "a pin joint is a hinge"},
    {"prismatic", "a prismatic joint is a slider"},
    {"spherical", "a spherical joint is a ball"},
    {"socket", "a ball and its socket are a ball"},
    {"weld", "a weld is a fixed joint"},
    {"cardan", "a cardan joint is a universal joint"},
    {"rope", "there is no rope yet, and a stiff [[spring]] is the nearest to one"},
    {"distance", "there is no rod yet, and a stiff [[spring]] is the nearest to one"},
};

JointKind read_kind(const Value& value) {
    const std::vector<std::string> names = keys_of(joint_kinds);
    const std::string& text = value.text(listed(names));
    for (const auto& [word, kind] : joint_kinds)
        if (word == text) return kind;
    const auto* const other = std::find_if(std::begin(other_kinds), std::end(other_kinds),
                                           [&](const auto& pair) { return pair.first == text; });
    if (other != std::end(other_kinds)) value.fail("got " + in_quotes(text), listed(names) + "; " + other->second);
    value.fail("got " + in_quotes(text) + suggestion(text, names), listed(names));
}

// Axes that the kind has are required and not zero; those that it has not are refused.
void read_axis(Table& table, const char* key, Triple& axis, bool has_axis, const std::string& why) {
    constexpr Quantity direction{Quantity::any, "", "x, y, z"};
    const std::string wanted = "a direction [x, y, z] that is not zero: " + why;
    const auto value = table.find(key);
    if (!has_axis) return;
    if (!value) return table.missing(key, wanted);
    convert(*value, axis, direction);
    check_not_zero(*value, axis.data(), axis.size(), wanted);
}

// Fixed bodies and the world are one.
constexpr int base = -1;
int node_of(const SceneDescription& scene, int body) { return body < 0 || scene.body(body).fixed ? base : body; }

std::string side_name(const SceneDescription& scene, int body) {
    return body < 0 ? "the world" : in_quotes(scene.body(body).name);
}

// The chain of joints from one node to another; empty where there is none. Joints of a scene form trees.
std::vector<const JointDescription*> chain(const SceneDescription& scene, int from, int to,
                                           const JointDescription* last = nullptr) {
    for (const JointDescription& joint : scene.joints) {
        if (&joint == last) continue;
        const int a = node_of(scene, joint.body), b = node_of(scene, joint.to_body);
        if (a != from && b != from) continue;
        const int next = a == from ? b : a;
        std::vector<const JointDescription*> rest;
        if (next != to) rest = chain(scene, next, to, &joint);
        if (next != to && rest.empty()) continue;
        rest.insert(rest.begin(), &joint);
        return rest;
    }
    return {};
}

// "a", "b" and the world: each once.
std::string joined_sides(const SceneDescription& scene, const std::vector<int>& sides) {
    std::vector<std::string> names;
    for (const int side : sides) {
        const std::string name = side_name(scene, side);
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
    return text;
}

void refuse_loop(Table& table, const JointDescription& joint, const SceneDescription& scene) {
    const auto path = chain(scene, node_of(scene, joint.body), node_of(scene, joint.to_body));
    if (path.empty()) return;
    const std::string tree = "joints that form trees: loops are not simulated yet";
    std::vector<int> sides{joint.body};
    for (const JointDescription* other : path) {
        const bool is_forward = node_of(scene, other->body) == node_of(scene, sides.back());
        sides.push_back(is_forward ? other->body : other->to_body);
        sides.push_back(is_forward ? other->to_body : other->body);
    }
    sides.push_back(joint.to_body);
    const std::string names = joined_sides(scene, sides);
    if (path.size() == 1 && std::minmax(joint.body, joint.to_body) == std::minmax(path[0]->body, path[0]->to_body))
        table.at("body").fail(names + " are tied by joint " + in_quotes(path[0]->name) + " already", tree);
    table.at("body").fail(names + " close a loop", tree);
}

void check_sides(Table& table, const JointDescription& joint, const SceneDescription& scene) {
    for (const int side : {joint.body, joint.to_body}) {
        if (side < 0) continue;
        const char* const key = side == joint.body ? "body" : "to_body";
        const BodyDescription& body = scene.body(side);
        if (body.kinematic || (body.fixed && body.angular_velocity != Triple{}))
            table.at(key).fail("body " + in_quotes(body.name) + (body.kinematic ? " is kinematic" : " is a turntable"),
                               "a body that does not move by itself");
        if (body.is_point_mass())
            table.at(key).fail("body " + in_quotes(body.name) + " is a point mass, which has no rotation",
                               "a body with a shape or inertia = [...] (kg m^2)");
    }
    if (node_of(scene, joint.body) != base || node_of(scene, joint.to_body) != base) return;
    const std::string name = side_name(scene, joint.body);
    if (joint.to_body < 0) table.at("body").fail(name + " is fixed, and so is the world", "a body that moves");
    table.at("body").fail(name + " and " + side_name(scene, joint.to_body) + " are both fixed", "a body that moves");
}

void check_perpendicular(Table& table, const JointDescription& joint) {
    const auto vector = [](const Triple& v) { return RealVec3{v[0], v[1], v[2]}; };
    const UniversalSpec spec{.axis = vector(joint.axis), .to_axis = vector(joint.to_axis)};
    if (joints::Universal::fault_of(spec) == JointFault::none) return;
    constexpr double degrees = 180 / 3.14159265358979323846;
    const double angle =
        std::acos(std::clamp(dot(normalized(spec.axis), normalized(spec.to_axis)).to_double(), -1.0, 1.0));
    table.at("to_axis").fail("it is " + few_digits(angle * degrees) + " degrees from axis",
                             "a direction perpendicular to axis, to 2^-10 rad");
}

// Fixed point refuses the scene with it, as with a number that it does not hold.
void check_arms(Table& table, const JointDescription& joint, const SceneDescription& scene, RangeDescription& range) {
    for (const int side : {joint.body, joint.to_body}) {
        if (side < 0) continue;
        const BodyDescription& body = scene.body(side);
        const double arm = std::hypot(joint.anchor[0] - body.position[0], joint.anchor[1] - body.position[1],
                                      joint.anchor[2] - body.position[2]);
        if (arm > longest_arm && !range.beyond_default)
            range.beyond_default = table.at("anchor").place().error(
                "it is " + few_digits(arm) + " m from the centre of mass of body " + in_quotes(body.name),
                "less than 4096 m, the most that fixed point holds; --numbers f64 and f32 have no such limit");
    }
}

// Bodies that springs and gravitation tie to jointed bodies, and these, with how far each is from them.
std::vector<bool> coupled_to_joints(const SceneDescription& scene) {
    const auto count = scene.bodies.size();
    std::vector<bool> is_coupled(count, scene.gravitation > 0);
    for (std::size_t b = 0; b < count; ++b)
        if (scene.is_jointed(static_cast<int>(b))) is_coupled[b] = true;
    for (std::size_t pass = 0; pass < count; ++pass)
        for (const SpringDescription& spring : scene.springs) {
            if (spring.to_body < 0 || scene.body(spring.body).fixed || scene.body(spring.to_body).fixed) continue;
            const auto one = static_cast<std::size_t>(spring.body), other = static_cast<std::size_t>(spring.to_body);
            is_coupled[one] = is_coupled[other] = is_coupled[one] || is_coupled[other];
        }
    for (std::size_t b = 0; b < count; ++b)
        if (scene.bodies[b].fixed) is_coupled[b] = false;
    return is_coupled;
}

// What a body passes through though its shape would touch it, were it in a layer; empty: nothing. Bodies in joints pass
// through each other, and need not say so.
std::string passed_by(const SceneDescription& scene, std::size_t b) {
    const BodyDescription& body = scene.bodies[b];
    const ShapeKind shape = shape_of(body.shape).kind;
    if (shape == ShapeKind::none) return "";
    if (!scene.planes.empty()) return "plane " + in_quotes(scene.planes.front().name);
    for (std::size_t other = 0; other < scene.bodies.size(); ++other)
        if (!scene.is_jointed(static_cast<int>(other)) && scene.layers_of(static_cast<int>(other)) != 0 &&
            shapes_meet(shape, scene.bodies[other].shape.kind))
            return "body " + in_quotes(scene.bodies[other].name);
    return "";
}

}  // namespace

JointDescription read_joint(Table table, const SceneDescription& scene, RangeDescription& range) {
    JointDescription joint;
    std::string body, to_body;
    table.optional("name", joint.name);
    if (const auto kind = table.find("kind")) joint.kind = read_kind(*kind);
    else table.missing("kind", listed(keys_of(joint_kinds)));
    const KindRow& row = row_of(joint.kind);
    const bool is_universal = joint.kind == JointKind::universal, has_axis = *row.axis != 0;
    table.required("body", body);
    const bool has_to_body = table.optional("to_body", to_body);
    table.required("anchor", joint.anchor, metres);
    read_axis(table, "axis", joint.axis, has_axis, row.axis);
    read_axis(table, "to_axis", joint.to_axis, is_universal, "the axis that to_body keeps, perpendicular to axis");
    table.finish();

    const std::string kind = word_of(joint_kinds, joint.kind);
    if (table.has("axis") && !has_axis)
        table.at("axis").fail("given for a " + kind + " joint", std::string("no axis: ") + row.instead);
    if (table.has("to_axis") && !is_universal)
        table.at("to_axis").fail("given for a " + kind + " joint", "it for a universal joint alone");
    joint.body = resolve(table, "body", body, scene);
    if (has_to_body) joint.to_body = resolve(table, "to_body", to_body, scene);
    if (joint.to_body == joint.body)
        table.at("to_body").fail("got " + in_quotes(to_body) + ", the joint's own body",
                                 "another body, or none for the world");
    if (joint.name.empty()) joint.name = body + " to " + (has_to_body ? to_body : "world");
    check_sides(table, joint, scene);
    check_range(table, "anchor", joint.anchor, "position", range);
    check_arms(table, joint, scene, range);
    if (is_universal) check_perpendicular(table, joint);
    refuse_loop(table, joint, scene);
    return joint;
}

void check_layers_of_joints(const std::vector<Table>& bodies, const std::vector<Table>& joints,
                            const SceneDescription& scene) {
    if (joints.empty() || scene.contact.response == ContactResponse::none) return;
    const std::string none = "layers = 0, with which it touches nothing";
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const BodyDescription& body = scene.bodies[b];
        if (body.fixed || !scene.is_jointed(static_cast<int>(b))) continue;
        Table table = bodies[b];
        if (body.layers.value_or(0) != 0)
            table.at("layers").refuse("0: body " + in_quotes(body.name) +
                                      " is in a joint, and jointed bodies touch nothing yet");
        if (const std::string passed = passed_by(scene, b); !body.layers && !passed.empty())
            table.fail("layers", "missing",
                       none + ": it is in a joint, jointed bodies touch nothing yet, and it would pass through " +
                           passed);
    }
    if (!needs(build_scene(scene)).touches()) return;
    const std::vector<bool> is_coupled = coupled_to_joints(scene);
    for (std::size_t b = 0; b < bodies.size(); ++b)
        if (is_coupled[b] && shape_of(scene.bodies[b].shape).kind != ShapeKind::none &&
            scene.layers_of(static_cast<int>(b)) != 0) {
            Table table = bodies[b];
            const std::string problem = "a spring or gravitation ties it to jointed bodies, which touch nothing yet";
            if (table.has("layers")) table.at("layers").fail(problem, none);
            table.fail("layers", problem, none);
        }
}

}  // namespace tumble::host
