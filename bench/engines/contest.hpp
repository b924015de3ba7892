// A contest of engines: scenes whose motion is known, and the rows that a contender gets on each. Valgrind's callgrind
// counts the instructions of a step on x86-64; the count repeats.
#pragma once

#include "contender.hpp"
#include "rows/rows.hpp"

namespace tumble::bench {

struct Contest {
    // The instructions of a step of 1 / `rate` s.
    using Count = std::function<std::uint64_t(int rate)>;

    std::size_t scenes;
    // A scene with steps of 1 / `rate` s.
    std::function<Problem(std::size_t scene, int rate)> problem;
    // None if the contender's engine cannot make the scene.
    std::function<std::vector<Row>(std::size_t scene, const Contender& contender, const Count& count)> rows;
};

// A free asymmetric top; contacts; mechanisms with joints.
[[nodiscard]] Contest top_contest();
[[nodiscard]] Contest contact_contest();
[[nodiscard]] Contest joint_contest();

[[nodiscard]] Problem problem_of(const host::SceneDescription& scene);

// The true motions after each of `samples` equal parts of the run of a scene without contacts. The reference integrates
// in long double and shares no code with any contender.
[[nodiscard]] std::vector<Motions> truth_of(const host::SceneDescription& scene, int samples);

// main() of a contest of the contenders that `add` adds: prints the rows. Runs itself under valgrind to count
// instructions.
int run_contest(int argc, char** argv, void (*add)(Contenders&), Contest (*contest)());

}  // namespace tumble::bench
