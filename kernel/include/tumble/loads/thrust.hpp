// A constant force at a point of a body and a constant torque while it is on, in the world's frame or the body's.
#pragma once

#include <tumble/loads/wrench.hpp>

namespace tumble {

template <class N>
struct Thrust {
    std::int16_t body = 0;
    Frame frame = Frame::world;
    std::uint32_t from = 0, until = 0;       // steps: on while from <= step < until
    WorkVec3<N> force = zero_vector<N>();    // N, in `frame` (body: principal axes)
    WorkVec3<N> torque = zero_vector<N>();   // N m, in `frame`
    WorkVec3<N> point_b = zero_vector<N>();  // m, principal axes

    [[nodiscard]] bool is_on(std::uint32_t step) const { return from <= step && step < until; }
    void apply(LoadedBody<N>& b) const {
        using Work = typename N::Work;
        if (frame == Frame::world) {
            b.push(force, point_b);
            b.torque_b += rotate_back(b.q_wb, torque);
        } else {
            b.force_w += rotate(b.q_wb, force);
            b.torque_b += cross<Work>(point_b, force) + torque;
        }
    }
};

}  // namespace tumble
