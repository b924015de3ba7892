// Starts main and ends QEMU with its status, by semihosting's SYS_EXIT_EXTENDED; a fault ends it with 100.
#include <cstdint>

int main();
extern "C" {
extern std::uint32_t stack_top;
void reset();
void fault();
}

namespace {

[[noreturn]] void end(int status) {
    const std::uint32_t block[] = {0x20026, static_cast<std::uint32_t>(status)};  // ADP_Stopped_ApplicationExit
    register std::uint32_t operation asm("r0") = 0x20;
    register const std::uint32_t* argument asm("r1") = block;
    for (;;) asm volatile("bkpt 0xab" : "+r"(operation) : "r"(argument) : "memory");
}

}  // namespace

void reset() { end(main()); }
void fault() { end(100); }

[[gnu::section(".vectors"), gnu::used]] static const void* const vectors[] = {
    &stack_top, reinterpret_cast<const void*>(reset), reinterpret_cast<const void*>(fault),
    reinterpret_cast<const void*>(fault)};
