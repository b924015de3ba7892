#include "contest.hpp"

#include "firmware/callgrind.hpp"
#include "rows/rows.hpp"
#include "truth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

namespace {

using tumble::bench::Runner;
using namespace tumble::reference;

constexpr std::array<int, 4> rates{64, 256, 1024, 4096};  // steps a second
constexpr int samples = 16, most_counted_steps = 256, energy_seconds = 20;

}  // namespace

// Callgrind counts this function, which it finds by name: a step with its call.
extern "C" [[gnu::noinline]] void counted_step(Runner& runner) { runner.step(); }

namespace tumble::bench {

namespace {

int steps_of(const Mechanism& mechanism, int rate) { return static_cast<int>(mechanism.seconds * rate); }
int counted_steps(const Mechanism& mechanism, int rate) {
    return std::min(steps_of(mechanism, rate), most_counted_steps);
}

// The error is that at the samples, the gap that after any step. Each is infinite where a place is not a number.
struct Answer {
    double error = 0, gap = 0;  // m
    std::string trouble;
};
Answer answer_of(const Mechanism& mechanism, int rate, Runner& runner, const std::vector<std::vector<Motion>>& truth) {
    Answer answer;
    const auto note = [](double& largest, Number value) {
        largest = std::max(largest, std::isfinite(value) ? static_cast<double>(value) : HUGE_VAL);
    };
    for (const auto& then : truth) {
        for (int i = 0; i < steps_of(mechanism, rate) / samples; ++i) {
            runner.step();
            note(answer.gap, mechanism.gap(runner.motions()));
        }
        const auto now = runner.motions();
        for (std::size_t link = 0; link < now.size(); ++link) note(answer.error, norm(now[link].x - then[link].x));
    }
    answer.trouble = runner.trouble();
    return answer;
}
// The mean energy of the last tenth of a run less that of the first, of its scale.
double energy_moved(const Mechanism& mechanism, int rate, Runner& runner) {
    const int tenth = energy_seconds * rate / 10;
    double first = 0, last = 0;
    for (int i = 0; i < 10 * tenth; ++i) {
        runner.step();
        if (i < tenth) first += mechanism.energy(runner.motions());
        if (i >= 9 * tenth) last += mechanism.energy(runner.motions());
    }
    return (last - first) / tenth / mechanism.energy_scale();
}

// All rows of a contender on a mechanism. Its cost counts only if its answer converges: with the smallest step the
// error is at most a hundredth of the mechanism's length.
std::vector<Row> rows_of(const Mechanism& mechanism, const Contender& contender, const std::string& count) {
    const auto truth = truth_of(mechanism, samples);
    std::vector<Row> rows;
    double error = 0;
    for (const int rate : rates) {
        Row& row = rows.emplace_back(row_of_engine(mechanism.name, contender, 1.0 / rate, steps_of(mechanism, rate)));
        const Answer answer = answer_of(mechanism, rate, *contender.make(mechanism, rate), truth);
        error = answer.error;
        const auto long_runner = contender.make(mechanism, rate);
        const double moved = energy_moved(mechanism, rate, *long_runner);
        const auto set = [&](const char* key, double value) {
            if (std::isfinite(value)) row[key] = value;
        };
        set("position_error_m", answer.error);
        set("gap_m", answer.gap);
        set("energy_moved", moved);
        if (!answer.trouble.empty()) row["trouble"] = answer.trouble;
        if (!long_runner->trouble().empty()) row["energy_trouble"] = long_runner->trouble();
    }
    const double bound = mechanism.length / 100;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!(error <= bound)) {
            rows[i]["failure"] = "does not converge: off by " + std::to_string(error) + " m at 1/" +
                                 std::to_string(rates.back()) + " s, more than " + std::to_string(bound) + " m";
            continue;
        }
        const auto steps = static_cast<std::uint64_t>(counted_steps(mechanism, rates[i]));
        const auto counted = host::instructions_in("counted_step", count + " " + std::to_string(rates[i])).count;
        rows[i]["insn_per_step"] = (counted + steps / 2) / steps;
    }
    return rows;
}

}  // namespace

int joint_contest(int argc, char** argv, const std::vector<Contender>& contenders) try {
    host::tell_lost_output();
    const auto all = mechanisms();
    if (argc == 5 && std::string{argv[1]} == "--count") {
        const Mechanism& mechanism = all.at(std::stoul(argv[2]));
        const int rate = std::stoi(argv[4]);
        const auto runner = contenders.at(std::stoul(argv[3])).make(mechanism, rate);
        runner->step();  // an engine's set-up in its first step is not counted
        for (int i = 0; i < counted_steps(mechanism, rate); ++i) counted_step(*runner);
        return 0;
    }
    for (std::size_t m = 0; m < all.size(); ++m) {
        for (std::size_t c = 0; c < contenders.size(); ++c) {
            const std::string count = argv[0] + (" --count " + std::to_string(m) + " " + std::to_string(c));
            for (Row& row : rows_of(all[m], contenders[c], count)) {
                row["tumble_bits"] = TUMBLE_BITS;
                std::cout << row.dump() << std::endl;
            }
        }
    }
    return 0;
} catch (...) { return report_failure(argv[0]); }

}  // namespace tumble::bench
