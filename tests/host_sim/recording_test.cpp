// What the command writes it reads: recordings of live runs, sessions of the page and whole scenes, with all kinds of
// events on all kinds of bodies, in all number systems.
#include <algorithm>
#include <array>
#include <random>

#include "command_runner.hpp"
#include "page/session.hpp"
#include "scene/reader.hpp"
#include "scene/writer.hpp"
#include "simulation/simulation.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

constexpr std::array kinds{EventKind::impulse,  EventKind::angular_impulse,  EventKind::force,
                           EventKind::torque,   EventKind::step_force,       EventKind::step_torque,
                           EventKind::velocity, EventKind::angular_velocity, EventKind::pose,
                           EventKind::gravity};
// All but the removal of a body, and those of [[force]].
static_assert(kinds.size() == static_cast<std::size_t>(EventKind::gravity) - 4, "a scene has these kinds");

constexpr std::array bodies_of_all_kinds{
    "shape = \"none\"\nmass = 0.5\n",
    "shape = \"none\"\nmass = 0.5\nfixed = true\n",
    "shape = \"none\"\nmass = 2.0\nkinematic = true\n",
    "shape = \"none\"\nmass = 0.7\ninertia = [0.1, 0.2, 0.25]\n",
    "shape = { box = [0.3, 0.4, 0.5] }\nmass = 1.0\n",
    "shape = { box = [0.4, 0.2, 0.3] }\ndensity = 500.0\ninertia = [0.2, 0.3, 0.25, 0.01, 0.02, 0.0]\n",
    "shape = { box = [0.3, 0.3, 0.3] }\nfixed = true\n",
    "shape = { box = [0.3, 0.2, 0.3] }\nkinematic = true\nangular_velocity = [0.0, 1.0, 0.0]\n",
    "shape = { sphere = 0.2 }\nmass = 0.8\nrestitution = 0.5\n",
    "shape = { cylinder = [0.2, 0.3] }\nmass = 0.8\nwheel_momentum = [0.0, 0.01, 0.0]\n",
    "shape = { hoop = 0.2 }\nmass = 0.3\nlinear_drag = 0.01\n",
    "shape = { capsule = [0.1, 0.4] }\nmass = 0.9\nquadratic_drag = 0.02\n",
    "shape = { points = [[0.1, 0, 0, 0.5], [-0.1, 0, 0, 0.5], [0, 0.2, 0, 0.3], [0, 0, 0.1, 0.2]] }\n",
};

// A scene, and a controller of it.
class Story {
public:
    explicit Story(unsigned seed) : random_(seed) {
        const auto count = 1 + random_() % 4;
        std::string text = "[world]\nstep = \"1/128\"\nduration = 1.0\ngravity = [0.0, -9.81, 0.0]\n[range]\n"
                           "position = 64.0\nvelocity = 32.0\nangular_velocity = 32.0\n";
        const bool has_floor = random_() % 2 == 0;
        if (has_floor) text += "[contact]\nrestitution = 0.3\nfriction = 0.4\n" + floor_plane + "offset = 2.0\n";
        for (unsigned b = 0; b < count; ++b)
            text += "[[body]]\nname = \"b" + std::to_string(b) + "\"\nposition = [" + std::to_string(3 * b) +
                    ".0, 1.0, 0.0]\n" + bodies_of_all_kinds[random_() % bodies_of_all_kinds.size()];
        for (unsigned b = 0; b < count; ++b)
            if (random_() % 3 == 0)
                text += "[[impulse]]\ntime = 0.25\nbody = \"b" + std::to_string(b) + "\"\nimpulse = [0.1, 0.2, 0.0]\n";
        bare_ = read_scene_text(text, "bare.toml");
        std::string events;
        const bool is_inline = random_() % 3 == 0;
        for (unsigned i = 0; i < random_() % 4; ++i) {
            EventDescription event = any_event();
            // Some at the steps of the controller.
            event.time = static_cast<double>(random_() % 100) / 128 + (random_() % 4 == 0 ? 0.3 / 128 : 0);
            events += is_inline ? (events.empty() ? "" : ", ") + as_inline(event) : event_text(event, bare_);
        }
        text_ = is_inline && !events.empty() ? "event = [" + events + "]\n" + text : text + events;
        for (int lines = 0, steps = 0; lines < 12 && steps < 100; ++lines) {
            for (unsigned i = random_() % 4; i > 0; --i) input_ += json(any_event()).dump() + "\n";
            const int taken = 1 + static_cast<int>(random_() % 12);
            steps += taken;
            input_ += R"({"step": )" + std::to_string(taken) + (random_() % 2 == 0 ? "" : ".0") + "}\n";
        }
        numbers_ = std::array{"q32", "f32", "f64"}[random_() % 3];
        if (random_() % 3 == 0) options_ = {"--step", "1/64", "--duration", "2.5"};
    }
    [[nodiscard]] const std::string& text() const { return text_; }
    [[nodiscard]] const std::string& input() const { return input_; }
    [[nodiscard]] const std::string& numbers() const { return numbers_; }
    [[nodiscard]] const std::vector<std::string>& options() const { return options_; }

private:
    double number(double most) { return std::uniform_real_distribution(-most, most)(random_); }
    Triple triple(double most) { return {number(most), number(most), number(most)}; }

    EventDescription any_event() {
        EventDescription event;
        event.body = static_cast<int>(random_() % bare_.bodies.size());
        const BodyDescription& body = bare_.body(event.body);
        do event.kind = kinds[random_() % kinds.size()];
        while (body.is_point_mass() && turns(event.kind));
        event.value = triple(event.kind == EventKind::velocity ? 3 : event.kind == EventKind::step_force ? 5 : 0.3);
        if (!has_body(event.kind)) {
            event.body = -1;
            event.value = {number(3), number(3) - 9, number(3)};
            return event;
        }
        if (event.kind == EventKind::pose)
            for (std::size_t i = 0; i < 3; ++i) event.value[i] += body.position[i];
        if (body.is_point_mass()) return event;
        if (event.kind == EventKind::pose) event.orientation = {1 + number(0.5), number(1), number(1), number(1)};
        else if (random_() % 2 == 0) event.frame = Frame::body;
        if (!turns(event.kind) && event.kind != EventKind::velocity && event.kind != EventKind::pose &&
            random_() % 2 == 0)
            event.point = triple(0.1);
        return event;
    }
    static bool turns(EventKind kind) {
        return kind == EventKind::angular_impulse || kind == EventKind::torque || kind == EventKind::step_torque ||
               kind == EventKind::angular_velocity;
    }
    [[nodiscard]] Json json(const EventDescription& event) const {
        Json line = {{"kind", name_of(event.kind)}, {"value", event.value}};
        if (has_body(event.kind)) line["body"] = bare_.body(event.body).name;
        if (event.frame == Frame::body) line["frame"] = "body";
        if (event.point != Triple{}) line["point"] = event.point;
        if (event.kind == EventKind::pose && !bare_.body(event.body).is_point_mass())
            line["orientation"] = event.orientation;
        return line;
    }
    [[nodiscard]] std::string as_inline(const EventDescription& event) const {
        std::string table = "{ time = " + std::to_string(event.time);
        const Json members = json(event);
        for (const auto& [key, value] : members.items()) table += ", " + key + " = " + value.dump();
        return table + " }";
    }

    std::mt19937 random_;
    SceneDescription bare_;  // without events
    std::string text_, input_, numbers_;
    std::vector<std::string> options_;
};

class Recorded : public testing::TestWithParam<unsigned> {};

TEST_P(Recorded, live_run_replays_to_the_same_hash) {
    const Story story(GetParam());
    const std::string scene = written("scene.toml", story.text()), record = temporary("record.toml");
    std::vector<std::string> live{TUMBLE_COMMAND, "run",           scene,      "--live",
                                  "--numbers",    story.numbers(), "--record", record};
    live.insert(live.end(), story.options().begin(), story.options().end());
    Process process(live, story.input(), Process::Errors::keep);
    std::string states;
    const int status = process.wait(&states);
    ASSERT_TRUE(status == 0 || status == 1) << process.errors() << story.text() << story.input();
    const Json last = Json::parse(lines_of(states).back());
    // The last line of the controller is the end of the recording.
    const std::string duration = seventeen_digits(last["time_s"].get<double>());
    const Outcome replay =
        tumble({"run", record, "--numbers", story.numbers(), "--duration", duration, "--json"}, Process::Errors::keep);
    EXPECT_EQ(replay.status, status) << replay.text << contents(record);
    const Json again = Json::parse(replay.text);
    EXPECT_EQ(again["steps"], last["step"]) << contents(record);
    EXPECT_EQ(again["state_hash"], last["state_hash"]) << contents(record);
    EXPECT_EQ(again["status"], last["status"]) << contents(record);
}

TEST_P(Recorded, scene_that_is_written_anew_is_the_same) {
    const SceneDescription scene = read_scene_text(Story(GetParam()).text(), "scene.toml");
    const std::string text = scene_text(scene);
    const SceneDescription again = read_scene_text(text, "again.toml");
    EXPECT_EQ(scene_text(again), text);
    EXPECT_EQ(finish(*make_simulation(again)), finish(*make_simulation(scene))) << text;
}

TEST_P(Recorded, session_of_the_page_is_read_again_with_all_its_hits) {
    std::mt19937 random(GetParam());
    const auto any = [&] {
        Triple triple;
        for (double& x : triple) x = std::uniform_real_distribution(-0.2, 0.2)(random);
        return triple;
    };
    Session session(Story(GetParam()).text(), "scene.toml");
    session.add({"verlet", "q32"});
    std::int64_t step = 0;
    for (int i = 0; i < 8; ++i) {
        const int body = static_cast<int>(random() % session.scene().bodies.size());
        // The page gives a place on the body to each hit, and any frame.
        session.hit({0, body, i % 2 == 0 ? Frame::body : Frame::world, any(), any(), {}});
        session.go_to(0, step += 1 + static_cast<int>(random() % 8), 1 << 30);
    }
    const std::string text = session.text();
    const Session again(text, "saved.toml");
    EXPECT_EQ(again.saved_steps(), step);
    // A hit that waits for an event of the scene acts later.
    const auto acted =
        std::count_if(session.hits().begin(), session.hits().end(), [&](const Hit& hit) { return hit.step < step; });
    EXPECT_EQ(again.hits().size(), static_cast<std::size_t>(acted)) << text;
    EXPECT_EQ(again.scene().events.size(), session.scene().events.size()) << text;
}

INSTANTIATE_TEST_SUITE_P(Quick, Recorded, testing::Range(0U, 8U));
INSTANTIATE_TEST_SUITE_P(Deep, Recorded, testing::Range(8U, 220U));

// Without a declared range, and with one that an expectation follows.
TEST(Recording, keeps_the_scene_as_it_was_but_for_its_ending) {
    const std::string scene = written("scene.toml",
                                      contents(shipped("cube")) +
                                          "\n[expect]\nintegrator = \"verlet\"\nnumbers = \"q32\"\nsteps = 4\n"
                                          "tumble_bits = 1\nhash = \"0123456789abcdef\"\n"),
                      record = temporary("record.toml");
    Process process({TUMBLE_COMMAND, "run", scene, "--live", "--record", record}, "{\"step\": 5000}\n",
                    Process::Errors::keep);
    EXPECT_EQ(process.wait(), 0);
    EXPECT_TRUE(contents(record).starts_with(contents(shipped("cube"))));
    EXPECT_FALSE(has(contents(record), "[expect]"));
    EXPECT_EQ(tumble({"run", record, "--check", "off"}).status, 0);
}

TEST(Recording, written_anew_declares_no_range_that_its_scene_does_not) {
    for (const std::string name : {"brick", "stone"}) {
        SceneDescription scene = read_scene_text(contents(shipped(name)), name);
        scene.range = {};
        scene.bodies[0].position[0] = 1e5;  // beyond the range that fixed point has without one
        const SceneDescription again = read_scene_text(scene_text(scene), "again.toml");
        EXPECT_FALSE(again.range.is_declared);
        EXPECT_EQ(again.bodies[0].position[0], 1e5);
    }
}

}  // namespace
}  // namespace tumble::host
