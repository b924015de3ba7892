// A constant force at a point of a body and a constant torque while it is on, in the world's frame or the body's.
#pragma once

#include <tumble/body/events.hpp>
#include <tumble/loads/loaded_body.hpp>

namespace tumble {

template <class N>
inline void apply(const TimedForce<N>& load, LoadedBody<N>& b) {
    using Work = typename N::Work;
    if (load.frame == Frame::world) {
        b.push(load.force, load.point_b);
        b.torque_b += rotate_back(b.q_wb, load.torque);
    } else {
        b.force_w += rotate(b.q_wb, load.force);
        b.torque_b += cross<Work>(load.point_b, load.force) + load.torque;
    }
}

}  // namespace tumble
