// Replays the scene that `tumble compile` wrote, counts what every step costs, and prints one result row. The row's
// state hash is for the host to check: no number is used whose answer is wrong.
#include <tumble/numbers/variants.hpp>
#include <tumble/replay.hpp>

#include TUMBLE_SCENE_HEADER

#include "json_row.hpp"
#include "port.hpp"

namespace {

using Recorded = tumble::scenes::TUMBLE_SCENE;

struct Config : Recorded::Features {
    using Numbers = tumble::variants::TUMBLE_VARIANT::Numbers<Recorded::Features::Numbers::Range>;
    using Integrator = tumble::integrators::TUMBLE_METHOD;
};

tumble::Replay<Config, Recorded> replay;

// Out of line: the step is measured as a function of its own, with its call, not with this program's registers. That of
// free bodies is inlined whole, as a firmware would have it that has nothing else to do; with loads and contacts that
// would double the text and treble the stack, and gain nothing.
[[gnu::noinline, gnu::flatten, maybe_unused]] tumble::Status step_world_inlined() { return replay.world().step(); }
[[gnu::noinline, maybe_unused]] tumble::Status step_world_called() { return replay.world().step(); }
tumble::Status measured_step() {
    using World = std::remove_cvref_t<decltype(replay.world())>;
    if constexpr (World::has_loads || World::has_contacts) return step_world_called();
    else return step_world_inlined();
}

}  // namespace

int main() {
    using namespace tumble;
    port::init();
    std::uint64_t total = 0, largest = 0;
    for (std::uint32_t step = 0; step < Recorded::steps; ++step) {
        const port::Instant before = port::ticks();
        const Status status = measured_step();
        const port::Instant after = port::ticks();
        const std::uint64_t cost = port::elapsed(before, after);
        total += cost;
        if (cost > largest) largest = cost;
        if (!status.ok()) break;
    }
    bench::JsonRow row;
    row.add("scene", Recorded::name);
    row.add("core", port::core());
    row.add("numbers", Config::Numbers::name);
    row.add("carry", Config::Numbers::carry);
    row.add("integrator", Config::Integrator::name);
    row.add("steps", replay.world().steps_taken());
    // Rounded to the nearest; the largest single step beside it.
    const std::uint64_t steps = replay.world().steps_taken();
    const auto unit = port::tick_unit();
    const auto pick = [&](const char* cycles, const char* insn, const char* ns) {
        return unit == "cycles" ? cycles : unit == "insn" ? insn : ns;
    };
    row.add(pick("cycles_per_step", "insn_per_step", "ns_per_step"), steps == 0 ? 0 : (total + steps / 2) / steps);
    row.add(pick("cycles_per_step_max", "insn_per_step_max", "ns_per_step_max"), largest);
    row.add("stack_bytes", static_cast<std::uint64_t>(port::stack_peak()));
    row.add("world_bytes", static_cast<std::uint64_t>(sizeof(replay.world())));
    row.add("status_bits", static_cast<std::uint64_t>(replay.world().status().bits));
    row.add_hex("state_hash", replay.world().hash());
    row.write();
    return 0;
}
