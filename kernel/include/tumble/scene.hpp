// What is decided of a scene at compile time: number system, integrator, capacities and features. What it leaves out is
// not in the image. `tumble compile` writes it from a scene file.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

namespace integrators {
struct Verlet;
}  // namespace integrators

// What a scene has room for and what can happen in it; what it leaves out is not in the image. This is the list of
// features; what combines or prints them goes through for_each().
struct Features {
    int bodies = 1;                // room for bodies, fixed ones too; 0: a world that counts its steps
    int planes = 0;                // room for planes
    int springs = 0;               // room for springs
    int near_pairs = 0;            // pairs near at one time, of a body and a plane or another; 0: as usual
    bool rotation = true;          // bodies rotate; without, all of them are point masses
    bool point_masses = false;     // bodies may be point masses, which do not
    bool drag = false;             // world-wide linear and angular drag
    bool gravitation = false;      // between all bodies
    bool forces = false;           // timed forces and torques
    bool impulses = false;         // timed impulses
    bool pairs = false;            // bodies touch bodies
    bool boxes = false;            // boxes touch (spheres always do where there are planes or pairs)
    bool round_shapes = false;     // cylinders, capsules and hoops touch planes
    bool friction = false;         // at contacts by impulses
    bool sleep = false;            // what rests falls asleep
    bool turntables = false;       // fixed bodies may turn
    bool contact_impulses = true;  // ContactResponse::impulse
    bool contact_springs = false;  // ContactResponse::spring

    friend constexpr bool operator==(const Features&, const Features&) = default;

    // Calls f(name, pointer to the member) for each of them, in the order above.
    template <class F>
    static constexpr void for_each(F&& f) {
        f("bodies", &Features::bodies);
        f("planes", &Features::planes);
        f("springs", &Features::springs);
        f("near_pairs", &Features::near_pairs);
        f("rotation", &Features::rotation);
        f("point_masses", &Features::point_masses);
        f("drag", &Features::drag);
        f("gravitation", &Features::gravitation);
        f("forces", &Features::forces);
        f("impulses", &Features::impulses);
        f("pairs", &Features::pairs);
        f("boxes", &Features::boxes);
        f("round_shapes", &Features::round_shapes);
        f("friction", &Features::friction);
        f("sleep", &Features::sleep);
        f("turntables", &Features::turntables);
        f("contact_impulses", &Features::contact_impulses);
        f("contact_springs", &Features::contact_springs);
    }
    // What either has room for and needs.
    [[nodiscard]] constexpr Features united_with(const Features& other) const {
        Features both = *this;
        for_each([&](const char*, auto member) {
            if (both.*member < other.*member) both.*member = other.*member;
        });
        return both;
    }
    // All that can happen, in this room.
    [[nodiscard]] constexpr Features with_everything() const {
        Features all = *this;
        for_each([&]<class T>(const char*, T Features::*member) {
            if constexpr (std::is_same_v<T, bool>) all.*member = true;
        });
        return all;
    }

    // True where some bodies rotate and others, point masses, do not.
    [[nodiscard]] constexpr bool mixed() const { return rotation && point_masses; }
    // True where there is something for a body to touch; point masses touch nothing.
    [[nodiscard]] constexpr bool touches() const { return bodies > 0 && rotation && (planes > 0 || pairs); }
    // True where the code of contacts by impulses is compiled in.
    [[nodiscard]] constexpr bool contacts() const { return touches() && contact_impulses; }
    // True where the code of contacts by springs is compiled in.
    [[nodiscard]] constexpr bool springs_touch() const { return touches() && contact_springs; }
    // True where something but gravity may push bodies.
    [[nodiscard]] constexpr bool loads() const {
        return bodies > 0 && (drag || gravitation || forces || springs > 0 || springs_touch());
    }
    // Every pair of a few bodies; of many, as many as a heap of spheres has. Boxes packed side by side have more.
    [[nodiscard]] constexpr int room_for_pairs() const {
        if (near_pairs > 0) return near_pairs;
        const int all = bodies * planes + (pairs ? bodies * (bodies - 1) / 2 : 0), usual = 3 * bodies + planes;
        return pairs && all > usual ? usual : all;
    }
};

// The base of every scene type: override what differs.
struct Scene {
    using Numbers = Q32<>;                   // the number system
    using Integrator = integrators::Verlet;  // one of tumble::integrators
    static constexpr Features features{};    // room, and what can happen
};

// A scene type made of its parts, for programs that vary them.
template <class N, class Method, Features what>
struct SceneOf {
    using Numbers = N;                          // as in Scene
    using Integrator = Method;                  // as in Scene
    static constexpr Features features = what;  // as in Scene
};

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
