// What firmware on every core without an operating system shares: memory before main, a painted stack, and text and the
// end by semihosting.
#pragma once

#include <cstdint>

#include "port.hpp"

int main();

extern "C" {
extern std::uint32_t __stack_limit[];
extern std::uint32_t __stack_top[];
extern std::uint32_t __data_start[];
extern std::uint32_t __data_end[];
extern const std::uint32_t __data_load[];
extern std::uint32_t __bss_start[];
extern std::uint32_t __bss_end[];
extern void (*const __init_array_start[])();
extern void (*const __init_array_end[])();
}

namespace tumble::port {

inline constexpr std::uint32_t paint = 0xA5A5A5A5;

// Paints the stack below the caller's stack pointer. stack_peak() finds the deepest word that has changed since.
[[gnu::always_inline]] inline void paint_stack(const std::uint32_t* stack_pointer) {
    for (volatile std::uint32_t* word = __stack_limit; word < stack_pointer; word = word + 1) *word = paint;
}

// Code that runs before .init_array must not use statics. main returns into exit, so exit's status is main's.
[[noreturn, gnu::always_inline]] inline void run_program() {
    const volatile std::uint32_t* from = __data_load;
    for (volatile std::uint32_t* to = __data_start; to < __data_end; to = to + 1, from = from + 1) *to = *from;
    for (volatile std::uint32_t* word = __bss_start; word < __bss_end; word = word + 1) *word = 0;
    for (auto constructor = __init_array_start; constructor < __init_array_end; ++constructor) (*constructor)();
    exit(main());
}

// Writes the value as 0x and eight digits.
void write_hex(std::uint32_t value);

}  // namespace tumble::port
