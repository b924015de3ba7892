// Measures the cost of a step of several methods on a core.
#pragma once

#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/firmware.hpp"
#include "scene/description.hpp"
#include "tools/files.hpp"

namespace tumble::host {

// A method in a number system, and the scene that its firmware replays.
struct StepProgram {
    NumberVariant variant;
    std::string integrator;
    SceneDescription scene;
    std::string header;  // of the scene
};

class Measurement {
public:
    // Builds in a directory of its own, which it makes and locks. `scene` names the struct in all headers.
    Measurement(const std::filesystem::path& build, const std::string& core, const std::string& scene);

    // The row of each program by StepFirmware; null where the program does not fit the core's memory. Throws
    // std::runtime_error where a program cannot be built or run, or ends with another state than the host's.
    [[nodiscard]] std::vector<nlohmann::ordered_json> rows_of(const std::vector<StepProgram>& programs);

private:
    std::filesystem::path scenes_;
    std::string core_;
    DirectoryLock lock_;
    StepFirmware firmware_;
};

}  // namespace tumble::host
