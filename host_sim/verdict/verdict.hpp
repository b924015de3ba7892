// Is this run right? The answer comes from a shadow run: the scene is run again by two finer references in double
// precision, and the run is held against them at up to 20 equally spaced moments. The distance between the references
// is the doubt. Where joints tie bodies and nothing touches, the references are two integrations of the equations of
// motion in the coordinates that the joints leave free, in long double. Nothing here guesses from the scene; what two
// fine runs and a budget of energy cannot decide is not decided.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "verdict/accuracy.hpp"
#include "verdict/record.hpp"

namespace tumble::host {

// How a scene is run.
struct Way {
    Method method;
    StepSize step;
    std::optional<double> restitution_threshold{};  // m/s, instead of the scene's
};

struct Verdict {
    enum class Kind {
        right,         // the error stays below the tolerance to the end
        wrong,         // it does not, from `time_s` on
        told,          // the status says so, and nothing else is wrong: `troubles`
        no_reference,  // right until `time_s`; after it the references part, or gain energy that no load gave
        unchecked,     // by the scene's steps and bodies the check costs more than it may; or it cannot be made
    };
    enum class Cause { none, numbers, method, step };

    Kind kind = Kind::unchecked;
    double time_s = 0;  // wrong, told: from when on; no_reference: the last time at which the run is known to be right
    double parted_s = 0;  // no_reference: the first time at which the references decide nothing
    int body = -1;        // wrong, told, no_reference: which; -1: no single one
    Errors error;         // wrong: of the body at `time_s`; else the largest up to there or to the end
    Errors doubt;         // no_reference: distance of the references at `time_s`; else the largest
    bool is_as_large_as_motion =
        false;                      // wrong: at some moment the error reaches all that the body has moved or turned
    bool gains_energy = false;      // no_reference: the references gain energy that no load gave
    bool is_solved = false;         // the references are solutions of the equations of motion, and no runs
    std::vector<Trouble> troubles;  // told, wrong: what the status says, the first first
    Cause cause = Cause::none;      // wrong, told: what has to change
    std::optional<Way> cure;        // wrong, told: a way of running the scene that is right
    bool is_searched = false;       // wrong, told: a way to cure it was run
    double cost_s = 0;              // unchecked: processor time of the check, about
    std::string obstacle;           // unchecked: why the check cannot be made
    std::vector<SharedRule> rules;  // right, no_reference: of the run and its references, so they are not checked
};

struct VerdictOptions {
    // An error is wrong above this angle, rad, or above this share of the distance that the body has moved. No error in
    // position is wrong within the contact tolerance or within what rounding moves a body by in the run.
    double tolerance = 0.1;
    // Of processor time for the references, and again for a cure, as estimated_seconds() counts it; none: no limit.
    std::optional<double> most_seconds{};
    int most_references = 3;  // pairs, each 4 times finer than the one before
    bool explains = true;     // looks for cause and cure, among the methods that are compiled
};

// Runs the scene with `method` and decides. Throws what make_simulation() throws for that run. A run without a step is
// right.
[[nodiscard]] Verdict verdict_of(const SceneDescription& scene, const Method& method,
                                 const VerdictOptions& options = {});
// Decides on a run that has been recorded at moments_of(scene). Throws nothing on account of the references.
[[nodiscard]] Verdict verdict_of(const SceneDescription& scene, const Method& method, const Record& run,
                                 const VerdictOptions& options = {});
// What the status alone tells: told or unchecked.
[[nodiscard]] Verdict told_by(const Record& run, const SceneDescription& scene);

// "right: the error is at most 1.2e-05 m and 0.0003 rad": one line without a full stop.
[[nodiscard]] std::string sentence_of(const Verdict& verdict, const SceneDescription& scene, const Method& method);

// Does a number system carry residuals where --carry does not say?
[[nodiscard]] bool carries_by_default(const std::string& numbers);

// The names of --json: right, wrong, told, no_reference, unchecked; numbers, method, step, or empty.
[[nodiscard]] const char* name_of(Verdict::Kind kind);
[[nodiscard]] const char* name_of(Verdict::Cause cause);

// "--integrator rk4", "--step 1/512", "--numbers f64", "contact.restitution_threshold = 0.16": the options and keys by
// which a way differs from how the scene was run.
[[nodiscard]] std::string options_of(const Way& cure, const Way& run);

}  // namespace tumble::host
