#include "command/messages.hpp"

#include <algorithm>
#include <cmath>

#include "scene/reader.hpp"
#include "tools/text.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {
namespace {

std::string step_of(const Simulation& simulation) { return few_digits(simulation.step_length()) + " s"; }

// "q32 room"
std::string numbers_of(const Simulation& simulation) {
    return std::string(simulation.numbers()) + (simulation.range().empty() ? "" : " ") +
           std::string(simulation.range());
}

// The longest step, of halvings of the scene's, at which floating point holds the spin that a body has now.
std::string step_that_holds(const HeldNumber& spin, int body, const SceneDescription& scene,
                            const Simulation& simulation) {
    const auto w = simulation.body(body).angular_velocity;
    const auto now = static_cast<double>(std::hypot(w[0], w[1], w[2]));
    const double halvings = std::isfinite(now) ? std::ceil(std::log2(now / spin.most)) : 1;
    return step_text(scaled(scene.step, -static_cast<int>(std::max(1.0, halvings))));
}

// The key of [range] that declares the number.
std::string key_of(const HeldNumber& number) {
    return number.name == "angular velocity" ? "angular_velocity" : number.name;
}

// By rule: a shorter step holds larger spins, a larger [range] larger positions and velocities.
std::string cure_of(const HeldNumber& number, int body, const SceneDescription& scene, const Simulation& simulation) {
    const bool is_fixed_point = !simulation.range().empty();
    if (number.is_declared) return "a larger [range] " + key_of(number);
    if (number.name.starts_with("change")) return "a smaller step or a larger [range] velocity";
    if (number.name == "angular velocity" && is_fixed_point)
        return std::string("a larger [range] angular_velocity and a smaller step") +
               (scene.range.is_declared ? "" : ", or --numbers f32");
    if (number.name == "angular velocity") return "--step " + step_that_holds(number, body, scene, simulation);
    if (held_by(simulation.range()).position < held_by("field").position) return "a larger [range] " + key_of(number);
    return scene.range.is_declared ? "--numbers f64 and no [range]" : "--numbers f64";
}

// What has happened, what helps by rule, and what helps too, beside a way that is known to be right.
struct Account {
    std::string what, cure, beside{};
};

Account range_left(const Trouble& trouble, const SceneDescription& scene, const Simulation& simulation) {
    const std::string wrong = ". The motion is wrong from here on";
    if (trouble.body < 0)
        return {"gravity exceeds the most that " + numbers_of(simulation) + " holds at a step of " +
                    step_of(simulation) + wrong,
                "a smaller step or a larger [range] velocity"};
    if (!trouble.number) return {"a number is not finite" + wrong, "a smaller step"};
    const HeldNumber& number = *trouble.number;
    const std::string holder =
        number.is_declared ? "q32 holds of the declared [range]" : numbers_of(simulation) + " holds";
    // Floating point goes on beyond a declared range.
    const std::string after = number.is_declared ? ". A run in q32 would be wrong from here on" : wrong;
    const std::string spin =
        number.or_spin > 0 ? ", or change of spin in a step exceeds " + few_digits(number.or_spin) + " rad/s" : "";
    return {number.name + " exceeds " + few_digits(number.most) + " " + number.unit + spin + ", the most that " +
                holder + " at a step of " + step_of(simulation) + after,
            cure_of(number, trouble.body, scene, simulation)};
}

// "a spring, a damper or drag": what acts in the scene and may be too strong.
std::string strong_loads(const SceneDescription& scene) {
    std::vector<std::string> loads;
    const auto has = [&](double SpringDescription::*number) {
        return std::any_of(scene.springs.begin(), scene.springs.end(), [&](const auto& s) { return s.*number > 0; });
    };
    const auto joint_has = [&](double JointSpringDescription::*number) {
        return std::any_of(scene.joints.begin(), scene.joints.end(),
                           [&](const auto& j) { return j.spring.*number > 0 || j.to_spring.*number > 0; });
    };
    if (has(&SpringDescription::stiffness) || joint_has(&JointSpringDescription::stiffness))
        loads.emplace_back("a spring");
    if (has(&SpringDescription::damping) || joint_has(&JointSpringDescription::damping)) loads.emplace_back("a damper");
    // The kernel does not judge a body's own drag.
    if (scene.linear_drag > 0 || scene.angular_drag > 0) loads.emplace_back("drag");
    if (scene.gravitation > 0) loads.emplace_back("gravitation");
    if (!scene.joints.empty()) loads.emplace_back("the force of a joint on a light or fast link");
    std::string text;
    for (std::size_t i = 0; i < loads.size(); ++i)
        text += (i == 0 ? "" : i + 1 == loads.size() ? " or " : ", ") + loads[i];
    return text.empty() ? "a contact spring" : text;
}

Account step_too_long(const SceneDescription& scene, const Simulation& simulation) {
    const long double safe = simulation.largest_safe_step();
    const std::string step = " for the step of " + step_of(simulation) + ". The method may be unstable at this step";
    if (safe > 0)
        return {"a contact spring is too stiff" + step, "a step of at most " + four_digits_down(0.999L * safe) + " s"};
    return {strong_loads(scene) + " is too strong" + step, "a smaller step"};
}

Account joints_not_closed(const Trouble& trouble, const Simulation& simulation) {
    Account account{"joints did not close in a 32nd of the step, so their bodies were moved until they were, and lost "
                    "energy",
                    "a smaller step, or heavier links"};
    if (!trouble.number) return account;
    account.what += ". A body was faster than " + few_digits(trouble.number->most) + " m/s, a quarter of what " +
                    numbers_of(simulation) + " holds: a joint may not end so much at once";
    account.beside = "a larger [range] velocity";
    return account;
}

Account account_of(const Trouble& trouble, const SceneDescription& scene, const Simulation& simulation) {
    if (trouble.issue == "range_left") return range_left(trouble, scene, simulation);
    if (trouble.issue == "step_too_long") return step_too_long(scene, simulation);
    if (trouble.issue == "contacts_full")
        return {"more pairs are near each other than the world has room for, so some bodies pass through others", ""};
    const ContactDescription& contact = scene.contact;
    if (trouble.issue == "left_over" && contact.most_impacts == 0 && contact.most_searches == 0 &&
        contact.most_sweeps == 0)
        return {"bodies that step in bounded time overlap by more than 16 tolerances",
                "a smaller step, or a larger contact.exact_bodies"};
    if (trouble.issue == "left_over")
        return {
            "a step used up the impacts, searches or sweeps that [contact] allows. The rest was resolved in the next "
            "step, and bodies overlapped until then",
            "larger contact.most_impacts, contact.most_searches and contact.most_sweeps, or a smaller step"};
    if (trouble.issue == "joint_open")
        return {"a joint is open, because a pose does not fit it or the step is too long by far. The motion is wrong "
                "from here on",
                "poses that fit all joints of their bodies, or a smaller step"};
    const bool of_joints = trouble.body < 0 ? !scene.joints.empty() : scene.is_jointed(trouble.body);
    if (trouble.issue == "step_bound_hit" && of_joints) return joints_not_closed(trouble, simulation);
    if (trouble.issue != "step_bound_hit") return {"there is no room for another body", ""};
    if (const std::string_view method = simulation.integrator();
        method.starts_with("implicit") || method.starts_with("pdmv"))
        return {
            "the solver of the method did not converge, or the impacts of a step met their bound. The result is less "
            "accurate",
            "a smaller step"};
    return {"a step met more impacts than its bound, so a body was stopped that would have bounced, or a heavy body "
            "presses lighter ones into each other, or a tall stack leans and walks off. The result is less accurate",
            "a smaller step, a contact.restitution_threshold above the speed of the small bounces, in m/s, or masses "
            "that differ less"};
}

}  // namespace

std::string message_of(const Trouble& trouble, const Trouble& first, const SceneDescription& scene,
                       const Simulation& simulation, const std::string& cure) {
    const double time = static_cast<double>(trouble.step) * scene.step.seconds();
    Account account = account_of(trouble, scene, simulation);
    const bool is_first = &trouble == &first;
    if (is_first && !cure.empty()) account.cure = cure;
    // What was unstable leaves the range: the cure of the first is that of both.
    if (!is_first && (!cure.empty() || first.issue == "step_too_long")) account.cure.clear();
    else if (!account.beside.empty()) account.cure += ", or " + account.beside;
    const std::string body =
        trouble.body < 0 ? "" : "body \"" + scene.bodies.at(static_cast<std::size_t>(trouble.body)).name + "\" at ";
    return scene.path + ": " + body + few_digits(time) + " s (step " + std::to_string(trouble.step) +
           "): " + trouble.issue + ": " + account.what + (account.cure.empty() ? "" : ". Use " + account.cure);
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
