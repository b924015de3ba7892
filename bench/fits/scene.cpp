// The firmware of a scene that `tumble compile` wrote: it takes the scene's steps, and nothing else. The compiler sets
// up the world, so the firmware has no code for that.
#include <tumble/replay.hpp>

#include TUMBLE_SCENE_HEADER

namespace {

using Recorded = tumble::scenes::TUMBLE_SCENE;

constinit tumble::Replay<Recorded::Config, Recorded> replay;

// What is measured.
[[gnu::noinline]] tumble::Status step_world() { return replay.step(); }

}  // namespace

int main() {
    for (std::uint32_t i = 0; i < Recorded::steps; ++i)
        if (!step_world().ok()) return 1;
    return 0;
}
