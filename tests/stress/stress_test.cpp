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

// A run that is judged, without anything known against it.
struct Case {
    double error = 0, energy = 1, norm = 1;  // the norm: a quaternion's length
    std::string status = {}, verdict = {};   // an issue; why the verdict is that the run is wrong
    double error_in_f64 = 1;
    std::string status_in_f64 = {};
    double floor = 1e-9, floor_in_f64 = 1e-17, of_order = 1e-6;
    bool is_f64 = false;

    [[nodiscard]] char letter() const {
        Measured run, in_f64;
        run.see_error(error);
        run.see_energy(energy);
        run.see_norm(norm);
        in_f64.error = error_in_f64;
        if (!status.empty()) run.troubles.push_back({status, 0, 0});
        if (!status_in_f64.empty()) in_f64.troubles.push_back({status_in_f64, 0, 0});
        Expectation expectation;
        expectation.floor = floor;
        expectation.floor_in_f64 = floor_in_f64;
        expectation.of_order = [&] { return of_order; };
        expectation.in_f64 = [&] { return in_f64; };
        expectation.wrong = [&] { return verdict; };
        expectation.is_f64 = is_f64;
        return static_cast<char>(judge(run, expectation).outcome);
    }
};

TEST(Outcome, AnErrorThatTheOrderOrRoundingExplainsIsAccurate) {
    EXPECT_EQ(Case{.error = 3e-6}.letter(), 'a');
    EXPECT_EQ((Case{.error = 0.03, .of_order = 0.01}.letter()), 'a');
    EXPECT_EQ((Case{.error = 0.05, .of_order = 0.01}.letter()), 'd');
    EXPECT_EQ((Case{.error = 0.11, .of_order = 1}.letter()), 'd') << "more than 0.1 is never accurate";
    EXPECT_EQ((Case{.error = 0.03, .floor = 0.01}.letter()), 'a');
}

TEST(Outcome, AMotionOfAnotherKindIsSilentUnlessItIsTold) {
    EXPECT_EQ((Case{.error = 1, .energy = 1.9, .norm = 1.0009, .error_in_f64 = 1}.letter()), 'd');
    EXPECT_EQ((Case{.error = 1, .energy = 2.1}.letter()), 's');
    EXPECT_EQ((Case{.error = 1, .norm = 1.0011}.letter()), 's');
    EXPECT_EQ(Case{.error = std::nan("")}.letter(), 's');
    EXPECT_EQ((Case{.error = 1, .energy = 2.1, .verdict = "wrong"}.letter()), 'b');
    EXPECT_EQ((Case{.error = 1, .energy = 2.1, .status = "range_left"}.letter()), 'r');
    EXPECT_EQ((Case{.error = 1, .energy = 2.1, .status = "step_bound_hit", .verdict = "wrong"}.letter()), 't');
    EXPECT_EQ((Case{.error = 0, .status = "range_left"}.letter()), 'r');
}

TEST(Outcome, ANumberSystemThatIsWrongByMuchMoreThanItsRoundingIsSilent) {
    EXPECT_EQ((Case{.error = 2e-3, .error_in_f64 = 1e-6}.letter()), 's');
    EXPECT_EQ((Case{.error = 9e-4, .error_in_f64 = 1e-9}.letter()), 'd');
    EXPECT_EQ((Case{.error = 2e-3, .error_in_f64 = 1e-5}.letter()), 'd');
    EXPECT_EQ((Case{.error = 2e-3, .error_in_f64 = 1e-9, .floor = 1e-5}.letter()), 'd');
    // The run in f64 has a status: its error is the error up to that step.
    EXPECT_EQ((Case{.error = 2e-3, .error_in_f64 = 0, .status_in_f64 = "step_bound_hit"}.letter()), 'd');
    // f64 is at 100 of its floors as well.
    EXPECT_EQ((Case{.error = 2e-3, .error_in_f64 = 1e-13, .floor = 1e-7, .floor_in_f64 = 1e-15}.letter()), 'd');
    EXPECT_EQ((Case{.error = 2e-2, .error_in_f64 = 1e-13, .floor = 1e-7, .floor_in_f64 = 1e-15}.letter()), 's');
    EXPECT_EQ((Case{.error = 2e-3, .error_in_f64 = 0, .is_f64 = true}.letter()), 'd');
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
