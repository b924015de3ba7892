// The cost of a step, from a result row: estimated cycles at zero wait states with their range, or instructions where
// the core has no timing table.
#pragma once

#include <nlohmann/json.hpp>

#include <cmath>
#include <string>

namespace tumble::host {

// A number of cycles or instructions, with its range unless that is one number: "1260 (889..1321)", "6037".
[[nodiscard]] inline std::string range_text(double expected, double least, double most) {
    const auto whole = [](double value) { return std::to_string(std::llround(value)); };
    const std::string text = whole(expected);
    return whole(least) == whole(most) ? text : text + " (" + whole(least) + ".." + whole(most) + ")";
}

struct StepCost {
    bool in_cycles = false;
    // NaN where it is not counted, as the worst step on the host.
    double mean = 0, least = 0, most = 0;  // of all steps; least and most are the bounds of the core's manual
    double worst = 0;                      // the most expensive step, at most

    // "1260 (889..1321)", "516 insn"; "-" for NaN.
    [[nodiscard]] std::string mean_text() const { return with_unit(mean, least, most); }
    [[nodiscard]] std::string worst_text() const { return with_unit(worst, worst, worst); }

private:
    [[nodiscard]] std::string with_unit(double expected, double least, double most) const {
        return std::isnan(expected) ? "-" : range_text(expected, least, most) + (in_cycles ? "" : " insn");
    }
};

[[nodiscard]] inline bool has_cycles(const nlohmann::ordered_json& row) { return row.contains("cycles_per_step_est"); }

[[nodiscard]] inline StepCost insn_of(const nlohmann::ordered_json& row) {
    const double insn = row.value("insn_per_step", std::nan(""));
    return {false, insn, insn, insn, row.value("insn_per_step_max", std::nan(""))};
}
[[nodiscard]] inline StepCost cycles_of(const nlohmann::ordered_json& row) {
    return {true, row.at("cycles_per_step_est"), row.at("cycles_per_step_min"), row.at("cycles_per_step_max"),
            row.at("cycles_worst_step_max")};
}
[[nodiscard]] inline StepCost cost_of(const nlohmann::ordered_json& row) {
    return has_cycles(row) ? cycles_of(row) : insn_of(row);
}

}  // namespace tumble::host
