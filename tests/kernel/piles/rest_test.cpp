// What rests and what does not: slow bodies that slide, tip or drift stay awake, what rests falls asleep, overlapping
// bodies come apart without momentum, and tall stacks stand at long steps.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

class Rest : public CaseTest {
protected:
    // m/s and rad/s that rounding leaves to bodies of a metre.
    static Number rounding() { return system().bits == 64 ? 1e-9L : 1e-5L; }
};
INSTANTIATE_TEST_SUITE_P(every, Rest, testing::ValuesIn(contact_cases()), NameOf{});

constexpr Number degree = pi / 180;

bool sleeps(const AnyWorld& world) {
    for (int b = 0; b < world.body_count(); ++b)
        if (!world.asleep(b)) return false;
    return true;
}
// A sleepy scene without gravity and planes.
SceneSetup sleepy_space(std::vector<BodySpec> bodies) {
    SceneSetup setup = space(0, 0, std::move(bodies));
    setup.world.contact.sleep.on = true;
    return setup;
}
// Boxes on each other, the lowest `depth` (m) below the floor and each other one below the top of the next. `turn` is
// about the vertical, rad.
SceneSetup tower(int count, Number mass, Vector edges, Number turn = 0, Number depth = 0) {
    SceneSetup setup = sleepy_floor();
    for (int i = 0; i < count; ++i) {
        BodySpec body = placed(box(real(mass), real(edges)), {0, (edges.y - depth) * (i + 0.5L) - depth / 2, 0});
        setup.bodies.push_back(oriented(body, {real(std::cos(turn / 2)), {0, real(std::sin(turn / 2)), 0}}));
    }
    return setup;
}

// --- sleep -------------------------------------------------------------------------------------------------------

// It moves by g sin(tilt) t^2 / 2. For the sleep time of 0.5 s it is slower than the sleep speed.
TEST_P(Rest, a_box_slides_down_slightly_tilted_ice_and_does_not_sleep) {
    for (const Number tilt : {0.3L, 0.1L}) {
        for (const Number heading : {0.0L, 2.0L, -1.0L}) {
            for (const auto& [mass, rate] : {std::pair{1.0L, 256}, {300.0L, 64}}) {
                SceneSetup setup = sleepy_floor(0, {placed(box(real(mass), {0.5, 0.25, 0.5}), {0, 0.125L, 0})});
                setup.step = Seconds{1, rate};
                const Number along = g * std::sin(tilt * degree);
                const Vector down{std::cos(heading), 0, std::sin(heading)};
                setup.world.gravity = real(down * along - Vector{0, g * std::cos(tilt * degree), 0});
                const auto world = run(setup, 4 * rate);
                EXPECT_FALSE(world->asleep(0)) << tilt << " degrees";
                EXPECT_LE(norm(world->motion(0).v - down * (along * 4)), 1e-3L * along * 4) << tilt << " degrees";
            }
        }
    }
}

TEST_P(Rest, a_box_that_overhangs_tips_over_and_one_that_does_not_falls_asleep) {
    for (const Number overhang : {0.27L, 0.255L, 0.24L}) {
        for (const Number side : {1.0L, -1.0L}) {
            SceneSetup setup = sleepy_floor(0.5L);
            setup.planes.clear();
            setup.world.gravity = {0, -0.02, 0};
            setup.bodies = {fixed(placed(box(1, {2, 0.5, 2}), {side * -1, -0.25L, 0})),
                            placed(box(3, {0.5, 0.2, 0.5}), {side * (overhang - 0.25L), 0.1L, 0})};
            const auto world = run(setup, 10 * second);
            const bool tips = overhang > 0.25L;
            EXPECT_EQ(world->asleep(1), !tips) << overhang;
            if (tips) { EXPECT_GT(std::abs(world->motion(1).w.z), 0.02L) << overhang; }
        }
    }
}

TEST_P(Rest, bodies_that_touch_and_drift_through_empty_space_never_sleep) {
    for (const Vector along : {Vector{1, 0, 0}, {0, -1, 0}, {0.6L, 0, 0.8L}}) {
        for (const Number mass : {1.0L, 5.0L}) {
            const auto world = run(sleepy_space({placed(sphere(1, 0.1), along * -1, along * 0.025L * (1 + mass)),
                                                 placed(sphere(real(mass), 0.1), along * -0.8L)}),
                                   8 * second);
            for (int b = 0; b < 2; ++b) {
                EXPECT_FALSE(world->asleep(b));
                EXPECT_LE(norm(world->motion(b).v - along * 0.025L), 1e-6L) << mass;
            }
        }
    }
}

// A force holds the box on the floor. The two balls drift past it without touching it, in the same island.
TEST_P(Rest, bodies_that_drift_past_a_body_at_rest_do_not_stop) {
    SceneSetup setup = sleepy_space({placed(box(2, {1, 0.5, 1}), {0, 0.25L, 0}),
                                     placed(sphere(1, 0.1), {0.1L, 0.6012L, 0}, {0.02L, 0, 0}),
                                     placed(sphere(1, 0.1), {-0.1L, 0.6012L, 0}, {0.02L, 0, 0})});
    setup.planes = {{}};
    setup.forces = {{.body = 0, .from = 0, .until = 100, .force = {0, -20, 0}}};
    const auto world = run(setup, 4 * second);
    for (int b = 1; b < 3; ++b) {
        EXPECT_FALSE(world->asleep(b));
        EXPECT_LE(norm(world->motion(b).v - Vector{0.02L, 0, 0}), 1e-6L);
    }
}

TEST_P(Rest, what_rests_falls_asleep_within_a_second_whatever_the_masses) {
    for (const Number mass : {0.001L, 1.0L, 1000.0L}) {
        for (const Number ratio : {0.0001L, 0.01L, 1.0L, 10.0L, 100.0L}) {
            SceneSetup setup = sleepy_floor();
            setup.bodies = {placed(box(real(mass), {0.5, 0.5, 0.5}), {0, 0.25L, 0}),
                            placed(box(real(mass * ratio), {0.25, 0.25, 0.25}), {0.0625L, 0.625L, 0.03125L}),
                            placed(sphere(real(mass), 0.25), {2, 0.25L, 0})};
            const auto world = run(setup, second);
            EXPECT_TRUE(sleeps(*world)) << mass << " kg, ratio " << ratio;
            EXPECT_LE(farthest_from_start(*world, setup), 0.001L) << mass << " kg, ratio " << ratio;
        }
    }
}

// --- overlaps ----------------------------------------------------------------------------------------------------

TEST_P(Rest, overlapping_balls_without_gravity_come_apart_without_momentum) {
    for (const Vector along : {Vector{1, 0, 0}, {0, -0.6L, 0.8L}}) {
        for (const Number ratio : {1.0L, 100.0L, 0.125L}) {
            for (const Vector drift : {Vector{}, {0.25L, 0.125L, 0}}) {
                const auto world = run(space(0, 0,
                                             {placed(sphere(1, 0.25), {}, drift),
                                              placed(sphere(real(ratio), 0.25), along * 0.45L, drift)}),
                                       4 * second);
                const Motion a = world->motion(0), b = world->motion(1);
                EXPECT_GE(norm(a.x - b.x), 0.499L) << ratio;
                EXPECT_LE(norm(a.x - b.x), 0.5L) << ratio;
                EXPECT_LE(norm(a.v - drift) + norm(b.v - drift), 1e-6L) << ratio;
                // The centre of mass goes on as it did.
                const Vector centre = (a.x + b.x * ratio) * (1 / (1 + ratio)),
                             start = along * (0.45L * ratio / (1 + ratio));
                EXPECT_LE(norm(centre - start - drift * 4), 1e-5L) << ratio;
            }
        }
    }
}

TEST_P(Rest, overlapping_boxes_without_gravity_come_apart_without_momentum) {
    for (const Number friction : {0.0L, 0.5L}) {
        for (const Vector place : {Vector{0.45L, 0.1L, 0.05L}, {-0.05L, 0.1L, -0.46L}}) {
            const auto world =
                run(space(0, friction, {placed(box(1, {0.5, 0.5, 0.5}), {}), placed(box(3, {0.5, 0.5, 0.5}), place)}),
                    4 * second);
            const Vector apart = world->motion(0).x - world->motion(1).x;
            EXPECT_GE(std::max(std::abs(apart.x), std::abs(apart.z)), 0.497L);
            for (int b = 0; b < 2; ++b)
                EXPECT_LE(norm(world->motion(b).v) + norm(world->motion(b).w), rounding()) << friction;
        }
    }
}

TEST_P(Rest, a_box_in_the_floor_rises_without_speed) {
    for (const bool falls : {false, true}) {
        for (const Number depth : {0.05L, 0.002L}) {
            SceneSetup setup = floor(0, 0.5L, {placed(box(2, {0.5, 0.5, 0.5}), {0, 0.25L - depth, 0})});
            if (!falls) setup.world.gravity = {};
            const auto world = build(setup, GetParam());
            for (int step = 0; step < 3 * second; ++step) {
                world->step();
                ASSERT_LE(norm(world->motion(0).v), rounding()) << depth << " m, step " << step;
            }
            EXPECT_LE(std::abs(world->motion(0).x.y - 0.25L), 0.0003L) << depth;
        }
    }
}

TEST_P(Rest, a_stack_of_overlapping_boxes_comes_apart_and_stands) {
    for (const auto& [exact_bodies, left] : {std::pair{ContactSpec::any, 0.0003L}, {ContactSpec::few, 0.0005L}}) {
        for (const Number depth : {0.01L, 0.003L}) {
            SceneSetup setup = tower(5, 2, {0.3L, 0.2L, 0.3L}, 0.5L, depth);
            setup.world.contact.exact_bodies = exact_bodies;
            const auto world = run(setup, 4 * second);
            for (int b = 0; b < 5; ++b) {
                const Vector x = world->motion(b).x;
                EXPECT_LE(std::abs(x.y - 0.2L * (b + 0.5L)), left * (b + 1)) << b;
                EXPECT_LE(std::hypot(x.x, x.z), 0.002L) << b;
            }
            EXPECT_TRUE(sleeps(*world)) << depth;
            EXPECT_TRUE(world->status().ok());
        }
    }
}

// Nothing moves when the last overlap is gone.
TEST_P(Rest, what_overlapped_falls_asleep_on_a_slope_too) {
    for (const Number depth : {0.001L, 0.005L}) {
        for (const auto& [count, rate, slope] : {std::tuple{1, 256, 0.2L}, {2, 60, -0.2L}, {5, 256, 0.15L}}) {
            SceneSetup setup = tower(count, 2, {0.5L, 0.3L, 0.5L}, 0, depth);
            setup.step = Seconds{1, rate};
            setup.world.gravity = real(Vector{g * std::sin(slope), -g * std::cos(slope), 0});
            const auto world = run(setup, 4 * rate);
            EXPECT_TRUE(sleeps(*world)) << count << " boxes, " << depth << " m deep";
            EXPECT_TRUE(world->status().ok());
        }
    }
}

// Each stands 0.05 m further out than the one below, and the stack topples. No warm start helps to push it apart.
TEST_P(Rest, a_tall_stack_that_overlaps_comes_apart) {
    for (const auto& [exact_bodies, left] : {std::pair{ContactSpec::any, 0.0006L}, {ContactSpec::few, 0.001L}}) {
        SceneSetup setup = tower(12, 2, {0.5L, 0.3L, 0.5L}, 0, 0.003L);
        setup.world.contact.exact_bodies = exact_bodies;
        for (int b = 0; b < 12; ++b) setup.bodies[static_cast<std::size_t>(b)].position.x = real(0.05L * b);
        const auto world = run(setup, 76);
        for (int b = 1; b < 12; ++b) {
            const Motion m = world->motion(b);
            const Vector apart = m.q.normalized().rotate_back(m.x - world->motion(b - 1).x);
            EXPECT_GE(apart.y, 0.3L - left) << b;
        }
        EXPECT_TRUE(world->status().ok());
    }
}

// Once apart, they would sink into the floor again if the heavy box pressed the light one down.
TEST_P(Rest, a_heavy_box_that_overlaps_a_light_one_is_lifted_too) {
    for (const Number ratio : {10.0L, 50.0L}) {
        const SceneSetup setup = floor(0, 0.5L,
                                       {placed(box(1, {0.5, 0.5, 0.5}), {0, 0.24L, 0}),
                                        placed(box(real(ratio), {0.5, 0.5, 0.5}), {0.02L, 0.73L, 0})});
        const auto world = run(setup, 4 * second);
        EXPECT_LE(std::abs(world->motion(0).x.y - 0.25L), 0.002L) << ratio;
        EXPECT_LE(std::abs(world->motion(1).x.y - 0.75L), 0.002L) << ratio;
    }
}

TEST_P(Rest, a_box_squeezed_between_walls_stays_where_it_is) {
    for (const Number mass : {1.0L, 40.0L}) {
        SceneSetup setup = floor(0, 0.5L, {placed(box(real(mass), {0.5, 0.5, 0.5}), {0, 0.25L, 0})});
        setup.planes.push_back({.normal = {1, 0, 0}, .offset = 0.24});
        setup.planes.push_back({.normal = {-1, 0, 0}, .offset = 0.24});
        const auto world = run(setup, 2 * second);
        EXPECT_LE(farthest_from_start(*world, setup), 0.001L);
        EXPECT_LE(norm(world->motion(0).v) + norm(world->motion(0).w), rounding());
    }
}

// In a step, an eighth of the penetration beyond a quarter of the tolerance, at most an eighth of the tolerance.
TEST_P(Rest, a_deep_penetration_is_corrected_as_slowly_as_promised) {
    for (const Number depth : {0.0625L, 0.0009765625L}) {
        for (const bool boxed : {false, true}) {
            const BodySpec body = boxed ? box(2, {1, 1, 1}) : sphere(2, 0.5);
            const auto world = build(floor(0.5L, 0, {placed(body, {0, 0.5L - depth, 0})}), GetParam());
            Number before = depth;
            for (int step = 0; step < 64; ++step) {
                world->step();
                const Number now = 0.5L - world->motion(0).x.y;
                const Number excess = before - tolerance::contact_band / 4;
                const Number most = std::min(excess > 0 ? excess / 8 : Number(0), tolerance::contact_band / 8);
                ASSERT_LE(before - now - 1.25L * most, tolerance::still) << "from " << depth << " m, step " << step;
                // An excess below 1/256 of the tolerance stays.
                if (excess > tolerance::contact_band / 250) {
                    ASSERT_LE(0.75L * most - (before - now), tolerance::still)
                        << "from " << depth << " m, step " << step;
                }
                before = now;
            }
        }
    }
}

// --- tall stacks -------------------------------------------------------------------------------------------------

// In a step at 1/60 s gravity falls by 2.7 mm, which is more than the tolerance.
TEST_P(Rest, a_tall_stack_stands_at_a_long_step) {
    struct Stack {
        int count, rate;
        Number mass, turn;
        Vector edges;
    };
    const Stack stacks[] = {{10, 60, 1, 0, {0.3L, 0.2L, 0.3L}},
                            {10, 50, 7.3L, 0.7L, {0.3L, 0.2L, 0.3L}},
                            {12, 75, 0.02L, -1.1L, {0.75L, 0.5L, 0.75L}},
                            {8, 50, 0.02L, -1.1L, {0.12L, 0.08L, 0.12L}}};
    for (const Stack& stack : stacks) {
        SceneSetup setup = tower(stack.count, stack.mass, stack.edges, stack.turn);
        setup.step = Seconds{1, stack.rate};
        const auto world = run(setup, 5 * stack.rate);
        EXPECT_LE(farthest_from_start(*world, setup), 0.005L) << stack.count << " boxes at 1/" << stack.rate << " s";
        for (int b = 0; b < stack.count; ++b)
            EXPECT_LE(norm(world->motion(b).v), 0.005L) << stack.count << " boxes at 1/" << stack.rate << " s";
        EXPECT_TRUE(world->status().ok()) << stack.count << " boxes at 1/" << stack.rate << " s";
    }
}

// On five light boxes a plank has more supports than statics take, so sweeps find the forces. They carry ten times the
// mass of a box. A mass of 10^4 boxes presses them into the floor, and the status says so. In double they carry it.
// In exact steps the status says within the first steps that the boxes do not carry it. In bounded ones it says so
// where they have sunk by 16 tolerances.
TEST_P(Rest, a_body_too_heavy_for_those_below_it_is_told) {
    for (const int exact_bodies : {ContactSpec::any, ContactSpec::few}) {
        const bool exact = exact_bodies == ContactSpec::any;
        for (const Number ratio : {1.0L, 10.0L, 1e4L}) {
            for (const auto& [mass, rate, heading] :
                 {std::tuple{1.0L, 60, 0.0L}, {0.02L, 256, 0.9L}, {30.0L, 128, -2.0L}}) {
                const Vector along{std::cos(heading), 0, std::sin(heading)};
                const Quaternion<Real> turned{real(std::cos(heading / 2)), {0, real(-std::sin(heading / 2)), 0}};
                SceneSetup setup = floor(0, 0.5L);
                setup.world.contact.exact_bodies = exact_bodies;
                setup.step = Seconds{1, rate};
                for (const Number side : {-0.6L, -0.3L, 0.0L, 0.3L, 0.6L})
                    setup.bodies.push_back(
                        oriented(placed(box(real(mass), {0.2, 0.5, 0.5}), along * side + Vector{0, 0.25L, 0}), turned));
                setup.bodies.push_back(
                    oriented(placed(box(real(mass * ratio), {1.5, 0.2, 0.5}), {0, 0.6L, 0}), turned));
                const bool holds = ratio < 100;
                const auto world = run(setup, !holds && system().bits < 64 ? rate / 8 : rate / 2);
                const bool told = world->status().has(exact ? Issue::step_bound_hit : Issue::left_over);
                if (holds || (exact && system().bits < 64)) {
                    EXPECT_EQ(told, !holds) << ratio << " at 1/" << rate << " s";
                }
                if (told) continue;
                EXPECT_LE(farthest_from_start(*world, setup), holds || exact ? 0.001L : 0.016L)
                    << ratio << " at 1/" << rate << " s";
            }
        }
    }
}

// In exact steps sweeps end before the points of the faces agree, and what they leave turns the boxes: the stack walks
// off sideways, although it is its own mirror image. In shorter steps, and in double, they are done in time. In bounded
// steps faces are solved at once.
TEST_P(Rest, a_stack_that_is_set_down_stays_on_its_axis_or_is_told) {
    for (const int exact_bodies : {ContactSpec::any, ContactSpec::few}) {
        for (const bool turned : {false, true}) {
            for (const int rate : {60, 256}) {
                SceneSetup setup = floor(0, 0.5L);
                setup.world.contact.exact_bodies = exact_bodies;
                setup.step = Seconds{1, rate};
                for (int i = 0; i < 8; ++i)
                    setup.bodies.push_back(placed(box(1, turned ? RealVec3{0.3, 0.2, 0.4} : RealVec3{0.4, 0.2, 0.3}),
                                                  {0, 0.1L + 0.001L + 0.201L * i, 0}));
                const auto world = run(setup, 2 * rate);
                Number aside = 0;
                for (int b = 0; b < world->body_count(); ++b)
                    aside = std::max(aside, std::hypot(world->motion(b).x.x, world->motion(b).x.z));
                if (exact_bodies == ContactSpec::few) {
                    EXPECT_LE(aside, system().bits == 64 ? 1e-12L : 1e-7L) << "1/" << rate << " s";
                }
                const bool told = world->status().has(Issue::step_bound_hit);
                EXPECT_TRUE(told || aside < 0.001L)
                    << "1/" << rate << " s, " << static_cast<double>(aside) << " m aside";
                if (rate == 256) { EXPECT_TRUE(world->status().ok()); }
            }
        }
    }
}

TEST_P(Rest, piles_of_equal_boxes_are_no_alarm) {
    for (const int rate : {60, 256}) {
        for (const Number friction : {0.3L, 0.6L}) {
            SceneSetup pyramid = floor(0, friction);
            pyramid.step = Seconds{1, rate};
            for (int row = 0; row < 4; ++row)
                for (int i = 0; i < 4 - row; ++i)
                    pyramid.bodies.push_back(
                        placed(box(2, {0.3, 0.2, 0.3}), {0.32L * (i + row * 0.5L), 0.2L * (row + 0.5L), 0}));
            EXPECT_TRUE(run(pyramid, rate / 2)->status().ok()) << "pyramid at 1/" << rate << " s";
            // Askew, it lands in pieces.
            SceneSetup stack = floor(0, friction);
            stack.step = Seconds{1, rate};
            for (int i = 0; i < 6; ++i)
                stack.bodies.push_back(placed(box(1, {0.3, 0.2, 0.3}),
                                              {0.02L * (i * 7 % 3 - 1), 0.11L + 0.21L * i, 0.02L * (i * 5 % 3 - 1)}));
            EXPECT_TRUE(run(stack, rate / 2)->status().ok()) << "stack at 1/" << rate << " s";
        }
    }
}

}  // namespace
}  // namespace tumble::test
