// Bodies that turn about a fixed point under a force that is constant in the world's frame.
//
// `pendulum`: amplitude against omega h, where omega is the frequency of small swings. Truth: Jacobi's elliptic
// functions. The error is the angle to the true orientation after each step, over 100 rad of omega t; relative to
// amplitudes below 1 rad. `heavy_top`: an asymmetric top's spin against the step. Truth: an integration in long double,
// of a row once. The error is the angle to the true orientation at 16 times.
//
// Energy is that of rotation and of the force, above its minimum. For the pendulum it is relative to the largest energy
// of a linear oscillation in the same method.
//
// Rounding: one rounding of the spin changes the motion as much as the same change of the start. N steps make sqrt(N)
// roundings without carried residuals, and rounded constants stretch time by one rounding.
#include <boost/math/special_functions/jacobi_elliptic.hpp>

#include <algorithm>
#include <cmath>
#include <map>

#include "accuracy/reference.hpp"
#include "stress/maps.hpp"
#include "truth/trajectory.hpp"

namespace tumble::bench::stress {
namespace {

using reference::Number;
using reference::Rotation;
using reference::vector_of;

// A relative change that stands for an infinitesimal one.
constexpr Number nearby = 1e-6L;

// Energy of the scene's first body under forces whose sum is zero, J.
Number energy_of(const host::SceneDescription& scene, const host::Simulation& simulation) {
    const Rotation q = host::motion_of(simulation.body(0)).q.normalized();
    Number energy = simulation.energy().kinetic;
    for (const auto& force : scene.forces) {
        const auto f = vector_of(force.force), point = vector_of(force.point);
        energy += norm(f) * norm(point) - dot(f, q.rotate(point));
    }
    return energy;
}

// The units of errors, rad, and of energies, relative to the start.
struct Sizes {
    Number angle = 1, energy = 1;
};

// The largest distance from the true orientation; energy and norm beside it.
template <class Truth>
Measured measure_turning(const host::SceneDescription& scene, host::Simulation& simulation, std::int64_t every,
                         const Sizes& sizes, Truth&& truth) {
    const Number energy = sizes.energy * energy_of(scene, simulation);
    return run_to_the_end(simulation, every, [&](Measured& run) {
        const Rotation q = host::motion_of(simulation.body(0)).q;
        run.see_error(angle_between(q, truth()) / sizes.angle);
        run.see_norm(std::sqrt(q.norm2()));
        run.see_energy(energy_of(scene, simulation) / energy);
    });
}

class Pendulum final : public Map {
public:
    Pendulum()
        : Map("pendulum", "a physical pendulum, 100 rad",
              {"frequency_times_step", "frequency of small swings times step", "rad", true,
               logarithmic_values(0.02, 3.62, 16), logarithmic_values(0.02, 3.62, 6)},
              {"amplitude", "amplitude", "rad", false, {0.1, 0.3, 1, 1.5, 2, 2.5, 3, 3.1}, {0.1, 1.5, 3}}) {}

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        const auto description = scene(x, y);
        return measure_turning(description, simulation, 1, {size(y), swing(simulation.integrator(), x)}, [&] {
            return reference::exponential<Number>({0, 0, angle(y, frequency * simulation.time())});
        });
    }

    double rounding_floor(double x, double y, const Method& method) const override {
        Number of_start = 0, of_time = 0;
        for (Number phase = 0; phase <= turned; phase += 0.5L) {
            const Number here = angle(y, phase);
            of_start = std::max(of_start, std::abs(angle(y * (1 - nearby), phase) - here));
            of_time = std::max(of_time, std::abs(angle(y, phase * (1 + nearby)) - here));
        }
        const double digits = resolution(scene(x, y), method, Quantity::spin, 2 * frequency * std::sin(y / 2));
        return digits * static_cast<double>((of_start * random_walk(method, turned / x) + of_time) / nearby / size(y));
    }

protected:
    void change(SceneFile& scene, double x, double y) const override {
        const double step = x / frequency, end = step * std::ceil(turned / x);
        scene.set("world.step", step);
        scene.set("world.duration", end);
        for (const char* force : {"force[0].until", "force[1].until"}) scene.set(force, end);
        scene.set("body[0].orientation", host::Quadruple{std::cos(y / 2), 0, 0, std::sin(y / 2)});
    }

private:
    // Of the scene's file: frequency of small swings, rad/s; and the phase of the whole run, rad.
    static constexpr double frequency = 4, turned = 100;

    static double size(double amplitude) { return std::min(1.0, amplitude); }

    // The largest energy of a linear oscillation that is released at rest, relative to the start, in a stable method.
    static double swing(std::string_view integrator, double x) {
        const auto step = host::find_integrator(integrator).oscillator_step(x * x, 0);
        double place = 1, velocity = 0, most = 1;  // velocity per step
        for (double angle = 0; angle < turned && step.is_stable(); angle += x) {
            const double before = place;
            place = step.xx * before + step.xv * velocity;
            velocity = step.vx * before + step.vv * velocity;
            most = std::max(most, place * place + velocity * velocity / (x * x));
        }
        return most;
    }

    // The angle from the lowest position, rad, after a release at an amplitude.
    static Number angle(Number amplitude, Number phase) {
        const Number modulus = std::sin(amplitude / 2);
        return 2 * std::asin(modulus * boost::math::jacobi_cd(modulus, phase));
    }
};

class HeavyTop final : public Map {
public:
    HeavyTop()
        : Map("heavy_top", "a heavy asymmetric top, 4 s",
              {"steps_a_second",
               "steps a second",
               "1/s",
               true,
               {4, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 1024, 2048},
               {4, 16, 64, 256, 1024}},
              {"spin",
               "spin about its axis",
               "rad/s",
               false,
               {0.5, 1.5, 3, 5, 7.5, 10, 15, 20, 25, 30},
               {1.5, 10, 30}}) {}

    void prepare(const std::vector<double>& y_values) override {
        for (const double y : y_values) (void)truth(y);
    }

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        const auto description = scene(x, y);
        const auto& orientations = truth(y).orientations;
        std::size_t sample = 0;
        return measure_turning(description, simulation, simulation.steps() / samples, {},
                               [&] { return reference::rotation_of(orientations.at(++sample)); });
    }

    double rounding_floor(double x, double y, const Method& method) const override {
        const double digits = resolution(scene(x, y), method, Quantity::spin, y);
        return digits * (truth(y).of_start * random_walk(method, duration * x) + truth(y).of_time);
    }

protected:
    void change(SceneFile& scene, double x, double y) const override {
        scene.set("world.step", 1 / x);
        scene.set("body[0].angular_velocity", host::Triple{0.25, 0.25, y});
    }

private:
    static constexpr double duration = 4;  // s, of the scene's file
    static constexpr int samples = 16;

    struct Truth {
        std::vector<Quaternion> orientations;
        double of_start = 0, of_time = 0;  // rad, of a relative change of 1
    };
    // Computed on the first call.
    const Truth& truth(double y) const {
        const auto known = truths_.find(y);
        if (known != truths_.end()) return known->second;
        host::SceneDescription description = scene(x().fine.back(), y);
        Truth truth{reference_orientations(description, samples)};
        auto& w = description.bodies[0].angular_velocity;
        for (double& component : w) component *= 1 + static_cast<double>(nearby);
        const auto other = reference_orientations(description, samples);
        for (std::size_t i = 0; i < other.size(); ++i) {
            truth.of_start = std::max(truth.of_start, angle_between_orientations(truth.orientations[i], other[i]));
        }
        truth.of_start /= static_cast<double>(nearby);
        truth.of_time = duration * std::hypot(w[0], w[1], w[2]);
        return truths_.emplace(y, std::move(truth)).first->second;
    }
    mutable std::map<double, Truth> truths_;
};

}  // namespace

std::unique_ptr<Map> make_pendulum() { return std::make_unique<Pendulum>(); }
std::unique_ptr<Map> make_heavy_top() { return std::make_unique<HeavyTop>(); }

}  // namespace tumble::bench::stress
