// `tumble advise`: the cheapest integrator, number system and step that keep a scene's error under a tolerance on a
// core. Errors are measured on the host, whose bits are the core's; cycles and instructions are counted on the core in
// QEMU.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <thread>

#include "command/advice.hpp"
#include "command/command.hpp"
#include "firmware/firmware.hpp"
#include "scene/reader.hpp"
#include "tools/files.hpp"
#include "tools/parallel.hpp"
#include "tools/progress.hpp"
#include "tools/text.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {
namespace {

// A longer run is measured up to here: the mean of a step has settled, and an emulation takes seconds.
constexpr std::int64_t most_measured_steps = 16384;

// No method's step costs less than this share of a step of semi-implicit Euler without carry in the same number system.
// That method evaluates every load once and adds to every number of a state once, as all methods do.
constexpr double least_share_of_euler = 0.5;

// Are costs in cycles, or in instructions? Throws std::invalid_argument where cycles are asked for and the core has
// none.
bool ranks_by_cycles(const AdviseOptions& options) {
    const bool known = core_named(options.core).has_cycles();
    const auto refuse = [&](const char* option) {
        throw std::invalid_argument(std::string(option) + ": nothing publishes the cycles of " + options.core +
                                    ", expected a core that has a timing table: " + cores_with_cycles());
    };
    if (!known && options.cost == "cycles") refuse("--cost");
    if (!known && options.clock) refuse("--clock");
    if (!known && options.cost.empty())
        std::cerr << options.core << ": nothing publishes its cycles; costs are in instructions\n";
    return known && options.cost != "insn";
}

// A method in a number system, and the scene that its firmware replays.
struct StepProgram {
    NumberVariant variant;
    std::string integrator;
    SceneDescription scene;
};

// Measures what candidates cost on the core, but for those that cannot be the cheapest.
class Ranking {
public:
    Ranking(const AdviseOptions& options, const Advice& advice, const SampledScene& scene)
        : options_(options), advice_(advice), scene_(scene), struct_(struct_name(scene.with_step(0).path)),
          build_(std::filesystem::path(TUMBLE_SOURCE_DIR) / "build/advise" / options.core / struct_),
          scenes_(made(build_ / "scenes")), lock_(build_), firmware_(build_, options.core, struct_, scenes_, {}, {}) {}

    void fill_in(std::vector<Candidate>& candidates) {
        std::vector<Candidate*> queue, with_useless_carry;
        for (Candidate& c : candidates) {
            const bool is_useless = std::any_of(candidates.begin(), candidates.end(), [&](const Candidate& other) {
                return is_without_carry(other, c) && other.attempt.step >= c.attempt.step;
            });
            (is_useless && !options_.all ? with_useless_carry : queue).push_back(&c);
        }
        if (queue.size() > processors_ && !options_.all) measure_euler(queue);
        std::stable_sort(queue.begin(), queue.end(),
                         [&](const Candidate* a, const Candidate* b) { return least_cost(*a) < least_cost(*b); });
        measure(queue);
        // Of the cheapest method the twin is measured too: a compiler may lay out a step with carry better.
        std::vector<Candidate*> twin;
        for (Candidate* c : with_useless_carry) {
            if (best_ != nullptr && is_without_carry(*best_, *c)) twin.push_back(c);
            else c->not_measured = "carry adds work, and the method keeps the error at no shorter step without it";
        }
        measure(twin);
    }

private:
    [[nodiscard]] static std::filesystem::path made(const std::filesystem::path& directory) {
        std::filesystem::create_directories(directory);
        return directory;
    }

    [[nodiscard]] static bool is_without_carry(const Candidate& plain, const Candidate& carried) {
        const Method &a = plain.attempt.method, &b = carried.attempt.method;
        return !a.carry && b.carry && a.integrator == b.integrator && a.numbers == b.numbers;
    }

    [[nodiscard]] StepProgram program_of(const Method& method, int step) const {
        SceneDescription scene = scene_.with_step(step);
        if (scene.steps() > most_measured_steps)
            scene.duration = static_cast<double>(most_measured_steps) * scene.step.seconds();
        return {variant_of(method.numbers, method.carry), method.integrator, scene};
    }

    // The row of each program by StepFirmware; null where the program does not fit the core's memory. Throws
    // std::runtime_error where a program cannot be built or run, or ends with another state than the host's.
    [[nodiscard]] std::vector<nlohmann::ordered_json> rows_of(const std::vector<StepProgram>& programs) {
        std::vector<std::string> names;
        for (const StepProgram& program : programs) {
            names.push_back(StepFirmware::name_of(program.variant, program.integrator));
            write_if_changed(scenes_ / (names.back() + ".hpp"),
                             compiled_scene(program.scene, Choice{}));  // the firmware has its own method
        }
        firmware_.build(names);
        std::vector<nlohmann::ordered_json> rows(programs.size());
        in_parallel(programs.size(), [&](std::size_t i) {
            const auto& [variant, integrator, scene] = programs[i];
            const std::string name = options_.core + ", " + names[i];
            StepOutcome outcome = firmware_.run(names[i]);
            if (!outcome.shortage.empty()) return;
            if (!outcome.error.empty()) throw std::runtime_error(name + ": " + outcome.error);
            check_state(outcome.row, *make_simulation(scene, integrator, variant.numbers, variant.carry), name);
            rows[i] = std::move(outcome.row);
        });
        return rows;
    }

    // What a step of semi-implicit Euler costs in each number system, at the shortest step of a candidate in it, where
    // a step has the least contacts.
    void measure_euler(const std::vector<Candidate*>& candidates) {
        std::map<std::string, int> shortest;
        for (const Candidate* c : candidates) {
            int& step = shortest.try_emplace(c->attempt.method.numbers, c->attempt.step).first->second;
            step = std::min(step, c->attempt.step);
        }
        std::vector<StepProgram> programs;
        for (const auto& [numbers, step] : shortest)
            programs.push_back(program_of({"semi_implicit_euler", numbers, false}, step));
        const auto rows = rows_of(programs);
        for (std::size_t i = 0; i < rows.size(); ++i)
            if (!rows[i].is_null()) euler_[programs[i].variant.numbers] = advice_.cost_of(rows[i]).mean;
    }
    // A simulated second of the candidate costs at least this.
    [[nodiscard]] double least_cost(const Candidate& candidate) const {
        const auto euler = euler_.find(candidate.attempt.method.numbers);
        return euler == euler_.end() ? 0 : least_share_of_euler * euler->second / candidate.attempt.length.seconds();
    }

    // In waves of as many as the machine has processors.
    void measure(const std::vector<Candidate*>& queue) {
        Progress progress(static_cast<std::int64_t>(queue.size()));
        for (std::size_t i = 0; i < queue.size();) {
            progress.show(static_cast<std::int64_t>(i), std::string(advice_.unit()) + " on " + options_.core);
            std::vector<Candidate*> wave;
            for (; i < queue.size() && wave.size() < processors_; ++i) {
                if (best_ == nullptr || least_cost(*queue[i]) < best_->cost) wave.push_back(queue[i]);
                else
                    queue[i]->not_measured =
                        "costs more than the best even if its step takes half of semi_implicit_euler's";
            }
            measure_wave(wave);
        }
    }
    void measure_wave(const std::vector<Candidate*>& wave) {
        std::vector<StepProgram> programs;
        for (const Candidate* c : wave) programs.push_back(program_of(c->attempt.method, c->attempt.step));
        const auto rows = rows_of(programs);
        for (std::size_t i = 0; i < wave.size(); ++i) {
            Candidate& c = *wave[i];
            c.row = rows[i];
            if (c.row.is_null()) c.not_measured = "does not fit the core's memory";
            else c.cost = advice_.cost_of(c.row).mean / c.attempt.length.seconds();
            if (!c.row.is_null() && (best_ == nullptr || c.cost < best_->cost)) best_ = &c;
        }
    }

    const AdviseOptions& options_;
    const Advice& advice_;
    const SampledScene& scene_;
    std::string struct_;                    // in the headers of the scene
    std::filesystem::path build_, scenes_;  // one header for each program
    DirectoryLock lock_;                    // of the build directory
    StepFirmware firmware_;
    std::map<std::string, double> euler_;  // cost of a step, by number system; empty: not measured
    const Candidate* best_ = nullptr;
    std::size_t processors_ = std::max(1u, std::thread::hardware_concurrency());
};

std::vector<Method> chosen_methods(const AdviseOptions& options, const SceneDescription& scene) {
    for (const std::string& integrator : options.integrators) (void)find_integrator(integrator);
    for (const std::string& numbers : options.numbers) {
        (void)find_number_system(scene, numbers, {});
        require_range(scene, numbers);
    }
    if (scene.range.beyond_default)
        std::cerr << "warning: fixed point is left out: " << scene.range.beyond_default->what() << "\n";
    const auto is_chosen = [](const std::vector<std::string>& list, const std::string& name) {
        return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
    };
    std::vector<Method> methods;
    for (const IntegratorInfo& integrator : integrators()) {
        for (const NumberVariant& variant : number_variants()) {
            if (is_chosen(options.integrators, integrator.name) && is_chosen(options.numbers, variant.numbers) &&
                runs_in(integrator, variant.numbers) && has_range_for(scene, variant.numbers))
                methods.push_back({integrator.name, variant.numbers, variant.carry});
        }
    }
    if (methods.empty())
        throw std::invalid_argument("none of these integrators runs in these number systems; `tumble list` says why");
    return methods;
}

std::vector<Attempt> search(const std::vector<Method>& methods, double tolerance, const SampledScene& scene,
                            const Truth& truth) {
    std::vector<std::optional<Attempt>> found(methods.size());
    Progress progress(static_cast<std::int64_t>(methods.size()));
    in_parallel(methods.size(), [&](std::size_t i) {
        found[i] = longest_step_within(tolerance, scene, truth, methods[i]);
        progress.step("errors on the host");
    });
    std::vector<Attempt> attempts;
    for (const auto& attempt : found)
        if (attempt) attempts.push_back(*attempt);
    return attempts;
}

// Searches and measures; fills in what the advice is.
void find_advice(const AdviseOptions& options, const std::vector<Method>& methods, const SampledScene& scene,
                 Advice& advice) {
    const std::string tolerance = few_digits(options.tolerance);
    const double doubt = advice.truth.doubt.largest();
    if (doubt > options.tolerance / 10) {
        advice.message = "the scene is chaotic: there is no reference for an error of " + tolerance +
                         ", since two fine runs differ by " + few_digits(doubt) +
                         ", expected at most a tenth of the tolerance; take a larger one or a shorter --duration";
        return;
    }
    std::vector<Candidate> candidates;
    for (const Attempt& attempt : search(methods, options.tolerance, scene, advice.truth)) {
        if (attempt.error() > options.tolerance) advice.unreached.push_back(attempt);
        else candidates.push_back({attempt, {}, 0, {}});
    }
    std::sort(advice.unreached.begin(), advice.unreached.end(),
              [](const Attempt& a, const Attempt& b) { return a.error() < b.error(); });
    if (!candidates.empty()) Ranking(options, advice, scene).fill_in(candidates);
    for (Candidate& c : candidates) (c.row.is_null() ? advice.not_measured : advice.ranking).push_back(std::move(c));
    std::stable_sort(advice.ranking.begin(), advice.ranking.end(),
                     [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
    if (!advice.ranking.empty()) return;
    if (!advice.not_measured.empty()) {
        advice.message = "what keeps the error under " + tolerance + " does not fit " + options.core + "'s memory";
        return;
    }
    advice.message = "nothing keeps the error under " + tolerance;
    if (!advice.unreached.empty())
        advice.message +=
            "; the closest is " + name_of(advice.unreached.front()) + " with " + closest_text(advice.unreached.front());
}

int advise(const AdviseOptions& options) {
    check_core(options.core);
    if (!core_named(options.core).has_insn())
        throw std::invalid_argument("--core: got \"" + options.core +
                                    "\", expected a core whose instructions are counted");
    Advice advice{ranks_by_cycles(options), {}, {}, {}, {}, {}};
    Choice choice;
    choice.scene = options.scene;
    choice.duration = options.duration;
    const SceneDescription scene = choice.read();
    const SampledScene sampled(scene);
    const std::vector<Method> methods = chosen_methods(options, scene);
    advice.truth = truth_of(sampled);
    find_advice(options, methods, sampled, advice);
    const SceneDescription searched = sampled.with_step(sampled.longest());
    if (options.json) print_json(options, searched, advice);
    else print_table(options, searched, advice);
    if (!advice.message.empty()) std::cerr << scene.path << ": " << advice.message << "\n";
    return advice.message.empty() ? done : failed;
}

constexpr const char* footer =
    "The error is the largest over 20 equally spaced times and all bodies, of positions in m and of orientations in "
    "rad, against\nan integration in long double; with contacts, against two fine runs in double precision that must "
    "agree to a tenth of E.\nThe cost is of a simulated second: cycles of the core at zero wait states, as its manual "
    "has them, or\ninstructions. Steps are the scene's times powers of two, at which every event keeps its time. Each "
    "method that\nis measured is built for the core; narrow the search to shorten that.\n"
    "Exit status: 0 something reaches E, 1 nothing does, 2 bad input.";

// A frequency, which is then in Hz. A small number without a unit was meant in MHz.
bool read_frequency(std::string& text) {
    constexpr double least_without_unit = 1000;  // Hz
    const std::optional<double> hertz = parse_frequency(text);
    if (!hertz || (*hertz < least_without_unit && !text.ends_with("Hz"))) return false;
    text = seventeen_digits(*hertz);
    return true;
}

}  // namespace

void add_advise(CommandLine& line) {
    const auto options = std::make_shared<AdviseOptions>();
    Subcommand command = line.add(
        "advise", "measure which integrator, number system and step keep an error at the least cost on a core",
        [=] { return advise(*options); }, footer);
    command.require(options->scene, "scene SCENE.toml", "scene file (TOML), or - for standard input", input_file());
    command.require(options->core, "--core NAME", "a core of `tumble list`");
    command.require(options->tolerance, "--tolerance E", "the largest error, in m and in rad",
                    positive("of metres and of radians"));
    command.add(options->integrators, "--integrators NAME,...", "search only these; see `tumble list`");
    command.add(options->numbers, "--numbers q32,f32,f64", "search only these number systems");
    command.add(options->duration, "--duration T", "length of the run in s, instead of the scene's", duration());
    command.add(options->cost, "--cost cycles|insn",
                "what to rank by; default: cycles, or instructions on a core whose cycles are not published",
                one_of("cycles", "insn"));
    command.add(
        options->clock, "--clock F",
        "clock of the core, as 16MHz: say what share of a step's time its mean cost and its worst step take",
        {"a positive frequency, as 16MHz, \"32.768 kHz\" or 48e6 (Hz); below 1000 with its unit", read_frequency});
    command.add(options->all, "--all", "measure also what cannot be the cheapest");
    command.add(options->json, "--json", "print one JSON object");
}

}  // namespace tumble::host
