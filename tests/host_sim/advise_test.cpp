// `tumble advise` without a core: the steps that are compared, the errors, and the message without a recommendation.
#include <cmath>

#include "command_runner.hpp"
#include "scene/scene_file.hpp"
#include "tools/text.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {
namespace {

SampledScene sampled(const char* name) { return SampledScene(read_scene(shipped(name))); }

// In the range whose worlds without carry other tests need too.
constexpr const char* swing = R"(name = "swing"
[world]
step = "1/128"
duration = 2.0
[range]
position = 64.0
velocity = 32.0
angular_velocity = 32.0
[[body]]
name = "bob"
shape = "none"
mass = 1.0
inertia = [1.0, 2.0, 3.0]
position = [1.0, 0.0, 0.0]
angular_velocity = [0.1, 2.0, 0.1]
[[spring]]
body = "bob"
to = [0.0, 0.0, 0.0]
stiffness = 9.0
)";

// A ball that is dropped half a metre on the floor.
const std::string bounce =
    world_of("-10.0", "1/64", "0.5") + floor_plane + body_of("ball", "sphere = 0.5", "[0.0, 1.0, 0.0]");

// --- steps -----------------------------------------------------------------------------------------------------------

TEST(SampledScene, samples_are_whole_longest_steps_up_to_the_end) {
    const SampledScene scene = sampled("orbit");  // 72 s at 1/256 s: 20 steps of 2 s are the fewest
    EXPECT_EQ(scene.with_step(scene.longest()).step.seconds(), 2.0);
    EXPECT_EQ(scene.sample_steps().back(), 36);
    for (std::size_t i = 1; i < scene.sample_steps().size(); ++i)
        EXPECT_GT(scene.sample_steps()[i], scene.sample_steps()[i - 1]);
    EXPECT_EQ(scene.with_step(scene.shortest()).step.seconds(), 1.0 / 4096);
}

TEST(SampledScene, steps_are_the_scenes_times_powers_of_two) {
    const SampledScene scene = sampled("pendulum");
    EXPECT_EQ(scene.with_step(-2).step.seconds(), 1.0 / 1024);
    EXPECT_EQ(scene.with_step(3).step.seconds(), 1.0 / 32);
    EXPECT_EQ(scene.with_step(3).steps() * 8, scene.with_step(0).steps());
    SceneDescription decimal = read_scene(shipped("pendulum"));
    decimal.step = parse_step("0.005").value();
    EXPECT_EQ(SampledScene(decimal).with_step(1).step.seconds(), 0.01);
    EXPECT_EQ(SampledScene(decimal).with_step(1).steps() * 2, SampledScene(decimal).with_step(0).steps());
}

TEST(SampledScene, no_step_moves_an_event) {
    for (const std::string& name : shipped_scenes()) {
        const SceneDescription original = read_scene(shipped(name));
        const SampledScene scene(original);
        for (int step = scene.shortest(); step <= scene.longest(); ++step) {
            const SceneDescription other = scene.with_step(step);
            const double length = other.step.seconds();
            for (std::size_t i = 0; i < other.impulses.size(); ++i) {
                EXPECT_NEAR(std::round(other.impulses[i].time / length) * length,
                            std::round(original.impulses[i].time / original.step.seconds()) * original.step.seconds(),
                            1e-12)
                    << name << ", impulse " << i << " at a step of " << length << " s";
            }
        }
    }
    EXPECT_EQ(sampled("cube").longest(), 0);       // its first hit is at the odd step 25
    EXPECT_EQ(sampled("satellite").longest(), 7);  // half a second divides all its times
}

TEST(SampledScene, short_scenes_are_sampled_between_their_steps) {
    SceneDescription scene = read_scene(shipped("pendulum"));
    scene.duration = 0.03;  // 8 steps
    const SampledScene sampled(scene);
    EXPECT_EQ(sampled.longest(), -2);
    EXPECT_LE(sampled.shortest(), -10);
    scene.duration = 0.0;
    EXPECT_THROW(SampledScene{scene}, std::invalid_argument);
}

// --- errors ----------------------------------------------------------------------------------------------------------

TEST(Accuracy, spring_has_the_error_of_the_closed_form) {
    const SampledScene scene(read_scene_text(swing, "swing.toml"));
    const Truth truth = truth_of(scene);
    EXPECT_FALSE(truth.has_contacts);
    EXPECT_EQ(truth.doubt.largest(), 0.0);
    const auto run = run_sampled(scene, {"verlet", "f64", false}, 0);
    ASSERT_TRUE(run && run->failure.empty());
    double expected = 0;
    for (std::size_t i = 0; i < truth.samples.size(); ++i) {
        const double t = static_cast<double>(scene.sample_steps()[i]) * scene.with_step(scene.longest()).step.seconds();
        expected = std::max(expected, std::abs(static_cast<double>(run->samples[i][0].x.x) - std::cos(3 * t)));
    }
    const Errors errors = largest_errors(run->samples, truth.samples);
    EXPECT_NEAR(errors.position_m, expected, 1e-13);
    EXPECT_GT(errors.orientation_rad, 1e-6);
}

TEST(Accuracy, longest_step_keeps_the_tolerance_and_twice_the_step_does_not) {
    const SampledScene scene(read_scene_text(swing, "swing.toml"));
    const Truth truth = truth_of(scene);
    for (const Method& method : {Method{"rk4", "q32", false}, {"rk4", "f32", true}, {"rk4", "f64", false}}) {
        const auto found = longest_step_within(1e-3, scene, truth, method);
        ASSERT_TRUE(found);
        ASSERT_LE(found->error(), 1e-3) << method.numbers;
        for (int step = found->step; step <= scene.longest(); ++step) {
            const auto again = run_sampled(scene, method, step);
            ASSERT_TRUE(again);
            const bool is_within =
                again->failure.empty() && largest_errors(again->samples, truth.samples).largest() <= 1e-3;
            EXPECT_EQ(is_within, step == found->step) << method.numbers << " " << step;
        }
    }
}

TEST(Accuracy, floor_of_rounding_is_not_reached_at_the_shortest_step) {
    const SampledScene scene(read_scene_text(swing, "swing.toml"));
    const auto closest = longest_step_within(1e-12, scene, truth_of(scene), {"rk4", "q32", false});
    ASSERT_TRUE(closest);
    EXPECT_GT(closest->error(), 1e-12);
    EXPECT_LT(closest->error(), 1e-4);
    EXPECT_GT(closest->step, scene.shortest());
}

TEST(Accuracy, range_left_is_a_failure) {
    SceneDescription scene = read_scene_text(swing, "swing.toml");
    scene.bodies[0].velocity = {31.0, 0.0, 0.0};
    scene.range = {64.0, 32.0, 32.0};
    scene.springs[0].stiffness = 1000.0;
    scene.bodies[0].position = {10.0, 0.0, 0.0};
    const auto run = run_sampled(SampledScene(scene), {"rk4", "q32", true}, 0);
    ASSERT_TRUE(run);
    EXPECT_EQ(run->failure, "range_left");
}

TEST(Accuracy, contacts_have_two_fine_runs_as_reference) {
    const SampledScene scene(read_scene_text(bounce, "bounce.toml"));
    const Truth truth = truth_of(scene);
    EXPECT_TRUE(truth.has_contacts);
    EXPECT_LT(truth.doubt.largest(), 1e-6);
    // It falls for sqrt(0.1) s and leaves with half of sqrt(10) m/s.
    const double up = 0.5 - std::sqrt(0.1);
    EXPECT_NEAR(static_cast<double>(truth.samples.back()[0].x.y), 0.5 + 0.5 * std::sqrt(10.0) * up - 5.0 * up * up,
                1e-6);
}

TEST(Accuracy, colliding_bodies_have_two_fine_runs_as_reference) {
    const auto truth = [&](const std::string& contact, const char* other) {
        return truth_of(
            SampledScene(read_scene_text("name = \"meeting\"\n[world]\nstep = \"1/64\"\nduration = 1.0\n" + contact +
                                             body_of("left", "sphere = 0.5", "[-1.0, 0.0, 0.0]") +
                                             "velocity = [1.0, 0.0, 0.0]\n" + body_of("right", "sphere = 0.5") + other,
                                         "meeting.toml")));
    };
    const char *towards = "position = [1.0, 0.0, 0.0]\nvelocity = [-1.0, 0.0, 0.0]\n",
               *past = "position = [1.0, 5.0, 0.0]\nvelocity = [-1.0, 0.0, 0.0]\n";
    const Truth meeting = truth("[contact]\nrestitution = 0.5\n", towards);
    EXPECT_TRUE(meeting.has_contacts);
    EXPECT_LT(meeting.doubt.largest(), 1e-6);
    // They meet after half a second and part with half the speed.
    EXPECT_NEAR(static_cast<double>(meeting.samples.back()[1].x.x), 0.5 + 0.25, 1e-6);
    EXPECT_FALSE(truth("", past).has_contacts);
    EXPECT_FALSE(truth("[contact]\nresponse = \"none\"\n", towards).has_contacts);
    const std::string spring = "[contact]\nresponse = \"spring\"\nstiffness = 100.0\n";
    EXPECT_FALSE(truth(spring, past).has_contacts);
    EXPECT_TRUE(truth(spring + "barrier = 0.001\n", past).has_contacts);
}

TEST(Accuracy, distant_planes_leave_the_motion_smooth) {
    SceneDescription scene = read_scene_text(bounce, "bounce.toml");
    scene.bodies[0].position[1] = 20.0;
    EXPECT_FALSE(truth_of(SampledScene(scene)).has_contacts);
}

TEST(Accuracy, joints_have_the_integration_of_their_equations_as_reference) {
    for (const char* name : {"joints/pendulum", "joints/double_pendulum"}) {
        SceneDescription description = read_scene(shipped(name));
        description.duration = 2;
        const SampledScene scene(description);
        const Truth truth = truth_of(scene);
        EXPECT_FALSE(truth.has_contacts);
        EXPECT_LT(truth.doubt.largest(), 1e-12) << name;
        // Of order 2: the longest step within a quarter of a tolerance is about half as long.
        const auto found = longest_step_within(4e-3, scene, truth, {"verlet", "f64", false}),
                   finer = longest_step_within(1e-3, scene, truth, {"verlet", "f64", false});
        ASSERT_TRUE(found && finer);
        ASSERT_LE(finer->error(), 1e-3) << name;
        EXPECT_EQ(found->step, finer->step + 1) << name;
    }
}

// --- the command -----------------------------------------------------------------------------------------------------

TEST(Advise, bad_input_names_the_option_and_what_was_expected) {
    const std::string brick = shipped("brick"), missing = "missing.toml", bad = written("bad.toml", "name = 3\n");
    struct Case {
        std::string scene, options, message;
    };
    const std::string m3 = "--core cortex-m3 ", m7 = "--core cortex-m7 ", one = "--tolerance 1 ";
    const std::vector<Case> cases = {
        {brick, "--core cortex-m9 " + one,
         "--core: got \"cortex-m9\" (did you mean \"cortex-m0\"?), expected one of cortex-m0, "},
        {brick, "--core wasm32 " + one, "--core: got \"wasm32\", expected a core whose instructions are counted"},
        {brick, m3 + "--tolerance 0", "--tolerance: got \"0\", expected a positive"},
        {brick, m3 + "--tolerance -1", "--tolerance: got \"-1\", expected a positive"},
        {brick, m3 + "--tolerance inf", "--tolerance: got \"inf\", expected a positive"},
        {brick, m3 + "--tolerance small", "--tolerance: got \"small\", expected a positive"},
        {brick, m3 + one + "--cost seconds", "--cost: got \"seconds\", expected cycles or insn"},
        {brick, m7 + one + "--cost cycles",
         "--cost: nothing publishes the cycles of cortex-m7, expected a core that has a timing table: cortex-m0"},
        {brick, m7 + one + "--clock 16MHz", "--clock: nothing publishes the cycles of cortex-m7"},
        {brick, m3 + one + "--clock 16mHz", "--clock: got \"16mHz\", expected a positive frequency, as 16MHz"},
        {brick, m3, "--tolerance is required"},
        {brick, one, "--core is required"},
        {brick, m3 + one + "--integrators rk4,rk5",
         "unknown integrator \"rk5\" (did you mean \"rk4\"?), expected one of explicit_euler"},
        {brick, m3 + one + "--numbers q31",
         "unknown number system \"q31\" (did you mean \"q32\"?), expected one of q32, f32, f64"},
        {brick, m3 + one + "--duration -1", "--duration: got \"-1\", expected"},
        {brick, m3 + one + "--duration 0", "duration: got 0 s"},
        {missing, m3 + one, "missing.toml"},
        {bad, m3 + one, "bad.toml:1: name"}};
    for (const Case& c : cases) {
        std::istringstream words(c.options);
        const std::vector<std::string> options{std::istream_iterator<std::string>(words), {}};
        expect_outcome(tumble(with({"advise", c.scene}, options)), 2, c.message);
    }
}

TEST(Frequency, has_a_unit_or_is_in_hertz) {
    for (const char* text : {"16MHz", "16 MHz", "16e6", "16000000", "16000000 Hz", "0.016GHz", "16000 kHz", "1.6e7Hz"})
        EXPECT_DOUBLE_EQ(parse_frequency(text).value_or(0), 16e6) << text;
    for (const char* text : {"", "MHz", "16mHz", "16mhz", "16 M", "0", "0 MHz", "-16MHz", "inf", "nan", "1e300 GHz",
                             "16MHz ", "16MHz.", "16,5 MHz"})
        EXPECT_FALSE(parse_frequency(text).has_value()) << text;
}

TEST(Advise, nothing_within_the_tolerance_is_status_1_with_the_closest) {
    const std::string scene = written("swing.toml", swing);
    const std::vector<std::string> arguments = {"advise",      scene,  "--core",        "cortex-m3",
                                                "--tolerance", "1e-9", "--integrators", "explicit_euler,rk4",
                                                "--numbers",   "q32"};
    const std::string text = text_of(arguments, 1);
    expect_parts(text, {"nothing keeps the error under 1e-09; the closest is rk4 q32 carry with "});
    EXPECT_FALSE(has(text, "%")) << text;

    const Json json = json_of(arguments, 1);
    EXPECT_EQ(json["scene"], "swing");
    EXPECT_EQ(json["core"], "cortex-m3");
    EXPECT_EQ(json["tolerance_m"], 1e-9);
    EXPECT_EQ(json["tolerance_rad"], 1e-9);
    EXPECT_EQ(json["samples"], 20);
    EXPECT_EQ(json["reference"], "long double");
    EXPECT_TRUE(json["recommendation"].is_null());
    EXPECT_TRUE(json["ranking"].empty());
    ASSERT_EQ(json["unreached"].size(), 4u);
    double last = 0;
    for (const Json& row : json["unreached"]) {
        EXPECT_EQ(row["numbers"], "q32");
        const double error =
            std::max(row["position_error_m"].get<double>(), row["orientation_error_rad"].get<double>());
        EXPECT_GE(error, last);
        last = error;
    }
    EXPECT_EQ(json["unreached"][0]["integrator"], "rk4");
}

// A long flat brick that lands on an edge: a rounding decides how it topples.
TEST(Advise, chaotic_scene_has_no_reference) {
    const std::string scene = world_of("-9.81", "1/64", "6.0") + "[contact]\nrestitution = 0.95\nfriction = 0.4\n" +
                              floor_plane + body_of("brick", "box = [1.0, 0.3, 2.0]", "[0.0, 6.0, 0.0]") +
                              "angular_velocity = [3.0, 1.0, 2.0]\n";
    expect_outcome(tumble({"advise", written("tumble.toml", scene), "--core", "cortex-m3", "--tolerance", "1e-9",
                           "--integrators", "verlet", "--numbers", "f64"}),
                   1, "the scene is chaotic: there is no reference for an error of 1e-09");
}

TEST(Advise, chaotic_joints_have_no_reference) {
    const std::vector<std::string> arguments = {"advise",        shipped("joints/double_pendulum"),
                                                "--core",        "cortex-m3",
                                                "--integrators", "verlet",
                                                "--numbers",     "f64",
                                                "--tolerance",   "1e-6",
                                                "--duration",    "30"};
    expect_outcome(tumble(arguments), 1, "the scene is chaotic: there is no reference for an error of 1e-06");
}

}  // namespace
}  // namespace tumble::host
