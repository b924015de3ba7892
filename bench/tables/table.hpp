// Tables of Markdown from result rows: which rows a line and a column are of, and how a cell is written.
#pragma once

#include <algorithm>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "pictures/drawing.hpp"
#include "rows/rows.hpp"

namespace tumble::bench {

using Rows = std::vector<Row>;
using Strings = std::vector<std::string>;

struct Table {
    Strings head;
    std::vector<Strings> lines;

    [[nodiscard]] std::string markdown() const {
        std::ostringstream out;
        const auto write = [&](const Strings& cells) {
            for (const std::string& cell : cells) out << "| " << cell << ' ';
            out << "|\n";
        };
        write(head);
        for (std::size_t i = 0; i < head.size(); ++i) out << (i == 0 ? "|---" : "|---:");
        out << "|\n";
        for (const Strings& line : lines) write(line);
        return out.str();
    }
    // Behind the mark of a page: on lines of its own.
    operator std::string() const { return "\n" + markdown(); }
};

// The value of a key as text: "numbers" with its carry, "q32 carry"; a float with two digits; "-" where there is none.
[[nodiscard]] inline std::string text_of(const Row& row, const std::string& key) {
    if (key == "numbers") return numbers_of(row);
    if (!row.contains(key) || row.at(key).is_null()) return "-";
    const Row& value = row.at(key);
    if (value.is_number_float()) return text("%.1e", value.get<double>());
    return value.is_string() ? value.get<std::string>() : value.dump();
}

// Rows with these values.
using Where = std::vector<std::pair<std::string, std::string>>;
[[nodiscard]] inline bool is_where(const Row& row, const Where& where) {
    return std::all_of(where.begin(), where.end(), [&](const auto& w) { return text_of(row, w.first) == w.second; });
}
// The first of them; null where there is none.
[[nodiscard]] inline const Row* find(const Rows& rows, const Where& where) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) { return is_where(row, where); });
    return found == rows.end() ? nullptr : &*found;
}
// The values of a key in the order of their first rows.
[[nodiscard]] inline Strings distinct(const Rows& rows, const std::string& key, const Where& where = {}) {
    Strings values;
    for (const Row& row : rows)
        if (const std::string value = text_of(row, key);
            is_where(row, where) && std::find(values.begin(), values.end(), value) == values.end())
            values.push_back(value);
    return values;
}

using Cell = std::function<std::string(const Row&)>;
[[nodiscard]] inline Cell value(const std::string& key) {
    return [key](const Row& row) { return text_of(row, key); };
}
[[nodiscard]] inline std::string in_code(const std::string& name) { return "`" + name + "`"; }
[[nodiscard]] inline std::string method(const Row& row) { return in_code(row.at("integrator")); }

[[nodiscard]] inline std::string engine_name(const Row& row) {
    const std::string version = row.at("version");
    return row.at("engine").get<std::string>() + (version.empty() ? "" : " " + version);
}
// The number systems that tables compare.
inline const Strings systems{"q32 carry", "f32 plain", "f64"};

struct Line {
    Strings first;  // cells
    Where where = {};
};
struct Column {
    std::string head;
    Cell cell;
    Where where = {};
};

// A line for each of the rows.
[[nodiscard]] inline Table list(const Rows& rows, const Where& where, const std::vector<Column>& columns) {
    Table table;
    for (const Column& column : columns) table.head.push_back(column.head);
    for (const Row& row : rows) {
        if (!is_where(row, where)) continue;
        Strings cells;
        for (const Column& column : columns) cells.push_back(column.cell(row));
        table.lines.push_back(cells);
    }
    return table;
}

// A cell for the first row that is of its line and of its column, "-" where there is none. `head` is of the lines'
// first cells. A line without rows is left out.
[[nodiscard]] inline Table cross(const Rows& rows, const Strings& head, const std::vector<Line>& lines,
                                 const std::vector<Column>& columns) {
    Table table{head, {}};
    for (const Column& column : columns) table.head.push_back(column.head);
    for (const Line& line : lines) {
        Strings cells = line.first;
        bool has_row = false;
        for (const Column& column : columns) {
            Where where = line.where;
            where.insert(where.end(), column.where.begin(), column.where.end());
            const Row* row = find(rows, where);
            has_row = has_row || row != nullptr;
            cells.push_back(row == nullptr ? "-" : column.cell(*row));
        }
        if (has_row) table.lines.push_back(cells);
    }
    return table;
}

}  // namespace tumble::bench
