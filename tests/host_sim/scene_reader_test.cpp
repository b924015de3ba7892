// The scene reader: every case of bad_scenes.txt is refused with the message that it names, every shipped scene is
// read, and good values arrive as written. Each case and each shipped file is a test.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <stdexcept>

#include "command_runner.hpp"
#include "scene/data.hpp"
#include "scene/scene_file.hpp"
#include "scene/writer.hpp"

namespace tumble::host {
namespace {

struct BadScene {
    std::string name, line, key, part, toml;
    friend void PrintTo(const BadScene& scene, std::ostream* out) { *out << scene.name; }
};

// The cases of bad_scenes.txt, whose head explains its lines.
std::vector<BadScene> bad_scenes() {
    const std::string mark = "== ";
    std::vector<BadScene> scenes;
    std::map<std::string, std::string> fragments;
    std::string* text = nullptr;
    std::ifstream stream(source_directory / "tests/host_sim/bad_scenes.txt");
    for (std::string line; std::getline(stream, line);) {
        if (line.starts_with(mark + "$")) {
            text = &fragments[line.substr(mark.size())];
        } else if (line.starts_with(mark)) {
            std::array<std::string, 3> fields;
            std::size_t at = mark.size();
            for (std::string& field : fields) {
                const std::size_t end = line.find(": ", at);
                if (end == std::string::npos) throw std::invalid_argument{line};
                field = line.substr(at, end - at);
                at = end + 2;
            }
            scenes.push_back({fields[0], fields[1], fields[2], line.substr(at), "# " + line + "\n"});
            text = &scenes.back().toml;
        } else if (text) {
            while (line.starts_with("$")) {
                const std::size_t end = std::min(line.find(' '), line.size());
                *text += fragments.at(line.substr(0, end));
                line.erase(0, end + 1);
            }
            if (!line.empty()) *text += line + "\n";
        }
    }
    return scenes;
}

class RefusedScene : public testing::TestWithParam<BadScene> {};

TEST_P(RefusedScene, names_file_line_key_and_expectation) {
    const auto& [name, line, key, part, toml] = GetParam();
    const std::string file = name + ".toml";
    try {
        (void)read_scene_text(toml, file);
        FAIL() << "was read without an error:\n" << toml;
    } catch (const SceneError& error) {
        const std::string text = error.what();
        EXPECT_TRUE(text.starts_with(file + ":" + line + ": " + key + ": ")) << text << "\n" << toml;
        EXPECT_NE(text.find(part), std::string::npos) << text << "\n" << toml;
        EXPECT_NE(text.find(", expected "), std::string::npos) << text;
        EXPECT_EQ(error.file(), file);
        EXPECT_EQ(std::to_string(error.line()), line);
        EXPECT_EQ(error.key(), key);
    }
}

INSTANTIATE_TEST_SUITE_P(cases, RefusedScene, testing::ValuesIn(bad_scenes()),
                         [](const auto& info) { return info.param.name; });

class ShippedScene : public testing::TestWithParam<std::string> {};

TEST_P(ShippedScene, reads) {
    try {
        const std::string file = shipped(GetParam());
        const SceneDescription scene = read_scene(file);
        EXPECT_EQ(scene.path, file);
        EXPECT_FALSE(scene.name.empty());
        EXPECT_FALSE(scene.bodies.empty());
        EXPECT_GT(scene.steps(), 0);
    } catch (const SceneError& error) { FAIL() << error.what(); }
}

INSTANTIATE_TEST_SUITE_P(files, ShippedScene, testing::ValuesIn(shipped_scenes()),
                         [](const auto& info) { return info.param; });

const std::string world = "[world]\nstep = \"1/256\"\nduration = 4.0\n";
const std::string brick = "[[body]]\nname = \"brick\"\nshape = { box = [1.0, 4.0, 9.0] }\nmass = 10\n";

SceneDescription read(const std::string& toml) { return read_scene_text(toml, "text.toml"); }

std::string error_of(const std::string& toml) {
    try {
        (void)read(toml);
    } catch (const SceneError& error) { return error.what(); }
    return "no error";
}

std::int64_t steps_of(const std::string& step, double duration) {
    SceneDescription scene;
    scene.step = parse_step(step).value();
    scene.duration = duration;
    return scene.steps();
}

TEST(SceneReader, whole_numbers_need_no_point_however_large) {
    for (const char* whole : {"9007199254740992", "9007199254740993", "9223372036854775807"})
        EXPECT_EQ(read(world + "[[body]]\nname = \"b\"\nshape = \"none\"\nmass = " + whole + "\n").body(0).mass,
                  std::stod(whole));
    EXPECT_TRUE(has(error_of(world + "[[body]]\nname = \"b\"\nshape = \"none\"\nmass = -9007199254740993\n"),
                    "got -9007199254740993, expected a positive finite number (kg)"));
}

TEST(SceneReader, a_message_is_short_however_long_what_it_refuses_is) {
    const std::string name(100000, 'n'), quoted = "\"" + name + "\"";
    for (const std::string& scene :
         {world + brick + name + " = 1\n", world + brick + "orientation = " + quoted + "\n",
          world + brick + "[contact]\nresponse = " + quoted + "\n", world + brick + "[" + name + "]\n",
          world + brick + "[[spring]]\nbody = " + quoted + "\nto = [0, 0, 0]\nstiffness = 1.0\n",
          world + "[[body]]\nname = " + quoted + "\nshape = { box = [1, 1, 1] }\n", world + brick + "\"" + name,
          world + brick + "mass = " + name + "\n"}) {
        const std::string error = error_of(scene);
        EXPECT_NE(error, "no error");
        EXPECT_LT(error.size(), 2000U);
    }
}

TEST(SceneReader, unknown_key_names_file_line_and_key) {
    EXPECT_EQ(error_of(world + brick + "masss = 3.0\n"),
              "text.toml:8: body[0].masss: unknown key (did you mean \"mass\"?), expected \"angular_velocity\", "
              "\"density\", \"fixed\", "
              "\"friction\", \"inertia\", \"kinematic\", \"layers\", \"linear_drag\", \"mass\", \"name\", "
              "\"orientation\", \"position\", "
              "\"quadratic_drag\", \"restitution\", \"rolling_resistance\", \"shape\", \"spinning_resistance\", "
              "\"velocity\" or \"wheel_momentum\"");
}

TEST(SceneReader, wrong_value_names_what_it_got_and_the_unit_expected) {
    EXPECT_EQ(error_of(world + "[[body]]\nname = \"brick\"\nshape = { sphere = 1.0 }\nmass = -3\n"),
              "text.toml:7: body[0].mass: got -3, expected a positive finite number (kg)");
}

TEST(SceneReader, an_end_of_a_spring_beyond_the_range_is_refused) {
    const auto scene = [](const std::string& range, const std::string& end) {
        return world + range + brick + "[[body]]\nname = \"other\"\nshape = { sphere = 1.0 }\nmass = 1.0\n" +
               "[[spring]]\nbody = \"brick\"\nstiffness = 1\n" + end + "\n";
    };
    const std::string near = "[range]\nposition = 64.0\n", other = "to_body = \"other\"\n";
    EXPECT_EQ(
        error_of(scene(near, "to = [0, -80, 0]")),
        "text.toml:17: spring[0].to[1]: got -80, expected a number from -64 to 64 (m), the range.position of this "
        "scene");
    for (const std::string inside : {"to = [64, -64, 0]", "to = [0, 0, 63.5]"})
        EXPECT_EQ(error_of(scene(near, inside)), "no error") << inside;
    for (const std::string& beyond :
         {std::string{"to = [0, 0, 1024.1]"}, std::string{"to = [0, 0, 0]\npoint = [-1025, 0, 0]"},
          other + "to_point = [0, 2000, 0]"}) {
        const std::string range = "[range]\nposition = 1024.0\n";
        EXPECT_NE(error_of(scene(range, beyond)).find("the range.position of this scene"), std::string::npos) << beyond;
        EXPECT_TRUE(read(scene("", beyond)).range.beyond_default) << beyond;
    }
}

TEST(SceneReader, a_scene_without_a_range_notes_the_first_number_beyond_the_default) {
    const std::string far = brick + "position = [0, 3.8e8, 0]\nvelocity = [1000, 0, 0]\n";
    const SceneDescription scene = read(world + far);
    ASSERT_TRUE(scene.range.beyond_default);
    EXPECT_STREQ(scene.range.beyond_default->what(),
                 "text.toml:8: body[0].position[1]: got 3.8e+08, expected a number from -1024 to 1024 (m), the "
                 "range.position without [range], which fixed point needs here; --numbers f64 and f32 need none");
    EXPECT_FALSE(read(world + brick + "position = [0, 1024, 0]\n").range.beyond_default);
    EXPECT_NE(error_of(world + "[range]\n" + far), "no error");
}

TEST(SceneReader, a_fixed_body_needs_no_mass) {
    const std::string table = "[[body]]\nname = \"table\"\nshape = { box = [1, 1, 1] }\n";
    EXPECT_TRUE(read(world + table + "fixed = true\n").bodies.at(0).mass);
    EXPECT_TRUE(read(world + table + "kinematic = true\n").bodies.at(0).mass);
    for (const char* rest : {"", "fixed = false\n"})
        EXPECT_NE(error_of(world + table + rest).find("body[0].mass: missing"), std::string::npos) << rest;
}

TEST(SceneReader, numbers_whose_products_leave_a_double_are_refused) {
    const auto gravity = [](const std::string& g) {
        return "[world]\nstep = \"1/256\"\nduration = 4.0\ngravity = [0, " + g + ", 0]\n" + brick;
    };
    EXPECT_EQ(error_of(gravity("-1e300")), "text.toml:4: world.gravity[1]: got -1e+300, expected a finite number "
                                           "(m/s^2), of a size up to 1e+40");
    EXPECT_EQ(error_of(gravity("1.1e40")).substr(0, 30), "text.toml:4: world.gravity[1]:");
    EXPECT_EQ(error_of(gravity("-1e40")), "no error");
    EXPECT_EQ(error_of(gravity("1e-300")), "no error");
    const std::string point = "[[body]]\nname = \"a\"\nshape = \"none\"\nmass = ";
    EXPECT_EQ(error_of(world + point + "1e-300\n"), "text.toml:7: body[0].mass: got 1e-300, expected a positive finite "
                                                    "number (kg), from 1e-40 to 1e+40");
    for (const auto* mass : {"1e-40", "1e40"}) EXPECT_EQ(error_of(world + point + mass + "\n"), "no error");
    for (const std::string number : {"1e41", "1e300", "1e308"}) {
        const std::string to_step = "[world]\nduration = 0\nstep = ", body = "[[body]]\nname = \"b\"\nmass = 1\n";
        for (const std::string& scene :
             {world + point + number + "\n", to_step + number + "\n" + brick, to_step + "\"" + number + "\"\n" + brick,
              world + "gravitation = " + number + "\n" + brick, world + "linear_drag = " + number + "\n" + brick,
              world + "[contact]\nstiffness = " + number + "\n" + brick,
              world + "[[plane]]\nname = \"p\"\nnormal = [0, 1, 0]\noffset = " + number + "\n" + brick,
              world + body + "shape = { sphere = " + number + " }\n",
              world + body + "shape = { box = [1, 1, " + number + "] }\n",
              world + body + "shape = { points = [[0, 0, 1, 1], [1, 0, 0, " + number + "]] }\n",
              world + brick + "inertia = [1, 1, " + number + "]\n",
              world + brick + "[[spring]]\nbody = \"brick\"\nto = [0, 0, " + number + "]\nstiffness = 1\n",
              world + brick + "[[force]]\nbody = \"brick\"\nuntil = 1\ntorque = [0, 0, " + number + "]\n",
              world + brick + "[[impulse]]\nbody = \"brick\"\ntime = 1\nimpulse = [" + number + ", 0, 0]\n"})
            EXPECT_NE(error_of(scene).find(", expected "), std::string::npos) << scene;
    }
}

TEST(SceneReader, what_lies_too_deep_is_refused_before_it_is_parsed) {
    const auto repeated = [](int count, const std::string& part, const std::string& between = "") {
        std::string text;
        for (int i = 0; i < count; ++i) text += (i > 0 ? between : "") + part;
        return text;
    };
    const std::string message = "text.toml:5: TOML syntax: tables, arrays and parts of keys lie more than 64 deep in "
                                "each other, expected at most 64";
    // Whatever stands before it.
    const std::vector<std::string> befores = {"#\n\n\n\n", "[x]\na = \"\"\"\n# ' \\\\\n\"\"\"\n",
                                              "a = [ 1,\n 'b', { c = 1.5 },\n\n]\n",
                                              "a = \"\\\"\" # \"\nb = ''''''\n[ 'c#' ]\n# [[\n"};
    for (const int count : {65, 66, 1000, 200000}) {
        const int half = count / 2 + 1;
        for (const std::string& deep :
             {repeated(count, "a", ".") + " = 1", repeated(count, "\"a.b\"", " . ") + " = 1",
              repeated(count, "'='", ".") + "=1", "[" + repeated(count, "a", ".") + "]",
              " [[ " + repeated(count, "\"]\"", "\t.") + " ]]", repeated(count, "a", "."),
              "x = " + repeated(count, "{ a = ") + "1" + repeated(count, " }"),
              "x = " + repeated(count, "[") + repeated(count, "]"),
              "x = { " + repeated(half, "a", ".") + " = { " + repeated(half, "b", ".") + " = 1 } }",
              "x = " + repeated(half, "[{ a = ") + "1" + repeated(half, "}]")}) {
            for (const std::string& before : befores) {
                if (count > 1000 && before != befores[0]) continue;
                EXPECT_EQ(error_of(before + deep + "\n"), message) << before << deep.substr(0, 200);
            }
        }
        if (half > 64) continue;
        // A header and the key below it.
        EXPECT_EQ(error_of("\n\n\n[" + repeated(half, "a", ".") + "]\n" + repeated(half, "b", ".") + " = 1\n"),
                  message);
    }
    // Deep enough for everybody, and what only looks deep.
    for (const std::string& shallow :
         {repeated(64, "a", ".") + " = 1", repeated(60, "a", ".") + " = 1.5", "a = \"" + repeated(100, ".") + "\"",
          "a = '''\n" + repeated(100, "[") + "'''", "a = 1 # " + repeated(100, "a", "."),
          "\"" + repeated(100, "a", ".") + "\" = 1", "a = [" + repeated(100, "1.5", ", ") + "]",
          "a = [" + repeated(100, "[1.5]", ",\n") + "]", "a = [" + repeated(100, "{ a.b = 1.5 }", ",") + "]",
          repeated(100, "[[a]]\nb.c = 1.5\n"),
          "[" + repeated(63, "a", ".") + "]\na = 1\n[b]\n" + repeated(63, "a", ".") + " = 1"})
        EXPECT_NE(error_of(shallow).find("unknown key"), std::string::npos) << shallow << "\n" << error_of(shallow);
}

TEST(SceneReader, what_there_is_no_room_for_is_told_with_its_line) {
    const auto bodies = [](int count) {
        std::string text = world;
        for (int b = 0; b < count; ++b)
            text += "[[body]]\nname = \"" + std::to_string(b) + "\"\nshape = { sphere = 1.0 }\nmass = 1.0\n";
        return text;
    };
    const std::string plane = "[[plane]]\nname = \"p",
                      spring = "[[spring]]\nbody = \"brick\"\nto = [0, 0, 0]\nstiffness = 1\n";
    EXPECT_EQ(error_of(bodies(max_bodies)), "no error");
    EXPECT_EQ(error_of(bodies(max_bodies + 1)),
              "text.toml:" + std::to_string(4 + 4 * max_bodies) + ": body[64]: got 65 of them, expected at most 64");
    std::string planes = world + brick, springs = world + brick;
    for (int i = 0; i < max_planes; ++i) planes += plane + std::to_string(i) + "\"\nnormal = [0, 1, 0]\n";
    for (int i = 0; i < max_springs; ++i) springs += spring;
    EXPECT_EQ(error_of(planes), "no error");
    EXPECT_EQ(error_of(springs), "no error");
    EXPECT_EQ(error_of(planes + plane + "\"\nnormal = [0, 1, 0]\n"),
              "text.toml:" + std::to_string(8 + 3 * max_planes) + ": plane[16]: got 17 of them, expected at most 16");
    EXPECT_EQ(error_of(springs + spring),
              "text.toml:" + std::to_string(8 + 4 * max_springs) + ": spring[64]: got 65 of them, expected at most 64");
    std::string joints = bodies(max_bodies);
    for (int b = 0; b <= max_joints; ++b)
        joints += "[[joint]]\nkind = \"ball\"\nanchor = [0, 0, 0]\nbody = \"" + std::to_string(b) + "\"\n";
    EXPECT_EQ(error_of(joints), "text.toml:" + std::to_string(4 + 4 * max_bodies + 4 * max_joints) +
                                    ": joint[64]: got 65 of them, expected at most 64");
}

TEST(SceneReader, files_that_cannot_be_read_are_errors_that_name_them) {
    const auto error_of_file = [](const std::string& path) -> std::string {
        try {
            (void)read_scene(path);
        } catch (const SceneError& error) {
            EXPECT_EQ(error.line(), 0);
            return error.what();
        }
        return "no error";
    };
    EXPECT_EQ(error_of_file("no/such/scene.toml"),
              "no/such/scene.toml: cannot be read: no such file, expected a scene file (TOML)");
    const std::string directory = source_directory.string();
    EXPECT_TRUE(error_of_file(directory).starts_with(directory + ": "));
    if (std::filesystem::exists("/dev/zero")) {
        EXPECT_EQ(error_of_file("/dev/zero"), "/dev/zero: cannot be read: it is larger than 33554432 bytes, expected a "
                                              "scene file (TOML)");
    }
}

TEST(SceneReader, empty_file_is_an_error) { EXPECT_EQ(error_of("").substr(0, 20), "text.toml:1: world: "); }

using Numbers = std::vector<double>;
using Triples = std::vector<Triple>;

// The numbers of a world and its range, and of a contact.
Numbers numbers_of(const SceneDescription& s) {
    return {s.gravitation, s.linear_drag, s.angular_drag, s.range.position, s.range.velocity, s.range.angular_velocity};
}
Numbers numbers_of(const ContactDescription& c) {
    return {c.restitution,
            c.restitution_threshold,
            c.friction,
            c.rolling_resistance,
            c.spinning_resistance,
            c.tolerance,
            c.stiffness,
            c.damping,
            c.barrier,
            static_cast<double>(c.most_impacts),
            static_cast<double>(c.most_searches),
            static_cast<double>(c.most_sweeps),
            static_cast<double>(c.exact_bodies)};
}

TEST(SceneReader, keys_left_out_have_the_documented_defaults) {
    const SceneDescription scene = read(world + brick);
    EXPECT_EQ(scene.name, "text");
    EXPECT_EQ(scene.path, "text.toml");
    EXPECT_EQ(scene.gravity, (Triple{0.0, 0.0, 0.0}));
    EXPECT_EQ(numbers_of(scene), (Numbers{0, 0, 0, 1024, 128, 64}));
    EXPECT_EQ(scene.contact.response, ContactResponse::impulse);
    EXPECT_EQ(numbers_of(scene.contact), (Numbers{0.5, 0, 0, 0, 0, 0.001, 10000, 0, 0, 0, 0, 0, -1}));
    EXPECT_FALSE(scene.contact.sleep);
    EXPECT_TRUE(scene.planes.empty());

    const BodyDescription& body = scene.bodies.at(0);
    EXPECT_EQ(body.shape.kind, ShapeKind::box);
    EXPECT_EQ(body.shape.size, (Triple{1.0, 4.0, 9.0}));
    EXPECT_EQ(body.mass, 10.0);
    EXPECT_FALSE(body.density || body.inertia || body.restitution || body.friction || body.fixed);
    EXPECT_TRUE(body.inertia_is_diagonal);
    EXPECT_EQ(body.position, (Triple{}));
    EXPECT_EQ(body.orientation, (Quadruple{1.0, 0.0, 0.0, 0.0}));
}

constexpr const char* every_key = R"(
name = "all"
[world]
gravity = [1, -9.81, 2]
step = 0.005
duration = 3
gravitation = 0.5
softening = 0.0625
linear_drag = 0.25
angular_drag = 0.125
wind = [3, 4, 5]
[gravity_gradient]
orbit_rate = 0.25
to_centre = [0, -3, 0]
[range]
velocity = 32
[contact]
response = "spring"
restitution = 1
restitution_threshold = 0.1
friction = 0.2
rolling_resistance = 0.002
spinning_resistance = 0.003
restitution_mixing = "product"
friction_mixing = "mean"
tolerance = 0.01
stiffness = 500
damping = 3
barrier = 0.5
most_impacts = 2
most_searches = 9
most_sweeps = 17
exact_bodies = 3
sleep = { angular_speed = 0.5 }
[[plane]]
name = "floor"
normal = [0, 2, 0]
offset = -1
restitution = 0
friction = 0.7
rolling_resistance = 0.004
spinning_resistance = 0.005
[[body]]
name = "a"
shape = { points = [[0, 0, 0, 1], [1, 0, 0, 2], [0, 1, 0, 3]] }
position = [1, 2, 3]
velocity = [-32, 32, 0]
orientation = [0, 0, 3, 4]
angular_velocity = [4, 5, 6]
restitution = 0.9
friction = 0.1
rolling_resistance = 0.006
spinning_resistance = 0.007
fixed = true
[[body]]
name = "b"
shape = { capsule = [0.5, 2] }
density = 700
linear_drag = 0.5
quadratic_drag = 0.75
wheel_momentum = [1, 2, 4]
[[spring]]
body = "a"
point = [1, 0, 0]
to_body = "b"
to_point = [0, 0, 1]
stiffness = 9
damping = 8
rest_length = 7
[[impulse]]
time = 3
body = "b"
impulse = [1, 2, 3]
frame = "body"
point = [4, 5, 6]
angular_impulse = [7, 8, 9]
[[force]]
body = "b"
from = 1
until = 2
force = [1, 2, 3]
frame = "body"
point = [4, 5, 6]
torque = [7, 8, 9]
)";

TEST(SceneReader, every_key_of_world_and_bodies_arrives_as_written) {
    const SceneDescription scene = read(every_key);
    EXPECT_EQ(scene.name, "all");
    EXPECT_EQ(scene.gravity, (Triple{1.0, -9.81, 2.0}));
    EXPECT_EQ(scene.step.denominator, 0);
    EXPECT_EQ(scene.step.seconds(), 0.005);
    EXPECT_EQ(scene.duration, 3.0);
    EXPECT_EQ(numbers_of(scene), (Numbers{0.5, 0.25, 0.125, 1024, 32, 64}));
    EXPECT_EQ(scene.contact.response, ContactResponse::spring);
    EXPECT_EQ(numbers_of(scene.contact), (Numbers{1, 0.1, 0.2, 0.002, 0.003, 0.01, 500, 3, 0.5, 2, 9, 17, 3}));
    EXPECT_EQ(scene.contact.restitution_mixing, Mixing::product);
    EXPECT_EQ(scene.contact.friction_mixing, Mixing::mean);
    const auto& sleep = scene.contact.sleep;
    ASSERT_TRUE(sleep);
    EXPECT_EQ((Numbers{sleep->speed, sleep->angular_speed, sleep->time}), (Numbers{0.03, 0.5, 0.5}));

    const PlaneDescription& plane = scene.planes.at(0);
    EXPECT_EQ(plane.name, "floor");
    EXPECT_EQ(plane.normal, (Triple{0.0, 2.0, 0.0}));
    EXPECT_EQ((Numbers{plane.offset, plane.restitution.value(), plane.friction.value(),
                       plane.rolling_resistance.value(), plane.spinning_resistance.value()}),
              (Numbers{-1, 0, 0.7, 0.004, 0.005}));

    const BodyDescription& a = scene.bodies.at(0);
    EXPECT_EQ(a.shape.kind, ShapeKind::points);
    ASSERT_EQ(a.shape.points.size(), 3u);
    EXPECT_EQ(a.shape.points[1].position, (Triple{1.0, 0.0, 0.0}));
    EXPECT_EQ(a.shape.points[2].mass, 3.0);
    EXPECT_FALSE(a.mass);
    EXPECT_EQ((Triples{a.position, a.velocity, a.angular_velocity}), (Triples{{1, 2, 3}, {-32, 32, 0}, {4, 5, 6}}));
    EXPECT_EQ(a.orientation, (Quadruple{0.0, 0.0, 3.0, 4.0}));
    EXPECT_EQ((Numbers{a.restitution.value(), a.friction.value(), a.rolling_resistance.value(),
                       a.spinning_resistance.value()}),
              (Numbers{0.9, 0.1, 0.006, 0.007}));
    EXPECT_TRUE(a.fixed);
    EXPECT_EQ(scene.bodies.at(1).shape.size, (Triple{0.5, 2.0, 0.0}));
    const BodyDescription& b = scene.bodies.at(1);
    EXPECT_EQ(b.density, 700.0);
    EXPECT_EQ((Numbers{b.linear_drag, b.quadratic_drag}), (Numbers{0.5, 0.75}));
    EXPECT_EQ((Triples{b.wheel_momentum, scene.wind}), (Triples{{1, 2, 4}, {3, 4, 5}}));
    EXPECT_EQ(scene.softening, 0.0625);
    ASSERT_TRUE(scene.gravity_gradient);
    EXPECT_EQ(scene.gravity_gradient->orbit_rate, 0.25);
    EXPECT_EQ(scene.gravity_gradient->to_centre, (Triple{0, -3, 0}));
}

TEST(SceneReader, every_key_of_springs_and_events_arrives_as_written) {
    const SceneDescription scene = read(every_key);
    const SpringDescription& spring = scene.springs.at(0);
    EXPECT_EQ(spring.body, 0);
    EXPECT_EQ(spring.to_body, 1);
    EXPECT_EQ((Triples{spring.point, spring.to}), (Triples{{1, 0, 0}, {0, 0, 1}}));
    EXPECT_EQ((Numbers{spring.stiffness, spring.damping, spring.rest_length}), (Numbers{9, 8, 7}));

    const ImpulseDescription& impulse = scene.impulses.at(0);
    EXPECT_EQ(impulse.time, 3.0);
    EXPECT_EQ(impulse.body, 1);
    EXPECT_EQ(impulse.frame, Frame::body);
    const Triples written{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    EXPECT_EQ((Triples{impulse.impulse, impulse.point, impulse.angular_impulse}), written);

    const ForceDescription& force = scene.forces.at(0);
    EXPECT_EQ((Numbers{force.from, force.until}), (Numbers{1, 2}));
    EXPECT_EQ(force.body, 1);
    EXPECT_EQ(force.frame, Frame::body);
    EXPECT_EQ((Triples{force.force, force.point, force.torque}), written);
}

TEST(SceneReader, gravity_is_an_event_without_a_body_that_is_read_as_it_is_written) {
    const auto scene = read(world + brick +
                            "[[event]]\ntime = 0.5\nkind = \"gravity\"\nvalue = [1.5, -9.81, 0.1]\n"
                            "[[event]]\ntime = 0.75\nkind = \"velocity\"\nbody = \"brick\"\nvalue = [1, 0, 0]\n");
    ASSERT_EQ(scene.events.size(), 2u);
    EXPECT_EQ(scene.events[0].kind, EventKind::gravity);
    EXPECT_EQ(scene.events[0].body, -1);
    EXPECT_EQ(scene.events[0].value, (Triple{1.5, -9.81, 0.1}));
    EXPECT_EQ(scene.most_gravity(), std::hypot(1.5, 9.81, 0.1));
    const auto again = read(scene_text(scene));
    ASSERT_EQ(again.events.size(), 2u);
    EXPECT_EQ(again.events[0].kind, EventKind::gravity);
    EXPECT_EQ(again.events[0].value, scene.events[0].value);
    EXPECT_EQ(again.events[1].body, 0);
    const auto needed = needs(build_scene(scene));
    EXPECT_TRUE(needed.control && needed.script);
}

TEST(SceneReader, spring_to_a_world_point_has_no_second_body) {
    const auto scene = read(world + brick + "[[spring]]\nbody = \"brick\"\nto = [0, 10, 0]\nstiffness = 100.0\n");
    EXPECT_EQ(scene.springs.at(0).to_body, -1);
    EXPECT_EQ(scene.springs.at(0).to, (Triple{0.0, 10.0, 0.0}));
}

constexpr const char* every_joint =
    "[[joint]]\nname = \"shoulder\"\nkind = \"hinge\"\nbody = \"a\"\nanchor = [1, 2, 3]\naxis = [0, 0, 2]\n"
    "[[joint]]\nkind = \"ball\"\nbody = \"b\"\nto_body = \"a\"\nanchor = [4, 5, 6]\n"
    "[[joint]]\nkind = \"fixed\"\nbody = \"c\"\nto_body = \"b\"\nanchor = [7, 8, 9]\n"
    "[[joint]]\nkind = \"slider\"\nbody = \"d\"\nanchor = [1, 0, 0]\naxis = [0, -1, 0]\n"
    "[[joint]]\nkind = \"universal\"\nbody = \"e\"\nto_body = \"d\"\nanchor = [0, 1, 0]\naxis = [3, 0, 0]\n"
    "to_axis = [0, 0, 1]\n";
std::string bodies_named(const std::string& letters) {
    std::string text;
    for (const char letter : letters)
        text += "[[body]]\nname = \"" + std::string(1, letter) + "\"\nshape = { sphere = 0.5 }\nmass = 1.0\n";
    return text;
}

TEST(SceneReader, every_key_of_joints_arrives_as_written_and_is_written_so) {
    const SceneDescription first = read(world + bodies_named("abcde") + every_joint), again = read(scene_text(first));
    for (const SceneDescription& scene : {first, again}) {
        ASSERT_EQ(scene.joints.size(), 5u);
        const auto& [hinge, ball, fixed, slider, universal] =
            std::tie(scene.joints[0], scene.joints[1], scene.joints[2], scene.joints[3], scene.joints[4]);
        EXPECT_EQ(hinge.name, "shoulder");
        EXPECT_EQ(hinge.to_body, -1);
        EXPECT_EQ((Triples{hinge.anchor, hinge.axis, hinge.to_axis}), (Triples{{1, 2, 3}, {0, 0, 2}, {}}));
        EXPECT_EQ(ball.name, "b to a");
        EXPECT_EQ(ball.body, 1);
        EXPECT_EQ(ball.to_body, 0);
        EXPECT_EQ((Triples{ball.anchor, ball.axis}), (Triples{{4, 5, 6}, {}}));
        EXPECT_EQ(fixed.anchor, (Triple{7, 8, 9}));
        EXPECT_EQ(slider.name, "d to world");
        EXPECT_EQ(slider.axis, (Triple{0, -1, 0}));
        EXPECT_EQ((Triples{universal.axis, universal.to_axis}), (Triples{{3, 0, 0}, {0, 0, 1}}));
        const JointKind kinds[] = {JointKind::hinge, JointKind::ball, JointKind::fixed, JointKind::slider,
                                   JointKind::universal};
        for (std::size_t i = 0; i < scene.joints.size(); ++i) EXPECT_EQ(scene.joints[i].kind, kinds[i]);
    }
    const SceneData data = build_scene(first);
    ASSERT_EQ(data.joints.size(), 5u);
    EXPECT_EQ(std::get<HingeSpec>(data.joints[0]).axis.z, Real{2});
    EXPECT_EQ(int{std::get<BallSpec>(data.joints[1]).to_body}, 0);
    EXPECT_EQ(std::get<FixedSpec>(data.joints[2]).anchor.y, Real{8});
    EXPECT_EQ(std::get<SliderSpec>(data.joints[3]).axis.y, Real{-1});
    EXPECT_EQ(std::get<UniversalSpec>(data.joints[4]).to_axis.z, Real{1});
    const Features needed = needs(data);
    EXPECT_EQ(needed.joints, 5);
    EXPECT_FALSE(needed.touches());
}

constexpr const char* joints_with_ends_and_springs =
    "[[joint]]\nkind = \"hinge\"\nbody = \"a\"\nanchor = [1, 2, 3]\naxis = [0, 0, 2]\nlimits = [-0.5, 2.5]\n"
    "spring = { stiffness = 3, damping = 0.25, angle = -1.5 }\nbreak_force = 70\nbreak_torque = 8\n"
    "[[joint]]\nkind = \"slider\"\nbody = \"b\"\nanchor = [1, 0, 0]\naxis = [0, 1, 0]\nlimits = [0, 12]\n"
    "spring = { stiffness = 40, travel = 9 }\n"
    "[[joint]]\nkind = \"universal\"\nbody = \"c\"\nanchor = [0, 1, 0]\naxis = [1, 0, 0]\nto_axis = [0, 1, 0]\n"
    "spring = { damping = 2 }\nto_spring = { stiffness = 5, angle = 0.125 }\nbreak_torque = 6.5\n"
    "[[joint]]\nkind = \"ball\"\nbody = \"d\"\nanchor = [0, 1, 0]\nspring = { stiffness = 7, damping = 1.5 }\n"
    "[[joint]]\nname = \"rod\"\nkind = \"distance\"\nbody = \"e\"\nto_body = \"d\"\npoint = [3, 4, 0]\n"
    "to_point = [0, 0, 0]\nlength = 5\nbreak_force = 9\n"
    "[[joint]]\nkind = \"distance\"\nbody = \"f\"\npoint = [0, 0, 2]\nto_point = [0, 0, 5]\nleast = 1.25\nmost = 4.5\n"
    "spring = { stiffness = 11, damping = 0.5, rest_length = 2.75 }\n"
    "[[event]]\ntime = 0.5\nkind = \"break_joint\"\njoint = \"rod\"\n"
    "[[event]]\ntime = 0.25\nkind = \"remove_joint\"\njoint = \"f to world\"\n";

TEST(SceneReader, ends_springs_and_strengths_of_joints_arrive_as_written_and_are_written_so) {
    const SceneDescription first = read(world + bodies_named("abcdef") + joints_with_ends_and_springs),
                           again = read(scene_text(first));
    const auto numbers = [](const JointSpringDescription& s) { return Triple{s.stiffness, s.damping, s.rest}; };
    for (const SceneDescription& scene : {first, again}) {
        ASSERT_EQ(scene.joints.size(), 6u);
        const auto& j = scene.joints;
        const std::array<double, 2> ranges[] = {{-0.5, 2.5}, {0, 12}, {0, 0}, {0, 0}, {5, 5}, {1.25, 4.5}},
                                    strengths[] = {{70, 8}, {0, 0}, {0, 6.5}, {0, 0}, {9, 0}, {0, 0}};
        const Triple springs[] = {{3, 0.25, -1.5}, {40, 0, 9}, {0, 2, 0}, {7, 1.5, 0}, {}, {11, 0.5, 2.75}};
        for (std::size_t i = 0; i < j.size(); ++i) {
            EXPECT_EQ((std::array{j[i].least, j[i].most}), ranges[i]) << i;
            EXPECT_EQ((std::array{j[i].break_force, j[i].break_torque}), strengths[i]) << i;
            EXPECT_EQ(numbers(j[i].spring), springs[i]) << i;
        }
        EXPECT_EQ(numbers(j[2].to_spring), (Triple{5, 0, 0.125}));
        EXPECT_EQ((Triples{j[4].anchor, j[4].to_point}), (Triples{{3, 4, 0}, {0, 0, 0}}));
        EXPECT_TRUE(j[4].is_rod());
        EXPECT_EQ(scene.events[0].kind, EventKind::break_joint);
        EXPECT_EQ(scene.events[0].joint, 4);
        EXPECT_EQ(scene.events[1].kind, EventKind::remove_joint);
        EXPECT_EQ(scene.events[1].joint, 5);
    }
    const SceneData data = build_scene(first);
    EXPECT_EQ(std::get<HingeSpec>(data.joints[0]).limits.most, Real{2.5});
    EXPECT_EQ(std::get<UniversalSpec>(data.joints[2]).to_spring.rest, Real{0.125});
    const auto& rope = std::get<DistanceSpec>(data.joints[5]);
    EXPECT_EQ(rope.to_point.z, Real{5});
    EXPECT_EQ(rope.least, Real{1.25});
    EXPECT_EQ(rope.spring.rest, Real{2.75});
    EXPECT_EQ(int{data.events[0].body}, 4);
}

TEST(SceneReader, a_world_has_the_features_of_joints_that_its_scene_needs) {
    const std::string hinge = world + bodies_named("a") +
                              "[[joint]]\nname = \"pin\"\nkind = \"hinge\"\nbody = \"a\"\nanchor = [1, 2, 3]\n"
                              "axis = [0, 0, 2]\n",
                      event = "[[event]]\ntime = 0.5\njoint = \"pin\"\nkind = ";
    // distances, springs, limits, breaks and removal
    const auto features = [](const std::string& text) {
        const Features f = needs(build_scene(read(text)));
        return std::array{f.distances, f.joint_springs, f.joint_limits, f.joint_breaks, f.removal};
    };
    EXPECT_EQ(features(hinge), (std::array{false, false, false, false, false}));
    EXPECT_EQ(features(hinge + "spring = { damping = 1 }\n"), (std::array{false, true, false, false, false}));
    EXPECT_EQ(features(hinge + "limits = [0, 1]\n"), (std::array{false, false, true, false, false}));
    EXPECT_EQ(features(hinge + "break_torque = 1\n"), (std::array{false, false, false, true, false}));
    EXPECT_EQ(features(hinge + event + "\"break_joint\"\n"), (std::array{false, false, false, true, false}));
    EXPECT_EQ(features(hinge + event + "\"remove_joint\"\n"), (std::array{false, false, false, false, true}));
    EXPECT_EQ(features(world + bodies_named("a") +
                       "[[joint]]\nkind = \"distance\"\nbody = \"a\"\npoint = [0, 0, 0]\nto_point = [0, 1, 0]\n"
                       "most = 1.5\n"),
              (std::array{true, false, false, false, false}));
}

// Of hinges, balls, fixed joints, sliders, universal joints and distances.
TEST(SceneReader, a_world_has_the_kinds_of_joints_that_its_scene_has) {
    const auto kinds = [](const std::string& text) {
        const Features f = needs(build_scene(read(text)));
        return std::array{f.hinges, f.balls, f.fixed_joints, f.sliders, f.universals, f.distances};
    };
    const std::string scene = world + bodies_named("a") + "[[joint]]\nbody = \"a\"\n",
                      anchored = "anchor = [1, 2, 3]\n", axis = "axis = [0, 0, 2]\n",
                      of_kind[]{"kind = \"hinge\"\n" + anchored + axis,
                                "kind = \"ball\"\n" + anchored,
                                "kind = \"fixed\"\n" + anchored,
                                "kind = \"slider\"\n" + anchored + axis,
                                "kind = \"universal\"\nto_axis = [0, 1, 0]\n" + anchored + axis,
                                "kind = \"distance\"\npoint = [0, 0, 0]\nto_point = [0, 1, 0]\nmost = 1.5\n"};
    for (std::size_t k = 0; k < std::size(of_kind); ++k) {
        std::array<bool, std::size(of_kind)> expected{};
        expected[k] = true;
        EXPECT_EQ(kinds(scene + of_kind[k]), expected) << of_kind[k];
    }
    EXPECT_EQ(kinds(world + bodies_named("a")), (std::array{true, true, true, true, true, false}));
}

TEST(SceneReader, an_anchor_that_fixed_point_does_not_hold_leaves_floating_point) {
    const auto anchored_at = [](const std::string& x) {
        return read("[range]\nposition = 32768.0\n" + world + bodies_named("a") +
                    "[[joint]]\nkind = \"ball\"\nbody = \"a\"\nanchor = [" + x + ", 0, 0]\n");
    };
    EXPECT_FALSE(anchored_at("4095.0").range.beyond_default);
    const auto& error = anchored_at("4096.0").range.beyond_default;
    ASSERT_TRUE(error);
    EXPECT_EQ(std::string(error->what()),
              "text.toml:13: joint[0].anchor: it is 4096 m from the centre of mass of body \"a\", expected less than "
              "4096 m, the most that fixed point holds; --numbers f64 and f32 have no such limit");
}

TEST(SceneReader, jointed_bodies_are_in_no_layer_and_others_in_all) {
    const SceneDescription scene =
        read(world + bodies_named("a") + "fixed = true\n" + bodies_named("b") + "layers = 0\n" + bodies_named("c") +
             "layers = 5\n" + bodies_named("d") +
             "[[joint]]\nkind = \"ball\"\nbody = \"b\"\nto_body = \"a\"\nanchor = [0, 0, 0]\n");
    for (const SceneDescription& each : {scene, read(scene_text(scene))}) {
        const SceneData data = build_scene(each);
        EXPECT_EQ(
            (std::array{data.bodies[0].layers, data.bodies[1].layers, data.bodies[2].layers, data.bodies[3].layers}),
            (std::array<std::uint16_t, 4>{0xffff, 0, 5, 0xffff}));
        EXPECT_TRUE(needs(data).layers);
    }
    const Features alone = needs(build_scene(read(world + bodies_named("a") + "layers = 0\n" + bodies_named("b"))));
    EXPECT_FALSE(alone.layers || alone.pairs);  // nothing can touch
}

TEST(SceneReader, joints_of_one_tree_may_tie_fixed_bodies_and_the_world) {
    const std::string joints = "[[joint]]\nkind = \"ball\"\nbody = \"a\"\nto_body = \"b\"\nanchor = [0, 0, 0]\n"
                               "[[joint]]\nkind = \"ball\"\nbody = \"c\"\nanchor = [0, 0, 0]\n"
                               "[[joint]]\nkind = \"ball\"\nbody = \"d\"\nto_body = \"b\"\nanchor = [0, 0, 0]\n";
    EXPECT_EQ(error_of(world + bodies_named("ab") + "fixed = true\n" + bodies_named("cd") + joints), "no error");
    EXPECT_EQ(error_of(world + bodies_named("abcd") + joints), "no error");  // a, b and d fly freely
}

TEST(SceneReader, a_fraction_is_kept_exactly_and_a_decimal_in_quotes_equals_the_number) {
    const StepSize fraction = parse_step("3/1000").value(), decimal = parse_step("0.005").value();
    EXPECT_EQ(fraction.numerator, 3);
    EXPECT_EQ(fraction.denominator, 1000);
    EXPECT_EQ(fraction.seconds(), 3.0 / 1000.0);
    EXPECT_EQ(decimal.denominator, 0);
    EXPECT_EQ(decimal.seconds(), 0.005);
}

TEST(SceneReader, step_that_is_neither_fraction_nor_decimal_is_refused) {
    for (const char* text : {"", "/", "1/", "/256", "1/0", "0/1", "-1/256", "+1/256", " 1/256", "1 / 256", "0x10",
                             "nan", "inf", "1e999", "1/256/2", "0"})
        EXPECT_FALSE(parse_step(text)) << text;
}

TEST(SceneReader, steps_end_at_or_just_after_the_duration) {
    struct Case {
        const char* step;
        double duration;
        std::int64_t steps;
    };
    for (const Case& c : {Case{"1/256", 4.0, 1024},
                          {"1/256", 0.3, 77},
                          {"1/256", 1.0 / 256.0, 1},
                          {"1/256", 1.001 / 256.0, 2},
                          {"1/10", 0.1, 1},
                          {"1/3", 1.0, 3},
                          {"0.005", 4.0, 800},
                          {"0.1", 0.3, 3},
                          {"0.1", 0.31, 4},
                          {"0.005", 0.3, 60},
                          {"1/256", 0.0, 0},
                          {"1/256", 1e-6, 1},
                          {"1/256", 8388608.0, max_steps},
                          {"1/256", 8388608.0 + 1.0 / 512.0, max_steps + 1},
                          {"1/256", 1e300, std::numeric_limits<std::int64_t>::max()}})
        EXPECT_EQ(steps_of(c.step, c.duration), c.steps) << c.step << " " << c.duration;
    EXPECT_EQ(read("[world]\nstep = \"1/256\"\nduration = 8388608\n" + brick).steps(), max_steps);
}

TEST(SceneReader, whole_numbers_of_decimal_steps_are_not_rounded_up) {
    for (const char* step : {"0.1", "0.005", "0.001", "1/10", "1/1000", "1/256", "7/1000"}) {
        const double size = parse_step(step)->seconds();
        for (std::int64_t n = 1; n < 20000; ++n) ASSERT_EQ(steps_of(step, static_cast<double>(n) * size), n) << step;
    }
}

TEST(SceneReader, three_moments_are_a_diagonal_tensor_and_six_elements_a_full_one) {
    using Tensor = std::array<double, 6>;
    const auto body = [](const std::string& inertia) {
        return read(world + brick + "inertia = " + inertia + "\n").bodies.at(0);
    };
    EXPECT_EQ(body("[1, 2, 3]").inertia, (Tensor{1.0, 2.0, 3.0, 0.0, 0.0, 0.0}));  // 1 + 2 = 3: equality is allowed
    EXPECT_TRUE(body("[1, 2, 3]").inertia_is_diagonal);
    const std::string full = "[20, 25, 30, 1.5, -0.8, 0.6]";
    EXPECT_EQ(body(full).inertia, (Tensor{20.0, 25.0, 30.0, 1.5, -0.8, 0.6}));
    EXPECT_FALSE(body(full).inertia_is_diagonal);
    EXPECT_TRUE(body("[20, 25, 30, 0, 0, 0]").inertia_is_diagonal);
}

TEST(SceneReader, turned_flat_plate_passes_the_triangle_inequality_at_every_angle) {
    // moments 1, 2, 3 turned about z and then about x: equality, up to rounding
    for (int i = 0; i < 200; ++i) {
        const double a = 0.1 * i, b = 0.37 * i, c = std::cos(a), s = std::sin(a), d = std::cos(b), t = std::sin(b);
        const double xx = c * c + 2.0 * s * s, yy = s * s + 2.0 * c * c, xy = -c * s;
        std::string numbers;
        for (const double x :
             {xx, d * d * yy + 3.0 * t * t, t * t * yy + 3.0 * d * d, d * xy, t * xy, d * t * (yy - 3.0)}) {
            std::array<char, 64> text{};
            std::snprintf(text.data(), text.size(), "%s%.17e", numbers.empty() ? "" : ", ", x);
            numbers += text.data();
        }
        ASSERT_EQ(error_of(world + brick + "inertia = [" + numbers + "]\n"), "no error") << i;
    }
}

TEST(SceneReader, a_body_without_shape_and_inertia_is_a_point_mass) {
    const std::string comet = "[[body]]\nname = \"comet\"\nshape = \"none\"\nmass = 2\n";
    EXPECT_TRUE(read(world + comet).bodies.at(0).is_point_mass());
    EXPECT_FALSE(read(world + comet + "inertia = [1, 2, 3]\n").bodies.at(0).is_point_mass());
    EXPECT_FALSE(read(world + brick).bodies.at(0).is_point_mass());
    // Nothing that does not turn it is refused, and angular drag is that of the others.
    const std::string still = "orientation = [-2, 0, 0, 0]\nangular_velocity = [0, 0, 0]\nfriction = 0.5\n",
                      rest = "[[spring]]\nbody = \"comet\"\npoint = [0, 0, 0]\nto_body = \"brick\"\n"
                             "to_point = [1, 0, 0]\nstiffness = 1\n"
                             "[[impulse]]\nbody = \"comet\"\ntime = 0\nimpulse = [1, 0, 0]\npoint = [0, 0, 0]\n"
                             "frame = \"world\"\nangular_impulse = [0, 0, 0]\n"
                             "[[force]]\nbody = \"comet\"\nuntil = 1\nforce = [1, 0, 0]\ntorque = [0, 0, 0]\n";
    EXPECT_EQ(error_of(world + "angular_drag = 0.5\n" + comet + still + brick + rest), "no error");
}

TEST(SceneReader, points_in_a_plane_are_accepted_and_points_on_a_line_with_inertia) {
    const std::string cloud = world + "[[body]]\nname = \"cloud\"\nshape = { points = ",
                      rod = cloud + "[[0, 0, -1, 1], [0, 0, 1, 1]] }\n";
    EXPECT_EQ(error_of(cloud + "[[1, 1, 1, 1], [2, 1, 1, 1], [1, 2, 1, 1]] }\n"), "no error");
    EXPECT_NE(error_of(rod).find("lie on one line"), std::string::npos);
    EXPECT_EQ(error_of(rod + "inertia = [2, 2, 0.1]\n"), "no error");
}

TEST(SceneReader, face_becomes_an_inward_impulse_at_its_centre) {
    struct Case {
        const char* face;
        Triple impulse, point;
    };
    for (const Case& c : std::initializer_list<Case>{{"-x", {5.0, 0.0, 0.0}, {-0.5, 0.0, 0.0}},
                                                     {"+x", {-5.0, 0.0, 0.0}, {0.5, 0.0, 0.0}},
                                                     {"-y", {0.0, 5.0, 0.0}, {0.0, -2.0, 0.0}},
                                                     {"+y", {0.0, -5.0, 0.0}, {0.0, 2.0, 0.0}},
                                                     {"-z", {0.0, 0.0, 5.0}, {0.0, 0.0, -4.5}},
                                                     {"+z", {0.0, 0.0, -5.0}, {0.0, 0.0, 4.5}}}) {
        const auto scene = read(world + brick + "[[impulse]]\ntime = 0.5\nbody = \"brick\"\nface = \"" + c.face +
                                "\"\nstrength = 5.0\n");
        const ImpulseDescription& impulse = scene.impulses.at(0);
        EXPECT_EQ(impulse.frame, Frame::body) << c.face;
        EXPECT_EQ(impulse.impulse, c.impulse) << c.face;
        EXPECT_EQ(impulse.point, c.point) << c.face;
    }
}

TEST(SceneReader, letters_outside_ascii_are_fine_in_quotes_and_comments) {
    for (const char* name : {"\"\u00e9t\u00e9 # \\\" \u00b5\"", "'\u00b5 \\'", "\"\"\"\n\u00b5 \" \u00b5\"\"\"",
                             "'''\n\u00b5 ' \u00b5'''"})
        EXPECT_EQ(error_of(std::string("\xef\xbb\xbf") + "name = " + name + "   # \u00b5 \" \u00b5\n" + world + brick),
                  "no error")
            << name;
}

TEST(SceneReader, events_keep_the_order_of_the_file) {
    std::string toml = world + brick;
    for (const char* time : {"2.0", "1.0", "1.0"})
        toml += std::string("[[impulse]]\ntime = ") + time + "\nbody = \"brick\"\nimpulse = [1, 0, 0]\n";
    const auto scene = read(toml);
    ASSERT_EQ(scene.impulses.size(), 3u);
    EXPECT_EQ(scene.impulses[0].time, 2.0);
    EXPECT_EQ(scene.impulses[1].time, 1.0);
}

TEST(SceneReader, cube_scenes_differ_in_name_and_step_only) {
    const auto text = [](const char* stem) {
        std::string kept;
        for (const std::string& line : lines_of(contents(shipped(stem))))
            if (!line.starts_with("#") && !line.starts_with("name     ") && !line.starts_with("step") &&
                !line.starts_with("name = \"cube"))
                kept += line + "\n";
        return kept;
    };
    EXPECT_EQ(text("cube"), text("cube_binary"));
    const auto decimal = read_scene(shipped("cube")), binary = read_scene(shipped("cube_binary"));
    EXPECT_EQ(decimal.steps(), 800);
    EXPECT_EQ(binary.steps(), 1024);
    EXPECT_EQ(decimal.impulses.size(), 9u);
}

}  // namespace
}  // namespace tumble::host
