// Two bodies relative to each other: spheres and boxes. The gap is the distance of the surfaces along `normal`, which
// points from the second body to the first. For separate boxes it is the widest separation along an axis, which is at
// most the distance. find() returns the points of a pair that is nearer than `band`; for boxes, the points up to
// `band`.
#pragma once

#include <tumble/shapes/pair_view.hpp>

namespace tumble {

template <class N>
struct SphereSphere {
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Unit = typename C::Unit;

    Vec3<Unit> normal;
    Length gap;

    explicit SphereSphere(const PairView<N>& view) {
        if (C::has_direction(view.reach)) normal = C::direction(view.reach);
        else normal = {Unit{}, C::one(), Unit{}};  // any direction
        gap = narrow<Length>(dot(normal, view.reach)) - view.a.half.x() - view.b.half.x();
    }
    // Both bodies get the same point, that of b, so that the impulses are equal and opposite.
    void find(const PairView<N>& view, Manifold<N>& found, Length) const {
        found.add() = {along(view.axes_a.to_body(normal), -(view.a.half.x() + gap)),
                       along(view.axes_b.to_body(normal), view.b.half.x()), gap};
    }
};

// a is the sphere, b the box.
template <class N>
struct SphereBox {
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Unit = typename C::Unit;

    Vec3<Unit> normal;
    Length gap;
    Vec3<Length> nearest;  // point of the box, in its own axes
    int sides = 0;         // of the box that look at the centre

    explicit SphereBox(const PairView<N>& view) {
        const Axes<N> axes = view.b.axes(view.axes_b);
        const Vec3<Length> centre = axes.to_body(view.reach);
        const Length radius = view.a.half.x();
        Vec3<Length> apart;
        for (int i = 0; i < 3; ++i) {
            const Length h = view.b.half[i];
            nearest[i] = centre[i] > h ? h : centre[i] < -h ? -h : centre[i];
            apart[i] = centre[i] - nearest[i];
            if (!(apart[i] == Length{})) ++sides;
        }
        Vec3<Unit> n = Vec3<Unit>::Constant(Unit{});
        if (dot(apart, apart) > mul(C::hair(radius), C::hair(radius))) {
            n = C::direction(apart);
            gap = narrow<Length>(dot(n, apart)) - radius;
        } else {
            // The centre is inside the box: the way out is through the nearest face.
            int face = 0;
            Length depth = view.b.half[0] - magnitude_of(centre[0]);
            for (int i = 1; i < 3; ++i) {
                const Length d = view.b.half[i] - magnitude_of(centre[i]);
                if (d < depth) {
                    depth = d;
                    face = i;
                }
            }
            const bool negative = centre[face] < Length{};
            n[face] = negative ? -C::one() : C::one();
            nearest[face] = negative ? -view.b.half[face] : view.b.half[face];
            gap = -depth - radius;
        }
        normal = axes.to_world(n);
    }
    // Whether the nearest point is on an edge or at a vertex of the box.
    [[nodiscard]] bool is_at_edge(Length) const { return sides > 1; }
    void find(const PairView<N>& view, Manifold<N>& found, Length) const {
        found.add() = {along(view.axes_a.to_body(normal), -(view.a.half.x() + gap)), view.b.principal(nearest), gap};
    }
};

}  // namespace tumble
