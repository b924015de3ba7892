// What a program reads of a body, in its own numbers: T is float, double, Real or the world's working numbers, and of a
// world in fixed point Fixed<F> with F below 30. Floats and Fixed of a world in fixed point come by shifts, all others
// through working numbers.
#pragma once

#include <tumble/body/state_in_unit.hpp>
#include <tumble/events/event.hpp>

namespace tumble {

// Where a body is.
template <class T>
struct Pose {
    Vector3<T> position{};        // m, of the centre of mass, world
    Quaternion<T> orientation{};  // user's body axes to world
};

// How a body moves.
template <class T>
struct Motion {
    Vector3<T> velocity{};          // m/s, of the centre of mass, world
    Vector3<T> angular_velocity{};  // rad/s, user's body axes
};

// What an inertial sensor on a body measures.
template <class T>
struct Imu {
    Vector3<T> specific_force{};    // m/s^2, acceleration less gravity, user's body axes
    Vector3<T> angular_velocity{};  // rad/s, user's body axes
};

// Between two poses of a body that are a step or a few apart: `share` 0 gives a, 1 gives b. The orientation takes the
// shorter way.
template <class T>
[[nodiscard]] constexpr Pose<T> interpolate(const Pose<T>& a, const Pose<T>& b, std::type_identity_t<T> share) {
    const T cosine = a.orientation.w * b.orientation.w + dot(a.orientation.v, b.orientation.v);
    const T left = T(1) - share, right = cosine < T(0) ? -share : share;
    const T w = a.orientation.w * left + b.orientation.w * right;
    const Vector3<T> v = a.orientation.v * left + b.orientation.v * right;
    const T length = sqrt(w * w + dot(v, v));
    return {a.position * left + b.position * share, {w / length, {v.x / length, v.y / length, v.z / length}}};
}

namespace detail {

// True where readouts avoid working numbers.
template <class T, class N>
inline constexpr bool reads_by_shifts = N::fixed_point && (std::is_same_v<T, float> || is_fixed<T>);

// raw * 2^-bits, which is at most half as precise in T, as the nearest T.
template <class T, int bits, class Raw>
[[nodiscard]] TUMBLE_INLINE constexpr T read(Raw raw) {
    if constexpr (!is_fixed<T>) {
        return to_float(raw, -bits);
    } else {
        constexpr int down = bits - T::fraction_bits;
        if constexpr (down <= 0) {
            return Scaled::of(raw, -bits).template to_fixed<T>();
        } else {
            const Raw rounded = ((raw >> (down - 1)) + 1) >> 1;
            if constexpr (8 * static_cast<int>(sizeof(Raw)) - down > 32) {
                constexpr std::int64_t limit = INT32_MAX;
                return T{static_cast<std::int32_t>(rounded > limit ? limit : rounded < -limit ? -limit : rounded)};
            }
            return T{static_cast<std::int32_t>(rounded)};
        }
    }
}

template <class T, class Bodies>
[[nodiscard]] Pose<T> pose_of(const Bodies& bodies, int b) {
    using N = typename Bodies::Numbers;
    Pose<T> pose;
    if constexpr (!reads_by_shifts<T, N>) {
        const auto x = bodies.position(b);
        const auto q = bodies.orientation(b);
        pose.position = Vector3<typename N::Work>{x[0], x[1], x[2]}.template as<T>();
        pose.orientation = {static_cast<T>(q.w),
                            {static_cast<T>(q.v[0]), static_cast<T>(q.v[1]), static_cast<T>(q.v[2])}};
    } else {
        const auto& s = bodies.state[b];
        for (int i = 0; i < 3; ++i) pose.position[i] = read<T, N::PositionSum::fraction_bits>(s.x_w[i].sum().raw);
        if constexpr (Bodies::rotation) {
            if (!bodies.rotates(b)) return pose;
            using Unit = typename N::Unit;
            const auto q = s.q_wb.value();
            const auto p = bodies.constants[b].principal().conjugate();
            const auto component = [&]<int i>() {
                const auto sum = mul_add(mul(q.w, p.v[i]), q.v[i], p.w);
                return narrow<Unit>(add_cross_component<i>(sum, q.v, p.v)).raw;
            };
            const VectorBlock<N> v{{component.template operator()<0>(), component.template operator()<1>(),
                                    component.template operator()<2>()},
                                   -Unit::fraction_bits};
            pose.orientation = {read<T, Unit::fraction_bits>(narrow<Unit>(mul(q.w, p.w) - dot(q.v, p.v)).raw),
                                v.template as<T>()};
        }
    }
    return pose;
}

// Angular velocity in principal axes from half turns.
template <class N, class Bodies>
[[nodiscard]] VectorBlock<N> spin_of(const Bodies& bodies, int b, const typename N::TurnSum (&t)[3],
                                     typename N::Scale unit,
                                     typename N::Work steps_per_second) requires(Bodies::rotation) {
    const auto& units = bodies.constants[b].units;
    VectorBlock<N> spin;
    if constexpr (Bodies::Units::has_one_rate) {
        spin = VectorBlock<N>::of_turns(t, unit);
        spin.multiply_by(units.per_half_turn(0));
    } else {
        spin = VectorBlock<N>::of_turns(t, unit, units);
    }
    spin.multiply_by(steps_per_second);
    return spin;
}

// Inlined: a program that reads one of the two pays for one.
template <class T, class Bodies>
[[nodiscard]] TUMBLE_INLINE Motion<T> motion_of(const Bodies& bodies, int b, typename Bodies::Work steps_per_second) {
    using N = typename Bodies::Numbers;
    const auto& s = bodies.state[b];
    const typename N::DriftSum d[3]{N::sum(s.d_w.x), N::sum(s.d_w.y), N::sum(s.d_w.z)};
    VectorBlock<N> velocity = VectorBlock<N>::of_drifts(d, bodies.scale);
    velocity.multiply_by(steps_per_second);
    Motion<T> motion{velocity.template as<T>(), {}};
    if constexpr (Bodies::rotation) {
        if (!bodies.rotates(b)) return motion;
        const typename N::TurnSum t[3]{N::sum(s.t_b.x), N::sum(s.t_b.y), N::sum(s.t_b.z)};
        const VectorBlock<N> spin = spin_of<N>(bodies, b, t, bodies.spin_scale(b), steps_per_second);
        motion.angular_velocity = bodies.in_users_axes(b, spin).template as<T>();
    }
    return motion;
}

// to - from with the residuals of both.
template <class N>
[[nodiscard]] auto change(const auto& to, const auto& from) {
    if constexpr (N::fixed_point) return to.sum() - from.sum();
    else return (to.value() - from.value()) + (to.residual() - from.residual());
}

// The means over the last step: of the acceleration from the change of the velocity, less `fall`, gravity's change of
// drift in a step. The body's axes are those in the middle of the step.
template <class T, class Bodies>
[[nodiscard]] Imu<T> imu_of(const Bodies& bodies, int b, const KeptMotion<typename Bodies::State>& before,
                            const typename Bodies::Numbers::DriftSum (&fall)[3],
                            const VectorBlock<typename Bodies::Numbers>& point,
                            typename Bodies::Work steps_per_second) {
    using N = typename Bodies::Numbers;
    using Block = VectorBlock<N>;
    const auto& s = bodies.state[b];
    typename N::DriftSum d[3];
    for (int i = 0; i < 3; ++i) d[i] = change<N>(s.d_w[i], before.d_w[i]) - fall[i];
    Block force = Block::of_drifts(d, bodies.scale).times(steps_per_second).times(steps_per_second);
    if (!bodies.rotates(b)) {
        TUMBLE_ASSERT(point.is_zero());
        return {force.template as<T>(), {}};
    }
    if constexpr (Bodies::rotation) {
        typename N::TurnSum mean[3], turned[3];
        auto now = s.t_b, from = before.t_b;
        typename N::Scale unit = bodies.spin_scale(b);
        if constexpr (Bodies::has_parts) {
            for (int h = bodies.halvings_of(b); h < before.halvings; ++h) N::halve(now);
            bodies.to_scale_of(b, from, before.halvings);
            if (before.halvings > bodies.halvings_of(b)) unit = bodies.scale.halved(before.halvings);
        }
        for (int i = 0; i < 3; ++i) {
            turned[i] = change<N>(now[i], from[i]);
            mean[i] = N::sum(now[i]) - N::half(turned[i]);
        }
        const Block spin = spin_of<N>(bodies, b, mean, unit, steps_per_second);
        // From the axes at the end of the step back to those of its middle: f + (h/2) w x f.
        force = force.rotated_back(s.q_wb.value()).turned(half_turn<N>(bodies, b));
        if (!point.is_zero()) {
            const Block arm = bodies.in_principal_axes(b, point);
            const Block gain = spin_of<N>(bodies, b, turned, unit, steps_per_second).times(steps_per_second);
            force = force + cross(gain, arm) + cross(spin, cross(spin, arm));
        }
        return {bodies.in_users_axes(b, force).template as<T>(), bodies.in_users_axes(b, spin).template as<T>()};
    }
    return {};
}

// About principal axis i, kg m^2.
template <class Bodies>
[[nodiscard]] auto moment_of(const Bodies& bodies, int b, int i,
                             typename Bodies::Work steps_per_second) requires(Bodies::rotation) {
    using Work = typename Bodies::Work;
    return Work(1) / (bodies.step_per_moment(b, i) * steps_per_second);
}

template <class Bodies>
[[nodiscard]] typename Bodies::Work kinetic_energy(const Bodies& bodies, int b,
                                                   typename Bodies::Work steps_per_second) {
    using N = typename Bodies::Numbers;
    using Work = typename N::Work;
    Work twice(0);
    for (int i = 0; i < 3; ++i) {
        const Work v = bodies.drift(b, i) * steps_per_second;
        twice += v * v;
    }
    twice = twice / (bodies.step_per_mass(b) * steps_per_second);
    if constexpr (Bodies::rotation) {
        for (int i = 0; i < 3 && bodies.rotates(b); ++i) {
            const Work w = bodies.turn(b, i) * steps_per_second;
            twice += w * w * moment_of(bodies, b, i, steps_per_second);
        }
    }
    return N::half_of(twice);
}

// R diag(moments) R^T, with R from principal axes to the user's.
template <class Bodies>
[[nodiscard]] InertiaTensor inertia_of_body(const Bodies& bodies, int b, typename Bodies::Work steps_per_second) {
    InertiaTensor tensor;
    if constexpr (Bodies::rotation) {
        if (!bodies.rotates(b)) return tensor;
        using N = typename Bodies::Numbers;
        const auto p = bodies.constants[b].principal();
        const auto real = [](auto u) { return static_cast<Real>(N::work(u)); };
        const RealQuat q{real(p.w), {real(p.v[0]), real(p.v[1]), real(p.v[2])}};
        for (int i = 0; i < 3; ++i) {
            RealVec3 axis;
            axis[i] = 1;
            const RealVec3 u = q.rotate(axis);
            const Real moment = static_cast<Real>(moment_of(bodies, b, i, steps_per_second));
            tensor.xx += moment * u.x * u.x;
            tensor.yy += moment * u.y * u.y;
            tensor.zz += moment * u.z * u.z;
            tensor.xy += moment * u.x * u.y;
            tensor.xz += moment * u.x * u.z;
            tensor.yz += moment * u.y * u.z;
        }
    }
    return tensor;
}

}  // namespace detail

}  // namespace tumble
