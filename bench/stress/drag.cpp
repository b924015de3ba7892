// Drag times step over mass, against how gravity compares with the throw. Truth: the closed form. The error is the
// distance from the true place after each step, relative to the way that what is lost of the velocity takes. What
// drag takes for good is the energy of the velocity's distance from the final one; it never exceeds the start's.
//
// Rounding: a velocity that is off by one rounding moves on by one time constant's way, and a place stays off by one.
// What falls at its final speed is rounded the same way in every step, so that plain floats make N roundings of N
// steps; fixed point is dithered and makes sqrt(N), and what is carried stays at one. Rounded constants make a place
// that is off by as much of the whole way.
#include <algorithm>
#include <cmath>

#include "closed_form.hpp"
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

    using Map::measure;
    Measured measure(double x, double y, host::Simulation& simulation) const override {
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
