// The true motion of a scene between contacts: every load and event of the scene format in long double, integrated far
// below the error of any kernel method. Its formulas are written apart from the kernel's and share no code with it:
// from the kernel it has the names of shapes, and from its caller which of them touch each other. Contacts are left
// out: ask clearance() whether the motion is still the scene's. A fixed body that turns does so at a constant angular
// velocity.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "scene/description.hpp"
#include "truth/motion.hpp"

namespace tumble::host {

class SmoothMotion {
public:
    // True of two kinds of shapes that touch each other, in either order; shapes_meet() of scene/data.hpp.
    using ShapesMeet = bool (*)(ShapeKind, ShapeKind);

    // At time 0. Event times are rounded to the nearest of the scene's steps, as the kernel rounds them.
    SmoothMotion(const SceneDescription& scene, ShapesMeet shapes_meet);

    // To the start of a step, before its impulses; earlier steps leave it where it is. Throws std::runtime_error where
    // bodies fall into each other, or the loads are so stiff that a run would not end.
    void advance_to(std::int64_t step);

    // x_w and v_w in the world; w in the user's body axes, which q turns into the world. Fixed bodies stay where they
    // are.
    [[nodiscard]] const std::vector<reference::Motion>& bodies() const { return now_; }

    // Is there anything that may touch?
    [[nodiscard]] bool can_touch() const { return !planes_.empty() || has_pairs_; }
    // The least distance of what may touch, m: the height of a body's lowest point over a plane, and of two bodies no
    // more than their distance. Negative where they overlap; very large where nothing can touch.
    [[nodiscard]] reference::Number clearance() const;
    // Which of these are in each other, and how deep, m: a body in a plane (other: the plane), or in a body before it
    // in the scene.
    struct Overlap {
        std::size_t body, other;
        bool with_plane;
        reference::Number depth;
    };
    [[nodiscard]] std::vector<Overlap> overlaps() const;
    // A bound of the speed at which it shrinks, m/s.
    [[nodiscard]] reference::Number closing_speed() const;

private:
    struct Tensor {
        reference::Vector x, y, z;  // rows
        [[nodiscard]] reference::Vector operator*(const reference::Vector& v) const;
        [[nodiscard]] Tensor inverse() const;
    };
    struct Body {
        reference::Number mass = 0;         // kg
        Tensor inertia, inverse;            // kg m^2, user's axes; both zero of a point mass
        bool fixed = false, turns = false;  // turns: though fixed
        ShapeKind kind = ShapeKind::none;
        reference::Vector size;  // m, as in ShapeDescription

        [[nodiscard]] bool moves() const { return !fixed || turns; }
        [[nodiscard]] bool touches_planes() const {
            return !fixed && kind != ShapeKind::none && kind != ShapeKind::points;
        }
        // How far it reaches along a unit vector, user's axes; and the farthest point that its spin moves, m.
        [[nodiscard]] reference::Number reach(const reference::Vector& n) const;
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
    [[nodiscard]] bool may_touch(std::size_t i, std::size_t j) const;
    [[nodiscard]] reference::Number distance_bound(std::size_t i, std::size_t j) const;
    [[nodiscard]] reference::Number height_over(const Plane& plane, std::size_t i) const;
    void add_spring(const SpringDescription& spring, const std::vector<reference::Motion>& motions,
                    Wrenches& sums) const;

    SceneDescription scene_;
    ShapesMeet shapes_meet_;
    reference::Number step_length_ = 0;  // s
    std::vector<Body> bodies_;
    std::vector<Plane> planes_;  // none where nothing can touch them
    bool has_pairs_ = false;     // of bodies that may touch
    std::vector<Kick> kicks_;    // by step, then in file order
    std::vector<TimedForce> forces_;
    std::vector<std::int64_t> breaks_;  // steps at which a load goes on or off or an impulse acts, ascending
    std::vector<reference::Motion> now_;
    std::int64_t step_ = 0;
    std::size_t next_kick_ = 0;
};

// The scene's step, s, with all digits; and the step nearest to a time.
[[nodiscard]] reference::Number long_seconds(const StepSize& step);
[[nodiscard]] std::int64_t nearest_step(double time, const StepSize& step);

}  // namespace tumble::host
