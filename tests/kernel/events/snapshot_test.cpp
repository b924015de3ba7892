// Snapshots as bytes: what is restored goes on with the same bits, and what cannot be restored changes nothing.
#include <tumble/tumble.hpp>

#include "saved_worlds.hpp"

#include <cstring>
#include <string>
#include <vector>

namespace tumble::test {
namespace {

constexpr Features only_saved{.control = true, .snapshots = true};

template <class W>
class Snapshots : public SavedWorlds<W> {
protected:
    template <Features features>
    using WorldOf = typename SavedWorlds<W>::template WorldOf<features>;
    using typename SavedWorlds<W>::Full;

    // Boxes and balls on a floor and on each other, one of them on a spring.
    [[nodiscard]] static Full full(Real mass = 1, Real gravity = -9.81) {
        Full world{Seconds{1, 256},
                   {.gravity = {0, gravity, 0},
                    .linear_drag = 0.01,
                    .contact = {.restitution = 0.25, .friction = 0.4, .sleep = {.on = true}}}};
        (void)world.add(PlaneSpec{});
        const auto add = [&](BodySpec body, RealVec3 position, RealVec3 spin) {
            body.position = position;
            body.angular_velocity = spin;
            (void)world.add(body);
        };
        add(box(2, {1, 0.5, 1}), {0, 0.25, 0}, {});
        add(box(1, {0.5, 0.4, 0.3}), {0.1, 0.8, 0}, {0.5, 1, 0.25});
        add(sphere(mass, 0.25), {2, 1, 0}, {});
        add(box(1, {0.5, 0.4, 0.3}), {2, 2, 0}, {1, 2, 3});
        add(box(1, {0.5, 0.4, 0.3}), {-3, 9, 0}, {3, 0.5, 2});
        SpringSpec tie;
        tie.body = 2;
        tie.to_body = 3;
        tie.stiffness = 20;
        (void)world.add(tie);
        return world;
    }
    [[nodiscard]] static WorldOf<only_saved> small(Real mass = 1) {
        WorldOf<only_saved> world{Seconds{1, 256}};
        BodySpec body = box(mass, {1, 0.5, 0.25});
        body.angular_velocity = {1, 2, 3};
        (void)world.add(body);
        return world;
    }
    template <class World>
    static void run(World& world, int steps) {
        for (int i = 0; i < steps; ++i) {
            if (world.steps_taken() % 64 == 5) world.set_torque(BodyId{0}, {0.01F, 0.5F, 0.0F}, Frame::world);
            if (world.steps_taken() % 64 == 9) world.set_torque(BodyId{0}, {}, Frame::world);
            if (world.steps_taken() % 64 == 12) world.apply_force(BodyId{0}, {0.0F, 3.0F, 0.0F}, Frame::body);
            world.step();
        }
    }
    // The world goes on with the same bits, sleep and status as another.
    template <class World>
    static void expect_same(World& a, World& b, int steps) {
        for (int i = 0; i < steps; ++i) {
            run(a, 1);
            run(b, 1);
            ASSERT_EQ(a.hash(), b.hash()) << i;
            for (int k = 0; k < a.body_count(); ++k) {
                ASSERT_EQ(a.asleep(BodyId{k}), b.asleep(BodyId{k})) << i;
                ASSERT_EQ(a.contact_count(BodyId{k}), b.contact_count(BodyId{k})) << i;
            }
        }
        EXPECT_EQ(a.status().bits, b.status().bits);
        EXPECT_EQ(a.near_pair_count(), b.near_pair_count());
    }
};
TYPED_TEST_SUITE(Snapshots, SavedWays);

TYPED_TEST(Snapshots, a_world_that_is_restored_goes_on_with_the_same_bits) {
    // In flight, in contact, beginning to sleep.
    for (const int steps : {0, 30, 90, 333}) {
        auto world = this->full();
        this->run(world, steps);
        const auto bytes = save(world);
        auto other = this->full();
        this->run(other, 11);
        ASSERT_EQ(restore(other, bytes), SnapshotFault::none);
        EXPECT_EQ(other.hash(), world.hash());
        EXPECT_EQ(save(other), bytes) << "a snapshot of the restored world is the same";
        this->expect_same(world, other, 60);
    }
}

TYPED_TEST(Snapshots, of_a_free_body_in_a_minimal_world_go_on_with_the_same_bits) {
    auto world = this->small(), other = this->small();
    this->run(world, 100);
    const auto bytes = save(world);
    ASSERT_EQ(restore(other, bytes), SnapshotFault::none);
    this->expect_same(world, other, 100);
}

TEST(SnapshotBytes, know_the_last_softening) {
    using N = Q32<NearRange>;
    static constexpr Features soft{.bodies = 2, .gravitation = true, .softening = true, .snapshots = true};
    World<SceneOf<N, integrators::Verlet, soft>> world{Seconds{1, 64}}, other{Seconds{1, 64}};
    world.set_softening(Real{2});
    world.set_softening(Real{0.5});
    const auto bytes = save(world);
    EXPECT_EQ(restore(other, bytes), SnapshotFault::other_scene);
    other.set_softening(Real{0.5});
    EXPECT_EQ(restore(other, bytes), SnapshotFault::none);

    const World<SceneOf<N, integrators::Verlet, soft>> falling{Seconds{1, 64}, {.gravity = {0, -1, 0}}};
    EXPECT_EQ(restore(other, save(falling)), SnapshotFault::other_scene) << "no event changes it";

    static constexpr Features hard{.bodies = 2, .gravitation = true, .snapshots = true};
    World<SceneOf<N, integrators::Verlet, hard>> without{Seconds{1, 64}};
    World<SceneOf<N, integrators::Verlet, soft>> never_set{Seconds{1, 64}};
    EXPECT_EQ(restore(never_set, save(without, SnapshotPart::bodies)), SnapshotFault::none);
}

TYPED_TEST(Snapshots, of_bodies_alone_take_the_change_of_a_surface_back) {
    typename TestFixture::Full world = this->full();
    BodySpec lift = box(1, {2, 0.5, 2});
    lift.position = {-4, 1, 0};
    lift.kinematic = true;
    world.remove(BodyId{4});
    const BodyId id = world.add(lift);
    for (int i = 0; i < 16; ++i) world.step();
    const auto bytes = save(world, SnapshotPart::bodies);
    auto other = world;
    other.set_velocity(id, {0.5F, 1.0F, 0.0F});
    for (auto* each : {&world, &other}) ASSERT_EQ(restore(*each, bytes), SnapshotFault::none);
    EXPECT_EQ(save(other), save(world));
}

// The same angular velocity as momentum and as velocity, also where it is held in parts of the step.
TYPED_TEST(Snapshots, of_bodies_alone_convert_the_spin_between_methods) {
    using N = typename TestFixture::N;
    using Own = typename TypeParam::Integrator;
    using Method = std::conditional_t<Own::spin == Spin::angular_momentum, integrators::Rk4, integrators::Verlet>;
    for (const int steps_per_second : {256, 16}) {
        const auto fill = [&](auto& world) {
            BodySpec body = box(2, {1, 0.5, 0.25});
            body.orientation = {1., {0.5, 0.25, -0.5}};
            body.velocity = {1, 2, 3};
            body.angular_velocity = steps_per_second == 16 ? RealVec3{5, -3, 7} : RealVec3{1, 2, 3};
            (void)world.add(body);
        };
        typename TestFixture::template WorldOf<only_saved> world{Seconds{1, steps_per_second}},
            back{Seconds{1, steps_per_second}};
        World<SceneOf<N, Method, only_saved>> other{Seconds{1, steps_per_second}};
        fill(world);
        fill(back);
        fill(other);
        for (int i = 0; i < 3; ++i) world.step();
        for (int i = 0; i < 9; ++i) other.step();
        ASSERT_EQ(restore(other, save(world, SnapshotPart::bodies)), SnapshotFault::none);
        ASSERT_EQ(restore(back, save(other, SnapshotPart::bodies)), SnapshotFault::none);
        const BodyId id{0};
        EXPECT_EQ(other.position(id), world.position(id));
        EXPECT_EQ(other.velocity(id), world.velocity(id));
        const double resolution =
            N::fixed_point || sizeof(typename N::Work) == 4 ? 1e-6 : 1e-14;  // of spins below 10 rad/s
        const auto expect_near = [&](auto a, auto b) {
            EXPECT_NEAR(static_cast<double>(a), static_cast<double>(b), 50 * resolution);
        };
        for (int i = 0; i < 3; ++i) {
            expect_near(other.angular_velocity(id)[i], world.angular_velocity(id)[i]);
            expect_near(back.angular_velocity(id)[i], world.angular_velocity(id)[i]);
        }
        expect_near(other.kinetic_energy(id), world.kinetic_energy(id));
        EXPECT_TRUE(other.status().ok());
    }
}

struct StepOfTheType : SceneOf<Q32<NearRange>, integrators::Rk4, only_saved> {
    static constexpr Seconds step{1, 256};
};
TEST(SnapshotBytes, do_not_depend_on_where_the_step_stands) {
    World<StepOfTheType> constant;
    World<SceneOf<Q32<NearRange>, integrators::Rk4, only_saved>> member{Seconds{1, 256}};
    BodySpec body = box(1, {1, 0.5, 0.25});
    body.angular_velocity = {1, 2, 3};
    (void)constant.add(body);
    (void)member.add(body);
    const auto expect_exchange = [](const auto& from, auto to, SnapshotPart part) {
        const auto bytes = save(from, part);
        ASSERT_EQ(restore(to, bytes), SnapshotFault::none);
        EXPECT_EQ(to.hash(), from.hash());
        EXPECT_TRUE(to.status().ok());
        EXPECT_EQ(to.snapshot_size(part), static_cast<int>(bytes.size()));
    };
    for (int i = 0; i < 20; ++i) constant.step();
    for (const SnapshotPart part : {SnapshotPart::bodies, SnapshotPart::world}) {
        expect_exchange(constant, member, part);
        expect_exchange(member, constant, part);
    }
}

template <class N, bool rotates>
using OfPoints = World<SceneOf<N, integrators::Verlet,
                               Features{.bodies = 2, .rotation = rotates, .point_masses = true, .snapshots = true}>>;
TEST(SnapshotBytes, of_point_masses_do_not_depend_on_what_else_may_rotate) {
    const auto exchange = [](auto from, auto to) {
        for (auto add : {&from}) {
            BodySpec stone = point_mass(1);
            stone.velocity = {1, 2, 3};
            (void)add->add(stone);
            (void)to.add(stone);
        }
        for (int i = 0; i < 20; ++i) from.step();
        ASSERT_EQ(restore(to, save(from, SnapshotPart::bodies)), SnapshotFault::none);
        EXPECT_EQ(to.hash(), from.hash());
    };
    const Seconds step{1, 256};
    exchange(OfPoints<Q32<NearRange>, true>{step}, OfPoints<Q32<NearRange>, false>{step});
    exchange(OfPoints<Q32<NearRange>, false>{step}, OfPoints<Q32<NearRange>, true>{step});
    exchange(OfPoints<F64, true>{step}, OfPoints<F64, false>{step});
}

template <int numbers>
struct Pull {
    float value[numbers]{};

    [[nodiscard]] bool acts_on(const auto&, int) const { return value[0] > 0; }
    void apply_to(const auto&) const {}
    static void each(auto& load, auto& archive) { archive(load.value); }
};
template <int numbers>
struct Pulled : SceneOf<F64, integrators::Verlet, only_saved> {
    using Loads = LoadList<Pull<numbers>>;
};
TEST(SnapshotBytes, of_a_world_with_another_own_load_are_refused) {
    World<Pulled<1>> one{Seconds{1, 64}};
    World<Pulled<3>> three{Seconds{1, 64}};
    (void)one.add(sphere(1, 1));
    (void)three.add(sphere(1, 1));
    const auto bytes = save(one);
    EXPECT_EQ(restore(three, bytes), SnapshotFault::other_scene);
    EXPECT_EQ(restore(one, bytes), SnapshotFault::none);
}

// The kick that ends a step is solved, and begins the next one.
TYPED_TEST(Snapshots, of_a_damped_body_go_on_with_the_same_bits) {
    static constexpr Features hung{.springs = 1, .control = true, .snapshots = true};
    const auto make = [] {
        typename TestFixture::template WorldOf<hung> world{Seconds{1, 256}, {.gravity = {0, -9.81, 0}}};
        BodySpec body = box(2, {1, 0.5, 0.25});
        body.position = {0.25, -1, 0.125};
        body.velocity = {1, 0, 0.5};
        (void)world.add(body);
        (void)world.add(SpringSpec{.body = 0, .stiffness = 300, .damping = 4, .rest_length = 1});
        return world;
    };
    for (const int steps : {8, 11, 12, 13, 100}) {  // with wrenches, and after them
        auto world = make(), other = make();
        this->run(world, steps);
        this->run(other, 33);
        ASSERT_EQ(restore(other, save(world)), SnapshotFault::none);
        for (int i = 0; i < 40; ++i) {
            this->run(world, 1);
            this->run(other, 1);
            ASSERT_EQ(world.hash(), other.hash()) << steps << " " << i;
        }
    }
}

TYPED_TEST(Snapshots, of_bodies_alone_restore_the_hash_in_worlds_with_other_features) {
    auto world = this->small();
    this->run(world, 100);
    const auto bytes = save(world, SnapshotPart::bodies);
    EXPECT_LT(bytes.size(), save(world).size());
    using Other =
        typename TestFixture::template WorldOf<Features{.bodies = 3, .drag = true, .snapshots = true, .imu = true}>;
    Other other{Seconds{1, 256}};
    (void)other.add(box(1, {1, 0.5, 0.25}));
    ASSERT_EQ(restore(other, bytes), SnapshotFault::none);
    EXPECT_EQ(other.hash(), world.hash());
    EXPECT_EQ(other.steps_taken(), world.steps_taken());
}

TYPED_TEST(Snapshots, of_bodies_alone_wake_all_and_find_contacts_anew) {
    using Resting = typename TestFixture::template WorldOf<Features{
        .planes = 1, .snapshots = true, .boxes = true, .friction = true, .sleep = true}>;
    Resting world{Seconds{1, 256}, {.gravity = {0, -9.81, 0}, .contact = {.friction = 0.5, .sleep = {.on = true}}}};
    BodySpec body = box(1, {0.5, 0.25, 0.5});
    body.position = {0, 0.3, 0};
    const BodyId id = world.add(body);
    (void)world.add(PlaneSpec{});
    const auto in_flight = save(world, SnapshotPart::bodies);
    const auto rest = [&] {
        for (int i = 0; i < 512; ++i) world.step();
        EXPECT_TRUE(world.asleep(id));
        EXPECT_NEAR(static_cast<double>(world.position(id).y), 0.125, 2e-3);
    };
    rest();
    ASSERT_EQ(restore(world, in_flight), SnapshotFault::none);
    EXPECT_FALSE(world.asleep(id));
    rest();
}

TYPED_TEST(Snapshots, that_are_wrong_are_refused_and_change_nothing) {
    auto world = this->full();
    this->run(world, 60);
    const auto own = save(world);
    for (const SnapshotPart part : {SnapshotPart::bodies, SnapshotPart::world}) {
        auto source = this->full();
        this->run(source, 50);
        const auto bytes = save(source, part);
        const auto refused = [&](const SavedBytes& wrong, SnapshotFault fault) {
            EXPECT_EQ(name_of(restore(world, wrong)), std::string(name_of(fault)));
            ASSERT_EQ(save(world), own);
        };
        // A bit of each of the first bytes, and of some of the others.
        for (std::size_t i = 0; i < bytes.size(); i += i < 48 ? 1 : 61) {
            auto wrong = bytes;
            wrong[i] = static_cast<std::uint8_t>(wrong[i] ^ 1u << i % 8);
            EXPECT_NE(restore(world, wrong), SnapshotFault::none) << i;
        }
        ASSERT_EQ(save(world), own);
        for (std::size_t count = 0; count < bytes.size(); ++count)
            EXPECT_EQ(world.restore(bytes.data(), static_cast<int>(count)), SnapshotFault::truncated) << count;
        ASSERT_EQ(save(world), own);
        refused(SavedBytes(64, 0), SnapshotFault::no_snapshot);
        auto wrong = bytes;
        wrong[4] = 2;
        refused(wrong, SnapshotFault::other_version);
        refused(save(this->full(3), part), SnapshotFault::other_scene);
        // A kind that is tested, so that there is one world less to compile.
        using Others = std::conditional_t<std::is_same_v<typename TestFixture::N, F64>,
                                          Kind<Q32<NearRange>, integrators::Verlet>, Kind<F64, integrators::Exact>>;
        World<SceneOf<typename Others::Numbers, typename Others::Integrator, little_of_everything>> others{
            Seconds{1, 256}};
        refused(save(others, part), SnapshotFault::other_numbers);
        auto longer = bytes;
        longer.push_back(1);
        auto copy = world;
        EXPECT_EQ(restore(copy, longer), SnapshotFault::none) << "what follows it is not read";
    }
}

TYPED_TEST(Snapshots, of_a_whole_world_have_its_gravity_and_those_of_its_bodies_do_not) {
    auto world = this->full(), other = this->full(1, -1.5), falling = this->full(1, -1.5);
    this->run(world, 90);
    world.set_gravity({0.5F, -9.5F, -0.25F});
    const auto bodies = save(world, SnapshotPart::bodies);
    ASSERT_EQ(restore(other, save(world)), SnapshotFault::none);
    this->expect_same(world, other, 60);

    ASSERT_EQ(restore(falling, bodies), SnapshotFault::none);
    const BodyId high{4};
    const auto before = static_cast<double>(falling.velocity(high).y);
    falling.step();
    EXPECT_NEAR((static_cast<double>(falling.velocity(high).y) - before) * 256, -1.5, 0.2) << "and little drag";
}

TYPED_TEST(Snapshots, need_their_room) {
    const auto world = this->small();
    SavedBytes bytes(static_cast<std::size_t>(world.snapshot_size()), 0xab);
    EXPECT_EQ(world.save(bytes.data(), static_cast<int>(bytes.size()) - 1), 0);
    EXPECT_EQ(bytes, SavedBytes(bytes.size(), 0xab)) << "nothing is written";
    EXPECT_GT(world.save(bytes.data(), static_cast<int>(bytes.size())), 0);
}

TEST(SnapshotBytes, have_the_check_word_of_the_standard_and_the_lowest_byte_first) {
    tumble::detail::Crc32 crc;
    for (const char c : std::string("123456789")) crc.add(static_cast<std::uint8_t>(c));
    EXPECT_EQ(crc.value(), 0xcbf43926u);
    tumble::detail::Crc32 words;
    words.add_word(0x34333231u);
    words.add_word(0x38373635u);
    words.add('9');
    EXPECT_EQ(words.value(), 0xcbf43926u);
    World<SceneOf<F64, integrators::Verlet, only_saved>> world{Seconds{1, 256}};
    BodySpec body = sphere(1, 1);
    body.position = {1, 0, 0};
    (void)world.add(body);
    world.step();
    const auto bytes = save(world, SnapshotPart::bodies);
    ASSERT_EQ(bytes.size(), 8u * 4 + 4 + 13 * 8 + 4);
    EXPECT_EQ(std::memcmp(bytes.data(), "tmbl\6\0\0\1", 8), 0);
    EXPECT_EQ(bytes[8], TUMBLE_BITS);
    EXPECT_EQ(bytes[32], 1) << "steps";
    const std::uint8_t one[8] = {0, 0, 0, 0, 0, 0, 0xf0, 0x3f};
    EXPECT_EQ(std::memcmp(bytes.data() + 36, one, 8), 0) << "x";
}

TEST(SnapshotBytes, of_a_world_let_its_script_go_on) {
    World<SceneOf<F64, integrators::Verlet,
                  Features{.forces = true, .impulses = true, .control = true, .script = true, .snapshots = true}>>
        world{Seconds{1, 256}};
    (void)world.add(sphere(1, 1));
    std::vector<EventSpec> specs;
    for (int i = 0; i < 4; ++i) specs.push_back({.time = Real{i} * Real{0.125}, .value = {1, 0, 0}});
    for (const auto& [kind, time, value] : {std::tuple{EventKind::begin_force, 0.1, RealVec3{0, 1, 0}},
                                            {EventKind::end_force, 0.3, {0, 1, 0}},
                                            {EventKind::begin_force, 0.2, {0, 0.5, 1}},
                                            {EventKind::force, 10.0 / 256, {0, 0, 1}},
                                            {EventKind::force, 50.0 / 256, {0, 0, 2}}})
        specs.push_back({.time = time, .kind = kind, .value = value, .point = {0.25, 0, 0}});
    specs.push_back({.time = 0.25, .kind = EventKind::begin_torque, .value = {0.5, 0, 1}});
    std::vector<Event<F64>> events;
    world.set_script(prepare_sorted(events, specs, world.bodies()));
    std::vector<SavedBytes> saved;
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < 128; ++i) {
        saved.push_back(save(world));
        world.step();
        hashes.push_back(world.hash());
    }
    for (const int from : {0, 5, 10, 26, 33, 50, 90}) {
        ASSERT_EQ(restore(world, saved[static_cast<std::size_t>(from)]), SnapshotFault::none);
        for (std::size_t i = static_cast<std::size_t>(from); i < 128; ++i) {
            world.step();
            ASSERT_EQ(world.hash(), hashes[i]) << from << " " << i;
        }
    }
}

}  // namespace
}  // namespace tumble::test
