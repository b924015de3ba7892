// Writes the tables and figures of the pages from result rows and from the kernel's own constants, so that they cannot
// drift from what was measured: everything between `<!-- table NAME -->` or `<!-- value NAME -->` and `<!-- end -->` is
// replaced, a table by lines of its own and a value within its line. With --check nothing is written, and a difference
// is an error.
#include <tumble/integrators/list.hpp>
#include <tumble/tumble.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "drawing.hpp"
#include "firmware/cost.hpp"
#include "host/host_rows.hpp"
#include "ladder.hpp"
#include "long_run_rows.hpp"
#include "port.hpp"
#include "rows.hpp"
#include "scene/data.hpp"

namespace {

using tumble::bench::cost_of_simulated_second, tumble::bench::numbers_of, tumble::bench::Row;
using tumble::host::cost_of, tumble::host::has_cycles, tumble::host::StepCost;

struct Table {
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;

    [[nodiscard]] std::string markdown() const {
        std::ostringstream out;
        const auto line = [&](const std::vector<std::string>& cells) {
            for (const std::string& cell : cells) out << "| " << cell << ' ';
            out << "|\n";
        };
        line(head);
        for (std::size_t i = 0; i < head.size(); ++i) out << (i == 0 ? "|---" : "|---:");
        out << "|\n";
        for (const auto& row : rows) line(row);
        return out.str();
    }
};

std::string text_of(const Row& row, const char* key) {
    if (!row.contains(key) || row.at(key).is_null()) return "-";
    if (row.at(key).is_number_float()) {
        char text[32];
        std::snprintf(text, sizeof text, "%.1e", row.at(key).get<double>());
        return text;
    }
    return row.at(key).dump();
}

// Names in order of their first row.
std::vector<std::string> distinct(const std::vector<Row>& rows, const auto& name) {
    std::vector<std::string> names;
    for (const Row& row : rows) {
        if (std::string n = name(row); std::find(names.begin(), names.end(), n) == names.end()) names.push_back(n);
    }
    return names;
}

std::vector<std::string> cores_of(const std::vector<Row>& rows) {
    return distinct(rows, [](const Row& r) { return r.at("core").get<std::string>(); });
}

std::string integrator_of(const Row& row) { return row.at("integrator").get<std::string>(); }

// The cores whose rows have cycles, or those whose rows have none.
std::vector<std::string> cores_of(const std::vector<Row>& rows, bool with_cycles) {
    std::vector<std::string> cores;
    for (const auto& core : cores_of(rows))
        if (with_cycles == std::any_of(rows.begin(), rows.end(),
                                       [&](const Row& row) { return row.at("core") == core && has_cycles(row); }))
            cores.push_back(core);
    return cores;
}

const Row* find_row(const std::vector<Row>& rows, const std::string& core, const std::string& method,
                    const std::string& numbers) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
        return integrator_of(r) == method && r.at("core") == core && numbers_of(r) == numbers;
    });
    return found == rows.end() ? nullptr : &*found;
}

std::string mean_of(const Row* row) { return row == nullptr ? "-" : cost_of(*row).mean_text(); }
std::string worst_of(const Row* row) { return row == nullptr ? "-" : cost_of(*row).worst_text(); }

// One line a method and number system; for each core the mean step and the worst.
Table free_table(const std::vector<Row>& rows, bool with_cycles) {
    Table table;
    const auto cores = cores_of(rows, with_cycles);
    table.head = {with_cycles ? "cycles" : "insn", "numbers"};
    for (const auto& core : cores) {
        table.head.push_back(core);
        table.head.emplace_back("worst");
    }
    for (const std::string numbers : {"q32 carry", "f32 plain"}) {
        for (const auto& method : distinct(rows, integrator_of)) {
            std::vector<std::string> line{"`" + method + "`", numbers};
            bool has_any = false;
            for (const auto& core : cores) {
                const Row* row = find_row(rows, core, method, numbers);
                has_any = has_any || row != nullptr;
                const StepCost cost = row == nullptr ? StepCost{} : cost_of(*row);
                const auto text = [&](double expected, double least, double most) {
                    return row == nullptr || std::isnan(expected) ? "-"
                                                                  : tumble::host::range_text(expected, least, most);
                };
                line.push_back(text(cost.mean, cost.least, cost.most));
                line.push_back(text(cost.worst, cost.worst, cost.worst));
            }
            if (has_any) table.rows.push_back(line);
        }
    }
    return table;
}

Table size_table(const std::vector<Row>& rows, const std::string& core) {
    Table table;
    table.head = {core,          "numbers",         "text bytes",    "RAM bytes", "world bytes",
                  "stack bytes", "bound of a step", "cycles a step", "worst step"};
    for (const Row& row : rows) {
        if (row.at("core") != core) continue;
        table.rows.push_back({"`" + integrator_of(row) + "`", numbers_of(row), text_of(row, "text_bytes"),
                              text_of(row, "ram_bytes"), text_of(row, "world_bytes"), text_of(row, "stack_bytes"),
                              text_of(row, "step_stack_bound_bytes"), mean_of(&row), worst_of(&row)});
    }
    return table;
}

// The dissertation's cube: what each of its methods costs beside what it gets wrong.
Table cube_table(const std::vector<Row>& rows) {
    Table table;
    table.head = {"cube, q32 carry", "position error, m", "orientation error, rad"};
    const auto cores = cores_of(rows);
    for (const auto& core : cores) {
        table.head.push_back(core);
        table.head.emplace_back("worst");
    }
    for (const std::string method : {"explicit_euler", "implicit_euler", "heun", "midpoint", "rk4", "verlet"}) {
        const Row* first = cores.empty() ? nullptr : find_row(rows, cores.front(), method, "q32 carry");
        if (first == nullptr) continue;
        std::vector<std::string> line{"`" + method + "`", text_of(*first, "position_error_m"),
                                      text_of(*first, "orientation_error_rad")};
        for (const auto& core : cores) {
            const Row* row = find_row(rows, core, method, "q32 carry");
            line.push_back(mean_of(row));
            line.push_back(worst_of(row));
        }
        table.rows.push_back(line);
    }
    return table;
}

// The last step as mean_text() has the mean.
std::string last_of(const Row& row) {
    if (!has_cycles(row)) return text_of(row, "insn_per_step_last") + " insn";
    return tumble::host::range_text(row.at("cycles_last_step_est"), row.at("cycles_last_step_min"),
                                    row.at("cycles_last_step_max"));
}

// What a contact scene costs, core by core.
Table contacts_table(const std::vector<Row>& rows) {
    Table table;
    table.head = {"scene", "core", "numbers", "cycles a step", "last step", "worst step", "text bytes", "RAM bytes"};
    for (const Row& row : rows) {
        table.rows.push_back({row.at("scene").get<std::string>(), row.at("core").get<std::string>(), numbers_of(row),
                              mean_of(&row), last_of(row), worst_of(&row), text_of(row, "text_bytes"),
                              text_of(row, "ram_bytes")});
    }
    return table;
}

// What the last step and the text of one scene take less than those of another that differs in one thing, in integers.
Table skipped_table(const std::vector<Row>& rows) {
    struct Pair {
        const char *what, *without, *with;
    };
    constexpr Pair pairs[] = {
        {"all code of contacts, without planes and pairs", "free body", "plane out of reach"},
        {"the test of a plane that is out of reach", "plane out of reach", "plane within reach"},
        {"code of boxes, among spheres", "ball and ball", "ball and box"},
        {"code of friction, without friction", "resting box", "resting box, rough"},
    };
    const auto find = [&](const char* scene, const std::string& core) {
        const auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
            return r.at("scene") == scene && r.at("core") == core && r.at("numbers") == "q32";
        });
        if (row == rows.end()) throw std::runtime_error{std::string{"no row of \""} + scene + "\" on " + core};
        return *row;
    };
    Table table;
    table.head = {"not paid for", "core", "cycles a step, expected", "text bytes"};
    for (const Pair& pair : pairs) {
        for (const auto& core : cores_of(rows)) {
            const Row without = find(pair.without, core), with = find(pair.with, core);
            const auto saved = [&](const char* key) {
                return std::to_string(with.at(key).get<long>() - without.at(key).get<long>());
            };
            const bool cycles = has_cycles(without) && has_cycles(with);
            table.rows.push_back({pair.what, core,
                                  cycles ? saved("cycles_last_step_est") : saved("insn_per_step_last") + " insn",
                                  saved("text_bytes")});
        }
    }
    return table;
}

// What each rung of a ladder adds to the ones above it, below what the empty world takes and above what all take
// together.
Table ladder_table(const std::vector<Row>& rows, const std::string& core, const std::string& numbers) {
    constexpr std::pair<const char*, const char*> columns[] = {
        {"code, B", "code_bytes"},
        {"constants, B", "rodata_bytes"},
        {"RAM, B", "ram_bytes"},
        {"stack, B", "step_stack_bytes"},
        {"its bound, B", "step_stack_bound_bytes"},
        {"cycles a step", "cycles_per_step_est"},
        {"worst step", "cycles_worst_step_max"},
        {"last step", "cycles_last_step_est"},
    };
    const auto ladders = tumble::bench::ladders_of(rows);
    const auto ladder = std::find_if(ladders.begin(), ladders.end(), [&](const tumble::bench::Ladder& each) {
        return each.core == core && each.numbers == numbers;
    });
    if (ladder == ladders.end()) throw std::runtime_error{"no feature ladder of " + core + " " + numbers};
    Table table;
    table.head = {ladder->name()};
    for (const auto& [name, key] : columns) table.head.emplace_back(name);
    const auto add = [&](const std::string& feature, const auto& cell) {
        std::vector<std::string> line{feature};
        for (const auto& [name, key] : columns) line.push_back(cell(key));
        table.rows.push_back(line);
    };
    const auto total = [](const Row& row) {
        return [&row](const char* key) {
            return row.contains(key) ? std::to_string(std::llround(row.at(key).get<double>())) : "-";
        };
    };
    add(ladder->feature(0), total(ladder->rungs.front()));
    for (std::size_t i = 1; i < ladder->rungs.size(); ++i) {
        const Row &below = ladder->rungs[i - 1], &rung = ladder->rungs[i];
        add(ladder->feature(i), [&](const char* key) -> std::string {
            if (!rung.contains(key) || !below.contains(key)) return "-";
            const long long more = std::llround(rung.at(key).get<double>()) - std::llround(below.at(key).get<double>());
            return (more > 0 ? "+" : "") + std::to_string(more);
        });
    }
    add("all of them", total(ladder->rungs.back()));
    return table;
}

// The error of a row of work against precision, in its problem's own unit.
double error_of(const Row& row) {
    return row.at(row.contains("position_error_m") ? "position_error_m" : "orientation_error_rad").get<double>();
}

// The cheapest way to stay below an error, beside what Boost.Odeint's RK4 in float costs for it. A simulated second is
// estimated cycles where the core has a timing table.
Table front_table(const std::vector<Row>& rows, const char* error_name) {
    Table table;
    table.head = {"problem", error_name, "core", "the cheapest", "a simulated s", "worst step", "Odeint RK4, float"};
    const auto scene_of = [](const Row& r) { return r.at("scene").get<std::string>(); };
    for (const auto& scene : distinct(rows, scene_of)) {
        for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8}) {
            for (const auto& core : cores_of(rows)) {
                if (core == "host") continue;
                const Row *best = nullptr, *plain = nullptr;
                bool peer_ran = false;
                std::optional<bool> unit;
                for (const Row& row : rows) {
                    if (scene_of(row) != scene || row.at("core") != core) continue;
                    const bool is_peer = row.at("integrator") == "odeint_rk4" && row.at("numbers") == "f32";
                    peer_ran = peer_ran || is_peer;
                    const bool in_cycles = cost_of_simulated_second(row).in_cycles;
                    if (unit.value_or(in_cycles) != in_cycles)
                        throw std::runtime_error{scene + ", " + core + ": some rows have cycles and some have none"};
                    unit = in_cycles;
                    if (row.contains("failure") || error_of(row) > tolerance) continue;
                    const bool is_ours = !integrator_of(row).starts_with("odeint_");
                    const auto is_cheaper = [&](const Row* than) {
                        return than == nullptr ||
                               cost_of_simulated_second(row).expected < cost_of_simulated_second(*than).expected;
                    };
                    if (is_ours && is_cheaper(best)) best = &row;
                    if (is_peer && is_cheaper(plain)) plain = &row;
                }
                const auto number = [&](const Row* row) {
                    return row == nullptr ? "not reached" : cost_of_simulated_second(*row).text();
                };
                char text[16];
                std::snprintf(text, sizeof text, "%.0e", tolerance);
                table.rows.push_back(
                    {scene, text, core,
                     best == nullptr ? "none"
                                     : "`" + integrator_of(*best) + "` " + numbers_of(*best) + ", 1/" +
                                           std::to_string(std::lround(1 / best->at("step_s").get<double>())) + " s",
                     number(best), best == nullptr ? "-" : text_of(*best, "cycles_worst_step_max"),
                     peer_ran ? number(plain) : "-"});
            }
        }
    }
    return table;
}

// Of a row, what `cell` says, or where it failed.
std::string unless_it_failed(const Row& row, const auto& cell) {
    const auto step = row.find("failure_step");
    return step == row.end() ? cell(row) : "fails at step " + step->dump();
}

// What a method does to what its problem conserves: a line an integrator, columns for each number system.
Table long_run_table(const std::vector<Row>& rows, const std::string& scene,
                     const std::vector<std::pair<const char*, const char*>>& columns) {
    const std::vector<std::string> systems = {"q32 carry", "f32 plain", "f64"};
    Table table;
    table.head = {scene};
    for (const auto& [key, name] : columns)
        for (const auto& n : systems) table.head.push_back(std::string{name} + ", " + n);
    for (const auto& m : distinct(rows, integrator_of)) {
        std::vector<std::string> line{"`" + m + "`"};
        for (const auto& [key, name] : columns) {
            for (const auto& n : systems) {
                const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
                    return r.at("scene") == scene && integrator_of(r) == m && numbers_of(r) == n;
                });
                line.push_back(found == rows.end() ? "-" : unless_it_failed(*found, [&](const Row& r) {
                    return text_of(r, key);
                }));
            }
        }
        table.rows.push_back(line);
    }
    return table;
}

// Long runs: a line a scene and method, of each number system what `cell` says of the row.
Table long_runs_table(const std::vector<Row>& rows, const std::vector<std::string>& systems, const auto& cell) {
    Table table;
    table.head = {"scene", "integrator", "steps"};
    for (const std::string& n : systems) table.head.push_back(n);
    const auto line_of = [](const Row& r) {
        return std::vector<std::string>{r.at("scene"), "`" + integrator_of(r) + "`", text_of(r, "steps")};
    };
    for (const Row& row : rows) {
        const auto first = line_of(row);
        const auto is_of = [&](const std::vector<std::string>& line) {
            return std::equal(first.begin(), first.end(), line.begin());
        };
        if (std::any_of(table.rows.begin(), table.rows.end(), is_of)) continue;
        std::vector<std::string> line = first;
        bool any = false;
        for (const std::string& n : systems) {
            const auto found = std::find_if(rows.begin(), rows.end(),
                                            [&](const Row& r) { return line_of(r) == first && numbers_of(r) == n; });
            line.push_back(found == rows.end() ? "-" : unless_it_failed(*found, cell));
            any = any || line.back() != "-";
        }
        if (any) table.rows.push_back(line);
    }
    return table;
}
// The largest errors of the energy in the first and in the last tenth.
std::string energy_of_tenths(const Row& row) {
    return text_of(row, "energy_first_tenth") + ", " + text_of(row, "energy_last_tenth");
}
// The largest of what a row has of momentum or penetration.
std::string largest_besides_energy(const Row& row) {
    double largest = 0;
    for (const Row& value : row.at(row.contains("momentum") ? "momentum" : "penetration_m"))
        largest = std::max(largest, value.get<double>());
    return tumble::bench::text("%.1e", largest);
}

// The largest error of a system of equations at some steps.
Table ordinary_table(const std::vector<Row>& rows, const std::string& scene, const std::vector<int>& exponents) {
    Table table;
    table.head = {scene};
    for (const int n : exponents) table.head.push_back("1/" + std::to_string(1 << n) + " s");
    table.head.push_back("order");
    for (const auto& system : {"q32 carry", "f32 plain", "f64"}) {
        for (const auto& m : distinct(rows, integrator_of)) {
            std::vector<std::string> line{"`" + m + "` " + system};
            std::vector<double> orders;
            for (const Row& row : rows) {
                if (row.at("scene") != scene || integrator_of(row) != m || numbers_of(row) != system) continue;
                for (const int n : exponents) {
                    if (row.at("step_s").get<double>() == std::ldexp(1.0, -n))
                        line.push_back(row.contains("failure") ? "fails" : text_of(row, "state_error"));
                }
                if (row.contains("observed_order")) orders.push_back(row.at("observed_order"));
            }
            char text[16] = "-";
            if (const auto order = tumble::bench::median_order(orders))
                std::snprintf(text, sizeof text, "%.1f", *order);
            line.emplace_back(text);
            table.rows.push_back(line);
        }
    }
    return table;
}

// All engines with all their ways to step; of this kernel the methods that a reader would choose between.
Table engines_table(const std::vector<Row>& rows) {
    Table table;
    table.head = {"engine",
                  "method",
                  "numbers",
                  "orientation error, rad",
                  "within 0.1 rad for, s",
                  "energy drift",
                  "insn per step, x86-64"};
    const std::vector<std::string> own = {"semi_implicit_euler", "rk4", "verlet", "suzuki4", "pdmv6", "exact"};
    for (const Row& row : rows) {
        const std::string engine = row.at("engine"), version = row.at("version"), method = integrator_of(row);
        if (engine == "tumble" && std::find(own.begin(), own.end(), method) == own.end()) continue;
        table.rows.push_back({engine + (version.empty() ? "" : " " + version),
                              engine == "tumble" ? "`" + method + "`" : method, numbers_of(row),
                              text_of(row, "orientation_error_rad"),
                              std::to_string(std::lround(row.at("within_100_mrad_s").get<double>())),
                              text_of(row, "energy_max_relative_drift"), text_of(row, "insn_per_step")});
    }
    return table;
}

// A ratio of times: two digits, or all before the point.
std::string ratio_text(double ratio) {
    char text[32];
    std::snprintf(text, sizeof text, ratio < 9.95 ? "%.2g" : "%.0f", ratio);
    return text;
}
std::string ratio_to(const Row* row, const std::string& engine) {
    if (row == nullptr || !row->contains("time_ratios") || !row->at("time_ratios").contains(engine)) return "-";
    return ratio_text(row->at("time_ratios").at(engine).get<double>());
}
std::string name_of_engine(const Row& row) {
    const std::string version = row.at("version");
    return row.at("engine").get<std::string>() + (version.empty() ? "" : " " + version) + ", " + integrator_of(row) +
           ", " + numbers_of(row);
}

// The host's problems of one size: how far this kernel's answers are from the truth, and its time as a multiple of each
// engine's, whose answer's error stands beside it.
Table host_table(const tumble::bench::HostRows& rows) {
    struct Variant {
        const char *numbers, *method;
    };
    constexpr Variant variants[]{{"q32 carry", "verlet"}, {"q32 carry", "rk4"}, {"f32 plain", "verlet"},
                                 {"f32 plain", "rk4"},    {"f64", "verlet"},    {"f64", "rk4"}};
    Table table;
    table.head = {"problem", "time, divided by that of", "its error, m"};
    for (const Variant& v : variants) table.head.push_back("`" + std::string{v.method} + "` " + v.numbers);
    for (const std::string& scene : rows.scenes(false)) {
        const int bodies = rows.sizes(scene).front();
        std::vector<std::string> errors{scene, "errors of this kernel, m", ""};
        for (const Variant& v : variants) {
            const Row* own = rows.kernel(scene, bodies, v.numbers, v.method);
            errors.push_back(own == nullptr ? "-" : text_of(*own, "position_error_m"));
        }
        table.rows.push_back(errors);
        for (const std::string& engine : rows.engines(scene)) {
            const Row& peer = *rows.fastest(scene, bodies, engine);
            std::vector<std::string> line{"", name_of_engine(peer),
                                          peer.contains("failure") ? "wrong" : text_of(peer, "position_error_m")};
            for (const Variant& v : variants)
                line.push_back(ratio_to(rows.kernel(scene, bodies, v.numbers, v.method), engine));
            table.rows.push_back(line);
        }
    }
    return table;
}

// Many bodies: the time of the default method in each number system as a multiple of each engine's.
constexpr const char* host_numbers[]{"q32 carry", "f32 plain", "f64"};
Table host_many_table(const tumble::bench::HostRows& rows) {
    Table table;
    table.head = {"q32 carry / f32 plain / f64", "time, divided by that of"};
    for (const int bodies : rows.sizes()) table.head.push_back(std::to_string(bodies));
    for (const std::string& scene : rows.scenes(true)) {
        for (const std::string& engine : rows.engines(scene)) {
            std::vector<std::string> line{scene, engine};
            for (const int bodies : rows.sizes()) {
                std::string cell;
                for (const char* numbers : host_numbers) {
                    const std::string ratio = ratio_to(rows.kernel(scene, bodies, numbers, "verlet"), engine);
                    cell += (cell.empty() ? "" : " / ") + ratio;
                }
                line.push_back(cell == "- / - / -" ? "-" : cell);
            }
            table.rows.push_back(line);
        }
    }
    return table;
}

// The time of a body's step as a multiple of that of one body alone: this kernel's, and each engine's fastest.
Table host_growth_table(const tumble::bench::HostRows& rows) {
    Table table;
    table.head = {"time a body, divided by that of one", "whose"};
    for (const int bodies : rows.sizes()) table.head.push_back(std::to_string(bodies));
    for (const std::string& scene : rows.scenes(true)) {
        const auto add = [&](const std::string& name, auto&& row_of) {
            std::vector<std::string> line{scene, name};
            for (const int bodies : rows.sizes()) {
                const Row *one = row_of(1), *row = row_of(bodies);
                const char* time = tumble::bench::HostRows::time;
                const bool known = one != nullptr && row != nullptr && one->contains(time) && row->contains(time);
                line.push_back(known ? ratio_text(row->at(time).get<double>() / one->at(time).get<double>()) : "-");
            }
            table.rows.push_back(line);
        };
        for (const char* numbers : host_numbers)
            add(std::string{"tumble "} + numbers,
                [&](int bodies) { return rows.kernel(scene, bodies, numbers, "verlet"); });
        for (const std::string& engine : rows.engines(scene))
            add(engine, [&](int bodies) { return rows.fastest(scene, bodies, engine); });
    }
    return table;
}

// The cores that firmware is built for: rows of port/boards.txt.
Table boards_table(const std::filesystem::path& file) {
    Table table;
    table.head = {
        "core", "port", "machine and CPU", "counts", "model of its cycles", "tested by", "compiler's options"};
    std::ifstream boards{file};
    for (std::string line; std::getline(boards, line);) {
        std::istringstream row{line};
        std::string core, port, machine, clock, counter, flash, ram, stack, timing, set, numbers, flags;
        if (!(row >> core) || core.starts_with("#")) continue;
        row >> port >> machine >> clock >> counter >> flash >> ram >> stack >> timing >> set >> numbers >> std::ws;
        if (!std::getline(row, flags)) throw std::runtime_error{file.string() + ": too few columns for " + core};
        table.rows.push_back({core, port, machine, counter.substr(0, counter.find(':')), timing,
                              set == "quick" ? "make test" : "make check", "`" + flags + "`"});
    }
    if (table.rows.empty()) throw std::runtime_error{"no core in " + file.string()};
    return table;
}

// What the default integrator costs on every core: the front page's first answer.
Table cores_table(const std::vector<Row>& rows) {
    Table table;
    table.head = {"core",       "a step, q32",        "worst",    "a step, plain float", "worst",
                  "flash, q32", "flash, plain float", "RAM, q32", "RAM, plain float"};
    for (const auto& core : cores_of(rows)) {
        const auto find = [&](const char* numbers) {
            const Row* row = find_row(rows, core, tumble::integrators::Verlet::name, numbers);
            if (row == nullptr) throw std::runtime_error{std::string{"no row of "} + numbers + " on " + core};
            return row;
        };
        const Row *q32 = find("q32 carry"), *plain = find("f32 plain");
        const auto bytes = [&](const Row* row, const char* key) {
            return core == "host" ? "-" : text_of(*row, key) + " B";
        };
        table.rows.push_back({core, mean_of(q32), worst_of(q32), mean_of(plain), worst_of(plain),
                              bytes(q32, "text_bytes"), bytes(plain, "text_bytes"), bytes(q32, "ram_bytes"),
                              bytes(plain, "ram_bytes")});
    }
    return table;
}

// How many times as many estimated cycles a free body's step takes in one number system as in another: the least and
// the most over all methods that run in both. "-" where rows have no cycles.
std::string times_as_many(const std::vector<Row>& rows, const std::string& core, const std::string& dear,
                          const std::string& cheap) {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const auto& method : distinct(rows, integrator_of)) {
        const Row *a = find_row(rows, core, method, dear), *b = find_row(rows, core, method, cheap);
        if (a == nullptr || b == nullptr || !has_cycles(*a) || !has_cycles(*b)) continue;
        const double ratio = cost_of(*a).mean / cost_of(*b).mean;
        least = std::min(least, ratio);
        most = std::max(most, ratio);
    }
    if (most == 0) return "-";
    char text[32];
    std::snprintf(text, sizeof text, "%.1f to %.1f", least, most);
    return text;
}

// The orders of a method: with loads, and where it differs of a free rotation.
template <class Method>
std::string order_of() {
    std::string text = std::to_string(Method::order);
    if constexpr (requires { Method::free_order; }) {
        if (Method::free_order == tumble::no_truncation) text += ", free: exact";
        else if (Method::free_order != Method::order) text += ", free: " + std::to_string(Method::free_order);
    }
    return text;
}

// Every method: its orders, what a step needs, and what that of a free body costs.
Table integrators_table(const std::vector<Row>& rows) {
    Table table;
    table.head = {"integrator", "order", "a step needs", "cortex-m3, q32", "worst", "cortex-m4f, plain float", "worst"};
    tumble::Integrators::for_each([&]<class Method>() {
        const Row *m3 = find_row(rows, "cortex-m3", Method::name, "q32 carry"),
                  *m4f = find_row(rows, "cortex-m4f", Method::name, "f32 plain");
        std::string needs = "-";
        if constexpr (requires { Method::needs; }) needs = Method::needs;
        table.rows.push_back({std::string{"`"} + Method::name + "`", order_of<Method>(), needs, mean_of(m3),
                              worst_of(m3), mean_of(m4f), worst_of(m4f)});
    });
    return table;
}

// The range of a fixed-point quantity and the step between its values, at 1/256 s.
Table formats_table() {
    Table table;
    table.head = {"range preset", "position", "velocity", "spin"};
    const auto add = [&]<class R>(const char* name) {
        using N = tumble::Q32<R>;
        const tumble::Real step = tumble::Real{1} / tumble::Real{256}, half{tumble::Real::scaled(1, -1)};
        const auto scale = N::Scale::of(step, step * half);
        const auto cell = [](int range, const char* unit, double unit_in_last_place) {
            char text[64];
            std::snprintf(text, sizeof text, "±%d %s, to %.1e", range, unit, unit_in_last_place);
            return std::string{text};
        };
        const auto last = [](auto number) { return tumble::Real::scaled(1, -decltype(number)::fraction_bits); };
        const tumble::Real position = last(typename N::Position{}),
                           velocity = scale.metres(last(typename N::Drift{})) / step,
                           spin = scale.angle(last(typename N::Turn{})) / (step * half);
        table.rows.push_back({name, cell(R::position, "m", position.to_double()),
                              cell(R::velocity, "m/s", velocity.to_double()),
                              cell(R::spin, "rad/s", spin.to_double())});
    };
    tumble::Ranges::for_each([&]<class Entry>() { add.template operator()<typename Entry::Range>(Entry::name); });
    return table;
}

std::string short_text(double value, const char* format = "%.4g") {
    if (std::isinf(value)) return "any";
    char text[32];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

// How long a step each method takes, as its header states it.
Table stability_table() {
    Table table;
    table.head = {"method", "order", "spring, `h w` up to", "drag, `h c/m` up to", "spin in `q32` is"};
    tumble::Integrators::for_each([&]<class Method>() {
        const bool gains = Method::oscillation_limit == 0;
        const bool momentum = Method::spin == tumble::Spin::angular_momentum;
        table.rows.push_back({std::string{"`"} + Method::name + "`", std::to_string(Method::order),
                              gains ? "none, it gains energy" : short_text(Method::oscillation_limit),
                              short_text(Method::drag_limit),
                              requires { Method::not_in_fixed_point; } ? "not there" : momentum ? "L / I_middle" : "w"
});
});
return table;
}

// The smallest and the largest that fixed point holds in each range, by the step, s.
Table resolution_table(const std::vector<int>& steps_per_second) {
    Table table;
    table.head = {"range",
                  "step s",
                  "length m",
                  "speed m/s",
                  "spin rad/s",
                  "spin up to rad/s",
                  "change of speed in a step up to m/s"};
    tumble::Ranges::for_each([&]<class Entry>() {
        using N = tumble::Q32<typename Entry::Range>;
        for (const int n : steps_per_second) {
            const tumble::Real step = tumble::Real{1} / tumble::Real{n}, half = step * tumble::Real::scaled(1, -1);
            const auto scale = N::Scale::of(step, tumble::turn_per_spin(tumble::Spin::angular_velocity, step));
            const auto last = [](auto number) { return tumble::Real::scaled(1, -decltype(number)::fraction_bits); };
            const auto smallest = [](tumble::Real value) { return short_text(value.to_double(), "%.1e"); };
            table.rows.push_back({Entry::name, "1/" + std::to_string(n), smallest(last(typename N::Position{})),
                                  smallest(scale.metres(last(typename N::Drift{})) / step),
                                  smallest(scale.angle(last(typename N::Turn{})) / half),
                                  short_text((scale.angle(N::largest_turn) / half).to_double()),
                                  short_text((scale.metres(N::largest_drift) / step).to_double() / 4)});
        }
    });
    return table;
}

// Bounds of a contact step, as the headers state them.
struct Boxes : tumble::Scene {
    static constexpr tumble::Features features{
        .bodies = 2, .planes = 1, .pairs = true, .boxes = true, .friction = true};
};
Table bounds_table() {
    using Step = tumble::IslandStep<Boxes::Numbers, Boxes::Integrator::spin, Boxes::features>;
    Table table;
    table.head = {"bound", "of what", ""};
    const auto add = [&](const char* name, const char* what, int bound) {
        table.rows.push_back({name, what, std::to_string(bound)});
    };
    add("`IslandStep::max_impacts`", "impacts of an island's step that are resolved at their own time",
        Step::max_impacts);
    add("`IslandStep::max_resteps`", "flights redone to find one impact", Step::max_resteps);
    add("`IslandStep::max_crossings`", "pairs looked at because they may have passed through each other",
        Step::max_crossings);
    add("`contact::max_points`", "contact points of a pair", tumble::contact::max_points);
    add("`contact::max_sweeps`", "sweeps over the points of what rests", tumble::contact::max_sweeps);
    add("`contact::max_impact_sweeps`", "sweeps over the points of an impact", tumble::contact::max_impact_sweeps);
    add("`contact::max_rounds`", "rounds of impacts that pass from pair to pair at one moment",
        tumble::contact::max_rounds);
    return table;
}

// A figure of the rows of engines on the tests' top, by number system: the error of rk4 after 100 s.
std::string top_error(const std::vector<Row>& rows, const std::string& numbers) {
    for (const Row& row : rows)
        if (row.at("engine") == "tumble" && integrator_of(row) == tumble::integrators::Rk4::name &&
            numbers_of(row) == numbers)
            return text_of(row, "orientation_error_rad");
    throw std::runtime_error{"no row of rk4 in " + numbers};
}

// How far a body turns in a step at most, rad: what a world holds of one that spins faster, at a step of 1 s.
std::string largest_turn() {
    tumble::World<tumble::Scene> world{tumble::Seconds{1, 1}};
    tumble::BodySpec ball = tumble::sphere(1, 1);
    ball.angular_velocity = {1, 0, 0};
    const auto id = world.add(ball);
    if (!id || world.step().ok()) throw std::runtime_error{"1 rad in a step is within the numbers"};
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", world.angular_velocity(*id).x().to_real().to_double());
    return text;
}

std::string read_file(const std::filesystem::path& path) {
    std::ifstream in{path};
    if (!in) throw std::runtime_error{path.string() + ": cannot be read"};
    return {std::istreambuf_iterator<char>{in}, {}};
}

using Makers = std::map<std::string, std::function<std::string()>>;

// The page with what its marks name; adds the names to `used`.
std::string filled_in(const std::string& page, const std::string& text, const Makers& tables, const Makers& values,
                      std::set<std::string>& used) {
    std::string out;
    std::size_t at = 0;
    const std::string end = "<!-- end -->";
    while (true) {
        const std::size_t table = text.find("<!-- table ", at), value = text.find("<!-- value ", at);
        const std::size_t mark = std::min(table, value);
        if (mark == std::string::npos) break;
        const std::size_t close = text.find(" -->", mark), stop = text.find(end, mark);
        if (close == std::string::npos || stop == std::string::npos || text.find("<!-- ", close) != stop)
            throw std::runtime_error{page + ": a mark without its end: " + text.substr(mark, 40)};
        const std::size_t name_at = mark + std::string{"<!-- table "}.size();
        const std::string name = text.substr(name_at, close - name_at);
        const Makers& makers = mark == table ? tables : values;
        const auto found = makers.find(name);
        if (found == makers.end())
            throw std::runtime_error{page + ": there is no " + (mark == table ? "table" : "value") + " '" + name + "'"};
        used.insert(name);
        out += text.substr(at, close + 4 - at) + (mark == table ? "\n" : "") + found->second();
        at = stop;
    }
    return out + text.substr(at);
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
    const std::filesystem::path results = argv[first];
    const auto rows = [&](const char* name) { return tumble::bench::read_rows(results / name); };
    const Makers tables{
        {"boards", [&] { return boards_table(results / "../../port/boards.txt").markdown(); }},
        {"cores", [&] { return cores_table(rows("free.jsonl")).markdown(); }},
        {"free", [&] { return free_table(rows("free.jsonl"), true).markdown(); }},
        {"free_insn", [&] { return free_table(rows("free.jsonl"), false).markdown(); }},
        {"size", [&] { return size_table(rows("free.jsonl"), "cortex-m3").markdown(); }},
        {"integrators", [&] { return integrators_table(rows("free.jsonl")).markdown(); }},
        {"cube", [&] { return cube_table(rows("cube.jsonl")).markdown(); }},
        {"front", [&] { return front_table(rows("work_precision.jsonl"), "error below, rad").markdown(); }},
        {"front_loads",
         [&] { return front_table(rows("work_precision_loads.jsonl"), "error below, m or rad").markdown(); }},
        {"contacts", [&] { return contacts_table(rows("contacts.jsonl")).markdown(); }},
        {"skipped", [&] { return skipped_table(rows("contacts.jsonl")).markdown(); }},
        {"ladder_cortex_m0", [&] { return ladder_table(rows("ladder.jsonl"), "cortex-m0", "q32 carry").markdown(); }},
        {"ladder_cortex_m3", [&] { return ladder_table(rows("ladder.jsonl"), "cortex-m3", "q32 carry").markdown(); }},
        {"ladder_cortex_m4f", [&] { return ladder_table(rows("ladder.jsonl"), "cortex-m4f", "q32 carry").markdown(); }},
        {"ladder_cortex_m4f_float",
         [&] { return ladder_table(rows("ladder.jsonl"), "cortex-m4f", "f32 plain").markdown(); }},
        {"long_run_free",
         [&] {
             return long_run_table(
                        rows("long_run.jsonl"), "generic top",
                        {{"energy_max_relative_drift", "energy"}, {"world_momentum_max_relative_drift", "momentum"}})
                 .markdown();
         }},
        {"long_run_heavy",
         [&] {
             return long_run_table(rows("long_run.jsonl"), "heavy top",
                                   {{"energy_max_relative_drift", "energy"},
                                    {"vertical_momentum_max_relative_drift", "vertical momentum"}})
                 .markdown();
         }},
        {"long_runs_energy",
         [&] {
             return long_runs_table(rows("long_run_series.jsonl"), {"q32 carry", "f32 plain", "f64"}, energy_of_tenths)
                 .markdown();
         }},
        {"long_runs_besides",
         [&] {
             return long_runs_table(rows("long_run_series.jsonl"), {"q32 carry", "f32 plain", "f64"},
                                    largest_besides_energy)
                 .markdown();
         }},
        {"oscillator",
         [&] {
             return ordinary_table(rows("ordinary.jsonl"), "harmonic oscillator", {2, 4, 6, 8, 10}).markdown();
         }},
        {"lorenz",
         [&] {
             return ordinary_table(rows("ordinary.jsonl"), "Lorenz system", {6, 8, 10, 12}).markdown();
         }},
        {"host", [&] { return host_table(tumble::bench::HostRows{rows("host.jsonl")}).markdown(); }},
        {"host_many", [&] { return host_many_table(tumble::bench::HostRows{rows("host.jsonl")}).markdown(); }},
        {"host_growth", [&] { return host_growth_table(tumble::bench::HostRows{rows("host.jsonl")}).markdown(); }},
        {"engines", [&] { return engines_table(rows("engines.jsonl")).markdown(); }},
        {"formats", [] { return formats_table().markdown(); }},
        {"bounds", [] { return bounds_table().markdown(); }},
        {"stability", [] { return stability_table().markdown(); }},
        {"resolution",
         [] {
             return resolution_table({64, 256, 1024}).markdown();
         }},
    };
    const auto ratio = [&](const char* core, const char* dear, const char* cheap) {
        return [=, &rows] { return times_as_many(rows("free.jsonl"), core, dear, cheap); };
    };
    const Makers values{
        {"float_on_m0", ratio("cortex-m0", "f32 plain", "q32 carry")},
        {"float_on_m3", ratio("cortex-m3", "f32 plain", "q32 carry")},
        {"q32_on_m4f", ratio("cortex-m4f", "q32 carry", "f32 plain")},
        {"q32_on_m4f_both_carry", ratio("cortex-m4f", "q32 carry", "f32 carry")},
        {"top_error_q32", [&] { return top_error(rows("engines.jsonl"), "q32 carry"); }},
        {"top_error_f32", [&] { return top_error(rows("engines.jsonl"), "f32 plain"); }},
        {"max_bodies", [] { return std::to_string(tumble::host::max_bodies); }},
        {"max_planes", [] { return std::to_string(tumble::host::max_planes); }},
        {"max_springs", [] { return std::to_string(tumble::host::max_springs); }},
        {"max_near_pairs", [] { return std::to_string(tumble::host::max_near_pairs); }},
        {"largest_turn_q32", [] { return largest_turn(); }},
        {"abort_status", [] { return std::to_string(tumble::port::abort_status); }},
        {"text_lost_status", [] { return std::to_string(tumble::port::text_lost_status); }},
        {"no_counter_status", [] { return std::to_string(tumble::port::no_counter_status); }},
    };
    std::set<std::string> used;
    bool drifted = false;
    for (int i = first + 1; i < argc; ++i) {
        const std::string page = argv[i], now = read_file(page), wanted = filled_in(page, now, tables, values, used);
        if (now == wanted) continue;
        if (check) {
            std::cerr << page << ": its tables are not what " << results.string() << " says; run `make tables`\n";
            drifted = true;
        } else {
            tumble::host::write_file(page, wanted);
        }
    }
    // With all pages given, what none of them shows is dead.
    for (const Makers* makers : {&tables, &values})
        for (const auto& [name, maker] : *makers)
            if (check && !used.contains(name)) {
                std::cerr << "'" << name << "' is in no page\n";
                drifted = true;
            }
    // What long runs promise.
    if (check)
        for (const std::string& promise : tumble::bench::broken_promises(rows("long_run_series.jsonl"))) {
            std::cerr << "broken in long_run_series.jsonl: " << promise << '\n';
            drifted = true;
        }
    return drifted ? 1 : 0;
} catch (const std::exception& error) {
    std::cerr << "tumble_tables: " << error.what() << '\n';
    return 1;
}
