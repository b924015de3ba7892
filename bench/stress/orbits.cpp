// Eccentricity of an orbit against the steps of a turn. Truth: Kepler's equation. The error is the distance from the
// true position at 8 times of each of five turns, relative to the major half axis. The change of energy is relative to
// the binding energy: a planet that gains all of it never returns.
//
// Rounding: one rounding of the velocity changes the motion as much as the same change of the start. N steps make
// sqrt(N) roundings without carried residuals; rounded constants make one.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "accuracy/closed_form.hpp"
#include "stress/maps.hpp"

namespace tumble::bench::stress {
namespace {

class Orbits final : public Map {
public:
    Orbits()
        : Map("orbits", "a planet, 5 turns",
              {"steps_a_turn",
               "steps a turn",
               "",
               true,
               {16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 2048, 4096},
               {16, 64, 256, 1024}},
              {"eccentricity",
               "eccentricity",
               "",
               false,
               {0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95},
               {0, 0.5, 0.9}}) {}

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        const auto description = scene(x, y);
        const auto every = static_cast<std::int64_t>(x) / samples_a_turn;
        const auto truth = places(description, simulation.step_length() * static_cast<long double>(every));
        const long double energy = simulation.energy().total();
        std::size_t sample = 0;
        return run_to_the_end(simulation, every, [&](Measured& run) {
            run.see_error(distance(simulation.body(planet).position, truth.at(++sample)));
            run.see_energy(1 + std::abs(simulation.energy().total() / energy - 1));
        });
    }

    double rounding_floor(double x, double y, const Method& method) const override {
        constexpr double nearby = 1e-6;
        auto description = scene(x, y);
        auto& speed = description.bodies[planet].velocity[1];
        const double digits = resolution(description, method, Quantity::velocity, speed);
        const auto here = places(description, period / samples_a_turn);
        speed *= 1 - nearby;
        const auto other = places(description, period / samples_a_turn);
        long double of_start = 0;
        for (std::size_t i = 0; i < here.size(); ++i) of_start = std::max(of_start, distance(here[i], other[i]));
        return digits * static_cast<double>(of_start) / nearby * (random_walk(method, turns * x) + 1);
    }

protected:
    void change(SceneFile& scene, double x, double y) const override {
        scene.set("world.step", period / x);
        scene.set("world.duration", turns * period);
        scene.set("body[1].position", host::Triple{half_axis * (1 - y), 0, 0});
        scene.set("body[1].velocity", host::Triple{0, std::sqrt(attraction / half_axis * (1 + y) / (1 - y)), 0});
    }

private:
    static constexpr int turns = 5, samples_a_turn = 8;
    static constexpr std::size_t planet = 1;
    // Of the scene's file: m, m^3/s^2; s.
    static constexpr double half_axis = 16, attraction = 256, period = 8 * std::numbers::pi;

    static std::vector<Position> places(const host::SceneDescription& scene, long double interval) {
        return closed_form(scene, interval, turns * samples_a_turn).value();
    }
    static long double distance(const Position& a, const Position& b) {
        return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / half_axis;
    }
};

}  // namespace

std::unique_ptr<Map> make_orbits() { return std::make_unique<Orbits>(); }

}  // namespace tumble::bench::stress
