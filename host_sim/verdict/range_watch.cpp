#include "verdict/range_watch.hpp"

#include <algorithm>
#include <cmath>

namespace tumble::host {
namespace {

// Of a range: initial values may lie at its end, and rounding takes them beyond.
constexpr double rounding_of_range = 1.0 / 1024;

// The smallest that is not below x > 0.
double next_power_of_two(double x) {
    int exponent = 0;
    return std::frexp(x, &exponent) == 0.5 ? x : std::ldexp(1.0, exponent);
}

}  // namespace

RangeWatch::RangeWatch(const SceneDescription& scene, const Simulation& simulation)
    : is_on_{scene.range.is_declared && simulation.range().empty()} {
    const RangeDescription held = held_by(find_number_system(scene, "q32", {}).range);
    const auto step = static_cast<double>(simulation.step_length());
    const double velocity = next_power_of_two(held.velocity * step) / step;
    // What every method holds about every axis. A method that keeps the angular momentum holds up to twice the spin
    // about some axes.
    const double spin = next_power_of_two(held.angular_velocity * step) / step;
    bounds_ = {{{"position", &BodySnapshot::position, held.position, "m"},
                {"velocity", &BodySnapshot::velocity, velocity, "m/s"},
                {"angular velocity", &BodySnapshot::angular_velocity, spin, "rad/s"}}};
}

void RangeWatch::see(const Simulation& simulation) {
    if (!is_on_ || trouble_) return;
    for (int b = 0; b < simulation.body_count(); ++b) {
        const BodySnapshot body = simulation.body(b);
        for (const Bound& bound : bounds_) {
            const auto& now = body.*bound.number;
            const long double most = bound.most * (1 + rounding_of_range);
            if (std::none_of(now.begin(), now.end(), [&](long double x) { return std::abs(x) > most; })) continue;
            trouble_ = Trouble{"range_left", b, simulation.steps_taken() - 1,
                               HeldNumber{bound.of, bound.most, bound.unit, true}};
            return;
        }
    }
}

}  // namespace tumble::host
