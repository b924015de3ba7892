// What is set up once, in SI units and the user's body axes, as set-up numbers: bodies, planes, springs, timed events
// and the world's own values. `tumble compile` writes these from a scene file.
#pragma once

#include <tumble/body/mass.hpp>

namespace tumble {

enum class Frame : std::uint8_t { world, body };

// A step or a moment, seconds; exact for fractions.
struct Seconds {
    Real value;
    constexpr Seconds(int numerator, int denominator) : value{Real{numerator} / Real{denominator}} {}
    constexpr explicit Seconds(Real seconds) : value{seconds} {}
};

// Everything about a body but its place in the world's arrays.
struct BodySpec {
    Shape shape{};
    Real mass = 1;                // kg
    InertiaTensor inertia{};      // kg m^2, about the centre of mass, user's axes
    RealVec3 position{};          // m, world
    RealVec3 velocity{};          // m/s, world
    RealQuat orientation{};       // user's body axes to world; normalised when added
    RealVec3 angular_velocity{};  // rad/s, user's body axes
    Real restitution = -1;        // negative: the world's default
    Real friction = -1;
    bool fixed = false;  // its place never changes; it may turn
};

struct PlaneSpec {
    RealVec3 normal{0, 1, 0};  // normalised when added; the free side is where normal . x + offset > 0
    Real offset = 0;           // m
    Real restitution = -1;     // negative: the world's default
    Real friction = -1;
};

// F = -k (length - rest_length) - c (rate of length), between a point of `body` and a world point or another body's.
struct SpringSpec {
    int body = 0;
    RealVec3 point{};                                  // m, user's body axes, from the centre of mass
    int to_body = -1;                                  // -1: `to` is a world point
    RealVec3 to{};                                     // m, world; or to_body's axes
    Real stiffness = 0, damping = 0, rest_length = 0;  // N/m, N s/m, m
};

// An instantaneous change of momentum before the step that begins at `time` (rounded to the nearest step).
struct ImpulseSpec {
    Real time = 0;  // s
    int body = 0;
    Frame frame = Frame::world;
    RealVec3 impulse{};          // N s, in `frame`
    RealVec3 point{};            // m, user's body axes, from the centre of mass
    RealVec3 angular_impulse{};  // N m s, in `frame`
};

// A constant force and torque while from <= t < until (both rounded to the nearest step).
struct ForceSpec {
    int body = 0;
    Real from = 0, until = 0;  // s
    Frame frame = Frame::world;
    RealVec3 force{};   // N, in `frame`
    RealVec3 point{};   // m, user's body axes
    RealVec3 torque{};  // N m, in `frame`
};

enum class ContactResponse : std::uint8_t { none, impulse, spring };

// A group of bodies in touch falls asleep when all of them have been slower than this for so long.
struct SleepSpec {
    bool on = false;
    Real speed = 0.03, angular_speed = 0.05;  // m/s, rad/s
    Real time = 0.5;                          // s
};

struct ContactSpec {
    ContactResponse response = ContactResponse::impulse;
    Real restitution = 0.5, restitution_threshold = 0, friction = 0;
    Real tolerance = 0.001;  // m: the band in which bodies touch, and the depth at which a step is redone
    Real stiffness = 10000, damping = 0, barrier = 0;  // ContactResponse::spring: N/m, N s/m of a point; N m^2
    SleepSpec sleep{};
};

struct WorldSpec {
    RealVec3 gravity{};     // m/s^2
    Real gravitation = 0;   // m^3/(kg s^2)
    Real linear_drag = 0;   // kg/s
    Real angular_drag = 0;  // N m s
    ContactSpec contact{};
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
[[nodiscard]] constexpr BodySpec box(Real mass, RealVec3 edges) { return body_of({ShapeKind::box, edges}, mass); }
[[nodiscard]] constexpr BodySpec sphere(Real mass, Real radius) {
    return body_of({ShapeKind::sphere, {radius, 0, 0}}, mass);
}
[[nodiscard]] constexpr BodySpec cylinder(Real mass, Real radius, Real height) {
    return body_of({ShapeKind::cylinder, {radius, height, 0}}, mass);
}
[[nodiscard]] constexpr BodySpec hoop(Real mass, Real radius) {
    return body_of({ShapeKind::hoop, {radius, 0, 0}}, mass);
}
[[nodiscard]] constexpr BodySpec capsule(Real mass, Real radius, Real length) {
    return body_of({ShapeKind::capsule, {radius, length, 0}}, mass);
}

inline namespace literals {
consteval Real operator""_kg(long double v) { return Real{static_cast<double>(v)}; }
consteval Real operator""_m(long double v) { return Real{static_cast<double>(v)}; }
consteval Real operator""_kg(unsigned long long v) { return Real{static_cast<int>(v)}; }
consteval Real operator""_m(unsigned long long v) { return Real{static_cast<int>(v)}; }
}  // namespace literals

}  // namespace tumble
