// The cost of a step of the peer on this core: one row, as the kernel's own firmware prints it. The host checks its
// state hash.
#include <tumble/tumble.hpp>

#include "odeint.hpp"

#include TUMBLE_SCENE_HEADER

#include "json_row.hpp"
#include "port.hpp"

namespace boost {
// Odeint's steppers of fixed order throw nothing.
void throw_exception(const std::exception&) { __builtin_trap(); }
void throw_exception(const std::exception&, const source_location&) { __builtin_trap(); }
}  // namespace boost

// Odeint's headers include <iostream>. Nothing here uses it, and firmware does not have it.
std::ios_base::Init::Init() = default;
std::ios_base::Init::~Init() = default;

// The C library reports the square root of a negative number here.
extern "C" int* __errno() {
    static int number;
    return &number;
}

namespace {

using Recorded = tumble::scenes::TUMBLE_SCENE;
using Number = TUMBLE_PEER_NUMBER;
using Equations = tumble::bench::TUMBLE_PEER_EQUATIONS;
using Run = tumble::bench::OdeintRun<tumble::bench::TUMBLE_PEER_STEPPER, Equations>;

Run run{Recorded{}, tumble::bench::as<Number>(Recorded::step.value)};

[[gnu::noinline]] void step_run() { run.step(); }

}  // namespace

int main() {
    using namespace tumble;
    port::init();
    constexpr std::uint32_t steps = Recorded::steps < 256 ? Recorded::steps : 256;
    std::uint64_t total = 0;
    for (std::uint32_t i = 0; i < steps; ++i) {
        const port::Instant before = port::ticks();
        step_run();
        total += port::elapsed(before, port::ticks());
    }
    port::JsonRow row;
    row.add("scene", Recorded::name);
    row.add("core", port::core());
    row.add("numbers", sizeof(Number) == 4 ? "f32" : "f64");
    row.add("carry", false);
    row.add("integrator", TUMBLE_PEER_NAME);
    row.add("steps", steps);
    row.add("insn_per_step", (total + steps / 2) / steps);
    row.add_hex("state_hash", run.hash());
    row.write();
    return 0;
}
