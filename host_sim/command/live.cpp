#include "command/live.hpp"

#include <algorithm>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "command/check.hpp"
#include "command/run_watch.hpp"
#include "scene/data.hpp"
#include "scene/edit.hpp"
#include "scene/json_event.hpp"
#include "scene/toml.hpp"
#include "scene/writer.hpp"
#include "tools/files.hpp"

namespace tumble::host {
namespace {

std::string body_text(const Simulation& simulation, const SceneDescription& scene, int b) {
    const BodySnapshot body = simulation.body(b);
    const ImuSnapshot imu = simulation.imu(b);
    return "{" + json_of_motion(scene.body(b).name, body, ", ") +
           ", \"specific_force_m_s2\": " + json_array(imu.specific_force) +
           ", \"mean_angular_velocity_rad_s\": " + json_array(imu.angular_velocity) +
           ", \"asleep\": " + (body.asleep ? "true" : "false") + ", \"contacts\": " + std::to_string(body.contacts) +
           "}";
}

// Flushed: the controller waits for it.
void write_state(const Simulation& simulation, const SceneDescription& scene, const RunWatch& watch) {
    std::string status, bodies, joints;
    for (const Trouble& trouble : watch.troubles()) status += (status.empty() ? "" : ", ") + json_text(trouble.issue);
    for (int b = 0; b < simulation.body_count(); ++b) bodies += (b > 0 ? ", " : "") + body_text(simulation, scene, b);
    for (std::size_t j = 0; j < scene.joints.size(); ++j)
        joints += (j > 0 ? ", {" : "], \"joints\": [{") +
                  json_of_joint(scene.joints[j], simulation.joint(static_cast<int>(j)), ", ") + "}";
    std::cout << "{\"step\": " << simulation.steps_taken() << ", \"time_s\": " << json_number(simulation.time())
              << ", \"state_hash\": " << json_text(hex(simulation.hash())) << ", \"status\": [" << status
              << "], \"bodies\": [" << bodies << joints << "]}" << std::endl;
}

// The events of the scene itself, each applied before its step and, as in a recording, before those of the controller.
class OwnEvents {
public:
    explicit OwnEvents(const SceneDescription& scene) {
        const SceneData data = build_scene(scene);
        for (std::size_t i = 0; i < scene.events.size(); ++i)  // rounded to steps as a world does
            events_.emplace_back((data.events[i].time / data.step.value).to_fixed(0, 64), scene.events[i]);
        std::stable_sort(events_.begin(), events_.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
    }
    void apply_to(Simulation& simulation) {
        for (; next_ < events_.size() && events_[next_].first <= simulation.steps_taken(); ++next_)
            simulation.apply(events_[next_].second);
    }

private:
    std::vector<std::pair<std::int64_t, EventDescription>> events_;
    std::size_t next_ = 0;
};

// The scene as it was run, and the events of the controller. The text of the file stays as it is but for the step and
// the duration, where they were others, and for how another run of it ended.
std::string recording_of(const Choice& choice, const SceneDescription& scene, bool has_own_duration,
                         const std::vector<EventDescription>& events) {
    std::string text = without_expectation(contents_of(choice.scene)), added;
    if (!choice.step.empty())
        text =
            with_value(text, "world", "step",
                       scene.step.denominator == 0 ? cpp_number(scene.step.decimal) : json_text(step_text(scene.step)));
    if (!has_own_duration) text = with_value(text, "world", "duration", cpp_number(readable_duration(scene)));
    if (!text.ends_with('\n')) text += '\n';
    for (const EventDescription& event : events) added += event_text(event, scene);
    // Events in an inline array take no more of them: then all is written anew.
    const toml::parse_result whole = toml::parse(text + added);
    const toml::array* const list = whole ? whole["event"].as_array() : nullptr;
    if (whole && (list == nullptr ? 0 : list->size()) == scene.events.size() + events.size()) return text + added;
    SceneDescription anew = scene;
    anew.duration = readable_duration(scene);
    anew.expected.reset();
    return scene_text(anew) + added;
}

}  // namespace

int run_live(const Choice& choice, const std::string& record) {
    if (choice.scene == "/dev/stdin")
        throw std::invalid_argument("scene: got standard input, from which --live reads events, expected a file");
    check_outputs({{"the scene", choice.scene}}, {{"--record", record}});
    const SceneDescription scene = choice.read();
    SceneDescription without_events = scene;
    without_events.events.clear();
    const auto simulation = choice.start(without_events);
    std::optional<OutputFile> file;
    if (!record.empty()) file.emplace(record, "--record");
    OwnEvents own(scene);
    std::vector<EventDescription> events;
    RunWatch watch(scene, *simulation);
    write_state(*simulation, scene, watch);
    own.apply_to(*simulation);
    std::string text;
    for (int line = 1; !watch.is_over() && std::getline(std::cin, text); ++line) {
        if (std::all_of(text.begin(), text.end(), [](char c) { return c == ' ' || c == '\t' || c == '\r'; })) continue;
        const LiveLine wanted = read_live_line(text, line, scene);
        if (const auto* event = std::get_if<EventDescription>(&wanted)) {
            simulation->apply(*event);
            if (!file) continue;
            events.push_back(*event);
            events.back().time = static_cast<double>(simulation->steps_taken()) * scene.step.seconds();
        } else {
            for (std::int64_t i = 0; i < std::get<StepsWanted>(wanted).count && !watch.is_over(); ++i) {
                simulation->step();
                watch.see();
                write_state(*simulation, scene, watch);
                own.apply_to(*simulation);
            }
        }
    }
    if (file) {
        // A recording ends where the run did, unless nothing was run.
        SceneDescription run = scene;
        const bool is_whole = simulation->steps_taken() == 0 || simulation->steps_taken() == simulation->steps();
        if (!is_whole) run.duration = static_cast<double>(simulation->steps_taken()) * scene.step.seconds();
        file->stream() << recording_of(choice, run, is_whole && !choice.duration, events);
        file->commit();
    }
    Record told;
    told.troubles = watch.troubles();
    return report(told_by(told, scene), scene, *simulation);
}

}  // namespace tumble::host
