#include "simulation/simulation.hpp"

#include <tumble/integrators/list.hpp>

#include <algorithm>

#include "simulation/modules.hpp"
#include "simulation/number_systems.hpp"
#include "tools/raise.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

// The type's name in C++, as the compiler spells it in this function's own name.
template <class T>
std::string type_name() {
    const std::string_view name = __PRETTY_FUNCTION__;
    const std::size_t first = name.find("T = ") + 4;
    return std::string(name.substr(first, name.find_first_of(";]", first) - first));
}

// A number system in C++, by its name in the kernel's list; floating point takes any range.
std::string type_of(std::string_view entry, std::string_view range) {
    const std::string of_range =
        range.empty() ? "tumble::RoomRange" : "tumble::RangeOf<\"" + std::string(range) + "\">";
    return "tumble::NumbersOf<\"" + std::string(entry) + "\", " + of_range + ">";
}

// Each name once: number systems of one name differ in range and carry.
template <class Info>
std::vector<std::string> names_of(const std::vector<Info>& infos) {
    std::vector<std::string> names;
    for (const Info& info : infos)
        if (std::find(names.begin(), names.end(), info.name) == names.end()) names.push_back(info.name);
    return names;
}

template <class Info>
[[noreturn]] void refuse_name(const char* what, std::string_view name, const std::vector<Info>& infos) {
    const std::vector<std::string> names = names_of(infos);
    raise(std::invalid_argument("unknown " + std::string(what) + " " + in_quotes(name) + suggestion(name, names) +
                                ", expected one of " + joined(names)));
}

bool holds(std::string_view range, const SceneDescription& scene) {
    if (range.empty()) return true;
    const RangeDescription &needed = scene.range, held = held_by(range);
    const double spin = scene.has_rotation() ? needed.angular_velocity : 0.0;
    return needed.position <= held.position && needed.velocity <= held.velocity && spin <= held.angular_velocity;
}

std::size_t index_of(const SceneDescription& scene, std::string_view numbers, std::optional<bool> carry) {
    const auto& systems = number_systems();
    const bool has_carry = carry ? *carry : default_carry(numbers);
    std::size_t found = systems.size();
    for (std::size_t i = 0; i < systems.size(); ++i) {
        if (systems[i].name != numbers || systems[i].carry != has_carry) continue;
        found = i;
        if (holds(systems[i].range, scene)) break;
    }
    if (found == systems.size()) refuse_name("number system", numbers, systems);
    return found;
}

bool is_fixed_point(std::string_view numbers) {
    const auto& all = number_systems();
    return std::any_of(all.begin(), all.end(),
                       [&](const NumberSystemInfo& info) { return info.name == numbers && info.fixed_point; });
}

}  // namespace

bool default_carry(std::string_view numbers) {
    const auto& systems = number_systems();
    const auto first = std::find_if(systems.begin(), systems.end(),
                                    [&](const NumberSystemInfo& info) { return info.name == numbers; });
    if (first == systems.end()) refuse_name("number system", numbers, systems);
    return first->carry;
}

bool Simulation::has_trouble(std::string_view issue) const {
    return std::any_of(troubles().begin(), troubles().end(),
                       [&](const Trouble& trouble) { return trouble.issue == issue; });
}

std::uint64_t finish(Simulation& simulation) {
    while (simulation.steps_taken() < simulation.steps() && simulation.troubles().empty()) simulation.step();
    return simulation.hash();
}

std::unique_ptr<Simulation> make_simulation(const SceneDescription& scene, std::string_view integrator,
                                            std::string_view numbers, std::optional<bool> carry) {
    const IntegratorInfo& method = find_integrator(integrator);
    const std::size_t system = index_of(scene, numbers, carry);
    require_runs_in(method, numbers);
    require_range(scene, numbers);
    return make_in_module(system, build_scene(scene), method.name);
}

bool is_compiled(const SceneDescription& scene, std::string_view integrator, std::string_view numbers,
                 std::optional<bool> carry) {
    return is_module_built(index_of(scene, numbers, carry), build_scene(scene), integrator);
}

const std::vector<IntegratorInfo>& integrators() {
    static const std::vector<IntegratorInfo> list = [] {
        std::vector<IntegratorInfo> infos;
        Integrators::for_each([&]<class Method>() {
            std::string needs;
            if constexpr (requires { Method::needs; }) needs = Method::needs;
            std::string not_in_fixed_point;
            if constexpr (requires { Method::not_in_fixed_point; }) not_in_fixed_point = Method::not_in_fixed_point;
            int free_order = Method::order;
            if constexpr (requires { Method::free_order; }) free_order = Method::free_order;
            infos.push_back({Method::name, type_name<Method>(), Method::order, free_order, needs, not_in_fixed_point,
                             Method::oscillation_limit, Method::drag_limit, &Method::oscillator_step, Method::spin,
                             host::is_usual<Method>()});
        });
        return infos;
    }();
    return list;
}

const std::vector<NumberSystemInfo>& number_systems() {
    static const std::vector<NumberSystemInfo> list = [] {
        std::vector<NumberSystemInfo> infos;
        const auto add = [&]<class N>(const System<N>& system) {
            infos.push_back({N::name, N::what, type_of(system.entry, system.range), std::string(system.range), N::carry,
                             N::fixed_point});
        };
        std::apply([&](const auto&... systems) { (add(systems), ...); }, number_system_list);
        return infos;
    }();
    return list;
}

const IntegratorInfo& find_integrator(std::string_view name) {
    const auto& all = integrators();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const IntegratorInfo& info) { return info.name == name; });
    if (found == all.end()) refuse_name("integrator", name, all);
    return *found;
}

bool runs_in(const IntegratorInfo& integrator, std::string_view numbers) {
    return integrator.not_in_fixed_point.empty() || !is_fixed_point(numbers);
}

bool has_range_for(const SceneDescription& scene, std::string_view numbers) {
    return !scene.range.beyond_default || !is_fixed_point(numbers);
}

void require_range(const SceneDescription& scene, std::string_view numbers) {
    if (!has_range_for(scene, numbers)) raise(SceneError(*scene.range.beyond_default));
}

void require_runs_in(const IntegratorInfo& integrator, std::string_view numbers) {
    if (runs_in(integrator, numbers)) return;
    std::vector<NumberSystemInfo> systems = number_systems();
    std::erase_if(systems, [&](const auto& info) { return !runs_in(integrator, info.name); });
    raise(std::invalid_argument("integrator \"" + integrator.name + "\" does not run in " + std::string(numbers) +
                                ", because " + integrator.not_in_fixed_point + "; expected --numbers to be one of " +
                                joined(names_of(systems))));
}

RangeDescription held_by(std::string_view range) {
    RangeDescription held;
    Ranges::for_each([&]<class Named>() {
        using R = typename Named::Range;
        if (range == Named::name) held = {R::position, R::velocity, R::spin};
    });
    return held;
}

const NumberSystemInfo& find_number_system(const SceneDescription& scene, std::string_view numbers,
                                           std::optional<bool> carry) {
    return number_systems()[index_of(scene, numbers, carry)];
}

}  // namespace tumble::host
