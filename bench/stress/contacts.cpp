// Contacts by impulses against the step. The true motion is a formula: heights of bounces, distances slid, velocities
// after an impact, or rest. Three bounds hold for every method: the penetration of a pair is at most a few tolerances,
// energy does not grow, and an error above a tenth is explained by the method's order or by the floor.
//
// `bounce_speed`, `bounce_restitution`: a ball falls on a plane. The error is the largest of its height after every
// step, relative to the height of the fall. Floor: the tolerance of contacts, and g h^2 / 8, the height of a bounce
// that is over within a step. `friction`: a box is thrown down an incline, slides on or stops. The error is the largest
// of the distance slid, relative to all of it. Floor: a h^2 / 8, half the length of the last step before it stops;
// 2^-16 of the tolerance, within which an impact is found; and a random walk of roundings. `mass_ratio_impact`: an
// elastic impact, head-on. The error is that of the two velocities, each relative to its own. `mass_ratio_pile`,
// `stack`: boxes rest on each other. The error is the largest displacement of a body, relative to 100 tolerances: one
// tolerance is accurate, and ten are no longer the same motion. Energy is relative to that of lifting all bodies by one
// tolerance.
//
// The methods are one for each way in which a position advances under a constant acceleration, and rk4. The others
// differ in the rotation of free bodies only, which hardly occurs here.
#include <algorithm>
#include <cmath>

#include "stress/maps.hpp"
#include "truth/smooth_motion.hpp"

namespace tumble::bench::stress {
namespace {

using reference::Number;
using reference::Vector;
using reference::vector_of;

constexpr double gravity = 9.8125;  // m/s^2, of the scenes' files

class ContactMap : public Map {
public:
    ContactMap(std::string name, std::string title, std::string scene, Axis y)
        : Map(std::move(name), std::move(title),
              {"steps_a_second", "steps a second", "1/s", true, {16, 32, 64, 128, 256, 512, 1024}, {32, 128, 512}},
              std::move(y), std::move(scene)) {}

    bool has_contacts() const override { return true; }
    bool takes(const host::IntegratorInfo& method) const override {
        constexpr const char* different[] = {"explicit_euler", "semi_implicit_euler", "verlet", "rk4"};
        return std::find(std::begin(different), std::end(different), method.name) != std::end(different);
    }
    // The floor of contacts is no noise: beyond it the method makes the error.
    double floors_of_truncation() const override { return 1; }
    // In flight a method of order 1 changes energy by as much as an impact may.
    Bounds bounds(const host::IntegratorInfo& method) const override {
        Bounds bounds;
        if (method.order > 1) bounds.energy = 1.01;
        bounds.depth = 2;
        bounds.error = largest_accurate_error;
        return bounds;
    }

protected:
    void change(SceneFile& scene, double x, double y) const final {
        scene.set("world.step", 1 / x);
        change_besides(scene, x, y);
    }
    virtual void change_besides(SceneFile& scene, double x, double y) const = 0;
};

// In tolerances; 0 if the shape is clear of it.
double depth_of(Number gap, const host::SceneDescription& scene) {
    return static_cast<double>(std::max(0.0L, -gap) / scene.contact.tolerance);
}

// Height over the plane, m, of a ball that is released at a height and bounces.
Number bounce(Number height, Number restitution, Number time) {
    Number speed = 0;
    while (speed > 1e-9L || height > 0) {
        const Number fall = (speed + std::sqrt(speed * speed + 2 * gravity * height)) / gravity;
        if (fall >= time) return height + speed * time - gravity * time * time / 2;
        time -= fall;
        speed = restitution * (gravity * fall - speed);
        height = 0;
    }
    return 0;
}

class Bounces : public ContactMap {
public:
    using ContactMap::ContactMap;

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        const auto description = scene(x, y);
        const double radius = description.body(0).shape.size[0], height = description.body(0).position[1] - radius;
        const Number energy = gravity * height;  // of 1 kg
        return run_to_the_end(simulation, 1, [&](Measured& run) {
            const Number now = simulation.body(0).position[1] - radius;
            run.see_error(std::abs(now - bounce(height, description.contact.restitution, simulation.time())) / height);
            run.see_energy((simulation.energy().total() - gravity * radius) / energy);
            run.see_depth(depth_of(now, description));
        });
    }
    double rounding_floor(double x, double y, const Method&) const override {
        const auto description = scene(x, y);
        const double height = description.body(0).position[1] - description.body(0).shape.size[0];
        return (description.contact.tolerance + gravity / (8 * x * x)) / height;
    }

protected:
    static void drop(SceneFile& scene, double height, double restitution, double duration) {
        scene.set("body[0].position", host::Triple{0, radius + height, 0});
        scene.set("contact.restitution", restitution);
        scene.set("world.duration", duration);
    }

private:
    static constexpr double radius = 0.25;  // m, of the scene's file
};

class BounceSpeed final : public Bounces {
public:
    BounceSpeed()
        : Bounces(
              "bounce_speed", "a ball that bounces with half its speed", "bounce",
              {"approach_speed", "approach speed", "m/s", true, {0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30}, {0.1, 1, 10}}) {}

protected:
    // The fall and two bounces, and a while at rest where the step is long.
    void change_besides(SceneFile& scene, double x, double y) const override {
        drop(scene, y * y / (2 * gravity), 0.5, std::max(4 * y / gravity, 16 / x));
    }
};

class BounceRestitution final : public Bounces {
public:
    BounceRestitution()
        : Bounces("bounce_restitution", "a ball that falls 1 m and bounces, 4 s", "bounce",
                  {"restitution", "restitution", "", false, {0, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 1}, {0, 0.5, 1}}) {}

protected:
    void change_besides(SceneFile& scene, double, double y) const override { drop(scene, 1, y, 4); }
};

class Friction final : public ContactMap {
public:
    Friction()
        : ContactMap("friction", "a box thrown down an incline of 3/4, 2 s", "friction",
                     {"friction",
                      "coefficient of friction",
                      "",
                      false,
                      {0, 0.25, 0.5, 0.7, 0.74, 0.76, 0.8, 1, 1.5, 2},
                      {0, 0.5, 1}}) {}

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        const auto description = scene(x, y);
        const auto& body = description.body(0);
        const Vector start = vector_of(body.position);
        const Number energy = simulation.energy().total(), all = way(y, duration);
        return run_to_the_end(simulation, 1, [&](Measured& run) {
            const auto now = host::motion_of(simulation.body(0));
            const Number slid = way(y, simulation.time());
            run.see_error(norm(now.x - start - downhill * slid) / all);
            // The energy that friction has not dissipated.
            const Number lost = y * mass * gravity * up.y * slid;
            run.see_energy(1 + (simulation.energy().total() + lost - energy) / (mass * (gravity * all + 1)));
            run.see_depth(depth_of(dot(now.x, up) - host::half_extent(body, now.q, up), description));
        });
    }
    double rounding_floor(double x, double y, const Method& method) const override {
        const auto description = scene(x, y);
        const double all = static_cast<double>(way(y, duration)), steps = static_cast<double>(description.steps());
        const double stop = static_cast<double>(std::abs(acceleration(y))) / (8 * x * x);
        return (stop + 0x1p-16 * description.contact.tolerance) / all +
               resolution(description, method, Quantity::velocity, all / static_cast<double>(duration)) *
                   random_walk(method, steps);
    }

protected:
    void change_besides(SceneFile& scene, double, double y) const override { scene.set("contact.friction", y); }

private:
    // Of the scene's file: kg, m/s, s.
    static constexpr Number mass = 2, speed = 1, duration = 2;
    static constexpr Vector up{-0.6L, 0.8L, 0}, downhill{-0.8L, -0.6L, 0};

    static Number acceleration(Number friction) { return gravity * (0.6L - 0.8L * friction); }
    // The distance slid, m.
    static Number way(Number friction, Number time) {
        const Number a = acceleration(friction);
        if (speed + a * time < 0) return speed * speed / (-2 * a);
        return speed * time + a * time * time / 2;
    }
};

const std::vector<double> mass_ratios = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1, 10, 100, 1e3, 1e4, 1e5, 1e6};

class MassRatioImpact final : public ContactMap {
public:
    MassRatioImpact()
        : ContactMap("mass_ratio_impact", "an elastic impact", "mass_ratio_impact",
                     {"mass_ratio", "mass ratio", "", true, mass_ratios, {1e-4, 1, 1e4}}) {}

    bool takes(const host::IntegratorInfo& method) const override { return method.name == "verlet"; }

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        const auto description = scene(x, y);
        const Number speed = description.body(0).velocity[0], reach = 2 * description.body(0).shape.size[0];
        const Number energy = simulation.energy().total();
        return run_to_the_end(simulation, 1, [&](Measured& run) {
            const auto one = simulation.body(0), other = simulation.body(1);
            const Number apart = other.position[0] - one.position[0];
            run.see_depth(depth_of(apart - reach, description));
            run.see_energy(simulation.energy().total() / energy);
            if (simulation.steps_taken() < simulation.steps()) return;
            const Number expected = 2 * y / (y + 1) * speed;
            run.see_error(std::abs(other.velocity[0] / expected - 1));
            run.see_error(std::abs(one.velocity[0] - (y - 1) / (y + 1) * speed) / speed);
        });
    }
    // A digit of the slower one's velocity.
    double rounding_floor(double x, double y, const Method& method) const override {
        const auto description = scene(x, y);
        const double speed = description.body(0).velocity[0];
        return resolution(description, method, Quantity::velocity, speed * std::min(1.0, y));
    }

protected:
    void change_besides(SceneFile& scene, double, double y) const override { scene.set("body[0].mass", y); }
};

class Piles : public ContactMap {
public:
    using ContactMap::ContactMap;

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        const auto description = scene(x, y);
        const Number energy = simulation.energy().total(), tolerance = description.contact.tolerance;
        Number mass = 0;
        for (const auto& body : description.bodies) mass += *body.mass;
        return run_to_the_end(simulation, 1, [&](Measured& run) {
            run.see_energy(1 + (simulation.energy().total() - energy) / (mass * gravity * tolerance));
            Number top = 0;  // of the body below
            for (int b = 0; b < simulation.body_count(); ++b) {
                const auto& start = description.body(b);
                const Vector now = vector_of(simulation.body(b).position);
                const Number half = start.shape.size[1] / 2;
                run.see_error(norm(now - vector_of(start.position)) / (tolerance / accurate_share));
                run.see_depth(depth_of(now.y - half - top, description));
                top = now.y + half;
            }
        });
    }
    double rounding_floor(double, double, const Method&) const override { return accurate_share / accurate_factor; }
    Bounds bounds(const host::IntegratorInfo& method) const override {
        Bounds bounds = ContactMap::bounds(method);
        bounds.energy = Bounds{}.energy;
        return bounds;
    }

private:
    static constexpr double accurate_share = 0.01;  // of the error's unit, a tolerance
};

class MassRatioPile final : public Piles {
public:
    MassRatioPile()
        : Piles("mass_ratio_pile", "a box on a box, 1 s", "mass_ratio_pile",
                {"mass_ratio", "upper over lower mass", "", true, mass_ratios, {1e-4, 1, 1e4}}) {}

protected:
    void change_besides(SceneFile& scene, double, double y) const override { scene.set("body[1].mass", y); }
};

class Stack final : public Piles {
public:
    Stack()
        : Piles("stack", "a stack of boxes, 0.5 s", "stack",
                {"height", "boxes", "", false, {1, 2, 3, 5, 7, 10, 15, 20, 30}, {1, 3, 10}}) {}

protected:
    void change_besides(SceneFile& scene, double, double y) const override {
        for (int box = 1; box < static_cast<int>(y); ++box) {
            const std::string copy = "body[" + std::to_string(scene.append_copy("body[0]")) + "]";
            scene.set(copy + ".name", "box " + std::to_string(box + 1));
            scene.set(copy + ".position", host::Triple{0, 0.5 + box, 0});
        }
    }
};

}  // namespace

std::unique_ptr<Map> make_bounce_speed() { return std::make_unique<BounceSpeed>(); }
std::unique_ptr<Map> make_bounce_restitution() { return std::make_unique<BounceRestitution>(); }
std::unique_ptr<Map> make_friction() { return std::make_unique<Friction>(); }
std::unique_ptr<Map> make_mass_ratio_impact() { return std::make_unique<MassRatioImpact>(); }
std::unique_ptr<Map> make_mass_ratio_pile() { return std::make_unique<MassRatioPile>(); }
std::unique_ptr<Map> make_stack() { return std::make_unique<Stack>(); }

}  // namespace tumble::bench::stress
