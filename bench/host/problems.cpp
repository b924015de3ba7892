#include "problems.hpp"

#include "accuracy/closed_form.hpp"
#include "scene/scene_file.hpp"
#include "truth/smooth_motion.hpp"

#include <algorithm>
#include <stdexcept>

namespace tumble::bench {

namespace {

using host::SceneDescription;
using reference::Motion;

constexpr int samples = 16;  // of a run
constexpr double apart = 2;  // m, between neighbouring bodies

class Maker {
public:
    // A scene file below the project's directory. `denominator`: of the step in s, if it differs from the file's.
    explicit Maker(const std::string& file, int denominator = 0)
        : description_{host::read_scene(std::string{TUMBLE_SOURCE_DIR} + "/" + file)} {
        if (denominator > 0) description_.step = {1, denominator, 0};
        problem_.scene = host::build_scene(description_);
        problem_.name = problem_.scene.name;
        problem_.features = host::needs(problem_.scene);
        problem_.table = "one";
    }
    Maker& fails(const std::string& contender) {
        problem_.fail.push_back(contender);
        return *this;
    }
    Maker& fails_above(std::size_t bodies, const std::vector<std::string>& contenders) {
        if (problem_.scene.bodies.size() > bodies)
            for (const std::string& contender : contenders) (void)fails(contender);
        return *this;
    }
    Maker& named(const std::string& name) {
        problem_.name = name;
        return *this;
    }
    Maker& within(double metres, double radians = 0) {
        problem_.position_within = metres;
        problem_.orientation_within = radians;
        return *this;
    }
    // Copies of the scene's only body, in rows along x, each with its spring if it has one.
    Maker& bodies(int count) {
        auto& bodies = problem_.scene.bodies;
        if (bodies.size() != 1) throw std::runtime_error{problem_.name + ": expected one body to repeat"};
        auto& springs = problem_.scene.springs;
        const BodySpec body = bodies.front();
        int across = 1;
        while (across * across < count) ++across;
        for (int i = 1; i < count; ++i) {
            const RealVec3 way{Real{apart * (i % across)}, 0,
                               Real{apart * (i / across)}};  // NOLINT(bugprone-integer-division)
            BodySpec next = body;
            next.position = next.position + way;
            bodies.push_back(next);
            if (springs.empty()) continue;
            SpringSpec spring = springs.front();
            spring.body = i;
            spring.to = spring.to + way;
            springs.push_back(spring);
        }
        problem_.features.bodies = count;
        problem_.features.springs = static_cast<int>(springs.size());
        problem_.table = "many";
        return *this;
    }
    Maker& touching() {
        problem_.features.pairs = true;
        return *this;
    }
    // With drag: a load that acts on each body in each step.
    Maker& in_air() {
        problem_.scene.world.linear_drag = Real{0.5};  // N s/m
        problem_.features.drag = true;
        return *this;
    }
    Maker& sleeping() {
        problem_.scene.world.contact.sleep.on = true;
        problem_.scene.world.contact.sleep.time = Real{0.25};  // s
        problem_.features.sleep = true;
        return *this;
    }
    // Steps of a timed run.
    Maker& steps(int count) {
        problem_.scene.steps = static_cast<std::uint32_t>(count);
        return *this;
    }

    // A scene whose motion is known.
    [[nodiscard]] Problem moves() {
        const int steps = static_cast<int>(problem_.scene.steps), every = std::max(1, steps / samples);
        const auto positions = closed_form(description_, description_.step.seconds() * every, steps / every);
        host::SmoothMotion smooth{description_, host::shapes_meet};
        const auto& bodies = problem_.scene.bodies;
        const std::size_t mover = bodies.front().fixed ? 1 : 0;
        const Motion start = start_of(bodies.at(mover));
        for (int sample = 1; sample * every <= steps; ++sample) {
            Motion motion;
            if (problem_.touches()) {
                motion = start;
                motion.x = reference::vector_of(positions.value().at(static_cast<std::size_t>(sample)));
            } else {
                smooth.advance_to(sample * every);
                motion = smooth.bodies().at(mover);
            }
            Problem::Sample& truth = problem_.truth.emplace_back(sample * every);
            for (const BodySpec& body : bodies) {
                Motion now = body.fixed ? start_of(body) : motion;
                if (!body.fixed) now.x = now.x + start_of(body).x - start.x;
                truth.bodies.push_back(now);
            }
        }
        return problem_;
    }
    // A scene at rest, in which iterative contact solvers let bodies creep.
    [[nodiscard]] Problem stands() {
        Problem::Sample& truth = problem_.truth.emplace_back(static_cast<int>(problem_.scene.steps));
        for (const BodySpec& body : problem_.scene.bodies) truth.bodies.push_back(start_of(body));
        return problem_;
    }
    // A scene at rest.
    [[nodiscard]] Problem rests(int steps_before) {
        problem_.steps_before = steps_before;
        Problem::Sample& truth = problem_.truth.emplace_back(steps_before);
        for (const BodySpec& body : problem_.scene.bodies) truth.bodies.push_back(start_of(body));
        return problem_;
    }

private:
    SceneDescription description_;
    Problem problem_;
};

}  // namespace

std::vector<Problem> problems(int most) {
    // The bounds admit a first-order method, and for contacts an engine with soft contacts.
    std::vector<Problem> all{
        Maker{"host_sim/scenes/free.toml"}.within(0.03, 0.1).moves(),
        Maker{"bench/problems/projectile_drag.toml", 256}.within(0.2).moves(),
        Maker{"bench/problems/stiff_spring.toml", 1024}.within(0.02).moves(),
        Maker{"bench/problems/kepler.toml", 256}.within(0.01).moves(),
        Maker{"bench/problems/ball_inelastic.toml"}.within(0.2).fails("Bullet, sequential impulses, f32 plain").moves(),
        Maker{"bench/contacts/resting_box.toml"}.within(0.01).rests(256),
        Maker{"host_sim/scenes/contacts/stack.toml"}.steps(256).within(0.01).fails("ODE, step, f64").stands(),
    };
    // Not enough memory for MuJoCo's Jacobian of all contacts.
    const std::vector<std::string> no_memory{"MuJoCo, Euler, conjugate gradients, f64"};
    const std::string box = "bench/contacts/resting_box.toml";
    for (int bodies = 1; bodies <= most; bodies *= 10) {
        // Steps of a timed run and before it. This kernel examines near pairs every eighth step, so a run is a multiple
        // of 8 steps.
        const int steps = std::clamp(20000 / bodies, 16, 512) & ~7, before = std::clamp(100000 / bodies, 64, 256);
        all.push_back(Maker{"host_sim/scenes/free.toml"}
                          .named("free bodies")
                          .bodies(bodies)
                          .steps(std::clamp(20000 / bodies, 16, 256))
                          .within(0.03, 0.1)
                          .moves());
        all.push_back(Maker{"bench/problems/stiff_spring.toml", 1024}
                          .named("bodies on a spring each")
                          .bodies(bodies)
                          .steps(std::clamp(20000 / bodies, 16, 256))
                          .within(0.02)
                          .moves());
        const auto boxes = [&](const char* name) {
            return Maker{box}.named(name).bodies(bodies).steps(steps).within(0.01).fails_above(1000, no_memory);
        };
        all.push_back(boxes("boxes at rest on a plane").rests(before));
        all.push_back(boxes("boxes at rest, looking for each other").touching().rests(before));
        all.push_back(boxes("boxes at rest in air, looking for each other").touching().in_air().rests(before));
        all.push_back(
            Maker{box}.named("boxes asleep on a plane").bodies(bodies).sleeping().steps(steps).within(0.01).rests(128));
    }
    return all;
}

}  // namespace tumble::bench
