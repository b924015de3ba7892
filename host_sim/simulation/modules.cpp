#include "simulation/modules.hpp"

#include <dlfcn.h>

#include <array>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <string>

#include "simulation/number_systems.hpp"
#include "sources_digest.hpp"
#include "tools/files.hpp"
#include "tools/firmware.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;

using Maker = void (*)(SceneData, std::string_view, std::unique_ptr<Simulation>&);

// Null for a file that is not there, and for a module of other sources than this program's.
Maker load(const fs::path& file) {
    void* const library = fs::exists(file) ? dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL) : nullptr;
    if (library == nullptr) return nullptr;
    const auto* const digest = static_cast<const char*>(dlsym(library, "tumble_sources_digest"));
    if (digest != nullptr && digest == std::string_view{TUMBLE_SOURCES_DIGEST})
        return reinterpret_cast<Maker>(dlsym(library, "tumble_make_simulation"));
    dlclose(library);
    return nullptr;
}

// Modules stay loaded: simulations are of their code.
Maker load_or_build(std::size_t index) {
    const std::string module = "tumble_worlds_" + std::to_string(index);
    const fs::path file = fs::path(TUMBLE_BUILD_DIR) / "host_sim" / (module + ".so");
    if (const Maker maker = load(file)) return maker;
    const DirectoryLock lock(file.parent_path());  // two builds of one directory would disturb each other
    if (const Maker maker = load(file)) return maker;
    run_quietly({"cmake", "--build", TUMBLE_BUILD_DIR, "--target", module});
    if (const Maker maker = load(file)) return maker;
    const char* const why = dlerror();
    throw std::runtime_error("cannot load the worlds of " + file.string() + ": " +
                             (why != nullptr ? why : "their sources are not this program's; build it again"));
}

}  // namespace

std::unique_ptr<Simulation> make_in_module(std::size_t index, SceneData data, std::string_view integrator) {
    static std::array<Maker, number_system_count> makers{};
    static std::array<std::once_flag, number_system_count> loaded;
    std::call_once(loaded.at(index), [&] { makers[index] = load_or_build(index); });
    std::unique_ptr<Simulation> made;
    makers[index](std::move(data), integrator, made);
    return made;
}

}  // namespace tumble::host
