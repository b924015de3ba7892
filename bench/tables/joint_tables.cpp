#include "tables/joint_tables.hpp"

#include "tables/cells.hpp"

namespace tumble::bench {
namespace {

// The least instructions of a simulated second at a step whose error is at most 1 mm, in millions; with the step.
std::string cost_of_a_millimetre(const Rows& rows, const Where& contender) {
    const Row* best = nullptr;
    const auto cost = [](const Row& row) {
        return row.at("insn_per_step").get<double>() / row.at("step_s").get<double>();
    };
    for (const Row& row : rows) {
        if (!is_where(row, contender) || !row.contains("insn_per_step") || !row.contains("position_error_m")) continue;
        if (row.at("position_error_m").get<double>() > 1e-3) continue;
        if (best == nullptr || cost(row) < cost(*best)) best = &row;
    }
    if (best == nullptr) return "not reached";
    const double millions = cost(*best) / 1e6;
    return text(millions < 10 ? "%.1f" : "%.0f", millions) + text(", 1/%.0f s", 1 / best->at("step_s").get<double>());
}
std::string signed_value(const Row& row, const char* key) {
    return row.contains(key) ? text("%+.0e", row.at(key).get<double>()) : "lost";
}
// With a star where the engine reported something of the run.
std::string energy(const Row& row) {
    return signed_value(row, "energy_moved") + (row.contains("energy_trouble") ? " *" : "");
}
std::string error(const Row& row) {
    const std::string metres = row.contains("position_error_m") ? text_of(row, "position_error_m") : "lost";
    return metres + (row.contains("trouble") ? " *" : "");
}
std::string instructions(const Row& row) { return row.contains("failure") ? "wrong" : text_of(row, "insn_per_step"); }

}  // namespace

Table joints_table(const Rows& all) {
    Rows rows = all;
    std::erase_if(rows, [](const Row& row) { return !row.contains("engine"); });
    const auto at = [](int rate) { return Where{{"step_s", text("%.1e", 1.0 / rate)}}; };
    std::vector<Line> lines;
    std::vector<std::string> costs;
    for (const std::string& scene : distinct(rows, "scene")) {
        for (const Row& row : rows) {
            Where contender;
            for (const char* key : {"scene", "engine", "integrator", "numbers"})
                contender.emplace_back(key, text_of(row, key));
            if (row.at("scene") != scene || &row != find(rows, contender)) continue;
            lines.push_back({{scene, engine_name(row) + ", " + way(row), numbers_of(row)}, contender});
            costs.push_back(cost_of_a_millimetre(rows, contender));
        }
    }
    std::vector<Column> columns;
    for (const int rate : {64, 256, 1024, 4096})
        columns.push_back({"error at 1/" + std::to_string(rate) + " s, m", error, at(rate)});
    columns.insert(columns.end(), {{"gap, m", value("gap_m"), at(256)},
                                   {"energy moves by", energy, at(256)},
                                   {"insn per step", instructions, at(256)}});
    Table table = cross(rows, {"mechanism", "engine", "numbers"}, lines, columns);
    table.head.emplace_back("million insn a second for 1 mm");
    for (std::size_t i = 0; i < lines.size(); ++i) table.lines[i].push_back(costs[i]);
    return table;
}

Table joints_long_table(const Rows& all) {
    Rows rows = all;
    std::erase_if(rows, [](const Row& row) { return row.contains("engine"); });
    return list(rows, {},
                {{"pendulum", value("scene")},
                 {"numbers", value("numbers")},
                 {"steps", value("steps")},
                 {"mean energy moves by", [](const Row& row) { return signed_value(row, "energy_moved"); }},
                 {"largest change", value("energy_change")},
                 {"largest gap, m", value("gap_m")}});
}

}  // namespace tumble::bench
