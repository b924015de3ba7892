// Linear drag: force -c v and torque -c w, the same for every body of the world; a point mass
// feels no torque. Depends on the body's own velocity.
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

    Drag(Real step, const WorldSpec& spec)
        : linear{N::template constant<Work>(spec.linear_drag)}, angular{N::template constant<Work>(spec.angular_drag)},
          linear_in_step{spec.linear_drag * step}, angular_in_step{spec.angular_drag * step} {}

    // True if the step is too long for the drag of this body. `bound` is 1 / the method's limit of h c / m; 0: no
    // limit.
    [[nodiscard]] bool is_too_strong(const BodySpec& spec, const PrincipalInertia& inertia, bool rotates,
                                     Real bound) const {
        return linear_in_step * bound > spec.mass || (rotates && angular_in_step * bound > inertia.moments.z);
    }

    void set_body(int b, const BodySpec& spec, const auto&, const auto&) {
        share_at_end_[b] =
            L::factor(N::template constant<Work>(linear_in_step / (spec.mass + linear_in_step * Real::scaled(1, -1))));
    }

    [[nodiscard]] bool acts_on(const auto& bodies, int b) const { return linear > Work{} || turns(bodies, b); }
    [[nodiscard]] bool turns(const auto& bodies, int b) const { return bodies.rotates(b) && angular > Work{}; }
    [[nodiscard]] bool depends_on_velocity() const { return linear > Work{} || angular > Work{}; }
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
    typename L::Factor share_at_end_[capacity];  // c' h / m of each body, with c' = c / (1 + h c / 2m)
};

}  // namespace tumble
