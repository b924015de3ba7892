// Random scenes in one number system and in double precision: whatever ends wrong without a status is printed, with
// what repeats it. Each scene runs in a process of its own kind, so that a trap, a sanitizer's report or an endless
// loop is a finding like others.
#include <fcntl.h>
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

#include "differential.hpp"
#include "scene/error.hpp"
#include "scene/reader.hpp"
#include "scene_text.hpp"
#include "simulation/simulation.hpp"
#include "tools/text.hpp"

namespace tumble::test {
namespace {

using namespace host;

constexpr rlim_t seconds_of_a_scene = 60;  // CPU, under sanitizers too
// Of so many random scenes and more, the part that may be refused: planes and anchors beyond what formats hold, and
// absurd numbers, which are drawn on purpose, make 5 %.
constexpr double most_refused = 0.08;
constexpr std::uint64_t enough_scenes = 1000;

struct Options {
    std::uint64_t seed = 0, first = 0, scenes = 20000;
    unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
    std::string write;
    std::vector<std::string> files;
    std::string integrator, numbers;  // the only ones; empty: all of the files, those drawn for random scenes
};

// What a child has found out about one trial, in memory that its parent shares.
struct Slot {
    bool done = false;
    Verdict::Kind kind{};
    std::int64_t step = 0;
    double compared = 0, share = 0;
    char what[360] = "";

    void set(const Verdict& verdict) {
        kind = verdict.kind;
        step = verdict.step;
        compared = verdict.compared;
        share = verdict.share;
        std::snprintf(what, sizeof what, "%s", verdict.what.c_str());
        done = true;
    }
    [[nodiscard]] Verdict verdict() const { return {kind, what, step, compared, share}; }
};

class Slots {
public:
    explicit Slots(std::size_t count) : size_(count * sizeof(Slot)) {
        memory_ = mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
        if (memory_ == MAP_FAILED) throw std::runtime_error("no memory for the results");
        for (std::size_t i = 0; i < count; ++i) new (&(*this)[i]) Slot;
    }
    ~Slots() { munmap(memory_, size_); }
    Slots(const Slots&) = delete;
    Slots& operator=(const Slots&) = delete;
    [[nodiscard]] Slot& operator[](std::size_t i) const { return static_cast<Slot*>(memory_)[i]; }

private:
    std::size_t size_;
    void* memory_ = nullptr;
};

// The verdicts of trials, each in a child process; `trial(i)` is called there.
template <class TrialOf>
std::vector<Verdict> judge_apart(std::size_t count, unsigned jobs, const TrialOf& trial_of) {
    const Slots slots(count);
    struct Worker {
        pid_t process;
        std::size_t next;  // of its trials, every jobs-th
    };
    const auto start = [&](std::size_t first) {
        std::cout.flush();
        const pid_t child = fork();
        if (child < 0) throw std::runtime_error("no process can be started");
        if (child > 0) return Worker{child, first};
        for (std::size_t i = first; i < count; i += jobs) {
            rusage used{};
            getrusage(RUSAGE_SELF, &used);
            const rlim_t limit = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + seconds_of_a_scene;
            const rlimit bound{limit, RLIM_INFINITY};
            setrlimit(RLIMIT_CPU, &bound);
            slots[i].set(judge(trial_of(i)));
        }
        std::_Exit(0);
    };
    std::vector<Worker> workers;
    for (std::size_t w = 0; w < std::min<std::size_t>(jobs, count); ++w) workers.push_back(start(w));
    while (!workers.empty()) {
        int status = 0;
        const pid_t ended = waitpid(workers.back().process, &status, 0);
        if (ended < 0) throw std::runtime_error("a process is lost");
        std::size_t i = workers.back().next;
        workers.pop_back();
        while (i < count && slots[i].done) i += jobs;
        if (i >= count) continue;
        Verdict verdict;
        verdict.kind = Verdict::Kind::wrong;
        verdict.what = WIFSIGNALED(status) ? std::string("ended by signal ") + strsignal(WTERMSIG(status))
                                           : "ended with status " + std::to_string(WEXITSTATUS(status));
        slots[i].set(verdict);
        if (i + jobs < count) workers.push_back(start(i + jobs));
    }
    std::vector<Verdict> verdicts;
    for (std::size_t i = 0; i < count; ++i) verdicts.push_back(slots[i].verdict());
    return verdicts;
}
Verdict judge_apart(const Trial& trial) {
    return judge_apart(1, 1, [&](std::size_t) { return trial; }).front();
}

// --- smaller scenes that are still wrong -----------------------------------------------------------------------------

template <class List>
void drop(List& list, std::size_t i) {
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
}

void drop_body(SceneDescription& scene, int body) {
    drop(scene.bodies, static_cast<std::size_t>(body));
    const auto drop_those = [body](auto& list) {
        std::erase_if(list, [body](const auto& item) { return item.body == body; });
        for (auto& item : list) item.body -= item.body > body ? 1 : 0;
    };
    std::erase_if(scene.springs, [body](const SpringDescription& spring) { return spring.to_body == body; });
    for (SpringDescription& spring : scene.springs) spring.to_body -= spring.to_body > body ? 1 : 0;
    drop_those(scene.springs);
    drop_those(scene.impulses);
    drop_those(scene.forces);
}

// All scenes that lack one thing.
std::vector<SceneDescription> smaller(const SceneDescription& scene) {
    std::vector<SceneDescription> list;
    const auto add = [&](const auto& change) {
        list.push_back(scene);
        change(list.back());
    };
    for (int b = 0; scene.bodies.size() > 1 && b < static_cast<int>(scene.bodies.size()); ++b)
        add([&](SceneDescription& s) { drop_body(s, b); });
    const auto each = [&](const auto& member) {
        for (std::size_t i = 0; i < (scene.*member).size(); ++i) add([&](SceneDescription& s) { drop(s.*member, i); });
    };
    each(&SceneDescription::planes);
    each(&SceneDescription::springs);
    each(&SceneDescription::impulses);
    each(&SceneDescription::forces);
    const auto zero = [&](const auto& member) {
        if (scene.*member != std::decay_t<decltype(scene.*member)>{}) add([&](SceneDescription& s) { s.*member = {}; });
    };
    zero(&SceneDescription::gravity);
    zero(&SceneDescription::gravitation);
    zero(&SceneDescription::linear_drag);
    zero(&SceneDescription::angular_drag);
    if (scene.contact.friction > 0) add([](SceneDescription& s) { s.contact.friction = 0; });
    if (scene.contact.sleep) add([](SceneDescription& s) { s.contact.sleep.reset(); });
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        if (scene.bodies[b].velocity != Triple{}) add([b](SceneDescription& s) { s.bodies[b].velocity = {}; });
        if (scene.bodies[b].angular_velocity != Triple{})
            add([b](SceneDescription& s) { s.bodies[b].angular_velocity = {}; });
    }
    return list;
}

void shrink(Trial& trial, Verdict& verdict) {
    for (bool smaller_one = true; smaller_one;) {
        smaller_one = false;
        for (const SceneDescription& scene : smaller(trial.scene)) {
            Trial next = trial;
            next.scene = scene;
            const Verdict of_next = judge_apart(next);
            if (of_next.kind != Verdict::Kind::wrong) continue;
            trial = next;
            verdict = of_next;
            smaller_one = true;
            break;
        }
    }
}

const std::map<Verdict::Kind, const char*> words{{Verdict::Kind::agrees, "agrees"},
                                                 {Verdict::Kind::told, "told"},
                                                 {Verdict::Kind::named, "named"},
                                                 {Verdict::Kind::refused, "refused"},
                                                 {Verdict::Kind::wrong, "WRONG"}};

// --- report ----------------------------------------------------------------------------------------------------------

std::string run_of(const Trial& trial) {
    return "--integrator " + trial.integrator + " --numbers " + trial.numbers + " --carry " +
           (trial.carry ? "on" : "off");
}

void write_scene(const std::string& directory, const Trial& trial, const Verdict& verdict, const std::string& name) {
    const std::filesystem::path path = std::filesystem::path(directory) / (name + ".toml");
    std::filesystem::create_directories(directory);
    std::ofstream file(path);
    file << "# " << verdict.what << ", at step " << verdict.step << "\n# tumble run " << path.string() << " "
         << run_of(trial) << "\n"
         << scene_text(trial.scene);
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path.string());
    std::cout << "  written to " << path.string() << "\n";
}

void report(Trial trial, Verdict verdict, const std::string& repeat, const std::string& name,
            const std::string& write) {
    std::cout << "WRONG " << name << " " << trial.kind << " (" << run_of(trial) << ") at step " << verdict.step << ": "
              << verdict.what << " (share " << few_digits(verdict.share) << ")\n  repeat: " << repeat << "\n";
    if (write.empty()) return;
    shrink(trial, verdict);
    write_scene(write, trial, verdict, name);
}

// What a file that is to be refused says of it: a part of the message, in a line of its own.
std::string expected_refusal(const std::string& file) {
    const std::string mark = "# refused: ";
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(mark)) return line.substr(mark.size());
    return {};
}

// Each file with each method in each number system that it runs in, or with those that were named. A refusal is right
// where the file expects it.
int judge_files(const Options& options) {
    std::vector<Trial> trials;
    int wrong = 0;
    for (const std::string& file : options.files) {
        const std::string refusal = expected_refusal(file);
        SceneDescription scene;
        try {
            scene = read_scene(file);
        } catch (const SceneError& error) {
            const bool right = !refusal.empty() && std::string(error.what()).find(refusal) != std::string::npos;
            std::cout << words.at(right ? Verdict::Kind::refused : Verdict::Kind::wrong) << " " << error.what() << "\n";
            wrong += right ? 0 : 1;
            continue;
        }
        if (!refusal.empty()) {
            std::cout << words.at(Verdict::Kind::wrong) << " " << file << " is read; expected: " << refusal << "\n";
            ++wrong;
            continue;
        }
        for (const BodyDescription& body : scene.bodies)
            if (!body.mass) throw std::runtime_error(file + ": " + body.name + ": expected mass, not density");
        for (const IntegratorInfo& integrator : integrators()) {
            if (!options.integrator.empty() && integrator.name != options.integrator) continue;
            for (const NumberSystemInfo& numbers : number_systems()) {
                const std::string name = numbers_text(numbers.name, numbers.carry);
                const bool is_base = numbers.name == "f64" && !numbers.carry;
                if (is_base || !runs_in(integrator, numbers.name)) continue;
                if (!options.numbers.empty() && name != options.numbers) continue;
                Trial trial{scene, file, integrator.name, numbers.name, numbers.carry};
                if (trials.empty() || run_of(trials.back()) != run_of(trial) || trials.back().kind != file)
                    trials.push_back(std::move(trial));
            }
        }
    }
    load_worlds(options.numbers);
    const std::vector<Verdict> verdicts =
        judge_apart(trials.size(), options.jobs, [&](std::size_t i) { return trials[i]; });
    for (std::size_t i = 0; i < trials.size(); ++i) {
        Verdict verdict = verdicts[i];
        if (verdict.kind == Verdict::Kind::refused) verdict.kind = Verdict::Kind::wrong;  // by the simulation
        if (verdict.kind == Verdict::Kind::wrong) ++wrong;
        std::cout << words.at(verdict.kind) << " " << trials[i].kind << " " << run_of(trials[i]) << " " << verdict.what
                  << " (compared " << few_digits(100 * verdict.compared) << " %, share " << few_digits(verdict.share)
                  << ")\n";
    }
    std::cout << trials.size() << " runs of " << options.files.size() << " scenes, " << wrong << " wrong\n";
    return wrong > 0 ? 1 : 0;
}

struct Row {
    std::map<Verdict::Kind, std::uint64_t> count;
    double compared = 0;
    std::vector<double> shares;

    void add(const Verdict& verdict) {
        ++count[verdict.kind];
        compared += verdict.compared;
        if (verdict.compared > 0) shares.push_back(verdict.share);
    }
};

// A row for each kind of scene and number system.
template <class TrialOf>
void print_table(const TrialOf& trial_of, const std::vector<Verdict>& verdicts) {
    std::map<std::string, Row> rows;
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        const Trial trial = trial_of(i);
        for (const std::string& name : {trial.kind, numbers_text(trial.numbers, trial.carry), std::string("~all")})
            rows[name].add(verdicts[i]);
    }
    std::printf("%-16s%7s%7s%7s%7s%8s%7s  %9s  %s\n", "", "scenes", "agree", "told", "named", "refused", "wrong",
                "compared", "largest difference, parts of its bound: median, 90 %, 99 %");
    for (auto& [name, row] : rows) {
        std::sort(row.shares.begin(), row.shares.end());
        std::uint64_t all = 0;
        for (const auto& [kind, n] : row.count) all += n;
        std::printf("%-16s%7llu", name.c_str(), static_cast<unsigned long long>(all));
        for (const auto kind : {Verdict::Kind::agrees, Verdict::Kind::told, Verdict::Kind::named,
                                Verdict::Kind::refused, Verdict::Kind::wrong})
            std::printf("%7llu", static_cast<unsigned long long>(row.count[kind]));
        std::printf("  %7.1f %%", 100 * row.compared / static_cast<double>(all));
        for (const double part : {0.5, 0.9, 0.99}) {
            if (!row.shares.empty())
                std::printf("  %.1e",
                            row.shares[static_cast<std::size_t>(part * static_cast<double>(row.shares.size() - 1))]);
        }
        std::printf("\n");
    }
}

int judge_random(const Options& options) {
    std::cout << "seed " << options.seed << ", scenes " << options.first << " to " << options.first + options.scenes - 1
              << std::endl;
    load_worlds(options.numbers);
    const auto trial_of = [&](std::size_t i) {
        Trial trial = draw_trial(options.seed, options.first + i);
        for (const NumberSystemInfo& system : number_systems()) {
            if (options.numbers != numbers_text(system.name, system.carry)) continue;
            trial.numbers = system.name;
            trial.carry = system.carry;
        }
        return trial;
    };
    const std::vector<Verdict> verdicts = judge_apart(options.scenes, options.jobs, trial_of);
    std::map<Verdict::Kind, std::uint64_t> count;
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        const Verdict& verdict = verdicts[i];
        ++count[verdict.kind];
        if (verdict.kind != Verdict::Kind::wrong) continue;
        const std::string seed = std::to_string(options.seed), index = std::to_string(options.first + i);
        report(trial_of(i), verdict,
               "tumble_property --seed " + seed + " --first " + index + " --scenes 1 --write DIRECTORY",
               seed + "-" + index, options.write);
    }
    print_table(trial_of, verdicts);
    const double refused = static_cast<double>(count[Verdict::Kind::refused]) / static_cast<double>(options.scenes);
    const bool tests_little = options.scenes >= enough_scenes && refused > most_refused;
    if (tests_little)
        std::cout << "WRONG: " << few_digits(100 * refused) << " % of the scenes are refused, at most "
                  << few_digits(100 * most_refused) << " % may be\n";
    return count[Verdict::Kind::wrong] > 0 || tests_little ? 1 : 0;
}

}  // namespace
}  // namespace tumble::test

int main(int argc, char** argv) {
    using namespace tumble::test;
    Options options;
    options.seed = std::random_device{}() % 1000000000;
    CLI::App app{"Random scenes, and scenes from files, held against runs in double precision."};
    app.add_option("--seed", options.seed, "of the scenes; a new one otherwise, which is printed");
    app.add_option("--first", options.first, "number of the first scene");
    app.add_option("--scenes", options.scenes, "number of scenes")->capture_default_str()->check(CLI::PositiveNumber);
    app.add_option("--jobs", options.jobs, "processes")->check(CLI::PositiveNumber);
    app.add_option("--write", options.write, "directory for the scenes that are wrong, made smaller");
    app.add_option("files", options.files, "scenes to judge instead of random ones");
    app.add_option("--integrator", options.integrator, "the only one that files are run with; see `tumble list`");
    app.add_option("--numbers", options.numbers, "the only number system, as \"q32 carry\"");
    CLI11_PARSE(app, argc, argv);
    try {
        return options.files.empty() ? judge_random(options) : judge_files(options);
    } catch (const std::exception& error) {
        std::cerr << "tumble_property: " << error.what() << "\n";
        return 2;
    }
}
