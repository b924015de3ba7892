// What cases of joints share, in worlds with the features that a case needs.
#pragma once

#include <tumble/tumble.hpp>

#include "kinds.hpp"

namespace tumble::test {

namespace joint_cases {
inline constexpr double g = 9.81;  // m/s^2
}

template <class W, Features features>
class JointCases : public testing::Test {
protected:
    using N = typename W::Numbers;
    using World = tumble::World<SceneOf<N, typename W::Integrator, features>>;
    static constexpr bool is_single = !N::fixed_point && sizeof(typename N::Unit) == 4;

    [[nodiscard]] static World falling(Seconds step = {1, 256}) {
        return World{step, {.gravity = {0, -joint_cases::g, 0}}};
    }
    [[nodiscard]] static World floating(Seconds step = {1, 256}) { return World{step, {}}; }
    static void run(World& world, int steps) {
        for (int i = 0; i < steps; ++i) (void)world.step();
    }
    [[nodiscard]] static auto joint(const World& world, int j = 0) { return world.template joint<double>(JointId{j}); }
};

}  // namespace tumble::test
