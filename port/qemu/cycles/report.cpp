#include "report.hpp"

#include <algorithm>
#include <cstdio>
#include <iomanip>
#include <map>
#include <string>

namespace cycles {

namespace {

struct Branch {
    std::uint64_t taken = 0, not_taken = 0;
    int symbol = -1;
};

// One branch may end several blocks.
[[nodiscard]] std::map<std::uint32_t, Branch> branches_of(const Counter& counter) {
    std::map<std::uint32_t, Branch> branches;
    for (const Block& b : counter.blocks()) {
        if (b.runs == 0 || !b.is_conditional()) continue;
        Branch& branch = branches[b.last.address];
        branch.taken += b.taken;
        branch.not_taken += b.runs - b.taken;
        branch.symbol = b.symbol;
    }
    return branches;
}

[[nodiscard]] const char* name_of_symbol(const Symbols& symbols, int index) {
    return index < 0 ? "?" : symbols[index].name.c_str();
}

[[nodiscard]] std::string hex(std::uint32_t value) {
    char text[9];
    std::snprintf(text, sizeof text, "%08x", static_cast<unsigned>(value));
    return text;
}

void fold(std::ostream& out, const Node& node, const std::string& path, const Symbols& symbols) {
    for (const auto& child : node.children) {
        const std::string here = (path.empty() ? "" : path + ";") + name_of_symbol(symbols, child->symbol);
        if (child->own.est != 0) out << here << ' ' << child->own.est << '\n';
        fold(out, *child, here, symbols);
    }
}

void write_places_below(std::ostream& out, const Node& node, const std::string& path, const Symbols& symbols) {
    for (const auto& child : node.children) {
        const std::string here = (path.empty() ? "" : path + ";") + name_of_symbol(symbols, child->symbol);
        std::map<std::uint32_t, std::uint64_t> cycles;
        for (const auto& [block, place] : child->places) {
            for (std::size_t i = 0; i < block->est.size(); ++i)
                cycles[block->address[i]] += static_cast<std::uint64_t>(block->est[i]) * place.runs;
            cycles[block->last.address] += place.branches;
        }
        for (const auto& [address, est] : cycles)
            if (est != 0) out << here << ' ' << hex(address) << ' ' << est << '\n';
        write_places_below(out, *child, here, symbols);
    }
}

struct Line {
    Totals own;
    std::uint64_t calls = 0;
};
void flatten(const Node& node, std::map<int, Line>& lines) {
    for (const auto& child : node.children) {
        Line& line = lines[child->symbol];
        line.own.insn += child->own.insn;
        line.own.min += child->own.min;
        line.own.est += child->own.est;
        line.own.max += child->own.max;
        line.calls += child->calls;
        flatten(*child, lines);
    }
}

}  // namespace

void write_row(std::ostream& out, const Counter& counter, Model model) {
    const double calls = counter.calls() == 0 ? 1 : static_cast<double>(counter.calls());
    const auto mean = [&](std::uint64_t sum) { return static_cast<double>(sum) / calls; };
    const auto& [insn, min, est, max, loads, stores] = counter.spreads();
    std::array<std::uint64_t, class_count> classes{};
    std::uint64_t blocks_unknown = 0;
    for (const Block& b : counter.blocks()) {
        for (std::size_t k = 0; k < classes.size(); ++k) classes[k] += b.classes[k] * b.runs;
        blocks_unknown += b.unknown.size() * b.runs;
    }
    std::size_t branches = 0, both_ways = 0;
    for (const auto& [address, branch] : branches_of(counter)) {
        ++branches;
        if (branch.taken > 0 && branch.not_taken > 0) ++both_ways;
    }

    out << std::fixed << std::setprecision(2) << "{\"timing\": \"" << manual_of(model)
        << "\", \"memory\": \"zero wait states\", \"valid\": "
        << (blocks_unknown == 0 && counter.calls() > 0 ? "true" : "false") << ", \"steps_counted\": " << counter.calls()
        << ", \"plugin_insn_per_step\": " << mean(insn.sum) << ", \"plugin_insn_worst_step\": " << insn.most
        << ", \"cycles_per_step_min\": " << mean(min.sum) << ", \"cycles_per_step_est\": " << mean(est.sum)
        << ", \"cycles_per_step_max\": " << mean(max.sum) << ", \"cycles_worst_step_min\": " << min.most
        << ", \"cycles_worst_step_est\": " << est.most << ", \"cycles_worst_step_max\": " << max.most
        << ", \"cycles_last_step_min\": " << min.last << ", \"cycles_last_step_est\": " << est.last
        << ", \"cycles_last_step_max\": " << max.last << ", \"loads_per_step\": " << mean(loads.sum)
        << ", \"stores_per_step\": " << mean(stores.sum) << ", \"step_stack_bytes\": " << counter.stack_bytes()
        << ", \"unknown_insn\": " << blocks_unknown << ", \"branches\": " << branches
        << ", \"branches_both_ways\": " << both_ways << ", \"mix_per_step\": {";
    const char* comma = "";
    for (std::size_t k = 0; k < classes.size(); ++k) {
        const auto cls = static_cast<Class>(k);
        if (classes[k] == 0 || cls == Class::begin || cls == Class::end) continue;
        out << comma << '"' << name_of(cls) << "\": " << mean(classes[k]);
        comma = ", ";
    }
    out << "}}\n";
}

void write_profile(std::ostream& out, const Counter& counter, const Symbols& symbols) {
    std::map<int, Line> lines;
    flatten(counter.calls_tree(), lines);
    std::vector<std::pair<int, Line>> order(lines.begin(), lines.end());
    std::stable_sort(order.begin(), order.end(),
                     [](const auto& a, const auto& b) { return a.second.own.est > b.second.own.est; });
    for (const auto& [symbol, line] : order)
        out << line.own.est << ' ' << line.own.min << ' ' << line.own.max << ' ' << line.own.insn << ' ' << line.calls
            << ' ' << name_of_symbol(symbols, symbol) << '\n';
}

void write_folded(std::ostream& out, const Counter& counter, const Symbols& symbols) {
    fold(out, counter.calls_tree(), "", symbols);
}

void write_places(std::ostream& out, const Counter& counter, const Symbols& symbols) {
    write_places_below(out, counter.calls_tree(), "", symbols);
}

void write_branches(std::ostream& out, const Counter& counter, const Symbols& symbols) {
    for (const auto& [address, branch] : branches_of(counter))
        out << hex(address) << " taken " << branch.taken << " not_taken " << branch.not_taken << ' '
            << name_of_symbol(symbols, branch.symbol) << '\n';
}

void write_blocks(std::ostream& out, const Counter& counter) {
    std::vector<const Block*> ran;
    for (const Block& b : counter.blocks())
        if (b.runs > 0) ran.push_back(&b);
    std::stable_sort(ran.begin(), ran.end(), [](const Block* a, const Block* b) { return a->start < b->start; });
    for (const Block* b : ran)
        out << hex(b->start) << ' ' << hex(b->end) << ' ' << b->runs << ' ' << b->totals.insn << ' ' << b->totals.min
            << ' ' << b->totals.est << ' ' << b->totals.max << '\n';
}

void write_unknown(std::ostream& out, const Counter& counter) {
    for (const Block& b : counter.blocks()) {
        if (b.runs == 0) continue;
        for (const Instruction& d : b.unknown)
            out << "cycles: no timing for the instruction " << hex(d.opcode) << " at " << hex(d.address)
                << ", executed " << b.runs << " times\n";
    }
}

}  // namespace cycles
