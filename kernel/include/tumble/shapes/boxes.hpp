// Two boxes: the separating axis test over their 15 axes (Gottschalk, Lin and Manocha 1996), and the contact points.
// These are either a face clipped against a face, reduced to four points, or the nearest points of two edges.
#pragma once

#include <tumble/shapes/pair_view.hpp>

namespace tumble {

// The axis along which two boxes are farthest apart: 0-2 is the normal of a face of a, 3-5 that of a face of b, the
// others are cross products of an edge of each. Also: whether b is on the negative side of the axis.
struct BoxAxis {
    std::int8_t index = 0;
    bool negative = false;
    // Set by Seams: neighbours cover the other sides that look at the other body; and this one too.
    bool covered = false, idle = false;

    // Writes or reads it.
    template <class Self, class Archive>
    static void archive(Self& self, Archive& to) {
        to.within(self.index, 0, 14);
        to(self.negative, self.covered, self.idle);
    }
};

template <class N>
class BoxBox {
public:
    using C = ContactNumbers<N>;
    using Length = typename C::Length;
    using Unit = typename C::Unit;

    Vec3<Unit> normal;  // world, from b to a
    Length gap;
    BoxAxis axis;

    // `bias`, >= 0: an axis of two edges is chosen only if it is farther apart than the best face by this length, so
    // that the choice does not alternate.
    BoxBox(const PairView<N>& view, Length bias) : axes_{view.a.axes(view.axes_a), view.b.axes(view.axes_b)} {
        // In the axes of a. r converts b's axes to a's. t goes from a to b.
        const auto &h = view.a.half, &k = view.b.half;
        const Vec3<Length> t = -axes_[0].to_body(view.reach);
        Vec3<Unit> r[3], size[3];
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                r[i][j] = narrow<Unit>(dot(axes_[0].axis(i), axes_[1].axis(j)));
                size[i][j] = magnitude_of(r[i][j]);
            }
        }
        const auto column = [](const Vec3<Unit>(&m)[3], int j) { return Vec3<Unit>{m[0][j], m[1][j], m[2][j]}; };
        const auto take_face = [&](Length separation, int index, bool negative) {
            apart_[index] = separation;
            if (index > 0 && !(separation > gap)) return;
            gap = separation;
            axis = {static_cast<std::int8_t>(index), negative};
        };
        for (int i = 0; i < 3; ++i)
            take_face(magnitude_of(t[i]) - h[i] - narrow<Length>(dot(size[i], k)), i, t[i] < Length{});
        for (int j = 0; j < 3; ++j) {
            const Length along = narrow<Length>(dot(column(r, j), t));
            take_face(magnitude_of(along) - k[j] - narrow<Length>(dot(column(size, j), h)), 3 + j, along < Length{});
        }
        const Length faces = gap;
        for (int i = 0; i < 3; ++i) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
            for (int j = 0; j < 3; ++j) {
                const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
                if (size[i][j] > C::nearly_parallel()) continue;
                // a_i x b_j has the components (-r[i2][j], r[i1][j]) along a_i1, a_i2.
                const Length along = narrow<Length>(mul_sub(mul(r[i1][j], t[i2]), r[i2][j], t[i1]));
                const Length reach = narrow<Length>(mul_add(mul(size[i2][j], h[i1]), size[i1][j], h[i2])) +
                                     narrow<Length>(mul_add(mul(size[i][j2], k[j1]), size[i][j1], k[j2]));
                const Length separation = C::over_sine(magnitude_of(along) - reach, r[i][j]);
                if (!(separation > gap)) continue;
                gap = separation;
                if (separation > faces + bias) axis = {static_cast<std::int8_t>(6 + 3 * i + j), along < Length{}};
            }
        }
        if (axis.index < 3) {
            normal = axes_[0].axis(axis.index);
        } else if (axis.index < 6) {
            normal = axes_[1].axis(axis.index - 3);
        } else {
            normal =
                C::direction(cross<Unit>(axes_[0].axis((axis.index - 6) / 3), axes_[1].axis((axis.index - 6) % 3)));
        }
        if (!axis.negative) normal = -normal;
    }
    // Reuses the result of the test for boxes that have not moved since.
    BoxBox(const PairView<N>& view, const BoxAxis& found, const Vec3<Unit>& along, Length apart)
        : normal{along}, gap{apart}, axis{found}, axes_{view.a.axes(view.axes_a), view.b.axes(view.axes_b)} {}

    // Whether a face of another direction is as near, to `band`. Not of a result that is reused.
    [[nodiscard]] bool is_at_edge(Length band) const {
        for (int i = 0; i < 6; ++i) {
            if (i == axis.index || apart_[i] < -band) continue;
            const Unit cosine = narrow<Unit>(dot(normal, axes_[i < 3 ? 0 : 1].axis(i % 3)));
            if (!(magnitude_of(cosine) > C::nearly_parallel())) return true;
        }
        return false;
    }
    // The points of the axis. Of two edges also those of the faces that look most along their normal: where the bodies
    // turn or slide off the edges, these touch next, and where bodies lie across each other, they hold them. Their gaps
    // are along the normal, from below.
    void find(const PairView<N>& view, Manifold<N>& found, Length band) const {
        if (axis.index < 6) return find_on_faces(view, found, band, axis);
        find_on_edges(view, found);
        find_beside(view, found, band);
    }

private:
    [[gnu::noinline]] void find_beside(const PairView<N>& view, Manifold<N>& found, Length band) const {
        int face = 0;
        Unit along{};
        for (int i = 0; i < 6; ++i) {
            const Unit cosine = narrow<Unit>(dot(normal, axes_[i / 3].axis(i % 3)));
            if (!(magnitude_of(cosine) > magnitude_of(along))) continue;
            along = cosine;
            face = i;
        }
        Manifold<N> beside;
        find_on_faces(view, beside, band, {static_cast<std::int8_t>(face), along > Unit{}});
        const Length close = C::sixteenth(view.a.radius);
        for (int i = 0; i < beside.count && found.count < contact::max_points; ++i) {
            ManifoldPoint<N> point = beside.point[i];
            // 1 / c is at least 2 - c.
            point.gap += point.gap - narrow<Length>(mul(magnitude_of(along), point.gap));
            if (point.gap < gap) point.gap = gap;
            if (point.gap > band || sum_of_magnitudes(Vec3<Length>(point.arm - found.point[0].arm)) < close) continue;
            found.add() = point;
        }
    }
    struct Vertex {
        Length u, v, gap;  // in the plane of the face, and above it
    };
    // A face that is clipped against the four sides of another has at most eight vertices.
    struct Polygon {
        Vertex vertex[8];
        int count = 0;
    };

    // Clips the incident face (of the other box, the one that points most against the normal of the reference face)
    // against the sides of the reference face. Both bodies get the same points: those of the incident face.
    void find_on_faces(const PairView<N>& view, Manifold<N>& found, Length band, const BoxAxis& of) const {
        const int side = of.index < 3 ? 0 : 1, other = 1 - side, face = of.index % 3, iu = (face + 1) % 3,
                  iv = (face + 2) % 3;
        const Axes<N>&axes = axes_[side], &incident = axes_[other];
        // Away from the reference box: against `normal` for a, along it for b.
        const Vec3<Unit> outward = side == 0 ? Vec3<Unit>(-normal) : normal;
        const bool flipped = of.negative == (side == 0);
        const Vec3<Unit> n = incident.to_body(outward);
        int k = 0;
        for (int i = 1; i < 3; ++i)
            if (magnitude_of(n[i]) > magnitude_of(n[k])) k = i;
        const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        const bool up = n[k] < Unit{};  // the face at +k points against the normal
        const CollisionShape<N>&reference_shape = side == 0 ? view.a : view.b,
              &incident_shape = side == 0 ? view.b : view.a;
        // From the reference box to the incident box, in the reference axes.
        const Vec3<Length> to_incident = axes.to_body(side == 0 ? Vec3<Length>(-view.reach) : view.reach);
        Vec3<Length> centre = to_incident, edge[2];
        {
            const auto along_axis = [&](int i, Length l) { return axes.to_body(along(incident.axis(i), l)); };
            centre += along_axis(k, up ? incident_shape.half[k] : -incident_shape.half[k]);
            edge[0] = along_axis(k1, incident_shape.half[k1]);
            edge[1] = along_axis(k2, incident_shape.half[k2]);
        }
        Polygon polygon;
        const Length top = reference_shape.half[face];
        for (int corner = 0; corner < 4; ++corner) {
            const bool plus_first = corner == 1 || corner == 2, plus_second = corner >= 2;
            const Vec3<Length> p = centre + (plus_first ? edge[0] : Vec3<Length>(-edge[0])) +
                                   (plus_second ? edge[1] : Vec3<Length>(-edge[1]));
            polygon.vertex[polygon.count++] = {p[iu], p[iv], (flipped ? -p[face] : p[face]) - top};
        }
        for (int s = 0; s < 4; ++s) clip(polygon, s, reference_shape.half[s < 2 ? iu : iv]);
        reduce(polygon, band);
        for (int i = 0; i < polygon.count; ++i) {
            const Vertex& vertex = polygon.vertex[i];
            if (vertex.gap > band) continue;
            Vec3<Length> p;  // reference axes
            p[iu] = vertex.u;
            p[iv] = vertex.v;
            p[face] = flipped ? -(vertex.gap + top) : vertex.gap + top;
            const Vec3<Length> q = incident.to_body(axes.to_world(Vec3<Length>(p - to_incident)));
            const Vec3<Length> of_reference = reference_shape.principal(p), of_incident = incident_shape.principal(q);
            found.add() = {side == 0 ? of_reference : of_incident, side == 0 ? of_incident : of_reference, vertex.gap};
        }
    }

    // Side s of the reference face: u <= half, -u <= half, v <= half, -v <= half.
    static void clip(Polygon& polygon, int s, Length half) {
        const auto beyond = [&](const Vertex& p) {
            const Length x = s < 2 ? p.u : p.v;
            return (s & 1) == 0 ? x - half : -x - half;
        };
        Polygon clipped;
        for (int i = 0; i < polygon.count; ++i) {
            const Vertex &p = polygon.vertex[i], &q = polygon.vertex[i + 1 < polygon.count ? i + 1 : 0];
            const Length p_beyond = beyond(p), q_beyond = beyond(q);
            const bool p_in = !(p_beyond > Length{}), q_in = !(q_beyond > Length{});
            if (p_in && clipped.count < 8) clipped.vertex[clipped.count++] = p;
            if (p_in == q_in || clipped.count == 8) continue;
            const Unit part = C::ratio(magnitude_of(p_beyond), magnitude_of(p_beyond) + magnitude_of(q_beyond));
            const auto between = [&](Length from, Length to) { return from + narrow<Length>(mul(part, to - from)); };
            clipped.vertex[clipped.count++] = {between(p.u, q.u), between(p.v, q.v), between(p.gap, q.gap)};
        }
        polygon = clipped;
    }

    // Keeps at most four points: the lowest, the farthest from it, and the farthest from their line on either side.
    static void reduce(Polygon& polygon, Length band) {
        int count = 0;
        for (int i = 0; i < polygon.count; ++i)
            if (!(polygon.vertex[i].gap > band)) polygon.vertex[count++] = polygon.vertex[i];
        polygon.count = count;
        if (count <= contact::max_points) return;
        int chosen[4] = {0, 0, 0, 0};
        for (int i = 1; i < count; ++i)
            if (polygon.vertex[i].gap < polygon.vertex[chosen[0]].gap) chosen[0] = i;
        const Vertex& a = polygon.vertex[chosen[0]];
        const auto distance2 = [&](const Vertex& p) {
            return mul_add(mul(p.u - a.u, p.u - a.u), p.v - a.v, p.v - a.v);
        };
        chosen[1] = chosen[0] == 0 ? 1 : 0;
        for (int i = 0; i < count; ++i)
            if (distance2(polygon.vertex[i]) > distance2(polygon.vertex[chosen[1]])) chosen[1] = i;
        const Vertex& b = polygon.vertex[chosen[1]];
        const auto area = [&](const Vertex& p) { return mul_sub(mul(b.u - a.u, p.v - a.v), b.v - a.v, p.u - a.u); };
        auto most = area(a), least = area(a);
        chosen[2] = chosen[3] = -1;
        for (int i = 0; i < count; ++i) {
            const auto here = area(polygon.vertex[i]);
            if (here > most) {
                most = here;
                chosen[2] = i;
            }
            if (here < least) {
                least = here;
                chosen[3] = i;
            }
        }
        Polygon kept;
        for (const int i : chosen)
            if (i >= 0) kept.vertex[kept.count++] = polygon.vertex[i];
        polygon = kept;
    }

    // The point on a's edge that is nearest to the line of b's edge.
    void find_on_edges(const PairView<N>& view, Manifold<N>& found) const {
        const int i = (axis.index - 6) / 3, j = (axis.index - 6) % 3;
        const Vec3<Unit> na = axes_[0].to_body(normal), nb = axes_[1].to_body(normal);
        Vec3<Length> on_a, on_b;
        for (int m = 0; m < 3; ++m) {
            on_a[m] = m == i ? Length{} : na[m] > Unit{} ? -view.a.half[m] : view.a.half[m];
            on_b[m] = m == j ? Length{} : nb[m] > Unit{} ? view.b.half[m] : -view.b.half[m];
        }
        const Vec3<Unit> a = axes_[0].axis(i), b = axes_[1].axis(j);
        const Vec3<Length> apart = axes_[1].to_world(on_b) - view.reach - axes_[0].to_world(on_a);
        const Unit c = narrow<Unit>(dot(a, b));
        const Length along_a = narrow<Length>(dot(a, apart)), along_b = narrow<Length>(dot(b, apart));
        const auto part = [&](Length l, Length less, Length most) {
            const Length s = C::over_sine(C::over_sine(l - less, c), c);
            return s > most ? most : s < -most ? -most : s;
        };
        on_a[i] = part(along_a, narrow<Length>(mul(c, along_b)), view.a.half[i]);
        on_b = axes_[1].to_body(Vec3<Length>(axes_[0].to_world(on_a) + view.reach));  // the same point
        found.add() = {view.a.principal(on_a), view.b.principal(on_b), gap};
    }

    Axes<N> axes_[2];
    Length apart_[6];  // along the normals of the faces
};

}  // namespace tumble
