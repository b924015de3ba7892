// Golden trajectories: the hash of the state after given numbers of steps, for every scene, integrator and number
// system. The hashes are the same for every compiler, optimisation level and machine. After a change that is meant to
// change bits, write the files anew with `make golden` and commit them with the change.
#include "scenes.hpp"

#include <cinttypes>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <utility>

namespace tumble::test {
namespace {

constexpr int checkpoints[] = {1, 16, 128, 1024};  // steps

// The state's digests at the checkpoints, in hex.
std::vector<std::string> digests_of(const SceneSetup& scene, const Case& c) {
    const auto world = build(scene, c);
    std::vector<std::string> digests;
    int done = 0;
    for (const int steps : checkpoints) {
        world->run(steps - std::exchange(done, steps));
        char text[20];
        std::snprintf(text, sizeof text, "%016" PRIx64, world->hash());
        digests.emplace_back(text);
    }
    return digests;
}

std::string path_of(const SceneSetup& scene) { return std::string{TUMBLE_GOLDEN_DIR "/"} + scene.name + ".txt"; }

class Golden : public testing::TestWithParam<SceneSetup> {};
std::string name_of_scene(const testing::TestParamInfo<SceneSetup>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(scene, Golden, testing::ValuesIn(scenes()), name_of_scene);

void write(const SceneSetup& scene) {
    ASSERT_TRUE(has_number_system("f64_carried")) << "kernel_tests_deep has every number system to write";
    std::ofstream file{path_of(scene)};
    file << "# " << scene.name << ": integrator, number system, digest of the state after";
    for (const int steps : checkpoints) file << " " << steps;
    file << " steps\n";
    for (const Case& c : every_case()) {
        file << c.method.name << " " << c.system.name;
        for (const std::string& digest : digests_of(scene, c)) file << " " << digest;
        file << "\n";
    }
    ASSERT_TRUE(file.good()) << path_of(scene);
}

TEST_P(Golden, every_integrator_and_number_system_gives_the_recorded_bits) {
    const SceneSetup& scene = GetParam();
    if (std::getenv("TUMBLE_UPDATE_GOLDEN") != nullptr) write(scene);

    std::map<std::string, std::string> recorded;  // "integrator system" to digests
    std::ifstream file{path_of(scene)};
    ASSERT_TRUE(file.good()) << "no " << path_of(scene);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words{line};
        std::string method, system;
        words >> method >> system >> std::ws;
        std::getline(words, recorded[method + " " + system]);
    }
    for (const Case& c : every_case()) {
        const auto found = recorded.find(std::string{c.method.name} + " " + c.system.name);
        if (found == recorded.end()) {
            ADD_FAILURE() << scene.name << ": nothing recorded for " << name_of(c);
            continue;
        }
        std::istringstream digests{found->second};
        const int* steps = checkpoints;
        for (const std::string& digest : digests_of(scene, c)) {
            std::string expected;
            digests >> expected;
            EXPECT_EQ(digest, expected) << scene.name << ", " << name_of(c) << ", step " << *steps;
            if (digest != expected) break;  // as all after it
            ++steps;
        }
    }
}

}  // namespace
}  // namespace tumble::test
