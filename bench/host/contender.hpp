// What is timed on the host: a problem, a scene of bench or host_sim with as many bodies of its kind as asked for, and
// those who can run it: this kernel, Boost.Odeint and other engines. Each makes a world of the same scene (bodies,
// step, gravity, contacts), steps it, and tells where the bodies are.
#pragma once

#include "scene/data.hpp"
#include "truth/motion.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tumble::bench {

using host::SceneData;

struct Problem {
    std::string name;
    std::string table;  // the table that shows it: one, or many
    SceneData scene;    // its steps are those of a timed run
    Features features;  // what a world needs for it
    // Of what starts again for each run. What rests stays as it is: it is stepped this often before, and goes on.
    int steps_before = 0;
    // Where each body that moves is after the steps of a sample, and how far from there an answer may be.
    struct Sample {
        int steps;
        std::vector<reference::Motion> bodies;
    };
    std::vector<Sample> truth;
    double position_within = 0;     // m
    double orientation_within = 0;  // rad; 0: the problem does not ask for it
    // Names of contenders that are known to have no answer, or one that is farther away: they are told, not timed.
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

// A problem in somebody's world.
class Runner {
public:
    virtual ~Runner() = default;
    // Back to the start of the scene.
    virtual void restart() = 0;
    virtual void run(int steps) = 0;
    // Of the problem's body, by its place in the scene. Orientation: its axes to the world's.
    [[nodiscard]] virtual reference::Motion motion(int body) const = 0;
    [[nodiscard]] virtual bool asleep(int body) const = 0;
};

struct Contender {
    std::string engine, version, method;
    std::string numbers;  // q32, f32 or f64
    bool carry;
    // Null where it has not what the problem asks for; throws std::runtime_error where it cannot do as much of it.
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

// Set-up vectors in an engine's numbers.
template <class T>
[[nodiscard]] std::array<T, 3> array_of(const RealVec3& v) {
    return {static_cast<T>(v.x.to_double()), static_cast<T>(v.y.to_double()), static_cast<T>(v.z.to_double())};
}
// Of a body whose axes are its principal ones, as those of all problems are; throws std::runtime_error otherwise. An
// engine whose bodies all rotate takes a point mass for a ball of 0.1 m.
[[nodiscard]] std::array<double, 3> principal_moments(const BodySpec& body);

}  // namespace tumble::bench
