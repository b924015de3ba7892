// The way of a body to a flat surface in a flight that was flown whole: the gap of each of its points as a cubic in
// closed form.
#pragma once

#include <tumble/shapes/plane.hpp>

namespace tumble {

// A gap as a cubic of s, the part of the flight from 0 to 1, by its control points in Bernstein's form (Farin 2002,
// "Curves and surfaces for CAGD", section 5). A length times a unit is exact.
template <class N>
struct GapCurve {
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Unit = typename C::Unit;
    using Sum = decltype(mul(Length{}, Unit{}));

    static constexpr bool is_double = std::is_same_v<Unit, double>;
    static constexpr int curved = is_double ? 24 : 12, straight = is_double ? 24 : 16;  // halvings

    Sum control[4];

    // An s at which a gap that is negative at the end has come down to zero; `latest` where that is later, or where
    // the gap is not negative at the end. To 2^-28, in double to 2^-48, by halving: no division, and the cost is
    // bounded. Halving follows the sign in the middle, so of three roots it may find the last. After 12 halvings (de
    // Casteljau) the chord is off by 2^-27 of the bend, which is 1e-9 m where a flight bends by 0.1 m. The end of the
    // last interval, where the point has come down to rounding.
    [[nodiscard, gnu::noinline, gnu::cold]] Unit root(Unit latest) const {
        if (!(control[3] < Sum{})) return latest;
        Sum a = control[0], b = control[1], c = control[2], d = control[3];
        Unit at{}, width = C::one();
        for (int i = 0; i < curved; ++i) {
            width = C::half(width);
            const Sum ab = N::half(a + b), bc = N::half(b + c), cd = N::half(c + d), abc = N::half(ab + bc),
                      bcd = N::half(bc + cd), middle = N::half(abc + bcd);
            if (middle > Sum{}) {
                at += width;
                if (!(at < latest)) return latest;
                a = middle;
                b = bcd;
                c = cd;
            } else {
                d = middle;
                c = abc;
                b = ab;
            }
        }
        for (int i = 0; i < straight; ++i) {
            width = C::half(width);
            const Sum middle = N::half(a + d);
            if (middle > Sum{}) {
                at += width;
                a = middle;
            } else {
                d = middle;
            }
        }
        at += width;
        return at < latest ? at : latest;
    }
    // True of a gap that is nowhere smaller than another: no control point is.
    [[nodiscard]] bool is_above(const GapCurve& other) const {
        bool above = true;
        for (int k = 0; k < 4; ++k) above = above && !(control[k] < other.control[k]);
        return above;
    }
    void add(Length gap) {
        for (Sum& c : control) c += mul(gap, C::one());
    }
};

// The height of the centre is a parabola, because gravity and contact forces are constant in a flight. The normal, seen
// from the body, is the cubic with the right values and rates at both ends (Hermite). It is off by turn^4 / 384: 2.6e-7
// at 0.1 rad.
template <class N, Features features>
class PlanePath {
public:
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Unit = typename C::Unit;
    using Curve = GapCurve<N>;
    using Sum = typename Curve::Sum;
    static constexpr Unit third() { return N::template constant<Unit>(Real{1} / Real{3}); }

    // Heights of the centre above the level at which the search ends. `rise`: a third of the way that the centre would
    // rise at the rate of the start.
    PlanePath(const CollisionShape<N>& shape, Length start, Length end, Sum rise)
        : shape_{shape}, height_{mul(start, C::one()), mul(start, C::one()) + rise,
                                 mul(start, C::one()) + rise + mul(end - start, third()), mul(end, C::one())} {}
    // The normal at both ends in principal axes, and a third of the turn of the flight at the rates there, rad.
    [[gnu::cold]] void set_normals(const Vec3<Unit>& start, const Vec3<Unit>& start_turn, const Vec3<Unit>& end,
                                   const Vec3<Unit>& end_turn) {
        normal_[0] = start;
        normal_[1] = start + cross<Unit>(start, start_turn);
        normal_[2] = end - cross<Unit>(end, end_turn);
        normal_[3] = end;
    }
    // Calls f with the gap of each point that may be the first at the level. Corners that end above it are left out.
    template <class F>
    void for_each_point(F&& f) const {
        if constexpr (features.boxes)
            if (shape_.is(ShapeKind::box)) return for_each_corner(f);
        if constexpr (features.round_shapes)
            if (!shape_.is(ShapeKind::sphere)) return for_each_end(f);
        f(curve([&](int) { return -mul(shape_.half.x(), C::one()); }));
    }

private:
    template <class F>
    [[nodiscard]] Curve curve(F&& reach) const {
        Curve curve;
        for (int k = 0; k < 4; ++k) curve.control[k] = height_[k] + reach(k);
        return curve;
    }
    template <class F>
    [[gnu::cold]] void for_each_corner(F&& f) const {
        Sum reach[4][3];
        for (int k = 0; k < 4; ++k) {
            const Vec3<Unit> n = shape_.turned ? shape_.edges.to_body(normal_[k]) : normal_[k];
            for (int i = 0; i < 3; ++i) reach[k][i] = mul(n[i], shape_.half[i]);
        }
        // The lowest at the end comes first: few of the others are not above it.
        int lowest = 0;
        for (int i = 0; i < 3; ++i) lowest |= static_cast<int>(reach[3][i] < Sum{}) << i;
        for (int other = 0; other < 8; ++other) {
            const auto reach_at = [&](int k) {
                Sum sum{};
                for (int i = 0; i < 3; ++i) sum += ((lowest ^ other) >> i & 1) != 0 ? reach[k][i] : -reach[k][i];
                return sum;
            };
            if (height_[3] + reach_at(3) < Sum{}) f(curve(reach_at));
        }
    }
    // The lowest point of a rim moves along it. That of a capsule's end is always a radius below its centre.
    template <class F>
    [[gnu::cold]] void for_each_end(F&& f) const {
        Vec3<Length> down[2];
        if (shape_.is_round())
            for (int i = 0; i < 2; ++i)
                down[i] = along(RollingPoints<N>{shape_, normal_[3 * i]}.down(), shape_.half.x());
        for (const Length up : {shape_.half.y(), -shape_.half.y()})
            f(curve([&](int k) {
                const Sum end = mul(narrow<Unit>(dot(normal_[k], shape_.axis)), up);
                return end + (shape_.is_round() ? dot(normal_[k], down[k / 2]) : -mul(shape_.half.x(), C::one()));
            }));
    }

    const CollisionShape<N>& shape_;
    Sum height_[4];
    Vec3<Unit> normal_[4];  // of a shape that is no sphere
};

}  // namespace tumble
