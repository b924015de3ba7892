// Control and status registers of a hart in machine mode. Their instructions are an extension of their own, which the
// compiler's -march need not name.
#pragma once

#include <cstdint>

namespace tumble::port::csr {

// Numbers of the RISC-V privileged architecture 1.12, chapter 2.2.
inline constexpr int mstatus = 0x300, mtvec = 0x305, pmpcfg0 = 0x3A0, pmpaddr0 = 0x3B0;
inline constexpr int mcycle = 0xB00, minstret = 0xB02, high = 0x80;  // high: from a counter's lower half to its upper

template <int number>
[[gnu::always_inline]] inline std::uint32_t read() {
    std::uint32_t value;
    asm volatile(".option push\n.option arch, +zicsr\ncsrr %0, %1\n.option pop" : "=r"(value) : "i"(number) : "memory");
    return value;
}
template <int number>
[[gnu::always_inline]] inline void write(std::uint32_t value) {
    asm volatile(".option push\n.option arch, +zicsr\ncsrw %0, %1\n.option pop" : : "i"(number), "r"(value) : "memory");
}

}  // namespace tumble::port::csr
