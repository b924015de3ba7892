// Writes the README's tables from result rows, so that they cannot drift from what was measured: everything between
// `<!-- table NAME -->` and `<!-- end -->` is replaced. With --check nothing is written, and a difference is an error.
#include "rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <sstream>

namespace {

using tumble::bench::numbers_of, tumble::bench::Row;

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

// One line an integrator; a column for each core and number system.
Table cost_table(const std::vector<Row>& rows, const std::vector<std::string>& numbers) {
    const auto method = [](const Row& r) { return r.at("integrator").get<std::string>(); };
    Table table;
    table.head = {"insn per step"};
    const auto cores = cores_of(rows);
    for (const auto& n : numbers) {
        for (const auto& c : cores) table.head.push_back(c + " " + n);
    }
    for (const auto& m : distinct(rows, method)) {
        std::vector<std::string> line{"`" + m + "`"};
        for (const auto& n : numbers) {
            for (const auto& c : cores) {
                const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
                    return method(r) == m && r.at("core") == c && numbers_of(r) == n;
                });
                line.push_back(found == rows.end() ? "-" : text_of(*found, "insn_per_step"));
            }
        }
        table.rows.push_back(line);
    }
    return table;
}

Table size_table(const std::vector<Row>& rows, const std::string& core) {
    Table table;
    table.head = {core,          "numbers",     "text bytes",    "RAM bytes",
                  "world bytes", "stack bytes", "insn per step", "worst step"};
    for (const Row& row : rows) {
        if (row.at("core") != core) continue;
        table.rows.push_back({"`" + row.at("integrator").get<std::string>() + "`", numbers_of(row),
                              text_of(row, "text_bytes"), text_of(row, "ram_bytes"), text_of(row, "world_bytes"),
                              text_of(row, "stack_bytes"), text_of(row, "insn_per_step"),
                              text_of(row, "insn_per_step_max")});
    }
    return table;
}

// The dissertation's cube: what each of its methods costs beside what it gets wrong.
Table cube_table(const std::vector<Row>& rows) {
    Table table;
    const auto cores = cores_of(rows);
    table.head = {"cube, q32 carry", "position error, m", "orientation error, rad"};
    for (const auto& c : cores) table.head.push_back("insn, " + c);
    for (const std::string method : {"explicit_euler", "implicit_euler", "heun", "midpoint", "rk4", "verlet"}) {
        std::vector<std::string> line{"`" + method + "`"};
        bool first = true;
        for (const auto& c : cores) {
            for (const Row& row : rows) {
                if (row.at("integrator") != method || row.at("core") != c || numbers_of(row) != "q32 carry") continue;
                if (first) {
                    line.push_back(text_of(row, "position_error_m"));
                    line.push_back(text_of(row, "orientation_error_rad"));
                    first = false;
                }
                line.push_back(text_of(row, "insn_per_step"));
            }
        }
        table.rows.push_back(line);
    }
    return table;
}

// What a contact scene costs, core by core.
Table contacts_table(const std::vector<Row>& rows) {
    Table table;
    table.head = {"scene", "core", "numbers", "insn per step", "last step", "worst step", "text bytes", "RAM bytes"};
    for (const Row& row : rows) {
        table.rows.push_back({row.at("scene").get<std::string>(), row.at("core").get<std::string>(), numbers_of(row),
                              text_of(row, "insn_per_step"), text_of(row, "insn_per_step_last"),
                              text_of(row, "insn_per_step_max"), text_of(row, "text_bytes"),
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
    table.head = {"not paid for", "core", "insn per step", "text bytes"};
    for (const Pair& pair : pairs) {
        for (const auto& core : cores_of(rows)) {
            const Row without = find(pair.without, core), with = find(pair.with, core);
            const auto saved = [&](const char* key) {
                return std::to_string(with.at(key).get<long>() - without.at(key).get<long>());
            };
            table.rows.push_back({pair.what, core, saved("insn_per_step_last"), saved("text_bytes")});
        }
    }
    return table;
}

// The error of a row of work against precision, in its problem's own unit.
double error_of(const Row& row) {
    return row.at(row.contains("position_error_m") ? "position_error_m" : "orientation_error_rad").get<double>();
}

// The cheapest way to stay below an error, beside what Boost.Odeint's RK4 in float costs for it.
Table front_table(const std::vector<Row>& rows, const char* error_name) {
    Table table;
    std::vector<std::string> cores;
    for (const auto& core : cores_of(rows))
        if (core == "cortex-m3" || core == "cortex-m4f") cores.push_back(core);
    table.head = {"problem", error_name};
    for (const auto& core : cores) {
        table.head.push_back("cheapest on " + core);
        table.head.push_back("insn per simulated s");
        table.head.push_back("Odeint RK4, float");
    }
    const auto scene_of = [](const Row& r) { return r.at("scene").get<std::string>(); };
    for (const auto& scene : distinct(rows, scene_of)) {
        for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8}) {
            char text[16];
            std::snprintf(text, sizeof text, "%.0e", tolerance);
            std::vector<std::string> line{scene, text};
            for (const auto& core : cores) {
                const Row *best = nullptr, *plain = nullptr;
                const auto cost = [](const Row& r) { return r.at("insn_per_simulated_second").get<double>(); };
                bool peer_ran = false;
                for (const Row& row : rows) {
                    if (scene_of(row) != scene || row.at("core") != core) continue;
                    const bool is_peer = row.at("integrator") == "odeint_rk4" && row.at("numbers") == "f32";
                    peer_ran = peer_ran || is_peer;
                    if (row.contains("failure") || error_of(row) > tolerance) continue;
                    const bool is_ours = !row.at("integrator").get<std::string>().starts_with("odeint_");
                    if (is_ours && (best == nullptr || cost(row) < cost(*best))) best = &row;
                    if (is_peer && (plain == nullptr || cost(row) < cost(*plain))) plain = &row;
                }
                const auto number = [&](const Row* row) {
                    if (row == nullptr) return std::string{"not reached"};
                    char digits[32];
                    std::snprintf(digits, sizeof digits, "%.0f", cost(*row));
                    return std::string{digits};
                };
                line.push_back(best == nullptr
                                   ? "none"
                                   : "`" + best->at("integrator").get<std::string>() + "` " + numbers_of(*best) +
                                         ", 1/" + std::to_string(std::lround(1 / best->at("step_s").get<double>())) +
                                         " s");
                line.push_back(number(best));
                line.push_back(peer_ran ? number(plain) : "-");
            }
            table.rows.push_back(line);
        }
    }
    return table;
}

std::string integrator_of(const Row& row) { return row.at("integrator").get<std::string>(); }

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
                if (found == rows.end()) line.push_back("-");
                else if (found->contains("failure"))
                    line.push_back("fails at step " + std::to_string(found->at("failure_step").get<long>()));
                else line.push_back(text_of(*found, key));
            }
        }
        table.rows.push_back(line);
    }
    return table;
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

std::string read_file(const std::filesystem::path& path) {
    std::ifstream in{path};
    if (!in) throw std::runtime_error{path.string() + ": cannot be read"};
    return {std::istreambuf_iterator<char>{in}, {}};
}

std::string with_tables(const std::string& text, const std::map<std::string, std::string>& tables) {
    std::string out;
    std::size_t at = 0;
    const std::string begin = "<!-- table ", end = "<!-- end -->";
    while (true) {
        const std::size_t mark = text.find(begin, at);
        if (mark == std::string::npos) break;
        const std::size_t close = text.find(" -->", mark), stop = text.find(end, mark);
        if (close == std::string::npos || stop == std::string::npos)
            throw std::runtime_error{"README: a table mark without its end"};
        const std::string name = text.substr(mark + begin.size(), close - mark - begin.size());
        const auto found = tables.find(name);
        if (found == tables.end()) throw std::runtime_error{"README: no rows for table '" + name + "'"};
        out += text.substr(at, close + 4 - at) + "\n" + found->second;
        at = stop;
    }
    return out + text.substr(at);
}

}  // namespace

int main(int argc, char** argv) try {
    const bool check = argc > 1 && std::string{argv[1]} == "--check";
    if (argc != (check ? 4 : 3)) {
        std::cerr << "usage: tumble_tables [--check] README.md RESULTS_DIRECTORY\n";
        return 2;
    }
    const std::filesystem::path readme = argv[check ? 2 : 1], results = argv[check ? 3 : 2];
    std::map<std::string, std::string> tables;
    const auto free = tumble::bench::read_rows(results / "free.jsonl");
    tables["free"] = cost_table(free, {"q32 carry", "f32 plain"}).markdown();
    tables["size"] = size_table(free, "cortex-m3").markdown();
    tables["cube"] = cube_table(tumble::bench::read_rows(results / "cube.jsonl")).markdown();
    tables["front"] =
        front_table(tumble::bench::read_rows(results / "work_precision.jsonl"), "error below, rad").markdown();
    if (const auto loads = results / "work_precision_loads.jsonl"; std::filesystem::exists(loads))
        tables["front_loads"] = front_table(tumble::bench::read_rows(loads), "error below, m or rad").markdown();
    if (const auto contacts = results / "contacts.jsonl"; std::filesystem::exists(contacts)) {
        const auto rows = tumble::bench::read_rows(contacts);
        tables["contacts"] = contacts_table(rows).markdown();
        tables["skipped"] = skipped_table(rows).markdown();
    }
    const auto long_run = tumble::bench::read_rows(results / "long_run.jsonl");
    tables["long_run_free"] =
        long_run_table(long_run, "generic top",
                       {{"energy_max_relative_drift", "energy"}, {"world_momentum_max_relative_drift", "momentum"}})
            .markdown();
    tables["long_run_heavy"] = long_run_table(long_run, "heavy top",
                                              {{"energy_max_relative_drift", "energy"},
                                               {"vertical_momentum_max_relative_drift", "vertical momentum"}})
                                   .markdown();
    const auto ordinary = tumble::bench::read_rows(results / "ordinary.jsonl");
    tables["oscillator"] = ordinary_table(ordinary, "harmonic oscillator", {2, 4, 6, 8, 10}).markdown();
    tables["lorenz"] = ordinary_table(ordinary, "Lorenz system", {6, 8, 10, 12}).markdown();
    tables["engines"] = engines_table(tumble::bench::read_rows(results / "engines.jsonl")).markdown();
    const std::string now = read_file(readme), wanted = with_tables(now, tables);
    if (now == wanted) return 0;
    if (check) {
        std::cerr << readme.string() << ": its tables are not what " << results.string()
                  << " says; run `make tables`\n";
        return 1;
    }
    std::ofstream{readme} << wanted;
    return 0;
} catch (const std::exception& error) {
    std::cerr << "tumble_tables: " << error.what() << '\n';
    return 1;
}
