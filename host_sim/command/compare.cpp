// `tumble compare`: builds the record firmware of a scene, runs it in QEMU, and compares every state that it writes
// with the host's state at the same step.
#include <tumble/status.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <sstream>

#include "command/check.hpp"
#include "command/command.hpp"
#include "firmware/firmware.hpp"
#include "tools/files.hpp"
#include "tools/process.hpp"
#include "tools/text.hpp"
#include "verdict/record.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;

struct CompareOptions : Choice {
    std::string core;
    std::int64_t every = 1;            // steps between recorded states
    std::optional<std::int64_t> flip;  // self-test: one bit of the host's record is flipped at this step
    int timeout = 600;                 // s of emulation
    CheckOptions check;
};

fs::path build_firmware(const CompareOptions& options, const SceneDescription& scene, const fs::path& build) {
    fs::create_directories(build / "scene");
    write_if_changed(build / "scene/scene.hpp", compiled_scene(scene, options));
    write_if_changed(build / "scene/recording.hpp",
                     "// Written by `tumble compare`: which steps the firmware records.\n#pragma once\n\n#include "
                     "\"scene.hpp\"\n\nusing RecordedScene = tumble::scenes::" +
                         struct_name(scene.path) + ";\ninline constexpr std::uint32_t record_every = " +
                         std::to_string(std::min<std::int64_t>(options.every, 0xffffffff)) + "u;\n");
    return build_record_firmware(build, options.core, build / "scene");
}

// The names of the issues so far, in the kernel's order, each followed by a space.
std::string status_text(const Simulation& simulation) {
    std::string text;
    for (const Issue issue : all_issues)
        if (simulation.has_trouble(name_of(issue))) text += std::string(name_of(issue)) + " ";
    return text;
}

// The host's run of the scene, which goes on from one recorded state to the next.
class Reference {
public:
    Reference(const CompareOptions& options, const SceneDescription& scene)
        : options_(options), scene_(scene), simulation_(options.start(scene)),
          recorder_(scene, *simulation_, moments_of(scene)) {}

    [[nodiscard]] bool at_end() const {
        return simulation_->steps_taken() >= simulation_->steps() || simulation_->has_trouble("range_left");
    }
    [[nodiscard]] bool is_over() const { return is_over_; }
    [[nodiscard]] std::int64_t states() const { return states_; }
    [[nodiscard]] const Simulation& simulation() const { return *simulation_; }
    [[nodiscard]] Record record() && { return std::move(recorder_).record(*simulation_); }

    // Compares the next recorded state with a line "step word word ..." in hex. Prints the first difference.
    [[nodiscard]] bool agrees(const std::string& line) {
        std::istringstream fields(line);
        std::uint64_t step = 0;
        fields >> std::hex >> step;
        std::vector<std::uint32_t> core_words, words;
        for (std::uint32_t word = 0; fields >> word;) core_words.push_back(word);
        words.reserve(core_words.size());
        simulation_->append_words(words);
        const auto now = static_cast<std::uint64_t>(simulation_->steps_taken());
        if (options_.flip && static_cast<std::uint64_t>(*options_.flip) == now) words[0] ^= 1u;
        if (step != now || words.size() != core_words.size()) {
            report("recorded step " + std::to_string(step) + " with " + std::to_string(core_words.size()) +
                   " words, expected step " + std::to_string(now) + " with " + std::to_string(words.size()));
            return false;
        }
        const auto differing = std::mismatch(words.begin(), words.end(), core_words.begin()).first;
        if (differing != words.end()) {
            const auto place = simulation_->place_of_word(static_cast<std::size_t>(differing - words.begin()));
            report("body \"" + scene_.bodies[static_cast<std::size_t>(place.body)].name + "\", " + place.number +
                   ": host " + number(words, place) + ", " + options_.core + " " + number(core_words, place));
            return false;
        }
        ++states_;
        advance();
        return true;
    }
    void report(const std::string& what) const {
        std::cout << options_.core << " differs at step " << simulation_->steps_taken() << " ("
                  << few_digits(simulation_->time()) << " s): " << what << "; " << states_
                  << " states before it agree\n";
        const auto shown = [](const std::string& status) { return status.substr(0, status.find_last_not_of(' ') + 1); };
        if (const std::string host_status = status_text(*simulation_); !core_status.empty() || !host_status.empty())
            std::cout << "status of " << options_.core << ": " << (core_status.empty() ? "ok" : shown(core_status))
                      << "; of the host: " << (host_status.empty() ? "ok" : shown(host_status)) << "\n";
        if (core_status.find(name_of(Issue::contacts_full)) != std::string::npos)
            std::cout << "the firmware has room for fewer pairs near each other than the scene has at this time; a "
                         "Config with a larger near_pairs has more\n";
    }

    std::string core_status;  // its issues so far, each followed by a space

private:
    // The words of one number, the highest first.
    [[nodiscard]] static std::string number(const std::vector<std::uint32_t>& words, const Simulation::Place& place) {
        std::string text = "0x";
        for (std::size_t i = place.count; i-- > 0;) text += hex(words[place.first + i]).substr(8);
        return text;
    }
    // Goes on to the next recorded step: every K-th, and the last.
    void advance() {
        if (at_end()) {
            is_over_ = true;
            return;
        }
        do {
            simulation_->step();
            recorder_.see(*simulation_);
        } while (!at_end() && simulation_->steps_taken() % options_.every != 0);
    }

    const CompareOptions& options_;
    const SceneDescription& scene_;
    std::unique_ptr<Simulation> simulation_;
    Recorder recorder_;
    std::int64_t states_ = 0;
    bool is_over_ = false;
};

int compare(const CompareOptions& options) {
    check_core(options.core);
    const SceneDescription scene = options.read();
    if (options.flip && (*options.flip < 0 || *options.flip > scene.steps() ||
                         (*options.flip % options.every != 0 && *options.flip != scene.steps())))
        throw std::invalid_argument("--flip: got " + std::to_string(*options.flip) +
                                    ", expected a step that is recorded: a multiple of --every, up to " +
                                    std::to_string(scene.steps()));
    const fs::path build = fs::path(TUMBLE_SOURCE_DIR) / "build/compare" / options.core;
    fs::create_directories(build);
    const DirectoryLock lock(build);
    Reference reference(options, scene);
    const fs::path firmware = build_firmware(options, scene, build);

    Process core = run_in_qemu(options.core, firmware, options.timeout);
    std::string last_line;
    for (std::string line; core.read_line(line);) {
        if (line.starts_with("state ")) {
            if (reference.is_over()) return reference.report("a state after the last"), failed;
            if (!reference.agrees(line.substr(6))) return failed;
        } else if (line.starts_with("status ")) {
            reference.core_status = line.substr(7);
        } else if (line.starts_with("end ")) {
            last_line = line.substr(4);
        } else {
            std::cerr << options.core << ": " << line << "\n";
        }
    }
    if (const int status = core.wait(); status != 0 || !reference.is_over()) {
        std::cout << options.core << " ended with status " << status << " after " << reference.states()
                  << " states that agree\n";
        return failed;
    }
    const std::string expected = status_text(reference.simulation()) + hex(reference.simulation().hash());
    if (last_line != expected) {
        std::cout << options.core << " ended with \"" << last_line << "\", the host with \"" << expected << "\"\n";
        return failed;
    }
    std::cout << options.core << " agrees with the host: " << reference.states() << " states, "
              << reference.simulation().integrator() << ", " << reference.simulation().numbers() << ", hash "
              << hex(reference.simulation().hash()) << "\n";
    const Verdict verdict =
        options.check.verdict(scene, method_of(reference.simulation()), std::move(reference).record());
    std::cout << verdict_line(options.check, verdict, scene, reference.simulation());
    const int status = report(verdict, scene, reference.simulation());
    return options.is_as_expected(scene, reference.simulation()) ? status : failed;
}

}  // namespace

void add_compare(CommandLine& line) {
    const auto options = std::make_shared<CompareOptions>();
    Subcommand command =
        line.add("compare", "replay a scene on a core in QEMU and on the host, and compare every recorded bit",
                 [=] { return compare(*options); });
    options->add_to(command);
    command.require(options->core, "--core NAME", "a core of `tumble list`");
    command.add(options->every, "--every K", "steps between recorded states", at_least(1, "steps"));
    command.add(options->timeout, "--timeout S", "seconds that the emulation may take", at_least(1, "seconds"));
    options->check.add_to(command);
    command.add(options->flip, "--flip STEP",
                "self-test: flip one bit of the host's record at this step; the comparison must report it",
                at_least(0, "steps"));
}

}  // namespace tumble::host
