#include "command/check.hpp"

#include <iostream>

#include "command/messages.hpp"

namespace tumble::host {

void CheckOptions::add_to(Subcommand& command) {
    command.add(check, "--check on|off",
                "hold the run against two finer references (default: on unless, by its steps and bodies, "
                "that takes more than about a second)",
                one_of("on", "off"));
    command.add(tolerance, "--tolerance E",
                "an error is wrong above E rad, or above E times the distance that a body moves", positive("rad"));
}

Verdict CheckOptions::verdict(const SceneDescription& scene, const Method& method, const Record& run) const {
    if (check == "off") return told_by(run, scene);
    VerdictOptions options{.tolerance = tolerance};
    if (check.empty()) options.most_seconds = most_seconds;
    return verdict_of(scene, method, run, options);
}

std::string verdict_line(const CheckOptions& options, const Verdict& verdict, const SceneDescription& scene,
                         const Simulation& simulation) {
    if (options.check == "off" && verdict.kind == Verdict::Kind::unchecked) return {};
    return "verdict: " + sentence_of(verdict, scene, method_of(simulation)) + "\n";
}

int report(const Verdict& verdict, const SceneDescription& scene, const Simulation& simulation) {
    const std::string cure =
        verdict.cure ? options_of(*verdict.cure, {method_of(simulation), scene.step}) : std::string();
    for (const Trouble& trouble : verdict.troubles)
        std::cerr << message_of(trouble, verdict.troubles.front(), scene, simulation, cure) << "\n";
    // The status says enough.
    if (verdict.troubles.empty() && verdict.is_as_large_as_motion)
        std::cerr << scene.path << ": " << sentence_of(verdict, scene, method_of(simulation))
                  << ". The error is as large as the motion\n";
    return verdict.troubles.empty() && !verdict.is_as_large_as_motion ? done : failed;
}

}  // namespace tumble::host
