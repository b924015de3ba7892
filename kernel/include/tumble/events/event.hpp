// Event: what a program does to a body between two steps. A live call of the world makes one event and applies it.
#pragma once

#include <tumble/body/bodies.hpp>
#include <tumble/body/stage.hpp>
#include <tumble/numbers/vector_block.hpp>

namespace tumble {

// A vector that a program gives to a world: three numbers, or a Vector3, of float, double, int, Real or the world's
// working numbers. In fixed point it keeps 29 bits of the largest component, a float costs shifts and a double integer
// arithmetic, and NaN and infinity are misuse. In floating point they make the body leave its range.
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
    velocity,          // value: m/s
    angular_velocity,  // value: rad/s
    pose,              // value: m, world; `orientation`
    remove,            // the body leaves the world; needs Features::removal
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
    case EventKind::velocity: return "velocity";
    case EventKind::angular_velocity: return "angular_velocity";
    case EventKind::pose: return "pose";
    default: return "remove";
    }
}

// An event of a body, in the working numbers of its world. World::apply() applies it before the next step.
template <class N>
struct Event {
    using Work = typename N::Work;  // number of the orientation

    EventKind kind = EventKind::impulse;  // what happens
    Frame frame = Frame::world;           // of `value`; body: the user's body axes
    BodyId body{};                        // which body
    InputVector<N> value{};               // see the kind
    InputVector<N> point{};               // m, user's body axes, from the centre of mass
    Quaternion<Work> orientation{};       // user's body axes to world; normalised when applied
    std::uint64_t step = 0;               // in a script: applied before this step is taken; else without meaning
};

namespace detail {

// A linear push at a point or an angular one, of N s or N m s, or of these a step. In principal axes where the frame is
// the body's.
template <class N>
struct Push {
    bool angular = false;
    Frame frame = Frame::world;
    VectorBlock<N> value{};
    bool at_centre = true;
    VectorBlock<N> point{};  // m, principal axes

    // Calls visit with the members that a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        visit(self.angular, self.frame, self.value, self.at_centre, self.point);
    }
};

// The value and point of an event as a push. Misuse: of a point mass, anything but a linear push at its centre in the
// world's frame.
template <class N, class Bodies>
[[nodiscard]] TUMBLE_INLINE Push<N> push_of(const Bodies& bodies, int b, const Event<N>& event, bool angular) {
    Push<N> push{angular, event.frame, event.value.block(), angular || event.point.block().is_zero(), {}};
    if (!bodies.rotates(b)) {
        TUMBLE_ASSERT(!angular && event.frame == Frame::world && push.at_centre);
        return push;
    }
    if constexpr (Bodies::rotation) {
        const auto principal = bodies.constants[b].principal();
        if (event.frame == Frame::body) push.value = push.value.rotated_back(principal);
        if (!push.at_centre) push.point = event.point.block().rotated_back(principal);
    }
    return push;
}

// Half the angle that the body turns in a step, at its present spin, in principal axes.
template <class N, class Bodies>
[[nodiscard]] Vec3<typename N::Unit> half_turn(const Bodies& bodies, int b) requires(Bodies::rotation) {
    Vec3<typename N::Unit> u;
    for (int i = 0; i < 3; ++i)
        u[i] = VectorBlock<N>::half_angle(bodies.state[b].t_b[i].value(), bodies.constants[b].units.per_half_turn(i),
                                          bodies.spin_scale(b));
    return u;
}

// Calls linear(axis, change of drift) and angular(change of turns in a scale) for what a push changes. A push that
// lasts a step acts in the orientation of the middle of that step; `ahead` is half the angle that the body turns in it.
template <class N, class Bodies, class Linear, class Angular>
TUMBLE_INLINE void resolve(const Bodies& bodies, int b, const Push<N>& push,
                           [[maybe_unused]] const Vec3<typename N::Unit>* ahead, Linear&& linear,
                           [[maybe_unused]] Angular&& angular) {
    const auto& body = bodies.constants[b];
    VectorBlock<N> p_w = push.value;
    if constexpr (Bodies::rotation) {
        const bool in_world = push.frame == Frame::world;
        if (!in_world || !push.at_centre || push.angular) {
            const auto q = bodies.state[b].q_wb.value();
            VectorBlock<N> p_b = push.value;
            if (in_world) {
                p_b = p_b.rotated_back(q);
                if (ahead != nullptr) p_b = p_b.turned(-*ahead);
            } else if (!push.angular) {
                p_w = (ahead != nullptr ? p_b.turned(*ahead) : p_b).rotated(q);
            }
            if (!push.at_centre) p_b = cross(push.point, p_b);
            if (!push.at_centre || push.angular)
                angular([&](int i, typename N::Scale unit) { return p_b.turn(i, body.units.per_impulse(i), unit); });
            if (push.angular) return;
        }
    }
    for (int i = 0; i < 3; ++i) linear(i, p_w.drift(i, body.drift_per_impulse, bodies.scale));
}

// --- events that change the state at once ------------------------------------------------------------------------

template <class N, class Bodies>
void apply_push(Bodies& bodies, int b, const Push<N>& push) {
    auto& s = bodies.state[b];
    resolve(
        bodies, b, push, nullptr, [&](int i, auto change) { N::add_sum(s.d_w[i], change); },
        [&]([[maybe_unused]] auto&& change) {
            if constexpr (Bodies::rotation)
                bodies.change_spin(b, [&](auto& t_b, typename N::Scale unit) {
                    for (int i = 0; i < 3; ++i) N::add_sum(t_b[i], change(i, unit));
                });
        });
}

// The vector in the world's axes, or in principal axes.
template <class N, class Bodies>
[[nodiscard]] VectorBlock<N> in_world(const Bodies& bodies, int b, const Event<N>& event) {
    VectorBlock<N> v = event.value.block();
    if (event.frame == Frame::world) return v;
    TUMBLE_ASSERT(bodies.rotates(b));
    if constexpr (Bodies::rotation)
        v = v.rotated_back(bodies.constants[b].principal()).rotated(bodies.state[b].q_wb.value());
    return v;
}
template <class N, class Bodies>
[[nodiscard]] VectorBlock<N> in_principal(const Bodies& bodies, int b,
                                          const Event<N>& event) requires(Bodies::rotation) {
    const VectorBlock<N>& v = event.value.block();
    return event.frame == Frame::world ? v.rotated_back(bodies.state[b].q_wb.value())
                                       : v.rotated_back(bodies.constants[b].principal());
}

// `seconds`: of a step.
template <class N, class Bodies>
void set_velocity(Bodies& bodies, int b, const Event<N>& event, typename N::Work seconds) {
    if (bodies.constants[b].fixed) return;
    const VectorBlock<N> v = in_world(bodies, b, event);
    for (int i = 0; i < 3; ++i) {
        bodies.state[b].d_w[i] = {};
        N::add_sum(bodies.state[b].d_w[i], v.drift(i, seconds, bodies.scale));
    }
}
template <class N, class Bodies>
void set_angular_velocity([[maybe_unused]] Bodies& bodies, [[maybe_unused]] int b,
                          [[maybe_unused]] const Event<N>& event, [[maybe_unused]] typename N::Work rate) {
    TUMBLE_ASSERT(bodies.rotates(b));
    if constexpr (Bodies::rotation) {
        const VectorBlock<N> w = in_principal(bodies, b, event);
        bodies.stop_spin(b);
        bodies.change_spin(b, [&](auto& t_b, typename N::Scale unit) {
            for (int i = 0; i < 3; ++i)
                N::add_sum(t_b[i], w.turn(i, typename N::Work(1) / bodies.constants[b].units.rate(i, rate), unit));
        });
    }
}
template <class N, class Bodies>
void set_pose(Bodies& bodies, int b, const Event<N>& event) {
    using Work = typename N::Work;
    auto& s = bodies.state[b];
    for (int i = 0; i < 3; ++i) {
        s.x_w[i] = {};
        N::add_sum(s.x_w[i], event.value.block().position(i));
    }
    const Quaternion<Work>& q = event.orientation;
    if (!bodies.rotates(b)) {
        TUMBLE_ASSERT(q == Quaternion<Work>{});
        return;
    }
    if constexpr (Bodies::rotation) {
        const Work norm2 = q.w * q.w + dot(q.v, q.v);
        TUMBLE_ASSERT(norm2 > Work(0));
        const auto p = bodies.constants[b].principal();
        const Work length = sqrt(norm2);
        const Quaternion<Work> to{q.w / length, {q.v.x / length, q.v.y / length, q.v.z / length}},
            principal{N::work(p.w), {N::work(p.v.x()), N::work(p.v.y()), N::work(p.v.z())}}, product = to * principal;
        const auto set = [](auto& number, Work value) {
            number = {};
            number.add(N::unit_sum(value));
        };
        set(s.q_wb.w, product.w);
        set(s.q_wb.x, product.v.x);
        set(s.q_wb.y, product.v.y);
        set(s.q_wb.z, product.v.z);
    }
}

}  // namespace detail

}  // namespace tumble
