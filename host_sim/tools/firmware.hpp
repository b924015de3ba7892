// What the host builds for a core and runs in QEMU: the record firmware of `tumble compare`, and the firmware that
// measures a step. All of it throws std::runtime_error with the tool's own words when a tool fails.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace tumble::host {

// Throws BadArgument unless the name is that of a core that QEMU emulates.
void check_core(const std::string& name);

// Leaves a file that says the same alone, so that nothing is built again.
void write_if_changed(const std::filesystem::path& path, const std::string& text);

// Runs a command; its output is shown only in the exception that is thrown when it fails.
void run_quietly(const std::vector<std::string>& command);

// One user of a build directory at a time; the lock ends with the process.
class DirectoryLock {
public:
    explicit DirectoryLock(const std::filesystem::path& directory);
    ~DirectoryLock();
    DirectoryLock(const DirectoryLock&) = delete;
    DirectoryLock& operator=(const DirectoryLock&) = delete;

private:
    int file_;
};

// The number systems of firmware, under the names of kernel/include/tumble/numbers/variants.hpp.
struct NumberVariant {
    std::string name, numbers;
    bool carry;
};
[[nodiscard]] const std::vector<NumberVariant>& number_variants();

// Firmware that replays a scene and counts the instructions of every step: bench/firmware, for one core.
class StepFirmware {
public:
    // The core whose programs run natively, under valgrind, which counts the instructions of a mean step only.
    static constexpr const char* host = "host";

    // A program's name: "q32-Rk4".
    [[nodiscard]] static std::string name_of(const NumberVariant& variant, const std::string& integrator);

    // Configures the build directory. `scenes` is one header, which all programs replay, or a directory with a header
    // for each program, named after it; `scene` is the name of the struct in them. `integrators`: those that programs
    // are made of; all if there are none.
    StepFirmware(std::filesystem::path build, std::string core, const std::string& scene,
                 const std::filesystem::path& scenes, const std::vector<std::string>& integrators = {});

    // Builds programs, on all processors: about 20 s for all of a number system that replay one scene, and 4 s for each
    // that has a scene of its own. What cannot be built is reported by run().
    void build(const std::vector<std::string>& names);

    // The row that a program of the last build() prints, with text_bytes (all that lies in flash) and ram_bytes added.
    // The caller checks its state_hash. Ends the emulation after `timeout` s.
    struct Outcome {
        nlohmann::ordered_json row;
        std::string error;          // empty: the row is there
        bool does_not_fit = false;  // the core's memory is too small; no row and no error
    };
    [[nodiscard]] Outcome run(const std::string& name, int timeout = 900) const;

private:
    std::filesystem::path build_;
    std::string core_, messages_;
};

}  // namespace tumble::host
