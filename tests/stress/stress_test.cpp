// What maps of stability take a run for, and that every method keeps to the limits that theory gives it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "scene/reader.hpp"
#include "stress/map.hpp"

namespace tumble::bench::stress {
namespace {

// A run that is judged without anything known against it.
struct Case {
    Measured run;
    double floor = 1e-9, floor_in_f64 = 1e-17, of_order = 1e-6;
    Measured in_f64 = [] {
        Measured as_wrong;
        as_wrong.error = 1;
        return as_wrong;
    }();
    std::string verdict;
    bool is_f64 = false;

    [[nodiscard]] char letter() const {
        Expectation expectation;
        expectation.floor = floor;
        expectation.floor_in_f64 = floor_in_f64;
        expectation.of_order = [&] { return of_order; };
        expectation.in_f64 = [&] { return in_f64; };
        expectation.wrong = [&] { return verdict; };
        expectation.is_f64 = is_f64;
        return static_cast<char>(judge(run, expectation).outcome);
    }
    Case& error(double value) {
        run.see_error(value);
        return *this;
    }
    Case& expected(double value) {
        of_order = value;
        return *this;
    }
    Case& energy(double ratio) {
        run.see_energy(ratio);
        return *this;
    }
    Case& norm(double length) {
        run.see_norm(length);
        return *this;
    }
    Case& status(const char* issue) {
        run.troubles.push_back({issue, 0, 0});
        return *this;
    }
    Case& wrong_by_verdict() {
        verdict = "wrong";
        return *this;
    }
    Case& error_in_f64(double value) {
        in_f64.error = value;
        return *this;
    }
};

TEST(Outcome, AnErrorThatTheOrderOrRoundingExplainsIsAccurate) {
    EXPECT_EQ(Case{}.error(3e-6).letter(), 'a');
    EXPECT_EQ(Case{}.error(0.03).expected(0.01).letter(), 'a');
    EXPECT_EQ(Case{}.error(0.05).expected(0.01).letter(), 'd');
    EXPECT_EQ(Case{}.error(0.11).expected(1).letter(), 'd') << "more than 0.1 is never accurate";
    Case rounding;
    rounding.floor = 0.01;
    EXPECT_EQ(rounding.error(0.03).letter(), 'a');
}

TEST(Outcome, AMotionOfAnotherKindIsSilentUnlessItIsTold) {
    EXPECT_EQ(Case{}.error(1).energy(1.9).norm(1.0009).error_in_f64(1).letter(), 'd');
    EXPECT_EQ(Case{}.error(1).energy(2.1).letter(), 's');
    EXPECT_EQ(Case{}.error(1).norm(1.0011).letter(), 's');
    EXPECT_EQ(Case{}.error(std::nan("")).letter(), 's');
    EXPECT_EQ(Case{}.error(1).energy(2.1).wrong_by_verdict().letter(), 'b');
    EXPECT_EQ(Case{}.error(1).energy(2.1).status("range_left").letter(), 'r');
    EXPECT_EQ(Case{}.error(1).energy(2.1).status("step_bound_hit").wrong_by_verdict().letter(), 't');
    EXPECT_EQ(Case{}.error(0).status("range_left").letter(), 'r');
}

TEST(Outcome, ANumberSystemThatIsWrongByMuchMoreThanItsRoundingIsSilent) {
    EXPECT_EQ(Case{}.error(2e-3).error_in_f64(1e-6).letter(), 's');
    EXPECT_EQ(Case{}.error(9e-4).error_in_f64(1e-9).letter(), 'd');
    EXPECT_EQ(Case{}.error(2e-3).error_in_f64(1e-5).letter(), 'd');
    Case coarse_digits;
    coarse_digits.floor = 1e-5;
    EXPECT_EQ(coarse_digits.error(2e-3).error_in_f64(1e-9).letter(), 'd');
    Case stopped;  // the run in f64 has a status: its error is the error up to that step
    stopped.in_f64.error = 0;
    stopped.in_f64.troubles.push_back({"step_bound_hit", 0, 0});
    EXPECT_EQ(stopped.error(2e-3).letter(), 'd');
    Case of_method;  // f64 is at 100 of its floors as well
    of_method.floor_in_f64 = 1e-15;
    of_method.floor = 1e-7;
    EXPECT_EQ(of_method.error(2e-3).error_in_f64(1e-13).letter(), 'd');
    EXPECT_EQ(of_method.error(2e-2).error_in_f64(1e-13).letter(), 's');
    Case f64;
    f64.is_f64 = true;
    f64.in_f64.error = 0;
    EXPECT_EQ(f64.error(2e-3).letter(), 'd');
}

// Of maps whose limit is theory's: cells that lie further than one from it are stable on one side and not on the other,
// in floating and in fixed point.
class StableSide : public testing::TestWithParam<const char*> {};

TEST_P(StableSide, OfEveryMethodIsMetWithinACell) {
    Map& map = map_named(GetParam());
    map.prepare(map.y().coarse);
    const std::vector<double>& xs = map.x().fine;
    for (const auto& integrator : host::integrators()) {
        for (const Method& method : {Method{integrator.name, "f64", false}, Method{integrator.name, "f32", true},
                                     Method{integrator.name, "q32", true}}) {
            if (!host::runs_in(integrator, method.numbers)) continue;
            for (const double y : map.y().coarse) {
                const auto limit = map.limit(y, method);
                // The cell that the limit lies in or before; none: the end.
                const auto cell = limit ? std::lower_bound(xs.begin(), xs.end(), *limit) - xs.begin()
                                        : static_cast<std::ptrdiff_t>(xs.size()) + 1;
                const auto outcome = [&](std::ptrdiff_t i) {
                    return static_cast<char>(map.judge(xs[static_cast<std::size_t>(i)], y, method).outcome);
                };
                const auto where = [&](std::ptrdiff_t i) {
                    return integrator.name + " " + method.numbers + " at " +
                           std::to_string(xs[static_cast<std::size_t>(i)]) + ", " + std::to_string(y) + ", limit " +
                           std::to_string(limit.value_or(-1));
                };
                // Implicit methods have no limit, but their iterations may fail with a status. Methods that add to
                // every oscillation have a status for the one across the spring, which the damper does not slow.
                const std::string stable = limit && integrator.oscillation_limit > 0 ? "ad" : "adt";
                for (std::ptrdiff_t i : {cell - 3, cell - 2}) {
                    if (i < 0) continue;
                    EXPECT_TRUE(stable.find(outcome(i)) != std::string::npos) << where(i) << ": " << outcome(i);
                }
                if (!limit) continue;
                // What grows at every step may do so slowly: then only the longest step is sure to show it.
                const auto last = static_cast<std::ptrdiff_t>(xs.size()) - 1;
                const std::ptrdiff_t from = cell == 0 ? last : std::min(cell, last), to = std::min(from + 1, last);
                const std::string beyond{outcome(from), outcome(to)};
                EXPECT_NE(beyond.find_first_of("brt"), std::string::npos) << where(to) << ": " << beyond;
            }
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Of, StableSide, testing::Values("springs", "drag"));

TEST(Cell, IsASceneFileThatReadsBackTheSame) {
    for (const auto& map : maps()) {
        for (const double y : map->y().coarse) {
            const SceneFile file = map->scene_file(map->x().coarse.front(), y);
            const host::SceneDescription scene = host::read_scene_text(file.text(), "cell");
            EXPECT_EQ(scene.step.seconds(), file.description().step.seconds()) << map->name();
            EXPECT_GT(scene.steps(), 0) << map->name();
        }
    }
}

}  // namespace
}  // namespace tumble::bench::stress
