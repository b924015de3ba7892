// `tumble compare`: a core in QEMU has the same bits as the host, and the first difference is reported with its place.
#include <regex>

#include "command_runner.hpp"

namespace tumble::host {
namespace {

void expect_core_agrees(const std::string& numbers) {
    expect_outcome(tumble({"compare", shipped("cube"), "--core", "cortex-m3", "--every", "7", "--duration", "2",
                           "--numbers", numbers}),
                   0, "cortex-m3 agrees with the host: 59 states, verlet, " + numbers);
}
TEST(Compare, host_and_core_agree_in_every_recorded_state) { expect_core_agrees("q32"); }
TEST(CompareDeep, host_and_core_agree_in_every_recorded_state_of_floats) {
    for (const char* numbers : {"f32", "f64"}) expect_core_agrees(numbers);
}

// The host has every feature compiled in, the core those of the recording.
TEST(CompareDeep, a_recording_of_a_live_run_gives_the_same_bits_on_a_core) {
    const std::string record = temporary("recorded.toml");
    std::string states;
    Process process({TUMBLE_COMMAND, "run", shipped("cube"), "--live", "--duration", "0.5", "--record", record},
                    "{\"kind\": \"force\", \"body\": \"cube\", \"frame\": \"body\", \"value\": [1, 2, 0.5]}\n"
                    "{\"step\": 20}\n"
                    "{\"kind\": \"torque\", \"body\": \"cube\", \"value\": [0.1, 0.2, 0.05]}\n{\"step\": 20}\n"
                    "{\"kind\": \"impulse\", \"body\": \"cube\", \"value\": [1, 2, 0.5], \"point\": [0, 0.1, 0]}\n"
                    "{\"kind\": \"pose\", \"body\": \"cube\", \"value\": [1, 2, 0.5]}\n{\"step\": 500}\n");
    ASSERT_EQ(process.wait(&states), 0);
    const std::string hash = Json::parse(lines_of(states).back())["state_hash"];
    const Outcome outcome = tumble({"compare", record, "--core", "cortex-m3", "--duration", "0.5"});
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    EXPECT_TRUE(has(outcome.text, "cortex-m3 agrees with the host")) << outcome.text;
    EXPECT_TRUE(has(outcome.text, "hash " + hash)) << outcome.text;
}

// One body under air, wheels and the gravity gradient, beside one without them.
TEST(CompareDeep, loads_that_a_scene_gives_to_bodies_have_the_same_bits_on_a_core) {
    const std::string free = "[[body]]\nname = \"free\"\nshape = { sphere = 0.1 }\nmass = 1.0\n"
                             "velocity = [1.0, 2.0, 0.0]\n",
                      scene =
                          world_of("-9.81", "1/256", "1.0") +
                          "wind = [2.0, 0.0, 1.0]\n[gravity_gradient]\norbit_rate = 0.5\nto_centre = [0.0, -1.0, "
                          "0.5]\n" +
                          free +
                          "[[body]]\nname = \"craft\"\nshape = { box = [0.5, 1.0, 2.0] }\n"
                          "mass = 2.0\nposition = [10.0, 0.0, 0.0]\nvelocity = [1.0, 5.0, 0.0]\nangular_velocity = "
                          "[1.0, 0.5, -0.5]\nlinear_drag = 0.125\nquadratic_drag = 0.25\nwheel_momentum = [0.5, 0.0, "
                          "0.25]\n";
    expect_outcome(tumble({"compare", written("loads.toml", scene), "--core", "cortex-m3"}), 0,
                   "cortex-m3 agrees with the host: 257 states");
}

TEST(Compare, joints_have_the_same_bits_on_a_core) {
    expect_outcome(tumble({"compare", shipped("joints/double_pendulum"), "--core", "cortex-m3", "--every", "16",
                           "--duration", "2"}),
                   0, "cortex-m3 agrees with the host: 33 states");
}

// Without the check, whose references are worlds of their own.
TEST(Compare, ropes_limits_springs_and_breaks_have_the_same_bits_on_a_core) {
    expect_outcome(
        tumble({"compare", shipped("joints/rope"), "--core", "cortex-m3", "--every", "64", "--check", "off"}), 0,
        "cortex-m3 agrees with the host: 81 states");
    expect_outcome(
        tumble({"compare", shipped("joints/door"), "--core", "cortex-m3", "--every", "16", "--check", "off"}), 0,
        "cortex-m3 agrees with the host: 65 states");
    expect_outcome(
        tumble({"compare",
                written("springs.toml", scene_of_springs + "[[event]]\ntime = 1\nkind = \"break_joint\"\n"
                                                           "joint = \"arm to world\"\n[[event]]\ntime = 1.5\n"
                                                           "kind = \"remove_joint\"\njoint = \"drawer to "
                                                           "world\"\n"),
                "--core", "cortex-m3", "--every", "64", "--check", "off"}),
        0, "cortex-m3 agrees with the host: 33 states");
}

TEST(CompareDeep, every_kind_of_joint_has_the_same_bits_on_a_core) {
    for (const char* scene : {"gyroscope", "chain", "arm"})
        expect_outcome(tumble({"compare", shipped("joints/" + std::string(scene)), "--core", "cortex-m3", "--every",
                               "16", "--duration", "0.5"}),
                       0, "cortex-m3 agrees with the host");
    expect_outcome(
        tumble({"compare", written("kinds.toml", scene_of_every_joint), "--core", "cortex-m0", "--every", "16"}), 0,
        "cortex-m0 agrees with the host: 33 states");
}

TEST(CompareDeep, joints_have_the_same_bits_on_a_core_with_floats_and_on_risc_v) {
    expect_outcome(tumble({"compare", shipped("joints/double_pendulum"), "--core", "cortex-m4f", "--numbers", "f32",
                           "--every", "16", "--duration", "1", "--check", "off"}),
                   0, "cortex-m4f agrees with the host: 17 states, verlet, f32");
    expect_outcome(tumble({"compare", shipped("joints/double_pendulum"), "--core", "rv32imac", "--every", "16",
                           "--duration", "1", "--check", "off"}),
                   0, "rv32imac agrees with the host: 17 states, verlet, q32");
}

TEST(CompareDeep, every_load_gives_the_same_bits) {
    for (const auto* scene : {"pendulum", "projectile", "satellite", "orbit"}) {
        SCOPED_TRACE(scene);
        (void)text_of({"compare", shipped(scene), "--core", "cortex-m4f", "--every", "64", "--duration", "4",
                       "--integrator", "rk4"});
    }
}

// The host is compiled with every feature, the core with those that the scene needs.
TEST(CompareDeep, every_contact_gives_the_same_bits) {
    const std::string head = world_of("-9.81", "1/256", "2.0"), floor = floor_plane,
                      soft = "[contact]\nresponse = \"spring\"\nstiffness = 2000.0\ndamping = 2.0\n";
    const std::string balls = body_of("low", "sphere = 0.25", "[0.0, 0.5, 0.0]") +
                              body_of("high", "sphere = 0.25", "[0.1, 1.5, 0.0]"),
                      table = body_of("table", "box = [4.0, 1.0, 4.0]", "[0.0, -0.5, 0.0]") +
                              "angular_velocity = [0.0, 1.0, 0.0]\nfixed = true\n",
                      crate = body_of("crate", "box = [0.5, 0.5, 0.5]", "[1.0, 0.3, 0.0]"),
                      point = "[[body]]\nname = \"point\"\nshape = \"none\"\nmass = 0.5\nposition = [0.5, 1.0, 0.0]\n",
                      tie = "[[spring]]\nbody = \"low\"\npoint = [0.25, 0.0, 0.0]\nto_body = \"point\"\n"
                            "stiffness = 20.0\n";
    const std::vector<std::pair<const char*, std::string>> scenes = {
        {"pairs", head + floor + balls},
        {"turntable", head + "[contact]\nfriction = 0.5\n" + table + crate},
        {"rolling", head + "[contact]\nfriction = 0.5\nrolling_resistance = 0.003\nrestitution_mixing = \"mean\"\n" +
                        floor + balls + crate},
        {"sleep", head + "[contact]\nrestitution = 0.0\nfriction = 0.5\nsleep = { time = 0.25 }\n" + floor + crate},
        {"round", head + "[contact]\nfriction = 0.5\n" + floor +
                      body_of("can", "cylinder = [0.25, 0.5]", "[0.0, 1.0, 0.0]") +
                      "angular_velocity = [1.0, 2.0, 0.5]\n"},
        {"points", head + floor + balls + point + tie},
        {"soft", head + soft + floor + balls},
        {"soft_boxes", head + soft + floor + crate + "angular_velocity = [1.0, 0.0, 0.5]\n"},
        {"barrier", head + soft + "barrier = 0.5\n" + floor + balls}};
    for (const auto& [name, scene] : scenes) {
        const Outcome outcome =
            tumble({"compare", written(std::string(name) + ".toml", scene), "--core", "cortex-m3", "--every", "16"});
        EXPECT_TRUE(has(outcome.text, "cortex-m3 agrees with the host: 33 states")) << name << ": " << outcome.text;
        EXPECT_FALSE(has(outcome.text, "range_left")) << name << ": " << outcome.text;
    }
}

TEST(Compare, a_flipped_bit_is_reported_with_its_step_body_and_number) {
    expect_outcome(tumble({"compare", shipped("brick"), "--core", "cortex-m3", "--every", "10", "--duration", "1",
                           "--flip", "120"}),
                   1,
                   "cortex-m3 differs at step 120 (0.46875 s): body \"brick\", x_w.x: host 0x0000000000000001, "
                   "cortex-m3 0x0000000000000000; 12 states");
}

// A scene file of a ball that leaves the smallest range.
std::string ball_in_the_smallest_range(const std::string& name, const std::string& world,
                                       const std::string& motion = "") {
    return written(name, world + smallest_range + body_of("ball", "sphere = 0.5") + motion);
}
const std::string falling = world_of("-9.81", "1/256", "8.0");

TEST(CompareDeep, leaving_the_range_is_a_failure_on_both_sides) {
    const std::string scene = ball_in_the_smallest_range("falling.toml", falling);
    expect_outcome(tumble({"compare", scene, "--core", "cortex-m3", "--every", "64"}), 1, "agrees with the host",
                   "range_left");
}

TEST(CompareDeep, firmware_without_doubles_has_no_double_arithmetic) {
    for (const auto* numbers : {"q32", "f32"}) {
        ASSERT_EQ(tumble({"compare", shipped("brick"), "--core", "cortex-m0", "--every", "256", "--duration", "1",
                          "--numbers", numbers})
                      .status,
                  0)
            << numbers;
        std::string symbols;
        ASSERT_EQ(Process({"arm-none-eabi-nm", (source_directory / "build/compare/cortex-m0/record.elf").string()})
                      .wait(&symbols),
                  0);
        for (const auto* name : {"__aeabi_d", "__aeabi_f2d", "__aeabi_i2d", "__aeabi_ui2d", "__aeabi_l2d"})
            EXPECT_FALSE(has(symbols, name)) << numbers << ": " << name;
        EXPECT_EQ(has(symbols, "__aeabi_fmul"), std::string(numbers) == "f32") << numbers;
    }
}

// --- of the deep set -------------------------------------------------------------------------------------------------

TEST(CompareDeep, packed_boxes_have_one_hash) {
    const std::string path = written("packed.toml", packed_boxes(4, "0.125"));
    for (const auto* core : {"cortex-m3", "cortex-m7"}) {
        expect_outcome(tumble({"compare", path, "--core", core}), 0,
                       std::string(core) + " agrees with the host: 33 states");
    }
    const std::string small = text_of({"compare", path, "--core", "cortex-m0"}, 1);
    const std::regex shortage("tumble: the firmware needs \\d+ bytes of RAM more than cortex-m0 has\n");
    EXPECT_TRUE(std::regex_match(small, shortage)) << small;
}

TEST(CompareDeep, a_difference_comes_with_the_status_of_both_sides) {
    const std::string scene = ball_in_the_smallest_range("falling.toml", falling);
    const std::string host = tumble({"run", scene}).text;
    const std::size_t at = host.find("(step ");
    ASSERT_NE(at, std::string::npos) << host;
    const std::string last = std::to_string(std::stoi(host.substr(at + 6)) + 1);
    expect_outcome(tumble({"compare", scene, "--core", "cortex-m3", "--flip", last}), 1,
                   "differs at step " + last + " ", "status of cortex-m3: range_left; of the host: range_left\n");
}

// Only the host knows the range of floating point, so its report is not a difference.
TEST(CompareDeep, a_declared_range_left_in_floating_point_is_reported_where_all_states_agree) {
    const std::string scene =
        ball_in_the_smallest_range("fast.toml", world_of("0", "1/64", "3.0"), "velocity = [0.0, 0.0, -30.0]\n");
    expect_outcome(tumble({"compare", scene, "--core", "cortex-m3", "--numbers", "f32"}), 1,
                   "cortex-m3 agrees with the host: 193 states", "range_left: position exceeds 64 m");
}

}  // namespace
}  // namespace tumble::host
