// What `make run` measures and prints: a job is one method in one number system on one core.
#pragma once

#include "rows/rows.hpp"
#include "rows/variants.hpp"
#include "scene/description.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace tumble::bench {

struct Job {
    std::string core;
    Variant variant;
    std::string method;
    std::string level;  // of the compiler's optimization
    Row row;
    std::string error;          // empty: the row is good
    std::string shortage;       // of the core's memory
    double accuracy = 0;        // largest error, m and rad; infinite where none was measured
    std::int64_t compared = 0;  // steps that the error is of

    [[nodiscard]] bool is_good() const { return error.empty() && !row.is_null(); }
    [[nodiscard]] double mean_cost() const { return host::cost_of(row).mean; }
};

// The committed row of a free body's step with this method on this core; null where there is none.
[[nodiscard]] const Row* free_step_of(const Job& job, const std::vector<Row>& free_steps);

// Leaves out each job that another one of its core beats in accuracy and in the cost of a free body's step, and clearly
// in one of them: contacts may change the order of methods that cost nearly the same. Returns how many it left out.
std::size_t leave_out_beaten(std::vector<Job>& jobs, const std::vector<Row>& free_steps);

// Leaves out each job that exceeds the tolerance where another one of its core keeps it; the default method, verlet,
// stays. Returns how many it left out.
std::size_t leave_out_inaccurate(std::vector<Job>& jobs, double tolerance);

// For each core the method that costs least of those whose error is within the tolerance; where there is none, the most
// accurate. Errors are known until the first contact; a scene that begins in contact has none.
void print_answer(const std::vector<std::string>& cores, const std::vector<Job>& jobs,
                  const host::SceneDescription& scene, double tolerance);

enum class Shown { front, all };
// `front`: without the rows that another row of the core beats in both accuracy and cost.
void print_table(const std::vector<Job>& jobs, Shown shown);

}  // namespace tumble::bench
