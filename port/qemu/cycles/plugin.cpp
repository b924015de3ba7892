// The plugin: options, translation of QEMU's blocks, and the report at the end.
//
//   -plugin libtumble_cycles.so,model=m3,elf=firmware.elf,region=step_world,out=row.json
//
// model=m0|m0+|m3|m4f   the timing table
// elf=FILE              the firmware's symbols
// region=TEXT           counts calls of functions whose symbol contains TEXT; without it, between markers 0xbfe0 and
//                       0xbff0 (hints 14 and 15: NOPs on every Cortex-M)
// skip=TEXT             functions that do not count (interrupts); systick_handler unless given
// multiplier=32         cycles of MUL on an M0 or M0+ with the small multiplier
// out=FILE              the JSON row; standard error unless given
// steps=FILE            a line a call: insn, min, est, max
// profile=, folded=, places=, branches=, blocks=FILE   see report.hpp
//
// A second exit of QEMU or a wrong option ends QEMU with a message and status 1.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include "counter.hpp"
#include "qemu_plugin.hpp"
#include "report.hpp"

extern "C" {
[[gnu::visibility("default")]] extern const int qemu_plugin_version = 1;
}

namespace cycles {

namespace {

struct Options {
    Model model = Model::m3;
    int multiplier = 1;
    std::string region, skip = "systick_handler";
    std::string elf, out, steps, profile, folded, places, branches, blocks;
};

[[nodiscard]] Options read_options(int count, char** texts) {
    Options options;
    bool has_model = false;
    const std::map<std::string_view, std::string*> named{{"region", &options.region},     {"skip", &options.skip},
                                                         {"elf", &options.elf},           {"out", &options.out},
                                                         {"steps", &options.steps},       {"profile", &options.profile},
                                                         {"folded", &options.folded},     {"places", &options.places},
                                                         {"branches", &options.branches}, {"blocks", &options.blocks}};
    for (int i = 0; i < count; ++i) {
        const std::string_view text = texts[i];
        const std::size_t equals = text.find('=');
        if (equals == text.npos) throw std::invalid_argument{"option '" + std::string{text} + "' has no value"};
        const std::string_view key = text.substr(0, equals), value = text.substr(equals + 1);
        if (key == "model") {
            const auto model = model_named(value);
            if (!model) throw std::invalid_argument{"no model '" + std::string{value} + "': m0, m0+, m3 or m4f"};
            options.model = *model;
            has_model = true;
        } else if (key == "multiplier") {
            if (value != "1" && value != "32") throw std::invalid_argument{"multiplier is 1 or 32"};
            options.multiplier = value == "32" ? 32 : 1;
        } else if (const auto found = named.find(key); found != named.end()) {
            *found->second = value;
        } else {
            throw std::invalid_argument{"no option '" + std::string{key} + "'"};
        }
    }
    if (!has_model) throw std::invalid_argument{"an option model=m0|m0+|m3|m4f is needed"};
    if (!options.region.empty() && options.elf.empty()) throw std::invalid_argument{"region needs elf=FILE"};
    return options;
}

class Plugin {
public:
    explicit Plugin(Options options)
        : options_{std::move(options)}, timing_{options_.model, options_.multiplier},
          symbols_{options_.elf.empty() ? Symbols{} : Symbols{options_.elf}}, counter_{timing_, symbols_} {
        if (!options_.region.empty() && !has_region())
            throw std::invalid_argument{options_.elf + " has no function with '" + options_.region + "' in its name"};
        if (!options_.places.empty()) counter_.keep_places();
        if (!options_.steps.empty()) {
            open(steps_, options_.steps);
            counter_.on_call_data = &steps_;
            counter_.on_call = [](const Totals& t, void* stream) {
                *static_cast<std::ofstream*>(stream) << t.insn << ' ' << t.min << ' ' << t.est << ' ' << t.max << '\n';
            };
        }
    }

    void translate(qemu_plugin_tb*);
    // Writes all reports. False, with a message, if a file could not be written.
    [[nodiscard]] bool report();

private:
    static void open(std::ofstream& stream, const std::string& path) {
        stream.open(path);
        if (!stream) throw std::runtime_error{"cannot write " + path};
    }
    [[nodiscard]] bool is_region(int symbol) const {
        return symbol >= 0 && symbols_[symbol].is_function && contains(symbol, options_.region);
    }
    [[nodiscard]] bool contains(int symbol, const std::string& text) const {
        return !text.empty() && symbol >= 0 && symbols_[symbol].name.find(text) != std::string::npos;
    }
    [[nodiscard]] bool has_region() const {
        for (int i = 0; i < symbols_.count(); ++i)
            if (is_region(i)) return true;
        return false;
    }

    [[nodiscard]] std::vector<Instruction> decode_block(qemu_plugin_tb*);
    void add_block(qemu_plugin_tb*, const std::vector<Instruction>&, std::size_t from, std::size_t to);
    void watch_push(qemu_plugin_insn*, const std::vector<Instruction>&, std::size_t at);

    Options options_;
    Timing timing_;
    Symbols symbols_;
    Counter counter_;
    std::ofstream steps_;
    std::map<std::uint32_t, int>
        rest_of_it_;  // by address: conditional instructions left where a block cut an IT block
};

Plugin* plugin = nullptr;

// The end of a page may cut an IT block, which then continues in the next translation block.
std::vector<Instruction> Plugin::decode_block(qemu_plugin_tb* tb) {
    const std::size_t count = qemu_plugin_tb_n_insns(tb);
    std::vector<Instruction> instructions;
    instructions.reserve(count);
    const auto cut = rest_of_it_.find(static_cast<std::uint32_t>(qemu_plugin_tb_vaddr(tb)));
    int conditional = cut == rest_of_it_.end() ? 0 : cut->second;
    for (std::size_t i = 0; i < count; ++i) {
        const qemu_plugin_insn* insn = qemu_plugin_tb_get_insn(tb, i);
        const auto* bytes = static_cast<const std::uint8_t*>(qemu_plugin_insn_data(insn));
        const auto halfword = [&](int at) { return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8); };
        // Not qemu_plugin_insn_size(): QEMU 7.2 says 4 for a short instruction just before the last halfword of a page.
        const std::uint16_t first = halfword(0), second = size_of(first) == 4 ? halfword(2) : std::uint16_t{0};
        Instruction d = decode(static_cast<std::uint32_t>(qemu_plugin_insn_vaddr(insn)), first, second);
        if (conditional > 0) {
            d.conditional = true;
            --conditional;
        }
        if (d.cls == Class::it) conditional = d.it_length;
        if (!timing_.knows(d)) d.cls = Class::unknown;
        instructions.push_back(d);
    }
    if (conditional > 0) rest_of_it_[instructions.back().address + instructions.back().size] = conditional;
    return instructions;
}

// A block for each stretch between markers.
void Plugin::translate(qemu_plugin_tb* tb) {
    const std::vector<Instruction> instructions = decode_block(tb);
    const auto is_marker = [&](std::size_t i) {
        return instructions[i].cls == Class::begin || instructions[i].cls == Class::end;
    };
    for (std::size_t from = 0; from < instructions.size();) {
        std::size_t to = from + 1;
        while (to < instructions.size() && !is_marker(to)) ++to;
        add_block(tb, instructions, from, to);
        from = to;
    }
}

void Plugin::add_block(qemu_plugin_tb* tb, const std::vector<Instruction>& all, std::size_t from, std::size_t to) {
    Block& b = counter_.add_block();
    b.start = all[from].address;
    b.end = all[to - 1].address + all[to - 1].size;
    b.first_size = all[from].size;
    b.last = all[to - 1];
    b.symbol = symbols_.empty() ? -1 : symbols_.at(b.start);
    b.skipped = contains(b.symbol, options_.skip);
    b.enters = is_region(b.symbol) && symbols_[b.symbol].address == b.start;

    const bool marks = options_.region.empty();
    b.begins = marks && all[from].cls == Class::begin;
    b.ends = marks && all[from].cls == Class::end;
    // A marker is not counted, and does not change the cost of its neighbours.
    const bool marker = all[from].cls == Class::begin || all[from].cls == Class::end;
    const std::size_t first = marker ? from + 1 : from;
    const std::span<const Instruction> stretch{all.data() + first, to - first};
    const std::vector<Cycles> costs = timing_.costs(stretch);
    for (std::size_t i = 0; i < costs.size(); ++i) {
        b.cost += costs[i];
        if (options_.places.empty()) continue;
        b.est.push_back(costs[i].est);
        b.address.push_back(stretch[i].address);
    }
    b.insn = static_cast<std::uint32_t>(stretch.size() + (marker && !marks ? 1 : 0));
    for (std::size_t i = first; i < to; ++i) {
        const Instruction& d = all[i];
        ++b.classes[static_cast<std::size_t>(d.cls)];
        if (d.loads()) b.loads += d.words;
        if (d.stores()) b.stores += d.words;
        if (d.cls == Class::unknown) b.unknown.push_back(d);
        watch_push(qemu_plugin_tb_get_insn(tb, i), all, i);
    }

    if (b.last.writes_pc && to == all.size()) {
        const Class c = b.last.cls;
        b.exit = c == Class::bl || c == Class::blx                     ? Exit::call
                 : c == Class::b || c == Class::tbb || c == Class::cbz ? Exit::jump
                                                                       : Exit::returns;
    }

    constexpr auto run = [](unsigned, void* block) { plugin->counter_.run(*static_cast<Block*>(block)); };
    if (from == 0) qemu_plugin_register_vcpu_tb_exec_cb(tb, run, QEMU_PLUGIN_CB_NO_REGS, &b);
    else qemu_plugin_register_vcpu_insn_exec_cb(qemu_plugin_tb_get_insn(tb, from), run, QEMU_PLUGIN_CB_NO_REGS, &b);
}

// Finds the depth of the stack: the address at which a PUSH stores, less the bytes that the next instructions subtract
// from SP.
void Plugin::watch_push(qemu_plugin_insn* insn, const std::vector<Instruction>& all, std::size_t at) {
    const Instruction& d = all[at];
    if (!d.stack_pointer || (d.cls != Class::stm && d.cls != Class::f_stm)) return;
    std::int32_t below = 0;
    for (std::size_t k = at + 1; k < all.size(); ++k) {
        if (all[k].stack_pointer &&
            (all[k].cls == Class::stm || all[k].cls == Class::f_stm || all[k].cls == Class::ldm))
            break;
        below += all[k].sp_decrement;
    }
    const auto bytes = static_cast<std::uintptr_t>(below > 0 ? below : 0);
    qemu_plugin_register_vcpu_mem_cb(
        insn,
        [](unsigned, std::uint32_t, std::uint64_t address, void* taken) {
            plugin->counter_.push(static_cast<std::uint32_t>(address),
                                  static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(taken)));
        },
        QEMU_PLUGIN_CB_NO_REGS, QEMU_PLUGIN_MEM_W, reinterpret_cast<void*>(bytes));
}

bool Plugin::report() {
    const auto to_file = [](const std::string& path, const auto& write) {
        if (path.empty()) return true;
        std::ofstream file{path};
        write(file);
        file.close();
        if (!file) std::cerr << "cycles: cannot write " << path << '\n';
        return static_cast<bool>(file);
    };
    write_unknown(std::cerr, counter_);
    if (options_.out.empty()) write_row(std::cerr, counter_, options_.model);
    bool ok = to_file(options_.out, [&](std::ostream& o) { write_row(o, counter_, options_.model); });
    ok &= to_file(options_.profile, [&](std::ostream& o) { write_profile(o, counter_, symbols_); });
    ok &= to_file(options_.folded, [&](std::ostream& o) { write_folded(o, counter_, symbols_); });
    ok &= to_file(options_.places, [&](std::ostream& o) { write_places(o, counter_, symbols_); });
    ok &= to_file(options_.branches, [&](std::ostream& o) { write_branches(o, counter_, symbols_); });
    ok &= to_file(options_.blocks, [&](std::ostream& o) { write_blocks(o, counter_); });
    if (!options_.steps.empty()) {
        steps_.close();
        if (!steps_) std::cerr << "cycles: cannot write " << options_.steps << '\n';
        ok &= static_cast<bool>(steps_);
    }
    return ok;
}

}  // namespace

}  // namespace cycles

extern "C" [[gnu::visibility("default")]] int qemu_plugin_install(qemu_plugin_id_t id, const qemu_info_t* info,
                                                                  int argc, char** argv) {
    using cycles::plugin;
    try {
        if (std::string_view{info->target_name} != "arm") throw std::invalid_argument{"for qemu-system-arm only"};
        plugin = new cycles::Plugin{cycles::read_options(argc, argv)};  // lives as long as QEMU
    } catch (const std::exception& error) {
        std::cerr << "cycles: " << error.what() << '\n';
        return 1;
    }
    qemu_plugin_register_vcpu_tb_trans_cb(id, [](qemu_plugin_id_t, qemu_plugin_tb* tb) { plugin->translate(tb); });
    qemu_plugin_register_atexit_cb(
        id,
        [](qemu_plugin_id_t, void*) {
            // Within exit(), so the status is set without running the handlers again.
            if (!plugin->report()) {
                std::fflush(nullptr);
                std::_Exit(1);
            }
        },
        nullptr);
    return 0;
}
