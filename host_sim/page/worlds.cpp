// The worlds of the page, in place of the modules of the command. Those with joints and contacts run every scene: a
// second set of worlds would cost more than joints do.
#include <array>

#include "simulation/modules.hpp"
#include "simulation/number_systems.hpp"

namespace tumble::host {
namespace {

// The entries of number_system_list that the page has, as page/CMakeLists.txt lists them.
constexpr std::array<bool, number_system_count> is_there = [] {
    std::array<bool, number_system_count> there{};
    for (const int index : {TUMBLE_PAGE_SYSTEMS}) there.at(static_cast<std::size_t>(index)) = true;
    return there;
}();

template <std::size_t index>
std::unique_ptr<Simulation> make_at(std::size_t wanted, SceneData& data, std::string_view integrator) {
    if constexpr (index == number_system_count) return nullptr;
    else if (wanted != index) return make_at<index + 1>(wanted, data, integrator);
    else if constexpr (is_there[index]) return make_in<index, Part::joints_contacts>(std::move(data), integrator);
    else return nullptr;
}

}  // namespace

bool is_module_built(std::size_t index, const SceneData&, std::string_view) { return is_there[index]; }

std::unique_ptr<Simulation> make_in_module(std::size_t index, SceneData data, std::string_view integrator) {
    return make_at<0>(index, data, integrator);
}

}  // namespace tumble::host
