#include "simulation/modules.hpp"

#include <dlfcn.h>

#include <array>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <string>

#include "simulation/number_systems.hpp"
#include "sources_digest.hpp"
#include "tools/files.hpp"
#include "tools/process.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;

using Maker = void (*)(SceneData, std::string_view, std::unique_ptr<Simulation>&);

// True of a module of the sources that this program is of: the digest beside it says so.
bool is_current(const fs::path& file) {
    return fs::exists(file) && contents_of(fs::path{file}.replace_extension(".digest.hpp"))
                                       .find('"' + std::string{TUMBLE_SOURCES_DIGEST} + '"') != std::string::npos;
}

// Modules stay loaded: simulations are of their code.
Maker load(std::size_t index) {
    const std::string module = "tumble_worlds_" + std::to_string(index);
    const fs::path file = fs::path(TUMBLE_BUILD_DIR) / "host_sim" / (module + ".so");
    const NumberSystemInfo& system = number_systems()[index];
    if (!is_current(file)) {
        const DirectoryLock lock(file.parent_path());  // two builds of one directory would disturb each other
        if (!is_current(file)) {
            std::cerr << "tumble: building the worlds of " << numbers_text(system.name, system.carry)
                      << (system.range.empty() ? "" : " of range ") << system.range << "\n";
            run_quietly({"cmake", "--build", TUMBLE_BUILD_DIR, "--target", module});
        }
        if (!is_current(file)) throw std::runtime_error("the sources have changed: build this program again");
    }
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
