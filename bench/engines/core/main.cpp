// A scene in an engine on a core: prints a row with what a step costs, with the error, and with the deepest overlap at
// the end. TUMBLE_ERROR names the error, if the scene has one. TUMBLE_ENGINE is the header of the engine. It has a
// class Engine:
//   name, numbers, carry   of the row; carry: whether the state carries residuals
//   step()                 a step of Recorded::step
//   position(i), turn(i)   of a body: m, and a unit quaternion
//   push(i, impulse)       an impulse in N s at a body's centre. This kernel has none: its world has the scene's
//   status_bits()          that of this kernel
#include TUMBLE_ENGINE

#include "heap.hpp"
#include "json_row.hpp"
#include "overlap.hpp"
#include "port.hpp"
#include "scene.hpp"

#include <cmath>

namespace {

using namespace tumble;
using namespace tumble::bench;

// In the cradle, whose bodies are balls, the outer ones move.
constexpr std::size_t first_still = scene_bodies[0].is_ball ? 1 : 0, end_of_still = body_count - first_still;

Engine engine;

// The host finds the step by its name.
[[gnu::noinline]] void step_run() { engine.step(); }

void push(auto& pushed, std::uint32_t step) {
    if constexpr (requires { pushed.push(std::size_t{0}, Vec{}); })
        for (const Push& due : scene_pushes)
            if (due.step == step) pushed.push(due.body, due.impulse);
}
std::uint32_t status_bits(const auto& ended) {
    if constexpr (requires { ended.status_bits(); }) return ended.status_bits();
    else return 0;
}

enum class Error { none, sideways, distance };
constexpr Error error = Error::TUMBLE_ERROR;

// The largest distance of a body from its place, sideways or in all, m; NaN where a place is none.
float largest_shift() {
    float most = 0;
    for (std::size_t i = first_still; i < end_of_still; ++i) {
        const Vec now = engine.position(i), start = scene_bodies[i].position;
        const float x = now.x - start.x, y = error == Error::distance ? now.y - start.y : 0 * now.y,
                    z = now.z - start.z;
        const float shift = std::sqrt(x * x + y * y + z * z);
        if (!(shift <= most)) most = shift;
        if (std::isnan(shift)) break;
    }
    return most;
}

}  // namespace

int main() {
    port::init();
    std::uint64_t total = 0, largest = 0;
    float shift = 0;
    std::uint32_t steps = 0;
    for (; steps < Recorded::steps && !std::isnan(shift); ++steps) {
        push(engine, steps);
        const port::Instant before = port::ticks();
        step_run();
        const std::uint64_t cost = port::elapsed(before, port::ticks());
        total += cost;
        if (cost > largest) largest = cost;
        if (const float now = largest_shift(); !(now <= shift)) shift = now;
    }
    port::JsonRow row;
    row.add("scene", Recorded::name);
    row.add("core", port::core());
    row.add("engine", Engine::name);
    row.add("version", TUMBLE_ENGINE_VERSION);
    row.add("integrator", TUMBLE_METHOD);
    row.add("numbers", Engine::numbers);
    row.add("carry", Engine::carry);
    row.add("steps_per_second", static_cast<std::uint32_t>(1 / step_seconds + 0.5f));
    row.add("steps", steps);
    row.add("insn_per_step", (total + steps / 2) / steps);
    row.add("insn_per_step_max", largest);
    row.add("stack_bytes", static_cast<std::uint64_t>(port::stack_peak()));
    row.add("heap_bytes", static_cast<std::uint64_t>(heap_peak()));
    row.add("status_bits", status_bits(engine));
    // The row's writer has whole numbers only.
    const auto add_metres = [&](const char* key, float metres) {
        row.add(key, static_cast<std::uint64_t>(metres * 1e9f + 0.5f));
    };
    if (std::isnan(shift)) {
        row.add("failure", "not a number");
    } else {
        if (error != Error::none) add_metres(error == Error::sideways ? "shift_sideways_nm" : "shift_nm", shift);
        add_metres("overlap_nm", deepest_overlap(engine));
    }
    row.write();
    return 0;
}
