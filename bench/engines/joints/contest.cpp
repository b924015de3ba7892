// Mechanisms with joints at four steps. One row for each mechanism, step and contender: the largest distance of a
// centre of mass from the reference, the largest gap of a joint, what the energy moves by, and the instructions of a
// step.
#include "joints/mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace tumble::bench {

namespace {

using reference::Number;

constexpr int samples = 16, most_counted_steps = 256, energy_seconds = 20;
constexpr int rates[] = {64, 256, 1024, 4096};  // steps a second

Problem problem(std::size_t scene, int rate) {
    Problem problem = mechanisms().at(scene).problem(rate);
    problem.steps_before = 1;  // an engine's set-up in its first step is not counted
    problem.counted_steps = std::min(static_cast<int>(problem.scene.steps), most_counted_steps);
    return problem;
}

// Sets the largest error at the samples and the largest gap after any step, m. Each is infinite where a place is not a
// number.
void measure(const Problem& problem, Runner& runner, const std::vector<Motions>& truth, double& error,
             double& largest_gap) {
    const auto note = [](double& largest, Number value) {
        largest = std::max(largest, std::isfinite(value) ? static_cast<double>(value) : HUGE_VAL);
    };
    for (const Motions& then : truth) {
        Motions now;
        for (std::uint32_t i = 0; i < problem.scene.steps / samples; ++i) {
            runner.step();
            now = runner.motions();
            note(largest_gap, gap(problem.joints, now));
        }
        for (std::size_t body = 0; body < now.size(); ++body) note(error, norm(now[body].x - then[body].x));
    }
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
std::vector<Row> rows(std::size_t scene, const Contender& contender, const Contest::Count& count) {
    const Mechanism mechanism = mechanisms()[scene];
    static std::map<std::size_t, std::vector<Motions>> truths;
    auto& truth = truths[scene];
    if (truth.empty()) truth = truth_of(mechanism.scene, samples);
    std::vector<Row> rows;
    double error = 0;
    for (const int rate : rates) {
        const Problem at_rate = problem(scene, rate);
        Row& row = rows.emplace_back(row_of_engine(at_rate.name, contender, 1.0 / rate, at_rate.scene.steps));
        const auto runner = contender.make(at_rate);
        if (!runner) return {};
        double gap = error = 0;
        measure(at_rate, *runner, truth, error, gap);
        const std::string trouble = runner->trouble();
        runner->restart();
        const double moved = energy_moved(mechanism, rate, *runner);
        const auto set = [&](const char* key, double value) {
            if (std::isfinite(value)) row[key] = value;
        };
        set("position_error_m", error);
        set("gap_m", gap);
        set("energy_moved", moved);
        if (!trouble.empty()) row["trouble"] = trouble;
        if (!runner->trouble().empty()) row["energy_trouble"] = runner->trouble();
    }
    const double bound = mechanism.length / 100;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (error <= bound) rows[i]["insn_per_step"] = count(rates[i]);
        else
            rows[i]["failure"] = "does not converge: off by " + std::to_string(error) + " m at 1/" +
                                 std::to_string(std::end(rates)[-1]) + " s, more than " + std::to_string(bound) + " m";
    }
    return rows;
}

}  // namespace

Contest joint_contest() { return {mechanisms().size(), problem, rows}; }

}  // namespace tumble::bench
