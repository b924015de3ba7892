// Runs maps in processes, one at a time on each core: a cell that crashes or does not end is an outcome of its row, and
// the run goes on behind it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rows.hpp"
#include "stress/map.hpp"
#include "variants.hpp"

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
    // Where each finished row is kept, and found again by a later run of the same program.
    std::filesystem::path kept = "build/results/stress";
    bool anew = false;           // what is kept there is not taken
    double seconds_a_cell = 60;  // what a cell may take
};

// The rows of jobs, in their order. Rows have the causes of silent cells: without_causes() takes them out.
[[nodiscard]] std::vector<Row> run(const std::vector<Job>& jobs, const RunOptions& options);

// The row of a map's axes, which explains the cells of its other rows.
[[nodiscard]] Row axes_row(const Map& map, bool coarse);

// All rows: before those of each map, its axes.
[[nodiscard]] std::vector<Row> with_axes(const std::vector<Row>& rows, bool coarse);
[[nodiscard]] Row without_causes(Row row);

}  // namespace tumble::bench::stress
