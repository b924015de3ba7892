// Times this kernel, Boost.Odeint, Bullet, ODE and MuJoCo on the same problems in one run of one program, and writes a
// row each. A contender with a wrong answer is not timed.
//
// The time of a step is the smallest CPU time of the repetitions. Other load on the machine only adds to a time, so the
// smallest is nearest to the cost of the program. Repetitions of all contenders of a problem are interleaved at random,
// so that a change of the machine's clock affects all of them.
#include "problems.hpp"
#include "rows/rows.hpp"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <iostream>
#include <map>

namespace {

using namespace tumble;
using namespace tumble::bench;

struct Errors {
    double position = 0, orientation = 0;  // m, rad; the largest
};

// Runs the problem from its start and compares. Throws std::runtime_error if an error exceeds its bound.
Errors check(const Problem& problem, Runner& runner) {
    Errors errors;
    int steps = 0;
    for (const Problem::Sample& sample : problem.truth) {
        runner.run(sample.steps - steps);
        steps = sample.steps;
        const Motions motions = runner.motions();
        for (int b = 0; b < static_cast<int>(sample.bodies.size()); ++b) {
            if (problem.scene.bodies[static_cast<std::size_t>(b)].fixed) continue;
            const auto i = static_cast<std::size_t>(b);
            const reference::Motion &now = motions[i], &truth = sample.bodies[i];
            const double position = static_cast<double>(norm(now.x - truth.x)),
                         orientation = static_cast<double>(angle_between(now.q, truth.q));
            // This comparison is false for NaN.
            if (!(position <= problem.position_within) ||
                (problem.orientation_within > 0 && !(orientation <= problem.orientation_within)))
                throw std::runtime_error{"body " + std::to_string(b) + " is " + std::to_string(position) + " m and " +
                                         std::to_string(orientation) + " rad from the truth after " +
                                         std::to_string(steps) + " steps"};
            if (problem.sleeps() && !runner.asleep(b))
                throw std::runtime_error{"body " + std::to_string(b) + " is awake"};
            errors.position = std::max(errors.position, position);
            errors.orientation = std::max(errors.orientation, orientation);
        }
    }
    return errors;
}

double cpu_seconds() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A contender on a problem.
struct Entry {
    const Contender* contender;
    std::unique_ptr<Runner> runner;
    Errors errors;
    std::string failure = {};     // why it is not timed
    std::vector<double> ns = {};  // of a step and body, for each repetition
    [[nodiscard]] double least() const { return *std::min_element(ns.begin(), ns.end()); }
    [[nodiscard]] double median() const {
        std::vector<double> sorted = ns;
        std::sort(sorted.begin(), sorted.end());
        return sorted[sorted.size() / 2];
    }
    [[nodiscard]] std::string name() const {
        const Contender& c = *contender;
        return c.engine + ", " + c.method + ", " + host::numbers_text(c.numbers, c.carry);
    }
};

class Collector final : public benchmark::BenchmarkReporter {
public:
    Collector(const Problem& problem, std::vector<Entry>& entries) : problem_{problem}, entries_{entries} {}
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override {
        for (const Run& run : runs) {
            if (run.error_occurred) throw std::runtime_error{run.benchmark_name() + ": " + run.error_message};
            if (run.run_type != Run::RT_Iteration) continue;
            Entry& entry = entries_.at(static_cast<std::size_t>(std::stoul(run.run_name.function_name)));
            const double seconds = problem_.starts_again() ? run.real_accumulated_time : run.cpu_accumulated_time;
            entry.ns.push_back(1e9 * seconds / static_cast<double>(run.iterations) / problem_.scene.steps /
                               problem_.moving_bodies());
        }
    }

private:
    const Problem& problem_;
    std::vector<Entry>& entries_;
};

void measure(const Problem& problem, std::vector<Entry>& entries) {
    benchmark::ClearRegisteredBenchmarks();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        if (!entries[i].runner) continue;
        Runner& runner = *entries[i].runner;
        const int steps = static_cast<int>(problem.scene.steps);
        const std::string name = std::to_string(i);
        // A restart is not timed. Without restarts the clock is not read between runs.
        if (problem.starts_again()) {
            const auto timed = [steps, &runner](benchmark::State& state) {
                for ([[maybe_unused]] auto _ : state) {
                    runner.restart();
                    const double start = cpu_seconds();
                    runner.run(steps);
                    state.SetIterationTime(cpu_seconds() - start);
                }
            };
            benchmark::RegisterBenchmark(name.c_str(), timed)->UseManualTime();
        } else {
            benchmark::RegisterBenchmark(name.c_str(), [steps, &runner](benchmark::State& state) {
                for ([[maybe_unused]] auto _ : state) runner.run(steps);
            });
        }
    }
    Collector collector{problem, entries};
    benchmark::RunSpecifiedBenchmarks(&collector);
    // Bodies that continued from run to run must still be at their place.
    for (Entry& entry : entries) {
        if (problem.starts_again() || !entry.runner) continue;
        Problem after = problem;
        after.truth.front().steps = 0;
        try {
            (void)check(after, *entry.runner);
        } catch (const std::exception& error) {
            entry.failure = std::string{"at the end: "} + error.what();
            entry.ns.clear();
        }
    }
}

// The smallest time of an engine, over its methods and numbers.
std::map<std::string, double> best_of_engines(const std::vector<Entry>& entries) {
    std::map<std::string, double> best;
    for (const Entry& entry : entries) {
        if (entry.ns.empty()) continue;
        const auto [found, is_new] = best.emplace(entry.contender->engine, entry.least());
        if (!is_new) found->second = std::min(found->second, entry.least());
    }
    return best;
}

// The contenders of the problem, each with its answer or the reason why it has none.
std::vector<Entry> entries_of(const Problem& problem, const Contenders& contenders) {
    std::vector<Entry> entries;
    for (const Contender& contender : contenders) {
        Entry entry{&contender, {}, {}};
        try {
            entry.runner = contender.make(problem);
            if (!entry.runner) continue;
            entry.errors = check(problem, *entry.runner);
        } catch (const std::exception& error) {
            entry.failure = error.what();
            entry.runner.reset();
        }
        entries.push_back(std::move(entry));
    }
    return entries;
}

std::vector<Row> rows_of(const Problem& problem, const std::vector<Entry>& entries) {
    const auto best = best_of_engines(entries);
    std::vector<Row> rows;
    for (const Entry& entry : entries) {
        const Contender& c = *entry.contender;
        Row& row = rows.emplace_back(row_of_engine(problem.name, c, problem.step(), problem.scene.steps));
        row["bodies"] = problem.moving_bodies();
        row["compiler"] = TUMBLE_HOST_COMPILER;
        row["flags"] = TUMBLE_HOST_FLAGS;
        if (!entry.failure.empty()) {
            row["failure"] = entry.failure;
            continue;
        }
        row["position_error_m"] = entry.errors.position;
        if (problem.orientation_within > 0) row["orientation_error_rad"] = entry.errors.orientation;
        row["ns_per_body_step"] = entry.least();
        row["ns_per_body_step_median"] = entry.median();
        if (c.engine != "tumble") continue;
        for (const auto& [engine, ns] : best)
            if (engine != c.engine) row["time_ratios"][engine] = entry.least() / ns;
    }
    return rows;
}

void print(const Problem& problem, const std::vector<Entry>& entries) {
    for (const Entry& entry : entries) {
        std::printf("%-38s %5d  %-44s ", problem.name.c_str(), problem.moving_bodies(), entry.name().c_str());
        if (!entry.failure.empty()) std::printf("%s\n", entry.failure.c_str());
        else
            std::printf("%9.1f ns a body, median %.1f; off by %.1e m, %.1e rad\n", entry.least(), entry.median(),
                        entry.errors.position, entry.errors.orientation);
    }
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    // Ours come first: a later option of the same name replaces them.
    std::vector<std::string> defaults{argv[0], "--benchmark_enable_random_interleaving=true",
                                      "--benchmark_repetitions=5", "--benchmark_min_time=0.02"};
    std::vector<char*> arguments;
    for (std::string& option : defaults) arguments.push_back(option.data());
    arguments.insert(arguments.end(), argv + 1, argv + argc);
    int count = static_cast<int>(arguments.size());
    benchmark::Initialize(&count, arguments.data());
    if (count != 3) {
        std::cerr << "usage: tumble_bench_host MOST_BODIES RESULTS.jsonl [--benchmark_...]\n";
        return 2;
    }
    const int most = std::stoi(arguments[1]);
    const std::string results = arguments[2];

    Contenders contenders;
    for (const auto add :
         {add_tumble_q32, add_tumble_f32_plain, add_tumble_f64, add_odeint, add_bullet, add_ode, add_mujoco})
        add(contenders);
    tumble::host::OutputFile file = tumble::bench::rows_file(results);
    std::vector<Row> rows;
    bool as_known = true;
    for (const Problem& problem : problems(most)) {
        std::vector<Entry> entries = entries_of(problem, contenders);
        measure(problem, entries);
        print(problem, entries);
        for (const Row& row : rows_of(problem, entries)) rows.push_back(row);
        for (const Entry& entry : entries) {
            const bool may_fail =
                std::find(problem.fail.begin(), problem.fail.end(), entry.name()) != problem.fail.end();
            if (may_fail != entry.failure.empty()) continue;
            std::cerr << problem.name << ": " << entry.name()
                      << (may_fail ? " is expected to fail and does not\n" : " fails\n");
            as_known = false;
        }
    }
    write_rows(file, rows);
    return as_known ? 0 : 1;
} catch (...) { return tumble::bench::report_failure(argv[0]); }
