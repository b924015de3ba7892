#include "contender.hpp"

#include "firmware/callgrind.hpp"
#include "rows/rows.hpp"
#include "truth/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

namespace {

using tumble::bench::Runner;
using namespace tumble::reference;

constexpr int samples_per_second = 4, counted_steps = 1024;

}  // namespace

// Callgrind counts this function, which it finds by name: a step with its call.
extern "C" [[gnu::noinline]] void counted_step(Runner& runner) { runner.step(); }

namespace tumble::bench {

namespace {

struct Errors {
    double orientation = 0;           // rad, the largest over the samples
    double energy = 0, momentum = 0;  // the largest relative changes of kinetic energy and of the momentum's norm
    double good_until =
        top_seconds;  // s: the last sample before the orientation was off by more than a tenth of a radian
};

Errors errors_of(Runner& runner) {
    const Body body{1, {top_moments[0], top_moments[1], top_moments[2]}};
    const Motion start{{}, {}, {}, {top_spin[0], top_spin[1], top_spin[2]}};
    static const auto reference =
        free_trajectory(body, start, sample_times(Number(1) / samples_per_second, top_seconds * samples_per_second));
    const auto energy = [&](Vector w) { return dot(times(body.moments, w), w) / 2; };
    const auto momentum = [&](Vector w) { return norm(times(body.moments, w)); };
    Errors errors;
    const auto note = [](double& largest, Number error) { largest = std::max(largest, static_cast<double>(error)); };
    for (std::size_t sample = 1; sample < reference.size(); ++sample) {
        for (int i = 0; i < top_steps_per_second / samples_per_second; ++i) runner.step();
        const auto q = runner.orientation();
        const auto w = runner.spin();
        const Vector spin = vector_of(w);
        const Number error = angle_between(reference[sample].q, rotation_of(q));
        if (errors.orientation <= 0.1 && error > 0.1L)
            errors.good_until = static_cast<double>(sample - 1) / samples_per_second;
        note(errors.orientation, error);
        note(errors.energy, std::abs(energy(spin) / energy(start.w) - 1));
        note(errors.momentum, std::abs(momentum(spin) / momentum(start.w) - 1));
    }
    return errors;
}

}  // namespace

int contest(int argc, char** argv, const std::vector<Contender>& contenders) try {
    host::tell_lost_output();
    if (argc == 3 && std::string{argv[1]} == "--count") {
        const auto runner = contenders.at(std::stoul(argv[2])).make();
        for (int i = 0; i < 64; ++i) runner->step();  // an engine's set-up in its first steps is not counted
        for (int i = 0; i < counted_steps; ++i) counted_step(*runner);
        return 0;
    }
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        const Contender& c = contenders[i];
        const auto runner = c.make();
        const Errors errors = errors_of(*runner);
        const auto counted =
            host::instructions_in("counted_step", std::string{argv[0]} + " --count " + std::to_string(i)).count;
        Row row = row_of_engine("free top", c, 1.0 / top_steps_per_second, top_seconds * top_steps_per_second);
        row["insn_per_step"] = (counted + counted_steps / 2) / counted_steps;
        row["orientation_error_rad"] = errors.orientation;
        row["within_100_mrad_s"] = errors.good_until;
        row["energy_max_relative_drift"] = errors.energy;
        row["momentum_max_relative_drift"] = errors.momentum;
        std::cout << row.dump() << std::endl;
    }
    return 0;
} catch (...) { return report_failure(argv[0]); }

}  // namespace tumble::bench
