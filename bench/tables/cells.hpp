// How the tables write the cells of a row, and columns of them by name.
#pragma once

#include <cmath>
#include <map>

#include "firmware/cost.hpp"
#include "tables/table.hpp"

namespace tumble::bench {

[[nodiscard]] inline std::string mean(const Row& row) { return host::cost_of(row).mean_text(); }
[[nodiscard]] inline std::string worst(const Row& row) { return host::cost_of(row).worst_text(); }
// The same without a unit, for tables that name it in their head.
[[nodiscard]] inline std::string bare_mean(const Row& row) {
    const auto cost = host::cost_of(row);
    return std::isnan(cost.mean) ? "-" : host::range_text(cost.mean, cost.least, cost.most);
}
[[nodiscard]] inline std::string bare_worst(const Row& row) {
    const auto cost = host::cost_of(row);
    return std::isnan(cost.worst) ? "-" : host::range_text(cost.worst, cost.worst, cost.worst);
}
[[nodiscard]] inline std::string last(const Row& row) {
    if (!host::has_cycles(row)) return text_of(row, "insn_per_step_last") + " insn";
    return host::range_text(row.at("cycles_last_step_est"), row.at("cycles_last_step_min"),
                            row.at("cycles_last_step_max"));
}
// A cell of a run that may have failed.
[[nodiscard]] inline Cell unless_failed(const Cell& cell) {
    return [cell](const Row& row) {
        const auto step = row.find("failure_step");
        return step == row.end() ? cell(row) : "fails at step " + step->dump();
    };
}

// The method of an engine, and for how long its error was small.
[[nodiscard]] inline std::string way(const Row& row) {
    return row.at("engine") == "tumble" ? method(row) : text_of(row, "integrator");
}
[[nodiscard]] inline std::string within(const Row& row) {
    return text("%ld", std::lround(row.at("within_100_mrad_s").get<double>()));
}
inline const std::map<std::string, Cell> cells{{"@method", method}, {"@mean", mean},          {"@worst", worst},
                                               {"@last", last},     {"@engine", engine_name}, {"@way", way},
                                               {"@within", within}};
// Of "head:key|head:key", where a key is one of a row or of `cells`.
[[nodiscard]] inline std::vector<Column> columns(const std::string& spec) {
    std::vector<Column> all;
    std::istringstream parts{spec};
    for (std::string part; std::getline(parts, part, '|');) {
        const std::size_t colon = part.find(':');
        const std::string key = part.substr(colon + 1);
        const auto cell = cells.find(key);
        all.push_back({part.substr(0, colon), cell == cells.end() ? value(key) : cell->second});
    }
    return all;
}

}  // namespace tumble::bench
