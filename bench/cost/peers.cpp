// The cost of a step of the peers' and engines' firmware on a core: a row for each program, with cycles if the core has
// a timing table, and with its sizes.
#include "rows/rows.hpp"
#include "rows/variants.hpp"

#include <tumble/status.hpp>

#include <iostream>

namespace {

// step_run() returns nothing, so no move follows its call.
constexpr int insn_of_call = 3;

// Firmware of engines prints whole numbers only.
void complete(tumble::bench::Row& row) {
    if (!row.contains("steps_per_second")) return;
    row["step_s"] = 1 / row.at("steps_per_second").get<double>();
    row.erase("steps_per_second");
    const auto take = [&](const char* from, const char* to, const char* law) {
        if (!row.contains(from)) return;
        row[to] = row.at(from).get<double>() / 1e9;
        row.erase(from);
        if (*law != '\0') row["law"] = law;
    };
    take("shift_nm", "error", "largest distance of a body from its place, m");
    take("shift_sideways_nm", "error", "largest distance of a body from its place sideways, m");
    take("overlap_nm", "overlap_m", "");
    // A bound that was hit leaves a state that is less accurate, which the error and the overlap tell.
    std::string trouble;
    for (const tumble::Issue issue : tumble::all_issues) {
        if ((row.at("status_bits").get<int>() & static_cast<int>(issue)) == 0) continue;
        if (issue != tumble::Issue::step_bound_hit)
            throw std::runtime_error{"a bit of the status is set: " + row.dump()};
        trouble = name_of(issue);
    }
    if (!trouble.empty()) row["trouble"] = trouble;
    row["tumble_bits"] = TUMBLE_BITS;
}

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
        tumble::bench::Row& row = outcomes[i].row;
        tumble::host::add_sizes(row, programs[i]);
        complete(row);
        std::cout << row.dump() << '\n';
    }
    return 0;
} catch (...) { return tumble::bench::report_failure("tumble_peers"); }
