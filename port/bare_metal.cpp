// The part of the port that all cores without an operating system share: console and exit by semihosting, and the
// painted stack.
#include "bare_metal.hpp"

#include "semihosting.hpp"

namespace tumble::port {

namespace {
bool text_lost = false;
}

// ":tt" opened for writing is the standard output of the debugger or of QEMU.
void write(std::string_view text) {
    using semihosting::Request;
    constexpr std::uintptr_t mode_write = 4;
    static const std::uint32_t handle =
        semihosting::call(Request::open, {reinterpret_cast<std::uintptr_t>(":tt"), mode_write, 3});
    if (semihosting::call(Request::write, {handle, reinterpret_cast<std::uintptr_t>(text.data()), text.size()}) != 0)
        text_lost = true;
}

void write_hex(std::uint32_t value) {
    char text[] = "0x00000000";
    for (int i = 0; i < 8; ++i) text[9 - i] = "0123456789abcdef"[(value >> (4 * i)) & 15];
    write({text, 10});
}

std::size_t stack_peak() {
    const volatile std::uint32_t* word = __stack_limit;
    while (word < __stack_top && *word == paint) word = word + 1;
    return static_cast<std::size_t>(__stack_top - const_cast<const std::uint32_t*>(word)) * sizeof(std::uint32_t);
}

void exit(int status) {
    constexpr std::uintptr_t application_exit = 0x20026;  // ADP_Stopped_ApplicationExit
    if (status == 0 && text_lost) status = text_lost_status;
    if (status != 0 && (status & 0xFF) == 0) status = 255;
    for (;;)
        semihosting::call(semihosting::Request::exit_extended, {application_exit, static_cast<std::uintptr_t>(status)});
}

}  // namespace tumble::port
