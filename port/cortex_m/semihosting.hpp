// Arm semihosting for M-profile: the few requests the port needs, served by QEMU or a debugger.
// On silicon with neither, the breakpoint becomes a HardFault.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tumble::port::semihosting {

enum class Request : std::uint32_t { open = 0x01, write = 0x05, exit_extended = 0x20 };

// `parameters` are the words of the request's parameter block; the answer's meaning depends on the request.
template <std::size_t count>
inline std::uint32_t call(Request request, const std::uintptr_t (&parameters)[count]) {
    register std::uint32_t r0 asm("r0") = static_cast<std::uint32_t>(request);
    register const std::uintptr_t* r1 asm("r1") = parameters;
    asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

}  // namespace tumble::port::semihosting
