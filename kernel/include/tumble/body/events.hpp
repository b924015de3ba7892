// Timed events in the numbers of a world: impulses, applied before the step that begins at their time, and forces that
// act for a while. Arrays of events are sorted by their first step; events with equal steps keep their order. Events
// count steps in 64 bits from the start of the world.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/numbers/load_numbers.hpp>

namespace tumble {

// An instantaneous change of momentum. World::prepare() makes it from an ImpulseSpec.
template <class N>
struct Impulse {
    std::uint64_t step = 0;             // applied before this step is taken
    std::int16_t body = 0;              // index
    Frame frame = Frame::world;         // of impulse and angular
    bool opposite : 1 = false;          // what acts is the opposite of `impulse`
    bool angular_opposite : 1 = false;  // what acts is the opposite of `angular`
    VectorBlock<N> impulse{};           // N s, in `frame` (body: principal axes)
    VectorBlock<N> angular{};           // N m s, in `frame`
    VectorBlock<N> point_b{};           // m, principal axes
};

// A constant force at a point of a body and a constant torque, both acting for a while. World::prepare() makes it from
// a ForceSpec.
template <class N>
struct TimedForce {
    std::int16_t body = 0;       // index
    Frame frame = Frame::world;  // of force and torque
    std::uint64_t from = 0;      // the first step in which it acts
    std::uint64_t until = 0;     // the first step in which it no longer acts
    // The change of drift in a step by a force in the world's frame, in units of the sums of loads
    typename N::DriftSum change[3]{};
    VectorBlock<N> force{};    // N s in a step, in `frame` (body: principal axes)
    VectorBlock<N> torque{};   // N m s in a step, in `frame`
    VectorBlock<N> point_b{};  // m, principal axes

    // True in the steps in which it acts.
    [[nodiscard]] constexpr bool is_on(std::uint64_t step) const { return from <= step && step < until; }
};

// A constant array that outlives the world: flash in a firmware.
template <class T>
struct Span {
    const T* first = nullptr;  // the first element
    int count = 0;             // number of elements

    // For loops over the elements.
    [[nodiscard]] constexpr const T* begin() const { return first; }
    // Past the last element.
    [[nodiscard]] constexpr const T* end() const { return first + count; }
};

namespace detail {

// A vector of set-up numbers in the numbers of the bodies' world; in the frame of the body in its principal axes. With
// `opposite`, the opposite of one that is negative, as a live push rounds it.
template <class N, Spin spin, int capacity, bool points, class Constant>
[[nodiscard]] constexpr VectorBlock<N> prepared(const Bodies<N, spin, capacity, points, Constant>& bodies,
                                                [[maybe_unused]] int b, [[maybe_unused]] Frame frame, const RealVec3& v,
                                                bool* opposite = nullptr) {
    auto block = VectorBlock<N>::of(v.x, v.y, v.z);
    if (opposite != nullptr && (*opposite = block.is_negative())) block = -block;
    if constexpr (spin == Spin::none) return block;
    else return frame == Frame::world || !bodies.rotates(b) ? block : bodies.in_principal_axes(b, block);
}

}  // namespace detail

// An event in the numbers of the bodies' world. The body must exist. Misuse: a rotation of a point mass, and the frame
// of a body that has none.
template <class N, Spin spin, int capacity, bool points, class Constant>
[[gnu::noinline, nodiscard]] constexpr Impulse<N> prepare(const Bodies<N, spin, capacity, points, Constant>& bodies,
                                                          const ImpulseSpec& spec) {
    const int b = bodies.index_of(spec.body);
    if (!bodies.rotates(b))
        TUMBLE_ASSERT(spec.frame == Frame::world && spec.point.is_zero() && spec.angular_impulse.is_zero());
    bool opposite = false, angular_opposite = false;
    const auto impulse = detail::prepared(bodies, b, spec.frame, spec.impulse, &opposite),
               angular = detail::prepared(bodies, b, spec.frame, spec.angular_impulse, &angular_opposite);
    return {bodies.step_of(spec.time),
            static_cast<std::int16_t>(b),
            spec.frame,
            opposite,
            angular_opposite,
            impulse,
            angular,
            detail::prepared(bodies, b, Frame::body, spec.point)};
}
// The same for a force that acts for a while.
template <class N, Spin spin, int capacity, bool points, class Constant>
[[gnu::noinline, nodiscard]] constexpr TimedForce<N> prepare(const Bodies<N, spin, capacity, points, Constant>& bodies,
                                                             const ForceSpec& spec) {
    const int b = bodies.index_of(spec.body);
    if (!bodies.rotates(b)) TUMBLE_ASSERT(spec.frame == Frame::world && spec.point.is_zero() && spec.torque.is_zero());
    const auto in_step = [&](const RealVec3& v) {
        return detail::prepared(bodies, b, spec.frame, v * bodies.step_length);
    };
    TimedForce<N> force{static_cast<std::int16_t>(b),
                        spec.frame,
                        bodies.step_of(spec.from),
                        bodies.step_of(spec.until),
                        {},
                        in_step(spec.force),
                        in_step(spec.torque),
                        detail::prepared(bodies, b, Frame::body, spec.point)};
    using L = LoadNumbers<N>;
    if (spec.frame == Frame::world)
        L::add(force.change, force.force, L::factor(bodies.constants[b].drift_per_impulse()), bodies.scale);
    return force;
}

namespace detail {

// The step before which an event is applied, or the first of a force.
template <class Timed>
[[nodiscard]] constexpr std::uint64_t start_of(const Timed& event) {
    if constexpr (requires { event.from; }) return event.from;
    else return event.step;
}

// Writes event_of(spec) of each, sorted by their first step. Events with equal steps keep their order.
template <class Events, class Specs, class F>
constexpr void prepare_each(Events& events, const Specs& specs, F&& event_of) {
    for (std::size_t i = 0; i < specs.size(); ++i) {
        const auto event = event_of(specs[i]);
        std::size_t place = i;
        for (; place > 0 && start_of(event) < start_of(events[place - 1]); --place) events[place] = events[place - 1];
        events[place] = event;
    }
}

}  // namespace detail

// Events in the numbers of the world, sorted by their first step. Events with equal steps keep their order.
template <class Events, class Specs, class Bodies>
[[nodiscard]] constexpr auto prepare_sorted(Events& events, const Specs& specs, const Bodies& bodies) {
    if constexpr (requires { events.resize(specs.size()); }) events.resize(specs.size());
    detail::prepare_each(events, specs, [&](const auto& spec) { return prepare(bodies, spec); });
    return Span<std::remove_cvref_t<decltype(events[0])>>{events.data(), static_cast<int>(specs.size())};
}

}  // namespace tumble
