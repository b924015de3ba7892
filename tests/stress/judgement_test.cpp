// What maps of stability say of runs that are known to be wrong, and of methods whose limits are known.
#include "../host_sim/liar.hpp"
#include "stress/map.hpp"

#include <gtest/gtest.h>

#include <ostream>

namespace {

using namespace tumble::bench::stress;
using tumble::host::Liar;
using tumble::host::SceneDescription;

// Letters of outcomes.
char letter(const Judgement& judgement) { return static_cast<char>(judgement.outcome); }
char outcome_of(const Map& map, double x, double y, const Method& method) { return letter(map.judge(x, y, method)); }
bool is_wrong(char outcome) { return outcome == 's' || outcome == 'b'; }

// A cell, and what is wrong with the world of the run that is taken for its own.
struct WrongWorld {
    const char* what;
    const char* map;
    double x, y;
    void (*change)(SceneDescription&);
};
std::ostream& operator<<(std::ostream& out, const WrongWorld& wrong) { return out << wrong.what; }

char outcome_of(const WrongWorld& wrong, const Method& method) {
    const Map& map = map_named(wrong.map);
    SceneDescription scene = map.scene(wrong.x, wrong.y);
    wrong.change(scene);
    const auto simulation = tumble::host::make_simulation(scene, method.integrator, method.numbers, method.carry);
    return letter(map.judge(wrong.x, wrong.y, method, *simulation));
}

void expect_that_the_right_one_passes(const WrongWorld& wrong, const Method& method) {
    EXPECT_EQ(outcome_of(map_named(wrong.map), wrong.x, wrong.y, method), 'a') << method.numbers;
}

// By per cent.
template <int weight>
void heavier(SceneDescription& scene) {
    for (auto& force : scene.forces) force.force[1] *= weight / 100.0;
}

class SmoothMaps : public testing::TestWithParam<WrongWorld> {};
class ContactMaps : public testing::TestWithParam<WrongWorld> {};

TEST_P(SmoothMaps, a_wrong_motion_is_not_accurate_and_is_silent_where_f64_is_right) {
    const Method in_f64{"rk4", "f64", false}, in_q32{"rk4", "q32", true};
    expect_that_the_right_one_passes(GetParam(), in_f64);
    expect_that_the_right_one_passes(GetParam(), in_q32);
    EXPECT_EQ(outcome_of(GetParam(), in_f64), 'd');
    EXPECT_EQ(outcome_of(GetParam(), in_q32), 's');
}
INSTANTIATE_TEST_SUITE_P(
    , SmoothMaps,
    testing::Values(
        WrongWorld{"drag_a_tenth_too_strong", "drag", 0.1, 1, [](auto& s) { s.linear_drag *= 1.1; }},
        WrongWorld{"no_gravity", "drag", 0.1, 0.3, [](auto& s) { s.gravity = {}; }},
        WrongWorld{"a_sun_too_heavy", "orbits", 256, 0.3, [](auto& s) { s.gravitation *= 1.01; }},
        WrongWorld{"an_orbit_begun_too_fast", "orbits", 512, 0.6, [](auto& s) { s.bodies[1].velocity[1] *= 1.01; }},
        WrongWorld{"a_pendulum_too_heavy", "pendulum", 0.08, 1.5, heavier<102>},
        WrongWorld{"a_pendulum_too_light", "pendulum", 0.04, 0.3, heavier<98>},
        WrongWorld{"a_top_of_other_moments", "heavy_top", 128, 5, [](auto& s) { (*s.bodies[0].inertia)[0] *= 1.02; }},
        WrongWorld{"a_top_begun_too_slowly", "heavy_top", 512, 20,
                   [](auto& s) { s.bodies[0].angular_velocity[2] *= 0.99; }}));

TEST_P(ContactMaps, a_wrong_contact_is_silent) {
    for (const Method& method : {Method{"verlet", "f64", false}, Method{"verlet", "q32", true}}) {
        expect_that_the_right_one_passes(GetParam(), method);
        EXPECT_EQ(outcome_of(GetParam(), method), 's') << method.numbers;
    }
}
INSTANTIATE_TEST_SUITE_P(
    , ContactMaps,
    testing::Values(
        WrongWorld{"bounces_too_high", "bounce_restitution", 256, 0.5, [](auto& s) { s.contact.restitution = 0.7; }},
        WrongWorld{"bounces_not_high_enough", "bounce_restitution", 256, 1,
                   [](auto& s) { s.contact.restitution = 0.9; }},
        WrongWorld{"falls_too_fast", "bounce_speed", 256, 3, [](auto& s) { s.gravity[1] *= 1.5; }},
        WrongWorld{"slides_too_far", "friction", 256, 1, [](auto& s) { s.contact.friction = 0.9; }},
        WrongWorld{"sticks", "friction", 64, 0.5, [](auto& s) { s.contact.friction = 1; }},
        WrongWorld{"sinks", "stack", 256, 3, [](auto& s) { s.planes[0].offset = 0.003; }},
        WrongWorld{"creeps", "stack", 256, 3, [](auto& s) { s.bodies[2].velocity[0] = 0.5; }},
        WrongWorld{"starts_too_deep", "mass_ratio_pile", 256, 1, [](auto& s) { s.bodies[1].position[1] -= 0.003; }},
        WrongWorld{"is_not_elastic", "mass_ratio_impact", 256, 1, [](auto& s) { s.contact.restitution = 0.5; }},
        WrongWorld{"flies_through", "mass_ratio_impact", 256, 1,
                   [](auto& s) { s.contact.response = tumble::ContactResponse::none; }}));

struct Cell {
    const char* map;
    double x, y;
};
char outcome_of_lies(const Cell& cell, const Method& method, double energy, double digits) {
    const Map& map = map_named(cell.map);
    Liar liar(tumble::host::make_simulation(map.scene(cell.x, cell.y), method.integrator, method.numbers, method.carry),
              energy, digits);
    return letter(map.judge(cell.x, cell.y, method, liar));
}

TEST(Maps, energy_from_nothing_is_silent) {
    const Method method{"suzuki4", "f64", false};
    for (const Cell& cell : {Cell{"pendulum", 0.04, 0.3}, Cell{"heavy_top", 128, 15.0}, Cell{"orbits", 256, 0.3}}) {
        EXPECT_EQ(outcome_of_lies(cell, method, 1, 0x1p60), 'a') << cell.map;
        EXPECT_EQ(outcome_of_lies(cell, method, 6, 0x1p60), 's') << cell.map;
    }
}

TEST(Maps, lost_digits_are_not_accurate) {
    const Method method{"suzuki4", "q32", true};
    for (const Cell& cell : {Cell{"pendulum", 0.04, 1.5}, Cell{"heavy_top", 256, 15.0}, Cell{"orbits", 1024, 0.3},
                             Cell{"drag", 0.02, 0.3}}) {
        EXPECT_EQ(outcome_of_lies(cell, method, 1, 0x1p60), 'a') << cell.map;
        EXPECT_NE(outcome_of_lies(cell, method, 1, 0x1p9), 'a') << cell.map;
    }
}

// Of ascending x with equal ratios: the cells a ratio or more below the limit are a motion of the same kind, those a
// ratio or more above are not.
void expect_the_limit(const Map& map, double y, const Method& method, double limit) {
    const auto& xs = map.x().fine;
    const double ratio = 1.001 * xs[1] / xs[0];
    for (const double x : xs) {
        const char outcome = outcome_of(map, x, y, method);
        if (x * ratio <= limit) {
            EXPECT_FALSE(is_wrong(outcome)) << map.name() << ' ' << x << ' ' << method.integrator;
        }
        if (limit > 0 && x >= limit * ratio) {
            EXPECT_NE(outcome, 'a') << map.name() << ' ' << x << ' ' << method.integrator;
            EXPECT_NE(outcome, 'd') << map.name() << ' ' << x << ' ' << method.integrator;
        }
    }
}

TEST(Maps, drag_ends_at_the_limits_of_the_methods) {
    for (const auto& integrator : tumble::host::integrators())
        expect_the_limit(map_named("drag"), 1, {integrator.name, "f64", false}, integrator.drag_limit);
}

TEST(Maps, small_swings_end_at_the_limits_of_the_methods) {
    for (const auto& integrator : tumble::host::integrators())
        expect_the_limit(map_named("pendulum"), 0.1, {integrator.name, "f64", false}, integrator.oscillation_limit);
}

TEST(Maps, orbits_drift_at_order_1_and_stay_at_order_4) {
    const Map& orbits = map_named("orbits");
    EXPECT_EQ(outcome_of(orbits, 64, 0.3, {"semi_implicit_euler", "f64", false}), 'd');
    for (const Method& method :
         {Method{"suzuki4", "f64", false}, Method{"suzuki4", "f32", true}, Method{"suzuki4", "q32", true}})
        EXPECT_EQ(outcome_of(orbits, 64, 0.3, method), 'a') << method.numbers;
    // Too long a step at the periapsis: a status, or a wrong run by the verdict.
    const char outcome = outcome_of(orbits, 16, 0.9, {"verlet", "f64", false});
    EXPECT_TRUE(outcome == 'b' || outcome == 't') << outcome;
}

}  // namespace
