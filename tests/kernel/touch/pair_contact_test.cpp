// Impacts between bodies: the closed forms of two spheres, Coulomb's law, the impulse formula off the centre, the
// conserved quantities, and that no body passes through another at any speed.
#include "contact_cases.hpp"

namespace tumble::test {
namespace {

// A random unit vector perpendicular to n.
Vector across(Vector n, Random& random) {
    const Vector c = cross(n, direction(random));
    return norm(c) > 0.1L ? c * (1 / norm(c)) : across(n, random);
}

class Pairs : public CaseTest {};
INSTANTIATE_TEST_SUITE_P(every, Pairs, testing::ValuesIn(contact_cases()), NameOf{});

TEST_P(Pairs, any_two_spheres_follow_the_impulse_formula_and_coulombs_law) {
    Random random{4};
    int stuck = 0, slid = 0;
    for (int i = 0; i < 40; ++i) {
        const Number restitution = random.uniform(0.125, 1), friction = i % 4 == 0 ? 0.0 : random.uniform(0.05, 0.6);
        SceneSetup setup = space(restitution, friction);
        const auto any_sphere = [&] {
            const Real mass = random.uniform(0.5, 4), radius = random.uniform(0.25, 0.5);
            return sphere(mass, radius);
        };
        BodySpec a = any_sphere(), b = any_sphere();
        // They meet after a random time with the line of centres along n.
        const Vector n = direction(random), tangent = across(n, random), common = direction(random);
        const Number cosine = random.uniform(0.5, 1), speed = random.uniform(2, 6), time = random.uniform(0.0625, 0.25);
        const Vector relative = (n * -cosine + tangent * std::sqrt(1 - cosine * cosine)) * speed;
        const Number distance = number(a.shape.size.x) + number(b.shape.size.x);
        const Vector spin_a = direction(random) * 4, spin_b = direction(random) * 4;
        a = placed(a, n * distance - (relative + common) * time, relative + common, spin_a);
        b = placed(b, -common * time, common, spin_b);
        setup.bodies = {a, b};
        const auto world = run(setup, 128);
        Struck first{start_of(a), a, n * -number(a.shape.size.x)}, second{start_of(b), b, n * number(b.shape.size.x)};
        (collide(first, second, n, restitution, friction) ? stuck : slid) += friction > 0 ? 1 : 0;
        const Bound allowed = 16 * tolerance::oblique.of(system());
        EXPECT_LE(norm(world->motion(0).v - first.motion.v), allowed) << "meeting " << i;
        EXPECT_LE(norm(world->motion(1).v - second.motion.v), allowed) << "meeting " << i;
        // The smallest radius converts speed to spin.
        EXPECT_LE(norm(world_spin(world->motion(0)) - first.motion.w), 10 * allowed) << "meeting " << i;
        EXPECT_LE(norm(world_spin(world->motion(1)) - second.motion.w), 10 * allowed) << "meeting " << i;
    }
    EXPECT_GE(std::min(stuck, slid), 5) << stuck << " stick, " << slid << " slide";
}

TEST_P(Pairs, a_sphere_that_hits_a_plane_obliquely_sticks_or_slides_by_coulombs_law) {
    struct Throw {
        Vector velocity, spin;
    };
    const Vector n{0, 1, 0};
    const BodySpec wall = fixed(sphere(1, 1));  // in the formula, it takes the place of the plane
    int stuck = 0, slid = 0;
    for (const Throw& thrown :
         {Throw{{1, -4, 0}, {}}, Throw{{6, -2, 1}, {}}, Throw{{2, -3, 0}, {0, 0, 8}}, Throw{{2, -3, 0}, {0, 0, -8}},
          Throw{{0, -2, 0}, {4, 2, -12}}, Throw{{3, -1, -2}, {-4, 6, 1}}, Throw{{-1, -4, 0.5L}, {0, 5, 0}}}) {
        for (const Number friction : {0.125L, 0.5L}) {
            for (const Number restitution : {0.0L, 0.5L, 1.0L}) {
                SceneSetup setup = space(restitution, friction);
                setup.planes = {{}};
                BodySpec ball = placed(sphere(2, 0.25), Vector{0, 0.25L, 0} - thrown.velocity * 0.201L, thrown.velocity,
                                       thrown.spin);
                setup.bodies = {ball};
                const auto world = run(setup, 64);
                Struck struck{start_of(ball), ball, n * -0.25L}, still{Motion{}, wall, Vector{}};
                (collide(struck, still, n, restitution, friction) ? stuck : slid) += 1;
                const Bound allowed = 16 * tolerance::levered.of(system());
                EXPECT_LE(norm(world->motion(0).v - struck.motion.v), allowed)
                    << "v " << thrown.velocity.x << " " << thrown.velocity.y << ", mu " << friction << ", e "
                    << restitution;
                EXPECT_LE(norm(world_spin(world->motion(0)) - struck.motion.w), 10 * allowed)
                    << "v " << thrown.velocity.x << " " << thrown.velocity.y << ", mu " << friction << ", e "
                    << restitution;
            }
        }
    }
    EXPECT_GE(std::min(stuck, slid), 6) << stuck << " stick, " << slid << " slide";
}

TEST_P(Pairs, a_rod_hit_off_its_centre_by_a_sphere_gets_the_spin_of_the_impulse_formula) {
    const RealQuat orientations[] = {{}, {0.9, {0.1, -0.3, 0.2}}, {0.25, {-0.5, 0.75, 0.125}}};
    for (const RealQuat& orientation : orientations) {
        for (const Vector offset : {Vector{0, 0, 0}, Vector{0.75L, 0, 0}, Vector{-0.875L, 0.03125L, 0}}) {
            for (const Number restitution : {0.5L, 1.0L}) {
                SceneSetup setup = space(restitution);
                const BodySpec rod = oriented(box(2, {2, 0.125, 0.25}), orientation);
                const Rotation q = start_of(rod).q;
                const Vector n = q.rotate({0, 0, 1}), start = q.rotate(offset + Vector{0, 0, 0.25L + 0.7L});
                const BodySpec ball = placed(sphere(0.5, 0.125), start, n * -4);
                setup.bodies = {ball, rod};
                const auto world = build(setup, GetParam());
                ASSERT_TRUE(step_to_impact(*world, 0));
                Struck hits{start_of(ball), ball, n * -0.125L},
                    hit{start_of(rod), rod, q.rotate(offset + Vector{0, 0, 0.125L})};
                collide(hits, hit, n, restitution, 0);
                const Bound allowed = 8 * tolerance::levered.of(system());
                EXPECT_LE(norm(world->motion(0).v - hits.motion.v), allowed) << offset.x << ", e " << restitution;
                EXPECT_LE(norm(world->motion(1).v - hit.motion.v), allowed) << offset.x << ", e " << restitution;
                // The rest of the step rotates w if the body is not a sphere, so momenta are compared.
                const Vector moments = moments_of(rod), expected = angular_momentum(hit.motion, moments);
                const Number angle = norm(hit.motion.w) / 256;
                EXPECT_LE(norm(angular_momentum(world->motion(1), moments) - expected),
                          2 * allowed + tolerance::method_error(order(), angle, angle) * norm(expected))
                    << offset.x << ", e " << restitution;
                EXPECT_LE(norm(world->motion(0).w), allowed);
                EXPECT_EQ(norm(offset) > 0, norm(expected) > 0.1L);
            }
        }
    }
}

TEST_P(Pairs, a_corner_of_a_box_on_the_face_of_another_gives_both_the_spin_of_the_impulse_formula) {
    for (const Number restitution : {0.5L, 1.0L}) {
        SceneSetup setup = space(restitution);
        const BodySpec falls =
            oriented(placed(box(2, {1, 0.5, 0.75}), {0.5L, 1.5L, -0.25L}, {0, -4, 0}), {0.9, {0.1, -0.3, 0.2}});
        const BodySpec table = box(5, {3, 0.5, 3});
        setup.bodies = {falls, table};
        const Rotation q = start_of(falls).q;
        const Vector n{0, 1, 0}, n_b = q.rotate_back(n);
        const Vector corner = q.rotate(
            {n_b.x > 0 ? -0.5L : 0.5L, n_b.y > 0 ? -0.25L : 0.25L, n_b.z > 0 ? -0.375L : 0.375L});  // the lowest
        const Vector touches = Vector{0.5L, 0, -0.25L} + Vector{corner.x, 0.25L, corner.z};
        Struck a{start_of(falls), falls, corner}, b{start_of(table), table, touches};
        collide(a, b, n, restitution, 0);
        const auto world = build(setup, GetParam());
        ASSERT_TRUE(step_to_impact(*world, 0));
        const Bound allowed = 8 * tolerance::levered.of(system());
        const Struck* expected[] = {&a, &b};
        for (int i = 0; i < 2; ++i) {
            const Motion& right = expected[i]->motion;
            const Vector moments = moments_of(expected[i]->body), l = angular_momentum(right, moments);
            const Number angle = norm(right.w) / 256;
            EXPECT_LE(norm(world->motion(i).v - right.v), allowed) << "body " << i << ", e " << restitution;
            EXPECT_LE(norm(angular_momentum(world->motion(i), moments) - l),
                      2 * allowed + tolerance::method_error(order(), angle, angle) * norm(l))
                << "body " << i << ", e " << restitution;
        }
    }
}

TEST_P(Pairs, an_edge_and_a_corner_of_a_box_send_a_sphere_back_the_way_it_came) {
    for (const Vector towards : {Vector{1, 1, 0}, Vector{0, -1, 1}, Vector{1, -1, 1}, Vector{-1, -1, -1}}) {
        const Vector n = towards * (1 / norm(towards));
        const auto world =
            build(space(1, 0, {placed(sphere(1, 0.25), n * 3, n * -4), fixed(box(1, {1, 1, 1}))}), GetParam());
        ASSERT_TRUE(step_to_impact(*world, 0));
        EXPECT_LE(norm(world->motion(0).v - n * 4), 4 * tolerance::oblique.of(system()));
        // It turned back where its surface met the edge or the corner, at sqrt(2) / 2 or sqrt(3) / 2.
        world->run(64);
        const Number turn = norm(towards) / 2 + 0.25L;
        const Number flown = (world->motion(0).x.x / n.x - turn) + (3 - turn);
        if (towards.x != 0) {
            const Number steps = flown * 64;
            EXPECT_LE(std::abs(steps - std::round(steps)), tolerance::whole_steps) << steps;
        }
    }
}

TEST_P(Pairs, the_larger_restitution_and_the_geometric_mean_of_friction_count) {
    SceneSetup setup = space(0.5L, 0.5L);
    setup.bodies = {placed(sphere(1, 0.25), {-1, 0, 0}, {2, 0, 0}), placed(sphere(1, 0.25), {1, 0, 0}, {-2, 0, 0})};
    const auto rebound = [&] { return run(setup, 192)->motion(1).v.x; };
    const Bound allowed = 4 * tolerance::exchange.of(system());
    EXPECT_LE(std::abs(rebound() - 1), allowed);  // the world's value
    setup.bodies[0].restitution = 0.25;
    EXPECT_LE(std::abs(rebound() - 0.5L), allowed);  // the only given value
    setup.bodies[1].restitution = 0.75;
    EXPECT_LE(std::abs(rebound() - 1.5L), allowed);

    // A spin about the normal of the line: friction slides, J = mu m v, and deflects the speed sideways.
    setup.bodies[0].angular_velocity = {0, 0, 30};
    setup.bodies[0].friction = 0.5;
    setup.bodies[1].friction = 0.02;
    const auto world = run(setup, 192);
    EXPECT_LE(std::abs(world->motion(1).v.y - 0.1L * 1.75L * 2), 4 * tolerance::oblique.of(system()));
}

TEST_P(Pairs, without_a_response_bodies_pass_through_each_other) {
    SceneSetup setup = space(1);
    setup.world.contact.response = ContactResponse::none;
    setup.bodies = {placed(sphere(1, 0.25), {-1, 0, 0}, {2, 0, 0}), placed(box(1, {1, 1, 1}), {1, 0, 0}, {-2, 0, 0})};
    const auto world = run(setup, 256);
    EXPECT_LE(std::abs(world->motion(0).x.x - 1) + std::abs(world->motion(1).x.x + 1), tolerance::passed.of(system()));
    EXPECT_EQ(world->contact_count(0), 0);
}

// Compares the momenta before and after each step, through a whole collision.
void expect_conserved(const SceneSetup& setup, const Case& c, const std::string& what) {
    const auto world = build(setup, c);
    const Vector start = world->motion(0).v;
    for (int step = 0; step < 160; ++step) {
        const Sums before = sums_of(*world, setup.bodies);
        Number speed = 0, momentum = 0, angular = 0, spin = 0, method = 0;
        for (int b = 0; b < world->body_count(); ++b) {
            const BodySpec& body = setup.bodies[static_cast<std::size_t>(b)];
            const Motion m = world->motion(b);
            const Number l = norm(angular_momentum(m, moments_of(body)));
            speed = std::max(speed, norm(m.v));
            momentum += number(body.mass) * norm(m.v);
            angular += number(body.mass) * norm(m.v) * (norm(m.x) + 1) + l;
            spin = std::max(spin, norm(m.w));
            method += l;
        }
        const Motion a = world->motion(0), b = world->motion(1);
        const bool lasts = world->contact_count(0) > 0;
        world->step();
        const Sums after = sums_of(*world, setup.bodies);
        for (int i = 0; i < world->body_count(); ++i) spin = std::max(spin, norm(world->motion(i).w));
        ASSERT_LE(norm(after.linear - before.linear), tolerance::exchange.of(c.system) * 2 * momentum)
            << what << ", step " << step;
        const Bound of_method =
            c.method.conserves ? Bound{} : 2 * tolerance::method_error(c.method.order, spin / 256, spin / 256) * method;
        // The impulses of a lasting contact act at both ends of the step, at points that slide apart meanwhile.
        const Number slid = (norm(a.v - b.v) + 2 * spin) / 256,
                     pushed = number(setup.bodies[0].mass) * norm(world->motion(0).v - a.v) / 2;
        const Bound of_sliding =
            lasts && world->contact_count(0) > 0 ? tolerance::slid_lever * (slid * pushed) : Bound{};
        ASSERT_LE(norm(after.angular - before.angular),
                  tolerance::levered.of(c.system) * 2 * angular + of_method + of_sliding)
            << what << ", step " << step;
    }
    EXPECT_GT(norm(world->motion(0).v - start), 0.1L) << what << ": they never met";
}
void expect_meetings_conserve(ShapeKind kind_a, ShapeKind kind_b, const Case& c) {
    Random random{17};
    for (int i = 0; i < 12; ++i) {
        SceneSetup setup = space(random.uniform(0, 1), i % 2 == 0 ? 0.0L : 0.4L);
        const auto body = [&](ShapeKind kind) {
            const Real mass = random.uniform(0.5, 4), x = random.uniform(0.5, 1), y = random.uniform(0.5, 1);
            BodySpec b = kind == ShapeKind::sphere ? sphere(mass, x * y) : box(mass, {x, y, 0.75});
            b.orientation = {1, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}};
            return b;
        };
        const BodySpec a = body(kind_a), b = body(kind_b);
        const Vector along = direction(random), beside = across(along, random) * 0.125L;
        const Vector spin_a = direction(random) * 2, spin_b = direction(random) * 2;
        setup.bodies = {placed(a, along * 2 + beside, along * -3, spin_a), placed(b, along * -0.25L, along, spin_b)};
        expect_conserved(setup, c, "meeting " + std::to_string(i) + (i % 2 == 0 ? "" : " with friction"));
    }
}

TEST_P(Pairs, two_spheres_keep_their_momentum_and_angular_momentum) {
    expect_meetings_conserve(ShapeKind::sphere, ShapeKind::sphere, GetParam());
}
TEST_P(Pairs, a_sphere_and_a_box_keep_their_momentum_and_angular_momentum) {
    expect_meetings_conserve(ShapeKind::sphere, ShapeKind::box, GetParam());
}
TEST_P(Pairs, two_boxes_keep_their_momentum_and_angular_momentum) {
    expect_meetings_conserve(ShapeKind::box, ShapeKind::box, GetParam());
}

// Five equal spheres on a floor without friction. The moving ones come from the left at 2 m/s, touch each other, and
// have one metre to go.
SceneSetup cradle(int moving) {
    SceneSetup setup = floor(1);
    for (int i = 0; i < 5; ++i) {
        const bool moves = i < moving;
        setup.bodies.push_back(placed(sphere(1, 0.25), {(moves ? -2 : -1) + 0.5L * static_cast<Number>(i), 0.25L, 0},
                                      {moves ? 2.0L : 0.0L, 0, 0}));
    }
    return setup;
}

TEST_P(Pairs, a_cradle_sends_away_as_many_spheres_as_arrive) {
    for (const int moving : {1, 2}) {
        const auto world = build(cradle(moving), GetParam());
        world->run(256);  // half a second to the row, half a second from it
        for (int i = 0; i < 5; ++i) {
            const bool leaves = i >= 5 - moving;
            const Motion m = world->motion(i);
            EXPECT_LE(norm(m.v - Vector{leaves ? 2.0L : 0.0L, 0, 0}), 2 * tolerance::cradle)
                << "sphere " << i << " of " << moving << " moving";
            EXPECT_LE(std::abs(m.x.x - (-1 + 0.5L * static_cast<Number>(i) + (leaves ? 1.0L : 0.0L))), tolerance::place)
                << "sphere " << i << " of " << moving << " moving";
        }
        EXPECT_TRUE(world->status().ok());
    }
}

// Eleven exchanges at one moment, with the pairs in either order.
TEST_P(Pairs, a_long_row_passes_on_an_impact_from_either_end) {
    constexpr int balls = 12;
    std::vector<Motion> after[2];
    const Bound allowed = (balls - 1) * 2 * tolerance::exchange.of(system());
    for (const bool from_right : {false, true}) {
        const Number along = from_right ? -1 : 1;
        const int strikes = from_right ? balls - 1 : 0, leaves = balls - 1 - strikes;
        SceneSetup setup = space(1);
        for (int i = 0; i < balls; ++i) {
            const Number x = 0.5L * (static_cast<Number>(i) - (balls - 1) / 2.0L);
            setup.bodies.push_back(i == strikes ? placed(sphere(1, 0.25), {x - along, 0, 0}, {2 * along, 0, 0})
                                                : placed(sphere(1, 0.25), {x, 0, 0}));
        }
        const auto world = build(setup, GetParam());
        world->run(256);  // half a second to the row, half a second from it
        for (int i = 0; i < balls; ++i) {
            const Motion m = world->motion(i);
            EXPECT_LE(norm(m.v - Vector{i == leaves ? 2 * along : 0, 0, 0}), allowed)
                << "ball " << i << (from_right ? ", from the right" : ", from the left");
            after[from_right ? 1 : 0].push_back(m);
        }
        EXPECT_TRUE(world->status().ok());
    }
    for (int i = 0; i < balls; ++i) {
        const Motion &a = after[0][static_cast<std::size_t>(i)], &b = after[1][static_cast<std::size_t>(balls - 1 - i)];
        EXPECT_LE(norm(a.v + b.v), allowed) << "ball " << i;
        EXPECT_LE(norm(a.x + b.x), allowed) << "ball " << i;
    }
}

// The impact of one pair reaches another pair, within the tolerance, that is about to collide by itself.
TEST_P(Pairs, a_row_with_a_gap_below_the_tolerance_passes_on_the_whole_impact) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Random random{seed};
        const Axes3 axes = random_axes(random);
        const int rate = seed % 2 == 0 ? 256 : 60;
        // A point that approaches by less than the change of speed by gravity in two steps rests.
        const Number radius = 0.05L, speed = random.uniform(1.05, 4) * 2 * 9.81L / rate,
                     gap = random.uniform(0.2e-3, 0.95e-3);
        SceneSetup setup{.name = "row", .step = {1, rate}};
        setup.world.contact.restitution = 1;
        setup.world.gravity = real(axes.to_world({0, 0, -9.81L}));
        setup.planes = {axes.plane({0, 0, 1})};
        for (const Number x : {-0.11L, 0.0L, 2 * radius + gap}) {
            setup.bodies.push_back(sphere(1, real(radius)));
            setup.bodies.back().position = real(axes.to_world({x, 0, radius}));
        }
        setup.bodies[0].velocity = real(axes.to_world({speed, 0, 0}));
        const auto world = build(setup, GetParam());
        for (int step = 0; step < 200 && axes.from_world(world->motion(2).v).x < 0.01L * speed; ++step) world->step();
        EXPECT_GE(axes.from_world(world->motion(2).v).x, 0.999L * speed) << "seed " << seed;
        EXPECT_LE(norm(world->motion(1).v), 0.01L * speed) << "seed " << seed;
    }
}

// The lower ball bounces off the floor and comes near the upper ball, in a step in which the upper ball has already
// flown.
TEST_P(Pairs, a_body_approached_by_another_within_a_step_flies_only_once) {
    for (const bool upper_first : {false, true}) {
        SceneSetup setup = space(1);
        setup.step = Seconds{1, 64};
        setup.planes = {{}};
        setup.bodies = {placed(sphere(1, 0.25), {0, 1.25, 0}, {0, -10, 0}),
                        placed(sphere(1, 0.25), {0, 1.95, 0}, {0, -10, 0})};
        if (upper_first) std::swap(setup.bodies[0], setup.bodies[1]);
        const int upper = upper_first ? 0 : 1;
        const auto world = build(setup, GetParam());
        for (int step = 1; step <= 7; ++step) {
            world->step();
            EXPECT_LE(std::abs(world->motion(upper).x.y - (1.95L - 10 * static_cast<Number>(step) / 64)),
                      tolerance::creep)
                << "step " << step;
        }
        world->run(5);
        EXPECT_LE(std::abs(world->motion(upper).v.y - 10), 20 * tolerance::exchange.of(system()));
        EXPECT_LE(std::abs(world->motion(1 - upper).v.y - 10), 20 * tolerance::exchange.of(system()));
    }
}

TEST_P(Pairs, a_cradle_between_walls_passes_its_momentum_to_and_fro) {
    SceneSetup setup = cradle(1);
    setup.planes.push_back({.normal = {1, 0, 0}, .offset = 2.25});
    setup.planes.push_back({.normal = {-1, 0, 0}, .offset = 2.25});
    const auto world = build(setup, GetParam());
    for (int half_second = 1; half_second <= 16; ++half_second) {
        world->run(64);  // 0.25 s, in the middle of a flight
        int moving = 0;
        for (int i = 0; i < 5; ++i) {
            const Number speed = std::abs(world->motion(i).v.x);
            if (speed > 1) {
                ++moving;
                EXPECT_LE(std::abs(speed - 2), 2 * static_cast<Number>(half_second) * tolerance::cradle);
            } else {
                EXPECT_LE(speed, 2 * static_cast<Number>(half_second) * tolerance::cradle);
            }
        }
        EXPECT_EQ(moving, 1) << "at " << 0.5 * half_second - 0.25 << " s";
        world->run(64);
    }
}

// Up to eight bounces in a step, the most that are resolved. Each may round the speed, and is found to within 2^-16 of
// the contact band: twice that in position, 3e-5 m after a thousand bounces.
TEST_P(Pairs, an_elastic_ball_between_near_walls_keeps_its_speed_and_stays_between_them) {
    constexpr Number room = 0.03125L, radius = 0.125L;
    for (const Number thickness : {0.5L, 0.0625L}) {
        for (const Number rooms : {0.25L, 0.8L, 3.0L, 5.5L, 7.5L, 8.0L}) {  // a step
            SceneSetup setup = space(1);
            setup.step = Seconds{1, 64};
            const Number speed = rooms * room * 64, start = 0.001L;
            const BodySpec wall = fixed(box(1, {real(thickness), 2, 2}));
            const Vector middle{(room + thickness) / 2 + radius, 0, 0};
            setup.bodies = {placed(wall, -middle), placed(wall, middle),
                            placed(sphere(1, real(radius)), {start, 0, 0}, {speed, 0, 0})};
            const auto world = build(setup, GetParam());
            for (int step = 1; step <= 128; ++step) {
                world->step();
                const Motion m = world->motion(2);
                const Number flown = start + room / 2 + rooms * room * static_cast<Number>(step);
                const Number bounces = std::floor(flown / room), beyond = flown - bounces * room;
                const Number x = (std::fmod(bounces, Number(2)) == 0 ? beyond : room - beyond) - room / 2;
                ASSERT_LE(std::abs(m.x.x) - room / 2, tolerance::depth) << rooms << " rooms, step " << step;
                ASSERT_LE(std::abs(m.x.x - x), tolerance::creep.of(system())) << rooms << " rooms, step " << step;
                ASSERT_LE(std::abs(norm(m.v) - speed), (bounces + 1) * speed * tolerance::exchange.of(system()))
                    << rooms << " rooms, step " << step;
            }
            EXPECT_TRUE(world->status().ok()) << rooms << " rooms a step";
        }
    }
}

TEST_P(Pairs, elastic_spheres_in_a_box_of_planes_keep_their_energy_and_stay_inside) {
    Random random{8};
    SceneSetup setup = space(1);
    for (int axis = 0; axis < 3; ++axis) {
        for (const int side : {-1, 1}) {
            PlaneSpec plane{.normal = {}, .offset = 1.5};
            plane.normal[axis] = side;
            setup.planes.push_back(plane);
        }
    }
    for (int i = 0; i < 8; ++i) {
        const Vector corner{(i & 1) != 0 ? 0.75L : -0.75L, (i & 2) != 0 ? 0.75L : -0.75L,
                            (i & 4) != 0 ? 0.75L : -0.75L};
        const Vector along = direction(random);
        setup.bodies.push_back(placed(sphere(1 + 0.25 * i, 0.25), corner, along * Number(random.uniform(1, 4))));
    }
    const auto world = build(setup, GetParam());
    const Number start = sums_of(*world, setup.bodies).energy;
    std::vector<Vector> first;
    for (int b = 0; b < 8; ++b) first.push_back(world->motion(b).v);
    Number greatest = 0, least = 2, farthest = 0, nearest = 2;
    for (int step = 0; step < 2560; ++step) {
        world->step();
        const Number energy = sums_of(*world, setup.bodies).energy / start;
        greatest = std::max(greatest, energy);
        least = std::min(least, energy);
        for (int a = 0; a < 8; ++a) {
            const Vector x = world->motion(a).x;
            farthest = std::max({farthest, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
            for (int b = 0; b < a; ++b) nearest = std::min(nearest, norm(x - world->motion(b).x));
        }
    }
    std::printf("%s: energy from %+.2Lg to %+.2Lg, deepest %.2Lg m in a wall, %.2Lg m in each other\n",
                name_of(GetParam()).c_str(), least - 1, greatest - 1, farthest - 1.25L, 0.5L - nearest);
    EXPECT_LE(greatest - 1, tolerance::elastic_gain.of(system()));
    EXPECT_LE(1 - least, tolerance::elastic_loss.of(system()));
    EXPECT_LE(farthest - 1.25L, tolerance::depth);
    EXPECT_LE(0.5L - nearest, tolerance::depth);
    EXPECT_TRUE(world->status().ok());
    for (int b = 0; b < 8; ++b)
        EXPECT_GT(norm(world->motion(b).v - first[static_cast<std::size_t>(b)]), 1e-3L) << "sphere " << b;
}

TEST(pairs, more_near_pairs_than_there_is_room_for_are_reported) {
    for (const Case& c : cases_of("verlet")) {
        const std::string_view name = c.system.name;
        if ((name != "q32_near" && name != "f32") || !has_minimal_worlds(name)) continue;
        SceneSetup setup = space(0.5L);
        setup.needs = with_few_pairs;
        for (const Vector& at : {Vector{0.375L, 0, 0}, Vector{-0.375L, 0, 0}, Vector{0, 0.625L, 0}})
            setup.bodies.push_back(placed(sphere(1, 0.25), at, at * -2));
        const auto few = build_minimal(setup, c), enough = build(setup, c);
        ASSERT_NE(few, nullptr);
        few->run(256);
        enough->run(256);
        EXPECT_TRUE(few->status().has(Issue::contacts_full)) << name;
        EXPECT_TRUE(enough->status().ok()) << name;
        // There is room for the pairs of two bodies.
        setup.bodies.pop_back();
        const auto pair = build_minimal(setup, c);
        pair->run(256);
        EXPECT_TRUE(pair->status().ok()) << name;
        EXPECT_GT(pair->motion(0).v.x, 0.3L) << name;
    }
}

// --- nothing tunnels: 3 m in a step ------------------------------------------------------------------------------

class Bullets : public CaseTest {
protected:
    static constexpr Number speed = 200, radius = 0.1L;
    static constexpr int shots = 200;
    static SceneSetup range(Number restitution = 0.5L) {
        SceneSetup setup = space(restitution);
        setup.step = Seconds{1, 64};
        return setup;
    }
    // A direction against n, inclined by up to 70 degrees.
    static Vector askew(Vector n, Random& random) {
        const Number cosine = random.uniform(0.34, 1);
        return n * -cosine + across(n, random) * std::sqrt(1 - cosine * cosine);
    }
    // A shot that reaches `at` with the direction `along`, after `flight` metres, and leaves as from a wall.
    static void expect_rebound(const SceneSetup& setup, Vector n, Vector at, Vector along, Number flight, int shot) {
        const auto world = build(setup, GetParam());
        constexpr int steps = 5;
        Number deepest = 1;
        for (int step = 0; step < steps; ++step) {
            world->step();
            deepest = std::min(deepest, dot(world->motion(0).x - at, n));
        }
        EXPECT_LE(-deepest, tolerance::depth) << "shot " << shot;
        const Vector v = (along - n * (1.5L * dot(along, n))) * speed;
        EXPECT_LE(norm(world->motion(0).v - v), 2 * speed * tolerance::levered.of(system())) << "shot " << shot;
        EXPECT_LE(norm(world->motion(0).x - (at + v * (steps / 64.0L - flight / speed))), tolerance::place)
            << "shot " << shot;
        EXPECT_TRUE(world->status().ok()) << "shot " << shot;
    }
};
INSTANTIATE_TEST_SUITE_P(every, Bullets, testing::ValuesIn(contact_cases("q32_field")), NameOf{});

TEST_P(Bullets, bounce_off_a_plane_from_every_side) {
    Random random{1};
    for (int shot = 0; shot < shots; ++shot) {
        const Vector n = direction(random), at = direction(random), along = askew(n, random);
        const Number flight = random.uniform(0.5, 9);
        SceneSetup setup = range();
        setup.planes = {{.normal = real(n), .offset = real(radius - dot(n, at))}};
        setup.bodies = {placed(sphere(0.05, real(radius)), at - along * flight, along * speed)};
        expect_rebound(setup, n, at, along, flight, shot);
    }
}

// A fixed wall, 0.05 m thick and two metres square, at a random place.
BodySpec thin_wall(Random& random) {
    BodySpec wall = box(100, {2, 2, 0.05});
    wall.position = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    wall.orientation = {random.uniform(-1, 1), {random.uniform(-1, 1), random.uniform(-1, 1), 0.5}};
    wall.fixed = true;
    return wall;
}

TEST_P(Bullets, bounce_off_the_faces_of_a_thin_box) {
    Random random{2};
    for (int shot = 0; shot < shots; ++shot) {
        SceneSetup setup = range();
        const BodySpec wall = thin_wall(random);
        const Motion place = start_of(wall);
        const Number side = shot % 2 == 0 ? 1 : -1;
        const Vector n = place.q.rotate({0, 0, side});
        const Vector at =
            place.x + place.q.rotate({random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), side * (0.025L + radius)});
        const Vector along = askew(n, random);
        const Number flight = random.uniform(0.5, 9);
        setup.bodies = {placed(sphere(0.05, real(radius)), at - along * flight, along * speed), wall};
        expect_rebound(setup, n, at, along, flight, shot);
    }
}

// The distance of a point from a box, in the axes of the box.
Number distance_to_box(Vector p, Vector half) {
    const auto beyond = [](Number x, Number h) { return std::max(std::abs(x) - h, Number(0)); };
    return norm(Vector{beyond(p.x, half.x), beyond(p.y, half.y), beyond(p.z, half.z)});
}

TEST_P(Bullets, hit_a_thin_box_exactly_where_their_path_crosses_it) {
    Random random{3};
    const Vector half{1, 1, 0.025L};
    int hits = 0, misses = 0;
    for (int shot = 0; shot < 2 * shots; ++shot) {
        SceneSetup setup = range();
        const BodySpec wall = thin_wall(random);
        const Motion place = start_of(wall);
        // Through a random point in or beside the wall.
        const Vector through{random.uniform(-1.3, 1.3), random.uniform(-1.3, 1.3), random.uniform(-0.2, 0.2)};
        const Vector along_b = direction(random), start_b = through - along_b * Number(random.uniform(4, 8));
        if (distance_to_box(start_b, half) < 2 * radius) continue;
        // The distance from a convex body is convex along a line. Its minimum is found by golden section.
        const auto at = [&](Number s) { return distance_to_box(start_b + along_b * s, half); };
        Number low = 0, high = 16;
        for (int i = 0; i < 100; ++i) {
            const Number a = low + 0.381966L * (high - low), b = low + 0.618034L * (high - low);
            (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
        }
        const Number nearest = at((low + high) / 2);
        if (std::abs(nearest - radius) < 5 * tolerance::contact_band) continue;  // too close to call
        const bool hit = nearest < radius;
        const Vector velocity = place.q.rotate(along_b) * speed;
        setup.bodies = {placed(sphere(0.05, real(radius)), place.x + place.q.rotate(start_b), velocity), wall};
        const auto world = build(setup, GetParam());
        for (int step = 0; step < 6; ++step) {
            world->step();
            const Vector x = place.q.rotate_back(world->motion(0).x - place.x);
            EXPECT_LE(radius - distance_to_box(x, half), tolerance::depth) << "shot " << shot;
        }
        EXPECT_EQ(norm(world->motion(0).v - velocity) > 0.1L, hit)
            << "shot " << shot << ", " << nearest << " m from the wall at the nearest";
        (hit ? hits : misses) += 1;
    }
    EXPECT_GT(std::min(hits, misses), 40) << hits << " hits, " << misses << " misses";
}

TEST_P(Bullets, hit_each_other_where_their_paths_cross) {
    Random random{5};
    int hits = 0, misses = 0;
    for (int shot = 0; shot < shots; ++shot) {
        SceneSetup setup = range(1);
        const Vector meet = direction(random), along = direction(random), other = direction(random);
        const Vector relative = (along - other) * speed;
        if (norm(relative) < speed) continue;
        // When the first body is at `meet`, the second is beside it, perpendicular to their relative velocity.
        const Number time = random.uniform(0.005, 0.04), beside = random.uniform(0, 0.3);
        if (std::abs(beside - 2 * radius) < 5 * tolerance::contact_band) continue;  // too close to call
        const Vector gap = across(relative * (1 / norm(relative)), random) * beside;
        const BodySpec a = placed(sphere(0.05, real(radius)), meet - along * speed * time, along * speed),
                       b = placed(sphere(0.1, real(radius)), meet + gap - other * speed * time, other * speed);
        if (norm(vector(a.position) - vector(b.position)) < 3 * radius) continue;
        setup.bodies = {a, b};
        const auto world = run(setup, 5);
        Struck first{start_of(a), a, {}}, second{start_of(b), b, {}};
        if (beside < 2 * radius) {
            ++hits;
            const Number back = std::sqrt(4 * radius * radius - beside * beside);
            const Vector n = (gap + relative * (back / norm(relative))) * (-1 / (2 * radius));  // from b to a
            first.arm = n * -radius;
            second.arm = n * radius;
            collide(first, second, n, 1, 0);
        } else {
            ++misses;
        }
        // In a glancing impact, the error of the normal is larger by this factor.
        const Number glance =
            beside < 2 * radius ? 1 / std::sqrt(1 - beside * beside / (4 * radius * radius)) : Number(1);
        EXPECT_LE(norm(world->motion(0).v - first.motion.v), speed * tolerance::bullet * glance) << "shot " << shot;
        EXPECT_LE(norm(world->motion(1).v - second.motion.v), speed * tolerance::bullet * glance) << "shot " << shot;
    }
    EXPECT_GT(std::min(hits, misses), 20) << hits << " hits, " << misses << " misses";
}

TEST_P(Bullets, do_not_pass_through_a_free_box) {
    Random random{6};
    for (int shot = 0; shot < shots / 2; ++shot) {
        SceneSetup setup = range();
        BodySpec wall = thin_wall(random);
        wall.fixed = false;
        const Motion place = start_of(wall);
        const Vector n = place.q.rotate({0, 0, 1});
        const Vector offset = place.q.rotate({random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 0.025});
        const Vector along = askew(n, random);
        const BodySpec ball =
            placed(sphere(0.05, real(radius)), place.x + offset + n * radius - along * Number(random.uniform(0.5, 9)),
                   along * speed);
        setup.bodies = {ball, wall};
        const auto world = build(setup, GetParam());
        Struck hits{start_of(ball), ball, n * -radius}, hit{place, wall, offset};
        collide(hits, hit, n, 0.5L, 0);
        world->run(5);
        EXPECT_LE(norm(world->motion(0).v - hits.motion.v), speed * tolerance::bullet) << "shot " << shot;
        EXPECT_LE(norm(world->motion(1).v - hit.motion.v), tolerance::bullet) << "shot " << shot;
    }
}

// The edges of two spinning boxes pass within the margin by which faces are preferred to edges. There no point stops
// them, so they must go on: their centre of mass does.
TEST_P(Pairs, boxes_whose_edges_graze_each_other_go_on) {
    Random random{28};
    int hits = 0;
    for (int i = 0; i < 150; ++i) {
        const auto near = [&](Vector v, double by) { return v + direction(random) * random.uniform(0, by); };
        SceneSetup setup = space(0.9L, 0.3L);
        setup.step = Seconds{1, 128};
        setup.bodies = {oriented(placed(box(1.244, {0.3082, 0.2281, 0.3338}), {}, {0, 0.0226L, -0.5867L},
                                        near({8.3637L, -11.0507L, -13.196L}, 0.01)),
                                 {1, {0.5641, 0.8209, -0.4305}}),
                        oriented(placed(box(1.1249, {0.4111, 0.3799, 0.4458}), near({0.5966L, 0.4641L, 0.0165L}, 0.002),
                                        {-5.2117L, 0.8651L, -0.2433L}, near({-12.9559L, -14.4705L, -6.9583L}, 0.01)),
                                 {1, {0.9253, -0.8437, -0.6439}})};
        const auto centre = [&](auto&& of) { return (of(0) * 1.244L + of(1) * 1.1249L) * (1 / (1.244L + 1.1249L)); };
        const auto body = [&](int b) { return setup.bodies[static_cast<std::size_t>(b)]; };
        const Vector start = centre([&](int b) { return vector(body(b).position); }),
                     velocity = centre([&](int b) { return vector(body(b).velocity); });
        const auto world = run(setup, 32);
        EXPECT_LE(norm(centre([&](int b) { return world->motion(b).x; }) - start - velocity * 0.25L), 1e-5L) << i;
        EXPECT_TRUE(world->status().ok()) << i;
        hits += norm(world->motion(0).v - vector(body(0).velocity)) > 0.01L ? 1 : 0;
    }
    EXPECT_GT(hits, 20);
    EXPECT_LT(hits, 130);
}

}  // namespace
}  // namespace tumble::test
