// The flight of an island: what its step asks of the method, through one function pointer.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/body/stage.hpp>
#include <tumble/contact/kicks.hpp>

namespace tumble {

// The method does what is asked for in the order of the members.
template <class N, int bodies>
struct Flight {
    const BodyGroup<bodies>& group;
    bool new_spins = false;  // something other than a flight has changed the spins
    // Gets the change of motion by gravity and by the loads at their present strength, over a whole step.
    Kicks<N, bodies>* loads = nullptr;
    Portion<typename N::Work> portion{false, typename N::Work(0)};  // length 0: the bodies stay where they are
};

template <class N, int bodies>
struct Mover {
    void* method;
    void (*move)(void* method, const Flight<N, bodies>& flight);
    Coasting coasting;
};

}  // namespace tumble
