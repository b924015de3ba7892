// Newton's gravitation between two bodies as point masses: F = G m1 m2 / r^2. One square root and one division a pair.
#pragma once

#include <tumble/loads/loaded_body.hpp>

namespace tumble {

template <class N>
struct Gravitation {
    using Work = typename N::Work;

    Work constant{};  // m^3/(kg s^2)

    // Bodies at the same place exert no force: there is no direction.
    void apply(LoadedBody<N>& a, Work mass_a, LoadedBody<N>& b, Work mass_b) const {
        WorkVec3<N> r;
        for (int i = 0; i < 3; ++i) r[i] = N::metres(b.stage->x_w[i] - a.stage->x_w[i]);
        const Work r2 = dot(r, r);
        if (!(r2 > Work(0))) return;
        const Work inverse = Work(1) / (r2 * sqrt(r2));
        const WorkVec3<N> force = scaled_by(r, constant * mass_a * mass_b * inverse);
        a.force_w += force;
        b.force_w -= force;
    }
};

}  // namespace tumble
