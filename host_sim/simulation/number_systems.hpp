// The kernel's number systems as the simulator has them compiled in: those of fixed point once for each range. The
// build makes four translation units of worlds for each: the methods of most runs, the rest, and all of them for scenes
// with joints, without contacts and with them.
#pragma once

#include <tumble/integrators/list.hpp>
#include <tumble/numbers/systems.hpp>

#include <cstddef>
#include <memory>
#include <string_view>
#include <tuple>
#include <type_traits>

#include "scene/data.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

template <class N>
struct System {
    using Numbers = N;
    std::string_view entry;       // its name in the list
    std::string_view range = {};  // its name, of a fixed-point system
};

template <class Entry, class... NamedRanges>
constexpr auto with_each_range(NamedList<NamedRanges...>) {
    if constexpr (Entry::fixed_point)
        return std::tuple{
            System<typename Entry::template Numbers<typename NamedRanges::Range>>{Entry::name, NamedRanges::name}...};
    else return std::tuple{System<typename Entry::template Numbers<RoomRange>>{Entry::name}};  // of any range
}
template <class... Entries>
constexpr auto with_ranges(NamedList<Entries...>) {
    return std::tuple_cat(with_each_range<Entries>(Ranges{})...);
}

// Ranges of one system from the smallest to the largest: the first that holds a scene's [range] is used.
inline constexpr auto number_system_list = with_ranges(NumberSystems{});
inline constexpr std::size_t number_system_count = std::tuple_size_v<decltype(number_system_list)>;

template <std::size_t index>
using NumbersAt = typename std::tuple_element_t<index, decltype(number_system_list)>::Numbers;

enum class Part { front, rest, joints, joints_contacts };
template <class... Methods, class Method>
constexpr bool contains(IntegratorList<Methods...>, std::type_identity<Method>) {
    return (std::is_same_v<Methods, Method> || ...);
}
// The methods of most runs, and the one that all are compared with.
template <class Method>
constexpr bool is_usual() {
    using namespace integrators;
    using Usual = IntegratorList<ExplicitEuler, SemiImplicitEuler, Rk4, Verlet, Suzuki4>;
    return contains(Usual{}, std::type_identity<Method>{});
}
// Of scenes without joints. The front has the usual methods, and of the smallest range all, which `make run` compares.
template <class N, class Method>
constexpr Part part_of() {
    const bool is_first = std::is_same_v<N, NumbersOf<"q32", NearRange>>;
    return is_first || is_usual<Method>() ? Part::front : Part::rest;
}

// A simulation in the index-th number system; null for an integrator that is not in this part of it.
template <std::size_t index, Part part>
[[nodiscard]] std::unique_ptr<Simulation> make_in(SceneData data, std::string_view integrator);

}  // namespace tumble::host
