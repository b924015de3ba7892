#include "firmware/firmware.hpp"

#include <tumble/numbers/systems.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <tuple>

#include "firmware/callgrind.hpp"
#include "tools/files.hpp"
#include "tools/process.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;

const fs::path source_directory = TUMBLE_SOURCE_DIR;
const fs::path boards_file = source_directory / "port/boards.txt";
const fs::path families_file = source_directory / "port/families.txt";
const fs::path toolchain_file = source_directory / "port/toolchain.cmake";

// The directory of a program of port/programs: "step" or "record".
std::string source_of(const char* program) { return (source_directory / "port/programs" / program).string(); }

// Is the build directory configured for this program of this checkout, with the core's toolchain?
bool is_configured(const char* program, const fs::path& build, const std::string& core) {
    const std::string cache = contents_of(build / "CMakeCache.txt");
    const auto has = [&](const std::string& text) { return cache.find(text + "\n") != std::string::npos; };
    return has("\nCMAKE_HOME_DIRECTORY:INTERNAL=" + source_of(program)) &&
           (core == StepFirmware::host || has("=" + toolchain_file.string())) && fs::exists(build / "build.ninja");
}

// CMake refuses a build directory that was configured for other sources, so their cache is removed.
void configure(const char* program, const fs::path& build, const std::string& core,
               const std::vector<std::string>& settings) {
    if (!is_configured(program, build, core)) {
        fs::remove(build / "CMakeCache.txt");
        fs::remove_all(build / "CMakeFiles");
    }
    std::vector<std::string> command = {
        "cmake", "-G", "Ninja", "-S", source_of(program), "-B", build.string(), "-DTUMBLE_CORE=" + core};
    if (core != StepFirmware::host) command.push_back("-DCMAKE_TOOLCHAIN_FILE=" + toolchain_file.string());
    command.insert(command.end(), settings.begin(), settings.end());
    run_quietly(command);
}

// The row of a program for the host, with valgrind's count of instructions instead of times.
nlohmann::ordered_json counted(const fs::path& program) {
    const Counted counted = instructions_in("*step_world*", "'" + program.string() + "'");
    const auto row = nlohmann::ordered_json::parse(counted.text);
    const std::uint64_t steps = row.at("steps");
    nlohmann::ordered_json with_count;
    for (const auto& [key, value] : row.items()) {
        if (key == "ns_per_step") with_count["insn_per_step"] = steps == 0 ? 0 : (counted.count + steps / 2) / steps;
        else if (key != "ns_per_step_max" && key != "stack_bytes") with_count[key] = value;
    }
    return with_count;
}

// The output of program and plugin: rows of one line each, and messages.
struct Printed {
    std::vector<nlohmann::ordered_json> rows;
    std::string messages;
};
Printed parse(const std::string& text) {
    Printed printed;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("{")) printed.rows.push_back(nlohmann::ordered_json::parse(line));
        else printed.messages += line + "\n";
    }
    return printed;
}

// Adds the plugin's counts to the firmware's row. Returns an error message, or an empty text.
std::string add_cycles(nlohmann::ordered_json& row, const nlohmann::ordered_json& cycles, const std::string& messages,
                       int insn_of_call) {
    if (row.at("steps") == 0) return {};
    if (cycles.at("unknown_insn") != 0) return "cycles are not known:\n" + messages;
    // The firmware rounds its mean to a whole number, the plugin to hundredths.
    const double own = row.at("insn_per_step").get<double>() - insn_of_call,
                 counted = cycles.at("plugin_insn_per_step");
    const bool same_worst =
        !row.contains("insn_per_step_max") || row.at("insn_per_step_max").get<std::int64_t>() - insn_of_call ==
                                                  cycles.at("plugin_insn_worst_step").get<std::int64_t>();
    if (cycles.at("steps_counted") != row.at("steps") || std::abs(counted - own) > 0.51 || !same_worst)
        return "the plugin counts " + cycles.dump() +
               ", expected the steps and instructions of the firmware, less the " + std::to_string(insn_of_call) +
               " of its call: " + row.dump();
    for (const char* key : {"cycles_per_step_min", "cycles_per_step_est", "cycles_per_step_max",
                            "cycles_worst_step_min", "cycles_worst_step_est", "cycles_worst_step_max",
                            "cycles_last_step_min", "cycles_last_step_est", "cycles_last_step_max", "timing", "memory",
                            "unknown_insn", "loads_per_step", "stores_per_step", "step_stack_bytes", "mix_per_step"})
        row[key] = cycles.at(key);
    return {};
}

[[noreturn]] void wrong_numbers(const std::string& core, const std::string& numbers) {
    std::string known;
    for (const NumberVariant& variant : number_variants()) known += (known.empty() ? "" : ", ") + variant.name;
    throw std::runtime_error(boards_file.string() + ": " + core + ": column numbers is '" + numbers +
                             "', expected number systems joined by commas, of: " + known);
}

// By port: the compiler, and the name of a binary utility with * for "size" or "nm".
std::map<std::string, std::pair<std::string, std::string>> compilers_and_tools() {
    std::ifstream families(families_file);
    std::map<std::string, std::pair<std::string, std::string>> list;
    for (std::string line; std::getline(families, line);) {
        std::istringstream row(line);
        std::string port, compiler, tools;
        if (!(row >> port) || port.starts_with("#")) continue;
        if (!(row >> compiler >> tools) || tools.find('*') == std::string::npos)
            throw std::runtime_error(families_file.string() + ": " + port + ": column tools is '" + tools +
                                     "', expected a * for the tool's name");
        list[port] = {compiler, tools};
    }
    return list;
}

// tumble::integrators::Rk4 -> Rk4.
std::string method_of(const std::string& integrator) {
    const std::string& type = find_integrator(integrator).type;
    return type.substr(type.rfind(':') + 1);
}

}  // namespace

std::string Core::tool(const std::string& name) const {
    std::string command = tools;
    return command.replace(command.find('*'), 1, name);
}

std::vector<Core> cores() {
    const auto families = compilers_and_tools();
    std::ifstream boards(boards_file);
    std::vector<Core> list;
    for (std::string line; std::getline(boards, line);) {
        std::istringstream row(line);
        Core core;
        std::string skipped, clock, numbers;
        if (!(row >> core.name) || core.name.starts_with("#")) continue;
        row >> core.port >> core.machine >> clock >> core.counter >> skipped >> skipped >> skipped >> core.timing >>
            core.set >> numbers >> std::ws;
        core.clock = parse_frequency(clock).value_or(0);
        std::istringstream words(numbers);
        for (std::string word; std::getline(words, word, ',');) {
            const auto& known = number_variants();
            if (std::none_of(known.begin(), known.end(), [&](const NumberVariant& v) { return v.name == word; }))
                wrong_numbers(core.name, numbers);
            core.numbers.push_back(word);
        }
        if (core.numbers.empty()) wrong_numbers(core.name, numbers);
        if (!std::getline(row, core.flags))
            throw std::runtime_error(boards_file.string() + ": too few columns for " + core.name);
        const auto family = families.find(core.port);
        if (family == families.end())
            throw std::runtime_error(boards_file.string() + ": " + core.name + ": column port is '" + core.port +
                                     "', expected one with a row in " + families_file.string());
        std::tie(core.compiler, core.tools) = family->second;
        list.push_back(core);
    }
    if (list.empty()) throw std::runtime_error("no core in " + boards_file.string());
    return list;
}

Core core_named(const std::string& name) {
    std::string known;
    for (const Core& core : cores()) {
        if (core.name == name) return core;
        known += (known.empty() ? "" : ", ") + core.name;
    }
    throw std::invalid_argument("no core '" + name + "', expected one of " + known);
}

std::string memory_shortage(const std::string& messages, const std::string& core) {
    // GNU: region `RAM' overflowed by 8688 bytes; LLVM: will not fit in region 'RAM': overflowed by 8688 bytes.
    const std::string before = "region ", middle = " overflowed by ", after = " bytes";
    std::string text;
    for (std::size_t at = messages.find(middle); at != std::string::npos; at = messages.find(middle, at + 1)) {
        const std::size_t name = messages.rfind(before, at), number = at + middle.size();
        const std::size_t end = messages.find(after, number);
        if (name == std::string::npos || end == std::string::npos) continue;
        const std::size_t first = name + before.size() + 1;  // after the quote
        const std::string region = messages.substr(first, messages.find('\'', first) - first);
        const std::string part = messages.substr(number, end - number) + after + " of " + region;
        if (text.find(part) == std::string::npos) text += (text.empty() ? "needs " : " and ") + part;
    }
    return text.empty() ? text : text + " more than " + core + " has";
}

fs::path build_record_firmware(const fs::path& build, const std::string& core, const fs::path& scene) {
    if (!is_configured("record", build, core))
        configure("record", build, core, {"-DTUMBLE_SCENE_DIR=" + scene.string()});
    try {
        run_quietly({"cmake", "--build", build.string()});
    } catch (const std::runtime_error& error) {
        if (const std::string shortage = memory_shortage(error.what(), core); !shortage.empty())
            throw std::runtime_error("the firmware " + shortage);
        throw;
    }
    return build / "record.elf";
}

Process run_in_qemu(const std::string& core, const fs::path& elf, int timeout,
                    const std::vector<std::string>& options) {
    std::vector<std::string> command = {"env", "TUMBLE_CYCLES=" TUMBLE_CYCLES_PLUGIN,
                                        (source_directory / "port/qemu/run").string(), "--timeout",
                                        std::to_string(timeout)};
    command.insert(command.end(), options.begin(), options.end());
    command.insert(command.end(), {core, elf.string()});
    return Process(command, {}, Process::Errors::merge);
}

StepOutcome run_step_program(const Core& core, const fs::path& elf, int timeout, const MeasuredStep& step,
                             const std::vector<std::string>& reports) {
    std::vector<std::string> options;
    if (core.has_cycles()) options = {"--cycles", core.timing, "--step", step.function};
    for (const std::string& report : reports) options.insert(options.end(), {"--report", report});
    std::string text;
    const int status = run_in_qemu(core.name, elf, timeout, options).wait(&text);
    StepOutcome outcome;
    if (status != 0) {
        outcome.error = "exit status " + std::to_string(status) + ": " + text;
        return outcome;
    }
    Printed printed = parse(text);
    if (printed.rows.size() != (core.has_cycles() ? 2 : 1)) {
        outcome.error = "expected a row" + std::string(core.has_cycles() ? " and the plugin's" : "") + ": " + text;
        return outcome;
    }
    if (core.has_cycles())
        outcome.error = add_cycles(printed.rows.front(), printed.rows.back(), printed.messages, step.insn_of_call);
    if (outcome.error.empty()) outcome.row = std::move(printed.rows.front());
    // A port that cannot measure its stack prints 0.
    if (outcome.row.contains("stack_bytes") && outcome.row.at("stack_bytes") == 0) outcome.row.erase("stack_bytes");
    return outcome;
}

void add_sizes(nlohmann::ordered_json& row, const fs::path& elf) {
    const std::string core = row.at("core");
    const std::string size = core == StepFirmware::host ? "size" : core_named(core).tool("size");
    const std::string sums = run_quietly({size, elf.string()});
    unsigned long code = 0, data = 0, zeros = 0;
    if (std::sscanf(sums.c_str(), "%*[^\n]\n%lu %lu %lu", &code, &data, &zeros) != 3)
        throw std::runtime_error(size + ": " + sums);
    row["text_bytes"] = code + data;
    std::istringstream lines(run_quietly({size, "-A", "-d", elf.string()}));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string section;
        std::uint64_t bytes = 0;
        if (!(words >> section >> bytes)) continue;
        if (section == ".text") row["code_bytes"] = bytes;
        if (section == ".rodata") row["rodata_bytes"] = bytes;
    }
    row["ram_bytes"] = data + zeros;
}

const std::vector<NumberVariant>& number_variants() {
    static const std::vector<NumberVariant> list = [] {
        std::vector<NumberVariant> variants;
        NumberSystems::for_each([&]<class System>() {
            using N = typename System::template Numbers<RoomRange>;  // of any range
            if (System::runs == Runs::everywhere) variants.push_back({System::name, N::name, N::carry});
        });
        return variants;
    }();
    return list;
}

const NumberVariant& variant_of(const std::string& numbers, bool carry) {
    return *std::find_if(number_variants().begin(), number_variants().end(),
                         [&](const NumberVariant& v) { return v.numbers == numbers && v.carry == carry; });
}

void check_state(const nlohmann::ordered_json& row, Simulation& simulation, const std::string& program) {
    if (row.at("state_hash") != hex(finish(simulation)))
        throw std::runtime_error(program + ": ends with another state than the host");
}

std::string StepFirmware::name_of(const NumberVariant& variant, const std::string& integrator) {
    return variant.name + "-" + method_of(integrator);
}

StepFirmware::StepFirmware(fs::path build, std::string core, const std::string& scene, const fs::path& scenes,
                           const std::vector<std::string>& integrators, const Compilation& compilation)
    : build_(std::move(build)), core_(std::move(core)) {
    std::string methods;
    for (const std::string& integrator : integrators) methods += (methods.empty() ? "" : "|") + method_of(integrator);
    configure("step", build_, core_,
              {"-DTUMBLE_SCENE=" + scene, "-DTUMBLE_METHODS=" + methods, "-DTUMBLE_OPTIMIZE=" + compilation.level,
               std::string("-DTUMBLE_LINES=") + (compilation.has_lines ? "ON" : "OFF"),
               std::string("-DTUMBLE_SEPARATE=") + (compilation.is_separate ? "ON" : "OFF"),
               (fs::is_directory(scenes) ? "-DTUMBLE_SCENE_DIR=" : "-DTUMBLE_SCENE_HEADER=") + scenes.string()});
}

void StepFirmware::build(const std::vector<std::string>& names) {
    std::vector<std::string> command = {"cmake", "--build", build_.string(), "--target"};
    command.insert(command.end(), names.begin(), names.end());
    for (const char* option : {"--", "-k", "0"}) command.emplace_back(option);
    messages_.clear();
    if (Process(command, {}, Process::Errors::merge).wait(&messages_) == 127)
        throw std::runtime_error("cmake not found");
}

StepOutcome StepFirmware::run(const std::string& name, int timeout, const std::vector<std::string>& reports) const {
    StepOutcome outcome;
    const fs::path elf = build_ / (name + ".elf");
    const auto not_compiled = [&](const std::string& group) {
        return messages_.find("FAILED: CMakeFiles/steps-" + group + ".dir") != std::string::npos;
    };
    const std::size_t not_linked = messages_.find("FAILED: " + name + ".elf");
    if (not_linked != std::string::npos) {
        // The linker's message stands between this failure and the next.
        const std::size_t end = messages_.find("FAILED: ", not_linked + 1);
        outcome.shortage = memory_shortage(messages_.substr(not_linked, end - not_linked), core_);
    }
    if (!outcome.shortage.empty()) return outcome;
    if (not_linked != std::string::npos || !fs::exists(elf) || not_compiled(name) ||
        not_compiled(name.substr(0, name.find('-')))) {
        outcome.error = "not built: see cmake --build " + build_.string() + " --target " + name;
    } else {
        if (core_ == host) outcome.row = counted(elf);
        else outcome = run_step_program(core_named(core_), elf, timeout, {}, reports);
        if (outcome.error.empty()) add_sizes(outcome.row, elf);
        if (outcome.error.empty() && core_ != host && core_named(core_).port == "cortex_m")
            outcome.row["step_stack_bound_bytes"] = std::stoul(
                run_quietly({(source_directory / "port/cortex_m/stack_bound").string(), elf.string(), "step_world"}));
    }
    return outcome;
}

}  // namespace tumble::host
