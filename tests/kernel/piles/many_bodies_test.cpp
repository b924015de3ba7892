// Worlds with more bodies than fit into a byte, and worlds in which a grid finds the bodies that may touch.
#include "kinds.hpp"
#include "player.hpp"
#include "tolerances.hpp"

#include <cmath>

namespace tumble::test {
namespace {

struct Tray : Scene {
    using Numbers = F64;
    static constexpr Features features{.bodies = 301, .planes = 1, .pairs = true, .boxes = true};
};

// 255 balls and the floor are 256 pairs, which is 0 modulo 256.
TEST(ManyBodies, a_tray_carries_as_many_balls_as_are_put_on_it) {
    for (const int balls : {200, 255, 256, 300}) {
        constexpr WorldSpec spec{.gravity = {0, -9.8125, 0}, .contact = {.restitution = 0}};
        const auto world = std::make_unique<World<Tray>>(Seconds{1, 256}, spec);
        ASSERT_TRUE(world->add(PlaneSpec{}));
        BodySpec tray = box(100, {20, 1, 20}), ball = sphere(1, Real{0.125});
        tray.position = {0, Real{0.5}, 0};
        const BodyId carrier = world->add(tray);
        for (int i = 0; i < balls; ++i) {
            ball.position = {Real{(i % 20) * 0.5 - 5}, Real{1.125}, Real{(i / 20) * 0.5 - 5}};
            ASSERT_TRUE(world->add(ball));
        }
        for (int step = 0; step < 8; ++step) ASSERT_TRUE(world->step().ok());
        EXPECT_EQ(world->contact_count(carrier), 4 + balls);
        for (int b = 0; b <= balls; ++b)
            EXPECT_LE(std::abs(static_cast<Number>(world->position(BodyId{b}).y) - (b == 0 ? 0.5L : 1.125L)),
                      tolerance::place)
                << "body " << b << " of " << balls;
    }
}

// With room for 64 bodies each pair has a time to contact of its own, with room for 65 a grid finds the pairs.
template <class N, int room, bool pairs = true>
struct Room : Scene {
    using Numbers = N;
    static constexpr Features features{.bodies = room,
                                       .planes = 5,
                                       .springs = 1,
                                       .near_pairs = pairs ? 512 : 0,
                                       .control = true,
                                       .removal = true,
                                       .snapshots = true,
                                       .pairs = pairs,
                                       .boxes = true,
                                       .friction = true,
                                       .sleep = true,
                                       .kinematic = true};
};

template <class N, int room, bool pairs = true>
class Play : Player<Room<N, room, pairs>> {
public:
    using Player = test::Player<Room<N, room, pairs>>;
    using Player::Player, Player::add, Player::run, Player::world, Player::save_and_restore;

    ~Play() { EXPECT_FALSE(world().status().has(Issue::contacts_full)); }

    // The bodies fall between walls.
    Hashes heap(int bodies, int steps) {
        walls(1);
        for (int i = 0; i < bodies; ++i)
            (void)add(any_body(Real{0.25}), RealVec3{0, Real{0.5 + 0.25 * i}, 0} + random_vector(Real{0.5}));
        run(steps);
        return this->hashes();
    }
    // Small bodies fly at a large ball in the middle, and at each other.
    Hashes sizes(int bodies, int steps) {
        (void)add(sphere(100, 4), {});
        for (int i = 0; i < bodies; ++i) {
            const RealVec3 from = random_vector(1), unit = from * (Real{1} / sqrt(dot(from, from)));
            (void)add(any_body(Real{i % 4 == 0 ? 0.5 : 0.0625}), unit * Real{4.5 + 0.1 * i}, unit * Real{-3 - i % 7});
        }
        run(steps);
        return this->hashes();
    }
    // A ball is thrown up over the place where a box comes to rest and falls asleep.
    Hashes sleeper() {
        walls(32);
        (void)add(sphere(100, 4), {0, 5, 0}, {0, 3, 0});
        (void)add(box(1, {1, Real{0.5}, 1}), {8, Real{0.25}, 0}, {-8, 0, 0});
        run(400);
        return this->hashes();
    }
    // What a program does while the world runs.
    Hashes control() {
        walls(8);
        BodySpec paddle = box(1, {1, 2, 8}), table = box(1, {2, 1, 2});
        paddle.kinematic = true;
        table.fixed = true;
        const BodyId pushes = add(paddle, {-6, 1, 0}, {2, 0, 0}), held = add(table, {4, Real{0.5}, 0});
        BodyId bodies[12];
        for (int i = 0; i < 12; ++i)
            bodies[i] = add(any_body(Real{0.5}), {Real{i - 5}, Real{0.75 + i % 3}, Real{0.5 * (i % 5)}});
        run(200);
        world().apply_impulse(bodies[3], {1, 4, 2});
        world().set_pose(held, {0, Real{0.5}, 1});  // into what lies there
        run(100);
        world().set_velocity(pushes, {-1, 0, 0});
        world().remove(bodies[5]);
        (void)add(sphere(1, Real{0.25}), {0, 4, 0}, {0, -5, 0});
        run(100);
        save_and_restore(8);
        run(100);
        world().set_velocity(pushes, {});
        run(200);
        world().apply_impulse(bodies[0], {-2, 1, 0});
        run(200);
        return this->hashes();
    }

    // Loads come to bodies on a floor, and go. No body reaches another.
    Hashes loads() {
        walls(64);
        BodyId bodies[12];
        for (int i = 0; i < 12; ++i)
            bodies[i] = add(any_body(Real{0.5}), {Real{8 * (i % 4)}, Real{0.5 + i % 3}, Real{8 * (i / 4)}});
        run(150);
        world().set_force(bodies[3], {2, 20, 1}, Frame::world);
        run(30);
        world().apply_impulse(bodies[7], {1, 3, -2});
        world().set_torque(bodies[4], {0, 0, 1}, Frame::body);
        run(40);
        save_and_restore(8);
        world().set_force(bodies[3], {0, -60, 0}, Frame::world);
        run(200);
        world().apply_force(bodies[1], {50, 0, 0}, Frame::world);
        save_and_restore(8);
        world().remove(bodies[7]);
        run(200);
        return this->hashes();
    }

    // What a program may do with a heap, in an order of chance.
    Hashes commands(std::uint64_t seed) {
        state_ = seed;
        walls(4);
        BodySpec paddle = box(1, {1, 2, 4});
        paddle.kinematic = true;
        const BodyId pushes = add(paddle, {-3, 1, 0}, {1, 0, 0});
        BodyId bodies[16];
        for (BodyId& body : bodies) body = add(any_body(Real{0.5}), RealVec3{0, 3, 0} + random_vector(Real{2.5}));
        run(20);
        for (int command = 0; command < 40; ++command) {
            BodyId& body = bodies[random_below(16)];
            const RealVec3 unit = random_vector(1);
            switch (random_below(9)) {
            case 0: world().set_force(body, unit * Real{20}, Frame::world); break;
            case 1: world().set_force(body, {}, Frame::body); break;
            case 2: world().apply_force(body, unit * Real{160}, Frame::body); break;
            case 3: world().set_torque(body, unit, Frame::body); break;
            case 4: world().apply_impulse(body, unit * Real{5}); break;
            case 5: world().set_pose(body, RealVec3{0, 2, 0} + unit * Real{1.5}); break;
            case 6: world().set_velocity(pushes, unit); break;
            case 7: save_and_restore(random_below(20)); break;
            case 8:
                world().remove(body);
                body = add(any_body(Real{0.5}), RealVec3{0, 3, 0} + unit * Real{2});
                break;
            }
            run(random_below(40));
        }
        return this->hashes();
    }

    // Of three balls in a row a force pushes the first against the second, and both at the third. Returns the least
    // distance between the last two, m. `order`: in which they are added.
    double least_distance(const int (&order)[3], Real gap, Real force) {
        const Real place[3] = {0, 1, Real{2} + gap};
        BodyId balls[3];
        for (const int ball : order) balls[ball] = add(sphere(1, Real{0.5}), {place[ball], 0, 0});
        run(20);
        world().set_force(balls[0], {force, 0, 0}, Frame::world);
        const auto x = [&](int ball) { return static_cast<double>(world().position(balls[ball]).x); };
        double least = 2;
        for (int step = 0; step < 24; ++step) {
            run(1);
            least = std::min(least, x(2) - x(1));
        }
        return least;
    }

    // A ball is put beside another and pushed at it in the same step. Returns how far the other comes, which has a gap
    // of 0.2 m to a wall.
    double way_to_the_wall(bool is_first) {
        plane({0, 1, 0}, 0);
        plane({-1, 0, 0}, Real{0.7});
        BodyId balls[2];
        for (const int ball : {is_first ? 0 : 1, is_first ? 1 : 0})
            balls[ball] = add(sphere(1, Real{0.5}), {ball == 0 ? 0 : -5, Real{0.5}, 0});
        run(21);
        world().set_pose(balls[1], {-1, Real{0.5}, 0});
        world().apply_impulse(balls[0], {});
        world().set_force(balls[1], {2000, 0, 0}, Frame::world);
        return most_x(balls[0], 40);
    }
    // A ball flies for some steps, a way in each, and is then this far from one that a load begins to push at it, m.
    Hashes shot(Real radius, int steps, Real way, Real gap) {
        const BodyId target = add(sphere(1, radius), {});
        (void)add(sphere(1, Real{0.3}), {radius + Real{0.3} + gap + way * Real{steps}, 0, 0}, {way * Real{-256}, 0, 0});
        run(steps);
        world().set_force(target, {4000, 0, 0}, Frame::world);
        run(4);
        return this->hashes();
    }
    // A spring that is added in mid-run pulls a ball at a wall, 1 m away. Returns how far the ball comes.
    double way_on_a_spring() {
        walls(Real{1.5});
        const BodyId ball = add(sphere(1, Real{0.5}), {0, Real{0.5}, 0});
        run(130);
        SpringSpec spring;
        spring.body = 0;
        spring.to = {4, Real{0.5}, 0};
        spring.stiffness = 200;
        EXPECT_TRUE(world().add(spring));
        return most_x(ball, 170);
    }

private:
    double most_x(BodyId body, int steps) {
        double most = -1;
        for (int step = 0; step < steps; ++step) {
            run(1);
            most = std::max(most, static_cast<double>(world().position(body).x));
        }
        return most;
    }
    [[nodiscard]] int random_below(int end) {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<int>((state_ >> 40) * static_cast<std::uint64_t>(end) >> 24);
    }
    // From -1 to 1.
    [[nodiscard]] Real random() { return Real{static_cast<double>(random_below(1 << 24)) / (1 << 23) - 1}; }
    [[nodiscard]] RealVec3 random_vector(Real size) {
        const Real x = size * random(), y = size * random(), z = size * random();
        return {x, y, z};
    }
    // A ball or a box of about this size, m.
    [[nodiscard]] BodySpec any_body(Real size) {
        const RealVec3 edges = RealVec3{size, size, size} + random_vector(size / Real{2});
        return random() < Real{} ? sphere(1, edges.x / Real{2}) : box(1, edges);
    }
    void plane(const RealVec3& normal, Real offset) {
        PlaneSpec spec;
        spec.normal = normal;
        spec.offset = offset;
        EXPECT_TRUE(world().add(spec));
    }
    // A floor and four walls at this distance.
    void walls(Real distance) {
        plane({0, 1, 0}, 0);
        for (const RealVec3& normal : {RealVec3{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}}) plane(normal, distance);
    }

    std::uint64_t state_ = 1;
};

// Two balls meet and part, two others later.
TEST(ManyBodies, the_most_near_pairs_of_a_history_are_known) {
    Play<F64, 64> play{WorldSpec{.contact = {.restitution = 1}}};
    for (const int at : {4, 8}) {
        (void)play.add(sphere(1, Real{0.5}), {-at, 2 * at, 0}, {10, 0, 0});
        (void)play.add(sphere(1, Real{0.5}), {at, 2 * at, 0}, {-10, 0, 0});
    }
    EXPECT_EQ(play.world().most_near_pairs(), 0);
    play.run(256);
    EXPECT_EQ(play.world().near_pair_count(), 0);
    EXPECT_EQ(play.world().most_near_pairs(), 1);
}

template <class N>
class Grids : public testing::Test {
protected:
    template <int room = 65, bool pairs = true, class Story>
    static void expect_same(const WorldSpec& spec, Story&& story) {
        Play<N, 64> with_times{spec};
        Play<N, room, pairs> other{spec};
        const Hashes expected = story(with_times), found = story(other);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], expected[i]) << "in step " << i;
    }
    // Calls f(play) for a world with times and one with a grid.
    template <class F>
    static void for_both(const WorldSpec& spec, F&& f) {
        f(Play<N, 64>{spec});
        f(Play<N, 65>{spec});
    }
    static WorldSpec with_gravity() {
        return {.gravity = {0, -9.8125, 0}, .contact = {.restitution = 0.25, .friction = 0.5}};
    }
};
using Systems = Tested<testing::Types<Q32<>>, testing::Types<F64>>;
TYPED_TEST_SUITE(Grids, Systems);

TYPED_TEST(Grids, find_the_pairs_of_a_heap) {
    this->expect_same(this->with_gravity(), [](auto& play) { return play.heap(24, 256); });
}
TYPED_TEST(Grids, find_the_pairs_of_small_bodies_that_fly_at_a_large_one) {
    constexpr WorldSpec spec{.contact = {.restitution = 1}};
    const auto story = [](auto& play) { return play.sizes(30, 300); };
    this->expect_same(spec, story);
    // Few bodies look at all others, and not into cells.
    this->template expect_same<1000>(spec, story);
}
TYPED_TEST(Grids, find_what_has_fallen_asleep_below) {
    WorldSpec spec = this->with_gravity();
    spec.contact.sleep = {.on = true, .time = Real{0.125}};
    this->expect_same(spec, [](auto& play) { return play.sleeper(); });
}
TYPED_TEST(Grids, find_what_a_program_puts_moves_and_removes) {
    WorldSpec spec = this->with_gravity();
    spec.contact.sleep.on = true;
    this->expect_same(spec, [](auto& play) { return play.control(); });
}

// Whether a body looks at others, and they at it, depends on nothing but where they are and what acts on them.
TYPED_TEST(Grids, and_times_list_the_same_pairs_whatever_a_program_does) {
    for (const std::uint64_t seed : {1u, 3u, 7u}) {
        SCOPED_TRACE(seed);
        this->expect_same(this->with_gravity(), [&](auto& play) { return play.commands(seed); });
    }
}

// A ball is not seen later because it was added first.
TYPED_TEST(Grids, and_times_find_what_is_pushed_in_time_in_each_order) {
    constexpr WorldSpec spec{.contact = {.restitution = 0}};
    constexpr int orders[][3] = {{0, 1, 2}, {2, 1, 0}, {2, 0, 1}, {1, 2, 0}};
    for (const auto& order : orders)
        for (const double gap : {0.0625, 0.25, 0.375})
            for (const double force : {500., 2000.}) {
                this->for_both(spec, [&](auto&& play) {
                    EXPECT_GE(play.least_distance(order, Real{gap}, Real{force}),
                              1 - static_cast<double>(play.world().contact_tolerance()))
                        << "first " << order[0] << ", " << gap << " m, " << force << " N";
                });
            }
}

// The ball of the one that flies, of 0.5 m or of 1 m, is as large after its way as before.
TYPED_TEST(Grids, find_what_flies_at_a_body_that_a_load_begins_to_push) {
    const WorldSpec spec;
    for (const double radius : {0.248, 0.375, 0.498})
        for (const int steps : {1, 3, 7})
            for (const double room : {0.1975, 0.6975})
                for (const double gap : {1., 1.03, 1.06}) {
                    const double way = room / (steps + 1);
                    SCOPED_TRACE(testing::Message()
                                 << radius << " m, " << way << " m a step, gap " << gap * way << " m");
                    this->expect_same(
                        spec, [&](auto& play) { return play.shot(Real{radius}, steps, Real{way}, Real{gap * way}); });
                }
}

TYPED_TEST(Grids, and_times_notice_what_comes_while_a_body_looks) {
    constexpr WorldSpec spec{.contact = {.restitution = 0}};
    for (const bool is_first : {true, false}) {
        this->for_both(spec, [&](auto&& play) {
            EXPECT_NEAR(play.way_to_the_wall(is_first), 0.2, static_cast<double>(play.world().contact_tolerance()));
        });
    }
}
TYPED_TEST(Grids, and_times_notice_a_spring_that_is_added) {
    for (const bool sleeps : {true, false}) {
        WorldSpec spec = this->with_gravity();
        spec.contact.restitution = 0;
        spec.contact.sleep = {.on = sleeps, .time = Real{0.125}};
        this->for_both(spec, [&](auto&& play) {
            EXPECT_NEAR(play.way_on_a_spring(), 1, static_cast<double>(play.world().contact_tolerance()));
        });
    }
}

// Bodies that reach no other move as in a world without pairs of bodies.
TYPED_TEST(Grids, and_times_are_not_needed_where_no_body_reaches_another) {
    const auto loads = [](auto& play) { return play.loads(); };
    this->template expect_same<64, false>(this->with_gravity(), loads);
    this->template expect_same<65, false>(this->with_gravity(), loads);
}

}  // namespace
}  // namespace tumble::test
