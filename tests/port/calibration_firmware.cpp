// elapsed() gives exactly the number of instructions executed: an assembly loop of known length, from 3 instructions to
// 40 million (several wraps of the counter), and short stretches at every position around a wrap.
#include "port.hpp"

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
    return readings;
}

void write_number(std::uint64_t value) {
    char text[20];
    std::size_t at = sizeof text;
    do text[--at] = static_cast<char>('0' + value % 10);
    while ((value /= 10) != 0);
    write(text + at, sizeof text - at);
}

bool exact(std::uint32_t rounds) {
    const Readings readings = run_loop(rounds);
    const std::uint64_t got = elapsed(readings.from, readings.to);
    if (got == instructions(rounds)) return true;
    write("got ");
    write_number(got);
    write(" insn, expected ");
    write_number(instructions(rounds));
    write("\n");
    return false;
}

}  // namespace

int main() {
    init();
    if (tick_unit() != "insn") return 1;
    bool ok = true;

    for (std::uint32_t rounds = 1; rounds <= 300; ++rounds) ok &= exact(rounds);
    for (std::uint32_t rounds : {1'000U, 9'999U, 100'000U, 1'234'567U, 5'000'000U, 20'000'000U}) {
        ok &= exact(rounds);
        write_number(instructions(rounds));
        write(" insn\n");
    }

    // Walk to just before a wrap (bit 24 of the raw count), then step over it in short stretches; the walk's length
    // moves the stretches against the wrap by one instruction at a time.
    std::uint32_t crossed = 0;
    for (std::uint32_t shift = 0; shift < 60; ++shift) {
        std::uint64_t left;
        const std::uint64_t period = std::uint64_t{1} << 24;
        do {
            ok &= exact(1);
            left = period - static_cast<std::uint64_t>(ticks()) % period;
            if (left > 20'000) ok &= exact(static_cast<std::uint32_t>(left / 32));
        } while (left > 20'000);
        for (std::uint32_t i = 0; i < shift; ++i) asm volatile("nop");
        for (std::uint32_t i = 0; i < 60; ++i) {
            const std::uint64_t before = static_cast<std::uint64_t>(ticks()) / period;
            ok &= exact(1 + i % 7);
            if (static_cast<std::uint64_t>(ticks()) / period != before) ++crossed;
        }
        // Step past what is left, so that each round meets a new wrap.
        ok &= exact(10'000);
    }
    write_number(crossed);
    write(" short stretches held a wrap\n");
    return ok ? 0 : 2;
}
