// What the host simulator makes of every shipped scene with every integrator and the number systems it runs in: the
// lines that conformance.hpp prints. Arguments: the scene files.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <vector>

#include "firmware.hpp"
#include "scene_reader.hpp"
#include "simulation.hpp"

int main(int count, char** paths) try {
    using namespace tumble::host;
    std::vector<SceneDescription> scenes;
    for (int i = 1; i < count; ++i) scenes.push_back(read_scene(paths[i]));
    std::vector<NumberVariant> variants = number_variants();
    std::sort(variants.begin(), variants.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    for (const NumberVariant& variant : variants) {
        for (const IntegratorInfo& integrator : integrators()) {
            if (!runs_in(integrator, variant.numbers)) continue;
            for (const SceneDescription& scene : scenes) {
                const auto run = make_simulation(scene, integrator.name, variant.numbers, variant.carry);
                while (run->steps_taken() < run->steps() && run->troubles().empty()) run->step();
                std::printf("%s %s %s %lld %016llx\n", scene.name.c_str(), variant.name.c_str(),
                            integrator.name.c_str(), static_cast<long long>(run->steps_taken()),
                            static_cast<unsigned long long>(run->hash()));
            }
        }
    }
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
