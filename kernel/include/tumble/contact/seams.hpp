// Seams between flush boxes. A side that a neighbour covers pushes nothing: flush boxes are one surface. Where two
// sides of a box meet in an edge, a body at the edge may be apart from it along either side, and rounding would choose.
// The neighbours of the body decide instead: a box that covers one side and is flush with the other leaves only the
// other.
#pragma once

#include <tumble/contact/narrow_phase.hpp>
#include <tumble/contact/pair_list.hpp>

namespace tumble {

template <class N, Spin spin, Features features>
class Seams {
public:
    using NarrowPhase = tumble::NarrowPhase<N, spin, features>;
    using Bodies = typename NarrowPhase::Bodies;
    using Bounds = typename NarrowPhase::Bounds;
    using C = typename NarrowPhase::C;
    using Length = typename NarrowPhase::Length;
    using Pair = typename NarrowPhase::Pair;
    using PairList = tumble::PairList<N, features>;
    using Unit = typename C::Unit;
    static constexpr bool exist = features.pairs && features.boxes;

    Seams(NarrowPhase& shapes, const PairList& pairs, const Bodies& bodies)
        : shapes_{shapes}, pairs_{pairs}, bodies_{bodies} {}

    // Measures a pair where its bodies have been placed.
    TUMBLE_INLINE void measure(Pair& pair) const { measure(pair, Bounds::axis_margin(shapes_.tolerance())); }
    TUMBLE_INLINE void measure(Pair& pair, Length margin) const requires(!exist) {
        (void)shapes_.measure(bodies_, pair, margin, false);
    }
    [[gnu::noinline]] void measure(Pair& pair, Length margin) const requires exist {
        const Vec3<Unit> before = pair.normal;
        const bool moved = pair.moved;
        if (!shapes_.measure(bodies_, pair, margin, has_neighbours(pair))) return;
        choose_side(pair);
        pair.moved = moved || shapes_.has_turned(pair) || !(pair.normal == before);
    }
    // True where a body has slid onto the other from a flush neighbour that it touched at the start of the flight. It
    // has lain on their common surface in the whole flight.
    [[nodiscard, gnu::noinline, gnu::cold]] bool is_crossed(const Pair& pair) const requires exist {
        if (is_far(pair.gap)) return false;
        // A box that was above the surface at the start has fallen onto it. A ball has no sides: it has slid where it
        // touched a neighbour.
        const bool from_aside = pair.axis.covered || pair.start_covered ||
                                narrow<Unit>(dot(pair.normal, pair.start_normal)) < C::half(C::one());
        return ((from_aside || is_ball(pair.a)) && lies_beside(pair, pair.a, pair.normal)) ||
               ((from_aside || is_ball(pair.b)) && lies_beside(pair, pair.b, -pair.normal));
    }
    // True of a body that is apart from another, and as high above a box of these as above a neighbour that covers the
    // side of that box to which it comes.
    [[nodiscard, gnu::noinline]] bool slides_onto(const Pair& pair) const requires exist {
        if (!has_neighbours(pair)) return false;
        const Edge edge[2] = {edge_of(pair.a, pair.b), edge_of(pair.b, pair.a)};
        bool any = false;
        for (int n = 0; n < 6; ++n)
            any = any || (is_side(edge[n / 3], n % 3) && covers_all_but(pair, edge[n / 3], n % 3, pair.normal));
        return any;
    }
    // Whether `fresh`, which is new in the list, has a body of a measured pair that touches and may be covered by it.
    [[nodiscard, gnu::noinline, gnu::cold]] bool may_change(const Pair& pair, const Pair& fresh) const requires exist {
        const auto has = [&](int body) { return pair.a == body || pair.b == body; };
        return &pair != &fresh && !pair.with_plane() && !(pair.gap > shapes_.tolerance()) && !pair.axis.covered &&
               (has(fresh.a) || (fresh.b >= 0 && has(fresh.b)));
    }

private:
    // A box and the body at its edge, in the axes of the box.
    struct Edge {
        int box, body;
        Axes<N> axes;
        Vec3<Length> half, centre, extent, gap;  // of the box; of the body; along each axis

        [[nodiscard]] bool is_below(int i) const { return centre[i] < Length{}; }
        // The nearest coordinate of the box.
        [[nodiscard]] Length within(int i, Length l) const {
            return l > half[i] ? half[i] : l < -half[i] ? Length(-half[i]) : l;
        }
        [[nodiscard]] Vec3<Length> within(const Vec3<Length>& p) const {
            return {within(0, p[0]), within(1, p[1]), within(2, p[2])};
        }
        // The part of the box that the outline of the body meets.
        [[nodiscard]] Length low(int i) const { return within(i, centre[i] - extent[i]); }
        [[nodiscard]] Length high(int i) const { return within(i, centre[i] + extent[i]); }
        // Of the centre of the body on the plane of a face.
        [[nodiscard]] Vec3<Length> foot(int side) const {
            Vec3<Length> p = centre;
            p[side] = is_below(side) ? Length(-half[side]) : half[side];
            return p;
        }
    };
    // A body beside the box, in the axes of that.
    struct Neighbour {
        const CollisionShape<N>& shape;
        Axes<N> axes;
        Vec3<Length> centre, extent{};
        bool is_flush = false;
    };

    [[nodiscard]] bool has_neighbours(const Pair& pair) const {
        return pair.b >= 0 && (pairs_.pairs_of(pair.a) > 1 || pairs_.pairs_of(pair.b) > 1);
    }
    [[nodiscard]] bool is_side(const Edge& of, int i) const {
        return shapes_.shape(of.box).is(ShapeKind::box) && is_near(of.gap[i]);
    }
    [[nodiscard]] bool is_far(Length gap) const { return magnitude_of(gap) > shapes_.tolerance(); }
    // Of the gap along the normal of a face at whose edge a body is.
    [[nodiscard]] bool is_near(Length gap) const {
        return !(gap > shapes_.tolerance()) && !(gap < -Bounds::edge_depth(shapes_.tolerance()));
    }

    // Another pair of the body, with a box or a plane that is where it belongs at this time: one of the same island, or
    // what is fixed.
    [[nodiscard, gnu::noinline, gnu::cold]] bool is_neighbour(const Pair& pair, int body, const Pair& beside) const {
        if (&beside == &pair || beside.left_out) return false;
        if (beside.a == body) return true;
        // What is fixed has pairs in several islands. Flush bodies that move are near each other, and so in one.
        return beside.b == body && (pair.a == body || pair.moves_b() || pairs_.are_near(pair.a, beside.a));
    }
    // The next of these pairs from place i of the list on, which it raises. Null after the last one.
    [[nodiscard, gnu::noinline, gnu::cold]] const Pair* next_neighbour(const Pair& pair, int body, int& i) const {
        while (i < pairs_.count()) {
            const Pair& beside = pairs_[i++];
            if (is_neighbour(pair, body, beside)) return &beside;
        }
        return nullptr;
    }
    // Whether the body of the pair touches a neighbour whose surface is that of the pair.
    [[nodiscard, gnu::noinline, gnu::cold]] bool lies_beside(const Pair& pair, int body,
                                                             const Vec3<Unit>& normal) const {
        int i = 0;
        while (const Pair* const beside = next_neighbour(pair, body, i))
            if (beside->touched && beside->count > 0 && !is_far(height_above(*beside, body, normal))) return true;
        return false;
    }
    // The distance of the surfaces of the body and its neighbour along a direction towards the body.
    [[nodiscard, gnu::noinline, gnu::cold]] Length height_above(const Pair& pair, int body,
                                                                const Vec3<Unit>& normal) const {
        if (pair.with_plane()) {
            if (!(narrow<Unit>(dot(pair.normal, normal)) > C::nearly_parallel())) return C::longest();
            return shapes_.view_of_plane(bodies_, pair).gap();
        }
        return shapes_.view_of(bodies_, pair).separation(pair.a == body ? normal : Vec3<Unit>(-normal), features.boxes);
    }

    [[nodiscard, gnu::noinline, gnu::cold]] Edge edge_of(int box, int body) const {
        const CollisionShape<N>&shape = shapes_.shape(box), &other = shapes_.shape(body);
        Edge edge{box, body, shape.axes(shapes_.axes(box)), shape.half, {}, {}, {}};
        edge.centre = edge.axes.to_body(shapes_.reach_between(bodies_, body, box));
        edge.extent = extent_of(other, other.axes(shapes_.axes(body)), edge.axes);
        for (int i = 0; i < 3; ++i) edge.gap[i] = magnitude_of(edge.centre[i]) - edge.half[i] - edge.extent[i];
        return edge;
    }
    // Along the axes of a frame.
    [[nodiscard, gnu::noinline, gnu::cold]] static Vec3<Length> extent_of(const CollisionShape<N>& shape,
                                                                          const Axes<N>& axes, const Axes<N>& frame) {
        if (!shape.is(ShapeKind::box)) return {shape.half.x(), shape.half.x(), shape.half.x()};
        Vec3<Length> extent;
        for (int i = 0; i < 3; ++i) {
            Vec3<Unit> size;
            for (int j = 0; j < 3; ++j) size[j] = magnitude_of(narrow<Unit>(dot(frame.axis(i), axes.axis(j))));
            extent[i] = narrow<Length>(dot(size, shape.half));
        }
        return extent;
    }

    // Chooses the side of a box along which the pair is apart, where neighbours leave one: of several the one that is
    // farthest apart. Where they cover that too, as of two boxes across the corner of four, the pair touches nothing.
    // The gap stays that of the axis that parts the bodies most: along the side a body may be deep beside the box.
    [[gnu::noinline, gnu::cold]] void choose_side(Pair& pair) const {
        const Edge edge[2] = {edge_of(pair.a, pair.b), edge_of(pair.b, pair.a)};
        int box = -1, side = 0;
        const Vec3<Unit> before = pair.normal;
        for (int n = 0; n < 6; ++n) {
            const Edge& of = edge[n / 3];
            const int i = n % 3;
            if (!is_side(of, i) || (box >= 0 && !(of.gap[i] > edge[box].gap[side]))) continue;
            if (!covers_all_but(pair, of, i, before)) continue;
            box = n / 3;
            side = i;
        }
        if (box < 0) return;
        const Vec3<Unit> axis = edge[box].axes.axis(side);
        const bool negative = (box == 0) == edge[box].is_below(side);  // the place of b along the axis
        const Vec3<Unit> normal = negative ? axis : Vec3<Unit>(-axis);
        pair.axis.covered = true;
        pair.axis.idle = is_ball(edge[box].body);  // it is beside the face
        for (int n = 0; n < 6 && !pair.axis.idle; ++n) {
            const Edge& of = edge[n / 3];
            const int i = n % 3;
            if (!is_side(of, i)) continue;
            const Vec3<Unit> first = of.axes.to_body(before);
            pair.axis.idle =
                !leans(of, first, (i + 1) % 3) && !leans(of, first, (i + 2) % 3) && covers_all_but(pair, of, i, normal);
        }
        pair.axis.index = static_cast<std::int8_t>(3 * box + side);
        pair.axis.negative = negative;
        pair.normal = shapes_.normal_of_surface(pair, normal);
    }
    // Whether a direction in the axes of the box has a part along axis i: over the body, or over the box where that is
    // smaller, it makes more than the tolerance. A long body that rocks on a box does not lean on its side.
    [[nodiscard]] bool leans(const Edge& edge, const Vec3<Unit>& direction, int i) const {
        const Unit part = magnitude_of(direction[i]);
        if (is_ball(edge.body)) return part > C::flat();
        const Length smaller = edge.extent[i] < edge.half[i] ? edge.extent[i] : edge.half[i];
        return narrow<Length>(mul(part, smaller)) > shapes_.tolerance();
    }
    // Whether there are other faces than `side` of the box that look at the body, and neighbours that are flush with
    // `side` cover all of them. `normal`: along which the pair was found apart.
    [[nodiscard, gnu::noinline, gnu::cold]] bool covers_all_but(const Pair& pair, const Edge& edge, int side,
                                                                const Vec3<Unit>& normal) const {
        const Vec3<Unit> direction = edge.axes.to_body(edge.box == pair.a ? Vec3<Unit>(-normal) : normal);
        bool any = false;
        for (int i = 0; i < 3; ++i) {
            if (i == side || !leans(edge, direction, i)) continue;
            any = any_flush(pair, edge, side, i, direction[i] < Unit{});
            if (!any) return false;
        }
        // A ball lies on a neighbour.
        return any && (!is_ball(edge.body) || any_flush(pair, edge, side, -1, false));
    }
    // Whether a neighbour that is flush with `side` covers face `face` of the box, on its negative or positive side;
    // -1: whether it contains the place on it below the body. A plane covers and contains all.
    [[nodiscard, gnu::noinline, gnu::cold]] bool any_flush(const Pair& pair, const Edge& edge, int side, int face,
                                                           bool negative) const {
        int i = 0;
        while (const Pair* const beside = next_neighbour(pair, edge.body, i)) {
            if (beside->with_plane()) {
                if (is_flush_with_plane(*beside, edge, side)) return true;
                continue;
            }
            const Neighbour n = flush_box(*beside, edge, side);
            if (n.is_flush && (face < 0 ? contains(n, edge, edge.foot(side)) : covers(n, edge, face, negative, side)))
                return true;
        }
        return false;
    }
    [[nodiscard]] bool is_flush_with_plane(const Pair& beside, const Edge& edge, int side) const {
        const Vec3<Unit> axis = edge.axes.axis(side);
        return !is_far(height_above(beside, edge.body, edge.is_below(side) ? Vec3<Unit>(-axis) : axis) -
                       edge.gap[side]);
    }
    // The body lies as high above a box that is flush along the axis `side` as above the box at its edge, and it has a
    // face in that direction.
    [[nodiscard, gnu::noinline, gnu::cold]] Neighbour flush_box(const Pair& beside, const Edge& edge, int side) const {
        const int other = beside.a == edge.body ? beside.b : beside.a;
        const CollisionShape<N>& shape = shapes_.shape(other);
        Neighbour found{shape, shape.axes(shapes_.axes(other)),
                        edge.axes.to_body(shapes_.reach_between(bodies_, other, edge.box))};
        if (!shape.is(ShapeKind::box)) return found;
        found.extent = extent_of(shape, found.axes, edge.axes);
        const Length beyond = edge.centre[side] - found.centre[side],
                     height = magnitude_of(beyond) - edge.extent[side] - found.extent[side];
        const Vec3<Unit> direction = found.axes.to_body(edge.axes.axis(side));
        int own = 0;
        for (int j = 1; j < 3; ++j)
            if (magnitude_of(direction[j]) > magnitude_of(direction[own])) own = j;
        found.is_flush = (beyond < Length{}) == edge.is_below(side) && !is_far(height - edge.gap[side]) &&
                         !(found.extent[side] > shape.half[own] + shapes_.tolerance());
        return found;
    }
    // Whether a flush neighbour covers face `face` of the box, on its negative or positive side, where the body is.
    [[nodiscard, gnu::noinline, gnu::cold]] bool covers(const Neighbour& n, const Edge& edge, int face, bool negative,
                                                        int side) const {
        const Length band = shapes_.tolerance();
        // It begins at the face or behind it, and goes on beyond it.
        const Length outward = negative ? Length(-n.centre[face]) : n.centre[face], surface = edge.half[face] + band;
        if (outward - n.extent[face] > surface || !(outward + n.extent[face] > surface)) return false;
        // A ball touches one point of the box.
        if (is_ball(edge.body)) return contains(n, edge, edge.within(edge.foot(side)));
        // It meets the part of the face that the outline of the body meets: across, more than in passing.
        const int across = 3 - face - side;
        const auto overlap = [&](int i) {
            const Length low = edge.low(i), high = edge.high(i), from = n.centre[i] - n.extent[i],
                         to = n.centre[i] + n.extent[i];
            return (high < to ? high : to) - (low > from ? low : from);
        };
        const Length length = edge.high(across) - edge.low(across), twice = band + band;
        return !(overlap(side) < -band) && !(overlap(across) + band < (length < twice ? length : twice));
    }
    // Whether a point, in the axes of the box at the edge, is in the neighbour.
    [[nodiscard, gnu::noinline, gnu::cold]] bool contains(const Neighbour& n, const Edge& edge,
                                                          const Vec3<Length>& point) const {
        const Vec3<Length> p = n.axes.to_body(edge.axes.to_world(Vec3<Length>(point - n.centre)));
        for (int i = 0; i < 3; ++i)
            if (magnitude_of(p[i]) > n.shape.half[i] + shapes_.tolerance()) return false;
        return true;
    }
    [[nodiscard]] bool is_ball(int body) const { return shapes_.shape(body).is(ShapeKind::sphere); }

    NarrowPhase& shapes_;
    const PairList& pairs_;
    const Bodies& bodies_;
};

}  // namespace tumble
