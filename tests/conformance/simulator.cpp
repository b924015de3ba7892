// What the host simulator makes of every shipped scene with every integrator and the number systems it runs in: the
// lines that conformance.hpp prints, and behind them steps and hash once more, after TUMBLE_FIRST_STEPS. Arguments: the
// names of the number systems and those of the integrators, each joined by commas or `all`, and the scene files;
// --first before them: the first steps alone; or --suite, names of number systems without ranges, and those of scenes,
// of which the first steps are replayed with the default integrator, and there is one hash.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/firmware.hpp"
#include "scene/scene_file.hpp"
#include "simulation/simulation.hpp"
#include "tools/output.hpp"
#include "tools/text.hpp"

namespace {

// True if a name is among others that are joined by commas, or these are `all`.
bool is_among(std::string_view name, std::string_view names) {
    const std::string list = "," + std::string(names) + ",", entry = "," + std::string(name) + ",";
    return names == "all" || list.find(entry) != list.npos;
}

}  // namespace

int main(int count, char** arguments) try {
    using namespace tumble::host;
    tell_lost_output();
    const std::string_view option = count > 1 ? arguments[1] : "";
    const bool is_suite = option == "--suite", first_alone = option == "--first";
    const int first_name = first_alone || is_suite ? 2 : 1, first_scene = first_name + (is_suite ? 1 : 2);
    if (count < first_scene) throw std::runtime_error("expected --suite, or number systems and integrators");
    const std::string_view systems = arguments[first_name];
    const std::string_view methods = is_suite ? "verlet" : arguments[first_name + 1];
    std::vector<SceneDescription> scenes;
    for (int i = first_scene; i < count; ++i) scenes.push_back(read_scene(arguments[i]));
    std::vector<NumberVariant> variants = number_variants();
    std::sort(variants.begin(), variants.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    for (const NumberVariant& variant : variants) {
        if (!is_among(variant.name, systems)) continue;
        for (const IntegratorInfo& integrator : integrators()) {
            if (!runs_in(integrator, variant.numbers) || !is_among(integrator.name, methods)) continue;
            for (const SceneDescription& scene : scenes) {
                const auto run = make_simulation(scene, integrator.name, variant.numbers, variant.carry);
                const auto most = is_suite ? 4096 / static_cast<std::int64_t>(scene.bodies.size()) : run->steps();
                const auto answer_after = [&](std::int64_t steps) {
                    while (run->steps_taken() < steps && run->troubles().empty()) run->step();
                    return " " + std::to_string(run->steps_taken()) + " " + hex(run->hash());
                };
                const std::int64_t whole = std::min(run->steps(), most);
                const std::string first = answer_after(std::min<std::int64_t>(whole, TUMBLE_FIRST_STEPS));
                std::printf("%s %s %s%s%s\n", scene.name.c_str(), variant.name.c_str(), integrator.name.c_str(),
                            first_alone ? "" : answer_after(whole).c_str(), is_suite ? "" : first.c_str());
            }
        }
    }
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
