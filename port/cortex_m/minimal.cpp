// From reset to main with the least code: no console, no counter, no report of a fault. A fault stops the core. An
// emulator or a debugger gets the status of main by semihosting; on silicon alone, main must not return.
#include "port.hpp"
#include "semihosting.hpp"

namespace tumble::port {

// The runtime stops the core where it would print why.
void write(std::string_view) {}
[[noreturn]] void exit(int) {
    for (;;) {}
}

}  // namespace tumble::port

extern "C" {
extern std::uint32_t __stack_top[], __data_start[], __data_end[], __bss_start[], __bss_end[];
extern const std::uint32_t __data_load[];
extern void (*const __init_array_start[])();
extern void (*const __init_array_end[])();
int main();

[[noreturn]] void reset_handler() {
#ifdef __ARM_FP
    auto* const coprocessor_access = reinterpret_cast<volatile std::uint32_t*>(0xE000ED88);
    *coprocessor_access = *coprocessor_access | (0xFU << 20);  // CP10, CP11
    asm volatile("dsb\n isb" ::: "memory");
#endif
    const std::uint32_t* from = __data_load;
    for (std::uint32_t* to = __data_start; to != __data_end;) *to++ = *from++;
    for (std::uint32_t* to = __bss_start; to != __bss_end;) *to++ = 0;
    for (auto* start = __init_array_start; start != __init_array_end;) (*start++)();
    const std::uintptr_t status[] = {0x20026, static_cast<std::uintptr_t>(main())};  // ADP_Stopped_ApplicationExit
    tumble::port::semihosting::call(tumble::port::semihosting::Request::exit_extended, status);
    for (;;) {}
}
[[noreturn]] void stop() {
    for (;;) {}
}
}

namespace {

struct VectorTable {
    std::uint32_t* stack_top;
    void (*reset)();
    void (*handlers[14])();  // exceptions 2 to 15
};

[[gnu::section(".vectors"), gnu::used]] const VectorTable vectors = {
    __stack_top, reset_handler, {stop, stop, stop, stop, stop, stop, stop, stop, stop, stop, stop, stop, stop, stop}};

}  // namespace
