// A pendulum and a spherical pendulum in this kernel for ten million steps of 1/256 s: a row each with what the mean
// energy of the last tenth is above that of the first, and with the largest gap after any step. Ends with status 1
// where the energy has moved by more than 3e-5 of m g l, or a step reports something.
#include "joints/mechanism.hpp"
#include "tumble_worlds.hpp"

#include <cmath>
#include <iostream>

namespace {

using namespace tumble;
using namespace tumble::bench;

constexpr int rate = 256;
constexpr double most_moved = 3e-5;

template <class N>
bool run(const Mechanism& mechanism, std::int64_t steps) {
    const Problem problem = mechanism.problem(rate);
    TumbleRunner<N, integrators::Verlet, Features{.bodies = 1, .joints = 1}> world{problem};
    const double start = mechanism.energy(world.motions());
    double first = 0, last = 0, change = 0, largest_gap = 0;
    for (std::int64_t i = 0; i < steps; ++i) {
        world.step();
        const auto motions = world.motions();
        const double energy = mechanism.energy(motions);
        change = std::max(change, std::abs(energy - start));
        if (i < steps / 10) first += energy;
        if (i >= steps - steps / 10) last += energy;
        largest_gap = std::max(largest_gap, gap(problem.joints, motions));
    }
    const double scale = mechanism.energy_scale(), moved = (last - first) / static_cast<double>(steps / 10) / scale;
    bench::Row row = row_of(problem.name, "host", N::name, N::carry, integrators::Verlet::name, 1.0 / rate);
    row["steps"] = steps;
    row["energy_moved"] = moved;
    row["energy_change"] = change / scale;
    row["gap_m"] = largest_gap;
    if (!world.trouble().empty()) row["trouble"] = world.trouble();
    row["tumble_bits"] = TUMBLE_BITS;
    std::cout << row.dump() << std::endl;
    return world.trouble().empty() && std::abs(moved) <= most_moved;
}

}  // namespace

int main(int, char** argv) try {
    host::tell_lost_output();
    bool holds = true;
    for (const Mechanism& mechanism : {pendulum(), spherical_pendulum()}) {
        holds = run<Q32<NearRange>>(mechanism, 10'000'000) && holds;
        holds = run<F32>(mechanism, 1'000'000) && holds;
        holds = run<F64>(mechanism, 1'000'000) && holds;
    }
    if (!holds) std::cerr << argv[0] << ": the energy moved by more than " << most_moved << " of m g l\n";
    return holds ? 0 : 1;
} catch (...) { return report_failure(argv[0]); }
