// elapsed() gives exactly the number of instructions executed: an assembly loop of known length, from 4 instructions to
// 40 million, and short stretches at every position around a wrap of the counter's lower part.
#include "port.hpp"

#include "../write_number.hpp"

namespace {

using namespace tumble::port;

struct Readings {
    Instant from;
    Instant to;
    std::uint32_t rounds;
};

// Executes 2 + 2 * rounds instructions between the two readings, for rounds >= 1.
constexpr std::uint64_t instructions(std::uint32_t rounds) { return 2 + 2 * std::uint64_t{rounds}; }

[[gnu::noinline]] Readings run_loop(std::uint32_t rounds) {
    Readings readings{{}, {}, rounds};
#if defined(__riscv)
    asm volatile("mv s2, %[readings]\n"
                 "lw s3, 16(s2)\n"
                 "call %[ticks]\n"
                 "sw a0, 0(s2)\n"
                 "sw a1, 4(s2)\n"
                 "1: addi s3, s3, -1\n"
                 "bnez s3, 1b\n"
                 "call %[ticks]\n"
                 "sw a0, 8(s2)\n"
                 "sw a1, 12(s2)\n"
                 :
                 : [readings] "r"(&readings), [ticks] "i"(&ticks)
                 : "ra", "t0", "t1", "t2", "t3", "t4", "t5", "t6", "a0", "a1", "a2", "a3", "a4", "a5", "a6", "a7", "s2",
                   "s3", "memory");
#else
    asm volatile("mov r5, %[readings]\n"
                 "ldr r4, [r5, #16]\n"
                 "bl %c[ticks]\n"
                 "str r0, [r5, #0]\n"
                 "str r1, [r5, #4]\n"
                 "1: subs r4, #1\n"
                 "bne 1b\n"
                 "bl %c[ticks]\n"
                 "str r0, [r5, #8]\n"
                 "str r1, [r5, #12]\n"
                 :
                 : [readings] "r"(&readings), [ticks] "i"(&ticks)
                 : "r0", "r1", "r2", "r3", "r4", "r5", "ip", "lr", "cc", "memory");
#endif
    return readings;
}

bool exact(std::uint32_t rounds) {
    const Readings readings = run_loop(rounds);
    const std::uint64_t got = elapsed(readings.from, readings.to);
    if (got == instructions(rounds)) return true;
    write("got ");
    write_number(got, 10, 1);
    write(" insn, expected ");
    write_number(instructions(rounds), 10, 1);
    write("\n");
    return false;
}

// Raw counts from one wrap to the next.
#if defined(__riscv)
constexpr std::uint64_t period = std::uint64_t{1} << 32;

// Sleeps until the timer of QEMU's virtual time, in ns as the counter's, whose registers are where most machines have
// them.
bool go_to_wrap() {
    constexpr std::uint32_t ns_per_tick = 100;
    auto* const compare = reinterpret_cast<volatile std::uint32_t*>(0x0200'4000);
    const std::uint64_t now = static_cast<std::uint64_t>(ticks());
    const std::uint64_t until = (now - now % period + period) / ns_per_tick - 20;
    compare[1] = 0xFFFF'FFFF;
    compare[0] = static_cast<std::uint32_t>(until);
    compare[1] = static_cast<std::uint32_t>(until >> 32);
    asm volatile(".option push\n.option arch, +zicsr\ncsrs mie, %0\nwfi\n.option pop" : : "r"(1U << 7) : "memory");
    return true;
}
#else
constexpr std::uint64_t period = std::uint64_t{1} << 24;

// Walks; are the instructions on the way exact?
bool go_to_wrap() {
    bool ok = true;
    std::uint64_t left;
    do {
        ok &= exact(1);
        left = period - static_cast<std::uint64_t>(ticks()) % period;
        if (left > 20'000) ok &= exact(static_cast<std::uint32_t>(left / 32));
    } while (left > 20'000);
    return ok;
}
#endif

}  // namespace

int main() {
    init();
    if (tick_unit() != "insn") return 1;
    bool ok = true;

    for (std::uint32_t rounds = 1; rounds <= 300; ++rounds) ok &= exact(rounds);
    for (std::uint32_t rounds : {1'000U, 9'999U, 100'000U, 1'234'567U, 5'000'000U, 20'000'000U}) {
        ok &= exact(rounds);
        write_number(instructions(rounds), 10, 1);
        write(" insn\n");
    }

    // The counter just before a wrap, which is stepped over in short stretches; what runs before them moves them
    // against the wrap by one instruction at a time.
    std::uint32_t crossed = 0;
    for (std::uint32_t shift = 0; shift < 60; ++shift) {
        ok &= go_to_wrap();
        for (std::uint32_t i = 0; i < shift; ++i) asm volatile("nop");
        for (std::uint32_t i = 0; i < 60; ++i) {
            const std::uint64_t before = static_cast<std::uint64_t>(ticks()) / period;
            ok &= exact(1 + i % 7);
            if (static_cast<std::uint64_t>(ticks()) / period != before) ++crossed;
        }
        // Step past what is left, so that each round meets a new wrap.
        ok &= exact(10'000);
    }
    write_number(crossed, 10, 1);
    write(" short stretches held a wrap\n");
    if (crossed == 0) return 3;
    return ok ? 0 : 2;
}
