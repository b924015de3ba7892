#include <cmath>

#include "stress/maps.hpp"

namespace tumble::bench::stress {
namespace {

// Of the scene's file: rad/s, kg, m; how far the oscillation turns, rad.
constexpr double frequency = 16, mass = 1, amplitude = 0.25, turned = 200;

// x'' = -w^2 x - 2 ratio w x' from the amplitude at rest, divided by the amplitude.
long double oscillation(long double ratio, long double angle) {
    if (ratio == 1) return (1 + angle) * std::exp(-angle);
    const long double root = std::sqrt(std::abs(1 - ratio * ratio));
    if (ratio < 1) {
        return std::exp(-ratio * angle) * (std::cos(root * angle) + ratio / root * std::sin(root * angle));
    }
    const long double slow = ratio - root, fast = ratio + root;
    return (fast * std::exp(-slow * angle) - slow * std::exp(-fast * angle)) / (2 * root);
}

class Springs final : public Map {
public:
    Springs()
        : Map("springs", "a mass on a damped spring, 200 rad",
              {"frequency_times_step", "frequency times step", "rad", true, logarithmic_values(0.05, 4, 24),
               logarithmic_values(0.05, 4, 12)},
              {"damping_ratio", "damping ratio", "", false, linear_values(0, 2, 11), linear_values(0, 2, 5)}) {}

    using Map::measure;
    Measured measure(double, double y, host::Simulation& simulation) const override {
        const long double energy = simulation.energy().total();
        return run_to_the_end(simulation, 1, [&](Measured& run) {
            const long double truth = oscillation(y, frequency * simulation.time());
            run.see_error(std::abs(simulation.body(0).position[0] / amplitude - truth));
            run.see_energy(simulation.energy().total() / energy);
        });
    }

    // Rounding of the spring's constants turns the motion ahead, and that of each step adds up as a random walk.
    double rounding_floor(double x, double y, const Method& method) const override {
        const double digits = resolution(scene(x, y), method, Quantity::velocity, frequency * amplitude);
        return digits * (turned + std::sqrt(turned / x));
    }

protected:
    void change(SceneFile& scene, double x, double y) const override {
        scene.set("world.step", x / frequency);
        scene.set("world.duration", turned / frequency);
        scene.set("spring[0].damping", 2 * y * mass * frequency);
    }
};

}  // namespace

std::unique_ptr<Map> make_springs() { return std::make_unique<Springs>(); }

}  // namespace tumble::bench::stress
