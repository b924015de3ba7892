// For typed tests, whose worlds are compiled with the test, a world for each kind.
#pragma once

#include "worlds.hpp"

namespace tumble::test {

// The kinds of a typed test: the quick set has the first, since a kind takes seconds to compile; the deep set has all.
template <class Quick, class Deep>
struct TestedKinds;
template <class... Quick, class... Deep>
struct TestedKinds<testing::Types<Quick...>, testing::Types<Deep...>> {
#ifdef TUMBLE_EVERY_KIND
    using Types = testing::Types<Quick..., Deep...>;
#else
    using Types = testing::Types<Quick...>;
#endif
};
template <class Quick, class Deep>
using Tested = typename TestedKinds<Quick, Deep>::Types;

[[nodiscard]] inline BodySpec at(BodySpec body, const RealVec3& position, const RealVec3& velocity = {},
                                 const RealVec3& spin = {}) {
    body.position = position;
    body.velocity = velocity;
    body.angular_velocity = spin;
    return body;
}

// What tests of boxes that touch and rub have, with room for so many bodies and planes.
[[nodiscard]] constexpr Features touching(int bodies, int planes) {
    return {.bodies = bodies,
            .planes = planes,
            .removal = true,
            .snapshots = true,
            .pairs = true,
            .boxes = true,
            .friction = true};
}

// Every feature, in little room. Tests share it, so that a kind has one such world.
inline constexpr Features little_of_everything =
    Features{.bodies = 5, .planes = 2, .springs = 2, .near_pairs = 12}.with_everything();

}  // namespace tumble::test
