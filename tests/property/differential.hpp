// Does a run end wrong without a word? The run of a trial is held against the same method and step in double precision,
// and both against what holds of any motion. What has a status, or is beyond a limit that is named beforehand, may be
// wrong from there on. The status is the kernel's; what is wrong without one may have that of the command, which knows
// the energy and the file's [range].
//
// The bound. A number system rounds the start, the constants and every step. Its unit of each number is what it
// resolves (of fixed point, its range's last place; of floats, the last place of the largest value). Double precision
// is run again from starts, and with constants, that differ by that rounding: some units where residuals are carried,
// half a unit for every step where they are not, since all may lean one way. How far these runs come apart is how the
// motion itself magnifies rounding; the bound is `safety` times the largest of it so far, and of contacts the band
// within which bodies touch. As soon as it exceeds a tenth of what the motion has reached by then, the scene is
// chaotic or too small for the numbers, and the comparison ends: what remains is held against the laws alone.
// What is beyond its bound is wrong only if it stays so with four times as many runs, some of them wider, and a bound
// of places and angles that grows with what the band lets velocities differ by: what a contact has pushed may lose
// touch a step later. Where rounding alone moves a body of a scene with contacts by its size, the laws alone hold.
#pragma once

#include <cstdint>
#include <string>

#include "trial.hpp"

namespace tumble::test {

struct Verdict {
    enum class Kind {
        agrees,   // as far as it could be compared
        told,     // a status: it agreed before
        named,    // beyond a limit that is named beforehand
        refused,  // by the reader or the simulation
        wrong
    };
    Kind kind = Kind::agrees;
    std::string what;       // is wrong, was told, named or refused
    std::int64_t step = 0;  // of what is wrong
    double compared = 0;    // part of the run that the bounds were of use in
    double share = 0;       // of its bound that the largest difference took
};

[[nodiscard]] Verdict judge(const Trial& trial);

// Loads the worlds of a number system, as "q32 carry", or of all, and those of double precision: processes made later
// share them.
void load_worlds(const std::string& numbers = {});

}  // namespace tumble::test
