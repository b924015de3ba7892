// The number systems that the host has compiled in. The build makes one translation unit of worlds for each line of the
// list, so a new number system is one line here.
#pragma once

#include <tumble/numbers/systems.hpp>

#include <cstddef>
#include <memory>
#include <string_view>
#include <tuple>

#include "scene/data.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

template <class N>
struct System {
    using Numbers = N;
    std::string_view type;        // in C++
    std::string_view range = {};  // the preset of a fixed-point system
};

// Ranges of one kind from the smallest to the largest: the first that holds a scene's [range] is used.
inline constexpr std::tuple number_system_list{
    System<Q32<NearRange>>{"tumble::Q32<tumble::NearRange>", "near"},
    System<Q32<RoomRange>>{"tumble::Q32<tumble::RoomRange>", "room"},
    System<Q32<FieldRange>>{"tumble::Q32<tumble::FieldRange>", "field"},
    System<Q32<NearRange, false>>{"tumble::Q32<tumble::NearRange, false>", "near"},
    System<Q32<RoomRange, false>>{"tumble::Q32<tumble::RoomRange, false>", "room"},
    System<Q32<FieldRange, false>>{"tumble::Q32<tumble::FieldRange, false>", "field"},
    System<F32>{"tumble::F32"},
    System<F32Plain>{"tumble::F32Plain"},
    System<F64>{"tumble::F64"},
    System<F64Carried>{"tumble::F64Carried"},
};
inline constexpr std::size_t number_system_count = std::tuple_size_v<decltype(number_system_list)>;

// A simulation in the index-th number system; null for an integrator that does not run in it.
template <std::size_t index>
[[nodiscard]] std::unique_ptr<Simulation> make_in(SceneData data, std::string_view integrator);

}  // namespace tumble::host
