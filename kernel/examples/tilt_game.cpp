// A game for a board with an accelerometer: the player tilts a tray with a rim, and two balls roll to the goal. Counts
// of the sensor become gravity by one constant, in integers. The program records its samples, 8 bytes each, and then
// replays them: each becomes an event when it is due. The program prints the hash of the end, which is the same on
// every machine: a game that is recorded on a core is replayed on the workstation, bit for bit.
#include <tumble/tumble.hpp>

#include "port.hpp"

namespace {

using namespace tumble::literals;

constexpr int samples = 24, steps_per_sample = 8;  // 8 samples a second, for 3 s

struct Tray : tumble::Scene {
    using Numbers = tumble::Q32<tumble::Range<2, 8, 128>>;  // 2 m, 8 m/s, 128 rad/s
    static constexpr tumble::Features features{
        .bodies = 2, .planes = 5, .near_pairs = 7, .control = true, .snapshots = true, .pairs = true, .friction = true};
};
using Game = tumble::World<Tray>;
constexpr double half = 0.2, radius = 0.02;  // of the tray and of a ball, m
constexpr tumble::BodyId steel{0}, wood{1};

Game game{tumble::Seconds{1, 64}, {.contact = {.restitution = 0, .friction = 0.5}}};
std::uint8_t start[512];  // the bodies at the start

// Two balls in one corner of a tray. The goal is the corner opposite.
void set_up() {
    tumble::BodySpec ball = tumble::sphere(0.25_kg, radius);
    ball.position = {-0.15, radius, -0.16};
    (void)game.add(ball);
    ball.mass = 0.025_kg;
    ball.position = {-0.1, radius, -0.15};
    (void)game.add(ball);
    (void)game.add(tumble::PlaneSpec{});
    for (const int side : {-1, 1}) {
        (void)game.add(tumble::PlaneSpec{.normal = {side, 0, 0}, .offset = half});
        (void)game.add(tumble::PlaneSpec{.normal = {0, 0, side}, .offset = half});
    }
}

// What the sensor reads before a step, along the axes of the tray, in counts of g / 16384: at rest the opposite of
// gravity.
struct Sample {
    std::uint16_t step;
    std::int16_t x, y, z;
};
Sample recording[samples];
// Its bits are Fixed<26>: m/s^2 times 2^26. One count is 9.80665 / 16384 m/s^2.
constexpr std::int32_t per_count = 40168;
void set_gravity(const Sample& s) {
    game.set_gravity(tumble::Vector3<tumble::Fixed<26>>{{-s.x * per_count}, {-s.y * per_count}, {-s.z * per_count}});
}

// In place of a sensor: a player tilts the tray along z for a second, then along x and z for two, by 14 degrees, with a
// hand that trembles.
Sample read_sensor(int step) {
    static std::uint32_t noise = 1;
    const auto tremble = [] {
        noise = noise * 1664525 + 1013904223;
        return static_cast<int>(noise >> 25) - 64;
    };
    const int slope = -4096, x = step < 64 ? 0 : slope, z = slope;
    const auto count = [&](int value) { return static_cast<std::int16_t>(value + tremble()); };
    return {static_cast<std::uint16_t>(step), count(x), count(15864), count(z)};
}

// What a game does at each step, and what the tests measure.
[[gnu::noinline]] void play_step(int step) {
    if (step % steps_per_sample == 0) {
        Sample& sample = recording[step / steps_per_sample];
        sample = read_sensor(step);
        set_gravity(sample);
    }
    game.step();
}

}  // namespace

int main() {
    tumble::port::init();
    constexpr int steps = samples * steps_per_sample;
    set_up();
    const int size = game.save(start, sizeof start, tumble::SnapshotPart::bodies);
    for (int step = 0; step < steps; ++step) {
        play_step(step);
        // A ball that rolls down has 5/7 of the acceleration of one that slides without friction.
        const float expected = 9.80665F / 4 * 5 / 7 * static_cast<float>(step + 1) / 64,
                    speed = game.motion<float>(steel).velocity.z;
        if (step == 15 && !(speed > 0.98F * expected && speed < 1.02F * expected)) return 1;
    }
    for (const tumble::BodyId ball : {steel, wood}) {
        const auto end = game.pose<float>(ball).position;
        if (!(end.x > 0.12F && end.z > 0.12F)) return 2;  // in the corner of the goal
    }
    if (!game.status().ok()) return 3;
    const std::uint64_t hash = game.hash();

    if (size == 0 || game.restore(start, size) != tumble::SnapshotFault::none) return 4;
    tumble::Script<Sample> script;
    script.set({recording, samples}, game.steps_taken());
    for (int step = 0; step < steps; ++step) {
        script.for_each_due(game.steps_taken(), set_gravity);
        game.step();
    }
    if (game.hash() != hash) return 5;
    tumble::port::write_hash(hash);
    return 0;
}
