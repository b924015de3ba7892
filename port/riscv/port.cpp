// The port on a RISC-V hart in machine mode: a 64-bit counter. Under QEMU's -icount an instruction takes 2^N ns of
// virtual time, which minstret counts in ns: exact, without rounding.
#include "bare_metal.hpp"
#include "board.hpp"
#include "csr.hpp"

namespace tumble::port {

namespace {

using board::Counter;
constexpr int counter = board::counter == Counter::insn ? csr::minstret : csr::mcycle;

std::uint64_t reading_cost = 0;

std::uint32_t* stack_pointer() {
    std::uint32_t* sp;
    asm volatile("mv %0, sp" : "=r"(sp));
    return sp;
}

// Two readings with nothing but two register moves between them.
void measure_reading_cost() {
    std::uint32_t from_low, from_high, to_low, to_high;
    reading_cost = 0;
    asm volatile(
        "call %[ticks]\n"
        "mv s2, a0\n"
        "mv s3, a1\n"
        "call %[ticks]\n"
        "mv %[from_low], s2\n"
        "mv %[from_high], s3\n"
        "mv %[to_low], a0\n"
        "mv %[to_high], a1\n"
        : [from_low] "=r"(from_low), [from_high] "=r"(from_high), [to_low] "=r"(to_low), [to_high] "=r"(to_high)
        : [ticks] "i"(&ticks)
        : "ra", "t0", "t1", "t2", "t3", "t4", "t5", "t6", "a0", "a1", "a2", "a3", "a4", "a5", "a6", "a7", "s2", "s3",
          "memory");
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

}  // namespace

void init() {
    paint_stack(stack_pointer());
    measure_reading_cost();
}

// If a wrap of the lower half falls between the two reads of the upper one, the lower half decides which one belongs to
// it. No branches: the cost does not depend on the values.
Instant ticks() {
    const std::uint32_t before = csr::read<counter + csr::high>();
    const std::uint32_t low = csr::read<counter>();
    const std::uint32_t after = csr::read<counter + csr::high>();
    const std::uint32_t high = after - ((low >> 31) & (after - before));
    return Instant{(std::uint64_t{high} << 32) | low};
}

std::uint64_t elapsed(Instant from, Instant to) {
    const auto begin = static_cast<std::uint64_t>(from);
    const auto end = static_cast<std::uint64_t>(to);
    if (end <= begin) return 0;
    const std::uint64_t units = board::counter == Counter::insn ? (end - begin) >> board::insn_shift : end - begin;
    return units > reading_cost ? units - reading_cost : 0;
}

std::string_view tick_unit() { return board::counter == Counter::insn ? "insn" : "cycles"; }

std::string_view core() { return board::core; }

}  // namespace tumble::port
