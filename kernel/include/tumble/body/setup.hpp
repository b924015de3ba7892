// What is set up once, in SI units and the user's body axes, as set-up numbers: bodies, planes, springs, timed events
// and the world's own values. `tumble compile` writes these from a scene file.
#pragma once

#include <tumble/body/mass.hpp>

namespace tumble {

// The axes that a vector is given in: of the world, or of the body as its user set it up, turning with it.
enum class Frame : std::uint8_t { world, body };

// A step or a moment, seconds; exact for fractions.
struct Seconds {
    Real value;  // s

    // A fraction; steps of a power of two are exact in binary.
    constexpr Seconds(int numerator, int denominator) : value{Real{numerator} / Real{denominator}} {}
    // A decimal, to the nearest set-up number.
    constexpr explicit Seconds(Real seconds) : value{seconds} {}
};

// Everything about a body but its place in the world's arrays.
struct BodySpec {
    Shape shape{};                // what touches; none: nothing does
    Real mass = 1;                // kg
    InertiaTensor inertia{};      // kg m^2, about the centre of mass, user's axes; none and no shape: a point mass
    RealVec3 position{};          // m, world
    RealVec3 velocity{};          // m/s, world
    RealQuat orientation{};       // user's body axes to world; normalised when added
    RealVec3 angular_velocity{};  // rad/s, user's body axes
    Real restitution = -1;        // of impacts, 0 to 1; negative: the world's default
    Real friction = -1;           // Coulomb's coefficient; negative: the world's default
    bool fixed = false;           // its place never changes; it may turn
};

// True of a body without shape and without inertia: a point mass. It touches nothing, and has neither orientation nor
// spin; what would turn it is misuse.
[[nodiscard]] constexpr bool is_point_mass(const BodySpec& spec) {
    const InertiaTensor& i = spec.inertia;
    return spec.shape.kind == ShapeKind::none && i.xx.is_zero() && i.yy.is_zero() && i.zz.is_zero() && i.xy.is_zero() &&
           i.xz.is_zero() && i.yz.is_zero();
}

// A fixed plane that bodies touch; as it is, the ground y = 0.
struct PlaneSpec {
    RealVec3 normal{0, 1, 0};  // normalised when added; the free side is where normal . x + offset > 0
    Real offset = 0;           // m
    Real restitution = -1;     // of impacts, 0 to 1; negative: the world's default
    Real friction = -1;        // Coulomb's coefficient; negative: the world's default
};

// F = -k (length - rest_length) - c (rate of length), between a point of `body` and a world point or another body's.
struct SpringSpec {
    int body = 0;          // index, in the order of add()
    RealVec3 point{};      // m, user's body axes, from the centre of mass
    int to_body = -1;      // index; -1: `to` is a world point
    RealVec3 to{};         // m, world; or to_body's axes
    Real stiffness = 0;    // N/m
    Real damping = 0;      // N s/m
    Real rest_length = 0;  // m
};

// An instantaneous change of momentum before the step that begins at `time` (rounded to the nearest step).
struct ImpulseSpec {
    Real time = 0;               // s
    int body = 0;                // index, in the order of add()
    Frame frame = Frame::world;  // of the impulses
    RealVec3 impulse{};          // N s, in `frame`
    RealVec3 point{};            // m, user's body axes, from the centre of mass
    RealVec3 angular_impulse{};  // N m s, in `frame`
};

// A constant force and torque while from <= t < until (both rounded to the nearest step).
struct ForceSpec {
    int body = 0;                // index, in the order of add()
    Real from = 0;               // s
    Real until = 0;              // s
    Frame frame = Frame::world;  // of force and torque
    RealVec3 force{};            // N, in `frame`
    RealVec3 point{};            // m, user's body axes, from the centre of mass
    RealVec3 torque{};           // N m, in `frame`
};

// What bodies that touch do: nothing, impulses (restitution and friction), or springs.
enum class ContactResponse : std::uint8_t { none, impulse, spring };

// A group of bodies in touch falls asleep when all of them have been slower than this for so long.
struct SleepSpec {
    bool on = false;            // where Features::sleep is compiled in
    Real speed = 0.03;          // m/s
    Real angular_speed = 0.05;  // rad/s
    Real time = 0.5;            // s
};

// How bodies touch planes and each other.
struct ContactSpec {
    ContactResponse response = ContactResponse::impulse;  // compiled in by Features
    Real restitution = 0.5;          // of impacts, 0 to 1, where a body or plane has none of its own
    Real restitution_threshold = 0;  // m/s: slower impacts do not bounce
    Real friction = 0;               // Coulomb's coefficient, where a body or plane has none of its own
    Real tolerance = 0.001;          // m: the band in which bodies touch, and the depth at which a step is redone
    Real stiffness = 10000;          // N/m of a point; ContactResponse::spring
    Real damping = 0;                // N s/m of a point; ContactResponse::spring
    Real barrier = 0;                // N m^2: a force of barrier / gap^2; ContactResponse::spring
    SleepSpec sleep{};               // of what rests
};

// True of a restitution that a body or plane may have; a negative one stands for the world's.
[[nodiscard]] constexpr bool is_restitution(Real e) { return e <= Real{1}; }
// True of values that contacts can have: none negative, restitution at most 1, the tolerance not 0.
[[nodiscard]] constexpr bool is_valid(const ContactSpec& spec) {
    const Real least[] = {
        spec.restitution, spec.restitution_threshold, spec.friction,  spec.stiffness, spec.damping, spec.barrier,
        spec.sleep.speed, spec.sleep.angular_speed,   spec.sleep.time};
    for (const Real& value : least)
        if (value.is_negative()) return false;
    return is_restitution(spec.restitution) && spec.tolerance > Real{};
}

// What acts on all bodies of a world.
struct WorldSpec {
    RealVec3 gravity{};     // m/s^2, world
    Real gravitation = 0;   // m^3/(kg s^2): attraction between all bodies
    Real linear_drag = 0;   // kg/s
    Real angular_drag = 0;  // N m s
    ContactSpec contact{};  // how bodies touch
};

// A body of the given shape and mass at the origin, at rest. Masses in kg, lengths in m.
[[nodiscard]] constexpr BodySpec body_of(Shape shape, Real mass) {
    TUMBLE_ASSERT(mass > Real{});
    BodySpec spec;
    spec.shape = shape;
    spec.mass = mass;
    spec.inertia = inertia_of(shape, mass);
    return spec;
}
// A mass without extension, in a world whose Features have point_masses.
[[nodiscard]] constexpr BodySpec point_mass(Real mass) {
    TUMBLE_ASSERT(mass > Real{});
    BodySpec spec;
    spec.mass = mass;
    return spec;
}
// A box of a mass and full edges.
[[nodiscard]] constexpr BodySpec box(Real mass, RealVec3 edges) { return body_of({ShapeKind::box, edges}, mass); }
// A solid sphere.
[[nodiscard]] constexpr BodySpec sphere(Real mass, Real radius) {
    return body_of({ShapeKind::sphere, {radius, 0, 0}}, mass);
}
// A solid cylinder along z.
[[nodiscard]] constexpr BodySpec cylinder(Real mass, Real radius, Real height) {
    return body_of({ShapeKind::cylinder, {radius, height, 0}}, mass);
}
// A thin ring about z.
[[nodiscard]] constexpr BodySpec hoop(Real mass, Real radius) {
    return body_of({ShapeKind::hoop, {radius, 0, 0}}, mass);
}
// A solid cylinder along z between two half spheres; length is that of the straight part.
[[nodiscard]] constexpr BodySpec capsule(Real mass, Real radius, Real length) {
    return body_of({ShapeKind::capsule, {radius, length, 0}}, mass);
}

inline namespace literals {
// Kilograms.
consteval Real operator""_kg(long double v) { return Real{static_cast<double>(v)}; }
// Metres.
consteval Real operator""_m(long double v) { return Real{static_cast<double>(v)}; }
// Kilograms.
consteval Real operator""_kg(unsigned long long v) { return Real{static_cast<int>(v)}; }
// Metres.
consteval Real operator""_m(unsigned long long v) { return Real{static_cast<int>(v)}; }
}  // namespace literals

}  // namespace tumble
