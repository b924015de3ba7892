#include "command/messages.hpp"

#include <algorithm>
#include <cmath>

#include "scene/reader.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

std::string step_of(const Simulation& simulation) { return few_digits(simulation.step_length()) + " s"; }

// "q32 room"
std::string numbers_of(const Simulation& simulation) {
    return std::string(simulation.numbers()) + (simulation.range().empty() ? "" : " ") +
           std::string(simulation.range());
}

// By rule: a shorter step holds larger spins, a larger [range] larger positions and velocities.
std::string cure_of(const HeldNumber& number, const SceneDescription& scene, const Simulation& simulation) {
    const std::string shorter =
        "--step " + step_text({scene.step.numerator, scene.step.denominator * 2, scene.step.decimal / 2});
    if (number.name == "angular velocity" && !simulation.range().empty())
        return "a larger [range] angular_velocity and a smaller step, or --numbers f32";
    if (number.name == "angular velocity" || number.name.starts_with("change")) return shorter;
    if (number.is_declared || held_by(simulation.range()).position < held_by("field").position)
        return "a larger [range] " + number.name;
    return "--numbers f64";
}

std::string range_left(const Trouble& trouble, const SceneDescription& scene, const Simulation& simulation,
                       const std::string& cure) {
    if (!trouble.number)
        return "a number is not finite. The motion is wrong from here on. Use " +
               (cure.empty() ? "a smaller step" : cure);
    const HeldNumber& number = *trouble.number;
    const std::string holder =
        number.is_declared ? "q32 holds of the declared [range]" : numbers_of(simulation) + " holds";
    return number.name + " exceeds " + few_digits(number.most) + " " + number.unit + ", the most that " + holder +
           " at a step of " + step_of(simulation) + ". The motion is wrong from here on. Use " +
           (cure.empty() ? cure_of(number, scene, simulation) : cure);
}

std::string step_too_long(const Simulation& simulation, const std::string& cure) {
    const long double safe = simulation.largest_safe_step();
    if (safe > 0)
        return "a contact spring is too stiff for the step of " + step_of(simulation) +
               ". The energy grows. Use a step of at most " + four_digits_down(0.999L * safe) + " s";
    return "a spring, a damper, drag or gravitation is too strong for the step of " + step_of(simulation) +
           ". The energy grows. Use " + (cure.empty() ? "a smaller step" : cure);
}

}  // namespace

std::string message_of(const Trouble& trouble, const SceneDescription& scene, const Simulation& simulation,
                       const std::string& cure) {
    const double time = static_cast<double>(trouble.step) * scene.step.seconds();
    const std::string place = scene.path + ": body \"" + scene.bodies.at(static_cast<std::size_t>(trouble.body)).name +
                              "\" at " + few_digits(time) + " s (step " + std::to_string(trouble.step) +
                              "): " + trouble.issue + ": ";
    if (trouble.issue == "range_left") return place + range_left(trouble, scene, simulation, cure);
    if (trouble.issue == "step_too_long") return place + step_too_long(simulation, cure);
    if (trouble.issue == "step_bound_hit" && simulation.integrator().starts_with("implicit"))
        return place +
               "the implicit solver did not converge, or the impacts of a step met their bound. The result is less "
               "accurate. Use a smaller step";
    if (trouble.issue == "step_bound_hit")
        return place + "a step met more impacts than its bound, so a body was stopped that would have bounced. The "
                       "result is less "
                       "accurate. Set a contact.restitution_threshold, in m/s, above the speed of the small bounces";
    if (trouble.issue == "contacts_full")
        return place + "more pairs are near each other than the world has room for, so some bodies pass through others";
    return place + "there is no room for another body";
}

std::string unheld_spin(const SceneDescription& scene, const Simulation& simulation) {
    const double declared = scene.range.angular_velocity;
    if (declared <= RangeDescription{}.angular_velocity) return {};
    int least = 0;
    for (int b = 1; b < simulation.body_count(); ++b)
        if (simulation.held_spin(b) < simulation.held_spin(least)) least = b;
    const double held = simulation.body_count() > 0 ? simulation.held_spin(least) : declared;
    if (held >= declared) return {};
    return "[range] asks for spins up to " + few_digits(declared) + " rad/s, but " + numbers_of(simulation) +
           " holds " + four_digits_down(held) + " rad/s of body \"" + scene.body(least).name + "\" at a step of " +
           step_of(simulation) + ". Use a step of at most " +
           four_digits_down(simulation.step_length() * static_cast<long double>(held / declared)) + " s";
}

}  // namespace tumble::host
