// `tumble run --live`: a program closes the loop over standard input and output, and events of scene files.
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "command_runner.hpp"

namespace tumble::host {
namespace {

const std::string drone = R"(name = "hover"
[world]
step = "1/256"
duration = 3.0
gravity = [0.0, -9.81, 0.0]
[range]
position = 64.0
velocity = 32.0
angular_velocity = 32.0
[[body]]
name = "drone"
shape = { box = [0.3, 0.1, 0.3] }
mass = 2.0
)";

// The command with a pipe to its input and one from its output.
class Live {
public:
    explicit Live(const std::vector<std::string>& arguments) {
        std::array<int, 2> to{}, from{};
        if (pipe(to.data()) != 0 || pipe(from.data()) != 0) throw std::runtime_error{"no pipe"};
        child_ = fork();
        if (child_ == 0) {
            dup2(to[0], 0);
            dup2(from[1], 1);
            for (const int end : {to[0], to[1], from[0], from[1]}) close(end);
            std::vector<char*> words{const_cast<char*>(TUMBLE_COMMAND)};
            for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
            words.push_back(nullptr);
            execv(TUMBLE_COMMAND, words.data());
            _exit(127);
        }
        close(to[0]);
        close(from[1]);
        to_ = fdopen(to[1], "w");
        from_ = fdopen(from[0], "r");
    }
    ~Live() {
        if (to_ != nullptr) (void)end();
    }
    Live(const Live&) = delete;
    Live& operator=(const Live&) = delete;

    void write(const Json& line) {
        std::fputs((line.dump() + "\n").c_str(), to_);
        std::fflush(to_);
    }
    // The next state; null at the end of the output.
    [[nodiscard]] Json read() {
        char* line = nullptr;
        std::size_t size = 0;
        const auto length = getline(&line, &size, from_);
        Json json = length > 0 ? Json::parse(line) : Json();
        std::free(line);
        return json;
    }
    // Ends the input; returns the exit status.
    int end() {
        std::fclose(to_);
        to_ = nullptr;
        while (!read().is_null()) {}
        std::fclose(from_);
        int status = 0;
        waitpid(child_, &status, 0);
        return WEXITSTATUS(status);
    }

private:
    pid_t child_ = 0;
    std::FILE *to_ = nullptr, *from_ = nullptr;
};

TEST(Live, a_controller_holds_a_height_and_its_recording_replays_to_the_same_state) {
    const std::string scene = written("hover.toml", drone), record = temporary("recorded.toml");
    Live live({"run", scene, "--live", "--record", record});
    Json state = live.read();
    EXPECT_EQ(state["step"], 0);
    EXPECT_EQ(state["bodies"][0]["position_m"][1], 0.0);
    for (int step = 1; step <= 768; ++step) {
        const Json& body = state["bodies"][0];
        // A spring of rate 4 / s to the height of 2 m, damped critically, against the weight.
        const double y = body["position_m"][1], v = body["velocity_m_s"][1];
        live.write({{"kind", "force"}, {"body", "drone"}, {"value", {0, 2 * (9.81 + 16 * (2 - y) - 8 * v), 0}}});
        live.write({{"step", 1}});
        state = live.read();
        ASSERT_EQ(state["step"], step);
    }
    // (1 + 4 t) exp(-4 t) of the way is left after 3 s; a step's delay of the controller changes the rate by a part of
    // h times 8 / s.
    EXPECT_NEAR(state["bodies"][0]["position_m"][1], 2, 2 * 13 * std::exp(-12.0 * (1 - 8.0 / 256)));
    EXPECT_NEAR(state["bodies"][0]["specific_force_m_s2"][1], 9.81, 32 * 11 * std::exp(-12.0 * (1 - 8.0 / 256)))
        << "its second derivative";
    EXPECT_EQ(live.end(), 0);
    const Json again = json_of({"run", record});
    EXPECT_EQ(again["state_hash"], state["state_hash"]);
    EXPECT_EQ(again["steps"], 768);
    EXPECT_TRUE(has(contents(record), "[[event]]\ntime = 0.00390625\nkind = \"force\"\nbody = \"drone\"\n"));
}

// Runs lines as standard input; the output has the states, and after them what is on standard error.
Outcome live(const std::string& scene, const std::string& input, std::vector<std::string> options = {}) {
    std::vector<std::string> command{TUMBLE_COMMAND, "run", scene, "--live"};
    command.insert(command.end(), options.begin(), options.end());
    Outcome outcome{};
    Process process(command, input, Process::Errors::merge);
    outcome.status = process.wait(&outcome.text);
    return outcome;
}

TEST(Live, a_step_of_many_writes_a_state_for_each_and_the_end_of_the_scene_ends_the_run) {
    const std::string scene = written("hover.toml", drone);
    EXPECT_EQ(lines_of(live(scene, "{\"step\": 5}\n\n{\"step\": 2}\n").text).size(), 8u);
    EXPECT_EQ(lines_of(live(scene, "").text).size(), 1u);
    const Outcome whole = live(scene, "{\"step\": 5000}\n{\"step\": 5000}\n");
    EXPECT_EQ(lines_of(whole.text).size(), 769u);
    EXPECT_EQ(whole.status, 0);
    EXPECT_EQ(Json::parse(lines_of(whole.text).back())["state_hash"], json_of({"run", scene})["state_hash"]);
}

TEST(Live, every_kind_of_event_replays_from_its_recording) {
    const std::string scene = written("hover.toml", drone), record = temporary("recorded.toml");
    const std::string events = R"({"kind": "impulse", "body": "drone", "value": [0.1, 0.2, 0.3], "point": [0, 0.1, 0]}
{"kind": "angular_impulse", "body": "drone", "value": [0.001, 0.002, 0.003], "frame": "body"}
{"step": 1}
{"kind": "force", "body": "drone", "value": [0.1, 20, 0.3], "frame": "body", "point": [0.001, 0, 0]}
{"kind": "torque", "body": "drone", "value": [0.001, 0.02, 0.003]}
{"step": 7}
{"kind": "step_force", "body": "drone", "value": [1, 2, 3]}
{"kind": "step_torque", "body": "drone", "value": [0.01, 0.02, 0.03], "frame": "body"}
{"step": 3}
{"kind": "velocity", "body": "drone", "value": [0.1, 0.2, 0.3], "frame": "body"}
{"kind": "angular_velocity", "body": "drone", "value": [0.1, 0.2, 0.3]}
{"step": 3}
{"kind": "pose", "body": "drone", "value": [0.1, 0.2, 0.3], "orientation": [1, 2, 3, 4]}
{"kind": "torque", "body": "drone", "value": [0, 0, 0]}
{"kind": "gravity", "value": [0.1, 0.2, -0.3]}
{"step": 760}
)";
    for (const char* numbers : {"q32", "f64"}) {
        const Outcome outcome = live(scene, events, {"--numbers", numbers, "--record", record});
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        EXPECT_EQ(Json::parse(lines_of(outcome.text).back())["state_hash"],
                  json_of({"run", record, "--numbers", numbers})["state_hash"]);
    }
}

TEST(Live, a_wrong_line_ends_the_run_with_its_number_and_what_was_expected) {
    const std::string scene = written("hover.toml", drone);
    const std::pair<const char*, const char*> cases[] = {
        {"height 2", "standard input:3: event: is not JSON, expected a JSON object"},
        {"[1]", "standard input:3: event: is not an object, expected a JSON object"},
        {"{\"step\": 0}", "standard input:3: step: got 0, expected a whole number of steps from 1 to 2^31"},
        {"{\"step\": 1, \"kind\": \"force\"}", "standard input:3: step: given beside other keys, expected"},
        {"{\"step\": 1, \"step\": 2}", "standard input:3: step: given twice, expected each key once"},
        {"{\"kind\": \"force\", \"body\": \"drone\", \"value\": [0, 0, 1], \"value\": [0, 9, 0]}",
         "standard input:3: value: given twice, expected each key once"},
        {"{\"kind\": \"forze\", \"body\": \"drone\", \"value\": [0, 0, 1]}",
         "standard input:3: event.kind: got \"forze\" (did you mean \"force\"?), expected"},
        {"{\"stp\": 1}",
         "standard input:3: stp: unknown key (did you mean \"step\"?), expected a JSON object: an event such as "},
        {"{\"Steps\": 4}", "standard input:3: Steps: unknown key (did you mean \"step\"?)"},
        {"{\"boddy\": 4}", "standard input:3: event.boddy: unknown key (did you mean \"body\"?)"},
        {"{\"kind\": \"end_torque\", \"body\": \"drone\", \"value\": [0, 0, 1]}",
         "standard input:3: event.kind: got \"end_torque\", which is for programs alone, expected \"force\" or "
         "\"torque\", "
         "which act"},
        {"{\"kind\": \"force\", \"body\": \"dron\", \"value\": [0, 0, 1]}",
         "standard input:3: event.body: got \"dron\" (did you mean \"drone\"?), expected the name of a body"},
        {"{\"kind\": \"force\", \"body\": \"drone\"}", "standard input:3: event.value: missing, expected 3 finite"},
        {"{\"kind\": \"force\", \"body\": \"drone\", \"value\": [0, 1]}",
         "standard input:3: event.value: got an array of 2, expected 3 finite numbers"},
        {"{\"time\": 1, \"kind\": \"force\", \"body\": \"drone\", \"value\": [0, 1, 0]}",
         "standard input:3: event.time: unknown key"},
        {"{\"kind\": \"velocity\", \"body\": \"drone\", \"value\": [0, 33, 0]}",
         "standard input:3: event.value[1]: got 33, expected a number from -32 to 32 (m/s)"},
        {"{\"kind\": \"gravity\", \"body\": \"drone\", \"value\": [0, -1, 0]}",
         "standard input:3: event.body: given for gravity, expected no body: gravity acts on all of them"},
        {"{\"kind\": \"gravity\", \"value\": [0, -1, 0], \"frame\": \"world\"}",
         "standard input:3: event.frame: given for gravity, expected no frame: gravity is in the world's"},
        {"{\"kind\": \"force\", \"value\": [0, -1, 0]}", "standard input:3: event.body: missing"},
        {"{\"kind\": \"force\", \"body\": null}", "standard input:3: body: got null, expected"},
        {"{\"step\": 1.5}", "standard input:3: step: got 1.5, expected a whole number of steps from 1 to 2^31"},
        {"{\"step\": \"1\"}", "standard input:3: step: got \"1\", expected a whole number of steps from 1 to 2^31"},
        {"{\"step\": [1, 2]}", "standard input:3: step: got a list of 2, expected a whole number of steps"},
        {"{\"step\": 1e300}", "standard input:3: step: got 1e+300, expected a whole number of steps"},
    };
    for (const auto& [line, message] : cases)
        expect_outcome(live(scene, std::string("{\"step\": 1}\n\n") + line + "\n{\"step\": 1}\n"), 2, message);
}

// What is refused is printed no deeper and no longer than a person reads.
TEST(Live, a_wrong_line_of_any_depth_and_length_is_refused_in_a_short_message) {
    const std::string scene = written("hover.toml", drone);
    const auto nested = [](char open, char close, std::size_t depth) {
        return std::string(depth, open) + std::string(depth, close);
    };
    const std::string deep = nested('[', ']', 200000), name(1000000, 'n');
    std::string objects;
    for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
    for (const std::string& line :
         {"{\"step\": " + deep + "}", R"({"kind": "force", "body": "drone", "value": )" + deep + "}",
          R"({"kind": "force", "body": )" + deep + R"(, "value": [0, 0, 1]})", deep, objects,
          objects + "1" + std::string(100000, '}'), "{\"step\": \"" + name + "\"}",
          R"({"kind": ")" + name + R"(", "body": "drone", "value": [0, 0, 1]})",
          R"({"kind": "force", "body": ")" + name + R"(", "value": [0, 0, 1]})", "{\"" + name + "\": 1}",
          "{\"" + name + "\": null}"}) {
        const Outcome outcome = live(scene, line + "\n");
        EXPECT_EQ(outcome.status, 2) << line.substr(0, 60);
        EXPECT_TRUE(has(outcome.text, "standard input:1: ")) << line.substr(0, 60);
        EXPECT_LT(outcome.text.size(), 3000U) << line.substr(0, 60);
    }
}

TEST(Live, whole_numbers_may_have_a_point_and_numbers_none) {
    const std::string scene = written("hover.toml", drone);
    EXPECT_EQ(lines_of(live(scene, "{\"step\": 2.0}\n").text).size(), 3U);
    EXPECT_EQ(live(scene, R"({"kind": "force", "body": "drone", "value": [9007199254740993, 0, 0]})"
                          "\n")
                  .status,
              0);
    EXPECT_EQ(live(scene, R"({"kind": "force", "body": "drone", "value": [18446744073709551615, 0, 0]})"
                          "\n")
                  .status,
              0);
}

// A rod, a box and a ball are pushed or turned until they leave a range that floating point alone would not end.
TEST(Live, ends_where_a_run_of_its_recording_ends) {
    struct Pushed {
        const char *shape, *event;
    };
    for (const Pushed& pushed : {Pushed{"box = [1.0, 0.02, 0.02]", R"("torque", "value": [0.003, 0, 0])"},
                                 Pushed{"box = [0.2, 0.3, 0.2]", R"("force", "value": [0, 900, 0])"},
                                 Pushed{"sphere = 0.1", R"("step_force", "value": [0, 0, 20000])"}})
        for (const char* numbers : {"q32", "f32", "f64"}) {
            const std::string scene = written("scene.toml", world_of("0", "1/256", "4.0") + smallest_range +
                                                                body_of("b", pushed.shape)),
                              record = temporary("record.toml");
            const Outcome outcome = live(scene,
                                         R"({"kind": )" + std::string(pushed.event) +
                                             R"(, "body": "b"})"
                                             "\n{\"step\": 1024}\n",
                                         {"--numbers", numbers, "--record", record});
            const Json again = json_of({"run", record, "--numbers", numbers}, 1);
            EXPECT_EQ(outcome.status, 1) << pushed.shape << numbers;
            Json last;
            for (const std::string& line : lines_of(outcome.text))
                if (line.starts_with("{")) last = Json::parse(line);
            EXPECT_EQ(last["status"], again["status"]) << pushed.shape << numbers;
            EXPECT_EQ(last["step"], again["steps"]) << pushed.shape << numbers;
            EXPECT_EQ(last["state_hash"], again["state_hash"]) << pushed.shape << numbers;
        }
}

TEST(Live, a_run_that_ends_with_its_input_has_a_recording_that_ends_there) {
    const std::string scene = written("hover.toml", drone), record = temporary("recorded.toml");
    for (const int steps : {1, 2, 127, 768}) {
        const Outcome outcome = live(scene,
                                     "{\"kind\": \"force\", \"body\": \"drone\", \"value\": [0, 1, 0]}\n{\"step\": " +
                                         std::to_string(steps) + "}\n",
                                     {"--record", record});
        const Json again = json_of({"run", record});
        EXPECT_EQ(again["steps"], steps);
        EXPECT_EQ(again["state_hash"], Json::parse(lines_of(outcome.text).back())["state_hash"]) << steps;
    }
}

// What comes after the end of the run stays in its recording.
TEST(Live, a_run_that_ends_before_its_scene_does_has_a_recording_that_can_be_read) {
    for (const char* later : {"[[impulse]]\ntime = 0.75\nbody = \"b\"\nimpulse = [0.1, 0, 0]\n",
                              "[[force]]\nfrom = 0.25\nuntil = 1.0\nbody = \"b\"\nforce = [0.1, 0, 0]\n",
                              "[[event]]\ntime = 0.75\nkind = \"force\"\nbody = \"b\"\nvalue = [0.1, 0, 0]\n"}) {
        const std::string scene = written("scene.toml", world_of("-9.81", "1/256", "1.0") + smallest_range +
                                                            body_of("b", "sphere = 0.1") + later),
                          record = temporary("record.toml");
        const Outcome outcome = live(scene,
                                     R"({"kind": "force", "body": "b", "value": [0, 1, 0]})"
                                     "\n{\"step\": 128}\n",
                                     {"--duration", "0.5", "--record", record});
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        EXPECT_EQ(Json::parse(lines_of(outcome.text).back())["state_hash"],
                  json_of({"run", record, "--duration", "0.5"})["state_hash"])
            << later;
        EXPECT_GT(json_of({"run", record})["steps"], 128) << later;
    }
}

TEST(Live, what_does_not_go_with_it_is_refused) {
    const std::string scene = written("hover.toml", drone);
    expect_outcome(live(scene, "", {"--json"}), 2,
                   "--live: got --json, --trajectory, --contacts, --joints, --plot, --gltf or --check beside it");
    expect_outcome(live("-", drone), 2, "scene: got standard input, from which --live reads events");
    expect_outcome(tumble({"run", scene, "--record", temporary("out.toml")}), 2, "--record: got no --live beside it");
    expect_outcome(live(scene, "", {"--record", scene}), 2, "--record");
}

TEST(Live, a_body_that_leaves_its_range_ends_the_run) {
    const Outcome outcome =
        live(written("hover.toml", drone),
             "{\"kind\": \"force\", \"body\": \"drone\", \"value\": [0, 100, 0]}\n{\"step\": 1000}\n");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(has(outcome.text, "\"status\": [\"range_left\"]")) << outcome.text.substr(0, 2000);
}

TEST(Events, of_bodies_are_not_checked_and_advise_refuses_them) {
    const std::string scene =
        written("hover.toml", drone + "[[event]]\ntime = 0.5\nkind = \"velocity\"\nbody = \"drone\"\n"
                                      "value = [0.0, 1.0, 0.0]\n");
    expect_outcome(tumble({"run", scene}), 0, "verdict: not checked");
    EXPECT_EQ(json_of({"run", scene})["verdict"]["kind"], "unchecked");
    expect_outcome(tumble({"advise", scene, "--core", "cortex-m3", "--tolerance", "1e-3"}), 2,
                   "event: other steps and methods have no reference for the [[event]] of a body");
    expect_outcome(tumble({"run", scene, "--duration", "0.5"}), 0, "event[0] comes when the last step has been taken");
}

TEST(Events, of_gravity_are_checked_and_change_the_potential_energy) {
    const auto scene = [&](const char* value) {
        return written("hover.toml", drone + "[[event]]\ntime = 1.0\nkind = \"gravity\"\nvalue = " + value + "\n");
    };
    const Json run = json_of({"run", scene("[2.0, 0.0, 0.0]"), "--numbers", "f64", "--check", "on"});
    EXPECT_EQ(run["verdict"]["kind"], "right");
    const Json body = run["bodies"][0];
    const double t = run["time_s"].get<double>() - 1;
    EXPECT_NEAR(body["velocity_m_s"][0].get<double>(), 2 * t, 1e-9);
    EXPECT_NEAR(body["position_m"][0].get<double>(), t * t, 1e-9);
    expect_outcome(tumble({"run", scene("[2.0, 0.0, 0.0]"), "--duration", "1.0"}), 0,
                   "event[0] comes when the last step has been taken");
}

TEST(Events, of_a_scene_set_what_they_say) {
    const std::string events = drone + R"([[event]]
time = 2.0
kind = "pose"
body = "drone"
value = [1.0, 2.0, 3.0]
[[event]]
time = 2.0
kind = "velocity"
body = "drone"
value = [0.0, 0.0, 0.0]
[[event]]
time = 1.0
kind = "force"
body = "drone"
value = [0.0, 19.62, 0.0]
)";
    // From 2 s on it stands still at its new place: a force holds its weight.
    const Json body = json_of({"run", written("hover.toml", events)})["bodies"][0];
    EXPECT_NEAR(body["position_m"][1], 2, 1e-6);
    EXPECT_NEAR(body["position_m"][2], 3, 1e-6);
    EXPECT_NEAR(body["velocity_m_s"][1], 0, 1e-6);
}

TEST(Events, columns_of_the_sensor_follow_the_others) {
    const std::string scene = written("hover.toml", drone + "angular_velocity = [0.0, 2.0, 0.0]\n"),
                      csv = temporary("a.csv"), plain = temporary("b.csv");
    ASSERT_EQ(tumble({"run", scene, "--trajectory", csv, "--imu", "--every", "512"}).status, 0);
    ASSERT_EQ(tumble({"run", scene, "--trajectory", plain, "--every", "512"}).status, 0);
    const auto rows = lines_of(contents(csv)), plain_rows = lines_of(contents(plain));
    ASSERT_EQ(rows.size(), 4u);
    EXPECT_EQ(rows[0], "time_s,body,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz,fx,fy,fz,gx,gy,gz");
    for (std::size_t i = 1; i < rows.size(); ++i) {
        EXPECT_TRUE(rows[i].starts_with(plain_rows[i] + ",")) << "the columns of the contract stay as they are";
        std::vector<double> sensor;
        std::istringstream cells(rows[i].substr(plain_rows[i].size() + 1));
        for (std::string cell; std::getline(cells, cell, ',');) sensor.push_back(std::stod(cell));
        ASSERT_EQ(sensor.size(), 6u);
        // It falls and feels no weight; before the first step it is taken to be held.
        EXPECT_NEAR(sensor[1], i == 1 ? 9.81 : 0, 1e-5);
        EXPECT_NEAR(sensor[0], 0, 1e-5);
        EXPECT_NEAR(sensor[4], 2, 1e-6);
    }
    expect_outcome(tumble({"run", scene, "--imu"}), 0, "warning: --imu has no effect without --trajectory");
}

}  // namespace
}  // namespace tumble::host
