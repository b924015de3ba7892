// Timed forces: a constant force at a point of a body and a constant torque for a time, in the world's frame or the
// body's.
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

// The timed forces of a world. A step visits those from the first that has not ended to the last that has begun.
template <class N>
class TimedForces {
public:
    TimedForces(Real, const WorldSpec&) {}
    // Calls changed(body) for every force that acts in step `now`.
    template <class F>
    void set(Span<TimedForce<N>> forces, std::uint64_t now, F&& changed) {
        forces_ = forces;
        first_ = end_ = 0;
        is_sorted_ = true;
        for (int k = 0; k < forces.count; ++k) {
            const TimedForce<N>& force = forces.first[k];
            if (k > 0 && force.from < forces.first[k - 1].from) is_sorted_ = false;
            if (force.is_on(now)) changed(force.body);
        }
    }
    // Skips what has ended before step `now`, after the world has gone to this step.
    void seek(std::uint64_t now) {
        first_ = end_ = 0;
        now_ = now;
    }
    // Call before step `now` is taken; calls changed(body) for every force that begins or ends at it.
    template <class F>
    void start_step(std::uint64_t now, F&& changed) {
        now_ = now;
        while (end_ < forces_.count && (!is_sorted_ || forces_.first[end_].from <= now)) ++end_;
        for (const TimedForce<N>& force : current())
            if (force.from == now || force.until == now) changed(force.body);
        while (first_ < end_ && forces_.first[first_].until <= now) ++first_;
    }

    [[nodiscard]] bool acts_on(const auto&, int b) const {
        for (const TimedForce<N>& force : current())
            if (force.body == b && force.is_on(now_)) return true;
        return false;
    }
    TUMBLE_INLINE void apply_to(const auto& group) const {
        for (const TimedForce<N>& force : current()) {
            if (!force.is_on(now_)) continue;
            if (auto* b = group.find(force.body)) tumble::apply(force, *b);
        }
    }

private:
    // The forces that a step visits.
    [[nodiscard]] Span<TimedForce<N>> current() const { return {forces_.first + first_, end_ - first_}; }

    Span<TimedForce<N>> forces_{};
    int first_ = 0, end_ = 0;  // in forces_: all before first_ have ended, none from end_ on has begun
    bool is_sorted_ = true;    // else a step visits all that follow first_
    std::uint64_t now_ = 0;    // the step's number
};

}  // namespace tumble
