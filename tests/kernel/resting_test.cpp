// Bodies that rest, slide, roll and sleep: stacks, inclines, a bowling ball, cylinders, turntables, and what wakes
// whom.
#include "contact_cases.hpp"

#include <utility>

namespace tumble::test {
namespace {

// An incline of tan = 3/4 that falls towards -x, and how a body stands on it at the origin.
const Vector uphill{0.8L, 0.6L, 0}, off_incline{-0.6L, 0.8L, 0};
constexpr Number slope_sine = 0.6L, slope_cosine = 0.8L;
SceneSetup incline(Number friction, std::vector<BodySpec> bodies = {}) {
    SceneSetup setup = floor(0, friction, std::move(bodies));
    setup.planes[0].normal = {-3, 4, 0};
    return setup;
}
BodySpec on_incline(const BodySpec& body, Number height) {
    return oriented(placed(body, off_incline * height), {3, {0, 0, 1}});
}
BodySpec standing(const BodySpec& body, Number x, Number height, Vector velocity = {}, Vector spin = {}) {
    return placed(body, {x, height, 0}, velocity, spin);
}
// Body z upwards.
constexpr RealQuat upright{1, {-1, 0, 0}};

class Resting : public CaseTest {
protected:
    // Whether nothing of the body moves by more than `still` for 100 steps.
    static void expect_still(AnyWorld& world, int body) {
        const Motion start = world.motion(body);
        for (int step = 0; step < 100; ++step) {
            world.step();
            const Motion m = world.motion(body);
            ASSERT_LE(norm(m.x - start.x), tolerance::still) << "body " << body << ", step " << step;
            ASSERT_LE(angle_between(m.q, start.q), tolerance::still) << "body " << body << ", step " << step;
        }
    }
};
INSTANTIATE_TEST_SUITE_P(every, Resting, testing::ValuesIn(contact_cases()), NameOf{});

// --- stacks ------------------------------------------------------------------------------------------------------

// Ten boxes of a metre, every second one shifted to a side.
SceneSetup stack(bool sleep, Number shift = 0) {
    SceneSetup setup = sleep ? sleepy_floor() : floor(0, 0.5L);
    for (int i = 0; i < 10; ++i) {
        BodySpec body = standing(box(1, {1, 1, 1}), i % 2 == 0 ? shift : -shift, i + 0.5L);
        if (i % 3 == 0) body.position.z = real(shift);
        setup.bodies.push_back(body);
    }
    return setup;
}
// The largest distance of a box from where it was put.
Number largest_shift(const AnyWorld& world, const SceneSetup& setup) {
    Number largest = 0;
    for (int b = 0; b < world.body_count(); ++b)
        largest =
            std::max(largest, norm(world.motion(b).x - vector(setup.bodies[static_cast<std::size_t>(b)].position)));
    return largest;
}
void expect_stack_stands(AnyWorld& world, const SceneSetup& setup, int seconds) {
    Number largest = 0;
    for (int i = 0; i < 4 * seconds; ++i) {
        world.run(second / 4);
        largest = std::max(largest, largest_shift(world, setup));
        ASSERT_LE(largest, tolerance::stack_shift) << "after " << 0.25 * (i + 1) << " s";
    }
    std::printf("%d s: moved by %.2Lg m at most\n", seconds, largest);
    const Motion top = world.motion(9);
    EXPECT_LE(norm(top.v), tolerance::rest_speed);
    EXPECT_LE(norm(top.w), tolerance::rest_speed);
    EXPECT_TRUE(world.status().ok()) << "status " << static_cast<int>(world.status().bits) << " at step "
                                     << world.status().first_step;
}

TEST_P(Resting, a_stack_of_ten_boxes_stands_for_a_minute_without_sleeping) {
    const SceneSetup setup = stack(false);
    const auto world = build(setup, GetParam());
    expect_stack_stands(*world, setup, 60);
    for (int b = 0; b < 10; ++b) EXPECT_FALSE(world->asleep(b));
}

TEST_P(Resting, a_stack_of_ten_boxes_stands_for_a_minute_and_sleeps_without_a_bit_moving) {
    const SceneSetup setup = stack(true);
    const auto world = build(setup, GetParam());
    for (int b = 0; b < 10; ++b) EXPECT_FALSE(world->asleep(b));
    world->run(second / 4);
    for (int b = 0; b < 10; ++b) EXPECT_FALSE(world->asleep(b)) << "sooner than in 0.5 s";
    expect_stack_stands(*world, setup, 5);
    for (int b = 0; b < 10; ++b) EXPECT_TRUE(world->asleep(b)) << "box " << b;
    const std::uint64_t asleep = world->hash();
    for (int step = 0; step < 55 * second; ++step) {
        world->step();
        ASSERT_EQ(world->hash(), asleep) << "step " << step << " of sleep";
    }
}

TEST_P(Resting, a_stack_of_shifted_boxes_stands) {
    const SceneSetup setup = stack(false, 0.03125L);
    const auto world = build(setup, GetParam());
    expect_stack_stands(*world, setup, 10);
}

TEST_P(Resting, the_top_of_a_stack_of_ten_boxes_stays_within_half_a_millimetre) {
    const SceneSetup setup = stack(false);
    const auto world = build(setup, GetParam());
    Number aside = 0, down = 0;
    for (int step = 0; step < 10 * second; ++step) {
        world->step();
        const Vector moved = world->motion(9).x - vector(setup.bodies[9].position);
        aside = std::max(aside, std::hypot(moved.x, moved.z));
        down = std::max(down, std::abs(moved.y));
    }
    std::printf("10 s: the top moved by %.2Lg m aside and %.2Lg m down at most\n", aside, down);
    EXPECT_LE(aside, tolerance::stack_top_aside);
    EXPECT_LE(down, tolerance::stack_top_down);
}

// Four rows of four, three, two and one, each box on the halves of the two below it.
TEST_P(Resting, a_pyramid_of_ten_boxes_stands) {
    SceneSetup setup = floor(0, 0.5L);
    for (int row = 0; row < 4; ++row)
        for (int i = 0; i < 4 - row; ++i)
            setup.bodies.push_back(
                standing(box(10, {1, 1, 1}), 1.0625L * (static_cast<Number>(i) - (3 - row) / 2.0L), row + 0.5L));
    const auto world = build(setup, GetParam());
    Number top = 0;
    for (int step = 0; step < 10 * second; ++step) {
        world->step();
        top = std::max(top, norm(world->motion(9).x - vector(setup.bodies[9].position)));
    }
    std::printf("10 s: the top moved by %.2Lg m at most\n", top);
    EXPECT_LE(top, tolerance::pyramid_top);
    EXPECT_TRUE(world->status().ok());
}

// Gaps of exactly zero: neighbours touch in a point or share a face, and boxes across a corner share an edge or a
// vertex. Nothing can get faster than what falls from the top.
TEST_P(Resting, a_heap_of_bodies_that_touch_exactly_stays_finite_and_above_the_floor) {
    for (const ShapeKind kind : {ShapeKind::sphere, ShapeKind::box}) {
        for (const Number edge : {0.5L, 0.6L}) {
            SceneSetup setup = floor(0, 0.5L);
            const int layers = kind == ShapeKind::box ? 2 : 3;  // 8 boxes, or 12 spheres
            for (int i = 0; i < 4 * layers; ++i) {
                const auto at = [&](int cell) { return edge * static_cast<Number>(cell); };
                const Real e = real(edge);
                BodySpec body = standing(kind == ShapeKind::box ? box(1, {e, e, e}) : sphere(1, real(edge / 2)),
                                         at(i & 1), at(i / 4) + edge / 2);
                body.position.z = real(at(i / 2 & 1));
                setup.bodies.push_back(body);
            }
            const auto world = build(setup, GetParam());
            const Number fall = std::sqrt(2 * g * edge * static_cast<Number>(layers));
            for (int step = 0; step < 2 * second; ++step) {
                world->step();
                for (int b = 0; b < world->body_count(); ++b) {
                    const Motion m = world->motion(b);
                    ASSERT_LE(edge / 2 - m.x.y, tolerance::depth) << "body " << b << ", step " << step;
                    ASSERT_LE(norm(m.v), fall) << "body " << b << ", step " << step;
                }
            }
            EXPECT_TRUE(world->status().ok())
                << "edge " << edge << ", status " << static_cast<int>(world->status().bits) << " at step "
                << world->status().first_step;
            if (kind == ShapeKind::box) {
                EXPECT_LE(largest_shift(*world, setup), tolerance::creep) << "edge " << edge;
            }
        }
    }
}

TEST_P(Resting, a_box_rests_on_a_fixed_box_and_on_two_others) {
    SceneSetup setup = floor(0, 0.5L);
    setup.bodies = {fixed(standing(box(1, {4, 1, 4}), 0, 0.5L)), standing(box(1, {1, 1, 1}), -0.5625L, 1.5L),
                    standing(box(1, {1, 1, 1}), 0.5625L, 1.5L), standing(box(1, {1, 1, 1}), 0, 2.5L)};
    const auto world = run(setup, 4 * second);
    EXPECT_LE(largest_shift(*world, setup), tolerance::stack_shift);
    for (int b = 1; b < 4; ++b) expect_still(*world, b);
}

TEST_P(Resting, a_sphere_rests_between_two_others_that_walls_hold) {
    SceneSetup setup = floor(0, 0);
    setup.planes.push_back({.normal = {1, 0, 0}, .offset = 0.75});
    setup.planes.push_back({.normal = {-1, 0, 0}, .offset = 0.75});
    // Centres on a triangle of sides 0.5, 0.5 and 0.5: the walls at 0.25 m from the centres below.
    setup.bodies = {standing(sphere(1, 0.25), -0.5L, 0.25L), standing(sphere(1, 0.25), 0.5L, 0.25L),
                    standing(sphere(2, 0.75), 0, 0.25L + std::sqrt(Number(0.75L)))};
    const auto world = run(setup, 4 * second);
    EXPECT_LE(largest_shift(*world, setup), tolerance::place);
    for (int b = 0; b < 3; ++b) expect_still(*world, b);
}

// --- a box that drops --------------------------------------------------------------------------------------------

TEST_P(Resting, a_dropped_cube_comes_to_rest_on_a_face_and_does_not_jitter) {
    struct Drop {
        RealQuat orientation;
        Vector spin;
    };
    for (const Drop& drop : {Drop{{}, {}}, Drop{{0.9, {0.1, -0.3, 0.2}}, {}}, Drop{{1, {0, 0, 0.25}}, {0.5, 0, 0}},
                             Drop{{0.8, {0.3, 0.1, -0.4}}, {3, -2, 5}}}) {
        // The dissertation's.
        const BodySpec cube = oriented(standing(box(10, {1, 1, 1}), 0, 2, {}, drop.spin), drop.orientation);
        const auto world = run(floor(0.4L, 0.3L, {cube}), 15 * second);
        expect_still(*world, 0);
        const Motion m = world->motion(0);
        const Vector up = m.q.normalized().rotate_back({0, 1, 0});
        EXPECT_LE(1 - std::max({std::abs(up.x), std::abs(up.y), std::abs(up.z)}), tolerance::rest_tilt);
        EXPECT_LE(std::abs(m.x.y - 0.5L), tolerance::place);
        EXPECT_LE(norm(m.v) + norm(m.w), tolerance::creep);
        EXPECT_EQ(world->contact_count(0), 4);
        EXPECT_FALSE(world->status().has(Issue::contacts_full) || world->status().has(Issue::range_left));
    }
}

TEST_P(Resting, a_box_that_is_put_down_stays_where_it_is) {
    SceneSetup setup = floor(0.5L, 0.5L, {standing(box(2, {1, 0.5, 0.75}), 0, 0.25L)});
    const auto world = run(setup, 4 * second);
    EXPECT_LE(largest_shift(*world, setup), tolerance::creep);
    EXPECT_LE(angle_between(world->motion(0).q, Rotation{}), tolerance::creep);
}

// The box is held up while the ball falls freely: how soon they meet is not told by their relative velocity. With gaps
// of up to 8 m between them they meet within what is foreseen at the start, half a second, and after it. From above
// that the blow goes deep into the floor below the box within a step, and the moment of the impact must be found among
// points that only rest.
TEST_P(Resting, a_ball_dropped_on_an_awake_box_comes_to_rest_on_it) {
    for (const bool ball_first : {false, true}) {
        for (const Number gap : {0.25L, 0.5L, 1.0L, 2.0L, 8.0L, 14.0L, 18.0L, 20.0L}) {
            SceneSetup setup = floor(0, 0.5L);
            setup.bodies = {standing(box(2, {1, 0.5, 1}), 0, 0.25L),
                            standing(sphere(1, 0.25), 0.125L, 0.5L + gap + 0.25L)};
            const int ball = ball_first ? 0 : 1, lying = 1 - ball;
            if (ball_first) std::swap(setup.bodies[0], setup.bodies[1]);
            const auto world = build(setup, GetParam());
            for (int step = 0; step < 3 * second; ++step) {
                world->step();
                ASSERT_LE(0.5L - (world->motion(ball).x.y - world->motion(lying).x.y), tolerance::depth)
                    << "from " << gap << " m, step " << step;
            }
            EXPECT_LE(std::abs(world->motion(lying).x.y - 0.25L), tolerance::place) << gap;
            EXPECT_LE(std::abs(world->motion(ball).x.y - 0.75L), tolerance::place) << gap;
            EXPECT_LE(norm(world->motion(ball).v), tolerance::creep) << gap;
            EXPECT_GT(world->contact_count(ball), 0) << gap;
            EXPECT_TRUE(world->status().ok()) << gap;
        }
    }
}

// Pressed halfway to each of them it does not tip.
TEST_P(Resting, a_hoop_that_lies_flat_rests_on_four_points_of_its_rim) {
    for (const Vector point : {Vector{0.125L, 0, 0}, {-0.125L, 0, 0}, {0, 0.125L, 0}, {0, -0.125L, 0}}) {
        const SceneSetup setup = floor(0, 0.5L, {oriented(hoop(2, 0.25), upright)});
        const auto world = run(setup, 10);
        EXPECT_EQ(world->contact_count(0), 4);
        world->apply_impulse(0, {0, -1, 0}, point);
        world->run(second / 2);
        EXPECT_EQ(world->contact_count(0), 4);
        EXPECT_LE(largest_shift(*world, setup), tolerance::creep);
    }
}

// Both islands see the table where it is at the end of the step.
TEST_P(Resting, a_body_that_falls_on_one_end_of_a_tilting_table_does_not_change_the_other_end) {
    std::vector<Motion> alone;
    for (const bool with_another : {false, true}) {
        SceneSetup setup = floor(0.5L, 0.5L);
        setup.planes.clear();
        setup.bodies = {fixed(standing(box(10, {4, 0.5, 4}), 0, 0, {}, {0.5, 0, 0})),
                        standing(box(1, {0.5, 0.5, 0.5}), -1.5L, 0.5L),
                        placed(box(1, {0.5, 0.5, 0.5}), {1.5L, 0.75L, -1})};
        if (!with_another) setup.bodies[1].position.x = -50;
        const auto world = build(setup, GetParam());
        for (std::size_t step = 0; step < 300; ++step) {
            world->step();
            const Motion m = world->motion(2);
            if (!with_another) alone.push_back(m);
            else ASSERT_EQ(norm(m.x - alone[step].x) + norm(m.v - alone[step].v), 0) << "step " << step;
        }
    }
}

// In fixed point a larger body makes the unit of length coarser; what had been measured in the finer one must not be
// taken for lengths in it.
TEST_P(Resting, a_much_larger_box_added_far_away_does_not_disturb_boxes_at_rest) {
    for (const Number edge : {16.0L, 32.0L}) {
        for (const bool fixed : {false, true}) {
            SceneSetup setup = floor(0, 0.5L);
            setup.bodies = {standing(box(2, {1, 0.5, 0.75}), 0, 0.25L),
                            standing(box(1, {0.5, 0.5, 0.5}), 0.125L, 0.75L)};
            const auto world = run(setup, second);
            const Motion before[] = {world->motion(0), world->motion(1)};
            BodySpec large = standing(box(1000, {real(edge), real(edge), real(edge)}), 40, edge / 2);
            large.fixed = fixed;
            ASSERT_TRUE(world->add(large));
            for (int step = 0; step < second; ++step) {
                world->step();
                for (int b = 0; b < 2; ++b) {
                    const Motion m = world->motion(b);
                    ASSERT_LE(norm(m.x - before[b].x), tolerance::still) << "body " << b << ", edge " << edge;
                    ASSERT_LE(angle_between(m.q, before[b].q), tolerance::still) << "body " << b << ", edge " << edge;
                }
            }
            EXPECT_LE(norm(world->motion(2).x - vector(large.position)), tolerance::creep) << edge;
            EXPECT_TRUE(world->status().ok()) << edge;
        }
    }
}

// --- sliding and rolling -----------------------------------------------------------------------------------------

TEST_P(Resting, a_sliding_box_stops_at_its_distance_and_stays_there) {
    SceneSetup setup = floor(0, 0.5L, {standing(box(2, {1, 0.25, 1}), 0, 0.125L, {2.4, 0, 1.8})});  // 3 m/s
    const auto world = run(setup, 2 * second);
    const Vector stop = Vector{0.8L, 0, 0.6L} * (9 / (2 * 0.5L * g));
    EXPECT_LE(norm(world->motion(0).x - (vector(setup.bodies[0].position) + stop)), tolerance::sliding * norm(stop));
    expect_still(*world, 0);
}

// Two sides combine by the geometric mean: the plane has 0.8, the boxes as much as gives 0.8, 0.7 and 0.5.
SceneSetup box_on_incline(Number friction) {
    SceneSetup setup = incline(0.125L, {on_incline(box(2, {0.5, 0.25, 0.5}), 0.125L)});
    setup.planes[0].friction = 0.8;
    setup.bodies[0].friction = real(friction);
    return setup;
}

TEST_P(Resting, a_box_on_an_incline_sticks_below_the_friction_angle) {
    const SceneSetup setup = box_on_incline(0.8L);
    const auto world = run(setup, 4 * second);
    EXPECT_LE(largest_shift(*world, setup), tolerance::creep);
    expect_still(*world, 0);
}

TEST_P(Resting, a_box_on_an_incline_slides_with_the_closed_form_above_the_friction_angle) {
    for (const auto& [own, combined] : {std::pair{0.6125L, 0.7L}, std::pair{0.3125L, 0.5L}}) {
        const SceneSetup setup = box_on_incline(own);
        const auto world = run(setup, 2 * second);
        const Number acceleration = g * (slope_sine - combined * slope_cosine);
        const Motion m = world->motion(0);
        const Vector moved = m.x - vector(setup.bodies[0].position);
        EXPECT_LE(std::abs(-dot(moved, uphill) / (2 * acceleration) - 1), tolerance::sliding) << combined;
        EXPECT_LE(std::abs(-dot(m.v, uphill) / (2 * acceleration) - 1), tolerance::sliding) << combined;
        EXPECT_LE(std::abs(dot(moved, off_incline)) + std::abs(moved.z), tolerance::place) << combined;
        EXPECT_LE(angle_between(m.q, start_of(setup.bodies[0]).q), tolerance::rest_tilt) << combined;
        EXPECT_EQ(norm(m.w), 0) << combined;  // nothing is left that would turn it, not even by rounding
    }
}

TEST_P(Resting, a_bowling_ball_slides_until_it_rolls_and_then_rolls_for_ever) {
    constexpr Number speed = 3.5L, friction = 0.25L, radius = 0.5L;
    SceneSetup setup = floor(0, friction);
    setup.step = Seconds{1, 1024};
    setup.bodies = {standing(sphere(2, 0.5), 0, radius, {speed, 0, 0})};
    const auto world = build(setup, GetParam());
    const auto slip = [&] { return world->motion(0).v.x + radius * world_spin(world->motion(0)).z; };
    const Number onset = 2 * speed / (7 * friction * g);  // 0.41 s; until then slip falls evenly
    int steps = 0;
    Number middle = 0, distance = 0;
    for (; slip() > 0.01L * speed && steps < 1024; ++steps) {
        world->step();
        if (steps + 1 == 200) middle = slip();
        distance = world->motion(0).x.x;
    }
    const Number time = static_cast<Number>(steps) / 1024;
    EXPECT_LE(std::abs(middle / (speed * (1 - 200 / 1024.0L / onset)) - 1), tolerance::sliding);
    EXPECT_LE(std::abs(time - 0.99L * onset), tolerance::sliding * onset);
    EXPECT_LE(std::abs(distance - (speed * time - friction * g * time * time / 2)), tolerance::sliding * distance);
    world->run(1024);
    for (int i = 0; i < 4; ++i) {
        world->run(1024);
        EXPECT_LE(std::abs(world->motion(0).v.x / (speed * 5 / 7) - 1), tolerance::sliding) << i + 2 << " s";
        EXPECT_LE(std::abs(slip()), tolerance::slip * speed) << i + 2 << " s";
    }
}

// Lies with its axis along z, which it rolls about: what it has of m r^2 in moment.
struct Roller {
    BodySpec body;
    Number radius;
    const char* name;
    [[nodiscard]] Number moment() const { return moments_of(body).z / (number(body.mass) * radius * radius); }
};
std::vector<Roller> rollers() {
    return {{cylinder(2, 0.25, 0.5), 0.25L, "cylinder"},
            {capsule(2, 0.25, 0.5), 0.25L, "capsule"},
            {hoop(2, 0.25), 0.25L, "hoop"}};
}

TEST_P(Resting, round_bodies_slide_until_they_roll) {
    for (const Roller& roller : rollers()) {
        const auto world = run(floor(0, 0.5L, {standing(roller.body, 0, roller.radius, {3, 0, 0})}), second);
        const Number rolls = 3 / (1 + roller.moment());
        EXPECT_LE(std::abs(world->motion(0).v.x / rolls - 1), tolerance::sliding) << roller.name;
        EXPECT_LE(std::abs(world_spin(world->motion(0)).z * roller.radius / -rolls - 1), tolerance::sliding)
            << roller.name;
        EXPECT_LE(std::abs(world->motion(0).x.y - roller.radius), tolerance::place) << roller.name;
    }
}

TEST_P(Resting, round_bodies_roll_down_an_incline_with_the_closed_form) {
    for (const Roller& roller : rollers()) {
        SceneSetup setup = incline(0.625L, {placed(roller.body, off_incline * roller.radius)});
        const auto world = run(setup, second);
        const Number acceleration = g * slope_sine / (1 + roller.moment());
        const Vector moved = world->motion(0).x - vector(setup.bodies[0].position);
        EXPECT_LE(std::abs(-dot(moved, uphill) / (acceleration / 2) - 1), tolerance::sliding) << roller.name;
        EXPECT_LE(std::abs(-dot(world->motion(0).v, uphill) / acceleration - 1), tolerance::sliding) << roller.name;
        EXPECT_LE(std::abs(dot(moved, off_incline)), tolerance::place) << roller.name;
    }
}

TEST_P(Resting, cylinders_and_capsules_rest_lying_and_a_cylinder_stands) {
    for (const bool stands : {false, true}) {
        SceneSetup setup = floor(0, 0.5L, {standing(cylinder(2, 0.25, 0.75), 0, stands ? 0.375L : 0.25L)});
        if (stands) setup.bodies[0].orientation = upright;
        else setup.bodies.push_back(standing(capsule(2, 0.25, 0.75), 2, 0.25L));
        const auto world = run(setup, 2 * second);
        EXPECT_LE(largest_shift(*world, setup), tolerance::creep);
        for (int b = 0; b < world->body_count(); ++b) {
            expect_still(*world, b);
            EXPECT_GE(world->contact_count(b), stands ? 3 : 2);
        }
    }
}

TEST_P(Resting, a_standing_cylinder_slides_to_its_distance_without_falling_over) {
    const BodySpec body = oriented(standing(cylinder(2, 0.25, 0.5), 0, 0.25L, {1.2, 0, 0.9}), upright);  // 1.5 m/s
    const SceneSetup setup = floor(0, 0.25L, {body});
    const auto world = run(setup, 2 * second);
    const Vector stop = Vector{0.8L, 0, 0.6L} * (2.25L / (2 * 0.25L * g));
    EXPECT_LE(norm(world->motion(0).x - (vector(setup.bodies[0].position) + stop)),
              2 * tolerance::sliding * norm(stop));
    EXPECT_LE(std::abs(world->motion(0).q.normalized().rotate({0, 0, 1}).y - 1), tolerance::rest_tilt);
}

TEST_P(Resting, a_dropped_cylinder_never_sinks_into_the_floor) {
    const Number radius = 0.25L, half = 0.5L;
    for (const RealQuat& orientation : {RealQuat{0.9, {0.1, -0.3, 0.2}}, RealQuat{1, {0.25, 0.5, 0}}}) {
        const BodySpec body = oriented(standing(cylinder(2, 0.25, 1), 0, 1.5L, {}, {1, 0, -2}), orientation);
        const auto world = build(floor(0.3L, 0.4L, {body}), GetParam());
        Number deepest = 0;
        for (int step = 0; step < 8 * second; ++step) {
            world->step();
            const Motion m = world->motion(0);
            const Number axis = std::abs(m.q.normalized().rotate({0, 0, 1}).y);
            deepest = std::min(deepest, m.x.y - half * axis - radius * std::sqrt(std::max(1 - axis * axis, Number(0))));
        }
        EXPECT_LE(-deepest, tolerance::depth);
        EXPECT_LE(world->motion(0).x.y - half, tolerance::depth);
        EXPECT_LE(std::abs(world->motion(0).v.y), 0.1L);
    }
}

// --- turntables --------------------------------------------------------------------------------------------------

// A fixed box that turns about the vertical; its top is at y = 0. Steps of 1/1024 s.
SceneSetup turntable(Number turns) {
    SceneSetup setup = floor(0, 1, {fixed(standing(box(100, {8, 0.5, 8}), 0, -0.25L, {}, {0, turns, 0}))});
    setup.step = Seconds{1, 1024};
    setup.planes.clear();
    return setup;
}
Vector turned(Vector v, Number angle) { return exponential(Vector{0, angle, 0}).rotate(v); }

TEST_P(Resting, a_fixed_body_keeps_turning_where_it_is) {
    const auto world = build(turntable(3.5L), GetParam());
    for (int i = 1; i <= 4; ++i) {
        world->run(512);
        const Motion m = world->motion(0);
        EXPECT_EQ(norm(m.x - Vector{0, -0.25L, 0}) + norm(m.v), 0);
        EXPECT_LE(angle_between(m.q, exponential(Vector{0, 1.75L * static_cast<Number>(i), 0})),
                  tolerance::turntable_rounding +
                      tolerance::method_error(order(), 3.5L / 1024, 1.75L * static_cast<Number>(i)));
        EXPECT_LE(norm(m.w - Vector{0, 3.5L, 0}), tolerance::turntable_spin);
    }
}

// v' = 2/7 W x v without slip: a circle, at 2/7 of the table's turns, in the world's frame.
TEST_P(Resting, a_ball_on_a_turntable_rolls_in_a_circle_at_two_sevenths_of_its_turns) {
    SceneSetup setup = turntable(3.5L);
    // No slip: v + w x (0, -r, 0) = W x x.
    setup.bodies.push_back(standing(sphere(1, 0.25), 1, 0.25L, {0, 0, 0.5}, {16, 0, 0}));
    const auto world = build(setup, GetParam());
    const Vector centre{1.5L, 0.25L, 0};
    for (int step = 1; step <= 6434; ++step) {  // 2 pi s
        world->step();
        if (step % 512 != 0 && step != 6434) continue;
        const Vector expected = centre + turned({-0.5L, 0, 0}, step / 1024.0L);
        EXPECT_LE(norm(world->motion(1).x - expected), 0.5L * tolerance::turntable_orbit)
            << "at " << step / 1024.0 << " s";
    }
    EXPECT_TRUE(world->status().ok());
}

TEST_P(Resting, a_ball_that_spins_with_its_turntable_stays_where_it_is) {
    SceneSetup setup = turntable(3.5L);
    setup.bodies.push_back(standing(sphere(1, 0.25), -2, 0.25L, {}, {-28, 0, 0}));
    const auto world = run(setup, 2048);
    EXPECT_LE(norm(world->motion(1).x - Vector{-2, 0.25L, 0}), tolerance::turntable_orbit);
}

TEST_P(Resting, a_box_is_carried_round_by_a_turntable) {
    SceneSetup setup = turntable(2);
    setup.bodies.push_back(standing(box(1, {0.5, 0.25, 0.5}), 1, 0.125L, {0, 0, -2}, {0, 2, 0}));  // v = W x x
    const auto world = run(setup, 2048);
    EXPECT_LE(norm(world->motion(1).x - turned({1, 0.125L, 0}, 4)), tolerance::turntable_orbit);
    EXPECT_LE(angle_between(world->motion(1).q, exponential(Vector{0, 4, 0})), tolerance::turntable_orbit);
}

TEST_P(Resting, a_box_at_rest_is_spun_up_by_a_turntable) {
    SceneSetup setup = turntable(2);
    setup.bodies.push_back(standing(box(1, {0.5, 0.25, 0.5}), 0, 0.125L));
    const auto world = build(setup, GetParam());
    // Four corners sqrt(2)/4 m from the axis rub: mu g r / (I / m) with I / m = 1/24 m^2.
    world->run(16);
    EXPECT_LE(std::abs(world->motion(1).w.y / (g * std::sqrt(Number(2)) / 4 * 24 * 16 / 1024) - 1), tolerance::sliding);
    world->run(2032);
    EXPECT_LE(std::abs(world->motion(1).w.y / 2 - 1), tolerance::sliding);
    EXPECT_LE(norm(world->motion(1).x - Vector{0, 0.125L, 0}), tolerance::place);
}

// --- sleep -------------------------------------------------------------------------------------------------------

// A box of 2 kg that has lain still for a second.
BodySpec sleeper() { return standing(box(2, {1, 0.5, 1}), 0, 0.25L); }
void expect_falls_asleep(AnyWorld& world, int body = 0) {
    world.run(second);
    ASSERT_TRUE(world.asleep(body));
    const std::uint64_t hash = world.hash();
    world.run(second / 2);
    ASSERT_EQ(world.hash(), hash);
}

TEST_P(Resting, nothing_sleeps_in_a_scene_that_does_not_ask_for_it) {
    const auto world = run(floor(0, 0.5L, {sleeper()}), 4 * second);
    EXPECT_FALSE(world->asleep(0));
}

TEST_P(Resting, an_impulse_wakes_a_sleeper_at_once_and_it_sleeps_again) {
    const auto world = build(sleepy_floor(0.5L, {sleeper()}), GetParam());
    expect_falls_asleep(*world);
    const Vector start = world->motion(0).x;
    world->apply_impulse(0, {4, 0, 0});  // 2 m/s
    EXPECT_FALSE(world->asleep(0));
    world->run(second / 16);
    EXPECT_FALSE(world->asleep(0));
    EXPECT_GT(world->motion(0).v.x, 1);
    world->run(2 * second);
    EXPECT_TRUE(world->asleep(0));
    EXPECT_GT(world->motion(0).x.x - start.x, 0.2L);
}

TEST_P(Resting, a_sleeper_that_is_pushed_slides_as_far_as_one_that_never_slept) {
    Number distance[2]{};
    for (const bool sleep : {false, true}) {
        SceneSetup setup = sleep ? sleepy_floor() : floor(0, 0.5L);
        setup.bodies = {sleeper()};
        const auto world = run(setup, 2 * second);
        EXPECT_EQ(world->asleep(0), sleep);
        const Vector start = world->motion(0).x;
        world->apply_impulse(0, {4, 0, 0});
        world->run(second);
        distance[sleep ? 1 : 0] = world->motion(0).x.x - start.x;
        EXPECT_LE(std::abs(distance[sleep ? 1 : 0] / (4 / g) - 1), tolerance::sliding);  // v^2 / (2 mu g)
    }
    EXPECT_LE(std::abs(distance[1] - distance[0]), tolerance::creep);
}

TEST_P(Resting, a_timed_force_wakes_a_sleeper_when_it_begins) {
    SceneSetup setup = sleepy_floor(0.5L, {sleeper()});
    setup.forces = {{.body = 0, .from = 2.0, .until = 3.0, .force = {30, 0, 0}}};
    const auto world = build(setup, GetParam());
    expect_falls_asleep(*world);
    world->run(second / 2);
    EXPECT_TRUE(world->asleep(0));  // up to the moment that the force begins
    const Vector start = world->motion(0).x;
    world->run(second);
    EXPECT_FALSE(world->asleep(0));
    // (F - mu m g) / m, for a second.
    const Number distance = (30 - 0.5L * 2 * g) / 2 / 2;
    EXPECT_LE(std::abs((world->motion(0).x.x - start.x) / distance - 1), tolerance::sliding);
    world->run(4 * second);
    EXPECT_TRUE(world->asleep(0));
}

TEST_P(Resting, a_force_that_is_set_while_it_acts_wakes_a_sleeper_and_stops_at_the_floor) {
    SceneSetup setup = sleepy_floor(0.5L, {sleeper()});
    const auto world = build(setup, GetParam());
    expect_falls_asleep(*world);
    const Vector start = world->motion(0).x;
    world->set_forces({{.body = 0, .from = 0.25, .until = 9.0, .force = {0, 0, -30}}});
    world->run(second);
    const Number distance = (30 - 0.5L * 2 * g) / 2 / 2;
    EXPECT_LE(std::abs((start.z - world->motion(0).x.z) / distance - 1), tolerance::sliding);

    setup.world.gravity = {};
    setup.bodies = {standing(sphere(2, 0.25), 0, 0.75L)};
    const auto floating = run(setup, 3);
    floating->set_forces({{.body = 0, .from = 0.0, .until = 9.0, .force = {0, -100, 0}}});
    floating->run(second);
    EXPECT_LE(0.25L - floating->motion(0).x.y, tolerance::depth);
}

TEST_P(Resting, contacts_and_sleep_continue_when_a_step_counter_wraps) {
    // A sleeper that a force pushes for a while, a ball that bounces, one on a spring, and one that rolls to the
    // sleeper.
    const auto scene = [&](std::uint64_t start) {
        const auto at = [&](int step) { return real((static_cast<Number>(start) + step) / second); };
        SceneSetup setup = sleepy_floor();
        setup.start = static_cast<std::uint32_t>(start);
        setup.bodies = {sleeper(), standing(sphere(1, 0.25), 4, 1), standing(sphere(0.5, 0.125), 8, 0.25L),
                        standing(sphere(2, 0.25), -8, 0.25L, {4, 0, 0})};
        setup.bodies[1].restitution = 1;
        setup.bodies[3].friction = 0;
        setup.springs = {{.body = 2, .to = {8.0, 1.0, 0.0}, .stiffness = 40, .damping = 0.5, .rest_length = 0.5}};
        setup.forces = {{.body = 0, .from = 0, .until = real(64.0L / second), .force = {0, 50, 0}},
                        {.body = 0, .from = at(700), .until = at(800), .force = {0, 0, 30}}};
        return setup;
    };
    SceneSetup plain = scene(0);
    plain.forces.erase(plain.forces.begin());
    constexpr int steps = 1100;
    for (const std::uint64_t turn : {std::uint64_t{1} << 16, std::uint64_t{1} << 31, std::uint64_t{1} << 32}) {
        for (const int before : {100, 640}) {
            const std::uint64_t start = turn - static_cast<std::uint64_t>(before);
            const auto early = build(plain, GetParam()), late = build(scene(start), GetParam());
            bool slept = false, woke = false;
            for (int step = 0; step < steps; ++step) {
                early->step();
                late->step();
                slept = slept || late->asleep(0);
                woke = woke || (slept && !late->asleep(0));
                if (system().fixed_point) {  // rounding is dithered by the number of the step
                    for (int body = 0; body < 4; ++body)
                        ASSERT_LE(norm(late->motion(body).x - early->motion(body).x), tolerance::place)
                            << turn << " - " << before << " + " << step << ": body " << body;
                } else {
                    ASSERT_EQ(late->hash(), early->hash()) << turn << " - " << before << " + " << step;
                }
            }
            EXPECT_TRUE(slept && woke);
        }
    }
}

TEST_P(Resting, a_sleeper_wakes_when_the_force_that_held_it_ends) {
    SceneSetup setup = sleepy_floor();
    setup.planes[0] = {.normal = {0, -1, 0}, .offset = 3};  // a ceiling
    setup.bodies = {standing(box(2, {1, 0.5, 1}), 0, 2.75L)};
    setup.forces = {{.body = 0, .from = 0.0, .until = 2.0, .force = {0, 40, 0}}};
    const auto world = build(setup, GetParam());
    expect_falls_asleep(*world);
    world->run(second / 2);
    EXPECT_LE(std::abs(world->motion(0).x.y - 2.75L), tolerance::creep);
    world->run(second);
    EXPECT_FALSE(world->asleep(0));
    EXPECT_LE(std::abs((2.75L - world->motion(0).x.y) / (g / 2) - 1), tolerance::sliding);
}

TEST_P(Resting, a_force_that_does_not_move_a_sleeper_moves_nothing) {
    SceneSetup setup = sleepy_floor(0.5L, {sleeper()});
    setup.forces = {{.body = 0, .from = 2.0, .until = 4.0, .force = {5, 0, 0}}};  // friction holds 9.8 N
    const auto world = run(setup, 5 * second);
    EXPECT_LE(largest_shift(*world, setup), tolerance::creep);
    EXPECT_TRUE(world->asleep(0));
}

TEST_P(Resting, a_touching_body_wakes_a_sleeper_and_a_passing_one_does_not) {
    for (const bool touches : {true, false}) {
        SceneSetup setup = sleepy_floor();
        // 7.25 m to go: it is there at 1.8125 s.
        setup.bodies = {sleeper(), placed(sphere(2, 0.25), {-8, 0.25L, touches ? 0.0L : 1.0L}, {4, 0, 0})};
        setup.bodies[1].friction = 0;
        const auto world = run(setup, second);
        EXPECT_TRUE(world->asleep(0));
        const Motion before = world->motion(0);
        world->run(second / 2 + second / 4);
        EXPECT_TRUE(world->asleep(0));
        EXPECT_FALSE(world->asleep(1));
        EXPECT_EQ(norm(world->motion(0).x - before.x), 0);
        world->run(second / 8);
        EXPECT_EQ(world->asleep(0), !touches);
        world->run(second);
        const Number moved = norm(world->motion(0).x - before.x);
        if (touches) {
            // The sphere's 8 N s; both then go at most at 2 m/s together.
            EXPECT_GT(moved, 0.1L);
            EXPECT_LE(std::abs(world->motion(1).v.x) - 2, tolerance::rest_speed);
        } else {
            EXPECT_EQ(moved, 0);
            EXPECT_LE(std::abs(world->motion(1).v.x - 4), tolerance::creep);
        }
    }
}

TEST_P(Resting, a_pushed_body_wakes_the_bodies_on_it) {
    SceneSetup setup = sleepy_floor();
    setup.bodies = {sleeper(), standing(box(1, {0.5, 0.5, 0.5}), 0.125L, 0.75L), standing(box(1, {1, 1, 1}), 4, 0.5L)};
    const auto world = build(setup, GetParam());
    expect_falls_asleep(*world);
    for (int b = 0; b < 3; ++b) EXPECT_TRUE(world->asleep(b)) << b;
    world->apply_impulse(0, {12, 0, 0});
    world->step();
    EXPECT_FALSE(world->asleep(0));
    EXPECT_FALSE(world->asleep(1));
    EXPECT_TRUE(world->asleep(2));  // touches neither
    const Vector far = world->motion(2).x;
    world->run(second / 4);
    EXPECT_GT(world->motion(1).x.x, 0.15L);  // dragged along by friction
    world->run(5 * second);
    EXPECT_EQ(norm(world->motion(2).x - far), 0);
    for (int b = 0; b < 3; ++b) EXPECT_TRUE(world->asleep(b)) << b;
}

TEST_P(Resting, a_body_that_loses_its_support_falls) {
    const auto world = build(sleepy_floor(0, {sleeper(), standing(box(1, {0.5, 0.5, 0.5}), 0, 0.75L)}), GetParam());
    expect_falls_asleep(*world, 1);
    world->apply_impulse(0, {16, 0, 0});  // 8 m/s: away after 0.1 s, and without friction
    world->run(second);
    EXPECT_LE(std::abs(world->motion(0).v.x - 8), 0.5L);
    EXPECT_LT(world->motion(1).x.y, 0.5L);
    EXPECT_GT(world->motion(1).x.y, 0.2L);
}

TEST_P(Resting, a_body_slightly_faster_than_the_limit_never_sleeps) {
    SceneSetup setup = sleepy_floor(0);
    setup.bodies = {standing(sphere(1, 0.25), 0, 0.25L, {0.0625, 0, 0}),       // slides
                    standing(sphere(1, 0.25), 2, 0.25L, {}, {0, 0.0625, 0})};  // spins where it stands
    const auto world = run(setup, 4 * second);
    EXPECT_FALSE(world->asleep(0));
    EXPECT_FALSE(world->asleep(1));
    EXPECT_LE(std::abs(world->motion(0).x.x - 0.25L), tolerance::creep);
    EXPECT_LE(norm(world->motion(1).w - Vector{0, 0.0625L, 0}), tolerance::creep);
}

TEST_P(Resting, nothing_sleeps_in_the_air) {
    SceneSetup setup = sleepy_floor();
    setup.world.gravity = {0, -0.0078125, 0};
    // Slower than the limit for 5.8 s, and at its height after 2 s.
    setup.bodies = {standing(sphere(1, 0.25), 0, 2, {0, 0.015625, 0})};
    const auto world = run(setup, 4 * second);
    EXPECT_FALSE(world->asleep(0));
    EXPECT_LE(std::abs(world->motion(0).x.y - 2), tolerance::creep);
    EXPECT_LE(std::abs(world->motion(0).v.y + 0.015625L), tolerance::creep);
}

// In fixed point a step of 2^-16 s is one of the shortest in which a ball feels gravity.
TEST(Sleep, begins_after_its_time_for_any_number_of_steps) {
    for (const char* system : {"q32_near", "f64"}) {
        for (const int steps : {70000, 140000}) {
            SceneSetup setup = sleepy_floor();
            setup.step = Seconds{1, 65536};
            setup.world.contact.sleep.time = Real{steps} / Real{65536};
            setup.bodies = {standing(sphere(1, 0.25), 0, 0.25L)};
            const auto world = build(setup, "verlet", system);
            world->run(steps - 1);
            EXPECT_FALSE(world->asleep(0)) << system;
            world->run(16);
            EXPECT_TRUE(world->asleep(0)) << system << ", " << steps << " steps";
        }
    }
}

}  // namespace
}  // namespace tumble::test
