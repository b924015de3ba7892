// Reads the table of tolerances. Writes the share of each tolerance that a run has used, one line for each row, column
// and test, to the file that TUMBLE_TOLERANCES names.
#include "bound.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>
#include <ostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace tumble::test {
namespace {

using Place = std::tuple<std::string, std::string, std::string>;  // row, test, column

// Without the parameters of the instantiation.
std::string name_of(const testing::TestInfo& test) {
    std::string_view suite = test.test_suite_name(), name = test.name();
    if (const auto slash = suite.find('/'); slash != suite.npos) suite.remove_prefix(slash + 1);
    return std::string{suite} + "." + std::string{name.substr(0, name.find('/'))};
}

const std::map<Place, Number>& table() {
    static const std::map<Place, Number> entries = [] {
        const auto fail = [](const std::string& line, const char* expectation) {
            throw std::runtime_error{TUMBLE_TOLERANCE_TABLE ": expected " + std::string{expectation} + ": " + line};
        };
        std::map<Place, Number> read;
        std::ifstream file{TUMBLE_TOLERANCE_TABLE};
        if (!file) fail("", "a file that can be read");
        for (std::string line; std::getline(file, line);) {
            if (line.empty() || line[0] == '#') continue;
            std::istringstream words{line};
            std::string row, test, entry;
            words >> row >> test;
            while (words >> entry) {
                const auto equals = entry.find('=');
                if (equals == entry.npos) fail(line, "column=value after the name of a row and a test");
                char* end = nullptr;
                const Number value = std::strtold(entry.c_str() + equals + 1, &end);
                if (*end != '\0' || !(value >= 0)) fail(line, "a number that is not below zero after each =");
                if (!read.emplace(Place{row, test, entry.substr(0, equals)}, value).second)
                    fail(line, "each place once");
            }
        }
        return read;
    }();
    return entries;
}

struct Use {
    const char* row;
    const char* column;
    Number tolerance;
    Number error;            // the largest, in the row's units
    Number share;            // the largest, of its bound
    bool is_judged = false;  // whether it is not always beside a larger one
};

class Uses : public testing::EmptyTestEventListener {
public:
    static Uses& all() {
        static Uses* const uses = [] {
            auto* made = new Uses;  // owned by the list of listeners
            testing::UnitTest::GetInstance()->listeners().Append(made);
            return made;
        }();
        return *uses;
    }
    Use& of(const char* row, const char* column) {
        for (Use& use : of_test_)
            if (use.row == row && use.column == column) return use;
        const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
        if (test == nullptr) throw std::logic_error{std::string{"tolerance "} + row + " is needed outside of any test"};
        const auto entry = table().find({row, name_of(*test), column});
        const bool has = entry != table().end();
        EXPECT_TRUE(has) << TUMBLE_TOLERANCE_TABLE ": expected a line: " << row << " " << name_of(*test) << " "
                         << column << "=value";
        of_test_.push_back({row, column, has ? entry->second : std::numeric_limits<Number>::max(), 0, 0, false});
        return of_test_.back();
    }
    void OnTestStart(const testing::TestInfo&) override { of_test_.clear(); }
    void OnTestEnd(const testing::TestInfo& test) override {
        for (const Use& use : of_test_) {
            Largest& largest = largest_[{use.row, name_of(test), use.column}];
            if (use.is_judged && (largest.test.empty() || largest.error < use.error)) {
                largest.error = use.error;
                largest.test = test.name();
            }
            largest.tolerance = use.tolerance;
            largest.share = std::max(largest.share, use.share);
        }
    }
    void OnTestProgramEnd(const testing::UnitTest&) override {
        const char* path = std::getenv("TUMBLE_TOLERANCES");
        if (path == nullptr) return;
        std::FILE* const file = std::fopen(path, "w");
        if (file == nullptr) {
            std::fprintf(stderr, "TUMBLE_TOLERANCES: cannot write %s\n", path);
            std::exit(1);
        }
        if (GTEST_FLAG_GET(filter) != "*") std::fputs("# not all tests\n", file);
        for (const auto& [place, largest] : largest_) {
            const auto& [row, test, column] = place;
            if (largest.test.empty())
                std::fprintf(file, "%s %s %s %.4Lg - - -\n", row.c_str(), test.c_str(), column.c_str(),
                             largest.tolerance);
            else
                std::fprintf(file, "%s %s %s %.4Lg %.4Lg %.4Lg %s\n", row.c_str(), test.c_str(), column.c_str(),
                             largest.tolerance, largest.error, largest.share, largest.test.c_str());
        }
        std::fclose(file);
    }

private:
    struct Largest {
        Number tolerance = 0, error = 0, share = 0;
        std::string test;
    };
    std::vector<Use> of_test_;
    std::map<Place, Largest> largest_;
};
[[maybe_unused]] const Uses& listens_from_the_start = Uses::all();

}  // namespace

void Bound::note(Number error) const {
    if (is_zero()) return;
    Use& use = Uses::all().of(row_, column_);
    use.is_judged = true;
    use.error = std::max(use.error, error / factor_);
    // An exact result that must be exact has used all of its tolerance.
    use.share = std::max(use.share, value_ == 0 && error <= 0 ? Number(1) : error / value_);
}

Bound Tolerance::in(const char* column) const { return {name_, column, Uses::all().of(name_, column).tolerance}; }

Bound Tolerance::of_order(int order) const {
    static const char* const names[] = {"order_0", "order_1", "order_2", "order_3", "order_4", "order_5",
                                        "order_6", "order_7", "order_8", "order_9", "order_10"};
    if (order > 10) return {};  // no error of truncation
    return in(names[order]);
}

void PrintTo(const Bound& bound, std::ostream* out) {
    *out << bound.value_ << " (" << bound.row_ << ", " << bound.column_ << ")";
}

}  // namespace tumble::test
