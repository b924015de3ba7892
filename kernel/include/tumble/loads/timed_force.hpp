// Timed forces: a constant force at a point of a body and a constant torque for a time, in the world's frame or the
// body's.
#pragma once

#include <tumble/body/events.hpp>
#include <tumble/loads/loaded_group.hpp>

namespace tumble {

// Adds the load to the changes of body k of the group.
template <class N, class Group>
TUMBLE_INLINE void apply(const TimedForce<N>& load, const Group& group, int k) {
    using L = LoadNumbers<N>;
    const bool in_world = load.frame == Frame::world, pushes = !load.force.is_zero();
    if (in_world && pushes) L::add(group.kick[k].linear, load.change, group.bodies.scale);
    if constexpr (Group::rotation) {
        if (!group.rotates(k)) return;
        const auto& q = group.stage[k].q_wb;
        if (!in_world && pushes) group.push(k, L::rotated(q, load.force), L::one());
        if (pushes && !load.point_b.is_zero())
            group.turn(k, L::cross(load.point_b, in_world ? L::rotated_back(q, load.force) : load.force));
        if (!load.torque.is_zero()) group.turn(k, in_world ? L::rotated_back(q, load.torque) : load.torque);
    }
}

// The timed forces of a world. A step visits those from the first that has not ended to the last that has begun.
template <class N>
class TimedForces {
public:
    constexpr TimedForces(Real, const WorldSpec&) {}
    // Calls changed(body) for every force that acts in step `now`.
    template <class F>
    constexpr void set(Span<TimedForce<N>> forces, std::uint64_t now, F&& changed) {
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
    // True of a force that turns the body or turns with it.
    [[nodiscard]] bool turns(const auto&, int b) const {
        for (const TimedForce<N>& force : current())
            if (force.body == b && force.is_on(now_) &&
                (force.frame == Frame::body || !force.torque.is_zero() || !force.point_b.is_zero()))
                return true;
        return false;
    }
    template <class Group>
    TUMBLE_INLINE void apply_to(const Group& group) const {
        for (const TimedForce<N>& force : current()) {
            if (!force.is_on(now_)) continue;
            const int k = group.place_of(force.body);
            if (k >= 0) tumble::apply(force, group, k);
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
