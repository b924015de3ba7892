// Linear drag: force -c v and torque -c w, the same for every body of the world; a point mass
// feels no torque. Depends on the body's own velocity.
//
// The motion of a body that feels linear drag and constant forces alone has a closed form. With a = h c/m and the kick
// k = h^2 g - a d at the start of a step, in units of the drift d = h v,
//   x(h) = x + d + Q k and d(h) = d + P k, with P = (1 - exp(-a)) / a and Q = (1 - P) / a.
// Methods of order two and more step such a body by it, without stages, as they do under gravity.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/loads/loaded_group.hpp>

namespace tumble {

template <class N, int capacity>
struct Drag {
    using Work = typename N::Work;
    using L = LoadNumbers<N>;

    Work linear{}, angular{};  // kg/s, N m s

    Real linear_in_step, angular_in_step;  // the same times the step, kg, kg m^2

    constexpr Drag(Real step, const WorldSpec& spec)
        : linear{N::template constant<Work>(spec.linear_drag)}, angular{N::template constant<Work>(spec.angular_drag)},
          linear_in_step{spec.linear_drag * step}, angular_in_step{spec.angular_drag * step} {}

    // True if the step is too long for the drag of this body. `bound` is 1 / the method's limit of h c / m; 0: no
    // limit.
    [[nodiscard]] constexpr bool is_too_strong(const BodySpec& spec, const PrincipalInertia& inertia, bool rotates,
                                               Real bound) const {
        return linear_in_step * bound > spec.mass || (rotates && angular_in_step * bound > inertia.moments.z);
    }

    // Of a body with a < 1/4: no product with a leaves the format then, and the series end early.
    struct ClosedForm {
        bool exists = false;
        typename L::Factor share{};                 // a
        typename N::Fraction of_drift{}, of_way{};  // P and Q
    };
    [[nodiscard]] const ClosedForm& closed_form(int b) const { return closed_form_[b]; }

    constexpr void set_body(int b, const BodySpec& spec, const auto&, const auto&) {
        set_closed_form(closed_form_[b], linear_in_step / spec.mass);
        share_at_end_[b] =
            L::factor(N::template constant<Work>(linear_in_step / (spec.mass + linear_in_step * Real::scaled(1, -1))));
    }

    [[nodiscard]] bool acts_on(const auto& bodies, int b) const { return linear > Work{} || turns(bodies, b); }
    [[nodiscard]] bool turns(const auto& bodies, int b) const { return bodies.rotates(b) && angular > Work{}; }
    [[nodiscard]] bool depends_on_velocity() const { return linear > Work{} || angular > Work{}; }
    // Whether a translation of the body is damped.
    [[nodiscard]] int dampers_at(int) const { return linear > Work{} ? 1 : 0; }
    // The change of drift is -h c/m times the drift, and that of a half turn -h c/I times the half turn.
    template <class Group>
    TUMBLE_INLINE void apply_to(const Group& group) const {
        const auto& scale = group.bodies.scale;
        if (linear > Work{}) {
            const auto c = L::negative(group.of_velocity(L::factor(linear)));
            for (int k = 0; k < group.count; ++k) {
                const auto share =
                    group.at_end() ? L::negative(share_at_end_[group.id[k]]) : L::product(c, group.step_per_mass(k));
                for (int i = 0; i < 3; ++i) L::add_share(group.kick[k].linear[i], group.velocity(k, i), share, scale);
            }
        }
        if constexpr (Group::rotation) {
            if (!(angular > Work{})) return;
            const auto c = L::negative(group.of_velocity(L::factor(angular)));
            for (int k = 0; k < group.count; ++k) {
                if (!group.rotates(k)) continue;
                const auto& units = group.bodies.constants[group.id[k]].units;
                for (int i = 0; i < 3; ++i) {
                    const auto per_moment =
                        L::product(group.half_turn_per_impulse(k, i), L::factor(units.per_half_turn(i)));
                    L::add_share(group.kick[k].angular[i], group.stage[k].t_b[i], L::product(c, per_moment), scale);
                }
            }
        }
    }

private:
    TUMBLE_COLD static constexpr void set_closed_form(ClosedForm& form, Real a) {
        form.exists = a > Real{} && a < Real::scaled(1, -2);
        if (!form.exists) return;
        // Q = 1/2! - a/3! + a^2/4! - ..., whose terms are below 2^-64 from a^14/16! on.
        Real way = Real{1} / Real{17};
        for (int n = 16; n > 2; --n) way = (Real{1} - a * way) / Real{n};
        way = (Real{1} - a * way) * Real::scaled(1, -1);
        form.share = L::factor(N::template constant<Work>(a));
        form.of_way = N::template constant<typename N::Fraction>(way);
        form.of_drift = N::template constant<typename N::Fraction>(Real{1} - a * way);
    }

    ClosedForm closed_form_[capacity]{};
    typename L::Factor share_at_end_[capacity]{};  // c' h / m of each body, with c' = c / (1 + h c / 2m)
};

}  // namespace tumble
