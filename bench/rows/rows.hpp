// Result rows: one JSON object a line, with the keys that every tool shares (units in the names).
// Each row has the kernel's TUMBLE_BITS as `tumble_bits`. A row without it has bits 1.
#pragma once

#include <tumble/version.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/cost.hpp"
#include "scene/error.hpp"
#include "tools/output.hpp"
#include "tools/text.hpp"

namespace tumble::bench {

using Row = nlohmann::ordered_json;

[[nodiscard]] inline std::vector<Row> read_rows(const std::filesystem::path& path) {
    std::ifstream in{path};
    if (!in) throw std::runtime_error{path.string() + ": cannot be read"};
    std::vector<Row> rows;
    for (std::string line; std::getline(in, line);) {
        if (!line.empty()) rows.push_back(Row::parse(line));
    }
    return rows;
}

// The files of a command-line argument, for check_outputs().
[[nodiscard]] inline std::vector<host::FileArgument> files_of(const std::string& argument,
                                                              const std::vector<std::filesystem::path>& paths) {
    std::vector<host::FileArgument> files;
    for (const auto& path : paths) files.push_back({argument, path});
    return files;
}

// Opens the file of a program's rows at its start, so that an error is found before the work; makes missing
// directories.
[[nodiscard]] inline host::OutputFile rows_file(const std::filesystem::path& path) {
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    return host::OutputFile{path};
}

// Writes all rows or none; throws if they cannot be written.
inline void write_rows(host::OutputFile& file, const std::vector<Row>& rows) {
    for (Row row : rows) {
        row["tumble_bits"] = TUMBLE_BITS;
        file.stream() << row.dump() << '\n';
    }
    file.commit();
}
inline void write_rows(const std::filesystem::path& path, const std::vector<Row>& rows) {
    host::OutputFile file = rows_file(path);
    write_rows(file, rows);
}

// The keys that rows of a method on a scene begin with; the step in s.
[[nodiscard]] inline Row row_of(const std::string& scene, const std::string& core, const std::string& numbers,
                                bool carry, const std::string& integrator, double step) {
    return {{"scene", scene},           {"core", core},  {"numbers", numbers}, {"carry", carry},
            {"integrator", integrator}, {"step_s", step}};
}

// Those of a contender of an engine on the host.
[[nodiscard]] inline Row row_of_engine(const std::string& scene, const auto& contender, double step,
                                       std::int64_t steps) {
    return {{"scene", scene},
            {"core", "host"},
            {"engine", contender.engine},
            {"version", contender.version},
            {"integrator", contender.method},
            {"numbers", contender.numbers},
            {"carry", contender.carry},
            {"step_s", step},
            {"steps", steps}};
}

[[nodiscard]] inline std::string numbers_of(const Row& row) {
    return host::numbers_text(row.at("numbers"), row.at("carry"));
}

// The cost of a simulated second in a row of work against precision: estimated cycles with their range if the core has
// a timing table, otherwise instructions.
struct SecondCost {
    bool in_cycles = false;
    double expected = 0, least = 0, most = 0;

    [[nodiscard]] std::string text() const {
        return host::range_text(expected, least, most) + (in_cycles ? "" : " insn");
    }
};
[[nodiscard]] inline SecondCost cost_of_simulated_second(const Row& row) {
    if (!row.contains("cycles_per_simulated_second_est")) {
        const double insn = row.at("insn_per_simulated_second");
        return {false, insn, insn, insn};
    }
    return {true, row.at("cycles_per_simulated_second_est"), row.at("cycles_per_simulated_second_min"),
            row.at("cycles_per_simulated_second_max")};
}

// For the handler of a main: prints the exception on standard error and returns the exit status.
[[nodiscard]] inline int report_failure(const char* program) {
    try {
        throw;
    } catch (const host::SceneError& error) {
        std::cerr << error.what() << '\n';
        return 2;
    } catch (const std::invalid_argument& error) {
        std::cerr << program << ": " << error.what() << '\n';
        return 2;
    } catch (const std::exception& error) {
        std::cerr << program << ": " << error.what() << '\n';
        return 1;
    }
}

// From the errors before and after the step is halved, with two decimals.
[[nodiscard]] inline double observed_order(double before, double after) {
    return std::round(std::log2(before / after) * 100) / 100;
}
// The median of the observed orders above 0.5. Smaller ones come from too large a step or from rounding.
[[nodiscard]] inline std::optional<double> median_order(std::vector<double> orders) {
    std::erase_if(orders, [](double order) { return !(order > 0.5); });
    if (orders.empty()) return {};
    std::sort(orders.begin(), orders.end());
    return orders[orders.size() / 2];
}

}  // namespace tumble::bench
