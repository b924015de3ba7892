// Semihosting of RISC-V, whose requests are Arm's: the few that the port needs, served by QEMU or a debugger.
// On silicon with neither, the breakpoint traps.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tumble::port::semihosting {

enum class Request : std::uint32_t { open = 0x01, write = 0x05, exit_extended = 0x20 };

// `parameters` are the words of the request's parameter block; the answer's meaning depends on the request. The three
// instructions that mark a request are 4 bytes each and lie in one page.
template <std::size_t count>
inline std::uint32_t call(Request request, const std::uintptr_t (&parameters)[count]) {
    register std::uint32_t a0 asm("a0") = static_cast<std::uint32_t>(request);
    register const std::uintptr_t* a1 asm("a1") = parameters;
    asm volatile(".balign 16\n"
                 ".option push\n"
                 ".option norvc\n"
                 "slli zero, zero, 0x1f\n"
                 "ebreak\n"
                 "srai zero, zero, 7\n"
                 ".option pop\n"
                 : "+r"(a0)
                 : "r"(a1)
                 : "memory");
    return a0;
}

}  // namespace tumble::port::semihosting
