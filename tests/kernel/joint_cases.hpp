// What cases of joints share, in worlds with the features that a case needs.
#pragma once

#include <tumble/tumble.hpp>

#include "kinds.hpp"

namespace tumble::test {

namespace joint_cases {
inline constexpr double g = 9.81;  // m/s^2
// In the quick set all cases share a world, which takes ten seconds to compile. In the deep set a world has the
// features of its case alone.
inline constexpr Features shared{.bodies = 6,
                                 .springs = 1,
                                 .joints = 6,
                                 .distances = true,
                                 .joint_springs = true,
                                 .joint_limits = true,
                                 .joint_breaks = true,
                                 .control = true,
                                 .script = true,
                                 .recording = true,
                                 .removal = true,
                                 .snapshots = true};
#ifdef TUMBLE_EVERY_KIND
template <Features own>
inline constexpr Features features_of = own;
#else
template <Features own>
inline constexpr Features features_of = shared;
#endif
}  // namespace joint_cases

// The kinds of worlds of these cases; `More` those of the deep set besides.
template <class... More>
using JointKinds = Tested<testing::Types<Kind<Q32<>, integrators::Verlet>, Kind<F64, integrators::Verlet>>,
                          testing::Types<Kind<F32, integrators::Verlet>, More...>>;

template <class W, Features features>
class JointCases : public testing::Test {
protected:
    using N = typename W::Numbers;
    using World = tumble::World<SceneOf<N, typename W::Integrator, joint_cases::features_of<features>>>;
    static constexpr bool is_single = !N::fixed_point && sizeof(typename N::Unit) == 4;

    [[nodiscard]] static World falling(Seconds step = {1, 256}) {
        return World{step, {.gravity = {0, -joint_cases::g, 0}}};
    }
    [[nodiscard]] static World floating(Seconds step = {1, 256}) { return World{step, {}}; }
    static void run(World& world, int steps) {
        for (int i = 0; i < steps; ++i) (void)world.step();
    }
    // J, of all bodies.
    [[nodiscard]] static double energy(const World& world) {
        double sum = 0;
        for (int b = 0; b < world.body_count(); ++b)
            sum += static_cast<double>(world.kinetic_energy(BodyId{b})) +
                   static_cast<double>(world.potential_energy(BodyId{b}));
        return sum;
    }
    [[nodiscard]] static auto joint(const World& world, int j = 0) { return world.template joint<double>(JointId{j}); }
};

}  // namespace tumble::test
