// A `Table` hands out the keys of one TOML table and remembers them, so that finish() can report the ones nobody asked
// for. A `Value` is a TOML node that knows its place in the file; all messages are made from those two.
#include "scene/reader.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <system_error>
#include <utility>

// toml++ 3.3 asserts (or, with NDEBUG, lets the compiler assume) that a key follows '[', although its parser reports
// the error "[=]" well.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(condition) static_assert(true)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

namespace tumble::host {
namespace {

// What a number must be, and its unit; `parts` names the elements of an array.
struct Quantity {
    enum Bound { any, positive, not_negative, zero_to_one } bound;
    const char* unit = "";
    const char* parts = "";
};

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
constexpr Quantity text_in_quotes{};  // tag: the value is a string

// The largest preset, `field`: what no [range] may exceed.
constexpr RangeDescription field{32768.0, 2048.0, 256.0};

constexpr double moment_tolerance = 1e-12;  // relative: rounding of moments computed from a tensor or from points

std::string shown(double x) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), x).ptr;
    return {text.data(), end};
}

std::string in_quotes(std::string_view text) { return "\"" + std::string(text) + "\""; }

// "a", "b" or "c"
template <class Names>
std::string listed(const Names& names) {
    std::string list;
    const std::size_t count = names.size();
    std::size_t i = 0;
    for (const auto& name : names) {
        if (i > 0) list += i + 1 == count ? " or " : ", ";
        list += in_quotes(name);
        ++i;
    }
    return list;
}

std::string shown(const toml::node& node) {
    if (const auto* x = node.as_integer()) return std::to_string(x->get());
    if (const auto* x = node.as_floating_point()) return shown(x->get());
    if (const auto* x = node.as_string()) return in_quotes(x->get());
    if (const auto* x = node.as_boolean()) return x->get() ? "true" : "false";
    if (node.is_array_of_tables()) return "an array of tables";
    if (const auto* x = node.as_array()) return "an array of " + std::to_string(x->size());
    return node.is_table() ? "a table" : "a date or time";
}

std::string expected(const Quantity& quantity, std::size_t count = 1) {
    const bool one = count == 1;
    std::string text = one ? "a " : std::to_string(count) + " ";
    text += quantity.bound == Quantity::positive      ? "positive finite number"
            : quantity.bound == Quantity::zero_to_one ? "number"
                                                      : "finite number";
    if (!one) text += "s";
    if (quantity.bound == Quantity::not_negative) text += " >= 0";
    if (quantity.bound == Quantity::zero_to_one) text += " from 0 to 1";
    if (!one && *quantity.parts != 0) text += " [" + std::string(quantity.parts) + "]";
    if (*quantity.unit != 0) text += " (" + std::string(quantity.unit) + ")";
    return text;
}

bool holds(const Quantity& quantity, double x) {
    switch (quantity.bound) {
    case Quantity::positive: return std::isfinite(x) && x > 0.0;
    case Quantity::not_negative: return std::isfinite(x) && x >= 0.0;
    case Quantity::zero_to_one: return x >= 0.0 && x <= 1.0;
    case Quantity::any: break;
    }
    return std::isfinite(x);
}

// Number of single-letter edits (insert, delete, replace) between two words.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i);
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
            diagonal = std::exchange(row[j], std::min({replaced, row[j] + 1, row[j - 1] + 1}));
        }
    }
    return row[b.size()];
}

// " (did you mean "mass"?)", or nothing when no name is near.
template <class Names>
std::string suggestion(std::string_view word, const Names& names) {
    std::size_t nearest = std::max<std::size_t>(1, word.size() / 2) + 1;
    std::string text;
    for (const auto& name : names) {
        const std::size_t distance = edit_distance(word, name);
        if (distance < nearest) {
            nearest = distance;
            text = " (did you mean " + in_quotes(name) + "?)";
        }
    }
    return text;
}

struct Place {
    std::string file;
    int line = 0;
    std::string key;

    [[noreturn]] void fail(const std::string& problem, const std::string& wanted) const {
        throw SceneError(file, line, key, problem + ", expected " + wanted);
    }
};

int line_of(const toml::source_region& source) { return static_cast<int>(source.begin.line); }

class Value {
public:
    Value(Place place, const toml::node& node) : place_(std::move(place)), node_(&node) {}

    [[nodiscard]] const toml::node& node() const { return *node_; }
    [[nodiscard]] const Place& place() const { return place_; }
    [[noreturn]] void fail(const std::string& problem, const std::string& wanted) const {
        place_.fail(problem, wanted);
    }
    [[noreturn]] void refuse(const std::string& wanted) const { fail("got " + shown(*node_), wanted); }

    // Element i of an array.
    [[nodiscard]] Value operator[](std::size_t i) const {
        const toml::node& element = *node_->as_array()->get(i);
        return {{place_.file, line_of(element.source()), place_.key + "[" + std::to_string(i) + "]"}, element};
    }

    [[nodiscard]] double number(const Quantity& quantity) const {
        const auto number = node_->is_number() ? node_->value<double>() : std::nullopt;
        if (!number || !holds(quantity, *number)) refuse(expected(quantity));
        return *number;
    }

    // An array of as many numbers as one of `counts`.
    [[nodiscard]] std::vector<double> numbers(const Quantity& quantity,
                                              std::initializer_list<std::size_t> counts) const {
        const toml::array* array = node_->as_array();
        if (array == nullptr || std::find(counts.begin(), counts.end(), array->size()) == counts.end()) {
            std::string wanted;
            for (const std::size_t count : counts) wanted += (wanted.empty() ? "" : " or ") + expected(quantity, count);
            refuse(wanted);
        }
        std::vector<double> numbers;
        for (std::size_t i = 0; i < array->size(); ++i) numbers.push_back((*this)[i].number(quantity));
        return numbers;
    }

    [[nodiscard]] const std::string& text(const std::string& wanted) const {
        const auto* text = node_->as_string();
        if (text == nullptr || text->get().empty()) refuse(wanted);
        return text->get();
    }

private:
    Place place_;
    const toml::node* node_;
};

// One choice of a fixed set of words.
template <class T>
using Words = std::vector<std::pair<std::string, T>>;

template <class T>
std::vector<std::string> keys_of(const Words<T>& words) {
    std::vector<std::string> keys;
    for (const auto& [word, meaning] : words) keys.push_back(word);
    return keys;
}

const Words<Frame> frames{{"world", Frame::world}, {"body", Frame::body}};
const Words<ContactResponse> responses{
    {"impulse", ContactResponse::impulse}, {"spring", ContactResponse::spring}, {"none", ContactResponse::none}};

// One conversion per C++ type, and what it expects of the file.
std::string wanted(const double&, const Quantity& quantity) { return expected(quantity); }
std::string wanted(const std::string&, const Quantity&) { return "text in quotes, not empty"; }
std::string wanted(const StepSize&, const Quantity&) {
    return "a positive number or a fraction in quotes such as \"1/256\" (s)";
}
std::string wanted(const bool&, const Quantity&) { return "true or false"; }
template <std::size_t N>
std::string wanted(const std::array<double, N>&, const Quantity& quantity) {
    return expected(quantity, N);
}
template <class T>
std::string wanted(const T&, const Words<T>& words) {
    return listed(keys_of(words));
}

void convert(const Value& value, double& out, const Quantity& quantity) { out = value.number(quantity); }
void convert(const Value& value, std::optional<double>& out, const Quantity& quantity) { out = value.number(quantity); }
void convert(const Value& value, std::string& out, const Quantity& quantity) {
    out = value.text(wanted(out, quantity));
}
void convert(const Value& value, bool& out, const Quantity& quantity) {
    if (!value.node().is_boolean()) value.refuse(wanted(out, quantity));
    out = value.node().as_boolean()->get();
}
void convert(const Value& value, StepSize& out, const Quantity& quantity) {
    std::optional<StepSize> step;
    if (const auto* text = value.node().as_string()) step = parse_step(text->get());
    else if (const double x = value.node().value<double>().value_or(0.0);
             value.node().is_number() && holds(quantity, x))
        step = StepSize{0, 0, x};
    if (!step) value.refuse(wanted(out, quantity));
    out = *step;
}
template <std::size_t N>
void convert(const Value& value, std::array<double, N>& out, const Quantity& quantity) {
    const auto numbers = value.numbers(quantity, {N});
    std::copy(numbers.begin(), numbers.end(), out.begin());
}
template <class T>
void convert(const Value& value, T& out, const Words<T>& words) {
    const auto names = keys_of(words);
    const std::string& text = value.text(listed(names));
    const auto word = std::find(names.begin(), names.end(), text);
    if (word == names.end()) value.fail("got " + in_quotes(text) + suggestion(text, names), listed(names));
    out = words[static_cast<std::size_t>(word - names.begin())].second;
}

class Table {
public:
    Table(Place place, const toml::table& table) : place_(std::move(place)), table_(&table) {}

    // The value of a key, which is known from now on.
    [[nodiscard]] std::optional<Value> find(const std::string& key) {
        known_.insert(key);
        const auto entry = table_->find(key);
        if (entry == table_->end()) return std::nullopt;
        return Value(place_of(key, line_of(entry->first.source())), entry->second);
    }

    [[nodiscard]] bool has(const std::string& key) const { return table_->contains(key); }

    // For checks on a key that is there.
    [[nodiscard]] Value at(const std::string& key) { return find(key).value(); }

    template <class T, class How = Quantity>
    bool optional(const std::string& key, T& out, const How& how = text_in_quotes) {
        const auto value = find(key);
        if (value) convert(*value, out, how);
        return value.has_value();
    }

    template <class T, class How = Quantity>
    void required(const std::string& key, T& out, const How& how = text_in_quotes) {
        if (!optional(key, out, how)) missing(key, wanted(out, how));
    }

    // Remembers that a key is missing; finish() reports it unless a misspelt key explains it.
    void missing(const std::string& key, const std::string& wanted) {
        if (!missing_) missing_ = {key, wanted};
    }

    // Throws for the first unknown key, else for the first missing one. Checks across keys come after it.
    void finish() const {
        const toml::key* unknown = nullptr;
        for (const auto& [key, value] : *table_)
            if (!known_.contains(std::string(key.str())) &&
                (unknown == nullptr || line_of(key.source()) < line_of(unknown->source())))
                unknown = &key;
        if (unknown != nullptr)
            place_of(std::string(unknown->str()), line_of(unknown->source()))
                .fail("unknown key" + suggestion(unknown->str(), known_), listed(known_));
        if (missing_) place_of(missing_->first, place_.line).fail("missing", missing_->second);
    }

    // Reports a rule across keys at the line of the table.
    [[noreturn]] void fail(const std::string& key, const std::string& problem, const std::string& wanted) const {
        place_of(key, place_.line).fail(problem, wanted);
    }

    [[nodiscard]] std::optional<Table> table(const std::string& key) {
        const auto value = find(key);
        if (!value) return std::nullopt;
        if (!value->node().is_table()) value->refuse("a table, [" + value->place().key + "]");
        return Table(value->place(), *value->node().as_table());
    }

    [[nodiscard]] std::vector<Table> tables(const std::string& key) {
        const auto value = find(key);
        std::vector<Table> list;
        if (!value) return list;
        const std::string wanted = "an array of tables, [[" + key + "]]";
        if (!value->node().is_array()) value->refuse(wanted);
        for (std::size_t i = 0; i < value->node().as_array()->size(); ++i) {
            const Value element = (*value)[i];
            if (!element.node().is_table()) element.refuse("a table, as in " + wanted);
            list.emplace_back(element.place(), *element.node().as_table());
        }
        return list;
    }

private:
    [[nodiscard]] Place place_of(const std::string& key, int line) const {
        return {place_.file, line, place_.key.empty() ? key : place_.key + "." + key};
    }

    Place place_;
    const toml::table* table_;
    std::set<std::string> known_;
    std::optional<std::pair<std::string, std::string>> missing_;
};

using Tensor = std::array<double, 6>;  // Ixx, Iyy, Izz, Ixy, Ixz, Iyz

// Eigenvalues of a symmetric 3x3 tensor, smallest first: cyclic Jacobi rotations, which keep the accuracy where two are
// equal.
Triple principal_moments(const Tensor& tensor) {
    double a[3][3] = {
        {tensor[0], tensor[3], tensor[4]}, {tensor[3], tensor[1], tensor[5]}, {tensor[4], tensor[5], tensor[2]}};
    const auto rotate = [&a](int p, int q) {
        if (a[p][q] == 0.0) return;
        const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
        const double c = 1.0 / std::hypot(t, 1.0), s = t * c;
        const int r = 3 - p - q;
        const double arp = a[r][p], arq = a[r][q];
        a[p][p] -= t * a[p][q];
        a[q][q] += t * a[p][q];
        a[p][q] = a[q][p] = 0.0;
        a[r][p] = a[p][r] = c * arp - s * arq;
        a[r][q] = a[q][r] = s * arp + c * arq;
    };
    for (int sweep = 0; sweep < 12; ++sweep) {  // convergence is quadratic: five sweeps reach rounding
        rotate(0, 1);
        rotate(0, 2);
        rotate(1, 2);
    }
    Triple moments{a[0][0], a[1][1], a[2][2]};
    std::sort(moments.begin(), moments.end());
    return moments;
}

// Inertia of point masses about their centre of mass.
Tensor inertia_of(const std::vector<PointMass>& points) {
    double mass = 0.0;
    Triple centre{};
    for (const PointMass& point : points) {
        mass += point.mass;
        for (std::size_t i = 0; i < 3; ++i) centre[i] += (point.position[i] - centre[i]) * (point.mass / mass);
    }
    Tensor tensor{};
    for (const PointMass& point : points) {
        const double x = point.position[0] - centre[0], y = point.position[1] - centre[1],
                     z = point.position[2] - centre[2];
        const Tensor unit{y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z};
        for (std::size_t i = 0; i < 6; ++i) tensor[i] += point.mass * unit[i];
    }
    return tensor;
}

// One row per shape: how many sizes it has, and whether it encloses a volume (else density means nothing).
struct ShapeRow {
    const char* key;
    ShapeKind kind;
    std::size_t sizes;
    const char* parts;
    bool has_volume;
};

constexpr ShapeRow shape_rows[] = {
    {"box", ShapeKind::box, 3, "x edge, y edge, z edge", true},   {"sphere", ShapeKind::sphere, 1, "radius", true},
    {"cylinder", ShapeKind::cylinder, 2, "radius, height", true}, {"hoop", ShapeKind::hoop, 1, "radius", false},
    {"capsule", ShapeKind::capsule, 2, "radius, length", true},   {"points", ShapeKind::points, 0, "", false},
};

bool has_volume(ShapeKind kind) {
    return std::any_of(std::begin(shape_rows), std::end(shape_rows),
                       [kind](const ShapeRow& row) { return row.kind == kind && row.has_volume; });
}

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
    const Triple moments = principal_moments(*body.inertia);
    const std::string problem =
        "the principal moments are " + shown(moments[0]) + ", " + shown(moments[1]) + " and " + shown(moments[2]);
    const double smallest = body.inertia_is_diagonal ? 0.0 : moment_tolerance * moments[2];
    if (!std::isfinite(moments[2]) || !(moments[0] > smallest))
        value.fail(problem, "all of them positive and finite (kg m^2)");
    if (moments[2] - moments[1] - moments[0] > moment_tolerance * moments[2])
        value.fail(problem, "none of them larger than the sum of the other two: the triangle inequality (kg m^2)");
}

void check_not_zero(const Value& value, const double* numbers, std::size_t count, const std::string& wanted) {
    const double square = std::inner_product(numbers, numbers + count, numbers, 0.0);
    if (!std::isnormal(square)) value.fail(square > 1.0 ? "its length is too large" : "its length is 0", wanted);
}

void check_inside(Table& table, const std::string& key, const Triple& numbers, double range, const char* unit) {
    for (std::size_t i = 0; i < 3; ++i)
        if (std::abs(numbers[i]) > range)
            table.at(key)[i].refuse("a number from -" + shown(range) + " to " + shown(range) + " (" + unit +
                                    "), the range." + key + " of this scene");
}

// Mass, density and inertia must together say what the body weighs and how it turns.
void check_mass(Table& table, const BodyDescription& body) {
    const ShapeKind kind = body.shape.kind;
    if (kind == ShapeKind::points) {
        for (const char* key : {"mass", "density"})
            if (table.has(key))
                table.at(key).fail("given with shape points", "no mass or density: the points carry the mass");
    } else if (body.mass && body.density) {
        table.at("density").fail("mass and density are both given", "one of them");
    } else if (body.density && !has_volume(kind)) {
        table.at("density").fail("given for a shape without volume", "mass (kg)");
    } else if (!body.mass && !body.density) {
        table.fail("mass", "missing", has_volume(kind) ? "mass (kg) or density (kg/m^3)" : "mass (kg)");
    }

    if (body.inertia) return check_moments(table.at("inertia"), body);
    if (kind == ShapeKind::none)
        table.fail("inertia", "missing", "3 or 6 numbers (kg m^2): a body without shape has no moments of its own");
    if (kind == ShapeKind::points) {
        const Triple moments = principal_moments(inertia_of(body.shape.points));
        if (!std::isfinite(moments[2]))
            table.at("shape").fail("the points have no finite principal moments",
                                   "smaller masses or distances (kg, m)");
        if (!(moments[0] > moment_tolerance * moments[2]))
            table.at("shape").fail("the points lie on one line, so that a principal moment is 0",
                                   "points off that line, or inertia = [...] (kg m^2)");
        return;
    }

    // the derived mass and moments are products of these: they must neither vanish nor overflow
    const auto& size = body.shape.size;
    const double largest = *std::max_element(size.begin(), size.end());
    const double smallest = std::accumulate(size.begin(), size.end(), largest,
                                            [](double a, double b) { return b > 0.0 ? std::min(a, b) : a; });
    const double light = body.mass ? *body.mass : *body.density * smallest * smallest * smallest;
    const double heavy = body.mass ? *body.mass : *body.density * largest * largest * largest;
    if (!std::isnormal(light * smallest * smallest) || !std::isfinite(16.0 * heavy * largest * largest))
        table.at("shape").fail("mass and moments of inertia of this shape are not representable",
                               "sizes (m) and mass (kg) that give positive finite moments");
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
    if (turned)
        check_not_zero(table.at("orientation"), body.orientation.data(), 4,
                       "a quaternion [w, x, y, z] that is not zero");
    check_inside(table, "position", body.position, range.position, "m");
    check_inside(table, "velocity", body.velocity, range.velocity, "m/s");
    check_inside(table, "angular_velocity", body.angular_velocity, range.angular_velocity, "rad/s");
    return body;
}

PlaneDescription read_plane(Table table) {
    PlaneDescription plane;
    table.required("name", plane.name);
    table.required("normal", plane.normal, Quantity{Quantity::any, "", "x, y, z"});
    table.optional("offset", plane.offset, Quantity{Quantity::any, "m"});
    table.optional("restitution", plane.restitution, restitution);
    table.optional("friction", plane.friction, friction);
    table.finish();
    check_not_zero(table.at("normal"), plane.normal.data(), 3, "a vector [x, y, z] that is not zero");
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
    std::vector<std::string> names;
    for (const BodyDescription& body : scene.bodies) names.push_back(body.name);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        table.at(key).fail("got " + in_quotes(name) + suggestion(name, names), "the name of a body: " + listed(names));
    return static_cast<int>(found - names.begin());
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

    spring.body = resolve(table, "body", body, scene);
    const std::string ends = "either to = [x, y, z] (m, a world point) or to_body = \"name\"";
    if (to_world && to_other) table.at("to_body").fail("to and to_body are both given", ends);
    if (!to_world && !to_other) table.fail("to", "missing", ends);
    if (has_to_point && !to_other)
        table.at("to_point").fail("given without to_body", "to_body = \"name\" beside it, or no to_point");
    if (to_other) {
        spring.to_body = resolve(table, "to_body", to_body, scene);
        spring.to = to_point;
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
    const ShapeDescription& shape = scene.bodies[static_cast<std::size_t>(impulse.body)].shape;
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
    if (has_face) push_face(table, face, strength, scene, impulse);
    if (has_face && !has_strength)
        table.fail("strength", "missing", expected({Quantity::positive, "N s"}) + " beside face");
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

// Line of the first byte outside ASCII that is in neither a string nor a comment; 0 when there is none. TOML allows
// none there, but toml++ 3.3 takes some of them (such as a bare micro sign) for unreachable code instead of reporting
// them.
int line_of_bare_non_ascii(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark
    int line = 1;
    std::string_view close;  // what ends the string or comment that is open
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const bool one_line = close.size() == 1;
        if (c == '\n') ++line;
        if (close.empty()) {
            if (static_cast<unsigned char>(c) >= 0x80) return line;
            if (c == '#') close = "\n";
            for (const std::string_view quote : {"\"\"\"", "'''", "\"", "'"}) {
                if (!close.empty() || !text.substr(i).starts_with(quote)) continue;
                close = quote;
                i += quote.size() - 1;
            }
        } else if (c == '\\' && close[0] == '"') {
            ++i;
            if (i < text.size() && text[i] == '\n') ++line;
        } else if (text.substr(i).starts_with(close)) {
            i += close.size() - 1;
            close = {};
        } else if (c == '\n' && one_line) {
            close = {};  // an unfinished string: the parser reports it
        }
    }
    return 0;
}

SceneDescription read_root(Table root, const std::string& file) {
    SceneDescription scene;
    scene.path = file;
    scene.name = std::filesystem::path(file).stem().string();

    // every key of the top level is asked for before any table is read, so that a misspelt table name is the first
    // error
    root.optional("name", scene.name);
    const auto world = root.table("world");
    if (!world) root.missing("world", "the table [world] with step and duration (s)");
    const auto range = root.table("range");
    const auto contact = root.table("contact");
    const auto planes = root.tables("plane");
    const auto bodies = root.tables("body");
    if (bodies.empty()) root.missing("body", "at least one [[body]]");
    const auto springs = root.tables("spring");
    const auto impulses = root.tables("impulse");
    const auto forces = root.tables("force");
    root.finish();

    read_world(*world, scene);
    if (range) read_range(*range, scene.range);
    if (contact) read_contact(*contact, scene.contact);
    std::set<std::string> names;
    for (Table table : planes) add_named(scene.planes, read_plane(table), table, names);
    for (Table table : bodies) add_named(scene.bodies, read_body(table, scene.range), table, names);
    for (const Table& table : springs) scene.springs.push_back(read_spring(table, scene));
    for (const Table& table : impulses) scene.impulses.push_back(read_impulse(table, scene));
    for (const Table& table : forces) scene.forces.push_back(read_force(table, scene));
    return scene;
}

}  // namespace

SceneError::SceneError(std::string file, int line, std::string key, const std::string& message)
    : std::runtime_error(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " + (key.empty() ? "" : key + ": ") +
                         message),
      file_(std::move(file)), line_(line), key_(std::move(key)) {}

SceneDescription read_scene(const std::filesystem::path& path) {
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
    const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (stream.bad()) throw refuse("reading it failed");
    return read_scene_text(text, path.string());
}

SceneDescription read_scene_text(std::string_view toml, std::string_view name) {
    const std::string file(name);
    if (const int line = line_of_bare_non_ascii(toml); line > 0)
        throw SceneError(file, line, "TOML syntax",
                         "a character outside ASCII, expected such only in quotes and comments");
    try {
        const toml::table table = toml::parse(toml, name);
        return read_root(Table({file, 1, ""}, table), file);
    } catch (const toml::parse_error& error) {
        throw SceneError(file, line_of(error.source()), "TOML syntax",
                         std::string(error.description()) + ", expected valid TOML 1.0");
    }
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
    if (code != std::errc{} || last != end || !holds({Quantity::positive}, step.decimal)) return std::nullopt;
    return step;
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
