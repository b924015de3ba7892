// The command `tumble` as its contract says: options, output, and the exit statuses 0 done, 1 failed, 2 bad input.
#include <tumble/version.hpp>

#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include "command_runner.hpp"
#include "firmware/firmware.hpp"
#include "rows.hpp"
#include "simulation/simulation.hpp"
#include "tools/output.hpp"

namespace tumble::host {
namespace {

using Json = nlohmann::json;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

std::set<std::string> keys_of(const Json& object) {
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.insert(key);
    return keys;
}

constexpr const char* falling = R"(name = "falling"
[world]
gravity = [0.0, -9.81, 0.0]
step = "1/256"
duration = 20.0
[range]
position = 64.0
velocity = 32.0
angular_velocity = 32.0
[[body]]
name = "steel \"ball\""
shape = { sphere = 0.5 }
mass = 1.0
)";

// --- run -------------------------------------------------------------------------------------------------------------

TEST(Run, json_has_the_keys_of_the_contract) {
    const Outcome outcome =
        tumble({"run", shipped("orbit"), "--integrator", "rk4", "--numbers", "f64", "--json"}, Process::Errors::pass);
    ASSERT_EQ(outcome.status, 0);
    const Json json = Json::parse(outcome.text);
    EXPECT_EQ(keys_of(json), (std::set<std::string>{"tumble_bits", "scene", "integrator", "numbers", "step_s", "steps",
                                                    "time_s", "state_hash", "energy_start_j", "energy_end_j",
                                                    "energy_max_relative_drift", "status", "verdict", "bodies"}));
    EXPECT_EQ(json["tumble_bits"], TUMBLE_BITS);
    EXPECT_EQ(json["scene"], "Kepler orbit");
    EXPECT_EQ(json["integrator"], "rk4");
    EXPECT_EQ(json["numbers"], "f64");
    EXPECT_EQ(json["step_s"], 1.0 / 64);
    EXPECT_EQ(json["steps"], 4608);
    EXPECT_EQ(json["time_s"], 72.0);
    EXPECT_TRUE(json["status"].empty());
    const std::string hash = json["state_hash"];
    EXPECT_EQ(hash.size(), 16u);
    EXPECT_EQ(hash.find_first_not_of("0123456789abcdef"), std::string::npos);
    EXPECT_NEAR(json["energy_start_j"], -1.82, 1e-12);
    EXPECT_LT(json["energy_max_relative_drift"], 1e-9);
    ASSERT_EQ(json["bodies"].size(), 2u);
    const Json& planet = json["bodies"][1];
    EXPECT_EQ(keys_of(planet), (std::set<std::string>{"name", "position_m", "velocity_m_s", "orientation",
                                                      "angular_velocity_rad_s", "asleep", "contacts"}));
    EXPECT_EQ(planet["name"], "planet");
    EXPECT_EQ(planet["position_m"].size(), 3u);
    EXPECT_EQ(planet["orientation"].size(), 4u);
    EXPECT_EQ(planet["asleep"], false);
    EXPECT_EQ(planet["contacts"], 0);
}

TEST(Run, json_numbers_have_17_digits) {
    const Outcome outcome =
        tumble({"run", shipped("brick"), "--step", "0.1", "--duration", "0.1", "--json"}, Process::Errors::pass);
    EXPECT_TRUE(has(outcome.text, "\"step_s\": 0.10000000000000001")) << outcome.text;
}

TEST(Run, prints_a_table_and_no_progress_when_piped) {
    const Outcome outcome = tumble({"run", shipped("top")});
    ASSERT_EQ(outcome.status, 0);
    for (const auto* part :
         {"free top: verlet, q32 near", "25600 steps", "position", "angular velocity", "energy", "state"})
        EXPECT_TRUE(has(outcome.text, part)) << part << "\n" << outcome.text;
    EXPECT_FALSE(has(outcome.text, "%"));
    EXPECT_FALSE(has(outcome.text, "\r"));
}

TEST(Run, trajectory_has_the_columns_of_the_contract) {
    const std::string path = temporary("out.csv");
    ASSERT_EQ(tumble({"run", shipped("orbit"), "--duration", "1", "--trajectory", path, "--every", "25"}).status, 0);
    const auto lines = lines_of(contents(path));
    // Steps 0, 25, 50 and the last, 64, of two bodies.
    ASSERT_EQ(lines.size(), 9u);
    EXPECT_EQ(lines[0], "time_s,body,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz");
    EXPECT_TRUE(lines[2].starts_with("0,planet,5,0,0,0,2.6")) << lines[2];
    EXPECT_TRUE(lines[8].starts_with("1,planet,")) << lines[8];
    for (const std::string& line : lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 14) << line;
}

TEST(Run, every_without_a_trajectory_gives_a_warning) {
    const std::string warning = "warning: --every has no effect without --trajectory";
    const Outcome without = tumble({"run", shipped("orbit"), "--duration", "1", "--every", "25"}),
                  with = tumble({"run", shipped("orbit"), "--duration", "1", "--trajectory", temporary("out.csv"),
                                 "--every", "25"}),
                  neither = tumble({"run", shipped("orbit"), "--duration", "1"});
    EXPECT_EQ(without.status, 0);
    EXPECT_TRUE(has(without.text, warning)) << without.text;
    EXPECT_FALSE(has(with.text, warning));
    EXPECT_FALSE(has(neither.text, warning));
}

TEST(Run, step_and_duration_replace_those_of_the_scene) {
    const Outcome outcome =
        tumble({"run", shipped("brick"), "--step", "1/128", "--duration", "0.51", "--json"}, Process::Errors::pass);
    const Json json = Json::parse(outcome.text);
    EXPECT_EQ(json["steps"], 66);  // the last step ends at or just after the duration
    EXPECT_EQ(json["step_s"], 1.0 / 128);
}

TEST(Run, carry_changes_the_state) {
    const auto hash = [](const char* carry) {
        return Json::parse(
            tumble({"run", shipped("brick"), "--carry", carry, "--json"}, Process::Errors::pass).text)["state_hash"];
    };
    EXPECT_NE(hash("on"), hash("off"));
}

// The plot of a scene; empty where gnuplot is missing.
std::string plot_of(const std::string& scene) {
    const std::string path = temporary("out's.svg");
    const Outcome outcome = tumble({"run", written("scene.toml", scene), "--plot", path});
    if (has(outcome.text, "gnuplot not found")) return {};
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    return contents(path);
}
// The distances from the left edge of the marks of one of gnuplot's shapes, in the order of drawing.
std::vector<double> marks_in(const std::string& svg, const std::string& shape) {
    const std::string start = "<use xlink:href='#" + shape + "' transform='translate(";
    std::vector<double> places;
    for (std::size_t at = svg.find(start); at != std::string::npos; at = svg.find(start, at + 1))
        places.push_back(std::stod(svg.substr(at + start.size())));
    return places;
}
constexpr const char *triangle = "gpPt7", *circle = "gpPt5";
constexpr std::size_t panels = 6;  // of positions and angular velocities

TEST(Run, a_plot_has_names_units_and_marks_at_impulses_and_contacts) {
    // The ball falls 1 m in 0.4515 s and bounces once; the puck is pushed at three times.
    std::string scene = R"(name = "it's \"1 < 2\""
[world]
gravity  = [0.0, -9.81, 0.0]
step     = "1/256"
duration = 1.0
[contact]
restitution = 1.0
[[plane]]
name   = "floor"
normal = [0.0, 1.0, 0.0]
offset = 0.0
[[body]]
name  = "ball & chain"
shape = { sphere = 0.5 }
mass  = 1.0
position = [0.0, 1.5, 0.0]
[[body]]
name  = "puck"
shape = { sphere = 0.5 }
mass  = 1.0
position = [9.0, 20.0, 0.0]
)";
    for (const char* time : {"0.0", "0.25", "0.75"})
        scene += std::string("[[impulse]]\nbody = \"puck\"\ntime = ") + time + "\nimpulse = [1.0, 0.0, 0.0]\n";
    const std::string svg = plot_of(scene);
    if (svg.empty()) GTEST_SKIP() << "no gnuplot";
    for (const char* text : {"it's \"1 &lt; 2\"", "ball &amp; chain", "puck", "verlet, q32, 256 steps of 1/256 s",
                             "x, m", "y, m", "z, m", "about x, rad/s", "about y, rad/s", "about z, rad/s", "energy, J",
                             "time, s", "kinetic", "potential", "total", "an impulse acts", "a contact begins"})
        EXPECT_TRUE(has(svg, std::string("<text>") + text + "</text>")) << text;
    EXPECT_FALSE(has(svg, "not fixed"));

    // In each panel, and once where their meaning is told.
    const std::vector<double> pushes = marks_in(svg, triangle), touches = marks_in(svg, circle);
    ASSERT_EQ(pushes.size(), 3 * panels + 1);
    ASSERT_EQ(touches.size(), 1 * panels + 1);
    const double second = (pushes[2] - pushes[0]) / 0.75;  // pixels
    EXPECT_NEAR(pushes[1] - pushes[0], 0.25 * second, 0.02);
    EXPECT_NEAR(touches[0] - pushes[0], 0.4515 * second, second / 256 + 0.02);
}

// It leaves the range after 3.26 s of 20 s.
TEST(Run, a_plot_of_a_run_that_stops_ends_there) {
    const std::string path = temporary("out.svg");
    const Outcome outcome = tumble({"run", written("falling.toml", falling), "--plot", path});
    if (has(outcome.text, "gnuplot not found")) GTEST_SKIP() << outcome.text;
    ASSERT_EQ(outcome.status, 1) << outcome.text;
    const std::string svg = contents(path);
    EXPECT_TRUE(has(svg, ">3<"));
    EXPECT_FALSE(has(svg, ">5<"));
}

TEST(Run, a_plot_of_ten_bodies_names_eight_that_are_not_fixed_and_says_so) {
    std::string scene = "[world]\nstep = \"1/256\"\nduration = 0.5\n[contact]\nresponse = \"none\"\n";
    for (int b = 0; b < 10; ++b)
        scene += "[[body]]\nname = \"body " + std::to_string(b) +
                 "\"\nshape = { sphere = 0.5 }\nmass = 1.0\nposition = [" + std::to_string(2 * b) + ".0, 0.0, 0.0]\n" +
                 (b == 3 ? "fixed = true\n" : "");
    const std::string svg = plot_of(scene);
    if (svg.empty()) GTEST_SKIP() << "no gnuplot";
    for (int b = 0; b < 10; ++b)
        EXPECT_EQ(has(svg, "<text>body " + std::to_string(b) + "</text>"), b != 3 && b != 9) << b;
    EXPECT_TRUE(has(svg, "<text>the first 8 of 10 bodies that are not fixed</text>"));
    for (const char* shape : {triangle, circle}) EXPECT_TRUE(marks_in(svg, shape).empty());
    for (const char* meaning : {"an impulse acts", "a contact begins"}) EXPECT_FALSE(has(svg, meaning));
}

TEST(Run, the_panels_of_a_plot_are_aligned_and_inside_the_picture) {
    const std::string path = temporary("out.svg");
    const Outcome outcome = tumble({"run", shipped("contacts/cradle"), "--plot", path});
    if (has(outcome.text, "gnuplot not found")) GTEST_SKIP() << outcome.text;
    ASSERT_EQ(outcome.status, 0) << outcome.text;
    const std::string svg = contents(path);
    std::map<std::pair<double, double>, std::set<double>> columns;  // left and right edges, and the tops between them
    const std::regex frame(R"(d='M([\d.]+),([\d.]+) L[\d.]+,[\d.]+ L([\d.]+),[\d.]+ L[\d.]+,[\d.]+ L[\d.]+,[\d.]+ Z)");
    for (std::sregex_iterator at(svg.begin(), svg.end(), frame), end; at != end; ++at)
        columns[{std::stod((*at)[1]), std::stod((*at)[3])}].insert(std::stod((*at)[2]));
    ASSERT_EQ(columns.size(), 2u);
    const auto& [positions, rows] = *columns.begin();
    const auto& [velocities, other_rows] = *columns.rbegin();
    EXPECT_EQ(rows.size(), 4u);
    EXPECT_EQ(other_rows.size(), 3u);
    EXPECT_TRUE(std::includes(rows.begin(), rows.end(), other_rows.begin(), other_rows.end()));
    // The labels beside the axes have their margins.
    EXPECT_GT(positions.first, 80);
    EXPECT_GT(velocities.first - positions.second, 80);
    EXPECT_LT(velocities.second, 990);
}

TEST(Run, a_file_that_cannot_be_written_to_the_end_is_a_failure) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    for (const std::string option : {"--trajectory", "--plot"}) {
        const Outcome outcome = tumble({"run", shipped("orbit"), option, "/dev/full"});
        if (has(outcome.text, "gnuplot not found")) GTEST_SKIP() << outcome.text;
        EXPECT_EQ(outcome.status, 1) << outcome.text;
        EXPECT_TRUE(has(outcome.text, option + ": writing /dev/full failed")) << outcome.text;
    }
}

TEST(Run, leaving_the_range_fails_with_body_time_and_status) {
    const Outcome outcome = tumble({"run", written("falling.toml", falling)});
    EXPECT_EQ(outcome.status, 1);
    for (const auto* part : {"steel \"ball\"", "3.26", " s (step ", "range_left", "[range]"})
        EXPECT_TRUE(has(outcome.text, part)) << part << "\n" << outcome.text;
    const Json json =
        Json::parse(tumble({"run", written("falling.toml", falling), "--json"}, Process::Errors::pass).text);
    EXPECT_EQ(json["status"], Json::array({"range_left"}));
    EXPECT_LT(json["steps"], 900);  // the run ends there
    EXPECT_EQ(json["bodies"][0]["name"], "steel \"ball\"");
}

TEST(Run, floating_point_that_is_not_finite_leaves_the_range) {
    const std::string scene =
        written("spring.toml",
                "name = \"spring\"\n[world]\nstep = 0.5\nduration = 500.0\n[[body]]\nname = \"bob\"\n"
                "shape = { sphere = 0.1 }\nmass = 0.001\nposition = [1.0, 0.0, 0.0]\n[[spring]]\nbody = \"bob\"\n"
                "to = [0.0, 0.0, 0.0]\nstiffness = 10000.0\n");
    const Outcome outcome =
        tumble({"run", scene, "--integrator", "explicit_euler", "--numbers", "f32", "--json"}, Process::Errors::pass);
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(Json::parse(outcome.text)["status"], Json::array({"step_too_long", "range_left"}));
}

std::string resting(const std::string& sleep) {
    return "name = \"resting\"\n[world]\ngravity = [0.0, -9.81, 0.0]\nstep = \"1/256\"\nduration = 3.0\n"
           "[contact]\nfriction = 0.5\n" +
           sleep +
           "[[plane]]\nname = \"floor\"\nnormal = [0.0, 1.0, 0.0]\n[[body]]\nname = \"box\"\n"
           "shape = { box = [1.0, 1.0, 1.0] }\nmass = 1.0\nposition = [0.0, 0.5, 0.0]\n";
}

TEST(Run, the_table_shows_which_bodies_are_asleep) {
    const std::string scene = written("resting.toml", resting("sleep = { time = 0.5 }\n"));
    EXPECT_TRUE(has(tumble({"run", scene}).text, "  asleep\n"));
    EXPECT_FALSE(has(tumble({"run", scene, "--duration", "0.4"}).text, "asleep"));
}

TEST(Run, json_has_sleep_and_contacts_of_each_body) {
    for (const auto* numbers : {"q32", "f32", "f64"}) {
        const auto box = [&](const std::string& sleep, const char* duration) {
            const Outcome outcome = tumble({"run", written("resting.toml", resting(sleep)), "--numbers", numbers,
                                            "--duration", duration, "--json"},
                                           Process::Errors::pass);
            EXPECT_EQ(outcome.status, 0) << numbers;
            return Json::parse(outcome.text)["bodies"][0];
        };
        const std::string sleep = "sleep = { time = 0.5 }\n";
        EXPECT_EQ(box(sleep, "3")["asleep"], true) << numbers;
        EXPECT_EQ(box(sleep, "3")["contacts"], 4) << numbers;
        EXPECT_EQ(box(sleep, "0.4")["asleep"], false) << numbers;
        EXPECT_EQ(box("", "3")["asleep"], false) << numbers;
        EXPECT_EQ(box("", "3")["contacts"], 4) << numbers;
    }
}

std::string on_springs(const std::string& stiffness, const std::string& height) {
    return "name = \"on springs\"\n[world]\ngravity = [0.0, -10.0, 0.0]\nstep = \"1/64\"\nduration = 1.0\n"
           "[contact]\nresponse = \"spring\"\nstiffness = " +
           stiffness +
           "\n[[plane]]\nname = \"floor\"\nnormal = [0.0, 1.0, 0.0]\n[[body]]\nname = \"ball\"\n"
           "shape = { sphere = 0.5 }\nmass = 1.0\nposition = [0.0, " +
           height + ", 0.0]\n";
}

TEST(Run, contact_springs_conserve_energy) {
    const Outcome outcome = tumble({"run", written("soft.toml", on_springs("10000.0", "1.0")), "--numbers", "f64",
                                    "--step", "1/1024", "--duration", "0.65", "--json"},
                                   Process::Errors::pass);
    ASSERT_EQ(outcome.status, 0);
    const Json json = Json::parse(outcome.text);
    // At the lowest point 5.3 of the 10 J are the spring's.
    EXPECT_LT(json["energy_max_relative_drift"], 0.02);
    // A fall of 316 ms, half a period of the spring, 31 ms, and nearly at the top again.
    EXPECT_NEAR(json["bodies"][0]["position_m"][1], 1.0, 0.02);
}

TEST(Run, a_step_too_long_for_a_contact_spring_fails_and_names_the_largest_safe_step) {
    const std::string scene = written("stiff.toml", on_springs("1000000.0", "0.499"));
    const Outcome outcome = tumble({"run", scene});
    EXPECT_EQ(outcome.status, 1) << outcome.text;
    const std::string message =
        "body \"ball\" at 0 s (step 0): step_too_long: a contact spring is too stiff for the step of 0.015625 s. The "
        "method may be unstable at this step. Use a step of at most ";
    const std::size_t at = outcome.text.find(message);
    ASSERT_NE(at, std::string::npos) << outcome.text;
    const std::string rest = outcome.text.substr(at + message.size()), safe = rest.substr(0, rest.find(" s\n"));
    // 1000 rad/s: at most 2 in a step.
    EXPECT_GT(std::stod(safe), 0.0002) << rest;
    EXPECT_LE(std::stod(safe), 0.002) << rest;

    const auto is_too_long = [&](const std::string& step) {
        const Outcome again = tumble({"run", scene, "--step", step, "--json"}, Process::Errors::pass);
        const Json issues = Json::parse(again.text)["status"];
        EXPECT_EQ(again.status, issues.empty() ? 0 : 1);
        return std::find(issues.begin(), issues.end(), "step_too_long") != issues.end();
    };
    EXPECT_TRUE(is_too_long("1/64"));
    EXPECT_TRUE(is_too_long(std::to_string(1.1 * std::stod(safe)))) << safe;
    EXPECT_FALSE(is_too_long(safe)) << safe;
}

// --- output ----------------------------------------------------------------------------------------------------------

// Runs the command in a shell, which redirects its standard output.
Outcome tumble_in_shell(const std::string& arguments, const std::string& output) {
    Outcome outcome{};
    outcome.status = Process({"sh", "-c", std::string(TUMBLE_COMMAND) + " " + arguments + " 2>&1 " + output}, {},
                             Process::Errors::merge)
                         .wait(&outcome.text);
    return outcome;
}

TEST(Output, lost_standard_output_is_reported) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    EXPECT_TRUE(has(tumble_in_shell("list", ">/dev/full").text,
                    "tumble: writing to standard output failed: No space left on device\n"));
    const std::string orbit = shipped("orbit");
    for (const std::string& arguments :
         {std::string("list"), std::string("--help"), std::string("run --help"), std::string("--version"),
          "compile " + orbit, "run " + orbit, "run --json " + orbit, "compile -o /dev/stdout " + orbit,
          "run --trajectory /dev/stdout " + orbit}) {
        const Outcome full = tumble_in_shell(arguments, ">/dev/full");
        EXPECT_EQ(full.status, 1) << arguments;
        EXPECT_TRUE(has(full.text, "failed")) << arguments << ": " << full.text;
        if (has(arguments, "/dev/stdout")) continue;
        const Outcome closed = tumble_in_shell(arguments, ">&-");
        EXPECT_EQ(closed.status, 1) << arguments;
        EXPECT_TRUE(has(closed.text, "failed")) << arguments << ": " << closed.text;
    }
}

// The scene comes from standard input.
Outcome tumble_of(const std::string& scene, const std::string& arguments) {
    Outcome outcome{};
    outcome.status = Process({"sh", "-c", std::string(TUMBLE_COMMAND) + " " + arguments}, scene, Process::Errors::keep)
                         .wait(&outcome.text);
    return outcome;
}

TEST(Output, a_hyphen_is_standard_input_and_standard_output) {
    const std::string orbit = shipped("orbit"), scene = contents(orbit), csv = temporary("out.csv");
    ASSERT_EQ(tumble({"run", orbit, "--duration", "1", "--trajectory", csv}).status, 0);
    const Outcome trajectory = tumble_of(scene, "run - --duration 1 --trajectory -");
    EXPECT_EQ(trajectory.status, 0);
    EXPECT_EQ(trajectory.text, contents(csv));  // the table is on standard error
    const Outcome header = tumble_of(scene, "compile - --struct Orbit -o -");
    EXPECT_EQ(header.status, 0);
    EXPECT_TRUE(has(header.text, "struct Orbit {")) << header.text;
    const Outcome bad = tumble_of("name = 3\n", "run - 2>&1");
    EXPECT_EQ(bad.status, 2);
    EXPECT_TRUE(has(bad.text, "/dev/stdin:1: name: got 3")) << bad.text;
    EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST(Output, the_scene_and_the_other_outputs_are_not_overwritten) {
    namespace fs = std::filesystem;
    const std::string scene = written("scene.toml", contents(shipped("orbit"))), before = contents(scene);
    const fs::path directory = fs::path(scene).parent_path();
    const std::string link = temporary("link.toml"), hard = temporary("hard.toml"), dangling = temporary("dangling"),
                      dotted = (directory / ".." / directory.filename() / "scene.toml").string();
    for (const std::string& old : {link, hard, dangling}) fs::remove(old);
    fs::create_symlink("scene.toml", link);
    fs::create_symlink("new.svg", dangling);
    fs::create_hard_link(scene, hard);
    for (const std::string& output : {scene, link, hard, dotted}) {
        for (const char* option : {"--trajectory", "--plot", "-o"}) {
            const bool compiles = std::string(option) == "-o";
            const Outcome outcome = tumble({compiles ? "compile" : "run", scene, option, output});
            EXPECT_EQ(outcome.status, 2) << option << " " << output;
            EXPECT_TRUE(has(outcome.text, std::string(compiles ? "--output" : option) + ": " + output +
                                              " is the file of the scene, expected another"))
                << outcome.text;
            EXPECT_EQ(contents(scene), before) << option << " " << output;
        }
        // The scene may be the link as well.
        EXPECT_EQ(tumble({"run", output, "--trajectory", scene}).status, 2) << output;
        EXPECT_EQ(contents(scene), before) << output;
    }
    for (const auto& [one, other] : {std::pair{temporary("new.svg"), temporary("new.svg")},
                                     {temporary("new.svg"), dangling},
                                     {temporary("new.svg"), (directory / "./new.svg").string()}}) {
        const Outcome outcome = tumble({"run", scene, "--trajectory", one, "--plot", other});
        EXPECT_EQ(outcome.status, 2);
        EXPECT_TRUE(has(outcome.text, "--plot: " + other + " is the file of --trajectory, expected another"))
            << outcome.text;
        EXPECT_FALSE(fs::exists(one));
    }
}

TEST(OutputFile, is_written_whole_or_not_at_all) {
    namespace fs = std::filesystem;
    const std::string path = written("out", "old"), link = temporary("link");
    const fs::path directory = fs::path(path).parent_path();
    const auto count = [&] { return std::distance(fs::directory_iterator(directory), fs::directory_iterator()); };
    fs::permissions(path, fs::perms(0640));
    fs::remove(link);
    fs::create_symlink("out", link);
    const auto before = count();
    {
        OutputFile file(path);
        file.stream() << std::string(1 << 20, 'x');
        EXPECT_EQ(contents(path), "old");
    }
    EXPECT_EQ(contents(path), "old");
    {
        OutputFile file(link);
        file.stream() << "new";
        EXPECT_EQ(contents(path), "old");
        file.commit();
    }
    EXPECT_EQ(contents(path), "new");
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(fs::status(path).permissions(), fs::perms(0640));
    EXPECT_EQ(count(), before);
    // A signal leaves nothing behind.
    for (const int signal : {SIGINT, SIGTERM, SIGQUIT}) {
        const pid_t program = fork();
        if (program == 0) {
            const rlimit no_core{0, 0};
            setrlimit(RLIMIT_CORE, &no_core);
            OutputFile file(path), other(temporary("other"));
            file.stream() << "newer";
            raise(signal);
            _exit(0);
        }
        int status = 0;
        ASSERT_EQ(waitpid(program, &status, 0), program);
        EXPECT_TRUE(WIFSIGNALED(status)) << signal;
        EXPECT_EQ(contents(path), "new");
        EXPECT_EQ(count(), before) << signal;
    }
}

TEST(OutputFile, a_write_error_throws) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    EXPECT_THROW(write_file("/dev/full", "text"), std::runtime_error);
    EXPECT_THROW(write_file("/nonexistent/file", "text"), std::invalid_argument);
    EXPECT_THROW(write_file(std::filesystem::temp_directory_path(), "text"), std::invalid_argument);
    EXPECT_NO_THROW(write_file("/dev/null", "text"));
    const bench::Row row = {{"scene", "none"}};
    EXPECT_THROW(bench::write_rows("/dev/full", {row}), std::runtime_error);
    const std::string rows = temporary("directory/rows.jsonl");
    bench::write_rows(rows, {row});
    EXPECT_EQ(bench::read_rows(rows).at(0).at("scene"), "none");
    // More than the largest file that the program may write, as a disk that fills up in the middle.
    const std::string path = written("limited", "old");
    const pid_t program = fork();
    if (program == 0) {
        const rlimit small{4096, 4096};
        setrlimit(RLIMIT_FSIZE, &small);
        signal(SIGXFSZ, SIG_IGN);
        try {
            write_file(path, std::string(1 << 18, 'x'));
        } catch (const std::runtime_error& error) { _exit(has(error.what(), "File too large") ? 3 : 4); }
        _exit(0);
    }
    int status = 0;
    ASSERT_EQ(waitpid(program, &status, 0), program);
    EXPECT_EQ(WEXITSTATUS(status), 3);
    EXPECT_EQ(contents(path), "old");
}

// --- bad input -------------------------------------------------------------------------------------------------------

struct BadCall {
    std::vector<std::string> arguments;
    std::string message;
    // Prints the call in the name of a test.
    friend void PrintTo(const BadCall& call, std::ostream* out) {
        for (std::size_t i = 0; i < call.arguments.size(); ++i)
            *out << (i > 0 ? " " : "") << std::filesystem::path(call.arguments[i]).filename().string();
    }
};
class BadInput : public testing::TestWithParam<BadCall> {};

TEST_P(BadInput, ends_with_status_2_and_says_what_was_expected) {
    const Outcome outcome = tumble(GetParam().arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.text;
    EXPECT_TRUE(has(outcome.text, GetParam().message)) << outcome.text;
}

INSTANTIATE_TEST_SUITE_P(
    Command, BadInput,
    testing::Values(
        BadCall{{}, "subcommand"}, BadCall{{"dance"}, "dance"}, BadCall{{"run"}, "scene"},
        BadCall{{"run", "missing.toml"}, "missing.toml: cannot be read: no such file"},
        BadCall{{"run", TUMBLE_SOURCE_DIR "/tests/host_sim/bad_scenes/mass_negative.toml"}, "mass"},
        BadCall{{"run", shipped("brick"), "--integrator", "rk5"},
                "unknown integrator \"rk5\" (did you mean \"rk4\"?), expected one of explicit_euler, "},
        BadCall{{"run", shipped("brick"), "--integrator", "exact"}, "expected --numbers to be one of f32, f64"},
        BadCall{{"compile", shipped("brick"), "--integrator", "exact", "--numbers", "q32"},
                "integrator \"exact\" does not run in q32, because "},
        BadCall{{"run", shipped("brick"), "--numbers", "q16"},
                "unknown number system \"q16\", expected one of q32, f32, f64"},
        BadCall{{"run", shipped("brick"), "--carry", "maybe"}, "--carry: got \"maybe\", expected on or off"},
        BadCall{{"run", shipped("brick"), "--step", "-1"}, "--step: got \"-1\", expected a positive number"},
        BadCall{{"run", shipped("brick"), "--step", "1/0"}, "--step: got \"1/0\", expected a positive number"},
        BadCall{{"run", shipped("brick"), "--step", ""}, "--step: got \"\", expected a positive number"},
        BadCall{{"run", shipped("brick"), "--duration", "-1"}, "--duration: got \"-1\", expected a number of seconds"},
        BadCall{{"run", shipped("brick"), "--duration", "nan"},
                "--duration: got \"nan\", expected a number of seconds"},
        BadCall{{"run", shipped("brick"), "--duration", "2s"}, "--duration: got \"2s\", expected a number of seconds"},
        BadCall{{"run", shipped("brick"), "--duration", "1e12"}, "2^31 steps"},
        BadCall{{"run", shipped("brick"), "--every", "0"},
                "--every: got \"0\", expected a whole number of steps >= 1\n"},
        BadCall{{"run", shipped("brick"), "--every", "1.5"}, "--every: got \"1.5\", expected a whole number of steps"},
        BadCall{{"run", shipped("brick"), "--trajectory", ""}, "--trajectory: got \"\", expected the name of a file"},
        BadCall{{"run", shipped("brick"), "--plot", ""}, "--plot: got \"\", expected the name of a file"},
        BadCall{{"run", shipped("brick"), "--trajectory", "/no/where.csv"}, "/no/where.csv"},
        BadCall{{"compile", shipped("brick"), "-o", "/no/where.hpp"}, "/no/where.hpp"},
        BadCall{{"compile", shipped("brick"), "-o", ""}, "--output: got \"\", expected the name of a file"},
        BadCall{{"compare", shipped("brick")}, "--core"},
        BadCall{{"compare", shipped("brick"), "--core", "z80"}, "got \"z80\", expected one of cortex-m0, "},
        BadCall{{"compare", shipped("brick"), "--core", "cortexm3"}, "got \"cortexm3\" (did you mean \"cortex-m3\"?)"},
        BadCall{{"rum", shipped("brick")}, "got \"rum\" (did you mean \"run\"?), expected \"run\", \"compile\", "},
        BadCall{{"run", "--integrators", "rk4"},
                "--integrators: unknown option of run (did you mean \"--integrator\"?), expected one of \"--help\", "},
        BadCall{{"advise", shipped("brick"), "--toleranc=1"},
                "--toleranc: unknown option of advise (did you mean \"--tolerance\"?), expected one of "},
        BadCall{{"run", shipped("brick"), "--trajectory", "-", "--json"},
                "--trajectory, --json: got standard output for each of them, expected it for one"},
        BadCall{{"compare", shipped("brick"), "--core", "cortex-m3", "--every", "16", "--flip", "17"},
                "--flip: got 17, expected a step that is recorded"},
        BadCall{{"compare", shipped("brick"), "--core", "cortex-m3", "--flip", "-1"}, "--flip: got \"-1\", expected"},
        BadCall{{"compare", shipped("brick"), "--core", "cortex-m3", "--every", "0"},
                "--every: got \"0\", expected a whole number of steps >= 1\n"},
        BadCall{{"compare", shipped("brick"), "--core", "cortex-m3", "--timeout", "0"},
                "--timeout: got \"0\", expected a whole number of seconds >= 1\n"}));

TEST(Command, version_is_that_of_the_kernel_and_of_its_bits) {
    const Outcome outcome = tumble({"--version"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.text, "tumble " TUMBLE_VERSION ", bits " + std::to_string(TUMBLE_BITS) + "\n");
}

TEST(Command, help_is_not_an_error) {
    for (const auto* topic : {"run", "compile", "compare", "list"})
        EXPECT_EQ(tumble({topic, "--help"}).status, 0) << topic;
    EXPECT_TRUE(has(tumble({"compare", "--help"}).text, "--flip"));
    EXPECT_TRUE(has(tumble({"--help"}).text, "Exit status"));
    EXPECT_FALSE(has(tumble({"run", "--help"}).text, "00000000"));  // the limits of a double, digit by digit
}

// --- warnings before a run
// --------------------------------------------------------------------------------------------

std::string scene_of(const std::string& contact, const std::string& bodies) {
    return "name = \"test\"\n[world]\nstep = \"1/256\"\nduration = 0.1\n" + contact +
           "[[plane]]\nname = \"floor\"\nnormal = [0.0, 1.0, 0.0]\noffset = 10.0\n" + bodies;
}
std::string body_of(const std::string& name, const std::string& shape) {
    return "[[body]]\nname = \"" + name + "\"\nshape = { " + shape + " }\nmass = 1.0\n";
}

TEST(Compile, a_scene_named_after_a_member_of_its_struct_gets_another_name) {
    const Outcome outcome = tumble({"compile", written("config.toml", scene_of("", body_of("a", "sphere = 1.0")))});
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    EXPECT_TRUE(has(outcome.text, "struct ConfigScene {")) << outcome.text;
}

TEST(Compile, the_struct_has_the_name_that_is_asked_for) {
    const std::string scene = written("named.toml", scene_of("", body_of("a", "sphere = 1.0")));
    const Outcome outcome = tumble({"compile", scene, "--struct", "first_flight"});
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    EXPECT_TRUE(has(outcome.text, "struct first_flight {")) << outcome.text;
    for (const auto* name : {"", "a b", "1st", "Config", "bodies"}) {
        const Outcome refused = tumble({"compile", scene, "--struct", name});
        EXPECT_EQ(refused.status, 2) << name;
        EXPECT_TRUE(has(refused.text, "--struct: got \"" + std::string(name) + "\", expected a name in C++"))
            << refused.text;
    }
}

TEST(Run, a_plot_that_cannot_be_written_is_refused_before_the_run) {
    const Outcome outcome = tumble(
        {"run", written("plot.toml", scene_of("", body_of("a", "sphere = 1.0"))), "--plot", "/nonexistent/a.svg"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(has(outcome.text, "--plot: cannot write /nonexistent/a.svg")) << outcome.text;
}

TEST(Run, an_unknown_integrator_is_refused_with_all_names) {
    const Outcome outcome =
        tumble({"run", written("names.toml", scene_of("", body_of("a", "sphere = 1.0"))), "--integrator", "foo"});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_TRUE(has(outcome.text, ", implicit_euler,")) << outcome.text;
}

// The warnings of a run that is well otherwise, without the file's name.
std::vector<std::string> warnings_of(const std::string& contact, const std::string& bodies) {
    const std::string scene = written("scene.toml", scene_of(contact, bodies));
    const Outcome outcome = tumble({"run", scene});
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    const std::string start = "warning: " + scene + ": ";
    std::vector<std::string> warnings;
    for (const std::string& line : lines_of(outcome.text))
        if (line.starts_with(start)) warnings.push_back(line.substr(start.size()));
    return warnings;
}
using Warnings = std::vector<std::string>;

TEST(Limits, shapes_without_body_contacts_give_a_warning_beside_other_bodies) {
    const std::string ball = body_of("ball", "sphere = 1.0") + "position = [8.0, 0.0, 0.0]\n";
    const auto warning = [](const std::string& shape, const std::string& what) {
        return Warnings{"body \"a\": contacts of " + shape + " with " + what + " are not simulated, it passes through"};
    };
    const std::vector<std::array<std::string, 2>> round = {
        {"hoop = 1.0", "a hoop"}, {"cylinder = [1.0, 1.0]", "a cylinder"}, {"capsule = [1.0, 1.0]", "a capsule"}};
    for (const auto& [shape, name] : round) {
        const std::string body = body_of("a", shape), fixed = body + "fixed = true\n";
        EXPECT_EQ(warnings_of("", body), Warnings{}) << name;
        EXPECT_EQ(warnings_of("", body + ball), warning(name, "other bodies"));
        EXPECT_EQ(warnings_of("", fixed + ball), warning(name, "other bodies"));
        EXPECT_EQ(warnings_of("", fixed + ball + "fixed = true\n"), Warnings{}) << name;
        EXPECT_EQ(warnings_of("[contact]\nresponse = \"spring\"\nstiffness = 100.0\n", body + ball),
                  warning(name, "other bodies"));
        EXPECT_EQ(warnings_of("[contact]\nresponse = \"none\"\n", body + ball), Warnings{}) << name;
        EXPECT_EQ(warnings_of("", body + "[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 1.0\ninertia = [1.0, 1.0, "
                                         "1.0]\nposition = [8.0, 0.0, 0.0]\n"),
                  Warnings{})
            << name;
    }
    const std::string point = "[[body]]\nname = \"a\"\nshape = \"none\"\nmass = 1.0\n";
    EXPECT_EQ(warnings_of("", point), warning("a point mass", "planes"));
    EXPECT_EQ(warnings_of("", point + ball), warning("a point mass", "planes"));
    EXPECT_EQ(warnings_of("", point + "fixed = true\n" + ball), Warnings{});
    EXPECT_EQ(warnings_of("", point + "inertia = [1.0, 1.0, 1.0]\n"), Warnings{});
    EXPECT_EQ(warnings_of("[contact]\nresponse = \"none\"\n", point), Warnings{});
    const std::string cloud = "[[body]]\nname = \"a\"\nshape = { points = [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0], "
                              "[0.0, 1.0, 0.0, 1.0]] }\n";
    EXPECT_EQ(warnings_of("", cloud), warning("a cloud of points", "planes"));
    EXPECT_EQ(warnings_of("", cloud + ball), warning("a cloud of points", "planes and other bodies"));
    EXPECT_EQ(warnings_of("", cloud + "fixed = true\n" + ball), warning("a cloud of points", "other bodies"));
    EXPECT_EQ(warnings_of("", cloud + "fixed = true\n"), Warnings{});
    EXPECT_EQ(warnings_of("", body_of("a", "sphere = 1.0") + ball), Warnings{});
    EXPECT_EQ(warnings_of("", body_of("a", "box = [1.0, 1.0, 1.0]") + ball), Warnings{});
}

TEST(Limits, a_contact_tolerance_below_the_resolution_of_the_numbers_gives_a_warning) {
    const auto contact = [](const std::string& tolerance) { return "[contact]\ntolerance = " + tolerance + "\n"; };
    const std::string ball = body_of("a", "sphere = 1.0"), long_box = body_of("a", "box = [1.0, 1.0, 600.0]");
    // 600 m take units of 2^-18 m, of which 16 are the least tolerance; a way of 0.5 m in a step units of 2^-28 m.
    EXPECT_EQ(warnings_of(contact("0.0001"), long_box), Warnings{});
    EXPECT_EQ(warnings_of(contact("1e-6"), long_box),
              Warnings{"contact.tolerance = 1e-06 m is too small for q32 beside this scene's largest body or way in a "
                       "step: 6.10352e-05 m is used"});
    EXPECT_EQ(warnings_of(contact("1e-6"), ball), Warnings{});
    EXPECT_EQ(warnings_of(contact("1e-9"), ball).size(), 1u);
    EXPECT_EQ(warnings_of(contact("1e-9") + "response = \"none\"\n", ball), Warnings{});
}

TEST(Limits, spring_response_has_neither_friction_nor_sleep) {
    const std::string ball = body_of("a", "sphere = 1.0"), spring = "[contact]\nresponse = \"spring\"\n",
                      rough = "friction = 0.5\n", sleep = "sleep = { speed = 0.1 }\n";
    const std::string no_friction = "friction is not simulated with contact.response = \"spring\"",
                      no_sleep = "contact.sleep has no effect with contact.response = \"spring\"";
    EXPECT_EQ(warnings_of(spring, ball), Warnings{});
    EXPECT_EQ(warnings_of(spring + rough, ball), Warnings{no_friction});
    EXPECT_EQ(warnings_of(spring, ball + rough), Warnings{no_friction});
    EXPECT_EQ(warnings_of(spring, rough + ball), Warnings{no_friction});  // a key of the plane, which comes before
    EXPECT_EQ(warnings_of(spring, ball + "friction = 0.0\n"), Warnings{});
    EXPECT_EQ(warnings_of(spring + sleep, ball), Warnings{no_sleep});
    EXPECT_EQ(warnings_of("[contact]\n" + rough + sleep, ball), Warnings{});
}

TEST(Limits, events_without_an_effect_give_a_warning) {
    const auto output = [](const std::string& contact, const std::string& bodies) {
        const Outcome outcome = tumble({"run", written("scene.toml", scene_of(contact, bodies))});
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        return outcome.text;
    };
    // 0.1 s is nearest to the end of the last step, the 26th.
    const auto impulse_at = [](const char* time) {
        return body_of("a", "sphere = 1.0") + "[[impulse]]\ntime = " + time +
               "\nbody = \"a\"\nimpulse = [1.0, 0.0, 0.0]\n";
    };
    EXPECT_TRUE(has(output("", impulse_at("0.1")), "warning: "));
    EXPECT_FALSE(has(output("", impulse_at("0.099")), "warning: "));
    const std::string fixed = body_of("a", "sphere = 1.0") + "fixed = true\n";
    const std::string force = "[[force]]\nbody = \"a\"\nuntil = 0.1\nforce = [1.0, 0.0, 0.0]\n";
    EXPECT_TRUE(has(output("", fixed + "[[impulse]]\ntime = 0.0\nbody = \"a\"\nimpulse = [1.0, 0.0, 0.0]\n"),
                    "impulse[0] acts on body \"a\", which is fixed, so it has no effect"));
    EXPECT_TRUE(has(output("", fixed + force), "force[0] acts on body \"a\", which is fixed"));
    EXPECT_FALSE(has(output("", body_of("a", "sphere = 1.0") + force), "warning: "));
}

TEST(Limits, a_force_whose_impulse_changes_in_whole_steps_gives_a_warning) {
    // The warning about a force between two times, at a step; 1000 N and 0.5 s by default.
    const auto said = [](const std::string& step, const std::string& from, const std::string& until,
                         const std::string& what = "force = [600.0, 0.0, -800.0]\n",
                         const std::string& duration = "0.5") {
        const std::string scene =
            written("scene.toml", "[world]\nstep = \"" + step + "\"\nduration = " + duration + "\n" +
                                      body_of("a", "sphere = 1.0") + "[[force]]\nbody = \"a\"\nfrom = " + from +
                                      "\nuntil = " + until + "\n" + what);
        const Outcome outcome = tumble({"compile", scene, "-o", "/dev/null"});
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        return outcome.text;
    };
    // Between the steps at 0.09375 s and 0.109375 s: the nearest to both times is the later one.
    EXPECT_TRUE(has(said("1/64", "0.102", "0.108"),
                    "force[0] acts in 0 steps of 0.015625 s, so its impulse is 0 N s instead of 6 N s; take a shorter "
                    "step or an impulse"));
    EXPECT_TRUE(has(said("1/64", "0.1", "0.102"), "force[0] acts in 1 step of 0.015625 s, so its impulse is 15.625 N s "
                                                  "instead of 2 N s; take a shorter step\n"));
    EXPECT_TRUE(has(said("1/64", "0.102", "0.108", "torque = [0.0, 3.0, 4.0]\n"), "0 N m s instead of 0.03 N m s"));
    EXPECT_TRUE(has(said("0.1", "0.14", "0.26", "force = [1.0, 0.0, 0.0]\ntorque = [2.0, 0.0, 0.0]\n"),
                    "2 steps of 0.1 s, so its impulse is 0.2 N s and 0.4 N m s instead of 0.12 N s and 0.24 N m s"));
    // No warning: within a tenth, without a force, and for the part after the end of the run.
    EXPECT_EQ(said("1/64", "0.1", "0.3"), "");
    EXPECT_EQ(said("1/8192", "0.102", "0.108"), "");
    EXPECT_EQ(said("1/64", "0.102", "0.108", "force = [0.0, 0.0, 0.0]\n"), "");
    EXPECT_EQ(said("1/64", "0.0", "0.5"), "");
    EXPECT_TRUE(has(said("1/4", "0.6", "0.7", "force = [1.0, 0.0, 0.0]\n", "0.7"), "1 step"));
    const std::string scene =
        written("late.toml", "[world]\nstep = \"1/64\"\nduration = 4.0\n" + body_of("a", "sphere = 1.0") +
                                 "[[force]]\nbody = \"a\"\nfrom = 3.0\nuntil = 3.5\n"
                                 "force = [1.0, 0.0, 0.0]\n");
    EXPECT_EQ(tumble({"compile", scene, "-o", "/dev/null"}).text, "");
    for (const auto* duration : {"2", "3"})
        EXPECT_TRUE(has(tumble({"compile", scene, "-o", "/dev/null", "--duration", duration}).text,
                        "force[0] begins when the last step has been taken, so it has no effect"));
    EXPECT_EQ(tumble({"compile", scene, "-o", "/dev/null", "--duration", "3.25"}).text, "");
}

TEST(Limits, a_velocity_of_a_fixed_body_gives_a_warning) {
    const std::string fixed = body_of("belt", "box = [4.0, 1.0, 4.0]") + "fixed = true\n";
    EXPECT_EQ(warnings_of("", fixed + "velocity = [1.0, 0.0, 0.0]\n"),
              Warnings{"body \"belt\" is fixed, so its velocity has no effect"});
    EXPECT_EQ(warnings_of("", fixed + "velocity = [0.0, 0.0, 0.0]\nangular_velocity = [0.0, 1.0, 0.0]\n"), Warnings{});
}

TEST(Limits, an_overlap_at_the_start_gives_a_warning) {
    // Of a scene with these bodies, without a floor or with one at a height.
    const auto said = [](const std::string& bodies, const std::string& floor = "", const std::string& contact = "") {
        const std::string scene =
            written("scene.toml", "[world]\nstep = \"1/64\"\nduration = 0\n" + contact + floor + bodies);
        const Outcome outcome = tumble({"compile", scene, "-o", "/dev/null"});
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        return outcome.text;
    };
    const auto at = [](const std::string& name, const std::string& shape, const std::string& position,
                       const std::string& more = "") {
        return body_of(name, shape) + "position = " + position + "\n" + more;
    };
    const std::string floor = "[[plane]]\nname = \"floor\"\nnormal = [0.0, 2.0, 0.0]\noffset = -1.0\n",  // y >= 1
        wall = "[[plane]]\nname = \"wall\"\nnormal = [-0.6, 0.0, 0.8]\n";
    const std::string turned = "orientation = [0.8, 0.0, 0.0, 0.6]\n";  // cos 0.28, sin 0.96 about z
    EXPECT_TRUE(has(said(at("b", "sphere = 0.5", "[0, -2, 0]"), floor),
                    "body \"b\" begins 3.5 m inside plane \"floor\", which pushes it out slowly"));
    EXPECT_TRUE(has(said(at("b", "sphere = 0.5", "[0, -8000, 0]"), floor, "[range]\nposition = 32768\n"), "8001.5 m"));
    // Half of 1 * 0.96 + 2 * 0.28.
    EXPECT_TRUE(has(said(at("b", "box = [1, 2, 3]", "[0, 1.75, 0]", turned), floor), "begins 0.01 m inside plane"));
    EXPECT_EQ(said(at("b", "box = [1, 2, 3]", "[0, 1.76, 0]", turned), floor), "");
    EXPECT_TRUE(has(said(at("b", "cylinder = [0.5, 3]", "[0, 1.4, 0]"), floor), "begins 0.1 m inside plane"));
    EXPECT_TRUE(has(said(at("b", "capsule = [0.5, 2]", "[0, 0, 1]"), wall), "begins 0.5 m inside plane \"wall\""));
    EXPECT_EQ(said(at("b", "hoop = 0.5", "[0, 1.5, 0]"), floor), "");
    // What touches and what is allowed to sink; what does not touch planes.
    EXPECT_EQ(said(at("b", "sphere = 0.5", "[0, 1.4995, 0]"), floor), "");
    EXPECT_TRUE(
        has(said(at("b", "sphere = 0.5", "[0, 1.4995, 0]"), floor, "[contact]\ntolerance = 1e-4\n"), "0.0005 m"));
    EXPECT_EQ(said(at("b", "sphere = 0.5", "[0, -2, 0]", "fixed = true\n"), floor), "");
    EXPECT_EQ(said(at("b", "sphere = 0.5", "[0, -2, 0]"), floor, "[contact]\nresponse = \"none\"\n"), "");
    // Bodies.
    const auto two = [&](const std::string& a, const std::string& x, const std::string& b, const std::string& y,
                         const std::string& more = "") { return said(at("a", a, x, more) + at("b", b, y)); };
    EXPECT_TRUE(has(two("sphere = 0.25", "[0, 0, 0]", "sphere = 0.25", "[0.27, 0, 0.36]"),
                    "body \"b\" begins 0.05 m inside body \"a\""));
    EXPECT_TRUE(has(two("sphere = 0.25", "[0, 0, 0]", "sphere = 0.25", "[0, 0, 0]"), "begins 0.5 m inside"));
    EXPECT_EQ(two("sphere = 0.25", "[0, 0, 0]", "sphere = 0.25", "[0.3, 0, 0.4]"), "");
    EXPECT_TRUE(has(two("box = [1, 1, 1]", "[0, 0, 0]", "box = [1, 1, 1]", "[0.2, 0.9, -0.3]"), "begins 0.1 m inside"));
    EXPECT_TRUE(has(two("box = [1, 1, 1]", "[0, 0, 0]", "box = [1, 1, 1]", "[0, 0, 0]"), "begins 1 m inside"));
    EXPECT_EQ(two("box = [1, 1, 1]", "[0, 0, 0]", "box = [1, 1, 1]", "[0.2, 1, -0.3]"), "");
    // A sphere by a corner of a box: 0.3 m from it along each axis, 0.5196 m in all.
    EXPECT_EQ(two("box = [1, 1, 1]", "[0, 0, 0]", "sphere = 0.51", "[0.8, 0.8, 0.8]"), "");
    EXPECT_TRUE(
        has(two("box = [1, 1, 1]", "[0, 0, 0]", "sphere = 0.53", "[0.8, -0.8, 0.8]"), "begins 0.0103848 m inside"));
    EXPECT_TRUE(has(two("sphere = 0.1", "[0, 0.3, 0]", "box = [1, 1, 1]", "[0, 0, 0]"), "begins 0.3 m inside"));
    // Two boxes edge to edge, apart along the normal of both edges alone.
    const std::string about_x = "orientation = [0.92387953, 0.38268343, 0.0, 0.0]\n",
                      about_z = "orientation = [0.92387953, 0.0, 0.0, 0.38268343]\n";
    const auto crossed = [&](const std::string& height) {
        return said(at("a", "box = [4, 1, 1]", "[0, 0, 0]", about_x) +
                    at("b", "box = [1, 1, 4]", "[0, " + height + ", 0]", about_z));
    };
    EXPECT_EQ(crossed("1.42"), "");
    EXPECT_TRUE(has(crossed("1.40"), "begins 0.0142136 m inside body \"a\""));
}

TEST(Run, an_energy_beyond_double_is_null_and_a_failure) {
    // Its step is 25000 times too long: the motion grows by 6e8 a step.
    const std::string scene = "[world]\nstep = \"1/4\"\nduration = 5.0\n" + body_of("a", "sphere = 1.0") +
                              body_of("b", "sphere = 1.0") + "position = [3.0, 0.0, 0.0]\n" +
                              "[[spring]]\nbody = \"b\"\nto = [3.0, 1.0, 0.0]\nstiffness = 1e10\n";
    const std::string path = written("scene.toml", scene);
    const Outcome outcome = tumble({"run", path, "--numbers", "f64", "--json"}, Process::Errors::pass);
    EXPECT_EQ(outcome.status, 1);
    const Json json = Json::parse(outcome.text);
    EXPECT_TRUE(json["energy_end_j"].is_null()) << outcome.text;
    EXPECT_TRUE(json["bodies"][1]["position_m"][1].is_number()) << outcome.text;
    // Where contacts are met at such speeds is of no interest.
    const auto told = json["status"].get<std::set<std::string>>();
    EXPECT_TRUE(told.count("step_too_long") == 1 && told.count("range_left") == 1) << outcome.text;
    EXPECT_TRUE(has(tumble({"run", path, "--numbers", "f64"}).text, "at 4.75 s (step 19): range_left"));
}

TEST(Firmware, a_memory_shortage_is_one_sentence) {
    EXPECT_EQ(memory_shortage("ld: a.elf section `.bss' will not fit in region `RAM'\n"
                              "ld: region `RAM' overflowed by 8688 bytes\ncollect2: error: ld returned 1 exit status\n",
                              "cortex-m0"),
              "needs 8688 bytes of RAM more than cortex-m0 has");
    EXPECT_EQ(memory_shortage("ld.lld: error: section '.bss' will not fit in region 'RAM': overflowed by 96 bytes\n"
                              "ld.lld: error: section '.text' will not fit in region 'FLASH': overflowed by 4 bytes\n",
                              "cortex-m3"),
              "needs 96 bytes of RAM and 4 bytes of FLASH more than cortex-m3 has");
    EXPECT_EQ(memory_shortage("undefined reference to `main'\n", "cortex-m3"), "");
}

// --- list ------------------------------------------------------------------------------------------------------------

TEST(List, names_integrators_number_systems_ranges_and_cores) {
    const Outcome outcome = tumble({"list"});
    EXPECT_EQ(outcome.status, 0);
    for (const IntegratorInfo& info : integrators()) EXPECT_TRUE(has(outcome.text, info.name)) << info.name;
    EXPECT_TRUE(has(outcome.text, "not in q32, because " + find_integrator("exact").not_in_fixed_point));
    for (const auto* part : {"q32", "f32", "f64", "near", "room", "field", "32768 m", "cortex-m0", "mps2-an385"})
        EXPECT_TRUE(has(outcome.text, part)) << part;
}

TEST(List, shows_the_order_of_free_rotation_where_it_differs) {
    const auto lines = lines_of(tumble({"list"}).text);
    const std::size_t column = lines.at(0).find("needs");
    std::size_t rows = 0;
    for (const std::string& line : lines) {
        for (const IntegratorInfo& info : integrators()) {
            if (!line.starts_with("  " + info.name + " ")) continue;
            ++rows;
            ASSERT_GT(line.size(), column);
            EXPECT_EQ(line.substr(column - 1, 1), " ") << line;
            EXPECT_NE(line.substr(column, 1), " ") << line;
            EXPECT_EQ(has(line, " 2 (free 6) "), info.name == "pdmv6") << line;
            EXPECT_EQ(has(line, " 2 (free exact) "), info.name == "exact") << line;
            EXPECT_EQ(has(line, "(free "), info.free_order != info.order) << line;
        }
    }
    EXPECT_EQ(rows, integrators().size());
}

// --- processes -------------------------------------------------------------------------------------------------------

TEST(Process, all_processes_end_when_the_program_ends) {
    for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGABRT, SIGKILL, SIGSEGV}) {
        std::array<int, 2> held{};  // its writing end stays open for as long as one of them runs
        ASSERT_EQ(pipe(held.data()), 0);
        const pid_t program = fork();
        ASSERT_GE(program, 0);
        if (program == 0) {
            const rlimit no_core{0, 0};
            setrlimit(RLIMIT_CORE, &no_core);
            // A sanitizer's own handler would end it by exit().
            if (signal == SIGSEGV || signal == SIGABRT) ::signal(signal, SIG_DFL);
            dup2(held[1], STDERR_FILENO);  // what is above it is not kept by all of them
            Process child({"sh", "-c", "sleep 60 & echo started; wait"});
            std::string line;
            (void)child.read_line(line);
            raise(signal);
            _exit(0);
        }
        close(held[1]);
        int status = 0;
        ASSERT_EQ(waitpid(program, &status, 0), program);
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << signal << ": " << status;
        pollfd end{held[0], POLLIN, 0};
        EXPECT_EQ(poll(&end, 1, 10000), 1) << "something runs on after signal " << signal;
        close(held[0]);
    }
}

TEST(Process, a_child_that_ends_by_a_signal_has_its_status) {
    EXPECT_EQ(Process({"sh", "-c", "kill -9 $$"}).wait(), 128 + SIGKILL);
    EXPECT_EQ(Process({"sh", "-c", "exit 7"}).wait(), 7);
    EXPECT_EQ(Process({"no_such_program"}).wait(), 127);
}

TEST(Process, input_and_output_larger_than_a_pipe_pass_through) {
    std::string input, output;
    for (int i = 0; i < 100000; ++i) input += "line " + std::to_string(i) + "\n";
    Process child({"sh", "-c", "cat; echo done >&2"}, input, Process::Errors::keep);
    EXPECT_EQ(child.wait(&output), 0);
    EXPECT_EQ(output, input);
    EXPECT_EQ(child.errors(), "done\n");
}

TEST(Emulator, a_timeout_that_is_not_a_positive_number_is_refused) {
    const std::string run = (source_directory / "port/qemu/run").string();
    for (const std::string timeout : {"abc", "0", "0.0", "-1", "", "1s", "1e3", ".", "inf", "1 2"}) {
        std::string text;
        EXPECT_EQ(Process({run, "--timeout", timeout, "cortex-m3", "no.elf"}, {}, Process::Errors::merge).wait(&text),
                  2);
        EXPECT_EQ(text, "run: --timeout: got '" + timeout + "', expected a positive number of seconds\n");
    }
    for (const std::string timeout : {"1", "0.5", "600"})
        EXPECT_EQ(Process({run, "--timeout", timeout, "cortex-m3", "no.elf"}, {}, Process::Errors::merge).wait(), 126);
}

// --- compile ---------------------------------------------------------------------------------------------------------

TEST(Compile, header_holds_what_the_scene_needs_and_nothing_else) {
    const std::string path = temporary("scene.hpp");
    ASSERT_EQ(tumble({"compile", shipped("ball"), "-o", path}).status, 0);
    const std::string header = contents(path);
    for (const auto* part :
         {"struct Ball {", "name = \"bouncing ball\"", "step{1, 256}", "steps = 1280u", ".restitution = 0.8",
          "using Numbers = tumble::NumbersOf<\"q32\", tumble::RangeOf<\"near\">>;",
          "using Integrator = tumble::integrators::Verlet;", ".bodies = 1,", ".planes = 1,",
          "static_assert(TUMBLE_BITS == "})
        EXPECT_TRUE(has(header, part)) << part << "\n" << header;
    for (const auto* part :
         {"boxes = true", "friction = true", "impulses = true", "forces = true", "drag = true", ".springs ="})
        EXPECT_FALSE(has(header, part)) << part;
}

// Boxes side by side have more neighbours than a heap of spheres: four by four on a floor 58 pairs.
std::string packed_boxes(int n) {
    std::string scene = "[world]\ngravity = [0.0, -9.81, 0.0]\nstep = \"1/256\"\nduration = 0.25\n[contact]\n"
                        "restitution = 0.0\nfriction = 0.5\n[[plane]]\nname = \"floor\"\nnormal = [0.0, 1.0, 0.0]\n";
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            scene += "[[body]]\nname = \"b" + std::to_string(n * i + j) + "\"\nshape = { box = [0.5, 0.5, 0.5] }\n" +
                     "mass = 1.0\nposition = [" + std::to_string(0.5 * i) + ", 0.25, " + std::to_string(0.5 * j) +
                     "]\n";
    return scene;
}

TEST(Compile, there_is_room_for_the_pairs_of_packed_boxes) {
    const auto near_pairs = [](const std::string& scene) {
        const Outcome outcome = tumble({"compile", scene});
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        const std::size_t at = outcome.text.find(".near_pairs = ");
        return at == std::string::npos ? 0 : std::stoi(outcome.text.substr(at + 14));
    };
    // Neighbours along two directions and both diagonals, and the floor.
    for (const int n : {4, 5}) {
        const int pairs = 2 * n * (n - 1) + 2 * (n - 1) * (n - 1) + n * n;
        const int room = near_pairs(written("packed.toml", packed_boxes(n)));
        EXPECT_GE(room, pairs) << n;
        EXPECT_LE(room, 2 * pairs) << n;
    }
    // These scenes have the default room.
    for (const char* scene : {"contacts/spheres", "contacts/pyramid", "brick"})
        EXPECT_EQ(near_pairs(shipped(scene)), 0);
}

TEST(Compile, a_scene_without_bodies_needs_an_option) {
    const std::string scene = written("bodiless.toml", "[world]\nstep = 0.1\nduration = 1.0\n");
    EXPECT_EQ(tumble({"compile", scene}).status, 2);
    const Outcome outcome = tumble({"compile", scene, "--no-bodies"});
    EXPECT_EQ(outcome.status, 0);
    for (const auto* part : {"std::array<tumble::BodySpec, 0> bodies{};", "            .bodies = 0,\n        };"})
        EXPECT_TRUE(has(outcome.text, part)) << part << "\n" << outcome.text;
}

TEST(Compile, goes_to_standard_output_by_default) {
    const Outcome outcome =
        tumble({"compile", shipped("cube_binary"), "--integrator", "rk4", "--numbers", "f64", "--carry", "on"});
    EXPECT_EQ(outcome.status, 0);
    for (const auto* part : {"struct CubeBinary {", "tumble::NumbersOf<\"f64_carried\", ", "tumble::integrators::Rk4",
                             "boxes = true", "friction = true", "impulses = true"})
        EXPECT_TRUE(has(outcome.text, part)) << part;
}

TEST(Compile, names_cannot_break_the_header) {
    const std::string scene = written(
        "1 odd-name.toml",
        "name = \"a \\\"b\\\" \\\\\"\n[world]\nstep = 0.1\nduration = 1.0\n[[body]]\nname = \"\\u00e9\\n*/ \\\\\"\n"
        "shape = { sphere = 1.0 }\nmass = 1.0\n");
    const Outcome outcome = tumble({"compile", scene});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(has(outcome.text, "struct Scene1OddName {")) << outcome.text;
    EXPECT_TRUE(has(outcome.text, R"(name = "a \"b\" \\";)")) << outcome.text;
    EXPECT_TRUE(has(outcome.text, R"(// "\303\251\012*/ \\")")) << outcome.text;
    EXPECT_TRUE(has(outcome.text, "step{tumble::Real{0.1}}")) << outcome.text;
}

// The features of a header that differ from their default, without the numbers of bodies and planes.
std::set<std::string> features_of(const std::string& scene) {
    const Outcome outcome = tumble({"compile", written("scene.toml", scene)}, Process::Errors::pass);
    EXPECT_EQ(outcome.status, 0) << scene;
    std::set<std::string> features;
    const std::string start = "            .";
    bool inside = false;
    for (const std::string& line : lines_of(outcome.text)) {
        if (line == "        static constexpr tumble::Features features{") inside = true;
        else if (!line.starts_with(start)) inside = false;
        else if (inside) features.insert(line.substr(start.size(), line.size() - start.size() - 1));
    }
    std::erase_if(features, [](const std::string& f) { return f.starts_with("bodies") || f.starts_with("planes"); });
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
    EXPECT_EQ(features(ball + other), Features{"pairs = true"});
    EXPECT_EQ(features(ball + other + fixed), Features{"pairs = true"});
    EXPECT_EQ(features(ball + fixed + other + fixed), Features{});
    EXPECT_EQ(features(ball + box), (Features{"pairs = true", "boxes = true"}));
    EXPECT_EQ(features(box + fixed), Features{"boxes = true"});
    EXPECT_EQ(features(ball + cloud), Features{});
    EXPECT_EQ(features(ball + turning), Features{});
    EXPECT_EQ(features(ball + turning + fixed), Features{"turntables = true"});
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
    EXPECT_EQ(features("[contact]\n" + sleep), (Features{"pairs = true", "boxes = true", "round_shapes = true",
                                                         "friction = true", "sleep = true", "turntables = true"}));
    EXPECT_EQ(features("[contact]\nsleep = false\n"), (Features{"pairs = true", "boxes = true", "round_shapes = true",
                                                                "friction = true", "turntables = true"}));
    EXPECT_EQ(features("[contact]\nresponse = \"spring\"\n" + sleep),
              (Features{"pairs = true", "boxes = true", "round_shapes = true", "turntables = true",
                        "contact_impulses = false", "contact_springs = true"}));
    EXPECT_EQ(features("[contact]\nresponse = \"none\"\n" + sleep), Features{"turntables = true"});
}

TEST(Compile, contact_has_the_members_of_its_response) {
    // The lines between the braces of `.contact = {`, without indentation and comments.
    const auto members = [](const std::string& contact) {
        const Outcome outcome =
            tumble({"compile", written("scene.toml", scene_of("[contact]\n" + contact, body_of("a", "sphere = 1.0")))},
                   Process::Errors::pass);
        EXPECT_EQ(outcome.status, 0);
        const auto lines = lines_of(outcome.text);
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
    const std::string impulse = ".response = tumble::ContactResponse::impulse,",
                      spring = ".response = tumble::ContactResponse::spring,",
                      constants = "stiffness = 500.0\ndamping = 3.0\nbarrier = 0.5\n";
    EXPECT_EQ(members(""), (Members{impulse, ".restitution = 0.5,", ".tolerance = 0.001,"}));
    EXPECT_EQ(members(constants + "sleep = { speed = 0.25 }\n"),
              (Members{impulse, ".restitution = 0.5,", ".tolerance = 0.001,",
                       ".sleep = {.on = true, .speed = 0.25, .angular_speed = 0.05, .time = 0.5},"}));
    EXPECT_EQ(members("response = \"spring\"\n"), (Members{spring, ".tolerance = 0.001,", ".stiffness = 10000.0,"}));
    EXPECT_EQ(members("response = \"spring\"\nfriction = 0.5\nsleep = { speed = 0.25 }\n" + constants),
              (Members{spring, ".tolerance = 0.001,", ".stiffness = 500.0,", ".damping = 3.0,", ".barrier = 0.5,"}));
    EXPECT_EQ(members("response = \"none\"\n" + constants), Members{".response = tumble::ContactResponse::none,"});
}

}  // namespace
}  // namespace tumble::host
