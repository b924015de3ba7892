// The compile-time decisions of a scene: number system, integrator, capacities and features. A feature that is off is
// not in the image. `tumble compile` writes a scene from a scene file.
#pragma once

#include <tumble/numbers/systems.hpp>

namespace tumble {

namespace integrators {
struct Verlet;
}  // namespace integrators

// The list of features: the room of a scene, and what can happen in it. A feature that is off is not in the image. Code
// that combines or prints features uses for_each(). kernel/README.md has a scene to begin with for each group.
struct Features {
    // --- every scene: the room ---
    int bodies = 1;   // room for bodies, fixed ones included; 0: the world only counts its steps
    int planes = 0;   // room for planes
    int springs = 0;  // room for springs
    // --- an arm: joints ---
    int joints = 0;              // room for joints; needs rotation; jointed bodies touch nothing yet
    bool hinges = true;          // joints may be hinges: HingeSpec
    bool balls = true;           // balls: BallSpec
    bool fixed_joints = true;    // welds: FixedSpec
    bool sliders = true;         // sliders: SliderSpec
    bool universals = true;      // universal joints: UniversalSpec
    bool distances = false;      // rods and ropes: DistanceSpec
    bool joint_springs = false;  // joints may have springs and dampers: JointSpring
    bool joint_limits = false;   // hinges and sliders may have limits: JointLimits
    bool joint_breaks = false;   // joints may break: break_force, break_torque, World::break_joint()
    // --- every scene: pairs that are near, and what a body is ---
    int near_pairs = 0;         // room for pairs that are near each other at one time; 0: the usual room
    bool rotation = true;       // bodies rotate; if false, all of them are point masses
    bool point_masses = false;  // some bodies may be point masses, which do not rotate
    // --- a satellite: loads ---
    bool drag = false;              // world-wide linear and angular drag
    bool gravitation = false;       // attraction between all bodies
    bool softening = false;         // of that attraction at short distances: World::set_softening()
    bool air = false;               // drag of each body in wind: Air
    bool gravity_gradient = false;  // torque on a long body in orbit: GravityGradient
    bool wheels = false;            // stored angular momentum of each body: Wheels
    // --- a drone: what a program does and reads ---
    bool forces = false;     // forces and torques may begin and end, in a script or by World::apply()
    bool impulses = false;   // a script may have impulses and angular impulses
    bool control = false;    // the program sets forces, torques and gravity while it runs
    bool script = false;     // a script may have events of every kind: World::set_script()
    bool recording = false;  // the world writes its events to a recording, for World::record()
    bool removal = false;    // bodies can be removed, and their places are used again
    bool snapshots = false;  // the world can be saved as bytes and restored, for World::save()
    bool imu = false;        // the world keeps the motion before each step, for World::imu()
    // --- dice: what touches, and how ---
    bool pairs = false;               // bodies collide with bodies
    bool boxes = false;               // boxes collide (spheres always do if there are planes or pairs)
    bool round_shapes = false;        // cylinders, capsules and hoops collide with planes
    bool layers = false;              // which bodies touch each other can be chosen: BodySpec::layers
    bool friction = false;            // for contacts by impulses
    bool rolling_resistance = false;  // rolling and spinning meet a resistance; needs friction
    bool mixing = false;              // how the values of two sides mix can be chosen: ContactSpec
    bool sleep = false;               // resting bodies fall asleep; for contacts by impulses
    bool turntables = false;          // fixed bodies may rotate
    bool kinematic = false;           // fixed bodies may move, and push what they meet: BodySpec::kinematic
    bool contact_readout = false;     // the world keeps what contacts do in a step, for World::contacts()
    bool impact_bounds = false;       // impacts, searches and sweeps of a step can be bounded: ContactSpec
    bool bounded_steps = false;       // islands of many bodies can step in bounded time: ContactSpec::exact_bodies
    bool exact_steps = true;          // islands can step with impacts at their own time: ContactSpec::exact_bodies
    bool contact_impulses = true;     // ContactResponse::impulse
    bool contact_springs = false;     // ContactResponse::spring

    friend constexpr bool operator==(const Features&, const Features&) = default;

    // Calls f(name, pointer to the member) for each feature, in the order above.
    template <class F>
    static constexpr void for_each(F&& f) {
        f("bodies", &Features::bodies);
        f("planes", &Features::planes);
        f("springs", &Features::springs);
        f("joints", &Features::joints);
        f("hinges", &Features::hinges);
        f("balls", &Features::balls);
        f("fixed_joints", &Features::fixed_joints);
        f("sliders", &Features::sliders);
        f("universals", &Features::universals);
        f("distances", &Features::distances);
        f("joint_springs", &Features::joint_springs);
        f("joint_limits", &Features::joint_limits);
        f("joint_breaks", &Features::joint_breaks);
        f("near_pairs", &Features::near_pairs);
        f("rotation", &Features::rotation);
        f("point_masses", &Features::point_masses);
        f("drag", &Features::drag);
        f("gravitation", &Features::gravitation);
        f("softening", &Features::softening);
        f("air", &Features::air);
        f("gravity_gradient", &Features::gravity_gradient);
        f("wheels", &Features::wheels);
        f("forces", &Features::forces);
        f("impulses", &Features::impulses);
        f("control", &Features::control);
        f("script", &Features::script);
        f("recording", &Features::recording);
        f("removal", &Features::removal);
        f("snapshots", &Features::snapshots);
        f("imu", &Features::imu);
        f("pairs", &Features::pairs);
        f("boxes", &Features::boxes);
        f("round_shapes", &Features::round_shapes);
        f("layers", &Features::layers);
        f("friction", &Features::friction);
        f("rolling_resistance", &Features::rolling_resistance);
        f("mixing", &Features::mixing);
        f("sleep", &Features::sleep);
        f("turntables", &Features::turntables);
        f("kinematic", &Features::kinematic);
        f("contact_readout", &Features::contact_readout);
        f("impact_bounds", &Features::impact_bounds);
        f("bounded_steps", &Features::bounded_steps);
        f("exact_steps", &Features::exact_steps);
        f("contact_impulses", &Features::contact_impulses);
        f("contact_springs", &Features::contact_springs);
    }
    // The features and the room that either of the two has.
    [[nodiscard]] constexpr Features united_with(const Features& other) const {
        Features both = *this;
        for_each([&](const char*, auto member) {
            if (both.*member < other.*member) both.*member = other.*member;
        });
        // A number may be less than the usual room of the other.
        const int room = room_for_pairs(), other_room = other.room_for_pairs();
        if (near_pairs != other.near_pairs) both.near_pairs = room < other_room ? other_room : room;
        return both;
    }
    // All features, in this room.
    [[nodiscard]] constexpr Features with_everything() const {
        Features all = *this;
        for_each([&]<class T>(const char*, T Features::*member) {
            if constexpr (std::is_same_v<T, bool>) all.*member = true;
        });
        return all;
    }

    // True if some bodies rotate and others, point masses, do not.
    [[nodiscard]] constexpr bool mixed() const { return rotation && point_masses; }
    // True if contacts may depend on the axes of a body. Those of spheres do not.
    [[nodiscard]] constexpr bool has_axes() const { return boxes || round_shapes; }
    // True if the surface of a fixed body may move.
    [[nodiscard]] constexpr bool moving_surfaces() const { return turntables || kinematic; }
    // True if a body can collide with something. Point masses collide with nothing.
    [[nodiscard]] constexpr bool touches() const { return bodies > 0 && rotation && (planes > 0 || pairs); }
    // True if the code of contacts by impulses is compiled in.
    [[nodiscard]] constexpr bool contacts() const { return touches() && contact_impulses; }
    // True if the code of contacts by springs is compiled in.
    [[nodiscard]] constexpr bool springs_touch() const { return touches() && contact_springs; }
    // True if a grid finds the bodies that may touch each other. Below, the tables of all pairs take less memory.
    [[nodiscard]] constexpr bool grid() const { return contacts() && pairs && bodies > 64; }
    // True if joints may tie bodies.
    [[nodiscard]] constexpr bool has_joints() const { return bodies > 0 && joints > 0; }
    // True if joints may have a range, at whose ends they are held.
    [[nodiscard]] constexpr bool has_joint_ranges() const { return distances || joint_limits; }
    // True if joints may have springs.
    [[nodiscard]] constexpr bool has_joint_springs() const { return has_joints() && joint_springs; }
    // True if the world may have a script.
    [[nodiscard]] constexpr bool has_script() const { return forces || impulses || script; }
    // True if anything other than gravity and control may push bodies.
    [[nodiscard]] constexpr bool loads() const {
        return bodies > 0 && (drag || gravitation || air || gravity_gradient || wheels || forces || springs > 0 ||
                              springs_touch() || has_joint_springs());
    }
    // Every pair of a body with a plane, and with another body where these may touch.
    [[nodiscard]] constexpr int all_pairs() const { return bodies * planes + (pairs ? bodies * (bodies - 1) / 2 : 0); }
    // Room for every pair of a few bodies; for many bodies, room for the pairs of a heap of spheres. In a heap a sphere
    // touches six others on average (as many contacts as motions: it is isostatic), and each pair is one of two
    // spheres; at a wall or in a corner up to three planes take the place of spheres, and a plane's pair is the
    // sphere's alone. Boxes that are packed side by side have more pairs. A world has room for 32767 pairs at the most.
    [[nodiscard]] constexpr int room_for_pairs() const {
        if (near_pairs > 0) return near_pairs;
        const int all = all_pairs(), usual = bodies * (6 + (planes < 3 ? planes : 3)) / 2,
                  most = usual < 32767 ? usual : 32767;
        return pairs && all > most ? most : all;
    }
};

namespace detail {

// How often a type is in a list.
template <class Type, class... List>
inline constexpr int times_in = (0 + ... + (std::is_same_v<Type, List> ? 1 : 0));

}  // namespace detail

// Loads that a program brings along, besides those of its scene's features: loads/load.hpp says what such a
// struct has.
template <class... Loads>
struct LoadList {
    static_assert(((detail::times_in<Loads, Loads...> == 1) && ...),
                  "a LoadList names each load once: for two of a kind, derive two structs from the load");
    static constexpr int count = sizeof...(Loads);  // number of loads
    template <class Load>
    static constexpr bool has = detail::times_in<Load, Loads...> == 1;  // it names the load
};

// The base of every scene type. Override the members that differ.
struct Scene {
    using Numbers = Q32<>;                   // the number system
    using Integrator = integrators::Verlet;  // one of tumble::integrators
    static constexpr Features features{};    // room and features
    using Loads = LoadList<>;                // loads of the program's own
};

// A scene type from its parts, for programs that vary them.
template <class N, class Method, Features what>
struct SceneOf {
    using Numbers = N;                          // as in Scene
    using Integrator = Method;                  // as in Scene
    static constexpr Features features = what;  // as in Scene
};

namespace detail {

// The loads of a scene's own; none where it does not name them.
template <class S>
struct OwnLoads {
    using List = LoadList<>;
};
template <class S>
requires requires { typename S::Loads; }
struct OwnLoads<S> {
    using List = typename S::Loads;
};
// True if anything other than gravity may push bodies of the scene.
template <class S>
inline constexpr bool has_loads = S::features.loads() || (S::features.bodies > 0 && OwnLoads<S>::List::count > 0);

// True of a number without a unit.
template <class T>
concept IsPlainNumber = std::is_arithmetic_v<T> || std::is_same_v<T, Real>;
// True of a number system, by what every one has.
template <class N>
concept IsNumberSystem = requires {
    typename N::Work;
    typename N::Scale;
    N::fixed_point;
};
// The scene, or one in its place whose World compiles, so that the message about the numbers stands alone.
template <class S>
struct WithNumbers {
    struct type : S {
        using Numbers = Q32<>;
    };
};
template <class S>
requires IsNumberSystem<typename S::Numbers>
struct WithNumbers<S> {
    using type = S;
};

// Takes no room if a feature is absent. The tag allows two of them at one address.
template <int tag>
struct Nothing {
    constexpr Nothing() = default;
    template <class... Setup>
    constexpr explicit Nothing(const Setup&...) {}
};

}  // namespace detail

// A member that exists only if a scene needs it. The tag distinguishes it from others of its class.
template <bool present, class T, int tag>
using If = std::conditional_t<present, T, detail::Nothing<tag>>;

}  // namespace tumble
