#include "command/command.hpp"

#include <algorithm>
#include <iostream>

#include "firmware/firmware.hpp"
#include "scene/data.hpp"
#include "scene/reader.hpp"
#include "simulation/limits.hpp"
#include "tools/text.hpp"

namespace tumble::host {

void Choice::add_to(Subcommand& command) {
    command.require(scene, "scene SCENE.toml", "scene file (TOML), or - for standard input", input_file());
    command.add(integrator, "--integrator NAME", "see `tumble list`");
    command.add(numbers, "--numbers q32|f32|f64", "number system");
    command.add(carry, "--carry on|off",
                "carry the rounding residual of the state (default: on for q32 and f32, off for f64)",
                one_of("on", "off"));
    command.add(step, "--step S", "step length in s, as 1/256 or 0.005, instead of the scene's",
                {"a positive number of seconds or a fraction such as 1/256",
                 [](const std::string& text) { return parse_step(text).has_value(); }});
    command.add(duration, "--duration T", "length of the run in s, instead of the scene's", host::duration());
}

SceneDescription Choice::read() const {
    const IntegratorInfo& method = find_integrator(integrator);
    SceneDescription description = read_scene(scene, no_bodies ? BodyCount::any : BodyCount::at_least_one);
    if (!step.empty()) description.step = parse_step(step).value();
    if (duration) description.duration = *duration;
    if (description.steps() > max_steps)
        throw BadArgument("--step, --duration: got more than 2^31 steps, expected at most " +
                          std::to_string(max_steps));
    (void)find_number_system(description, numbers, wants_carry());
    require_runs_in(method, numbers);
    for (const std::string& limitation : limitations(description)) warn(limitation);
    if (is_run)
        for (const Limit& limit : exceeded_limits(description, integrator, numbers, wants_carry()))
            warn(limit.sentence);
    return description;
}

void Choice::warn(const std::string& of) const { std::cerr << "warning: " << scene << ": " << of << "\n"; }

std::unique_ptr<Simulation> Choice::start(const SceneDescription& description) const {
    auto simulation = make_simulation(description, integrator, numbers, wants_carry());
    const ContactDescription& contact = description.contact;
    const auto used = static_cast<double>(simulation->contact_tolerance());
    // A tolerance that is resolved is off by less than a sixteenth of itself.
    if (contact.response == ContactResponse::impulse && used > contact.tolerance * 17 / 16)
        warn("contact.tolerance = " + few_digits(contact.tolerance) + " m is too small for " + numbers +
             " beside this scene's largest body or way in a step: " + few_digits(used) + " m is used");
    return simulation;
}

bool takes_standard_output(const std::vector<FileArgument>& outputs, bool json) {
    std::vector<std::string> taking;
    for (const FileArgument& output : outputs)
        if (output.path == standard_output) taking.push_back(output.argument);
    const bool is_taken = !taking.empty();
    if (json) taking.emplace_back("--json");
    if (is_taken && taking.size() > 1)
        throw BadArgument(joined(taking) + ": got standard output for each of them, expected it for one");
    return is_taken;
}

void check_core(const std::string& name) {
    std::vector<std::string> names;
    for (const Core& core : cores())
        if (core.machine != "-") names.push_back(core.name);
    if (std::find(names.begin(), names.end(), name) != names.end()) return;
    throw BadArgument("--core: got " + in_quotes(name) + suggestion(name, names) + ", expected one of " +
                      joined(names));
}

std::string message_of(const Trouble& trouble, const SceneDescription& scene, const Simulation& simulation) {
    const std::string body = scene.bodies.at(static_cast<std::size_t>(trouble.body)).name;
    const double time = static_cast<double>(trouble.step) * scene.step.seconds();
    std::string message = scene.path + ": body \"" + body + "\" at " + few_digits(time) + " s (step " +
                          std::to_string(trouble.step) + "): " + trouble.issue + ": ";
    if (!trouble.why.empty()) message += trouble.why;
    else if (trouble.issue == "range_left" && simulation.range().empty())
        message += "a number is not finite, or the body turns too far in a step. Take a smaller step";
    else if (trouble.issue == "range_left")
        message +=
            "left what fixed point holds: of place and velocity the declared [range], a quarter of it as the change "
            "of a velocity in a step; of spin a quarter of a radian a step, whatever the range, and half of that "
            "about the axis of a disc with methods that keep the angular momentum, as verlet does. Take a smaller "
            "step, or declare a larger [range] for place and velocity";
    else if (trouble.issue == "step_bound_hit")
        message += "an iteration met its bound, so the result is less accurate; take a smaller step";
    else if (trouble.issue == "contacts_full")
        message += "more pairs of bodies near each other than there is room for, so some pass through each other";
    else if (trouble.issue == "step_too_long")
        message +=
            simulation.largest_safe_step() > 0
                ? "contact spring too stiff for the step of " + few_digits(simulation.step_length()) +
                      " s: the largest safe step is " + four_digits_down(0.999 * simulation.largest_safe_step()) + " s"
                : "the step of " + few_digits(simulation.step_length()) +
                      " s is too long for what acts and adds to the energy: a spring too stiff, damping or drag too "
                      "strong, or two bodies that attract each other too near; take a smaller step";
    else message += "no room for another body";
    return message;
}

int command(int argc, const char* const* argv) {
    try {
        CommandLine line;
        for (const auto add : {add_run, add_compile, add_compare, add_advise, add_profile, add_list}) add(line);
        return line.run(argc, argv);
    } catch (const SceneError& error) {
        std::cerr << error.what() << "\n";
        return bad_input;
    } catch (const UnsupportedScene& error) {
        std::cerr << error.what() << "\n";
        return bad_input;
    } catch (const BadArgument& error) {
        std::cerr << "tumble: " << error.what() << "\n";
        return bad_input;
    } catch (const std::invalid_argument& error) {
        std::cerr << "tumble: " << error.what() << "\n";
        return bad_input;
    } catch (const std::exception& error) {
        std::cerr << "tumble: " << error.what() << "\n";
        return failed;
    }
}

}  // namespace tumble::host
