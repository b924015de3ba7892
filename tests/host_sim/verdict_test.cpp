// The verdict on a run, held against an integration in long double that shares no code with the kernel, and against
// what physics says of single scenes.
#include <algorithm>
#include <cmath>
#include <random>

#include "command/check.hpp"
#include "command/messages.hpp"
#include "command_runner.hpp"
#include "scene/data.hpp"
#include "scene/scene_file.hpp"
#include "simulation/simulation.hpp"
#include "tools/text.hpp"
#include "truth/smooth_motion.hpp"
#include "verdict/energy_budget.hpp"
#include "verdict/record.hpp"
#include "verdict/verdict.hpp"

namespace tumble::host {
namespace {

const Method verlet_q32{"verlet", "q32", true};

SceneDescription parsed(const std::string& text) { return read_scene_text(text, "test.toml"); }

// m and rad: the largest error in parts of what counts as wrong, by a long double integration of a scene without
// contacts.
double error_in_parts_of_wrong(const SceneDescription& scene, const Method& method) {
    SmoothMotion truth(scene, shapes_meet);
    const auto start = truth.bodies();
    const auto simulation = make_simulation(scene, method.integrator, method.numbers, method.carry);
    std::vector<double> way(start.size());
    double worst = 0;
    const auto moments = moments_of(scene);
    for (const std::int64_t moment : moments) {
        const std::int64_t from = simulation->steps_taken();
        for (std::int64_t look = 1; look <= 16; ++look) {
            truth.advance_to(from + (moment - from) * look / 16);
            for (std::size_t b = 0; b < way.size(); ++b)
                way[b] = std::max(way[b], static_cast<double>(norm(truth.bodies()[b].x - start[b].x)));
        }
        while (simulation->steps_taken() < moment) {
            simulation->step();
            if (!simulation->troubles().empty()) return std::numeric_limits<double>::infinity();
        }
        for (std::size_t b = 0; b < way.size(); ++b) {
            Errors errors;
            errors.see(motion_of(simulation->body(static_cast<int>(b))), truth.bodies()[b]);
            worst =
                std::max({worst, errors.orientation_rad / 0.1, way[b] > 1e-5 ? errors.position_m / way[b] / 0.1 : 0});
        }
    }
    return worst;
}

TEST(Verdict, method_that_is_too_coarse_is_the_cause_and_its_cure_is_right) {
    const SceneDescription scene = read_scene(shipped("pendulum"));
    const Verdict verdict = verdict_of(scene, verlet_q32);
    ASSERT_EQ(verdict.kind, Verdict::Kind::wrong);
    EXPECT_EQ(verdict.cause, Verdict::Cause::method);
    ASSERT_TRUE(verdict.cure.has_value());
    EXPECT_LT(error_in_parts_of_wrong(scene, verdict.cure->method), 1);
}

TEST(Verdict, euler_on_an_oscillator_is_wrong_by_as_much_as_the_motion) {
    SceneDescription scene = read_scene(shipped("oscillators"));
    scene.duration = 60;
    const Verdict verdict = verdict_of(scene, {"explicit_euler", "f64", false});
    EXPECT_TRUE(verdict.kind == Verdict::Kind::wrong || verdict.kind == Verdict::Kind::told);
    EXPECT_TRUE(verdict.is_as_large_as_motion);
    EXPECT_EQ(verdict.cause, Verdict::Cause::method);
}

TEST(DeepVerdict, floats_far_from_the_origin_are_the_cause_that_exchange_finds) {
    // The spacing of floats there is 2 mm, and a step moves the body by 0.4 mm.
    const Verdict verdict = verdict_of(parsed(R"(
world = { step = "1/256", duration = 10.0 }
range = { position = 32000.0 }
body = [ { name = "b", shape = { sphere = 0.1 }, mass = 1.0, position = [30000, 0, 0], velocity = [0.1, 0, 0] } ]
)"),
                                       {"verlet", "f32", false});
    EXPECT_EQ(verdict.kind, Verdict::Kind::wrong);
    EXPECT_EQ(verdict.cause, Verdict::Cause::numbers);
    ASSERT_TRUE(verdict.cure.has_value());
}

TEST(Verdict, spin_beyond_fixed_point_is_told_with_the_number_that_left_and_a_cure_that_is_right) {
    SceneDescription scene = parsed(R"(
world = { step = "1/256", duration = 1.0 }
body = [ { name = "die", shape = { box = [0.1, 0.1, 0.1] }, mass = 1.0 } ]
impulse = [ { time = 0.25, body = "die", angular_impulse = [0, 0, 0.3] } ]
)");
    const Verdict verdict = verdict_of(scene, verlet_q32);
    ASSERT_EQ(verdict.kind, Verdict::Kind::told);
    EXPECT_EQ(verdict.time_s, 0.25);
    ASSERT_TRUE(verdict.troubles.front().number.has_value());
    EXPECT_EQ(verdict.troubles.front().number->name, "angular velocity");
    EXPECT_NEAR(verdict.troubles.front().number->most, 128, 1e-6);
    ASSERT_TRUE(verdict.cure.has_value());
    scene.step = verdict.cure->step;
    EXPECT_EQ(verdict_of(scene, verdict.cure->method).kind, Verdict::Kind::right);
}

TEST(Verdict, rough_impacts_gain_no_energy) {
    // A rod that lands on its edge: Newton's hypothesis alone would add 56 % to its energy.
    const std::string rod = R"(
contact = { restitution = 1.0, friction = 0.5 }
plane = [ { name = "floor", normal = [0, 1, 0] } ]
body = [ { name = "b", shape = { box = [1, 0.1, 0.1] }, mass = 1.0, position = [0, 0.36235, 0], velocity = [0, -1, 0], orientation = [0.93937271, 0, 0, 0.34289781], angular_velocity = [0, 0, 4.2] } ]
)";
    for (const char* step : {"1/256", "1/1024"}) {
        const Verdict verdict =
            verdict_of(parsed("world = { step = \"" + std::string(step) + "\", duration = 0.125 }" + rod), verlet_q32);
        EXPECT_EQ(verdict.kind, Verdict::Kind::right);
        EXPECT_FALSE(verdict.gains_energy);
    }
}

TEST(Verdict, energy_that_loads_give_is_no_gain) {
    const SceneDescription scene = parsed(R"(
world = { gravity = [0, -9.81, 0], step = "1/256", duration = 2.0 }
body = [ { name = "b", shape = { box = [0.2, 0.3, 0.4] }, mass = 1.0 } ]
impulse = [ { time = 0.5, body = "b", impulse = [3, 0, 0], point = [0, 0.1, 0] } ]
force = [ { body = "b", from = 0.75, until = 1.25, force = [0, 20, 0] } ]
)");
    const Verdict verdict = verdict_of(scene, verlet_q32);
    EXPECT_EQ(verdict.kind, Verdict::Kind::right) << sentence_of(verdict, scene, verlet_q32);
}

TEST(Verdict, billiards_have_no_reference_after_some_impacts) {
    const Verdict verdict = verdict_of(read_scene(shipped("cube")), verlet_q32, {.explains = false});
    EXPECT_EQ(verdict.kind, Verdict::Kind::no_reference);
    EXPECT_GT(verdict.time_s, 1);
    EXPECT_LT(verdict.error.orientation_rad, 0.1);
}

TEST(Verdict, check_that_is_too_dear_is_not_made) {
    SceneDescription scene = read_scene(shipped("top"));
    scene.duration = 3600;
    const Verdict verdict = verdict_of(scene, verlet_q32, {.most_seconds = 0.1});
    EXPECT_EQ(verdict.kind, Verdict::Kind::unchecked);
    EXPECT_GT(verdict.cost_s, 0.1);
}

TEST(Verdict, tolerance_decides_what_is_wrong) {
    const SceneDescription scene = read_scene(shipped("pendulum"));
    EXPECT_EQ(verdict_of(scene, verlet_q32, {.tolerance = 0.5, .explains = false}).kind, Verdict::Kind::right);
    EXPECT_EQ(verdict_of(scene, {"rk4", "q32", true}, {.tolerance = 1e-6, .explains = false}).kind,
              Verdict::Kind::wrong);
}

// A body of `mass` that hangs or stands at rest at 30 cm from the origin, by a spring of 4 N/mm.
SceneDescription at_rest(double mass, bool mirrored, bool by_contact, const char* step) {
    const double sag = mass * 9.81 / 4000, sign = mirrored ? -1 : 1;
    const auto number = [](double x) { return seventeen_digits(x); };
    const std::string world = world_of(number(-9.81 * sign), step, "2.0");
    const auto body_at = [&](double y) {
        return body_of("b", "sphere = 0.1", "[0.3, " + number(y) + ", 0]", number(mass));
    };
    if (by_contact)
        return parsed(world + "[contact]\nresponse = \"spring\"\nstiffness = 4000.0\n[[plane]]\nname = \"floor\"\n" +
                      "normal = [0, " + number(sign) + ", 0]\n" + body_at(sign * (0.1 - sag)));
    return parsed(world + body_at(-sign * sag) + "[[spring]]\nbody = \"b\"\nto = [0.3, 0, 0]\nstiffness = 4000.0\n");
}

TEST(Verdict, a_body_that_rests_on_a_spring_is_right) {
    for (const auto& [mass, mirrored] : {std::pair{0.5, false}, {1.7, true}, {3.0, false}})
        for (const bool by_contact : {false, true})
            for (const char* step : {"1/256", "1/1000"})
                for (const Method& method : {verlet_q32, Method{"verlet", "f32", true}, Method{"rk4", "f64", false}}) {
                    const SceneDescription scene = at_rest(mass, mirrored, by_contact, step);
                    const Verdict verdict = verdict_of(scene, method);
                    EXPECT_EQ(name_of(verdict.kind), std::string("right"))
                        << mass << mirrored << by_contact << step << method.numbers << " "
                        << sentence_of(verdict, scene, method);
                }
}

// Its true position is the origin. Where the springs are pressed it is unstable, so rounding may grow to a true error.
TEST(Verdict, a_body_that_symmetry_keeps_still_is_judged_by_its_distance_from_the_origin) {
    for (const double stiffness : {50.0, 333.0})
        for (const double side : {0.3, 0.7})
            for (const Method& method : {verlet_q32, Method{"verlet", "f32", true}, Method{"rk4", "f64", false}}) {
                const std::string x = seventeen_digits(side), k = seventeen_digits(stiffness);
                // The two outer bodies swing in and out alike; the middle one is held between them.
                const auto outer = [&](const std::string& name, const std::string& place, const char* velocity) {
                    return body_of(name, "sphere = 0.05", "[" + place + ", 0, 0]", "0.7") + "velocity = " + velocity +
                           "\n[[spring]]\nbody = \"middle\"\nto_body = \"" + name + "\"\nstiffness = " + k +
                           "\nrest_length = 0.2\n";
                };
                const SceneDescription scene =
                    parsed(world_of("0", "1/256", "4.0") + "[contact]\nresponse = \"none\"\n" +
                           body_of("middle", "sphere = 0.05", "", "0.3") + outer("left", "-" + x, "[0.4, 0.1, 0]") +
                           outer("right", x, "[-0.4, -0.1, 0]"));
                const Record run = record_of(scene, method, 0, moments_of(scene));
                double error = 0;  // in parts of a tenth of a hundredth of the way of the others
                for (const Moment& moment : run.moments)
                    error = std::max(error, static_cast<double>(norm(moment.bodies[0].x)) / (moment.way_m[1] / 1000));
                const Verdict verdict = verdict_of(scene, method, run);
                if (error < 0.5 || error > 2) {
                    EXPECT_EQ(name_of(verdict.kind), std::string(error < 1 ? "right" : "wrong"))
                        << stiffness << " " << side << " " << method.numbers << " " << error << " "
                        << sentence_of(verdict, scene, method);
                }
            }
}

TEST(Verdict, last_confirmed_moment_is_told) {
    const SceneDescription scene = read_scene(shipped("cube"));
    const Verdict verdict = verdict_of(scene, verlet_q32, {.explains = false});
    ASSERT_EQ(verdict.kind, Verdict::Kind::no_reference);
    EXPECT_GT(verdict.parted_s, verdict.time_s);
    EXPECT_NEAR(verdict.parted_s - verdict.time_s, scene.duration / sample_count, 2 * scene.step.seconds());
    Verdict none = verdict;
    none.time_s = 0;
    EXPECT_TRUE(sentence_of(none, scene, verlet_q32).starts_with("no reference: two finer runs "));
    EXPECT_TRUE(sentence_of(verdict, scene, verlet_q32).starts_with("right until "));
}

TEST(Verdict, state_that_is_not_finite_without_a_status_is_wrong) {
    for (const char* name : {"orbit", "brick"}) {
        const SceneDescription scene = read_scene(shipped(name));
        Record run = record_of(scene, verlet_q32, 0, moments_of(scene));
        run.moments.resize(run.moments.size() / 2);
        run.not_finite = 0;
        const Verdict verdict = verdict_of(scene, verlet_q32, run, {.explains = false});
        EXPECT_EQ(verdict.kind, Verdict::Kind::wrong);
        EXPECT_TRUE(verdict.is_as_large_as_motion);
        EXPECT_NE(sentence_of(verdict, scene, verlet_q32).find("\" is not finite"), std::string::npos);
    }
}

// A plate of ten grams between the floor and a heavy block that lands on it.
std::string squeezed(double heavy) {
    return world_of("-9.81", "1/256", "0.3") + "[contact]\nrestitution = 0.5\n" + floor_plane +
           body_of("light", "box = [0.3, 0.1, 0.3]", "[0, 0.05, 0]", "0.01") +
           body_of("heavy", "box = [0.4, 0.4, 0.4]", "[0, 0.4, 0]", seventeen_digits(heavy));
}

TEST(Verdict, cure_of_impacts_beyond_their_bound_has_been_run) {
    int cured = 0;
    for (const double heavy : {0.3, 3.0}) {
        SceneDescription scene = parsed(squeezed(heavy));
        const Verdict verdict = verdict_of(scene, {"verlet", "f64", false});
        if (verdict.troubles.empty() || verdict.troubles.front().issue != "step_bound_hit" || !verdict.cure) continue;
        ++cured;
        if (verdict.cure->restitution_threshold)
            scene.contact.restitution_threshold = *verdict.cure->restitution_threshold;
        scene.step = verdict.cure->step;
        const Method& method = verdict.cure->method;
        EXPECT_TRUE(record_of(scene, method, 0, moments_of(scene)).troubles.empty()) << heavy;
    }
    EXPECT_GT(cured, 0);
}

TEST(Verdict, check_that_is_not_made_says_why) {
    const SceneDescription scene = read_scene(shipped("brick"));
    Verdict verdict;
    verdict.cost_s = 29.5;
    EXPECT_EQ(sentence_of(verdict, scene, verlet_q32), "not checked: the check takes about 30 s (--check on)");
    verdict.obstacle = "cmake failed";
    EXPECT_EQ(sentence_of(verdict, scene, verlet_q32), "not checked: cmake failed");
}

TEST(Verdict, usual_scenes_are_checked) {
    std::vector<std::string> names = shipped_scenes();
    for (const char* name : {"drop", "incline", "pyramid", "spheres", "stack"})
        names.push_back(std::string("contacts/") + name);
    for (const std::string& name : names) {
        const SceneDescription scene = read_scene(shipped(name));
        const Record run = record_of(scene, {"verlet", "f64", false}, 0, moments_of(scene));
        EXPECT_LT(estimated_seconds(scene, 2, run.load) + estimated_seconds(scene, 3, run.load),
                  CheckOptions::most_seconds)
            << name;
    }
}

// The same estimate for the same scene: a second run of it, and one on a machine that is busy, is checked or not alike.
TEST(Verdict, no_clock_decides_what_the_command_says) {
    namespace fs = std::filesystem;
    for (const auto& entry : fs::recursive_directory_iterator(source_directory / "host_sim")) {
        const std::string name = entry.path().filename();
        if (!entry.is_regular_file() || !(name.ends_with(".cpp") || name.ends_with(".hpp")) || name == "progress.hpp")
            continue;
        const std::string text = contents(entry.path().string());
        for (const char* clock : {"chrono", "clock_gettime", "getrusage", "gettimeofday", "std::clock", "<ctime>"})
            EXPECT_FALSE(has(text, clock)) << entry.path() << " has " << clock;
    }
}

// Two rods of 1 m in the plane x, y, or turned out of it, on hinges; let go at angles from hanging.
SceneDescription double_pendulum(double upper, double lower, const char* step, const char* duration,
                                 double lower_mass = 1, bool is_turned = false) {
    const auto turned = [&](double x, double y) {
        const double c = is_turned ? 0.8 : 1, s = is_turned ? 0.6 : 0;  // about y
        return "[" + seventeen_digits(c * x) + ", " + seventeen_digits(y) + ", " + seventeen_digits(-s * x) + "]";
    };
    const auto orientation = [&](double angle) {
        const reference::Rotation about_y =
            reference::exponential<reference::Number>({0, is_turned ? std::atan2(0.6L, 0.8L) : 0, 0});
        const reference::Rotation q = about_y * reference::exponential<reference::Number>({0, 0, angle});
        return "orientation = [" + seventeen_digits(double(q.w)) + ", " + seventeen_digits(double(q.v.x)) + ", " +
               seventeen_digits(double(q.v.y)) + ", " + seventeen_digits(double(q.v.z)) + "]\n";
    };
    const double x = std::sin(upper), y = -std::cos(upper);
    const std::string axis = is_turned ? "axis = [0.6, 0, 0.8]\n" : "axis = [0, 0, 1]\n";
    return parsed(world_of("-9.81", step, duration) + smallest_range +
                  body_of("upper", "box = [0.1, 1, 0.1]", turned(x / 2, y / 2)) + orientation(upper) +
                  body_of("lower", "box = [0.1, 1, 0.1]", turned(x + std::sin(lower) / 2, y - std::cos(lower) / 2),
                          seventeen_digits(lower_mass)) +
                  orientation(lower) + joint_of("hinge", "upper", "", "[0, 0, 0]", axis) +
                  joint_of("hinge", "upper", "lower", turned(x, y), axis));
}

TEST(Verdict, jointed_bodies_are_held_against_their_equations_of_motion) {
    const struct {
        double upper, lower, mass;
        bool is_turned;
    } cases[] = {{2.0, 2.4, 1, false}, {-2.0, -2.4, 1, false}, {1.0, -0.5, 4, true}, {-1.0, 0.5, 0.25, true}};
    for (const auto& c : cases) {
        for (const Method& method : {verlet_q32, Method{"verlet", "f64", false}}) {
            const SceneDescription fine = double_pendulum(c.upper, c.lower, "1/256", "2.0", c.mass, c.is_turned);
            const Verdict right = verdict_of(fine, method);
            EXPECT_EQ(right.kind, Verdict::Kind::right) << sentence_of(right, fine, method);
            EXPECT_TRUE(right.is_solved);
            EXPECT_EQ(right.rules.size(), 0u);
            EXPECT_LT(right.doubt.largest(), 1e-9);
            // The error is that of order 2: a quarter at half the step.
            const Verdict finer =
                verdict_of(double_pendulum(c.upper, c.lower, "1/512", "2.0", c.mass, c.is_turned), method);
            EXPECT_NEAR(right.error.position_m / finer.error.position_m, 4, 0.5) << right.error.position_m;
        }
    }
}

TEST(Verdict, joints_that_a_method_does_not_follow_are_wrong_and_its_cure_is_right) {
    const Method method{"verlet", "f64", false};
    constexpr double tolerance = 0.01;  // a tenth of that of error_in_parts_of_wrong()
    for (const char* step : {"1/64", "1/100"}) {
        SceneDescription scene = double_pendulum(2.0, 2.4, step, "3.0");
        const Verdict verdict = verdict_of(scene, method, {.tolerance = tolerance});
        ASSERT_EQ(verdict.kind, Verdict::Kind::wrong) << sentence_of(verdict, scene, method);
        ASSERT_TRUE(verdict.cure.has_value()) << sentence_of(verdict, scene, method);
        EXPECT_EQ(verdict.cause, Verdict::Cause::method);  // one of order four holds at this step
        EXPECT_GT(error_in_parts_of_wrong(scene, method), 0.1);
        scene.step = verdict.cure->step;
        EXPECT_LT(error_in_parts_of_wrong(scene, verdict.cure->method), 0.1);
    }
}

// The true motion of a double pendulum multiplies an error by 10^10 in 14 s: nothing holds it against a run after that.
TEST(Verdict, chaotic_joints_have_no_reference_after_some_time) {
    const SceneDescription scene = double_pendulum(2.0, 2.4, "1/256", "20.0");
    const Record truth = solved_record_of(scene, 1e-17, moments_of(scene)).record;
    const Verdict verdict = verdict_of(scene, {"verlet", "f64", false}, truth, {.explains = false});
    ASSERT_EQ(verdict.kind, Verdict::Kind::no_reference);
    EXPECT_GE(verdict.time_s, 11);
    EXPECT_LE(verdict.time_s, 15);
    EXPECT_LT(verdict.error.position_m, 1e-2);
    expect_parts(sentence_of(verdict, scene, verlet_q32),
                 {"right until ", "no reference from there on: two solutions of the equations of motion differ by "});
    // A run is wrong long before.
    const Verdict run = verdict_of(scene, verlet_q32, {.explains = false});
    EXPECT_EQ(run.kind, Verdict::Kind::wrong);
    EXPECT_GT(run.time_s, 3);
    EXPECT_LT(run.time_s, verdict.time_s);
}

TEST(Verdict, blows_and_loads_on_joints_are_judged) {
    const Method method{"verlet", "f64", false};
    SceneDescription scene = double_pendulum(0.5, 0.25, "1/256", "2.0");
    scene.linear_drag = 0.1;
    scene.angular_drag = 0.05;
    scene.bodies[0].velocity = {1, 2, 3};  // across the joints: it ends
    scene.bodies[1].angular_velocity = {1, -2, 1};
    ImpulseDescription blow;
    blow.time = 0.5;
    blow.body = 1;
    blow.impulse = {1, 2, -3};
    blow.point = {0.05, -0.5, 0};
    scene.impulses.push_back(blow);
    ForceDescription force;
    force.body = 0;
    force.from = 1;
    force.until = 1.5;
    force.force = {0, 5, 2};
    force.frame = Frame::body;
    force.point = {0, 0.1, 0.05};
    scene.forces.push_back(force);
    SpringDescription spring;
    spring.body = 1;
    spring.to = {1, 1, 0};
    spring.stiffness = 10;
    spring.damping = 0.5;
    spring.rest_length = 0.5;
    scene.springs.push_back(spring);
    const Verdict verdict = verdict_of(scene, method);
    EXPECT_EQ(verdict.kind, Verdict::Kind::right) << sentence_of(verdict, scene, method);
    EXPECT_LT(verdict.error.largest(), 1e-3);
    // A run without the blow is another motion.
    SceneDescription other = scene;
    other.impulses.clear();
    const Verdict without = verdict_of(scene, method, record_of(other, method, 0, moments_of(scene)));
    EXPECT_EQ(without.kind, Verdict::Kind::wrong);
    EXPECT_GE(without.time_s, 0.5);
    EXPECT_LT(without.time_s, 0.8);
}

// What joints do not allow ends without a gain, and a method that adds energy exceeds the budget.
TEST(Verdict, energy_budget_holds_with_joints) {
    SceneDescription scene = double_pendulum(1.0, 0.5, "1/64", "4.0");
    scene.bodies[0].velocity = {1, 2, 3};
    scene.bodies[1].angular_velocity = {1, -2, 1};
    ImpulseDescription blow;
    blow.time = 1;
    blow.body = 1;
    blow.impulse = {0, 0, 5};  // across both joints: it does no work
    scene.impulses.push_back(blow);
    EXPECT_FALSE(record_of(scene, {"verlet", "f64", false}, 0, moments_of(scene), 0.04).gained.has_value());
    EXPECT_TRUE(record_of(scene, {"explicit_euler", "f64", false}, 0, moments_of(scene), 0.04).gained.has_value());
}

TEST(Verdict, check_of_joints_that_is_too_dear_is_not_made) {
    const SceneDescription scene = double_pendulum(2.0, 2.4, "1/256", "4.0");
    const Record run = record_of(scene, {"verlet", "f64", false}, 0, moments_of(scene));
    const Verdict dear = verdict_of(scene, {"verlet", "f64", false}, run, {.most_seconds = 0.01}),
                  made = verdict_of(scene, {"verlet", "f64", false}, run, {.most_seconds = 10.0});
    EXPECT_EQ(dear.kind, Verdict::Kind::unchecked);
    EXPECT_NE(made.kind, Verdict::Kind::unchecked);
    // The beginning tells roughly what it costs.
    const double cost = solved_record_of(scene, 1e-11, moments_of(scene)).seconds +
                        solved_record_of(scene, 1e-14, moments_of(scene)).seconds;
    EXPECT_GT(dear.cost_s, cost / 3);
    EXPECT_LT(dear.cost_s, cost * 3);
    // So stiff that the integration would take a minute: its beginning tells so.
    SceneDescription stiff = scene;
    SpringDescription spring;
    spring.to = {1, 0, 0};
    spring.stiffness = 1e9;
    stiff.springs.push_back(spring);
    const SolvedRecord beginning = solved_record_of(stiff, 1e-11, moments_of(stiff), 0.05);
    EXPECT_TRUE(beginning.record.moments.empty());
    EXPECT_GT(beginning.seconds, 5);
}

std::vector<std::string> rules_in(const std::string& text) {
    const SceneDescription scene = parsed(text);
    const Verdict verdict = verdict_of(scene, {"verlet", "f64", false}, {.most_references = 1, .explains = false});
    std::vector<std::string> names;
    for (const SharedRule rule : verdict.rules) {
        names.emplace_back(name_of(rule));
        if (verdict.kind == Verdict::Kind::right) {
            EXPECT_TRUE(has(sentence_of(verdict, scene, verlet_q32), names.back()));
        }
    }
    return names;
}

TEST(Verdict, rules_that_the_references_share_are_named_where_a_run_uses_them) {
    using Names = std::vector<std::string>;
    const std::string world = world_of("-9.81", "1/128", "1.0"),
                      rough = "[contact]\nrestitution = 0.0\nfriction = 0.3\n", ice = "[contact]\nrestitution = 0.0\n",
                      rest = body_of("b", "box = [0.2, 0.2, 0.2]", "[0, 0.1, 0]");
    const auto tile = [](const std::string& name, const std::string& place, const std::string& edge = "1.0") {
        return body_of(name, "box = [" + edge + ", 0.4, 2.0]", "[" + place + ", -0.2, 0]") + "fixed = true\n";
    };
    const std::string slides = "velocity = [0.9, 0, 0]\n";
    // Nothing touches; a ball that bounces without friction; a box at rest on ice and on a rough plane.
    EXPECT_EQ(rules_in(world + body_of("b", "sphere = 0.1", "[0, 9, 0]") + floor_plane), Names{});
    EXPECT_EQ(rules_in(world + body_of("b", "sphere = 0.1", "[0, 0.3, 0]") + floor_plane), Names{});
    EXPECT_EQ(rules_in(world + ice + floor_plane + rest), Names{});
    EXPECT_EQ(rules_in(world + rough + floor_plane + rest), Names{"friction"});
    EXPECT_EQ(rules_in(world + ice + "sleep = { time = 0.25 }\n" + floor_plane + rest), Names{"sleep"});
    // A box slides on one tile, stands on a seam, and slides over an edge.
    EXPECT_EQ(rules_in(world + ice + tile("t", "0", "4.0") + rest + slides), Names{});
    EXPECT_EQ(rules_in(world + ice + tile("t", "-0.5") + tile("u", "0.5") + rest), Names{"seams"});
    EXPECT_EQ(rules_in(world + ice + tile("t", "-0.3") + rest + slides), Names{"edges"});
    // Side by side is no seam for what touches one of them.
    EXPECT_EQ(rules_in(world + ice + tile("t", "0") + tile("u", "1") + rest), Names{});
    EXPECT_EQ(rules_in(world + ice + floor_plane + body_of("b", "box = [0.2, 0.2, 0.2]", "[0, 0.08, 0]")),
              Names{"overlap"});
}

// A mass stands on a spring that gravity presses, along a direction that no numbers hold. It falls to the side that
// rounding takes, and by a finer rounding only later: no numbers are right for a mass that begins a hair beside.
TEST(Verdict, cure_that_a_rounding_decides_is_none) {
    int wrong = 0;
    for (const auto& [x, y] : {std::pair{0.6, 0.8}, {0.28, 0.96}})
        for (const char* numbers : {"q32", "f32"}) {
            const auto along = [x = x, y = y](double length) {
                return "[" + seventeen_digits(x * length) + ", " + seventeen_digits(y * length) + ", 0.0]";
            };
            const Method method{"rk4", numbers, true};
            const SceneDescription scene =
                parsed("[world]\nstep = \"1/128\"\nduration = 7.0\ngravity = " + along(-10) +
                       "\n[contact]\nresponse = \"none\"\n" + body_of("bob", "sphere = 0.1", along(0.9)) +
                       body_of("far", "sphere = 0.1", "[0, 0, 20]") + "velocity = [0, 0, 1]\n" +
                       "[[spring]]\nbody = \"bob\"\nto = [0, 0, 0]\nstiffness = 100.0\nrest_length = 1.0\n");
            const Verdict verdict = verdict_of(scene, method);
            if (verdict.kind != Verdict::Kind::wrong) continue;
            ++wrong;
            EXPECT_FALSE(verdict.cure.has_value()) << sentence_of(verdict, scene, method);
            EXPECT_TRUE(has(sentence_of(verdict, scene, method), "; no way was found that is known to be right"));
            EXPECT_EQ(verdict.cause, Verdict::Cause::none);
        }
    EXPECT_GT(wrong, 0);
}

// A box that slides down a ramp of flush tiles by Coulomb's law, from its place and from a hair beside it.
class SlideOverTiles : public testing::TestWithParam<unsigned> {};

TEST_P(SlideOverTiles, follows_coulombs_law_and_is_judged_right) {
    std::mt19937 random(GetParam());
    const auto from = [&](double least, double most) { return std::uniform_real_distribution(least, most)(random); };
    const double angle = from(0.52, 0.7), friction = from(0.1, 0.35), edge = from(0.4, 1.2), height = from(0.05, 0.2),
                 side = random() % 2 == 0 ? 1 : -1, start = from(0.2, 0.4) * edge;
    const auto at = [&](double along, double above) {
        return "[" + seventeen_digits(side * (along * std::cos(angle) + above * std::sin(angle))) + ", " +
               seventeen_digits(above * std::cos(angle) - along * std::sin(angle)) + ", 0.3]";
    };
    const std::string turned = "orientation = [" + seventeen_digits(std::cos(angle / 2)) + ", 0, 0, " +
                               seventeen_digits(-side * std::sin(angle / 2)) + "]\n";
    std::string text = world_of("-9.81", random() % 2 == 0 ? "1/256" : "1/128", "0.75") +
                       "[contact]\nrestitution = 0.0\nfriction = " + seventeen_digits(friction) + "\n";
    for (int i = 0; i * edge < 4; ++i)
        text += body_of("tile" + std::to_string(i), "box = [" + seventeen_digits(edge) + ", 0.4, 2.0]",
                        at((i + 0.5) * edge, -0.2)) +
                turned + "fixed = true\n";
    text += body_of("b", "box = [0.2, " + seventeen_digits(height) + ", 0.3]", at(start, height / 2)) + turned;
    SceneDescription scene = parsed(text);
    const Method method{"verlet", random() % 2 == 0 ? "q32" : "f32", true};
    const Verdict verdict = verdict_of(scene, method);
    EXPECT_EQ(name_of(verdict.kind), std::string("right")) << sentence_of(verdict, scene, method) << text;
    EXPECT_FALSE(verdict.cure.has_value());
    const double way = 9.81 * (std::sin(angle) - friction * std::cos(angle)) / 2 * 0.75 * 0.75;
    const Triple begin = scene.bodies.back().position;
    for (const double beside : {-2e-4, 0.0, 2e-4}) {
        scene.bodies.back().position = {begin[0] + side * std::sin(angle) * beside, begin[1] + std::cos(angle) * beside,
                                        begin[2]};
        const auto run = make_simulation(scene, method.integrator, method.numbers, method.carry);
        (void)finish(*run);
        const auto end = run->body(run->body_count() - 1).position;
        const auto along =
            static_cast<double>(side * (end[0] - begin[0]) * std::cos(angle) - (end[1] - begin[1]) * std::sin(angle));
        EXPECT_NEAR(along, way, 0.01 * way + 1e-3) << beside << text;
    }
}
INSTANTIATE_TEST_SUITE_P(Quick, SlideOverTiles, testing::Range(0U, 3U));
INSTANTIATE_TEST_SUITE_P(Deep, SlideOverTiles, testing::Range(3U, 203U));

std::string message(const SceneDescription& scene, const Method& method, const HeldNumber& number) {
    const auto simulation = make_simulation(scene, method.integrator, method.numbers, method.carry);
    const Trouble trouble{"range_left", 0, 3, number};
    return message_of(trouble, trouble, scene, *simulation);
}

TEST(Messages, a_number_that_left_its_range_has_a_cure_that_can_help) {
    SceneDescription scene = parsed(R"(
world = { step = "1/256", duration = 1.0 }
body = [ { name = "die", shape = { box = [0.1, 0.1, 0.1] }, mass = 1.0 } ]
)");
    const HeldNumber spin{"angular velocity", 64, "rad/s"};
    EXPECT_TRUE(message(scene, verlet_q32, spin)
                    .ends_with("Use a larger [range] angular_velocity and a smaller step, or --numbers f32"));
    EXPECT_TRUE(
        message(scene, verlet_q32, {"change of velocity in a step", 32, "m/s", false, 16})
            .ends_with("or change of spin in a step exceeds 16 rad/s, the most that q32 room holds at a step of "
                       "0.00390625 s. The motion is wrong from here on. Use a smaller step or a larger [range] "
                       "velocity"));
    scene.range.is_declared = true;
    EXPECT_TRUE(message(scene, verlet_q32, spin).ends_with("Use a larger [range] angular_velocity and a smaller step"));
    const std::pair<const char*, const char*> keys[] = {
        {"position", "position"}, {"velocity", "velocity"}, {"angular velocity", "angular_velocity"}};
    for (const auto& [name, key] : keys)
        for (const Method& method : {Method{"verlet", "f32", true}, {"verlet", "f64", false}})
            EXPECT_TRUE(
                message(scene, method, {name, 64, "", true})
                    .ends_with("A run in q32 would be wrong from here on. Use a larger [range] " + std::string(key)));
}

TEST(Verdict, a_run_that_is_wrong_before_its_status_speaks_is_called_wrong) {
    const SceneDescription scene = read_scene(shipped("pendulum"));
    const Method euler{"explicit_euler", "f64", false};
    const Record run = record_of(scene, euler, 0, moments_of(scene));
    ASSERT_FALSE(run.troubles.empty());
    const Verdict verdict = verdict_of(scene, euler, run);
    EXPECT_EQ(verdict.kind, Verdict::Kind::wrong);
    EXPECT_LT(verdict.time_s, told_by(run, scene).time_s);
    EXPECT_TRUE(has(sentence_of(verdict, scene, euler), "; the status reports " + run.troubles.front().issue));
    // Until its status speaks, a longer step of another method is right.
    Record right = record_of(scene, {"rk4", "f64", false}, 0, moments_of(scene));
    right.troubles = run.troubles;
    EXPECT_EQ(verdict_of(scene, euler, right).kind, Verdict::Kind::told);
}

TEST(Verdict, search_for_a_cure_compiles_nothing) {
    const SceneDescription scene = read_scene(shipped("pendulum"));
    const auto compiled = [&] {
        std::vector<bool> all;
        for (const NumberSystemInfo& system : number_systems())
            for (const IntegratorInfo& method : integrators())
                all.push_back(is_compiled(scene, method.name, system.name, system.carry));
        return all;
    };
    const Method euler{"semi_implicit_euler", "f64", false};
    const Record run = record_of(scene, euler, 0, moments_of(scene));
    (void)verdict_of(scene, euler, run, {.explains = false});
    const std::vector<bool> before = compiled();
    for (const Method& method :
         {euler, Method{"semi_implicit_euler", "f32", false}, Method{"semi_implicit_euler", "q32", false}})
        (void)verdict_of(scene, method, run, {.tolerance = 1e-12});
    EXPECT_EQ(compiled(), before);
}

TEST(Messages, a_step_that_is_too_long_for_a_spin_has_one_that_holds_it) {
    // Verlet keeps the momentum. That of a disc about its axis is twice the spin times the middle moment.
    struct Spinning {
        const char* shape;
        double most;  // rad/s, in a step of 1/16 s
        std::int64_t steps_per_second;
    };
    for (const Spinning& spinning : {Spinning{"sphere = 0.1", 48, 64}, {"box = [1, 1, 0.01]", 24, 128}}) {
        SceneDescription scene = parsed("world = { step = \"1/16\", duration = 1.0 }\n" +
                                        body_of("body", spinning.shape) + "angular_velocity = [0, 0, 150]\n");
        const auto simulation = make_simulation(scene, "verlet", "f64", false);
        simulation->step();
        ASSERT_TRUE(simulation->has_trouble("range_left")) << spinning.shape;
        const Trouble& trouble = simulation->troubles().front();
        EXPECT_NEAR(trouble.number.value().most, spinning.most, 0.01) << spinning.shape;
        const std::string message = message_of(trouble, trouble, scene, *simulation);
        EXPECT_TRUE(message.ends_with("Use --step 1/" + std::to_string(spinning.steps_per_second))) << message;
        scene.step = {1, spinning.steps_per_second, 0};
        const auto held = make_simulation(scene, "verlet", "f64", false);
        held->step();
        EXPECT_FALSE(held->has_trouble("range_left")) << spinning.shape;
    }
}

TEST(Messages, a_load_that_is_too_strong_is_one_of_the_scene) {
    const std::string body = R"(
world = { step = 0.5, duration = 1.0, linear_drag = 9.0 }
body = [ { name = "bob", shape = { sphere = 0.1 }, mass = 0.1, position = [1, 0, 0] } ]
)";
    const auto said_of = [](const std::string& text) {
        const SceneDescription scene = parsed(text);
        const auto simulation = make_simulation(scene, "verlet", "f64", false);
        const Trouble& trouble = simulation->troubles().at(0);
        return message_of(trouble, trouble, scene, *simulation);
    };
    EXPECT_TRUE(has(said_of(body), "step_too_long: drag is too strong"));
    EXPECT_TRUE(has(said_of(body + R"(spring = [ { body = "bob", to = [0, 0, 0], stiffness = 4e3, damping = 1.0 } ])"),
                    "step_too_long: a spring, a damper or drag is too strong"));
}

TEST(Messages, one_cause_has_one_cure) {
    const SceneDescription scene = read_scene(shipped("brick"));
    const auto simulation = make_simulation(scene, "verlet", "q32", true);
    const Trouble first{"step_too_long", 0, 0}, second{"range_left", 0, 8, HeldNumber{"velocity", 256, "m/s"}};
    for (const std::string cure : {"", "--step 1/512"}) {
        EXPECT_NE(message_of(first, first, scene, *simulation, cure).find("Use "), std::string::npos);
        EXPECT_EQ(message_of(second, first, scene, *simulation, cure).find("Use "), std::string::npos);
    }
    EXPECT_NE(message_of(second, second, scene, *simulation).find("Use "), std::string::npos);
}

TEST(VerdictOfRun, told_run_has_one_message) {
    for (const char* stiffness : {"10000.0", "4000.0"}) {
        const std::string scene = world_of("0", "0.5", "20.0") + body_of("bob", "sphere = 0.1", "[1, 0, 0]", "0.1") +
                                  "[[spring]]\nbody = \"bob\"\nto = [0, 0, 0]\nstiffness = " + stiffness + "\n";
        const std::string path = written("spring.toml", scene);
        const std::string text = text_of({"run", path, "--numbers", "f64", "--check", "on"}, 1);
        expect_parts(text, {"step_too_long"});
        EXPECT_FALSE(has(text, "as large as the motion")) << text;
    }
}

// The check of this run takes much longer than the second at which the shell ends it.
TEST(VerdictOfRun, a_check_that_is_ended_loses_nothing_of_the_run) {
    const std::string limited = R"(ulimit -t 1; exec "$0" run "$1" --duration 10 --numbers f64 --check on)";
    Process process({"sh", "-c", limited, TUMBLE_COMMAND, shipped("contacts/spheres")}, {}, Process::Errors::keep);
    std::string table;
    EXPECT_NE(process.wait(&table), 0);
    EXPECT_TRUE(has(table, "\nstate  ")) << table;
    EXPECT_FALSE(has(table, "verdict: ")) << table;
}

TEST(VerdictOfRun, is_one_line_and_off_is_none) {
    expect_outcome(tumble({"run", shipped("brick"), "--check", "on"}, Process::Errors::keep), 0,
                   "\nverdict: right: the error is at most ");
    const std::string off = text_of({"run", shipped("brick"), "--check", "off"});
    EXPECT_FALSE(has(off, "verdict")) << off;
}

TEST(VerdictOfRun, json_has_every_key) {
    const auto verdict_of_run = [](const std::vector<std::string>& options) {
        return Json::parse(tumble(with({"run", shipped("pendulum"), "--json"}, options), Process::Errors::keep).text)
            .at("verdict");
    };
    const auto wrong = verdict_of_run({"--check", "on"});
    EXPECT_EQ(wrong.at("kind"), "wrong");
    EXPECT_EQ(wrong.at("body"), "bob");
    EXPECT_EQ(wrong.at("cause"), "method");
    EXPECT_EQ(wrong.at("cure"), "--integrator rk4");
    EXPECT_GT(wrong.at("error_rad"), 0.1);
    EXPECT_GT(wrong.at("time_s"), 0);
    EXPECT_GT(wrong.at("error_m"), 0);
    const auto unchecked = verdict_of_run({"--check", "off"});
    EXPECT_EQ(unchecked.at("kind"), "unchecked");
    for (const char* key : {"time_s", "body", "error_m", "error_rad", "cause", "cure"})
        EXPECT_TRUE(unchecked.at(key).is_null()) << key;
}

TEST(VerdictOfRun, error_as_large_as_the_motion_is_a_failure_and_a_smaller_one_is_not) {
    expect_outcome(tumble({"run", shipped("pendulum"), "--check", "on"}), 0);
    expect_outcome(tumble({"run", shipped("oscillators"), "--integrator", "explicit_euler", "--numbers", "f64",
                           "--duration", "20", "--check", "on"}),
                   1, "The error is as large as the motion");
}

}  // namespace
}  // namespace tumble::host
