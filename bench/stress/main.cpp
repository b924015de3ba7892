// Maps of stability: what becomes of scenes over step and another parameter, for every method and number system.
#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>
#include <map>

#include "stress/runner.hpp"

namespace {

using namespace tumble::bench;
namespace stress = tumble::bench::stress;
namespace fs = std::filesystem;

// "2/8": the second of eight.
struct Shard {
    std::size_t number = 1, count = 1;
};
Shard shard_of(const std::string& text) {
    Shard shard;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%zu/%zu%c", &shard.number, &shard.count, &rest) != 2 || shard.number < 1 ||
        shard.number > shard.count)
        throw std::invalid_argument{"--shard " + text + ": expected i/n with 1 <= i <= n"};
    return shard;
}

// The rows of the files in the order of one run; each row once, and of each map all or none.
std::vector<Row> merged(const std::vector<fs::path>& files) {
    const auto key = [](const Row& row) {
        return row.at("map").get<std::string>() + ", " + row.at("integrator").get<std::string>() + ", " +
               numbers_of(row);
    };
    std::map<std::string, Row> found;
    for (const fs::path& file : files) {
        for (const Row& row : read_rows(file)) {
            if (!row.contains("cells")) continue;
            const auto [place, is_new] = found.emplace(key(row), row);
            if (!is_new && place->second != row)
                throw std::runtime_error{file.string() + ": other cells for " + key(row) + " than a file before it"};
        }
    }
    std::vector<Row> rows;
    std::string missing;
    for (const stress::Job& job : stress::jobs_of({})) {
        const Row names = {{"map", job.map->name()},
                           {"integrator", job.integrator},
                           {"numbers", job.variant.numbers},
                           {"carry", job.variant.carry}};
        const auto row = found.find(key(names));
        if (row == found.end()) missing += "\n  " + key(names);
        else rows.push_back(row->second);
    }
    if (!missing.empty()) throw std::runtime_error{"rows are missing:" + missing};
    return rows;
}

// Counts and silent cells of rows with causes. Returns how many of these are silent without contacts.
std::size_t report(const std::vector<Row>& rows) {
    std::map<char, std::size_t> counts;
    std::size_t silent = 0, with_contacts = 0;
    for (const Row& row : rows) {
        const stress::Map& map = stress::map_named(row.at("map"));
        for (const char letter : row.at("cells").get<std::string>()) ++counts[letter];
        for (const Row& cell : row.at("silent_cells")) {
            const auto number = [&](const char* key) { return tumble::host::cpp_number(cell.at(key)); };
            const std::string x = number("x"), y = number("y");
            std::cout << "silent: " << map.name() << ' ' << x << ' ' << y << ' '
                      << row.at("integrator").get<std::string>() << ' ' << numbers_of(row) << ": "
                      << cell.at("cause").get<std::string>() << '\n';
            ++(map.has_contacts() ? with_contacts : silent);
        }
    }
    for (const stress::Outcome outcome : stress::all_outcomes)
        std::cout << counts[static_cast<char>(outcome)] << ' ' << words_of(outcome) << '\n';
    std::cout << silent << " silent without contacts, " << with_contacts << " with\n";
    return silent;
}

}  // namespace

int main(int argc, char** argv) try {
    CLI::App app{
        "What becomes of scenes over step and another parameter, for every method and number system, as rows."};
    stress::Choice choice;
    stress::RunOptions options;
    fs::path results = "build/results/stability.jsonl";
    std::string shard_text = "1/1";
    std::vector<fs::path> merge;
    std::vector<std::string> cell;
    app.add_option("--maps", choice.maps, "Names of maps; all if there are none")->delimiter(',');
    app.add_option("--integrators", choice.integrators, "Names of methods; all if there are none")->delimiter(',');
    app.add_option("--numbers", choice.numbers, "Names of number systems; all if there are none")->delimiter(',');
    app.add_flag("--coarse", options.coarse, "A few cells of each map");
    app.add_option("--seconds-a-cell", options.seconds_a_cell, "What a cell may take before it is one without an end");
    app.add_option("--shard", shard_text, "i/n: each n-th row, from the i-th on");
    app.add_option("--merge", merge, "Rows of all shards: makes the rows of one run of them");
    app.add_option("--scene", cell, "MAP X Y: write the scene of a cell to standard output")->expected(3);
    app.add_option("--results", results, "Where the rows go, as JSON lines");
    CLI11_PARSE(app, argc, argv);

    if (!cell.empty()) {
        std::cout << stress::map_named(cell[0]).scene_file(std::stod(cell[1]), std::stod(cell[2])).text();
        return 0;
    }
    std::vector<Row> rows;
    const Shard shard = shard_of(shard_text);
    if (!merge.empty()) {
        rows = merged(merge);
    } else {
        std::vector<stress::Job> jobs;
        const auto all = stress::jobs_of(choice);
        for (std::size_t i = shard.number - 1; i < all.size(); i += shard.count) jobs.push_back(all[i]);
        rows = stress::run(jobs, options);
    }
    write_rows(results, shard.count > 1 ? rows : stress::with_axes(rows, options.coarse));
    const std::size_t silent = report(rows);
    std::cout << rows.size() << " rows in " << results.string() << '\n';
    return silent > 0 ? 1 : 0;
} catch (...) { return report_failure("tumble_stress"); }
