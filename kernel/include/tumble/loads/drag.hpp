// Linear drag: force -c v and torque -c w, the same for every body of the world; a point mass
// feels no torque. Depends on the body's own velocity.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/loads/loaded_body.hpp>

namespace tumble {

template <class N>
struct Drag {
    using Work = typename N::Work;

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

    [[nodiscard]] bool acts_on(const auto& bodies, int b) const {
        return linear > Work(0) || (bodies.rotates(b) && angular > Work(0));
    }
    [[nodiscard]] bool depends_on_velocity() const { return linear > Work(0) || angular > Work(0); }
    TUMBLE_INLINE void apply_to(const auto& group) const {
        for (int k = 0; k < group.members.count; ++k) apply(group.loaded[k]);
    }

private:
    template <class Body>
    void apply(Body& body) const {
        body.force_w -= scaled_by(body.v_w, linear);
        if constexpr (Body::rotation)
            if (body.rotates()) body.torque_b -= scaled_by(body.w_b, angular);
    }
};

}  // namespace tumble
