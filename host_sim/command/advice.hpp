// What `tumble advise` finds out, and how it prints that.
#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <vector>

#include "firmware/cost.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {

struct AdviseOptions {
    std::string scene, core;
    double tolerance = 0;                           // of positions in m and of orientations in rad
    std::optional<double> duration;                 // s; empty: the file's
    std::vector<std::string> integrators, numbers;  // to search; empty: all
    std::string cost;             // "cycles", "insn", or empty: cycles where the core has a timing table
    std::optional<double> clock;  // Hz
    bool all = false;             // measure also what cannot be the cheapest
    bool json = false;
};

// A method that keeps the tolerance, at its longest step that does.
struct Candidate {
    Attempt attempt;
    nlohmann::ordered_json row;  // of its firmware; null where it was not measured
    double cost = 0;             // of a simulated second, in cycles or instructions
    std::string not_measured;    // why
};

struct Advice {
    bool in_cycles;  // or in instructions
    Truth truth;
    std::vector<Candidate> ranking, not_measured;  // the cheapest first
    std::vector<Attempt> unreached;                // at the step with the smallest error, the most accurate first
    std::string message;                           // why there is no recommendation

    [[nodiscard]] const char* unit() const { return in_cycles ? "cycles" : "instructions"; }
    [[nodiscard]] StepCost cost_of(const nlohmann::ordered_json& row) const {
        return in_cycles ? cycles_of(row) : insn_of(row);
    }
};

// "rk4 q32 carry"
[[nodiscard]] std::string name_of(const Attempt& attempt);
// "0.0012 at 1/256 s", the error and its step, or the failure that ended the run.
[[nodiscard]] std::string closest_text(const Attempt& attempt);

void print_json(const AdviseOptions& options, const SceneDescription& scene, const Advice& advice);
void print_table(const AdviseOptions& options, const SceneDescription& scene, const Advice& advice);

}  // namespace tumble::host
