// Rollback over a wire, as in network games. Two players run the same world; the impulses of each arrive at the other a
// few steps late. A player keeps the snapshot of a step as bytes. When a late impulse arrives, it restores the snapshot
// of the impulse's step, applies the impulse and repeats the steps since then. In the end both worlds equal, bit for
// bit, one in which every impulse came in time. A spectator who comes late takes the bytes from the wire and goes on.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

struct Table : tumble::Scene {
    using Numbers = tumble::Q32<tumble::NearRange>;
    static constexpr tumble::Features features{
        .bodies = 2, .planes = 1, .snapshots = true, .pairs = true, .friction = true};
};
using World = tumble::World<Table>;

constexpr int delay = 8, steps = 512;
const tumble::BodyId mine{0}, theirs{1};

World set_up(double mass = 0.2) {
    World world{tumble::Seconds{1, 256}, {.gravity = {0, -9.81, 0}, .contact = {.friction = 0.2}}};
    tumble::BodySpec ball = tumble::sphere(mass, 0.1_m);
    ball.position = {0, 0.1_m, 0};
    (void)world.add(ball);
    ball.position = {1, 0.1_m, 0};
    (void)world.add(ball);
    (void)world.add(tumble::PlaneSpec{});
    return world;
}

// Every 64 steps each player pushes its own ball towards the other's.
bool is_push(int step) { return step % 64 == 0; }
void step(World& world, int number, bool other_is_known) {
    if (is_push(number)) {
        world.apply_impulse(mine, {0.2, 0, 0});  // N s
        if (other_is_known) world.apply_impulse(theirs, {-0.1, 0, 0});
    }
    world.step();
}

// The bytes that go over the wire.
struct Bytes {
    std::uint8_t data[1536];
    int size = 0;
};
bool save(const World& world, Bytes& bytes) {
    bytes.size = world.save(bytes.data, sizeof bytes.data);
    return bytes.size > 0;
}
tumble::SnapshotFault restore(World& world, const Bytes& bytes) { return world.restore(bytes.data, bytes.size); }

World in_time = set_up(), late = set_up(), spectator = set_up();
Bytes snapshot;

}  // namespace

int main() {
    using tumble::SnapshotFault;
    int rollbacks_that_changed = 0;
    for (int now = 0; now < steps; ++now) {
        step(in_time, now, true);
        if (is_push(now) && !save(late, snapshot)) return 1;
        step(late, now, false);  // the state without the late impulse, for display
        if (now < delay || !is_push(now - delay)) continue;
        const std::uint64_t guess = late.hash();
        if (restore(late, snapshot) != SnapshotFault::none) return 2;
        for (int again = now - delay; again <= now; ++again) step(late, again, true);
        if (late.hash() != in_time.hash()) return 3;
        rollbacks_that_changed += late.hash() != guess;
    }
    if (late.hash() != in_time.hash() || rollbacks_that_changed != steps / 64) return 4;

    // The spectator comes after the last push.
    if (!save(late, snapshot) || restore(spectator, snapshot) != SnapshotFault::none) return 5;
    for (int i = 0; i < 32; ++i) {
        late.step();
        spectator.step();
    }
    if (spectator.hash() != late.hash()) return 6;
    // A byte that the wire has changed, a part of the bytes, and the bytes of another game are refused.
    const std::uint64_t before = spectator.hash();
    snapshot.data[100] ^= 1;
    if (restore(spectator, snapshot) != SnapshotFault::corrupted) return 7;
    if (spectator.restore(snapshot.data, snapshot.size / 2) != SnapshotFault::truncated) return 8;
    World other = set_up(0.3);
    if (!save(other, snapshot) || restore(spectator, snapshot) != SnapshotFault::other_scene) return 9;
    if (spectator.hash() != before) return 10;

    // The balls have met: the other's ball was pushed to the left and driven to the right, and no ball passed through
    // the other.
    const auto x = in_time.position(mine).x, other_x = in_time.position(theirs).x;
    const bool met = other_x > 1 && (other_x - x).to_real() > 0.199;
    return met && in_time.status().ok() ? 0 : 11;
}
