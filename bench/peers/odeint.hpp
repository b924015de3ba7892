// The peer: one body integrated by Boost.Odeint in float or double, as its documentation shows. It integrates only what
// the error needs: the rotation if the error is an orientation, the centre of mass if it is a position. The same source
// is timed on cores and measured for error on the host.
#pragma once

#include <boost/numeric/odeint/stepper/euler.hpp>
#include <boost/numeric/odeint/stepper/modified_midpoint.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta4.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <type_traits>

namespace tumble::bench {

// Numbers of a scene's data (tumble/replay.hpp) as T.
template <class T>
[[nodiscard]] T as(auto number) {
    if constexpr (std::same_as<T, float>) return number.to_float();
    else return number.to_double();
}
template <class T>
[[nodiscard]] std::array<T, 3> vector_as(const auto& v) {
    return {as<T>(v.x), as<T>(v.y), as<T>(v.z)};
}

// A top about its centre of mass: orientation (w, x, y, z, body to world) and angular velocity (body axes, rad/s). With
// `forced`, the force with which the scene's first event begins acts at a point of it, constant in the world.
template <class Number, bool forced>
struct TopEquations {
    using T = Number;
    using State = std::array<T, 7>;
    static constexpr bool has_orientation = true;  // in the first four numbers

    std::array<T, 3> moments;         // kg m^2
    std::array<T, 3> force{}, arm{};  // N, world; m, body axes

    template <class Data>
    [[nodiscard]] static TopEquations of(const Data& scene) {
        const auto& inertia = scene.bodies[0].inertia;
        TopEquations top{{as<T>(inertia.xx), as<T>(inertia.yy), as<T>(inertia.zz)}};
        if constexpr (forced) {
            top.force = vector_as<T>(scene.events[0].value);
            top.arm = vector_as<T>(scene.events[0].point);
        }
        return top;
    }
    template <class Data>
    [[nodiscard]] static State start(const Data& scene) {
        const auto w = vector_as<T>(scene.bodies[0].angular_velocity);
        return {1, 0, 0, 0, w[0], w[1], w[2]};
    }

    void operator()(const State& s, State& rate, T) const {
        const T half = T(0.5);
        const T w = s[0], x = s[1], y = s[2], z = s[3], a = s[4], b = s[5], c = s[6];
        rate[0] = -half * (x * a + y * b + z * c);
        rate[1] = half * (w * a + y * c - z * b);
        rate[2] = half * (w * b + z * a - x * c);
        rate[3] = half * (w * c + x * b - y * a);
        rate[4] = (moments[1] - moments[2]) / moments[0] * b * c;
        rate[5] = (moments[2] - moments[0]) / moments[1] * c * a;
        rate[6] = (moments[0] - moments[1]) / moments[2] * a * b;
        if constexpr (forced) {
            // The force in the body's axes: v - 2 w (u x v) + 2 u x (u x v).
            const auto cross = [](const std::array<T, 3>& u, const std::array<T, 3>& v) {
                return std::array<T, 3>{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
                                        u[0] * v[1] - u[1] * v[0]};
            };
            const std::array<T, 3> u{x, y, z}, across = cross(u, force), twice = cross(u, across);
            std::array<T, 3> f;
            for (std::size_t i = 0; i < 3; ++i) f[i] = force[i] + T(2) * (twice[i] - w * across[i]);
            const auto torque = cross(arm, f);
            for (std::size_t i = 0; i < 3; ++i) rate[4 + i] += torque[i] / moments[i];
        }
    }
    // One step of Newton's iteration keeps the quaternion of unit length.
    static void normalise(auto& s) {
        const T excess = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + s[3] * s[3];
        const T scale = T(1.5) - T(0.5) * excess;
        for (std::size_t i = 0; i < 4; ++i) s[i] *= scale;
    }
};

// The centre of mass of the scene's last body: position (m) and velocity (m/s), under gravity, linear drag, a spring to
// a world point, and the attraction of a fixed body.
template <class Number>
struct PointEquations {
    using T = Number;
    using State = std::array<T, 6>;
    static constexpr bool has_orientation = false;  // a position, in the first three numbers

    std::array<T, 3> gravity;                       // m/s^2
    T drag = 0;                                     // 1/s
    T stiffness = 0, damping = 0, rest_length = 0;  // 1/s^2, 1/s, m
    T attraction = 0;                               // m^3/s^2
    std::array<T, 3> centre{};                      // of the spring or the attraction, m

    template <class Data>
    [[nodiscard]] static PointEquations of(const Data& scene) {
        const auto& body = scene.bodies[scene.bodies.size() - 1];
        const auto per_mass = [&](const auto& number) { return as<T>(number / body.mass); };
        PointEquations point{vector_as<T>(scene.world.gravity), per_mass(scene.world.linear_drag)};
        for (const auto& spring : scene.springs) {
            point.stiffness = per_mass(spring.stiffness);
            point.damping = per_mass(spring.damping);
            point.rest_length = as<T>(spring.rest_length);
            point.centre = vector_as<T>(spring.to);
        }
        if (scene.bodies.size() == 2) {
            point.attraction = as<T>(scene.world.gravitation * scene.bodies[0].mass);
            point.centre = vector_as<T>(scene.bodies[0].position);
        }
        return point;
    }
    template <class Data>
    [[nodiscard]] static State start(const Data& scene) {
        const auto& body = scene.bodies[scene.bodies.size() - 1];
        const auto x = vector_as<T>(body.position), v = vector_as<T>(body.velocity);
        return {x[0], x[1], x[2], v[0], v[1], v[2]};
    }

    void operator()(const State& s, State& rate, T) const {
        for (std::size_t i = 0; i < 3; ++i) {
            rate[i] = s[3 + i];
            rate[3 + i] = gravity[i] - drag * s[3 + i];
        }
        if (stiffness > 0 || attraction > 0) {
            std::array<T, 3> away;
            T square = 0, outwards = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                away[i] = s[i] - centre[i];
                square += away[i] * away[i];
                outwards += away[i] * s[3 + i];
            }
            const T length = std::sqrt(square);
            T pull = attraction / (square * length);
            if (stiffness > 0) pull += (stiffness * (length - rest_length) + damping * outwards / length) / length;
            for (std::size_t i = 0; i < 3; ++i) rate[3 + i] -= pull * away[i];
        }
    }
    static void normalise(State&) {}
};

template <class E>
using OdeintEuler = boost::numeric::odeint::euler<typename E::State, typename E::T, typename E::State, typename E::T>;
template <class E>
using OdeintMidpoint =
    boost::numeric::odeint::modified_midpoint<typename E::State, typename E::T, typename E::State, typename E::T>;
template <class E>
using OdeintRk4 =
    boost::numeric::odeint::runge_kutta4<typename E::State, typename E::T, typename E::State, typename E::T>;

// A scene with a fixed step, s.
template <template <class> class Stepper, class Equations>
class OdeintRun {
public:
    using T = typename Equations::T;

    template <class Data>
    OdeintRun(const Data& scene, T step)
        : equations_{Equations::of(scene)}, state_{Equations::start(scene)}, step_{step} {}

    void step() {
        stepper_.do_step(equations_, state_, T(0), step_);
        Equations::normalise(state_);
    }
    [[nodiscard]] const typename Equations::State& state() const { return state_; }
    // Digest of the state's bits (FNV-1a over bytes, the lowest first): compares a core's answer with the host's.
    [[nodiscard]] std::uint64_t hash() const {
        using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
        std::uint64_t hash = 0xcbf29ce484222325u;
        for (const T value : state_) {
            const auto bits = std::bit_cast<Bits>(value);
            for (unsigned shift = 0; shift < 8 * sizeof bits; shift += 8)
                hash = (hash ^ ((bits >> shift) & 0xff)) * 0x100000001b3u;
        }
        return hash;
    }

private:
    Equations equations_;
    typename Equations::State state_;
    T step_;
    Stepper<Equations> stepper_;
};

}  // namespace tumble::bench
