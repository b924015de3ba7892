// The cost of a step of the peers' firmware on a core: a row for each program, with cycles if the core has a timing
// table.
#include "rows.hpp"
#include "variants.hpp"

#include <iostream>

namespace {

// step_run() returns nothing, so no move follows its call.
constexpr int insn_of_call = 3;

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    if (argc < 3) {
        std::cerr << "usage: tumble_peers CORE ELF...\n";
        return 2;
    }
    const tumble::host::Core core = tumble::host::core_named(argv[1]);
    const std::vector<std::string> programs(argv + 2, argv + argc);
    std::vector<tumble::host::StepOutcome> outcomes(programs.size());
    tumble::bench::in_parallel(programs.size(), [&](std::size_t i) {
        outcomes[i] = tumble::host::run_step_program(core, programs[i], 900, {"step_run", insn_of_call});
    });
    for (std::size_t i = 0; i < programs.size(); ++i) {
        if (!outcomes[i].error.empty()) throw std::runtime_error{programs[i] + ": " + outcomes[i].error};
        std::cout << outcomes[i].row.dump() << '\n';
    }
    return 0;
} catch (...) { return tumble::bench::report_failure("tumble_peers"); }
