// Newton's gravitation between two bodies as point masses: F = G m1 m2 / r^2. One square root and one division a pair.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/loads/loaded_body.hpp>
#include <tumble/status.hpp>

namespace tumble {

template <class N, int bodies>
class Gravitation {
public:
    using Work = typename N::Work;

    Gravitation(Real step, const WorldSpec& spec)
        : constant_{N::template constant<Work>(spec.gravitation)},
          near_per_mass_{N::template constant<Work>(spec.gravitation * step * step * Real{least_steps * least_steps})} {
    }
    void set_body(int b, const BodySpec& spec, const auto&, const auto&) {
        mass_[b] = N::template constant<Work>(spec.mass);
    }

    [[nodiscard]] bool acts_on(const auto& all, int) const { return constant_ > Work(0) && all.count > 1; }
    [[nodiscard]] bool couples(const auto& all, int b) const { return acts_on(all, b); }
    template <class F>
    void for_each_coupled(const auto& all, int b, F&& f) const {
        for (int other = 0; constant_ > Work(0) && other < all.count; ++other)
            if (other != b) f(other);
    }
    TUMBLE_INLINE void apply_to(const auto& group) const {
        for (int k = 0; k < group.members.count && constant_ > Work(0); ++k) {
            const int a = group.members.id[k];
            for (int b = 0; b < group.bodies.count; ++b) {
                if (b == a || (b < a && group.find(b) != nullptr)) continue;  // a pair of the group once
                if (mass_[b] == Work(0)) continue;                            // the place of a removed body
                if (!apply(group.loaded[k], mass_[a], *group.other_end(b), mass_[b], group.bodies.constants[b].fixed))
                    group.bodies.report(Issue::step_too_long, a);
            }
        }
    }

private:
    // Least number of steps in the time sqrt(r^3 / G (m1 + m2)), in which two bodies at the distance r turn about each
    // other by a radian or fall into each other. With fewer, the energy drifts.
    static constexpr int least_steps = 2;

    // False where the step is too long for two bodies so near each other. Where b is fixed, only its own mass counts.
    // Bodies at the same place exert no force, since there is no direction.
    template <class Body>
    bool apply(Body& a, Work mass_a, Body& b, Work mass_b, bool b_is_fixed) const {
        WorkVec3<N> r;
        for (int i = 0; i < 3; ++i) r[i] = N::apart(b.stage->x_w[i], a.stage->x_w[i]);
        const Work r2 = dot(r, r);
        if (!(r2 > Work(0))) return false;
        const Work r3 = r2 * sqrt(r2), inverse = Work(1) / r3;
        const WorkVec3<N> force = scaled_by(r, constant_ * mass_a * mass_b * inverse);
        a.force_w += force;
        b.force_w -= force;
        return !(r3 < near_per_mass_ * (b_is_fixed ? mass_b : mass_a + mass_b));
    }

    Work constant_{};       // m^3/(kg s^2)
    Work near_per_mass_{};  // m^3/kg: r^3 below which a pair is too near for the step
    Work mass_[bodies]{};
};

}  // namespace tumble
