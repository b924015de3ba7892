// The flight of an island: what its step asks of the method, through one function pointer.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/body/stage.hpp>
#include <tumble/scene.hpp>
#include <tumble/solver/kicks.hpp>

namespace tumble {

// The method does what is asked for in the order of the members.
template <class N, Features features>
struct Flight {
    const SomeBodies<features.bodies>& group;
    bool new_spins = false;  // something other than a flight has changed the spins
    // Gets the change of motion by gravity and by the loads at their present strength, over a whole step.
    Kicks<N, features.bodies>* loads = nullptr;
    Portion<typename N::Work> portion{false, typename N::Work(0)};  // length 0: the bodies stay where they are
    // When in the step it begins, as a part of it. Kinematic bodies move along.
    [[no_unique_address]] If<features.kinematic, typename N::Work, 0> from{};
    [[no_unique_address]] If<features.kinematic, bool, 1> places{};  // with length 0: puts them where they are then
};

template <class N, Features features>
struct Mover {
    void* method;
    void (*move)(void* method, const Flight<N, features>& flight);
    Coasting coasting;
};

}  // namespace tumble
