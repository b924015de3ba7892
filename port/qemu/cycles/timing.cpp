#include "timing.hpp"

#include <algorithm>
#include <array>

namespace cycles {

namespace {

// Cycles of a class on a core: for the instruction, and for each word that it transfers. Ranges are those of the
// manual, or of silicon where a rule says so. The estimate is for the operands of q32 code (README.md, long
// multiplications).
struct Cell {
    int min = 0, est = 0, max = 0, per_word = 0;
    bool known = false;

    constexpr Cell() = default;
    constexpr Cell(int cycles) : Cell{cycles, cycles, cycles} {}
    constexpr Cell(int least, int estimate, int most) : min{least}, est{estimate}, max{most}, known{true} {}
    [[nodiscard]] constexpr Cell a_word() const {
        Cell c = *this;
        c.per_word = 1;
        return c;
    }
};
constexpr Cell none{};
constexpr Cell one_and_a_word = Cell{1}.a_word();
// The neighbours decide the cost, see Timing::cost.
constexpr Cell paired = Cell{1};

struct Row {
    Class cls;
    Cell cell[model_count];
};

// Cortex-M0: DDI 0432C table 3-1. Cortex-M0+: DDI 0484C table 3-1. Cortex-M3: DDI 0337I table 3-1 and section 3.3.3.
// Cortex-M4: 100166 table 3-1; floating point: DDI 0439 table 7-1. Timing::taken has the cost of a taken branch on an
// M3 or M4 (P), and Timing::cost the rules of neighbours.
constexpr Row rows[] = {
    //                M0              M0+             M3              M4F
    {Class::alu, {1, 1, 1, 1}},
    {Class::mul, {1, 1, 1, 1}},
    {Class::mla, {none, none, 2, 1}},
    {Class::dsp, {none, none, none, 1}},
    {Class::mull, {none, none, {3, 5, 5}, 1}},
    {Class::mlal, {none, none, {3, 7, 7}, 1}},  // 4 to 7 in the manual; silicon takes 3 for two short operands
    {Class::div, {none, none, {2, 7, 12}, {2, 7, 12}}},
    {Class::ldr, {2, 2, paired, paired}},
    {Class::str, {2, 2, paired, paired}},
    {Class::ldrd, {none, none, one_and_a_word, one_and_a_word}},
    {Class::strd, {none, none, one_and_a_word, one_and_a_word}},
    {Class::ldm, {one_and_a_word, one_and_a_word, one_and_a_word, one_and_a_word}},
    {Class::stm, {one_and_a_word, one_and_a_word, one_and_a_word, one_and_a_word}},
    {Class::b, {3, 2, 1, 1}},
    {Class::bl, {4, 3, 1, 1}},
    {Class::bx, {3, 2, 1, 1}},
    {Class::blx, {3, 2, 1, 1}},
    {Class::cbz, {none, none, 1, 1}},
    {Class::tbb, {none, none, {2, 4, 5}, {2, 4, 5}}},  // with its branch at least 6 on silicon, which goes over that
    {Class::it, {none, none, paired, paired}},
    {Class::mrs, {4, 3, {1, 2, 2}, {1, 2, 2}}},
    {Class::barrier, {4, 3, {1, 1, 4}, {1, 1, 4}}},
    {Class::isb, {4, 3, {2, 4, 4}, {2, 4, 4}}},
    {Class::cps, {1, 1, {1, 2, 2}, {1, 2, 2}}},
    {Class::nop, {1, 1, 1, 1}},
    {Class::wait, {2, 2, 1, 1}},
    {Class::trap, {1, 1, 1, 1}},  // leaves the measured code: an exception's cycles are not the program's
    {Class::f_alu, {none, none, none, 1}},
    {Class::f_mla, {none, none, none, 3}},
    {Class::f_div, {none, none, none, 14}},
    {Class::f_mov, {none, none, none, 1}},
    {Class::f_mov2, {none, none, none, 2}},
    {Class::f_cmp, {none, none, none, 1}},
    {Class::f_ldr, {none, none, none, paired}},
    {Class::f_str, {none, none, none, paired}},
    {Class::f_ldm, {none, none, none, one_and_a_word}},
    {Class::f_stm, {none, none, none, one_and_a_word}},
    {Class::begin, {0, 0, 0, 0}},
    {Class::end, {0, 0, 0, 0}},
};

constexpr auto table = [] {
    std::array<std::array<Cell, class_count>, model_count> cells{};
    for (const Row& row : rows)
        for (std::size_t model = 0; model < model_count; ++model)
            cells[model][static_cast<std::size_t>(row.cls)] = row.cell[model];
    return cells;
}();

[[nodiscard]] const Cell& cell_of(Model model, Class cls) {
    return table[static_cast<std::size_t>(model)][static_cast<std::size_t>(cls)];
}

[[nodiscard]] bool is_single_load(Class c) { return c == Class::ldr || c == Class::f_ldr; }
[[nodiscard]] bool is_single_store(Class c) { return c == Class::str || c == Class::f_str; }
[[nodiscard]] bool is_core_transfer(Class c) { return c >= Class::ldr && c <= Class::stm; }
[[nodiscard]] bool is_fp_arithmetic(Class c) { return c == Class::f_alu || c == Class::f_mla || c == Class::f_div; }

// Loads and stores of one word on an M3 or M4 overlap with their neighbours (DDI 0337I 3.3.3; the store rules are
// silicon's, where the manual says "always one cycle").
[[nodiscard]] Cycles load_cost(const Instruction& d, const Instruction* before) {
    const bool behind_one = before == nullptr || is_single_load(before->cls) || is_single_store(before->cls);
    // A load is pipelined after a load, unless it waits for the loaded value. Nothing is pipelined after a store.
    const bool behind_load =
        before != nullptr && is_single_load(before->cls) && (before->writes & d.address_registers) == 0;
    if (d.words > 1) return {3, 3, 3};
    // A literal may compete with the fetch of instructions.
    return {behind_one ? 1 : 2, behind_load ? 1 : 2, 2 + (d.literal && d.cls == Class::ldr ? 1 : 0)};
}
[[nodiscard]] Cycles store_cost(const Instruction& d, const Instruction* before, const Instruction* after) {
    const bool behind_load =
        before != nullptr && is_single_load(before->cls) && (before->writes & d.address_registers) == 0;
    if (d.cls == Class::f_str) {
        if (d.words > 1) return {2, 3, 3};
        const bool holds_up = after != nullptr && (is_single_load(after->cls) || is_single_store(after->cls));
        return {1, holds_up ? 2 : 1, 2};
    }
    // The store is completed while the next instruction runs, unless that is a load. Reading three registers takes two
    // cycles.
    const bool holds_up =
        after != nullptr && (after->cls == Class::ldr || after->cls == Class::ldm || after->cls == Class::ldrd);
    return {1, !behind_load && (d.register_offset || holds_up) ? 2 : 1, 2};
}

}  // namespace

std::optional<Model> model_named(std::string_view name) {
    constexpr std::string_view names[] = {"m0", "m0+", "m3", "m4f"};
    const auto* found = std::find(std::begin(names), std::end(names), name);
    if (found == std::end(names)) return {};
    return static_cast<Model>(found - names);
}

std::string_view manual_of(Model model) {
    switch (model) {
    case Model::m0: return "Arm DDI 0432C";
    case Model::m0plus: return "Arm DDI 0484C";
    case Model::m3: return "Arm DDI 0337I";
    default: return "Arm 100166, DDI 0439";
    }
}

bool Timing::knows(const Instruction& d) const {
    if (!cell_of(model_, d.cls).known) return false;
    // The only 32-bit encodings of Armv6-M are BL, MSR, MRS and the barriers.
    return !is_v6m() || d.size == 2 || d.cls == Class::bl || d.cls == Class::mrs || d.cls == Class::barrier ||
           d.cls == Class::isb;
}

Cycles Timing::cost(const Instruction& d, const Instruction* before, const Instruction* after) const {
    const Cell& cell = cell_of(model_, d.cls);
    const int words = cell.per_word * d.words;
    Cycles c{cell.min + words, cell.est + words, cell.max + words};
    if (is_v6m()) {
        if (d.cls == Class::mul) c = {multiplier_, multiplier_, multiplier_};
        if (d.cls == Class::b && d.conditional) c = {1, 1, 1};  // taken() has the rest
        // POP with PC: 4 + N on an M0, 3 + N on an M0+, where N counts the PC.
        const int pop_pc = d.cls == Class::ldm && d.writes_pc ? (model_ == Model::m0 ? 3 : 2) : 0;
        return c += {pop_pc, pop_pc, pop_pc};
    }

    switch (d.cls) {
    case Class::ldr:
    case Class::f_ldr: c = load_cost(d, before); break;
    case Class::str:
    case Class::f_str: c = store_cost(d, before, after); break;
    case Class::it:  // folded into a 16-bit instruction before it
        c = {before == nullptr || before->size == 2 ? 0 : 1, before != nullptr && before->size == 2 ? 0 : 1, 1};
        break;
    default: break;
    }

    // An instruction that is skipped, because its condition does not hold, takes one cycle.
    if (d.conditional && !d.writes_pc) c.min = std::min(c.min, 1);
    if (before == nullptr) return c;
    // An address that the previous instruction computes is late by a cycle (DDI 0337I 3.3.3). The wait for an address
    // that it loads is in the load's own cost.
    if (is_core_transfer(d.cls) && before->cls != Class::ldr && (before->writes & d.address_registers) != 0)
        c += {0, 1, 1};
    // A floating-point result is ready a cycle later, and an addend is needed a cycle later (DDI 0439, 7).
    if (is_fp_arithmetic(before->cls)) {
        const bool needs = (before->fp_writes & d.fp_reads) != 0, adds = (before->fp_writes & d.fp_addend) != 0;
        const bool arithmetic = is_fp_arithmetic(d.cls) || d.cls == Class::f_cmp;
        if (needs) c += {arithmetic ? 1 : 0, 1, 1};
        else if (adds) c += {0, 0, 1};
    }
    return c;
}

// Integer instructions run beside VDIV and VSQRT, which take 13 cycles more than their issue.
int Timing::hidden_beside_division(std::span<const Instruction> following) const {
    constexpr int room = 13;
    Cycles beside;
    for (const Instruction& d : following) {
        if (d.cls >= Class::f_alu || beside.est >= room) break;
        beside += cost(d, nullptr, nullptr);
    }
    return std::min(beside.est, room);
}

std::vector<Cycles> Timing::costs(std::span<const Instruction> stretch) const {
    std::vector<Cycles> each;
    for (std::size_t i = 0; i < stretch.size(); ++i) {
        const Instruction* before = i > 0 ? &stretch[i - 1] : nullptr;
        const Instruction* after = i + 1 < stretch.size() ? &stretch[i + 1] : nullptr;
        each.push_back(cost(stretch[i], before, after));
        if (stretch[i].cls == Class::f_div) {
            const int hidden = hidden_beside_division(stretch.subspan(i + 1));
            each.back() += {-hidden, -hidden, 0};
        }
    }
    return each;
}

Cycles Timing::taken(const Instruction& branch, std::uint32_t target, int target_size) const {
    if (is_v6m()) {
        const int refill = branch.cls == Class::b && branch.conditional ? (model_ == Model::m0 ? 2 : 1) : 0;
        return {refill, refill, refill};
    }
    // P is 1 to 3. On silicon it is 1 if the instruction has the target, 2 if the target is in a register or memory,
    // and one more if a 32-bit target instruction straddles a word.
    const bool direct = branch.cls == Class::b || branch.cls == Class::bl || branch.cls == Class::cbz;
    const bool straddles = target_size == 4 && (target & 2) != 0;
    return {1, (direct ? 1 : 2) + (straddles ? 1 : 0), 3};
}

}  // namespace cycles
