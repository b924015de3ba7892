// A free asymmetric top, the tests' own, for 100 s at 1/256 s: the error of its orientation, the drift of energy and
// momentum, and the instructions of a whole step.
#include "contest.hpp"

#include <algorithm>
#include <cmath>

namespace tumble::bench {

namespace {

using namespace reference;

constexpr int rate = 256, seconds = 100, samples_per_second = 4;
constexpr Vector moments{1, 2, 3};  // kg m^2

host::SceneDescription top() {
    host::SceneDescription scene;
    scene.name = "free top";
    scene.step = {1, rate, 0};
    scene.duration = seconds;
    host::BodyDescription& body = scene.bodies.emplace_back();
    body.mass = 1;                                           // kg
    body.inertia = std::array<double, 6>{1, 2, 3, 0, 0, 0};  // kg m^2
    body.angular_velocity = {0.1, 2, 0.1};                   // rad/s, body frame
    return scene;
}

Problem problem(std::size_t /*scene*/, int /*rate*/) {
    Problem problem = problem_of(top());
    problem.steps_before = 64;  // an engine's set-up in its first steps is not counted
    problem.counted_steps = 1024;
    return problem;
}

std::vector<Row> rows(std::size_t /*scene*/, const Contender& contender, const Contest::Count& count) {
    static const auto truth = truth_of(top(), seconds * samples_per_second);
    const Problem top = problem(0, rate);
    const auto runner = contender.make(top);
    const auto energy = [](Vector w) { return dot(times(moments, w), w); };
    const auto momentum = [](Vector w) { return norm(times(moments, w)); };
    const Vector start = start_of(top.scene.bodies.front()).w;
    double orientation = 0;             // rad, the largest over the samples
    double drift = 0, of_momentum = 0;  // the largest relative changes of kinetic energy and of the momentum's norm
    double good_until = seconds;        // s: the last sample before the orientation was off by more than 0.1 rad
    const auto note = [](double& largest, Number error) { largest = std::max(largest, static_cast<double>(error)); };
    for (std::size_t sample = 0; sample < truth.size(); ++sample) {
        runner->run(rate / samples_per_second);
        const Motion now = runner->motions().front();
        const Number error = angle_between(truth[sample].front().q, now.q);
        if (orientation <= 0.1 && error > 0.1L) good_until = static_cast<double>(sample) / samples_per_second;
        note(orientation, error);
        note(drift, std::abs(energy(now.w) / energy(start) - 1));
        note(of_momentum, std::abs(momentum(now.w) / momentum(start) - 1));
    }
    Row row = row_of_engine(top.name, contender, top.step(), top.scene.steps);
    row["insn_per_step"] = count(rate);
    row["orientation_error_rad"] = orientation;
    row["within_100_mrad_s"] = good_until;
    row["energy_max_relative_drift"] = drift;
    row["momentum_max_relative_drift"] = of_momentum;
    return {row};
}

}  // namespace

Contest top_contest() { return {1, problem, rows}; }

}  // namespace tumble::bench
