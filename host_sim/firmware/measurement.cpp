#include "firmware/measurement.hpp"

#include <stdexcept>

#include "tools/parallel.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;

fs::path made(const fs::path& directory) {
    fs::create_directories(directory);
    return directory;
}

}  // namespace

Measurement::Measurement(const fs::path& build, const std::string& core, const std::string& scene)
    : scenes_(made(build / "scenes")), core_(core), lock_(build), firmware_(build, core, scene, scenes_) {}

std::vector<nlohmann::ordered_json> Measurement::rows_of(const std::vector<StepProgram>& programs) {
    std::vector<std::string> names;
    for (const StepProgram& program : programs) {
        names.push_back(StepFirmware::name_of(program.variant, program.integrator));
        write_if_changed(scenes_ / (names.back() + ".hpp"), program.header);
    }
    firmware_.build(names);
    std::vector<nlohmann::ordered_json> rows(programs.size());
    in_parallel(programs.size(), [&](std::size_t i) {
        const auto& [variant, integrator, scene, header] = programs[i];
        const std::string name = core_ + ", " + names[i];
        StepOutcome outcome = firmware_.run(names[i]);
        if (!outcome.shortage.empty()) return;
        if (!outcome.error.empty()) throw std::runtime_error(name + ": " + outcome.error);
        check_state(outcome.row, *make_simulation(scene, integrator, variant.numbers, variant.carry), name);
        rows[i] = std::move(outcome.row);
    });
    return rows;
}

}  // namespace tumble::host
