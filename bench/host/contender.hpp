// A problem to time on the host, and its contenders: this kernel, Boost.Odeint and other engines. A problem is a scene
// of bench or host_sim with a number of copies of its body. Each contender makes a world of the same scene (bodies,
// step, gravity, contacts), steps it, and returns the poses of the bodies.
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

struct Problem {
    std::string name;
    std::string table;  // the table that shows it: one, or many
    SceneData scene;    // its number of steps is that of a timed run
    Features features;  // that a world needs for it
    // 0: each run starts again. Otherwise the world takes these steps once, and each run continues the one before.
    int steps_before = 0;
    // The true poses of the moving bodies at each sample, and the largest error of an answer.
    struct Sample {
        int steps;
        std::vector<reference::Motion> bodies;
    };
    std::vector<Sample> truth;
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
    virtual void run(int steps) = 0;
    // The motion of a body that is not fixed, by its index in the scene. Orientation: body to world.
    [[nodiscard]] virtual reference::Motion motion(int body) const = 0;
    [[nodiscard]] virtual bool asleep(int body) const = 0;
    // What the engine has reported of its steps; empty: nothing.
    [[nodiscard]] virtual std::string trouble() const { return ""; }
};

struct Contender {
    std::string engine, version, method;
    std::string numbers;  // q32, f32 or f64
    bool carry;
    // Null if the engine lacks a feature of the problem; throws std::runtime_error if the problem is too large for it.
    std::function<std::unique_ptr<Runner>(const Problem&)> make;
};

// Each adds its contenders to the list.
void add_tumble_q32(std::vector<Contender>& contenders);
void add_tumble_f32_plain(std::vector<Contender>& contenders);
void add_tumble_f64(std::vector<Contender>& contenders);
void add_odeint(std::vector<Contender>& contenders);
void add_bullet(std::vector<Contender>& contenders);
void add_ode(std::vector<Contender>& contenders);
void add_mujoco(std::vector<Contender>& contenders);

// Set-up vectors in the numbers of an engine.
template <class T>
[[nodiscard]] std::array<T, 3> array_of(const RealVec3& v) {
    return {static_cast<T>(v.x.to_double()), static_cast<T>(v.y.to_double()), static_cast<T>(v.z.to_double())};
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

}  // namespace tumble::bench
