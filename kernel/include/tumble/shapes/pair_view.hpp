// Two shapes at their places: the position of one body relative to another, and their separation along a direction.
#pragma once

#include <tumble/shapes/manifold.hpp>
#include <tumble/shapes/shape.hpp>

namespace tumble {

template <class N>
struct PairView {
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Unit = typename C::Unit;

    const CollisionShape<N>&a, &b;
    const Axes<N>&axes_a, &axes_b;  // principal
    Vec3<Length> reach;             // from the centre of b to that of a, world

    [[nodiscard]] PairView reversed() const { return {b, a, axes_b, axes_a, -reach}; }

    // The distance of the surfaces along a direction.
    [[nodiscard]] Length separation(const Vec3<Unit>& normal, bool boxes) const {
        return narrow<Length>(dot(normal, reach)) - extent(a, axes_a, normal, boxes) - extent(b, axes_b, normal, boxes);
    }
    // Of the centre of a above the surface of b.
    [[nodiscard]] Length height(const Vec3<Unit>& normal, bool boxes) const {
        return narrow<Length>(dot(normal, reach)) - extent(b, axes_b, normal, boxes);
    }

private:
    [[nodiscard, gnu::noinline]] static Length extent(const CollisionShape<N>& shape, const Axes<N>& axes,
                                                      const Vec3<Unit>& normal, bool boxes) {
        if (!(boxes && shape.is(ShapeKind::box))) return shape.half.x();
        const Vec3<Unit> n = shape.axes(axes).to_body(normal);
        Length sum{};
        for (int i = 0; i < 3; ++i) sum += magnitude_of(narrow<Length>(mul(n[i], shape.half[i])));
        return sum;
    }
};

}  // namespace tumble
