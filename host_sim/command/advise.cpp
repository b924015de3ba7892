// `tumble advise`: the cheapest integrator, number system and step that keep a scene's error under a tolerance on a
// core. Errors are measured on the host, whose bits are the core's; cycles and instructions are counted on the core in
// QEMU.
#include <tumble/version.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <map>

#include "command/command.hpp"
#include "firmware/cost.hpp"
#include "firmware/firmware.hpp"
#include "scene/reader.hpp"
#include "tools/files.hpp"
#include "tools/parallel.hpp"
#include "tools/progress.hpp"
#include "tools/text.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct AdviseOptions {
    std::string scene, core;
    double tolerance = 0;                           // of positions in m and of orientations in rad
    std::optional<double> duration;                 // s; empty: the file's
    std::vector<std::string> integrators, numbers;  // to search; empty: all
    std::string cost;             // "cycles", "insn", or empty: cycles where the core has a timing table
    std::optional<double> clock;  // Hz: what share of a step's time it takes
    bool all = false;             // measure also what cannot be the cheapest
    bool json = false;
};

// Longer runs are measured up to here: the mean of a step has settled, and an emulation takes seconds.
constexpr std::int64_t most_measured_steps = 16384;

// A step adds to each of the three numbers of a place.
constexpr int least_insn_per_body = 3;

// The most that carry may save. It adds work, but the compiler may have laid out the rest of the step better.
constexpr double most_saved_by_carry = 0.05;

// A method that reaches the tolerance, at its longest step that does.
struct Candidate {
    Attempt attempt;
    NumberVariant variant;
    Json row;                  // of the firmware; null until it is measured
    double cost = 0;           // of a simulated second, cycles or instructions
    std::string not_measured;  // why

    [[nodiscard]] bool waits() const { return row.is_null() && not_measured.empty(); }
    [[nodiscard]] bool is_measured() const { return !row.is_null(); }
};

Json json_of(const Attempt& attempt) {
    Json json;
    json["integrator"] = attempt.method.integrator;
    json["numbers"] = attempt.method.numbers;
    json["carry"] = attempt.method.carry;
    json["step_s"] = attempt.length.seconds();
    json["position_error_m"] = attempt.failure.empty() ? Json(attempt.errors.position_m) : Json();
    json["orientation_error_rad"] = attempt.failure.empty() ? Json(attempt.errors.orientation_rad) : Json();
    if (!attempt.failure.empty()) json["failure"] = attempt.failure;
    return json;
}

Json json_of(const AdviseOptions& options, const Candidate& candidate) {
    Json json = json_of(candidate.attempt);
    if (!candidate.is_measured()) {
        json["reason"] = candidate.not_measured;
        return json;
    }
    const double step = candidate.attempt.length.seconds();
    json["insn_per_simulated_second"] = candidate.row.at("insn_per_step").get<double>() / step;
    json["measured_steps"] = candidate.row.at("steps");
    for (const char* key :
         {"insn_per_step", "insn_per_step_max", "text_bytes", "ram_bytes", "stack_bytes", "state_hash"})
        json[key] = candidate.row.at(key);
    if (!has_cycles(candidate.row)) return json;
    for (const char* key : {"min", "est", "max"})
        json[std::string("cycles_per_simulated_second_") + key] =
            candidate.row.at(std::string("cycles_per_step_") + key).get<double>() / step;
    for (const char* key :
         {"cycles_per_step_min", "cycles_per_step_est", "cycles_per_step_max", "cycles_worst_step_min",
          "cycles_worst_step_est", "cycles_worst_step_max", "timing", "memory"})
        json[key] = candidate.row.at(key);
    if (options.clock) {
        const StepCost cost = cycles_of(candidate.row);
        json["mean_share_of_step"] = cost.mean / (*options.clock * step);
        json["worst_share_of_step"] = cost.worst / (*options.clock * step);
    }
    return json;
}

// What costs are ranked by, in the core's cycles or instructions.
struct Unit {
    bool cycles;
    [[nodiscard]] const char* name() const { return cycles ? "cycles" : "instructions"; }
    [[nodiscard]] double of_step(const Json& row) const { return (cycles ? cycles_of(row) : insn_of(row)).mean; }
};

// Throws BadArgument where cycles are asked for and the core has none.
Unit unit_of(const AdviseOptions& options) {
    const bool known = core_named(options.core).has_cycles();
    const auto refuse = [&](const char* option) {
        std::string cores_with;
        for (const Core& core : cores())
            if (core.has_cycles()) cores_with += (cores_with.empty() ? "" : ", ") + core.name;
        throw BadArgument(std::string(option) + ": nothing publishes the cycles of " + options.core +
                          ", expected a core that has a timing table: " + cores_with);
    };
    if (!known && options.cost == "cycles") refuse("--cost");
    if (!known && options.clock) refuse("--clock");
    if (!known && options.cost.empty())
        std::cerr << options.core << ": nothing publishes its cycles; costs are in instructions\n";
    return {known && options.cost != "insn"};
}

// What the candidates cost on the core, cheapest first as far as it can be told without measuring.
class Measurement {
public:
    Measurement(const AdviseOptions& options, const Unit& unit, const SceneDescription& scene,
                const SampledScene& sampled)
        : options_(options), unit_(unit), sampled_(sampled),
          build_(fs::path(TUMBLE_SOURCE_DIR) / "build/advise" / options.core / struct_name(scene.path)),
          least_(least_insn_per_body *
                 std::count_if(scene.bodies.begin(), scene.bodies.end(), [](const auto& b) { return !b.fixed; })) {
        fs::create_directories(build_ / "scenes");
    }

    // Fills in the rows. What cannot be the cheapest is not measured, unless all are asked for.
    void run(std::vector<Candidate>& candidates) {
        const DirectoryLock lock(build_);
        StepFirmware firmware(build_, options_.core, struct_name(sampled_.with_step(0).path), build_ / "scenes");
        if (!options_.all) measure_floors(candidates, firmware);
        // The lowest bound first; where it is the same, without carry first.
        std::sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
            if (bound(a) != bound(b)) return bound(a) < bound(b);
            return !a.attempt.method.carry && b.attempt.method.carry;
        });
        Progress progress(static_cast<std::int64_t>(candidates.size()));
        const auto shown = [&] {
            const auto is_done = [](const Candidate& c) { return !c.waits(); };
            progress.show(std::count_if(candidates.begin(), candidates.end(), is_done),
                          unit_.name() + (" on " + options_.core));
        };
        for (;;) {
            shown();
            std::vector<Candidate*> wave;
            std::vector<std::string> names;
            for (Candidate& candidate : candidates) {
                if (!candidate.waits() || wave.size() >= processors_) continue;
                if (!options_.all) candidate.not_measured = reason_to_skip(candidate, candidates);
                if (!candidate.waits() || (!options_.all && waits_for_twin(candidate, candidates))) continue;
                wave.push_back(&candidate);
                names.push_back(StepFirmware::name_of(candidate.variant, candidate.attempt.method.integrator));
                write_scene(names.back(), candidate);
            }
            if (wave.empty()) break;
            firmware.build(names);
            in_parallel(wave.size(), [&](std::size_t i) { measure(*wave[i], firmware, names[i]); });
            for (const Candidate* candidate : wave)
                if (candidate->is_measured()) best_ = std::min(best_, candidate->cost);
        }
    }

private:
    // The same method without carry, where that reaches the tolerance at the same step.
    [[nodiscard]] static const Candidate* twin_of(const Candidate& candidate, const std::vector<Candidate>& all) {
        if (!candidate.attempt.method.carry) return nullptr;
        const auto twin = std::find_if(all.begin(), all.end(), [&](const Candidate& other) {
            return !other.attempt.method.carry && other.attempt.step >= candidate.attempt.step &&
                   other.attempt.method.integrator == candidate.attempt.method.integrator &&
                   other.attempt.method.numbers == candidate.attempt.method.numbers;
        });
        return twin == all.end() ? nullptr : &*twin;
    }
    [[nodiscard]] static bool waits_for_twin(const Candidate& candidate, const std::vector<Candidate>& all) {
        const Candidate* twin = twin_of(candidate, all);
        return twin != nullptr && twin->waits();
    }
    [[nodiscard]] std::string reason_to_skip(const Candidate& candidate, const std::vector<Candidate>& all) const {
        if (const Candidate* twin = twin_of(candidate, all);
            twin != nullptr && twin->is_measured() && twin->cost * (1 - most_saved_by_carry) >= best_)
            return "costs more than the best even if carry saves " + few_digits(100 * most_saved_by_carry) +
                   " % of what it costs without, at no shorter step";
        if (bound(candidate) < best_) return {};
        const auto floor = floors_.find(candidate.attempt.method.numbers);
        return "costs more than the best even in " +
               (floor == floors_.end()
                    ? std::to_string(least_)
                    : "half of the " + few_digits(std::round(floor->second)) + " " + candidate.attempt.method.numbers) +
               " " + unit_.name() + " of a step" + (floor == floors_.end() ? "" : " of semi_implicit_euler");
    }

    // No step costs less than half of what one of semi-implicit Euler without carry does: that evaluates every load
    // once and adds to every number once, which all methods do. It is measured in each number system that has many
    // candidates, at the shortest of their steps, at which contacts cost the least for a step.
    void measure_floors(const std::vector<Candidate>& candidates, StepFirmware& firmware) {
        std::vector<Candidate> cheapest;
        std::vector<std::string> names;
        for (const NumberVariant& variant : number_variants()) {
            const auto shares = [&](const Candidate& c) { return c.variant.numbers == variant.numbers; };
            const auto first = std::find_if(candidates.begin(), candidates.end(), shares);
            const auto is_single = [&](const Candidate& c) { return shares(c) && twin_of(c, candidates) == nullptr; };
            if (variant.carry || std::count_if(candidates.begin(), candidates.end(), is_single) <= 2) continue;
            Candidate floor = *first;
            for (const Candidate& c : candidates)
                if (shares(c) && c.attempt.step < floor.attempt.step) floor = c;
            floor.variant = variant;
            floor.attempt.method = {"semi_implicit_euler", variant.numbers, variant.carry};
            cheapest.push_back(floor);
            names.push_back(StepFirmware::name_of(variant, floor.attempt.method.integrator));
            write_scene(names.back(), floor);
        }
        if (cheapest.empty()) return;
        firmware.build(names);
        in_parallel(cheapest.size(), [&](std::size_t i) { measure(cheapest[i], firmware, names[i]); });
        for (const Candidate& floor : cheapest)
            if (floor.is_measured()) floors_[floor.variant.numbers] = unit_.of_step(floor.row);
    }
    // What a simulated second of the candidate costs at least. An instruction takes a cycle or more.
    [[nodiscard]] double bound(const Candidate& candidate) const {
        const auto floor = floors_.find(candidate.attempt.method.numbers);
        const double cost = floor == floors_.end() ? 0.0 : floor->second / 2;
        return std::max(cost, static_cast<double>(least_)) / candidate.attempt.length.seconds();
    }

    // The run that is measured.
    [[nodiscard]] SceneDescription scene_of(const Candidate& candidate) const {
        SceneDescription scene = sampled_.with_step(candidate.attempt.step);
        if (scene.steps() > most_measured_steps)
            scene.duration = static_cast<double>(most_measured_steps) * scene.step.seconds();
        return scene;
    }
    void write_scene(const std::string& name, const Candidate& candidate) const {
        const std::string header = compiled_scene(scene_of(candidate), Choice{});  // the firmware has its own method
        write_if_changed(build_ / "scenes" / (name + ".hpp"), header);
    }

    void measure(Candidate& candidate, const StepFirmware& firmware, const std::string& name) const {
        const Method& method = candidate.attempt.method;
        StepOutcome outcome = firmware.run(name);
        if (!outcome.shortage.empty()) {
            candidate.not_measured = "does not fit the core's memory";
            return;
        }
        if (!outcome.error.empty()) throw std::runtime_error(options_.core + ", " + name + ": " + outcome.error);
        const auto simulation = make_simulation(scene_of(candidate), method.integrator, method.numbers, method.carry);
        check_state(outcome.row, *simulation, options_.core + ", " + name);
        candidate.row = std::move(outcome.row);
        candidate.cost = unit_.of_step(candidate.row) / candidate.attempt.length.seconds();
    }

    const AdviseOptions& options_;
    Unit unit_;
    const SampledScene& sampled_;
    fs::path build_;
    std::int64_t least_;
    std::map<std::string, double> floors_;  // a number system's cheapest step
    std::size_t processors_ = std::max(1u, std::thread::hardware_concurrency());
    double best_ = std::numeric_limits<double>::infinity();
};

std::vector<Method> chosen_methods(const AdviseOptions& options, const SceneDescription& scene) {
    for (const std::string& integrator : options.integrators) (void)find_integrator(integrator);
    for (const std::string& numbers : options.numbers) (void)find_number_system(scene, numbers, {});
    const auto is_chosen = [](const std::vector<std::string>& list, const std::string& name) {
        return list.empty() || std::find(list.begin(), list.end(), name) != list.end();
    };
    std::vector<Method> methods;
    for (const IntegratorInfo& integrator : integrators()) {
        for (const NumberVariant& variant : number_variants()) {
            if (is_chosen(options.integrators, integrator.name) && is_chosen(options.numbers, variant.numbers) &&
                runs_in(integrator, variant.numbers))
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

// Everything that is found out.
struct Advice {
    Unit unit;
    Truth truth;
    std::vector<Candidate> ranking, not_measured;
    std::vector<Attempt> unreached;  // at the step with the smallest error, the closest first
    std::string message;             // why there is no recommendation
};

void print_json(const AdviseOptions& options, const SampledScene& sampled, const Advice& advice) {
    Json json;
    json["tumble_bits"] = TUMBLE_BITS;
    const SceneDescription scene = sampled.with_step(sampled.longest());
    json["scene"] = scene.name;
    json["core"] = options.core;
    json["cost"] = advice.unit.cycles ? "cycles" : "insn";
    if (options.clock) json["clock_hz"] = *options.clock;
    json["tolerance_m"] = options.tolerance;
    json["tolerance_rad"] = options.tolerance;
    json["samples"] = sample_count;
    json["duration_s"] = scene.duration;
    json["reference"] = advice.truth.has_contacts ? "two fine runs" : "long double";
    json["reference_doubt_m"] = advice.truth.doubt.position_m;
    json["reference_doubt_rad"] = advice.truth.doubt.orientation_rad;
    json["recommendation"] = advice.ranking.empty() ? Json() : json_of(options, advice.ranking.front());
    if (!advice.message.empty()) json["message"] = advice.message;
    for (const char* key : {"ranking", "not_measured", "unreached"}) json[key] = Json::array();
    for (const Candidate& candidate : advice.ranking) json["ranking"].push_back(json_of(options, candidate));
    for (const Candidate& candidate : advice.not_measured) json["not_measured"].push_back(json_of(options, candidate));
    for (const Attempt& attempt : advice.unreached) json["unreached"].push_back(json_of(attempt));
    std::cout << json.dump(2) << "\n";
}

std::string name_of(const Attempt& attempt) {
    return attempt.method.integrator + " " + numbers_text(attempt.method.numbers, attempt.method.carry);
}
// Its error, with the digits that matter, and its step; or what ended it.
std::string closest_text(const Attempt& attempt) {
    std::array<char, 32> error{};
    std::snprintf(error.data(), error.size(), "%.2g", attempt.error());
    return attempt.failure.empty() ? error.data() + (" at " + step_text(attempt.length)) + " s" : attempt.failure;
}

// A title and, under it, names in lines of a terminal's width.
void print_list(const std::string& title, const std::vector<std::string>& names) {
    std::cout << "\n" << title << "\n";
    std::string line;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string name = names[i] + (i + 1 < names.size() ? "," : "");
        if (line.size() + name.size() > 110) {
            std::cout << " " << line << "\n";
            line.clear();
        }
        line += " " + name;
    }
    std::cout << " " << line << "\n";
}

// A share of a step's time: "7.9 %".
std::string percent(double share) { return few_digits(std::round(share * 10000) / 100) + " %"; }

void print_clock(const AdviseOptions& options, const Candidate& best) {
    const StepCost cost = cycles_of(best.row);
    const double there_are = *options.clock * best.attempt.length.seconds();
    std::cout << "At " << few_digits(*options.clock / 1e6) << " MHz a step of " << step_text(best.attempt.length)
              << " s has " << std::llround(there_are) << " cycles: the mean step takes "
              << percent(cost.mean / there_are) << " of them, the worst one at most " << percent(cost.worst / there_are)
              << (cost.worst > there_are ? ", more than there are" : "") << ".\n";
}

void print_table(const AdviseOptions& options, const SceneDescription& scene, const Advice& advice) {
    const Unit unit = advice.unit;
    if (!advice.ranking.empty()) {
        const Candidate& best = advice.ranking.front();
        const std::string limit = few_digits(options.tolerance);
        std::cout << options.core << ": " << best.attempt.method.integrator << " in " << best.attempt.method.numbers
                  << (best.attempt.method.carry ? " with carry" : " without carry") << " at a step of "
                  << step_text(best.attempt.length) << " s keeps \"" << scene.name << "\" within " << limit << " m and "
                  << limit << " rad for " << std::llround(best.cost) << " " << unit.name() << " a simulated second"
                  << (unit.cycles ? ", at zero wait states" : "") << ".\n";
        if (options.clock) print_clock(options, best);
        const std::string per_step = unit.cycles ? "cycles/step" : "insn/step",
                          per_second = unit.cycles ? "cycles/s" : "insn/s";
        std::printf("\n%-20s %-9s %9s %10s %10s %24s %9s %12s %7s %7s", "integrator", "numbers", "step s", "error m",
                    "error rad", per_step.c_str(), "worst", per_second.c_str(), "text", "RAM");
        if (options.clock) std::printf(" %9s %9s", "mean", "worst");
        std::printf("\n");
    }
    for (const Candidate& c : advice.ranking) {
        const auto number = [&](const char* key) { return c.row.at(key).get<unsigned long long>(); };
        const StepCost cost = unit.cycles ? cycles_of(c.row) : insn_of(c.row);
        std::printf("%-20s %-9s %9s %10.2g %10.2g %24s %9.0f %12.0f %7llu %7llu", c.attempt.method.integrator.c_str(),
                    numbers_text(c.attempt.method.numbers, c.attempt.method.carry).c_str(),
                    step_text(c.attempt.length).c_str(), c.attempt.errors.position_m, c.attempt.errors.orientation_rad,
                    range_text(cost.mean, cost.least, cost.most).c_str(), cost.worst, c.cost, number("text_bytes"),
                    number("ram_bytes"));
        if (options.clock) {
            const StepCost cycles = cycles_of(c.row);
            const double there_are = *options.clock * c.attempt.length.seconds();
            std::printf(" %9s %9s", percent(cycles.mean / there_are).c_str(),
                        percent(cycles.worst / there_are).c_str());
        }
        std::printf("\n");
    }
    std::fflush(stdout);
    std::vector<std::string> reasons;
    for (const Candidate& c : advice.not_measured)
        if (std::find(reasons.begin(), reasons.end(), c.not_measured) == reasons.end())
            reasons.push_back(c.not_measured);
    for (const std::string& reason : reasons) {
        std::vector<std::string> names;
        for (const Candidate& c : advice.not_measured)
            if (c.not_measured == reason)
                names.push_back(name_of(c.attempt) + " at " + step_text(c.attempt.length) + " s");
        print_list("not measured: " + reason, names);
    }
    std::vector<std::string> names;
    for (const Attempt& attempt : advice.unreached) names.push_back(name_of(attempt) + " " + closest_text(attempt));
    if (!names.empty()) print_list("not within the tolerance, with the smallest error", names);
}

int advise(const AdviseOptions& options) {
    check_core(options.core);
    if (!core_named(options.core).has_insn())
        throw BadArgument("--core: got \"" + options.core + "\", expected a core whose instructions are counted");
    const Unit unit = unit_of(options);
    Choice choice;
    choice.scene = options.scene;
    choice.duration = options.duration;
    const SceneDescription scene = choice.read();
    const SampledScene sampled(scene);
    const std::vector<Method> methods = chosen_methods(options, scene);

    Advice advice{unit, {}, {}, {}, {}, {}};
    advice.truth = truth_of(sampled);
    const double doubt = advice.truth.doubt.largest();
    if (doubt > options.tolerance / 10) {
        advice.message = "the scene is chaotic: there is no reference for an error of " +
                         few_digits(options.tolerance) + ", since two fine runs differ by " + few_digits(doubt) +
                         ", expected at most a tenth of the tolerance; take a larger one or a shorter --duration";
    } else {
        std::vector<Candidate> candidates;
        for (const Attempt& attempt : search(methods, options.tolerance, sampled, advice.truth)) {
            if (attempt.error() > options.tolerance) {
                advice.unreached.push_back(attempt);
                continue;
            }
            candidates.push_back({attempt, variant_of(attempt.method.numbers, attempt.method.carry), {}, 0, {}});
        }
        std::sort(advice.unreached.begin(), advice.unreached.end(),
                  [](const Attempt& a, const Attempt& b) { return a.error() < b.error(); });
        if (!candidates.empty()) Measurement(options, unit, scene, sampled).run(candidates);
        for (Candidate& candidate : candidates)
            (candidate.is_measured() ? advice.ranking : advice.not_measured).push_back(std::move(candidate));
        std::stable_sort(advice.ranking.begin(), advice.ranking.end(),
                         [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
        if (advice.ranking.empty() && !advice.not_measured.empty())
            advice.message = "what keeps the error under " + few_digits(options.tolerance) + " does not fit " +
                             options.core + "'s memory";
        else if (advice.ranking.empty())
            advice.message = "nothing keeps the error under " + few_digits(options.tolerance) +
                             (advice.unreached.empty() ? std::string()
                                                       : "; the closest is " + name_of(advice.unreached.front()) +
                                                             " with " + closest_text(advice.unreached.front()));
    }
    if (options.json) print_json(options, sampled, advice);
    else print_table(options, scene, advice);
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

// A frequency, which is then in Hz.
bool read_frequency(std::string& text) {
    const std::optional<double> hertz = parse_frequency(text);
    if (hertz) text = seventeen_digits(*hertz);
    return hertz.has_value();
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
    command.add(options->clock, "--clock F",
                "clock of the core, as 16MHz: say what share of a step's time its mean cost and its worst step take",
                {"a positive frequency, as 16MHz, \"32.768 kHz\" or 48e6 (Hz)", read_frequency});
    command.add(options->all, "--all", "measure also what cannot be the cheapest");
    command.add(options->json, "--json", "print one JSON object");
}

}  // namespace tumble::host
