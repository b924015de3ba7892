// The port on a Cortex-M: a 64-bit counter.
// Under QEMU's -icount an instruction takes 2^N ns of SysTick time, which gives exact instruction counts: a difference
// of two readings is less than one tick away from the true time, and an instruction is more than two ticks long, so
// rounding to the nearest instruction is unambiguous whatever the phase.
#include "bare_metal.hpp"

#include <numeric>

#include "board.hpp"

extern "C" {
// SysTick wraps since init(), 2^24 ticks each; written by systick_handler.
volatile std::uint32_t tumble_port_wraps = 0;

// One wrap. Assembly, because its number of instructions is subtracted from a measured stretch.
[[gnu::naked]] void systick_handler() {
    asm("ldr r0, =tumble_port_wraps\n"
        "ldr r1, [r0]\n"
        "adds r1, #1\n"
        "str r1, [r0]\n"
        "bx lr\n"
        ".ltorg\n");
}
}

namespace tumble::port {

namespace {

using board::Counter;
using Register = volatile std::uint32_t*;

constexpr std::uint64_t handler_insn = 5;
constexpr unsigned systick_bits = 24;
constexpr std::uint32_t systick_mask = (std::uint32_t{1} << systick_bits) - 1;

// One instruction lasts ticks_num / ticks_den SysTick periods.
constexpr std::uint64_t ns_per_s = 1'000'000'000;
constexpr std::uint64_t common = std::gcd(board::insn_ns * board::clock_hz, ns_per_s);
constexpr std::uint64_t ticks_num = board::insn_ns * board::clock_hz / common;
constexpr std::uint64_t ticks_den = ns_per_s / common;
static_assert(board::counter != Counter::insn || ticks_num > 2 * ticks_den,
              "an instruction must last more than two SysTick periods for an exact count: raise N of insn:N");

Register at(std::uintptr_t address) { return reinterpret_cast<Register>(address); }
Register systick_control() { return at(0xE000E010); }
Register systick_reload() { return at(0xE000E014); }
Register systick_value() { return at(0xE000E018); }
Register debug_exception_control() { return at(0xE000EDFC); }
Register dwt_control() { return at(0xE0001000); }
Register dwt_cycles() { return at(0xE0001004); }
Register dwt_lock() { return at(0xE0001FB0); }

std::uint64_t reading_cost = 0;
std::uint64_t last_cycles = 0;

// The count goes down and its interrupt comes when it reaches 0, so its negative is the time since the last wrap. If a
// wrap falls between the two reads of the high part, the low part decides which one belongs to it. No branches: the
// cost does not depend on the values.
std::uint64_t read_systick() {
    const std::uint32_t before = tumble_port_wraps;
    const std::uint32_t low = (0 - *systick_value()) & systick_mask;
    asm volatile("isb" ::: "memory");
    const std::uint32_t after = tumble_port_wraps;
    const std::uint32_t high = after - ((low >> (systick_bits - 1)) & (after - before));
    return (std::uint64_t{high} << systick_bits) | low;
}

std::uint64_t read_dwt() {
    const std::uint32_t step = *dwt_cycles() - static_cast<std::uint32_t>(last_cycles);
    return last_cycles += step;
}

void start_systick() {
    *systick_control() = 0;
    tumble_port_wraps = 0;
    *systick_reload() = systick_mask;
    *systick_value() = 0;
    *systick_control() = 7;  // enable, interrupt, processor clock
}

void start_dwt() {
    *debug_exception_control() = *debug_exception_control() | (1U << 24);  // TRCENA
    *dwt_lock() = 0xC5ACCE55;                                              // Cortex-M7 locks its DWT
    *dwt_cycles() = 0;
    *dwt_control() = *dwt_control() | 1U;
    last_cycles = 0;
}

// Two readings with nothing but two register moves between them.
void measure_reading_cost() {
    std::uint32_t from_low, from_high, to_low, to_high;
    reading_cost = 0;
    asm volatile(
        "bl %c[ticks]\n"
        "mov r4, r0\n"
        "mov r5, r1\n"
        "bl %c[ticks]\n"
        "mov %[from_low], r4\n"
        "mov %[from_high], r5\n"
        "mov %[to_low], r0\n"
        "mov %[to_high], r1\n"
        : [from_low] "=r"(from_low), [from_high] "=r"(from_high), [to_low] "=r"(to_low), [to_high] "=r"(to_high)
        : [ticks] "i"(&ticks)
        : "r0", "r1", "r2", "r3", "r4", "r5", "ip", "lr", "cc", "memory");
    const auto instant = [](std::uint32_t high, std::uint32_t low) {
        return Instant{(std::uint64_t{high} << 32) | low};
    };
    constexpr std::uint64_t moves = 2;
    const std::uint64_t measured = elapsed(instant(from_high, from_low), instant(to_high, to_low));
    if (measured <= moves) {
        write("port: the counter of this board does not advance\n");
        exit(no_counter_status);
    }
    reading_cost = measured - moves;
}

std::uint32_t* stack_pointer() {
    std::uint32_t* sp;
    asm volatile("mov %0, sp" : "=r"(sp));
    return sp;
}

}  // namespace

void init() {
    paint_stack(stack_pointer());
    if constexpr (board::counter == Counter::dwt) start_dwt();
    else start_systick();
    measure_reading_cost();
}

Instant ticks() {
    if constexpr (board::counter == Counter::dwt) return Instant{read_dwt()};
    else return Instant{read_systick()};
}

// A wrap within the stretch ran systick_handler, whose instructions are not the caller's.
std::uint64_t elapsed(Instant from, Instant to) {
    const auto begin = static_cast<std::uint64_t>(from);
    const auto end = static_cast<std::uint64_t>(to);
    if (end <= begin) return 0;
    std::uint64_t units = end - begin;
    std::uint64_t own = reading_cost;
    if constexpr (board::counter == Counter::insn) {
        units = (units * ticks_den * 2 + ticks_num) / (ticks_num * 2);
        own += handler_insn * ((end >> systick_bits) - (begin >> systick_bits));
    }
    return units > own ? units - own : 0;
}

std::string_view tick_unit() { return board::counter == Counter::insn ? "insn" : "cycles"; }

std::string_view core() { return board::core; }

}  // namespace tumble::port
