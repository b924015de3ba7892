// The pairs of shapes that collide. A pair is one header with its geometry and one entry in the table below. The table
// decides which shapes collide, which test they get, and in which order.
#pragma once

#include <tumble/scene.hpp>
#include <tumble/shapes/boxes.hpp>
#include <tumble/shapes/spheres.hpp>

namespace tumble {

// Geometry<N>{view} computes the normal, the gap and, by find(), the points of a body of the first shape and one of the
// second.
template <ShapeKind first_shape, ShapeKind second_shape, template <class> class Geometry>
struct ShapePair {
    static constexpr ShapeKind first = first_shape, second = second_shape;
    template <class N>
    using Contact = Geometry<N>;
};

namespace detail {

// A pair of shapes in one order of its bodies.
struct ShapeOrder {
    ShapeKind a, b;
    int entry;
    bool reversed;
};
template <int most>
struct ShapeOrders {
    ShapeOrder order[most]{};
    int count = 0;

    constexpr void add(const ShapeOrder& o) { order[count++] = o; }
    // True if no later order, from `at` on, has the same a (b). Then a (b) alone identifies the order.
    [[nodiscard]] constexpr bool a_tells(int at) const {
        for (int i = at + 1; i < count; ++i)
            if (order[i].a == order[at].a) return false;
        return true;
    }
    [[nodiscard]] constexpr bool b_tells(int at) const {
        for (int i = at + 1; i < count; ++i)
            if (order[i].b == order[at].b) return false;
        return true;
    }
};

// True if worlds of these features have colliding bodies of this shape.
[[nodiscard]] constexpr bool has_shape(const Features& features, ShapeKind kind) {
    return kind == ShapeKind::sphere || (kind == ShapeKind::box ? features.boxes : features.round_shapes);
}

template <int at, class First, class... Rest>
struct PairAt : PairAt<at - 1, Rest...> {};
template <class First, class... Rest>
struct PairAt<0, First, Rest...> : std::type_identity<First> {};

}  // namespace detail

template <class... Pairs>
struct ShapePairList {
    template <int at, class N>
    using Contact = typename detail::PairAt<at, Pairs...>::type::template Contact<N>;

    [[nodiscard]] TUMBLE_INLINE static constexpr bool has(ShapeKind kind) {
        return ((kind == Pairs::first || kind == Pairs::second) || ...);
    }
    [[nodiscard]] static constexpr bool has(ShapeKind a, ShapeKind b) {
        return (((a == Pairs::first && b == Pairs::second) || (a == Pairs::second && b == Pairs::first)) || ...);
    }
    // True if every two shapes of the list are a pair.
    [[nodiscard]] static constexpr bool is_complete() {
        for (int a = 0; a <= static_cast<int>(ShapeKind::points); ++a)
            for (int b = 0; b <= a; ++b)
                if (has(ShapeKind(a)) && has(ShapeKind(b)) && !has(ShapeKind(a), ShapeKind(b))) return false;
        return true;
    }
    // All orders of two bodies in worlds of these features, in the order of the list.
    [[nodiscard]] static constexpr auto orders(const Features& features) {
        detail::ShapeOrders<2 * static_cast<int>(sizeof...(Pairs))> orders;
        int entry = 0;
        const auto add = [&](ShapeKind first, ShapeKind second) {
            if (detail::has_shape(features, first) && detail::has_shape(features, second)) {
                orders.add({first, second, entry, false});
                if (first != second) orders.add({second, first, entry, true});
            }
            ++entry;
        };
        (add(Pairs::first, Pairs::second), ...);
        return orders;
    }
};

// The table.
// clang-format off
using ShapePairs = ShapePairList<
    ShapePair<ShapeKind::box, ShapeKind::box, BoxBox>,
    ShapePair<ShapeKind::sphere, ShapeKind::box, SphereBox>,
    ShapePair<ShapeKind::sphere, ShapeKind::sphere, SphereSphere>>;
// clang-format on

// True if bodies of the two shapes collide.
[[nodiscard]] constexpr bool meets(ShapeKind a, ShapeKind b) { return ShapePairs::has(a, b); }
// True if a body of the shape collides with bodies of any shape.
[[nodiscard]] TUMBLE_INLINE constexpr bool touches_bodies(ShapeKind kind) { return ShapePairs::has(kind); }
// meets(a, b) for two shapes that collide with bodies. Constant if all such shapes meet.
[[nodiscard]] TUMBLE_INLINE constexpr bool touching_meet(ShapeKind a, ShapeKind b) {
    return ShapePairs::is_complete() || meets(a, b);
}

namespace detail {

template <Features features>
inline constexpr auto shape_orders = ShapePairs::orders(features);

template <Features features, int at, class N, class Make, class F>
TUMBLE_INLINE void with_contact_from(const PairView<N>& view, Make& make, F& f) {
    constexpr ShapeOrder order = shape_orders<features>.order[at];
    if constexpr (at + 1 < shape_orders<features>.count) {
        constexpr bool b_tells = shape_orders<features>.b_tells(at), a_tells = shape_orders<features>.a_tells(at);
        if (!((b_tells || view.a.is(order.a)) && ((a_tells && !b_tells) || view.b.is(order.b))))
            return with_contact_from<features, at + 1>(view, make, f);
    }
    using Contact = ShapePairs::Contact<order.entry, N>;
    if constexpr (order.reversed) {
        const PairView<N> reversed = view.reversed();
        f(make.template operator()<Contact>(reversed), reversed, true);
    } else {
        f(make.template operator()<Contact>(view), view, false);
    }
}

}  // namespace detail

// True if worlds of these features have pairs other than two spheres.
template <Features features>
inline constexpr bool has_other_pairs_than_spheres = detail::shape_orders<features>.count > 1;

// Calls f(geometry, view in the pair's order, whether that order is reversed) for two shapes that meet.
// make<Contact>(view) makes the geometry.
template <Features features, class N, class Make, class F>
void with_contact(const PairView<N>& view, Make&& make, F&& f) {
    detail::with_contact_from<features, 0>(view, make, f);
}

}  // namespace tumble
