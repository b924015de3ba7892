// Flash, memory and cost of a step at -O2 and at -Os: a row for each scene, core and level, of the default method in
// the default numbers. A row is written only if its state hash is the host's.
#include "command/command.hpp"
#include "rows.hpp"
#include "tools/files.hpp"
#include "variants.hpp"

#include <CLI/CLI.hpp>

#include <iostream>

namespace {

namespace fs = std::filesystem;
using tumble::bench::Row, tumble::host::StepFirmware;

constexpr const char *method = "verlet", *numbers = "q32";
constexpr const char* levels[]{"-O2", "-Os"};

Row measured(const fs::path& scene_file, const std::string& core, const std::string& level) {
    const auto scene = tumble::host::read_scene(scene_file, tumble::host::BodyCount::any);
    const fs::path work = fs::path{"build/optimization"} / (scene_file.stem().string() + level);
    fs::create_directories(work);
    const fs::path header = fs::absolute(work / "scene.hpp");
    tumble::host::write_if_changed(header, tumble::host::compiled_scene(scene, {}));
    StepFirmware firmware{work / core, core,     tumble::host::struct_name(scene_file.string()),
                          header,      {method}, StepFirmware::Lines::none,
                          level};
    const std::string program = StepFirmware::name_of(tumble::host::variant_of(numbers, true), method);
    firmware.build({program});
    tumble::host::StepOutcome outcome = firmware.run(program);
    if (!outcome.error.empty() || !outcome.shortage.empty())
        throw std::runtime_error{scene_file.string() + ", " + core + ", " + level + ": " + outcome.error +
                                 outcome.shortage};
    tumble::host::check_state(outcome.row, *tumble::host::make_simulation(scene, method, numbers, true), program);
    outcome.row["flags"] = level;
    return outcome.row;
}

}  // namespace

int main(int argc, char** argv) try {
    tumble::host::tell_lost_output();
    CLI::App app{"Measures what a step takes at -O2 and at -Os."};
    std::vector<fs::path> scenes;
    std::vector<std::string> cores;
    fs::path results = "build/results/optimization.jsonl";
    app.add_option("scenes", scenes, "Scene files")->required();
    app.add_option("--cores", cores, "Cores to run on")->delimiter(',')->required();
    app.add_option("--results", results, "Where the rows go, as JSON lines");
    CLI11_PARSE(app, argc, argv);
    tumble::host::check_outputs(tumble::bench::files_of("a scene", scenes), {{"--results", results}});
    tumble::host::OutputFile file = tumble::bench::rows_file(results);
    std::vector<Row> rows;
    for (const fs::path& scene : scenes)
        for (const std::string& core : cores)
            for (const char* level : levels) {
                rows.push_back(measured(scene, core, level));
                std::cout << scene.string() << ' ' << core << ' ' << level << ": " << rows.back().at("text_bytes")
                          << " bytes of flash\n";
            }
    tumble::bench::write_rows(file, rows);
    return 0;
} catch (...) { return tumble::bench::report_failure("tumble_optimization"); }
