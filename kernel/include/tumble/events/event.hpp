// Event: what a program does to a body or to gravity between two steps. A live call of the world makes one event and
// applies it.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/body/orientation.hpp>
#include <tumble/body/stage.hpp>
#include <tumble/numbers/vector_block.hpp>

namespace tumble {

// A vector that a program gives to a world: three numbers, or a Vector3, of float, double, int, Fixed, Real or the
// world's working numbers. In fixed point it keeps 29 bits of the largest component, a float costs shifts and a double
// integer arithmetic, and NaN and infinity are misuse. In floating point they make the body leave its range.
template <class N>
class InputVector {
public:
    constexpr InputVector() = default;  // zero
    // Three numbers, which may differ in type.
    template <class X, class Y, class Z>
    constexpr InputVector(X x, Y y, Z z) : block_{VectorBlock<N>::of(x, y, z)} {}
    // A vector.
    template <class T>
    constexpr InputVector(const Vector3<T>& v)  // NOLINT(google-explicit-constructor): a vector in any number
        : block_{VectorBlock<N>::of(v.x, v.y, v.z)} {}
    // The vector in the kernel's form.
    [[nodiscard]] constexpr const VectorBlock<N>& block() const { return block_; }

private:
    VectorBlock<N> block_{};
};

// The kind of an event.
enum class EventKind : std::uint8_t {
    impulse,           // value: N s; at `point`
    angular_impulse,   // value: N m s
    force,             // value: N; at `point`, in place of the force before, until the next; needs Features::control
    torque,            // value: N m; in place of the torque before, until the next; needs Features::control
    step_force,        // value: N; at `point`, in the next step alone, beside all others; needs Features::control
    step_torque,       // value: N m; in the next step alone, beside all others; needs Features::control
    begin_force,       // value: N; at `point`, beside all others, until its end; needs Features::forces
    end_force,         // ends a begin_force of the same value, frame and point
    begin_torque,      // value: N m; beside all others, until its end; needs Features::forces
    end_torque,        // ends a begin_torque of the same value and frame
    velocity,          // value: m/s
    angular_velocity,  // value: rad/s
    pose,              // value: m, world; `orientation`
    remove,            // the body leaves the world; needs Features::removal
    gravity,           // value: m/s^2, world; of all bodies, so `body` is not used; needs Features::control
    break_joint,       // the joint breaks; `body` is its id: Event::of_joint(); needs Features::joint_breaks
    remove_joint,      // the joint leaves the world; likewise; needs Features::removal
};

// The name of a kind, as scene files write it: angular_impulse.
[[nodiscard]] constexpr const char* name_of(EventKind kind) {
    switch (kind) {
    case EventKind::impulse: return "impulse";
    case EventKind::angular_impulse: return "angular_impulse";
    case EventKind::force: return "force";
    case EventKind::torque: return "torque";
    case EventKind::step_force: return "step_force";
    case EventKind::step_torque: return "step_torque";
    case EventKind::begin_force: return "begin_force";
    case EventKind::end_force: return "end_force";
    case EventKind::begin_torque: return "begin_torque";
    case EventKind::end_torque: return "end_torque";
    case EventKind::velocity: return "velocity";
    case EventKind::angular_velocity: return "angular_velocity";
    case EventKind::pose: return "pose";
    case EventKind::remove: return "remove";
    case EventKind::break_joint: return "break_joint";
    case EventKind::remove_joint: return "remove_joint";
    default: return "gravity";
    }
}

// True of a force or torque that an event sets.
[[nodiscard]] constexpr bool is_wrench(EventKind kind) {
    return kind >= EventKind::force && kind <= EventKind::end_torque;
}
// True of one that acts from its beginning to its end.
[[nodiscard]] constexpr bool is_timed(EventKind kind) {
    return kind >= EventKind::begin_force && kind <= EventKind::end_torque;
}
// True of an event that acts at a point.
[[nodiscard]] constexpr bool has_point(EventKind kind) {
    return kind == EventKind::impulse || kind == EventKind::force || kind == EventKind::step_force ||
           kind == EventKind::begin_force || kind == EventKind::end_force;
}
// True of an event that has a body.
[[nodiscard]] constexpr bool has_body(EventKind kind) { return kind < EventKind::gravity; }
// True of an event of a joint.
[[nodiscard]] constexpr bool has_joint(EventKind kind) { return kind > EventKind::gravity; }

// An event of a body or of gravity, in the working numbers of its world. World::apply() applies it before the next
// step.
template <class N>
struct Event {
    using Work = typename N::Work;  // number of the orientation

    EventKind kind = EventKind::impulse;  // what happens
    Frame frame = Frame::world;           // of `value`; body: the user's body axes
    BodyId body{};                        // which body; none of gravity; of a joint's event the joint: joint()
    InputVector<N> value{};               // see the kind
    InputVector<N> point{};               // m, user's body axes, from the centre of mass
    Quaternion<Work> orientation{};       // user's body axes to world; normalised when applied
    std::uint64_t step = 0;               // in a script: applied before this step is taken; else without meaning

    // What happens to a joint.
    [[nodiscard]] static constexpr Event of_joint(EventKind kind, JointId id) {
        return {kind, Frame::world, BodyId{id.index(), id.generation()}, {}, {}, {}, 0};
    }
    // The joint of such an event.
    [[nodiscard]] constexpr JointId joint() const { return {body.index(), body.generation()}; }
};

namespace detail {

// A linear push at a point or an angular one, of N s or N m s, or of these a step. In principal axes where the frame is
// the body's.
template <class N>
struct Push {
    Frame frame = Frame::world;
    bool at_centre = true;  // of an angular push too
    VectorBlock<N> value{};
    VectorBlock<N> point{};  // m, principal axes

    // Calls visit with the members that a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        visit(self.frame, self.at_centre, self.value, self.point);
    }
};

// Of a point mass, anything but a linear push at its centre in the world's frame is misuse.
template <bool angular>
TUMBLE_INLINE void require_rotation(const auto& bodies, int b, Frame frame, bool at_centre) {
    if (!bodies.rotates(b)) TUMBLE_ASSERT(!angular && frame == Frame::world && at_centre);
}
// Writes the push in the frame, at a point in the user's body axes.
template <class N, bool angular, class Bodies>
TUMBLE_INLINE void take_push(Push<N>& push, const Bodies& bodies, int b, Frame frame, const VectorBlock<N>& value,
                             [[maybe_unused]] const VectorBlock<N>& point) {
    const bool at_centre = angular || point.is_zero();
    require_rotation<angular>(bodies, b, frame, at_centre);
    push.frame = frame;
    push.at_centre = at_centre;
    push.value = value;
    push.point = {};
    if constexpr (Bodies::rotation) {
        if (frame == Frame::body) push.value = bodies.in_principal_axes(b, value);
        if (!at_centre) push.point = bodies.in_principal_axes(b, point);
    }
}

// Half the angle that the body turns in a step, at its present spin, in principal axes.
template <class N, class Bodies>
[[nodiscard]] Vec3<typename N::Unit> half_turn(const Bodies& bodies, int b) requires(Bodies::rotation) {
    const auto& units = bodies.constants[b].units;
    const auto t = bodies.state[b].t_b.value();
    const typename N::Scale unit = bodies.spin_scale(b);
    return {VectorBlock<N>::half_angle(t[0], units.per_half_turn(0), unit),
            VectorBlock<N>::half_angle(t[1], units.per_half_turn(1), unit),
            VectorBlock<N>::half_angle(t[2], units.per_half_turn(2), unit)};
}

// Calls linear(push in world axes) and turning(push in principal axes, N m s) for what a push changes. A push that
// lasts a step acts in the orientation of the middle of that step; `ahead` is half the angle that the body turns in it.
template <class N, bool angular, class Bodies, class Linear, class Turning>
TUMBLE_INLINE void resolve(const Bodies& bodies, int b, const Push<N>& push,
                           [[maybe_unused]] const Vec3<typename N::Unit>* ahead, [[maybe_unused]] Linear&& linear,
                           [[maybe_unused]] Turning&& turning) {
    using Block = VectorBlock<N>;
    if constexpr (!Bodies::rotation) {
        linear(push.value);
    } else {
        const auto in_body = [&] {
            const Block p_b = push.value.rotated_back(bodies.state[b].q_wb.value());
            return ahead != nullptr ? p_b.turned(-*ahead) : p_b;
        };
        if constexpr (angular) {
            turning(push.frame == Frame::world ? in_body() : push.value);
        } else {
            const Block* p_w = &push.value;
            Block turned;
            if (push.frame == Frame::body) {
                const auto q = bodies.state[b].q_wb.value();
                turned = ahead != nullptr ? push.value.turned(*ahead).rotated(q) : push.value.rotated(q);
                p_w = &turned;
            }
            linear(*p_w);
            if (!push.at_centre) turning(cross(push.point, push.frame == Frame::world ? in_body() : push.value));
        }
    }
}

// --- events that change the state at once ------------------------------------------------------------------------

// Applies a push, or its opposite. An impulse and its opposite leave the motion as it was, bit for bit: they are
// applied as one of the two, with ties upwards, and with ties downwards where the opposite is meant.
template <class N, bool angular, class Bodies>
TUMBLE_INLINE void apply_push(Bodies& bodies, int b, const Push<N>& push, bool opposite) {
    using Block = VectorBlock<N>;
    const auto add = [](auto& to) {
        return [&](int i, auto change, auto is_small) __attribute__((always_inline)) {
            if constexpr (is_small) to[i].add(change);
            else N::add_sum(to[i], change);
        };
    };
    const auto& body = bodies.constants[b];
    resolve<N, angular>(
        bodies, b, push, nullptr,
        [&](const Block& p_w) __attribute__((always_inline)) {
            p_w.each_drift(body.drift_per_impulse(), bodies.scale, opposite, add(bodies.state[b].d_w));
        },
        [&]([[maybe_unused]] const Block& p_b) __attribute__((always_inline)) {
            if constexpr (Bodies::rotation)
                bodies.change_spin(
                    b, [&](auto& t_b, typename N::Scale unit)
                           __attribute__((always_inline)) { p_b.each_turn(body.units, unit, opposite, add(t_b)); });
        });
}
// The vector in the world's axes, or in principal axes.
template <class N, class Bodies>
[[nodiscard]] VectorBlock<N> in_world(const Bodies& bodies, int b, Frame frame, VectorBlock<N> v) {
    if (frame == Frame::world) return v;
    TUMBLE_ASSERT(bodies.rotates(b));
    if constexpr (Bodies::rotation) v = bodies.in_principal_axes(b, v).rotated(bodies.state[b].q_wb.value());
    return v;
}
template <class N, class Bodies>
[[nodiscard]] VectorBlock<N> in_principal(const Bodies& bodies, int b, Frame frame,
                                          const VectorBlock<N>& v) requires(Bodies::rotation) {
    return frame == Frame::world ? v.rotated_back(bodies.state[b].q_wb.value()) : bodies.in_principal_axes(b, v);
}

// `seconds`: of a step.
template <class N, class Bodies>
void set_velocity(Bodies& bodies, int b, Frame frame, const VectorBlock<N>& value, typename N::Work seconds) {
    if (bodies.constants[b].fixed() && !bodies.constants[b].kinematic()) return;
    const VectorBlock<N> v = in_world<N>(bodies, b, frame, value);
    for (int i = 0; i < 3; ++i) {
        bodies.state[b].d_w[i] = {};
        N::add_sum(bodies.state[b].d_w[i], v.drift(i, seconds, bodies.scale));
    }
}
template <class N, class Bodies>
void set_angular_velocity([[maybe_unused]] Bodies& bodies, [[maybe_unused]] int b, [[maybe_unused]] Frame frame,
                          [[maybe_unused]] const VectorBlock<N>& value, [[maybe_unused]] typename N::Work rate) {
    TUMBLE_ASSERT(bodies.rotates(b));
    if constexpr (Bodies::rotation) {
        const VectorBlock<N> w = in_principal<N>(bodies, b, frame, value);
        bodies.stop_spin(b);
        bodies.change_spin(b, [&](auto& t_b, typename N::Scale unit) {
            for (int i = 0; i < 3; ++i)
                N::add_sum(t_b[i], w.turn(i, typename N::Work(1) / bodies.constants[b].units.rate(i, rate), unit));
        });
    }
}
template <class N, class Bodies>
TUMBLE_INLINE void set_pose(Bodies& bodies, int b, const VectorBlock<N>& position,
                            const Quaternion<typename N::Work>& q) {
    using Work = typename N::Work;
    auto& s = bodies.state[b];
    if (!bodies.rotates(b)) TUMBLE_ASSERT(q == Quaternion<Work>{});
    else if constexpr (Bodies::rotation) set_product<N>(s.q_wb, q, bodies.constants[b].principal());
    for (int i = 0; i < 3; ++i) {
        s.x_w[i] = {};
        N::add_sum(s.x_w[i], position.position(i));
    }
}

}  // namespace detail

}  // namespace tumble
