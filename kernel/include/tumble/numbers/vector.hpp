// Vector3 and Quaternion: the vectors of the public interface, in any number: float, double, set-up numbers, working
// numbers. Plain data, so that scenes are constants. A controller computes with them in the numbers that it likes.
#pragma once

#include <tumble/config.hpp>

namespace tumble {

// Three components.
template <class T>
struct Vector3 {
    T x{};  // first component
    T y{};  // second component
    T z{};  // third component

    [[nodiscard]] constexpr T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
    constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
    // True of the zero vector.
    [[nodiscard]] constexpr bool is_zero() const {
        if constexpr (requires { x.is_zero(); }) return x.is_zero() && y.is_zero() && z.is_zero();
        else return x == T{} && y == T{} && z == T{};
    }
    // The same vector in other numbers.
    template <class To>
    [[nodiscard]] constexpr Vector3<To> as() const {
        return {static_cast<To>(x), static_cast<To>(y), static_cast<To>(z)};
    }
    friend constexpr bool operator==(const Vector3&, const Vector3&) = default;
    friend constexpr Vector3 operator+(Vector3 a, Vector3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend constexpr Vector3 operator-(Vector3 a, Vector3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend constexpr Vector3 operator-(Vector3 a) { return {-a.x, -a.y, -a.z}; }
    friend constexpr Vector3 operator*(Vector3 a, T s) { return {a.x * s, a.y * s, a.z * s}; }
};
// The product with a number. This and the next are templates, so that a program's own operators for its vectors come
// first.
template <class T>
[[nodiscard]] constexpr Vector3<T> operator*(std::type_identity_t<T> s, const Vector3<T>& a) {
    return a * s;
}
// The quotient by a number.
template <class T>
[[nodiscard]] constexpr Vector3<T> operator/(const Vector3<T>& a, std::type_identity_t<T> s) {
    return {a.x / s, a.y / s, a.z / s};
}
// Adds a vector.
template <class T>
constexpr Vector3<T>& operator+=(Vector3<T>& a, const std::type_identity_t<Vector3<T>>& b) {
    return a = a + b;
}
// Subtracts a vector.
template <class T>
constexpr Vector3<T>& operator-=(Vector3<T>& a, const std::type_identity_t<Vector3<T>>& b) {
    return a = a - b;
}
// Multiplies by a number.
template <class T>
constexpr Vector3<T>& operator*=(Vector3<T>& a, std::type_identity_t<T> s) {
    return a = a * s;
}
// Divides by a number.
template <class T>
constexpr Vector3<T>& operator/=(Vector3<T>& a, std::type_identity_t<T> s) {
    return a = a / s;
}
// The scalar product.
template <class T>
[[nodiscard]] constexpr T dot(Vector3<T> a, Vector3<T> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
// The vector product.
template <class T>
[[nodiscard]] constexpr Vector3<T> cross(Vector3<T> a, Vector3<T> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

namespace detail {

// 1, computed by the compiler.
template <class T>
inline constexpr T one = T(1);

}  // namespace detail

// Hamilton's quaternion w + xi + yj + zk. By default the identity.
template <class T>
struct Quaternion {
    T w = detail::one<T>;  // real part
    Vector3<T> v{};        // x, y, z

    friend constexpr bool operator==(const Quaternion&, const Quaternion&) = default;
    friend constexpr Quaternion operator*(Quaternion a, Quaternion b) {
        return {a.w * b.w - dot(a.v, b.v), b.v * a.w + a.v * b.w + cross(a.v, b.v)};
    }
    // The inverse rotation, of a unit quaternion.
    [[nodiscard]] constexpr Quaternion conjugate() const { return {w, -v}; }
    // Rotates a vector. The quaternion must have unit length.
    [[nodiscard]] constexpr Vector3<T> rotate(Vector3<T> r) const {
        const Vector3<T> c = cross(v, r), t = c + c;
        return r + t * w + cross(v, t);
    }
    // The same quaternion in other numbers.
    template <class To>
    [[nodiscard]] constexpr Quaternion<To> as() const {
        return {static_cast<To>(w), v.template as<To>()};
    }
};
// Rotates a vector by a unit quaternion: with the orientation of a body, from its axes into the world's.
template <class T>
[[nodiscard]] constexpr Vector3<T> rotate(const Quaternion<T>& q, const Vector3<T>& v) {
    return q.rotate(v);
}
// The inverse: from the world's axes into those of the body.
template <class T>
[[nodiscard]] constexpr Vector3<T> rotate_back(const Quaternion<T>& q, const Vector3<T>& v) {
    return q.conjugate().rotate(v);
}

}  // namespace tumble
