// Writes the tables and figures of the pages from the result rows and from the kernel's constants. In a page, what
// stands between `<!-- table NAME -->` or `<!-- value NAME -->` and `<!-- end -->` is replaced: a table by lines of its
// own, a value within its line. With --check nothing is written; a difference, a table that no page shows and a broken
// promise of the long runs are errors.
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <set>

#include "firmware/firmware.hpp"
#include "host/host_tables.hpp"
#include "pictures/ladder.hpp"
#include "pictures/long_run_rows.hpp"
#include "port.hpp"
#include "scene/data.hpp"
#include "tables/cells.hpp"
#include "tables/joint_tables.hpp"
#include "tables/kernel_tables.hpp"
#include "tables/pages.hpp"

namespace {

using namespace tumble::bench;
using tumble::host::cost_of, tumble::host::has_cycles;

// The row of these values, which the table cannot do without.
const Row& row_of(const Rows& rows, const Where& where) {
    if (const Row* row = find(rows, where)) return *row;
    std::string what = "no row with";
    for (const auto& [key, text] : where) what += " " + key + " " + text;
    throw std::runtime_error{what};
}

// Two columns a core: the mean step and the worst.
std::vector<Column> steps_on(const Strings& cores, const Cell& mean_cell, const Cell& worst_cell) {
    std::vector<Column> columns;
    for (const std::string& core : cores) {
        columns.push_back({core, mean_cell, {{"core", core}}});
        columns.push_back({"worst", worst_cell, {{"core", core}}});
    }
    return columns;
}
// A line for each method.
std::vector<Line> lines_of(const Strings& methods, const Where& where) {
    std::vector<Line> lines;
    for (const std::string& name : methods) {
        lines.push_back({{in_code(name)}, where});
        lines.back().where.emplace_back("integrator", name);
    }
    return lines;
}

// The cost of a step of a free body, on the cores with cycles or on those without.
Table free_table(const Rows& rows, bool with_cycles) {
    Strings cores = distinct(rows, "core");
    std::erase_if(cores, [&](const std::string& core) {
        return with_cycles != std::any_of(rows.begin(), rows.end(),
                                          [&](const Row& row) { return row.at("core") == core && has_cycles(row); });
    });
    std::vector<Line> lines;
    for (const std::string numbers : {"q32 carry", "f32 plain"})
        for (const std::string& name : distinct(rows, "integrator"))
            lines.push_back({{in_code(name), numbers}, {{"integrator", name}, {"numbers", numbers}}});
    return cross(rows, {with_cycles ? "cycles" : "insn", "numbers"}, lines, steps_on(cores, bare_mean, bare_worst));
}

// The dissertation's cube: what each of its methods costs, and its errors.
Table cube_table(const Rows& rows) {
    const std::vector<Line> lines =
        lines_of({"explicit_euler", "implicit_euler", "heun", "midpoint", "rk4", "verlet"}, {{"numbers", "q32 carry"}});
    std::vector<Column> columns = steps_on(distinct(rows, "core"), mean, worst);
    columns.insert(columns.begin(), {{"position error, m", value("position_error_m")},
                                     {"orientation error, rad", value("orientation_error_rad")}});
    return cross(rows, {"cube, q32 carry"}, lines, columns);
}

// Whole firmware of what users build, small on an M0+ and fast on an M4F: the front page's first answer.
Table fits_table(const Rows& rows) {
    std::vector<Line> lines;
    for (const std::string& program : distinct(rows, "program")) lines.push_back({{program}, {{"program", program}}});
    std::vector<Column> columns;
    for (const auto& [name, core] : {std::pair{"M0+", "cortex-m0plus"}, std::pair{"M4F", "cortex-m4f"}})
        for (const auto& [head, key] :
             {std::pair{"flash, B", "text_bytes"}, std::pair{"RAM, B", "ram_bytes"},
              std::pair{"stack, B", "step_stack_bytes"}, std::pair{"cycles, mean", "cycles_per_step_est"},
              std::pair{"worst", "cycles_worst_step_est"}})
            columns.push_back({std::string{name} + ": " + head, value(key), {{"core", core}}});
    return cross(rows, {"firmware"}, lines, columns);
}

// One body that hits surfaces: its worst step with the bounds of a scene, and how far it comes from where it is
// without.
Table step_bounds_table(const Rows& rows, const Strings& scenes) {
    std::vector<Line> lines;
    for (const std::string& scene : scenes)
        for (const std::string& bounds : distinct(rows, "bounds"))
            lines.push_back({{scene, bounds}, {{"scene", scene}, {"bounds", bounds}}});
    std::vector<Column> columns;
    for (const auto& [name, core] :
         {std::pair{"M0+", "cortex-m0plus"}, std::pair{"M3", "cortex-m3"}, std::pair{"M4F", "cortex-m4f"}})
        columns.push_back({std::string{name} + ": worst", value("cycles_worst_step_est"), {{"core", core}}});
    columns.push_back({"error, m", value("position_error_m")});
    return cross(rows, {"scene", "bounds of a step"}, lines, columns);
}
// The largest of all their scenes.
Table largest_step_bounds_table(const Rows& rows) {
    Rows largest;
    for (const Row& row : rows) {
        const auto same = [&](const Row& other) {
            return other.at("bounds") == row.at("bounds") && other.at("core") == row.at("core");
        };
        auto of = std::find_if(largest.begin(), largest.end(), same);
        if (of == largest.end()) {
            of = largest.insert(of, row);
            (*of)["scene"] = "any of these";
        }
        for (const char* key : {"cycles_worst_step_est", "position_error_m"})
            if ((*of).at(key) < row.at(key)) (*of)[key] = row.at(key);
    }
    return step_bounds_table(largest, {"any of these"});
}

// The default method on every core.
Table cores_table(const Rows& rows) {
    const Where q32{{"integrator", "verlet"}, {"numbers", "q32 carry"}},
        plain{{"integrator", "verlet"}, {"numbers", "f32 plain"}};
    const auto bytes = [](const char* key) -> Cell {
        return [key](const Row& row) { return row.at("core") == "host" ? "-" : text_of(row, key) + " B"; };
    };
    std::vector<Line> lines;
    for (const std::string& core : distinct(rows, "core")) lines.push_back({{core}, {{"core", core}}});
    return cross(rows, {"core"}, lines,
                 {{"a step, q32", mean, q32},
                  {"worst", worst, q32},
                  {"a step, plain float", mean, plain},
                  {"worst", worst, plain},
                  {"flash, q32", bytes("text_bytes"), q32},
                  {"flash, plain float", bytes("text_bytes"), plain},
                  {"RAM, q32", bytes("ram_bytes"), q32},
                  {"RAM, plain float", bytes("ram_bytes"), plain}});
}

// Memory of a free body's program on an M3, in the number systems that the table of costs has.
Table size_table(Rows rows) {
    std::erase_if(rows,
                  [](const Row& row) { return numbers_of(row) != "q32 carry" && numbers_of(row) != "f32 plain"; });
    return list(rows, {{"core", "cortex-m3"}},
                columns("cortex-m3:@method|numbers:numbers|text bytes:text_bytes|RAM bytes:ram_bytes|"
                        "world bytes:world_bytes|stack bytes:stack_bytes|bound of a step:step_stack_bound_bytes|"
                        "cycles a step:@mean|worst step:@worst"));
}

// What -Os saves and costs beside -O2.
Table optimization_table(const Rows& rows) {
    const auto change = [](double from, double to) { return text("%+.1f %%", 100 * (to / from - 1)); };
    Table table{{"scene", "core", "flash, -O2", "-Os", "change", "bound of stack, -O2", "-Os", "cycles a step, -O2",
                 "-Os", "change", "worst step, -O2", "-Os"},
                {}};
    for (const std::string& scene : distinct(rows, "scene")) {
        for (const std::string& core : distinct(rows, "core")) {
            const auto at_level = [&](const char* level) -> const Row& {
                const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
                    return r.at("scene") == scene && r.at("core") == core &&
                           r.at("flags").get<std::string>().starts_with(level);
                });
                if (row == rows.end()) throw std::runtime_error{"no row of " + scene + ", " + core + ", " + level};
                return *row;
            };
            const Row &fast = at_level("-O2"), &small = at_level("-Os");
            table.lines.push_back({scene, core, text_of(fast, "text_bytes"), text_of(small, "text_bytes"),
                                   change(fast.at("text_bytes"), small.at("text_bytes")),
                                   text_of(fast, "step_stack_bound_bytes"), text_of(small, "step_stack_bound_bytes"),
                                   mean(fast), mean(small), change(cost_of(fast).mean, cost_of(small).mean),
                                   worst(fast), worst(small)});
        }
    }
    return table;
}

// What the last step and the text of one scene take less than those of another that differs in one thing, in integers.
Table skipped_table(const Rows& rows) {
    constexpr const char* pairs[][3] = {
        {"all code of contacts, without planes and pairs", "free body", "plane out of reach"},
        {"the test of a plane that is out of reach", "plane out of reach", "plane within reach"},
        {"code of boxes, among spheres", "ball and ball", "ball and box"},
        {"code of friction, without friction", "resting box", "resting box, rough"},
    };
    Table table{{"not paid for", "core", "cycles a step, expected", "text bytes"}, {}};
    for (const auto& [what, scene_without, scene_with] : pairs) {
        for (const std::string& core : distinct(rows, "core")) {
            const Row &without = row_of(rows, {{"scene", scene_without}, {"core", core}, {"numbers", "q32 carry"}}),
                      &with = row_of(rows, {{"scene", scene_with}, {"core", core}, {"numbers", "q32 carry"}});
            const auto saved = [&](const char* key) {
                return std::to_string(with.at(key).get<long>() - without.at(key).get<long>());
            };
            const bool cycles = has_cycles(without) && has_cycles(with);
            table.lines.push_back({what, core,
                                   cycles ? saved("cycles_last_step_est") : saved("insn_per_step_last") + " insn",
                                   saved("text_bytes")});
        }
    }
    return table;
}

// What each rung of a ladder adds to those above it, between the empty world and the sum.
Table ladder_table(const Rows& rows, const std::string& name) {
    constexpr std::pair<const char*, const char*> columns[] = {{"code, B", "code_bytes"},
                                                               {"constants, B", "rodata_bytes"},
                                                               {"RAM, B", "ram_bytes"},
                                                               {"stack, B", "step_stack_bytes"},
                                                               {"its bound, B", "step_stack_bound_bytes"},
                                                               {"cycles a step", "cycles_per_step_est"},
                                                               {"worst step", "cycles_worst_step_max"},
                                                               {"last step", "cycles_last_step_est"}};
    const auto ladders = ladders_of(rows);
    const auto ladder = std::find_if(ladders.begin(), ladders.end(), [&](const auto& l) { return l.name() == name; });
    if (ladder == ladders.end()) throw std::runtime_error{"no feature ladder of " + name};
    Table table{{name}, {}};
    for (const auto& column : columns) table.head.emplace_back(column.first);
    // The values of a row; what they are more than those of the row below, where there is one.
    const auto add = [&](const std::string& feature, const Row& row, const Row* below) {
        Strings line{feature};
        for (const auto& [head, key] : columns) {
            if (!row.contains(key) || (below != nullptr && !below->contains(key))) {
                line.emplace_back("-");
                continue;
            }
            long long number = std::llround(row.at(key).get<double>());
            if (below != nullptr) number -= std::llround(below->at(key).get<double>());
            line.push_back((below != nullptr && number > 0 ? "+" : "") + std::to_string(number));
        }
        table.lines.push_back(line);
    };
    const Rows& rungs = ladder->rungs;
    add(ladder->feature(0), rungs.front(), nullptr);
    for (std::size_t i = 1; i < rungs.size(); ++i) add(ladder->feature(i), rungs[i], &rungs[i - 1]);
    add("all of them", rungs.back(), nullptr);
    return table;
}

// The row that costs least of those with at most the error, in its problem's own unit; null where there is none.
const Row* cheapest(const std::vector<const Row*>& rows, double tolerance) {
    const Row* best = nullptr;
    for (const Row* row : rows) {
        if (row->contains("failure")) continue;
        const char* error = row->contains("position_error_m") ? "position_error_m" : "orientation_error_rad";
        if (row->at(error).get<double>() > tolerance) continue;
        if (best == nullptr || cost_of_simulated_second(*row).expected < cost_of_simulated_second(*best).expected)
            best = row;
    }
    return best;
}

// The cheapest way to stay below an error, beside what Boost.Odeint's RK4 in float costs for it. A simulated second is
// in estimated cycles where the core has a timing table.
Table front_table(const Rows& rows, const char* error_name) {
    Table table{{"problem", error_name, "core", "the cheapest", "a simulated s", "worst step", "Odeint RK4, float"},
                {}};
    Strings cores = distinct(rows, "core");
    std::erase(cores, "host");
    const auto cost_text = [](const Row* row) {
        return row == nullptr ? "not reached" : cost_of_simulated_second(*row).text();
    };
    std::map<std::pair<std::string, std::string>, std::vector<const Row*>> ours, peers;
    std::map<std::pair<std::string, std::string>, bool> in_cycles;
    for (const Row& row : rows) {
        const std::pair<std::string, std::string> at{row.at("scene"), row.at("core")};
        const bool cycles = cost_of_simulated_second(row).in_cycles;
        if (in_cycles.try_emplace(at, cycles).first->second != cycles)
            throw std::runtime_error{at.first + ", " + at.second + ": some rows have cycles and some have none"};
        if (!row.at("integrator").get<std::string>().starts_with("odeint_")) ours[at].push_back(&row);
        else if (row.at("integrator") == "odeint_rk4" && row.at("numbers") == "f32") peers[at].push_back(&row);
    }
    for (const std::string& scene : distinct(rows, "scene")) {
        for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8}) {
            for (const std::string& core : cores) {
                const Row *best = cheapest(ours[{scene, core}], tolerance),
                          *peer = cheapest(peers[{scene, core}], tolerance);
                table.lines.push_back({scene, text("%.0e", tolerance), core,
                                       best == nullptr
                                           ? "none"
                                           : method(*best) + " " + numbers_of(*best) +
                                                 text(", 1/%ld s", std::lround(1 / best->at("step_s").get<double>())),
                                       cost_text(best), best == nullptr ? "-" : text_of(*best, "cycles_worst_step_max"),
                                       peers[{scene, core}].empty() ? "-" : cost_text(peer)});
            }
        }
    }
    return table;
}

// What a method does to what its problem conserves: a line a method, columns for each number system. `conserved`:
// "momentum" or "vertical momentum".
Table long_run_table(const Rows& rows, const std::string& scene, const std::string& conserved) {
    const std::vector<Line> lines = lines_of(distinct(rows, "integrator"), {{"scene", scene}});
    std::vector<Column> columns;
    const std::string momentum = conserved == "momentum" ? "world_momentum" : "vertical_momentum";
    for (const auto& [key, name] : {std::pair{std::string{"energy"}, std::string{"energy"}}, {momentum, conserved}})
        for (const std::string& n : systems)
            columns.push_back({name + ", " + n, unless_failed(value(key + "_max_relative_drift")), {{"numbers", n}}});
    return cross(rows, {scene}, lines, columns);
}

// Long runs: a line a scene and method.
Table long_runs_table(const Rows& rows, const Cell& cell) {
    std::vector<Line> lines;
    std::set<Strings> seen;
    for (const Row& row : rows) {
        const Strings first{row.at("scene"), method(row), text_of(row, "steps")};
        if (seen.insert(first).second)
            lines.push_back({first, {{"scene", first[0]}, {"integrator", row.at("integrator")}, {"steps", first[2]}}});
    }
    std::vector<Column> columns;
    for (const std::string& n : systems) columns.push_back({n, unless_failed(cell), {{"numbers", n}}});
    return cross(rows, {"scene", "integrator", "steps"}, lines, columns);
}
std::string energy_of_tenths(const Row& row) {
    return text_of(row, "energy_first_tenth") + ", " + text_of(row, "energy_last_tenth");
}
std::string largest_besides_energy(const Row& row) {
    double largest = 0;
    for (const Row& each : row.at(row.contains("momentum") ? "momentum" : "penetration_m"))
        largest = std::max(largest, each.get<double>());
    return text("%.1e", largest);
}

// The median of the observed orders of these rows.
std::string order_of(const Rows& rows, const Where& where) {
    std::vector<double> orders;
    for (const Row& row : rows)
        if (is_where(row, where) && row.contains("observed_order")) orders.push_back(row.at("observed_order"));
    const auto order = median_order(orders);
    return order ? text("%.1f", *order) : "-";
}

// The largest error of a system of equations at some steps, from 2^-first s to 2^-last s, and the median of the
// observed orders.
Table ordinary_table(const Rows& rows, const std::string& scene, int first, int last) {
    std::vector<Line> lines;
    for (const std::string& n : systems)
        for (const std::string& name : distinct(rows, "integrator"))
            lines.push_back({{in_code(name) + " " + n}, {{"scene", scene}, {"integrator", name}, {"numbers", n}}});
    const Cell error = [](const Row& row) { return row.contains("failure") ? "fails" : text_of(row, "state_error"); };
    std::vector<Column> columns;
    for (int n = first; n <= last; n += 2)
        columns.push_back({text("1/%d s", 1 << n), error, {{"step_s", text("%.1e", std::ldexp(1.0, -n))}}});
    columns.push_back({"order", [&](const Row& row) {
                           return order_of(
                               rows,
                               {{"scene", scene}, {"integrator", row.at("integrator")}, {"numbers", numbers_of(row)}});
                       }});
    return cross(rows, {scene}, lines, columns);
}

std::string error_of(const Row& row) { return row.contains("failure") ? "fails" : text_of(row, "error"); }

// The errors of scenes with contacts by the step, and the median of the observed orders of those in double.
Table contact_laws_table(const Rows& rows) {
    std::vector<Line> lines;
    for (const std::string& scene : distinct(rows, "scene"))
        lines.push_back({{scene, text_of(row_of(rows, {{"scene", scene}}), "law")}, {{"scene", scene}}});
    std::vector<Column> columns;
    for (const int n : {128, 256, 512, 1024})
        columns.push_back({text("1/%d s", n), error_of, {{"numbers", "f64"}, {"step_s", text("%.1e", 1.0 / n)}}});
    // Errors that are only rounding have no order.
    Rows resolved = rows;
    std::erase_if(resolved, [](const Row& row) { return row.contains("failure") || !(row.at("error") > 1e-9); });
    columns.push_back({"order", [&](const Row& row) {
                           return order_of(resolved, {{"scene", row.at("scene")}, {"numbers", "f64"}});
                       }});
    columns.push_back({"q32, 1/256 s", error_of, {{"numbers", "q32 carry"}, {"step_s", text("%.1e", 1.0 / 256)}}});
    return cross(rows, {"scene", "error, in double"}, lines, columns);
}

// All engines with all their ways to step; of this kernel the methods that a reader would choose between.
Table engines_table(Rows rows) {
    const std::set<std::string> own{"semi_implicit_euler", "rk4", "verlet", "suzuki4", "pdmv6", "exact"};
    std::erase_if(rows,
                  [&](const Row& row) { return row.at("engine") == "tumble" && !own.contains(row.at("integrator")); });
    return list(rows, {},
                columns("engine:@engine|method:@way|numbers:numbers|orientation error, rad:orientation_error_rad|"
                        "within 0.1 rad for, s:@within|energy drift:energy_max_relative_drift|"
                        "insn per step, x86-64:insn_per_step"));
}

// With a star where the kernel reported something.
std::string error_or_trouble(const Row& row) {
    const std::string error = row.contains("failure") || row.contains("error") ? error_of(row) : "-";
    return error + (row.contains("trouble") ? " *" : "");
}

// Contacts whose motion is known: for each scene the errors of each contender, then the cost of a step.
Table engine_contacts_table(const Rows& rows) {
    // A contender is named with its method where its engine has several.
    const auto name_of = [&](const Row& row) {
        const Where engine{{"engine", row.at("engine")}, {"numbers", numbers_of(row)}};
        const bool has_one = distinct(rows, "integrator", engine).size() == 1;
        return engine_name(row) + (has_one ? "" : ", " + text_of(row, "integrator")) + ", " + numbers_of(row);
    };
    Table table{{"scene", "step", "error, or cost"}, {}};
    std::vector<Where> contenders;
    for (const Row& row : rows) {
        if (std::find(table.head.begin(), table.head.end(), name_of(row)) != table.head.end()) continue;
        table.head.push_back(name_of(row));
        contenders.push_back(
            {{"engine", row.at("engine")}, {"integrator", row.at("integrator")}, {"numbers", numbers_of(row)}});
    }
    const auto add = [&](const std::string& scene, const std::string& step, const std::string& law,
                         const std::string& what, const Cell& cell) {
        const double seconds = find(rows, {{"scene", scene}, {"step_s", step}})->at("step_s");
        Strings line{scene, text("1/%.0f s", 1 / seconds), what};
        for (Where where : contenders) {
            where.insert(where.end(), {{"scene", scene}, {"step_s", step}, {"law", law}});
            const Row* row = find(rows, where);
            line.push_back(row == nullptr ? "-" : cell(*row));
        }
        table.lines.push_back(line);
    };
    for (const std::string& scene : distinct(rows, "scene")) {
        const Strings laws = distinct(rows, "law", {{"scene", scene}});
        for (const std::string& step : distinct(rows, "step_s", {{"scene", scene}})) {
            for (const std::string& law : laws) add(scene, step, law, law, error_or_trouble);
            add(scene, step, laws.front(), "insn per step, x86-64", value("insn_per_step"));
        }
    }
    return table;
}

// Engines in one process of node: a column for each. Lines are scenes, or scenes with their laws.
std::string web_engine(const Row& row) {
    const std::string method = row.at("integrator");
    const bool own = row.at("engine") == "tumble";
    return engine_name(row) + (method.empty() || own ? "" : ", " + method) + (own ? ", " + numbers_of(row) : "");
}
Table web_table(const Rows& rows, double step, bool with_laws, const std::function<bool(const Row&)>& belongs,
                const Cell& cell) {
    Table table{{with_laws ? "scene: error" : "scene"}, {}};
    std::map<std::string, std::size_t> columns, lines;
    for (const Row& row : rows) {
        if (row.at("step_s").get<double>() != step || !belongs(row)) continue;
        const auto [column, is_new] = columns.try_emplace(web_engine(row), table.head.size());
        if (is_new) table.head.push_back(column->first);
        const std::string name = row.at("scene").get<std::string>() + (with_laws ? ": " + text_of(row, "law") : "");
        const auto [line, is_new_line] = lines.try_emplace(name, table.lines.size());
        if (is_new_line) table.lines.push_back({name});
        Strings& cells = table.lines[line->second];
        cells.resize(std::max(cells.size(), column->second + 1), "-");
        cells[column->second] = cell(row);
    }
    for (Strings& cells : table.lines) cells.resize(table.head.size(), "-");
    return table;
}
bool is_heap(const Row& row) { return row.at("scene").get<std::string>().starts_with("heap"); }
bool is_no_heap(const Row& row) { return !is_heap(row); }
std::string web_time(const Row& row) {
    if (row.contains("failure") && !row.contains("us_per_step")) return "fails";
    const auto digits = [](double us) { return text(us < 1 ? "%.2f" : us < 10 ? "%.1f" : "%.0f", us); };
    return digits(row.at("us_per_step")) + " / " + digits(row.at("us_worst_eight"));
}
std::string web_bytes(const Row& row) {
    return row.at("wasm_bytes") == 0 ? "-" : text("%.0f", row.at("wasm_bytes").get<double>() / 1000);
}
Table web_size_table(const Rows& rows) {
    Table table{{"engine", "numbers", "WebAssembly, KB", "same bits in each run"}, {}};
    std::map<std::string, std::size_t> lines;
    for (const Row& row : rows) {
        const auto [line, is_new] = lines.try_emplace(web_engine(row), table.lines.size());
        if (is_new) table.lines.push_back({web_engine(row), row.at("numbers"), web_bytes(row), "yes"});
        if (row.contains("repeats") && !row.at("repeats").get<bool>()) table.lines[line->second].back() = "no";
    }
    return table;
}

// Engines on cores: a line for each scene, engine and step.
Table core_engines_table(const Rows& rows) {
    std::vector<Line> lines;
    for (const std::string& scene : distinct(rows, "scene")) {
        for (const Row& row : rows) {
            const std::string step = text("1/%.0f s", 1 / row.at("step_s").get<double>());
            const Strings first{scene, engine_name(row) + ", " + text_of(row, "integrator"), numbers_of(row), step};
            const bool is_there =
                std::any_of(lines.begin(), lines.end(), [&](const Line& line) { return line.first == first; });
            if (row.at("scene") != scene || is_there) continue;
            Where where;
            for (const char* key : {"scene", "engine", "integrator", "numbers", "step_s"})
                where.emplace_back(key, text_of(row, key));
            lines.push_back({first, where});
        }
    }
    std::vector<Column> columns = steps_on({"cortex-m4f", "cortex-m3"}, bare_mean, bare_worst);
    const Cell ram = [](const Row& row) {
        int bytes = 0;
        for (const char* key : {"ram_bytes", "heap_bytes", "step_stack_bytes"}) bytes += row.at(key).get<int>();
        return std::to_string(bytes);
    };
    const Where on_m4f{{"core", "cortex-m4f"}};
    columns.insert(columns.end(), {{"error, m", error_or_trouble, on_m4f},
                                   {"overlap, m", value("overlap_m"), on_m4f},
                                   {"flash, B", value("text_bytes"), on_m4f},
                                   {"RAM, B", ram, on_m4f}});
    return cross(rows, {"scene", "engine", "numbers", "step"}, lines, columns);
}

// The cores that firmware is built for: rows of port/boards.txt.
Table boards_table() {
    Table table{{"core", "port", "machine and CPU", "counts", "model of its cycles", "tested by", "compiler's options"},
                {}};
    for (const tumble::host::Core& core : tumble::host::cores())
        table.lines.push_back({core.name, core.port, core.machine, core.counter.substr(0, core.counter.find(':')),
                               core.timing, core.set == "quick" ? "make test" : "make check", in_code(core.flags)});
    return table;
}

// The cycles of a free body's step in one number system as a multiple of those in another: the least and the most over
// all methods that run in both; "-" where rows have no cycles.
std::string times_as_many(const Rows& rows, const std::string& core, const std::string& dear,
                          const std::string& cheap) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const std::string& name : distinct(rows, "integrator")) {
        const Row *a = find(rows, {{"core", core}, {"integrator", name}, {"numbers", dear}}),
                  *b = find(rows, {{"core", core}, {"integrator", name}, {"numbers", cheap}});
        if (a == nullptr || b == nullptr || !has_cycles(*a) || !has_cycles(*b)) continue;
        const double ratio = cost_of(*a).mean / cost_of(*b).mean;
        least = std::min(least, ratio);
        most = std::max(most, ratio);
    }
    return most == 0 ? "-" : text("%.1f to %.1f", least, most);
}

const char* contact_columns = "scene:scene|core:core|numbers:numbers|cycles a step:@mean|last step:@last|"
                              "worst step:@worst|text bytes:text_bytes|RAM bytes:ram_bytes";

using R = const Results&;
// The error of rk4 on the tests' top after 100 s.
std::string top_error(R r, const char* numbers) {
    return text_of(row_of(r["engines"], {{"engine", "tumble"}, {"integrator", "rk4"}, {"numbers", numbers}}),
                   "orientation_error_rad");
}
// The least clock, in whole MHz, at which each step of the cube ends within its 0.005 s on this core.
std::string clock_of_cube(R r, const char* core) {
    const Row& row = row_of(r["cube"], {{"core", core}, {"integrator", "verlet"}});
    return text("%.0f MHz", std::ceil(cost_of(row).worst / 0.005 / 1e6));
}
const Makers makers{
    {"table boards", [](R) { return boards_table(); }},
    {"table fits", [](R r) { return fits_table(r["fits"]); }},
    {"table step_bounds", [](R r) { return step_bounds_table(r["bounds"], distinct(r["bounds"], "scene")); }},
    {"table step_bounds_of_all", [](R r) { return largest_step_bounds_table(r["bounds"]); }},
    {"table cores", [](R r) { return cores_table(r["free"]); }},
    {"table free", [](R r) { return free_table(r["free"], true); }},
    {"table free_insn", [](R r) { return free_table(r["free"], false); }},
    {"table size", [](R r) { return size_table(r["free"]); }},
    {"table optimization", [](R r) { return optimization_table(r["optimization"]); }},
    {"table integrators", [](R r) { return integrators_table(r["free"]); }},
    {"table cube", [](R r) { return cube_table(r["cube"]); }},
    {"value cube_clock_m0", [](R r) { return clock_of_cube(r, "cortex-m0"); }},
    {"value cube_clock_m3", [](R r) { return clock_of_cube(r, "cortex-m3"); }},
    {"value cube_clock_m4f", [](R r) { return clock_of_cube(r, "cortex-m4f"); }},
    {"table front", [](R r) { return front_table(r["work_precision"], "error below, rad"); }},
    {"table front_loads", [](R r) { return front_table(r["work_precision_loads"], "error below, m or rad"); }},
    {"table contacts", [](R r) { return list(r["contacts"], {}, columns(contact_columns)); }},
    {"table contact_laws", [](R r) { return contact_laws_table(r["contact_laws"]); }},
    {"table skipped", [](R r) { return skipped_table(r["contacts"]); }},
    {"table ladder_cortex_m0", [](R r) { return ladder_table(r["ladder"], "cortex-m0 q32 carry"); }},
    {"table ladder_cortex_m3", [](R r) { return ladder_table(r["ladder"], "cortex-m3 q32 carry"); }},
    {"table ladder_cortex_m4f", [](R r) { return ladder_table(r["ladder"], "cortex-m4f q32 carry"); }},
    {"table ladder_cortex_m4f_float", [](R r) { return ladder_table(r["ladder"], "cortex-m4f f32 plain"); }},
    {"table long_run_free", [](R r) { return long_run_table(r["long_run"], "generic top", "momentum"); }},
    {"table long_run_heavy", [](R r) { return long_run_table(r["long_run"], "heavy top", "vertical momentum"); }},
    {"table long_runs_energy", [](R r) { return long_runs_table(r["long_run_series"], energy_of_tenths); }},
    {"table long_runs_besides", [](R r) { return long_runs_table(r["long_run_series"], largest_besides_energy); }},
    {"table oscillator", [](R r) { return ordinary_table(r["ordinary"], "harmonic oscillator", 2, 10); }},
    {"table lorenz", [](R r) { return ordinary_table(r["ordinary"], "Lorenz system", 6, 12); }},
    {"table host", [](R r) { return host_table(r["host"]); }},
    {"table host_many", [](R r) { return host_many_table(r["host"]); }},
    {"table host_growth", [](R r) { return host_growth_table(r["host"]); }},
    {"table engines", [](R r) { return engines_table(r["engines"]); }},
    {"table engine_contacts", [](R r) { return engine_contacts_table(r["engine_contacts"]); }},
    {"table joints", [](R r) { return joints_table(r["joints"]); }},
    {"table joints_long", [](R r) { return joints_long_table(r["joints"]); }},
    {"table core_engines", [](R r) { return core_engines_table(r["core_engines"]); }},
    {"table web_errors",
     [](R r) { return web_table(r["web_engines"], 1.0 / 256, true, is_no_heap, error_or_trouble); }},
    {"table web_errors_60",
     [](R r) { return web_table(r["web_engines"], 1.0 / 60, true, is_no_heap, error_or_trouble); }},
    {"table web_times", [](R r) { return web_table(r["web_engines"], 1.0 / 60, false, is_no_heap, web_time); }},
    {"table web_heaps", [](R r) { return web_table(r["web_engines"], 1.0 / 60, false, is_heap, web_time); }},
    {"table web_overlaps", [](R r) { return web_table(r["web_engines"], 1.0 / 60, false, is_heap, error_or_trouble); }},
    {"table web_size", [](R r) { return web_size_table(r["web_engines"]); }},
    {"table control", [](R r) { return control_table(r["control"]); }},
    {"table stories", [](R r) { return stories_table(r["control"]); }},
    {"table formats", [](R) { return formats_table(); }},
    {"table bounds", [](R) { return bounds_table(); }},
    {"table near_pairs", [](R) { return near_pairs_table(); }},
    {"table stability", [](R) { return stability_table(); }},
    {"table resolution", [](R) { return resolution_table(); }},
    {"value float_on_m0", [](R r) { return times_as_many(r["free"], "cortex-m0", "f32 plain", "q32 carry"); }},
    {"value float_on_m3", [](R r) { return times_as_many(r["free"], "cortex-m3", "f32 plain", "q32 carry"); }},
    {"value q32_on_m4f", [](R r) { return times_as_many(r["free"], "cortex-m4f", "q32 carry", "f32 plain"); }},
    {"value q32_on_m4f_both_carry",
     [](R r) { return times_as_many(r["free"], "cortex-m4f", "q32 carry", "f32 carry"); }},
    {"value top_error_q32", [](R r) { return top_error(r, "q32 carry"); }},
    {"value top_error_f32", [](R r) { return top_error(r, "f32 plain"); }},
    {"value max_bodies", [](R) { return std::to_string(tumble::host::max_bodies); }},
    {"value max_joints", [](R) { return std::to_string(tumble::host::max_joints); }},
    {"value max_planes", [](R) { return std::to_string(tumble::host::max_planes); }},
    {"value max_springs", [](R) { return std::to_string(tumble::host::max_springs); }},
    {"value max_near_pairs", [](R) { return std::to_string(tumble::host::max_near_pairs); }},
    {"value largest_turn_q32", [](R) { return largest_turn(); }},
    {"value readout_q32", [](R) { return readout_bytes(true, false); }},
    {"value readout_q32_friction", [](R) { return readout_bytes(true, true); }},
    {"value readout_f32", [](R) { return readout_bytes(false, false); }},
    {"value readout_f32_friction", [](R) { return readout_bytes(false, true); }},
    {"value event_q32", [](R) { return std::to_string(sizeof(tumble::Event<tumble::Q32<>>)); }},
    {"value event_f32", [](R) { return std::to_string(sizeof(tumble::Event<tumble::F32>)); }},
    {"value event_spec", [](R) { return std::to_string(sizeof(tumble::EventSpec)); }},
    {"value abort_status", [](R) { return std::to_string(tumble::port::abort_status); }},
    {"value text_lost_status", [](R) { return std::to_string(tumble::port::text_lost_status); }},
    {"value no_counter_status", [](R) { return std::to_string(tumble::port::no_counter_status); }},
};

// The makers that no page uses, and the promises that the rows of the long runs break.
Strings faults_of(R results, const std::set<std::string>& used) {
    Strings faults;
    for (const auto& [name, maker] : makers)
        if (!used.contains(name)) faults.push_back(name + " is in no page");
    for (const std::string& promise : broken_promises(results["long_run_series"]))
        faults.push_back("broken in long_run_series.jsonl: " + promise);
    return faults;
}

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    const bool check = argc > 1 && std::string{argv[1]} == "--check";
    const int first = check ? 2 : 1;
    if (argc < first + 2) {
        std::cerr << "usage: tumble_tables [--check] RESULTS_DIRECTORY PAGE.md...\n";
        return 2;
    }
    const Results results{argv[first]};
    std::set<std::string> used;
    Strings faults;
    for (int i = first + 1; i < argc; ++i) {
        const std::string page = argv[i], now = read_file(page), wanted = filled_in(page, now, makers, results, used);
        if (now == wanted) continue;
        if (check)
            faults.push_back(page + ": its tables differ from the rows of " + argv[first] + "; run `make tables`");
        else tumble::host::write_file(page, wanted);
    }
    if (check)
        for (const std::string& fault : faults_of(results, used)) faults.push_back(fault);
    for (const std::string& fault : faults) std::cerr << fault << '\n';
    return faults.empty() ? 0 : 1;
} catch (...) { return tumble::bench::report_failure("tumble_tables"); }
