// Vectors and quaternions: Eigen's fixed-size storage for every number system, and the products that keep sums wide.
// dot, cross, rotate and the quaternion product are functions here, because Eigen's own would round each product;
// sums, differences, blocks, maps and .cast<double>() are Eigen's.
#pragma once

#include <tumble/numbers/systems.hpp>

#include <Eigen/Core>

#include <concepts>

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

// Hamilton's w + xi + yj + zk. A plain value: normalisation is the business of whoever integrates it.
template <class T>
struct Quat {
    T w{};
    Vec3<T> v = Vec3<T>::Constant(T{});

    [[nodiscard]] Quat conjugate() const { return {w, -v}; }
};

// Products of the other numbers, so that one formula serves all systems.
template <class T>
concept SelfContained = std::floating_point<T> || std::same_as<T, Scaled>;  // its products are of its own type
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

// a . b, exact in fixed point; left to right in floating point.
template <class A, class B>
[[nodiscard]] TUMBLE_INLINE auto dot(const Vec3<A>& a, const Vec3<B>& b) {
    return mul_add(mul_add(mul(a.x(), b.x()), a.y(), b.y()), a.z(), b.z());
}

// Component i of a x b, exact in fixed point; and added to a sum.
template <int i, class A, class B>
[[nodiscard]] TUMBLE_INLINE auto cross_component(const Vec3<A>& a, const Vec3<B>& b) {
    constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
    return mul_sub(mul(a[j], b[k]), a[k], b[j]);
}
template <int i, class Sum, class A, class B>
[[nodiscard]] TUMBLE_INLINE Sum add_cross_component(Sum sum, const Vec3<A>& a, const Vec3<B>& b) {
    constexpr int j = (i + 1) % 3, k = (i + 2) % 3;
    return mul_sub(mul_add(sum, a[j], b[k]), a[k], b[j]);
}

// a x b, rounded once a component to To.
template <class To, class A, class B>
[[nodiscard]] TUMBLE_INLINE Vec3<To> cross(const Vec3<A>& a, const Vec3<B>& b) {
    return {narrow<To>(cross_component<0>(a, b)), narrow<To>(cross_component<1>(a, b)),
            narrow<To>(cross_component<2>(a, b))};
}

}  // namespace tumble
