// The points at which two bodies, or a body and a plane, may touch.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

namespace contact {
inline constexpr int max_points = 4;  // of a pair
}  // namespace contact

// A contact point: its place from the centre of mass of each body, in that body's principal axes.
template <class N>
struct ManifoldPoint {
    using Length = typename ContactNumbers<N>::Length;
    Vec3<Length> arm, arm_b;
    Length gap;
};

// The lowest of the points that are added, at most as many as a pair has.
template <class N>
struct Manifold {
    ManifoldPoint<N> point[contact::max_points];
    int count = 0;

    [[nodiscard]] ManifoldPoint<N>& add() { return point[count++]; }
    void add_lowest(const ManifoldPoint<N>& p) {
        if (count < contact::max_points) {
            point[count++] = p;
            return;
        }
        int highest = 0;
        for (int i = 1; i < count; ++i)
            if (point[i].gap > point[highest].gap) highest = i;
        if (p.gap < point[highest].gap) point[highest] = p;
    }
};

}  // namespace tumble
