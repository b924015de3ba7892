// Pages whose marks `<!-- table NAME -->` and `<!-- value NAME -->` are filled from result rows.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "table.hpp"

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
        if (maker == makers.end()) throw std::runtime_error{page + ": there is no " + name};
        used.insert(name);
        out += text.substr(at, close + 4 - at) + maker->second(results);
        at = stop;
    }
    return out + text.substr(at);
}

}  // namespace tumble::bench
