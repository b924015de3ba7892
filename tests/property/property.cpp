// Runs random scenes, or scene files with every method in every number system, and reports each that breaks the
// property of judge.hpp, with what repeats it. Trials run in child processes, so that a trap, a sanitizer's report or
// an endless loop is a finding like others.
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <random>
#include <thread>

#include "judge.hpp"
#include "scene/error.hpp"
#include "scene/reader.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"
#include "tools/text.hpp"

namespace tumble::test {
namespace {

using namespace host;
using Kind = Judgement::Kind;

constexpr rlim_t seconds_of_a_trial = 60;  // CPU, under sanitizers too
// Largest shares of random scenes that may be refused or undecided, where there are enough scenes to tell.
constexpr double most_refused = 0.08, most_undecided = 0.5;
constexpr std::size_t enough_scenes = 1000;

constexpr std::pair<Kind, const char*> words[] = {{Kind::agrees, "agrees"},
                                                  {Kind::undecided, "undecided"},
                                                  {Kind::told, "told"},
                                                  {Kind::refused, "refused"},
                                                  {Kind::wrong, "WRONG"}};
const char* word_of(Kind kind) { return words[static_cast<std::size_t>(kind)].second; }

std::vector<double> times;
struct Options {
    std::uint64_t seed = std::random_device{}() % 1000000000, first = 0;
    std::size_t scenes = 20000;
    unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
    std::string write, integrator, numbers;
    std::vector<std::string> files;
};

// What a child has found out about one trial, in memory that its parent shares.
struct Slot {
    bool is_done = false;
    Kind kind{};
    double compared = 0, share = 0, secs = 0;
    char what[400] = "";

    void set(const Judgement& judgement) {
        kind = judgement.kind;
        compared = judgement.compared;
        share = judgement.share;
        std::snprintf(what, sizeof what, "%s", judgement.what.c_str());
        is_done = true;
    }
};

std::string end_of(int status) {
    return WIFSIGNALED(status) ? std::string("ended by signal ") + strsignal(WTERMSIG(status))
                               : "ended with status " + std::to_string(WEXITSTATUS(status));
}

// In a child: every jobs-th trial from the first on.
template <class TrialOf>
[[noreturn]] void judge_in_child(Slot* slots, std::size_t first, std::size_t count, unsigned jobs,
                                 const TrialOf& trial_of) {
    for (std::size_t i = first; i < count; i += jobs) {
        rusage used{};
        getrusage(RUSAGE_SELF, &used);
        const rlim_t seconds = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + seconds_of_a_trial;
        const rlimit limit{seconds, RLIM_INFINITY};
        setrlimit(RLIMIT_CPU, &limit);
        rusage b{}; getrusage(RUSAGE_SELF,&b); slots[i].set(judge(trial_of(i))); rusage e{}; getrusage(RUSAGE_SELF,&e);
        slots[i].secs = double(e.ru_utime.tv_sec-b.ru_utime.tv_sec)+1e-6*double(e.ru_utime.tv_usec-b.ru_utime.tv_usec);
    }
    std::_Exit(0);
}

// The judgements of trials; trial_of(i) is called in the child.
template <class TrialOf>
std::vector<Judgement> judge_all(std::size_t count, unsigned jobs, const TrialOf& trial_of) {
    const std::size_t size = std::max<std::size_t>(1, count) * sizeof(Slot);
    void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::runtime_error("no memory for the results");
    Slot* const slots = static_cast<Slot*>(memory);
    std::map<pid_t, std::size_t> next;  // trial of each child
    const auto start = [&](std::size_t first) {
        if (first >= count) return;
        std::cout.flush();
        const pid_t child = fork();
        if (child < 0) throw std::runtime_error("no process can be started");
        if (child == 0) judge_in_child(slots, first, count, jobs, trial_of);
        next[child] = first;
    };
    for (unsigned job = 0; job < jobs; ++job) start(job);
    while (!next.empty()) {
        int status = 0;
        const pid_t ended = wait(&status);
        if (ended < 0) throw std::runtime_error("a process is lost");
        std::size_t i = next.at(ended);
        next.erase(ended);
        while (i < count && slots[i].is_done) i += jobs;
        if (i >= count) continue;
        slots[i].set({Kind::wrong, end_of(status)});
        start(i + jobs);
    }
    std::vector<Judgement> judgements;
    for (std::size_t i = 0; i < count; ++i)
        judgements.push_back({slots[i].kind, slots[i].what, slots[i].compared, slots[i].share}), times.push_back(slots[i].secs);
    munmap(memory, size);
    return judgements;
}

// --- smaller scenes that are still wrong -----------------------------------------------------------------------------

void drop_body(SceneDescription& scene, int body) {
    const auto drop_those = [body](auto& list, int std::decay_t<decltype(list.front())>::*of) {
        std::erase_if(list, [&](const auto& item) { return item.*of == body; });
        for (auto& item : list) item.*of -= item.*of > body ? 1 : 0;
    };
    scene.bodies.erase(scene.bodies.begin() + body);
    drop_those(scene.springs, &SpringDescription::body);
    drop_those(scene.springs, &SpringDescription::to_body);
    drop_those(scene.impulses, &ImpulseDescription::body);
    drop_those(scene.forces, &ForceDescription::body);
}

// All scenes that lack one thing.
std::vector<SceneDescription> smaller(const SceneDescription& scene) {
    std::vector<SceneDescription> list;
    const auto add = [&](const auto& change) { change(list.emplace_back(scene)); };
    for (int b = 0; scene.bodies.size() > 1 && b < static_cast<int>(scene.bodies.size()); ++b)
        add([&](SceneDescription& s) { drop_body(s, b); });
    const auto each = [&](const auto& member) {
        for (std::ptrdiff_t i = 0; i < std::ssize(scene.*member); ++i)
            add([&](SceneDescription& s) { (s.*member).erase((s.*member).begin() + i); });
    };
    each(&SceneDescription::planes);
    each(&SceneDescription::springs);
    each(&SceneDescription::impulses);
    each(&SceneDescription::forces);
    // What is 0 or empty where there is none.
    const auto clear = [&](const auto& member_of) {
        SceneDescription changed = scene;
        auto& member = member_of(changed);
        if (member == std::decay_t<decltype(member)>{}) return;
        member = {};
        list.push_back(changed);
    };
    clear([](SceneDescription& s) -> auto& { return s.gravity; });
    clear([](SceneDescription& s) -> auto& { return s.gravitation; });
    clear([](SceneDescription& s) -> auto& { return s.linear_drag; });
    clear([](SceneDescription& s) -> auto& { return s.angular_drag; });
    clear([](SceneDescription& s) -> auto& { return s.contact.friction; });
    if (scene.contact.sleep) add([](SceneDescription& s) { s.contact.sleep.reset(); });
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        clear([b](SceneDescription& s) -> auto& { return s.bodies[b].velocity; });
        clear([b](SceneDescription& s) -> auto& { return s.bodies[b].angular_velocity; });
    }
    return list;
}

void shrink(Trial& trial, Judgement& judgement) {
    for (bool is_smaller = true; is_smaller;) {
        is_smaller = false;
        for (const SceneDescription& scene : smaller(trial.scene)) {
            const Trial next{scene, trial.kind, trial.method};
            const Judgement of_next = judge_all(1, 1, [&](std::size_t) { return next; }).front();
            if (of_next.kind != Kind::wrong) continue;
            trial = next;
            judgement = of_next;
            is_smaller = true;
            break;
        }
    }
}

// --- report ----------------------------------------------------------------------------------------------------------

std::string options_of(const Method& method) {
    return "--integrator " + method.integrator + " --numbers " + method.numbers + " --carry " +
           (method.carry ? "on" : "off");
}

void write_shrunk(const std::filesystem::path& path, Trial trial, Judgement judgement) {
    shrink(trial, judgement);
    std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path);
    file << "# " << judgement.what << "\n# tumble run " << path.string() << " " << options_of(trial.method) << "\n"
         << scene_text(trial.scene);
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path.string());
    std::cout << "  written to " << path.string() << "\n";
}

// The part of the message with which a file is to be refused, in a line of its own.
std::string expected_refusal(const std::string& file) {
    const std::string mark = "# refused: ";
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(mark)) return line.substr(mark.size());
    return {};
}

// Each file with each method in each number system, or with those that were named.
int judge_files(const Options& options) {
    std::vector<Trial> trials;
    int wrong = 0;
    for (const std::string& file : options.files) {
        const std::string refusal = expected_refusal(file);
        SceneDescription scene;
        std::string message;
        try {
            scene = read_scene(file);
        } catch (const SceneError& error) { message = error.what(); }
        if (!refusal.empty() || !message.empty()) {
            const bool is_right = !refusal.empty() && message.find(refusal) != std::string::npos;
            std::cout << word_of(is_right ? Kind::refused : Kind::wrong) << " " << file << ": " << message << "\n";
            wrong += is_right ? 0 : 1;
            continue;
        }
        std::vector<Method> methods;
        for (const IntegratorInfo& integrator : integrators()) {
            if (!options.integrator.empty() && integrator.name != options.integrator) continue;
            for (const NumberSystemInfo& numbers : number_systems()) {
                if (!options.numbers.empty() && numbers_text(numbers.name, numbers.carry) != options.numbers) continue;
                // The worlds of q32 are listed once a range.
                const bool is_known = std::any_of(methods.begin(), methods.end(), [&](const Method& m) {
                    return m.integrator == integrator.name && m.numbers == numbers.name && m.carry == numbers.carry;
                });
                if (!is_known && runs_in(integrator, numbers.name))
                    methods.push_back({integrator.name, numbers.name, numbers.carry});
            }
        }
        for (const Method& method : methods) trials.push_back({scene, file, method});
    }
    const auto judgements = judge_all(trials.size(), options.jobs, [&](std::size_t i) { return trials[i]; });
    for (std::size_t i = 0; i < trials.size(); ++i) {
        Judgement judgement = judgements[i];
        if (judgement.kind == Kind::refused) judgement.kind = Kind::wrong;  // by the simulation
        if (judgement.kind == Kind::wrong) ++wrong;
        std::cout << word_of(judgement.kind) << " " << trials[i].kind << " " << options_of(trials[i].method) << " "
                  << judgement.what << " (compared " << few_digits(100 * judgement.compared) << " %, share "
                  << few_digits(judgement.share) << ")\n";
    }
    std::cout << trials.size() << " runs of " << options.files.size() << " scenes, " << wrong << " wrong\n";
    return wrong > 0 ? 1 : 0;
}

// A row for each kind of scene and each number system.
template <class TrialOf>
void print_table(const TrialOf& trial_of, const std::vector<Judgement>& judgements) {
    struct Row {
        std::map<Kind, int> count;
        std::vector<double> shares;
        double compared = 0;
    };
    std::map<std::string, Row> rows;
    for (std::size_t i = 0; i < judgements.size(); ++i) {
        const Trial trial = trial_of(i);
        for (const auto& name : {trial.kind, numbers_text(trial.method.numbers, trial.method.carry), std::string("~")}) {
            Row& row = rows[name];
            ++row.count[judgements[i].kind];
            row.shares.push_back(judgements[i].share);
            row.compared += judgements[i].compared;
        }
    }
    std::printf("%-14s", "");
    for (const auto& [kind, word] : words) std::printf("%10s", word);
    std::printf("  compared  largest difference in parts of its bound: median, 99 %%\n");
    for (auto& [name, row] : rows) {
        std::sort(row.shares.begin(), row.shares.end());
        const std::size_t last = row.shares.size() - 1;
        std::printf("%-14s", name.c_str());
        for (const auto& [kind, word] : words) std::printf("%10d", row.count[kind]);
        std::printf("  %6.1f %%  %.1e  %.1e\n", 100 * row.compared / static_cast<double>(last + 1),
                    row.shares[last / 2], row.shares[last * 99 / 100]);
    }
}

int judge_random(const Options& options) {
    std::cout << "seed " << options.seed << ", scenes " << options.first << " to " << options.first + options.scenes - 1
              << std::endl;
    const auto trial_of = [&](std::size_t i) { return draw_trial(options.seed, options.first + i); };
    const std::vector<Judgement> judgements = judge_all(options.scenes, options.jobs, trial_of);
    std::map<Kind, double> share;
    for (std::size_t i = 0; i < judgements.size(); ++i) {
        share[judgements[i].kind] += 1 / static_cast<double>(options.scenes);
        if (getenv("ALL")) { const Trial t = trial_of(i); std::cout << "ALL " << i << " " << word_of(judgements[i].kind) << " [" << t.kind << "] " << t.method.numbers << (t.method.carry?"+":"-") << " " << t.method.integrator << " c=" << judgements[i].compared << " s=" << judgements[i].share << " t=" << times[i] << " " << judgements[i].what << "\n"; }
        if (judgements[i].kind != Kind::wrong) continue;
        const Trial trial = trial_of(i);
        const std::string seed = std::to_string(options.seed), index = std::to_string(options.first + i);
        std::cout << "WRONG " << trial.kind << " (" << options_of(trial.method) << "): " << judgements[i].what
                  << "\n  repeat: tumble_property --seed " << seed << " --first " << index
                  << " --scenes 1 --write DIRECTORY\n";
        if (!options.write.empty())
            write_shrunk(std::filesystem::path(options.write) / (seed + "-" + index + ".toml"), trial, judgements[i]);
    }
    print_table(trial_of, judgements);
    bool tests_little = false;
    for (const auto& [kind, most] : {std::pair{Kind::refused, most_refused}, {Kind::undecided, most_undecided}}) {
        if (options.scenes < enough_scenes || share[kind] <= most) continue;
        std::cout << "WRONG: " << few_digits(100 * share[kind]) << " % of the scenes are " << word_of(kind)
                  << ", at most " << few_digits(100 * most) << " % may be\n";
        tests_little = true;
    }
    return share[Kind::wrong] > 0 || tests_little ? 1 : 0;
}

}  // namespace
}  // namespace tumble::test

int main(int argc, char** argv) {
    using namespace tumble::test;
    Options options;
    CLI::App app{"Runs random scenes or scene files and holds them against double precision and fine references."};
    app.add_option("--seed", options.seed, "seed of the scenes; a new one otherwise, which is printed");
    app.add_option("--first", options.first, "number of the first scene");
    app.add_option("--scenes", options.scenes, "number of scenes")->capture_default_str()->check(CLI::PositiveNumber);
    app.add_option("--jobs", options.jobs, "processes")->check(CLI::PositiveNumber);
    app.add_option("--write", options.write, "directory for the wrong scenes, made as small as possible");
    app.add_option("files", options.files, "scenes to judge instead of random ones");
    app.add_option("--integrator", options.integrator, "the only method that files are run with; see `tumble list`");
    app.add_option("--numbers", options.numbers, "the only number system of files, as \"q32 carry\"");
    CLI11_PARSE(app, argc, argv);
    try {
        return options.files.empty() ? judge_random(options) : judge_files(options);
    } catch (const std::exception& error) {
        std::cerr << "tumble_property: " << error.what() << "\n";
        return 2;
    }
}
