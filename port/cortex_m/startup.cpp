// From reset to main, and from a fault to a non-zero exit status.
// Division by zero stops on every core: by the trap of ARMv7-M, by __aeabi_idiv0 (runtime.cpp) on a Cortex-M0.
#include "bare_metal.hpp"

extern "C" {
void systick_handler();

[[noreturn]] void reset_handler() {
#if __ARM_ARCH >= 7
    auto* const configuration = reinterpret_cast<volatile std::uint32_t*>(0xE000ED14);
    auto* const system_handlers = reinterpret_cast<volatile std::uint32_t*>(0xE000ED24);
    *configuration = *configuration | (1U << 4);       // DIV_0_TRP
    *system_handlers = *system_handlers | (7U << 16);  // own exceptions for memory, bus and usage faults

#if __ARM_ARCH == 7
    // No access to the 32 KiB below the RAM, which some machines read as zero: a stack overflow must fault at once.
    auto* const mpu = reinterpret_cast<volatile std::uint32_t*>(0xE000ED90);
    mpu[3] = (reinterpret_cast<std::uint32_t>(__stack_limit) - 0x8000) | (1U << 4);  // base address, region 0
    mpu[4] = (14U << 1) | 1U;                                                        // 2^15 bytes, no access
    mpu[1] = 5;                                                                      // all else as without an MPU
#else
    asm volatile("msr msplim, %0" : : "r"(__stack_limit));  // ARMv8-M has a stack limit of its own
#endif
#endif
#ifdef __ARM_FP
    auto* const coprocessor_access = reinterpret_cast<volatile std::uint32_t*>(0xE000ED88);
    *coprocessor_access = *coprocessor_access | (0xFU << 20);  // CP10, CP11
#endif
    asm volatile("dsb\n isb" ::: "memory");
    tumble::port::run_program();
}

[[noreturn, gnu::used]] void report_fault(const std::uint32_t* frame, std::uint32_t exception) {
    using tumble::port::write;
    using tumble::port::write_hex;
    const auto name = [exception]() -> std::string_view {
        switch (exception) {
        case 2: return "NMI";
        case 3: return "HardFault";
        case 4: return "MemManage";
        case 5: return "BusFault";
        case 6: return "UsageFault";
        default: return "unexpected exception";
        }
    }();
    write("fault: ");
    write(name);
    constexpr int pc = 6;  // word of the exception frame
#if __ARM_ARCH >= 7
    const std::uint32_t cfsr = *reinterpret_cast<volatile std::uint32_t*>(0xE000ED28);
    const bool past_limit = (cfsr & (1U << 20)) != 0;  // STKOF, ARMv8-M only
#else
    constexpr bool past_limit = false;
#endif
    if (frame < __stack_limit || past_limit) write(", stack overflow");
    else if (frame + pc < __stack_top) {
        write(" at pc ");
        write_hex(frame[pc]);
    }
#if __ARM_ARCH >= 7
    write(", CFSR ");
    write_hex(cfsr);
    write(", BFAR ");
    write_hex(*reinterpret_cast<volatile std::uint32_t*>(0xE000ED38));
#endif
    write("\n");
    tumble::port::exit(128 + static_cast<int>(exception));
}

// The stack may have overflowed, so the report runs on its far end, which nothing but an overflow has used.
[[gnu::naked]] void fault_handler() {
    asm("mov r0, sp\n"
        "mrs r1, ipsr\n"
        "ldr r2, =__stack_limit + 512\n"
        "mov sp, r2\n"
        "bl report_fault\n"
        ".ltorg\n");
}
}

namespace {

struct VectorTable {
    std::uint32_t* stack_top;
    void (*reset)();
    void (*handlers[14])();  // exceptions 2 to 15; no external interrupt is ever enabled
};

[[gnu::section(".vectors"), gnu::used]] const VectorTable vectors = {
    __stack_top,
    reset_handler,
    {fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler,
     fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, systick_handler},
};

}  // namespace
