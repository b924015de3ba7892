// Joints as they are added to a world. A joint ties a body to another one or to the world and leaves it some directions
// of motion: rotations about axes and translations along axes. Anchors and axes are given in the world, where the
// bodies are when the joint is added, so that every joint starts closed.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/scene.hpp>

namespace tumble {

// The range of the free direction of a hinge, rad, or of a slider, m, from where the joint is added. At its ends the
// joint is held, and is not pulled: to arrive there ends its speed, as an impact without restitution does. Both zero:
// none. Needs Features::joint_limits.
struct JointLimits {
    Real least = 0;  // not positive; of a hinge at least -2.6
    Real most = 0;   // not negative; of a hinge at most 2.6

    // True of a range.
    [[nodiscard]] constexpr bool acts() const { return !least.is_zero() || !most.is_zero(); }

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"least", "rad or m"}, of.least...);
        f(Field{"most", "rad or m"}, of.most...);
    }
};

namespace detail {

// The fields of joints of all kinds, of which each kind has some, in this order.
constexpr void each_field_of_joint(auto&& f, auto& one, auto&... more) {
    f(Field{"body", "", Field::body}, one.body, more.body...);
    f(Field{"to_body", "", Field::body}, one.to_body, more.to_body...);
    if constexpr (requires { one.anchor; }) f(Field{"anchor", "m"}, one.anchor, more.anchor...);
    if constexpr (requires { one.point; }) f(Field{"point", "m"}, one.point, more.point...);
    if constexpr (requires { one.to_point; }) f(Field{"to_point", "m"}, one.to_point, more.to_point...);
    if constexpr (requires { one.axis; }) f(Field{"axis"}, one.axis, more.axis...);
    if constexpr (requires { one.to_axis; }) f(Field{"to_axis"}, one.to_axis, more.to_axis...);
    if constexpr (requires { one.least; }) f(Field{"least", "m", Field::not_negative}, one.least, more.least...);
    if constexpr (requires { one.most; }) f(Field{"most", "m", Field::positive}, one.most, more.most...);
    if constexpr (requires { one.spring; }) f(Field{"spring"}, one.spring, more.spring...);
    if constexpr (requires { one.to_spring; }) f(Field{"to_spring"}, one.to_spring, more.to_spring...);
    if constexpr (requires { one.limits; }) f(Field{"limits"}, one.limits, more.limits...);
    f(Field{"break_force", "N", Field::positive}, one.break_force, more.break_force...);
    if constexpr (requires { one.break_torque; })
        f(Field{"break_torque", "N m", Field::positive}, one.break_torque, more.break_torque...);
}

}  // namespace detail

// A rotation about one axis: a door, an elbow, a wheel on its axle.
struct HingeSpec {
    BodyIndex body = 0;      // its id, or its number in the order of add()
    BodyIndex to_body = -1;  // the other body; -1: the world
    RealVec3 anchor{};       // m, world; a point of the axis
    RealVec3 axis{0, 0, 1};  // world, from `to_body` to `body`; of any length but zero
    JointSpring spring{};    // about the axis; needs Features::joint_springs, as all springs of joints
    JointLimits limits{};    // of the angle
    Real break_force = 0;    // N; a larger force breaks it; 0: none does; needs Features::joint_breaks
    Real break_torque = 0;   // N m; likewise

    static constexpr void each(auto&& f, auto&... of) { detail::each_field_of_joint(f, of...); }  // see Field
};
// All rotations about a point: a shoulder, a link of a chain.
struct BallSpec {
    BodyIndex body = 0;      // its id, or its number in the order of add()
    BodyIndex to_body = -1;  // the other body; -1: the world
    RealVec3 anchor{};       // m, world
    JointSpring spring{};    // against the whole turn; it rests where the joint is added
    Real break_force = 0;    // N; a larger force breaks it; 0: none does; needs Features::joint_breaks
    Real break_torque = 0;   // N m; likewise

    static constexpr void each(auto&& f, auto&... of) { detail::each_field_of_joint(f, of...); }  // see Field
};
// No motion: two bodies become one, and the force between them can be read.
struct FixedSpec {
    BodyIndex body = 0;      // its id, or its number in the order of add()
    BodyIndex to_body = -1;  // the other body; -1: the world
    RealVec3 anchor{};       // m, world; force and torque are those at this point
    Real break_force = 0;    // N; a larger force breaks it; 0: none does; needs Features::joint_breaks
    Real break_torque = 0;   // N m; likewise

    static constexpr void each(auto&& f, auto&... of) { detail::each_field_of_joint(f, of...); }  // see Field
};
// A translation along one axis, without rotation: a piston, a drawer, a telescopic leg.
struct SliderSpec {
    BodyIndex body = 0;      // its id, or its number in the order of add()
    BodyIndex to_body = -1;  // the other body; -1: the world
    RealVec3 anchor{};       // m, world; the point of `body` that stays on the axis
    RealVec3 axis{1, 0, 0};  // world; of any length but zero; travel along it is positive
    JointSpring spring{};    // along the axis
    JointLimits limits{};    // of the travel
    Real break_force = 0;    // N; a larger force breaks it; 0: none does; needs Features::joint_breaks
    Real break_torque = 0;   // N m; likewise

    static constexpr void each(auto&& f, auto&... of) { detail::each_field_of_joint(f, of...); }  // see Field
};
// Rotations about two axes that stay perpendicular, one of each body: a cardan joint.
struct UniversalSpec {
    BodyIndex body = 0;         // its id, or its number in the order of add()
    BodyIndex to_body = -1;     // the other body; -1: the world
    RealVec3 anchor{};          // m, world; the point where the axes meet
    RealVec3 axis{1, 0, 0};     // world; fixed in `body`; of any length but zero
    RealVec3 to_axis{0, 1, 0};  // world; fixed in `to_body`; perpendicular to `axis` to 2^-10 rad
    JointSpring spring{};       // about `axis`
    JointSpring to_spring{};    // about `to_axis`
    Real break_force = 0;       // N; a larger force breaks it; 0: none does; needs Features::joint_breaks
    Real break_torque = 0;      // N m; likewise

    static constexpr void each(auto&& f, auto&... of) { detail::each_field_of_joint(f, of...); }  // see Field
};
// A distance of two points within a range. A rod has least == most, a rope has least == 0: it pulls where it is taut,
// and does nothing while it is slack. Going taut ends the rate of the distance, as an impact without restitution does.
// Needs Features::distances.
struct DistanceSpec {
    BodyIndex body = 0;      // its id, or its number in the order of add()
    BodyIndex to_body = -1;  // the other body; -1: the world
    RealVec3 point{};        // m, world; of `body`
    RealVec3 to_point{};     // m, world; of `to_body`
    Real least = 0;          // m, not negative, at most `most`
    Real most = 0;           // m, positive; the points are in the range when the joint is added, to 2^-20 of it
    JointSpring spring{};    // along the line between the points
    Real break_force = 0;    // N; a larger force breaks it; 0: none does; needs Features::joint_breaks

    static constexpr void each(auto&& f, auto&... of) { detail::each_field_of_joint(f, of...); }  // see Field
};

// Why a joint cannot be added: World::fault_of(). With the last two add() returns the id of nothing. The others are
// mistakes of the program, and misuse.
enum class JointFault : std::uint8_t {
    none,                    // it can be added
    no_such_body,            // an id or a number without a body
    same_body,               // it ties a body to itself
    no_moving_body,          // both sides are fixed
    point_mass,              // a body without rotation
    zero_axis,               // an axis of length zero
    axes_not_perpendicular,  // of a universal joint
    empty_range,             // of a distance: least is negative or above most, or most is not positive
    outside_range,           // the points of a distance are nearer than least or farther than most
    bad_limits,              // they do not hold the start, 0, or are beyond 2.6 rad
    bad_strength,            // a negative break_force or break_torque
    bad_spring,              // a negative stiffness or damping, or a rest that the angle or the length never has
    too_far,                 // fixed point: an anchor, or a distance, of more than 4096 m from a centre of mass
    moving_base,             // a fixed side that moves by itself: a kinematic body, or a turntable
    in_a_layer,              // it has a shape in a layer, or a load couples it to such a body: it would touch others
    closes_loop,             // a chain of joints ties the two sides already, two bodies perhaps by another joint
    no_room,                 // Features::joints are there already
};

// The name of a fault: closes_loop.
[[nodiscard]] constexpr const char* name_of(JointFault fault) {
    switch (fault) {
    case JointFault::none: return "none";
    case JointFault::no_such_body: return "no_such_body";
    case JointFault::same_body: return "same_body";
    case JointFault::no_moving_body: return "no_moving_body";
    case JointFault::point_mass: return "point_mass";
    case JointFault::zero_axis: return "zero_axis";
    case JointFault::axes_not_perpendicular: return "axes_not_perpendicular";
    case JointFault::empty_range: return "empty_range";
    case JointFault::outside_range: return "outside_range";
    case JointFault::bad_limits: return "bad_limits";
    case JointFault::bad_strength: return "bad_strength";
    case JointFault::bad_spring: return "bad_spring";
    case JointFault::too_far: return "too_far";
    case JointFault::moving_base: return "moving_base";
    case JointFault::in_a_layer: return "in_a_layer";
    case JointFault::closes_loop: return "closes_loop";
    default: return "no_room";
    }
}
// True where add() returns the id of nothing in place of ending the program.
[[nodiscard]] constexpr bool is_refused(JointFault fault) {
    return fault == JointFault::closes_loop || fault == JointFault::no_room;
}

namespace detail {

// A step of a tree is flown in up to 2^most_joint_halvings parts of h, in which h^2 f r / I is at most
// 2^joint_load_log2: joints/hold.hpp. The host warns of what needs more.
inline constexpr int most_joint_halvings = 5, joint_load_log2 = -2;

[[nodiscard]] constexpr JointLimits limits_of([[maybe_unused]] const auto& spec) {
    if constexpr (requires { spec.limits; }) return spec.limits;
    else return {};
}
// What is wrong with the limits of a joint; `turns`: of an angle.
TUMBLE_COLD [[nodiscard]] constexpr JointFault fault_of_limits(const auto& spec, bool turns) {
    const JointLimits limits = limits_of(spec);
    const Real most_angle = Real{2.6};
    if (limits.least > Real{} || limits.most < Real{}) return JointFault::bad_limits;
    if (turns && (limits.most > most_angle || -limits.least > most_angle)) return JointFault::bad_limits;
    return JointFault::none;
}
// N and N m: what a joint bears; 0: anything.
[[nodiscard]] constexpr Real break_force_of(const auto& spec) { return spec.break_force; }
[[nodiscard]] constexpr Real break_torque_of([[maybe_unused]] const auto& spec) {
    if constexpr (requires { spec.break_torque; }) return spec.break_torque;
    else return {};
}
// The first and the second spring of a joint, as far as its kind has them.
[[nodiscard]] constexpr JointSpring spring_of(const auto& spec, int i) {
    if constexpr (requires { spec.to_spring; }) return i == 0 ? spec.spring : spec.to_spring;
    else if constexpr (requires { spec.spring; }) return i == 0 ? spec.spring : JointSpring{};
    else return {};
}
// What is wrong with the springs of a joint. `turns`: about axes, of which the angle is in (-pi, pi].
TUMBLE_COLD [[nodiscard]] constexpr JointFault fault_of_springs(const auto& spec, int turns) {
    const Real half_turn = Real::scaled(0x3243f6a8885a308d, -60);
    for (int i = 0; i < 2; ++i) {
        const JointSpring spring = spring_of(spec, i);
        if (spring.stiffness.is_negative() || spring.damping.is_negative()) return JointFault::bad_spring;
        if (turns > 0 && abs(spring.rest) > half_turn) return JointFault::bad_spring;
        if (turns == 3 && !spring.rest.is_zero()) return JointFault::bad_spring;
        if constexpr (requires { spec.most; })
            if (spring.rest.is_negative()) return JointFault::bad_spring;
    }
    return JointFault::none;
}
// The point of a side at which a joint holds it, m, world.
[[nodiscard]] constexpr const RealVec3& anchor_of(const auto& spec, [[maybe_unused]] int side) {
    if constexpr (requires { spec.to_point; }) return side == 0 ? spec.point : spec.to_point;
    else return spec.anchor;
}
// The axes of a joint in the world, of unit length and perpendicular: two on the side of each body.
struct JointAxes {
    RealVec3 of_body[2]{}, of_other[2]{};
};

// A unit vector across a unit vector and across the axis of the world that is least along it.
TUMBLE_COLD [[nodiscard]] constexpr RealVec3 perpendicular_to(const RealVec3& axis) {
    int least = 0;
    for (int i = 1; i < 3; ++i)
        if (abs(axis[i]) < abs(axis[least])) least = i;
    const int j = (least + 1) % 3, k = (least + 2) % 3;
    RealVec3 across;
    across[j] = axis[k];
    across[k] = -axis[j];
    return normalized(across);
}
// The axis and one across it, alike on both sides.
TUMBLE_COLD [[nodiscard]] constexpr JointAxes axes_about(const RealVec3& axis) {
    JointAxes axes;
    axes.of_body[0] = axes.of_other[0] = normalized(axis);
    axes.of_body[1] = axes.of_other[1] = perpendicular_to(axes.of_body[0]);
    return axes;
}

}  // namespace detail

}  // namespace tumble
