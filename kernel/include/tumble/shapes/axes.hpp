// The axes of a body in the world, for shapes: a rotation as a matrix.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

// The columns are the body's axes in the world.
template <class N>
struct Axes {
    using C = ContactNumbers<N>;
    using Unit = typename C::Unit;

    StoredVec3<Unit> row[3];  // row[i][j]: component i (world) of axis j

    // The rotation matrix of q, times |q|^2, which is off 1 by rounding.
    [[nodiscard, gnu::noinline]] static Axes of(const Quat<Unit>& q) {
        const auto ww = mul(q.w, q.w), xx = mul(q.v.x(), q.v.x()), yy = mul(q.v.y(), q.v.y()),
                   zz = mul(q.v.z(), q.v.z());
        const auto xy = mul(q.v.x(), q.v.y()), xz = mul(q.v.x(), q.v.z()), yz = mul(q.v.y(), q.v.z());
        const auto wx = mul(q.w, q.v.x()), wy = mul(q.w, q.v.y()), wz = mul(q.w, q.v.z());
        const auto twice = [](auto a) { return narrow<Unit>(a + a); };
        const auto p = ww - zz, r = xx - yy, s = ww + zz, t = xx + yy;
        return {{{narrow<Unit>(p + r), twice(xy - wz), twice(xz + wy)},
                 {twice(xy + wz), narrow<Unit>(p - r), twice(yz - wx)},
                 {twice(xz - wy), twice(yz + wx), narrow<Unit>(s - t)}}};
    }
    [[nodiscard]] Vec3<Unit> axis(int j) const { return {row[0][j], row[1][j], row[2][j]}; }
    template <class T>
    [[nodiscard]] Vec3<T> to_world(const Vec3<T>& v) const {
        return {narrow<T>(dot(row[0], v)), narrow<T>(dot(row[1], v)), narrow<T>(dot(row[2], v))};
    }
    template <class T>
    [[nodiscard]] Vec3<T> to_body(const Vec3<T>& v) const {
        return {narrow<T>(dot(axis(0), v)), narrow<T>(dot(axis(1), v)), narrow<T>(dot(axis(2), v))};
    }
    friend bool operator==(const Axes& a, const Axes& b) {
        return a.row[0] == b.row[0] && a.row[1] == b.row[1] && a.row[2] == b.row[2];
    }
    // This rotation after another one.
    [[nodiscard]] Axes times(const Axes& first) const {
        Axes product;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) product.row[i][j] = narrow<Unit>(dot(row[i], first.axis(j)));
        return product;
    }
};

}  // namespace tumble
