#include "simulation/simulation.hpp"

#include <tumble/integrators/list.hpp>
#include <tumble/shapes/pairs.hpp>

#include <algorithm>
#include <cmath>

#include "simulation/modules.hpp"
#include "simulation/number_systems.hpp"
#include "tools/text.hpp"
#include "truth/smooth_motion.hpp"

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
    throw std::invalid_argument("unknown " + std::string(what) + " " + in_quotes(name) + suggestion(name, names) +
                                ", expected one of " + joined(names));
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

std::string acts_on_fixed(const BodyDescription& body) {
    return "acts on body \"" + body.name + "\", which is fixed, so it has no effect";
}

// The name of a shape that touches no bodies, for a warning; empty for all others. A body without a shape is named as a
// point mass, because a warning is given for no other.
std::string_view passing_shape(ShapeKind shape) {
    if (touches_bodies(shape)) return "";
    switch (shape) {
    case ShapeKind::cylinder: return "a cylinder";
    case ShapeKind::hoop: return "a hoop";
    case ShapeKind::capsule: return "a capsule";
    case ShapeKind::points: return "a cloud of points";
    case ShapeKind::none: return "a point mass";
    default: return "";
    }
}

// The planes and bodies through which a body of such a shape may pass; empty: none. A body with moments and no shape is
// meant to touch nothing, so there is no warning.
std::string passed_by(const BodyDescription& body, const SceneDescription& scene) {
    const bool passes_planes = body.shape.kind == ShapeKind::points || body.is_point_mass();
    const bool planes = passes_planes && !body.fixed && !scene.planes.empty();
    const bool others =
        body.shape.kind != ShapeKind::none &&
        std::any_of(scene.bodies.begin(), scene.bodies.end(), [&](const BodyDescription& other) {
            return &other != &body && other.shape.kind != ShapeKind::none && !(body.fixed && other.fixed);
        });
    return std::string(planes ? "planes" : "") + (planes && others ? " and " : "") + (others ? "other bodies" : "");
}

// A force's impulse that differs by more than this part of its size gets a warning.
constexpr double impulse_tolerance = 0.1;

// The warning about a force whose impulse differs by more, because it acts in whole steps, between those nearest to its
// times. Empty for any other force.
std::string other_impulse(const ForceDescription& force, const SceneDescription& scene) {
    const double step = scene.step.seconds();
    const std::int64_t from = nearest_step(force.from, scene.step),
                       until = std::min(nearest_step(force.until, scene.step), scene.steps());
    if (from >= scene.steps()) return "begins when the last step has been taken, so it has no effect";
    const double wanted = std::min(force.until, static_cast<double>(scene.steps()) * step) - force.from,
                 given = static_cast<double>(until - from) * step;
    if (std::abs(given - wanted) <= impulse_tolerance * wanted) return {};
    const auto impulse = [&](double seconds) {
        const auto length = [](const Triple& v) { return std::hypot(v[0], v[1], v[2]); };
        const double linear = length(force.force), angular = length(force.torque);
        return (linear > 0 ? few_digits(linear * seconds) + " N s" : "") + (linear > 0 && angular > 0 ? " and " : "") +
               (angular > 0 ? few_digits(angular * seconds) + " N m s" : "");
    };
    if (impulse(wanted).empty()) return {};
    return "acts in " + std::to_string(until - from) + (until - from == 1 ? " step" : " steps") + " of " +
           few_digits(step) + " s, so its impulse is " + impulse(given) + " instead of " + impulse(wanted) +
           "; take a shorter step" + (until == from ? " or an impulse" : "");
}

// The bodies that overlap others or planes at the start, deeper than contacts allow.
void add_overlaps(const SceneDescription& scene, std::vector<std::string>& list) {
    for (const auto& overlap : SmoothMotion(scene, shapes_meet).overlaps()) {
        if (overlap.depth <= scene.contact.tolerance) continue;
        list.push_back("body \"" + scene.bodies[overlap.body].name + "\" begins " + few_digits(overlap.depth) +
                       " m inside " + (overlap.with_plane ? "plane" : "body") + " \"" +
                       (overlap.with_plane ? scene.planes[overlap.other].name : scene.bodies[overlap.other].name) +
                       "\", which pushes it out slowly");
    }
}

}  // namespace

bool default_carry(std::string_view numbers) {
    const auto& systems = number_systems();
    const auto first = std::ranges::find(systems, numbers, &NumberSystemInfo::name);
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
    return is_module_built(index_of(scene, numbers, carry), integrator);
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
    if (!has_range_for(scene, numbers)) throw SceneError(*scene.range.beyond_default);
}

void require_runs_in(const IntegratorInfo& integrator, std::string_view numbers) {
    if (runs_in(integrator, numbers)) return;
    std::vector<NumberSystemInfo> systems = number_systems();
    std::erase_if(systems, [&](const auto& info) { return !runs_in(integrator, info.name); });
    throw std::invalid_argument("integrator \"" + integrator.name + "\" does not run in " + std::string(numbers) +
                                ", because " + integrator.not_in_fixed_point + "; expected --numbers to be one of " +
                                joined(names_of(systems)));
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

std::vector<std::string> limitations(const SceneDescription& scene) {
    std::vector<std::string> list;
    const auto number_of_steps = scene.steps();
    for (std::size_t i = 0; i < scene.impulses.size(); ++i) {
        const double step = scene.impulses[i].time / scene.step.seconds();
        const BodyDescription& body = scene.bodies[static_cast<std::size_t>(scene.impulses[i].body)];
        const std::string impulse = "impulse[" + std::to_string(i) + "] ";
        if (body.fixed) list.push_back(impulse + acts_on_fixed(body));
        else if (step >= static_cast<double>(number_of_steps) - 0.5)
            list.push_back(impulse + "comes when the last step has been taken, so it has no effect");
    }
    for (std::size_t i = 0; i < scene.forces.size(); ++i) {
        const BodyDescription& body = scene.bodies[static_cast<std::size_t>(scene.forces[i].body)];
        const std::string other = body.fixed ? acts_on_fixed(body) : other_impulse(scene.forces[i], scene);
        if (!other.empty()) list.push_back("force[" + std::to_string(i) + "] " + other);
    }
    for (std::size_t i = 0; i < scene.events.size(); ++i) {
        const EventDescription& event = scene.events[i];
        const bool moves_fixed = event.kind == EventKind::pose || event.kind == EventKind::angular_velocity ||
                                 (event.kind == EventKind::velocity && scene.body(event.body).kinematic);
        const std::string name = "event[" + std::to_string(i) + "] ";
        if (scene.body(event.body).fixed && !moves_fixed) list.push_back(name + acts_on_fixed(scene.body(event.body)));
        else if (nearest_step(event.time, scene.step) >= number_of_steps)
            list.push_back(name + "comes when the last step has been taken, so it has no effect");
    }
    for (const BodyDescription& body : scene.bodies)
        if (body.fixed && !body.kinematic && body.velocity != Triple{})
            list.push_back("body \"" + body.name + "\" is fixed, so its velocity has no effect");
    if (scene.contact.response == ContactResponse::none) return list;
    if (scene.contact.response == ContactResponse::impulse) add_overlaps(scene, list);
    if (scene.contact.response == ContactResponse::spring) {
        const auto rough = [](const auto& side) { return side.friction.value_or(0.0) > 0; };
        if (scene.contact.friction > 0 || std::any_of(scene.bodies.begin(), scene.bodies.end(), rough) ||
            std::any_of(scene.planes.begin(), scene.planes.end(), rough))
            list.emplace_back("friction is not simulated with contact.response = \"spring\"");
        if (scene.contact.sleep) list.emplace_back("contact.sleep has no effect with contact.response = \"spring\"");
    }
    for (const BodyDescription& body : scene.bodies) {
        const std::string shape(passing_shape(body.shape.kind)), passed = passed_by(body, scene);
        if (!shape.empty() && !passed.empty())
            list.push_back("body \"" + body.name + "\": contacts of " + shape + " with " + passed +
                           " are not simulated, it passes through");
    }
    return list;
}

}  // namespace tumble::host
