// Runs maps in processes, one at a time on each core. A cell that crashes or does not end is an outcome of its row, and
// the run continues after it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rows/rows.hpp"
#include "rows/variants.hpp"
#include "stress/map.hpp"

namespace tumble::bench::stress {

// A row of the results: a map with a method in a number system.
struct Job {
    Map* map = nullptr;
    std::string integrator;
    Variant variant;

    [[nodiscard]] Method method() const { return {integrator, variant.numbers, variant.carry}; }
};

struct Choice {
    std::vector<std::string> maps, integrators, numbers;  // names; none: all
};
// In the order of rows.
[[nodiscard]] std::vector<Job> jobs_of(const Choice& choice);

struct RunOptions {
    bool coarse = false;
    // Directory of finished rows, for a later run of the same program.
    std::filesystem::path kept = "build/results/stress";
    bool anew = false;           // ignore kept rows
    double seconds_a_cell = 60;  // time limit of a cell
};

// The rows of jobs, in their order. Rows have the causes of silent cells; without_causes() removes them.
[[nodiscard]] std::vector<Row> run(const std::vector<Job>& jobs, const RunOptions& options);

// The row of a map's axes, which explains the cells of its other rows.
[[nodiscard]] Row axes_row(const Map& map, bool coarse);

// All rows; the axes of a map precede its rows.
[[nodiscard]] std::vector<Row> with_axes(const std::vector<Row>& rows, bool coarse);
[[nodiscard]] Row without_causes(Row row);

}  // namespace tumble::bench::stress
