// Shapes that collide: planes, spheres, boxes, capsules, cylinders and hoops. Lengths are in units of
// ContactNumbers::LengthScale.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/shapes/axes.hpp>

namespace tumble {

// The points x with normal . x + offset >= 0.
template <class N>
struct HalfSpace {
    StoredVec3<typename N::Unit> normal{};  // unit; to the free side
    typename N::AlongSum offset{};          // m

    HalfSpace() = default;
    TUMBLE_COLD constexpr explicit HalfSpace(const PlaneSpec& spec) {
        const RealVec3 n = normalized(spec.normal);
        for (int i = 0; i < 3; ++i) normal[i] = N::template constant<typename N::Unit>(n[i]);
        if constexpr (N::fixed_point) {
            // The limit of the offset is four times the range of positions: half the range of its sum with n . x, so
            // that the sum cannot wrap.
            constexpr int bits = N::AlongSum::fraction_bits;
            TUMBLE_ASSERT(abs(spec.offset) <= Real::scaled(1, 62 - bits));
            offset = {spec.offset.to_fixed(bits, 63)};
        } else offset = N::template constant<typename N::Work>(spec.offset);
    }
};

// Two directions that form a right-handed frame with n.
template <class N>
constexpr void set_tangents(const StoredVec3<typename N::Unit>& n, StoredVec3<typename N::Unit> (&tangent)[2]) {
    using C = ContactNumbers<N>;
    using Unit = typename N::Unit;
    using Vector = StoredVec3<Unit>;
    const auto product = [](const Vector& a, const Vector& b) {
        return Vector{narrow<Unit>(cross_component<0>(a, b)), narrow<Unit>(cross_component<1>(a, b)),
                      narrow<Unit>(cross_component<2>(a, b))};
    };
    // Across the axis along which n is least, the first of equals. With the axis as a constant, its zeros cost nothing.
    const auto across = [&](auto axis) {
        StoredVec3<Unit> e{};
        e[axis] = C::one();
        return product(n, e);
    };
    const Unit x = magnitude_of(n.x()), y = magnitude_of(n.y()), z = magnitude_of(n.z());
    using std::integral_constant;
    if (x <= y && x <= z) tangent[0] = across(integral_constant<int, 0>{});
    else if (y <= z) tangent[0] = across(integral_constant<int, 1>{});
    else tangent[0] = across(integral_constant<int, 2>{});
    tangent[0] = C::direction(tangent[0]);
    tangent[1] = product(n, tangent[0]);
}

template <class N>
struct Plane : HalfSpace<N> {
    StoredVec3<typename N::Unit> tangent[2]{};  // form a right-handed frame with the normal

    Plane() = default;
    constexpr explicit Plane(const PlaneSpec& spec) : HalfSpace<N>{spec} { set_tangents<N>(this->normal, tangent); }
};

template <class N>
struct CollisionShape {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    using Length = typename C::Length;

    ShapeKind kind = ShapeKind::none;
    bool turned = false;  // true if a box's edges are not along principal axes; `edges` are then its axes among them
    // Half the edges of a box (along principal axes unless it is turned); the radius of a sphere; the radius and half
    // the length of a round shape.
    StoredVec3<Length> half{};
    Length radius{};          // of the sphere about the centre of mass that contains the shape
    StoredVec3<Unit> axis{};  // of a cylinder, capsule or hoop, among the principal axes
    Axes<N> edges{};

    // Converts the lengths to a coarser scale.
    constexpr void rescale(const typename C::LengthScale& from, const typename C::LengthScale& to) {
        for (int i = 0; i < 3; ++i) half[i] = to.coarser(half[i], from);
        radius = to.coarser(radius, from);
    }
    [[nodiscard]] constexpr bool is(ShapeKind k) const { return kind == k; }
    [[nodiscard]] bool is_round() const { return kind == ShapeKind::cylinder || kind == ShapeKind::hoop; }

    [[nodiscard]] Axes<N> axes(const Axes<N>& principal) const { return turned ? principal.times(edges) : principal; }
    // From the axes of the shape to principal axes.
    [[nodiscard]] Vec3<Length> principal(const Vec3<Length>& arm) const { return turned ? edges.to_world(arm) : arm; }
};

// The shapes of a world's bodies, in one scale of lengths, which the largest shape decides.
template <class N, int bodies>
class Shapes {
public:
    using Scale = typename ContactNumbers<N>::LengthScale;

    // Makes room for a length, m, and converts the shapes that are already set to the new scale. False if the scale
    // does not change.
    constexpr bool make_room(Real length) {
        if (!(length > largest_)) return false;
        largest_ = length;
        const Scale finer = scale_;
        scale_ = Scale::of(largest_);
        for (CollisionShape<N>& shape : shape_)
            if (!shape.is(ShapeKind::none)) shape.rescale(finer, scale_);
        return scale_.bits() != finer.bits();
    }
    [[nodiscard]] constexpr const Scale& scale() const { return scale_; }
    // m, of contacts.
    [[nodiscard]] constexpr Real least_tolerance() const { return scale_.least_tolerance(largest_); }
    [[nodiscard]] constexpr CollisionShape<N>& operator[](int b) { return shape_[bodies == 1 ? 0 : b]; }
    [[nodiscard]] constexpr const CollisionShape<N>& operator[](int b) const { return shape_[bodies == 1 ? 0 : b]; }

private:
    CollisionShape<N> shape_[bodies]{};
    Scale scale_{};
    Real largest_{};
};

// The largest distance of a point of the shape from its centre of mass, m.
[[nodiscard]] constexpr Real reach_of(const Shape& shape) {
    const auto [a, b, c] = shape.size;
    switch (shape.kind) {
    case ShapeKind::sphere:
    case ShapeKind::hoop: return a;
    case ShapeKind::box: return sqrt(a * a + b * b + c * c) * Real::scaled(1, -1);
    case ShapeKind::cylinder: return sqrt(a * a + b * b * Real::scaled(1, -2));
    case ShapeKind::capsule: return a + b * Real::scaled(1, -1);
    default: return {};
    }
}

template <class N>
TUMBLE_COLD constexpr void set_collision_shape(CollisionShape<N>& shape, const BodySpec& spec,
                                               const PrincipalInertia& inertia,
                                               const typename ContactNumbers<N>::LengthScale& scale) {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;
    const auto unit = [](Real v) { return N::template constant<Unit>(v); };
    const Real reach = reach_of(spec.shape);
    TUMBLE_ASSERT(C::LengthScale::fits(reach));
    shape.kind = reach > Real{} ? spec.shape.kind : ShapeKind::none;
    shape.radius = scale.length(reach);
    const Real half = Real::scaled(1, -1);
    const RealVec3 size = spec.shape.size;
    const RealQuat back = inertia.principal.conjugate();
    const RealVec3 axis[3] = {back.rotate({1, 0, 0}), back.rotate({0, 1, 0}), back.rotate({0, 0, 1})};
    if (shape.kind == ShapeKind::box) {
        // The principal axis along which an edge lies, to 2^-40 of a right angle.
        shape.turned = false;
        for (int j = 0; j < 3; ++j) {
            bool along_one = false;
            for (int i = 0; i < 3; ++i) {
                if (Real{1} - abs(axis[j][i]) < Real::scaled(1, -40)) {
                    shape.half[i] = scale.length(size[j] * half);
                    along_one = true;
                }
            }
            if (!along_one) shape.turned = true;
        }
        if (shape.turned) {
            for (int j = 0; j < 3; ++j) {
                shape.half[j] = scale.length(size[j] * half);
                for (int i = 0; i < 3; ++i) shape.edges.row[i][j] = unit(axis[j][i]);
            }
        }
    } else {
        shape.half = {scale.length(size.x), scale.length(shape.kind == ShapeKind::hoop ? Real{} : size.y * half), {}};
        for (int i = 0; i < 3; ++i) shape.axis[i] = unit(axis[2][i]);
    }
}

}  // namespace tumble
