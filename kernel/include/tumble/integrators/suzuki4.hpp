// Suzuki's composition of verlet: five parts g, g, 1 - 4g, g, g with g = 1 / (4 - 4^(1/3)) (M. Suzuki, Phys. Lett. A
// 146 (1990) 319). Order 4, reversible in time, momentum norm exact to rounding, bounded energy error. It takes five
// times the work of verlet in free rotation and five evaluations of the loads a step. The accurate choice when torques
// act. No division, no square root.
#pragma once

#include <tumble/integrators/verlet.hpp>

namespace tumble {

namespace detail {

struct Suzuki4Parts {
    static constexpr int count = 5, kinds = 2;
    [[nodiscard]] static constexpr int kind(int part) { return part == 2 ? 1 : 0; }
    // Evaluated by the compiler only: at run time it would take longer than the rest of a step.
    [[nodiscard]] static consteval Real of(int part) { return of_kind(kind(part)); }
    [[nodiscard]] static constexpr Real of_kind(int k) {
        Real root = 1.5;  // cube root of 4, by Newton's iteration
        for (int i = 0; i < 6; ++i) root = root - (root * root * root - Real{4}) / (Real{3} * root * root);
        const Real g = Real{1} / (Real{4} - root);
        return k == 0 ? g : Real{1} - Real{4} * g;
    }
};

}  // namespace detail

namespace integrators {

// Five steps of verlet in one: order 4, the accurate choice where loads turn a body. No division, no square root.
struct Suzuki4 : KickDriftKick<Composed<SymmetricTopFlow, tumble::detail::Suzuki4Parts>, tumble::detail::Suzuki4Parts> {
    static constexpr const char* name = "suzuki4";
    static constexpr int order = 4;
    static constexpr bool exact_for_spheres = true;
    using PartAlone = Verlet;
};

}  // namespace integrators
}  // namespace tumble
