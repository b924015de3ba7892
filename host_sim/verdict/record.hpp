// A run that is read at the moments at which a verdict compares it with others.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "truth/motion.hpp"
#include "verdict/accuracy.hpp"
#include "verdict/energy_budget.hpp"
#include "verdict/range_watch.hpp"

namespace tumble::host {

// Processor time of this thread that runs may take.
class ProcessorTime {
public:
    explicit ProcessorTime(std::optional<double> most_seconds = {});
    // To be called while a run goes on: `share` of it, 0 to 1, has taken the time since `begun`. Throws TooDear as soon
    // as the whole run would exceed the limit.
    void check(double begun, double share) const;
    [[nodiscard]] double now() const;  // s

    struct TooDear : std::runtime_error {
        explicit TooDear(double cost) : std::runtime_error("too dear"), seconds(cost) {}
        double seconds;  // of the run
    };

private:
    std::optional<double> most_seconds_;
    double start_;
};

struct Moment {
    std::vector<reference::Motion> bodies;
    // Largest distance from the start, m, and largest angle to the start's orientation, rad, that each body has had.
    std::vector<double> way_m, turn_rad;
};

struct Record {
    std::vector<Moment> moments;        // those that the run reached
    std::vector<Trouble> troubles;      // of the kernel, and a declared [range] that floating point leaves
    std::optional<std::size_t> gained;  // the first moment at which energy has grown though no load did work
    double contact_tolerance = 0;       // m
    double rounding = 0;                // m: what rounding may move a body by in this run
    int not_finite = -1;                // the body whose state ended the moments by not being finite; -1: none
};

// The scene's own steps at whose ends runs are compared: at most sample_count, equally spaced up to rounding.
[[nodiscard]] std::vector<std::int64_t> moments_of(const SceneDescription& scene);

// Reads a run while it goes on, at the ends of some of its steps.
class Recorder {
public:
    // At the start of a run. `most_gain`: growth of energy, in parts of the largest kinetic energy, above which it
    // counts as grown; none: energy is not looked at.
    Recorder(const SceneDescription& scene, const Simulation& simulation, std::vector<std::int64_t> moments,
             std::optional<double> most_gain = {});

    // To be called after every step. True where it has looked at the bodies.
    bool see(const Simulation& simulation);
    // Has the state left the range, or is it not finite? Nothing is recorded from there on.
    [[nodiscard]] bool is_over() const { return is_over_; }
    [[nodiscard]] const std::optional<Trouble>& range_trouble() const { return range_.trouble(); }
    [[nodiscard]] Record record(const Simulation& simulation) &&;

private:
    [[nodiscard]] bool look(const Simulation& simulation);
    void plan_look();

    SceneDescription scene_;
    std::vector<std::int64_t> moments_;
    Record record_;
    RangeWatch range_;
    std::optional<EnergyBudget> energy_;
    std::vector<std::pair<std::int64_t, std::int64_t>> driven_;  // steps in which loads do work, each [first, end)
    Moment start_, now_;
    std::int64_t looked_ = 0, next_look_ = 0;  // steps
    bool is_over_ = false;
};

// Runs the scene with its own step halved `halvings` times. It ends early where the state leaves the range or is not
// finite.
[[nodiscard]] Record record_of(const SceneDescription& scene, const Method& method, int halvings,
                               const std::vector<std::int64_t>& moments, const ProcessorTime& time,
                               std::optional<double> most_gain = {});

}  // namespace tumble::host
