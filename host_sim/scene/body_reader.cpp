// Tables of bodies: shape, mass and inertia, and the state at the start.
#include <tumble/shapes/shape.hpp>

#include <algorithm>

#include "scene/data.hpp"
#include "scene/reading.hpp"

namespace tumble::host {
namespace {

constexpr double longest_reach = 1e8;  // m, of a shape from its centre: the longest length of contacts in fixed point

constexpr double moment_tolerance = 1e-12;  // relative: rounding of moments computed from a tensor or from points

// kg, of a fixed body whose mass the file leaves out. No motion depends on it.
constexpr double mass_of_fixed = 1;

// Smallest first.
Triple moments_of(const InertiaTensor& tensor) {
    const RealVec3 moments = principal_inertia(tensor).moments;
    return {moments.z.to_double(), moments.y.to_double(), moments.x.to_double()};
}

// One row per shape: how many sizes it has.
struct ShapeRow {
    ShapeKind kind;
    std::size_t sizes;
    const char* parts;
};

constexpr ShapeRow shape_rows[] = {
    {ShapeKind::box, 3, "x edge, y edge, z edge"}, {ShapeKind::sphere, 1, "radius"},
    {ShapeKind::cylinder, 2, "radius, height"},    {ShapeKind::hoop, 1, "radius"},
    {ShapeKind::capsule, 2, "radius, length"},     {ShapeKind::points, 0, ""},
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
        const auto entry = table.find(word_of(row.kind));
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

// Mass, density and inertia must together give the body's mass and moments; a body without shape and inertia has no
// moments. A fixed body needs a mass only to attract others.
void check_mass(Table& table, BodyDescription& body, bool attracts) {
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
    } else if (!body.mass && !body.density && body.fixed && !attracts) {
        body.mass = mass_of_fixed;
    } else if (!body.mass && !body.density) {
        table.fail("mass", "missing",
                   std::string(has_volume ? "mass (kg) or density (kg/m^3)" : "mass (kg)") +
                       (body.fixed ? ": with world.gravitation a fixed body attracts by its mass" : ""));
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

// The message has a cure, because elsewhere a mass of 0 may stand for a body that never moves.
std::optional<double> read_mass(Table& table) {
    const Quantity kilograms{Quantity::positive, "kg"};
    std::optional<double> mass;
    const auto value = table.find("mass");
    if (value && value->any_number() == 0.0)
        value->refuse(kilograms.expected() + "; a body that never moves has fixed = true instead, and needs no mass");
    table.optional("mass", mass, kilograms);
    return mass;
}

// A point mass has no rotation: a number that gives it one is an error.
void refuse_to_turn(Table& table, const std::string& key, const double* numbers, std::size_t count,
                    const BodyDescription& body, const std::string& otherwise) {
    if (body.is_point_mass() && std::any_of(numbers, numbers + count, [](double x) { return x != 0.0; }))
        table.at(key).fail("body " + in_quotes(body.name) + " is a point mass, which has no rotation",
                           otherwise + ", or a shape or inertia = [...] (kg m^2) of the body");
}

}  // namespace

void refuse_to_turn(Table& table, const std::string& key, const Triple& numbers, const BodyDescription& body) {
    refuse_to_turn(table, key, numbers.data(), numbers.size(), body, "[0, 0, 0] or no " + key);
}

BodyDescription read_body(Table table, const SceneDescription& scene, RangeDescription& range) {
    BodyDescription body;
    table.required("name", body.name);
    if (const auto shape = table.find("shape")) body.shape = read_shape(*shape, shape->place().key);
    else table.missing("shape", "\"none\" or a table such as { box = [x, y, z] } (m)");
    body.mass = read_mass(table);
    table.optional("density", body.density, Quantity{Quantity::positive, "kg/m^3"});
    if (const auto inertia = table.find("inertia")) {
        auto numbers = inertia->numbers({Quantity::any, "kg m^2"}, {3, 6});
        numbers.resize(6);
        body.inertia.emplace();
        std::copy(numbers.begin(), numbers.end(), body.inertia->begin());
        body.inertia_is_diagonal = numbers[3] == 0.0 && numbers[4] == 0.0 && numbers[5] == 0.0;
    }
    read_fields<BodySpec>(table, body);
    const bool turned = table.has("orientation");
    table.optional("linear_drag", body.linear_drag, Quantity{Quantity::not_negative, "kg/s"});
    table.optional("quadratic_drag", body.quadratic_drag, Quantity{Quantity::not_negative, "kg/m"});
    table.optional("wheel_momentum", body.wheel_momentum, Quantity{Quantity::any, "N m s", "x, y, z"});
    body.fixed = body.fixed || body.kinematic;
    table.finish();

    check_mass(table, body, scene.gravitation > 0);
    if (const double reach = reach_of(shape_of(body.shape)).to_double(); reach > longest_reach)
        table.at("shape").fail("it reaches " + shown(reach) + " m from its centre",
                               "sizes (m) with which it reaches at most " + shown(longest_reach) + " m");
    if (turned)
        check_not_zero(table.at("orientation"), body.orientation.data(), 4,
                       "a quaternion [w, x, y, z] that is not zero");
    refuse_to_turn(table, "orientation", body.orientation.data() + 1, 3, body, "[1, 0, 0, 0] or no orientation");
    refuse_to_turn(table, "angular_velocity", body.angular_velocity, body);
    refuse_to_turn(table, "wheel_momentum", body.wheel_momentum, body);
    check_range(table, "position", body.position, "position", range);
    check_range(table, "velocity", body.velocity, "velocity", range);
    check_range(table, "angular_velocity", body.angular_velocity, "angular_velocity", range);
    return body;
}

}  // namespace tumble::host
