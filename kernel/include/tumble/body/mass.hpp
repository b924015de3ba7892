// Mass properties of solid shapes, computed with set-up numbers: mass, principal moments and principal axes.
// The kernel works in the principal frame with moments sorted downwards (x largest, z smallest); `principal` rotates
// that frame into the user's body frame, so that inputs and outputs stay in the user's axes.
#pragma once

#include <tumble/numbers/real.hpp>

namespace tumble {

// A symmetric tensor, kg m^2, about the centre of mass. xy, xz and yz are its elements, which are minus the products of
// inertia.
struct InertiaTensor {
    Real xx{};  // the moment about x
    Real yy{};  // the moment about y
    Real zz{};  // the moment about z
    Real xy{};  // minus the product of inertia of x and y
    Real xz{};  // minus the product of inertia of x and z
    Real yz{};  // minus the product of inertia of y and z

    friend constexpr bool operator==(const InertiaTensor&, const InertiaTensor&) = default;
};

// The order of the user's axes as principal axes, where no product of inertia makes them turn. The third principal axis
// points backwards if the order is odd.
class AxisOrder {
public:
    // No order: the principal axes are others than the user's.
    constexpr AxisOrder() = default;
    // The user's axes that are the first and the second principal axis.
    constexpr AxisOrder(int first, int second)
        : code_{static_cast<std::uint8_t>(known | first | second << 2 | ((second - first + 3) % 3 == 1 ? 0 : odd))} {}

    // False where the principal axes are others than the user's.
    [[nodiscard]] TUMBLE_INLINE constexpr bool is_known() const { return code_ != 0; }
    // The user's axis that is principal axis i.
    [[nodiscard]] TUMBLE_INLINE constexpr int axis(int i) const {
        const int first = code_ & 3, second = code_ >> 2 & 3;
        return i == 0 ? first : i == 1 ? second : 3 - first - second;
    }
    // The component along principal axis i of a vector in the user's axes.
    [[nodiscard]] TUMBLE_INLINE constexpr auto principal(const auto& user, int i) const {
        const auto component = user[axis(i)];
        return i == 2 && (code_ & odd) != 0 ? -component : component;
    }
    // Writes a vector in principal axes to `user`.
    TUMBLE_INLINE constexpr void place(auto& user, const auto& principal) const {
        user[axis(0)] = principal[0];
        user[axis(1)] = principal[1];
        user[axis(2)] = (code_ & odd) != 0 ? -principal[2] : principal[2];
    }

private:
    static constexpr int known = 32, odd = 16;
    std::uint8_t code_ = 0;
};

struct PrincipalInertia {
    RealVec3 moments;    // kg m^2, sorted downwards
    RealQuat principal;  // rotates principal-frame vectors into the user's body frame
    AxisOrder order{};   // the same rotation, where it is an order of axes
};

// Solids, and the hoop, a thin ring. Bodies of shape `points` and `none` collide with nothing.
enum class ShapeKind : std::uint8_t { none, sphere, box, cylinder, hoop, capsule, points };

// A shape about its centre of mass. The meaning of size, in metres:
//   box: full edges; sphere: radius; hoop: radius, about z;
//   cylinder: radius and length along z; capsule: radius and length of the straight part, along z.
struct Shape {
    ShapeKind kind = ShapeKind::none;  // none: a mass without extension
    RealVec3 size{};                   // m, as above

    friend constexpr bool operator==(const Shape&, const Shape&) = default;
};

namespace detail {

// (x, y) rotated by the angle with this cosine and sine.
TUMBLE_COLD constexpr void turn_pair(Real& x, Real& y, const Real& cosine, const Real& sine) {
    const Real before = x;
    x = cosine * before - sine * y;
    y = sine * before + cosine * y;
}

// One Jacobi rotation, which zeroes element (p, q) of the symmetric matrix a. v accumulates the rotations.
TUMBLE_COLD constexpr void jacobi_rotate(Real (&a)[3][3], Real (&v)[3][3], int p, int q) {
    if (a[p][q].is_zero()) return;
    const Real theta = (a[q][q] - a[p][p]) / (a[p][q] * Real{2});
    const Real t = (theta.is_negative() ? Real{-1} : Real{1}) / (abs(theta) + sqrt(theta * theta + Real{1}));
    const Real c = Real{1} / sqrt(t * t + Real{1}), s = t * c;
    for (int k = 0; k < 3; ++k) turn_pair(a[k][p], a[k][q], c, s);
    for (int k = 0; k < 3; ++k) turn_pair(a[p][k], a[q][k], c, s);
    a[p][q] = a[q][p] = Real{};
    for (int k = 0; k < 3; ++k) turn_pair(v[k][p], v[k][q], c, s);
}

// Products of set-up numbers as loops over their components, which is less code than the same by name.
TUMBLE_COLD constexpr void cross_product(const Real (&a)[3], const Real (&b)[3], Real (&result)[3]) {
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        result[i] = a[j] * b[k] - a[k] * b[j];
    }
}
// a b of quaternions.
TUMBLE_COLD [[nodiscard]] constexpr RealQuat product(const RealQuat& a, const RealQuat& b) {
    const Real u[3]{a.v.x, a.v.y, a.v.z}, v[3]{b.v.x, b.v.y, b.v.z};
    Real across[3], along{};
    cross_product(u, v, across);
    for (int i = 0; i < 3; ++i) {
        along += u[i] * v[i];
        across[i] = v[i] * a.w + u[i] * b.w + across[i];
    }
    return {a.w * b.w - along, {across[0], across[1], across[2]}};
}
// The inverse rotation by a unit quaternion.
TUMBLE_COLD [[nodiscard]] constexpr RealVec3 rotated_back(const RealQuat& q, const RealVec3& v) {
    const Real u[3]{-q.v.x, -q.v.y, -q.v.z}, r[3]{v.x, v.y, v.z};
    Real twice[3], across[3];
    cross_product(u, r, twice);
    for (Real& component : twice) component *= Real{2};
    cross_product(u, twice, across);
    for (int i = 0; i < 3; ++i) across[i] = r[i] + twice[i] * q.w + across[i];
    return {across[0], across[1], across[2]};
}

// The unit quaternion of a rotation matrix that is given by its columns (Shepperd: the largest pivot).
TUMBLE_COLD [[nodiscard]] constexpr RealQuat quaternion_of(const Real (&column)[3][3]) {
    const Real trace = column[0][0] + column[1][1] + column[2][2];
    // Element (i, j) less (j, i): of twice the sine of the angle, the component along the third axis.
    const auto lean = [&](int i, int j) { return column[i][j] - column[j][i]; };
    Real w{}, v[3];
    if (trace > Real{}) {
        w = trace + Real{1};
        for (int i = 0; i < 3; ++i) v[i] = lean((i + 1) % 3, (i + 2) % 3);
    } else {
        int p = column[1][1] >= column[2][2] ? 1 : 2;
        if (column[0][0] >= column[1][1] && column[0][0] >= column[2][2]) p = 0;
        w = lean((p + 1) % 3, (p + 2) % 3);
        v[p] = Real{1} + column[p][p];
        for (int i = 0; i < 3; ++i) {
            if (i == p) continue;
            v[p] -= column[i][i];
            v[i] = column[p][i] + column[i][p];
        }
    }
    return normalized(RealQuat{w, {v[0], v[1], v[2]}});
}

TUMBLE_COLD [[nodiscard]] constexpr PrincipalInertia principal_inertia_of(const InertiaTensor& i) {
    Real a[3][3] = {{i.xx, i.xy, i.xz}, {i.xy, i.yy, i.yz}, {i.xz, i.yz, i.zz}};
    Real v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < 8; ++sweep) {
        jacobi_rotate(a, v, 0, 1);
        jacobi_rotate(a, v, 0, 2);
        jacobi_rotate(a, v, 1, 2);
    }
    int order[3] = {0, 1, 2};  // the sort is stable: equal moments keep the user's order
    const auto swap_if_less = [&](int m, int n) {
        if (a[order[m]][order[m]] < a[order[n]][order[n]]) {
            const int t = order[m];
            order[m] = order[n];
            order[n] = t;
        }
    };
    swap_if_less(0, 1);
    swap_if_less(1, 2);
    swap_if_less(0, 1);
    Real axis[3][3];
    for (int k = 0; k < 3; ++k)
        for (int n = 0; n < 2; ++n) axis[n][k] = v[k][order[n]];
    cross_product(axis[0], axis[1], axis[2]);
    const bool is_diagonal = i.xy.is_zero() && i.xz.is_zero() && i.yz.is_zero();
    return {{a[order[0]][order[0]], a[order[1]][order[1]], a[order[2]][order[2]]},
            quaternion_of(axis),
            is_diagonal ? AxisOrder{order[0], order[1]} : AxisOrder{}};
}

}  // namespace detail

// Principal moments and axes of a full tensor, by cyclic Jacobi rotations (Golub & Van Loan, 8.5), to about 2^-60.
[[nodiscard]] constexpr PrincipalInertia principal_inertia(const InertiaTensor& i) {
    PrincipalInertia principal{};
    detail::run_once([&] { principal = detail::principal_inertia_of(i); });
    return principal;
}

// The tensor of a homogeneous solid (of a thin ring for a hoop) of the given mass, kg m^2. Zero for `none`.
[[nodiscard]] constexpr InertiaTensor inertia_of(const Shape& shape, Real mass) {
    const auto [a, b, c] = shape.size;
    const auto diagonal = [&](Real x, Real y, Real z) { return InertiaTensor{mass * x, mass * y, mass * z, 0, 0, 0}; };
    const Real twelfth = Real{1} / Real{12};
    switch (shape.kind) {
    case ShapeKind::sphere: {
        const Real i = a * a * Real{2} / Real{5};
        return diagonal(i, i, i);
    }
    case ShapeKind::box:
        return diagonal((b * b + c * c) * twelfth, (a * a + c * c) * twelfth, (a * a + b * b) * twelfth);
    case ShapeKind::cylinder: {
        const Real t = (a * a * Real{3} + b * b) * twelfth;
        return diagonal(t, t, a * a / Real{2});
    }
    case ShapeKind::hoop: {
        const Real t = a * a / Real{2};
        return diagonal(t, t, a * a);
    }
    case ShapeKind::capsule: {
        // The straight part and the two caps share the mass in proportion to their volumes, length : 4/3 radius.
        const Real caps_length = a * Real{4} / Real{3}, straight = b / (b + caps_length),
                   caps = caps_length / (b + caps_length);
        const Real axial = straight * a * a / Real{2} + caps * a * a * Real{2} / Real{5};
        const Real transverse = straight * (b * b * twelfth + a * a / Real{4}) +
                                caps * (a * a * Real{2} / Real{5} + b * b / Real{4} + a * b * Real{3} / Real{8});
        return diagonal(transverse, transverse, axial);
    }
    default: return {};
    }
}

// True if all lengths of the shape are positive. The straight part of a capsule may be 0: it is then a ball.
[[nodiscard]] constexpr bool has_positive_size(const Shape& shape) {
    const bool is_flat = shape.kind == ShapeKind::none || shape.kind == ShapeKind::points,
               is_round = shape.kind == ShapeKind::sphere || shape.kind == ShapeKind::hoop;
    const int lengths = is_flat ? 0 : is_round ? 1 : shape.kind == ShapeKind::box ? 3 : 2;
    for (int i = 0; i < lengths; ++i) {
        const Real length = shape.size[i];
        const bool may_be_zero = shape.kind == ShapeKind::capsule && i == 1;
        if (length.is_negative() || (length.is_zero() && !may_be_zero)) return false;
    }
    return true;
}
// True if a body can have these principal moments, sorted downwards: the largest is at most the sum of the others, with
// a millionth as the margin for rounding.
[[nodiscard]] constexpr bool are_of_a_body(const RealVec3& moments) {
    return moments.x * (Real{1} - Real::scaled(1, -20)) <= moments.y + moments.z;
}

// m^3; zero for shapes without a volume (none, hoop, points).
[[nodiscard]] constexpr Real volume_of(const Shape& shape) {
    const Real pi = 3.14159265358979323846;
    const auto [a, b, c] = shape.size;
    switch (shape.kind) {
    case ShapeKind::sphere: return pi * a * a * a * Real{4} / Real{3};
    case ShapeKind::box: return a * b * c;
    case ShapeKind::cylinder: return pi * a * a * b;
    case ShapeKind::capsule: return pi * a * a * (b + a * Real{4} / Real{3});
    default: return {};
    }
}

// One of the masses from which point_cloud() makes a body.
struct PointMass {
    RealVec3 position;  // m
    Real mass;          // kg
};
// The mass properties of rigidly connected point masses.
struct PointCloud {
    Real mass;              // kg
    RealVec3 centre;        // m, the centre of mass
    InertiaTensor inertia;  // kg m^2, about the centre of mass
};
// Adds up `count` points. At least one must have mass.
[[nodiscard]] constexpr PointCloud point_cloud(const PointMass* points, int count) {
    PointCloud cloud{};
    for (int i = 0; i < count; ++i) {
        cloud.mass += points[i].mass;
        cloud.centre = cloud.centre + points[i].position * points[i].mass;
    }
    cloud.centre = cloud.centre * (Real{1} / cloud.mass);
    for (int i = 0; i < count; ++i) {
        const RealVec3 r = points[i].position - cloud.centre;
        const Real m = points[i].mass;
        cloud.inertia.xx += m * (r.y * r.y + r.z * r.z);
        cloud.inertia.yy += m * (r.x * r.x + r.z * r.z);
        cloud.inertia.zz += m * (r.x * r.x + r.y * r.y);
        cloud.inertia.xy -= m * r.x * r.y;
        cloud.inertia.xz -= m * r.x * r.z;
        cloud.inertia.yz -= m * r.y * r.z;
    }
    return cloud;
}

}  // namespace tumble
