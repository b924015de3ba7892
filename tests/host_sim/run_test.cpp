// `tumble run` as its contract says: options, output and exit status.
#include <tumble/version.hpp>

#include <algorithm>
#include <map>
#include <regex>
#include <set>

#include "command_runner.hpp"

namespace tumble::host {
namespace {

std::set<std::string> keys_of(const Json& object) {
    std::set<std::string> keys;
    for (const auto& [key, value] : object.items()) keys.insert(key);
    return keys;
}

const std::string falling =
    world_of("-9.81", "1/256", "20.0") + smallest_range + body_of(R"(steel \"ball\")", "sphere = 0.5");

TEST(Run, json_has_the_keys_of_the_contract) {
    const Json json = json_of({"run", shipped("orbit"), "--integrator", "rk4", "--numbers", "f64"});
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

TEST(Run, tells_which_bodies_stepped_in_bounded_time) {
    const auto pile = [](int boxes, const std::string& contact) {
        std::string text = "world = { gravity = [0, -9.8, 0], step = \"1/64\", duration = 0.5 }\n"
                           "plane = [ { name = \"floor\", normal = [0, 1, 0] } ]\ncontact = { restitution = 0" +
                           contact + " }\nbody = [ ";
        for (int i = 0; i < boxes; ++i)
            text += (i > 0 ? ", " : "") + std::string("{ name = \"b") + std::to_string(i) +
                    "\", shape = { box = [1, 1, 1] }, mass = 1, position = [0, " + std::to_string(0.75 + 1.25 * i) +
                    ", 0] }";
        return written("pile.toml", text + " ]\n");
    };
    const std::vector<std::string> run{"run", pile(6, ""), "--check", "off"};
    expect_parts(text_of(run), {"bounded steps of 6 bodies (b0, b1, b2, b3, b4, ..) from 0 s on: overlaps of up to "});
    const Json told = json_of(with(run, {"--json"}))["bounded_steps"];
    EXPECT_EQ(keys_of(told), (std::set<std::string>{"bodies", "deepest_overlap_m", "at_s"}));
    ASSERT_EQ(told["bodies"].size(), 6u);
    EXPECT_EQ(told["bodies"][5]["name"], "b5");
    EXPECT_EQ(told["bodies"][5]["from_s"], 0.0);
    EXPECT_GT(told["bodies"][5]["steps"], 10);
    EXPECT_LT(told["deepest_overlap_m"], 0.016);
    for (const auto& [boxes, contact] : {std::pair{6, ", exact_bodies = 1000"}, {2, ""}}) {
        const std::vector<std::string> exact{"run", pile(boxes, contact), "--check", "off"};
        EXPECT_FALSE(has(text_of(exact), "bounded steps"));
        EXPECT_FALSE(json_of(with(exact, {"--json"})).contains("bounded_steps"));
    }
}

// Two boxes that are one in the other.
TEST(Run, tells_of_deep_overlaps_in_bounded_steps) {
    const std::string boxes = body_of("a", "box = [1.0, 1.0, 1.0]") + body_of("b", "box = [1.0, 1.0, 1.0]") +
                              body_of("c", "box = [1.0, 1.0, 1.0]");
    const Outcome outcome = tumble({"run", written("deep.toml", scene_of("", boxes)), "--check", "off"});
    EXPECT_NE(outcome.status, 0);
    expect_parts(outcome.text, {"bodies that step in bounded time overlap by more than 16 tolerances",
                                "a smaller step, or a larger contact.exact_bodies"});
}

TEST(Run, json_numbers_have_17_digits) {
    expect_outcome(tumble({"run", shipped("brick"), "--step", "0.1", "--duration", "0.1", "--json"}), 0,
                   "\"step_s\": 0.10000000000000001");
}

TEST(Run, prints_a_table_and_no_progress_when_piped) {
    const std::string text = text_of({"run", shipped("top")});
    expect_parts(text,
                 {"free top: verlet, q32 near", "25600 steps", "position", "angular velocity", "energy", "state"});
    EXPECT_FALSE(has(text, "%"));
    EXPECT_FALSE(has(text, "\r"));
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
    const std::string warning = "warning: --every has no effect without --trajectory", csv = temporary("out.csv");
    const auto run = [](const std::vector<std::string>& options) {
        return tumble(with({"run", shipped("orbit"), "--duration", "1"}, options));
    };
    expect_outcome(run({"--every", "25"}), 0, warning);
    EXPECT_FALSE(has(run({"--trajectory", csv, "--every", "25"}).text, warning));
    EXPECT_FALSE(has(run({}).text, warning));
}

TEST(Run, contacts_have_a_row_for_each_event_and_for_every_kth_step_of_what_touches) {
    const std::string fall = world_of("-9.81", "1/256", "1.0"), inelastic = "[contact]\nrestitution = 0.0\n",
                      scene = written("fall.toml", fall + inelastic + floor_plane +
                                                       body_of("ball", "sphere = 0.5", "[0.0, 1.0, 0.0]")),
                      csv = temporary("contacts.csv");
    ASSERT_EQ(tumble({"run", scene, "--contacts", csv, "--every", "100", "--check", "off"}).status, 0);
    const auto lines = lines_of(contents(csv));
    // It lands in step 82.
    ASSERT_EQ(lines.size(), 5u);
    EXPECT_EQ(lines[0],
              "time_s,body,other,touches,began,ended,hit_speed,nx,ny,nz,depth,px,py,pz,normal_impulse,jx,jy,jz");
    EXPECT_TRUE(lines[1].starts_with("0.3203125,ball,floor,1,1,0,3.13")) << lines[1];
    EXPECT_TRUE(lines[2].starts_with("0.390625,ball,floor,1,0,0,0,0,1,0,")) << lines[2];
    EXPECT_TRUE(lines[3].starts_with("0.78125,ball,floor,1,0,0,0,0,1,0,")) << lines[3];
    EXPECT_TRUE(lines[4].starts_with("1,ball,floor,1,0,0,0,0,1,0,")) << lines[4];
    for (const std::string& line : lines) EXPECT_EQ(std::count(line.begin(), line.end(), ','), 17) << line;
    for (const char* response : {"none", "spring"}) {
        const std::string other = written("other.toml", fall + "[contact]\nresponse = \"" + response + "\"\n" +
                                                            body_of("ball", "sphere = 0.5"));
        expect_outcome(tumble({"run", other, "--contacts", csv}), 2,
                       "--contacts: got a scene without contacts by impulses, expected contact.response = \"impulse\"");
    }
}

TEST(Run, step_and_duration_replace_those_of_the_scene) {
    const Json json = json_of({"run", shipped("brick"), "--step", "1/128", "--duration", "0.51"});
    EXPECT_EQ(json["steps"], 66);  // the last step ends at or just after the duration
    EXPECT_EQ(json["step_s"], 1.0 / 128);
}

TEST(Run, carry_changes_the_state) {
    const auto hash = [](const char* carry) {
        return json_of({"run", shipped("brick"), "--carry", carry})["state_hash"];
    };
    EXPECT_NE(hash("on"), hash("off"));
}

// The plot of a scene file, whose run ends with a status; empty where gnuplot is missing.
std::string plot_of(const std::string& scene, int status = 0) {
    const std::string path = temporary("out's.svg");
    const Outcome outcome = tumble({"run", scene, "--plot", path});
    if (has(outcome.text, "gnuplot not found")) return {};
    EXPECT_EQ(outcome.status, status) << outcome.text;
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
    std::string scene = R"(name = "it's \"1 < 2\"")" + ("\n" + world_of("-9.81", "1/256", "1.0")) +
                        "[contact]\nrestitution = 1.0\n" + floor_plane +
                        body_of("ball & chain", "sphere = 0.5", "[0.0, 1.5, 0.0]") +
                        body_of("puck", "sphere = 0.5", "[9.0, 20.0, 0.0]");
    for (const char* time : {"0.0", "0.25", "0.75"})
        scene += std::string("[[impulse]]\nbody = \"puck\"\ntime = ") + time + "\nimpulse = [1.0, 0.0, 0.0]\n";
    const std::string svg = plot_of(written("scene.toml", scene));
    if (svg.empty()) GTEST_SKIP() << "no gnuplot";
    for (const char* text : {"it's \"1 &lt; 2\"", "ball &amp; chain", "puck", "verlet, q32, 256 steps of 1/256 s",
                             "x, m", "y, m", "z, m", "about x, rad/s", "about y, rad/s", "about z, rad/s", "energy, J",
                             "time, s", "kinetic", "potential", "total", "an impulse acts", "a contact begins"})
        EXPECT_TRUE(has(svg, std::string("<text>") + text + "</text>")) << text;
    EXPECT_FALSE(has(svg, "not fixed"));

    // A mark in each panel, and one in the legend.
    const std::vector<double> pushes = marks_in(svg, triangle), touches = marks_in(svg, circle);
    ASSERT_EQ(pushes.size(), 3 * panels + 1);
    ASSERT_EQ(touches.size(), 1 * panels + 1);
    const double second = (pushes[2] - pushes[0]) / 0.75;  // pixels
    EXPECT_NEAR(pushes[1] - pushes[0], 0.25 * second, 0.02);
    EXPECT_NEAR(touches[0] - pushes[0], 0.4515 * second, second / 256 + 0.02);
}

// It leaves the range after 3.26 s of 20 s.
TEST(Run, a_plot_of_a_run_that_stops_ends_there) {
    const std::string svg = plot_of(written("falling.toml", falling), 1);
    if (svg.empty()) GTEST_SKIP() << "no gnuplot";
    EXPECT_TRUE(has(svg, ">3<"));
    EXPECT_FALSE(has(svg, ">5<"));
}

TEST(Run, a_plot_of_ten_bodies_names_eight_that_are_not_fixed_and_says_so) {
    std::string scene = "[world]\nstep = \"1/256\"\nduration = 0.5\n[contact]\nresponse = \"none\"\n";
    for (int b = 0; b < 10; ++b)
        scene += body_of("body " + std::to_string(b), "sphere = 0.5", "[" + std::to_string(2 * b) + ", 0, 0]") +
                 (b == 3 ? "fixed = true\n" : "");
    const std::string svg = plot_of(written("scene.toml", scene));
    if (svg.empty()) GTEST_SKIP() << "no gnuplot";
    for (int b = 0; b < 10; ++b)
        EXPECT_EQ(has(svg, "<text>body " + std::to_string(b) + "</text>"), b != 3 && b != 9) << b;
    EXPECT_TRUE(has(svg, "<text>the first 8 of 10 bodies that are not fixed</text>"));
    for (const char* shape : {triangle, circle}) EXPECT_TRUE(marks_in(svg, shape).empty());
    for (const char* meaning : {"an impulse acts", "a contact begins"}) EXPECT_FALSE(has(svg, meaning));
}

TEST(Run, the_panels_of_a_plot_are_aligned_and_inside_the_picture) {
    const std::string svg = plot_of(shipped("contacts/cradle"));
    if (svg.empty()) GTEST_SKIP() << "no gnuplot";
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
        expect_outcome(outcome, 1, option + ": writing /dev/full failed");
    }
}

TEST(Run, leaving_the_range_fails_with_body_time_and_status) {
    expect_outcome(tumble({"run", written("falling.toml", falling)}), 1, "steel \"ball\"", "3.26", " s (step ",
                   "range_left", "[range]");
    const Json json = json_of({"run", written("falling.toml", falling)}, 1);
    EXPECT_EQ(json["status"], Json::array({"range_left"}));
    EXPECT_LT(json["steps"], 900);  // the run ends there
    EXPECT_EQ(json["bodies"][0]["name"], "steel \"ball\"");
}

// The kernel and the watch of the declared range find the same spin.
TEST(Run, each_status_is_told_once) {
    for (const char* numbers : {"q32", "f32", "f64"})
        for (const char* step : {"1/30", "1/25"}) {
            const std::string scene = written(
                "turned.toml", world_of("0", step, "2.0") + smallest_range + body_of("b", "box = [0.2, 0.3, 0.4]") +
                                   "[[force]]\nbody = \"b\"\nuntil = 2.0\ntorque = [0.0, 0.0, 40.0]\n");
            EXPECT_EQ(json_of({"run", scene, "--numbers", numbers}, 1)["status"], Json::array({"range_left"}))
                << numbers << step;
        }
}

// Whatever the method keeps, and about every axis.
TEST(Run, floating_point_is_held_to_the_declared_range_of_spins) {
    for (const char* integrator : {"verlet", "rk4"})
        for (const char* numbers : {"f32", "f64"})
            for (const char* torque : {"[0.0, 0.0, 0.25]", "[0.0, -0.25, 0.0]", "[0.25, 0.0, 0.0]"}) {
                const std::string scene =
                    written("turned.toml", world_of("0", "1/256", "4.0") + smallest_range +
                                               body_of("b", "cylinder = [0.2, 0.4]") +
                                               "[[force]]\nbody = \"b\"\nuntil = 4.0\n" + "torque = " + torque + "\n");
                const Json json = json_of({"run", scene, "--numbers", numbers, "--integrator", integrator}, 1);
                EXPECT_EQ(json["status"], Json::array({"range_left"})) << integrator << numbers << torque;
                const double spin = std::hypot(json["bodies"][0]["angular_velocity_rad_s"][0].get<double>(),
                                               json["bodies"][0]["angular_velocity_rad_s"][1].get<double>(),
                                               json["bodies"][0]["angular_velocity_rad_s"][2].get<double>());
                EXPECT_GT(spin, 32);
                EXPECT_LT(spin, 32.25) << integrator << numbers << torque;
            }
}

TEST(Run, floating_point_that_is_not_finite_leaves_the_range) {
    const std::string scene = written(
        "spring.toml", world_of("0", "0.5", "500.0") + body_of("bob", "sphere = 0.1", "[1.0, 0.0, 0.0]", "0.001") +
                           "[[spring]]\nbody = \"bob\"\nto = [0.0, 0.0, 0.0]\nstiffness = 10000.0\n");
    EXPECT_EQ(json_of({"run", scene, "--integrator", "explicit_euler", "--numbers", "f32"}, 1)["status"],
              Json::array({"step_too_long", "range_left"}));
}

std::string resting(const std::string& sleep) {
    return world_of("-9.81", "1/256", "3.0") + "[contact]\nfriction = 0.5\n" + sleep + floor_plane +
           body_of("box", "box = [1.0, 1.0, 1.0]", "[0.0, 0.5, 0.0]");
}

TEST(Run, the_table_shows_which_bodies_are_asleep) {
    const std::string scene = written("resting.toml", resting("sleep = { time = 0.5 }\n"));
    EXPECT_TRUE(has(tumble({"run", scene}).text, "  asleep\n"));
    EXPECT_FALSE(has(tumble({"run", scene, "--duration", "0.4"}).text, "asleep"));
}

TEST(Run, json_has_sleep_and_contacts_of_each_body) {
    for (const auto* numbers : {"q32", "f32", "f64"}) {
        const auto box = [&](const std::string& sleep, const char* duration) {
            const std::string scene = written("resting.toml", resting(sleep));
            return json_of({"run", scene, "--numbers", numbers, "--duration", duration})["bodies"][0];
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
    return world_of("-10.0", "1/64", "1.0") + "[contact]\nresponse = \"spring\"\nstiffness = " + stiffness + "\n" +
           floor_plane + body_of("ball", "sphere = 0.5", "[0.0, " + height + ", 0.0]");
}

TEST(Run, contact_springs_conserve_energy) {
    const Json json = json_of({"run", written("soft.toml", on_springs("10000.0", "1.0")), "--numbers", "f64", "--step",
                               "1/1024", "--duration", "0.65"});
    // At the lowest point 5.3 of the 10 J are the spring's.
    EXPECT_LT(json["energy_max_relative_drift"], 0.02);
    // A fall of 316 ms, half a period of the spring, 31 ms, and nearly at the top again.
    EXPECT_NEAR(json["bodies"][0]["position_m"][1], 1.0, 0.02);
}

// Verlet is exact under constant gravity.
TEST(Run, what_new_gravity_gives_is_no_drift_of_the_energy) {
    std::string scene = world_of("-9.81", "1/256", "2.0") + body_of("ball", "sphere = 0.5", "[3.0, 5.0, -2.0]", "2.0") +
                        "velocity = [1.0, 4.0, 0.5]\n" + body_of("pole", "sphere = 0.5", "[9.0, 9.0, 9.0]", "5.0") +
                        "fixed = true\n";
    for (const char* event : {"0.5\nvalue = [2.0, 0.0, 1.0]", "1.0\nvalue = [0.0, 9.81, 0.0]"})
        scene += "[[event]]\nkind = \"gravity\"\ntime = " + std::string(event) + "\n";
    for (const char* numbers : {"q32", "f64"}) {
        const Json json = json_of({"run", written("tilted.toml", scene), "--numbers", numbers, "--check", "off"});
        const double start = json["energy_start_j"], end = json["energy_end_j"];
        EXPECT_GT(std::abs(end - start), 100) << numbers;
        EXPECT_LT(json["energy_max_relative_drift"], 1e-7) << numbers;
    }
}

TEST(Run, a_step_too_long_for_a_contact_spring_fails_and_names_the_largest_safe_step) {
    const std::string scene = written("stiff.toml", on_springs("1000000.0", "0.499"));
    const std::string text = text_of({"run", scene}, 1),
                      message = "body \"ball\" at 0 s (step 0): step_too_long: a contact spring is too stiff for the "
                                "step of 0.015625 s. The "
                                "method may be unstable at this step. Use a step of at most ";
    const std::size_t at = text.find(message);
    ASSERT_NE(at, std::string::npos) << text;
    const std::string rest = text.substr(at + message.size()), safe = rest.substr(0, rest.find(" s\n"));
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

TEST(Run, an_energy_beyond_double_is_null_and_a_failure) {
    // Its step is 25000 times too long: the motion grows by 6e8 a step.
    const std::string scene = "[world]\nstep = \"1/4\"\nduration = 5.0\n" + body_of("a", "sphere = 1.0") +
                              body_of("b", "sphere = 1.0") + "position = [3.0, 0.0, 0.0]\n" +
                              "[[spring]]\nbody = \"b\"\nto = [3.0, 1.0, 0.0]\nstiffness = 1e10\n";
    const std::string path = written("scene.toml", scene);
    const Json json = json_of({"run", path, "--numbers", "f64"}, 1);
    EXPECT_TRUE(json["energy_end_j"].is_null()) << json;
    EXPECT_TRUE(json["bodies"][1]["position_m"][1].is_number()) << json;
    // Where contacts are met at such speeds is of no interest.
    const auto told = json["status"].get<std::set<std::string>>();
    EXPECT_TRUE(told.count("step_too_long") == 1 && told.count("range_left") == 1) << json;
    EXPECT_TRUE(has(tumble({"run", path, "--numbers", "f64"}).text, "at 4.75 s (step 19): range_left"));
}

// A scene and how it ends in a method, with one key of [expect] changed.
std::string expecting(const Json& run, const std::string& key = {}, const std::string& value = {}) {
    std::string text = contents(shipped("cube")) + "\n[expect]\n";
    const auto line = [&](const std::string& name, const std::string& own) {
        text += name + " = " + (name == key ? value : own) + "\n";
    };
    line("integrator", run["integrator"].dump());
    line("numbers", run["numbers"].dump());
    line("steps", run["steps"].dump());
    line("tumble_bits", std::to_string(TUMBLE_BITS));
    line("hash", run["state_hash"].dump());
    return written("expecting.toml", text);
}

TEST(Run, ends_as_the_scene_expects_or_says_both_hashes) {
    const Json f32 = json_of({"run", shipped("cube"), "--integrator", "rk4", "--numbers", "f32"});
    const std::string hash = f32["state_hash"];
    // The method is that of [expect].
    expect_outcome(tumble({"run", expecting(f32)}), 0, "rk4, f32", hash);
    expect_outcome(tumble({"run", expecting(f32, "hash", "\"0123456789abcdef\"")}), 1,
                   "expect: got hash " + hash + " after 800 steps, expected hash 0123456789abcdef after 800 steps\n");
    expect_outcome(tumble({"run", expecting(f32, "steps", "799")}), 1,
                   " after 799 steps, expected hash " + hash + " after 799 steps");
    expect_outcome(tumble({"run", expecting(f32, "steps", "801")}), 1,
                   "got hash " + hash + " after 800 steps, expected hash " + hash + " after 801 steps");
    const std::string of_other_bits = expecting(f32, "tumble_bits", std::to_string(TUMBLE_BITS - 1));
    expect_outcome(tumble({"run", of_other_bits}), 0, hash);  // which gives the same bits here
    expect_outcome(tumble({"run", of_other_bits, "--duration", "4"}), 0, "warning: ");
}

TEST(Run, that_is_another_is_not_held_against_what_the_scene_expects) {
    const Json q32 = json_of({"run", shipped("cube")});
    const std::string scene = expecting(q32, "hash", "\"0123456789abcdef\"");
    for (const std::vector<std::string>& other : {std::vector<std::string>{"--integrator", "rk4"},
                                                  {"--numbers", "f64"},
                                                  {"--carry", "off"},
                                                  {"--step", "1/512"},
                                                  {"--duration", "1"}}) {
        std::vector<std::string> arguments = {"run", scene, "--check", "off"};
        arguments.insert(arguments.end(), other.begin(), other.end());
        expect_outcome(tumble(arguments), 0,
                       "warning: " + scene +
                           ": [expect] is of verlet in q32 at the scene's own step and duration. This "
                           "run is another, and is not held against it");
    }
    expect_outcome(tumble({"run", scene, "--check", "off", "--integrator", "verlet"}), 1,
                   "expected hash 0123456789abcdef");
}

TEST(Run, cure_of_a_declared_range_is_a_key_of_it) {
    const std::string fast = world_of("0.0", "1/256", "1.0") + smallest_range + body_of("b", "sphere = 0.1") +
                             "angular_velocity = [0, 0, 31.0]\n" +
                             "[[force]]\nfrom = 0.0\nuntil = 1.0\nbody = \"b\"\ntorque = [0, 0, 0.1]\n";
    expect_outcome(tumble({"run", written("fast.toml", fast), "--numbers", "f64", "--check", "off"}), 1,
                   "Use a larger [range] angular_velocity");
}

TEST(DeepRun, free_body_whose_rotation_does_not_converge_is_not_told_of_impacts_alone) {
    const std::string fast =
        world_of("0.0", "1/30", "0.5") + body_of("b", "sphere = 0.1") + "angular_velocity = [0, 0, 30.0]\n";
    expect_outcome(
        tumble({"run", written("fast.toml", fast), "--numbers", "f64", "--integrator", "pdmv6", "--check", "off"}), 1,
        "the solver of the method did not converge");
}

}  // namespace
}  // namespace tumble::host
