#include "cost/matrix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>

namespace tumble::bench {
namespace {

using host::StepCost;
using host::StepFirmware;

// Factor by which a cost or an error must be larger to be clearly larger.
constexpr double clearly = 1.1;

struct Merit {
    double cost, error;
};

// Is b neither cheaper nor more accurate than a, and dearer or less accurate by this factor?
bool beats(const Merit& a, const Merit& b, double factor) {
    return a.cost <= b.cost && a.error <= b.error && (a.cost * factor < b.cost || a.error * factor < b.error);
}

// For each job, whether another one of its core beats it.
std::vector<bool> beaten(const std::vector<Job>& jobs, double factor, const auto& merit_of) {
    std::vector<bool> list;
    for (const Job& job : jobs)
        list.push_back(std::any_of(jobs.begin(), jobs.end(), [&](const Job& other) {
            return other.core == job.core && beats(merit_of(other), merit_of(job), factor);
        }));
    return list;
}

std::string name_of(const Job& job) {
    return job.method + " in " + host::numbers_text(job.variant.numbers, job.variant.carry);
}

// Hz, of the core's row in boards.txt; 0 where it has none.
double clock_of(const std::string& core) { return core == StepFirmware::host ? 0 : host::core_named(core).clock; }

// "21 steps long at 16 MHz", "28 % of a step at 25 MHz".
std::string length_in_steps(double cycles, double clock, double step) {
    const double share = cycles / (clock * step);
    const std::string length =
        share >= 1 ? host::few_digits(std::round(share * (share < 10 ? 10 : 1)) / (share < 10 ? 10 : 1)) + " steps long"
                   : host::few_digits(std::ceil(100 * share)) + " % of a step";
    return length + " at " + host::few_digits(clock / 1e6) + " MHz";
}

std::string worst_text(const Job& job, double step) {
    const StepCost cost = host::cost_of(job.row);
    if (std::isnan(cost.worst)) return "";
    std::string text = "; worst step " + cost.worst_text() + (cost.in_cycles ? " cycles" : "");
    if (const double clock = clock_of(job.core); cost.in_cycles && clock > 0)
        text += ", " + length_in_steps(cost.worst, clock, step);
    return text;
}

std::string error_text(const Job& job, const host::SceneDescription& scene) {
    if (job.compared == 0) return "error not measured: in contact from the start";
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "error %.1e m or rad", job.accuracy);
    if (job.compared == scene.steps()) return text.data();
    return text.data() +
           (" until the first contact at " +
            host::few_digits(std::round(static_cast<double>(job.compared) * scene.step.seconds() * 100) / 100)) +
           " s";
}

void print_best(const Job& best, const host::SceneDescription& scene, double tolerance) {
    const StepCost cost = host::cost_of(best.row);
    if (std::isnan(cost.mean)) {
        std::printf("%-11s counts neither cycles nor instructions\n", best.core.c_str());
        return;
    }
    const std::string limit = host::few_digits(tolerance);
    const std::string rank = best.compared == 0           ? "is the cheapest"
                             : best.accuracy <= tolerance ? "is the cheapest within " + limit
                                                          : "is the most accurate; none is within " + limit;
    const bool issues_two = best.core != StepFirmware::host && host::core_named(best.core).issues_two();
    std::printf("%-11s %s %s: %s%s a step%s\n", best.core.c_str(), name_of(best).c_str(), rank.c_str(),
                cost.mean_text().c_str(), cost.in_cycles ? " cycles" : "",
                issues_two ? (", at least " + host::few_digits(std::ceil(cost.mean / 2)) + " cycles").c_str() : "");
    std::printf("%-11s %s%s\n", "", error_text(best, scene).c_str(), worst_text(best, scene.step.seconds()).c_str());
}

void print_row(const Job& job) {
    std::printf("%-11s %-10s %-20s ", job.core.c_str(),
                host::numbers_text(job.variant.numbers, job.variant.carry).c_str(), job.method.c_str());
    if (!job.shortage.empty() || job.row.is_null()) {
        std::printf("%s\n", !job.shortage.empty() ? job.shortage.c_str() : ("FAILED: " + job.error).c_str());
        return;
    }
    const auto number = [&](const char* key) {
        return job.row.contains(key) ? std::to_string(job.row.at(key).get<unsigned long long>()) : "-";
    };
    std::array<char, 16> error{"-"};
    if (job.compared > 0) std::snprintf(error.data(), error.size(), "%.1e", job.accuracy);
    const StepCost cost = host::cost_of(job.row);
    std::printf("%24s %14s %8s %8s %7s %7s  %-16s %s\n", cost.mean_text().c_str(), cost.worst_text().c_str(),
                error.data(), number("text_bytes").c_str(), number("ram_bytes").c_str(), number("stack_bytes").c_str(),
                job.row.at("state_hash").get<std::string>().c_str(), job.error.empty() ? "yes" : job.error.c_str());
}

}  // namespace

const Row* free_step_of(const Job& job, const std::vector<Row>& free_steps) {
    const auto found = std::find_if(free_steps.begin(), free_steps.end(), [&](const Row& row) {
        return row.at("core") == job.core && row.at("integrator") == job.method &&
               row.at("numbers") == job.variant.numbers && row.at("carry") == job.variant.carry;
    });
    return found == free_steps.end() ? nullptr : &*found;
}

std::size_t leave_out_beaten(std::vector<Job>& jobs, const std::vector<Row>& free_steps) {
    // A job without a row costs nothing, so that it stays.
    const std::vector<bool> out = beaten(jobs, clearly, [&](const Job& job) {
        const Row* row = free_step_of(job, free_steps);
        return Merit{row == nullptr ? std::nan("") : host::cost_of(*row).mean, job.accuracy};
    });
    std::size_t i = 0;
    return std::erase_if(jobs, [&](const Job&) { return out[i++]; });
}

std::size_t leave_out_inaccurate(std::vector<Job>& jobs, double tolerance) {
    std::set<std::string> answered;  // cores
    for (const Job& job : jobs)
        if (job.accuracy <= tolerance) answered.insert(job.core);
    return std::erase_if(jobs, [&](const Job& job) {
        return job.accuracy > tolerance && answered.contains(job.core) && job.method != "verlet";
    });
}

void print_answer(const std::vector<std::string>& cores, const std::vector<Job>& jobs,
                  const host::SceneDescription& scene, double tolerance) {
    const auto is_better = [&](const Job& a, const Job& b) {
        if ((a.accuracy <= tolerance) != (b.accuracy <= tolerance)) return a.accuracy <= tolerance;
        return a.accuracy <= tolerance || a.accuracy == b.accuracy ? a.mean_cost() < b.mean_cost()
                                                                   : a.accuracy < b.accuracy;
    };
    for (const std::string& core : cores) {
        const Job* best = nullptr;
        for (const Job& job : jobs)
            if (job.core == core && job.is_good() && (best == nullptr || is_better(job, *best))) best = &job;
        if (best != nullptr) print_best(*best, scene, tolerance);
        else std::printf("%-11s no row\n", core.c_str());
    }
}

void print_table(const std::vector<Job>& jobs, Shown shown) {
    const std::vector<bool> hidden = beaten(jobs, 1, [](const Job& job) {
        const double none = std::nan("");
        return job.is_good() ? Merit{job.mean_cost(), job.accuracy} : Merit{none, none};
    });
    std::printf("\n%-11s %-10s %-20s %24s %14s %8s %8s %7s %7s  %-16s %s\n", "core", "numbers", "integrator",
                "cycles/step", "worst", "error", "text", "RAM", "stack", "state hash", "agrees");
    bool has_insn = false;
    for (std::size_t i = 0; i < jobs.size(); ++i) {
        if (shown == Shown::front && hidden[i]) continue;
        print_row(jobs[i]);
        has_insn = has_insn || (!jobs[i].row.is_null() && !host::has_cycles(jobs[i].row));
    }
    std::printf("cycles: expected (least..most), zero wait states; worst: the dearest step, at most%s\n",
                has_insn ? "; insn: no timing table of this core" : "");
}

}  // namespace tumble::bench
