// The decoder: a table of encodings each for 16 and 32 bits; the first row that matches decides.
#include <bit>
#include <iterator>

#include "instruction.hpp"

namespace cycles {

namespace {

// Where an encoding keeps the registers that timing needs.
enum class Form : std::uint8_t {
    none,
    // 16 bits
    rd0,        // result in bits 2..0
    rd8,        // result in bits 10..8
    rd_high,    // result in bits 7, 2..0
    branch,     // writes the PC
    condition,  // writes the PC if its condition holds
    it,         //
    literal,    // Rt in bits 10..8
    rt_rn,      // Rt in bits 2..0, base in bits 5..3
    rt_rn_rm,   // and offset in bits 8..6
    rt_sp,      // Rt in bits 10..8, base SP
    add_sp,     // ADD SP, #imm7 * 4
    sub_sp,     //
    list_push,  // bits 8..0
    list_pop,   //
    list_rn,    // bits 7..0, base in bits 10..8
    // 32 bits
    rd,         // result in bits 11..8; 15: none
    rd_rn_imm,  // the same; a SUB from SP sets sp_decrement
    rt_rd,      // two results, in bits 15..12 and 11..8
    multiply,   // MUL where the addend is 15
    single,     // load or store of one word or less
    dual,       // two words, in bits 15..12 and 11..8
    exclusive,  //
    store_exclusive,
    table,         // TBB, TBH
    list,          // bits 15..0, base in bits 19..16
    link,          // BL
    f_single,      // VLDR, VSTR
    f_list,        // VLDM, VSTM
    f_pair,        // two words between core and FPU
    f_word,        // one word
    f_status,      // VMRS, VMSR
    f_three,       // Sd, Sn, Sm
    f_accumulate,  // Sd is the addend
    f_two,         // Sd, Sm
    f_one,         // Sd: immediate moves
    f_in_place,    // Sd to Sd: fixed-point conversions
    f_compare,     // Sd with Sm
    f_compare_0,   // Sd with zero
};

struct Encoding {
    std::uint32_t mask, value;
    Class cls;
    Form form;
};

// clang-format off
constexpr Encoding encodings_16[] = {
    {0xe000, 0x0000, Class::alu, Form::rd0},  // shifts, ADD, SUB
    {0xf800, 0x2800, Class::alu, Form::none},  // CMP #imm
    {0xe000, 0x2000, Class::alu, Form::rd8},
    {0xffc0, 0x4200, Class::alu, Form::none},  // TST
    {0xff80, 0x4280, Class::alu, Form::none},  // CMP, CMN
    {0xffc0, 0x4340, Class::mul, Form::rd0},
    {0xfc00, 0x4000, Class::alu, Form::rd0},
    {0xff00, 0x4500, Class::alu, Form::none},  // CMP of high registers
    {0xff87, 0x4487, Class::bx, Form::branch},  // ADD PC
    {0xff87, 0x4687, Class::bx, Form::branch},  // MOV PC
    {0xff80, 0x4700, Class::bx, Form::branch},
    {0xff80, 0x4780, Class::blx, Form::branch},
    {0xfc00, 0x4400, Class::alu, Form::rd_high},
    {0xf800, 0x4800, Class::ldr, Form::literal},
    {0xfe00, 0x5000, Class::str, Form::rt_rn_rm},
    {0xfe00, 0x5200, Class::str, Form::rt_rn_rm},
    {0xfe00, 0x5400, Class::str, Form::rt_rn_rm},
    {0xf000, 0x5000, Class::ldr, Form::rt_rn_rm},
    {0xf800, 0x6000, Class::str, Form::rt_rn},
    {0xf800, 0x6800, Class::ldr, Form::rt_rn},
    {0xf800, 0x7000, Class::str, Form::rt_rn},
    {0xf800, 0x7800, Class::ldr, Form::rt_rn},
    {0xf800, 0x8000, Class::str, Form::rt_rn},
    {0xf800, 0x8800, Class::ldr, Form::rt_rn},
    {0xf800, 0x9000, Class::str, Form::rt_sp},
    {0xf800, 0x9800, Class::ldr, Form::rt_sp},
    {0xf000, 0xa000, Class::alu, Form::rd8},  // ADR, ADD Rd, SP, #imm
    {0xff80, 0xb000, Class::alu, Form::add_sp},
    {0xff80, 0xb080, Class::alu, Form::sub_sp},
    {0xf500, 0xb100, Class::cbz, Form::condition},
    {0xff00, 0xb200, Class::alu, Form::rd0},  // extensions
    {0xfe00, 0xb400, Class::stm, Form::list_push},
    {0xffe8, 0xb660, Class::cps, Form::none},
    {0xffc0, 0xba80, Class::unknown, Form::none},
    {0xff00, 0xba00, Class::alu, Form::rd0},  // REV, REV16, REVSH
    {0xfe00, 0xbc00, Class::ldm, Form::list_pop},
    {0xff00, 0xbe00, Class::trap, Form::none},
    {0xffff, 0xbf20, Class::wait, Form::none},
    {0xffff, 0xbf30, Class::wait, Form::none},
    {0xffff, 0xbfe0, Class::begin, Form::none},
    {0xffff, 0xbff0, Class::end, Form::none},
    {0xff0f, 0xbf00, Class::nop, Form::none},
    {0xff00, 0xbf00, Class::it, Form::it},
    {0xf800, 0xc000, Class::stm, Form::list_rn},
    {0xf800, 0xc800, Class::ldm, Form::list_rn},
    {0xfe00, 0xde00, Class::trap, Form::none},  // UDF, SVC
    {0xf000, 0xd000, Class::b, Form::condition},
    {0xf800, 0xe000, Class::b, Form::branch},
};
// clang-format on

constexpr Encoding encodings_32[] = {
    // Load and store multiple, dual, exclusive, table branches.
    {0xffd00000, 0xe8800000, Class::stm, Form::list},
    {0xffd00000, 0xe8900000, Class::ldm, Form::list},
    {0xffd00000, 0xe9000000, Class::stm, Form::list},
    {0xffd00000, 0xe9100000, Class::ldm, Form::list},
    {0xfff00000, 0xe8400000, Class::str, Form::store_exclusive},
    {0xfff00000, 0xe8500000, Class::ldr, Form::exclusive},
    {0xfff000e0, 0xe8c00040, Class::str, Form::store_exclusive},  // byte, halfword
    {0xfff000e0, 0xe8d00040, Class::ldr, Form::exclusive},
    {0xfff000e0, 0xe8d00000, Class::tbb, Form::table},
    {0xff700000, 0xe8600000, Class::strd, Form::dual},  // post-indexed
    {0xff700000, 0xe8700000, Class::ldrd, Form::dual},
    {0xff500000, 0xe9400000, Class::strd, Form::dual},  // offset, pre-indexed
    {0xff500000, 0xe9500000, Class::ldrd, Form::dual},
    // Data processing.
    {0xfe000000, 0xea000000, Class::alu, Form::rd},         // shifted register
    {0xfa008000, 0xf0000000, Class::alu, Form::rd_rn_imm},  // modified immediate
    {0xfa008000, 0xf2000000, Class::alu, Form::rd_rn_imm},  // plain immediate, bit fields, saturation
    {0xff000000, 0xfa000000, Class::alu, Form::rd},         // register: shifts, extensions, CLZ, REV, parallel
    // Multiplication and division.
    {0xfff000f0, 0xfb000000, Class::mla, Form::multiply},
    {0xfff000f0, 0xfb000010, Class::mla, Form::rd},  // MLS
    {0xff800000, 0xfb000000, Class::dsp, Form::rd},
    {0xffd000f0, 0xfb800000, Class::mull, Form::rt_rd},
    {0xffd000f0, 0xfb9000f0, Class::div, Form::rd},
    {0xffd000f0, 0xfbc00000, Class::mlal, Form::rt_rd},
    {0xfff000f0, 0xfbe00060, Class::mlal, Form::rt_rd},  // UMAAL
    {0xfff000c0, 0xfbc00080, Class::mlal, Form::rt_rd},  // SMLALxy
    {0xfff000e0, 0xfbc000c0, Class::mlal, Form::rt_rd},  // SMLALD
    {0xfff000e0, 0xfbd000c0, Class::mlal, Form::rt_rd},  // SMLSLD
    // Branches and control.
    {0xf800d000, 0xf000d000, Class::bl, Form::link},
    {0xf800d000, 0xf0009000, Class::b, Form::branch},
    {0xffe0d000, 0xf3808000, Class::mrs, Form::none},  // MSR
    {0xffe0d000, 0xf3e08000, Class::mrs, Form::rd},
    {0xfffff700, 0xf3af8000, Class::nop, Form::none},  // hints
    {0xffffd0f0, 0xf3bf8060, Class::isb, Form::none},
    {0xffffd0f0, 0xf3bf8040, Class::barrier, Form::none},
    {0xffffd0f0, 0xf3bf8050, Class::barrier, Form::none},
    {0xffffd0f0, 0xf3bf8020, Class::nop, Form::none},  // CLREX
    {0xfb80d000, 0xf3808000, Class::unknown, Form::none},
    {0xf800d000, 0xf0008000, Class::b, Form::condition},
    // Load and store single. A load of a byte or halfword to the PC is a preload.
    {0xff70f000, 0xf810f000, Class::nop, Form::none},
    {0xff70f000, 0xf830f000, Class::nop, Form::none},
    {0xff70f000, 0xf910f000, Class::nop, Form::none},
    {0xff700000, 0xf8000000, Class::str, Form::single},
    {0xff700000, 0xf8200000, Class::str, Form::single},
    {0xff700000, 0xf8400000, Class::str, Form::single},
    {0xff700000, 0xf8100000, Class::ldr, Form::single},
    {0xff700000, 0xf8300000, Class::ldr, Form::single},
    {0xff700000, 0xf8500000, Class::ldr, Form::single},
    {0xff700000, 0xf9100000, Class::ldr, Form::single},
    {0xff700000, 0xf9300000, Class::ldr, Form::single},
    // Floating point: single precision, and the moves of doubles. Arithmetic of doubles (bit 8) is in no table.
    {0xffe00e00, 0xec400a00, Class::f_mov2, Form::f_pair},
    {0xff300f00, 0xed000a00, Class::f_str, Form::f_single},
    {0xff300f00, 0xed000b00, Class::f_str, Form::f_single},
    {0xff300f00, 0xed100a00, Class::f_ldr, Form::f_single},
    {0xff300f00, 0xed100b00, Class::f_ldr, Form::f_single},
    {0xfe100e00, 0xec000a00, Class::f_stm, Form::f_list},
    {0xfe100e00, 0xec100a00, Class::f_ldm, Form::f_list},
    {0xffe00f10, 0xeee00a10, Class::f_mov, Form::f_status},
    {0xff000e10, 0xee000a10, Class::f_mov, Form::f_word},
    {0xffb00f10, 0xee000a00, Class::f_mla, Form::f_accumulate},  // VMLA, VMLS
    {0xffb00f10, 0xee100a00, Class::f_mla, Form::f_accumulate},  // VNMLA, VNMLS
    {0xffb00f10, 0xee200a00, Class::f_alu, Form::f_three},       // VMUL, VNMUL
    {0xffb00f10, 0xee300a00, Class::f_alu, Form::f_three},       // VADD, VSUB
    {0xffb00f10, 0xee800a00, Class::f_div, Form::f_three},       // VDIV
    {0xffb00f10, 0xee900a00, Class::f_mla, Form::f_accumulate},  // VFNMA, VFNMS
    {0xffb00f10, 0xeea00a00, Class::f_mla, Form::f_accumulate},  // VFMA, VFMS
    {0xffb00f50, 0xeeb00a00, Class::f_mov, Form::f_one},         // VMOV #imm
    {0xffbf0fd0, 0xeeb10ac0, Class::f_div, Form::f_two},         // VSQRT
    {0xffbe0f50, 0xeeb00a40, Class::f_mov, Form::f_two},         // VMOV, VABS, VNEG
    {0xffbf0f50, 0xeeb40a40, Class::f_cmp, Form::f_compare},
    {0xffbf0f50, 0xeeb50a40, Class::f_cmp, Form::f_compare_0},
    {0xffbe0f50, 0xeeb20a40, Class::f_alu, Form::f_two},       // VCVTB, VCVTT
    {0xffbf0f50, 0xeeb80a40, Class::f_alu, Form::f_two},       // from integers
    {0xffbe0f50, 0xeebc0a40, Class::f_alu, Form::f_two},       // to integers
    {0xffba0f50, 0xeeba0a40, Class::f_alu, Form::f_in_place},  // from and to fixed point
};

[[nodiscard]] constexpr std::uint16_t bit(std::uint32_t register_number) {
    return static_cast<std::uint16_t>(1u << register_number);
}

// Immediate of SUB SP, SP, #imm in its two forms; 0 for anything else.
[[nodiscard]] std::int32_t decrement_of_sp(std::uint32_t op) {
    const std::uint32_t imm8 = op & 0xff, imm3 = op >> 12 & 7, i = op >> 26 & 1;
    if ((op & 0xfbef8f00) == 0xf1ad0d00) {  // SUB{S}.W SP, SP, #modified
        const std::uint32_t rotation = i << 4 | imm3 << 1 | imm8 >> 7;
        if (rotation >= 8)
            return static_cast<std::int32_t>(std::rotr(0x80 | (imm8 & 0x7f), static_cast<int>(rotation)));
        return imm3 == 0 ? static_cast<std::int32_t>(imm8) : 0;  // repeated bytes are no stack frame
    }
    if ((op & 0xfbff8f00) == 0xf2ad0d00) return static_cast<std::int32_t>(i << 11 | imm3 << 8 | imm8);  // SUBW
    return 0;
}

void read_core_operands(Instruction& d, Form form) {
    const std::uint32_t op = d.opcode;
    const std::uint32_t rn = op >> 16 & 15, rt = op >> 12 & 15, rd = op >> 8 & 15, rm = op & 15;
    const std::uint16_t low0 = bit(op & 7), low3 = bit(op >> 3 & 7), low6 = bit(op >> 6 & 7), low8 = bit(op >> 8 & 7);
    const bool load = d.loads();
    const auto written_rd = rd == 15 ? std::uint16_t{0} : bit(rd);
    constexpr std::uint16_t sp = 1 << 13, all_but_pc = 0x7fff;
    const auto transfer = [&](std::uint16_t data, std::uint16_t address) {
        if (load) d.writes |= data;
        d.address_registers = address;
    };
    switch (form) {
    case Form::rd0: d.writes = low0; break;
    case Form::rd8: d.writes = low8; break;
    case Form::rd_high: d.writes = bit((op & 7) | (op >> 4 & 8)); break;
    case Form::branch: d.writes_pc = true; break;
    case Form::condition: d.writes_pc = d.conditional = true; break;
    case Form::it: d.it_length = static_cast<std::uint8_t>(4 - std::countr_zero(op & 15)); break;
    case Form::literal:
        d.literal = true;
        d.writes = low8;
        break;
    case Form::rt_rn: transfer(low0, low3); break;
    case Form::rt_rn_rm:
        transfer(low0, low3 | low6);
        d.register_offset = true;
        break;
    case Form::rt_sp:
        transfer(low8, sp);
        d.stack_pointer = true;
        break;
    case Form::add_sp:
    case Form::sub_sp: {
        const auto bytes = static_cast<std::int32_t>(4 * (op & 0x7f));
        d.writes = sp;
        d.sp_decrement = form == Form::sub_sp ? bytes : -bytes;
        break;
    }
    // PUSH writes SP early, so that a POP after it does not wait (silicon). `writes` therefore does not have SP.
    case Form::list_push:
        d.words = static_cast<std::uint8_t>(std::popcount(op & 0x1ff));
        d.address_registers = sp;
        d.stack_pointer = true;
        break;
    case Form::list_pop:
        d.words = static_cast<std::uint8_t>(std::popcount(op & 0x1ff));
        transfer(static_cast<std::uint16_t>(op & 0xff), sp);
        d.writes |= sp;
        d.stack_pointer = true;
        d.writes_pc = (op & 0x100) != 0;
        break;
    case Form::list_rn:
        d.words = static_cast<std::uint8_t>(std::popcount(op & 0xff));
        transfer(static_cast<std::uint16_t>(op & 0xff), low8);
        d.writes |= low8;
        break;
    case Form::rd: d.writes = written_rd; break;
    case Form::rd_rn_imm:
        d.writes = written_rd;
        d.sp_decrement = decrement_of_sp(op);
        break;
    case Form::rt_rd: d.writes = bit(rt) | bit(rd); break;
    case Form::multiply:
        if (rt == 15) d.cls = Class::mul;
        d.writes = bit(rd);
        break;
    case Form::single: {
        const bool immediate_12 = (op & 0x00800000) != 0;
        d.literal = load && rn == 15;
        transfer(bit(rt), d.literal ? std::uint16_t{0} : bit(rn));
        d.writes &= all_but_pc;
        d.writes_pc = load && rt == 15;
        d.stack_pointer = rn == 13;
        if (!d.literal && !immediate_12) {
            d.register_offset = (op & 0x800) == 0;
            if (d.register_offset) d.address_registers |= bit(rm);
            else if ((op & 0x100) != 0) d.writes |= bit(rn);
        }
        break;
    }
    case Form::dual:
        d.words = 2;
        d.literal = rn == 15;
        transfer(bit(rt) | bit(rd), bit(rn));
        if ((op & 0x00200000) != 0) d.writes |= bit(rn);
        d.stack_pointer = rn == 13;
        break;
    case Form::exclusive: transfer(bit(rt), bit(rn)); break;
    case Form::store_exclusive:  // the status register is rd, or rm of the short forms
        d.writes = (op & 0x00800000) != 0 ? bit(rm) : bit(rd);
        d.address_registers = bit(rn);
        break;
    case Form::table:
        d.writes_pc = true;
        d.address_registers = bit(rn) | bit(rm);
        break;
    case Form::list:
        d.words = static_cast<std::uint8_t>(std::popcount(op & 0xffff));
        transfer(static_cast<std::uint16_t>(op & all_but_pc), bit(rn));
        // Of PUSH as above, in 32 bits.
        if ((op & 0x00200000) != 0 && (load || rn != 13)) d.writes |= bit(rn);
        d.stack_pointer = rn == 13;
        d.writes_pc = load && (op & 0x8000) != 0;
        break;
    case Form::link:
        d.writes_pc = true;
        d.writes = 1 << 14;
        break;
    default: break;
    }
}

// A register of the FPU as the singles that it is made of.
struct FpRegister {
    std::uint32_t singles;
    FpRegister(std::uint32_t field, std::uint32_t low_bit, bool is_double)
        : singles{is_double ? 3u << (2 * field) : 1u << (field << 1 | low_bit)} {}
};

void read_fp_operands(Instruction& d, Form form) {
    const std::uint32_t op = d.opcode;
    const bool is_double = (op & 0x100) != 0, load = d.loads();
    const std::uint32_t rn = op >> 16 & 15, rt = op >> 12 & 15, first = rt << 1 | (op >> 22 & 1);
    const std::uint32_t vd = FpRegister{rt, op >> 22 & 1, is_double}.singles;
    const std::uint32_t vn = FpRegister{rn, op >> 7 & 1, is_double}.singles;
    const std::uint32_t vm = FpRegister{op & 15, op >> 5 & 1, is_double}.singles;
    const auto transfer = [&](std::uint32_t singles) { (load ? d.fp_writes : d.fp_reads) = singles; };
    const bool to_core = (op & 0x00100000) != 0;
    switch (form) {
    case Form::f_single:
        d.words = is_double ? 2 : 1;
        d.literal = rn == 15;
        d.stack_pointer = rn == 13;
        d.address_registers = bit(rn);
        transfer(vd);
        break;
    case Form::f_list: {
        const std::uint32_t words = op & 0xff, from = is_double ? 2 * rt : first;
        d.words = static_cast<std::uint8_t>(words);
        d.stack_pointer = rn == 13;
        d.address_registers = bit(rn);
        if ((op & 0x00200000) != 0) d.writes = bit(rn);
        transfer((words >= 32 ? ~0u : (1u << words) - 1) << from);
        break;
    }
    case Form::f_pair: {
        const std::uint32_t pair = is_double ? vm : 3u << ((op & 15) << 1 | (op >> 5 & 1));
        (to_core ? d.fp_reads : d.fp_writes) = pair;
        if (to_core) d.writes = bit(rt) | bit(rn);
        break;
    }
    case Form::f_word:
        (to_core ? d.fp_reads : d.fp_writes) = vn;
        if (to_core) d.writes = bit(rt);
        break;
    case Form::f_status:
        if (to_core && rt != 15) d.writes = bit(rt);
        break;
    case Form::f_three:
        d.fp_writes = vd;
        d.fp_reads = vn | vm;
        break;
    case Form::f_accumulate:
        d.fp_writes = d.fp_addend = vd;
        d.fp_reads = vn | vm;
        break;
    case Form::f_two:
        d.fp_writes = vd;
        d.fp_reads = vm;
        break;
    case Form::f_one: d.fp_writes = vd; break;
    case Form::f_in_place: d.fp_writes = d.fp_reads = vd; break;
    case Form::f_compare: d.fp_reads = vd | vm; break;
    case Form::f_compare_0: d.fp_reads = vd; break;
    default: break;
    }
}

}  // namespace

Instruction decode(std::uint32_t address, std::uint16_t first, std::uint16_t second) {
    Instruction d;
    d.address = address;
    d.size = static_cast<std::uint8_t>(size_of(first));
    d.opcode = d.size == 4 ? std::uint32_t{first} << 16 | second : first;
    const Encoding* row = d.size == 4 ? std::begin(encodings_32) : std::begin(encodings_16);
    const Encoding* const end = d.size == 4 ? std::end(encodings_32) : std::end(encodings_16);
    for (; row != end; ++row) {
        if ((d.opcode & row->mask) != row->value) continue;
        d.cls = row->cls;
        if (row->form >= Form::f_single) read_fp_operands(d, row->form);
        else read_core_operands(d, row->form);
        break;
    }
    return d;
}

const char* name_of(Class cls) {
    static constexpr const char* names[] = {"alu",   "mul",   "mla",   "dsp",   "mull",  "mlal",    "div",   "ldr",
                                            "str",   "ldrd",  "strd",  "ldm",   "stm",   "b",       "bl",    "bx",
                                            "blx",   "cbz",   "tbb",   "it",    "mrs",   "barrier", "isb",   "cps",
                                            "nop",   "wait",  "trap",  "f_alu", "f_mla", "f_div",   "f_mov", "f_mov2",
                                            "f_cmp", "f_ldr", "f_str", "f_ldm", "f_stm", "begin",   "end",   "unknown"};
    static_assert(std::size(names) == class_count);
    return names[static_cast<int>(cls)];
}

}  // namespace cycles
