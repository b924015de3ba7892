#include "scene/reader.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "scene/data.hpp"
#include "scene/reading.hpp"

namespace tumble::host {

// Found by Table::required() and Table::optional(), as those of scene/toml.hpp.
static std::string wanted(const StepSize&, const Quantity&) {
    return "a positive number or a fraction in quotes such as \"1/256\" (s)";
}
static void convert(const Value& value, StepSize& out, const Quantity& quantity) {
    std::optional<StepSize> step;
    if (const auto* text = value.node().as_string()) step = parse_step(text->get());
    else if (const auto x = value.any_number(); x && quantity.holds(*x)) step = StepSize{0, 0, *x};
    if (!step) value.refuse(wanted(out, quantity));
    out = *step;
}

namespace {

// The largest preset, `field`: a [range] is at most as large.
const RangeDescription field{FieldRange::position, FieldRange::velocity, FieldRange::spin};

constexpr double planes_within = 4;  // times the range of positions: the largest offset of a plane in fixed point

PlaneDescription read_plane(Table table, RangeDescription& range) {
    PlaneDescription plane;
    table.required("name", plane.name);
    table.required("normal", plane.normal, Quantity{Quantity::any, "", "x, y, z"});
    read_fields<PlaneSpec>(table, plane);
    table.finish();
    check_not_zero(table.at("normal"), plane.normal.data(), 3, "a vector [x, y, z] that is not zero");
    if (table.has("offset"))
        check_range(table.at("offset"), plane.offset, planes_within * range.position, "m",
                    shown(planes_within) + " times the range.position", range);
    return plane;
}

void read_world(Table table, SceneDescription& scene) {
    read_fields<WorldSpec>(table, scene);
    table.required("step", scene.step, Quantity{Quantity::positive, "s"});
    table.required("duration", scene.duration, seconds);
    table.optional("softening", scene.softening, Quantity{Quantity::not_negative, "m"});
    table.optional("wind", scene.wind, Quantity{Quantity::any, "m/s", "x, y, z"});
    table.finish();
    if (scene.softening > 0.0 && !(scene.gravitation > 0.0))
        table.at("softening")
            .fail("there is no gravitation to soften", "a gravitation above 0 (m^3/(kg s^2)), or no softening");
    if (scene.steps() > max_steps)
        table.at("duration")
            .fail("got " + shown(scene.duration) + " s, which takes more than 2^31 steps",
                  "at most " + std::to_string(max_steps) + " steps of " + shown(scene.step.seconds()) + " s");
}

GravityGradientDescription read_gravity_gradient(Table table) {
    GravityGradientDescription gradient;
    table.required("orbit_rate", gradient.orbit_rate, Quantity{Quantity::positive, "rad/s"});
    table.required("to_centre", gradient.to_centre, Quantity{Quantity::any, "", "x, y, z"});
    table.finish();
    check_not_zero(table.at("to_centre"), gradient.to_centre.data(), 3, "a vector [x, y, z] that is not zero");
    return gradient;
}

// A load on bodies, none of which feels it, is a mistake.
void check_felt(const SceneDescription& scene, Table& world, const std::optional<Table>& gravity_gradient) {
    if (scene.angular_drag > 0.0 && !scene.has_rotation())
        world.at("angular_drag").fail("all bodies are point masses, which have no rotation", "0 or no angular_drag");
    if (gravity_gradient && !scene.has_rotation())
        gravity_gradient->place().fail("all bodies are point masses, which have no rotation", "no [gravity_gradient]");
    const auto feels_air = [](const BodyDescription& b) {
        return !b.fixed && (b.linear_drag > 0.0 || b.quadratic_drag > 0.0);
    };
    if (scene.wind != Triple{} && std::none_of(scene.bodies.begin(), scene.bodies.end(), feels_air))
        world.at("wind").fail("no body feels it",
                              "a body that is not fixed, with linear_drag (kg/s) or quadratic_drag (kg/m), or no wind");
}

void read_range(Table table, RangeDescription& range) {
    const auto read = [&table](const char* key, double& out, double largest, const char* unit) {
        table.optional(key, out, Quantity{Quantity::positive, unit});
        if (out > largest)
            table.at(key).refuse("at most " + shown(largest) + " (" + unit +
                                 "), the most that fixed point holds; floating point needs no [range]");
    };
    read("position", range.position, field.position, "m");
    read("velocity", range.velocity, field.velocity, "m/s");
    read("angular_velocity", range.angular_velocity, field.angular_velocity, "rad/s");
    range.is_declared = true;
    table.finish();
}

void read_contact(Table table, ContactDescription& contact) {
    read_fields<ContactSpec>(table, contact);
    if (const auto value = table.find("sleep")) {
        const auto* off = value->node().as_boolean();
        if (!value->node().is_table() && (off == nullptr || off->get()))
            value->refuse("false, or a table { speed = 0.03, angular_speed = 0.05, time = 0.5 }");
        if (value->node().is_table()) {
            Table sleep(value->place(), *value->node().as_table());
            contact.sleep.emplace();
            sleep.optional("speed", contact.sleep->speed, Quantity{Quantity::positive, "m/s"});
            sleep.optional("angular_speed", contact.sleep->angular_speed, Quantity{Quantity::positive, "rad/s"});
            sleep.optional("time", contact.sleep->time, seconds);
            sleep.finish();
        }
    }
    table.finish();
}

// Adds a plane, a body or a joint to its list. No other may have its name, which a joint may have from its bodies.
template <class T>
void add_named(std::vector<T>& list, T item, Table& table, std::set<std::string>& names) {
    if (!names.insert(item.name).second)
        (table.has("name") ? table.at("name").place() : table.place())
            .fail("the name " + in_quotes(item.name) + " is taken", "a name of its own");
    list.push_back(std::move(item));
}

// Refuses the first element for which there is no room.
void check_count(const std::vector<Table>& tables, int room) {
    const auto most = static_cast<std::size_t>(room);
    if (tables.size() > most)
        tables[most].place().fail("got " + std::to_string(tables.size()) + " of them",
                                  "at most " + std::to_string(room));
}

// The name of a file without its directory and its last extension.
std::string stem_of(const std::string& file) {
    const std::string name = file.substr(file.find_last_of('/') + 1);
    const std::size_t dot = name.find_last_of('.');
    return dot == std::string::npos || dot == 0 ? name : name.substr(0, dot);
}

SceneDescription read_root(Table root, const std::string& file, BodyCount count) {
    SceneDescription scene;
    scene.path = file;
    scene.name = stem_of(file);

    // every key of the top level is asked for before any table is read, so that a misspelt table name is the first
    // error
    root.optional("name", scene.name);
    auto world = root.table("world");
    if (!world) root.missing("world", "the table [world] with step and duration (s)");
    const auto range = root.table("range");
    const auto contact = root.table("contact");
    const auto gravity_gradient = root.table("gravity_gradient");
    const auto planes = root.tables("plane");
    const auto bodies = root.tables("body");
    const auto springs = root.tables("spring");
    const auto joints = root.tables("joint");
    const auto impulses = root.tables("impulse");
    const auto forces = root.tables("force");
    const auto events = root.tables("event");
    const auto expect = root.table("expect");
    root.finish();

    read_world(*world, scene);
    if (range) read_range(*range, scene.range);
    if (contact) read_contact(*contact, scene.contact);
    if (gravity_gradient) scene.gravity_gradient = read_gravity_gradient(*gravity_gradient);
    std::set<std::string> names;
    check_count(planes, max_planes);
    check_count(bodies, max_bodies);
    check_count(springs, max_springs);
    check_count(joints, max_joints);
    for (Table table : planes) add_named(scene.planes, read_plane(table, scene.range), table, names);
    // After the tables: where `body = [...]` stands below [world] or a plane, it is an unknown key of theirs.
    if (bodies.empty() && count == BodyCount::at_least_one) root.fail("body", "missing", "at least one [[body]]");
    for (Table table : bodies) add_named(scene.bodies, read_body(table, scene, scene.range), table, names);
    check_felt(scene, *world, gravity_gradient);
    for (const Table& table : springs) scene.springs.push_back(read_spring(table, scene, scene.range));
    for (Table table : joints) add_named(scene.joints, read_joint(table, scene, scene.range), table, names);
    for (const Table& table : impulses) scene.impulses.push_back(read_impulse(table, scene));
    for (const Table& table : forces) scene.forces.push_back(read_force(table, scene));
    for (const Table& table : events) scene.events.push_back(read_event(table, scene, scene.range));
    check_layers_of_joints(bodies, joints, scene);
    if (expect) scene.expected = read_expectation(*expect);
    return scene;
}

}  // namespace

void check_not_zero(const Value& value, const double* numbers, std::size_t count, const std::string& wanted) {
    if (std::isnormal(std::inner_product(numbers, numbers + count, numbers, 0.0))) return;
    const double largest = std::abs(
        *std::max_element(numbers, numbers + count, [](double a, double b) { return std::abs(a) < std::abs(b); }));
    value.fail(largest > 0 ? "its length is below 1e-150, too short to have a direction" : "its length is 0", wanted);
}

void check_range(const Value& value, double number, double most, const std::string& unit, const std::string& what,
                 RangeDescription& range) {
    if (std::abs(number) <= most || range.beyond_default) return;
    const std::string wanted = "a number from -" + shown(most) + " to " + shown(most) + " (" + unit + "), " + what;
    if (range.is_declared) value.refuse(wanted + " of this scene");
    range.beyond_default = value.refusal(wanted + " without [range], which fixed point needs here; --numbers f64 and "
                                                  "f32 need none");
}

void check_range(Table& table, const std::string& key, const Triple& numbers, const std::string& what,
                 RangeDescription& range) {
    if (!table.has(key)) return;
    const bool is_velocity = what == "velocity", is_spin = what == "angular_velocity";
    const double most = is_spin ? range.angular_velocity : is_velocity ? range.velocity : range.position;
    for (std::size_t i = 0; i < numbers.size(); ++i)
        check_range(table.at(key)[i], numbers[i], most,
                    is_spin       ? "rad/s"
                    : is_velocity ? "m/s"
                                  : "m",
                    "the range." + what, range);
}

SceneDescription read_scene_text(std::string_view toml, std::string_view name, BodyCount bodies) {
    const std::string file(name);
    const Document document(toml, file);
    return read_root(document.root(), file, bodies);
}

}  // namespace tumble::host
