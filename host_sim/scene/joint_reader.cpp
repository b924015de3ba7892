// Tables of joints.
#include <tumble/joints/distance.hpp>
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

// What a kind's axis is for, and why it has none, no limits or no spring; empty: it has.
struct KindRow {
    const char* axis;
    const char* no_axis;
    const char* no_limits;
    const char* no_spring;
};
constexpr const char* no_one_angle = "only a hinge and a slider have limits";
constexpr const char* none_is_free = "a fixed joint has no free direction";
// In the order of JointKind.
constexpr KindRow kind_rows[] = {
    {"a hinge turns about it", "", "", ""},
    {"", "a ball turns about any axis", no_one_angle, ""},
    {"", none_is_free, none_is_free, none_is_free},
    {"a slider moves along it", "", "", ""},
    {"a universal joint turns about it, and about to_axis", "", no_one_angle, ""},
    {"", "a distance acts along the line between its points", "its range is least and most", ""},
};
const KindRow& row_of(JointKind kind) { return kind_rows[static_cast<std::size_t>(kind)]; }

// The keys of the fields that a kind has.
std::set<std::string> keys_of(JointKind kind) {
    JointDescription joint;
    joint.kind = kind;
    std::set<std::string> keys;
    for_each_field(joint, [&](Field field, const auto&) { keys.insert(field.name); });
    if (kind == JointKind::distance) keys.insert("length");  // least and most of a rod
    return keys;
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
    {"rope", "a rope is a distance with most"},
    {"cable", "a cable is a distance with most"},
    {"rod", "a rod is a distance with length"},
    {"continuous", "a continuous joint is a hinge without limits"},
    {"wheel", "a wheel turns on a hinge, and its suspension is a slider with a spring, on a body of its own"},
    {"cylindrical", "a cylindrical joint is a slider and a hinge, with a body between them"},
    {"screw", "there is no screw joint; a hinge turns, and a slider moves"},
    {"planar", "a planar joint is two sliders and a hinge, with bodies between them"},
    {"floating", "a floating body has no joint"},
    {"free", "a free body has no joint"},
    {"spring", "a spring between two points is a [[spring]], or a distance with most and spring"},
};

JointKind read_kind(const Value& value) {
    const std::vector<std::string> names = keys_of(words<JointKind>);
    const std::string& text = value.text(listed(names));
    for (const auto& [word, kind] : words<JointKind>)
        if (word == text) return kind;
    const auto* const other = std::find_if(std::begin(other_kinds), std::end(other_kinds),
                                           [&](const auto& pair) { return pair.first == text; });
    if (other != std::end(other_kinds)) value.fail("got " + in_quotes(text), listed(names) + "; " + other->second);
    value.fail("got " + in_quotes(text) + suggestion(text, names), listed(names));
}

// Axes that the kind has are required and not zero.
void read_axis(Table& table, const Field& field, Triple& axis, bool has_axis, const std::string& why) {
    const std::string wanted = "a direction [x, y, z] that is not zero: " + why;
    const auto value = table.find(field.name);
    if (!value && has_axis) table.missing(field.name, wanted);
    if (!value) return;
    convert(*value, axis, values_of<Triple>(field));
    check_not_zero(*value, axis.data(), axis.size(), wanted);
}

double distance_of(const Triple& a, const Triple& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

// Keys of other programs that this one has not yet, and why.
void refuse_what_is_not_there(Table& table) {
    constexpr const char* none = "there are no motors of joints yet";
    constexpr std::pair<const char*, const char*> missing[] = {
        {"motor", none}, {"servo", none}, {"friction", "there is no friction of joints yet"}};
    for (const auto& [key, reason] : missing)
        if (table.has(key))
            table.at(key).fail(reason, "none: what acts in a joint is limits, spring, break_force and break_torque");
    bool collides = false;
    if (table.optional("collide", collides) && collides)
        table.at("collide").fail("jointed bodies touch nothing yet", "false, or no collide");
}

// A distance needs a range.
void require_range(Table& table) {
    if (table.has("length") || table.has("most")) return;
    table.missing(table.has("least") ? "most" : "length",
                  table.has("least") ? "a positive finite number (m): the distance is from least to most"
                                     : "length of a rod (m), or most of a rope (m) with or without least (m)");
}

void check_distance(Table& table, const JointDescription& joint) {
    for (const char* key : {"least", "most"})
        if (table.has("length") && table.has(key))
            table.at(key).fail("given beside length", "length of a rod, or least and most of a range");
    if (joint.least > joint.most)
        table.at("least").refuse("at most most = " + shown(joint.most) + " (m), from where on the distance is held");
    const double apart = distance_of(joint.anchor, joint.to_point);
    if (joint.is_rod() && !(apart > 0))
        table.at("to_point").fail("it is at point", "another place: a rod acts along the line between them");
    bool is_outside = false;
    joint_of(joint).visit([&](const auto& spec) {
        if constexpr (requires { spec.to_point; }) is_outside = joints::Distance::fault_of(spec) != JointFault::none;
    });
    if (!is_outside) return;
    const std::string start = ", the distance of point and to_point at the start";
    if (table.has("length")) table.at("length").refuse(shown(apart) + " (m)" + start);
    if (apart > joint.most) table.at("most").refuse("at least " + shown(apart) + " (m)" + start);
    table.at("least").refuse("at most " + shown(apart) + " (m)" + start);
}

void read_spring(Table& table, const char* key, JointKind kind, JointSpringDescription& spring) {
    const auto value = table.find(key);
    if (!value) return;
    const std::string rest = rest_key(kind);
    const bool is_linear = kind == JointKind::slider || kind == JointKind::distance;
    const std::string example = "a table { stiffness = 10.0, damping = 0.1" +
                                (rest.empty() ? "" : ", " + rest + " = 0.5") + " } of " +
                                (is_linear ? "N/m, N s/m" : "N m/rad, N m s/rad") +
                                (rest.empty() ? ""
                                 : is_linear  ? " and m"
                                              : " and rad");
    if (!value->node().is_table()) value->refuse(example);
    Table keys(value->place(), *value->node().as_table());
    JointSpring::each(
        [&](Field field, double& number) {
            const bool is_rest = &number == &spring.rest;
            const std::string units = field.unit, between = " or ";  // of angles, then of lengths
            const std::size_t at = units.find(between);
            const bool is_second = is_linear && at != std::string::npos;
            const std::string unit = is_second ? units.substr(at + between.size()) : units.substr(0, at);
            if (is_rest && kind == JointKind::distance) field.kind = Field::not_negative;
            field.unit = unit.c_str();
            if (!is_rest || !rest.empty()) keys.optional(is_rest ? rest : field.name, number, values_of<double>(field));
        },
        spring);
    const bool has_rest = !rest.empty() && keys.has(rest);
    if (kind == JointKind::ball && keys.has("angle"))
        keys.at("angle").fail("given for a ball joint", "no angle: the spring of a ball rests where the joint starts");
    keys.finish();
    if (!spring.acts()) value->fail("it has no effect", "a stiffness or a damping above 0, or no " + std::string(key));
    if (has_rest && !(spring.stiffness > 0))
        keys.at(rest).fail("given without stiffness", "stiffness above 0 beside it");
    constexpr double half_turn = 3.14159265358979323846;
    if (has_rest && !is_linear && std::abs(spring.rest) > half_turn)
        keys.at(rest).refuse("a number from -pi to pi (rad): a spring knows the angle within half a turn");
}

// [least, most] around the start.
void read_limits(Table& table, JointDescription& joint) {
    constexpr double most_angle = 2.6;  // rad
    const auto value = table.find("limits");
    if (!value) return;
    const bool turns = joint.kind == JointKind::hinge;
    const std::string unit = turns ? "(rad)" : "(m)", wanted = "[least, most] around 0, where the joint starts " + unit;
    const auto* const array = value->node().as_array();
    if (array == nullptr || array->size() != 2) value->refuse(wanted);
    std::array<double, 2> limits{};
    convert(*value, limits, Quantity{Quantity::any, turns ? "rad" : "m", "least, most"});
    const std::string got = "got [" + shown(limits[0]) + ", " + shown(limits[1]) + "]";
    if (limits[0] > 0 || limits[1] < 0) value->fail(got, wanted);
    if (limits[0] == limits[1]) value->fail(got, wanted + "; a joint that does not move is a fixed one");
    if (turns && (limits[0] < -most_angle || limits[1] > most_angle))
        value->fail(got, wanted + ", each within " + shown(most_angle) + " rad");
    joint.least = limits[0];
    joint.most = limits[1];
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
    static const std::string held = "less than 4096 m, the most that fixed point holds; --numbers f64 and f32 have no "
                                    "such limit";
    const bool is_distance = joint.kind == JointKind::distance;
    for (const int side : {joint.body, joint.to_body}) {
        if (side < 0) continue;
        const BodyDescription& body = scene.body(side);
        const double arm = distance_of(joint.anchor_on(side), body.position);
        const char* const key = !is_distance ? "anchor" : side == joint.body ? "point" : "to_point";
        if (arm > longest_arm && !range.beyond_default)
            range.beyond_default = table.at(key).place().error(
                "it is " + few_digits(arm) + " m from the centre of mass of body " + in_quotes(body.name), held);
    }
    const char* const key = !is_distance ? "limits" : table.has("length") ? "length" : "most";
    const bool is_long = joint.kind != JointKind::hinge && std::max(joint.most, -joint.least) > longest_arm;
    if (is_long && !range.beyond_default) range.beyond_default = table.at(key).refusal(held);
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

// Keys that the kind has not are refused with the reason.
void refuse_what_the_kind_has_not(Table& table, JointKind kind, const std::set<std::string>& has) {
    const KindRow& row = row_of(kind);
    const auto refuse = [&](const char* key, const std::string& wanted) {
        if (table.has(key) && !has.contains(key)) table.at(key).fail("given for a " + word_of(kind) + " joint", wanted);
    };
    refuse("anchor", "point and to_point, its two ends");
    refuse("axis", std::string("no axis: ") + row.no_axis);
    refuse("to_axis", "none: only a universal joint has one");
    for (const char* key : {"point", "to_point"}) refuse(key, "anchor, the point that both sides keep");
    for (const char* key : {"length", "least", "most"}) refuse(key, "none: only a distance has one");
    refuse("limits", std::string("no limits: ") + row.no_limits);
    refuse("spring", std::string("no spring: ") + row.no_spring);
    refuse("to_spring", "none: only a universal joint has a second axis");
    refuse("break_torque", "break_force: a distance carries no torque");
    const JointDescription any;
    detail::each_field_of_joint([&](Field field, const auto&) { refuse(field.name, "none"); }, any);
}

// The world is no body, and has no name unless a body has it.
int resolve_side(Table& table, const std::string& key, const std::string& name, const SceneDescription& scene) {
    const bool is_there =
        std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const auto& body) { return body.name == name; });
    if (!is_there && edit_distance(name, "world") == 0)
        table.at(key).fail("got " + in_quotes(name) + ", which is no body",
                           key == "to_body"
                               ? "the name of a body, or none for the world"
                               : "the name of a body that moves: a joint without to_body ties it to the world");
    return resolve(table, key, name, scene);
}

// The fields of a joint but its bodies; the kind `has` some. From here on keys that the kind has not are not there, or
// the kind is not.
void read_fields(Table& table, JointDescription& joint, const std::set<std::string>& has) {
    detail::each_field_of_joint(
        [&]<class T>(Field field, T& value) {
            const bool is_required = has.contains(field.name);
            if constexpr (std::is_same_v<T, JointSpringDescription>) {
                read_spring(table, field.name, joint.kind, value);
            } else if constexpr (std::is_same_v<T, Triple>) {
                const bool is_axis = &value == &joint.axis;
                if (is_axis || &value == &joint.to_axis)
                    return read_axis(table, field, value, is_required,
                                     is_axis ? row_of(joint.kind).axis
                                             : "the axis that to_body keeps, perpendicular to axis");
                table.read(field.name, value, values_of<T>(field), is_required);
                if (&value == &joint.anchor) table.read("point", value, values_of<T>(field), has.contains("point"));
            } else if constexpr (std::is_same_v<T, double>) {
                if (&value == &joint.least && table.optional("length", joint.most, Quantity{Field::positive, "m"}))
                    joint.least = joint.most;
                table.optional(field.name, value, values_of<T>(field));
                if (&value != &joint.most) return;
                if (is_required) require_range(table);
                read_limits(table, joint);
            }
        },
        joint);
}

}  // namespace

JointDescription read_joint(Table table, const SceneDescription& scene, RangeDescription& range) {
    JointDescription joint;
    std::string body, to_body;
    refuse_what_is_not_there(table);
    table.optional("name", joint.name);
    const auto kind = table.find("kind");
    if (kind) joint.kind = read_kind(*kind);
    else table.missing("kind", listed(keys_of(words<JointKind>)));
    const std::set<std::string> has = keys_of(joint.kind);
    if (kind) refuse_what_the_kind_has_not(table, joint.kind, has);
    table.required("body", body);
    const bool has_to_body = table.optional("to_body", to_body);
    read_fields(table, joint, has);
    table.finish();

    const bool is_distance = joint.kind == JointKind::distance;
    if (is_distance) check_distance(table, joint);
    if (joint.is_rod() && joint.spring.acts())
        table.at("spring").fail("given for a rod, which keeps its length", "least and most, or no spring");
    joint.body = resolve_side(table, "body", body, scene);
    if (has_to_body) joint.to_body = resolve_side(table, "to_body", to_body, scene);
    if (joint.to_body == joint.body)
        table.at("to_body").fail("got " + in_quotes(to_body) + ", the joint's own body",
                                 "another body, or none for the world");
    if (joint.name.empty()) joint.name = body + " to " + (has_to_body ? to_body : "world");
    check_sides(table, joint, scene);
    check_range(table, is_distance ? "point" : "anchor", joint.anchor, "position", range);
    if (is_distance) check_range(table, "to_point", joint.to_point, "position", range);
    check_arms(table, joint, scene, range);
    if (joint.kind == JointKind::universal) check_perpendicular(table, joint);
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
