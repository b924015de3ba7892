// The contest of joints: the mechanisms in each engine at four steps. One row for each mechanism, step and contender:
// the largest distance of a centre of mass from the reference, the largest gap of a joint, what the energy moves by,
// and the instructions of a step on x86-64.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mechanism.hpp"

namespace tumble::bench {

// A mechanism in some engine's world.
class Runner {
public:
    virtual ~Runner() = default;
    virtual void step() = 0;
    // Of all links; velocities and spins too.
    [[nodiscard]] virtual std::vector<reference::Motion> motions() = 0;
    // What the engine has reported of its steps; empty: nothing.
    [[nodiscard]] virtual std::string trouble() const { return ""; }
};

struct Contender {
    std::string engine, version, method;
    std::string numbers;  // q32, f32 or f64
    bool carry;
    std::function<std::unique_ptr<Runner>(const Mechanism&, int rate)> make;  // with steps of 1 / rate s
};

// main() of a contest: prints the rows. Runs itself under valgrind to count instructions.
int joint_contest(int argc, char** argv, const std::vector<Contender>& contenders);

}  // namespace tumble::bench
