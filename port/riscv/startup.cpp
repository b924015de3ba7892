// From reset to main, and from a trap to a non-zero exit status. RISC-V divides by zero without a trap.
#include <iterator>

#include "bare_metal.hpp"
#include "csr.hpp"

extern "C" {

[[gnu::naked, gnu::aligned(4)]] void trap_handler();

[[noreturn, gnu::used]] void start() {
    using namespace tumble::port;
    csr::write<csr::mtvec>(reinterpret_cast<std::uint32_t>(&trap_handler));
#ifdef __riscv_flen
    csr::write<csr::mstatus>(csr::read<csr::mstatus>() | (1U << 13));  // FS: initial
#endif
    run_program();
}

// At the lowest address of the flash. No access to the 32 KiB below the RAM, whatever memory the machine has there: a
// stack overflow must fault at once. A hart without memory protection traps there, and goes on behind it.
[[gnu::naked, gnu::used, gnu::section(".vectors")]] void reset_handler() {
    asm(".option push\n"
        ".option arch, +zicsr\n"
        ".option norelax\n"
        "la gp, __global_pointer$\n"
        "la sp, __stack_top\n"
        "la t0, 1f\n"
        "csrw mtvec, t0\n"
        "la t0, __stack_limit - 0x8000\n"
        "srli t0, t0, 2\n"
        "li t1, 0xFFF\n"  // a naturally aligned power of two: 2^(3 + 12) bytes
        "or t0, t0, t1\n"
        "csrw pmpaddr0, t0\n"
        "li t0, 0x98\n"  // locked, so for machine mode too; NAPOT; no access
        "csrw pmpcfg0, t0\n"
        ".balign 4\n"
        "1: j start\n"
        ".option pop\n");
}

[[noreturn, gnu::used]] void report_trap(std::uint32_t cause, std::uint32_t pc, std::uint32_t address,
                                         const std::uint32_t* stack_pointer) {
    using tumble::port::write;
    using tumble::port::write_hex;
    static constexpr std::string_view names[] = {
        "instruction address misaligned", "instruction access fault", "illegal instruction",      "breakpoint",
        "load address misaligned",        "load access fault",        "store address misaligned", "store access fault"};
    write("fault: ");
    write(cause < std::size(names) ? names[cause] : "unexpected trap");
    if (stack_pointer < __stack_limit) write(", stack overflow");
    write(" at pc ");
    write_hex(pc);
    write(", mtval ");
    write_hex(address);
    write("\n");
    tumble::port::exit(128 + static_cast<int>(cause & 0x7F));
}

// The stack may have overflowed, so the report runs on its far end, which nothing but an overflow has used.
[[gnu::naked, gnu::aligned(4)]] void trap_handler() {
    asm(".option push\n"
        ".option arch, +zicsr\n"
        "mv a3, sp\n"
        "la sp, __stack_limit + 512\n"
        "csrr a0, mcause\n"
        "csrr a1, mepc\n"
        "csrr a2, mtval\n"
        ".option pop\n"
        "j report_trap\n");
}
}
