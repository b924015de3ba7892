#include "simulation/modules.hpp"

#include <dlfcn.h>

#include <array>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <string>

#include "simulation/number_systems.hpp"
#include "tools/files.hpp"
#include "tools/firmware.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;

using Maker = void (*)(SceneData, std::string_view, std::unique_ptr<Simulation>&);

void build(const std::string& module, const fs::path& file) {
    const DirectoryLock lock(file.parent_path());  // two builds of one directory would disturb each other
    if (!fs::exists(file)) run_quietly({"cmake", "--build", TUMBLE_BUILD_DIR, "--target", module});
}

// Modules stay loaded: simulations are of their code.
Maker load(std::size_t index) {
    const std::string module = "tumble_worlds_" + std::to_string(index);
    const fs::path file = fs::path(TUMBLE_BUILD_DIR) / "host_sim" / (module + ".so");
    if (!fs::exists(file)) build(module, file);
    void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* const maker = library == nullptr ? nullptr : dlsym(library, "tumble_make_simulation");
    if (maker == nullptr) throw std::runtime_error(std::string("cannot load worlds: ") + dlerror());
    return reinterpret_cast<Maker>(maker);
}

}  // namespace

std::unique_ptr<Simulation> make_in_module(std::size_t index, SceneData data, std::string_view integrator) {
    static std::array<Maker, number_system_count> makers{};
    static std::array<std::once_flag, number_system_count> loaded;
    std::call_once(loaded.at(index), [&] { makers[index] = load(index); });
    std::unique_ptr<Simulation> made;
    makers[index](std::move(data), integrator, made);
    return made;
}

}  // namespace tumble::host
