// Islands of many bodies that step in bounded time: what they keep, and where they come to rest.
#include <tumble/tumble.hpp>

#include "kinds.hpp"
#include "random.hpp"
#include "snapshots.hpp"
#include "tolerances.hpp"

#include <cmath>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

namespace tumble::test {
namespace {

template <class N, bool bounded = true, bool exact = true>
struct Piles : Scene {
    using Numbers = N;
    static constexpr Features features = [] {
        Features all = touching(16, 5);
        all.near_pairs = 140;
        all.sleep = all.kinematic = all.turntables = all.contact_readout = true;
        all.bounded_steps = bounded;
        all.exact_steps = exact;
        return all;
    }();
};

template <class N>
class BoundedSteps : public testing::Test {
protected:
    using World = tumble::World<Piles<N>>;
    static constexpr double g = 9.8125;  // m/s^2

    [[nodiscard]] static WorldSpec with(int exact_bodies, double restitution, double friction, bool falls = true) {
        WorldSpec spec;
        if (falls) spec.gravity = {0, -g, 0};
        spec.contact.restitution = restitution;
        spec.contact.friction = friction;
        spec.contact.exact_bodies = exact_bodies;
        return spec;
    }
    [[nodiscard]] static PlaneSpec wall(double x, double y, double z, double offset) {
        PlaneSpec plane;
        plane.normal = {x, y, z};
        plane.offset = offset;
        return plane;
    }
    static void add_pit(auto& world, double half_width = 1) {
        EXPECT_TRUE(world.add(wall(0, 1, 0, 0)));
        for (const double side : {1.0, -1.0}) {
            EXPECT_TRUE(world.add(wall(side, 0, 0, half_width)));
            EXPECT_TRUE(world.add(wall(0, 0, side, half_width)));
        }
    }
    // Bodies of up to this ratio of masses, turned and thrown about. Cubes and balls keep the energy of their spin to
    // rounding; boxes do not roll away.
    enum class Bodies { boxes, cubes_and_balls };
    static void add_thrown(auto& world, Random& random, Bodies kind, double most_mass, double speed) {
        for (int i = 0; i < 12; ++i) {
            const double mass = std::pow(most_mass, random.uniform(0, 1)), edge = random.uniform(0.25, 0.5);
            BodySpec body = box(mass, {edge, edge, edge});
            if (kind == Bodies::boxes) body = box(mass, {edge, random.uniform(0.25, 0.5), random.uniform(0.25, 0.5)});
            else if (random.between(0, 2) == 0) body = sphere(mass, edge / 2);
            const auto part = [&](double most) { return random.uniform(-most, most); };
            body.position = {(i % 2) * 0.9 - 0.45, 0.5 + 0.9 * std::floor(i / 4), (i / 2 % 2) * 0.9 - 0.45};
            body.orientation = {1, {part(1), part(1), part(1)}};
            body.velocity = {part(speed), part(speed), part(speed)};
            body.angular_velocity = {part(3), part(3), part(3)};
            ASSERT_TRUE(world.add(body));
        }
    }
    static void add_stack(auto& world, int boxes, double gap) {
        ASSERT_TRUE(world.add(PlaneSpec{}));
        for (int i = 0; i < boxes; ++i) ASSERT_TRUE(world.add(at(box(10, {1, 1, 1}), {0, 0.5 + i + gap * (i + 1), 0})));
    }
    [[nodiscard]] static std::vector<BodyId> ids(const World& world) {
        std::vector<BodyId> ids;
        for (int b = 0; b < Piles<N>::features.bodies; ++b)
            if (world.contains(BodyId{b})) ids.push_back(BodyId{b});
        return ids;
    }
    [[nodiscard]] static Vector in_doubles(const auto& v) {
        return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
    }
    [[nodiscard]] static Vector place(const World& world, BodyId b) { return in_doubles(world.position(b)); }
    [[nodiscard]] static Vector velocity(const World& world, BodyId b) { return in_doubles(world.velocity(b)); }
    // m: what rounding leaves of a place on the axis of a stack.
    static constexpr double on_axis = std::is_same_v<N, F64> ? 1e-13 : 1e-7;
    // What rounding leaves of a sum over many bodies, relative.
    static constexpr double rounding = std::is_same_v<N, F64> ? 1e-12 : 1e-5;
    [[nodiscard]] static double energy(const World& world) {
        double sum = 0;
        for (const BodyId b : ids(world))
            sum += static_cast<double>(world.kinetic_energy(b)) + static_cast<double>(world.potential_energy(b));
        return sum;
    }
    [[nodiscard]] static double deepest(const World& world) {
        double depth = 0;
        for (const BodyId b : ids(world))
            for (const auto& contact : world.contacts(b)) depth = std::max(depth, static_cast<double>(contact.depth));
        return depth;
    }
    [[nodiscard]] static bool stands(const World& world) {
        bool all = true;
        for (const BodyId b : ids(world))
            all = all && norm(in_doubles(world.velocity(b))) == 0 && norm(in_doubles(world.angular_velocity(b))) == 0;
        return all;
    }
};
using BoundedSystems = Tested<testing::Types<Q32<>>, testing::Types<F64, F32>>;
TYPED_TEST_SUITE(BoundedSteps, BoundedSystems);

TYPED_TEST(BoundedSteps, give_the_same_bits_without_the_code_of_exact_ones) {
    const WorldSpec spec = this->with(0, 0.5, 0.5);
    World<Piles<TypeParam, true, false>> without{Seconds{1, 64}, spec};
    typename TestFixture::World with{Seconds{1, 64}, spec};
    this->add_stack(without, 3, 0.25);
    this->add_stack(with, 3, 0.25);
    for (int step = 0; step < 64; ++step) {
        (void)without.step();
        (void)with.step();
        ASSERT_EQ(with.hash(), without.hash()) << "in step " << step;
    }
}

TYPED_TEST(BoundedSteps, are_taken_by_islands_of_more_bodies_alone) {
    const WorldSpec some = this->with(2, 0.5, 0.5), exact = this->with(ContactSpec::any, 0.5, 0.5);
    for (const int boxes : {1, 2, 3}) {
        World<Piles<TypeParam, false>> without{Seconds{1, 64}, exact};
        typename TestFixture::World usual{Seconds{1, 64}, exact}, bounded{Seconds{1, 64}, some};
        this->add_stack(without, boxes, 0.25);
        this->add_stack(usual, boxes, 0.25);
        this->add_stack(bounded, boxes, 0.25);
        for (int step = 0; step < 64; ++step) {
            (void)without.step();
            (void)usual.step();
            (void)bounded.step();
            ASSERT_EQ(usual.hash(), without.hash()) << boxes << " boxes in step " << step;
            ASSERT_TRUE(boxes == 3 || bounded.hash() == usual.hash()) << boxes << " boxes in step " << step;
        }
        EXPECT_EQ(bounded.hash() == usual.hash(), boxes < 3);
    }
}

// Without gravity all energy is kinetic. Corrections of overlaps give none.
TYPED_TEST(BoundedSteps, add_no_energy_and_no_momentum) {
    for (int scene = 0; scene < 24; ++scene) {
        Random random{static_cast<std::uint64_t>(scene + 1)};
        const double restitution = scene % 4 / 3.0, friction = random.uniform(0, 1.2);
        typename TestFixture::World world{Seconds{1, scene % 3 == 0   ? 32
                                                     : scene % 3 == 1 ? 64
                                                                      : 256},
                                          this->with(scene % 2, restitution, friction, false)};
        this->add_thrown(world, random, TestFixture::Bodies::cubes_and_balls, 100, 3);
        for (const BodyId b : this->ids(world)) {  // towards the middle
            const Vector x = this->place(world, b) - Vector{0, 1.5L, 0};
            world.set_velocity(
                b, {static_cast<float>(-2 * x.x), static_cast<float>(-2 * x.y), static_cast<float>(-2 * x.z)});
        }
        const auto momentum = [&] {
            Vector sum{};
            for (const BodyId b : this->ids(world))
                sum = sum + this->velocity(world, b) * static_cast<double>(world.mass(b));
            return sum;
        };
        const Vector before = momentum();
        const double first = this->energy(world);
        double last = first;
        bool touched = false;
        for (int step = 0; step < 128; ++step) {
            (void)world.step();
            const double now = this->energy(world);
            ASSERT_LE(now, last + this->rounding * first) << scene << " in step " << step;
            touched = touched || now < 0.99 * first;
            last = now;
        }
        EXPECT_TRUE(touched || restitution == 1) << scene;
        EXPECT_LE(norm(momentum() - before), this->rounding * 5000) << scene;
    }
}

TYPED_TEST(BoundedSteps, bring_what_falls_into_a_pit_to_rest) {
    for (int scene = 0; scene < 12; ++scene) {
        Random random{static_cast<std::uint64_t>(scene + 100)};
        typename TestFixture::World world{Seconds{1, scene % 2 == 0 ? 60 : 256},
                                          this->with(0, scene % 4 / 3.0, random.uniform(0.3, 0.8))};
        this->add_pit(world);
        this->add_thrown(world, random, TestFixture::Bodies::boxes, 10, 1);
        const double first = this->energy(world);
        double last = first, lifted = 0;
        const int steps = (scene % 2 == 0 ? 60 : 256) * 8;
        for (int step = 0; step < steps; ++step) {
            (void)world.step();
            const double now = this->energy(world);
            if (now > last) lifted += now - last;
            last = now;
        }
        EXPECT_TRUE(this->stands(world)) << scene;
        EXPECT_LE(lifted, first / 1000) << scene;  // overlaps that are pushed apart
        EXPECT_LE(this->deepest(world), 1.5 * static_cast<double>(tolerance::contact_band)) << scene;
        for (const BodyId b : this->ids(world)) {
            const Vector x = this->place(world, b);
            EXPECT_TRUE(std::abs(x.x) < 1 && std::abs(x.z) < 1 && x.y > 0) << scene;
        }
        // And there it stays, to the bit.
        const Vector there = this->place(world, BodyId{11});
        for (int step = 0; step < 64; ++step) (void)world.step();
        EXPECT_EQ(norm(this->place(world, BodyId{11}) - there), 0) << scene;
        EXPECT_TRUE(this->stands(world)) << scene;
    }
}

#ifdef TUMBLE_EVERY_KIND
template <class N>
struct LargePit : Scene {
    using Numbers = N;
    static constexpr Features features = [] {
        Features all = touching(50, 5);
        all.near_pairs = 400;
        all.bounded_steps = true;
        return all;
    }();
};
// Where sweeps are few, a heap creeps on. Two of the eight may.
TYPED_TEST(BoundedSteps, bring_heaps_of_fifty_boxes_to_rest) {
    int resting = 0;
    for (const int rate : {60, 128}) {
        for (std::uint64_t seed = 0; seed < 4; ++seed) {
            Random random{seed};
            tumble::World<LargePit<TypeParam>> world{Seconds{1, rate}, this->with(0, 0, 0.5)};
            this->add_pit(world, 1.5);
            for (int i = 0; i < 50; ++i) {
                const auto part = [&] { return random.uniform(-1, 1); };
                BodySpec body = box(1, {0.5, 0.5, 0.5});
                body.position = {(i % 3 - 1) * 0.95, 0.6 + 0.95 * std::floor(i / 9), (i / 3 % 3 - 1) * 0.95};
                body.orientation = {1, {part(), part(), part()}};
                ASSERT_TRUE(world.add(body));
            }
            for (int step = 0; step < rate * 8; ++step) (void)world.step();
            bool all = true;
            for (int b = 0; b < 50; ++b) all = all && norm(this->in_doubles(world.velocity(BodyId{b}))) == 0;
            resting += all ? 1 : 0;
        }
    }
    EXPECT_GE(resting, 6);
}
#endif

TYPED_TEST(BoundedSteps, let_what_was_held_go_on) {
    typename TestFixture::World world{Seconds{1, 60}, this->with(0, 0, 0.5)};
    this->add_pit(world);
    Random random{7};
    this->add_thrown(world, random, TestFixture::Bodies::boxes, 2, 0);
    for (int step = 0; step < 480; ++step) (void)world.step();
    ASSERT_TRUE(this->stands(world));
    // Pushed, it moves on and comes to rest again.
    const Vector there = this->place(world, BodyId{11});
    world.set_velocity(BodyId{11}, {0, 2, 0});
    for (int step = 0; step < 4; ++step) (void)world.step();
    EXPECT_GT(norm(this->place(world, BodyId{11}) - there), 0.05);
    for (int step = 0; step < 240; ++step) (void)world.step();
    ASSERT_TRUE(this->stands(world));
    // Without the bodies below, those above fall.
    double before = 0, after = 0;
    for (int b = 0; b < 4; ++b) world.remove(BodyId{b});
    for (const BodyId b : this->ids(world)) before += static_cast<double>(this->place(world, b).y);
    for (int step = 0; step < 60; ++step) (void)world.step();
    for (const BodyId b : this->ids(world)) after += static_cast<double>(this->place(world, b).y);
    EXPECT_LT(after, before - 0.5);
}

TYPED_TEST(BoundedSteps, let_a_box_slide_and_bounce_by_the_laws_of_friction_and_restitution) {
    for (const double friction : {0.2, 0.5}) {
        typename TestFixture::World world{Seconds{1, 256}, this->with(0, 0, friction)};
        ASSERT_TRUE(world.add(PlaneSpec{}));
        BodySpec body = box(2, {1, 0.25, 1});
        body.position = {0, 0.125, 0};
        body.velocity = {1.5, 0, 2};
        const BodyId id = world.add(body);
        for (int step = 0; step < 1024; ++step) (void)world.step();
        // By v^2 / (2 mu g), to first order: to half of the first step.
        const Vector x = this->place(world, id);
        const Number way = 2.5 * 2.5 / (2 * friction * this->g), step = 2.5 / 256;
        EXPECT_LE(std::abs(std::hypot(x.x, x.z) - way), step) << friction;
        EXPECT_LE(std::abs(x.x / x.z - 0.75L), 1e-3L) << friction;
        EXPECT_TRUE(this->stands(world)) << friction;
    }
    for (const double restitution : {0.0, 0.5, 1.0}) {
        typename TestFixture::World world{Seconds{1, 256}, this->with(0, restitution, 0)};
        ASSERT_TRUE(world.add(PlaneSpec{}));
        const BodyId id = world.add(at(box(2, {1, 0.25, 1}), {0, 1.125, 0}));
        double highest = 0;
        bool hit = false;
        for (int step = 0; step < 256; ++step) {
            (void)world.step();
            for (const auto& contact : world.contacts(id)) {
                if (contact.hit && !hit) {
                    EXPECT_NEAR(static_cast<double>(contact.hit_speed), std::sqrt(2 * this->g), this->g / 128);
                }
                hit = hit || contact.hit;
            }
            if (hit) highest = std::max(highest, static_cast<double>(this->place(world, id).y) - 0.125);
        }
        // It turns round up to a step early, above the floor by what it flies in that.
        const double early = std::sqrt(2 * this->g) / 256;
        EXPECT_TRUE(hit);
        EXPECT_GE(highest, restitution * restitution - early);
        EXPECT_LE(highest, restitution * restitution + 3 * early);
    }
}

// At restitution 1 the energy is that of before, and rounding must not decide whether it is more.
TYPED_TEST(BoundedSteps, bounce_without_loss_at_restitution_one) {
    Random random{5};
    for (int scene = 0; scene < 40; ++scene) {
        typename TestFixture::World world{Seconds{1, 60}, this->with(0, 1, 0, false)};
        const double speed = random.uniform(0.5, 4), aside = random.uniform(0, 0.15);
        if (scene % 2 == 0) {  // two balls, oblique
            BodySpec ball = at(sphere(1, Real{0.1}), {-1, aside, 0});
            ball.velocity = {speed, 0, 0};
            (void)world.add(ball);
            (void)world.add(at(sphere(random.uniform(0.5, 2), Real{0.1}), {0, 0, 0}));
        } else {  // a box, flat on a plane
            ASSERT_TRUE(world.add(PlaneSpec{}));
            BodySpec body = at(box(random.uniform(0.5, 2), {0.5, 0.25, 0.75}), {0, 0.625, 0});
            body.velocity = {0, -speed, 0};
            (void)world.add(body);
        }
        const double before = this->energy(world);
        for (int step = 0; step < 150; ++step) (void)world.step();
        EXPECT_LE(this->energy(world), before * (1 + this->rounding)) << scene;
        EXPECT_GE(this->energy(world), before * 0.98) << scene;
    }
}

TYPED_TEST(BoundedSteps, keep_a_stack_that_is_set_down_on_its_axis) {
    for (const int boxes : {3, 6, 10}) {
        typename TestFixture::World world{Seconds{1, 60}, this->with(2, 0, 0.5)};
        this->add_stack(world, boxes, 0.002);
        for (int step = 0; step < 120; ++step) (void)world.step();
        EXPECT_TRUE(this->stands(world)) << boxes;
        EXPECT_TRUE(world.status().ok());
        double weight = 0;
        for (const auto& contact : world.contacts(BodyId{0}))
            if (contact.plane == PlaneId{0}) weight = static_cast<double>(contact.normal_impulse) * 60;
        EXPECT_NEAR(weight, boxes * 10 * this->g, 0.01 * weight);
        for (const BodyId b : this->ids(world)) {
            const Vector x = this->place(world, b);
            EXPECT_LE(std::hypot(x.x, x.z), this->on_axis) << boxes;
        }
    }
}

// Their faces are solved at once, so what is symmetric stays so.
TYPED_TEST(BoundedSteps, set_boxes_of_any_shape_down_where_they_are) {
    for (const auto& [x, y, z] : {std::tuple{0.5, 0.5, 0.5},
                                  {0.4, 0.2, 0.3},
                                  {0.5, 0.2, 0.4},
                                  {2.5, 1.5, 2.5},
                                  {0.02, 0.3, 0.02},
                                  {0.25, 0.02, 0.25}}) {
        for (const double gap : {0.0005, 0.005}) {
            for (const double off : {0.0, 0.01}) {
                if (off > 0 && off > 0.05 * std::min(x, y)) continue;
                Random random{7};
                typename TestFixture::World world{Seconds{1, 60}, this->with(ContactSpec::few, 0, 0.5)};
                ASSERT_TRUE(world.add(PlaneSpec{}));
                std::vector<Vector> places;
                for (int i = 0; i < 8; ++i) {
                    const auto aside = [&] { return off * random.uniform(-1, 1); };
                    BodySpec body = at(box(1, {x, y, z}), {aside(), y / 2 + gap + i * (y + gap), aside()});
                    body.orientation = {1, {0, 2.5 * aside(), 0}};
                    places.push_back({static_cast<double>(body.position.x), 0, static_cast<double>(body.position.z)});
                    ASSERT_TRUE(world.add(body));
                }
                for (int step = 0; step < 60; ++step) (void)world.step();
                EXPECT_TRUE(this->stands(world)) << y << " m high, " << gap << " m apart, " << off << " m off";
                EXPECT_LE(this->deepest(world), 0.0006);
                for (const BodyId b : this->ids(world)) {
                    const Vector at = this->place(world, b), from = places[static_cast<std::size_t>(b.index())];
                    EXPECT_LE(std::hypot(at.x - from.x, at.z - from.z), off > 0 ? 0.001 : this->on_axis)
                        << y << " m high, " << gap << " m apart, " << off << " m off";
                }
            }
        }
    }
}

// Up to two boxes, or sixteen balls, are few.
TYPED_TEST(BoundedSteps, are_taken_by_many_and_told) {
    const auto drop = [&](int exact_bodies, int boxes, int balls) {
        auto world = std::make_unique<typename TestFixture::World>(Seconds{1, 64}, this->with(exact_bodies, 0.5, 0.5));
        EXPECT_TRUE(world->add(PlaneSpec{}));
        for (int i = 0; i < boxes + balls; ++i)
            EXPECT_TRUE(world->add(at(i < boxes ? box(1, {1, 1, 1}) : sphere(1, 0.5), {0.03 * i, 0.75 + 1.1 * i, 0})));
        bool any = false;
        for (int step = 0; step < 64; ++step) {
            (void)world->step();
            for (const BodyId b : this->ids(*world)) any = any || world->stepped_bounded(b);
            EXPECT_TRUE(any || world->deepest_overlap() == 0);
        }
        return std::pair{any, world->hash()};
    };
    for (const auto& [boxes, balls, many] :
         {std::tuple{2, 0, false}, {0, 16, false}, {1, 1, false}, {3, 0, true}, {1, 2, true}}) {
        const auto usual = drop(ContactSpec::few, boxes, balls), exact = drop(ContactSpec::any, boxes, balls);
        EXPECT_EQ(usual.first, many) << boxes << " boxes, " << balls << " balls";
        EXPECT_EQ(usual.second == exact.second, !many) << boxes << " boxes, " << balls << " balls";
        EXPECT_FALSE(exact.first);
    }
}

// What slides over boxes side by side, as fast as many of its lengths in a step, does not strike their sides.
TYPED_TEST(BoundedSteps, let_a_body_slide_over_the_seams_of_others) {
    for (const bool ball : {false, true}) {
        for (const double speed : {0.5, 6.0}) {
            typename TestFixture::World world{Seconds{1, 64}, this->with(ContactSpec::few, 0.5, 0)};
            PlaneSpec floor;
            floor.offset = 0.25;
            ASSERT_TRUE(world.add(floor));
            for (int i = 0; i < 12; ++i)
                ASSERT_TRUE(world.add(at(box(1, {0.5, 0.25, 1}), {0.5 * i - 0.25, -0.125, 0})));
            BodySpec body = at(ball ? sphere(1, 0.1) : box(1, {0.2, 0.2, 0.2}), {0, 0.1, 0.1});
            body.velocity.x = speed;
            ASSERT_TRUE(world.add(body));
            const double time = 5 / speed < 1 ? 0.75 : 1;
            for (int step = 0; step < 64 * time; ++step) (void)world.step();
            EXPECT_NEAR(static_cast<double>(world.position(BodyId{12}).x), speed * time, 1e-4) << speed;
            EXPECT_NEAR(static_cast<double>(world.position(BodyId{12}).y), 0.1, 1e-4) << speed;
            for (int i = 0; i < 12; ++i)
                EXPECT_NEAR(static_cast<double>(this->place(world, BodyId{i}).x), 0.5 * i - 0.25, 2e-3) << speed;
        }
    }
}

// Within a step a contact may send a body away from something that it had touched at the start.
TYPED_TEST(BoundedSteps, keep_all_contacts_of_a_step_in_which_bodies_part) {
    for (int seed = 1; seed <= 6; ++seed) {
        Random random{static_cast<std::uint64_t>(seed)};
        typename TestFixture::World world{Seconds{1, 128}, this->with(0, 0.6, 0)};
        this->add_pit(world);
        this->add_thrown(world, random, TestFixture::Bodies::cubes_and_balls, 4, 3);
        for (int step = 0; step < 200; ++step) {
            std::vector<Vector> before;
            for (const BodyId b : this->ids(world)) before.push_back(this->velocity(world, b));
            (void)world.step();
            for (const BodyId b : this->ids(world)) {
                Vector sum{0, -this->g * static_cast<double>(world.mass(b)) / 128, 0};
                for (const auto& contact : world.contacts(b)) sum = sum + this->in_doubles(contact.impulse);
                const Vector change = (this->velocity(world, b) - before[static_cast<std::size_t>(b.index())]) *
                                      static_cast<double>(world.mass(b));
                EXPECT_LE(norm(change - sum), 0.05) << "seed " << seed << ", step " << step;
            }
        }
    }
}

// With masses of up to 100 to 1 sweeps in bounded number are far from a solution, and would add up to a joule in a
// step.
TYPED_TEST(BoundedSteps, add_no_energy_where_sweeps_are_far_from_done) {
    for (const int seed : {111, 141}) {
        Random random{static_cast<std::uint64_t>(seed)};
        typename TestFixture::World world{Seconds{1, 60}, this->with(0, 0, random.uniform(0.3, 1.2))};
        this->add_pit(world);
        this->add_thrown(world, random, TestFixture::Bodies::boxes, 100, 1);
        double last = this->energy(world), most = 0;
        for (int step = 0; step < 300; ++step) {
            (void)world.step();
            const double now = this->energy(world);
            most = std::max(most, now - last);
            last = now;
        }
        EXPECT_LE(most, 0.4) << seed;  // by corrections of deep overlaps
    }
}

// A light body on which heavy ones fall spins by up to a radian in a step, and bounded sweeps do not hold it.
TYPED_TEST(BoundedSteps, let_nothing_through_a_surface) {
    for (const std::uint64_t seed : {7u, 33u, 53u, 99u, 2172u}) {
        Random random{seed};
        const double restitution = random.uniform(0, 1), friction = random.uniform(0, 1.2);
        typename TestFixture::World world{Seconds{1, 30}, this->with(0, restitution, friction)};
        this->add_pit(world);
        const auto part = [&](double most) { return random.uniform(-most, most); };
        for (int i = 0; i < 16; ++i) {
            BodySpec body = box(std::pow(10, part(1)),
                                {random.uniform(0.1, 0.6), random.uniform(0.1, 0.6), random.uniform(0.1, 0.6)});
            body.position = {(i % 2) - 0.5, 0.6 + std::floor(i / 4), (i / 2 % 2) - 0.5};
            body.orientation = {1, {part(1), part(1), part(1)}};
            body.velocity = {part(1), random.uniform(-2, 1), part(1)};
            body.angular_velocity = {part(5), part(5), part(5)};
            ASSERT_TRUE(world.add(body));
        }
        bool all = true;
        for (int step = 0; all && step < 90; ++step) {
            (void)world.step();
            for (const BodyId b : this->ids(world)) {
                const Vector x = this->place(world, b);
                all = all && x.y > 0 && std::abs(x.x) < 1 && std::abs(x.z) < 1;
                // A flight that was not taken is not told.
                for (const auto& contact : world.contacts(b)) {
                    const bool pushes = static_cast<double>(contact.normal_impulse) > 0;
                    all = all && (pushes || (!contact.hit && (contact.touches || contact.ended)));
                }
            }
            EXPECT_TRUE(all) << "pile " << seed << ", step " << step;
        }
    }
}

TYPED_TEST(BoundedSteps, carry_a_stack_on_what_moves) {
    typename TestFixture::World world{Seconds{1, 128}, this->with(0, 0, 0.5)};
    BodySpec lift = box(1, {4, 0.5, 4});
    lift.kinematic = true;
    lift.position = {0, -0.25, 0};
    lift.velocity = {0.5, 0.25, 0};
    const BodyId carrier = world.add(lift);
    for (int i = 0; i < 3; ++i) {
        BodySpec body = at(box(1, {0.5, 0.5, 0.5}), {0, 0.25 + 0.5 * i, 0});
        body.velocity = lift.velocity;
        (void)world.add(body);
    }
    for (int step = 0; step < 256; ++step) (void)world.step();
    for (const BodyId b : this->ids(world)) {
        const Vector x = this->place(world, b) - this->place(world, carrier);
        EXPECT_LE(std::hypot(x.x, x.z, std::remainder(x.y, 0.5L)), 1e-3L);
    }
    // It stops, and they slide on it until friction has stopped them.
    world.set_velocity(carrier, {});
    for (int step = 0; step < 256; ++step) (void)world.step();
    const Vector x = this->place(world, BodyId{1}) - this->place(world, carrier);
    EXPECT_LE(std::abs(x.x - 0.25 / this->g), 0.01L);
    EXPECT_TRUE(this->stands(world));
}

// Matched to the surface at the start, so that nothing slips.
TYPED_TEST(BoundedSteps, keep_a_stack_on_its_circle_on_what_turns) {
    for (const double spin : {-2.0, 1.0, 2.0}) {
        for (const bool kinematic : {false, true}) {
            typename TestFixture::World world{Seconds{1, 60}, this->with(0, 0, 0.625)};
            BodySpec table = box(1, {4, 0.5, 4});
            (kinematic ? table.kinematic : table.fixed) = true;
            table.position = {0, -0.25, 0};
            table.angular_velocity = {0, spin, 0};
            (void)world.add(table);
            for (int i = 0; i < 3; ++i)
                (void)world.add(
                    at(box(1 + i, {0.25, 0.25, 0.25}), {0.5, 0.125 + 0.25 * i, 0}, {0, 0, -0.5 * spin}, {0, spin, 0}));
            for (int step = 0; step < 240; ++step) (void)world.step();
            for (int b = 1; b < 4; ++b) {
                const Vector x = this->place(world, BodyId{b});
                EXPECT_LE(std::abs(std::hypot(x.x, x.z) - 0.5L), 0.002L)
                    << spin << (kinematic ? ", kinematic, " : ", ") << b;
            }
        }
    }
}

// A surface that moves does work.
TYPED_TEST(BoundedSteps, are_pushed_and_lifted_by_what_moves) {
    for (const double speed : {0.5, 2.0}) {
        typename TestFixture::World world{Seconds{1, 64}, this->with(0, 0, 0.3, false)};
        BodySpec pusher = box(1, {0.5, 0.5, 0.5});
        pusher.kinematic = true;
        pusher.velocity = {speed, 0, 0};
        (void)world.add(pusher);
        for (int i = 0; i < 3; ++i) (void)world.add(at(box(1, {0.5, 0.5, 0.5}), {0.51 + 0.51 * i, 0, 0}));
        for (int step = 0; step < 64; ++step) (void)world.step();
        for (int b = 1; b < 4; ++b) EXPECT_LE(std::abs(this->velocity(world, BodyId{b}).x - speed), 0.01) << speed;
        EXPECT_LE(this->deepest(world), static_cast<double>(tolerance::contact_band)) << speed;
    }
    for (const double speed : {0.2, 0.5, 2.0}) {
        typename TestFixture::World world{Seconds{1, 64}, this->with(0, 0, 0.5)};
        BodySpec lift = box(1, {4, 0.5, 4});
        lift.kinematic = true;
        lift.position = {0, -0.25, 0};
        const BodyId carrier = world.add(lift);
        for (int i = 0; i < 3; ++i) (void)world.add(at(box(1, {0.5, 0.5, 0.5}), {0, 0.25 + 0.5 * i, 0}));
        for (int step = 0; step < 32; ++step) (void)world.step();
        world.set_velocity(carrier, {0, static_cast<float>(speed), 0});
        for (int step = 0; step < 64; ++step) (void)world.step();
        for (int b = 1; b < 4; ++b) {
            const Vector x = this->place(world, BodyId{b}) - this->place(world, carrier);
            EXPECT_LE(std::hypot(x.x, x.z), 1e-3L) << speed;
            EXPECT_LE(std::abs(x.y - 0.5L * b), 2e-3L) << speed;
            EXPECT_LE(std::abs(this->velocity(world, BodyId{b}).y - speed), 0.02L) << speed;
        }
    }
}

TYPED_TEST(BoundedSteps, part_what_overlaps_and_touch_nothing_that_is_apart) {
    for (const double gap : {0.004, -0.001}) {
        typename TestFixture::World world{Seconds{1, 60}, this->with(0, 0, 0.5)};
        ASSERT_TRUE(world.add(PlaneSpec{}));
        for (int i = 0; i < 6; ++i)  // side by side, or as a stack
            (void)world.add(gap > 0 ? at(box(1, {0.5, 0.5, 0.5}), {(0.5 + gap) * i, 0.25, 0})
                                    : at(box(1, {0.5, 0.5, 0.5}), {0, 0.25 + gap + (0.5 + gap) * i, 0}));
        for (int step = 0; step < 120; ++step) (void)world.step();
        EXPECT_TRUE(this->stands(world)) << gap;
        EXPECT_LE(this->deepest(world), 0.6 * static_cast<double>(tolerance::contact_band)) << gap;
        for (int b = 0; b < 6; ++b)
            for (const auto& contact : world.contacts(BodyId{b}))
                EXPECT_TRUE(gap < 0 || !contact.touches || contact.plane == PlaneId{0}) << b;
    }
}

TYPED_TEST(BoundedSteps, stop_what_is_pushed_at_a_thin_wall) {
    for (const double gap : {0.01, 0.03, 0.06}) {
        typename TestFixture::World world{Seconds{1, 60}, this->with(0, 0, 0.3, false)};
        BodySpec thin = box(1, {0.02, 2, 2});
        thin.fixed = true;
        (void)world.add(thin);
        // A heavy box at 12 m/s and a light ball between the two.
        BodySpec ball = at(sphere(Real{0.1}, Real{0.1}), {0.11 + gap, 0, 0}),
                 hammer = at(box(50, {0.5, 0.5, 0.5}), {0.7 + gap, 0, 0});
        hammer.velocity = {-12, 0, 0};
        const BodyId light = world.add(ball);
        (void)world.add(hammer);
        for (int step = 0; step < 30; ++step) (void)world.step();
        EXPECT_GT(this->place(world, light).x, 0) << gap;
    }
}

TYPED_TEST(BoundedSteps, go_on_from_a_snapshot_and_from_sleep) {
    WorldSpec spec = this->with(2, 0.3, 0.5);
    spec.contact.sleep.on = true;
    typename TestFixture::World world{Seconds{1, 60}, spec};
    this->add_pit(world);
    Random random{3};
    this->add_thrown(world, random, TestFixture::Bodies::boxes, 4, 1);
    typename TestFixture::World other = world;
    for (int step = 0; step < 600; ++step) {
        if (step % 50 == 25) { ASSERT_EQ(restore(other, save(world)), SnapshotFault::none); }
        (void)world.step();
        (void)other.step();
        ASSERT_TRUE(step < 25 || world.hash() == other.hash()) << "in step " << step;
    }
    for (const BodyId b : this->ids(world)) EXPECT_TRUE(world.asleep(b));
    world.apply_impulse(BodyId{11}, {0, 4, 0});
    for (int step = 0; step < 300; ++step) (void)world.step();
    for (const BodyId b : this->ids(world)) EXPECT_TRUE(world.asleep(b));
}

}  // namespace
}  // namespace tumble::test
