// Does the kernel do what it should on any scene? The property, of a scene run with a method in a number system:
//
// 1. Fixed point and floats agree with double precision. The run stays near the same run in f64, with the same step
//    and contact band, within what rounding explains: further runs in f64 from starts and constants that are off by
//    that rounding show how the motion magnifies it. Where the bound exceeds a tenth of the motion, rounding decides
//    and the comparison ends. What is beyond the bound is judged again with four times as many such runs and
//    with two in the run's own numbers, since a motion may come to a fork.
// 2. Double precision agrees with the verdict's references as far as the step allows: a run in f64 that the verdict
//    calls wrong has at most half of the error at a quarter, a 16th or a 64th of the step, or a status there.
// 3. Quaternions have unit length, a body that was clear of a plane is not deep in it, an isolated scene keeps its
//    momentum, and with residuals and a method of order 2 energy that no load gave grows only if it does in f64.
//    In fixed point the comparison ends where a body is rotated in parts of the step, whose error is a smaller one.
// 4. A status ends all comparisons: what the kernel reports may be wrong from there on.
#pragma once

#include <string>

#include "trial.hpp"

namespace tumble::test {

struct Judgement {
    enum class Kind {
        agrees,     // over at least half of the run
        undecided,  // less of it could be compared, or the references part
        told,       // by a status; it agreed before
        refused,    // by the reader or the simulation
        wrong
    };
    Kind kind = Kind::agrees;
    std::string what;     // is wrong, was told or refused
    double compared = 0;  // part of the run
    double share = 0;     // of its bound that the largest difference took
};

[[nodiscard]] Judgement judge(const Trial& trial);

}  // namespace tumble::test
