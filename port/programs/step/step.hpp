// Replays the scene that `tumble compile` wrote, counts what every step costs, and prints one result row. The row's
// state hash is for the host to check: no number is used whose answer is wrong.
//
// A source that includes this defines TUMBLE_SCENE_HEADER, TUMBLE_SCENE (the struct in it) and TUMBLE_VARIANT (the
// number system's name in quotes), and calls measure<Method>() from a function of its own for each method. What methods
// share is then compiled once; the linker takes into a program what its one method needs.
#pragma once

#include <tumble/replay.hpp>

#include TUMBLE_SCENE_HEADER

#include "json_row.hpp"
#include "port.hpp"

#include <new>
#include <type_traits>

namespace {

using Recorded = tumble::scenes::TUMBLE_SCENE;

template <class Method>
struct Timed : Recorded::Config {
    using Numbers = tumble::NumbersOf<TUMBLE_VARIANT, typename Recorded::Config::Numbers::Range>;
    using Integrator = Method;
};

template <class Method>
using Replayed = tumble::Replay<Timed<Method>, Recorded>;

// Whether the compiler can set the replay up. The program has no code for it then, as a firmware has none.
template <class Replay>
constexpr bool is_constant = requires {
    typename std::bool_constant<(static_cast<void>(Replay{}), true)>;
};

// What is not constant is set up when its program starts: a constructor of a global would be in every program.
template <class Method, bool constant = is_constant<Replayed<Method>>>
union Place {
    constexpr Place() : empty{} {}
    char empty;
    Replayed<Method> replay;
    // Out of line, so that its stack does not count as the step's.
    [[gnu::noinline]] void set_up() { new (&replay) Replayed<Method>; }
};
template <class Method>
union Place<Method, true> {
    Replayed<Method> replay{};
    void set_up() {}
};
template <class Method>
constinit Place<Method> place{};

// Out of line: the step is measured as a function of its own, with its call, not with this program's registers. That of
// free bodies is inlined whole, as a firmware would have it that has nothing else to do; with loads and contacts that
// would double the text and treble the stack, and gain nothing.
template <class Method>
[[gnu::noinline, gnu::flatten]] tumble::Status step_world_inlined() {
    return place<Method>.replay.step();
}
template <class Method>
[[gnu::noinline]] tumble::Status step_world_called() {
    return place<Method>.replay.step();
}
template <class Method>
tumble::Status measured_step() {
    using World = tumble::World<Timed<Method>>;
    if constexpr (World::has_loads) return step_world_called<Method>();
    else return step_world_inlined<Method>();
}

// Out of line, so that its stack does not count as the step's.
template <class Method>
[[gnu::noinline]] void print_row(std::uint64_t total, std::uint64_t largest, std::uint64_t last) {
    using namespace tumble;
    const World<Timed<Method>>& world = place<Method>.replay.world();
    const std::uint64_t steps = world.steps_taken();
    const auto unit = port::tick_unit();
    const auto pick = [&](const char* cycles, const char* insn, const char* ns) {
        return unit == "cycles" ? cycles : unit == "insn" ? insn : ns;
    };
    port::JsonRow row;
    row.add("scene", Recorded::name);
    row.add("core", port::core());
    row.add("numbers", Timed<Method>::Numbers::name);
    row.add("carry", Timed<Method>::Numbers::carry);
    row.add("integrator", Method::name);
    row.add("steps", steps);
    // Rounded to the nearest; the largest single step beside it, and the last.
    row.add(pick("cycles_per_step", "insn_per_step", "ns_per_step"), steps == 0 ? 0 : (total + steps / 2) / steps);
    row.add(pick("cycles_worst_step", "insn_per_step_max", "ns_per_step_max"), largest);
    row.add(pick("cycles_per_step_last", "insn_per_step_last", "ns_per_step_last"), last);
    row.add("stack_bytes", static_cast<std::uint64_t>(port::stack_peak()));
    row.add("world_bytes", static_cast<std::uint64_t>(sizeof(world)));
    row.add("status_bits", static_cast<std::uint64_t>(world.status().bits));
    row.add_hex("state_hash", world.hash());
    row.write();
}

// The whole program.
template <class Method>
int measure() {
    using namespace tumble;
    place<Method>.set_up();
    port::init();
    std::uint64_t total = 0, largest = 0, last = 0;
    for (std::uint32_t step = 0; step < Recorded::steps; ++step) {
        const port::Instant before = port::ticks();
        const Status status = measured_step<Method>();
        const port::Instant after = port::ticks();
        const std::uint64_t cost = port::elapsed(before, after);
        total += cost;
        if (cost > largest) largest = cost;
        last = cost;
        if (!status.ok()) break;
    }
    print_row<Method>(total, largest, last);
    return 0;
}

}  // namespace
