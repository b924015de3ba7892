// What a step of the peer costs on this core: one row, as the kernel's own firmware prints it.
#include "odeint_top.hpp"

#include "json_row.hpp"
#include "port.hpp"

namespace boost {
// Odeint's steppers of fixed order throw nothing.
void throw_exception(const std::exception&) { __builtin_trap(); }
void throw_exception(const std::exception&, const source_location&) { __builtin_trap(); }
}  // namespace boost

// Odeint's headers include <iostream>, which nothing here uses and a firmware has not.
std::ios_base::Init::Init() = default;
std::ios_base::Init::~Init() = default;

namespace {

using Number = TUMBLE_PEER_NUMBER;
tumble::bench::OdeintTop<tumble::bench::TUMBLE_PEER_STEPPER, Number> top{{1, 2, 3}, {1, 1, 1}, Number(1) / 256};

[[gnu::noinline]] void step_top() { top.step(); }

}  // namespace

int main() {
    using namespace tumble;
    port::init();
    constexpr std::uint32_t steps = 256;
    std::uint64_t total = 0;
    for (std::uint32_t i = 0; i < steps; ++i) {
        const port::Instant before = port::ticks();
        step_top();
        total += port::elapsed(before, port::ticks());
    }
    bench::JsonRow row;
    row.add("scene", "generic top");
    row.add("core", port::core());
    row.add("numbers", sizeof(Number) == 4 ? "f32" : "f64");
    row.add("carry", false);
    row.add("integrator", TUMBLE_PEER_NAME);
    row.add("steps", steps);
    row.add("insn_per_step", (total + steps / 2) / steps);
    row.write();
    return 0;
}
