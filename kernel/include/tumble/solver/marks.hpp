// What acts on each body besides gravity, asked once in a step.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

struct Mark {
    bool coupled : 1 = false;  // a load connects it to another moving body
    bool loaded : 1 = false;   // a load acts at stages
    bool driven : 1 = false;   // a load or a wrench acts

    // Its bits in a snapshot, and back.
    [[nodiscard]] std::uint32_t bits() const { return static_cast<std::uint32_t>(coupled | loaded << 1 | driven << 2); }
    [[nodiscard]] static Mark of(std::uint32_t bits) { return {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0}; }
    // True where gravity alone acts.
    [[nodiscard]] bool none() const { return !(coupled || loaded || driven); }
};

// A sleeping body keeps its mark: what would change it wakes the body.
template <int bodies>
using Marks = Mark[bodies];

}  // namespace tumble
