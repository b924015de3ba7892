// What ends a run and what its status tells: the same for `run` and for `run --live`.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "verdict/record.hpp"

namespace tumble::host {

// Energies of a run. The drift counts from the energy after the impact of the start, and is relative to it; where that
// is within rounding, to the largest kinetic energy. What changes of gravity give to the potential is no drift.
class EnergyWatch {
public:
    // `ended`: J, what joints end of the velocities at the start. `rounding`: J, what rounding may change.
    EnergyWatch(const Energy& start, long double ended, long double rounding)
        : start_(start), end_(start), level_(start.total() - ended), rounding_(rounding),
          largest_kinetic_(start.kinetic - ended) {}
    void see(const Energy& now) {
        end_ = now;
        const long double change = std::abs(now.total() - now.given - level_);
        largest_change_ = largest_change_ < change || std::isnan(change) ? change : largest_change_;
        largest_kinetic_ = std::max(largest_kinetic_, now.kinetic);
    }
    [[nodiscard]] const Energy& end_parts() const { return end_; }
    [[nodiscard]] long double start() const { return start_.total(); }
    [[nodiscard]] long double end() const { return end_.total(); }
    [[nodiscard]] long double largest_drift() const { return largest_change_; }  // J
    // None where rounding alone changes the energy, and all of it is within rounding: a mechanism at rest at height 0.
    [[nodiscard]] std::optional<long double> largest_relative_drift() const {
        const long double scale = std::abs(level_) > rounding_ ? std::abs(level_) : largest_kinetic_;
        if (scale <= rounding_ && largest_change_ <= 2 * rounding_ && rounding_ > 0) return {};
        return scale > 0 ? largest_change_ / scale : largest_change_;
    }

private:
    Energy start_, end_;
    long double level_;     // J, after the impact of the start
    long double rounding_;  // J
    long double largest_change_ = 0, largest_kinetic_;
};

// Which bodies moved in bounded time, and how deep they were in each other at most.
struct BoundedSteps {
    struct Body {
        std::int64_t first = 0, steps = 0;  // the step in which it did so first, from 0 on; in how many
    };
    std::vector<Body> bodies;   // as those of the scene
    double deepest = 0;         // m
    std::int64_t deepest_at{};  // steps taken then

    void see(const Simulation& simulation);
    [[nodiscard]] bool any() const {
        return std::any_of(bodies.begin(), bodies.end(), [](const Body& body) { return body.steps > 0; });
    }
};

class RunWatch {
public:
    // At the start of a run; both must outlive this. `moments`: those at which it is recorded for a verdict.
    RunWatch(const SceneDescription& scene, const Simulation& simulation, std::vector<std::int64_t> moments = {});

    // To be called after every step.
    void see();
    // At the end of the scene, and where a body has left its range: the motion is wrong from there on.
    [[nodiscard]] bool is_over() const;
    // Of the kernel, of a declared [range] that floating point leaves, and speeds whose energy no double holds. Each
    // status once.
    [[nodiscard]] std::vector<Trouble> troubles() const;
    [[nodiscard]] const EnergyWatch& energy() const { return energy_; }
    [[nodiscard]] const BoundedSteps& bounded() const { return bounded_; }
    [[nodiscard]] Record record() &&;

private:
    // In fixed point a blow is held within a quarter of the range of velocities.
    void watch_speeds();

    const Simulation& simulation_;
    EnergyWatch energy_;
    BoundedSteps bounded_;
    Recorder recorder_;
    std::vector<int> jointed_;             // bodies that joints tie and that move; empty in floating point
    std::optional<HeldNumber> too_fast_;   // what one of them exceeded before the step that did not close
    double most_speed_ = 0, fastest_ = 0;  // m/s: that quarter; of a jointed body after the last step
};

}  // namespace tumble::host
