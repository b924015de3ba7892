// Shared by the tests of contacts: their cases, random directions, the conserved quantities of impacts, and the impulse
// formula in long double.
#pragma once

#include "random.hpp"
#include "references.hpp"
#include "tolerances.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tumble::test {

inline constexpr Number g = 9.8125L;  // m/s^2, exact in binary
inline constexpr RealVec3 gravity{0, -9.8125, 0};
inline constexpr int second = 256;  // steps, if a scene does not say otherwise

// Without gravity.
[[nodiscard]] inline SceneSetup space(Number restitution, Number friction = 0, std::vector<BodySpec> bodies = {}) {
    return {.name = "space",
            .world = {.contact = {.restitution = real(restitution), .friction = real(friction)}},
            .bodies = std::move(bodies)};
}
// A floor under gravity.
[[nodiscard]] inline SceneSetup floor(Number restitution, Number friction = 0, std::vector<BodySpec> bodies = {}) {
    SceneSetup setup = space(restitution, friction, std::move(bodies));
    setup.world.gravity = gravity;
    setup.planes = {{}};
    return setup;
}
// One on which bodies fall asleep: below 0.03 m/s and 0.05 rad/s for 0.5 s.
[[nodiscard]] inline SceneSetup sleepy_floor(Number friction = 0.5L, std::vector<BodySpec> bodies = {}) {
    SceneSetup setup = floor(0, friction, std::move(bodies));
    setup.world.contact.sleep.on = true;
    return setup;
}

// The default method and one with stages within a step, in a number system of each kind.
[[nodiscard]] inline std::vector<Case> contact_cases(std::string_view fixed_point = "q32_near") {
    std::vector<Case> cases;
    for (const char* method : {"verlet", "rk4"})
        for (const Case& c : cases_of(method))
            if (c.system.name == fixed_point || std::string_view{c.system.name} == "f32" ||
                std::string_view{c.system.name} == "f64")
                cases.push_back(c);
    return cases;
}

// A random direction.
[[nodiscard]] inline Vector direction(Random& random) {
    for (;;) {
        const Vector v{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        if (norm(v) > 0.1L && norm(v) < 1) return v * (1 / norm(v));
    }
}
// The axes of a scene: those of the world, or rotated and mirrored at random.
class Axes3 {
public:
    Axes3() = default;
    explicit Axes3(Random& random)
        : turn_{exponential(direction(random) * random.uniform(-3, 3))}, mirrored_{random.between(0, 1) == 1} {}
    [[nodiscard]] Vector to_world(Vector v) const { return turn_.rotate({mirrored_ ? -v.x : v.x, v.y, v.z}); }
    [[nodiscard]] Vector from_world(Vector v) const {
        const Vector back = turn_.rotate_back(v);
        return {mirrored_ ? -back.x : back.x, back.y, back.z};
    }
    // That of a body which is its own mirror image.
    [[nodiscard]] Rotation turn() const { return turn_; }
    [[nodiscard]] PlaneSpec plane(Vector normal, Number offset = 0) const {
        return {.normal = real(to_world(normal)), .offset = real(offset)};
    }

private:
    Rotation turn_{};
    bool mirrored_ = false;
};
[[nodiscard]] inline Axes3 random_axes(Random& random) { return random.between(0, 2) == 0 ? Axes3{} : Axes3{random}; }
// Rounded to this number of decimals, as in scene files.
[[nodiscard]] inline Number decimal(Number value, int digits) {
    const Number unit = std::pow(Number(10), static_cast<Number>(-digits));
    return std::round(value / unit) * unit;
}

[[nodiscard]] inline Vector world_spin(const Motion& m) { return m.q.normalized().rotate(m.w); }

// Sums over the free bodies.
struct Sums {
    Vector linear{}, angular{};  // N s; N m s about the origin
    Number energy = 0;           // J, kinetic
};
[[nodiscard]] inline Sums sums_of(const AnyWorld& world, const std::vector<BodySpec>& bodies) {
    Sums sums;
    for (int b = 0; b < world.body_count(); ++b) {
        const BodySpec& body = bodies[static_cast<std::size_t>(b)];
        if (body.fixed) continue;
        const Motion m = world.motion(b);
        const Vector p = m.v * number(body.mass), moments = moments_of(body);
        sums.linear = sums.linear + p;
        sums.angular = sums.angular + cross(m.x, p) + angular_momentum(m, moments);
        sums.energy += dot(p, m.v) / 2 + spin_energy(m, moments);
    }
    return sums;
}

// A body at the point of an impact: `arm` is that point from the centre of mass, in world axes.
struct Struck {
    Motion motion;
    const BodySpec& body;
    Vector arm;

    [[nodiscard]] Vector velocity() const { return motion.v + cross(motion.q.rotate(motion.w), arm); }
    // The change of velocity along d at the point by a unit impulse along d.
    [[nodiscard]] Number response(Vector d) const {
        if (body.fixed) return 0;
        const Vector turning = motion.q.rotate_back(cross(arm, d));
        return 1 / number(body.mass) + dot(turning, over(turning, moments_of(body)));
    }
    void push(Vector impulse) {
        if (body.fixed) return;
        motion.v = motion.v + impulse * (1 / number(body.mass));
        motion.w = motion.w + over(motion.q.rotate_back(cross(arm, impulse)), moments_of(body));
    }
};
// The impulse formula, J = -(1 + e) v_n / (sum of responses), with Coulomb's law: the impulse that stops the slip, or
// mu J against it. n points from b to a. With friction it is exact if an impulse along n causes no slip, as on spheres.
// Returns whether the bodies stick.
inline bool collide(Struck& a, Struck& b, Vector n, Number restitution, Number friction) {
    const auto response = [&](Vector d) { return a.response(d) + b.response(d); };
    const Vector v = a.velocity() - b.velocity();
    const Number approach = dot(v, n), pushed = -(1 + restitution) * approach / response(n);
    const Vector slip = v - n * approach;
    Vector impulse = n * pushed;
    bool sticks = true;
    if (friction > 0 && norm(slip) > 0) {
        const Vector along = slip * (1 / norm(slip));
        const Number stop = norm(slip) / response(along);
        sticks = stop <= friction * pushed;
        impulse = impulse - along * (sticks ? stop : friction * pushed);
    }
    a.push(impulse);
    b.push(-impulse);
    return sticks;
}

// The largest distance of a body from where it was put, m.
[[nodiscard]] inline Number farthest_from_start(const AnyWorld& world, const SceneSetup& setup) {
    Number largest = 0;
    for (int b = 0; b < world.body_count(); ++b)
        largest =
            std::max(largest, norm(world.motion(b).x - vector(setup.bodies[static_cast<std::size_t>(b)].position)));
    return largest;
}

// Directions that are not axes of the world, and one that is.
inline const Vector normals[] = {{0, 1, 0}, {-1, 0, 0}, {0.6L, 0, -0.8L}, {2 / 7.0L, -3 / 7.0L, 6 / 7.0L}};

// A plane through the origin, without gravity.
[[nodiscard]] inline SceneSetup plane(Vector n, Number restitution, std::vector<BodySpec> bodies) {
    SceneSetup setup = space(restitution, 0, std::move(bodies));
    setup.planes = {{.normal = real(n)}};
    return setup;
}
[[nodiscard]] inline BodySpec standing(const BodySpec& body, Number x, Number height, Vector velocity = {},
                                       Vector spin = {}) {
    return placed(body, {x, height, 0}, velocity, spin);
}
// With the rounding of impulses, relative to a speed of a few metres per second.
class ImpactCases : public CaseTest {
protected:
    static Bound rounding() { return tolerance::contact_impulse.of(system()); }
};

// Steps until an impulse has changed the body's velocity; for scenes without loads.
[[nodiscard]] inline bool step_to_impact(AnyWorld& world, int body, int most = 1024) {
    const Vector before = world.motion(body).v;
    for (int step = 0; step < most; ++step) {
        world.step();
        if (norm(world.motion(body).v - before) > 1e-3L) return true;
    }
    return false;
}

}  // namespace tumble::test
