// Rows of long runs: how far from its start what a motion conserves has been within spans of steps that double every
// other time, what each method promises of it, and their picture. Of one run:
//   at                 the last steps of the spans
//   energy             largest relative error of the energy in each span
//   momentum           largest error in each span, relative to the length at the start: of the angular momentum about
//   the
//                      origin, of its vertical component under forces; none where planes push
//   penetration_m      largest depth of a body in a plane or another body in each span, where there are contacts
//   shift_m            farthest that a body of a stack has been from its start
//   energy_first_tenth, energy_last_tenth   the largest errors in the first and the last tenth of the run
#pragma once

#include "rows.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::bench {

// What a row of rounding alone may come to within so many steps: a random walk of a few units of its number system,
// relative to what is conserved.
[[nodiscard]] double rounding_floor(const std::string& numbers, double steps);

// The same of rounding with a bias: a sixteenth of a unit a step.
[[nodiscard]] double biased_floor(const std::string& numbers, double steps);

// A promise that a row is held to.
struct Promise {
    enum class Kind {
        below,   // every value is at most `bound`
        steady,  // the largest in the last tenth is at most twice the largest in the first and `bound`
    };
    std::string quantity;  // a key of the row
    Kind kind;
    double bound;
    double measured;  // what `bound` or twice the first tenth and `bound` limit
    double limit;

    [[nodiscard]] bool is_kept() const { return measured <= limit; }
    [[nodiscard]] std::string text() const;  // of what is promised
};
// Those of a row's scene, method and number system; none for what nobody promises.
[[nodiscard]] std::vector<Promise> promises_of(const Row& row);

// A sentence for every promise that a row breaks, or for a run that failed although it has promises.
[[nodiscard]] std::vector<std::string> broken_promises(const std::vector<Row>& rows);

// Energy, momentum and penetration over steps. Throws std::runtime_error.
void draw_long_runs(const std::vector<Row>& rows, const std::filesystem::path& svg);

}  // namespace tumble::bench
