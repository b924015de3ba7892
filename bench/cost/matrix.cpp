// The main job: replays one scene on the host and on every core with every integrator and number system, compares the
// bits, and writes what a step costs as a table and as JSON lines. A row whose hash differs from the host's is marked
// and makes the run fail; so does a firmware that faults or does not end.
#include "cost/matrix.hpp"

#include "accuracy/reference.hpp"
#include "command/command.hpp"
#include "firmware/firmware.hpp"
#include "scene/scene_file.hpp"
#include "tools/files.hpp"
#include "tools/text.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <map>
#include <mutex>
#include <optional>

namespace {

using namespace tumble::bench;
using tumble::host::OutputFile;
using tumble::host::Progress;
using tumble::host::SceneDescription;
using tumble::host::StepFirmware;
namespace fs = std::filesystem;

struct Options {
    fs::path scene, results = "build/results/run.jsonl";
    std::optional<fs::path> front;  // rows of a free body's step; none: all jobs are measured and shown
    std::vector<std::string> cores, methods, numbers, levels{"-O2"};
    bool accuracy = false, all = false, separate = false;
    double tolerance = 0;

    // All of them, with the defaults filled in; none where the command line ends the program with `status`.
    static std::optional<Options> parse(int argc, char** argv, int& status);
};

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
    return variant_names();
}

std::optional<Options> Options::parse(int argc, char** argv, int& status) {
    CLI::App app{"Replays a scene on the host and on every core, compares the bits, and prints what a step costs."};
    Options o;
    app.add_option("scene", o.scene, "Scene file")->required();
    app.add_option("--cores", o.cores,
                   "Cores to run on, or host, which needs valgrind; default: the quick set of boards.txt")
        ->delimiter(',');
    app.add_option("--integrators", o.methods, "Integrators to run; default: all")->delimiter(',');
    app.add_option("--numbers", o.numbers,
                   "Number systems to run, as q32, q32_plain, ...; default: those of the core in boards.txt")
        ->delimiter(',');
    app.add_option("--optimize", o.levels, "Levels of the compiler, as --optimize=-O2,-Os")
        ->delimiter(',')
        ->capture_default_str();
    app.add_flag("--all", o.all, "Every number system and method, and every core where --cores names none");
    app.add_flag("--separate", o.separate,
                 "Compile each method by itself, as a firmware has it, which takes three times as long; methods that "
                 "are compiled together share functions, which makes steps with loads dearer");
    app.add_option("--results", o.results, "Where the rows go, as JSON lines")->capture_default_str();
    app.add_flag("--accuracy", o.accuracy,
                 "Add errors against the long-double reference, up to the scene's first contact");
    app.add_option("--tolerance", o.tolerance,
                   "Say first which method is the cheapest with at most this error, m and rad")
        ->check(CLI::PositiveNumber);
    app.add_option("--front", o.front,
                   "Rows of a free body's step: measure in q32 only the methods that no other beats in error and in "
                   "the cost of these rows, and print the rows that no other beats; no effect with --all, and on what "
                   "--integrators or --numbers names");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        status = app.exit(error);
        return {};
    }
    if (o.all || !o.methods.empty()) o.front.reset();
    if (o.all) o.numbers = variant_names();
    else if (o.front && o.numbers.empty()) o.numbers = {"q32"};
    if (o.methods.empty()) o.methods = integrator_names();
    if (o.cores.empty()) o.cores = core_names(o.all);
    o.accuracy = o.accuracy || o.tolerance > 0 || o.front;
    return o;
}

// The number systems of each core with every integrator that runs in them, at every level.
std::vector<Job> jobs_of(const Options& options) {
    std::vector<Job> jobs;
    for (const auto& core : options.cores)
        for (const auto& v : variants_named(options.numbers.empty() ? numbers_of_core(core) : options.numbers))
            for (const auto& m : options.methods)
                for (const auto& level : options.levels)
                    if (tumble::host::runs_in(tumble::host::find_integrator(m), v.numbers))
                        jobs.push_back({core, v, m, level, {}, {}, {}});
    return jobs;
}

// The host's answer for each number system and integrator.
struct Answer {
    std::string hash;
    Flight::Error error;
};
using Answers = std::map<std::pair<std::string, std::string>, Answer>;

Answers replayed_on_host(const SceneDescription& scene, const std::vector<Job>& jobs, bool accuracy) {
    std::vector<const Job*> choices;
    Answers answers;
    for (const Job& job : jobs)
        if (answers.try_emplace({job.variant.name, job.method}).second) choices.push_back(&job);
    std::optional<Flight> flight;
    if (accuracy) flight.emplace(scene);
    Progress progress(static_cast<std::int64_t>(choices.size()));
    in_parallel(choices.size(), [&](std::size_t i) {
        const auto& [numbers, method] = std::pair{choices[i]->variant, choices[i]->method};
        const auto simulation = tumble::host::make_simulation(scene, method, numbers.numbers, numbers.carry);
        Answer& answer = answers.at({numbers.name, method});
        answer.hash = tumble::host::hex(finish(*simulation));
        if (flight) answer.error = flight->error_of(method, numbers.numbers, numbers.carry);
        progress.step("host " + numbers.name + " " + method);
    });
    return answers;
}

void add_accuracy(std::vector<Job>& jobs, const Answers& answers) {
    for (Job& job : jobs) {
        const Flight::Error& error = answers.at({job.variant.name, job.method}).error;
        job.compared = error.steps;
        job.accuracy = error.steps == 0 ? std::numeric_limits<double>::infinity()
                                        : std::max(error.largest.position_m, error.largest.orientation_rad);
    }
}

// The first line that the compiler of a core prints for --version.
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

// Adds to the row of a job what the core does not know, and whether the bits agree.
void complete(Job& job, const SceneDescription& scene, const Answer& answer) {
    const bool on_host = job.core == StepFirmware::host;
    job.row["step_s"] = scene.step.seconds();
    job.row["compiler"] = on_host ? TUMBLE_HOST_COMPILER : compiler_of(job.core);
    const bool has_q32_flags = !on_host && tumble::host::core_named(job.core).compiled_by_gcc();
    job.row["flags"] = job.level + (has_q32_flags && job.variant.numbers == "q32" ? TUMBLE_Q32_FLAGS : "");
    if (job.compared > 0) {
        job.row["position_error_m"] = answer.error.largest.position_m;
        job.row["orientation_error_rad"] = answer.error.largest.orientation_rad;
    }
    const bool agrees = job.row.at("state_hash") == answer.hash;
    job.row["state_hash_agrees"] = agrees;
    if (!agrees) job.error = "NO: host has " + answer.hash;
}

// Builds the firmware of each core and runs it.
void measure(std::vector<Job>& jobs, const Options& options, const SceneDescription& scene, const Answers& answers) {
    const std::string name = options.scene.stem().string();
    const fs::path work = fs::path{"build/matrix"} / name, header = fs::absolute(work / (name + ".hpp"));
    fs::create_directories(work);
    const tumble::host::DirectoryLock lock{work};
    tumble::host::write_if_changed(header, tumble::host::compiled_scene(scene, {}));

    // One build for each core and level; it holds the programs that are run.
    std::vector<std::pair<std::string, std::string>> builds;
    for (const std::string& core : options.cores)
        for (const std::string& level : options.levels) builds.emplace_back(core, level);
    Progress progress(static_cast<std::int64_t>(builds.size() + jobs.size()), Progress::Piped::tenths);
    std::vector<std::optional<StepFirmware>> firmware(builds.size());
    const auto index_of = [&](const Job& job) {
        const std::pair build{job.core, job.level};
        return static_cast<std::size_t>(std::find(builds.begin(), builds.end(), build) - builds.begin());
    };
    in_parallel(builds.size(), [&](std::size_t b) {
        const auto& [core, level] = builds[b];
        std::vector<std::string> methods, programs;
        for (const Job& job : jobs)
            if (index_of(job) == b) {
                methods.push_back(job.method);
                programs.push_back(StepFirmware::name_of(job.variant, job.method));
            }
        firmware[b].emplace(work / (level == "-O2" ? core : core + level), core,
                            tumble::host::struct_name(options.scene.string()), header, methods,
                            StepFirmware::Compilation{.level = level, .is_separate = options.separate});
        if (!programs.empty()) firmware[b]->build(programs);
        progress.step("built for " + core);
    });
    in_parallel(jobs.size(), [&](std::size_t i) {
        Job& job = jobs[i];
        tumble::host::StepOutcome outcome =
            firmware[index_of(job)]->run(StepFirmware::name_of(job.variant, job.method));
        job.row = std::move(outcome.row);
        job.error = outcome.error;
        job.shortage = outcome.shortage;
        if (!job.row.is_null()) complete(job, scene, answers.at({job.variant.name, job.method}));
        progress.step(job.core + " " + job.variant.name + " " + job.method);
    });
}

// Names the number systems that suit a core and were not measured.
void print_other_numbers(const Options& options) {
    for (const std::string& core : options.cores)
        for (const std::string& numbers : numbers_of_core(core))
            if (std::find(options.numbers.begin(), options.numbers.end(), numbers) == options.numbers.end())
                std::printf("%s also suits %s, which ARGS=--all measures\n", core.c_str(), numbers.c_str());
}

// Writes the rows, prints the answer first and then the table; the exit status.
int report(const Options& options, const SceneDescription& scene, const std::vector<Job>& jobs, std::size_t left_out,
           OutputFile& file) {
    std::vector<Row> rows;
    for (const Job& job : jobs)
        if (job.is_good()) rows.push_back(job.row);
    write_rows(file, rows);
    const auto failed = std::count_if(jobs.begin(), jobs.end(), [](const Job& job) { return !job.error.empty(); });

    if (options.tolerance > 0) print_answer(options.cores, jobs, scene, options.tolerance);
    print_table(jobs, options.front ? Shown::front : Shown::all);
    std::printf("%zu rows in %s", rows.size(), options.results.c_str());
    if (left_out > 0)
        std::printf("; %zu not measured: they miss the tolerance, or another method is more accurate and costs less "
                    "for a free body (%s)",
                    left_out, options.front->c_str());
    if (failed > 0) std::printf("; %td FAILED", failed);
    std::printf("\n");
    if (options.front) print_other_numbers(options);
    return failed == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    int status = 0;
    const std::optional<Options> options = Options::parse(argc, argv, status);
    if (!options) return status;

    tumble::host::check_outputs({{"the scene", options->scene}}, {{"--results", options->results}});
    const SceneDescription scene = tumble::host::read_scene(options->scene, tumble::host::BodyCount::any);
    OutputFile file = rows_file(options->results);
    std::vector<Job> jobs = jobs_of(*options);
    const Answers answers = replayed_on_host(scene, jobs, options->accuracy);
    add_accuracy(jobs, answers);
    std::size_t left_out = options->front ? leave_out_beaten(jobs, read_rows(*options->front)) : 0;
    if (options->front && options->tolerance > 0) left_out += leave_out_inaccurate(jobs, options->tolerance);
    measure(jobs, *options, scene, answers);
    return report(*options, scene, jobs, left_out, file);
} catch (...) { return tumble::bench::report_failure("tumble_matrix"); }
