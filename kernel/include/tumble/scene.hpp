// What is decided of a scene at compile time: number system, integrator, capacities and features. What it leaves out is
// not in the image. `tumble compile` writes it from a scene file.
#pragma once

#include <tumble/numbers/systems.hpp>

#include <type_traits>

namespace tumble {

namespace integrators {
struct Verlet;
}  // namespace integrators

// The base of every scene type: override what differs. Features are off until a scene asks for them.
struct Scene {
    using Numbers = Q32<>;
    using Integrator = integrators::Verlet;
    static constexpr int bodies = 1;  // capacities
    static constexpr int planes = 0;
    static constexpr int springs = 0;
    static constexpr bool drag = false;         // world-wide linear and angular drag
    static constexpr bool gravitation = false;  // between all bodies
    static constexpr bool forces = false;       // timed forces and torques
    static constexpr bool script = false;       // timed impulses
    static constexpr bool pairs = false;        // bodies touch bodies
    static constexpr int near_pairs = 0;        // pairs near at one time, of a body and a plane or another; 0: as usual
    static constexpr bool boxes = false;        // boxes touch (spheres always do where there are planes or pairs)
    static constexpr bool cylinders = false;    // cylinders, capsules and hoops touch planes
    static constexpr bool friction = false;
    static constexpr bool sleep = false;            // what rests falls asleep
    static constexpr bool turntables = false;       // fixed bodies may turn
    static constexpr bool contact_impulses = true;  // ContactResponse::impulse
    static constexpr bool contact_springs = false;  // ContactResponse::spring
};

// What of a scene shapes the bodies, loads and contacts of its world; the method and the script do not.
struct Capacity {
    int bodies, planes, springs, near_pairs;
    bool drag, gravitation, forces, pairs, boxes, cylinders, friction, sleep, turntables, contact_impulses,
        contact_springs;

    [[nodiscard]] constexpr bool touches() const { return planes > 0 || pairs; }
    [[nodiscard]] constexpr bool contacts() const { return touches() && contact_impulses; }
    [[nodiscard]] constexpr bool springs_touch() const { return touches() && contact_springs; }
    [[nodiscard]] constexpr bool loads() const {
        return drag || gravitation || forces || springs > 0 || springs_touch();
    }
    // Every pair of a few bodies; of many, as many as a heap of spheres has. Boxes packed side by side have more.
    [[nodiscard]] constexpr int room_for_pairs() const {
        if (near_pairs > 0) return near_pairs;
        const int all = bodies * planes + (pairs ? bodies * (bodies - 1) / 2 : 0), usual = 3 * bodies + planes;
        return pairs && all > usual ? usual : all;
    }
};
template <class S>
inline constexpr Capacity capacity_of{S::bodies,     S::planes,           S::springs,        S::near_pairs,
                                      S::drag,       S::gravitation,      S::forces,         S::pairs,
                                      S::boxes,      S::cylinders,        S::friction,       S::sleep,
                                      S::turntables, S::contact_impulses, S::contact_springs};

namespace detail {

// Takes no room where a feature is absent; the tag keeps two of them at one address.
template <int tag>
struct Nothing {
    constexpr Nothing() = default;
    template <class... Setup>
    constexpr explicit Nothing(const Setup&...) {}
};

}  // namespace detail

// A member that is there only where a scene needs it; the tag tells it from others of its class.
template <bool present, class T, int tag>
using If = std::conditional_t<present, T, detail::Nothing<tag>>;

}  // namespace tumble
