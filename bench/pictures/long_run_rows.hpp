// Rows of long runs: the errors of conserved quantities in spans of steps, which double every other span; the bounds
// that each method promises; and their picture. Keys of a row:
//   at                 the last steps of the spans
//   energy             largest relative error of the energy in each span
//   momentum           largest error in each span, relative to the length at the start: of the angular momentum about
//   the
//                      origin, or of its vertical component under forces; none with planes
//   penetration_m      largest penetration of a body into a plane or another body in each span; with contacts only
//   shift_m            largest distance of a body of a stack from its start
//   energy_first_tenth, energy_last_tenth   the largest errors in the first and the last tenth of the run
#pragma once

#include "rows/rows.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::bench {

// The relative error that rounding alone may cause in so many steps: a random walk of a few units of the number system.
[[nodiscard]] double rounding_floor(const std::string& numbers, double steps);

// The relative error of biased rounding: a sixteenth of a unit a step.
[[nodiscard]] double biased_floor(const std::string& numbers, double steps);

// A bound that a row is checked against.
struct Promise {
    enum class Kind {
        below,   // every value is at most `bound`
        steady,  // the largest in the last tenth is at most twice the largest in the first and `bound`
    };
    std::string quantity;  // a key of the row
    Kind kind;
    double bound;
    double measured;  // the value that `limit` bounds
    double limit;     // `bound`, or that and twice the largest of the first tenth

    [[nodiscard]] bool is_kept() const { return measured <= limit; }
    [[nodiscard]] std::string text() const;  // the bound as a sentence
};
// The promises for a row's scene, method and number system; none if there is no bound.
[[nodiscard]] std::vector<Promise> promises_of(const Row& row);

// A sentence for every promise that a row breaks, and for every failed run that has promises.
[[nodiscard]] std::vector<std::string> broken_promises(const std::vector<Row>& rows);

// Energy, momentum and penetration over steps. Throws std::runtime_error.
void draw_long_runs(const std::vector<Row>& rows, const std::filesystem::path& svg);

}  // namespace tumble::bench
