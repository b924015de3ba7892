// The options --check and --tolerance of commands that run a scene, and what they print of the verdict.
#pragma once

#include <string>

#include "command/command.hpp"
#include "verdict/verdict.hpp"

namespace tumble::host {

struct CheckOptions {
    std::string check;       // "on", "off" or empty: on unless it is estimated to take more than most_seconds
    double tolerance = 0.1;  // rad, and in parts of the distance that a body moves

    static constexpr double most_seconds = 1;  // of processor time

    void add_to(Subcommand& command);
    // Checks a run that has been recorded, as far as is asked for.
    [[nodiscard]] Verdict verdict(const SceneDescription& scene, const Method& method, const Record& run) const;
};

// "verdict: right: the error is at most ..." and an end of line; empty with --check off.
[[nodiscard]] std::string verdict_line(const CheckOptions& options, const Verdict& verdict,
                                       const SceneDescription& scene, const Simulation& simulation);

// Writes what went wrong to standard error, with the cure that the verdict found. The exit status: 1 where the status
// tells of trouble, and where the error is as large as the motion.
[[nodiscard]] int report(const Verdict& verdict, const SceneDescription& scene, const Simulation& simulation);

}  // namespace tumble::host
