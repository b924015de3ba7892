// A run that is read at the moments at which a verdict compares it with others.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "truth/motion.hpp"
#include "verdict/accuracy.hpp"
#include "verdict/energy_budget.hpp"
#include "verdict/range_watch.hpp"
#include "verdict/shared_rules.hpp"

namespace tumble::host {

// What a step of a run has to do on average. It follows from the scene and from the run, not from a clock.
struct Load {
    double bodies = 0;   // that are not fixed
    double springs = 0;  // and pairs that attract each other
    double joints = 0;
    double pairs = 0;  // that are near each other and move
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
    double spacing = 0;                 // m: of neighbouring positions at the start, in the numbers of this run
    double rounding = 0;                // m: what rounding may move a body by in it
    int not_finite = -1;                // the body whose state ended the moments by not being finite; -1: none
    Load load;                          // what a step has to do
    std::vector<SharedRule> rules;      // that the run has used
};

// Adds a trouble, unless one of its name is there: the first occurrence counts.
void add_once(std::vector<Trouble>& troubles, const Trouble& trouble);

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
    RuleWatch rules_;
    std::vector<std::int64_t> moments_;
    Record record_;
    RangeWatch range_;
    std::optional<EnergyBudget> energy_;
    std::vector<std::pair<std::int64_t, std::int64_t>> driven_;  // steps in which loads do work, each [first, end)
    Moment start_, now_;
    std::int64_t looked_ = 0, next_look_ = 0;  // steps
    std::int64_t seen_ = 0, moving_ = 0;       // bodies that are not fixed, in all looks; and those that moved then
    bool is_over_ = false;
};

// Runs the scene with its own step halved `halvings` times. It ends early where the state leaves the range or is not
// finite.
[[nodiscard]] Record record_of(const SceneDescription& scene, const Method& method, int halvings,
                               const std::vector<std::int64_t>& moments, std::optional<double> most_gain = {});

// The motion of a scene in which nothing touches, by its equations, or its beginning where the whole costs more than
// `most_seconds`. `most_error`: of each step of the integration, absolute and relative.
struct SolvedRecord {
    Record record;
    double seconds = 0;  // of processor time, about, for the whole, by the number of evaluations
};
[[nodiscard]] SolvedRecord solved_record_of(const SceneDescription& scene, double most_error,
                                            const std::vector<std::int64_t>& moments,
                                            std::optional<double> most_seconds = {});

// About the processor time of record_of(), s, by the number of its steps and what each has to do: the same on every
// machine, however busy it is.
[[nodiscard]] double estimated_seconds(const SceneDescription& scene, int halvings, const Load& load);

}  // namespace tumble::host
