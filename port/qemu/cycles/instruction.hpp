// Thumb and Thumb-2 instructions of Armv6-M and Armv7E-M, as far as their timing needs: a class, and the registers that
// make one instruction wait for another. Encodings: Armv7-M Architecture Reference Manual (DDI 0403), chapter A5.
#pragma once

#include <cstdint>

namespace cycles {

enum class Class : std::uint8_t {
    alu,      // data processing, moves, shifts, extensions, bit fields
    mul,      // 32 x 32 -> 32
    mla,      // with accumulation: MLA, MLS
    dsp,      // 16-bit and most-significant-word multiplications of the DSP extension
    mull,     // SMULL, UMULL
    mlal,     // SMLAL, UMLAL, UMAAL and the DSP extension's long accumulations
    div,      // SDIV, UDIV
    ldr,      // one word or less
    str,      //
    ldrd,     // two words
    strd,     //
    ldm,      // `words` words: LDM, POP
    stm,      // STM, PUSH
    b,        // B, with a condition or without
    bl,       //
    bx,       // BX, MOV PC, ADD PC
    blx,      //
    cbz,      // CBZ, CBNZ
    tbb,      // TBB, TBH
    it,       //
    mrs,      // MRS, MSR
    barrier,  // DMB, DSB
    isb,      //
    cps,      //
    nop,      // NOP and the hints that do nothing
    wait,     // WFE, WFI
    trap,     // SVC, BKPT, UDF
    f_alu,    // floating-point sums, products, comparisons with a result, conversions
    f_mla,    // VMLA, VFMA and their kin
    f_div,    // VDIV, VSQRT
    f_mov,    // between registers of the FPU, or one word to and from the core; VABS, VNEG
    f_mov2,   // two words to and from the core
    f_cmp,    // VCMP
    f_ldr,    // VLDR: `words` is 1 or 2
    f_str,    //
    f_ldm,    // VLDM, VPOP
    f_stm,    // VSTM, VPUSH
    begin,    // hint 14: a counted stretch begins behind it
    end,      // hint 15: a counted stretch ends before it
    unknown,  // not in these tables: makes a measurement invalid
};
inline constexpr int class_count = static_cast<int>(Class::unknown) + 1;

// Its name in reports, as "mull".
[[nodiscard]] const char* name_of(Class);

struct Instruction {
    std::uint32_t address = 0;
    std::uint32_t opcode = 0;  // 32-bit encodings: the first halfword in the upper half
    Class cls = Class::unknown;
    std::uint8_t size = 2;          // bytes
    std::uint8_t words = 1;         // transferred by a load or store
    bool writes_pc = false;         //
    bool conditional = false;       // a conditional branch, or in an IT block
    bool register_offset = false;   // [Rn, Rm]
    bool literal = false;           // [PC, #imm]
    bool stack_pointer = false;     // addressed by SP
    std::int32_t sp_decrement = 0;  // bytes that ADD/SUB SP, #imm takes off the stack pointer

    // A bit a register.
    std::uint16_t writes = 0;             // results of data processing and loads, and base registers written back
    std::uint16_t address_registers = 0;  // what an address is made of
    std::uint32_t fp_writes = 0;          // single-precision registers S0 to S31
    std::uint32_t fp_reads = 0;           // but for
    std::uint32_t fp_addend = 0;          // the addend of a multiply-accumulate, which is needed later
    std::uint8_t it_length = 0;           // of IT: conditional instructions that follow

    [[nodiscard]] bool loads() const {
        return cls == Class::ldr || cls == Class::ldrd || cls == Class::ldm || cls == Class::f_ldr ||
               cls == Class::f_ldm || cls == Class::tbb;
    }
    [[nodiscard]] bool stores() const {
        return cls == Class::str || cls == Class::strd || cls == Class::stm || cls == Class::f_str ||
               cls == Class::f_stm;
    }
};

// The instruction whose first halfword is `first`; `second` is read only where the encoding has 32 bits.
[[nodiscard]] Instruction decode(std::uint32_t address, std::uint16_t first, std::uint16_t second);

// 2 or 4 bytes, from the first halfword alone.
[[nodiscard]] constexpr int size_of(std::uint16_t first) { return first >> 11 >= 0x1d ? 4 : 2; }

}  // namespace cycles
