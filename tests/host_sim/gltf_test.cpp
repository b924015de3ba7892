// `tumble run --gltf`: what the file must be by the specification of glTF 2.0 (its sections are named), and that it
// shows the run.
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>

#include "command_runner.hpp"

namespace tumble::host {
namespace {

// Of base64 (RFC 4648).
std::vector<std::uint8_t> bytes_of(const std::string& text) {
    static const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::vector<std::uint8_t> bytes;
    EXPECT_EQ(text.size() % 4, 0u);
    for (std::size_t i = 0; i < text.size(); i += 4) {
        std::uint32_t bits = 0;
        int padding = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t digit = digits.find(text[i + k]);
            if (text[i + k] == '=') ++padding;
            else EXPECT_TRUE(digit != std::string::npos && padding == 0) << i;
            bits = bits << 6 | static_cast<std::uint32_t>(text[i + k] == '=' ? 0 : digit);
        }
        EXPECT_TRUE(padding == 0 || i + 4 == text.size());
        for (int k = 0; k < 3 - padding; ++k) bytes.push_back(static_cast<std::uint8_t>(bits >> (16 - 8 * k)));
    }
    return bytes;
}

void expect_keys(const Json& object, const std::set<std::string>& required, const std::set<std::string>& allowed = {}) {
    for (const std::string& key : required)
        EXPECT_TRUE(object.contains(key)) << key << " in " << object.dump(0).substr(0, 200);
    for (const auto& [key, value] : object.items())
        EXPECT_TRUE(required.contains(key) || allowed.contains(key)) << key << " is not of the specification";
}

class File {
public:
    explicit File(Json json) : json_(std::move(json)) {
        // 5.17: lists have an element at least.
        expect_keys(json_,
                    {"asset", "scene", "scenes", "nodes", "meshes", "materials", "accessors", "bufferViews", "buffers"},
                    {"animations"});
        for (const auto& [key, value] : json_.items()) EXPECT_TRUE(!value.is_array() || !value.empty()) << key;
        EXPECT_EQ(json_["asset"]["version"], "2.0");
        EXPECT_EQ(json_["buffers"].size(), 1u);
        const std::string uri = json_["buffers"][0]["uri"], head = "data:application/octet-stream;base64,";
        EXPECT_TRUE(uri.starts_with(head));
        bytes_ = bytes_of(uri.substr(head.size()));
        EXPECT_EQ(json_["buffers"][0]["byteLength"], bytes_.size());
        for (const Json& view : json_["bufferViews"]) check_view(view);
        for (std::size_t i = 0; i < json_["accessors"].size(); ++i) check_accessor(i);
        for (const Json& mesh : json_["meshes"]) check_mesh(mesh);
        check_scene();
        for (const Json& material : json_["materials"]) check_material(material);
        if (json_.contains("animations"))
            for (const Json& animation : json_["animations"]) check_animation(animation);
        // Nothing is there that nothing uses.
        EXPECT_EQ(used_.size(), json_["accessors"].size());
    }
    [[nodiscard]] const Json& json() const { return json_; }
    [[nodiscard]] std::vector<float> numbers(std::size_t accessor) const {
        std::vector<float> numbers;
        for (const std::uint32_t word : words(accessor)) numbers.push_back(std::bit_cast<float>(word));
        return numbers;
    }
    [[nodiscard]] const Json* node(const std::string& name) const {
        for (const Json& node : json_["nodes"])
            if (node["name"] == name) return &node;
        return nullptr;
    }
    // The output and the input of a node's animation; none where it stays.
    [[nodiscard]] std::optional<std::pair<std::vector<float>, std::vector<float>>>
    track(const std::string& name, const std::string& path) const {
        if (!json_.contains("animations")) return {};
        const Json& animation = json_["animations"][0];
        for (const Json& channel : animation["channels"]) {
            const Json& target = channel["target"];
            if (target["path"] != path || json_["nodes"][target["node"].get<std::size_t>()]["name"] != name) continue;
            const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
            return std::pair{numbers(sampler["output"]), numbers(sampler["input"])};
        }
        return {};
    }

private:
    static constexpr int float_component = 5126, unsigned_int_component = 5125;
    [[nodiscard]] static std::size_t each(const Json& accessor) {
        static const std::map<std::string, std::size_t> sizes{{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};
        return sizes.at(accessor["type"]);
    }
    [[nodiscard]] std::vector<std::uint32_t> words(std::size_t accessor) const {
        const Json &of = json_["accessors"][accessor],
                   &view = json_["bufferViews"][of["bufferView"].get<std::size_t>()];
        const std::size_t start = view["byteOffset"];
        std::vector<std::uint32_t> words;
        for (std::size_t i = 0; i < of["count"].get<std::size_t>() * each(of); ++i) {
            std::uint32_t word = 0;
            for (std::size_t k = 4; k-- > 0;) word = word << 8 | bytes_.at(start + 4 * i + k);  // 3.6.1: little endian
            words.push_back(word);
        }
        return words;
    }
    void check_view(const Json& view) const {
        expect_keys(view, {"buffer", "byteLength", "byteOffset"}, {"target"});
        EXPECT_EQ(view["buffer"], 0);
        EXPECT_GE(view["byteLength"], 1);
        EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(), bytes_.size());
        EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0u);  // 3.6.2.4: alignment
        EXPECT_TRUE(!view.contains("target") || view["target"] == 34962 || view["target"] == 34963);
    }
    void check_accessor(std::size_t index) const {
        const Json& accessor = json_["accessors"][index];
        expect_keys(accessor, {"bufferView", "componentType", "count", "type"}, {"min", "max"});
        const Json& view = json_["bufferViews"].at(accessor["bufferView"].get<std::size_t>());
        EXPECT_GE(accessor["count"], 1);
        EXPECT_EQ(accessor["count"].get<std::size_t>() * each(accessor) * 4, view["byteLength"]);
        const bool is_float = accessor["componentType"] == float_component;
        EXPECT_TRUE(is_float || accessor["componentType"] == unsigned_int_component);
        if (!is_float) return;
        const std::vector<float> values = numbers(index);
        for (const float value : values) ASSERT_TRUE(std::isfinite(value));  // 3.6.2.2
        if (!accessor.contains("min")) return;
        // 3.6.2.5: exact bounds.
        for (std::size_t i = 0; i < each(accessor); ++i) {
            float least = values[i], most = values[i];
            for (std::size_t k = i; k < values.size(); k += each(accessor)) {
                least = std::min(least, values[k]);
                most = std::max(most, values[k]);
            }
            EXPECT_EQ(accessor["min"][i].get<float>(), least);
            EXPECT_EQ(accessor["max"][i].get<float>(), most);
        }
    }
    // 3.7.2.
    void check_mesh(const Json& mesh) {
        expect_keys(mesh, {"primitives"});
        for (const Json& primitive : mesh["primitives"]) {
            expect_keys(primitive, {"attributes", "indices", "material"});
            EXPECT_LT(primitive["material"].get<std::size_t>(), json_["materials"].size());
            const std::size_t position = primitive["attributes"]["POSITION"],
                              normal = primitive["attributes"]["NORMAL"], index = primitive["indices"];
            used_.insert({position, normal, index});
            const Json& accessors = json_["accessors"];
            EXPECT_TRUE(accessors[position].contains("min") && accessors[position]["type"] == "VEC3");
            EXPECT_EQ(accessors[position]["count"], accessors[normal]["count"]);
            EXPECT_EQ(accessors[index]["type"], "SCALAR");
            EXPECT_EQ(accessors[index]["count"].get<std::size_t>() % 3, 0u);
            const std::vector<float> at = numbers(position), normals = numbers(normal);
            for (std::size_t i = 0; i < normals.size(); i += 3)
                EXPECT_NEAR(std::hypot(normals[i], normals[i + 1], normals[i + 2]), 1, 1e-5);
            const std::vector<std::uint32_t> corners = words(index);
            for (const std::uint32_t corner : corners) ASSERT_LT(corner, at.size() / 3);
            // 3.7.2.1: counterclockwise from outside, which is where the normals point.
            for (std::size_t i = 0; i < corners.size(); i += 3) {
                std::array<std::array<double, 3>, 3> p{};
                std::array<double, 3> mean{};
                for (std::size_t k = 0; k < 3; ++k)
                    for (std::size_t j = 0; j < 3; ++j) {
                        p[k][j] = at[3 * corners[i + k] + j];
                        mean[j] += normals[3 * corners[i + k] + j];
                    }
                double along = 0, area = 0;
                for (std::size_t j = 0; j < 3; ++j) {
                    const std::size_t u = (j + 1) % 3, v = (j + 2) % 3;
                    const double normal_of_triangle =
                        (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
                    along += normal_of_triangle * mean[j];
                    area += normal_of_triangle * normal_of_triangle;
                }
                EXPECT_GT(area, 0) << "triangle " << i / 3;
                EXPECT_GT(along, 0) << "triangle " << i / 3;
            }
        }
    }
    void check_scene() {
        EXPECT_EQ(json_["scene"], 0);
        EXPECT_EQ(json_["scenes"].size(), 1u);
        std::set<std::size_t> shown;
        for (const std::size_t node : json_["scenes"][0]["nodes"]) EXPECT_TRUE(shown.insert(node).second);
        // 3.5.2: a node has one parent at most, and a child is no root.
        for (const Json& node : json_["nodes"]) {
            if (!node.contains("children")) continue;
            for (const std::size_t child : node["children"]) EXPECT_TRUE(shown.insert(child).second);
        }
        EXPECT_EQ(shown.size(), json_["nodes"].size());
        for (const Json& node : json_["nodes"]) {
            expect_keys(node, {"name", "mesh", "translation", "rotation"}, {"children", "scale"});
            EXPECT_LT(node["mesh"].get<std::size_t>(), json_["meshes"].size());
            EXPECT_EQ(node["translation"].size(), 3u);
            expect_unit(node["rotation"].get<std::vector<float>>());
        }
    }
    void check_material(const Json& material) const {
        expect_keys(material, {"pbrMetallicRoughness", "doubleSided"});
        const Json& surface = material["pbrMetallicRoughness"];
        expect_keys(surface, {"baseColorFactor", "metallicFactor", "roughnessFactor"});
        EXPECT_EQ(surface["baseColorFactor"].size(), 4u);
        for (const double part : surface["baseColorFactor"]) EXPECT_TRUE(part >= 0 && part <= 1);
    }
    // 3.11.
    void check_animation(const Json& animation) {
        expect_keys(animation, {"channels", "samplers"});
        EXPECT_FALSE(animation["channels"].empty());
        std::set<std::pair<std::size_t, std::string>> targets;
        for (const Json& channel : animation["channels"]) {
            expect_keys(channel, {"sampler", "target"});
            const Json &target = channel["target"],
                       &sampler = animation["samplers"].at(channel["sampler"].get<std::size_t>());
            EXPECT_TRUE(targets.emplace(target["node"].get<std::size_t>(), target["path"].get<std::string>()).second);
            EXPECT_LT(target["node"].get<std::size_t>(), json_["nodes"].size());
            expect_keys(sampler, {"input", "output", "interpolation"});
            const std::size_t input = sampler["input"], output = sampler["output"];
            used_.insert({input, output});
            const bool turns = target["path"] == "rotation";
            EXPECT_TRUE(turns || target["path"] == "translation" || target["path"] == "scale");
            EXPECT_EQ(json_["accessors"][output]["type"], turns ? "VEC4" : "VEC3");
            EXPECT_TRUE(json_["accessors"][input].contains("min"));
            const std::vector<float> times = numbers(input), values = numbers(output);
            EXPECT_EQ(json_["accessors"][input]["count"], json_["accessors"][output]["count"]);
            EXPECT_GE(times[0], 0);
            for (std::size_t i = 1; i < times.size(); ++i) EXPECT_LT(times[i - 1], times[i]);
            for (std::size_t i = 0; turns && i < values.size(); i += 4)
                expect_unit({values[i], values[i + 1], values[i + 2], values[i + 3]});
        }
    }
    static void expect_unit(const std::vector<float>& q) {
        ASSERT_EQ(q.size(), 4u);
        EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-6);
    }

    Json json_;
    std::vector<std::uint8_t> bytes_;
    std::set<std::size_t> used_;  // accessors
};

File file_of(const std::string& scene, std::vector<std::string> more = {}) {
    const std::string path = temporary("out.gltf");
    more.insert(more.begin(), {"run", scene, "--gltf", path, "--check", "off"});
    expect_outcome(tumble(std::move(more)), 0);
    return File(Json::parse(contents(path)));
}

TEST(Gltf, is_valid_and_has_every_body_and_plane_of_the_scene) {
    for (const char* name :
         {"contacts/rolling", "contacts/stack", "contacts/turntable", "satellite", "stone", "orbit", "free"}) {
        SCOPED_TRACE(name);
        const File file = file_of(shipped(name), {"--duration", "0.25"});
        std::string text = contents(shipped(name));
        std::size_t count = 0;
        for (const char* table : {"\n[[body]]", "\n[[plane]]"})
            for (std::size_t at = text.find(table); at != std::string::npos; at = text.find(table, at + 1)) ++count;
        EXPECT_EQ(file.json()["nodes"].size(), count);
    }
}

TEST(Gltf, has_the_joints_as_parts_of_their_bodies) {
    const File file = file_of(shipped("joints/double_pendulum"), {"--duration", "0.1"});
    const Json& nodes = file.json()["nodes"];
    ASSERT_EQ(nodes.size(), 4u);
    for (const auto& [body, joint] : {std::pair{"upper", "shoulder"}, {"lower", "elbow"}}) {
        const Json& children = file.node(body)->at("children");
        ASSERT_EQ(children.size(), 1u);
        const Json& pin = nodes[children[0].get<std::size_t>()];
        EXPECT_EQ(pin["name"], joint);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(pin["translation"][i].get<double>(), i == 1 ? 0.5 : 0, 1e-12);
        const Json& mesh = file.json()["meshes"][pin["mesh"].get<std::size_t>()];
        const Json& corners =
            file.json()["accessors"][mesh["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()];
        EXPECT_GT(corners["max"][2].get<double>(), 0.05);  // it stands out of a rod that is 0.1 m thick
    }
    EXPECT_EQ(file.json()["scenes"][0]["nodes"].size(), 2u);
    // A joint of each kind, two pins of the universal one.
    EXPECT_EQ(file_of(written("kinds.toml", scene_of_every_joint), {"--duration", "0.1"}).json()["nodes"].size(),
              5u + 6);
}

TEST(Gltf, has_a_rope_as_a_line_from_its_hook_to_its_weight) {
    const File file = file_of(shipped("joints/rope"), {"--duration", "1.25", "--every", "16"});
    const auto weight = file.track("weight", "translation"), middle = file.track("rope", "translation"),
               turn = file.track("rope", "rotation"), scale = file.track("rope", "scale");
    ASSERT_TRUE(weight && middle && turn && scale);
    const std::size_t count = weight->second.size();
    ASSERT_EQ(scale->first.size(), 3 * count);
    double shortest = 2;
    for (std::size_t i = 0; i < count; ++i) {
        const float* const at = &weight->first[3 * i];
        const double length = std::hypot(at[0], at[1], at[2]);
        shortest = std::min(shortest, length);
        EXPECT_NEAR(scale->first[3 * i + 2], length, 1e-6);
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(middle->first[3 * i + k], at[k] / 2, 1e-6);
        // The third column of the rotation is z, along which the line lies.
        const float* const q = &turn->first[4 * i];
        const double way[] = {2 * (q[0] * q[2] + q[3] * q[1]), 2 * (q[1] * q[2] - q[3] * q[0]),
                              1 - 2 * (q[0] * q[0] + q[1] * q[1])};
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(way[k] * length, -at[k], 1e-5);
    }
    EXPECT_LT(shortest, 1.9);  // it has been slack
    EXPECT_EQ(file.json()["nodes"].size(), 2u);
}

TEST(Gltf, ends_where_the_run_ends) {
    const Json run = json_of({"run", shipped("brick"), "--duration", "0.5"});
    const File file = file_of(shipped("brick"), {"--duration", "0.5", "--every", "7"});
    const Json& body = run["bodies"][0];
    const auto position = file.track(body["name"], "translation"), orientation = file.track(body["name"], "rotation");
    ASSERT_TRUE(orientation);
    EXPECT_EQ(orientation->second.back(), run["time_s"].get<float>());
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_NEAR(orientation->first[orientation->first.size() - 4 + i],
                    body["orientation"][(i + 1) % 4].get<double>(), 1e-6);
    for (std::size_t i = 0; position && i < 3; ++i)
        EXPECT_NEAR(position->first[position->first.size() - 3 + i], body["position_m"][i].get<double>(), 1e-5);
    const auto steps = run["steps"].get<std::size_t>();
    EXPECT_EQ(orientation->second.size(), (steps + 6) / 7 + 1);
}

TEST(Gltf, has_shapes_of_the_size_of_the_bodies) {
    const std::string scene = written(
        "scene.toml", scene_of("", body_of("box", "box = [1.0, 2.0, 3.0]") + body_of("ball", "sphere = 0.5") +
                                       body_of("can", "cylinder = [0.25, 2.0]") + body_of("hoop", "hoop = 0.5") +
                                       body_of("pill", "capsule = [0.25, 2.0]")));
    const File file = file_of(scene);
    const std::map<std::string, std::array<double, 3>> halves{{"box", {0.5, 1, 1.5}},
                                                              {"ball", {0.5, 0.5, 0.5}},
                                                              {"can", {0.25, 0.25, 1}},
                                                              {"hoop", {0.515625, 0.515625, 0.015625}},
                                                              {"pill", {0.25, 0.25, 1.25}}};
    for (const auto& [name, half] : halves) {
        ASSERT_NE(file.node(name), nullptr) << name;
        const Json& mesh = file.json()["meshes"][(*file.node(name))["mesh"].get<std::size_t>()];
        const Json& accessor =
            file.json()["accessors"][mesh["primitives"][0]["attributes"]["POSITION"].get<std::size_t>()];
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(accessor["max"][i].get<double>(), half[i], 1e-6) << name;
            EXPECT_NEAR(accessor["min"][i].get<double>(), -half[i], 1e-6) << name;
        }
    }
}

TEST(Gltf, of_planes_face_their_normals) {
    const std::string scene =
        written("scene.toml", world_of("0.0", "1/256", "0.1") +
                                  "[[plane]]\nname = \"wall\"\nnormal = [3.0, 0.0, -4.0]\noffset = 2.0\n"
                                  "[[plane]]\nname = \"ceiling\"\nnormal = [0.0, -1.0, 0.0]\noffset = 5.0\n" +
                                  body_of("ball", "sphere = 0.5"));
    const File file = file_of(scene);
    const std::map<std::string, std::array<double, 4>> planes{{"wall", {0.6, 0, -0.8, 2}}, {"ceiling", {0, -1, 0, 5}}};
    for (const auto& [name, plane] : planes) {
        ASSERT_NE(file.node(name), nullptr) << name;
        const auto q = (*file.node(name))["rotation"].get<std::vector<double>>();
        const auto at = (*file.node(name))["translation"].get<std::vector<double>>();
        // The turned y axis.
        const double x = q[0], y = q[1], z = q[2], w = q[3];
        const std::array<double, 3> up{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)};
        double above = plane[3];
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(up[i], plane[i], 1e-12) << name;
            above += plane[i] * at[i];
        }
        EXPECT_NEAR(above, 0, 1e-12) << name;
    }
}

TEST(Gltf, of_a_body_that_stays_has_no_animation) {
    const std::string still = written("scene.toml", scene_of("", body_of("ball", "sphere = 0.5")));
    EXPECT_FALSE(file_of(still).json().contains("animations"));
}

TEST(Gltf, takes_standard_output_alone) {
    expect_outcome(tumble({"run", shipped("brick"), "--gltf", "-", "--json"}), 2,
                   "--gltf, --json: got standard output");
}

}  // namespace
}  // namespace tumble::host
