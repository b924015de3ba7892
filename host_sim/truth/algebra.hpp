// Vectors and quaternions for references and oracles, in any floating-point type. They share no code with the kernel on
// purpose: the formulas are plain, and every product is rounded. Quaternions follow Hamilton's convention; q rotates a
// vector from the body frame into the world frame.
#pragma once

#include <cmath>

namespace tumble::reference {

template <class T>
struct Vec {
    T x{}, y{}, z{};

    [[nodiscard]] T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    friend Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend Vec operator*(Vec a, T s) { return {a.x * s, a.y * s, a.z * s}; }
    friend Vec operator*(T s, Vec a) { return a * s; }
    Vec operator-() const { return {-x, -y, -z}; }
    friend bool operator==(const Vec&, const Vec&) = default;
};

template <class T>
[[nodiscard]] T dot(Vec<T> a, Vec<T> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
[[nodiscard]] Vec<T> cross(Vec<T> a, Vec<T> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
[[nodiscard]] T norm(Vec<T> a) {
    return std::sqrt(dot(a, a));
}
// In its direction; not of zero.
template <class T>
[[nodiscard]] Vec<T> unit(Vec<T> a) {
    return a * (1 / norm(a));
}
// The product by elements: a diagonal matrix times a vector.
template <class T>
[[nodiscard]] Vec<T> times(Vec<T> d, Vec<T> a) {
    return {d.x * a.x, d.y * a.y, d.z * a.z};
}
template <class T>
[[nodiscard]] Vec<T> over(Vec<T> a, Vec<T> d) {
    return {a.x / d.x, a.y / d.y, a.z / d.z};
}

template <class T>
struct Quaternion {
    T w = 1;
    Vec<T> v{};

    friend Quaternion operator*(Quaternion a, Quaternion b) {
        return {a.w * b.w - dot(a.v, b.v), a.w * b.v + b.w * a.v + cross(a.v, b.v)};
    }
    friend Quaternion operator*(Quaternion a, T s) { return {a.w * s, a.v * s}; }
    friend Quaternion operator+(Quaternion a, Quaternion b) { return {a.w + b.w, a.v + b.v}; }
    friend bool operator==(const Quaternion&, const Quaternion&) = default;
    [[nodiscard]] Quaternion conjugate() const { return {w, -v}; }
    [[nodiscard]] T norm2() const { return w * w + dot(v, v); }
    [[nodiscard]] Quaternion normalized() const { return *this * (T(1) / std::sqrt(norm2())); }
    // q (0, r) q*. Where q has another length than 1, it is |q|^2 times the rotated vector.
    [[nodiscard]] Vec<T> rotate(Vec<T> r) const {
        return (w * w - dot(v, v)) * r + T(2) * dot(v, r) * v + T(2) * w * cross(v, r);
    }
    [[nodiscard]] Vec<T> rotate_back(Vec<T> r) const { return conjugate().rotate(r); }
};

// The rotation about a vector's direction by its length, rad.
template <class T>
[[nodiscard]] Quaternion<T> exponential(Vec<T> angle) {
    const T a = norm(angle);
    if (a == T(0)) return {};
    return {std::cos(a / 2), angle * (std::sin(a / 2) / a)};
}

// The angle between two orientations, rad. Their lengths may differ from 1.
template <class T>
[[nodiscard]] T angle_between(Quaternion<T> a, Quaternion<T> b) {
    const Quaternion<T> d = a.conjugate() * b;
    return 2 * std::atan2(norm(d.v), std::abs(d.w));
}

}  // namespace tumble::reference
