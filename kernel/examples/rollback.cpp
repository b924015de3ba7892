// Snapshot and rollback, as in network games: the impulses of the other player arrive a few steps late. A world is a
// value without heap and pointers of its own, so a copy is a snapshot. The program restores the snapshot of the
// impulse's step, applies the impulse and repeats the steps since then. In the end the world equals, bit for bit, one
// in which every impulse came in time.
#include <tumble/tumble.hpp>

using namespace tumble::literals;

namespace {

struct Table : tumble::Scene {
    using Numbers = tumble::Q32<tumble::NearRange>;
    static constexpr tumble::Features features{.bodies = 2, .planes = 1, .pairs = true, .friction = true};
};
using World = tumble::World<Table>;

constexpr int delay = 8, steps = 512;
const tumble::BodyId mine{0}, theirs{1};

World set_up() {
    World world{tumble::Seconds{1, 256}, {.gravity = {0, -9.81, 0}, .contact = {.friction = 0.2}}};
    tumble::BodySpec ball = tumble::sphere(0.2_kg, 0.1_m);
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

World in_time = set_up(), late = set_up(), snapshot = late;

}  // namespace

int main() {
    int rollbacks_that_changed = 0;
    for (int now = 0; now < steps; ++now) {
        step(in_time, now, true);
        if (is_push(now)) snapshot = late;
        step(late, now, false);  // the state without the late impulse, for display
        if (now < delay || !is_push(now - delay)) continue;
        const std::uint64_t guess = late.hash();
        late = snapshot;
        for (int again = now - delay; again <= now; ++again) step(late, again, true);
        if (late.hash() != in_time.hash()) return 1;
        rollbacks_that_changed += late.hash() != guess;
    }
    if (late.hash() != in_time.hash() || rollbacks_that_changed != steps / 64) return 2;
    // The balls have met: the other's ball was pushed to the left and driven to the right, and no ball passed through
    // the other.
    const auto x = in_time.position(mine).x, other_x = in_time.position(theirs).x;
    const bool met = other_x > 1 && (other_x - x).to_real() > 0.199;
    return met && in_time.status().ok() ? 0 : 3;
}
