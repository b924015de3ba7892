// What a program reads of contacts: impulses that account for every change of momentum, Coulomb's law, and what began,
// ended or hit.
#include <tumble/tumble.hpp>

#include "contact_cases.hpp"
#include "kinds.hpp"
#include "snapshots.hpp"

#include <initializer_list>
#include <optional>
#include <vector>

namespace tumble::test {
namespace {

class ContactReadouts : public CaseTest {
protected:
    // Of an impulse in N s: what rounding leaves of a momentum of about 10 N s. Statics leave 2^-18 of a load.
    static Number rounding() { return system().bits == 64 ? 1e-12L : 1e-5L; }
};
INSTANTIATE_TEST_SUITE_P(every, ContactReadouts, testing::ValuesIn(contact_cases()), NameOf{});

Number weight_in_step(Number mass) { return mass * g / second; }

TEST_P(ContactReadouts, a_box_on_an_incline_reads_its_weight_its_friction_and_its_centre_of_pressure) {
    for (const Number slope : {0.0L, 0.25L, -0.4L}) {
        for (const bool sleeps : {false, true}) {
            SceneSetup setup = sleepy_floor(0.6L, {placed(box(2, {0.5, 0.25, 1}), {0, 0.125, 0})});
            setup.world.contact.sleep.on = sleeps;
            setup.world.gravity = real(Vector{g * std::sin(slope), -g * std::cos(slope), 0});
            const auto world = run(setup, second);
            ASSERT_EQ(world->asleep(0), sleeps);
            const auto contacts = world->contacts(0);
            ASSERT_EQ(contacts.size(), 1u);
            const ReadContact& c = contacts[0];
            EXPECT_EQ(c.plane, 0);
            EXPECT_EQ(c.body, -1);
            EXPECT_TRUE(c.touches && !c.began && !c.ended && !c.hit);
            EXPECT_EQ(c.points.size(), 4u);
            EXPECT_LE(norm(c.normal - Vector{0, 1, 0}), 1e-9L);
            const Number weight = weight_in_step(2), allowed = 1e-6L * weight;
            EXPECT_LE(std::abs(c.normal_impulse - weight * std::cos(slope)), allowed);
            EXPECT_LE(norm(c.friction_impulse + Vector{weight * std::sin(slope), 0, 0}), allowed);
            // Weight and friction make no moment about it.
            EXPECT_LE(norm(c.point - Vector{0.125L * std::tan(slope), 0, 0}), 1e-6L);
        }
    }
}

TEST_P(ContactReadouts, a_bounce_reads_its_impulse_and_the_speed_of_its_approach_even_where_the_ball_is_away_again) {
    for (const Number restitution : {0.0L, 0.5L, 1.0L}) {
        SceneSetup setup = space(restitution, 0, {placed(sphere(3, 0.125), {0, 0.5L, 0}, {0, -20, 0})});
        setup.planes = {{}};
        const auto world = build(setup, GetParam());
        std::vector<ReadContact> hits;
        for (int step = 0; step < 16; ++step) {
            world->step();
            for (const ReadContact& c : world->contacts(0))
                if (c.hit) hits.push_back(c);
        }
        ASSERT_EQ(hits.size(), 1u);
        EXPECT_EQ(hits[0].touches, restitution == 0);
        EXPECT_LE(std::abs(hits[0].hit_speed - 20), 1e-4L);
        EXPECT_LE(norm(hits[0].impulse - Vector{0, 3 * 20 * (1 + restitution), 0}), 1e-4L);
        EXPECT_LE(norm(hits[0].point), 1e-4L);
    }
}

TEST_P(ContactReadouts, a_coin_that_rattles_reads_points_within_the_tolerance) {
    for (const Number spin : {2.0L, -5.0L}) {
        BodySpec coin = placed(cylinder(0.5, 0.25, 0.03125), {0, 0.0625L, 0}, {}, {spin, 1, 0});
        coin.orientation = real(reference::exponential(Vector{-1.45L, 0, 0}));
        SceneSetup setup = floor(0.25L, 0.5L, {coin});
        const auto world = build(setup, GetParam());
        const Number tolerance = number(setup.world.contact.tolerance), allowed = tolerance * 1.001L;
        int read = 0;
        for (int step = 0; step < second; ++step) {
            world->step();
            for (const ReadContact& c : world->contacts(0)) {
                EXPECT_EQ(c.touches, !c.points.empty());
                for (const Vector& point : c.points) {
                    ++read;
                    // Halfway between the two surfaces.
                    EXPECT_LE(2 * point.y, allowed) << "step " << step;
                }
            }
        }
        EXPECT_GT(read, 100);
    }
}

// The pair leaves the list before the step is solved.
TEST_P(ContactReadouts, a_body_that_is_thrown_off_reads_no_impulse) {
    for (const bool sleeps : {false, true}) {
        for (const Number speed : {0.5L, 5.0L}) {
            SceneSetup setup = sleepy_floor(0.5L, {placed(sphere(2, 0.125), {0, 0.125L, 0})});
            setup.world.contact.sleep.on = sleeps;
            const auto world = run(setup, second);
            ASSERT_EQ(world->asleep(0), sleeps);
            world->apply_impulse(0, {0, 2 * speed, 0});
            world->step();
            for (const ReadContact& c : world->contacts(0)) {
                EXPECT_TRUE(c.ended && !c.hit);
                EXPECT_EQ(norm(c.impulse), 0);
            }
            world->step();
            EXPECT_TRUE(world->contacts(0).empty());
        }
    }
}

// The arm of a ball does not turn with it.
TEST_P(ContactReadouts, the_centre_of_pressure_of_a_rolling_ball_is_on_the_floor_below_it) {
    SceneSetup setup = floor(0, 0.5L, {placed(sphere(2, 0.125), {0, 0.125L, 0}, {4, 0, 0}, {0, 7, -32})});
    const auto world = build(setup, GetParam());
    for (int step = 0; step < 16; ++step) {
        const Vector before = world->motion(0).x;
        world->step();
        const auto contacts = world->contacts(0);
        ASSERT_EQ(contacts.size(), 1u);
        EXPECT_LE(norm(contacts[0].point - Vector{before.x, 0, before.z}), 1e-5L);
    }
}

// A ball that flies to and fro between two walls several times in a step leaves each out of its reach again.
TEST_P(ContactReadouts, no_impact_of_a_step_is_lost) {
    SceneSetup setup = space(1, 0, {placed(sphere(2, 0.125), {0, 0, 0}, {30, 0, 0})});
    const Number room = 0.02L;  // m, on either side
    setup.planes = {{.normal = {1, 0, 0}, .offset = real(0.125L + room)},
                    {.normal = {-1, 0, 0}, .offset = real(0.125L + room)}};
    const auto world = build(setup, GetParam());
    Vector before{60, 0, 0};
    for (int step = 0; step < 64; ++step) {
        world->step();
        Vector sum{};
        for (const ReadContact& c : world->contacts(0)) {
            EXPECT_TRUE(c.hit);
            EXPECT_LE(std::abs(c.hit_speed - 30), 1e-4L);
            sum = sum + c.impulse;
        }
        const Vector now = world->motion(0).v * 2;
        EXPECT_LE(norm(now - before - sum), 1e-4L);
        before = now;
    }
    EXPECT_TRUE(world->status().ok());
}

// Boxes and balls that fall into a pit.
SceneSetup heap(Random& random, Number restitution, Number friction) {
    SceneSetup setup = floor(restitution, friction);
    setup.step = Seconds{1, 128};
    setup.world.contact.sleep.on = true;
    for (const Vector normal : {Vector{1, 0, 0}, Vector{-1, 0, 0}, Vector{0, 0, 1}, Vector{0, 0, -1}})
        setup.planes.push_back({.normal = real(normal), .offset = 0.9});
    for (int b = 0; b < 7; ++b) {
        const Real mass = random.uniform(0.5, 3);
        const auto edge = [&] { return Real{random.uniform(0.2, 0.5)}; };
        BodySpec body = b % 3 == 2 ? sphere(mass, random.uniform(0.1, 0.25)) : box(mass, {edge(), edge(), edge()});
        const Vector place{random.uniform(-0.4, 0.4), 0.5L + 0.6L * b, random.uniform(-0.4, 0.4)};
        setup.bodies.push_back(placed(body, place, direction(random) * 2, direction(random) * 6));
    }
    return setup;
}

TEST_P(ContactReadouts, impulses_of_a_heap_account_for_every_change_of_momentum_and_obey_coulombs_law) {
    Random random{28};
    int began = 0, ended = 0, touching = 0;
    for (const Number restitution : {0.0L, 0.6L}) {
        for (const Number friction : {0.0L, 0.4L}) {
            const SceneSetup setup = heap(random, restitution, friction);
            const auto world = build(setup, GetParam());
            const int count = static_cast<int>(setup.bodies.size());
            std::vector<Vector> before(setup.bodies.size());
            std::vector<bool> slept(setup.bodies.size());
            for (int step = 0; step < 200; ++step) {
                for (int b = 0; b < count; ++b) {
                    before[static_cast<std::size_t>(b)] = world->motion(b).v;
                    slept[static_cast<std::size_t>(b)] = world->asleep(b);
                }
                const bool ok = world->step().ok();
                world->clear_status();
                for (int b = 0; b < count; ++b) {
                    Vector sum{};
                    Number pressed = 0;
                    for (const ReadContact& c : world->contacts(b)) {
                        began += c.began ? 1 : 0;
                        ended += c.ended ? 1 : 0;
                        sum = sum + c.impulse;
                        pressed += c.normal_impulse;
                        EXPECT_EQ(c.touches, !c.points.empty());
                        EXPECT_GE(c.normal_impulse, 0);
                        EXPECT_LE(norm(c.friction_impulse), 1.01L * friction * c.normal_impulse + 4 * rounding());
                        if (c.body < 0) continue;
                        for (const ReadContact& other : world->contacts(c.body)) {
                            const bool is_same = other.body == b;
                            EXPECT_TRUE(!is_same || norm(c.impulse + other.impulse) < rounding());
                        }
                    }
                    if (!ok) continue;  // a part of the step may be lost
                    const Number mass = number(setup.bodies[static_cast<std::size_t>(b)].mass);
                    const Vector change = (world->motion(b).v - before[static_cast<std::size_t>(b)]) * mass,
                                 fall = Vector{0, -g * mass / 128, 0};
                    // A body that stands or sleeps is stopped, where sweeps leave it a little; one that falls asleep,
                    // as a ball that rolls slowly, at up to the speed of sleep.
                    const bool falls_asleep = world->asleep(b) && !slept[static_cast<std::size_t>(b)];
                    const Number stopped = falls_asleep ? number(setup.world.contact.sleep.speed) * mass : 0;
                    EXPECT_LE(norm(change - sum - fall), 16 * rounding() + 1e-3L * pressed + stopped)
                        << "step " << step;
                }
            }
            for (int b = 0; b < count; ++b)
                for (const ReadContact& c : world->contacts(b)) touching += c.touches ? 1 : 0;
        }
    }
    EXPECT_EQ(began - ended, touching);
    EXPECT_GT(ended, 100);
}

// The readings of a world, for comparison.
template <class World>
std::vector<double> readings(const World& world, std::initializer_list<BodyId> bodies) {
    std::vector<double> all;
    for (const BodyId id : bodies)
        for (const auto& c : world.contacts(id)) {
            for (const int i :
                 {c.body.index(), c.plane.index(), int{c.touches}, int{c.began}, int{c.ended}, int{c.hit}})
                all.push_back(i);
            for (int i = 0; i < 3; ++i)
                for (const auto x : {c.impulse[i], c.friction_impulse[i], c.normal[i], c.point[i]})
                    all.push_back(static_cast<double>(x));
            for (const auto x : {c.depth, c.normal_impulse, c.hit_speed}) all.push_back(static_cast<double>(x));
        }
    return all;
}

template <class K>
class ContactReadoutsOfKind : public testing::Test {
protected:
    static constexpr Features features = [] {
        Features all = touching(4, 1);
        all.contact_readout = true;
        return all;
    }();
    using Scene = World<SceneOf<typename K::Numbers, typename K::Integrator, features>>;

    // Three boxes on each other.
    struct Tower {
        Scene world{Seconds{1, 64}, {.gravity = {0, -8, 0}, .contact = {.friction = 0.5}}};
        BodyId body[3];
        Tower() {
            for (int i = 0; i < 3; ++i) {
                BodySpec spec = box(1, {1, 0.5, 1});
                spec.position = {0, Real{0.25} + Real{0.5} * Real{i}, 0};
                body[i] = world.add(spec);
            }
            (void)world.add(PlaneSpec{});
            for (int i = 0; i < 8; ++i) world.step();
        }
        // Of the contact of one box with another, or with the plane. None: it is not read.
        [[nodiscard]] std::optional<double> load(int b, int partner) const {
            for (const auto& c : world.contacts(body[b]))
                if (partner < 0 ? static_cast<bool>(c.plane) : c.body == body[partner])
                    return static_cast<double>(c.normal_impulse) * 64 / 8;
            return {};
        }
    };
};
using ReadKinds = Tested<testing::Types<Kind<Q32<NearRange>, integrators::Verlet>>,
                         testing::Types<Kind<F64, integrators::Rk4>, Kind<F32Plain, integrators::Verlet>>>;
TYPED_TEST_SUITE(ContactReadoutsOfKind, ReadKinds);

TYPED_TEST(ContactReadoutsOfKind, a_tower_reads_what_stands_on_each_box) {
    typename TestFixture::Tower tower;
    EXPECT_NEAR(tower.load(0, -1).value_or(0), 3, 1e-6);
    EXPECT_NEAR(tower.load(0, 1).value_or(0), 2, 1e-6);
    EXPECT_NEAR(tower.load(2, 1).value_or(0), 1, 1e-6);
    EXPECT_FALSE(tower.load(2, 0));
}

TYPED_TEST(ContactReadoutsOfKind, a_body_that_is_removed_takes_its_contacts_along_and_the_next_has_its_own_id) {
    typename TestFixture::Tower tower;
    tower.world.remove(tower.body[2]);
    EXPECT_FALSE(tower.load(1, 2));
    tower.world.step();
    EXPECT_NEAR(tower.load(0, -1).value_or(0), 2, 1e-6);
    BodySpec spec = sphere(2, 0.25);
    spec.position = {0, 1.25, 0};
    tower.body[2] = tower.world.add(spec);
    tower.world.step();
    EXPECT_NEAR(tower.load(1, 2).value_or(0), 2, 1e-6);
    for (const auto& c : tower.world.contacts(tower.body[2])) EXPECT_TRUE(c.began);
}

TYPED_TEST(ContactReadoutsOfKind, a_body_that_is_set_elsewhere_ends_its_contacts_in_the_next_step) {
    typename TestFixture::Tower tower;
    tower.world.set_pose(tower.body[2], {Real{5}, Real{5}, Real{0}});
    EXPECT_EQ(tower.load(2, 1).value_or(1), 0);
    tower.world.step();
    int ended = 0;
    for (const auto& c : tower.world.contacts(tower.body[1])) ended += c.ended ? 1 : 0;
    EXPECT_EQ(ended, 1);
    tower.world.step();
    EXPECT_FALSE(tower.load(2, 1));
}

TYPED_TEST(ContactReadoutsOfKind, bodies_that_are_restored_have_no_contacts_before_the_next_step) {
    typename TestFixture::Tower tower;
    const auto bytes = save(tower.world, SnapshotPart::bodies);
    tower.world.step();
    ASSERT_EQ(restore(tower.world, bytes), SnapshotFault::none);
    EXPECT_FALSE(tower.load(0, -1));
    tower.world.step();
    EXPECT_NEAR(tower.load(0, -1).value_or(0), 3, 1e-6);
}

TYPED_TEST(ContactReadoutsOfKind, a_restored_world_reads_the_same) {
    typename TestFixture::Tower tower, other;
    tower.world.apply_impulse(tower.body[2], {Real{2}, Real{1}, Real{0.5}});
    for (int step = 0; step < 60; ++step) {
        ASSERT_EQ(restore(other.world, save(tower.world)), SnapshotFault::none);
        const auto read = [](const auto& t) { return readings(t.world, {t.body[0], t.body[1], t.body[2]}); };
        EXPECT_EQ(read(tower), read(other));
        tower.world.step();
        other.world.step();
        EXPECT_EQ(read(tower), read(other));
    }
}

}  // namespace
}  // namespace tumble::test
