// What acts on each body besides gravity, asked once in a step.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

struct Mark {
    bool coupled : 1 = false;  // a load connects it to another moving body
    bool loaded : 1 = false;   // a load acts at stages
    bool driven : 1 = false;   // a load or a wrench acts

    // True where gravity alone acts.
    [[nodiscard]] bool none() const { return !(coupled || loaded || driven); }
};

// A sleeping body keeps its mark: what would change it wakes the body.
template <int bodies>
using Marks = Mark[bodies];

}  // namespace tumble
