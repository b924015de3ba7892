// Maps of stability: the outcome of scenes over the step and another parameter, for every method and number system.
#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>
#include <map>

#include "stress/picture.hpp"
#include "stress/runner.hpp"
#include "tools/files.hpp"

namespace {

using namespace tumble::bench;
namespace stress = tumble::bench::stress;
namespace fs = std::filesystem;

// The exit status if cells without contacts are silent.
constexpr int silent_status = 3;

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

// The rows of the files in the order of one run of these jobs. Each job must have its row.
std::vector<Row> merged(const std::vector<fs::path>& files, const std::vector<stress::Job>& jobs) {
    const auto key = [](const std::string& map, const std::string& integrator, const std::string& numbers, bool carry) {
        return map + ", " + integrator + ", " + tumble::host::numbers_text(numbers, carry);
    };
    std::map<std::string, Row> found;
    for (const fs::path& file : files) {
        for (Row& row : read_rows(file)) {
            if (!row.contains("silent_cells")) continue;
            const std::string name = key(row.at("map"), row.at("integrator"), row.at("numbers"), row.at("carry"));
            const auto [place, is_new] = found.emplace(name, row);
            if (!is_new && place->second != row)
                throw std::runtime_error{file.string() + ": the cells of " + name +
                                         " differ from those of a file before it"};
        }
    }
    std::vector<Row> rows;
    std::string missing;
    for (const stress::Job& job : jobs) {
        const std::string name = key(job.map->name(), job.integrator, job.variant.numbers, job.variant.carry);
        const auto row = found.find(name);
        if (row == found.end()) missing += "\n  " + name;
        else rows.push_back(row->second);
    }
    if (!missing.empty()) throw std::runtime_error{"rows are missing:" + missing};
    return rows;
}

// Prints counts and silent cells of rows with causes. Returns the number of silent cells without contacts.
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

// Draws a picture of each map in the rows, stability_NAME.svg.
void draw(const fs::path& file, const fs::path& directory) {
    const std::vector<Row> rows = read_rows(file);
    fs::create_directories(directory);
    for (const auto& map : stress::maps()) {
        Row axes;
        std::vector<Row> of_map;
        for (const Row& row : rows) {
            if (row.at("map") != map->name()) continue;
            if (row.contains("cells")) of_map.push_back(row);
            else axes = row;
        }
        if (of_map.empty()) continue;
        const fs::path picture = directory / ("stability_" + map->name() + ".svg");
        tumble::host::write_if_changed(picture, stress::picture_of(*map, axes, of_map));
    }
}

// Prints one cell of each chosen row: its measurements and its outcome.
void explain(const std::string& map, double x, double y, const stress::Choice& choice) {
    stress::map_named(map).prepare({y});
    for (const stress::Job& job : stress::jobs_of(choice)) {
        if (job.map->name() != map) continue;
        const stress::Judgement judgement = job.map->judge(x, y, job.method());
        std::cout << static_cast<char>(judgement.outcome) << ' ' << job.integrator << ' ' << job.variant.name;
        if (judgement.outcome != stress::Outcome::told) {
            const stress::Measured run = job.map->measure(x, y, job.method());
            const auto add = [](const char* what, double value) {
                std::cout << ", " << what << ' ' << tumble::host::few_digits(value);
            };
            add("error", run.error);
            add("of rounding", job.map->rounding_floor(x, y, job.method()));
            add("energy ratio", run.energy_most);
            add("norm error", run.norm_error);
        }
        std::cout << (judgement.cause.empty() ? "" : ": ") << judgement.cause << '\n';
    }
}

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    CLI::App app{"Outcome of scenes over the step and another parameter, for every method and number system, as rows."};
    stress::Choice choice;
    stress::RunOptions options;
    fs::path results = "build/results/stability.jsonl";
    std::string shard_text = "1/1";
    std::vector<fs::path> merge;
    std::vector<std::string> scene, cell;
    fs::path drawn, directory;
    app.add_option("--maps", choice.maps, "Names of maps; all if there are none")->delimiter(',');
    app.add_option("--integrators", choice.integrators, "Names of methods; all if there are none")->delimiter(',');
    app.add_option("--numbers", choice.numbers, "Names of number systems; all if there are none")->delimiter(',');
    app.add_flag("--coarse", options.coarse, "A few cells of each map");
    app.add_option("--seconds-a-cell", options.seconds_a_cell,
                   "Time limit of a cell, s; a cell that exceeds it has no end");
    app.add_option("--shard", shard_text, "i/n: each n-th row, from the i-th on");
    app.add_option("--merge", merge, "Rows of all shards: joins them as the rows of one run")->delimiter(',');
    app.add_option("--kept", options.kept, "Directory of finished rows; they are kept until the program changes");
    app.add_flag("--anew", options.anew, "Run kept rows again");
    app.add_option("--scene", scene, "MAP X Y: write the scene of a cell to standard output")->expected(3);
    app.add_option("--cell", cell, "MAP X Y: the outcome of a cell and its cause, for each method and number system")
        ->expected(3);
    app.add_option("--draw", drawn, "Draw the maps of these rows instead of running them");
    app.add_option("--directory", directory, "Where the pictures go; without it none are drawn");
    app.add_option("--results", results, "Where the rows go, as JSON lines");
    CLI11_PARSE(app, argc, argv);

    if (!scene.empty()) {
        std::cout << stress::map_named(scene[0]).scene_file(std::stod(scene[1]), std::stod(scene[2])).text();
        return 0;
    }
    if (!cell.empty()) {
        explain(cell[0], std::stod(cell[1]), std::stod(cell[2]), choice);
        return 0;
    }
    if (!drawn.empty()) {
        draw(drawn, directory.empty() ? "." : directory);
        return 0;
    }
    const Shard shard = shard_of(shard_text);
    std::vector<stress::Job> all = stress::jobs_of(choice), jobs;
    for (std::size_t i = shard.number - 1; i < all.size(); i += shard.count) jobs.push_back(all[i]);
    const std::vector<Row> rows = merge.empty() ? stress::run(jobs, options) : merged(merge, jobs);
    // A shard's rows keep the causes of their silent cells for the merge.
    write_rows(results, shard.count > 1 ? rows : stress::with_axes(rows, options.coarse));
    const std::size_t silent = report(rows);
    std::cout << rows.size() << " rows in " << results.string() << '\n';
    if (!directory.empty()) draw(results, directory);
    return silent > 0 ? silent_status : 0;
} catch (...) { return report_failure("tumble_stress"); }
