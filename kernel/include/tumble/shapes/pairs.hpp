// Which of SphereSphere, SphereBox and BoxBox knows a pair of shapes.
#pragma once

#include <tumble/scene.hpp>
#include <tumble/shapes/boxes.hpp>
#include <tumble/shapes/spheres.hpp>

namespace tumble {

// Calls f(what is known of two shapes, the view in its order, whether that is reversed). box_box(view) is asked for
// what is known of two boxes.
template <Features features, class N, class BoxBoxOf, class F>
void with_contact(const PairView<N>& view, [[maybe_unused]] BoxBoxOf&& box_box, F&& f) {
    if constexpr (features.boxes) {
        const bool box_a = view.a.is(ShapeKind::box), box_b = view.b.is(ShapeKind::box);
        if (box_a && box_b) return f(box_box(view), view, false);
        if (box_b) return f(SphereBox<N>{view}, view, false);
        if (box_a) {
            const PairView<N> reversed = view.reversed();
            return f(SphereBox<N>{reversed}, reversed, true);
        }
    }
    f(SphereSphere<N>{view}, view, false);
}

}  // namespace tumble
