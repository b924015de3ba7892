// Replays the scene that `tumble compile` has written and compares the state's hash with the project's own, which the
// build gives as EXPECTED_Q32, EXPECTED_F32 and EXPECTED_F64. The status is the sum of 1, 2 and 4 for those that
// differ.
#include "free.hpp"

namespace {

template <class System>
struct Config : tumble::scenes::Free::Config {
    using Numbers = System;
};

template <class System>
bool differs(std::uint64_t expected) {
    tumble::Replay<Config<System>, tumble::scenes::Free> replay;
    for (std::uint32_t step = 0; step < tumble::scenes::Free::steps; ++step)
        if (!replay.step().ok()) return true;
    return replay.world().hash() != expected;
}

}  // namespace

int main() {
    int status = 0;
    if (differs<tumble::scenes::Free::Config::Numbers>(EXPECTED_Q32)) status += 1;
    if (differs<tumble::F32>(EXPECTED_F32)) status += 2;
#ifdef EXPECTED_F64
    if (differs<tumble::F64>(EXPECTED_F64)) status += 4;
#endif
    return status;
}
