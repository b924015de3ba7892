// Fails in the way that FAILURE names, where memory is missing at BAD_ADDRESS. Reaching the end exits with 0.
#include "port.hpp"

#include <cstdlib>

namespace {

volatile std::uintptr_t nowhere = BAD_ADDRESS;
volatile std::uint32_t zero = 0;

// Endless, which compilers cannot know.
[[gnu::noinline]] std::uint32_t overflow_stack(std::uint32_t depth) {
    volatile std::uint32_t frame[32] = {depth};
    return nowhere == 0 ? 0 : overflow_stack(depth + 1) + frame[depth % 32];
}

void execute_undefined() {
#if defined(__arm__)
    asm volatile("udf #0");
#elif defined(__riscv)
    asm volatile("unimp");
#else
    __builtin_trap();
#endif
}

volatile std::uint32_t sink;

enum class Failure {
    bad_read,
    bad_write,
    bad_jump,
    stack_overflow,
    undefined_instruction,
    divide_by_zero,
    abort,
    forever
};

}  // namespace

int main() {
    tumble::port::init();
    switch (Failure::FAILURE) {
    case Failure::bad_read: sink = *reinterpret_cast<volatile std::uint32_t*>(nowhere); break;
    case Failure::bad_write: *reinterpret_cast<volatile std::uint32_t*>(nowhere) = 1; break;
    case Failure::bad_jump: reinterpret_cast<void (*)()>(nowhere | 1)(); break;
    case Failure::stack_overflow: sink = overflow_stack(0); break;
    case Failure::undefined_instruction: execute_undefined(); break;
    case Failure::divide_by_zero: sink = 100 / zero; break;
    case Failure::abort: std::abort();
    case Failure::forever:
        for (;;) asm volatile("");
    }
    return 0;
}
