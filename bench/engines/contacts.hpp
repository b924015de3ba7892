// The contest of engines on contacts: scenes of contacts.cpp, whose motion is known, at 1/256 s and at 1/60 s. One row
// for each scene, step, law and contender: how far the motion is off the law, and the instructions of a step on x86-64,
// the mean of the first second. The contenders are those of bench/host, with each engine's default settings, and Box2D
// for planar scenes.
#pragma once

#include "host/contender.hpp"

namespace tumble::bench {

void add_box2d(std::vector<Contender>& contenders);
// This kernel in the number system of TUMBLE_NUMBERS.
void add_tumble_contacts(std::vector<Contender>& contenders);

// main() of a contest: prints the rows. Runs itself under valgrind to count instructions.
int contact_contest(int argc, char** argv, const std::vector<Contender>& contenders);

}  // namespace tumble::bench
