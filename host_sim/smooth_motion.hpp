// The true motion of a scene between contacts: every load and event of the scene format in long double, integrated far
// below the error of any kernel method. Its formulas are written apart from the kernel's and share no code with it.
// Contacts are left out: ask clearance() whether the motion is still the scene's.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reference/motion.hpp"
#include "scene_description.hpp"

namespace tumble::host {

class SmoothMotion {
public:
    // At time 0. Event times are rounded to the nearest of the scene's steps, as the kernel rounds them.
    explicit SmoothMotion(const SceneDescription& scene);

    // To the start of a step, before its impulses; earlier steps leave it where it is. Throws std::runtime_error where
    // bodies fall into each other, or the loads are so stiff that a run would not end.
    void advance_to(std::int64_t step);

    // x_w and v_w in the world; w in the user's body axes, which q turns into the world. Fixed bodies stay.
    [[nodiscard]] const std::vector<reference::Motion>& bodies() const { return now_; }

    // The height of the lowest point of a sphere or box that moves over a plane, m: negative where they overlap. Very
    // large without planes or a contact response.
    [[nodiscard]] reference::Number clearance() const;
    // A bound of the speed of any such point, m/s.
    [[nodiscard]] reference::Number surface_speed() const;

private:
    struct Tensor {
        reference::Vector x, y, z;  // rows
        [[nodiscard]] reference::Vector operator*(const reference::Vector& v) const;
        [[nodiscard]] Tensor inverse() const;
    };
    struct Body {
        reference::Number mass = 0;  // kg
        Tensor inertia, inverse;     // kg m^2, user's axes
        bool fixed = false, touches = false;
        reference::Vector half;  // m: half edges of a box, radius of a sphere in each
        bool round = false;
    };
    struct Thrust {
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
    void add_spring(const SpringDescription& spring, const std::vector<reference::Motion>& motions,
                    Wrenches& sums) const;

    SceneDescription scene_;
    reference::Number step_length_ = 0;  // s
    std::vector<Body> bodies_;
    std::vector<Plane> planes_;  // none where nothing can touch them
    std::vector<Kick> kicks_;    // by step, then in file order
    std::vector<Thrust> thrusts_;
    std::vector<std::int64_t> breaks_;  // steps at which a load goes on or off or an impulse acts, ascending
    std::vector<reference::Motion> now_;
    std::int64_t step_ = 0;
    std::size_t next_kick_ = 0;
};

// The scene's step, s, with all digits; and the step nearest to a time.
[[nodiscard]] reference::Number long_seconds(const StepSize& step);
[[nodiscard]] std::int64_t nearest_step(double time, const StepSize& step);

}  // namespace tumble::host
