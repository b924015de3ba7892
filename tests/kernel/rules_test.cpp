// The rules of contacts and of sleep at their limits: which approaches bounce, which body wakes which, the effect of a
// change during a run, and the reports of bounds that a step reaches.
#include "contact_cases.hpp"

#include <utility>

namespace tumble::test {
namespace {

class Rules : public CaseTest {
protected:
    // Relative to a speed of a few metres per second.
    static Bound rounding() { return tolerance::contact_impulse.of(system()); }
};
INSTANTIATE_TEST_SUITE_P(every, Rules, testing::ValuesIn(contact_cases()), NameOf{});

// Directions that are not axes of the world, and one that is.
const Vector normals[] = {{0, 1, 0}, {-1, 0, 0}, {0.6L, 0, -0.8L}, {2 / 7.0L, -3 / 7.0L, 6 / 7.0L}};

// A plane through the origin, without gravity.
SceneSetup plane(Vector n, Number restitution, std::vector<BodySpec> bodies) {
    SceneSetup setup = space(restitution, 0, std::move(bodies));
    setup.planes = {{.normal = real(n)}};
    return setup;
}
// A heavy ball strikes a light one of 1 kg, which touches a plane.
SceneSetup squeeze(Number ratio, Vector normal, Number speed) {
    SceneSetup setup = space(1, 0,
                             {placed(sphere(real(ratio), 0.25), normal * (0.75L + 0.001953125L), normal * -speed),
                              placed(sphere(1, 0.25), normal * 0.25L)});
    setup.planes = {{.normal = real(normal)}};
    return setup;
}
// The gap is in no step deeper than the tolerance.
template <class Gap>
void expect_not_deep(AnyWorld& world, int steps, Gap&& gap, Number distance) {
    for (int step = 0; step < steps; ++step) {
        world.step();
        ASSERT_LE(-gap(), tolerance::depth) << "from " << distance << " m, step " << step;
    }
}
BodySpec cube(Number x, Number height) { return placed(box(2, {1, 1, 1}), {x, height, 0}); }

// --- restitution -------------------------------------------------------------------------------------------------

TEST_P(Rules, an_approach_below_the_restitution_threshold_does_not_bounce) {
    for (const Number threshold : {0.25L, 1.0L, 3.0L}) {
        for (const Vector n : normals) {
            for (const Number share : {0.5L, 0.96L, 1.04L, 2.0L}) {
                const Number speed = share * threshold;
                SceneSetup setup = plane(n, 0.75L, {placed(sphere(3, 0.25), n * (0.25L + speed / 10), n * -speed)});
                setup.world.contact.restitution_threshold = real(threshold);
                const auto world = run(setup, second / 4);
                const Number leaves = share > 1 ? 0.75L * speed : 0;
                EXPECT_LE(norm(world->motion(0).v - n * leaves), 4 * rounding() * speed) << threshold << ", " << speed;
                EXPECT_TRUE(world->status().ok());
            }
        }
    }
}

TEST_P(Rules, the_threshold_applies_to_the_relative_speed_of_two_bodies) {
    for (const Number share : {0.9L, 1.1L}) {
        SceneSetup setup = space(1, 0,
                                 {placed(sphere(1, 0.25), {-0.375L, 0, 0}, {1.5L * share, 0, 0}),
                                  placed(sphere(3, 0.25), {0.375L, 0, 0}, {-0.5L * share, 0, 0})});
        setup.world.contact.restitution_threshold = 2;
        const auto world = run(setup, second);
        // The centre of mass is at rest: the bodies turn back or stay together.
        const Number leaves = share > 1 ? share : 0;
        EXPECT_LE(norm(world->motion(0).v + Vector{1.5L * leaves, 0, 0}), 4 * rounding());
        EXPECT_LE(norm(world->motion(1).v - Vector{0.5L * leaves, 0, 0}), 4 * rounding());
    }
}

// A ball lands 0.95 of a step after its release. Its bounce would last 2 e v / g: more or less than an eighth of a
// step.
TEST_P(Rules, a_bounce_shorter_than_an_eighth_of_a_step_is_suppressed) {
    constexpr Number h = 1.0L / 16, landing = 0.95L * h;
    for (const Number share : {0.0625L, 0.115L, 0.135L, 0.1875L}) {
        const Number speed = g * landing, restitution = share * g * h / (2 * speed);
        SceneSetup setup = floor(restitution, 0, {placed(sphere(1, 0.5), {0, 0.5L + g * landing * landing / 2, 0})});
        setup.step = Seconds{1, 16};
        const auto world = run(setup, 1);
        const Number left = share > 0.125L ? restitution * speed - g * (h - landing) : 0;
        EXPECT_LE(std::abs(world->motion(0).v.y - left), tolerance::brief_bounce * speed) << share << " of a step";
    }
}

// The moment of an impact is found for any flight, here from rest in a step of up to 1/8 s. The ball rises until after
// the end of the step.
TEST_P(Rules, an_elastic_ball_keeps_its_energy_wherever_in_the_second_half_of_a_long_step_it_lands) {
    for (const Number h : {0.125L, 0.0625L}) {
        for (int place = 10; place < 20; ++place) {
            const Number landing = h * static_cast<Number>(place) / 20, drop = g * landing * landing / 2;
            SceneSetup setup = floor(1, 0, {placed(sphere(1, 0.25), {0, 0.25L + drop, 0})});
            setup.step = Seconds{real(h)};
            const auto world = run(setup, 1);
            const Motion m = world->motion(0);
            const Number apex = m.x.y - 0.25L + m.v.y * m.v.y / (2 * g);
            EXPECT_LE(std::abs(apex - drop), tolerance::landing.of(system()))
                << "at " << place << "/20 of " << h << " s";
        }
    }
}

// --- bounds of a step --------------------------------------------------------------------------------------------

// The light ball goes to and fro until it has turned the heavy one round, which takes pi sqrt(ratio) impacts.
TEST_P(Rules, a_ball_that_is_squeezed_for_too_many_rounds_is_reported_and_another_turns_the_heavy_one_round) {
    for (const Vector n : normals) {
        for (const Number ratio : {3.0L, 1e4L}) {
            const auto world = run(squeeze(ratio, n, 2), 1);
            EXPECT_EQ(world->status().has(Issue::step_bound_hit), ratio > 100);
            const Number energy = (ratio * norm(world->motion(0).v) * norm(world->motion(0).v) +
                                   norm(world->motion(1).v) * norm(world->motion(1).v)) /
                                  2;
            EXPECT_LE(energy, 2 * ratio * (1 + 1e-4L));
            if (ratio < 100) {
                EXPECT_GE(energy, 2 * ratio * (1 - 1e-4L));
                EXPECT_GT(dot(world->motion(0).v, n), 0);
            }
        }
    }
}

// Each body that the ball flies past is examined, because along the direction from that body at the start the ball has
// passed.
TEST_P(Rules, passing_more_bodies_in_a_step_than_are_examined_is_reported_and_passing_few_is_not) {
    for (const Vector along : {Vector{1, 0, 0}, {0, 0, -1}, {0.6L, 0, 0.8L}}) {
        for (const int passed : {3, 4, 5, 7}) {
            SceneSetup setup{.name = "past", .step = Seconds{1, 4}};
            setup.bodies = {placed(sphere(1, 0.125), along * -1, along * 30)};
            for (int i = 0; i < passed; ++i) {
                const Number side = i % 2 == 0 ? 0.5L : -0.5L;
                setup.bodies.push_back(fixed(placed(sphere(1, 0.125), along * (i * 0.75L) + Vector{0, side, 0})));
            }
            const auto world = run(setup, 1);
            EXPECT_EQ(world->status().has(Issue::step_bound_hit), passed > 4) << passed;
            if (passed <= 4) { EXPECT_LE(norm(world->motion(0).v - along * 30), rounding()) << passed; }
        }
    }
}

// Boxes that fall by a few centimetres onto each other, off the centre.
SceneSetup falling_boxes(int count, Number restitution, Number mass) {
    SceneSetup setup{.name = "pile"};
    setup.world = {.gravity = {0, -9.81, 0}, .contact = {.restitution = real(restitution), .friction = 0.5}};
    setup.planes = {{}};
    for (int i = 0; i < count; ++i) {
        const Number x = i % 2 == 0 ? 0.02L : -0.02L;
        setup.bodies.push_back(placed(box(real(mass), {0.5, 0.4, 0.5}), {x, 0.25L + 0.45L * i, 0.01L * i}));
    }
    return setup;
}
// A box that falls in a random pose onto another that lies there.
SceneSetup box_onto_a_box(Number mass) {
    SceneSetup setup{.name = "pile"};
    setup.world = {.gravity = {0, -9.81, 0}, .contact = {.restitution = 0.3, .friction = 0.3}};
    setup.planes = {{}};
    setup.bodies = {placed(box(real(mass), {0.4, 0.3, 0.5}), {0, 0.15L, 0}),
                    placed(box(real(mass), {0.4, 0.3, 0.5}), {0.0096L, 1, -0.0736L})};
    setup.bodies[1].orientation = {0.4149, {-0.1772, -0.7190, 0.5287}};
    return setup;
}
SceneSetup balls_in_a_pit(Number restitution) {
    SceneSetup setup{.name = "pit"};
    setup.world = {.gravity = {0, -9.81, 0}, .contact = {.restitution = real(restitution), .friction = 0.3}};
    setup.planes = {{},
                    {.normal = {1, 0, 0}, .offset = 0.4},
                    {.normal = {-1, 0, 0}, .offset = 0.4},
                    {.normal = {0, 0, 1}, .offset = 0.4},
                    {.normal = {0, 0, -1}, .offset = 0.4}};
    for (int i = 0; i < 7; ++i) {
        const Number x = 0.15L * std::sin(Number(2 * i)), z = 0.15L * std::cos(Number(3 * i));
        setup.bodies.push_back(placed(sphere(1, real(0.11L + 0.005L * i)), {x, 0.2L + 0.3L * i, z}));
    }
    return setup;
}
// The same scene mirrored in x and turned about the vertical.
SceneSetup turned_scene(SceneSetup setup, bool mirrored, Number angle) {
    const Number c = std::cos(angle / 2), s = std::sin(angle / 2);
    const RealQuat turn{real(c), {0, real(s), 0}};
    for (BodySpec& body : setup.bodies) {
        if (mirrored) {
            body.position.x = -body.position.x;
            body.orientation.v.y = -body.orientation.v.y;
            body.orientation.v.z = -body.orientation.v.z;
        }
        body.position = turn.rotate(body.position);
        body.orientation = turn * body.orientation;
    }
    return setup;
}

// A bouncing body comes to rest after infinitely many bounces. Bounces slower than the speed of rest are cut off.
TEST_P(Rules, piles_that_come_to_rest_report_nothing) {
    if (order() == 4) GTEST_SKIP() << "contacts are those of the default method";
    std::vector<SceneSetup> scenes;
    for (const int count : {2, 3, 4})
        for (const Number restitution : {0.1L, 0.3L})
            if (count < 4 || restitution < 0.2L) scenes.push_back(falling_boxes(count, restitution, 2));
    scenes.push_back(turned_scene(falling_boxes(3, 0.1L, 0.4L), true, 0.7L));
    for (const bool mirrored : {false, true})
        scenes.push_back(turned_scene(box_onto_a_box(1), mirrored, mirrored ? 0.7L : 0));
    for (const Number restitution : {0.3L, 0.6L}) scenes.push_back(balls_in_a_pit(restitution));
    for (SceneSetup& setup : scenes) {
        for (const Seconds step : {Seconds{1, 60}, {1, 256}, {1, 1000}, {1, 1024}}) {
            setup.step = step;
            const auto world = run(setup, static_cast<int>((Real{3} / step.value).to_fixed(0)));
            const Status status = world->status();
            EXPECT_TRUE(status.ok()) << setup.name << " of " << setup.bodies.size() << ", step "
                                     << step.value.to_double() << ": " << int{status.bits};
            if (setup.bodies.size() > 4) continue;  // balls roll on
            for (int b = 0; b < world->body_count(); ++b) {
                EXPECT_LE(norm(world->motion(b).v), 0.01L)
                    << setup.bodies.size() << ", step " << step.value.to_double();
            }
        }
    }
}

// Without gravity a light ball between two heavy ones that come on bounces without end in finite time, and then all
// three go on together. What is cut off is a small part of their approach.
TEST_P(Rules, the_end_of_an_inelastic_collapse_is_no_alarm) {
    for (const Number restitution : {0.05L, 0.2L}) {
        for (const Number mass : {0.25L, 0.5L}) {
            for (const Vector along : {Vector{1, 0, 0}, {0, -0.6L, 0.8L}}) {
                SceneSetup setup = space(restitution);
                setup.bodies = {placed(sphere(2, 0.125), along * -0.5L, along * 1),
                                placed(sphere(real(mass), 0.0625), along * -0.125L),
                                placed(sphere(2, 0.125), along * 0.5L, along * -0.75L)};
                const auto world = run(setup, second);
                EXPECT_TRUE(world->status().ok())
                    << static_cast<double>(restitution) << " " << static_cast<double>(mass);
                const Sums after = sums_of(*world, setup.bodies);
                EXPECT_LE(norm(after.linear - along * 0.5L), 1e-5L);
                EXPECT_LE(after.energy, 1 + 0.5625L);
                EXPECT_LE(norm(world->motion(0).v - world->motion(2).v), 0.1L);
            }
        }
    }
}

// In a narrow wedge a ball bounces more often than a moment has rounds. The speed that is left is an error for a fast
// ball. It is none for a ball that approaches the planes more slowly than the speed of rest.
TEST_P(Rules, a_fast_bounce_that_is_cut_off_is_reported_under_gravity_and_a_slow_one_is_not) {
    for (const Number speed : {4.0L, 0.5L / 64}) {
        SceneSetup setup = squeeze(1e4L, {0, 1, 0}, speed);
        setup.bodies[0].position = {0, 0.75, 0};
        setup.world.gravity = gravity;
        const auto world = run(setup, 1);
        EXPECT_EQ(world->status().has(Issue::step_bound_hit), speed > 1) << speed;
    }
}

TEST_P(Rules, jumping_over_a_barrier_in_one_step_is_reported) {
    for (const Vector n : normals) {
        for (const Number speed : {16.0L, 30.0L}) {
            SceneSetup setup = plane(n, 0.5L, {placed(sphere(1, 0.25), n * (0.25L + speed / 32), n * -speed)});
            setup.step = Seconds{1, 16};
            // The barrier is too weak to act, and to be too stiff, at the beginning and at the end of the step.
            setup.world.contact = {.response = ContactResponse::spring, .stiffness = 1, .barrier = 1e-6};
            const auto world = run(setup, 2);
            EXPECT_TRUE(world->status().has(Issue::step_too_long)) << speed;
        }
    }
}

TEST_P(Rules, a_start_outside_the_range_is_reported_before_the_first_step) {
    if (!system().fixed_point) GTEST_SKIP() << "floating point holds any start that is finite";
    for (const auto& [position, velocity] :
         {std::pair<Vector, Vector>{{0, 80, 0}, {}}, {{-65, 0, 0}, {}}, {{}, {0, 0, 40}}, {{}, {-33, 0, 0}}}) {
        SceneSetup setup{.name = "far"};
        setup.bodies = {placed(sphere(1, 0.25), {}), placed(sphere(1, 0.25), position, velocity)};
        const auto world = build(setup, GetParam());
        EXPECT_TRUE(world->status().has(Issue::range_left));
        EXPECT_EQ(world->status().first_body, 1);
    }
}

// Gravity drives the ball out of the range on its way to a floor, which stops it in the same step.
TEST_P(Rules, leaving_the_range_on_the_way_to_an_impact_is_reported) {
    if (!system().fixed_point) GTEST_SKIP() << "floating point has no such range";
    for (const Vector n : {Vector{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}}) {
        for (const Number speed : {29.0L, 31.5L}) {
            constexpr Number h = 1.0L / 16, pull = 32;
            const Number way = speed * 0.75L * h + pull * 0.75L * h * 0.75L * h / 2;
            SceneSetup setup = plane(n, 0, {placed(sphere(1, 0.5), n * (0.5L + way), n * -speed)});
            setup.step = Seconds{1, 16};
            setup.world.gravity = real(n * -pull);
            const auto world = run(setup, 1);
            EXPECT_EQ(world->status().has(Issue::range_left), speed > 30) << speed;
            EXPECT_LE(norm(world->motion(0).v), pull * h);
        }
    }
}

// A heavy ball from behind drives a light one out of the range, and gravity brings it back within the same step.
TEST_P(Rules, leaving_the_range_by_an_impact_is_reported_even_if_the_rest_of_the_step_returns) {
    if (!system().fixed_point) GTEST_SKIP() << "floating point has no such range";
    for (const Vector n : {Vector{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}}) {
        for (const Number speed : {10.0L, 24.0L}) {  // of the heavy one; half of the approach is added to it
            SceneSetup setup{.name = "driven out", .step = Seconds{1, 16}};
            setup.world = {.gravity = real(n * -320), .contact = {.restitution = 0.5}};
            setup.bodies = {placed(sphere(1000, 0.25), {}, n * speed),
                            placed(sphere(1, 0.25), n * (0.5L + (speed + 10) / 160), n * -10)};
            const auto world = run(setup, 1);
            EXPECT_EQ(world->status().has(Issue::range_left), speed > 20) << speed;
            EXPECT_LT(norm(world->motion(1).v), 30);
        }
    }
}

// --- the largest safe step of contacts by springs ----------------------------------------------------------------

// Half of the oscillator's limit 2 / w.
TEST_P(Rules, the_largest_safe_step_is_half_the_limit_of_the_fastest_oscillation) {
    constexpr Number stiffness = 1000;
    SceneSetup setup{.name = "springs", .step = Seconds{1, 1024}};
    setup.world.contact = {.response = ContactResponse::spring, .stiffness = real(stiffness)};
    const auto safe = [&] { return run(setup, 1)->largest_safe_step(); };
    setup.planes = {{}};
    for (const Number mass : {0.5L, 1.0L, 8.0L}) {
        setup.bodies = {placed(sphere(real(mass), 0.5), {0, 1, 0})};
        EXPECT_LE(std::abs(safe() * std::sqrt(stiffness / mass) - 1), tolerance::safe_step)
            << "a ball of " << mass << " kg";
        for (const Vector edges : {Vector{1, 1, 1}, {2, 1, 1}, {0.25L, 3, 0.5L}, {4, 4, 0.125L}}) {
            setup.bodies = {placed(box(real(mass), real(edges)), {0, 4, 0})};
            // Four springs: lifting, and tilting about edge i by springs that are half an edge j away, for every face
            // below.
            Number fastest = 4 * stiffness / mass;
            for (int i = 0; i < 3; ++i)
                for (int j = 0; j < 3; ++j)
                    if (i != j)
                        fastest =
                            std::max(fastest, 4 * stiffness * edges[j] * edges[j] / 4 / moments_of(setup.bodies[0])[i]);
            EXPECT_LE(std::abs(safe() * std::sqrt(fastest) - 1), tolerance::safe_step)
                << mass << " kg, edges " << edges.x << ", " << edges.y << ", " << edges.z << " m";
        }
    }
    // In a row of touching bodies, neighbours move against each other in the fastest oscillation: 3 k / m for three
    // equal bodies.
    setup.planes.clear();
    setup.bodies.clear();
    for (int i = 0; i < 3; ++i) setup.bodies.push_back(placed(sphere(2, 0.25), {0.5L * i, 0, 0}));
    EXPECT_LE(safe(), 1 / std::sqrt(3 * stiffness / 2));
}

// --- foresight ---------------------------------------------------------------------------------------------------

// A load may change a closing speed within a step, though the body was far enough to be clear of contact at the earlier
// speed.
TEST_P(Rules, a_body_that_a_force_drives_on_within_a_step_does_not_come_deeper_than_the_tolerance) {
    constexpr Number speed = 4, push = 3.875L * 256;
    for (const Vector n : {normals[0], normals[3]}) {
        for (int place = 0; place < 32; ++place) {
            const Number gap = speed / 256 * (1 + place / 20.0L);
            SceneSetup setup = plane(n, 0, {placed(sphere(1, 0.25), n * (0.25L + gap), n * -speed)});
            setup.forces = {{.body = 0, .from = 0.0, .until = 8.0, .force = real(n * -push)}};
            const auto world = build(setup, GetParam());
            expect_not_deep(
                *world, 4, [&] { return dot(world->motion(0).x, n) - 0.25L; }, gap);
        }
    }
}

// The same for two bodies, with either of them driven.
TEST_P(Rules, bodies_that_a_force_drives_at_each_other_within_a_step_do_not_come_deeper_than_the_tolerance) {
    constexpr Number speed = 4, push = 3.875L * 256;
    for (const Vector n : normals) {
        for (const int driven : {0, 1}) {
            for (int place = 0; place < 16; ++place) {
                const Number gap = speed / 256 * (1 + place / 10.0L);
                SceneSetup setup = space(0, 0, {placed(sphere(1, 0.25), n * (0.5L + gap)), sphere(1, 0.25)});
                const Vector along = driven == 0 ? -n : n;
                setup.bodies[static_cast<std::size_t>(driven)].velocity = real(along * speed);
                setup.forces = {{.body = driven, .from = 0.0, .until = 8.0, .force = real(along * push)}};
                const auto world = build(setup, GetParam());
                const auto now = [&] { return dot(world->motion(0).x - world->motion(1).x, n) - 0.5L; };
                expect_not_deep(*world, 4, now, gap);
            }
        }
    }
}

// A body hovers above a floor and has been clear of contact for half a second. Another body touches it softly, and a
// force on that one presses both down.
TEST_P(Rules, a_body_pressed_by_another_does_not_come_deeper_than_the_tolerance) {
    for (const Vector n : normals) {
        for (const bool reversed : {false, true}) {
            for (const Number push : {1.5L, 3.0L, 64.0L, 200.0L}) {
                const Number above = push < 10 ? 0.05L : 0.3L;
                constexpr Number apart = 0.002L, drift = 0.04L;
                SceneSetup setup = plane(n, 0,
                                         {placed(sphere(1, 0.25), n * (0.25L + above)),
                                          placed(sphere(1, 0.25), n * (0.75L + above + apart), n * -drift)});
                if (reversed) std::swap(setup.bodies[0], setup.bodies[1]);
                const int lower = reversed ? 1 : 0;
                setup.forces = {{.body = 1 - lower,
                                 .from = real(10 / 256.0L),  // half a millimetre apart
                                 .until = 8.0,
                                 .force = real(n * -push)}};
                const auto world = build(setup, GetParam());
                expect_not_deep(
                    *world, second, [&] { return dot(world->motion(lower).x, n) - 0.25L; }, above);
            }
        }
    }
}

// A slope deflects gravity towards a wall that is parallel to gravity.
TEST_P(Rules, a_body_that_slides_down_a_slope_to_a_wall_does_not_come_deeper_than_the_tolerance) {
    for (const Number mirror : {1.0L, -1.0L}) {
        for (int place = 0; place < 24; ++place) {
            const Number gap = 0.0015L * (1 + place * place / 8.0L), x = 0.25L + gap;
            SceneSetup setup = space(0, 0, {placed(sphere(1, 0.25), {mirror * x, (0.25L + 0.6L * x) / 0.8L, 0})});
            setup.world.gravity = gravity * Real{4};
            setup.planes = {{.normal = {real(-0.6L * mirror), 0.8, 0}}, {.normal = {real(mirror), 0, 0}}};
            const auto world = build(setup, GetParam());
            expect_not_deep(
                *world, second / 2, [&] { return mirror * world->motion(0).x.x - 0.25L; }, gap);
            EXPECT_LE(norm(world->motion(0).v), tolerance::rest_speed);
        }
    }
}

TEST_P(Rules, new_gravity_stops_a_body_at_a_plane_that_was_not_tested) {
    for (const Vector n : normals) {
        const auto world = build(plane(n, 0, {placed(sphere(1, 0.25), n * 2.25L)}), GetParam());
        world->run(3);  // at rest, with a bound on the time to contact of half a second
        world->set_gravity(n * -25);
        // It falls for 0.4 s.
        expect_not_deep(
            *world, second, [&] { return dot(world->motion(0).x, n) - 0.25L; }, 2);
        EXPECT_LE(std::abs(dot(world->motion(0).x, n) - 0.25L), tolerance::place);
        EXPECT_TRUE(world->status().ok());
    }
}

TEST_P(Rules, a_plane_added_during_a_run_stops_a_body_that_was_clear_of_contact) {
    for (const Vector n : normals) {
        const auto world = run(space(0.5L, 0, {placed(sphere(1, 0.25), n * 2.25L, n * -8)}), 3);
        ASSERT_TRUE(world->add(PlaneSpec{.normal = real(n)}));
        world->run(second / 2);
        EXPECT_LE(norm(world->motion(0).v - n * 4), 8 * rounding());
    }
}

// --- who wakes whom ----------------------------------------------------------------------------------------------

// Cubes on each other, in any order in the world.
TEST_P(Rules, a_pushed_body_wakes_all_bodies_below_it) {
    for (const bool reversed : {false, true}) {
        for (int pushed = 0; pushed < 3; ++pushed) {
            SceneSetup setup = sleepy_floor(0.5L);
            for (int i = 0; i < 3; ++i) setup.bodies.push_back(cube(0, (reversed ? 2 - i : i) + 0.5L));
            setup.bodies.push_back(cube(3, 0.5L));
            const auto world = run(setup, second);
            for (int b = 0; b < 4; ++b) ASSERT_TRUE(world->asleep(b)) << b;
            world->apply_impulse(pushed, {0.5L, 0, 0});
            for (int b = 0; b < 3; ++b) EXPECT_FALSE(world->asleep(b)) << b << " when " << pushed << " is pushed";
            EXPECT_TRUE(world->asleep(3));
        }
    }
}

TEST_P(Rules, a_spring_wakes_the_body_at_its_other_end) {
    for (const int pushed : {0, 1}) {
        for (const bool reversed : {false, true}) {
            SceneSetup setup = sleepy_floor(0.5L, {cube(0, 0.5L), cube(4, 0.5L), cube(8, 0.5L)});
            SpringSpec spring{.body = reversed ? 1 : 0, .stiffness = 4};
            spring.to_body = 1 - spring.body;
            spring.rest_length = 4;
            setup.springs = {spring};
            const auto world = run(setup, second);
            for (int b = 0; b < 3; ++b) ASSERT_TRUE(world->asleep(b)) << b;
            world->apply_impulse(pushed, {0.125L, 0, 0});
            EXPECT_FALSE(world->asleep(0)) << pushed;
            EXPECT_FALSE(world->asleep(1)) << pushed;
            EXPECT_TRUE(world->asleep(2));
        }
    }
}

// A body hovers ahead of a sleeping one and has been clear of contact for half a second. An impulse from behind the
// sleeping body arrives sooner. Three elastic balls of one mass in a row: the last takes all momentum. Forces hold the
// first two on a smooth floor, and the last, which is smaller, does not touch it.
TEST_P(Rules, a_body_woken_with_its_neighbour_hits_a_body_that_was_clear_of_contact) {
    for (const Vector n : normals) {
        for (const bool reversed : {false, true}) {
            SceneSetup setup =
                space(1, 0, {sphere(1, 0.25), placed(sphere(1, 0.25), n * 0.5L), placed(sphere(1, 0.2), n * 1.7L)});
            const Vector up = std::abs(n.x) < 0.9L ? cross(n, {1, 0, 0}) : cross(n, {0, 1, 0});
            setup.planes = {{.normal = real(up), .offset = 0.25}};
            for (int b = 0; b < 2; ++b)
                setup.forces.push_back({.body = b, .from = 0, .until = 100, .force = real(up * -8)});
            setup.world.contact.sleep.on = true;
            if (reversed) std::swap(setup.bodies[0], setup.bodies[1]);
            const int pushed = reversed ? 1 : 0;
            const auto world = run(setup, second + 4);
            ASSERT_TRUE(world->asleep(0) && world->asleep(1));
            world->apply_impulse(pushed, n * 8);
            EXPECT_FALSE(world->asleep(0) || world->asleep(1));
            world->run(second / 2);  // 4 m of flight, of which 0.75 m to the last
            EXPECT_LE(norm(world->motion(2).v - n * 8), 64 * rounding());
            EXPECT_LE(norm(world->motion(0).v) + norm(world->motion(1).v), 64 * rounding());
        }
    }
}

// Slower than the speed limit of sleep, and without friction, it goes on for the whole sleep time.
TEST_P(Rules, a_woken_body_stays_awake_for_the_whole_sleep_time) {
    const auto world = run(sleepy_floor(0, {cube(0, 0.5L)}), second);
    ASSERT_TRUE(world->asleep(0));
    const Vector start = world->motion(0).x;
    world->apply_impulse(0, {0.03125L, 0, 0});  // 1/64 m/s
    world->run(second / 2 - 1);
    EXPECT_FALSE(world->asleep(0));
    EXPECT_LE(std::abs(world->motion(0).x.x - start.x - 127 / (64 * 256.0L)), tolerance::still);
    world->run(4);
    EXPECT_TRUE(world->asleep(0));
}

TEST_P(Rules, sleep_begins_with_the_step_that_completes_its_time_and_stops_all_motion) {
    for (const int steps : {16, 128, 300}) {
        SceneSetup setup = sleepy_floor(0);
        setup.world.contact.sleep.time = real(steps / 256.0L);
        setup.bodies = {placed(sphere(1, 0.25), {0, 0.25L, 0}, {0.015625L, 0, 0}, {0, 0.03125, 0})};
        const auto world = run(setup, steps - 1);
        EXPECT_FALSE(world->asleep(0)) << steps;
        EXPECT_GT(norm(world->motion(0).v), 0);
        world->step();
        EXPECT_TRUE(world->asleep(0)) << steps;
        EXPECT_EQ(norm(world->motion(0).v) + norm(world->motion(0).w), 0) << steps;
    }
}

// A force holds the body 0.05 mm above the gap of a contact, for longer than the sleep time. Then it sinks.
TEST_P(Rules, the_sleep_time_counts_from_the_contact) {
    for (const Number mass : {1.0L, 4.0L}) {
        SceneSetup setup = sleepy_floor(0.25L);
        setup.bodies = {placed(sphere(real(mass), 0.25), {0, 0.25L + tolerance::contact_band + 5e-5L, 0})};
        const Number weight = mass * g;
        setup.forces = {{.body = 0, .from = 0.0, .until = 1.0, .force = {0, real(weight), 0}},
                        {.body = 0, .from = 1.0, .until = 9.0, .force = {0, real(0.99L * weight), 0}}};
        const auto world = run(setup, second);
        ASSERT_FALSE(world->asleep(0));
        int steps = 0;
        for (; steps < second && !world->asleep(0); ++steps) world->step();
        EXPECT_GE(steps, second / 2) << mass;
        EXPECT_LE(steps, second / 2 + 16) << mass;  // 8 of them until it touches
    }
}

TEST_P(Rules, new_gravity_wakes_sleepers) {
    const auto world = run(sleepy_floor(0.25L, {cube(0, 0.5L), cube(4, 0.5L)}), second);
    ASSERT_TRUE(world->asleep(0));
    world->set_gravity({4.90625L, -9.8125L, 0});
    EXPECT_FALSE(world->asleep(0));
    EXPECT_FALSE(world->asleep(1));
    const Vector start = world->motion(0).x;
    world->run(second);
    EXPECT_LE(std::abs((world->motion(0).x.x - start.x) / (g / 8) - 1), 2 * tolerance::sliding);  // (g/2 - g/4) / 2
}

TEST_P(Rules, a_plane_added_during_a_run_wakes_sleepers) {
    const auto world = run(sleepy_floor(0.5L, {cube(0, 0.5L)}), second);
    ASSERT_TRUE(world->asleep(0));
    ASSERT_TRUE(world->add(PlaneSpec{.normal = {1, 0, 0}, .offset = 4}));
    EXPECT_FALSE(world->asleep(0));
    world->run(second);
    EXPECT_TRUE(world->asleep(0));
}

// The body moves with the table, more slowly than the speed limit of sleep.
TEST_P(Rules, nothing_sleeps_on_a_turntable) {
    for (const Number turns : {0.015625L, -0.015625L}) {
        SceneSetup setup = sleepy_floor(1);
        setup.planes.clear();
        setup.bodies = {fixed(placed(box(100, {8, 0.5, 8}), {0, -0.25L, 0}, {}, {0, turns, 0})),
                        placed(box(1, {0.5, 0.25, 0.5}), {1, 0.125L, 0}, {0, 0, -turns}, {0, turns, 0})};
        const auto world = run(setup, 4 * second);
        EXPECT_FALSE(world->asleep(1));
        EXPECT_LE(norm(world->motion(1).x - Vector{std::cos(4 * turns), 0.125L, -std::sin(4 * turns)}),
                  4 * tolerance::still + tolerance::creep)
            << turns;
    }
}

// --- depth -------------------------------------------------------------------------------------------------------

// In a step, an eighth of the penetration beyond a quarter of the tolerance, at most an eighth of the tolerance.
TEST_P(Rules, a_deep_penetration_is_corrected_as_slowly_as_promised) {
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

// --- free rotation after an impulse ------------------------------------------------------------------------------

class Impulses : public CaseTest {};
INSTANTIATE_TEST_SUITE_P(every, Impulses, testing::ValuesIn(every_case()), NameOf{});

// A method prepares its constants anew after an impulse: a body that is struck in flight moves like one that starts
// with the motion after the impulse.
TEST_P(Impulses, a_struck_body_moves_like_one_that_starts_with_its_motion) {
    for (const Vector impulse : {Vector{0, 0, 2}, {1, -0.5L, 0.25L}, {-2, 1, 3}}) {
        SceneSetup setup{.name = "struck", .bodies = {placed(box(2, {0.5, 1, 0.75}), {}, {}, {1, -2, 0.5})}};
        const auto struck = run(setup, 37);
        struck->apply_impulse(0, impulse, {0.25L, 0.5L, -0.125L});
        const Motion m = struck->motion(0);
        setup.bodies[0].position = real(m.x);
        setup.bodies[0].velocity = real(m.v);
        setup.bodies[0].orientation = real(m.q);
        setup.bodies[0].angular_velocity = real(m.w);
        struck->run(128);
        const auto started = run(setup, 128);
        EXPECT_LE(angle_between(struck->motion(0).q, started->motion(0).q), 16 * tolerance::same_flight.of(system()));
        EXPECT_LE(norm(struck->motion(0).w - started->motion(0).w),
                  16 * tolerance::same_flight.of(system()) * norm(m.w));
    }
}

}  // namespace
}  // namespace tumble::test
