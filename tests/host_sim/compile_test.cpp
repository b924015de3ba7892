// `tumble compile`: the header of a scene.
#include <algorithm>
#include <set>

#include "command_runner.hpp"

namespace tumble::host {
namespace {

TEST(Compile, a_scene_named_after_a_member_of_its_struct_gets_another_name) {
    expect_outcome(tumble({"compile", written("config.toml", scene_of("", body_of("a", "sphere = 1.0")))}), 0,
                   "struct ConfigScene {");
}

TEST(Compile, the_struct_has_the_name_that_is_asked_for) {
    const std::string scene = written("named.toml", scene_of("", body_of("a", "sphere = 1.0")));
    expect_outcome(tumble({"compile", scene, "--struct", "first_flight"}), 0, "struct first_flight {");
    for (const auto* name : {"", "a b", "1st", "Config", "bodies", "Bodies", "class", "xor", "std", "tumble"}) {
        expect_outcome(tumble({"compile", scene, "--struct", name}), 2,
                       "--struct: got \"" + std::string(name) + "\", expected a name in C++");
    }
}

TEST(Compile, header_holds_what_the_scene_needs_and_nothing_else) {
    const std::string path = temporary("scene.hpp");
    ASSERT_EQ(tumble({"compile", shipped("ball"), "-o", path}).status, 0);
    const std::string header = contents(path);
    expect_parts(header,
                 {"struct Ball {", "name = \"bouncing ball\"", "step{1, 256}", "steps = 1280u", ".restitution = 0.8",
                  "using Numbers = tumble::NumbersOf<\"q32\", tumble::RangeOf<\"near\">>;",
                  "using Integrator = tumble::integrators::Verlet;", ".bodies = 1,", ".planes = 1,",
                  "static_assert(TUMBLE_BITS == "});
    for (const auto* part :
         {"boxes = true", "friction = true", "impulses = true", "forces = true", "drag = true", ".springs ="})
        EXPECT_FALSE(has(header, part)) << part;
}

int near_pairs(const std::string& scene) {
    const std::string text = text_of({"compile", scene});
    const std::size_t at = text.find(".near_pairs = ");
    return at == std::string::npos ? 0 : std::stoi(text.substr(at + 14));
}

TEST(Compile, there_is_room_for_the_pairs_of_packed_boxes) {
    // Neighbours along two directions and both diagonals, and the floor.
    for (const int n : {4, 5}) {
        const int pairs = 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + n * n;
        const int room = near_pairs(written("packed.toml", packed_boxes(n, "0.25")));
        EXPECT_GE(room, pairs) << n;
        EXPECT_LE(room, 2 * pairs) << n;
    }
}

TEST(Compile, a_scene_has_room_for_the_pairs_of_its_replay_and_their_root) {
    EXPECT_EQ(near_pairs(shipped("contacts/stack")), 10 + 4);  // each box is on the next, or on the floor
    EXPECT_EQ(near_pairs(shipped("contacts/rolling")), 3 + 2);
    // These have the usual room: no contacts, and one pair.
    for (const char* scene : {"brick", "ball"}) EXPECT_EQ(near_pairs(shipped(scene)), 0);
}

// Names that C++ does not take, that it has itself, or that two bodies share once they are written in it.
TEST(Compile, bodies_have_their_ids_by_their_names) {
    std::string bodies;
    for (const char* name : {"ball", "the ball", "the-ball", "2nd", "float", "\u00e9", "_Ball_", "Bodies"})
        bodies += body_of(name, "sphere = 1.0");
    const std::string scene = written("ids.toml", scene_of("", bodies));
    std::string expected = "    struct Bodies {\n";
    int index = 0;
    for (const char* name : {"ball", "the_ball", "the_ball_2", "body_2nd", "float_4", "body_", "Ball_", "Bodies_7"})
        expected +=
            std::string("        static constexpr tumble::BodyId ") + name + "{" + std::to_string(index++) + "};\n";
    expect_outcome(tumble({"compile", scene}), 0, expected);
}

TEST(Compile, joints_are_specs_of_their_kind_and_have_ids_by_their_names) {
    const std::string header = text_of({"compile", shipped("joints/double_pendulum")});
    expect_parts(header,
                 {"#include <tuple>\n",
                  "static constexpr std::tuple joints{\n        tumble::HingeSpec{   // \"shoulder\"",
                  "            .body = 1,\n            .to_body = 0,\n            .anchor = {0.9092974268256817, "
                  "0.4161468365471424, 0.0},   // m\n        },\n",
                  "static constexpr tumble::JointId shoulder{0};\n", "JointId elbow{1};\n", ".joints = 2,"});
    for (const char* part : {".pairs", ".boxes", ".planes"}) EXPECT_FALSE(has(header, part)) << part;
    const std::string rod = "[[body]]\nname = \"rod\"\nshape = { box = [1, 1, 1] }\nmass = 1\nlayers = 0\n" +
                            joint_of("ball", "rod", "", "[0, 0, 0]"),
                      beside = text_of(
                          {"compile", written("beside.toml", scene_of("", body_of("a", "sphere = 1.0") + rod))});
    expect_parts(beside, {".layers = 0,", ".layers = true,", ".planes = 1,", "tumble::BallSpec{"});
    EXPECT_FALSE(has(text_of({"compile", written("alone.toml", world_of("0", "1/256", "1") + rod)}), "layers"));
    const std::string ball = text_of({"compile", shipped("ball")});
    for (const char* part : {"tuple", "oint"}) EXPECT_FALSE(has(ball, part)) << part;
}

TEST(Compile, joints_have_their_ends_springs_and_strengths_and_no_feature_that_they_do_not_need) {
    const std::string head = world_of("-9.81", "1/256", "1") + body_of("a", "sphere = 0.5");
    const auto header_of = [&](const std::string& joint) {
        return text_of({"compile", written("joint.toml", head + joint)});
    };
    const std::string hinge = header_of(joint_of("hinge", "a", "", "[0, 1, 0]",
                                                 "axis = [0, 0, 1]\nlimits = [-0.5, 1.25]\nbreak_torque = 7.5\n"
                                                 "spring = { stiffness = 3, damping = 0.25, angle = -1.5 }\n")),
                      rope = header_of(distance_of("a", "[0, 0, 0]", "[0, 2, 0]", "most = 2.5\nbreak_force = 40")),
                      cardan =
                          header_of(joint_of("universal", "a", "", "[0, 0, 0]",
                                             "axis = [1, 0, 0]\nto_axis = [0, 1, 0]\nto_spring = { damping = 2 }\n") +
                                    "[[event]]\ntime = 0.5\nkind = \"remove_joint\"\njoint = \"a to world\"\n");
    expect_parts(hinge,
                 {".spring = {\n                .stiffness = 3.0,   // N m/rad or N/m\n                .damping = "
                  "0.25,   // N m s/rad or N s/m\n                .rest = -1.5,   // rad or m\n            },\n",
                  ".limits = {\n                .least = -0.5,   // rad or m\n                .most = 1.25,",
                  ".break_torque = 7.5,   // N m\n", ".joint_springs = true,", ".joint_limits = true,",
                  ".joint_breaks = true,"});
    for (const char* part : {".distances", ".removal", ".break_force", ".hinges"})
        EXPECT_FALSE(has(hinge, part)) << part;
    expect_parts(hinge, {".balls = false,", ".fixed_joints = false,", ".sliders = false,", ".universals = false,"});
    expect_parts(rope, {"tumble::DistanceSpec{   // \"a to world\"\n            .body = 0,\n            .to_point = "
                        "{0.0, 2.0, 0.0},   // m\n            .most = 2.5,   // m\n",
                        ".break_force = 40.0,   // N\n", ".distances = true,", ".joint_breaks = true,"});
    for (const char* part : {".anchor", ".least", ".joint_springs", ".joint_limits"})
        EXPECT_FALSE(has(rope, part)) << part;
    expect_parts(cardan, {".to_spring = {\n                .damping = 2.0,", ".kind = tumble::EventKind::remove_joint,",
                          ".body = 0,\n", ".removal = true,"});
    EXPECT_FALSE(has(cardan, " .spring"));
}

TEST(Compile, a_scene_without_bodies_needs_an_option) {
    const std::string scene = written("bodiless.toml", "[world]\nstep = 0.1\nduration = 1.0\n");
    EXPECT_EQ(tumble({"compile", scene}).status, 2);
    expect_outcome(tumble({"compile", scene, "--no-bodies"}), 0, "std::array<tumble::BodySpec, 0> bodies{};",
                   "            .bodies = 0,\n        };");
}

TEST(Compile, goes_to_standard_output_by_default) {
    expect_outcome(
        tumble({"compile", shipped("cube_binary"), "--integrator", "rk4", "--numbers", "f64", "--carry", "on"}), 0,
        "struct CubeBinary {", "tumble::NumbersOf<\"f64_carried\", ", "tumble::integrators::Rk4", "boxes = true",
        "friction = true", "impulses = true");
}

TEST(Compile, names_cannot_break_the_header) {
    const std::string scene = written(
        "1 odd-name.toml",
        "name = \"a \\\"b\\\" \\\\\"\n[world]\nstep = 0.1\nduration = 1.0\n[[body]]\nname = \"\\u00e9\\n*/ \\\\\"\n"
        "shape = { sphere = 1.0 }\nmass = 1.0\n");
    expect_outcome(tumble({"compile", scene}), 0, "struct Scene1OddName {", R"(name = "a \"b\" \\";)",
                   R"(// "\303\251\012*/ \\")", "step{tumble::Real{0.1}}");
}

// The features of a header that differ from their default, without numbers.
std::set<std::string> features_of(const std::string& scene) {
    std::set<std::string> features;
    const std::string start = "            .";
    bool inside = false;
    for (const std::string& line : lines_of(text_of({"compile", written("scene.toml", scene)}))) {
        if (line == "        static constexpr tumble::Features features{") inside = true;
        else if (!line.starts_with(start)) inside = false;
        else if (inside) features.insert(line.substr(start.size(), line.size() - start.size() - 1));
    }
    std::erase_if(features, [](const std::string& f) {
        return f.starts_with("bodies") || f.starts_with("planes") || f.starts_with("near_pairs");
    });
    return features;
}
using Features = std::set<std::string>;

TEST(Compile, features_are_those_that_the_contacts_need) {
    const std::string ball = body_of("ball", "sphere = 1.0"), other = body_of("other", "sphere = 1.0"),
                      box = body_of("box", "box = [1.0, 1.0, 1.0]"), fixed = "fixed = true\n",
                      turning = "angular_velocity = [0.0, 2.0, 0.0]\n", rough = "friction = 0.5\n",
                      cloud = "[[body]]\nname = \"cloud\"\nshape = { points = [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, "
                              "1.0], [0.0, 1.0, 0.0, 1.0]] }\n";
    const auto features = [](const std::string& bodies) { return features_of(scene_of("", bodies)); };
    EXPECT_EQ(features(ball), Features{});
    EXPECT_EQ(features(ball + rough), Features{"friction = true"});
    EXPECT_EQ(features(rough + ball), Features{"friction = true"});  // the plane's
    for (const std::string resists : {"rolling_resistance = 0.001\n", "spinning_resistance = 0.001\n"}) {
        EXPECT_EQ(features(ball + resists), (Features{"friction = true", "rolling_resistance = true"}));
        EXPECT_EQ(features(resists + ball), (Features{"friction = true", "rolling_resistance = true"}));
    }
    EXPECT_EQ(features(ball + other), Features{"pairs = true"});
    EXPECT_EQ(features(ball + other + fixed), Features{"pairs = true"});
    EXPECT_EQ(features(ball + fixed + other + fixed), Features{});
    EXPECT_EQ(features(ball + box), (Features{"pairs = true", "boxes = true"}));
    EXPECT_EQ(features(box + fixed), Features{"boxes = true"});
    EXPECT_EQ(features(ball + cloud), Features{});
    EXPECT_EQ(features(ball + turning), Features{});
    EXPECT_EQ(features(ball + turning + fixed), Features{"turntables = true"});
    EXPECT_EQ(features(ball + turning + "kinematic = true\n"), Features{"kinematic = true"});
    EXPECT_EQ(features(ball + "kinematic = true\n" + other), (Features{"pairs = true", "kinematic = true"}));
    EXPECT_EQ(features(ball + fixed + other + "kinematic = true\n"), Features{"kinematic = true"});
    for (const auto* shape : {"cylinder = [1.0, 1.0]", "capsule = [1.0, 1.0]", "hoop = 1.0"}) {
        EXPECT_EQ(features(body_of("a", shape)), Features{"round_shapes = true"}) << shape;
        EXPECT_EQ(features(body_of("a", shape) + ball), Features{"round_shapes = true"}) << shape;
        EXPECT_EQ(features(body_of("a", shape) + fixed), Features{}) << shape;
    }
    // Only the hoop moves, and it touches no bodies.
    EXPECT_EQ(features(ball + fixed + other + fixed + body_of("a", "hoop = 1.0")), Features{"round_shapes = true"});

    const std::string head = "name = \"test\"\n[world]\nstep = \"1/256\"\nduration = 0.1\n";
    EXPECT_EQ(features_of(head + box + rough), Features{});
    EXPECT_EQ(features_of(head + body_of("a", "hoop = 1.0") + ball), Features{});
    EXPECT_EQ(features_of(head + box + rough + ball), (Features{"pairs = true", "boxes = true", "friction = true"}));
    EXPECT_EQ(features_of(head + "[contact]\nresponse = \"spring\"\n" + ball), Features{});
}

TEST(Compile, features_are_those_of_the_contact_response) {
    const std::string everything = body_of("ball", "sphere = 1.0") + "friction = 0.5\n" +
                                   body_of("box", "box = [1.0, 1.0, 1.0]") + body_of("hoop", "hoop = 1.0") +
                                   body_of("table", "cylinder = [1.0, 1.0]") +
                                   "fixed = true\nangular_velocity = [0.0, 0.0, 1.0]\n";
    const auto features = [&](const std::string& contact) { return features_of(scene_of(contact, everything)); };
    const std::string sleep = "sleep = { time = 1.0 }\n";
    EXPECT_EQ(features("[contact]\n" + sleep),
              (Features{"pairs = true", "boxes = true", "round_shapes = true", "friction = true", "sleep = true",
                        "turntables = true", "bounded_steps = true"}));
    EXPECT_EQ(features("[contact]\nsleep = false\n"),
              (Features{"pairs = true", "boxes = true", "round_shapes = true", "friction = true", "turntables = true",
                        "bounded_steps = true"}));
    EXPECT_EQ(features("[contact]\nresponse = \"spring\"\n" + sleep),
              (Features{"pairs = true", "boxes = true", "round_shapes = true", "turntables = true",
                        "contact_impulses = false", "contact_springs = true"}));
    EXPECT_EQ(features("[contact]\nresponse = \"none\"\n" + sleep), Features{"turntables = true"});
    EXPECT_EQ(features("[contact]\nrestitution_mixing = \"mean\"\n").count("mixing = true"), 1u);
    EXPECT_EQ(features("[contact]\nmost_searches = 4\n").count("impact_bounds = true"), 1u);
    EXPECT_EQ(features("[contact]\nmost_searches = 0\n").count("impact_bounds = true"), 0u);
    EXPECT_EQ(features("[contact]\nmost_sweeps = 8\n").count("impact_bounds = true"), 1u);
    EXPECT_EQ(features("[contact]\nexact_bodies = 0\n").count("bounded_steps = true"), 1u);
    EXPECT_EQ(features("[contact]\nexact_bodies = 0\n").count("exact_steps = false"), 1u);
    EXPECT_EQ(features("[contact]\nexact_bodies = 2\n").count("exact_steps = false"), 0u);
    EXPECT_EQ(features("[contact]\nexact_bodies = 3\n").count("bounded_steps = true"), 0u);
    EXPECT_EQ(features("[contact]\nrestitution_mixing = \"larger\"\n").count("mixing = true"), 0u);
}

// Bodies that could be many at one time need the code of bounded steps: more than two, or more than sixteen balls.
TEST(Compile, features_have_bounded_steps_where_bodies_may_be_many) {
    const auto is_bounded = [&](int balls, int boxes, const std::string& contact = "") {
        std::string bodies;
        for (int i = 0; i < balls + boxes; ++i)
            bodies += body_of("b" + std::to_string(i), i < balls ? "sphere = 1.0" : "box = [1.0, 1.0, 1.0]");
        const std::string fixed = body_of("table", "box = [1.0, 1.0, 1.0]") + "fixed = true\n";
        return features_of(scene_of(contact, bodies + fixed)).count("bounded_steps = true") > 0;
    };
    EXPECT_FALSE(is_bounded(0, 2));
    EXPECT_FALSE(is_bounded(1, 1));
    EXPECT_FALSE(is_bounded(16, 0));
    EXPECT_TRUE(is_bounded(0, 3));
    EXPECT_TRUE(is_bounded(2, 1));
    EXPECT_TRUE(is_bounded(17, 0));
    EXPECT_FALSE(is_bounded(0, 3, "[contact]\nexact_bodies = 1000\n"));
    EXPECT_FALSE(is_bounded(0, 3, "[contact]\nresponse = \"spring\"\n"));
    EXPECT_TRUE(is_bounded(2, 0, "[contact]\nexact_bodies = 1\n"));
}

TEST(Compile, contact_has_the_members_of_its_response_that_differ_from_their_default) {
    // The lines between the braces of `.contact = {`, without indentation and comments.
    const auto members = [](const std::string& contact) {
        const std::string scene = scene_of("[contact]\n" + contact, body_of("a", "sphere = 1.0"));
        const auto lines = lines_of(text_of({"compile", written("scene.toml", scene)}));
        const auto first = std::find(lines.begin(), lines.end(), "        .contact = {");
        const auto last = std::find(first, lines.end(), "        },");
        std::vector<std::string> members;
        for (auto line = first; line < last; ++line) {
            if (line == first) continue;
            const std::size_t start = line->find_first_not_of(' ');
            members.push_back(line->substr(start, line->find("   //") - start));
        }
        return members;
    };
    using Members = std::vector<std::string>;
    const std::string spring = ".response = tumble::ContactResponse::spring,",
                      constants = "stiffness = 500.0\ndamping = 3.0\nbarrier = 0.5\n";
    EXPECT_EQ(members(""), Members{});
    EXPECT_EQ(members(constants + "sleep = { speed = 0.25 }\n"),
              (Members{".sleep = {", ".on = true,", ".speed = 0.25,", "},"}));
    EXPECT_EQ(members("rolling_resistance = 0.5\nspinning_resistance = 0.25\nfriction_mixing = \"product\"\n"),
              (Members{".rolling_resistance = 0.5,", ".spinning_resistance = 0.25,",
                       ".friction_mixing = tumble::Mixing::product,"}));
    EXPECT_EQ(members("restitution = 0\ntolerance = 0.01\nmost_impacts = 1\nmost_searches = 4\nmost_sweeps = "
                      "8\nexact_bodies = 2\n"),
              (Members{".restitution = 0.0,", ".tolerance = 0.01,", ".most_impacts = 1,", ".most_searches = 4,",
                       ".most_sweeps = 8,", ".exact_bodies = 2,"}));
    EXPECT_EQ(members("response = \"spring\"\n"), Members{spring});
    EXPECT_EQ(
        members("response = \"spring\"\nfriction = 0.5\nsleep = { speed = 0.25 }\nmost_sweeps = 8\ntolerance = 0.01\n" +
                constants),
        (Members{spring, ".tolerance = 0.01,", ".stiffness = 500.0,", ".damping = 3.0,", ".barrier = 0.5,"}));
    EXPECT_EQ(members("response = \"none\"\n" + constants), Members{".response = tumble::ContactResponse::none,"});
}

}  // namespace
}  // namespace tumble::host
