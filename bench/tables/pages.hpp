// Pages whose marks `<!-- table NAME -->` and `<!-- value NAME -->` are filled from result rows.
#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>

#include "tables/table.hpp"

namespace tumble::bench {

// The files of rows, each read once.
class Results {
public:
    explicit Results(std::filesystem::path directory) : directory_(std::move(directory)) {}
    [[nodiscard]] const Rows& operator[](const std::string& name) const {
        const auto [file, is_new] = files_.try_emplace(name);
        if (is_new) file->second = read_rows(directory_ / (name + ".jsonl"));
        return file->second;
    }

private:
    std::filesystem::path directory_;
    mutable std::map<std::string, Rows> files_;
};

// The text after a mark, by the mark: "table cores", "value max_bodies".
using Makers = std::map<std::string, std::function<std::string(const Results&)>>;

[[nodiscard]] inline std::string read_file(const std::filesystem::path& path) {
    std::ifstream in{path};
    if (!in) throw std::runtime_error{path.string() + ": cannot be read"};
    return {std::istreambuf_iterator<char>{in}, {}};
}

// A number of a row, of which a page names file, key and values: "value free.world_bytes: core cortex-m3; numbers q32
// carry; integrator verlet". Empty where the name is of another form.
[[nodiscard]] inline std::string number_of_row(const std::string& name, const Results& results) {
    const std::string word = "value ";
    const std::size_t dot = name.find('.'), colon = name.find(": ");
    if (!name.starts_with(word) || dot == std::string::npos || colon == std::string::npos || dot > colon) return {};
    const std::string file = name.substr(word.size(), dot - word.size()), key = name.substr(dot + 1, colon - dot - 1);
    Where where;
    std::istringstream parts{name.substr(colon + 2)};
    for (std::string part; std::getline(parts >> std::ws, part, ';');) {
        const std::size_t blank = part.find(' ');
        if (blank == std::string::npos)
            throw std::runtime_error{name + ": expected a key and its value in '" + part + "'"};
        where.emplace_back(part.substr(0, blank), part.substr(blank + 1));
    }
    const Row* row = find(results[file], where);
    if (row == nullptr || !row->contains(key)) throw std::runtime_error{"there is no row with this number: " + name};
    const double number = row->at(key);
    return text(number < 100 && number != std::floor(number) ? "%.3g" : "%.0f", number);
}

// The page with the texts of the makers between its marks; adds their names to `used`.
[[nodiscard]] inline std::string filled_in(const std::string& page, const std::string& text, const Makers& makers,
                                           const Results& results, std::set<std::string>& used) {
    std::string out;
    std::size_t at = 0;
    while (true) {
        const std::size_t mark = std::min(text.find("<!-- table ", at), text.find("<!-- value ", at));
        if (mark == std::string::npos) break;
        const std::size_t close = text.find(" -->", mark), stop = text.find("<!-- end -->", mark);
        if (close == std::string::npos || stop == std::string::npos || text.find("<!-- ", close) != stop)
            throw std::runtime_error{page + ": a mark without its end: " + text.substr(mark, 40)};
        const std::size_t name_at = mark + std::string{"<!-- "}.size();
        const std::string name = text.substr(name_at, close - name_at);
        const auto maker = makers.find(name);
        const std::string number = maker == makers.end() ? number_of_row(name, results) : std::string{};
        if (maker == makers.end() && number.empty()) throw std::runtime_error{page + ": there is no " + name};
        used.insert(name);
        out += text.substr(at, close + 4 - at) + (number.empty() ? maker->second(results) : number);
        at = stop;
    }
    return out + text.substr(at);
}

}  // namespace tumble::bench
