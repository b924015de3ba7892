// Scenes that bound the impacts, searches and sweeps of a step: what is left over is resolved at the start of the next.
#include <tumble/tumble.hpp>

#include "kinds.hpp"
#include "tolerances.hpp"

#include <algorithm>
#include <cmath>

namespace tumble::test {
namespace {

// Counts how often a step asks for the forces, which is about once a flight.
struct Counter {
    int* calls = nullptr;

    [[nodiscard]] bool acts_on(const auto& bodies, int b) const { return !bodies.constants[b].fixed(); }
    void apply_to(auto&) const {
        if (calls != nullptr) ++*calls;
    }
};

template <class N, bool on = true>
struct Bounded : Scene {
    using Numbers = N;
    using Loads = LoadList<Counter>;
    static constexpr Features features{
        .bodies = 8, .planes = 6, .pairs = true, .boxes = true, .friction = true, .impact_bounds = on};
};

template <class N>
class ImpactBoundsTest : public testing::Test {
protected:
    using World = tumble::World<Bounded<N>>;

    static WorldSpec with(int impacts, int searches, Real restitution = 1, Real friction = 0) {
        WorldSpec spec;
        spec.gravity = {0, -9.8125, 0};  // m/s^2
        spec.contact.restitution = restitution;
        spec.contact.friction = friction;
        spec.contact.most_impacts = impacts;
        spec.contact.most_searches = searches;
        return spec;
    }
    static WorldSpec with_sweeps(int sweeps, Real restitution, Real friction) {
        WorldSpec spec = with(0, 0, restitution, friction);
        spec.contact.most_sweeps = sweeps;
        return spec;
    }
    static PlaneSpec wall(const RealVec3& normal, Real offset) {
        PlaneSpec plane;
        plane.normal = normal;
        plane.offset = offset;
        return plane;
    }
    static void add_dice(auto& world) {
        EXPECT_TRUE(world.add(PlaneSpec{}));
        (void)world.add(at(box(1, {1, 0.5, 0.75}), {0, 2, 0}, {1, 0, -0.5}, {1, 2, 3}));
        (void)world.add(at(box(1, {0.5, 0.5, 0.5}), {0.25, 3, 0}, {}, {1, 0, 0}));
    }
    // A ball flies into a corner: three impacts in one step.
    static BodyId add_corner(World& world, bool mirrored = false) {
        const Real side = mirrored ? Real{-1} : Real{1};
        EXPECT_TRUE(world.add(PlaneSpec{}));
        EXPECT_TRUE(world.add(wall({side, 0, 0}, 0)));
        EXPECT_TRUE(world.add(wall({0, 0, 1}, 0)));
        return world.add(at(sphere(1, Real{0.25}), {side * Real{2.25}, 2.27, 2.29}, {side * Real{-20}, -19, -20}));
    }
    static double energy(const World& world, BodyId body) {
        return static_cast<double>(world.kinetic_energy(body)) + static_cast<double>(world.potential_energy(body));
    }
};
using Systems = Tested<testing::Types<Q32<>>, testing::Types<F64>>;
TYPED_TEST_SUITE(ImpactBoundsTest, Systems);

TYPED_TEST(ImpactBoundsTest, that_are_never_reached_change_no_bit) {
    for (const Real restitution : {Real{0}, Real{0.5}, Real{1}}) {
        const WorldSpec usual = this->with(0, 0, restitution, Real{0.25});
        WorldSpec wide = this->with(8, 96, restitution, Real{0.25});
        wide.contact.most_sweeps = 100000;
        World<Bounded<TypeParam, false>> without{Seconds{1, 256}, usual};
        typename TestFixture::World free{Seconds{1, 256}, usual}, bounded{Seconds{1, 256}, wide};
        this->add_dice(without);
        this->add_dice(free);
        this->add_dice(bounded);
        for (int step = 0; step < 512; ++step) {
            (void)without.step();
            (void)free.step();
            (void)bounded.step();
            ASSERT_EQ(free.hash(), without.hash()) << "in step " << step;
            ASSERT_EQ(bounded.hash(), without.hash()) << "in step " << step;
        }
        EXPECT_TRUE(bounded.status().ok());
    }
}

TYPED_TEST(ImpactBoundsTest, leave_the_impacts_of_a_corner_to_the_next_steps) {
    for (const bool mirrored : {false, true}) {
        typename TestFixture::World world{Seconds{1, 64}, this->with(1, 12)};
        const BodyId ball = this->add_corner(world, mirrored);
        world.set_velocity(ball, {mirrored ? 20 : -20, -19, -20});
        int steps = 0;
        while (!world.status().has(Issue::left_over) && ++steps < 16) (void)world.step();
        ASSERT_LT(steps, 16);
        for (int step = 0; step < 3; ++step) (void)world.step();
        // Each speed has been reversed.
        const auto v = world.velocity(ball);
        EXPECT_NEAR(std::abs(static_cast<double>(v.x)), 20, 1e-4);
        EXPECT_EQ(static_cast<double>(v.x) > 0, !mirrored);
        EXPECT_NEAR(static_cast<double>(v.z), 20, 1e-4);
        EXPECT_NEAR(static_cast<double>(v.y), 19, 1);
        EXPECT_EQ(world.status().count, 1);
    }
}

TYPED_TEST(ImpactBoundsTest, lose_no_energy_however_narrow_they_are) {
    for (const int searches : {1, 2, 4}) {
        typename TestFixture::World world{Seconds{1, 64}, this->with(1, searches)};
        const BodyId ball = this->add_corner(world);
        const double before = this->energy(world, ball);
        for (int step = 0; step < 256; ++step) (void)world.step();
        // A search of few flights ends within the tolerance of the surface.
        EXPECT_NEAR(this->energy(world, ball), before, 1e-3 * 9.8125) << searches;
    }
}

TYPED_TEST(ImpactBoundsTest, bound_the_flights_of_a_step) {
    const auto most_flights = [&](int impacts, int searches) {
        typename TestFixture::World world{Seconds{1, 256}, this->with(impacts, searches, Real{0.5}, Real{0.25})};
        int calls = 0, most = 0;
        world.template change_load<Counter>().calls = &calls;
        EXPECT_TRUE(world.add(PlaneSpec{}));
        for (int i = 0; i < 6; ++i)
            (void)world.add(at(box(1, {0.5, 0.5, 0.5}), {Real{0.1 * (i % 3)}, Real{0.5 + 0.75 * i}, 0},
                               {0, Real{-i}, 0}, {1, 2, Real{0.5 * i}}));
        for (int step = 0; step < 512; ++step) {
            calls = 0;
            (void)world.step();
            most = std::max(most, calls);
        }
        EXPECT_EQ(world.status().has(Issue::left_over), impacts > 0);
        return most;
    };
    const int free = most_flights(0, 0), bounded = most_flights(1, 4);
    EXPECT_LT(bounded, free / 2) << free;
}

// A ball that falls at less than its radius a step ends a step in the floor or in the box, and leaves it.
TYPED_TEST(ImpactBoundsTest, let_nothing_pass_through) {
    for (const bool plane : {true, false})
        for (int i = 0; i < 16; ++i) {
            typename TestFixture::World world{Seconds{1, 64}, this->with(1, 1)};
            BodySpec slab = box(1, {4, Real{0.03125}, 4});
            slab.fixed = true;
            if (plane) EXPECT_TRUE(world.add(PlaneSpec{}));
            else (void)world.add(at(slab, {0, Real{-0.015625}, 0}));
            const BodyId ball =
                world.add(at(sphere(1, Real{0.0625}), {0, Real{0.5 + 0.03 * i}, 0}, {0, Real{-40 - i}, 0}));
            double least = 1;
            for (int step = 0; step < 8; ++step) {
                (void)world.step();
                least = std::min(least, static_cast<double>(world.position(ball).y));
            }
            EXPECT_GT(static_cast<double>(world.velocity(ball).y), 38 + i) << plane << " " << i;
            EXPECT_GT(static_cast<double>(world.position(ball).y), 0.0625) << plane << " " << i << " " << least;
        }
}

// A box is thrown, hits the floor with its vertices, edges and faces, and slides to rest.
TYPED_TEST(ImpactBoundsTest, of_few_sweeps_let_a_box_come_to_rest_a_little_elsewhere) {
    for (const bool mirrored : {false, true})
        for (const double bounce : {0.0, 0.375}) {
            const Real side = mirrored ? Real{-1} : Real{1};
            const auto end = [&](int sweeps) {
                typename TestFixture::World world{Seconds{1, 256}, this->with_sweeps(sweeps, Real{bounce}, Real{0.5})};
                EXPECT_TRUE(world.add(PlaneSpec{}));
                const BodyId body = world.add(at(box(1, {0.5, 0.3, 0.4}), {0, Real{1.2}, 0}, {side * Real{2}, 0, 0.5},
                                                 {1, side * Real{2}, side * Real{3}}));
                double before = this->energy(world, body);
                for (int step = 0; step < 768; ++step) {
                    (void)world.step();
                    const double now = this->energy(world, body);
                    EXPECT_LT(now, before + 1e-3) << "in step " << step << " with " << sweeps;
                    before = now;
                }
                if (sweeps < 32) { EXPECT_EQ(world.status().has(Issue::left_over), sweeps > 0) << sweeps; }
                EXPECT_EQ(world.contact_count(body), 4) << sweeps;
                return world.position(body);
            };
            const auto usual = end(0), many = end(32), few = end(8);
            for (const auto& [bounded, within] : {std::pair{many, 1e-3}, std::pair{few, 1e-2}}) {
                EXPECT_NEAR(static_cast<double>(bounded.x), static_cast<double>(usual.x), within) << mirrored;
                EXPECT_NEAR(static_cast<double>(bounded.y), static_cast<double>(usual.y), 1e-3) << mirrored;
                EXPECT_NEAR(static_cast<double>(bounded.z), static_cast<double>(usual.z), within) << mirrored;
            }
            // One sweep a solution is the least there is. It still holds the box.
            EXPECT_GT(static_cast<double>(end(1).y), 0.14);
        }
}

// What the sweeps of a step do not pass on strikes in the next one, at full restitution.
TYPED_TEST(ImpactBoundsTest, of_few_sweeps_pass_a_strike_through_a_row_of_balls_in_several_steps) {
    for (const int sweeps : {1, 2, 5, 64}) {
        WorldSpec spec = this->with_sweeps(sweeps, 1, 0);
        spec.gravity = {};
        typename TestFixture::World world{Seconds{1, 256}, spec};
        BodyId ball[6];
        for (int i = 0; i < 6; ++i)
            ball[i] = world.add(at(sphere(1, Real{0.25}), {Real{0.5 * i} - Real{i == 0 ? 0.25 : 0}, 0, 0},
                                   {Real{i == 0 ? 2 : 0}, 0, 0}));
        for (int step = 0; step < 128; ++step) (void)world.step();
        for (int i = 0; i < 5; ++i)
            EXPECT_NEAR(static_cast<double>(world.velocity(ball[i]).x), 0, 1e-3) << i << ", " << sweeps;
        EXPECT_NEAR(static_cast<double>(world.velocity(ball[5]).x), 2, 1e-3) << sweeps;
        EXPECT_EQ(world.status().has(Issue::left_over), sweeps < 64) << sweeps;
    }
}

}  // namespace
}  // namespace tumble::test
