// Runs random scenes, or scene files with every method in every number system, and reports each that breaks the
// property of judge.hpp, with what repeats it. Trials run in child processes, so that a trap, a sanitizer's report or
// an endless loop is a finding like others.
#include <sys/mman.h>
#include <sys/time.h>
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
#include <set>
#include <thread>

#include "judge.hpp"
#include "scene/error.hpp"
#include "scene/scene_file.hpp"
#include "simulation/simulation.hpp"
#include "tools/text.hpp"

namespace tumble::test {
namespace {

using namespace host;
using host::runs_in;
using Kind = Judgement::Kind;

constexpr time_t seconds_of_a_trial = 60;  // CPU, under sanitizers too
// Largest shares of random scenes that may be refused or undecided, where there are enough scenes to tell.
constexpr double most_refused = 0.06, most_undecided = 0.25;
constexpr std::size_t enough_scenes = 1000;
constexpr const char* kind_words[] = {"agrees", "undecided", "told", "refused", "WRONG"};  // of kinds

// What a child has found out about one trial, in memory that its parent shares.
struct Slot {
    bool is_done = false;
    Kind kind{};
    double compared = 0, share = 0;
    char what[400] = "";

    void set(const Judgement& judgement) {
        kind = judgement.kind;
        compared = judgement.compared;
        share = judgement.share;
        std::snprintf(what, sizeof what, "%s", judgement.what.c_str());
        is_done = true;
    }
};

// In a child: every jobs-th trial from the first on.
[[noreturn]] void judge_in_child(Slot* slots, const std::vector<Trial>& trials, std::size_t first, unsigned jobs) {
    for (std::size_t i = first; i < trials.size(); i += jobs) {
        const itimerval timer{{}, {seconds_of_a_trial, 0}};  // its signal ends the process
        setitimer(ITIMER_PROF, &timer, nullptr);
        slots[i].set(judge(trials[i]));
    }
    std::_Exit(0);
}

std::vector<Judgement> judge_all(const std::vector<Trial>& trials, unsigned jobs) {
    const std::size_t count = trials.size(), size = (count + 1) * sizeof(Slot);
    void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) throw std::runtime_error("no memory for the results");
    Slot* const slots = static_cast<Slot*>(memory);
    std::map<pid_t, std::size_t> first;  // trial of each child
    const auto start = [&](std::size_t trial) {
        if (trial >= count) return;
        std::cout.flush();
        const pid_t child = fork();
        if (child < 0) throw std::runtime_error("no process can be started");
        if (child == 0) judge_in_child(slots, trials, trial, jobs);
        first[child] = trial;
    };
    for (unsigned job = 0; job < jobs; ++job) start(job);
    while (!first.empty()) {
        int status = 0;
        const pid_t ended = wait(&status);
        if (ended < 0) throw std::runtime_error("a process is lost");
        std::size_t i = first.at(ended);
        first.erase(ended);
        while (i < count && slots[i].is_done) i += jobs;
        if (i >= count) continue;
        slots[i].set({Kind::wrong, WIFSIGNALED(status) ? std::string("ended by ") + strsignal(WTERMSIG(status))
                                                       : "ended with status " + std::to_string(WEXITSTATUS(status))});
        start(i + jobs);
    }
    std::vector<Judgement> judgements;
    for (std::size_t i = 0; i < count; ++i)
        judgements.push_back({slots[i].kind, slots[i].what, slots[i].compared, slots[i].share});
    munmap(memory, size);
    return judgements;
}

void drop_body(SceneDescription& scene, int body) {
    const auto drop_those = [body](auto& list, auto of) {
        std::erase_if(list, [&](const auto& item) { return item.*of == body; });
        for (auto& item : list) item.*of -= item.*of > body ? 1 : 0;
    };
    scene.bodies.erase(scene.bodies.begin() + body);
    drop_those(scene.springs, &SpringDescription::body);
    drop_those(scene.springs, &SpringDescription::to_body);
    drop_those(scene.joints, &JointDescription::body);
    drop_those(scene.joints, &JointDescription::to_body);
    drop_those(scene.impulses, &ImpulseDescription::body);
    drop_those(scene.forces, &ForceDescription::body);
}

// All scenes that lack one thing, or in which one number is 0.
std::vector<SceneDescription> smaller(const SceneDescription& scene) {
    std::vector<SceneDescription> list;
    for (int b = 0; scene.bodies.size() > 1 && b < static_cast<int>(scene.bodies.size()); ++b)
        drop_body(list.emplace_back(scene), b);
    const auto drop_each = [&](auto member) {
        for (std::ptrdiff_t i = 0; i < std::ssize(scene.*member); ++i) {
            auto& things = list.emplace_back(scene).*member;
            things.erase(things.begin() + i);
        }
    };
    drop_each(&SceneDescription::planes);
    drop_each(&SceneDescription::springs);
    drop_each(&SceneDescription::joints);
    drop_each(&SceneDescription::impulses);
    drop_each(&SceneDescription::forces);
    if (scene.contact.sleep) list.emplace_back(scene).contact.sleep.reset();
    SceneDescription changed = scene;
    for_each_number(changed, [&](double& x, Measure) {
        if (const double number = std::exchange(x, 0); number != 0) list.push_back(changed), x = number;
    });
    return list;
}

void shrink(Trial& trial, Judgement& judgement) {
    for (bool is_smaller = true; is_smaller;) {
        is_smaller = false;
        for (const SceneDescription& scene : smaller(trial.scene)) {
            const Trial next{scene, trial.kind, trial.method};
            const Judgement of_next = judge_all({next}, 1).front();
            if (of_next.kind != Kind::wrong) continue;
            trial = next;
            judgement = of_next;
            is_smaller = true;
            break;
        }
    }
}

// The part of the message with which a file is to be refused, in a line of its own.
std::string expected_refusal(const std::string& file) {
    const std::string mark = "# refused: ";
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(mark)) return line.substr(mark.size());
    return {};
}

// Each file that is not to be refused with each method in each number system; whether files are refused as they say.
bool read_trials(const std::vector<std::string>& files, std::vector<Trial>& trials) {
    std::set<std::pair<std::string, bool>> variants;  // the worlds of fixed point are there once a range
    for (const NumberSystemInfo& system : number_systems()) variants.emplace(system.name, system.carry);
    bool is_right = true;
    for (const std::string& file : files) {
        std::string message;
        try {
            const SceneDescription scene = read_scene(file);
            for (const IntegratorInfo& integrator : host::integrators())
                for (const auto& [numbers, carry] : variants)
                    if (runs_in(integrator, numbers))
                        trials.push_back({scene, file, {integrator.name, numbers, carry}});
        } catch (const SceneError& error) { message = error.what(); }
        const std::string expected = expected_refusal(file);
        if (expected.empty() == message.empty() && message.find(expected) != std::string::npos) continue;
        std::cout << "WRONG " << file << ": expected refusal \"" << expected << "\", got \"" << message << "\"\n";
        is_right = false;
    }
    return is_right;
}

void write_shrunk(const std::filesystem::path& path, Trial trial, Judgement judgement, const std::string& options) {
    shrink(trial, judgement);
    std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path);
    file << "# " << judgement.what << "\n# tumble run " << path.string() << " " << options << "\n"
         << scene_text(trial.scene);
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path.string());
    std::cout << "  written to " << path.string() << "\n";
}

// A row for each kind of scene or file, each number system, and all.
void print_table(const std::vector<Trial>& trials, const std::vector<Judgement>& judgements) {
    std::map<std::string, std::map<Kind, int>> rows;
    std::map<std::string, double> compared;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const Method& method = trials[i].method;
        for (const auto& name : {trials[i].kind, numbers_text(method.numbers, method.carry), std::string("~ all")}) {
            ++rows[name][judgements[i].kind];
            compared[name] += 100 * judgements[i].compared;
        }
    }
    for (auto& [name, row] : rows) {
        int all = 0;
        for (const Kind kind : {Kind::agrees, Kind::undecided, Kind::told, Kind::refused, Kind::wrong}) {
            std::printf("%6d %s", row[kind], kind_words[static_cast<int>(kind)]);
            all += row[kind];
        }
        std::printf("  %3.0f %% compared  %s\n", compared[name] / all, name.c_str());
    }
}

}  // namespace
}  // namespace tumble::test

int main(int argc, char** argv) try {
    using namespace tumble::test;
    std::uint64_t seed = std::random_device{}() % 1000000000, first = 0;
    std::size_t scenes = 20000;
    unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
    std::string write;
    std::vector<std::string> files;
    std::vector<std::uint64_t> known;
    bool only_first_modules = false, has_joints = false;
    CLI::App app{"Runs random scenes or scene files and holds them against double precision and fine references."};
    app.add_option("--seed", seed, "seed of the scenes; a new one otherwise, which is printed");
    app.add_option("--first", first, "number of the first scene");
    app.add_option("--scenes", scenes, "number of scenes")->capture_default_str()->check(CLI::PositiveNumber);
    app.add_option("--jobs", jobs, "processes")->check(CLI::PositiveNumber);
    app.add_option("--write", write, "directory for the wrong scenes, made as small as possible");
    app.add_option("--known", known, "numbers of scenes that are known to end wrong: those that do not any more fail")
        ->delimiter(',');
    app.add_flag("--joints", has_joints, "scenes of bodies on joints, which the others do not have");
    app.add_flag("--first-modules", only_first_modules,
                 "leave out the scenes that are drawn for another carry than the default or for an unusual method");
    app.add_option("files", files, "scenes to judge instead of random ones");
    CLI11_PARSE(app, argc, argv);

    const std::string range = "seed " + std::to_string(seed) + ", scenes from " + std::to_string(first) + " on";
    std::vector<Trial> trials;
    bool is_right = read_trials(files, trials);
    for (std::uint64_t i = 0; files.empty() && i < scenes; ++i)
        trials.push_back(draw_trial(seed, first + i, has_joints));
    std::cout << (files.empty() ? range : std::to_string(files.size()) + " files") << std::endl;
    if (only_first_modules)
        std::erase_if(trials, [](const Trial& trial) {
            return trial.method.carry != tumble::host::default_carry(trial.method.numbers) ||
                   !tumble::host::find_integrator(trial.method.integrator).is_usual;
        });
    const std::vector<Judgement> judgements = judge_all(trials, jobs);
    std::map<Kind, double> share;
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const auto& [scene, kind, method, index] = trials[i];
        Judgement judgement = judgements[i];
        if (judgement.kind == Kind::refused && !files.empty()) judgement.kind = Kind::wrong;  // by the simulation
        if (std::erase(known, index) > 0) {
            is_right = is_right && judgement.kind == Kind::wrong;
            std::cout << (judgement.kind == Kind::wrong ? "known" : "WRONG no more: known") << " scene " << index
                      << ": " << judgement.what << "\n";
            continue;
        }
        share[judgement.kind] += 1 / static_cast<double>(trials.size());
        if (judgement.kind != Kind::wrong) continue;
        const std::string options = "--integrator " + method.integrator + " --numbers " + method.numbers + " --carry " +
                                    (method.carry ? "on" : "off");
        std::cout << kind_words[static_cast<int>(judgement.kind)] << " " << kind << ", scene " << index << " ("
                  << options << "): " << judgement.what << " (compared "
                  << tumble::host::few_digits(100 * judgement.compared) << " %, share of its bound "
                  << tumble::host::few_digits(judgement.share) << ")\n";
        const auto path = std::filesystem::path(write) / (std::to_string(seed) + "-" + std::to_string(index) + ".toml");
        if (!write.empty()) write_shrunk(path, trials[i], judgement, options);
    }
    print_table(trials, judgements);
    const bool tests_little = files.empty() && scenes >= enough_scenes &&
                              (share[Kind::refused] > most_refused || share[Kind::undecided] > most_undecided);
    if (tests_little) std::cout << "WRONG: too many scenes are refused or undecided\n";
    return share[Kind::wrong] > 0 || !is_right || tests_little ? 1 : 0;
} catch (const std::exception& error) {
    std::cerr << "tumble_property: " << error.what() << "\n";
    return 2;
}
