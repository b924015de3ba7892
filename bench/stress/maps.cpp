#include "stress/maps.hpp"

#include <stdexcept>

namespace tumble::bench::stress {
namespace {

// One a line, in the order of rows.
constexpr std::unique_ptr<Map> (*makers[])() = {
    make_free_rotation,   make_springs,
    make_pendulum,        make_heavy_top,
    make_orbits,          make_drag,
    make_bounce_speed,    make_bounce_restitution,
    make_friction,        make_mass_ratio_impact,
    make_mass_ratio_pile, make_stack,
};

}  // namespace

const std::vector<std::unique_ptr<Map>>& maps() {
    static const std::vector<std::unique_ptr<Map>> list = [] {
        std::vector<std::unique_ptr<Map>> made;
        for (const auto make : makers) made.push_back(make());
        return made;
    }();
    return list;
}

Map& map_named(const std::string& name) {
    std::string known;
    for (const auto& map : maps()) {
        if (map->name() == name) return *map;
        known += (known.empty() ? "" : ", ") + map->name();
    }
    throw std::invalid_argument{"no map '" + name + "', expected one of " + known};
}

}  // namespace tumble::bench::stress
