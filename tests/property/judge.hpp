// Does the kernel do what it should on any scene? The property, of a scene run with a method in a number system:
//
// 1. Fixed point and floats agree with double precision. The run stays near the same run in f64, with the same step
//    and contact band, within what rounding explains. Further runs in f64 from starts and constants that are off by
//    that rounding show how the motion magnifies it: the bound is `rounding_factor` times the largest distance of them
//    so far, or one resolution of the number system where that is larger, and with impacts what lies within the contact
//    band. The comparison ends where the bound exceeds a tenth of the motion: there rounding decides. What is beyond
//    the bound is judged again with four times as many such runs, since a motion may come to a fork.
// 2. Double precision agrees with the verdict's references as far as the step allows. A run in f64 that the verdict
//    calls wrong has no more than half of the error at an eighth of the step, or a status there.
// 3. In every number system numbers stay finite, quaternions have unit length, a body that has touched a plane is not
//    deep in it, an isolated scene keeps its momentum, and energy that no load gave grows only where it does in f64.
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
    std::string what;     // is wrong, was told, undecided or refused
    double compared = 0;  // part of the run
    double share = 0;     // of its bound that the largest difference took
};

[[nodiscard]] Judgement judge(const Trial& trial);

}  // namespace tumble::test
