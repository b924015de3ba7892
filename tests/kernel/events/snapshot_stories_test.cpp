// Snapshots of worlds to which a random story of calls happens: what is restored goes on with the same bits, and what
// is forged stays within the room of the world.
#include <tumble/tumble.hpp>

#include "saved_worlds.hpp"

#include <cstring>
#include <random>

namespace tumble::test {
namespace {

template <class W>
class SnapshotStories : public SavedWorlds<W> {};
TYPED_TEST_SUITE(SnapshotStories, SavedWays);

// The words that follow from a seed.
struct Words {
    std::mt19937 engine;

    explicit Words(unsigned seed) : engine{seed} {}
    std::uint32_t operator()() { return static_cast<std::uint32_t>(engine()); }
};

// Blocks that stand on each other, on a floor and on a kinematic table, and what happens to them: impulses, velocities,
// poses, forces and removals, at steps that the seed chooses.
template <class World>
class Story {
public:
    explicit Story(unsigned seed) : seed_{seed} {}

    [[nodiscard]] World begin() const {
        Words random{seed_};
        const auto between = [&](double low, double high) { return low + (high - low) * (random() * 0x1p-32); };
        WorldSpec spec{.gravity = {0, -9.81, 0},
                       .contact = {.restitution = random() % 2 * 0.25,
                                   .friction = 0.5,
                                   .sleep = {.on = random() % 3 != 0},
                                   .exact_bodies = seed_ % 3 == 0 ? 0 : ContactSpec::any}};
        if (random() % 3 == 0) spec.linear_drag = 0.02;
        World world{Seconds{1, random() % 4 == 0 ? 256 : 60}, spec};
        (void)world.add(PlaneSpec{});
        const bool alike = seed_ % 2 == 0;
        for (int k = 0; k < 3; ++k) {
            BodySpec body = box(1, {0.3, 0.3, 0.3});
            if (!alike) body = box(between(0.3, 3), {between(0.2, 0.5), 0.3, between(0.2, 0.5)});
            if (!alike && random() % 5 == 0) body = sphere(between(0.3, 2), 0.15);
            body.position = {between(-0.1, 0.1), 0.15 + 0.35 * k, between(-0.1, 0.1)};
            if (k == 2 || (!alike && random() % 2 == 0))
                body.orientation = {1., {between(-0.3, 0.3), 0, between(-0.2, 0.2)}};
            (void)world.add(body);
        }
        BodySpec table = box(1, {1, 0.2, 1});
        table.position = {-2, 0.5, 0};
        table.kinematic = random() % 2 == 0;
        table.fixed = !table.kinematic;
        if (table.kinematic) table.velocity = {between(-0.1, 0.1), 0, 0};
        (void)world.add(table);
        BodySpec cup = box(1, {0.3, 0.3, 0.3});
        cup.position = {-2, 0.76, 0};
        (void)world.add(cup);
        SpringSpec tie{
            .body = 0, .to_body = random() % 2 == 0 ? 1 : 3, .stiffness = between(1, 30), .rest_length = 0.5};
        if (random() % 2 == 0) (void)world.add(tie);
        return world;
    }
    // What happens before a step of a world; `removals`: nothing else.
    void act(World& world, int step, bool removals = false) const {
        Words random{seed_ * 7919u + static_cast<unsigned>(step) * 104729u};
        if (random() % 40 != 0) return;
        const BodyId id{static_cast<int>(random() % 5)};
        if (!world.contains(id)) return;
        const auto between = [&](double low, double high) {
            return static_cast<float>(low + (high - low) * (random() * 0x1p-32));
        };
        const float x = between(-1, 1), y = between(-0.2, 1.5), z = between(-1, 1);
        const unsigned what = random() % 12;
        if (what == 0 && random() % 4 == 0) world.remove(id);
        if (what == 0 || removals) return;
        if (what < 4) world.apply_impulse(id, {x, y, z});
        else if (what == 4) world.set_velocity(id, {0.3F * x, 0.0F, 0.3F * z});
        else if (what == 5) world.set_force(id, {x, y, z}, Frame::world);
        else if (what == 6) world.set_force(id, {}, Frame::world);
        else if (what == 7) world.apply_torque(id, {x, y, z}, Frame::body);
        else if (what == 8) world.set_angular_velocity(id, {x, y, z});
        else if (what == 9) world.set_pose(id, {x, 1 + y, z});
        else if (world.contains(BodyId{3})) world.set_velocity(BodyId{3}, {what == 10 ? 0.2F * x : 0.0F, 0.0F, 0.0F});
    }

private:
    unsigned seed_;
};

TYPED_TEST(SnapshotStories, of_a_random_story_go_on_with_the_same_bits_sleep_and_readouts) {
    using World = typename TestFixture::Full;
#ifdef TUMBLE_EVERY_KIND
    constexpr unsigned stories = 100;
    constexpr int steps = 1000;
#else
    constexpr unsigned stories = 8;
    constexpr int steps = 100;
#endif
    for (unsigned seed = 1; seed <= stories; ++seed) {
        const Story<World> story{seed};
        World world = story.begin(), fresh = world, other = world;
        const int saved_at = static_cast<int>(Words{seed * 31}() % 400);
        for (int i = 0; i < saved_at; ++i) {
            story.act(world, i);
            story.act(fresh, i, true);
            story.act(other, i, true);
            world.step();
            other.step();
        }
        const auto bytes = save(world);
        for (World* restored : {&fresh, &other}) {
            ASSERT_EQ(restore(*restored, bytes), SnapshotFault::none) << seed;
            ASSERT_EQ(save(*restored), bytes) << seed;
        }
        for (int i = saved_at; i < saved_at + steps; ++i) {
            for (World* one : {&world, &fresh, &other}) {
                story.act(*one, i);
                if (i == saved_at + 10 && one->contains(BodyId{2})) one->apply_impulse(BodyId{2}, {1.0F, 0.5F, 0.0F});
                one->step();
            }
            for (const World* restored : {&fresh, &other}) {
                ASSERT_EQ(restored->hash(), world.hash())
                    << seed << ": " << i - saved_at << " steps after " << saved_at;
                for (int b = 0; b < 5; ++b) {
                    const BodyId id{b};
                    if (!world.contains(id)) continue;
                    ASSERT_EQ(restored->asleep(id), world.asleep(id)) << seed << " " << i;
                    ASSERT_EQ(restored->contact_count(id), world.contact_count(id)) << seed << " " << i;
                    auto own = world.contacts(id).begin();
                    for (const auto& contact : restored->contacts(id)) {
                        ASSERT_TRUE(own != world.contacts(id).end());
                        ASSERT_TRUE(contact.impulse == (*own).impulse && contact.point == (*own).point &&
                                    contact.began == (*own).began && contact.ended == (*own).ended)
                            << seed << " " << i;
                        ++own;
                    }
                }
            }
        }
        for (const World* restored : {&fresh, &other}) ASSERT_EQ(save(*restored), save(world)) << seed;
    }
}

// Whoever can make the check word right can write any number. None of them may lead out of the room of the world.
TYPED_TEST(SnapshotStories, that_are_forged_are_refused_or_stay_within_the_room) {
    using World = typename TestFixture::Full;
#ifdef TUMBLE_EVERY_KIND
    constexpr unsigned stories = 20, forgeries = 100;
#else
    constexpr unsigned stories = 3, forgeries = 20;
#endif
    for (unsigned seed = 1; seed <= stories; ++seed) {
        const Story<World> story{seed};
        Words random{seed * 77};
        World world = story.begin();
        const int saved_at = static_cast<int>(random() % 300);
        for (int i = 0; i < saved_at; ++i) {
            story.act(world, i);
            world.step();
        }
        const auto bytes = save(world);
        const auto forged = [&](std::size_t place, std::uint32_t word) {
            auto forgery = bytes;
            std::memcpy(&forgery[place], &word, 4);
            tumble::detail::Crc32 crc;
            for (std::size_t i = 0; i + 4 < forgery.size(); ++i) crc.add(forgery[i]);
            const std::uint32_t check = crc.value();
            std::memcpy(&forgery[forgery.size() - 4], &check, 4);
            return forgery;
        };
        const std::size_t end = bytes.size() - 4;
        int refused = 0;
        for (std::size_t place = 32; seed == 1 && place < end; place += 4) {
            World other = world;
            refused += restore(other, forged(place, 0x7fffffffu)) != SnapshotFault::none;
        }
        EXPECT_TRUE(seed > 1 || refused > 10) << refused;
        for (unsigned i = 0; i < forgeries; ++i) {
            const std::uint32_t words[] = {0xffffffffu, 0x7fffffffu, 0x80000000u, random(), random() % 70};
            const auto forgery = forged(32 + 4 * (random() % ((end - 32) / 4)), words[random() % 5]);
            World other = world;
            if (restore(other, forgery) != SnapshotFault::none) {
                ASSERT_EQ(save(other), bytes) << "what is refused changes nothing";
                continue;
            }
            for (int step = saved_at; step < saved_at + 30; ++step) {
                story.act(other, step);
                other.step();
            }
        }
    }
}

}  // namespace
}  // namespace tumble::test
