// A constant force at a point of a body and a constant torque while it is on, in the world's frame or the body's.
#pragma once

#include <tumble/body/events.hpp>
#include <tumble/loads/loaded_body.hpp>

namespace tumble {

template <class N, class Body>
inline void apply(const TimedForce<N>& load, Body& b) {
    using Work = typename N::Work;
    if (!b.rotates()) {
        b.force_w += load.force;
    } else if constexpr (Body::rotation) {
        if (load.frame == Frame::world) {
            b.push(load.force, load.point_b);
            b.torque_b += rotate_back(b.q_wb, load.torque);
        } else {
            b.force_w += rotate(b.q_wb, load.force);
            b.torque_b += cross<Work>(load.point_b, load.force) + load.torque;
        }
    }
}

// The timed forces of a world.
template <class N>
class TimedForces {
public:
    TimedForces(Real, const WorldSpec&) {}
    void set(Span<TimedForce<N>> forces) { forces_ = forces; }

    [[nodiscard]] bool acts_on(const auto& bodies, int b) const {
        for (const TimedForce<N>& force : forces_)
            if (force.body == b && force.is_on(bodies.steps_taken)) return true;
        return false;
    }
    // Calls f(body) for every force that begins or ends at the step.
    template <class F>
    void for_each_change(std::uint32_t step, F&& f) const {
        for (const TimedForce<N>& force : forces_)
            if (force.from == step || force.until == step) f(force.body);
    }
    TUMBLE_INLINE void apply_to(const auto& group) const {
        for (const TimedForce<N>& force : forces_) {
            if (!force.is_on(group.bodies.steps_taken)) continue;
            if (auto* b = group.find(force.body)) tumble::apply(force, *b);
        }
    }

private:
    Span<TimedForce<N>> forces_{};
};

}  // namespace tumble
