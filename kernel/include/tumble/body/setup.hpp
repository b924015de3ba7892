// The set-up values of a world in SI units and in the user's body axes: bodies, planes, springs, timed events, and the
// world's own values. `tumble compile` writes them from a scene file.
#pragma once

#include <tumble/body/id.hpp>
#include <tumble/body/mass.hpp>

namespace tumble {

// The axes of a vector: those of the world, or the user's body axes, which rotate with the body.
enum class Frame : std::uint8_t { world, body };

// A duration in seconds: the step, or a time.
struct Seconds {
    Real value;  // s

    // A fraction of a second. A step that is a power of two is exact in binary.
    constexpr Seconds(int numerator, int denominator) : value{Real{numerator} / Real{denominator}} {}
    // A decimal number of seconds, to the nearest set-up number.
    constexpr explicit Seconds(Real seconds) : value{seconds} {}
};

// A field of a spec: its name, its unit, and what it takes. Each spec names its fields once, in each(f, of...), which
// calls f(field, x...) for each of them in the order of the spec, with the members x of that name of the structs `of`:
// of a spec, or of others with the same members. What depends on all fields follows from it: the digest of snapshots,
// `tumble compile`, and readers and writers of scene files.
struct Field {
    // Numbers in a range; the id of a body; and any number that steps or events change, which a snapshot holds.
    enum Kind : std::uint8_t { any, positive, not_negative, zero_to_one, body, state };

    const char* name;       // of the member
    const char* unit = "";  // SI; empty: none
    Kind kind = any;        // of a value that is given, where the default is none
};

// A body as it is added to a world.
struct BodySpec {
    static constexpr std::uint16_t all_layers = 0xffff;  // BodySpec::layers of a body in every layer

    Shape shape{};                  // collides; none: collides with nothing
    Real mass = 1;                  // kg
    InertiaTensor inertia{};        // kg m^2, about the centre of mass, user's axes; zero and no shape: a point mass
    RealVec3 position{};            // m, world
    RealVec3 velocity{};            // m/s, world
    RealQuat orientation{};         // user's body axes to world; normalised when added
    RealVec3 angular_velocity{};    // rad/s, user's body axes
    Real restitution = -1;          // of impacts, 0 to 1; negative: the world's value
    Real friction = -1;             // Coulomb's coefficient; negative: the world's value
    Real rolling_resistance = -1;   // m; the moment against rolling over the normal force; negative: the world's value
    Real spinning_resistance = -1;  // m; the same about the normal
    bool fixed = false;             // its position never changes; it may rotate
    bool kinematic = false;         // moves as its velocity says and pushes what it meets, but nothing pushes it
    // A bit for each of 16 layers. Two bodies touch only where they have a layer in common. A body in no layer, 0,
    // touches nothing, planes neither. Others than all need Features::layers.
    std::uint16_t layers = all_layers;

    // True of a body that nothing pushes.
    [[nodiscard]] constexpr bool is_fixed() const { return fixed || kinematic; }

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"shape", "m"}, of.shape...);
        f(Field{"mass", "kg", Field::positive}, of.mass...);
        f(Field{"inertia", "kg m^2"}, of.inertia...);
        f(Field{"position", "m", Field::state}, of.position...);
        f(Field{"velocity", "m/s", Field::state}, of.velocity...);
        f(Field{"orientation", "", Field::state}, of.orientation...);
        f(Field{"angular_velocity", "rad/s", Field::state}, of.angular_velocity...);
        f(Field{"restitution", "", Field::zero_to_one}, of.restitution...);
        f(Field{"friction", "", Field::not_negative}, of.friction...);
        f(Field{"rolling_resistance", "m", Field::not_negative}, of.rolling_resistance...);
        f(Field{"spinning_resistance", "m", Field::not_negative}, of.spinning_resistance...);
        f(Field{"fixed"}, of.fixed...);
        f(Field{"kinematic"}, of.kinematic...);
        f(Field{"layers"}, of.layers...);
    }
};

// True of a point mass: a body without shape and inertia. It collides with nothing, and has neither orientation nor
// spin. A rotation of it is misuse.
[[nodiscard]] constexpr bool is_point_mass(const BodySpec& spec) {
    const InertiaTensor& i = spec.inertia;
    return spec.shape.kind == ShapeKind::none && i.xx.is_zero() && i.yy.is_zero() && i.zz.is_zero() && i.xy.is_zero() &&
           i.xz.is_zero() && i.yz.is_zero();
}

// The body as contacts see it: without a shape where it is in no layer.
[[nodiscard]] constexpr BodySpec as_it_touches(const BodySpec& spec) {
    BodySpec body = spec;
    if (spec.layers == 0) body.shape = {};
    return body;
}

// A fixed plane. By default the ground y = 0.
struct PlaneSpec {
    RealVec3 normal{0, 1, 0};       // normalised when added; the free side is where normal . x + offset > 0
    Real offset = 0;                // m
    Real restitution = -1;          // of impacts, 0 to 1; negative: the world's value
    Real friction = -1;             // Coulomb's coefficient; negative: the world's value
    Real rolling_resistance = -1;   // m; the moment against rolling over the normal force; negative: the world's value
    Real spinning_resistance = -1;  // m; the same about the normal

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"normal"}, of.normal...);
        f(Field{"offset", "m"}, of.offset...);
        f(Field{"restitution", "", Field::zero_to_one}, of.restitution...);
        f(Field{"friction", "", Field::not_negative}, of.friction...);
        f(Field{"rolling_resistance", "m", Field::not_negative}, of.rolling_resistance...);
        f(Field{"spinning_resistance", "m", Field::not_negative}, of.spinning_resistance...);
    }
};

// F = -k (length - rest_length) - c (rate of length), between a point of `body` and a point of the world or of another
// body.
struct SpringSpec {
    BodyIndex body = 0;      // its id, or its number in the order of add()
    RealVec3 point{};        // m, user's body axes, from the centre of mass
    BodyIndex to_body = -1;  // the other body; -1: `to` is a point of the world
    RealVec3 to{};           // m, world, or user's axes of `to_body` from its centre of mass
    Real stiffness = 0;      // N/m
    Real damping = 0;        // N s/m
    Real rest_length = 0;    // m

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"body", "", Field::body}, of.body...);
        f(Field{"point", "m"}, of.point...);
        f(Field{"to_body", "", Field::body}, of.to_body...);
        f(Field{"to", "m"}, of.to...);
        f(Field{"stiffness", "N/m", Field::not_negative}, of.stiffness...);
        f(Field{"damping", "N s/m", Field::not_negative}, of.damping...);
        f(Field{"rest_length", "m", Field::not_negative}, of.rest_length...);
    }
};

// A spring and a damper along a free direction of a joint: a torque or a force -stiffness (x - rest) - damping (rate of
// x), with the angle, the travel or the length x.
struct JointSpring {
    Real stiffness = 0;  // N m/rad about an axis, N/m along one; not negative
    Real damping = 0;    // N m s/rad, N s/m; not negative
    Real rest = 0;       // rad or m from where the joint is added, an angle within half a turn; of a distance a length

    // True where it does anything.
    [[nodiscard]] constexpr bool acts() const { return !stiffness.is_zero() || !damping.is_zero(); }

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"stiffness", "N m/rad or N/m", Field::not_negative}, of.stiffness...);
        f(Field{"damping", "N m s/rad or N s/m", Field::not_negative}, of.damping...);
        f(Field{"rest", "rad or m"}, of.rest...);
    }
};

// The response of contacts: nothing, impulses (with restitution and friction), or springs.
enum class ContactResponse : std::uint8_t { none, impulse, spring };

// How the values of the two sides of a contact make one. A side without a value uses the world's. Restitutions that mix
// by `larger` are an exception: there it is ignored if the other side has a value.
enum class Mixing : std::uint8_t { larger, smaller, mean, geometric_mean, product };

// An island falls asleep when all its bodies have been slower than these speeds for the given time.
struct SleepSpec {
    bool on = false;            // needs Features::sleep
    Real speed = 0.03;          // m/s
    Real angular_speed = 0.05;  // rad/s
    Real time = 0.5;            // s

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"on"}, of.on...);
        f(Field{"speed", "m/s", Field::positive}, of.speed...);
        f(Field{"angular_speed", "rad/s", Field::positive}, of.angular_speed...);
        f(Field{"time", "s", Field::not_negative}, of.time...);
    }
};

// Contacts of bodies with planes and with each other.
struct ContactSpec {
    ContactResponse response = ContactResponse::impulse;  // must be compiled in by Features
    Real restitution = 0.5;          // of impacts, 0 to 1; for bodies and planes without a value of their own
    Real restitution_threshold = 0;  // m/s; slower impacts do not bounce
    Real friction = 0;               // Coulomb's coefficient; for bodies and planes without a value of their own
    Real rolling_resistance = 0;     // m; the moment against rolling over the normal force; likewise
    Real spinning_resistance = 0;    // m; the same about the normal; likewise
    Mixing restitution_mixing = Mixing::larger;       // another needs Features::mixing
    Mixing friction_mixing = Mixing::geometric_mean;  // another needs Features::mixing
    Real tolerance = 0.001;  // m; the gap within which bodies touch, and the depth at which a step is redone
    Real stiffness = 10000;  // N/m for each contact point; for ContactResponse::spring
    Real damping = 0;        // N s/m for each contact point; for ContactResponse::spring
    Real barrier = 0;        // N m^2; the force is barrier / gap^2; for ContactResponse::spring
    SleepSpec sleep{};       // when resting bodies fall asleep
    // Bounds of an island's exact step; what is left over is resolved at the start of the next. 0: the usual ones. Need
    // Features::impact_bounds.
    int most_impacts = 0;   // that are resolved at their own time
    int most_searches = 0;  // flights that are redone to find them
    int most_sweeps = 0;    // over its points, for impacts and forces; each solution has one at least

    static constexpr int any = 0x7fffffff;  // however many
    static constexpr int few = -1;          // as many as steps_exactly() says; without Features::bounded_steps, any
    static constexpr int few_bodies = 2;    // of any shape
    static constexpr int few_spheres = 16;  // alone: each of their pairs has one point
    // Islands of more bodies that move step in bounded time. A bound of more than 0 needs Features::exact_steps, and a
    // bound of another number than `any` Features::bounded_steps.
    int exact_bodies = few;

    // True of an island of so many moving bodies, with such a bound.
    [[nodiscard]] static constexpr bool steps_exactly(int exact_bodies, int moving, bool all_spheres) {
        if (exact_bodies != few) return moving <= exact_bodies;
        return moving <= (all_spheres ? few_spheres : few_bodies);
    }

    // True without a choice of mixing.
    [[nodiscard]] constexpr bool mixes_as_usual() const {
        return restitution_mixing == Mixing::larger && friction_mixing == Mixing::geometric_mean;
    }
    // True where a step has bounds other than the usual ones.
    [[nodiscard]] constexpr bool has_bounds() const { return most_impacts > 0 || most_searches > 0 || most_sweeps > 0; }

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"response"}, of.response...);
        f(Field{"restitution", "", Field::zero_to_one}, of.restitution...);
        f(Field{"restitution_threshold", "m/s", Field::not_negative}, of.restitution_threshold...);
        f(Field{"friction", "", Field::not_negative}, of.friction...);
        f(Field{"rolling_resistance", "m", Field::not_negative}, of.rolling_resistance...);
        f(Field{"spinning_resistance", "m", Field::not_negative}, of.spinning_resistance...);
        f(Field{"restitution_mixing"}, of.restitution_mixing...);
        f(Field{"friction_mixing"}, of.friction_mixing...);
        f(Field{"tolerance", "m", Field::positive}, of.tolerance...);
        f(Field{"stiffness", "N/m", Field::not_negative}, of.stiffness...);
        f(Field{"damping", "N s/m", Field::not_negative}, of.damping...);
        f(Field{"barrier", "N m^2", Field::not_negative}, of.barrier...);
        f(Field{"sleep"}, of.sleep...);
        f(Field{"most_impacts"}, of.most_impacts...);
        f(Field{"most_searches"}, of.most_searches...);
        f(Field{"most_sweeps"}, of.most_sweeps...);
        f(Field{"exact_bodies"}, of.exact_bodies...);
    }
};

// True of a restitution that a body or plane may have. Negative values stand for the world's.
[[nodiscard]] constexpr bool is_restitution(Real e) { return e <= Real{1}; }
// True of values that contacts can have: none is negative, the restitution is at most 1, the tolerance is above 0.
[[nodiscard]] constexpr bool is_valid(const ContactSpec& spec) {
    const Real least[] = {spec.restitution,
                          spec.restitution_threshold,
                          spec.friction,
                          spec.rolling_resistance,
                          spec.spinning_resistance,
                          spec.stiffness,
                          spec.damping,
                          spec.barrier,
                          spec.sleep.speed,
                          spec.sleep.angular_speed,
                          spec.sleep.time};
    for (const Real& value : least)
        if (value.is_negative()) return false;
    return is_restitution(spec.restitution) && spec.tolerance > Real{} && spec.most_impacts >= 0 &&
           spec.most_searches >= 0 && spec.most_sweeps >= 0 && spec.exact_bodies >= ContactSpec::few;
}

// Values that act on all bodies of a world.
struct WorldSpec {
    RealVec3 gravity{};     // m/s^2, world
    Real gravitation = 0;   // m^3/(kg s^2); attraction between all bodies
    Real linear_drag = 0;   // kg/s
    Real angular_drag = 0;  // N m s
    ContactSpec contact{};  // contacts

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"gravity", "m/s^2", Field::state}, of.gravity...);
        f(Field{"gravitation", "m^3/(kg s^2)", Field::not_negative}, of.gravitation...);
        f(Field{"linear_drag", "kg/s", Field::not_negative}, of.linear_drag...);
        f(Field{"angular_drag", "N m s", Field::not_negative}, of.angular_drag...);
        f(Field{"contact"}, of.contact...);
    }
};

// The orientation of a body that is turned about an axis of any length but zero, by an angle, rad, right-handed; of
// unit length to rounding. Of two turns a * b, b comes first.
TUMBLE_COLD [[nodiscard]] constexpr RealQuat rotation_about(const RealVec3& axis, Real angle) {
    TUMBLE_ASSERT(!axis.is_zero());
    // The series of a part of half the angle, at most 1/8, whose next terms are below 2^-78; then doubled.
    const Real half = Real::scaled(1, -1);
    Real part = angle * half;
    int doublings = 0;
    for (; abs(part) > Real::scaled(1, -3); ++doublings) part = part * half;
    const Real square = part * part;
    Real cosine = 1, sine = 1;  // over the part
    for (int n = 12; n > 0; n -= 2) {
        cosine = Real{1} - square / Real{n * (n - 1)} * cosine;
        sine = Real{1} - square / Real{n * (n + 1)} * sine;
    }
    RealQuat q{cosine, normalized(axis) * (part * sine)};
    for (; doublings > 0; --doublings) q = q * q;
    return q;
}

// A body of the given shape and mass, at rest at the origin.
[[nodiscard]] constexpr BodySpec body_of(Shape shape, Real mass) {
    TUMBLE_ASSERT(mass > Real{});
    BodySpec spec;
    spec.shape = shape;
    spec.mass = mass;
    spec.inertia = inertia_of(shape, mass);
    return spec;
}
// A point mass, kg. For worlds whose Features have point_masses.
[[nodiscard]] constexpr BodySpec point_mass(Real mass) {
    TUMBLE_ASSERT(mass > Real{});
    BodySpec spec;
    spec.mass = mass;
    return spec;
}
// A box with its mass, kg, and its full edges, m.
[[nodiscard]] constexpr BodySpec box(Real mass, RealVec3 edges) { return body_of({ShapeKind::box, edges}, mass); }
// A solid sphere with its mass, kg, and its radius, m.
[[nodiscard]] constexpr BodySpec sphere(Real mass, Real radius) {
    return body_of({ShapeKind::sphere, {radius, 0, 0}}, mass);
}
// A solid cylinder along z with its mass, kg, its radius and its height, m.
[[nodiscard]] constexpr BodySpec cylinder(Real mass, Real radius, Real height) {
    return body_of({ShapeKind::cylinder, {radius, height, 0}}, mass);
}
// A thin ring about z with its mass, kg, and its radius, m.
[[nodiscard]] constexpr BodySpec hoop(Real mass, Real radius) {
    return body_of({ShapeKind::hoop, {radius, 0, 0}}, mass);
}
// A solid cylinder along z between two half spheres, with its mass, kg, its radius and the length of the straight part,
// m.
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
// Degrees, in radians.
consteval Real operator""_deg(long double v) {
    return Real{static_cast<double>(v)} * Real::scaled(0x3243f6a8885a308d, -60) / Real{180};
}
// Degrees, in radians.
consteval Real operator""_deg(unsigned long long v) {
    return Real{static_cast<int>(v)} * Real::scaled(0x3243f6a8885a308d, -60) / Real{180};
}
}  // namespace literals

}  // namespace tumble
