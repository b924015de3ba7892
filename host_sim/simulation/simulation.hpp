// A scene being replayed on the host, whatever its integrator and number system: the one interface of the command, the
// tests and the benchmarks. Everything that it reports is in SI units and the user's body axes.
#pragma once

#include <tumble/body/state.hpp>
#include <tumble/integrators/stability.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/description.hpp"

namespace tumble::host {

// The state of one body with all the digits that the run carries.
struct BodySnapshot {
    std::array<long double, 3> position{};          // m, world
    std::array<long double, 3> velocity{};          // m/s, world
    std::array<long double, 4> orientation{};       // w, x, y, z; user's body axes to world
    std::array<long double, 3> angular_velocity{};  // rad/s, user's body axes
    bool asleep = false;
    int contacts = 0;  // contact points in the last step
    int parts = 1;     // of a step, in which it rotates: 1 unless it turns too far for the method
};

// What an inertial sensor at the centre of mass measured in the last step: World::imu().
struct ImuSnapshot {
    std::array<double, 3> specific_force{};    // m/s^2, user's body axes
    std::array<double, 3> angular_velocity{};  // rad/s, user's body axes
};

// What two bodies, or a body and a plane, did to each other in the last step: World::contacts(), on the first body.
struct ContactSnapshot {
    int body = 0;    // not a fixed one
    int other = -1;  // a body; -1: the partner is a plane
    int plane = -1;
    bool touches = false, began = false, ended = false;
    double hit_speed = 0;                      // m/s; 0: no impact
    std::array<double, 3> normal{};            // from the partner to the body, world
    double depth = 0;                          // m
    std::array<double, 3> point{};             // m, world: centre of pressure
    double normal_impulse = 0;                 // N s
    std::array<double, 3> friction_impulse{};  // N s, on the body, world
};

// How a joint stands and moves, and what it carries: World::joint(). What its kind has not is none, and a joint that
// holds nothing has nothing.
struct JointSnapshot {
    std::optional<double> angle{}, speed{};          // rad, rad/s: hinge; universal, about the axis of `body`
    std::optional<double> to_angle{}, to_speed{};    // rad, rad/s: universal, about the axis of `to_body`
    std::optional<double> travel{}, travel_speed{};  // m, m/s: slider; distance, whose travel is its length
    std::array<double, 3> force{}, torque{};         // N, N m, world axes, on `body`, about the anchor
    std::optional<int> at_limit{};  // of a joint with a range: 1 where it is held at its most, -1 at its least, else 0
    bool broken = false;            // it broke or was removed, and holds nothing
    int corrections = 0;            // of its tree in the last step
    std::optional<double> gap{};   // m, between the anchors of both sides, as their bodies stand; of a distance what is
                                   // beyond its range
    std::optional<double> lean{};  // rad, between their orientations, less the free rotations
};

// J. The potential is that of gravity, springs, mutual gravitation, the gravity gradient and, as far as
// world_simulation.hpp tells, of contacts by springs; fixed bodies have none of gravity's, and no kinetic energy.
struct Energy {
    long double kinetic = 0;  // translation and rotation
    long double potential = 0;
    long double given = 0;  // what changes of gravity have added to the potential so far, at the places of that moment
    [[nodiscard]] long double total() const { return kinetic + potential; }
};

// A number of a body's state and the most of it that is held, of each component.
struct HeldNumber {
    std::string name;  // position, velocity, angular velocity, ...
    double most = 0;
    std::string unit;
    bool is_declared = false;  // the limit is the scene's [range], which floating point does not have itself
    double or_spin = 0;        // rad/s; change of velocity in a step: the change of a spin may exceed this instead
};

// The first occurrence of something that went wrong.
struct Trouble {
    std::string issue;                   // the name of a sticky status bit
    int body = 0;                        // below 0: none, as of gravity
    std::int64_t step = 0;               // the step that met it, from 0
    std::optional<HeldNumber> number{};  // of range_left: the number that left; none: one is not finite. Of
                                         // step_bound_hit: what a jointed body exceeded before the step; none: nothing
};

// A state of one simulation to go back to.
class Snapshot {
public:
    virtual ~Snapshot() = default;
};

class Simulation {
public:
    virtual ~Simulation() = default;

    // Takes one step.
    virtual void step() = 0;
    // Applies an event before the next step; its time has no meaning.
    virtual void apply(const EventDescription& event) = 0;
    // restore() takes a snapshot of the same simulation; bits go on as they did after it.
    [[nodiscard]] virtual std::unique_ptr<Snapshot> snapshot() const = 0;
    virtual void restore(const Snapshot& snapshot) = 0;

    [[nodiscard]] virtual std::int64_t steps_taken() const = 0;
    [[nodiscard]] virtual std::uint64_t hash() const = 0;
    [[nodiscard]] virtual int body_count() const = 0;
    [[nodiscard]] virtual BodySnapshot body(int index) const = 0;
    [[nodiscard]] virtual ImuSnapshot imu(int index) const = 0;
    // Each contact once; contacts by springs are not among them.
    [[nodiscard]] virtual std::vector<ContactSnapshot> contacts() const = 0;
    // Of the scene's joints, in their order.
    [[nodiscard]] virtual JointSnapshot joint(int index) const = 0;
    [[nodiscard]] virtual Energy energy() const = 0;

    // The troubles that set status bits, in order of first occurrence; empty: none.
    [[nodiscard]] virtual const std::vector<Trouble>& troubles() const = 0;

    // The largest step at which contacts by springs gain no energy, s. 0: none of them limits the step.
    [[nodiscard]] virtual long double largest_safe_step() const = 0;

    // The tolerance of contacts by impulses, m. It is larger than the scene's if the number system does not resolve the
    // scene's.
    [[nodiscard]] virtual long double contact_tolerance() const = 0;

    // Whether the last step moved a body in bounded time, and the deepest overlap of such bodies, m.
    [[nodiscard]] virtual bool stepped_bounded(int body) const = 0;
    [[nodiscard]] virtual double deepest_overlap() const = 0;

    // The most pairs, of a body and a plane or of two bodies, that have been near each other at one time.
    [[nodiscard]] virtual int most_near_pairs() const = 0;

    // The largest spin about any axis of a body that the number system holds at this step, rad/s: the least over its
    // axes. Infinite in floating point, and for a body that does not rotate.
    [[nodiscard]] virtual double held_spin(int body) const = 0;

    // All words of all bodies' states, in the order of a record; and the body and number that a word belongs to.
    virtual void append_words(std::vector<std::uint32_t>& words) const = 0;
    struct Place {
        int body;
        std::string number;        // for example "d_w.y"
        std::size_t first, count;  // its words in the record, the lowest first
    };
    [[nodiscard]] virtual Place place_of_word(std::size_t index) const = 0;

    [[nodiscard]] virtual std::string_view integrator() const = 0;
    [[nodiscard]] virtual std::string_view numbers() const = 0;  // q32, f32 or f64
    [[nodiscard]] virtual std::string_view range() const = 0;    // near, room, field; empty for floating point
    [[nodiscard]] virtual bool carry() const = 0;

    [[nodiscard]] std::int64_t steps() const { return steps_; }             // of the whole run
    [[nodiscard]] long double step_length() const { return step_length_; }  // s
    [[nodiscard]] long double time() const { return static_cast<long double>(steps_taken()) * step_length_; }
    [[nodiscard]] bool has_trouble(std::string_view issue) const;

protected:
    Simulation(std::int64_t steps, long double step_length) : steps_{steps}, step_length_{step_length} {}

private:
    std::int64_t steps_;
    long double step_length_;
};

// `carry` empty: on for q32 and f32, off for f64. Throws std::invalid_argument for an unknown integrator or number
// system and for an integrator that does not run in it, UnsupportedScene for a scene that cannot be replayed.
[[nodiscard]] std::unique_ptr<Simulation> make_simulation(const SceneDescription& scene,
                                                          std::string_view integrator = "verlet",
                                                          std::string_view numbers = "q32",
                                                          std::optional<bool> carry = {});

// Are the worlds of such a run compiled? Where they are not, make_simulation() compiles them first: about half a
// minute.
[[nodiscard]] bool is_compiled(const SceneDescription& scene, std::string_view integrator, std::string_view numbers,
                               std::optional<bool> carry);

// Takes the steps that are left, until something goes wrong; returns the hash.
std::uint64_t finish(Simulation& simulation);

// What can be chosen.
struct IntegratorInfo {
    std::string name;
    std::string type;                // in C++, for example tumble::integrators::Rk4
    int order = 0, free_order = 0;   // with loads, and of torque-free rotation; no_truncation: exact
    std::string needs;               // of sqrt, division and trigonometry, beyond what loads and contacts need
    std::string not_in_fixed_point;  // why not; empty where it runs in every number system
    // Of the linear oscillator: Stability of integrators/stability.hpp.
    double oscillation_limit = 0, drag_limit = 0;
    OscillatorStep (*oscillator_step)(double k, double c) = nullptr;
    Spin spin = Spin::none;  // what it keeps of a spin
    bool is_usual = false;   // its worlds are in the first module of every number system
};
struct NumberSystemInfo {
    std::string name;
    std::string what;   // the numbers with which it computes
    std::string type;   // in C++
    std::string range;  // near, room, field or empty
    bool carry = false;
    bool fixed_point = false;
};
[[nodiscard]] const std::vector<IntegratorInfo>& integrators();
[[nodiscard]] const std::vector<NumberSystemInfo>& number_systems();
// Does this number system carry residuals where a run does not say? Throws std::invalid_argument for an unknown one.
[[nodiscard]] bool default_carry(std::string_view numbers);
[[nodiscard]] const IntegratorInfo& find_integrator(std::string_view name);  // throws std::invalid_argument
// Is the integrator there in the number system (q32, f32 or f64)? Where it is not, require_runs_in throws
// std::invalid_argument that says why and what to choose.
[[nodiscard]] bool runs_in(const IntegratorInfo& integrator, std::string_view numbers);
void require_runs_in(const IntegratorInfo& integrator, std::string_view numbers);
// False in fixed point where the file declares no [range] and the scene exceeds the default one. Then require_range
// throws the reader's SceneError.
[[nodiscard]] bool has_range_for(const SceneDescription& scene, std::string_view numbers);
void require_range(const SceneDescription& scene, std::string_view numbers);
// The numbers of a range of fixed point: near, room or field.
[[nodiscard]] RangeDescription held_by(std::string_view range);
[[nodiscard]] const NumberSystemInfo& find_number_system(const SceneDescription& scene, std::string_view numbers,
                                                         std::optional<bool> carry);

// Warnings: a sentence for each part of the scene that is not simulated.
[[nodiscard]] std::vector<std::string> limitations(const SceneDescription& scene);

}  // namespace tumble::host
