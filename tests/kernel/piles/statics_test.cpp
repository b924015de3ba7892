// Islands at rest, which statics solve: whatever the masses, the step and the order of the bodies are, nothing moves.
// Where friction or a support does not suffice, bodies move by the laws of motion.
#include "contact_cases.hpp"

#include <utility>

namespace tumble::test {
namespace {

class Statics : public CaseTest {
protected:
    // m: what rounding of places and the solver may move a resting body
    static constexpr Number rounding = 1e-6L;

    // Whether no body of the scene has moved or turned.
    static void expect_at_rest(const SceneSetup& setup, int steps, const std::string& about) {
        const auto world = run(setup, steps);
        for (int b = 0; b < world->body_count(); ++b) {
            const BodySpec& body = setup.bodies[static_cast<std::size_t>(b)];
            const Motion m = world->motion(b);
            EXPECT_LE(norm(m.x - vector(body.position)), rounding) << about << ", body " << b;
            EXPECT_LE(angle_between(m.q, rotation(body.orientation).normalized()), rounding) << about << ", body " << b;
            EXPECT_LE(norm(m.v) + norm(m.w), rounding) << about << ", body " << b;
        }
        EXPECT_TRUE(world->status().ok()) << about;
    }
    static BodySpec at(const BodySpec& body, Number x, Number y, Number z = 0) { return placed(body, {x, y, z}); }
    // About the vertical, by 2 atan(t).
    static BodySpec turned(const BodySpec& body, Number t) { return oriented(body, {1, {0, real(t), 0}}); }
    static SceneSetup reversed(SceneSetup setup) {
        std::reverse(setup.bodies.begin(), setup.bodies.end());
        return setup;
    }
};
INSTANTIATE_TEST_SUITE_P(every, Statics, testing::ValuesIn(contact_cases()), NameOf{});

TEST_P(Statics, a_light_box_carries_a_body_of_any_mass) {
    for (const Number friction : {0.5L, 0.0L}) {
        for (const Number mass : {0.0625L, 30.0L, 300.0L, 3000.0L}) {
            for (const bool ball : {false, true}) {
                const Real m = real(mass);
                SceneSetup setup = floor(0, friction, {at(box(1, {1, 1, 1}), 0, 0.5L)});
                setup.bodies.push_back(ball ? at(sphere(m, 0.125), 0.25L, 1.125L, -0.125L)
                                            : at(box(m, {0.5, 0.25, 0.375}), -0.125L, 1.125L, 0.25L));
                const std::string about = std::to_string(static_cast<double>(mass)) + (ball ? " kg ball" : " kg box");
                expect_at_rest(setup, 64, about);
                expect_at_rest(reversed(setup), 64, about + ", reversed");
            }
        }
    }
}

// Boxes that slide as one over a floor or an incline.
enum class Pile { box, tower, pyramid, bridge };
SceneSetup sliding(Pile pile, Number friction, Number slope, Vector velocity, const Axes3& axes, bool reversed) {
    SceneSetup setup = space(0, friction);
    setup.world.gravity = real(axes.to_world(Vector{g * std::sin(slope), -g * std::cos(slope), 0}));
    setup.planes = {axes.plane({0, 1, 0})};
    const auto add = [&](Number mass, Vector edges, Vector place) {
        setup.bodies.push_back(oriented(
            placed(box(real(mass), real(edges)), axes.to_world(place), axes.to_world(velocity)), real(axes.turn())));
    };
    const Vector brick{0.5L, 0.125L, 0.375L};
    if (pile == Pile::box) add(2, brick, {0, 0.0625L, 0});
    for (int i = 0; pile == Pile::tower && i < 6; ++i)
        add(1 + i % 3, brick, {0.0078125L * i, 0.0625L + 0.125L * i, 0.015625L * (i % 2)});
    for (int row = 0; pile == Pile::pyramid && row < 3; ++row)
        for (int i = 0; i < 3 - row; ++i) add(1 + i, brick, {0.5625L * i + 0.28125L * row, 0.0625L + 0.125L * row, 0});
    if (pile == Pile::bridge) {
        for (int i = 0; i < 3; ++i) add(1, {0.25L, 0.25L, 0.25L}, {0.75L * i, 0.125L, 0});
        add(30, {2, 0.125L, 0.5L}, {0.75L, 0.3125L, 0});
    }
    if (reversed) std::reverse(setup.bodies.begin(), setup.bodies.end());
    return setup;
}
constexpr Pile piles[] = {Pile::box, Pile::tower, Pile::pyramid, Pile::bridge};

// Their friction is that of one body: v' = g (sin - mu cos) along the incline, mu g against the motion.
TEST_P(Statics, bodies_that_slide_as_one_slide_by_coulombs_law) {
    for (const Pile pile : piles) {
        for (const Number friction : {0.0L, 0.25L}) {
            for (const Number slope : {0.0L, 0.125L, 0.375L}) {
                for (const Number speed : {0.0L, 2.0L}) {
                    const SceneSetup setup = sliding(pile, friction, slope, {speed, 0, 0}, {}, false);
                    const auto world = build(setup, GetParam());
                    const bool slides = speed > 0 || std::tan(slope) > friction;
                    const Number faster = slides ? g * (std::sin(slope) - friction * std::cos(slope)) : 0;
                    for (int step = 1; step <= second / 2; ++step) {
                        world->step();
                        for (int b = 0; b < world->body_count(); ++b)
                            for (const ReadContact& c : world->contacts(b))
                                EXPECT_LE(norm(c.friction_impulse), 1.001L * friction * c.normal_impulse + 1e-5L);
                    }
                    for (int b = 0; b < world->body_count(); ++b) {
                        const Vector start = vector(setup.bodies[static_cast<std::size_t>(b)].position),
                                     way = {speed / 2 + faster / 8, 0, 0};
                        EXPECT_LE(norm(world->motion(b).x - start - way), system().bits == 64 ? 1e-10L : 1e-5L)
                            << "body " << b << ", slope " << slope << ", friction " << friction;
                        EXPECT_LE(norm(world->motion(b).w), system().bits == 64 ? 1e-10L : 1e-5L);
                    }
                    EXPECT_TRUE(world->status().ok());
                }
            }
        }
    }
}

TEST_P(Statics, what_slides_as_one_slides_alike_mirrored_turned_and_reordered) {
    Random random{29};
    for (const Pile pile : piles) {
        for (const Number slope : {0.0L, 0.375L}) {
            const Vector velocity{1, 0, 0.5L};
            const auto one = run(sliding(pile, 0.25L, slope, velocity, {}, false), second);
            for (int i = 0; i < 4; ++i) {
                const Axes3 axes{random};
                const bool reversed = i % 2 == 1;
                const auto other = run(sliding(pile, 0.25L, slope, velocity, axes, reversed), second);
                for (int b = 0; b < one->body_count(); ++b) {
                    const Vector x = one->motion(b).x, y = other->motion(reversed ? one->body_count() - 1 - b : b).x;
                    EXPECT_LE(norm(axes.from_world(y) - x), system().bits == 64 ? 1e-9L : 1e-4L) << "body " << b;
                }
            }
        }
    }
}

// A plank with one edge on a floor and the other on a ramp, tilted by a tenth of a radian.
SceneSetup plank_on_ramp(Number slope, Number friction, bool mirrored) {
    const Number side = mirrored ? -1 : 1, tilt = 0.1L, length = 1, height = 0.125L;
    SceneSetup setup = floor(0, friction);
    setup.planes.push_back({.normal = real(Vector{-side * std::sin(slope), std::cos(slope), 0})});
    const Number right = length * std::sin(tilt) / std::tan(slope), left = right - length * std::cos(tilt);
    const Vector centre{(left + right) / 2 - std::sin(tilt) * height / 2,
                        length * std::sin(tilt) / 2 + std::cos(tilt) * height / 2, 0};
    setup.bodies = {oriented(placed(box(2, {real(length), real(height), 1}), {side * centre.x, centre.y, 0}),
                             {1, {0, 0, real(side * std::tan(tilt / 2))}})};
    return setup;
}

// The sum of both pushes is upright, and each lies in its cone: the plank stands if the ramp's slope is within twice
// the angle of friction.
TEST_P(Statics, a_plank_stands_on_a_floor_and_a_ramp_up_to_twice_the_angle_of_friction) {
    for (const bool mirrored : {false, true}) {
        for (const Number slope : {0.2L, 0.5L, 0.8L, 1.0L}) {
            for (const Number friction : {0.125L, 0.3L, 0.6L}) {
                const SceneSetup setup = plank_on_ramp(slope, friction, mirrored);
                const Number limit = 2 * std::atan(friction);
                const auto world = build(setup, GetParam());
                for (int step = 0; step < second; ++step) {
                    world->step();
                    for (const ReadContact& c : world->contacts(0))
                        EXPECT_LE(norm(c.friction_impulse), 1.001L * friction * c.normal_impulse + 1e-6L);
                }
                const Number way = norm(world->motion(0).x - vector(setup.bodies[0].position));
                EXPECT_TRUE(slope > 0.97L * limit || way < 1e-5L) << slope << ", friction " << friction;
                EXPECT_TRUE(slope < 1.03L * limit || way > 1e-3L) << slope << ", friction " << friction;
            }
        }
    }
}

TEST_P(Statics, a_tower_of_ten_boxes_stands_at_sixty_steps_a_second) {
    for (const Number growth : {1.0L, 1.5L, 0.75L}) {
        SceneSetup setup = floor(0, 0.5L);
        setup.step = {1, 60};
        Number mass = 1;
        for (int i = 0; i < 10; ++i) {
            setup.bodies.push_back(at(box(real(mass), {0.25, 0.25, 0.5}), 0, 0.125L + 0.25L * i));
            mass *= growth;
        }
        const std::string about = "masses grow by " + std::to_string(static_cast<double>(growth));
        expect_at_rest(setup, 120, about);
        expect_at_rest(reversed(setup), 120, about + ", reversed");
    }
}

TEST_P(Statics, boxes_that_stand_turned_and_shifted_rest_and_so_does_the_mirror_image) {
    for (const Number side : {1.0L, -1.0L}) {
        for (const bool fixed_ground : {false, true}) {
            SceneSetup setup = floor(0, 0.5L);
            if (fixed_ground) {
                setup.planes.clear();
                setup.bodies.push_back(fixed(at(box(1, {8, 1, 8}), 0, -0.5L)));
            }
            setup.bodies.push_back(turned(at(box(2, {1, 0.5, 0.75}), 0, 0.25L), side * 0.25L));
            setup.bodies.push_back(turned(at(box(20, {0.5, 0.5, 1}), side * 0.125L, 0.75L, 0.0625L), side * 0.125L));
            setup.bodies.push_back(at(box(0.5, {0.75, 0.25, 0.5}), side * 0.25L, 1.125L, 0.125L));
            setup.bodies.push_back(at(sphere(50, 0.25), side * 0.25L, 1.5L, 0.125L));
            expect_at_rest(setup, 128, side > 0 ? "to the right" : "to the left");
        }
    }
}

// Far from the middle of four points the evenest share would pull at some of them.
TEST_P(Statics, a_load_over_a_corner_is_carried_by_the_points_near_it) {
    for (const Number x : {-0.46875L, 0.0L, 0.46875L})
        for (const Number z : {-0.46875L, 0.46875L})
            expect_at_rest(floor(0, 0.5L, {at(box(1, {1, 0.5, 1}), 0, 0.25L), at(sphere(100, 0.25), x, 0.75L, z)}), 64,
                           "over " + std::to_string(static_cast<double>(x)) + ", " +
                               std::to_string(static_cast<double>(z)));
}

// The slope falls towards -x for side 1. Its tangent is 3/4.
TEST_P(Statics, a_box_on_an_incline_rests_below_the_friction_angle_and_slides_above_it) {
    for (const Number side : {1.0L, -1.0L}) {
        for (const Number mass : {0.25L, 40.0L}) {
            for (const Number friction : {0.5L, 0.74L, 0.76L, 1.0L}) {
                SceneSetup setup = floor(0, friction);
                setup.planes[0].normal = {real(-3 * side), 4, 0};
                const Vector off{-0.6L * side, 0.8L, 0}, down{-0.8L * side, -0.6L, 0};
                setup.bodies.push_back(
                    oriented(placed(box(real(mass), {1, 0.25, 0.75}), off * 0.125L), {3, {0, 0, real(side)}}));
                const std::string about = "friction " + std::to_string(static_cast<double>(friction));
                if (friction > 0.75L) {
                    expect_at_rest(setup, 128, about);
                    continue;
                }
                const auto world = run(setup, 128);  // half a second
                const Number way = 0.5L * g * (0.6L - 0.8L * friction) * 0.25L;
                const Vector moved = world->motion(0).x - vector(setup.bodies[0].position);
                EXPECT_NEAR(static_cast<double>(dot(moved, down)), static_cast<double>(way), 1e-5) << about;
                EXPECT_LE(norm(moved - down * dot(moved, down)), 1e-5L) << about;
            }
        }
    }
}

TEST_P(Statics, a_box_whose_centre_overhangs_its_support_falls) {
    for (const Number side : {1.0L, -1.0L}) {
        for (const Number overhang : {0.484375L, 0.515625L}) {
            const SceneSetup setup =
                floor(0, 0.5L, {at(box(8, {1, 1, 1}), 0, 0.5L), at(box(1, {1, 0.5, 0.5}), side * overhang, 1.25L)});
            if (overhang < 0.5L) {
                expect_at_rest(setup, 128, "within the support");
                continue;
            }
            const auto world = run(setup, 256);
            EXPECT_LT(world->motion(1).x.y, 1.2L);
            EXPECT_GT(side * world->motion(1).x.x, overhang);
        }
    }
}

// A ball has no face to stand on: it rolls down the flattest slope.
TEST_P(Statics, a_ball_on_a_slope_of_a_thousandth_rolls) {
    SceneSetup setup = floor(0, 0.5L, {at(sphere(2, 0.25), 0, 0.25L)});
    setup.world.gravity.x = real(g / 1024);
    const auto world = run(setup, 256);
    EXPECT_NEAR(static_cast<double>(world->motion(0).x.x), static_cast<double>(g / 1024 * 5 / 14), 1e-6);
}

// Upon a board of 1 kg on the floor.
TEST_P(Statics, a_heavy_body_slides_to_rest_or_rolls_on_a_light_one_that_stays) {
    for (const Number side : {1.0L, -1.0L}) {
        for (const bool first : {false, true}) {
            for (const bool ball : {false, true}) {
                SceneSetup setup = floor(0, 0.5L, {at(box(1, {4, 0.25, 4}), 0, 0.125L)});
                BodySpec heavy = ball ? at(sphere(1000, 0.25), 0, 0.5L) : at(box(1000, {0.5, 0.25, 0.75}), 0, 0.375L);
                heavy.velocity.x = real(side);
                if (ball) heavy.angular_velocity.z = real(-4 * side);  // it rolls
                setup.bodies.push_back(heavy);
                if (first) setup = reversed(setup);
                const int mover = first ? 0 : 1, board = 1 - mover;
                const auto world = run(setup, second / 2);
                const Number way = ball ? 0.5L : 1 / (2 * 0.5L * g);
                EXPECT_NEAR(static_cast<double>(side * world->motion(mover).x.x), static_cast<double>(way), 1e-5);
                EXPECT_LE(norm(world->motion(board).x - Vector{0, 0.125L, 0}), rounding);
                EXPECT_LE(norm(world->motion(board).v) + norm(world->motion(board).w), rounding);
                EXPECT_TRUE(world->status().ok());
            }
        }
    }
}

// Rows of boxes, each of which stands on two others, or on the floor. `beside`: the gap between neighbours.
std::vector<BodySpec> pyramid(int rows, Number beside, Number above) {
    std::vector<BodySpec> bodies;
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < rows - row; ++i)
            bodies.push_back(placed(box(real(1 + 0.25L * i), {0.5, 0.25, 0.25}),
                                    {(0.5L + beside) * (i + 0.5L * row), 0.125L + (0.25L + above) * row, 0}));
    return bodies;
}

TEST_P(Statics, a_pyramid_stands_with_its_boxes_apart_or_side_by_side) {
    for (const Number friction : {0.5L, 0.0L}) {
        for (const Number beside : {0.0L, 1e-4L, 0.0625L, 0.125L}) {
            SceneSetup setup = floor(0, friction, pyramid(4, beside, 0));
            const std::string about = std::to_string(static_cast<double>(beside)) + " m beside each other";
            expect_at_rest(setup, 64, about);
            expect_at_rest(reversed(setup), 64, about + ", reversed");
            std::swap(setup.bodies[1], setup.bodies[7]);
            std::swap(setup.bodies[2], setup.bodies[9]);
            expect_at_rest(setup, 64, about + ", in another order");
        }
    }
}

TEST_P(Statics, a_box_on_four_legs_carries_a_body_of_any_mass) {
    for (const Number mass : {0.01L, 1.0L, 1000.0L}) {
        SceneSetup setup = floor(0, 0.5L, {at(box(3, {1.25, 0.125, 1.25}), 0, 0.5625L)});
        for (const Number x : {-0.5L, 0.5L})
            for (const Number z : {-0.5L, 0.5L})
                setup.bodies.push_back(at(box(real(1 + 0.5L * x), {0.25, 0.5, 0.25}), x, 0.25L, z));
        setup.bodies.push_back(at(box(real(mass), {0.25, 0.25, 0.25}), 0.0625L, 0.75L, -0.125L));
        const std::string about = std::to_string(static_cast<double>(mass)) + " kg";
        expect_at_rest(setup, 64, about);
        expect_at_rest(reversed(setup), 64, about + ", reversed");
    }
}

TEST_P(Statics, a_bridge_carries_a_body_of_any_mass) {
    for (const Number mass : {0.01L, 1.0L, 1000.0L}) {
        for (const Number at_x : {0.0L, 0.25L, -0.3125L}) {
            SceneSetup setup = floor(0, 0.5L, {at(box(1, {0.25, 0.5, 0.5}), -0.5L, 0.25L)});
            setup.bodies.push_back(at(box(2, {0.25, 0.5, 0.5}), 0.5L, 0.25L));
            setup.bodies.push_back(at(box(3, {1.25, 0.125, 0.5}), 0, 0.5625L));
            setup.bodies.push_back(at(box(real(mass), {0.25, 0.25, 0.25}), at_x, 0.75L, 0.03125L));
            const std::string about = std::to_string(static_cast<double>(mass)) + " kg";
            expect_at_rest(setup, 64, about);
            expect_at_rest(reversed(setup), 64, about + ", reversed");
        }
    }
}

TEST_P(Statics, what_stands_keeps_its_bits_until_it_is_pushed) {
    for (const bool tower : {false, true}) {
        SceneSetup setup = floor(0, 0.5L, pyramid(3, 0.0625L, 1e-4L));
        setup.world.gravity = {0.5, real(-g), 0.25};
        if (tower) {
            setup.bodies.clear();
            for (int i = 0; i < 6; ++i)
                setup.bodies.push_back(turned(at(box(2, {0.5, 0.25, 0.5}), 0, 0.125L + 0.2501L * i), 0.0625L * i));
        }
        const auto world = run(setup, second / 4);
        const auto hash = world->hash();
        for (int step = 0; step < second / 4; ++step) {
            world->step();
            ASSERT_EQ(world->hash(), hash) << (tower ? "tower" : "pyramid") << ", step " << step;
        }
        // The top body slides to rest, and the others stay. Then all keep their bits again.
        const int top = world->body_count() - 1;
        const Motion before = world->motion(top);
        world->apply_impulse(top, {0.5L, 0, 0});
        world->run(second / 2);
        EXPECT_GT(world->motion(top).x.x, before.x.x + 1e-3L);
        const auto after = world->hash();
        world->run(second / 4);
        EXPECT_EQ(world->hash(), after) << (tower ? "tower" : "pyramid");
    }
}

TEST_P(Statics, what_stands_moves_as_soon_as_its_loads_do_not_hold) {
    SceneSetup setup = floor(0, 0.5L, {at(box(2, {1, 0.5, 1}), 0, 0.25L), at(box(2, {1, 0.5, 1}), 0, 0.75L)});
    // Friction holds half of the weight.
    setup.forces.push_back({.body = 1, .from = 0.25, .until = 0.5, .force = {real(0.96L * g), 0, 0}});
    setup.forces.push_back({.body = 1, .from = 0.5, .until = 10.0, .force = {real(1.04L * g), 0, 0}});
    const auto world = run(setup, second / 2);
    EXPECT_LE(norm(world->motion(1).x - vector(setup.bodies[1].position)), rounding);
    world->run(second / 2);
    const Number expected = 0.5L * (0.02L * g) * 0.25L;
    EXPECT_NEAR(static_cast<double>(world->motion(1).x.x), static_cast<double>(expected),
                static_cast<double>(0.01L * expected));
    EXPECT_LE(norm(world->motion(0).x - vector(setup.bodies[0].position)), rounding);
}

// The solver's resolution is that of the heaviest body of an island.
TEST_P(Statics, what_falls_or_is_pushed_beside_a_heavy_body_at_rest_moves) {
    for (const Number ratio : {1.0L, 1e3L, 1e4L}) {
        SceneSetup setup = floor(0, 0.5L, {at(box(real(ratio), {0.5, 0.5, 0.5}), 0, 0.25L)});
        setup.bodies.push_back(at(sphere(1, 0.0625), 0.3125L, 0.0625L + 0.00390625L));
        setup.bodies.push_back(at(box(1, {0.125, 0.125, 0.125}), -0.3134765625L, 0.0625L));
        setup.forces.push_back({.body = 2, .from = 0.0, .until = 1.0, .force = {0, 0, real(0.75L * g)}});
        const auto world = run(setup, second / 4);
        EXPECT_LE(world->motion(1).x.y, 0.0625L + 1e-4L) << "mass ratio " << ratio;
        const Number expected = 0.5L * (0.25L * g) * 0.0625L;
        EXPECT_LE(std::abs(world->motion(2).x.z - expected), 0.02L * expected) << "mass ratio " << ratio;
    }
}

// Smooth supports hold a body only where their pushes together do.
TEST_P(Statics, a_smooth_body_slides_off_supports_of_which_one_is_tilted) {
    for (const bool tilted_first : {false, true}) {
        SceneSetup setup = floor(0, 0);
        const Number tilt = 0.0009L;  // about the middle of its upper face
        for (const bool tilted : {tilted_first, !tilted_first}) {
            BodySpec support = fixed(at(box(1, {0.3, 0.5, 0.5}), -0.5L, 0.25L));
            if (tilted) {
                support =
                    fixed(at(box(1, {0.3, 0.5, 0.5}), 0.5L + 0.25L * std::sin(tilt), 0.5L - 0.25L * std::cos(tilt)));
                support = oriented(support, {1, {0, 0, real(std::tan(tilt / 2))}});
            }
            setup.bodies.push_back(support);
        }
        setup.bodies.push_back(at(box(1, {1.2, 0.1, 0.5}), 0, 0.55L));
        const auto world = run(setup, second);
        EXPECT_LT(world->motion(2).x.x, -5e-4L) << (tilted_first ? "the tilted one first" : "the tilted one last");
    }
}

TEST_P(Statics, a_body_lies_on_two_points) {
    const SceneSetup setup = floor(0, 0.5L, {at(capsule(3, 0.125, 0.5), 0, 0.125L)});
    expect_at_rest(setup, 64, "capsule");
}

}  // namespace
}  // namespace tumble::test
