// Sensors of a replayed script, as a test of fusion code needs them: a gyro and an accelerometer of 16 bits. `tumble
// compile host_sim/scenes/cube.toml` wrote cube.hpp. The program prints the number of samples and a hash of all counts.
// It is the same on every machine, so what a filter makes of them on the workstation it makes of them on the core.
#include <tumble/tumble.hpp>

#include "cube.hpp"
#include "port.hpp"

namespace {

using Cube = tumble::scenes::Cube;

// The scene as it was compiled, and an inertial sensor.
struct Sensed : Cube::Config {
    static constexpr tumble::Features features = [] {
        tumble::Features with = Cube::Config::features;
        with.imu = true;
        return with;
    }();
};
tumble::Replay<Sensed, Cube> replay;

// Full scale of the sensors: 16 g and 2000 degrees a second.
constexpr float counts_per_m_s2 = 32768 / (16 * 9.80665F), counts_per_rad_s = 32768 / 34.906585F;

// The nearest count, ties away from zero, held at full scale.
std::int16_t count(float value, float scale) {
    const float scaled = value * scale;
    if (scaled >= 32767) return 32767;
    if (scaled <= -32768) return -32768;
    return static_cast<std::int16_t>(scaled + (scaled < 0 ? -0.5F : 0.5F));
}
struct Sample {
    std::int16_t gyro[3], accelerometer[3];
};

// What a test does at each step, and what the tests measure. The sensor is off the centre of mass, m.
[[gnu::noinline]] Sample step_and_sample() {
    replay.step();
    const auto imu = replay.world().imu<float>(tumble::BodyId{0}, {0.0F, 0.1F, 0.0F});
    Sample s;
    for (int i = 0; i < 3; ++i) {
        s.gyro[i] = count(imu.angular_velocity[i], counts_per_rad_s);
        s.accelerometer[i] = count(imu.specific_force[i], counts_per_m_s2);
    }
    return s;
}

}  // namespace

int main() {
    tumble::Hash hash;
    for (std::uint32_t step = 0; step < Cube::steps; ++step) {
        const Sample s = step_and_sample();
        for (int i = 0; i < 3; ++i)
            hash.add(static_cast<std::uint32_t>(static_cast<std::uint16_t>(s.gyro[i])) << 16 |
                     static_cast<std::uint16_t>(s.accelerometer[i]));
        if (step != 99) continue;
        // The impulses have given the cube a spin of 0.96 rad/s about y and -1.44 rad/s about z of the world.
        const auto rate = [](float counts) { return counts / counts_per_rad_s; };
        const float square =
            rate(s.gyro[0]) * rate(s.gyro[0]) + rate(s.gyro[1]) * rate(s.gyro[1]) + rate(s.gyro[2]) * rate(s.gyro[2]);
        if (!(square > 2.98F && square < 3.01F)) return 1;  // 0.96^2 + 1.44^2 = 2.995
    }
    if (!replay.world().status().ok()) return 2;
    tumble::port::write_hash(hash.value());
    return 0;
}
