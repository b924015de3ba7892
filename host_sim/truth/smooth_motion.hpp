// The true motion of a scene between contacts. Every load and event of the scene format is integrated in long double,
// with an error far below that of any kernel method. It shares no code with the kernel except the names of shapes; its
// caller says which shapes touch each other. It leaves out contacts: clearance() tells whether the motion is still that
// of the scene. A fixed body may turn at a constant angular velocity, and a kinematic one moves. At the start and at
// every impulse the velocities across joints end.
#pragma once

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include "scene/description.hpp"
#include "truth/joint_trees.hpp"
#include "truth/motion.hpp"
#include "truth/tensor.hpp"

namespace tumble::host {

// How well a motion is integrated, and at what cost.
struct Effort {
    reference::Number most_error = reference::tolerance;  // of each step of the integration, absolute and relative
    std::int64_t most_evaluations = std::numeric_limits<std::int64_t>::max();  // of the equations of motion
};
struct EffortSpent : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class SmoothMotion {
public:
    // Do two kinds of shapes touch each other, in either order? See shapes_meet() of scene/data.hpp.
    using ShapesMeet = bool (*)(ShapeKind, ShapeKind);

    // The motion starts at time 0. Event times are rounded to the nearest step of the scene, as in the kernel.
    SmoothMotion(const SceneDescription& scene, ShapesMeet shapes_meet, const Effort& effort = {});

    // Advances to the start of a step, before its impulses; an earlier step changes nothing. Throws std::runtime_error
    // where bodies fall into each other, or where the loads are so stiff that the run would not end, and EffortSpent.
    void advance_to(std::int64_t step);

    // x and v in the world frame; w in the user's body axes, which q rotates into the world frame. Fixed bodies keep
    // their place.
    [[nodiscard]] const std::vector<reference::Motion>& bodies() const { return now_; }
    // The kinetic energy that joints end at the start, J.
    [[nodiscard]] reference::Number energy_across_joints() const { return trees_.energy_across(now_); }
    // How often the equations of motion have been evaluated, and up to which time, s.
    [[nodiscard]] std::int64_t evaluations() const { return evaluations_; }
    [[nodiscard]] reference::Number reached() const { return reached_; }

    // Can any contact occur?
    [[nodiscard]] bool can_touch() const { return !planes_.empty() || has_pairs_; }
    // The least gap of a possible contact, m: the height of a body's lowest point over a plane, or a lower bound of the
    // distance of two bodies. Negative where they overlap; very large where no contact is possible.
    [[nodiscard]] reference::Number clearance() const;
    // The overlaps and their depths, m: of a body with a plane (other: the plane), or with an earlier body of the
    // scene.
    struct Overlap {
        std::size_t body, other;
        bool with_plane;
        reference::Number depth;
    };
    [[nodiscard]] std::vector<Overlap> overlaps() const;
    // An upper bound of the speed at which the clearance shrinks, m/s.
    [[nodiscard]] reference::Number closing_speed() const;

private:
    using Tensor = reference::Tensor;
    struct Body {
        reference::Number mass = 0;                   // kg
        Tensor inertia, inverse;                      // kg m^2, user's axes; both zero of a point mass
        bool fixed = false, moves_by_itself = false;  // a fixed body with a spin or, if kinematic, a velocity
        bool is_jointed = false;                      // it moves with its tree
        int layers = 0;                               // mask; bodies without a common one do not touch each other
        ShapeKind kind = ShapeKind::none;
        reference::Vector size;  // m, as in ShapeDescription

        // With coordinates of its own.
        [[nodiscard]] bool moves() const { return (!fixed && !is_jointed) || moves_by_itself; }
        [[nodiscard]] bool touches_planes() const {
            return !fixed && layers != 0 && kind != ShapeKind::none && kind != ShapeKind::points;
        }
        // The distance of the farthest point that the spin moves, m.
        [[nodiscard]] reference::Number swept() const;
    };
    struct TimedForce {
        std::int64_t from, until;  // steps
        ForceDescription force;
    };
    struct Kick {
        std::int64_t step;
        ImpulseDescription impulse;
    };
    struct NewGravity {
        std::int64_t step;
        reference::Vector gravity;
    };
    struct Plane {
        reference::Vector normal;  // unit
        reference::Number offset;
    };
    using Wrenches = std::vector<reference::Wrench>;

    [[nodiscard]] static Body body_of(const BodyDescription& description);
    [[nodiscard]] static Tensor tensor_of(const BodyDescription& body, reference::Number mass);
    void kick(const ImpulseDescription& impulse);
    void flow(std::int64_t from, std::int64_t to);
    void add_loads(const std::vector<reference::Motion>& motions, std::int64_t step, Wrenches& sums) const;
    [[nodiscard]] reference::Number extent_of(std::size_t i, const reference::Vector& along) const;
    [[nodiscard]] bool may_touch(std::size_t i, std::size_t j) const;
    [[nodiscard]] reference::Number distance_bound(std::size_t i, std::size_t j) const;
    [[nodiscard]] reference::Number height_over(const Plane& plane, std::size_t i) const;
    void add_air_wheels_and_gradient(const std::vector<reference::Motion>& motions, Wrenches& sums) const;
    void add_spring(const SpringDescription& spring, const std::vector<reference::Motion>& motions,
                    Wrenches& sums) const;

    SceneDescription scene_;
    ShapesMeet shapes_meet_;
    reference::Number step_length_ = 0;  // s
    Effort effort_;
    std::int64_t evaluations_ = 0;
    reference::Number reached_ = 0;  // s
    std::vector<Body> bodies_;
    std::vector<Plane> planes_;          // empty where no body can touch them
    bool has_pairs_ = false;             // of bodies that may touch
    std::vector<Kick> kicks_;            // by step, then in file order
    std::vector<NewGravity> gravities_;  // likewise
    std::vector<TimedForce> forces_;
    std::vector<std::int64_t> breaks_;  // steps at which a load goes on or off or an impulse acts, ascending
    std::vector<reference::Motion> now_;
    JointTrees trees_;
    std::vector<reference::Number> joints_;  // state of the trees
    std::int64_t step_ = 0;
    std::size_t next_kick_ = 0, next_gravity_ = 0;
    reference::Vector gravity_;  // m/s^2
};

// Half the extent of a shape along a direction of unit length, m.
[[nodiscard]] reference::Number half_extent(const BodyDescription& body, const reference::Rotation& q,
                                            const reference::Vector& along);

}  // namespace tumble::host
