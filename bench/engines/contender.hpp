// A problem for engines, and its contenders: this kernel, Boost.Odeint and other engines. A problem is a scene. Each
// contender makes a world of the same scene (bodies, joints, step, gravity, contacts), steps it, and returns the
// motions of the bodies.
#pragma once

#include "scene/data.hpp"
#include "truth/motion.hpp"

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace tumble::bench {

using host::SceneData;
using Motions = std::vector<reference::Motion>;  // of all bodies of a scene; orientation: body to world

// A hinge or a ball joint between two bodies, or a body and the world, at the start.
struct Joint {
    reference::Vector anchor;    // m, world
    reference::Vector axis;      // of a hinge, world, of unit length; zero: a ball joint
    reference::Vector on_own;    // m: the anchor from the body's centre of mass, in its axes
    reference::Vector on_other;  // likewise, of the other body; of the world the anchor
    reference::Vector own_axis;  // in the body's axes
    reference::Vector spin;      // rad/s, of the body against the other, in the body's axes

    [[nodiscard]] bool is_hinge() const { return dot(axis, axis) > 0; }
};

struct Problem {
    std::string name;
    std::string table;  // of bench/host, the table that shows it: one, or many
    SceneData scene;    // its number of steps is that of a timed run
    Features features;  // that a world needs for it
    // Empty, or of each body its joint with the body before, and of the first with the world. `scene` has them too.
    std::vector<Joint> joints{};
    // 0: each run starts again. Otherwise the world takes these steps once, and each run continues the one before.
    int steps_before = 0;
    int counted_steps = 0;  // of a contest, after those
    // The true motions of the moving bodies at each sample, and the largest error of an answer.
    struct Sample {
        int steps;
        Motions bodies;
    };
    std::vector<Sample> truth{};
    double position_within = 0;     // m
    double orientation_within = 0;  // rad; 0: not checked
    // Names of contenders without an answer or with a larger error: they have a row, but are not timed.
    std::vector<std::string> fail{};

    [[nodiscard]] bool starts_again() const { return steps_before == 0; }
    [[nodiscard]] bool sleeps() const { return scene.world.contact.sleep.on; }
    [[nodiscard]] int moving_bodies() const {
        int count = 0;
        for (const BodySpec& body : scene.bodies) count += body.fixed ? 0 : 1;
        return count;
    }
    [[nodiscard]] bool touches() const { return features.touches(); }
    [[nodiscard]] double step() const { return scene.step.value.to_double(); }  // s
};

// A problem in a contender's world.
class Runner {
public:
    virtual ~Runner() = default;
    // Back to the start of the scene.
    virtual void restart() = 0;
    virtual void step() = 0;
    void run(int steps) {
        for (int i = 0; i < steps; ++i) step();
    }
    // Those of fixed bodies may be missing.
    [[nodiscard]] virtual Motions motions() = 0;
    [[nodiscard]] virtual bool asleep(int body) const = 0;
    // What the engine has reported of its steps; empty: nothing.
    [[nodiscard]] virtual std::string trouble() const { return ""; }
};

// A runner that makes its World anew at each start. A World is made of a problem and a method, has step(), motions()
// and asleep(body), and may have trouble().
template <class World>
class RemakingRunner final : public Runner {
public:
    template <class... Method>
    explicit RemakingRunner(const Problem& problem, const Method&... method)
        : make_{[&problem, method...] { return std::make_unique<World>(problem, method...); }} {
        restart();
    }

    void restart() override {
        world_.reset();
        world_ = make_();
    }
    void step() override { world_->step(); }
    [[nodiscard]] Motions motions() override { return world_->motions(); }
    [[nodiscard]] bool asleep(int body) const override { return world_->asleep(body); }
    [[nodiscard]] std::string trouble() const override {
        if constexpr (requires { world_->trouble(); }) return world_->trouble();
        else return "";
    }

private:
    std::function<std::unique_ptr<World>()> make_;
    std::unique_ptr<World> world_;
};

struct Contender {
    std::string engine, version, method;
    std::string numbers;  // q32, f32 or f64
    bool carry;
    // Null if the engine lacks a feature of the problem; throws std::runtime_error if the problem is too large for it.
    std::function<std::unique_ptr<Runner>(const Problem&)> make;
};
using Contenders = std::vector<Contender>;

// Each adds its contenders to the list: with the default settings, for the free top, and for mechanisms with joints.
void add_tumble_q32(Contenders& contenders);
void add_tumble_f32_plain(Contenders& contenders);
void add_tumble_f64(Contenders& contenders);
void add_tumble_tops(Contenders& contenders);
void add_tumble_contacts(Contenders& contenders);
void add_tumble_joints(Contenders& contenders);
void add_odeint(Contenders& contenders);
void add_bullet(Contenders& contenders);
void add_bullet_tops(Contenders& contenders);
void add_bullet_joints(Contenders& contenders);
void add_ode(Contenders& contenders);
void add_ode_tops(Contenders& contenders);
void add_mujoco(Contenders& contenders);
void add_mujoco_tops(Contenders& contenders);
void add_mujoco_joints(Contenders& contenders);
void add_box2d(Contenders& contenders);

// Set-up vectors in the numbers of an engine.
template <class T>
[[nodiscard]] std::array<T, 3> array_of(const RealVec3& v) {
    return {static_cast<T>(v.x.to_double()), static_cast<T>(v.y.to_double()), static_cast<T>(v.z.to_double())};
}
[[nodiscard]] inline reference::Motion start_of(const BodySpec& body) {
    const auto vector = [](const RealVec3& v) { return reference::vector_of(array_of<double>(v)); };
    const RealQuat q = normalized(body.orientation);
    return {
        vector(body.position), vector(body.velocity), {q.w.to_double(), vector(q.v)}, vector(body.angular_velocity)};
}
// The principal moments of a body whose axes are its principal ones, as in all problems; throws std::runtime_error
// otherwise. For engines whose bodies all rotate, a point mass has the moments of a ball of 0.1 m.
[[nodiscard]] inline std::array<double, 3> principal_moments(const BodySpec& body) {
    if (is_point_mass(body)) {
        const double moment = 0.004 * body.mass.to_double();
        return {moment, moment, moment};
    }
    const InertiaTensor& i = body.inertia;
    if (!i.xy.is_zero() || !i.xz.is_zero() || !i.yz.is_zero())
        throw std::runtime_error{"a body's axes are not its principal ones"};
    return {i.xx.to_double(), i.yy.to_double(), i.zz.to_double()};
}
// For engines whose coordinates are those of the joints: sets the velocities from the poses and from the angular
// velocity of each body against the one before, rad/s in the axes of the body.
inline void set_velocities(const std::vector<Joint>& joints, const std::vector<reference::Vector>& turns,
                           Motions& motions) {
    reference::Vector velocity{}, spin{};  // of the joint, and of the body before; world
    for (std::size_t i = 0; i < joints.size(); ++i) {
        reference::Motion& now = motions[i];
        spin = spin + now.q.rotate(turns[i]);
        now.w = now.q.rotate_back(spin);
        now.v = velocity - cross(spin, now.q.rotate(joints[i].on_own));
        if (i + 1 < joints.size()) velocity = now.v + cross(spin, now.q.rotate(joints[i + 1].on_other));
    }
}

}  // namespace tumble::bench
