// The equations of motion of bodies that joints tie, in long double and in the coordinates that the joints leave free:
// there is no constraint and no gap. A joint is the rotation and the travel of a body against its parent, with a speed
// for each free direction. Rotations are quaternions, so no pose is singular. A tree that ties to nothing of the world
// hangs on it by all six directions. A rod has all of them too, and the travel keeps its length.
// The accelerations follow from the forces on the bodies by the articulated-body algorithm (Featherstone, Rigid Body
// Dynamics Algorithms, 2008, chapter 7), one free direction after the other. Springs and dampers of joints are
// generalized forces along the free directions. It shares no code with the kernel.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "scene/description.hpp"
#include "truth/motion.hpp"
#include "truth/tensor.hpp"

namespace tumble::host {

// The first joint of which the equations of motion are not known here: one that keeps a distance in a range, has
// limits or may break. JointTrees lets such a distance go and takes no notice of the others. Null: there is none.
[[nodiscard]] const JointDescription* without_equations(const std::vector<JointDescription>& joints);

// About and along which a joint lets its sides move where it is added: unit vectors of the world, of each kind
// perpendicular to each other.
struct FreeAxes {
    std::vector<reference::Vector> turns, slides;
};
[[nodiscard]] FreeAxes free_axes(const JointDescription& joint);

class JointTrees {
public:
    struct Body {
        reference::Number mass = 0;  // kg
        reference::Tensor inertia;   // kg m^2, user's axes
        bool fixed = false;          // it moves as its motion says, whatever pushes it
    };
    using Motions = std::vector<reference::Motion>;  // of all bodies

    // Of each joint where it is, in world axes.
    struct Link {
        reference::Vector reach;                             // m, from the parent's centre of mass to the body's
        std::vector<std::array<reference::Number, 6>> free;  // velocities against the parent at unit speeds
        reference::Vector rod;                               // its unit vector; zero: it is none
    };
    using Links = std::vector<Link>;

    JointTrees() = default;
    // Joints are closed at the start. Throws std::invalid_argument where joints close a loop.
    JointTrees(std::vector<Body> bodies, const std::vector<JointDescription>& joints, const Motions& start);

    // Does a joint tie this body? False of fixed bodies.
    [[nodiscard]] bool has(std::size_t body) const { return node_of_[body] >= 0; }

    // The state: of each joint the rotation from the start (a quaternion) and the travel (m), both in the parent's
    // axes; then the speeds along all free directions, rad/s and m/s.
    [[nodiscard]] std::vector<reference::Number> start() const;
    // Sets the speeds from the velocities of the bodies. What the joints do not allow ends as in an impact without
    // restitution: the momentum along the free directions is kept.
    void end_velocities_across(std::span<reference::Number> state, const Motions& motions) const;
    // The kinetic energy that so ends at the start, J.
    [[nodiscard]] reference::Number energy_across(const Motions& motions) const;
    // Sets the motions of jointed bodies.
    Links place(std::span<const reference::Number> state, Motions& motions) const;
    // The rate of the state under the loads on all bodies. Links and motions are those of place().
    void rate(std::span<const reference::Number> state, const Links& links, const Motions& motions,
              const std::vector<reference::Wrench>& loads, std::span<reference::Number> rates) const;
    // Makes unit quaternions of all rotations.
    void normalize(std::span<reference::Number> state) const;

private:
    using Number = reference::Number;
    using Vector = reference::Vector;
    using Motion = reference::Motion;
    using Rotation = reference::Rotation;
    using Six = std::array<Number, 6>;  // linear, then angular, about a body's centre of mass, in world axes
    using Matrix = std::array<Six, 6>;

    struct Direction {
        bool turns = false;           // a rotation; else a translation
        Vector axis;                  // unit, in the parent's axes at the start
        bool is_kept_by_own = false;  // it turns with the body; else with the parent
    };
    struct Node {
        std::size_t body = 0;
        int parent = -1;            // a body; -1: the world
        Vector arm_of_parent, arm;  // m, from the centre of mass to the anchor, in the axes of each
        Rotation rest;              // of the body in the parent's axes, at the start
        Vector first_travel;        // m, in the parent's axes: from its anchor to the body's at the start
        bool is_rod = false;
        std::vector<Direction> free;
        std::size_t first_speed = 0;
        std::vector<JointSpringDescription> springs;  // of each free direction; empty: there is none
        bool is_reversed = false;                     // the parent is the joint's `body`
    };
    static constexpr std::size_t numbers_of_place = 7;
    struct Place {
        Rotation turned;
        Vector travel;
    };

    void add(std::size_t body, int parent, const JointDescription* joint, const Motions& start);
    [[nodiscard]] static Motion motion_of(int body, const Motions& motions);
    [[nodiscard]] Place place_of(std::size_t node, std::span<const Number> state) const;
    [[nodiscard]] std::span<const Number> speeds_of(std::span<const Number> state) const;
    [[nodiscard]] static Vector axis_of(const Direction& direction, const Place& at);
    // The directions that a solution eliminates, as `free`: of a rod two slides across it, and the turns.
    [[nodiscard]] static std::vector<Six> ways_of(const Link& link);
    [[nodiscard]] Links links_of(std::span<const Number> state, const Motions& motions) const;
    [[nodiscard]] Six bias_of(std::size_t node, std::span<const Number> state, const Link& link,
                              const Motions& motions) const;
    // m/s, in the parent's axes: how fast the travel changes.
    [[nodiscard]] Vector sliding_of(const Node& node, std::span<const Number> state) const;
    // Adds a change of that to the speeds, or to their rates.
    static void add_slide(const Node& node, const Vector& slide, std::span<Number> speeds);
    // m/s^2, along a rod, of a body that goes round its other end.
    [[nodiscard]] static Number inward(const Node& node, const Vector& sliding);
    [[nodiscard]] Matrix inertia_of(std::size_t body, const Motions& motions) const;
    // The angle or the travel along each free direction since the start; of three rotations the vector of the turn.
    [[nodiscard]] static std::array<Number, 3> coordinates_of(const Node& node, const Place& at);
    // The forces of springs and dampers along all free directions, N m or N.
    [[nodiscard]] std::vector<Number> spring_forces(std::span<const Number> state) const;
    // The rates along all free directions that the forces give, by node, where the bases move at the rates `base` and
    // `bias` adds to what a body has of its parent.
    // `pushes`: further forces along the free directions.
    void solve(const Motions& motions, const Links& links, const std::vector<Six>& forces, const std::vector<Six>& bias,
               const std::vector<Six>& base, const std::vector<Number>& pushes, std::span<Number> along) const;

    std::vector<Body> bodies_;
    std::vector<Node> nodes_;   // a parent before its children
    std::vector<int> node_of_;  // by body; -1: none
    std::size_t speeds_ = 0;
};

}  // namespace tumble::host
