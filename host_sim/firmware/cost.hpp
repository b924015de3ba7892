// What a step costs, as its row says: estimated cycles with their range, for zero wait states, or instructions where
// the core has no timing table.
#pragma once

#include <nlohmann/json.hpp>

#include <cmath>
#include <string>

namespace tumble::host {

// Whole cycles or instructions; a range only where it is one: "1260 (889..1321)", "6037".
[[nodiscard]] inline std::string range_text(double expected, double least, double most) {
    const auto whole = [](double value) { return std::to_string(std::llround(value)); };
    const std::string text = whole(expected);
    return whole(least) == whole(most) ? text : text + " (" + whole(least) + ".." + whole(most) + ")";
}

struct StepCost {
    bool in_cycles = false;
    // Not a number where it is not counted, as single steps on the host.
    double mean = 0, least = 0, most = 0;  // over all steps; least and most by the core's manual
    double worst = 0;                      // the dearest step, at most

    // "1260 (889..1321)", "516 insn"; "-" where it is not counted.
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
