// The feature ladder: rows of scenes of which each adds one feature to the one before it, from the empty world up.
#pragma once

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "rows/rows.hpp"

namespace tumble::bench {

// On one core, in one number system.
struct Ladder {
    std::string core, numbers;
    std::vector<Row> rungs;

    [[nodiscard]] std::string name() const { return core + " " + numbers; }
    [[nodiscard]] std::string feature(std::size_t rung) const { return rungs[rung].at("scene"); }
};

// Those of the rows, in the order of their first rungs. Throws std::runtime_error where they differ in features.
[[nodiscard]] inline std::vector<Ladder> ladders_of(const std::vector<Row>& rows) {
    std::vector<Ladder> ladders;
    for (const Row& row : rows) {
        const Ladder of_row{row.at("core"), numbers_of(row), {}};
        auto ladder = std::find_if(ladders.begin(), ladders.end(),
                                   [&](const Ladder& other) { return other.name() == of_row.name(); });
        if (ladder == ladders.end()) ladder = ladders.insert(ladder, of_row);
        ladder->rungs.push_back(row);
    }
    if (ladders.empty()) throw std::runtime_error{"the feature ladder has no rows"};
    for (const Ladder& ladder : ladders) {
        bool same = ladder.rungs.size() == ladders.front().rungs.size();
        for (std::size_t i = 0; same && i < ladder.rungs.size(); ++i)
            same = ladder.feature(i) == ladders.front().feature(i);
        if (!same)
            throw std::runtime_error{"the feature ladder of " + ladder.name() + " has other rungs than that of " +
                                     ladders.front().name()};
    }
    return ladders;
}

// Draws what each rung takes and adds, a bar for each ladder.
void draw_ladders(const std::vector<Ladder>& ladders, const std::filesystem::path& svg);

}  // namespace tumble::bench
