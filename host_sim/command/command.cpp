#include "command/command.hpp"

#include <algorithm>
#include <iostream>

#include "command/messages.hpp"
#include "firmware/firmware.hpp"
#include "scene/data.hpp"
#include "scene/scene_file.hpp"
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
        throw std::invalid_argument("--step, --duration: got more than 2^31 steps, expected at most " +
                                    std::to_string(max_steps));
    (void)find_number_system(description, numbers, wants_carry());
    require_runs_in(method, numbers);
    require_range(description, numbers);
    for (const std::string& limitation : limitations(description)) warn(limitation);
    return description;
}

void Choice::warn(const std::string& of) const { std::cerr << "warning: " << scene << ": " << of << "\n"; }

std::unique_ptr<Simulation> Choice::start(const SceneDescription& description) const {
    auto simulation = make_simulation(description, integrator, numbers, wants_carry());
    const ContactDescription& contact = description.contact;
    const auto used = static_cast<double>(simulation->contact_tolerance());
    // A tolerance that the numbers can represent is rounded by less than a sixteenth.
    if (contact.response == ContactResponse::impulse && used > contact.tolerance * 17 / 16)
        warn("contact.tolerance = " + few_digits(contact.tolerance) + " m is too small for " + numbers +
             " beside this scene's largest body or way in a step: " + few_digits(used) + " m is used");
    if (const std::string unheld = unheld_spin(description, *simulation); !unheld.empty()) warn(unheld);
    return simulation;
}

std::string json_of_motion(const std::string& name, const BodySnapshot& body, const std::string& separator) {
    return "\"name\": " + json_text(name) + separator + "\"position_m\": " + json_array(body.position) + separator +
           "\"velocity_m_s\": " + json_array(body.velocity) + separator +
           "\"orientation\": " + json_array(body.orientation) + separator +
           "\"angular_velocity_rad_s\": " + json_array(body.angular_velocity);
}

bool takes_standard_output(const std::vector<FileArgument>& outputs, bool json) {
    std::vector<std::string> taking;
    for (const FileArgument& output : outputs)
        if (output.path == standard_output) taking.push_back(output.argument);
    const bool is_taken = !taking.empty();
    if (json) taking.emplace_back("--json");
    if (is_taken && taking.size() > 1)
        throw std::invalid_argument(joined(taking) + ": got standard output for each of them, expected it for one");
    return is_taken;
}

void check_core(const std::string& name) {
    std::vector<std::string> names;
    for (const Core& core : cores())
        if (core.machine != "-") names.push_back(core.name);
    if (std::find(names.begin(), names.end(), name) != names.end()) return;
    throw std::invalid_argument("--core: got " + in_quotes(name) + suggestion(name, names) + ", expected one of " +
                                joined(names));
}

std::string cores_with_cycles() {
    std::vector<std::string> names;
    for (const Core& core : cores())
        if (core.has_cycles()) names.push_back(core.name);
    return joined(names);
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
    } catch (const std::invalid_argument& error) {
        std::cerr << "tumble: " << error.what() << "\n";
        return bad_input;
    } catch (const std::exception& error) {
        std::cerr << "tumble: " << error.what() << "\n";
        return failed;
    }
}

}  // namespace tumble::host
