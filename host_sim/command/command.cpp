#include "command/command.hpp"

#include <tumble/version.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>

#include "firmware/firmware.hpp"
#include "scene/data.hpp"
#include "scene/reader.hpp"
#include "simulation/limits.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

// Refuses what an option got unless `holds` is true of it; CLI11 puts the option's name before the message.
template <class Test>
CLI::Validator expect(const std::string& wanted, const Test& holds) {
    return {[=](std::string& text) { return holds(text) ? std::string() : "got \"" + text + "\", expected " + wanted; },
            ""};
}
template <class Number, class Test>
CLI::Validator expect_number(const std::string& wanted, const Test& holds) {
    return expect(wanted, [=](const std::string& text) {
        Number number{};
        const char* const end = text.data() + text.size();
        const auto [last, code] = std::from_chars(text.data(), end, number);
        return code == std::errc{} && last == end && holds(number);
    });
}

CLI::Validator expect_file() {
    return expect("the name of a file", [](const std::string& text) { return !text.empty(); });
}
CLI::Validator expect_duration() {
    return expect_number<double>("a number of seconds >= 0",
                                 [](double seconds) { return std::isfinite(seconds) && seconds >= 0; });
}
template <class Number>
CLI::Validator expect_at_least(Number least, const std::string& of_what) {
    return expect_number<Number>("a whole number of " + of_what + " >= " + std::to_string(least),
                                 [=](Number number) { return number >= least; });
}

void add_choice(CLI::App& app, Choice& choice) {
    app.add_option("scene", choice.scene, "scene file (TOML)")->required()->type_name("SCENE.toml");
    app.add_option("--integrator", choice.integrator, "see `tumble list`")->capture_default_str()->type_name("NAME");
    app.add_option("--numbers", choice.numbers, "number system")->capture_default_str()->type_name("q32|f32|f64");
    app.add_option("--carry", choice.carry,
                   "carry the rounding residual of the state (default: on for q32 and f32, off for f64)")
        ->type_name("on|off")
        ->check(expect("on or off", [](const std::string& text) { return text == "on" || text == "off"; }));
    app.add_option("--step", choice.step, "step length in s, as 1/256 or 0.005, instead of the scene's")
        ->type_name("S")
        ->check(expect("a positive number of seconds or a fraction such as 1/256",
                       [](const std::string& text) { return parse_step(text).has_value(); }));
    app.add_option("--duration", choice.duration, "length of the run in s, instead of the scene's")
        ->type_name("T")
        ->check(expect_duration());
}

}  // namespace

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
    require_range(description, numbers);
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

void check_core(const std::string& name) {
    std::string known;
    for (const Core& core : cores()) {
        if (core.machine == "-") continue;
        if (core.name == name) return;
        known += (known.empty() ? "" : ", ") + core.name;
    }
    throw BadArgument("--core: got \"" + name + "\", expected one of " + known);
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
    CLI::App app{"Rigid bodies on small hardware: replay scenes on the host, compile them for firmware, compare the "
                 "two bit by bit."};
    app.name("tumble");
    app.set_version_flag("--version", "tumble " TUMBLE_VERSION ", bits " + std::to_string(TUMBLE_BITS),
                         "print the version of the command, and of the bits of its results");
    app.require_subcommand(1);
    app.footer("Exit status: 0 done, 1 the run failed or a comparison differs, 2 bad input.");

    RunOptions run_options;
    auto* run_command = app.add_subcommand("run", "replay a scene on the host");
    add_choice(*run_command, run_options);
    run_command->add_option("--trajectory", run_options.trajectory, "write every state as CSV")
        ->type_name("out.csv")
        ->check(expect_file());
    run_command->add_option("--every", run_options.every, "steps between rows of the trajectory")
        ->capture_default_str()
        ->type_name("K")
        ->check(expect_at_least<std::int64_t>(1, "steps"));
    run_command->add_flag("--json", run_options.json, "print one JSON object");
    run_command
        ->add_option("--plot", run_options.plot,
                     "plot positions, angular velocities and energies as SVG, with marks at impulses and contacts "
                     "(needs gnuplot)")
        ->type_name("out.svg")
        ->check(expect_file());

    CompileOptions compile_options;
    auto* compile_command = app.add_subcommand("compile", "write a scene as a C++ header for firmware");
    add_choice(*compile_command, compile_options);
    compile_command->add_option("-o,--output", compile_options.output, "the header; default: standard output")
        ->type_name("scene.hpp")
        ->check(expect_file());
    compile_command
        ->add_option("--struct", compile_options.name,
                     "name of the struct in the header; default: the file's name in PascalCase")
        ->type_name("NAME")
        ->check(expect("a name in C++ that no member of the struct has", is_struct_name));
    compile_command->add_flag("--no-bodies", compile_options.no_bodies,
                              "take a scene without bodies too: what a world costs before its first");

    CompareOptions compare_options;
    auto* compare_command = app.add_subcommand(
        "compare", "replay a scene on a core in QEMU and on the host, and compare every recorded bit");
    add_choice(*compare_command, compare_options);
    compare_command->add_option("--core", compare_options.core, "a core of `tumble list`")
        ->required()
        ->type_name("NAME");
    compare_command->add_option("--every", compare_options.every, "steps between recorded states")
        ->capture_default_str()
        ->type_name("K")
        ->check(expect_at_least<std::int64_t>(1, "steps"));
    compare_command->add_option("--timeout", compare_options.timeout, "seconds that the emulation may take")
        ->capture_default_str()
        ->type_name("S")
        ->check(expect_at_least<int>(1, "seconds"));
    compare_command
        ->add_option("--flip", compare_options.flip,
                     "self-test: flip one bit of the host's record at this step; the comparison must report it")
        ->type_name("STEP")
        ->check(expect_at_least<std::int64_t>(0, "steps"));

    AdviseOptions advise_options;
    auto* advise_command = app.add_subcommand(
        "advise", "measure which integrator, number system and step keep an error at the least cost on a core");
    advise_command->footer(
        "The error is the largest over 20 equally spaced times and all bodies, of positions in m and of orientations "
        "in "
        "rad, against\nan integration in long double; with contacts, against two fine runs in double precision that "
        "must agree to a tenth of E.\nThe cost is of a simulated second: cycles of the core at zero wait states, as "
        "its "
        "manual has them, or\ninstructions. Steps are the scene's times powers of two, at which every event keeps its "
        "time. Each method that\nis measured is built for the core; narrow the search to shorten that.\n"
        "Exit status: 0 something reaches E, 1 nothing does, 2 bad input.");
    advise_command->add_option("scene", advise_options.scene, "scene file (TOML)")->required()->type_name("SCENE.toml");
    advise_command->add_option("--core", advise_options.core, "a core of `tumble list`")->required()->type_name("NAME");
    advise_command->add_option("--tolerance", advise_options.tolerance, "the largest error, in m and in rad")
        ->required()
        ->type_name("E")
        ->check(expect_number<double>("a positive number, of metres and of radians",
                                      [](double error) { return std::isfinite(error) && error > 0; }));
    advise_command->add_option("--integrators", advise_options.integrators, "search only these; see `tumble list`")
        ->delimiter(',')
        ->type_name("NAME,...");
    advise_command->add_option("--numbers", advise_options.numbers, "search only these number systems")
        ->delimiter(',')
        ->type_name("q32,f32,f64");
    advise_command->add_option("--duration", advise_options.duration, "length of the run in s, instead of the scene's")
        ->type_name("T")
        ->check(expect_duration());
    advise_command
        ->add_option("--cost", advise_options.cost,
                     "what to rank by; default: cycles, or instructions on a core whose cycles are not published")
        ->type_name("cycles|insn")
        ->check(expect("cycles or insn", [](const std::string& text) { return text == "cycles" || text == "insn"; }));
    advise_command
        ->add_option_function<std::string>(
            "--clock", [&](const std::string& text) { advise_options.clock = parse_frequency(text); },
            "clock of the core, as 16MHz: say what share of a step's time its mean cost and its worst step take")
        ->type_name("F")
        ->check(expect("a positive frequency, as 16MHz, \"32.768 kHz\" or 48e6 (Hz)",
                       [](const std::string& text) { return parse_frequency(text).has_value(); }));
    advise_command->add_flag("--all", advise_options.all, "measure also what cannot be the cheapest");
    advise_command->add_flag("--json", advise_options.json, "print one JSON object");

    ProfileOptions profile_options;
    auto* profile_command = app.add_subcommand(
        "profile", "show where the cycles of a step go on a core, by functions and as a flame graph");
    profile_command->footer("Cycles are those that the core's manual gives, at zero wait states; the firmware is built "
                            "for the core and runs "
                            "in QEMU.");
    add_choice(*profile_command, profile_options);
    profile_command->add_option("--core", profile_options.core, "a core whose cycles are known")
        ->required()
        ->type_name("NAME");
    profile_command->add_option("--flame", profile_options.flame, "draw a flame graph as SVG")
        ->type_name("out.svg")
        ->check(expect_file());
    profile_command->add_option("--functions", profile_options.functions, "functions that the table names")
        ->capture_default_str()
        ->type_name("N")
        ->check(expect_at_least<int>(1, "functions"));
    profile_command->add_flag("--json", profile_options.json, "print one JSON object");
    profile_command->add_option("--timeout", profile_options.timeout, "seconds that the emulation may take")
        ->capture_default_str()
        ->type_name("S")
        ->check(expect_at_least<int>(1, "seconds"));

    app.add_subcommand("list", "name the integrators, number systems, ranges and cores");

    try {
        const auto all = app.get_subcommands([](const CLI::App*) { return true; });
        const bool names_one = argc > 1 && std::any_of(all.begin(), all.end(), [&](const CLI::App* each) {
                                   return each->get_name() == argv[1];
                               });
        if (argc > 1 && argv[1][0] != '-' && !names_one)
            throw BadArgument("got \"" + std::string(argv[1]) +
                              "\", expected run, compile, compare, advise, profile or list");
        app.parse(argc, argv);
        if (run_command->parsed()) {
            if (run_command->count("--every") > 0 && run_options.trajectory.empty())
                std::cerr << "warning: --every has no effect without --trajectory\n";
            return run(run_options);
        }
        if (compile_command->parsed()) return compile(compile_options);
        if (compare_command->parsed()) return compare(compare_options);
        if (advise_command->parsed()) return advise(advise_options);
        if (profile_command->parsed()) return profile(profile_options);
        return list();
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? done : bad_input;
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
