#include <algorithm>
#include <cmath>

#include "stress/maps.hpp"

namespace tumble::bench::stress {
namespace {

// Of the scene's file: rad/s, kg, m, m; the phase of the whole run and between two measurements, rad.
constexpr double frequency = 8, mass = 1, rest_length = 1, amplitude = 1.0 / 32, turned = 200,
                 angle_between_looks = 0.7, widest_swing = 100;

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
              {"frequency_times_step",
               "frequency times step",
               "rad",
               true,
               logarithmic_values(0.05, 4, 24),
               logarithmic_values(0.05, 4, 12),
               {}},
              {"damping_ratio", "damping ratio", "", false, linear_values(0, 2, 11), {0, 0.2, 1, 2}, {}}) {}

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        // Near its limit a method lets the energy of an oscillation vary widely without growth. Growth is a second half
        // with more energy than the first, or an energy that no stable oscillation reaches.
        const long double start = simulation.energy().total();
        long double early = start;
        return run_to_the_end(simulation, std::max(1L, std::lround(angle_between_looks / x)), [&](Measured& run) {
            const long double truth = oscillation(y, frequency * simulation.time());
            run.see_error(std::abs(simulation.body(0).position[0] / amplitude - truth));
            const long double energy = simulation.energy().total();
            run.see_energy(energy / start / widest_swing);
            if (2 * simulation.steps_taken() < simulation.steps()) early = std::max(early, energy);
            else run.see_energy(energy / early);
        });
    }

    // Rounding of the spring's constants shifts the phase. Rounding of its length, about `rest_length`, adds up as a
    // random walk without carried residuals.
    double rounding_floor(double x, double y, const Method& method) const override {
        const double digits = resolution(scene(x, y), method, Quantity::velocity, frequency * amplitude);
        return digits * (turned + rest_length / amplitude * random_walk(method, turned / x));
    }
    std::optional<double> limit(double y, const Method& method) const override {
        const auto step = host::find_integrator(method.integrator).oscillator_step;
        return limit_where(y, [&](double x) { return !step(x * x, 2 * y * x).is_stable(); });
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
