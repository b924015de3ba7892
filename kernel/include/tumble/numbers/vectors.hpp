// Vectors and quaternions: Eigen's fixed-size storage for every number system, and products that keep sums wide. dot,
// cross and rotate are functions of the kernel, because Eigen's own would round each product. Sums, differences,
// blocks, maps and .cast<double>() are Eigen's.
#pragma once

#include <tumble/numbers/scaled.hpp>

namespace Eigen {

template <int F>
struct NumTraits<tumble::Fixed<F>> : GenericNumTraits<tumble::Fixed<F>> {
    using Real = tumble::Fixed<F>;
    using NonInteger = tumble::Fixed<F>;
    using Nested = tumble::Fixed<F>;
    using Literal = tumble::Fixed<F>;
    enum {
        IsComplex = 0,
        IsInteger = 0,
        IsSigned = 1,
        RequireInitialization = 0,
        ReadCost = 1,
        AddCost = 1,
        MulCost = 4
    };
};

}  // namespace Eigen

namespace tumble {

template <class T>
using Vec3 = Eigen::Matrix<T, 3, 1>;

// A vector as a world keeps it. The compiler can set it up, which it cannot do with Eigen's.
template <class T>
struct StoredVec3 {
    T component[3];

    StoredVec3() = default;
    constexpr StoredVec3(T x, T y, T z) : component{x, y, z} {}
    TUMBLE_INLINE StoredVec3(const Vec3<T>& v)  // NOLINT(google-explicit-constructor): it is the same vector
        : component{v.x(), v.y(), v.z()} {}
    [[nodiscard]] TUMBLE_INLINE operator Vec3<T>() const { return {component[0], component[1], component[2]}; }

    [[nodiscard]] TUMBLE_INLINE constexpr T& operator[](int i) { return component[i]; }
    [[nodiscard]] TUMBLE_INLINE constexpr const T& operator[](int i) const { return component[i]; }
    [[nodiscard]] TUMBLE_INLINE constexpr const T& x() const { return component[0]; }
    [[nodiscard]] TUMBLE_INLINE constexpr const T& y() const { return component[1]; }
    [[nodiscard]] TUMBLE_INLINE constexpr const T& z() const { return component[2]; }
    [[nodiscard]] constexpr StoredVec3 operator-() const { return {-component[0], -component[1], -component[2]}; }
    friend constexpr bool operator==(const StoredVec3&, const StoredVec3&) = default;
};
// True of a Vec3 and of a StoredVec3.
template <class V>
inline constexpr bool is_vector_of_three = false;
template <class T>
inline constexpr bool is_vector_of_three<Vec3<T>> = true;
template <class T>
inline constexpr bool is_vector_of_three<StoredVec3<T>> = true;
template <class V>
concept VectorOfThree = is_vector_of_three<V>;

// An array whose bytes are zero at first, so that the compiler can set up a world. All bytes zero must be a value of T:
// it is read where nothing has been written yet.
template <class T, int count>
class ZeroedArray {
public:
    [[nodiscard]] TUMBLE_INLINE T& operator[](int i) { return array()[count == 1 ? 0 : i]; }
    [[nodiscard]] TUMBLE_INLINE const T& operator[](int i) const { return array()[count == 1 ? 0 : i]; }
    [[nodiscard]] TUMBLE_INLINE T* begin() { return array(); }
    [[nodiscard]] TUMBLE_INLINE const T* begin() const { return array(); }
    [[nodiscard]] TUMBLE_INLINE T* end() { return array() + count; }

private:
    static_assert(std::is_trivially_destructible_v<T>);
    using Array = T[count];
    // Not by std::launder, which hides from the compiler whose address it is: 1 % of a step.
    [[nodiscard]] TUMBLE_INLINE Array& array() { return reinterpret_cast<Array&>(bytes_); }
    [[nodiscard]] TUMBLE_INLINE const Array& array() const { return reinterpret_cast<const Array&>(bytes_); }

    alignas(T) std::byte bytes_[sizeof(T) * count]{};
};

// Hamilton's w + xi + yj + zk. A plain value: whoever integrates it normalises it.
template <class T, class Vector = Vec3<T>>
struct Quat {
    // Not initialised by default, so that arrays of stages cost nothing. Quat{} does not initialise v either.
    T w;
    Vector v;

    [[nodiscard]] constexpr Quat conjugate() const { return {w, -v}; }
};

// Products of the other number types, so that one formula serves all number systems.
template <class T>
concept SelfContained = std::floating_point<T> || std::same_as<T, Scaled>;  // the product of two has the type itself
template <SelfContained T>
[[nodiscard]] TUMBLE_INLINE constexpr T mul(T a, T b) {
    return a * b;
}
template <SelfContained T>
[[nodiscard]] TUMBLE_INLINE constexpr T mul_add(T sum, T a, T b) {
    return sum + a * b;
}
template <SelfContained T>
[[nodiscard]] TUMBLE_INLINE constexpr T mul_sub(T sum, T a, T b) {
    return sum - a * b;
}
template <SelfContained To>
[[nodiscard]] TUMBLE_INLINE constexpr To narrow(To a) {
    return a;
}

// a . b: exact in fixed point, summed left to right in floating point.
template <VectorOfThree A, VectorOfThree B>
[[nodiscard]] TUMBLE_INLINE constexpr auto dot(const A& a, const B& b) {
    return mul_add(mul_add(mul(a.x(), b.x()), a.y(), b.y()), a.z(), b.z());
}

// A call takes little beside the product, whose code is long.
[[nodiscard, gnu::noinline]] inline Scaled dot(const Vec3<Scaled>& a, const Vec3<Scaled>& b) {
    return mul_add(mul_add(mul(a.x(), b.x()), a.y(), b.y()), a.z(), b.z());
}

// Component i of a x b, exact in fixed point. Below: the same added to a sum.
template <int i, VectorOfThree A, VectorOfThree B>
[[nodiscard]] TUMBLE_INLINE constexpr auto cross_component(const A& a, const B& b) {
    constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
    return mul_sub(mul(a[j], b[k]), a[k], b[j]);
}
template <int i, class Sum, class A, class B>
[[nodiscard]] TUMBLE_INLINE Sum add_cross_component(Sum sum, const Vec3<A>& a, const Vec3<B>& b) {
    constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
    return mul_sub(mul_add(sum, a[j], b[k]), a[k], b[j]);
}

// a x b, with each component rounded once to To.
template <class To, VectorOfThree A, VectorOfThree B>
[[nodiscard]] TUMBLE_INLINE Vec3<To> cross(const A& a, const B& b) {
    return {narrow<To>(cross_component<0>(a, b)), narrow<To>(cross_component<1>(a, b)),
            narrow<To>(cross_component<2>(a, b))};
}

template <class T>
[[nodiscard]] TUMBLE_INLINE constexpr T magnitude_of(T a) {
    return a < T{} ? -a : a;
}
template <class T>
[[nodiscard]] TUMBLE_INLINE constexpr T larger_of(T a, T b) {
    return a > b ? a : b;
}

template <class To>
[[nodiscard, gnu::noinline]] inline Vec3<Scaled> cross(const Vec3<Scaled>& a, const Vec3<Scaled>& b) {
    return {cross_component<0>(a, b), cross_component<1>(a, b), cross_component<2>(a, b)};
}

// An upper bound of |v| without a root.
template <VectorOfThree V>
[[nodiscard]] TUMBLE_INLINE constexpr auto sum_of_magnitudes(const V& v) {
    return magnitude_of(v.x()) + magnitude_of(v.y()) + magnitude_of(v.z());
}

// A direction times a length.
template <VectorOfThree Direction, class Length>
[[nodiscard]] Vec3<Length> along(const Direction& u, Length l) {
    return {narrow<Length>(mul(u.x(), l)), narrow<Length>(mul(u.y(), l)), narrow<Length>(mul(u.z(), l))};
}

// A vector of working numbers, in SI units unless stated otherwise.
template <class N>
using WorkVec3 = Vec3<typename N::Work>;

template <class N>
[[nodiscard]] constexpr WorkVec3<N> zero_vector() {
    return WorkVec3<N>::Constant(typename N::Work(0));
}

// q v q*, body to world: (w^2 - |u|^2) v + 2 (u . v) u + 2 w u x v with q = (w, u). For a q whose length is off 1 by
// rounding it is still a rotation, times |q|^2. The form that is shorter by one product is not.
template <class Work>
[[nodiscard]] inline Vec3<Work> rotate(const Quat<Work>& q, const Vec3<Work>& v) {
    const Work along = q.w * q.w - dot(q.v, q.v), twice_dot = dot(q.v, v) * Work(2), twice_w = q.w * Work(2);
    const Vec3<Work> c = cross<Work>(q.v, v);
    const auto component = [&](int i) { return mul_add(mul_add(along * v[i], twice_dot, q.v[i]), twice_w, c[i]); };
    return {component(0), component(1), component(2)};
}
// World to body.
template <class Work>
[[nodiscard]] inline Vec3<Work> rotate_back(const Quat<Work>& q, const Vec3<Work>& v) {
    return rotate(q.conjugate(), v);
}

template <class Work>
[[nodiscard]] inline Vec3<Work> scaled_by(const Vec3<Work>& v, Work s) {
    return {v.x() * s, v.y() * s, v.z() * s};
}

// Set-up numbers, and quaternions and directions of the state, as working numbers.
template <class N>
[[nodiscard]] constexpr WorkVec3<N> work_vector(RealVec3 v) {
    using Work = typename N::Work;
    return {N::template constant<Work>(v.x), N::template constant<Work>(v.y), N::template constant<Work>(v.z)};
}

template <class N>
[[nodiscard]] inline Quat<typename N::Work> work_quaternion(const Quat<typename N::Unit>& q) {
    return {N::work(q.w), {N::work(q.v.x()), N::work(q.v.y()), N::work(q.v.z())}};
}
template <class N, VectorOfThree V>
[[nodiscard]] inline WorkVec3<N> work_unit(const V& n) {
    return {N::work(n.x()), N::work(n.y()), N::work(n.z())};
}

}  // namespace tumble
