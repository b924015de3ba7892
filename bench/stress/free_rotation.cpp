#include <tumble/integrators/method.hpp>

#include <cmath>
#include <map>
#include <utility>

#include "accuracy/reference.hpp"
#include "stress/maps.hpp"

namespace tumble::bench::stress {
namespace {

constexpr double spin = 16, turned = 1000;  // rad/s, rad
constexpr int samples = 20;

struct Top {
    const char* name;  // its moments and its special feature
    host::Triple moments;
    host::Triple direction;  // of the spin, principal axes; of any length
};
// Near its middle axis a body flips again and again. At 1e-9 doubles cannot represent the distance to the separatrix,
// which is its square.
constexpr Top tops[] = {
    {"1:1:1", {1, 1, 1}, {1, 2, 3}},
    {"1:1:1.999", {1, 1, 1.999}, {1, 1, 2}},
    {"1:1:2 disc", {1, 1, 2}, {1, 1, 2}},
    {"1:1.0001:2", {1, 1.0001, 2}, {1, 1, 2}},
    {"1:2:3 plate", {1, 2, 3}, {1, 1, 1}},
    {"1:2:3, 1e-3 off middle axis", {1, 2, 3}, {1e-3, 1, 1e-3}},
    {"1:2:3, 1e-6 off middle axis", {1, 2, 3}, {1e-6, 1, 1e-6}},
    {"1:2:2 rod", {1, 2, 2}, {2, 1, 1}},
    {"1:10:10 rod", {0.1, 1, 1}, {2, 1, 1}},
    {"1:100:100 rod", {0.01, 1, 1}, {2, 1, 1}},
    {"1:1000:1000 rod", {0.001, 1, 1}, {2, 1, 1}},
    {"1:1000:1000.5", {0.001, 1, 1.0005}, {2, 1, 1}},
};

host::Triple spin_of(const Top& top) {
    const auto& d = top.direction;
    const double factor = spin / std::hypot(d[0], d[1], d[2]);
    return {d[0] * factor, d[1] * factor, d[2] * factor};
}

// Each time between two samples, 50 rad, is a whole number of steps.
std::vector<double> steps(double first, int count) {
    std::vector<double> values;
    for (const double x : logarithmic_values(first, 2, count))
        values.push_back(turned / samples / std::round(turned / samples / x));
    return values;
}

Axis axis_of_tops() {
    Axis axis{"body", "moments of inertia", "", false, {}, {0, 3, 4, 6, 10}, {}};
    for (const Top& top : tops) {
        axis.fine.push_back(static_cast<double>(axis.names.size()));
        axis.names.emplace_back(top.name);
    }
    return axis;
}

class FreeRotation final : public Map {
public:
    FreeRotation()
        : Map("free_rotation", "free rotation, 1000 rad",
              {"step_times_spin", "step times spin", "rad", true, steps(0.01, 24), steps(0.05, 6), {}},
              axis_of_tops()) {}

    void prepare(const std::vector<double>& y_values) override {
        for (const double y : y_values)
            if (!truth_.contains(y)) truth_[y] = truth_of(y);
    }

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        const auto& truth = truth_.at(y).orientations;
        const long double energy = simulation.energy().total();
        const std::int64_t every = std::lround(turned / samples / x);
        return run_to_the_end(simulation, every, [&](Measured& run) {
            const auto q = simulation.body(0).orientation;
            const auto sample = static_cast<std::size_t>(simulation.steps_taken() / every);
            run.see_error(angle_between_orientations(truth.at(sample), q));
            run.see_norm(std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]));
            run.see_energy(simulation.energy().total() / energy);
        });
    }

    // A random walk of the spin, one rounding a step, and its effect on the motion. Angles are rounded in every step,
    // so carried residuals gain one digit only. Fixed point holds the angular momentum in the digits of the largest
    // spin, and `exact` turns it as one vector: fewer digits remain for the spin about the least moment.
    double rounding_floor(double x, double y, const Method& method) const override {
        const host::Triple& moments = tops[static_cast<std::size_t>(y)].moments;
        const bool as_one =
            method.numbers == "q32" || host::find_integrator(method.integrator).free_order == tumble::no_truncation;
        return resolution(scene(x, y), method, Quantity::spin, spin) * truth_.at(y).sensitivity *
               std::sqrt(turned / x) * (method.carry ? 0.1 : 1) * (as_one ? moments[1] / moments[0] : 1);
    }
    int order(const host::IntegratorInfo& method) const override { return method.free_order; }

protected:
    void change(SceneFile& scene, double x, double y) const override {
        const Top& top = tops[static_cast<std::size_t>(y)];
        scene.set("world.step", x / spin);
        scene.set("body[0].inertia", top.moments);
        scene.set("body[0].angular_velocity", spin_of(top));
    }

private:
    struct Truth {
        std::vector<Quaternion> orientations;
        double sensitivity = 0;  // change of orientation, rad, for a relative change of the spin
    };

    [[nodiscard]] Truth truth_of(double y) const {
        host::SceneDescription top = scene(x().fine.back(), y);
        Truth truth{reference_orientations(top, samples), 0};
        constexpr double change = 1e-9;
        const host::Triple aside{1, -1, 1};
        for (std::size_t i = 0; i < 3; ++i) top.bodies[0].angular_velocity[i] += change * spin * aside[i];
        const auto beside = reference_orientations(top, samples);
        for (std::size_t i = 0; i < beside.size(); ++i) {
            truth.sensitivity =
                std::max(truth.sensitivity, angle_between_orientations(truth.orientations[i], beside[i]) / change);
        }
        return truth;
    }

    std::map<double, Truth> truth_;
};

}  // namespace

std::unique_ptr<Map> make_free_rotation() { return std::make_unique<FreeRotation>(); }

}  // namespace tumble::bench::stress
