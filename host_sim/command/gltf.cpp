#include "command/gltf.hpp"

#include <tumble/version.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "tools/text.hpp"
#include "truth/motion.hpp"

namespace tumble::host {
namespace {

using Json = nlohmann::ordered_json;
using Colour = std::array<double, 3>;  // red, green, blue, 0 to 1, linear

constexpr int around = 32;                  // corners of a circle
constexpr double point_mass_radius = 0.05;  // m, of the ball that shows a point mass
constexpr double tube = 1.0 / 32;           // radius of a hoop's tube, of the hoop's radius

// Numbers of the specification.
constexpr int float_component = 5126, unsigned_int_component = 5125, array_buffer = 34962, element_array_buffer = 34963;

struct Mesh {
    std::vector<float> positions, normals;  // three numbers a corner
    std::vector<std::uint32_t> corners;     // three a triangle, counterclockwise from outside

    std::uint32_t add(const Triple& position, const Triple& normal) {
        for (const double x : position) positions.push_back(static_cast<float>(x));
        for (const double x : normal) normals.push_back(static_cast<float>(x));
        return static_cast<std::uint32_t>(positions.size() / 3 - 1);
    }
    void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { corners.insert(corners.end(), {a, b, c}); }
};

// A point of the outline of a surface of revolution about z.
struct Outline {
    double radius, z;                // m
    double normal_radius, normal_z;  // of unit length, outwards
};
// The surface between the points, which go up along its outside.
void revolve(Mesh& mesh, const std::vector<Outline>& outline, const Triple& centre = {}) {
    std::vector<std::uint32_t> last;
    bool is_last_a_point = false;
    for (const Outline& point : outline) {
        const bool is_point = std::abs(point.radius) < 1e-12;
        std::vector<std::uint32_t> ring;
        for (int k = 0; k <= around; ++k) {
            const double angle = 2 * std::numbers::pi * k / around, c = std::cos(angle), s = std::sin(angle);
            ring.push_back(mesh.add({centre[0] + point.radius * c, centre[1] + point.radius * s, centre[2] + point.z},
                                    {point.normal_radius * c, point.normal_radius * s, point.normal_z}));
        }
        for (std::size_t k = 0; !last.empty() && k + 1 < ring.size(); ++k) {
            if (!is_last_a_point) mesh.add_triangle(last[k], last[k + 1], ring[k + 1]);
            if (!is_point) mesh.add_triangle(last[k], ring[k + 1], ring[k]);
        }
        last = ring;
        is_last_a_point = is_point;
    }
}
// From the angle, above the equator, to the other.
void add_arc(std::vector<Outline>& outline, double radius, double z, double from, double to, int steps) {
    for (int i = 0; i <= steps; ++i) {
        const double angle = from + (to - from) * i / steps, c = std::cos(angle), s = std::sin(angle);
        outline.push_back({radius * c, z + radius * s, c, s});
    }
}
void add_ball(Mesh& mesh, double radius, const Triple& centre = {}) {
    std::vector<Outline> outline;
    add_arc(outline, radius, 0, -std::numbers::pi / 2, std::numbers::pi / 2, around / 2);
    revolve(mesh, outline, centre);
}
void add_box(Mesh& mesh, const Triple& edges) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (const double side : {-1.0, 1.0}) {
            std::uint32_t corner[4];
            for (int k = 0; k < 4; ++k) {
                Triple at{}, normal{};
                at[axis] = side * edges[axis] / 2;
                at[u] = (k == 1 || k == 2 ? side : -side) * edges[u] / 2;
                at[v] = (k >= 2 ? 1 : -1) * edges[v] / 2;
                normal[axis] = side;
                corner[k] = mesh.add(at, normal);
            }
            mesh.add_triangle(corner[0], corner[1], corner[2]);
            mesh.add_triangle(corner[0], corner[2], corner[3]);
        }
    }
}
void add_cylinder(Mesh& mesh, double radius, double height) {
    const double half = height / 2;
    revolve(mesh, {{0, -half, 0, -1}, {radius, -half, 0, -1}});
    revolve(mesh, {{radius, -half, 1, 0}, {radius, half, 1, 0}});
    revolve(mesh, {{radius, half, 0, 1}, {0, half, 0, 1}});
}
void add_capsule(Mesh& mesh, double radius, double length) {
    std::vector<Outline> outline;
    add_arc(outline, radius, -length / 2, -std::numbers::pi / 2, 0, around / 4);
    add_arc(outline, radius, length / 2, 0, std::numbers::pi / 2, around / 4);
    revolve(mesh, outline);
}
void add_hoop(Mesh& mesh, double radius) {
    std::vector<Outline> outline;
    for (int i = 0; i <= around / 2; ++i) {
        const double angle = 2 * std::numbers::pi * i / (around / 2), c = std::cos(angle), s = std::sin(angle);
        outline.push_back({radius * (1 + tube * c), radius * tube * s, c, s});
    }
    revolve(mesh, outline);
}
// Balls at the points, from their centre of mass.
void add_points(Mesh& mesh, const std::vector<PointDescription>& points) {
    Triple centre{};
    double mass = 0, reach = 0;
    for (const PointDescription& point : points) {
        mass += point.mass;
        for (std::size_t i = 0; i < 3; ++i) centre[i] += point.mass * point.position[i];
    }
    for (double& x : centre) x /= mass;
    const auto from_centre = [&](const Triple& p) {
        return Triple{p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
    };
    for (const PointDescription& point : points) {
        const Triple arm = from_centre(point.position);
        reach = std::max(reach, std::hypot(arm[0], arm[1], arm[2]));
    }
    for (const PointDescription& point : points)
        add_ball(mesh, reach > 0 ? reach / 16 : point_mass_radius, from_centre(point.position));
}
Mesh mesh_of(const ShapeDescription& shape) {
    Mesh mesh;
    switch (shape.kind) {
    case ShapeKind::none: add_ball(mesh, point_mass_radius); break;
    case ShapeKind::sphere: add_ball(mesh, shape.size[0]); break;
    case ShapeKind::box: add_box(mesh, shape.size); break;
    case ShapeKind::cylinder: add_cylinder(mesh, shape.size[0], shape.size[1]); break;
    case ShapeKind::hoop: add_hoop(mesh, shape.size[0]); break;
    case ShapeKind::capsule: add_capsule(mesh, shape.size[0], shape.size[1]); break;
    case ShapeKind::points: add_points(mesh, shape.points); break;
    }
    return mesh;
}
// A square about the origin, towards y.
Mesh square(double half) {
    Mesh mesh;
    std::uint32_t corner[4];
    for (int k = 0; k < 4; ++k)
        corner[k] = mesh.add({k == 0 || k == 3 ? -half : half, 0, k < 2 ? half : -half}, {0, 1, 0});
    mesh.add_triangle(corner[0], corner[1], corner[2]);
    mesh.add_triangle(corner[0], corner[2], corner[3]);
    return mesh;
}

// The file, and the bytes of its buffer.
class Document {
public:
    Document() {
        json_["asset"] = {{"version", "2.0"}, {"generator", "tumble " TUMBLE_VERSION}};
        json_["scene"] = 0;
        json_["scenes"] = Json::array({{{"nodes", Json::array()}}});
        for (const char* list : {"nodes", "meshes", "materials", "accessors", "bufferViews"})
            json_[list] = Json::array();
    }

    // Numbers, `each` of which belong together. Returns their accessor.
    template <class T>
    std::size_t add(const std::vector<T>& numbers, std::size_t each, int target = 0, bool with_bounds = false) {
        static constexpr const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
        Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", numbers.size() * sizeof(T)}};
        if (target != 0) view["target"] = target;
        json_["bufferViews"].push_back(view);
        for (const T number : numbers) {
            const auto bits = std::bit_cast<std::uint32_t>(number);
            for (int k = 0; k < 4; ++k) bytes_.push_back(static_cast<std::uint8_t>(bits >> 8 * k));  // the lowest first
        }
        Json accessor = {{"bufferView", json_["bufferViews"].size() - 1},
                         {"componentType", std::is_same_v<T, float> ? float_component : unsigned_int_component},
                         {"count", numbers.size() / each},
                         {"type", types[each - 1]}};
        for (std::size_t i = 0; with_bounds && i < each; ++i) {
            T least = numbers[i], most = numbers[i];
            for (std::size_t k = i; k < numbers.size(); k += each) {
                least = std::min(least, numbers[k]);
                most = std::max(most, numbers[k]);
            }
            accessor["min"].push_back(least);
            accessor["max"].push_back(most);
        }
        json_["accessors"].push_back(accessor);
        return json_["accessors"].size() - 1;
    }
    std::size_t add(const Mesh& mesh, const Colour& colour, bool both_sides) {
        json_["materials"].push_back({{"pbrMetallicRoughness",
                                       {{"baseColorFactor", {colour[0], colour[1], colour[2], 1.0}},
                                        {"metallicFactor", 0.0},
                                        {"roughnessFactor", 0.75}}},
                                      {"doubleSided", both_sides}});
        const std::size_t position = add(mesh.positions, 3, array_buffer, true),
                          normal = add(mesh.normals, 3, array_buffer),
                          indices = add(mesh.corners, 1, element_array_buffer);
        const Json primitive = {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
                                {"indices", indices},
                                {"material", json_["materials"].size() - 1}};
        json_["meshes"].push_back({{"primitives", Json::array({primitive})}});
        return json_["meshes"].size() - 1;
    }
    // A part of the scene, or of a part of it, with which it moves. Returns its node.
    std::size_t place(const std::string& name, std::size_t mesh, const auto& position, const auto& orientation,
                      std::optional<std::size_t> of = {}, const std::vector<float>& scale = {}) {
        json_["nodes"].push_back(
            {{"name", name}, {"mesh", mesh}, {"translation", position}, {"rotation", orientation}});
        const std::size_t node = json_["nodes"].size() - 1;
        if (!scale.empty()) json_["nodes"][node]["scale"] = scale;
        (of ? json_["nodes"][*of]["children"] : json_["scenes"][0]["nodes"]).push_back(node);
        return node;
    }
    // The numbers at the times are those of a node's "translation", "rotation" or "scale".
    void animate(std::size_t node, const char* path, std::size_t times, std::size_t numbers) {
        if (animation_.is_null()) animation_ = {{"channels", Json::array()}, {"samplers", Json::array()}};
        animation_["channels"].push_back(
            {{"sampler", animation_["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
        animation_["samplers"].push_back({{"input", times}, {"output", numbers}, {"interpolation", "LINEAR"}});
    }
    [[nodiscard]] std::string text() {
        if (json_["nodes"].empty())
            return Json{{"asset", json_["asset"]}}.dump() + "\n";  // lists have an element at least
        if (!animation_.is_null()) json_["animations"] = Json::array({animation_});
        json_["buffers"] =
            Json::array({{{"byteLength", bytes_.size()}, {"uri", "data:application/octet-stream;base64," + base64()}}});
        return json_.dump() + "\n";
    }

private:
    // RFC 4648.
    [[nodiscard]] std::string base64() const {
        static constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text;
        for (std::size_t i = 0; i < bytes_.size(); i += 3) {
            const std::size_t count = std::min<std::size_t>(3, bytes_.size() - i);
            std::uint32_t bits = 0;
            for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? bytes_[i + k] : 0u);
            for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[bits >> (18 - 6 * k) & 63] : '=';
        }
        return text;
    }

    Json json_, animation_;
    std::vector<std::uint8_t> bytes_;
};

// The shortest turn from an axis to the direction, which is of unit length: x, y, z, w.
std::array<double, 4> turn_from(std::size_t axis, const Triple& to) {
    if (to[axis] < -0.999999) return {1, 0, 0, 0};
    const double w = std::sqrt((1 + to[axis]) / 2);
    std::array<double, 4> turn{0, 0, 0, w};
    const std::size_t next = (axis + 1) % 3, last = (axis + 2) % 3;
    turn[next] = -to[last] / (2 * w);
    turn[last] = to[next] / (2 * w);
    return turn;
}

constexpr Colour of_planes{0.55, 0.55, 0.55}, of_fixed{0.3, 0.3, 0.35}, of_joints{0.02, 0.02, 0.02};
// Of Okabe and Ito (2008), which colour-blind readers tell apart, from sRGB.
constexpr Colour of_bodies[] = {{0.787, 0.346, 0}, {0.092, 0.456, 0.811}, {0, 0.342, 0.171},    {0.871, 0.776, 0.054},
                                {0, 0.168, 0.445}, {0.665, 0.112, 0},     {0.603, 0.191, 0.386}};

// How far corners of a mesh are from its origin along a direction of unit length, m.
double extent_along(const Mesh& mesh, const reference::Vector& direction) {
    double most = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); i += 3) {
        const reference::Vector corner{mesh.positions[i], mesh.positions[i + 1], mesh.positions[i + 2]};
        most = std::max(most, std::abs(static_cast<double>(dot(corner, direction))));
    }
    return most;
}

// The least extent of a mesh along its axes, from its origin, m.
double thickness_of(const Mesh& mesh) {
    return std::min({extent_along(mesh, {1, 0, 0}), extent_along(mesh, {0, 1, 0}), extent_along(mesh, {0, 0, 1})});
}
Triple triple(const reference::Vector& v) {
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
// The place of a point of the world at the start, in the axes of a body.
reference::Vector in_axes_of(const BodyDescription& body, const Triple& point) {
    return reference::rotation_of(body.orientation)
        .normalized()
        .rotate_back(reference::vector_of(point) - reference::vector_of(body.position));
}

// A joint but for a distance, which moves with its body: a ball; a cube of a fixed joint; pins along the axes of
// others, the longer and thinner one of a slider. All of them stand out of the body.
void place_joint(Document& document, const JointDescription& joint, const BodyDescription& body, const Mesh& mesh,
                 std::size_t node) {
    const reference::Rotation to_world = reference::rotation_of(body.orientation).normalized();
    const Triple at = triple(in_axes_of(body, joint.anchor));
    const double thickness = thickness_of(mesh);
    const auto add = [&](const Mesh& pin, const std::array<double, 4>& turn) {
        (void)document.place(joint.name, document.add(pin, of_joints, false), at, turn, node);
    };
    Mesh knob;
    if (joint.kind == JointKind::ball) add_ball(knob, 1.25 * thickness);
    if (joint.kind == JointKind::fixed) add_box(knob, {2.125 * thickness, 2.125 * thickness, 2.125 * thickness});
    if (!knob.positions.empty()) return add(knob, {0, 0, 0, 1});
    for (const Triple& axis : {joint.axis, joint.to_axis}) {
        if (axis == Triple{}) continue;
        const reference::Vector world = reference::vector_of(axis), own = to_world.rotate_back(unit(world));
        const bool slides = joint.kind == JointKind::slider;
        Mesh pin;
        add_cylinder(pin, thickness / (slides ? 8 : 4), (slides ? 6 : 2.5) * extent_along(mesh, own));
        add(pin, turn_from(2, triple(own)));
    }
}

// The line of a distance: a cylinder of 1 m along z that is moved, turned and stretched between the two points.
class Line {
public:
    Line(const SceneDescription& scene, const JointDescription& joint) : joint_{joint} {
        for (const int side : {joint.body, joint.to_body})
            if (side >= 0)
                own_[side == joint.to_body] =
                    in_axes_of(scene.bodies[static_cast<std::size_t>(side)], joint.anchor_on(side));
    }
    // pose_of(b): that of a body.
    void sample(const auto& pose_of) {
        reference::Vector end[2];
        for (const int side : {joint_.body, joint_.to_body}) {
            const std::size_t k = side == joint_.to_body;
            if (side < 0) {
                end[k] = reference::vector_of(joint_.anchor_on(side));
                continue;
            }
            const auto& [position, q] = pose_of(static_cast<std::size_t>(side));
            end[k] = reference::Vector{position[0], position[1], position[2]} +
                     reference::Rotation{q[3], {q[0], q[1], q[2]}}.rotate(own_[k]);
        }
        const reference::Vector way = end[1] - end[0];
        const auto length = static_cast<double>(norm(way));
        append(middle_, triple((end[0] + end[1]) * 0.5L));
        append(turn_, turn_from(2, length > 0 ? triple(unit(way)) : Triple{0, 0, 1}));
        append(stretch_, Triple{1, 1, length});
    }
    // times(): the accessor of the times of the samples.
    void place(Document& document, double radius, const auto& times) const {
        Mesh mesh;
        add_cylinder(mesh, radius, 1);
        const auto first = [](const std::vector<float>& numbers, std::size_t each) {
            return std::vector<float>(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(each));
        };
        const std::size_t node = document.place(joint_.name, document.add(mesh, of_joints, false), first(middle_, 3),
                                                first(turn_, 4), {}, first(stretch_, 3));
        const auto animate = [&](const char* path, const std::vector<float>& numbers, std::size_t each) {
            if (!std::equal(numbers.begin() + static_cast<std::ptrdiff_t>(each), numbers.end(), numbers.begin()))
                document.animate(node, path, times(), document.add(numbers, each));
        };
        animate("translation", middle_, 3);
        animate("rotation", turn_, 4);
        animate("scale", stretch_, 3);
    }

private:
    static void append(std::vector<float>& numbers, const auto& more) {
        for (const double x : more) numbers.push_back(static_cast<float>(x));
    }

    const JointDescription& joint_;
    reference::Vector own_[2];                    // the points in the axes of their bodies
    std::vector<float> middle_, turn_, stretch_;  // of each sample
};

}  // namespace

void Gltf::sample(const Simulation& simulation, bool last) {
    if (simulation.steps_taken() % every_ != 0 && !last) return;
    const auto time = static_cast<float>(simulation.time());
    if (!times_.empty() && !(time > times_.back())) return;
    std::vector<Pose> now;
    for (int b = 0; b < simulation.body_count(); ++b) {
        const BodySnapshot body = simulation.body(b);
        const auto& [w, x, y, z] = body.orientation;
        const long double norm = std::sqrt(w * w + x * x + y * y + z * z);
        Pose pose;
        bool is_finite = true;
        for (std::size_t i = 0; i < 3; ++i) {
            pose.position[i] = static_cast<float>(body.position[i]);
            is_finite = is_finite && std::isfinite(pose.position[i]);
        }
        for (std::size_t i = 0; i < 4; ++i) {
            pose.orientation[i] = static_cast<float>(body.orientation[(i + 1) % 4] / norm);
            is_finite = is_finite && std::isfinite(pose.orientation[i]);
        }
        if (!is_finite) return;
        now.push_back(pose);
    }
    times_.push_back(time);
    for (std::size_t b = 0; b < now.size(); ++b) poses_[b].push_back(now[b]);
}

std::string Gltf::text() const {
    Document document;
    Triple centre{};
    double reach = 1;  // m; the half of a plane's square
    for (const auto& poses : poses_)
        for (std::size_t i = 0; i < 3 && !poses.empty(); ++i)
            centre[i] += static_cast<double>(poses.front().position[i]) / static_cast<double>(poses_.size());
    std::optional<std::size_t> accessor_of_times;
    const auto times = [&] {
        if (!accessor_of_times) accessor_of_times = document.add(times_, 1, 0, true);
        return *accessor_of_times;
    };
    for (std::size_t b = 0; b < poses_.size(); ++b) {
        const auto& poses = poses_[b];
        if (poses.empty()) continue;
        const BodyDescription& body = scene_.bodies[b];
        const Colour& colour = body.fixed ? of_fixed : of_bodies[b % std::size(of_bodies)];
        const Mesh mesh = mesh_of(body.shape);
        const std::size_t node = document.place(body.name, document.add(mesh, colour, false), poses.front().position,
                                                poses.front().orientation);
        std::vector<float> positions, orientations;
        bool moves = false, turns = false;
        double extent = 0;
        for (const float x : mesh.positions) extent = std::max(extent, std::abs(static_cast<double>(x)));
        for (const Pose& pose : poses) {
            positions.insert(positions.end(), pose.position.begin(), pose.position.end());
            orientations.insert(orientations.end(), pose.orientation.begin(), pose.orientation.end());
            moves = moves || pose.position != poses.front().position;
            turns = turns || pose.orientation != poses.front().orientation;
            for (std::size_t i = 0; i < 3; ++i)
                reach = std::max(reach, std::abs(static_cast<double>(pose.position[i]) - centre[i]) + 2 * extent);
        }
        if (moves) document.animate(node, "translation", times(), document.add(positions, 3));
        if (turns) document.animate(node, "rotation", times(), document.add(orientations, 4));
        for (const JointDescription& joint : scene_.joints) {
            if (joint.body != static_cast<int>(b)) continue;
            if (joint.kind != JointKind::distance) {
                place_joint(document, joint, body, mesh, node);
                continue;
            }
            Line line(scene_, joint);
            for (std::size_t i = 0; i < times_.size(); ++i)
                line.sample([&](std::size_t side) -> const Pose& { return poses_[side][i]; });
            line.place(document, thickness_of(mesh) / 8, times);
        }
    }
    for (const PlaneDescription& plane : scene_.planes) {
        const double norm = std::hypot(plane.normal[0], plane.normal[1], plane.normal[2]);
        Triple normal = plane.normal, at = centre;
        double above = plane.offset;
        for (std::size_t i = 0; i < 3; ++i) {
            normal[i] /= norm;
            above += normal[i] * centre[i];
        }
        for (std::size_t i = 0; i < 3; ++i) at[i] -= above * normal[i];
        (void)document.place(plane.name, document.add(square(reach), of_planes, true), at, turn_from(1, normal));
    }
    return document.text();
}

}  // namespace tumble::host
