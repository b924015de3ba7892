// Drag times step over mass, against the ratio of final speed to start speed. Truth: the closed form. The error is the
// distance from the true position after each step, in units of the distance of one time constant. The energy is that of
// the difference between velocity and final velocity; drag dissipates it, so it never exceeds that at the start.
//
// Rounding: one rounding of the velocity moves the body by the distance of one time constant; one rounding of the
// position stays. A body at its final speed is rounded the same way in every step, so plain floats make N roundings in
// N steps. Fixed point is dithered and makes sqrt(N); carried residuals keep it at one. Rounded constants shift the
// position by the same share of the whole distance.
#include <algorithm>
#include <cmath>

#include "accuracy/closed_form.hpp"
#include "stress/maps.hpp"

namespace tumble::bench::stress {
namespace {

class DragMap final : public Map {
public:
    DragMap()
        : Map("drag", "a throw through a fluid, 32 time constants",
              {"drag_times_step", "drag times step over mass", "", true, logarithmic_values(0.01, 4, 31),
               logarithmic_values(0.01, 4, 9)},
              {"final_speed", "final speed over start speed", "", false, {0, 0.1, 0.3, 1, 3, 10}, {0, 1, 10}}) {}

    Measured measure_run(double x, double y, host::Simulation& simulation) const override {
        const auto description = scene(x, y);
        const auto truth =
            closed_form(description, simulation.step_length(), static_cast<int>(simulation.steps())).value();
        return run_to_the_end(simulation, 1, [&](Measured& run) {
            const auto body = simulation.body(0);
            const auto& place = truth.at(static_cast<std::size_t>(simulation.steps_taken()));
            run.see_error(std::hypot(body.position[0] - place[0], body.position[1] - place[1]) / (speed(y) * time));
            const long double rest = std::hypot(body.velocity[0], body.velocity[1] + y * start) / speed(y);
            run.see_energy(std::max(1.0L, rest * rest));
        });
    }

    double rounding_floor(double x, double y, const Method& method) const override {
        const auto description = scene(x, y);
        const double steps = static_cast<double>(description.steps()), way = start * time * (1 + y * constants),
                     of_velocity = resolution(description, method, Quantity::velocity, speed(y)),
                     of_place = resolution(description, method, Quantity::position, way) * way / (speed(y) * time),
                     all = method.numbers == "q32" || method.carry ? random_walk(method, steps) : steps;
        return of_velocity * (all + constants) + of_place * all;
    }

    std::optional<double> limit(double y, const Method& method) const override {
        const auto step = host::find_integrator(method.integrator).oscillator_step;
        return limit_where(y, [&](double x) { return !step(0, x).is_stable(); });
    }

protected:
    void change(SceneFile& scene, double x, double y) const override {
        scene.set("world.step", x * time);
        scene.set("world.gravity", host::Triple{0, -y * start / time, 0});
    }

private:
    // Of the scene's file: s, m/s, time constants.
    static constexpr double time = 0.25, start = 0.0625, constants = 32;

    static double speed(double y) { return start * std::hypot(1, y); }
};

}  // namespace

std::unique_ptr<Map> make_drag() { return std::make_unique<DragMap>(); }

}  // namespace tumble::bench::stress
