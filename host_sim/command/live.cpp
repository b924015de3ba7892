#include "command/live.hpp"

#include <algorithm>
#include <iostream>
#include <optional>
#include <stdexcept>

#include "command/check.hpp"
#include "scene/json_event.hpp"
#include "scene/writer.hpp"
#include "tools/files.hpp"
#include "verdict/record.hpp"

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
void write_state(const Simulation& simulation, const SceneDescription& scene) {
    std::string status, bodies;
    for (const Trouble& trouble : simulation.troubles())
        status += (status.empty() ? "" : ", ") + json_text(trouble.issue);
    for (int b = 0; b < simulation.body_count(); ++b) bodies += (b > 0 ? ", " : "") + body_text(simulation, scene, b);
    std::cout << "{\"step\": " << simulation.steps_taken() << ", \"time_s\": " << json_number(simulation.time())
              << ", \"state_hash\": " << json_text(hex(simulation.hash())) << ", \"status\": [" << status
              << "], \"bodies\": [" << bodies << "]}" << std::endl;
}

// Takes steps until the scene ends or a body leaves its range.
bool goes_on(const Simulation& simulation) {
    return simulation.steps_taken() < simulation.steps() && !simulation.has_trouble("range_left");
}

}  // namespace

int run_live(const Choice& choice, const std::string& record) {
    if (choice.scene == "/dev/stdin")
        throw std::invalid_argument("scene: got standard input, from which --live reads events, expected a file");
    check_outputs({{"the scene", choice.scene}}, {{"--record", record}});
    const SceneDescription scene = choice.read();
    const auto simulation = choice.start(scene);
    std::optional<OutputFile> file;
    if (!record.empty()) {
        file.emplace(record, "--record");
        file->stream() << contents_of(choice.scene);
    }
    write_state(*simulation, scene);
    std::string text;
    for (int line = 1; goes_on(*simulation) && std::getline(std::cin, text); ++line) {
        if (std::all_of(text.begin(), text.end(), [](char c) { return c == ' ' || c == '\t' || c == '\r'; })) continue;
        const LiveLine wanted = read_live_line(text, line, scene);
        if (const auto* event = std::get_if<EventDescription>(&wanted)) {
            simulation->apply(*event);
            if (!file) continue;
            EventDescription timed = *event;
            timed.time = static_cast<double>(simulation->steps_taken()) * scene.step.seconds();
            file->stream() << event_text(timed, scene);
        } else {
            for (std::int64_t i = 0; i < std::get<StepsWanted>(wanted).count && goes_on(*simulation); ++i) {
                simulation->step();
                write_state(*simulation, scene);
            }
        }
    }
    if (file) file->commit();
    Record told;
    told.troubles = simulation->troubles();
    return report(told_by(told, scene), scene, *simulation);
}

}  // namespace tumble::host
