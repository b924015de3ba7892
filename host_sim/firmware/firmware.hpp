// What the host builds for a core and runs in QEMU: the record firmware of `tumble compare`, and the firmware that
// measures a step. All of it throws std::runtime_error with the tool's own words when a tool fails.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "simulation/simulation.hpp"
#include "tools/process.hpp"

namespace tumble::host {

// Rows of port/boards.txt, with what port/families.txt has for their ports.
struct Core {
    std::string name, port, machine, counter, timing, set;  // as the file explains its columns
    std::vector<std::string> numbers;                       // those that suit it, named as in NumberVariant
    double clock = 0;                                       // Hz; 0 where the row has none
    std::string flags;
    std::string compiler, tools;

    // Options of GCC are for it.
    [[nodiscard]] bool compiled_by_gcc() const { return compiler.ends_with("-g++"); }
    // The name of a binary utility, "size".
    [[nodiscard]] std::string tool(const std::string& name) const;
    // Has port/qemu/cycles a table of what its instructions cost?
    [[nodiscard]] bool has_cycles() const { return timing != "-"; }
    // Are its instructions counted, so that a step has a cost that repeats?
    [[nodiscard]] bool has_insn() const { return counter.starts_with("insn"); }
    // A Cortex-M7 issues two at most: its cycles are at least half its instructions.
    [[nodiscard]] bool issues_two() const { return flags.find("-mcpu=cortex-m7") != std::string::npos; }
};
[[nodiscard]] std::vector<Core> cores();
// Throws std::invalid_argument for a name that is in no row.
[[nodiscard]] Core core_named(const std::string& name);

// "needs 8688 bytes of RAM more than cortex-m0 has", of the messages of a linker; empty where no memory is too small.
[[nodiscard]] std::string memory_shortage(const std::string& messages, const std::string& core);

// Firmware that replays a scene and writes its states: port/programs/record. `scene` is the directory of scene.hpp and
// recording.hpp, the same one whenever a build directory is used.
[[nodiscard]] std::filesystem::path build_record_firmware(const std::filesystem::path& build, const std::string& core,
                                                          const std::filesystem::path& scene);

// A program in emulation, which ends after `timeout` s. `options` of port/qemu/run stand before the core.
[[nodiscard]] Process run_in_qemu(const std::string& core, const std::filesystem::path& elf, int timeout,
                                  const std::vector<std::string>& options = {});

// The kernel's number systems that firmware is made of: the name in the list, the type's own name, and carry.
struct NumberVariant {
    std::string name, numbers;
    bool carry;
};
[[nodiscard]] const std::vector<NumberVariant>& number_variants();
[[nodiscard]] const NumberVariant& variant_of(const std::string& numbers, bool carry);

// What firmware that measures a step gives in emulation.
struct StepOutcome {
    nlohmann::ordered_json row;
    std::string error;     // empty: the row is there
    std::string shortage;  // of the core's memory, as memory_shortage(); no row and no error then
};

// The function that firmware measures, by a part of its symbol, and the instructions that the firmware counts beside
// it: the call, and the moves of what the counter gave before it and of what the function returns.
struct MeasuredStep {
    std::string function = "step_world";
    int insn_of_call = 4;
};

// Runs such firmware in QEMU, which ends after `timeout` s, and returns the row that it prints. On a core with a timing
// table the row has the cycles of the step: keys as in bench/README.md. An instruction without a timing is an error, as
// is a plugin that has not counted the instructions that the firmware has. `reports` are more of what the plugin writes
// there, "places=FILE" (port/qemu/cycles/report.hpp).
[[nodiscard]] StepOutcome run_step_program(const Core& core, const std::filesystem::path& elf, int timeout = 900,
                                           const MeasuredStep& step = {}, const std::vector<std::string>& reports = {});

// Throws where a program's row ends with another state than the rest of the simulation does.
void check_state(const nlohmann::ordered_json& row, Simulation& simulation, const std::string& program);

// Firmware that replays a scene and counts the instructions of every step: port/programs/step, for one core.
class StepFirmware {
public:
    // The core whose programs run natively, under valgrind, which counts the instructions of a mean step only.
    static constexpr const char* host = "host";

    // A program's name: "q32-Rk4".
    [[nodiscard]] static std::string name_of(const NumberVariant& variant, const std::string& integrator);

    enum class Lines { none, known };  // debug information; the instructions of a step are the same with it

    // Configures the build directory. `scenes` is one header, which all programs replay, or a directory with a header
    // for each program, named after it; `scene` is the name of the struct in them. `integrators`: those that programs
    // are made of; all if there are none. `optimize`: the compiler's level.
    StepFirmware(std::filesystem::path build, std::string core, const std::string& scene,
                 const std::filesystem::path& scenes, const std::vector<std::string>& integrators = {},
                 Lines lines = Lines::none, const std::string& optimize = "-O2");

    // Builds programs, on all processors: about 20 s for all of a number system that replay one scene, and 4 s for each
    // that has a scene of its own. What cannot be built is reported by run().
    void build(const std::vector<std::string>& names);

    // run_step_program() of a program of the last build(), with its sizes (text_bytes: all that lies in flash,
    // code_bytes, rodata_bytes, ram_bytes, and on a Cortex-M step_stack_bound_bytes) added. The caller checks its
    // state_hash.
    [[nodiscard]] StepOutcome run(const std::string& name, int timeout = 900,
                                  const std::vector<std::string>& reports = {}) const;

private:
    std::filesystem::path build_;
    std::string core_, messages_;
};

}  // namespace tumble::host
