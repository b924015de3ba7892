// `tumble profile`: where the cycles of a scene's step go on a core. It prints the mean and the worst step,
// instructions by kind, functions (inlined ones too) and branches that always went the same way, and draws a flame
// graph.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <optional>
#include <sstream>

#include "command/command.hpp"
#include "firmware/firmware.hpp"
#include "tools/files.hpp"
#include "tools/output.hpp"
#include "tools/process.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct ProfileOptions : Choice {
    std::string core;
    std::string flame;   // file; empty: none
    int functions = 20;  // rows of the table
    bool json = false;
    int timeout = 600;  // s of emulation
};

// Estimated cycles of all steps: of the function alone, and with the functions that it calls or inlines.
struct Function {
    std::uint64_t own = 0, with_callees = 0;
    std::string name;
};
// A conditional branch that was always taken or never.
struct Branch {
    std::string address, line;  // file:line below the repository
    std::uint64_t taken = 0, not_taken = 0;
};
struct Branches {
    std::size_t count = 0;  // that ran
    std::vector<Branch> one_way;
};

std::vector<Function> functions_of(const fs::path& places, const fs::path& elf) {
    std::istringstream lines(run_quietly({TUMBLE_FLAME, places.string(), elf.string()}));
    std::vector<Function> functions;
    for (Function f; lines >> f.own >> f.with_callees >> std::ws && std::getline(lines, f.name);)
        functions.push_back(f);
    return functions;
}

Branches branches_of(const fs::path& file, const fs::path& elf) {
    std::istringstream lines(contents_of(file));
    Branches branches;
    std::vector<std::string> command = {"arm-none-eabi-addr2line", "-e", elf.string()};
    std::string taken, not_taken, rest;
    for (Branch b; lines >> b.address >> taken >> b.taken >> not_taken >> b.not_taken && std::getline(lines, rest);) {
        ++branches.count;
        if (b.taken > 0 && b.not_taken > 0) continue;
        branches.one_way.push_back(b);
        command.push_back("0x" + b.address);
    }
    if (branches.one_way.empty()) return branches;
    std::istringstream places(run_quietly(command));
    const std::string root = std::string(TUMBLE_SOURCE_DIR) + "/";
    for (Branch& b : branches.one_way) {
        std::getline(places, b.line);
        b.line = fs::path(b.line.substr(0, b.line.find(" (discriminator"))).lexically_normal();
        if (b.line.starts_with(root)) b.line.erase(0, root.size());
    }
    return branches;
}

void print_table(std::FILE* out, const ProfileOptions& options, const Method& method, const SceneDescription& scene,
                 const Json& row, const std::vector<Function>& functions, const Branches& branches) {
    const auto number = [&](const char* key) { return row.at(key).get<double>(); };
    std::fprintf(out, "%s: %s in %s on %s, %lld steps; cycles at zero wait states by %s\n", scene.name.c_str(),
                 method.integrator.c_str(), numbers_text(row.at("numbers"), row.at("carry")).c_str(),
                 options.core.c_str(), row.at("steps").get<long long>(), row.at("timing").get<std::string>().c_str());
    std::fprintf(out, "\n%-11s %12s %12s %12s %12s\n", "", "estimate", "least", "most", "insn");
    std::fprintf(out, "%-11s %12.0f %12.0f %12.0f %12.0f\n", "mean step", number("cycles_per_step_est"),
                 number("cycles_per_step_min"), number("cycles_per_step_max"), number("insn_per_step"));
    std::fprintf(out, "%-11s %12.0f %12.0f %12.0f %12.0f\n", "worst step", number("cycles_worst_step_est"),
                 number("cycles_worst_step_min"), number("cycles_worst_step_max"), number("insn_per_step_max"));
    std::fprintf(out, "\na step loads %.0f and stores %.0f words, and takes %.0f bytes of stack; its instructions:\n ",
                 number("loads_per_step"), number("stores_per_step"), number("step_stack_bytes"));
    std::vector<std::pair<double, std::string>> mix;
    for (const auto& [kind, count] : row.at("mix_per_step").items()) mix.emplace_back(count.get<double>(), kind);
    std::stable_sort(mix.begin(), mix.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (const auto& [count, kind] : mix) std::fprintf(out, " %s %s", few_digits(count).c_str(), kind.c_str());

    std::uint64_t total = 0;
    for (const Function& f : functions) total += f.own;
    const auto share = [&](std::uint64_t cycles) {
        return total == 0 ? 0.0 : 100 * static_cast<double>(cycles) / static_cast<double>(total);
    };
    std::fprintf(out, "\n\n%9s %9s  %s\n", "own", "with its", "function, with what is inlined by name");
    std::fprintf(out, "%9s %9s\n", "", "callees");
    std::uint64_t shown = 0;
    for (std::size_t i = 0; i < functions.size() && i < static_cast<std::size_t>(options.functions); ++i) {
        const Function& f = functions[i];
        std::fprintf(out, "%7.1f %% %7.1f %%  %s\n", share(f.own), share(f.with_callees), f.name.c_str());
        shown += f.own;
    }
    if (shown < total)
        std::fprintf(out, "%7.1f %% %9s  %zu others\n", share(total - shown), "",
                     functions.size() - static_cast<std::size_t>(options.functions));

    std::fprintf(out, "\n%zu of %zu conditional branches went one way in all steps\n", branches.one_way.size(),
                 branches.count);
    for (const Branch& b : branches.one_way)
        std::fprintf(out, "  %s  %-12s %8llu times  %s\n", b.address.c_str(),
                     b.taken > 0 ? "always taken" : "never taken",
                     static_cast<unsigned long long>(b.taken + b.not_taken), b.line.c_str());
    if (!options.flame.empty()) std::fprintf(out, "\nflame graph in %s\n", options.flame.c_str());
}

void print_json(Json row, const std::vector<Function>& functions, const Branches& branches) {
    const double steps = std::max(1.0, row.at("steps").get<double>());
    row["functions"] = Json::array();
    for (const Function& f : functions)
        row["functions"].push_back({{"function", f.name},
                                    {"own_cycles_per_step", static_cast<double>(f.own) / steps},
                                    {"cycles_per_step", static_cast<double>(f.with_callees) / steps}});
    row["branches"] = branches.count;
    row["one_way_branches"] = Json::array();
    for (const Branch& b : branches.one_way)
        row["one_way_branches"].push_back(
            {{"address", b.address}, {"line", b.line}, {"taken", b.taken}, {"not_taken", b.not_taken}});
    std::cout << row.dump(2) << "\n";
}

int profile(const ProfileOptions& options) {
    check_core(options.core);
    if (!core_named(options.core).has_cycles())
        throw std::invalid_argument("--core: got \"" + options.core +
                                    "\", whose cycles no manual gives, expected one of " + cores_with_cycles());
    const SceneDescription scene = options.read();
    const Method method = options.method(scene);
    const NumberSystemInfo& system = find_number_system(scene, method.numbers, method.carry);
    const NumberVariant& variant = variant_of(system.name, system.carry);
    const std::vector<FileArgument> outputs = {{"--flame", options.flame}};
    check_outputs({{"the scene", options.scene}}, outputs);
    std::FILE* const report = takes_standard_output(outputs, options.json) ? stderr : stdout;
    std::optional<OutputFile> flame;
    if (!options.flame.empty()) flame.emplace(options.flame, "--flame");
    const fs::path build = fs::path(TUMBLE_SOURCE_DIR) / "build/profile" / options.core;
    fs::create_directories(build);
    const DirectoryLock lock(build);
    const fs::path header = build / "scene.hpp";
    write_if_changed(header, compiled_scene(scene, Choice{}));  // the firmware has its own method
    // Debug lines name the inlined functions; they do not change the code of a step.
    StepFirmware firmware(build, options.core, struct_name(scene.path), header, {method.integrator},
                          {.has_lines = true});
    const std::string name = StepFirmware::name_of(variant, method.integrator);
    firmware.build({name});
    const fs::path places = build / "places", branches_file = build / "branches", elf = build / (name + ".elf");
    const StepOutcome outcome =
        firmware.run(name, options.timeout, {"places=" + places.string(), "branches=" + branches_file.string()});
    if (!outcome.shortage.empty()) throw std::runtime_error(name + " " + outcome.shortage);
    if (!outcome.error.empty()) throw std::runtime_error(options.core + ", " + name + ": " + outcome.error);
    const auto simulation = options.start(scene);
    check_state(outcome.row, *simulation, options.core + ", " + name);

    const std::vector<Function> functions = functions_of(places, elf);
    const Branches branches = branches_of(branches_file, elf);
    if (flame) {
        const std::string title = scene.name + ", " + method.integrator + " in " +
                                  numbers_text(variant.numbers, variant.carry) + " on " + options.core + ": " +
                                  few_digits(outcome.row.at("cycles_per_step_est").get<double>()) +
                                  " cycles a step, estimate, zero wait states";
        flame->stream() << run_quietly({TUMBLE_FLAME, places.string(), elf.string(), "/dev/stdout", title});
        flame->commit();
    }
    if (options.json) print_json(outcome.row, functions, branches);
    else print_table(report, options, method, scene, outcome.row, functions, branches);
    return done;
}

}  // namespace

void add_profile(CommandLine& line) {
    const auto options = std::make_shared<ProfileOptions>();
    Subcommand command = line.add(
        "profile", "show where the cycles of a step go on a core, by functions and as a flame graph",
        [=] { return profile(*options); },
        "Cycles are those that the core's manual gives, at zero wait states; the firmware is built for the "
        "core and runs in QEMU.");
    options->add_to(command);
    command.require(options->core, "--core NAME", "a core whose cycles are known");
    command.add(options->flame, "--flame out.svg", "draw a flame graph as SVG; - is standard output", svg_file());
    command.add(options->functions, "--functions N", "functions that the table names", at_least(1, "functions"));
    command.add(options->json, "--json", "print one JSON object");
    command.add(options->timeout, "--timeout S", "seconds that the emulation may take", at_least(1, "seconds"));
}

}  // namespace tumble::host
