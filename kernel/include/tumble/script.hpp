// Timed events: impulses that a script applies before the step that begins at their time. Events are sorted by step, in
// file order within one; the world walks along them once.
#pragma once

#include <tumble/loads/thrust.hpp>

namespace tumble {

template <class N>
struct Impulse {
    std::uint32_t step = 0;  // applied before this step is taken
    std::int16_t body = 0;
    Frame frame = Frame::world;
    WorkVec3<N> impulse = zero_vector<N>();  // N s, in `frame` (body: principal axes)
    WorkVec3<N> angular = zero_vector<N>();  // N m s, in `frame`
    WorkVec3<N> point_b = zero_vector<N>();  // m, principal axes
};

// Constant arrays that outlive the world: flash in a firmware.
template <class T>
struct Span {
    const T* first = nullptr;
    int count = 0;

    [[nodiscard]] const T* begin() const { return first; }
    [[nodiscard]] const T* end() const { return first + count; }
};

}  // namespace tumble
