#include "simulation/modules.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "simulation/number_systems.hpp"
#include "sources_digest.hpp"
#include "tools/files.hpp"
#include "tools/process.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;

using Maker = void (*)(SceneData, std::string_view, std::unique_ptr<Simulation>&);

// True if the module was built from the same sources as this program, by the digest beside it.
bool is_current(const fs::path& file) {
    return fs::exists(file) && contents_of(fs::path{file}.replace_extension(".digest.hpp"))
                                       .find('"' + std::string{TUMBLE_SOURCES_DIGEST} + '"') != std::string::npos;
}

// The part of each number system that an integrator is in, for scenes without joints.
std::array<Part, number_system_count> parts_of(std::string_view integrator) {
    std::array<Part, number_system_count> parts{};
    std::size_t index = 0;
    const auto add = [&]<class N>(const System<N>&) {
        Integrators::for_each([&]<class Method>() {
            if (integrator == Method::name) parts[index] = part_of<N, Method>();
        });
        ++index;
    };
    std::apply([&](const auto&... systems) { (add(systems), ...); }, number_system_list);
    return parts;
}

Part part_of(std::size_t index, const SceneData& data, std::string_view integrator) {
    if (data.joints.empty()) return parts_of(integrator).at(index);
    return needs(data).touches() ? Part::joints_contacts : Part::joints;
}

// How the name of its module ends, and what it has, by Part.
constexpr std::array<std::pair<const char*, const char*>, 4> part_names{
    {{"", "the first methods of "},
     {"_rest", "the other methods of "},
     {"_joints", "joints in "},
     {"_joints_contacts", "joints and contacts in "}}};
const auto& name_of(Part part) { return part_names.at(static_cast<std::size_t>(part)); }

// The name of a module, as host_sim/CMakeLists.txt makes it.
std::string module_name(std::size_t index, Part part) {
    const auto joined = [](const auto& system) {
        return std::string(system.entry) + (system.range.empty() ? "" : "_") + std::string(system.range);
    };
    const auto names =
        std::apply([&](const auto&... systems) { return std::array{joined(systems)...}; }, number_system_list);
    return "tumble_worlds_" + names.at(index) + name_of(part).first;
}

fs::path file_of(const std::string& module) { return fs::path(TUMBLE_BUILD_DIR) / "host_sim" / (module + ".so"); }

// Modules stay loaded, because simulations run their code.
Maker load(std::size_t index, Part part) {
    const std::string module = module_name(index, part);
    const fs::path file = file_of(module);
    const NumberSystemInfo& system = number_systems()[index];
    if (!is_current(file)) {
        const DirectoryLock lock(file.parent_path());  // two builds of one directory would disturb each other
        if (!is_current(file)) {
            if (isatty(STDERR_FILENO) == 1)  // as Progress: the errors of a run that is right are empty
                std::cerr << "tumble: compiling " << name_of(part).second << numbers_text(system.name, system.carry)
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

bool is_module_built(std::size_t index, const SceneData& data, std::string_view integrator) {
    return is_current(file_of(module_name(index, part_of(index, data, integrator))));
}

std::unique_ptr<Simulation> make_in_module(std::size_t index, SceneData data, std::string_view integrator) {
    constexpr std::size_t parts = part_names.size();
    static std::array<Maker, number_system_count * parts> makers{};
    static std::array<std::once_flag, makers.size()> loaded;
    const Part part = part_of(index, data, integrator);
    const std::size_t module = index * parts + static_cast<std::size_t>(part);
    std::call_once(loaded.at(module), [&] { makers[module] = load(index, part); });
    std::unique_ptr<Simulation> made;
    makers[module](std::move(data), integrator, made);
    return made;
}

}  // namespace tumble::host
