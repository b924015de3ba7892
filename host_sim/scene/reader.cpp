#include "scene/reader.hpp"

#include <tumble/shapes/shape.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <system_error>

#include "scene/data.hpp"
#include "scene/toml.hpp"
#include "tools/text.hpp"

namespace tumble::host {

// Found by Table::required() and Table::optional(), as those of scene/toml.hpp.
static std::string wanted(const StepSize&, const Quantity&) {
    return "a positive number or a fraction in quotes such as \"1/256\" (s)";
}
static void convert(const Value& value, StepSize& out, const Quantity& quantity) {
    std::optional<StepSize> step;
    if (const auto* text = value.node().as_string()) step = parse_step(text->get());
    else if (const double x = value.node().value<double>().value_or(0.0); value.node().is_number() && quantity.holds(x))
        step = StepSize{0, 0, x};
    if (!step) value.refuse(wanted(out, quantity));
    out = *step;
}

namespace {

constexpr Quantity metres{Quantity::any, "m", "x, y, z"};
constexpr Quantity metres_per_second{Quantity::any, "m/s", "x, y, z"};
constexpr Quantity radians_per_second{Quantity::any, "rad/s", "x, y, z"};
constexpr Quantity newtons{Quantity::any, "N", "x, y, z"};
constexpr Quantity newton_metres{Quantity::any, "N m", "x, y, z"};
constexpr Quantity newton_seconds{Quantity::any, "N s", "x, y, z"};
constexpr Quantity newton_metre_seconds{Quantity::any, "N m s", "x, y, z"};
constexpr Quantity restitution{Quantity::zero_to_one, ""};
constexpr Quantity friction{Quantity::not_negative, ""};
constexpr Quantity stiffness{Quantity::not_negative, "N/m"};
constexpr Quantity damping{Quantity::not_negative, "N s/m"};
constexpr Quantity time{Quantity::not_negative, "s"};

// The largest preset, `field`: what no [range] may exceed.
constexpr RangeDescription field{FieldRange::position, FieldRange::velocity, FieldRange::spin};

// Bytes: some hundred thousand events.
constexpr std::size_t largest_file = std::size_t{1} << 25;

constexpr double planes_within = 4;    // times the range of positions: what fixed point holds of a plane's offset
constexpr double longest_reach = 1e8;  // m, of a shape from its centre: what fixed point measures contacts with

constexpr double moment_tolerance = 1e-12;  // relative: rounding of moments computed from a tensor or from points

const Words<Frame> frames{{"world", Frame::world}, {"body", Frame::body}};
const Words<ContactResponse> responses{
    {"impulse", ContactResponse::impulse}, {"spring", ContactResponse::spring}, {"none", ContactResponse::none}};

// Smallest first.
Triple moments_of(const InertiaTensor& tensor) {
    const RealVec3 moments = principal_inertia(tensor).moments;
    return {moments.z.to_double(), moments.y.to_double(), moments.x.to_double()};
}

// One row per shape: how many sizes it has.
struct ShapeRow {
    const char* key;
    ShapeKind kind;
    std::size_t sizes;
    const char* parts;
};

constexpr ShapeRow shape_rows[] = {
    {"box", ShapeKind::box, 3, "x edge, y edge, z edge"},   {"sphere", ShapeKind::sphere, 1, "radius"},
    {"cylinder", ShapeKind::cylinder, 2, "radius, height"}, {"hoop", ShapeKind::hoop, 1, "radius"},
    {"capsule", ShapeKind::capsule, 2, "radius, length"},   {"points", ShapeKind::points, 0, ""},
};

ShapeDescription read_shape(const Value& value, const std::string& key) {
    const std::string wanted_shape = "\"none\", or a table with one of box = [x, y, z], sphere = radius, cylinder = "
                                     "[radius, height], hoop = radius, "
                                     "capsule = [radius, length] (m) and points = [[x, y, z, mass], ...] (m, kg)";
    ShapeDescription shape;
    if (const auto* text = value.node().as_string(); text != nullptr && text->get() == "none") return shape;
    if (!value.node().is_table()) value.refuse(wanted_shape);

    Table table(value.place(), *value.node().as_table());
    int found = 0;
    for (const ShapeRow& row : shape_rows) {
        const auto entry = table.find(row.key);
        if (!entry) continue;
        ++found;
        shape.kind = row.kind;
        const Quantity size{Quantity::positive, "m", row.parts};
        if (row.sizes == 1) {
            shape.size[0] = entry->number(size);
        } else if (row.sizes > 1) {
            const auto sizes = entry->numbers(size, {row.sizes});
            std::copy(sizes.begin(), sizes.end(), shape.size.begin());
        } else {
            const toml::array* points = entry->node().as_array();
            if (points == nullptr || points->empty())
                entry->refuse("an array of points [[x, y, z, mass], ...] (m, kg), not empty");
            for (std::size_t i = 0; i < points->size(); ++i) {
                const Value point = (*entry)[i];
                const auto numbers = point.numbers({Quantity::any, "m, kg", "x, y, z, mass"}, {4});
                shape.points.push_back(
                    {{numbers[0], numbers[1], numbers[2]}, point[3].number({Quantity::positive, "kg"})});
            }
        }
    }
    table.finish();
    if (found != 1)
        Place{value.place().file, value.place().line, key}.fail("got " + std::to_string(found) + " shapes",
                                                                wanted_shape);
    return shape;
}

// Principal moments must be positive and obey the triangle inequality: no rigid body has others.
void check_moments(const Value& value, const BodyDescription& body) {
    const Triple moments = moments_of(tensor_of(*body.inertia));
    const std::string problem =
        "the principal moments are " + shown(moments[0]) + ", " + shown(moments[1]) + " and " + shown(moments[2]);
    const double smallest = body.inertia_is_diagonal ? 0.0 : moment_tolerance * moments[2];
    if (!(moments[0] > smallest)) value.fail(problem, "all of them positive and finite (kg m^2)");
    if (moments[2] - moments[1] - moments[0] > moment_tolerance * moments[2])
        value.fail(problem, "none of them larger than the sum of the other two: the triangle inequality (kg m^2)");
}

void check_not_zero(const Value& value, const double* numbers, std::size_t count, const std::string& wanted) {
    if (!std::isnormal(std::inner_product(numbers, numbers + count, numbers, 0.0)))
        value.fail("its length is 0", wanted);
}

void check_inside(Table& table, const std::string& key, const Triple& numbers, double range, const char* unit,
                  const std::string& range_key) {
    for (std::size_t i = 0; i < 3; ++i)
        if (std::abs(numbers[i]) > range)
            table.at(key)[i].refuse("a number from -" + shown(range) + " to " + shown(range) + " (" + unit +
                                    "), the range." + range_key + " of this scene");
}

// Mass, density and inertia must together say what the body weighs and how it turns; without shape and inertia it does
// not.
void check_mass(Table& table, const BodyDescription& body) {
    const ShapeKind kind = body.shape.kind;
    const bool has_volume = !volume_of(shape_of(body.shape)).is_zero();
    if (kind == ShapeKind::points) {
        for (const char* key : {"mass", "density"})
            if (table.has(key))
                table.at(key).fail("given with shape points", "no mass or density: the points carry the mass");
    } else if (body.mass && body.density) {
        table.at("density").fail("mass and density are both given", "one of them");
    } else if (body.density && !has_volume) {
        table.at("density").fail("given for a shape without volume", "mass (kg)");
    } else if (!body.mass && !body.density) {
        table.fail("mass", "missing", has_volume ? "mass (kg) or density (kg/m^3)" : "mass (kg)");
    }

    if (body.inertia) return check_moments(table.at("inertia"), body);
    if (kind == ShapeKind::points) {
        const PointCloud cloud = cloud_of(body.shape.points);
        const Triple moments = moments_of(cloud.inertia);
        if (!(moments[0] > moment_tolerance * moments[2]))
            table.at("shape").fail("the points lie on one line, so that a principal moment is 0",
                                   "points off that line, inertia = [...] (kg m^2), or shape = \"none\" for a point "
                                   "mass");
    }
}

// A point mass has no rotation: numbers that ask for one are an error.
void refuse_to_turn(Table& table, const std::string& key, const double* numbers, std::size_t count,
                    const BodyDescription& body, const std::string& otherwise) {
    if (body.is_point_mass() && std::any_of(numbers, numbers + count, [](double x) { return x != 0.0; }))
        table.at(key).fail("body " + in_quotes(body.name) + " is a point mass, which has no rotation",
                           otherwise + ", or a shape or inertia = [...] (kg m^2) of the body");
}
void refuse_to_turn(Table& table, const std::string& key, const Triple& numbers, const BodyDescription& body) {
    refuse_to_turn(table, key, numbers.data(), numbers.size(), body, "[0, 0, 0] or no " + key);
}
// Nor has it axes that an impulse or a force could be given in.
void refuse_body_frame(Table& table, Frame frame, const BodyDescription& body) {
    if (body.is_point_mass() && frame == Frame::body)
        table.at("frame").fail("body " + in_quotes(body.name) + " is a point mass, which has no axes of its own",
                               "\"world\" or no frame");
}

BodyDescription read_body(Table table, const RangeDescription& range) {
    BodyDescription body;
    table.required("name", body.name);
    if (const auto shape = table.find("shape")) body.shape = read_shape(*shape, shape->place().key);
    else table.missing("shape", "\"none\" or a table such as { box = [x, y, z] } (m)");
    table.optional("mass", body.mass, Quantity{Quantity::positive, "kg"});
    table.optional("density", body.density, Quantity{Quantity::positive, "kg/m^3"});
    if (const auto inertia = table.find("inertia")) {
        auto numbers = inertia->numbers({Quantity::any, "kg m^2"}, {3, 6});
        numbers.resize(6);
        body.inertia.emplace();
        std::copy(numbers.begin(), numbers.end(), body.inertia->begin());
        body.inertia_is_diagonal = numbers[3] == 0.0 && numbers[4] == 0.0 && numbers[5] == 0.0;
    }
    table.optional("position", body.position, metres);
    table.optional("velocity", body.velocity, metres_per_second);
    const bool turned = table.optional("orientation", body.orientation, Quantity{Quantity::any, "", "w, x, y, z"});
    table.optional("angular_velocity", body.angular_velocity, radians_per_second);
    table.optional("restitution", body.restitution, restitution);
    table.optional("friction", body.friction, friction);
    table.optional("fixed", body.fixed);
    table.finish();

    check_mass(table, body);
    if (const double reach = reach_of(shape_of(body.shape)).to_double(); reach > longest_reach)
        table.at("shape").fail("it reaches " + shown(reach) + " m from its centre",
                               "sizes (m) with which it reaches at most " + shown(longest_reach) + " m");
    if (turned)
        check_not_zero(table.at("orientation"), body.orientation.data(), 4,
                       "a quaternion [w, x, y, z] that is not zero");
    refuse_to_turn(table, "orientation", body.orientation.data() + 1, 3, body, "[1, 0, 0, 0] or no orientation");
    refuse_to_turn(table, "angular_velocity", body.angular_velocity, body);
    check_inside(table, "position", body.position, range.position, "m", "position");
    check_inside(table, "velocity", body.velocity, range.velocity, "m/s", "velocity");
    check_inside(table, "angular_velocity", body.angular_velocity, range.angular_velocity, "rad/s", "angular_velocity");
    return body;
}

PlaneDescription read_plane(Table table, const RangeDescription& range) {
    PlaneDescription plane;
    table.required("name", plane.name);
    table.required("normal", plane.normal, Quantity{Quantity::any, "", "x, y, z"});
    table.optional("offset", plane.offset, Quantity{Quantity::any, "m"});
    table.optional("restitution", plane.restitution, restitution);
    table.optional("friction", plane.friction, friction);
    table.finish();
    check_not_zero(table.at("normal"), plane.normal.data(), 3, "a vector [x, y, z] that is not zero");
    if (const double most = planes_within * range.position; std::abs(plane.offset) > most)
        table.at("offset").refuse("a number from -" + shown(most) + " to " + shown(most) + " (m), " +
                                  shown(planes_within) + " times the range.position of this scene");
    return plane;
}

void read_world(Table table, SceneDescription& scene) {
    table.optional("gravity", scene.gravity, Quantity{Quantity::any, "m/s^2", "x, y, z"});
    table.required("step", scene.step, Quantity{Quantity::positive, "s"});
    table.required("duration", scene.duration, time);
    table.optional("gravitation", scene.gravitation, Quantity{Quantity::not_negative, "m^3/(kg s^2)"});
    table.optional("linear_drag", scene.linear_drag, Quantity{Quantity::not_negative, "kg/s"});
    table.optional("angular_drag", scene.angular_drag, Quantity{Quantity::not_negative, "N m s"});
    table.finish();
    if (scene.steps() > max_steps)
        table.at("duration")
            .fail("got " + shown(scene.duration) + " s, which takes more than 2^31 steps",
                  "at most " + std::to_string(max_steps) + " steps of " + shown(scene.step.seconds()) + " s");
}

void read_range(Table table, RangeDescription& range) {
    const auto read = [&table](const char* key, double& out, double largest, const char* unit) {
        table.optional(key, out, Quantity{Quantity::positive, unit});
        if (out > largest) table.at(key).refuse("at most " + shown(largest) + " (" + unit + ")");
    };
    read("position", range.position, field.position, "m");
    read("velocity", range.velocity, field.velocity, "m/s");
    read("angular_velocity", range.angular_velocity, field.angular_velocity, "rad/s");
    range.is_declared = true;
    table.finish();
}

void read_contact(Table table, ContactDescription& contact) {
    table.optional("response", contact.response, responses);
    table.optional("restitution", contact.restitution, restitution);
    table.optional("restitution_threshold", contact.restitution_threshold, Quantity{Quantity::not_negative, "m/s"});
    table.optional("friction", contact.friction, friction);
    table.optional("tolerance", contact.tolerance, Quantity{Quantity::positive, "m"});
    table.optional("stiffness", contact.stiffness, stiffness);
    table.optional("damping", contact.damping, damping);
    table.optional("barrier", contact.barrier, Quantity{Quantity::not_negative, "N m^2"});
    if (const auto value = table.find("sleep")) {
        const auto* off = value->node().as_boolean();
        if (!value->node().is_table() && (off == nullptr || off->get()))
            value->refuse("false, or a table { speed = 0.03, angular_speed = 0.05, time = 0.5 }");
        if (value->node().is_table()) {
            Table sleep(value->place(), *value->node().as_table());
            contact.sleep.emplace();
            sleep.optional("speed", contact.sleep->speed, Quantity{Quantity::positive, "m/s"});
            sleep.optional("angular_speed", contact.sleep->angular_speed, Quantity{Quantity::positive, "rad/s"});
            sleep.optional("time", contact.sleep->time, time);
            sleep.finish();
        }
    }
    table.finish();
}

// The body that a key names.
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

SpringDescription read_spring(Table table, const SceneDescription& scene) {
    SpringDescription spring;
    std::string body, to_body;
    Triple to_point{};
    table.required("body", body);
    table.optional("point", spring.point, metres);
    const bool to_world = table.optional("to", spring.to, metres);
    const bool to_other = table.optional("to_body", to_body);
    const bool has_to_point = table.optional("to_point", to_point, metres);
    table.required("stiffness", spring.stiffness, stiffness);
    table.optional("damping", spring.damping, damping);
    table.optional("rest_length", spring.rest_length, Quantity{Quantity::not_negative, "m"});
    table.finish();

    const double furthest = scene.range.position;
    check_inside(table, "point", spring.point, furthest, "m", "position");
    if (to_world) check_inside(table, "to", spring.to, furthest, "m", "position");
    if (has_to_point) check_inside(table, "to_point", to_point, furthest, "m", "position");
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

void check_time(Table& table, const std::string& key, double when, const SceneDescription& scene) {
    if (when > scene.duration)
        table.at(key).refuse("a time from 0 to the end of the run, " + shown(scene.duration) + " (s)");
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

ImpulseDescription read_impulse(Table table, const SceneDescription& scene) {
    static const Words<std::pair<std::size_t, double>> faces{{"-x", {0, -1.0}}, {"+x", {0, 1.0}},  {"-y", {1, -1.0}},
                                                             {"+y", {1, 1.0}},  {"-z", {2, -1.0}}, {"+z", {2, 1.0}}};
    ImpulseDescription impulse;
    std::string body;
    std::pair<std::size_t, double> face;
    double strength = 0.0;
    table.required("time", impulse.time, time);
    table.required("body", body);
    const bool has_impulse = table.optional("impulse", impulse.impulse, newton_seconds);
    table.optional("frame", impulse.frame, frames);
    table.optional("point", impulse.point, metres);
    const bool has_face = table.optional("face", face, faces);
    const bool has_strength = table.optional("strength", strength, Quantity{Quantity::positive, "N s"});
    const bool has_angular = table.optional("angular_impulse", impulse.angular_impulse, newton_metre_seconds);
    table.finish();

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
    table.optional("from", force.from, time);
    table.required("until", force.until, time);
    const bool has_force = table.optional("force", force.force, newtons);
    table.optional("frame", force.frame, frames);
    table.optional("point", force.point, metres);
    const bool has_torque = table.optional("torque", force.torque, newton_metres);
    table.finish();

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

// Adds a named thing to its list; no other may have its name, whatever it is.
template <class T>
void add_named(std::vector<T>& list, T item, Table& table, std::set<std::string>& names) {
    if (!names.insert(item.name).second)
        table.at("name").fail("the name " + in_quotes(item.name) + " is taken", "a name of its own");
    list.push_back(std::move(item));
}

// The first that there is no room for is refused.
void check_count(const std::vector<Table>& tables, int room) {
    const auto most = static_cast<std::size_t>(room);
    if (tables.size() > most)
        tables[most].place().fail("got " + std::to_string(tables.size()) + " of them",
                                  "at most " + std::to_string(room));
}

SceneDescription read_root(Table root, const std::string& file, BodyCount count) {
    SceneDescription scene;
    scene.path = file;
    scene.name = std::filesystem::path(file).stem().string();

    // every key of the top level is asked for before any table is read, so that a misspelt table name is the first
    // error
    root.optional("name", scene.name);
    auto world = root.table("world");
    if (!world) root.missing("world", "the table [world] with step and duration (s)");
    const auto range = root.table("range");
    const auto contact = root.table("contact");
    const auto planes = root.tables("plane");
    const auto bodies = root.tables("body");
    if (bodies.empty() && count == BodyCount::at_least_one) root.missing("body", "at least one [[body]]");
    const auto springs = root.tables("spring");
    const auto impulses = root.tables("impulse");
    const auto forces = root.tables("force");
    root.finish();

    read_world(*world, scene);
    if (range) read_range(*range, scene.range);
    if (contact) read_contact(*contact, scene.contact);
    std::set<std::string> names;
    check_count(planes, max_planes);
    check_count(bodies, max_bodies);
    check_count(springs, max_springs);
    for (Table table : planes) add_named(scene.planes, read_plane(table, scene.range), table, names);
    for (Table table : bodies) add_named(scene.bodies, read_body(table, scene.range), table, names);
    if (scene.angular_drag > 0.0 && !scene.has_rotation())
        world->at("angular_drag").fail("all bodies are point masses, which have no rotation", "0 or no angular_drag");
    for (const Table& table : springs) scene.springs.push_back(read_spring(table, scene));
    for (const Table& table : impulses) scene.impulses.push_back(read_impulse(table, scene));
    for (const Table& table : forces) scene.forces.push_back(read_force(table, scene));
    return scene;
}

}  // namespace

SceneDescription read_scene(const std::filesystem::path& path, BodyCount bodies) {
    const auto refuse = [&path](const std::string& why) -> SceneError {
        return {path.string(), 0, "", "cannot be read: " + why + ", expected a scene file (TOML)"};
    };
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status))
        throw refuse(status.type() == std::filesystem::file_type::not_found ? "no such file" : error.message());
    if (std::filesystem::is_directory(status)) throw refuse("it is a directory");
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw refuse("it cannot be opened");
    std::string text;
    for (std::array<char, 1 << 16> part{}; stream.read(part.data(), part.size()), stream.gcount() > 0;) {
        text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
        if (text.size() > largest_file) throw refuse("it is larger than " + std::to_string(largest_file) + " bytes");
    }
    if (stream.bad()) throw refuse("reading it failed");
    return read_scene_text(text, path.string(), bodies);
}

SceneDescription read_scene_text(std::string_view toml, std::string_view name, BodyCount bodies) {
    const std::string file(name);
    const Document document(toml, file);
    return read_root(document.root(), file, bodies);
}

std::optional<StepSize> parse_step(std::string_view text) {
    const char* const end = text.data() + text.size();
    StepSize step{0, 0, 0.0};
    if (const auto slash = text.find('/'); slash != std::string_view::npos) {
        const char* const middle = text.data() + slash;
        const auto above = std::from_chars(text.data(), middle, step.numerator);
        const auto below = std::from_chars(middle + 1, end, step.denominator);
        const bool read = above.ec == std::errc{} && below.ec == std::errc{} && above.ptr == middle && below.ptr == end;
        if (!read || step.numerator <= 0 || step.denominator <= 0) return std::nullopt;
        return step;
    }
    const auto [last, code] = std::from_chars(text.data(), end, step.decimal);
    if (code != std::errc{} || last != end || !Quantity{Quantity::positive}.holds(step.decimal)) return std::nullopt;
    return step;
}

std::string step_text(const StepSize& step) {
    if (step.denominator == 0) return few_digits(step.decimal);
    return std::to_string(step.numerator) + (step.denominator == 1 ? "" : "/" + std::to_string(step.denominator));
}

std::int64_t SceneDescription::steps() const {
    // Both operations are exact where the quotient is a whole number and the duration is; else they and the decimal in
    // the file are wrong by a few units of 1e-16. The tolerance absorbs that, and its cap keeps it below one step in
    // long runs.
    const double quotient =
        step.denominator == 0 ? duration / step.decimal
                              : duration * static_cast<double>(step.denominator) / static_cast<double>(step.numerator);
    if (!(quotient < 9e18)) return std::numeric_limits<std::int64_t>::max();
    const double tolerance = std::min(1e-9 * quotient, 1e-5);
    return static_cast<std::int64_t>(std::ceil(quotient - tolerance));
}

}  // namespace tumble::host
