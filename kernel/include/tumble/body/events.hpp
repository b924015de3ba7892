// Timed events as a world's own numbers: impulses, applied before the step that begins at their time, and forces that
// are on for a while. Arrays of them are sorted by their first step; what starts together keeps its order. Steps of
// events are counted in 64 bits, from the start of the world on.
#pragma once

#include <tumble/body/bodies.hpp>

namespace tumble {

// An instantaneous change of momentum; World::prepare() makes it.
template <class N>
struct Impulse {
    std::uint64_t step = 0;                  // applied before this step is taken
    std::int16_t body = 0;                   // index
    Frame frame = Frame::world;              // of impulse and angular
    WorkVec3<N> impulse = zero_vector<N>();  // N s, in `frame` (body: principal axes)
    WorkVec3<N> angular = zero_vector<N>();  // N m s, in `frame`
    WorkVec3<N> point_b = zero_vector<N>();  // m, principal axes
};

// A constant force at a point of a body and a constant torque while it is on; World::prepare() makes it.
template <class N>
struct TimedForce {
    std::int16_t body = 0;                   // index
    Frame frame = Frame::world;              // of force and torque
    std::uint64_t from = 0;                  // the first step that it is on in
    std::uint64_t until = 0;                 // the first step that it is off again in
    WorkVec3<N> force = zero_vector<N>();    // N, in `frame` (body: principal axes)
    WorkVec3<N> torque = zero_vector<N>();   // N m, in `frame`
    WorkVec3<N> point_b = zero_vector<N>();  // m, principal axes

    // True in the steps that it acts in.
    [[nodiscard]] bool is_on(std::uint64_t step) const { return from <= step && step < until; }
};

// Constant arrays that outlive the world: flash in a firmware.
template <class T>
struct Span {
    const T* first = nullptr;  // of the array
    int count = 0;             // of its elements

    // For loops over the elements.
    [[nodiscard]] const T* begin() const { return first; }
    // Behind the last element.
    [[nodiscard]] const T* end() const { return first + count; }
};

// A set-up value as the numbers of the bodies' world. Its body must have been added; what would turn a point mass, or
// is in axes that it does not have, is misuse.
template <class N, Spin spin, int capacity, bool points>
[[gnu::noinline, nodiscard]] Impulse<N> prepare(const Bodies<N, spin, capacity, points>& bodies,
                                                const ImpulseSpec& spec) {
    const bool in_body = spec.frame == Frame::body;
    if (!bodies.rotates(bodies.index_of(spec.body)))
        TUMBLE_ASSERT(!in_body && spec.point.is_zero() && spec.angular_impulse.is_zero());
    return {bodies.step_of(spec.time),
            static_cast<std::int16_t>(bodies.index_of(spec.body)),
            spec.frame,
            in_body ? bodies.principal_vector(spec.body, spec.impulse) : work_vector<N>(spec.impulse),
            in_body ? bodies.principal_vector(spec.body, spec.angular_impulse) : work_vector<N>(spec.angular_impulse),
            bodies.principal_vector(spec.body, spec.point)};
}
// The same of a force that is on for a while.
template <class N, Spin spin, int capacity, bool points>
[[gnu::noinline, nodiscard]] TimedForce<N> prepare(const Bodies<N, spin, capacity, points>& bodies,
                                                   const ForceSpec& spec) {
    const bool in_body = spec.frame == Frame::body;
    if (!bodies.rotates(bodies.index_of(spec.body)))
        TUMBLE_ASSERT(!in_body && spec.point.is_zero() && spec.torque.is_zero());
    return {static_cast<std::int16_t>(bodies.index_of(spec.body)),
            spec.frame,
            bodies.step_of(spec.from),
            bodies.step_of(spec.until),
            in_body ? bodies.principal_vector(spec.body, spec.force) : work_vector<N>(spec.force),
            in_body ? bodies.principal_vector(spec.body, spec.torque) : work_vector<N>(spec.torque),
            bodies.principal_vector(spec.body, spec.point)};
}

// An impulse's change of momentum, at once.
template <class N, Spin spin, int capacity, bool points>
inline void apply(const Impulse<N>& event, Bodies<N, spin, capacity, points>& bodies) {
    using Work = typename N::Work;
    const int b = bodies.index_of(event.body);
    if (bodies.constants[b].fixed) return;
    if (!bodies.rotates(b)) {
        bodies.push(b, event.impulse);
    } else if constexpr (spin != Spin::none) {
        const Quat<Work> q = work_quaternion<N>(bodies.state[b].q_wb.value());
        WorkVec3<N> linear_w = event.impulse, linear_b = event.impulse, angular_b = event.angular;
        if (event.frame == Frame::world) {
            linear_b = rotate_back(q, event.impulse);
            angular_b = rotate_back(q, event.angular);
        } else {
            linear_w = rotate(q, event.impulse);
        }
        bodies.push(b, linear_w, angular_b + cross<Work>(event.point_b, linear_b));
    }
    bodies.check_range(b);
}

namespace detail {

template <class N>
[[nodiscard]] constexpr std::uint64_t start_of(const Impulse<N>& impulse) {
    return impulse.step;
}
template <class N>
[[nodiscard]] constexpr std::uint64_t start_of(const TimedForce<N>& force) {
    return force.from;
}

}  // namespace detail

// The world's own numbers, sorted by their first step; what starts together keeps its order.
template <class Events, class Specs, class Bodies>
[[nodiscard]] auto prepare_sorted(Events& events, const Specs& specs, const Bodies& bodies) {
    if constexpr (requires { events.resize(specs.size()); }) events.resize(specs.size());
    std::size_t count = 0;
    for (const auto& spec : specs) {
        const auto event = prepare(bodies, spec);
        std::size_t place = count++;
        for (; place > 0 && detail::start_of(event) < detail::start_of(events[place - 1]); --place)
            events[place] = events[place - 1];
        events[place] = event;
    }
    return Span<std::remove_cvref_t<decltype(events[0])>>{events.data(), static_cast<int>(count)};
}

}  // namespace tumble
