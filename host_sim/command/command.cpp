#include "command/command.hpp"

#include <tumble/version.hpp>

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
    const Expected named{"a name", [](const std::string& text) { return !text.empty(); }};
    command.add(integrator, "--integrator NAME", "see `tumble list` (default: the scene's [expect], else verlet)",
                named);
    command.add(numbers, "--numbers q32|f32|f64", "number system (default: the scene's [expect], else q32)", named);
    command.add(carry, "--carry on|off",
                "carry the rounding residual of the state (default: the scene's [expect], else on for q32 and f32, off "
                "for f64)",
                one_of("on", "off"));
    command.add(step, "--step S", "step length in s, as 1/256 or 0.005, instead of the scene's",
                {"a positive number of seconds or a fraction such as 1/256",
                 [](const std::string& text) { return parse_step(text).has_value(); }});
    command.add(duration, "--duration T", "length of the run in s, instead of the scene's", host::duration());
}

Method Choice::method(const SceneDescription& description) const {
    const auto& expected = description.expected;
    Method method{integrator, numbers};
    if (integrator.empty()) method.integrator = expected ? expected->integrator : "verlet";
    if (numbers.empty()) method.numbers = expected ? expected->numbers : "q32";
    const bool is_expected = expected && expected->carry && method.numbers == expected->numbers;
    method.carry = !carry.empty() ? carry == "on" : is_expected ? *expected->carry : default_carry(method.numbers);
    return method;
}

SceneDescription Choice::read() const {
    if (!integrator.empty()) (void)find_integrator(integrator);
    SceneDescription description = read_scene(scene, no_bodies ? BodyCount::any : BodyCount::at_least_one);
    if (!step.empty()) description.step = parse_step(step).value();
    if (duration) description.duration = *duration;
    if (description.steps() > max_steps)
        throw std::invalid_argument("--step, --duration: got more than 2^31 steps, expected at most " +
                                    std::to_string(max_steps));
    const Method chosen = method(description);
    (void)find_number_system(description, chosen.numbers, chosen.carry);
    require_runs_in(find_integrator(chosen.integrator), chosen.numbers);
    require_range(description, chosen.numbers);
    if (const auto& expected = description.expected; expected && !is_expected(description))
        warn("[expect] is of " + expected->integrator + " in " + expected->numbers +
             (expected->carry && *expected->carry != default_carry(expected->numbers)
                  ? *expected->carry ? " with carry" : " without carry"
                  : "") +
             " at the scene's own step and duration. This run is another, and is not held against it");
    for (const std::string& limitation : limitations(description)) warn(limitation);
    // A recorded session may have ended before its scene.
    if (is_expected(description) && description.expected->steps < description.steps())
        description.duration = static_cast<double>(description.expected->steps) * description.step.seconds();
    return description;
}

bool Choice::is_expected(const SceneDescription& description) const {
    const auto& expected = description.expected;
    if (!expected || !step.empty() || duration) return false;
    const Method chosen = method(description);
    return chosen.integrator == expected->integrator && chosen.numbers == expected->numbers &&
           chosen.carry == expected->carry.value_or(default_carry(expected->numbers));
}

bool Choice::is_as_expected(const SceneDescription& description, const Simulation& simulation) const {
    if (!is_expected(description)) return true;
    const Expectation& expected = *description.expected;
    if (simulation.steps_taken() == expected.steps && simulation.hash() == expected.hash) return true;
    const auto ending = [](std::uint64_t hash, std::int64_t steps) {
        return "hash " + hex(hash) + " after " + std::to_string(steps) + " steps";
    };
    std::cerr << scene << ": expect: got " << ending(simulation.hash(), simulation.steps_taken()) << ", expected "
              << ending(expected.hash, expected.steps);
    if (expected.bits != TUMBLE_BITS)
        std::cerr << ". The file is of bits " << expected.bits << ", and this command has bits " << TUMBLE_BITS
                  << ", whose results differ";
    std::cerr << "\n";
    return false;
}

void Choice::warn(const std::string& of) const { std::cerr << "warning: " << scene << ": " << of << "\n"; }

std::unique_ptr<Simulation> Choice::start(const SceneDescription& description) const {
    const Method chosen = method(description);
    auto simulation = make_simulation(description, chosen.integrator, chosen.numbers, chosen.carry);
    const ContactDescription& contact = description.contact;
    const auto used = static_cast<double>(simulation->contact_tolerance());
    // A tolerance that the numbers can represent is rounded by less than a sixteenth.
    if (contact.response == ContactResponse::impulse && used > contact.tolerance * 17 / 16)
        warn("contact.tolerance = " + few_digits(contact.tolerance) + " m is too small for " + chosen.numbers +
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

std::string json_of_joint(const JointDescription& description, const JointSnapshot& joint,
                          const std::string& separator) {
    const auto number = [&](const char* key, const std::optional<double>& value) {
        return separator + json_text(key) + ": " + (value ? json_number(*value) : "null");
    };
    return "\"name\": " + json_text(description.name) + separator +
           "\"kind\": " + json_text(word_of(description.kind)) + number("angle_rad", joint.angle) +
           number("speed_rad_s", joint.speed) + number("to_angle_rad", joint.to_angle) +
           number("to_speed_rad_s", joint.to_speed) + number("travel_m", joint.travel) +
           number("speed_m_s", joint.travel_speed) + separator + "\"force_n\": " + json_array(joint.force) + separator +
           "\"torque_n_m\": " + json_array(joint.torque) + separator +
           "\"at_limit\": " + (joint.at_limit ? std::to_string(*joint.at_limit) : "null") + separator +
           "\"broken\": " + (joint.broken ? "true" : "false") + separator +
           "\"corrections\": " + std::to_string(joint.corrections) + number("gap_m", joint.gap) +
           number("gap_rad", joint.lean);
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
        for (const auto add : {add_run, add_compile, add_compare, add_advise, add_profile, add_view, add_list})
            add(line);
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
