// The main job: one scene, replayed on the host and on every core with every integrator and number system; the bits
// compared; what a step costs printed and written as JSON lines. A row whose hash differs from the host's is marked and
// makes the whole run fail; so does a firmware that faults or does not end.
#include "command/command.hpp"
#include "firmware/cost.hpp"
#include "firmware/firmware.hpp"
#include "rows.hpp"
#include "tools/files.hpp"
#include "tools/text.hpp"
#include "variants.hpp"

#include "reference.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <future>
#include <iostream>
#include <limits>
#include <mutex>
#include <optional>

namespace {

using tumble::bench::in_parallel;
using tumble::bench::Row;
using tumble::bench::Variant;
using tumble::host::Progress;
using tumble::host::StepCost;
using tumble::host::StepFirmware;
namespace fs = std::filesystem;

// Those of the quick set of boards.txt, or all that can be emulated.
std::vector<std::string> core_names(bool all) {
    std::vector<std::string> names;
    for (const auto& core : tumble::host::cores())
        if (core.machine != "-" && (all || core.set == "quick")) names.push_back(core.name);
    return names;
}

// Those that boards.txt recommends; all for the host.
std::vector<std::string> numbers_of_core(const std::string& name) {
    for (const auto& core : tumble::host::cores())
        if (core.name == name) return core.numbers;
    return tumble::bench::variant_names();
}

// The first line of what a core's compiler says of itself.
const std::string& compiler_of(const std::string& core) {
    static std::mutex mutex;
    static std::map<std::string, std::string> versions;
    const std::string compiler = tumble::host::core_named(core).compiler;
    const std::lock_guard lock{mutex};
    const auto [version, is_new] = versions.try_emplace(compiler);
    if (is_new && !tumble::host::Process({compiler, "--version"}).read_line(version->second))
        throw std::runtime_error(compiler + " says no version");
    return version->second;
}

struct Job {
    std::string core;
    Variant variant;
    std::string method;
    Row row;
    std::string error;          // empty: the row is good
    std::string shortage;       // of the core's memory
    std::int64_t compared = 0;  // steps that its errors are of
};

void print_table(const std::vector<Job>& jobs) {
    std::printf("\n%-11s %-10s %-20s %26s %12s %8s %7s %7s  %-16s %s\n", "core", "numbers", "integrator", "cycles/step",
                "worst", "text", "RAM", "stack", "state hash", "agrees");
    bool has_insn = false;
    for (const Job& job : jobs) {
        const std::string numbers = tumble::host::numbers_text(job.variant.numbers, job.variant.carry);
        if (!job.shortage.empty()) {
            std::printf("%-11s %-10s %-20s %s\n", job.core.c_str(), numbers.c_str(), job.method.c_str(),
                        job.shortage.c_str());
        } else if (!job.error.empty() && job.row.is_null()) {
            std::printf("%-11s %-10s %-20s FAILED: %s\n", job.core.c_str(), numbers.c_str(), job.method.c_str(),
                        job.error.c_str());
        } else {
            const auto number = [&](const char* key) {
                return job.row.contains(key) ? std::to_string(job.row.at(key).get<unsigned long long>()) : "-";
            };
            const StepCost cost = tumble::host::cost_of(job.row);
            has_insn = has_insn || !cost.in_cycles;
            std::printf("%-11s %-10s %-20s %26s %12s %8s %7s %7s  %-16s %s\n", job.core.c_str(), numbers.c_str(),
                        job.method.c_str(), cost.mean_text().c_str(), cost.worst_text().c_str(),
                        number("text_bytes").c_str(), number("ram_bytes").c_str(), number("stack_bytes").c_str(),
                        job.row.at("state_hash").get<std::string>().c_str(),
                        job.error.empty() ? "yes" : job.error.c_str());
        }
    }
    std::printf("cycles: expected (least..most), zero wait states; worst: the dearest step, at most%s\n",
                has_insn ? "; insn: no timing table of this core" : "");
}

// For each core the method that costs least of those whose error is within the tolerance; if there is none, the most
// accurate. Errors are known until the first contact only, which the line says; where a scene begins in contact none is
// known, and the line has the cheapest. Then where the rows are.
void print_answer(const std::vector<std::string>& cores, const std::vector<Job>& jobs,
                  const tumble::host::SceneDescription& scene, double tolerance) {
    const auto error_of = [](const Job& job) {
        if (job.compared == 0) return std::numeric_limits<double>::infinity();
        return std::max(job.row.at("position_error_m").get<double>(),
                        job.row.at("orientation_error_rad").get<double>());
    };
    const auto cost_of = [](const Job& job) { return tumble::host::cost_of(job.row).mean; };
    const auto is_better = [&](const Job& a, const Job& b) {
        const double error_a = error_of(a), error_b = error_of(b);
        if ((error_a <= tolerance) != (error_b <= tolerance)) return error_a <= tolerance;
        return error_a <= tolerance || error_a == error_b ? cost_of(a) < cost_of(b) : error_a < error_b;
    };
    for (const std::string& core : cores) {
        const Job* best = nullptr;
        for (const Job& job : jobs)
            if (job.core == core && job.error.empty() && !job.row.is_null() &&
                (best == nullptr || is_better(job, *best)))
                best = &job;
        if (best == nullptr) {
            std::printf("%-11s no row\n", core.c_str());
            continue;
        }
        const StepCost cost = tumble::host::cost_of(best->row);
        if (std::isnan(cost.mean)) {
            std::printf("%-11s counts neither cycles nor instructions\n", core.c_str());
            continue;
        }
        std::printf("%-11s %s in %s: %s", core.c_str(), best->method.c_str(),
                    tumble::host::numbers_text(best->variant.numbers, best->variant.carry).c_str(),
                    cost.mean_text().c_str());
        if (cost.in_cycles) std::printf(" cycles");
        std::printf(" a step, ");
        if (!std::isnan(cost.worst)) std::printf("%s at worst, ", cost.worst_text().c_str());
        if (core != StepFirmware::host && tumble::host::core_named(core).issues_two())
            std::printf("at least %.0f cycles, ", std::ceil(cost.mean / 2));
        if (best->compared == 0) {
            std::printf("the cheapest; error not measured: in contact from the start\n");
            continue;
        }
        const double error = error_of(*best);
        std::printf("error %.1e m or rad", error);
        if (best->compared < scene.steps())
            std::printf(" until the first contact at %.3g s",
                        static_cast<double>(best->compared) * scene.step.seconds());
        std::printf(": %s %g\n", error <= tolerance ? "the cheapest within" : "the most accurate, none is within",
                    tolerance);
    }
}

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    CLI::App app{"Replays a scene on the host and on every core, compares the bits, and prints what a step costs."};
    fs::path scene_path, results = "build/results/run.jsonl";
    std::vector<std::string> cores, methods = tumble::bench::integrator_names(), numbers;
    bool accuracy = false, all = false;
    double tolerance = 0;
    app.add_option("scene", scene_path, "Scene file")->required();
    app.add_option("--cores", cores,
                   "Cores to run on, or host, which needs valgrind; without, those of the quick set of boards.txt")
        ->delimiter(',');
    app.add_option("--integrators", methods, "Integrators to run")->delimiter(',');
    app.add_option("--numbers", numbers,
                   "Number systems to run, as q32, q32_plain, ...; without, those of the core in boards.txt")
        ->delimiter(',');
    app.add_flag("--all", all, "Every number system, and every core where --cores names none");
    app.add_option("--results", results, "Where the rows go, as JSON lines");
    app.add_flag("--accuracy", accuracy,
                 "Add errors against the long-double reference, up to the scene's first contact");
    app.add_option("--tolerance", tolerance,
                   "Say at last which method is the cheapest with at most this error, m and rad")
        ->check(CLI::PositiveNumber);
    CLI11_PARSE(app, argc, argv);
    if (all) numbers = tumble::bench::variant_names();
    if (cores.empty()) cores = core_names(all);
    accuracy = accuracy || tolerance > 0;

    tumble::host::check_outputs({{"the scene", scene_path}}, {{"--results", results}});
    const tumble::host::SceneDescription scene = tumble::host::read_scene(scene_path, tumble::host::BodyCount::any);
    tumble::host::OutputFile rows_file = tumble::bench::rows_file(results);
    const std::string name = scene_path.stem().string();
    const fs::path work = fs::path{"build/matrix"} / name;
    fs::create_directories(work);
    const tumble::host::DirectoryLock lock{work};

    // The number systems of each core with every integrator that runs in them, and all of these together.
    std::vector<std::pair<Variant, std::string>> choices;
    std::vector<Job> jobs;
    for (const auto& core : cores) {
        for (const auto& v : tumble::bench::variants_named(numbers.empty() ? numbers_of_core(core) : numbers)) {
            for (const auto& m : methods) {
                if (!tumble::host::runs_in(tumble::host::find_integrator(m), v.numbers)) continue;
                jobs.push_back({core, v, m, {}, {}, {}});
                if (std::none_of(choices.begin(), choices.end(),
                                 [&](const auto& c) { return c.first.name == v.name && c.second == m; }))
                    choices.emplace_back(v, m);
            }
        }
    }

    // The host's answer for each integrator and number system.
    struct Answer {
        std::string hash;
        tumble::bench::Flight::Error error;
    };
    std::map<std::pair<std::string, std::string>, Answer> answers;
    std::mutex answers_mutex;
    std::optional<tumble::bench::Flight> flight;
    if (accuracy) flight.emplace(scene);
    Progress progress(static_cast<std::int64_t>(choices.size() + cores.size() + jobs.size()), Progress::Piped::tenths);
    auto replayed = std::async(std::launch::async, [&] {
        in_parallel(choices.size(), [&](std::size_t i) {
            const auto& [variant, method] = choices[i];
            const auto simulation = tumble::host::make_simulation(scene, method, variant.numbers, variant.carry);
            Answer answer{tumble::host::hex(finish(*simulation)), {}};
            if (flight) answer.error = flight->error_of(method, variant.numbers, variant.carry);
            const std::lock_guard lock{answers_mutex};
            answers[{variant.name, method}] = answer;
            progress.step("host " + variant.name + " " + method);
        });
    });

    // Meanwhile the firmware of each core; ninja uses both processors itself.
    const fs::path header = fs::absolute(work / (name + ".hpp"));
    tumble::host::write_if_changed(header, tumble::host::compiled_scene(scene, {}));
    std::map<std::string, StepFirmware> firmware;
    for (const auto& core : cores) {
        const auto at =
            firmware
                .try_emplace(core, work / core, core, tumble::host::struct_name(scene_path.string()), header, methods)
                .first;
        std::vector<std::string> programs;
        for (const Job& job : jobs)
            if (job.core == core) programs.push_back(StepFirmware::name_of(job.variant, job.method));
        at->second.build(programs);
        progress.step("built for " + core);
    }

    replayed.get();

    in_parallel(jobs.size(), [&](std::size_t i) {
        Job& job = jobs[i];
        tumble::host::StepOutcome outcome = firmware.at(job.core).run(StepFirmware::name_of(job.variant, job.method));
        job.error = outcome.error;
        job.shortage = outcome.shortage;
        if (!outcome.row.is_null()) {
            job.row = std::move(outcome.row);
            const Answer& answer = answers.at({job.variant.name, job.method});
            const bool on_host = job.core == StepFirmware::host;
            job.row["step_s"] = scene.step.seconds();
            job.row["compiler"] = on_host ? TUMBLE_HOST_COMPILER : compiler_of(job.core);
            const bool has_q32_flags = !on_host && tumble::host::core_named(job.core).compiled_by_gcc();
            job.row["flags"] = has_q32_flags && job.variant.numbers == "q32" ? TUMBLE_Q32_FLAGS : "-O2";
            job.compared = answer.error.steps;
            if (job.compared > 0) {
                job.row["position_error_m"] = answer.error.largest.position_m;
                job.row["orientation_error_rad"] = answer.error.largest.orientation_rad;
            }
            const bool agrees = job.row.at("state_hash") == answer.hash;
            job.row["state_hash_agrees"] = agrees;
            if (!agrees) job.error = "NO: host has " + answer.hash;
        }
        progress.step(job.core + " " + job.variant.name + " " + job.method);
    });

    std::vector<Row> rows;
    int failed = 0;
    for (const Job& job : jobs) {
        if (!job.row.is_null() && job.error.empty()) rows.push_back(job.row);
        if (!job.error.empty()) ++failed;
    }
    print_table(jobs);
    tumble::bench::write_rows(rows_file, rows);
    std::printf("\n");
    if (tolerance > 0) print_answer(cores, jobs, scene, tolerance);
    std::printf("%zu rows in %s", rows.size(), results.c_str());
    if (failed > 0) std::printf("; %d FAILED", failed);
    std::printf("\n");

    return failed == 0 ? 0 : 1;
} catch (...) { return tumble::bench::report_failure("tumble_matrix"); }
