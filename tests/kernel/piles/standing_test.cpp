// What stands is not looked at until something happens. Reference: a world in which every step looks at everything.
#include "kinds.hpp"
#include "player.hpp"
#include "random.hpp"

#include <algorithm>
#include <cmath>

namespace tumble::test::bodies_that_stand {
namespace {

template <class N, int room>
struct Ground : Scene {
    using Numbers = N;
    static constexpr Features features = [] {
        Features all = touching(room, 2);
        all.control = all.turntables = all.kinematic = true;
        return all;
    }();
};
const Real gravity{-9.8125};  // m/s^2

// Two stacks of three boxes, a box on a fixed table, and a paddle. `busy`: and far from them a ball that rolls on.
template <class N, int room>
class Town : public Player<Ground<N, room>> {
public:
    using Player = test::Player<Ground<N, room>>;
    using Player::add, Player::world;

    Town(bool looks, bool busy) : Player{spec()}, looks_{looks} {
        EXPECT_TRUE(world().add(PlaneSpec{}));
        for (int i = 0; i < 6; ++i) boxes[i] = add(box(1, {1, 1, 1}), {Real{i < 3 ? 0 : 4}, Real{0.5 + i % 3}, 0});
        BodySpec fixed = box(1, {2, 1, 2}), moving = box(1, {1, 1, 1});
        fixed.fixed = true;
        moving.kinematic = true;
        table = add(fixed, {-6, Real{0.5}, 0});
        (void)add(box(1, {1, 1, 1}), {-6, Real{1.5}, 0});
        paddle = add(moving, {8, Real{0.5}, 0});
        if (busy) (void)add(sphere(1, Real{0.25}), {0, Real{0.25}, 20}, {Real{0.125}, 0, 0});
    }

    static WorldSpec spec() {
        WorldSpec spec;
        spec.gravity = {0, gravity, 0};
        spec.contact.restitution = Real{0.25};
        spec.contact.friction = Real{0.5};
        return spec;
    }
    void run(int steps) {
        for (int step = 0; step < steps; ++step) {
            if (looks_) Player::look_at_everything();
            Player::run(1);
        }
    }

    BodyId boxes[6], table, paddle;

private:
    bool looks_;
};

template <class N>
class Standing : public testing::Test {
protected:
    // What happens after the bodies have stood for so many steps.
    template <int room = 11, class Event>
    static void expect_same(const std::vector<int>& waits, Event&& event, int after = 200) {
        for (const int wait : waits)
            for (const bool busy : {false, true}) {
                Town<N, room> left_alone{false, busy}, looked_at{true, busy};
                for (auto* play : {&left_alone, &looked_at}) {
                    play->run(wait);
                    event(*play);
                    play->run(after);
                }
                ASSERT_EQ(left_alone.hashes(), looked_at.hashes())
                    << "after " << wait << " steps" << (busy ? ", beside a ball that rolls" : "");
                EXPECT_NE(left_alone.hashes()[static_cast<std::size_t>(wait) - 1], left_alone.hashes().back())
                    << "nothing happened";
            }
    }
    // The paddle shoves the second stack, after 96 steps, and would reach the first after 160. The bits are the same
    // until the stack moves. Then sweeps solve the pile, which end within a tolerance and begin with impulses that
    // depend on when its pairs were examined: the places are the same, up to 2e-6 m in q32.
    template <int room>
    static void expect_same_shove() {
        for (const int wait : waits)
            for (const bool busy : {false, true}) {
                Town<N, room> left_alone{false, busy}, looked_at{true, busy};
                const auto place = [](auto& play, int box) {
                    return play.world().template pose<double>(play.boxes[box]).position;
                };
                for (auto* play : {&left_alone, &looked_at}) {
                    play->run(wait);
                    play->world().set_velocity(play->paddle, {-8, 0, 0});
                    for (int step = 0; step < 128 && place(*play, 3).x == 4; ++step) play->run(1);
                    EXPECT_LT(place(*play, 3).x, 4) << "nothing happened";
                }
                ASSERT_EQ(left_alone.hashes(), looked_at.hashes())
                    << "after " << wait << " steps" << (busy ? ", beside a ball that rolls" : "");
                for (auto* play : {&left_alone, &looked_at}) play->run(60);
                for (int box = 0; box < 6; ++box)
                    for (int i = 0; i < 3; ++i)
                        EXPECT_NEAR(place(left_alone, box)[i], place(looked_at, box)[i], 1e-5) << box;
            }
    }
    static inline const std::vector<int> waits{1, 3, 9};
};
using Systems = Tested<testing::Types<Q32<>>, testing::Types<F64>>;
TYPED_TEST_SUITE(Standing, Systems);

TYPED_TEST(Standing, bodies_are_hit_by_what_is_thrown) {
    this->expect_same(this->waits, [](auto& play) {
        (void)play.add(sphere(1, Real{0.25}), {-3, Real{2.5}, 0}, {6, 0, Real{0.25}});
    });
}
TYPED_TEST(Standing, bodies_are_hit_by_what_has_flown_all_the_time) {
    for (const int height : {3, 20})
        this->expect_same(
            {1},
            [&](auto& play) {
                (void)play.add(sphere(1, Real{0.25}), {Real{0.25}, Real{3.5 + height}, 0});
            },
            800);
}
TYPED_TEST(Standing, bodies_feel_impulses_and_forces) {
    const auto strike = [](auto& play) { play.world().apply_impulse(play.boxes[1], {2, 0, 1}); };
    this->expect_same(this->waits, strike);
    this->template expect_same<70>(this->waits, strike);
    this->expect_same(this->waits, [](auto& play) {
        play.world().set_force(play.boxes[2], {3, 0, 0}, Frame::world);  // friction holds it
        play.run(30);
        play.world().set_force(play.boxes[2], {8, 0, 0}, Frame::world);
    });
    this->expect_same(this->waits, [](auto& play) {
        play.world().apply_force(play.boxes[5], {0, 90, 40}, Frame::world);
    });
}
TYPED_TEST(Standing, bodies_fall_when_what_holds_them_goes) {
    this->expect_same(this->waits, [](auto& play) { play.world().remove(play.boxes[0]); });
    this->expect_same(this->waits, [](auto& play) { play.world().set_pose(play.table, {-6, Real{0.25}, 3}); });
}
TYPED_TEST(Standing, bodies_are_moved_by_what_begins_to_move) {
    this->template expect_same_shove<11>();
    this->template expect_same_shove<70>();
    this->expect_same(this->waits, [](auto& play) { play.world().set_angular_velocity(play.table, {0, 2, 0}); });
}
TYPED_TEST(Standing, bodies_stand_no_longer_than_they_are_pressed) {
    this->expect_same({20}, [](auto& play) {
        PlaneSpec wall;
        wall.normal = {-1, 0, 0};
        wall.offset = 12;
        EXPECT_TRUE(play.world().add(wall));
        const BodyId pressed = play.add(box(1, {1, 1, 1}), {Real{11.5}, 3, 0});
        for (int step = 0; step < 20; ++step) {
            play.world().apply_force(pressed, {40, 0, 0}, Frame::world);
            play.run(1);
        }
    });
}
TYPED_TEST(Standing, bodies_feel_gravity_that_turns) {
    const auto tilt = [](auto& play, double slope, double side) {
        const double down = -9.8125 / std::sqrt(1 + slope * slope + side * side);
        play.world().set_gravity({-slope * down, down, -side * down});
    };
    // Friction holds them to a slope of 0.5, and stacks do not tip at 0.3.
    const auto rock = [&](auto& play) {
        for (int step = 0; step < 12; ++step) {
            tilt(play, 0.3 * std::sin(step), 0.3 * std::cos(step));
            play.run(1);
        }
    };
    const auto rock_and_slide = [&](auto& play) {
        rock(play);
        tilt(play, 0.75, 0);
        play.run(4);
    };
    this->expect_same({3}, rock_and_slide, 4);
    this->template expect_same<70>({3}, rock_and_slide, 4);
    Town<TypeParam, 11> town{false, false};
    town.run(9);
    rock(town);
    EXPECT_EQ(town.hashes().back(), town.hashes()[8]) << "nothing has moved";
}
TYPED_TEST(Standing, bodies_move_on_after_a_snapshot) {
    this->expect_same(this->waits, [](auto& play) {
        play.world().apply_impulse(play.boxes[2], {1, 0, 0});
        play.run(3);
        play.save_and_restore(200);  // all comes to rest
        play.run(3);
        play.world().apply_impulse(play.boxes[4], {0, 0, 3});
    });
}
// True where nothing has changed for 20 steps after `steps`.
template <class Play>
bool rests_after(Play& play, int steps) {
    play.run(steps);
    const auto last = play.hashes().back();
    play.run(20);
    const auto& hashes = play.hashes();
    return std::all_of(hashes.end() - 20, hashes.end(), [&](auto hash) { return hash == last; });
}
// A box is laid aslant on another one, which lies on the ground or is fixed. Soon nothing changes any more.
template <class N>
void expect_rest(const BodySpec& lower, BodySpec upper, Real height, const RealVec3& place, Real x_slope, Real z_slope,
                 bool is_fixed, int steps) {
    Player<Ground<N, 11>> play{Town<N, 11>::spec()};
    EXPECT_TRUE(play.world().add(PlaneSpec{}));
    BodySpec other = lower;
    other.fixed = is_fixed;
    const Real half = other.shape.size.y * 0.5, depth = 0.0002;
    (void)play.add(other, {0, half - depth, 0});
    upper.orientation = rotation_about({0, 0, 1}, x_slope) * rotation_about({1, 0, 0}, z_slope);
    const RealVec3 above{0, half * 2 - depth + upper.shape.size.y * 0.5 + height, 0};
    const BodyId b = play.add(upper, place + above);
    const auto start = play.world().position(b);
    ASSERT_TRUE(rests_after(play, steps));
    EXPECT_TRUE(play.world().status().ok());
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(static_cast<double>(play.world().position(b)[i]), static_cast<double>(start[i]), 0.0003);
}
// Each has its deepest vertex beside the face of the other. Where they overlap they are not so deep that it is
// corrected.
TYPED_TEST(Standing, boxes_come_to_rest_that_are_deepest_beside_their_faces) {
    Random random{1};
    for (int i = 0; i < 24; ++i) {
        const auto slope = [&] { return random.uniform(0.00005, 0.00015); };
        const auto side = [&] { return random.between(0, 1) == 0 ? -1 : 1; };
        const double x = random.uniform(0.2, 0.45), z = random.uniform(0.2, 0.45), x_slope = slope(), z_slope = slope(),
                     deepest = random.uniform(0.0002, 0.00025);
        const int at_x = side(), at_z = side();
        const double mass = random.uniform(0.3, 3);
        expect_rest<TypeParam>(box(1, {1, 1, 1}), box(mass, {1, 0.2, 1}), x_slope * (0.5 - x) + z_slope * 0.5 - deepest,
                               {at_x * x, 0, at_z * z}, -at_x * x_slope, -at_z * z_slope, i % 3 == 0, 200);
    }
}
// Two edges part them more than their faces do. Some turn about two points until a third one touches.
TYPED_TEST(Standing, planks_come_to_rest_across_each_other) {
    Random random{2};
    for (int i = 0; i < 24; ++i) {
        const auto slope = [&] { return random.uniform(0.0002, 0.002); };
        const auto side = [&] { return random.between(0, 1) == 0 ? -1 : 1; };
        const double x_slope = slope(), z_slope = slope(), deepest = random.uniform(0.00005, 0.0002),
                     mass = random.uniform(0.3, 3);
        const int x_side = side(), z_side = side();
        expect_rest<TypeParam>(box(1, {4, 0.1, 0.1}), box(mass, {0.1, 0.1, 4}), (x_slope + z_slope) * 0.05 - deepest,
                               {}, x_side * x_slope, z_side * z_slope, i % 3 == 0, 3000);
    }
}

// A plank falls on two trestles that stand apart, and lies on them. A few move on by rounding: the share of least
// squares leaves a cone, and sweeps hold it.
TYPED_TEST(Standing, a_plank_on_two_fixed_boxes_comes_to_rest) {
    Random random{3};
    const auto draw = [&](double low, double high) { return random.uniform(low, high); };
    int moving = 0;
    for (int i = 0; i < 20; ++i) {
        Player<Ground<TypeParam, 11>> play{Town<TypeParam, 11>::spec()};
        EXPECT_TRUE(play.world().add(PlaneSpec{}));
        for (const double x : {-0.5, 0.5}) {
            const double length = draw(0.1, 0.4), width = draw(0.2, 0.6);
            BodySpec trestle = box(1, {length, 0.5, width});
            trestle.fixed = true;
            trestle.orientation = rotation_about({0, 1, 0}, draw(-1, 1));
            (void)play.add(trestle, {x, 0.25, 0});
        }
        const double mass = draw(0.3, 3), length = draw(1.3, 2), width = draw(0.1, 0.5), yaw = draw(-0.1, 0.1),
                     tilt = draw(-0.001, 0.001), at = draw(-0.1, 0.1), height = draw(0.001, 0.005);
        BodySpec plank = box(mass, {length, 0.1, width});
        plank.orientation = rotation_about({0, 1, 0}, yaw) * rotation_about({0, 0, 1}, tilt);
        const BodyId id = play.add(plank, {at, 0.55 + height, 0});
        moving += rests_after(play, 2000) ? 0 : 1;
        EXPECT_TRUE(play.world().status().ok()) << i;
        EXPECT_NEAR(static_cast<double>(play.world().position(id).y), 0.55, 0.0003);
    }
    EXPECT_LE(moving, 4);
}

// Nothing of a groove is level, so its two forces are not known one by one: a ball or a box lies in it, or leans on a
// wall.
TYPED_TEST(Standing, a_body_on_two_planes_comes_to_rest) {
    Random random{5};
    const auto draw = [&](double low, double high) { return random.uniform(low, high); };
    for (int i = 0; i < 24; ++i) {
        Player<Ground<TypeParam, 11>> play{Town<TypeParam, 11>::spec()};
        const double slope = draw(0.3, 1.2), other = i % 2 == 0 ? slope : draw(0.3, 1.2), turn = draw(0, 3);
        for (const double side : {-slope, other}) {
            PlaneSpec plane;
            plane.normal = {std::sin(side) * std::cos(turn), std::cos(side), std::sin(side) * std::sin(turn)};
            EXPECT_TRUE(play.world().add(plane));
        }
        const double mass = draw(0.3, 10), height = draw(0.3, 0.5);
        if (i % 3 == 0) (void)play.add(sphere(mass, Real{0.125}), {0, Real{height}, 0});
        else (void)play.add(box(mass, {0.25, 0.375, 0.5}), {0, Real{height + 0.2}, 0});
        EXPECT_TRUE(rests_after(play, 2000)) << i;
    }
}

// It falls on the end of a short box that a rail stands beside, flush with it, and rocks there.
TYPED_TEST(Standing, a_plank_that_rocks_beside_a_seam_comes_to_rest) {
    Random random{4};
    for (int i = 0; i < 12; ++i) {
        Player<Ground<TypeParam, 11>> play{Town<TypeParam, 11>::spec()};
        BodySpec block = box(1, {0.76, 0.15, 0.35}), rail = box(1, {0.1, 0.25, 2.75});
        block.fixed = rail.fixed = true;
        const auto draw = [&](double low, double high) { return random.uniform(low, high); };
        block.orientation = rotation_about({0, 1, 0}, draw(0.5, 0.9));
        (void)play.add(block, {0, 0.425, -0.025});
        (void)play.add(rail, {0.45, 0.375, -0.05});
        const double mass = draw(0.3, 10), length = draw(1.2, 2), lean = draw(-0.003, 0.003),
                     tilt = draw(-0.003, 0.003), x = draw(0.1, 0.16), height = draw(0.002, 0.006),
                     z = draw(-0.01, 0.01);
        BodySpec plank = box(mass, {0.28, 0.27, length});
        plank.orientation = rotation_about({1, 0, 0}, lean) * rotation_about({0, 0, 1}, tilt);
        (void)play.add(plank, {x, 0.635 + height, z});
        ASSERT_TRUE(rests_after(play, 4000)) << i;
    }
}

TYPED_TEST(Standing, bodies_meet_a_new_plane) {
    this->expect_same(this->waits, [](auto& play) {
        PlaneSpec wall;
        wall.normal = {-1, 0, 0};
        wall.offset = Real{4.375};  // in the middle of a box
        EXPECT_TRUE(play.world().add(wall));
    });
}

// With a grid the one of two bodies that looked last keeps the bound on their time to contact: here a box, which slides
// below a large ball that falls, and stands.
TYPED_TEST(Standing, bodies_are_hit_by_a_large_ball_that_looked_before_them) {
    const auto run = []<class Ground>(Ground, bool looks, bool busy, int side, int restored = -1) {
        WorldSpec spec;
        spec.gravity = {0, -1, 0};
        spec.contact.restitution = spec.contact.friction = Real{0};
        Player<Ground> play{spec};
        EXPECT_TRUE(play.world().add(PlaneSpec{}));
        const BodyId ball = play.add(sphere(1, Real{7.875}), {0, Real{11.75}, 0}, {0, -7, 0});
        const BodyId sliding = play.add(box(1, {1, 1, 1}), {Real{-15} * side, Real{0.5}, 0}, {Real{50} * side, 0, 0});
        if (busy) (void)play.add(sphere(1, Real{0.25}), {0, Real{0.25}, 100}, {1, 0, 0});
        for (int step = 0; step < 200; ++step) {
            if (step == 77) play.world().set_velocity(sliding, {});
            if (looks && step > 77) play.look_at_everything();
            if (step == restored) play.save_and_restore(20);
            play.run(1);
            if (step == 105) { EXPECT_EQ(play.world().contact_count(ball), 1); }
        }
        return play.hashes();
    };
    for (const int side : {-1, 1})
        for (const bool busy : {false, true}) {
            const auto looked_at = run(Ground<TypeParam, 10>{}, true, busy, side);
            EXPECT_EQ(run(Ground<TypeParam, 10>{}, false, busy, side), looked_at);
            for (const int restored : {-1, 79})
                EXPECT_EQ(run(Ground<TypeParam, 70>{}, false, busy, side, restored), looked_at) << restored;
        }
}

// What is nearer than 4 m to body 0 is pulled up.
struct PullOnAll {
    [[nodiscard]] bool acts_on(const auto& bodies, int b) const {
        if (b == 0) return false;
        double distance2 = 0;
        for (int i = 0; i < 3; ++i) {
            const double d = static_cast<double>(bodies.position(b)[i] - bodies.position(0)[i]);
            distance2 += d * d;
        }
        return distance2 < 16;
    }
    template <class Group>
    void apply_to(const Group& group) const {
        using Work = typename Group::Work;
        for (int k = 0; k < group.count; ++k)
            if (acts_on(group.bodies, group.id[k])) group.push(k, Vector3<Work>{Work(0), Work(30), Work(0)});
    }
};
template <class N>
struct Magnetic : Ground<N, 4> {
    using Loads = LoadList<PullOnAll>;
};
TYPED_TEST(Standing, bodies_feel_a_load_that_begins_to_act_by_itself) {
    const auto run = []<class Ground>(Ground, bool looks, int height, int first) {
        Player<Ground> play{{.gravity = {0, gravity, 0}}};
        EXPECT_TRUE(play.world().add(PlaneSpec{}));
        (void)play.add(sphere(1, Real{0.25}), {-8, Real{0.25} + height, 1}, {4, Real{4} * height, 0});
        BodyId boxes[2];
        for (int i = 0; i < 2; ++i) boxes[i] = play.add(box(1, {1, 1, 1}), {0, Real{i == first ? 0.5 : 1.5}, -1});
        double top = 0;
        for (int step = 0; step < 600; ++step) {
            if (looks) play.look_at_everything();
            play.run(1);
            top = std::max(top, static_cast<double>(play.world().position(boxes[first]).y));
        }
        EXPECT_GT(top, 2);
        return play.hashes();
    };
    for (const int height : {0, 2})
        for (const int first : {0, 1})
            EXPECT_EQ(run(Magnetic<TypeParam>{}, false, height, first),
                      run(Magnetic<TypeParam>{}, true, height, first));
}

// From a step on it pushes body 0 along x.
struct Gust {
    std::uint32_t begin = 0;
    float force = 0;  // N

    [[nodiscard]] bool acts_on(const auto& bodies, int b) const { return b == 0 && bodies.steps_taken >= begin; }
    template <class Group>
    void apply_to(const Group& group) const {
        using Work = typename Group::Work;
        for (int k = 0; k < group.count; ++k)
            if (acts_on(group.bodies, group.id[k]))
                group.push(k, Vector3<Work>{static_cast<Work>(force), Work(0), Work(0)});
    }
};
template <class N, int room>
struct Windy : Ground<N, room> {
    using Loads = LoadList<Gust>;
};
// A ball flies alone, or has another before it, which is as far from a wall. Bounds on the time to contact that were
// found without the load end when it begins, those of the other ball too.
TYPED_TEST(Standing, a_load_that_begins_to_act_by_itself_drives_no_body_into_a_wall) {
    const auto run = []<class Ground>(Ground, std::uint32_t begin, bool has_other) {
        WorldSpec spec;
        spec.gravity = {};
        spec.contact.restitution = 0;
        Player<Ground> play{spec};
        PlaneSpec wall;
        wall.normal = {-1, 0, 0};
        wall.offset = Real{0.75};
        EXPECT_TRUE(play.world().add(wall));
        const BodyId driven = play.add(sphere(1, Real{0.5}), {Real{has_other ? -1 : 0}, 0, 0}),
                     last = has_other ? play.add(sphere(1, Real{0.5}), {0, 0, 0}) : driven;
        Gust& gust = play.world().template change_load<Gust>();
        gust.begin = begin;
        gust.force = has_other ? 4000 : 100;
        double most = 0;
        for (int step = 0; step < 60; ++step) {
            play.run(1);
            most = std::max(most, static_cast<double>(play.world().position(last).x));
        }
        EXPECT_NEAR(most, 0.25, static_cast<double>(play.world().contact_tolerance()))
            << "from step " << begin << (has_other ? ", with another ball" : "") << ", " << Ground::features.bodies
            << " bodies";
    };
    for (const bool has_other : {false, true})
        for (std::uint32_t begin = 20; begin < 28; ++begin) {
            run(Windy<TypeParam, 4>{}, begin, has_other);
            run(Windy<TypeParam, 70>{}, begin, has_other);
        }
}

template <class N>
struct Crowded : Ground<N, 3> {
    static constexpr Features features = [] {
        Features all = Ground<N, 3>::features;
        all.near_pairs = 3;
        return all;
    }();
};
TYPED_TEST(Standing, a_pair_without_room_is_found_when_there_is_room) {
    for (const int side : {-1, 1}) {
        Player<Crowded<TypeParam>> play{{.gravity = {0, gravity, 0}}};
        PlaneSpec wall;
        wall.normal = {Real{side}, 0, 0};
        EXPECT_TRUE(play.world().add(PlaneSpec{}));
        EXPECT_TRUE(play.world().add(wall));
        (void)play.add(sphere(1, Real{0.25}), {Real{30} * side, Real{0.25}, 0}, {Real{0.25} * side, 0, 0});
        const BodyId inside = play.add(box(1, {1, 1, 1}), {Real{3} * side, Real{0.5}, 0}),
                     leaving = play.add(sphere(1, Real{0.25}), {Real{30} * side, Real{0.25}, 9});
        play.run(20);
        play.world().set_pose(inside, {Real{0.25} * side, Real{0.5}, 0});
        play.run(20);
        EXPECT_TRUE(play.world().status().has(Issue::contacts_full));
        EXPECT_EQ(play.world().contact_count(inside), 4);
        play.world().set_velocity(leaving, {0, 2, 0});
        play.run(60);
        EXPECT_EQ(play.world().near_pair_count(), 3);
        EXPECT_GT(play.world().contact_count(inside), 4);
    }
}

}  // namespace
}  // namespace tumble::test::bodies_that_stand
