// The spin after a part of a step, without a division by the part: the angular momentum stands still in the world.
#pragma once

#include <tumble/body/orientation.hpp>

namespace tumble {

// Turns a spin that is an angular momentum from the axes of the body at `from` into those at `to`. With (w, u) =
// to* from, t' = t + 2 w u x t + 2 u x (u x t). Only the change is rounded, to 2^-30 of the spin. 34 products.
template <class N>
[[gnu::cold]] void turn_momentum(SpinVec3<N, Spin::angular_momentum>& t_b, const Quat<typename N::Unit>& from,
                                 const Quat<typename N::Unit>& to) {
    using Unit = typename N::Unit;
    using Turn = typename N::Turn;
    const Unit w = narrow<Unit>(mul_add(dot(to.v, from.v), to.w, from.w));
    const auto add_cross = [](auto sum, const auto& a, const auto& b, int i) {
        const int j = i < 2 ? i + 1 : 0, k = i > 0 ? i - 1 : 2;
        return mul_sub(mul_add(sum, a[j], b[k]), a[k], b[j]);
    };
    const Vec3<Turn> t = t_b.value();
    Vec3<Unit> u;
    Vec3<Turn> across;
    for (int i = 0; i < 3; ++i)
        u[i] = narrow<Unit>(add_cross(mul_sub(mul(to.w, from.v[i]), to.v[i], from.w), from.v, to.v, i));
    for (int i = 0; i < 3; ++i) across[i] = narrow<Turn>(add_cross(decltype(mul(w, t[i])){}, u, t, i));
    for (int i = 0; i < 3; ++i) {
        const auto half = N::turn_sum(add_cross(mul(w, across[i]), u, across, i));
        t_b[i].add(half);
        t_b[i].add(half);
    }
}

}  // namespace tumble
