#include "worlds.hpp"

#include <tumble/integrators/list.hpp>

#include <algorithm>
#include <ostream>
#include <stdexcept>

namespace tumble::test {

const std::vector<Method>& methods() {
    static const std::vector<Method> all = [] {
        std::vector<Method> list;
        Integrators::for_each([&]<class M>() {
            int free_order = M::order;
            if constexpr (requires { M::free_order; }) free_order = M::free_order;
            bool keeps = true;
            if constexpr (requires { M::keeps_the_spin_of_spheres; }) keeps = M::keeps_the_spin_of_spheres;
            constexpr bool is_exact = requires { M::exact_for_spheres; };
            list.push_back({M::name, M::order, free_order, M::spin == Spin::angular_momentum, is_exact, keeps,
                            M::oscillation_limit, M::drag_limit});
        });
        return list;
    }();
    return all;
}

bool has_number_system(std::string_view name) {
    return std::any_of(number_systems().begin(), number_systems().end(),
                       [&](const System& s) { return name == s.name; });
}
bool has_minimal_worlds(std::string_view system) {
    return std::any_of(minimal_worlds().begin(), minimal_worlds().end(),
                       [&](const MinimalWorlds& m) { return system == m.system; });
}
const System& number_system(std::string_view name) {
    for (const System& s : number_systems())
        if (name == s.name) return s;
    throw std::invalid_argument{"no number system " + std::string{name}};
}

std::vector<Case> every_case() {
    std::vector<Case> cases;
    for (const System& s : number_systems())
        for (const Method& m : methods())
            if (s.has(m.name)) cases.push_back({m, s});
    return cases;
}
std::vector<Case> cases_in(std::string_view system) {
    std::vector<Case> cases;
    for (const Case& c : every_case())
        if (system == c.system.name) cases.push_back(c);
    return cases;
}
std::vector<Case> cases_of(std::string_view method) {
    std::vector<Case> cases;
    for (const Case& c : every_case())
        if (method == c.method.name) cases.push_back(c);
    return cases;
}
std::string name_of(const Case& c) { return std::string{c.method.name} + "_" + c.system.name; }
void PrintTo(const Case& c, std::ostream* out) { *out << name_of(c); }

std::vector<EventSpec> events_of(const std::vector<TimedImpulse>& impulses, const std::vector<TimedForce>& forces) {
    std::vector<EventSpec> events;
    for (const TimedImpulse& i : impulses) {
        events.push_back({i.time, EventKind::impulse, i.body, i.frame, i.impulse, i.point});
        if (!i.angular_impulse.is_zero())
            events.push_back({i.time, EventKind::angular_impulse, i.body, i.frame, i.angular_impulse});
    }
    for (const TimedForce& f : forces) {
        events.push_back({f.from, EventKind::begin_force, f.body, f.frame, f.force, f.point});
        events.push_back({f.until, EventKind::end_force, f.body, f.frame, f.force, f.point});
        if (f.torque.is_zero()) continue;
        events.push_back({f.from, EventKind::begin_torque, f.body, f.frame, f.torque});
        events.push_back({f.until, EventKind::end_torque, f.body, f.frame, f.torque});
    }
    return events;
}

namespace {

std::unique_ptr<AnyWorld> fill(std::unique_ptr<AnyWorld> world, const SceneSetup& setup) {
    const auto require = [&](bool done) {
        if (!done) throw std::invalid_argument{std::string{"cannot build "} + setup.name};
    };
    require(world != nullptr);
    if (setup.start > 0) world->start_at(setup.start);
    for (const auto& b : setup.bodies) require(world->add(b));
    for (const auto& p : setup.planes) require(world->add(p));
    for (const auto& s : setup.springs) require(world->add(s));
    const std::vector<EventSpec> events = events_of(setup.impulses, setup.forces);
    if (!events.empty()) world->set_events(events);
    return world;
}

}  // namespace

std::unique_ptr<AnyWorld> build(const SceneSetup& setup, std::string_view method, std::string_view system) {
    return fill(number_system(system).make(method, setup.step, setup.world), setup);
}
std::unique_ptr<AnyWorld> build_minimal(const SceneSetup& setup, const Case& c) {
    for (const MinimalWorlds& m : minimal_worlds()) {
        if (c.system.name != std::string_view{m.system} || m.features != setup.needs) continue;
        auto world = m.make(c.method.name, setup.step, setup.world);
        return world == nullptr ? nullptr : fill(std::move(world), setup);
    }
    return nullptr;
}

}  // namespace tumble::test
