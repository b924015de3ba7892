// `tumble run`.
#include <tumble/version.hpp>

#include <algorithm>
#include <iomanip>
#include <iostream>
#include <limits>
#include <optional>

#include "command/check.hpp"
#include "command/command.hpp"
#include "command/gltf.hpp"
#include "command/live.hpp"
#include "command/plot.hpp"
#include "command/run_watch.hpp"
#include "simulation/start_impact.hpp"
#include "tools/gnuplot.hpp"
#include "tools/output.hpp"
#include "tools/progress.hpp"
#include "tools/text.hpp"
#include "verdict/record.hpp"

namespace tumble::host {
namespace {

struct RunOptions : Choice {
    std::string trajectory, contacts, joints, plot, gltf;  // files; empty: none
    std::optional<std::int64_t> every;  // steps between rows of the trajectory and of the contacts, and key frames
    bool json = false, imu = false, live = false;
    std::string record;  // file; empty: none
    CheckOptions check;
};

// A file of comma-separated values, to which a run adds rows.
class Table {
public:
    Table(const std::string& path, const char* option, const std::string& columns) : file_(path, option) {
        file_.stream() << columns << "\n";
    }
    // The names of bodies, planes or joints as fields.
    template <class Named>
    [[nodiscard]] static std::vector<std::string> fields(const std::vector<Named>& list) {
        std::vector<std::string> names;
        for (const Named& each : list) names.push_back(csv_field(each.name));
        return names;
    }
    // The stream, for the first fields of a row.
    [[nodiscard]] std::ostream& row() { return file_.stream(); }
    void add(long double x) { file_.stream() << "," << seventeen_digits(x); }
    template <class T, std::size_t count>
    void add(const std::array<T, count>& numbers) {
        for (const T x : numbers) add(x);
    }
    void end_row() { file_.stream() << "\n"; }
    // False when rows have been lost.
    [[nodiscard]] bool good() const { return file_.good(); }
    void close() { file_.commit(); }

private:
    OutputFile file_;
};

class Trajectory : public Table {
public:
    Trajectory(const std::string& path, std::int64_t every, bool imu, const SceneDescription& scene)
        : Table(path, "--trajectory",
                std::string("time_s,body,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz") + (imu ? ",fx,fy,fz,gx,gy,gz" : "")),
          every_(every), imu_(imu), names_(fields(scene.bodies)) {}
    void record(const Simulation& simulation, bool last) {
        if (simulation.steps_taken() % every_ != 0 && !last) return;
        const std::string time = seventeen_digits(simulation.time());
        for (int b = 0; b < simulation.body_count(); ++b) {
            const BodySnapshot body = simulation.body(b);
            row() << time << "," << names_[static_cast<std::size_t>(b)];
            add(body.position);
            add(body.velocity);
            add(body.orientation);
            add(body.angular_velocity);
            if (imu_) {
                const ImuSnapshot imu = simulation.imu(b);
                add(imu.specific_force);
                add(imu.angular_velocity);
            }
            end_row();
        }
    }

private:
    std::int64_t every_;
    bool imu_;
    std::vector<std::string> names_;
};

// A file of its own: a joint is no body, and readers of a trajectory count on its columns and on a row for each body. A
// field that the joint's kind has not is empty.
class JointRows : public Table {
public:
    JointRows(const std::string& path, std::int64_t every, const SceneDescription& scene)
        : Table(path, "--joints",
                "time_s,joint,angle,speed,to_angle,to_speed,travel,travel_speed,fx,fy,fz,tx,ty,tz,at_limit,broken,"
                "corrections,gap,gap_angle"),
          every_(every), names_(fields(scene.joints)) {}
    void record(const Simulation& simulation, bool last) {
        if (simulation.steps_taken() % every_ != 0 && !last) return;
        const std::string time = seventeen_digits(simulation.time());
        for (std::size_t j = 0; j < names_.size(); ++j) {
            const JointSnapshot joint = simulation.joint(static_cast<int>(j));
            row() << time << "," << names_[j];
            const auto add_if_there = [&](const std::optional<double>& number) {
                if (number) add(*number);
                else row() << ",";
            };
            for (const auto& number :
                 {joint.angle, joint.speed, joint.to_angle, joint.to_speed, joint.travel, joint.travel_speed})
                add_if_there(number);
            add(joint.force);
            add(joint.torque);
            row() << "," << (joint.at_limit ? std::to_string(*joint.at_limit) : "") << "," << joint.broken << ","
                  << joint.corrections;
            add_if_there(joint.gap);
            add_if_there(joint.lean);
            end_row();
        }
    }

private:
    std::int64_t every_;
    std::vector<std::string> names_;
};

// What touched, began, ended or hit in each step.
class ContactRows : public Table {
public:
    ContactRows(const std::string& path, std::int64_t every, const SceneDescription& scene)
        : Table(path, "--contacts",
                "time_s,body,other,touches,began,ended,hit_speed,nx,ny,nz,depth,px,py,pz,normal_impulse,jx,jy,jz"),
          every_(every), bodies_(fields(scene.bodies)), planes_(fields(scene.planes)) {}
    // Events of every step, and of every K-th step what touches.
    void record(const Simulation& simulation, bool last) {
        const bool all = simulation.steps_taken() % every_ == 0 || last;
        const std::string time = seventeen_digits(simulation.time());
        for (const ContactSnapshot& c : simulation.contacts()) {
            if (!all && !c.began && !c.ended && !(c.hit_speed > 0)) continue;
            row() << time << "," << bodies_[static_cast<std::size_t>(c.body)] << ","
                  << (c.other < 0 ? planes_[static_cast<std::size_t>(c.plane)]
                                  : bodies_[static_cast<std::size_t>(c.other)])
                  << "," << c.touches << "," << c.began << "," << c.ended;
            add(c.hit_speed);
            add(c.normal);
            add(c.depth);
            add(c.point);
            add(c.normal_impulse);
            add(c.friction_impulse);
            end_row();
        }
    }

private:
    std::int64_t every_;
    std::vector<std::string> bodies_, planes_;
};

// Keys that do not apply are null.
std::string json_of(const Verdict& verdict, const SceneDescription& scene, const Simulation& simulation) {
    using enum Verdict::Kind;
    const bool has_time = verdict.kind == wrong || verdict.kind == told || verdict.kind == no_reference,
               has_errors = verdict.kind != unchecked;
    const auto number = [](bool is_there, double value) { return is_there ? json_number(value) : std::string("null"); };
    const auto text = [](const std::string& value) { return value.empty() ? std::string("null") : json_text(value); };
    std::string shared;
    for (const SharedRule rule : verdict.rules) shared += (shared.empty() ? "[" : ", ") + json_text(name_of(rule));
    shared = verdict.kind != right && verdict.kind != no_reference ? "null" : shared.empty() ? "[]" : shared + "]";
    return "{\"kind\": " + json_text(name_of(verdict.kind)) + ", \"time_s\": " + number(has_time, verdict.time_s) +
           ", \"body\": " + text(verdict.body < 0 ? "" : scene.body(verdict.body).name) +
           ", \"error_m\": " + number(has_errors, verdict.error.position_m) +
           ", \"error_rad\": " + number(has_errors, verdict.error.orientation_rad) + ", \"shared_rules\": " + shared +
           ", \"cause\": " + text(name_of(verdict.cause)) +
           ", \"cure\": " + text(verdict.cure ? options_of(*verdict.cure, {method_of(simulation), scene.step}) : "") +
           "}";
}

std::string json_of(const BoundedSteps& bounded, const SceneDescription& scene, long double step) {
    std::string bodies;
    for (std::size_t b = 0; b < bounded.bodies.size(); ++b) {
        const BoundedSteps::Body& body = bounded.bodies[b];
        if (body.steps == 0) continue;
        bodies += (bodies.empty() ? "" : ", ") + std::string("{\"name\": ") + json_text(scene.bodies[b].name) +
                  ", \"from_s\": " + json_number(static_cast<long double>(body.first) * step) +
                  ", \"steps\": " + std::to_string(body.steps) + "}";
    }
    return "{\"bodies\": [" + bodies + "], \"deepest_overlap_m\": " + json_number(bounded.deepest) +
           ", \"at_s\": " + json_number(static_cast<long double>(bounded.deepest_at) * step) + "}";
}

void print_json(const SceneDescription& scene, const Simulation& simulation, const EnergyWatch& energy,
                const BoundedSteps& bounded, const Verdict& verdict) {
    std::string status;
    for (const Trouble& trouble : verdict.troubles) status += (status.empty() ? "" : ", ") + json_text(trouble.issue);
    std::cout << "{\n  \"tumble_bits\": " << TUMBLE_BITS << ",\n  \"scene\": " << json_text(scene.name)
              << ",\n  \"integrator\": " << json_text(simulation.integrator())
              << ",\n  \"numbers\": " << json_text(simulation.numbers())
              << ",\n  \"step_s\": " << json_number(simulation.step_length())
              << ",\n  \"steps\": " << simulation.steps_taken() << ",\n  \"time_s\": " << json_number(simulation.time())
              << ",\n  \"state_hash\": " << json_text(hex(simulation.hash()))
              << ",\n  \"energy_start_j\": " << json_number(energy.start())
              << ",\n  \"energy_end_j\": " << json_number(energy.end()) << ",\n  \"energy_max_relative_drift\": "
              << (energy.largest_relative_drift() ? json_number(*energy.largest_relative_drift()) : "null")
              << (bounded.any() ? ",\n  \"bounded_steps\": " + json_of(bounded, scene, simulation.step_length()) : "")
              << ",\n  \"status\": [" << status << "],\n  \"verdict\": " << json_of(verdict, scene, simulation)
              << ",\n  \"bodies\": [";
    for (int b = 0; b < simulation.body_count(); ++b) {
        const BodySnapshot body = simulation.body(b);
        std::cout << (b > 0 ? "," : "") << "\n    {\n      " << json_of_motion(scene.body(b).name, body, ",\n      ")
                  << ",\n      \"asleep\": " << (body.asleep ? "true" : "false")
                  << ",\n      \"contacts\": " << body.contacts << "\n    }";
    }
    std::cout << "\n  ]";
    for (std::size_t j = 0; j < scene.joints.size(); ++j)
        std::cout << (j > 0 ? "," : ",\n  \"joints\": [") << "\n    {\n      "
                  << json_of_joint(scene.joints[j], simulation.joint(static_cast<int>(j)), ",\n      ") << "\n    }";
    std::cout << (scene.joints.empty() ? "" : "\n  ]") << "\n}\n";
}

// Does nothing in the scene change the energy on purpose, but for changes of gravity, which the drift leaves out?
bool keeps_energy(const SceneDescription& scene) {
    const auto is_push = [](const EventDescription& event) { return event.kind != EventKind::gravity; };
    if (!scene.impulses.empty() || !scene.forces.empty() || scene.linear_drag > 0 || scene.angular_drag > 0 ||
        std::any_of(scene.events.begin(), scene.events.end(), is_push))
        return false;
    for (const BodyDescription& body : scene.bodies)
        if (!body.fixed && (body.linear_drag > 0 || body.quadratic_drag > 0)) return false;
    for (const SpringDescription& spring : scene.springs)
        if (spring.damping > 0) return false;
    // At an end of its range a joint takes speed, and what breaks takes along what its spring stored.
    for (const JointDescription& joint : scene.joints)
        if (joint.has_ends() || joint.may_break() || joint.spring.damping > 0 || joint.to_spring.damping > 0)
            return false;
    const auto has_shape = [](const BodyDescription& body) {
        return body.shape.kind != ShapeKind::none && body.shape.kind != ShapeKind::points;
    };
    const auto shapes = std::count_if(scene.bodies.begin(), scene.bodies.end(), has_shape);
    return scene.contact.response == ContactResponse::none || !scene.joints.empty() || shapes == 0 ||
           (scene.planes.empty() && shapes == 1);
}

template <class Numbers>
std::string columns(const Numbers& numbers) {
    std::string text;
    for (const long double x : numbers) {
        const std::string number = few_digits(x);
        text += " " + std::string(number.size() < 12 ? 12 - number.size() : 0, ' ') + number;
    }
    return text;
}

// The bodies that moved in bounded time, from when on, and how deep they were in each other: one line.
std::string line_of(const BoundedSteps& bounded, const SceneDescription& scene, long double step) {
    constexpr std::size_t most_names = 5;
    std::vector<std::string> names;
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    for (std::size_t b = 0; b < bounded.bodies.size(); ++b) {
        if (bounded.bodies[b].steps == 0) continue;
        names.push_back(scene.bodies[b].name);
        first = std::min(first, bounded.bodies[b].first);
    }
    std::string text = "bounded steps of " + std::to_string(names.size()) + " bodies (";
    for (std::size_t i = 0; i < std::min(names.size(), most_names); ++i) text += (i > 0 ? ", " : "") + names[i];
    if (names.size() > most_names) text += ", ..";
    return text + ") from " + few_digits(static_cast<long double>(first) * step) + " s on: overlaps of up to " +
           few_digits(bounded.deepest) + " m, at " + few_digits(static_cast<long double>(bounded.deepest_at) * step) +
           " s";
}

void print_table(std::ostream& out, const SceneDescription& scene, const Simulation& simulation,
                 const EnergyWatch& energy, const BoundedSteps& bounded) {
    out << (scene.name.empty() ? scene.path : scene.name) << ": " << simulation.integrator() << ", "
        << simulation.numbers();
    if (!simulation.range().empty()) out << " " << simulation.range();
    out << (simulation.carry() ? "" : ", no carry") << ", " << simulation.steps_taken() << " steps of "
        << few_digits(simulation.step_length()) << " s, " << few_digits(simulation.time()) << " s\n";
    for (int b = 0; b < simulation.body_count(); ++b) {
        const BodySnapshot body = simulation.body(b);
        out << scene.bodies[static_cast<std::size_t>(b)].name << "\n"
            << "  position         m    " << columns(body.position) << "\n  velocity         m/s  "
            << columns(body.velocity) << "\n  angular velocity rad/s" << columns(body.angular_velocity)
            << "\n  orientation      wxyz " << columns(body.orientation) << "\n";
        if (body.contacts > 0) out << "  contact points        " << std::setw(13) << body.contacts << "\n";
        if (body.asleep) out << "  asleep\n";
    }
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
        const JointSnapshot joint = simulation.joint(static_cast<int>(j));
        const auto line = [&](const char* label, const std::optional<double>& first,
                              const std::optional<double>& second) {
            if (first && second) out << label << columns(std::array{*first, *second}) << "\n";
            else if (first) out << label << columns(std::array{*first}) << "\n";
        };
        out << scene.joints[j].name << (joint.broken ? ", broken\n" : "\n");
        if (joint.broken) continue;
        line("  angle            rad  ", joint.angle, joint.to_angle);
        line("  speed            rad/s", joint.speed, joint.to_speed);
        line("  travel           m    ", joint.travel, {});
        line("  speed            m/s  ", joint.travel_speed, {});
        if (joint.at_limit.value_or(0) != 0) out << "  at its " << (*joint.at_limit > 0 ? "most" : "least") << "\n";
        out << "  force            N    " << columns(joint.force) << "\n  torque           N m  "
            << columns(joint.torque) << "\n  gap              m    " << columns(std::array{joint.gap.value_or(0)})
            << "\n";
    }
    out << "energy " << few_digits(energy.start()) << " J at the start, " << few_digits(energy.end())
        << " J at the end";
    if (const StartImpact impact = impact_at_start(scene); impact.joint >= 0)
        out << ", " << few_digits(impact.energy) << " J ended by joints in the first step";
    if (keeps_energy(scene)) {
        if (const auto drift = energy.largest_relative_drift())
            out << ", largest relative drift " << few_digits(*drift);
        else out << ", largest drift " << few_digits(energy.largest_drift()) << " J, within rounding";
    }
    if (bounded.any()) out << "\n" << line_of(bounded, scene, simulation.step_length());
    out << "\nstate  " << hex(simulation.hash()) << "\n";
}

int run(const RunOptions& options) {
    if (options.live) {
        if (options.json || !options.trajectory.empty() || !options.contacts.empty() || !options.joints.empty() ||
            !options.plot.empty() || !options.gltf.empty() || !options.check.check.empty())
            throw std::invalid_argument(
                "--live: got --json, --trajectory, --contacts, --joints, --plot, --gltf or --check beside it, expected "
                "none of them");
        return run_live(options, options.record);
    }
    if (!options.record.empty()) throw std::invalid_argument("--record: got no --live beside it, expected --live");
    const std::vector<FileArgument> outputs = {{"--trajectory", options.trajectory},
                                               {"--contacts", options.contacts},
                                               {"--joints", options.joints},
                                               {"--plot", options.plot},
                                               {"--gltf", options.gltf}};
    check_outputs({{"the scene", options.scene}}, outputs);
    std::ostream& table = takes_standard_output(outputs, options.json) ? std::cerr : std::cout;
    if (options.every && options.trajectory.empty() && options.contacts.empty() && options.joints.empty() &&
        options.gltf.empty())
        std::cerr << "warning: --every has no effect without --trajectory, --contacts, --joints or --gltf\n";
    if (options.imu && options.trajectory.empty()) std::cerr << "warning: --imu has no effect without --trajectory\n";
    const SceneDescription scene = options.read();
    if (!options.contacts.empty() && scene.contact.response != ContactResponse::impulse)
        throw std::invalid_argument("--contacts: got a scene without contacts by impulses, expected "
                                    "contact.response = \"impulse\"");
    if (!options.joints.empty() && scene.joints.empty())
        throw std::invalid_argument("--joints: got a scene without joints, expected at least one [[joint]]");
    const auto simulation = options.start(scene);
    std::optional<Trajectory> trajectory;
    if (!options.trajectory.empty())
        trajectory.emplace(options.trajectory, options.every.value_or(1), options.imu, scene);
    std::optional<ContactRows> contacts;
    if (!options.contacts.empty()) contacts.emplace(options.contacts, options.every.value_or(1), scene);
    std::optional<JointRows> joints;
    if (!options.joints.empty()) joints.emplace(options.joints, options.every.value_or(1), scene);
    std::optional<Plot> plot;
    std::optional<OutputFile> plot_file;
    if (!options.plot.empty()) {
        plot_file.emplace(options.plot, "--plot");
        require_gnuplot();
        plot.emplace(*simulation, scene);
    }

    std::optional<Gltf> gltf;
    std::optional<OutputFile> gltf_file;
    if (!options.gltf.empty()) {
        gltf_file.emplace(options.gltf, "--gltf");
        gltf.emplace(scene, options.every.value_or(1));
    }

    RunWatch watch(scene, *simulation, moments_of(scene));
    {
        Progress progress(simulation->steps());
        for (;;) {
            const bool last = watch.is_over();
            if (trajectory) trajectory->record(*simulation, last);
            if (contacts) contacts->record(*simulation, last);
            if (joints) joints->record(*simulation, last);
            if (plot) plot->sample(*simulation, watch.energy().end_parts(), last);
            if (gltf) gltf->sample(*simulation, last);
            if (last) break;
            simulation->step();
            watch.see();
            if (trajectory && !trajectory->good()) trajectory->close();  // throws
            if (contacts && !contacts->good()) contacts->close();
            if (joints && !joints->good()) joints->close();
            if (simulation->steps_taken() % 256 == 0) progress.show(simulation->steps_taken());
        }
    }
    if (trajectory) trajectory->close();
    if (contacts) contacts->close();
    if (joints) joints->close();
    if (plot) {
        plot_file->stream() << plot->drawn();
        plot_file->commit();
    }
    if (gltf) {
        gltf_file->stream() << gltf->text();
        gltf_file->commit();
    }
    if (!options.json) print_table(table, scene, *simulation, watch.energy(), watch.bounded());
    table.flush();  // the run is done, whatever becomes of its check
    const EnergyWatch energy = watch.energy();
    const BoundedSteps bounded = watch.bounded();
    const Record record = std::move(watch).record();
    const Verdict verdict = options.check.verdict(scene, method_of(*simulation), record);
    if (options.json) print_json(scene, *simulation, energy, bounded, verdict);
    else table << verdict_line(options.check, verdict, scene, *simulation);
    const int status = report(verdict, scene, *simulation);
    return options.is_as_expected(scene, *simulation) ? status : failed;
}

}  // namespace

void add_run(CommandLine& line) {
    const auto options = std::make_shared<RunOptions>();
    Subcommand command = line.add("run", "replay a scene on the host", [=] { return run(*options); });
    options->add_to(command);
    command.add(options->trajectory, "--trajectory out.csv", "write every state as CSV; - is standard output",
                output_file());
    command.add(options->contacts, "--contacts out.csv",
                "write what touched, began, ended or hit in each step, with its impulses, as CSV; - is standard output",
                output_file());
    command.add(options->joints, "--joints out.csv",
                "write how every joint stands, moves and pulls as CSV; - is standard output", output_file());
    command.add(options->every, "--every K",
                "steps between rows of the trajectory, of joints, and of contacts that last, and between key frames of "
                "--gltf (default: 1)",
                at_least(1, "steps"));
    command.add(
        options->imu, "--imu",
        "add columns of an inertial sensor to the trajectory: specific force and angular velocity, in the body's "
        "axes");
    command.add(options->live, "--live",
                "take events as JSON lines from standard input, and write the state as JSON lines");
    command.add(options->record, "--record out.toml", "with --live: write the scene with the events of the run",
                output_file());
    options->check.add_to(command);
    command.add(options->json, "--json", "print one JSON object");
    command.add(options->plot, "--plot out.svg",
                "plot positions, angular velocities and energies as SVG, with marks at impulses and "
                "contacts (needs gnuplot); - is standard output",
                svg_file());
    command.add(options->gltf, "--gltf out.gltf",
                "write the run as an animated scene of glTF 2.0, for Blender and other viewers; - is standard output",
                output_file());
}

}  // namespace tumble::host
