// A World of any integrator, number system and set of features behind one interface, so that a scene is written once
// and runs in all of them. States are read exactly, as long double, in the user's body axes.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/events/script.hpp>
#include <tumble/scene.hpp>
#include <tumble/status.hpp>

#include "simulation/long_double.hpp"
#include "truth/motion.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

namespace tumble::test {

using reference::Motion;
using reference::Number;
using reference::Rotation;
using reference::Vector;

inline constexpr Number pi = std::numbers::pi_v<Number>;

using host::number;
using host::rotation;
using host::vector;
[[nodiscard]] inline Real real(Number value) {
    const auto high = static_cast<double>(value);
    return Real{high} + Real{static_cast<double>(value - static_cast<Number>(high))};
}
[[nodiscard]] inline RealVec3 real(Vector v) { return {real(v.x), real(v.y), real(v.z)}; }
[[nodiscard]] inline RealQuat real(Rotation q) { return {real(q.w), real(q.v)}; }

inline constexpr Features everything = Features{.bodies = 12, .planes = 6, .springs = 3}.with_everything();
// Sets of features of minimal worlds.
inline constexpr Features nothing{};
inline constexpr Features with_drag{.drag = true};
inline constexpr Features with_spring{.springs = 1};
inline constexpr Features with_coupling{.bodies = 2, .springs = 1};
inline constexpr Features with_gravitation{.bodies = 2, .gravitation = true};
inline constexpr Features with_forces{.forces = true};
inline constexpr Features with_impulses{.impulses = true};
inline constexpr Features with_plane{.planes = 1};
inline constexpr Features with_box{.planes = 1, .boxes = true};
inline constexpr Features with_friction{.planes = 1, .boxes = true, .friction = true};
inline constexpr Features with_round_shapes{.planes = 1, .round_shapes = true, .friction = true};
inline constexpr Features with_pairs{.bodies = 2, .pairs = true};
inline constexpr Features with_few_pairs{.bodies = 3, .near_pairs = 1, .pairs = true};
inline constexpr Features with_box_pairs{.bodies = 2, .pairs = true, .boxes = true, .friction = true};
inline constexpr Features with_turntable{
    .bodies = 2, .pairs = true, .boxes = true, .friction = true, .turntables = true};
inline constexpr Features with_sleep{.planes = 1, .boxes = true, .friction = true, .sleep = true};
inline constexpr Features with_contact_springs{
    .bodies = 2, .planes = 1, .pairs = true, .contact_impulses = false, .contact_springs = true};
inline constexpr Features with_point{.rotation = false, .point_masses = true, .drag = true, .impulses = true};
inline constexpr Features with_points{.bodies = 3,
                                      .springs = 2,
                                      .rotation = false,
                                      .point_masses = true,
                                      .drag = true,
                                      .gravitation = true,
                                      .forces = true,
                                      .impulses = true};
inline constexpr Features with_points_among_bodies{
    .bodies = 4, .springs = 3, .point_masses = true, .drag = true, .forces = true, .impulses = true};
inline constexpr Features with_point_and_plane{.bodies = 2, .planes = 1, .springs = 1, .point_masses = true};

[[nodiscard]] inline BodySpec fixed(BodySpec body) {
    body.fixed = true;
    return body;
}

// A kind of world, for tests that are typed by it.
template <class N, class Method>
struct Kind {
    using Numbers = N;
    using Integrator = Method;
};

// An impulse, and a force and a torque from a time until another, which are events of a scene.
struct TimedImpulse {
    Real time = 0;
    BodyIndex body = 0;
    Frame frame = Frame::world;
    RealVec3 impulse{}, point{}, angular_impulse{};
};
struct TimedForce {
    BodyIndex body = 0;
    Real from = 0, until = 0;
    Frame frame = Frame::world;
    RealVec3 force{}, point{}, torque{};
};
[[nodiscard]] std::vector<EventSpec> events_of(const std::vector<TimedImpulse>& impulses,
                                               const std::vector<TimedForce>& forces);

// A scene: all data of a world.
struct SceneSetup {
    const char* name = "";
    Seconds step{1, 256};
    std::uint32_t start = 0;  // number of steps counted as already taken
    WorldSpec world{};
    std::vector<BodySpec> bodies{};
    std::vector<PlaneSpec> planes{};
    std::vector<SpringSpec> springs{};
    std::vector<TimedImpulse> impulses{};
    std::vector<TimedForce> forces{};
    Features needs{};  // of its minimal world: one of the sets above
};

// A tumble::Contact of a body.
struct ReadContact {
    int body = -1, plane = -1;
    bool touches = false, began = false, ended = false, hit = false;
    Number hit_speed = 0, depth = 0, normal_impulse = 0;
    Vector normal{}, point{}, impulse{}, friction_impulse{};
    std::vector<Vector> points{};
};

class AnyWorld {
public:
    virtual ~AnyWorld() = default;

    virtual bool add(const BodySpec& body) = 0;
    virtual bool add(const PlaneSpec& plane) = 0;
    virtual bool add(const SpringSpec& spring) = 0;
    virtual void set_events(const std::vector<EventSpec>& events) = 0;  // those of the steps to come
    virtual void apply(const EventSpec& event) = 0;                     // before the next step
    virtual void apply_impulse(int body, Vector impulse, Vector point = {}) = 0;
    virtual void set_gravity(Vector gravity) = 0;  // m/s^2
    virtual Status step() = 0;
    virtual void clear_status() = 0;
    // Counts this number of steps as already taken. Called before anything is added.
    virtual void start_at(std::uint32_t step) = 0;

    [[nodiscard]] virtual Motion motion(int body) const = 0;    // every bit of the state
    [[nodiscard]] virtual Motion reported(int body) const = 0;  // through the world's accessors
    [[nodiscard]] virtual Status status() const = 0;
    [[nodiscard]] virtual std::uint64_t hash() const = 0;
    [[nodiscard]] virtual int body_count() const = 0;
    [[nodiscard]] virtual int contact_count(int body) const = 0;
    [[nodiscard]] virtual std::vector<ReadContact> contacts(int body) const = 0;
    [[nodiscard]] virtual bool asleep(int body) const = 0;
    [[nodiscard]] virtual Number largest_safe_step() const = 0;  // s; without contact springs any step is

    Status run(std::int64_t steps) {
        Status last = status();
        for (std::int64_t i = 0; i < steps; ++i) last = step();
        return last;
    }
};

struct Method {
    const char* name;
    int order;
    int free_order;  // order of torque-free rotation, if it differs
    bool conserves;  // angular momentum to rounding, energy with a bounded error
    bool exact_for_spheres, keeps_the_spin_of_spheres;
    double oscillation_limit, drag_limit;  // of integrators/stability.hpp
};
[[nodiscard]] const std::vector<Method>& methods();

struct System {
    const char* name;
    bool fixed_point, carry;
    int bits;  // of a number
    std::unique_ptr<AnyWorld> (*make)(std::string_view method, Seconds step,
                                      const WorldSpec&);  // null: not in this system
    bool (*has)(std::string_view method);
};
// The number systems of this program. The quick set has fewer than number_systems.hpp lists.
[[nodiscard]] const std::vector<System>& number_systems();
[[nodiscard]] bool has_number_system(std::string_view name);
[[nodiscard]] const System& number_system(std::string_view name);

// Worlds with one set of features compiled in.
struct MinimalWorlds {
    const char* system;
    Features features;
    std::unique_ptr<AnyWorld> (*make)(std::string_view method, Seconds step, const WorldSpec&);
};
[[nodiscard]] const std::vector<MinimalWorlds>& minimal_worlds();
[[nodiscard]] bool has_minimal_worlds(std::string_view system);

// An integrator in a number system. Most tests are instantiated over these cases.
struct Case {
    Method method;
    System system;
};
[[nodiscard]] std::vector<Case> every_case();
[[nodiscard]] std::vector<Case> cases_in(std::string_view system);
[[nodiscard]] std::vector<Case> cases_of(std::string_view method);
[[nodiscard]] std::string name_of(const Case& c);
void PrintTo(const Case& c, std::ostream* out);

struct NameOf {
    std::string operator()(const testing::TestParamInfo<Case>& info) const { return name_of(info.param); }
    std::string operator()(const testing::TestParamInfo<Method>& info) const { return info.param.name; }
};

// A world with every feature.
[[nodiscard]] std::unique_ptr<AnyWorld> build(const SceneSetup& setup, std::string_view method,
                                              std::string_view system);
[[nodiscard]] inline std::unique_ptr<AnyWorld> build(const SceneSetup& setup, const Case& c) {
    return build(setup, c.method.name, c.system.name);
}
// A world with exactly setup.needs. Null for a system or a method without minimal worlds.
[[nodiscard]] std::unique_ptr<AnyWorld> build_minimal(const SceneSetup& setup, const Case& c);

}  // namespace tumble::test
