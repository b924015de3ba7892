// Firmware that the host builds for a core and runs in QEMU: the one that records states, for `tumble compare`, and the
// one that measures a step. All functions throw std::runtime_error with the tool's message when a tool fails.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "simulation/simulation.hpp"
#include "tools/process.hpp"

namespace tumble::host {

// A row of port/boards.txt, with the compiler and the tools of its port from port/families.txt.
struct Core {
    std::string name, port, machine, counter, timing, set;  // the columns, which the file explains
    std::vector<std::string> numbers;  // number systems that suit the core, named as in NumberVariant
    double clock = 0;                  // Hz; 0 where the row has none
    std::string flags;
    std::string compiler, tools;

    // Does the compiler take GCC's options?
    [[nodiscard]] bool compiled_by_gcc() const { return compiler.ends_with("-g++"); }
    // The name of a binary utility, "size".
    [[nodiscard]] std::string tool(const std::string& name) const;
    // Does port/qemu/cycles have a timing table of its instructions?
    [[nodiscard]] bool has_cycles() const { return timing != "-"; }
    // Are its instructions counted? Their number is the same in every run.
    [[nodiscard]] bool has_insn() const { return counter.starts_with("insn"); }
    // A Cortex-M7 issues at most two instructions a cycle, so it takes at least half as many cycles as instructions.
    [[nodiscard]] bool issues_two() const { return flags.find("-mcpu=cortex-m7") != std::string::npos; }
};
[[nodiscard]] std::vector<Core> cores();
// Throws std::invalid_argument for an unknown name.
[[nodiscard]] Core core_named(const std::string& name);

// "needs 8688 bytes of RAM more than cortex-m0 has", from the linker's messages; empty where the memory is large
// enough.
[[nodiscard]] std::string memory_shortage(const std::string& messages, const std::string& core);

// Builds the firmware that replays a scene and writes its states: port/programs/record. `scene` is the directory of
// scene.hpp and recording.hpp; a build directory always has the same one.
[[nodiscard]] std::filesystem::path build_record_firmware(const std::filesystem::path& build, const std::string& core,
                                                          const std::filesystem::path& scene);

// Starts a program in QEMU, which ends after `timeout` s at the latest. `options` are those of port/qemu/run.
[[nodiscard]] Process run_in_qemu(const std::string& core, const std::filesystem::path& elf, int timeout,
                                  const std::vector<std::string>& options = {});

// A number system of the kernel that firmware can use: its name in the kernel's list, the name of its type, and carry.
struct NumberVariant {
    std::string name, numbers;
    bool carry;
};
[[nodiscard]] const std::vector<NumberVariant>& number_variants();
[[nodiscard]] const NumberVariant& variant_of(const std::string& numbers, bool carry);

// The result of firmware that measures a step.
struct StepOutcome {
    nlohmann::ordered_json row;
    std::string error;     // empty: there is a row
    std::string shortage;  // from memory_shortage(); not empty: there is neither row nor error
};

// The function that firmware measures, by a part of its symbol. The firmware's own count has `insn_of_call`
// instructions more: the call, and moves of the counter's value and of the function's result.
struct MeasuredStep {
    std::string function = "step_world";
    int insn_of_call = 4;
};

// Runs such firmware in QEMU and returns the row that it prints; bench/KEYS.md explains the keys. On a core with a
// timing table the row has the cycles of the step. It is an error if an instruction has no timing, or if plugin and
// firmware count different numbers of instructions. `reports` are further outputs of the plugin, as "places=FILE"
// (port/qemu/cycles/report.hpp).
[[nodiscard]] StepOutcome run_step_program(const Core& core, const std::filesystem::path& elf, int timeout = 900,
                                           const MeasuredStep& step = {}, const std::vector<std::string>& reports = {});

// Adds the sizes of a program to its row: text_bytes (everything in flash), code_bytes, rodata_bytes, ram_bytes.
void add_sizes(nlohmann::ordered_json& row, const std::filesystem::path& elf);

// Runs the simulation to its end. Throws where its final state differs from that of the row.
void check_state(const nlohmann::ordered_json& row, Simulation& simulation, const std::string& program);

// Firmware for one core that replays a scene and counts the instructions of every step: port/programs/step.
class StepFirmware {
public:
    // The name of the host as a core. Its programs run under valgrind, which counts the instructions of a mean step
    // only.
    static constexpr const char* host = "host";

    // A program's name: "q32-Rk4".
    [[nodiscard]] static std::string name_of(const NumberVariant& variant, const std::string& integrator);

    // How its programs are compiled.
    struct Compilation {
        std::string level = "-O2";
        bool has_lines = false;    // debug information, which does not change the code of a step
        bool is_separate = false;  // each method by itself, as a firmware has it. Methods that are compiled together
                                   // share functions, which can make their steps dearer
    };

    // Configures the build directory. `scenes` is one header for all programs, or a directory that has a header for
    // each program, named after it. `scene` is the name of the struct in the headers. Programs are made of the
    // integrators that are given, or of all where none is.
    StepFirmware(std::filesystem::path build, std::string core, const std::string& scene,
                 const std::filesystem::path& scenes, const std::vector<std::string>& integrators,
                 const Compilation& compilation);

    // Builds programs on all processors. All programs of a number system that replay one scene take about 20 s; a
    // program that has a scene of its own takes 4 s. run() reports programs that could not be built.
    void build(const std::vector<std::string>& names);

    // Calls run_step_program() for a program of the last build() and adds its sizes, and on a Cortex-M
    // step_stack_bound_bytes. The caller checks state_hash.
    [[nodiscard]] StepOutcome run(const std::string& name, int timeout = 900,
                                  const std::vector<std::string>& reports = {}) const;

private:
    std::filesystem::path build_;
    std::string core_, messages_;
};

}  // namespace tumble::host
