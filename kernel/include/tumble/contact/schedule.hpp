// Who steps together, and whom a step wakes at its end.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/contact/islands.hpp>

namespace tumble {

template <int bodies>
struct Schedule {
    Islands<bodies> islands{};
    BodyGroup<bodies> wakes{};
    bool joins[bodies]{};  // not of bodies that have flown freely
};

}  // namespace tumble
