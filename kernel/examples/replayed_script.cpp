// A replayed script. `tumble compile host_sim/scenes/cube.toml` wrote cube.hpp, which has the scene's bodies, planes
// and timed impulses as constants. The program prints the state hash that `tumble run` prints for the same file.
#include <tumble/tumble.hpp>

#include "cube.hpp"
#include "port.hpp"

namespace {

using Cube = tumble::scenes::Cube;
using tumble::Real;

constinit tumble::Replay<Cube::Config, Cube> replay;  // the compiler sets it up

bool is_near(tumble::Scaled value, Real wanted) { return abs(value.to_real() - wanted) < 1e-3; }

void write_hash(std::uint64_t hash) {
    char line[17];
    for (int i = 0; i < 16; ++i) line[i] = "0123456789abcdef"[(hash >> (60 - 4 * i)) & 15];
    line[16] = '\n';
    tumble::port::write(line, sizeof line);
}

}  // namespace

int main() {
    const tumble::BodyId cube{0};
    for (std::uint32_t step = 0; step < Cube::steps; ++step) {
        if (!replay.step().ok()) return 1;
        if (step != 99) continue;
        // After 0.5 s. An impulse off the centre has spun the cube, one from below has made it rise at 3 m/s, and one
        // from the left, along its rotated axis, has sent it to the right.
        const auto& world = replay.world();
        const auto w = world.angular_velocity(cube);
        if (!is_near(w.x, 0) || !is_near(w.y, 0.96) || !is_near(w.z, -1.44)) return 2;
        if (!(world.velocity(cube).x > 2)) return 3;
    }
    write_hash(replay.world().hash());
    return 0;
}
