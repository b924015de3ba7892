// The whole machine interface of tumble's programs: text output, a counter, stack use, and an exit. Programs that print
// or measure include it; the kernel never does. port/host and each folder in port/families.txt has an implementation.
// The build decides which one is linked; no macro does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace tumble::port {

// Exit statuses that the port itself produces. A fault exits with 128 + its exception number (of a Cortex-M: HardFault
// 131, MemManage 132, BusFault 133, UsageFault 134; of RISC-V: mcause, as 133 of a load and 135 of a store).
inline constexpr int abort_status = 120;       // abort(), a failed assert(), integer division by zero
inline constexpr int text_lost_status = 121;   // exit(0) or the end of main after text was lost
inline constexpr int no_counter_status = 122;  // the board row promises a counter that does not advance

// A reading of the counter. Raw counts differ from tick_unit() by a rational factor, so a reading has no arithmetic:
// elapsed() is the only way to a number.
enum class Instant : std::uint64_t {};

// Starts the counter, measures what a reading costs and repaints the unused stack. Call it first, and again to restart
// stack_peak() from here; readings taken before such a second call are void.
// Cost on a target: one pass over the unused stack. Failure: ends with no_counter_status.
void init();

// Reads the counter; 64 bits, so it does not wrap. Cost: under 30 instructions, always the same number.
// On silicon with a DWT counter, readings must be less than 2^32 cycles apart (43 s at 100 MHz), or time is lost.
[[nodiscard]] Instant ticks();

// What ran between the return of ticks() that gave `from` and the call of ticks() that gave `to`, in tick_unit(), with
// the cost of the reading itself taken out. `insn` is exact; see port.cpp of the core's port.
// Never negative: 0 when `to` is not later than `from`. Cost: one 64-bit multiplication and division.
[[nodiscard]] std::uint64_t elapsed(Instant from, Instant to);

// "insn" (instructions retired, under QEMU with -icount), "cycles" (on silicon) or "ns" (steady clock of the host and
// of WebAssembly). An emulated target never says "cycles".
[[nodiscard]] std::string_view tick_unit();

// The name of the core's row in port/boards.txt, or "host".
[[nodiscard]] std::string_view core();

// Sends text to standard output, unbuffered. It needs a debugger or emulator that serves semihosting; without one a
// core stops at the first call. Text that is lost turns a later exit(0) into text_lost_status.
void write(std::string_view text);
inline void write(const char* text, std::size_t size) { write(std::string_view{text, size}); }
// Writes a hash as 16 hexadecimal digits and the end of the line.
inline void write_hash(std::uint64_t hash) {
    char line[17];
    for (int i = 0; i < 16; ++i) line[i] = "0123456789abcdef"[(hash >> (60 - 4 * i)) & 15];
    line[16] = '\n';
    write(line, sizeof line);
}

// Bytes of stack used at the deepest point since init(), counted from the top of the stack, the caller's frames
// included. It may hold one exception frame too much (32 bytes; 104 with an FPU) if the counter wrapped at that point,
// and is not less than what init() itself needs (up to 132 bytes). 0 where it is not measured (host, WebAssembly).
// Cost: one pass over the unused stack.
[[nodiscard]] std::size_t stack_peak();

// Ends the program with this status. Only the low 8 bits reach the shell; a non-zero status whose low 8 bits are zero
// becomes 255, so a failure never reads as success.
[[noreturn]] void exit(int status);

}  // namespace tumble::port
