// Result rows: one JSON object a line, with the keys that every tool shares (units in the names).
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

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

inline void write_rows(const std::filesystem::path& path, const std::vector<Row>& rows) {
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    std::ofstream out{path};
    for (const Row& row : rows) out << row.dump() << '\n';
    if (!out) throw std::runtime_error{path.string() + ": cannot be written"};
}

}  // namespace tumble::bench
