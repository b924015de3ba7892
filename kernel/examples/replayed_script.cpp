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
    tumble::port::write_hash(replay.world().hash());
    return 0;
}
