// `tumble compile`: writes a scene as a struct of constants, with the capacities that it needs and no more.
#include <tumble/version.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>
#include <string_view>

#include "command/command.hpp"
#include "scene/data.hpp"
#include "scene/words.hpp"
#include "simulation/simulation.hpp"
#include "tools/output.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

std::string number(Real value) { return cpp_number(value.to_double()); }
std::string vector(const RealVec3& v) { return "{" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + "}"; }

// The initialiser of a struct, with a line for each member that differs from its default.
class Members {
public:
    explicit Members(std::string indent) : indent_(std::move(indent)) {}
    void always(const char* name, const std::string& value, const char* comment = "") {
        text_ +=
            indent_ + "." + name + " = " + value + "," + (*comment != 0 ? std::string("   // ") + comment : "") + "\n";
    }
    void when(bool present, const char* name, const std::string& value, const char* comment = "") {
        if (present) always(name, value, comment);
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string indent_, text_;
};

std::string shape_text(const Shape& shape) {
    const char* kind = [&] {
        switch (shape.kind) {
        case ShapeKind::sphere: return "sphere";
        case ShapeKind::box: return "box";
        case ShapeKind::cylinder: return "cylinder";
        case ShapeKind::hoop: return "hoop";
        case ShapeKind::capsule: return "capsule";
        default: return "none";
        }
    }();
    return std::string("{tumble::ShapeKind::") + kind + ", " + vector(shape.size) + "}";
}

std::string body_text(const BodyDescription& description, const BodySpec& body) {
    const bool own_inertia = description.inertia || description.shape.kind == ShapeKind::points;
    const InertiaTensor& i = body.inertia;
    Members members("            ");
    members.when(body.shape.kind != ShapeKind::none, "shape", shape_text(body.shape), "m");
    members.always("mass", number(body.mass), "kg");
    members.when(!description.is_point_mass(), "inertia",
                 own_inertia ? "{" + number(i.xx) + ", " + number(i.yy) + ", " + number(i.zz) + ", " + number(i.xy) +
                                   ", " + number(i.xz) + ", " + number(i.yz) + "}"
                             : "tumble::inertia_of(" + shape_text(body.shape) + ", " + number(body.mass) + ")",
                 "kg m^2");
    members.when(!body.position.is_zero(), "position", vector(body.position), "m");
    members.when(!body.velocity.is_zero(), "velocity", vector(body.velocity), "m/s");
    members.when(!(body.orientation.w == Real{1}) || !body.orientation.v.is_zero(), "orientation",
                 "{" + number(body.orientation.w) + ", " + vector(body.orientation.v) + "}", "w, x, y, z");
    members.when(!body.angular_velocity.is_zero(), "angular_velocity", vector(body.angular_velocity), "rad/s");
    members.when(!body.restitution.is_negative(), "restitution", number(body.restitution));
    members.when(!body.friction.is_negative(), "friction", number(body.friction));
    members.when(!body.rolling_resistance.is_negative(), "rolling_resistance", number(body.rolling_resistance), "m");
    members.when(!body.spinning_resistance.is_negative(), "spinning_resistance", number(body.spinning_resistance), "m");
    members.when(body.fixed, "fixed", "true");
    members.when(body.kinematic, "kinematic", "true");
    members.when(body.layers != BodySpec::all_layers, "layers", std::to_string(body.layers));
    return members.text();
}

std::string plane_text(const PlaneDescription&, const PlaneSpec& plane) {
    Members members("            ");
    members.always("normal", vector(plane.normal));
    members.when(!plane.offset.is_zero(), "offset", number(plane.offset), "m");
    members.when(!plane.restitution.is_negative(), "restitution", number(plane.restitution));
    members.when(!plane.friction.is_negative(), "friction", number(plane.friction));
    members.when(!plane.rolling_resistance.is_negative(), "rolling_resistance", number(plane.rolling_resistance), "m");
    members.when(!plane.spinning_resistance.is_negative(), "spinning_resistance", number(plane.spinning_resistance),
                 "m");
    return members.text();
}

std::string spring_text(const SpringDescription&, const SpringSpec& spring) {
    Members members("            ");
    members.always("body", std::to_string(spring.body));
    members.when(!spring.point.is_zero(), "point", vector(spring.point), "m");
    members.when(spring.to_body >= 0, "to_body", std::to_string(spring.to_body));
    members.when(!spring.to.is_zero(), "to", vector(spring.to), "m");
    members.always("stiffness", number(spring.stiffness), "N/m");
    members.when(!spring.damping.is_zero(), "damping", number(spring.damping), "N s/m");
    members.when(!spring.rest_length.is_zero(), "rest_length", number(spring.rest_length), "m");
    return members.text();
}

std::string spring_of_joint_text(const JointSpring& spring) {
    return "{" + number(spring.stiffness) + ", " + number(spring.damping) + ", " + number(spring.rest) + "}";
}

std::string joint_text(const JointDescription& description, const AnyJointSpec& joint) {
    Members members("            ");
    joint.visit([&](const auto& spec) {
        members.always("body", std::to_string(spec.body));
        members.when(spec.to_body >= 0, "to_body", std::to_string(spec.to_body));
        if constexpr (requires { spec.anchor; }) members.always("anchor", vector(spec.anchor), "m");
        if constexpr (requires { spec.axis; }) members.always("axis", vector(spec.axis));
        if constexpr (requires { spec.to_axis; }) members.always("to_axis", vector(spec.to_axis));
        if constexpr (requires { spec.to_point; }) {
            members.always("point", vector(spec.point), "m");
            members.always("to_point", vector(spec.to_point), "m");
            members.when(!spec.least.is_zero(), "least", number(spec.least), "m");
            members.always("most", number(spec.most), "m");
        }
        if constexpr (requires { spec.spring; }) {
            const bool is_linear = description.kind == JointKind::slider || description.kind == JointKind::distance;
            const char* const units = is_linear ? "N/m, N s/m, m" : "N m/rad, N m s/rad, rad";
            members.when(spec.spring.acts(), "spring", spring_of_joint_text(spec.spring), units);
            if constexpr (requires { spec.to_spring; })
                members.when(spec.to_spring.acts(), "to_spring", spring_of_joint_text(spec.to_spring), units);
        }
        if constexpr (requires { spec.limits; })
            members.when(spec.limits.acts(), "limits",
                         "{" + number(spec.limits.least) + ", " + number(spec.limits.most) + "}",
                         description.kind == JointKind::slider ? "m" : "rad");
        members.when(!spec.break_force.is_zero(), "break_force", number(spec.break_force), "N");
        if constexpr (requires { spec.break_torque; })
            members.when(!spec.break_torque.is_zero(), "break_torque", number(spec.break_torque), "N m");
    });
    std::string kind = word_of(joint_kinds, description.kind);
    kind[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(kind[0])));
    return "        tumble::" + kind + "Spec{   // " + cpp_text(description.name) + "\n" + members.text() +
           "        },\n";
}

std::string drag_text(const DragSpec& drag) {
    Members members("            ");
    members.always("body", std::to_string(drag.body));
    members.when(!drag.linear.is_zero(), "linear", number(drag.linear), "kg/s");
    members.when(!drag.quadratic.is_zero(), "quadratic", number(drag.quadratic), "kg/m");
    return members.text();
}

std::string wheels_text(const WheelsSpec& wheels) {
    Members members("            ");
    members.always("body", std::to_string(wheels.body));
    members.always("momentum", vector(wheels.momentum), "N m s");
    return members.text();
}

std::string event_text(const EventSpec& event) {
    Members members("            ");
    members.always("time", number(event.time), "s");
    members.always("kind", std::string("tumble::EventKind::") + name_of(event.kind));
    members.when(has_body(event.kind), "body", std::to_string(event.body));
    members.when(has_joint(event.kind), "body", std::to_string(event.body), "the joint");
    members.when(event.frame == Frame::body, "frame", "tumble::Frame::body");
    members.when(!event.value.is_zero(), "value", vector(event.value));
    members.when(!event.point.is_zero(), "point", vector(event.point), "m");
    members.when(event.kind == EventKind::pose, "orientation",
                 "{" + number(event.orientation.w) + ", " + vector(event.orientation.v) + "}", "w, x, y, z");
    return members.text();
}

std::string comment_of(const BodyDescription& body) { return "   // " + cpp_text(body.name); }
std::string comment_of(const PlaneDescription& plane) { return "   // " + cpp_text(plane.name); }
std::string comment_of(const auto&) { return ""; }

// The words that C++ has taken.
const std::set<std::string>& cpp_words() {
    static const std::set<std::string> taken = [] {
        std::istringstream words(
            "alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t "
            "char32_t char8_t class co_await co_return co_yield compl concept const const_cast consteval "
            "constexpr constinit continue decltype default delete do double dynamic_cast else enum "
            "explicit export extern false float for friend goto if inline int long mutable namespace new "
            "noexcept not not_eq nullptr operator or or_eq private protected public register "
            "reinterpret_cast requires return short signed sizeof static static_assert static_cast "
            "struct switch template this thread_local throw true try typedef typeid typename union "
            "unsigned using virtual void volatile wchar_t while xor xor_eq");
        return std::set<std::string>{std::istream_iterator<std::string>(words), {}};
    }();
    return taken;
}

// The names of bodies or joints in C++, each once: other characters become '_', and what C++ or another one has taken
// gets its number behind it. `of`: the struct that has them as members.
template <class Named>
std::vector<std::string> cpp_names(const char* of, const std::string& prefix, const std::vector<Named>& list) {
    std::set<std::string> taken = cpp_words();
    taken.insert(of);
    std::vector<std::string> names;
    for (const Named& each : list) {
        std::string name;
        for (const char c : each.name) {
            const auto code = static_cast<unsigned char>(c);
            const bool in_name = code < 0x80 && std::isalnum(code) != 0;
            if (in_name) name += c;
            else if (!name.empty() && name.back() != '_') name += '_';
        }
        if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0) name = prefix + name;
        while (!taken.insert(name).second) name += (name.back() == '_' ? "" : "_") + std::to_string(names.size());
        names.push_back(name);
    }
    return names;
}
// The ids that a world gives to the bodies, and to the joints, by their names.
std::string ids_text(const std::vector<BodyDescription>& bodies) {
    if (bodies.empty()) return "";
    std::string text = "    // The ids of the bodies, as add() gives them in this order.\n    struct Bodies {\n";
    const std::vector<std::string> names = cpp_names("Bodies", "body_", bodies);
    for (std::size_t i = 0; i < names.size(); ++i)
        text += "        static constexpr tumble::BodyId " + names[i] + "{" + std::to_string(i) + "};\n";
    return text + "    };\n";
}
// The joints, and their ids by their names; nothing where there are none.
std::string joints_text(const std::vector<JointDescription>& descriptions, const std::vector<AnyJointSpec>& joints) {
    if (joints.empty()) return "";
    std::string text = "    static constexpr std::tuple joints{\n",
                ids = "    // The ids of the joints, as add() gives them in this order.\n    struct Joints {\n";
    const std::vector<std::string> names = cpp_names("Joints", "joint_", descriptions);
    for (std::size_t i = 0; i < joints.size(); ++i) {
        text += joint_text(descriptions[i], joints[i]);
        ids += "        static constexpr tumble::JointId " + names[i] + "{" + std::to_string(i) + "};\n";
    }
    return text + "    };\n" + ids + "    };\n";
}

// A std::array of specs; item(i) is what follows the opening brace of spec i.
template <class Spec, class Item>
std::string array_text(const char* type, const char* name, const std::vector<Spec>& specs, Item&& item) {
    std::string list = "    static constexpr std::array<tumble::" + std::string(type) + ", " +
                       std::to_string(specs.size()) + "> " + name + "{";
    if (specs.empty()) return list + "};\n";
    list += "{\n";
    for (std::size_t i = 0; i < specs.size(); ++i) list += "        {" + item(i) + "        },\n";
    return list + "    }};\n";
}

// The same with the name of each description in a comment.
template <class Description, class Spec>
std::string list_text(const char* type, const char* name, const std::vector<Description>& descriptions,
                      const std::vector<Spec>& specs, std::string (*text)(const Description&, const Spec&)) {
    return array_text(type, name, specs, [&](std::size_t i) {
        return comment_of(descriptions[i]) + "\n" + text(descriptions[i], specs[i]);
    });
}

// The same of specs that stand for keys of bodies; nothing where there are none.
template <class Spec>
std::string list_text(const char* type, const char* name, const std::vector<Spec>& specs,
                      std::string (*text)(const Spec&)) {
    if (specs.empty()) return "";
    return array_text(type, name, specs, [&](std::size_t i) { return "\n" + text(specs[i]); });
}

// What the loads have that a scene names by keys of bodies or by a table.
std::string loads_text(const SceneData& data) {
    std::string text;
    if (!data.softening.is_zero())
        text = "    static constexpr tumble::Real softening{" + number(data.softening) + "};   // m\n";
    if (!data.drags.empty()) text += "    static constexpr tumble::RealVec3 wind" + vector(data.wind) + ";   // m/s\n";
    text += list_text("DragSpec", "drags", data.drags, drag_text) +
            list_text("WheelsSpec", "wheels", data.wheels, wheels_text);
    if (!data.orbit.rate.is_zero())
        text += "    static constexpr tumble::OrbitSpec orbit{" + number(data.orbit.rate) + ", " +
                vector(data.orbit.to_centre) + "};   // rad/s\n";
    return text;
}

std::string step_in_cpp(const StepSize& step) {
    if (step.denominator == 0) return "{tumble::Real{" + cpp_number(step.decimal) + "}}";
    constexpr std::int64_t largest = std::numeric_limits<std::int32_t>::max();
    const std::string above = std::to_string(step.numerator), below = std::to_string(step.denominator);
    if (step.numerator <= largest && step.denominator <= largest) return "{" + above + ", " + below + "}";
    return "{tumble::Real::scaled(" + above + ", 0) / tumble::Real::scaled(" + below + ", 0)}";
}

// The name of a choice in C++.
template <class T>
std::string cpp_name(const std::string& type, const Words<T>& words, T value) {
    std::string name = word_of(words, value);
    std::replace(name.begin(), name.end(), ' ', '_');
    return "tumble::" + type + "::" + name;
}

std::string world_text(const WorldSpec& world) {
    Members contact("            "), members("        ");
    members.when(!world.gravity.is_zero(), "gravity", vector(world.gravity), "m/s^2");
    members.when(!world.gravitation.is_zero(), "gravitation", number(world.gravitation), "m^3/(kg s^2)");
    members.when(!world.linear_drag.is_zero(), "linear_drag", number(world.linear_drag), "kg/s");
    members.when(!world.angular_drag.is_zero(), "angular_drag", number(world.angular_drag), "N m s");
    const ContactSpec& c = world.contact;
    contact.always("response", cpp_name("ContactResponse", responses, c.response));
    if (c.response == ContactResponse::impulse) {
        contact.always("restitution", number(c.restitution));
        contact.when(!c.restitution_threshold.is_zero(), "restitution_threshold", number(c.restitution_threshold),
                     "m/s");
        contact.when(!c.friction.is_zero(), "friction", number(c.friction));
        contact.when(!c.rolling_resistance.is_zero(), "rolling_resistance", number(c.rolling_resistance), "m");
        contact.when(!c.spinning_resistance.is_zero(), "spinning_resistance", number(c.spinning_resistance), "m");
        contact.when(c.restitution_mixing != Mixing::larger, "restitution_mixing",
                     cpp_name("Mixing", mixings, c.restitution_mixing));
        contact.when(c.friction_mixing != Mixing::geometric_mean, "friction_mixing",
                     cpp_name("Mixing", mixings, c.friction_mixing));
        contact.always("tolerance", number(c.tolerance), "m");
        contact.when(c.sleep.on, "sleep",
                     "{.on = true, .speed = " + number(c.sleep.speed) + ", .angular_speed = " +
                         number(c.sleep.angular_speed) + ", .time = " + number(c.sleep.time) + "}",
                     "m/s, rad/s, s");
        contact.when(c.most_impacts > 0, "most_impacts", std::to_string(c.most_impacts));
        contact.when(c.most_searches > 0, "most_searches", std::to_string(c.most_searches));
        contact.when(c.most_sweeps > 0, "most_sweeps", std::to_string(c.most_sweeps));
        contact.when(c.exact_bodies != ContactSpec::few, "exact_bodies", std::to_string(c.exact_bodies));
    } else if (c.response == ContactResponse::spring) {
        contact.always("tolerance", number(c.tolerance), "m");
        contact.always("stiffness", number(c.stiffness), "N/m");
        contact.when(!c.damping.is_zero(), "damping", number(c.damping), "N s/m");
        contact.when(!c.barrier.is_zero(), "barrier", number(c.barrier), "N m^2");
    }
    return "    static constexpr tumble::WorldSpec world{\n" + members.text() + "        .contact = {\n" +
           contact.text() + "        },\n    };\n";
}

// Features::near_pairs of a firmware that replays the scene; 0 where it is the usual one. The host replays its first
// steps, in which a pile comes to rest: with the same bits, or in double precision where such worlds would have to be
// compiled first. The room is larger than the most pairs of that run by the root of their number: by so much a number
// of pairs varies that meet by chance, as with other numbers or another method.
int near_pairs_for(const SceneDescription& scene, const Features& features, const NumberSystemInfo& numbers,
                   const IntegratorInfo& integrator) {
    constexpr std::int64_t most_steps = 16384;
    const int all = features.all_pairs();
    if (!features.contacts() || all == 1) return 0;
    const auto simulation = is_compiled(scene, integrator.name, numbers.name, numbers.carry)
                                ? make_simulation(scene, integrator.name, numbers.name, numbers.carry)
                                : make_simulation(scene, "verlet", "f64");
    for (std::int64_t step = 0; step < std::min(scene.steps(), most_steps); ++step) {
        simulation->step();
        if (simulation->has_trouble("range_left")) break;
    }
    const double most = simulation->most_near_pairs();
    const int room = std::clamp(static_cast<int>(std::ceil(most + std::sqrt(most))), 1, all);
    return room == features.room_for_pairs() ? 0 : room;
}

std::string config_text(const SceneDescription& scene, const SceneData& data, const NumberSystemInfo& numbers,
                        const IntegratorInfo& integrator) {
    Features needed = needs(data);
    needed.near_pairs = near_pairs_for(scene, needed, numbers, integrator);
    std::string text =
        "    // What the scene needs, and nothing else. Derive from it to choose other numbers or another integrator.\n"
        "    struct Config : tumble::Scene {\n        using Numbers = " +
        numbers.type + ";\n        using Integrator = " + integrator.type +
        ";\n        static constexpr tumble::Seconds step" + step_in_cpp(scene.step) + ";\n";
    Members members("            ");
    Features::for_each([&]<class T>(const char* name, T Features::*member) {
        const T value = needed.*member;
        if constexpr (std::is_same_v<T, bool>)
            members.when(value != Features{}.*member, name, value ? "true" : "false");
        else members.when(value > 0 || Features{}.*member > 0, name, std::to_string(value));
    });
    return text + "        static constexpr tumble::Features features{\n" + members.text() + "        };\n    };\n";
}

// Is it a name in C++ that no member of the struct has, and no namespace that it names?
bool is_struct_name(const std::string& name) {
    static const std::vector<std::string> members = {
        "Config", "Bodies", "Joints",    "name", "step",  "steps",  "world", "bodies", "planes", "springs",
        "joints", "events", "softening", "wind", "drags", "wheels", "orbit", "tumble", "std"};
    const auto is_in_name = [](unsigned char c) { return c < 0x80 && (std::isalnum(c) != 0 || c == '_'); };
    return !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) == 0 &&
           std::all_of(name.begin(), name.end(), is_in_name) &&
           std::find(members.begin(), members.end(), name) == members.end() && !cpp_words().contains(name);
}

}  // namespace

std::string struct_name(const std::string& path) {
    std::string name;
    bool starts_word = true;
    for (const char c : std::filesystem::path(path).stem().string()) {
        const auto code = static_cast<unsigned char>(c);
        const bool in_name = code < 0x80 && std::isalnum(code) != 0;
        if (in_name) name += starts_word ? static_cast<char>(std::toupper(code)) : c;
        starts_word = !in_name;
    }
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) != 0) name = "Scene" + name;
    if (!is_struct_name(name)) name += "Scene";
    return name;
}

std::string compiled_scene(const SceneDescription& scene, const Choice& choice, const std::string& name) {
    const SceneData data = build_scene(scene);
    std::vector<BodySpec> bodies = data.bodies;
    if (!needs(data).layers)
        for (BodySpec& body : bodies) body.layers = BodySpec::all_layers;  // where nothing touches they say nothing
    const Method method = choice.method(scene);
    const NumberSystemInfo& numbers = find_number_system(scene, method.numbers, method.carry);
    const IntegratorInfo& integrator = find_integrator(method.integrator);
    std::ostringstream text;
    text << "// The scene " << cpp_text(scene.name) << ", written by `tumble compile` from "
         << cpp_text(std::filesystem::path(scene.path).filename().string()) << " for " << integrator.name << " and "
         << numbers.name << (numbers.range.empty() ? "" : " " + numbers.range)
         << (numbers.carry ? "" : " without carry")
         << ":\n// edit the scene instead. Units are SI; vectors of a body are in the user's body axes.\n#pragma "
            "once\n\n"
            "#include <tumble/tumble.hpp>\n\n#include <array>\n#include <cstdint>\n"
         << (data.joints.empty() ? "" : "#include <tuple>\n") << "\nstatic_assert(TUMBLE_BITS == " << TUMBLE_BITS
         << ",\n              \"this scene was compiled by a tumble whose results have other bits than this kernel's: "
            "\"\n"
            "              \"compile it again with the `tumble` of the kernel's version\");\n\n"
            "namespace tumble::scenes {\n\nstruct "
         << (name.empty() ? struct_name(scene.path) : name)
         << " {\n    static constexpr const char* name = " << cpp_text(scene.name)
         << ";\n    static constexpr tumble::Seconds step" << step_in_cpp(scene.step)
         << ";\n    static constexpr std::uint32_t steps = " << data.steps << "u;\n"
         << world_text(data.world) << list_text("BodySpec", "bodies", scene.bodies, bodies, body_text)
         << ids_text(scene.bodies) << list_text("PlaneSpec", "planes", scene.planes, data.planes, plane_text)
         << list_text("SpringSpec", "springs", scene.springs, data.springs, spring_text)
         << joints_text(scene.joints, data.joints) << loads_text(data)
         << list_text("EventSpec", "events", data.events, event_text) << "\n"
         << config_text(scene, data, numbers, integrator) << "};\n\n}  // namespace tumble::scenes\n";
    return text.str();
}

namespace {

struct CompileOptions : Choice {
    std::string output;  // empty: standard output
    std::string name;    // of the struct in it; empty: struct_name()
};

int compile(const CompileOptions& options) {
    check_outputs({{"the scene", options.scene}}, {{"--output", options.output}});
    const std::string header = compiled_scene(options.read(), options, options.name);
    if (options.output.empty() || options.output == standard_output) {
        std::cout << header;
    } else {
        OutputFile file(options.output, "--output");
        file.stream() << header;
        file.commit();
    }
    return done;
}

}  // namespace

void add_compile(CommandLine& line) {
    const auto options = std::make_shared<CompileOptions>();
    Subcommand command =
        line.add("compile", "write a scene as a C++ header for firmware", [=] { return compile(*options); });
    options->add_to(command);
    command.add(options->output, "-o,--output scene.hpp", "the header; default: standard output, as for -",
                output_file());
    command.add(options->name, "--struct NAME",
                "name of the struct in the header; default: the file's name in PascalCase",
                {"a name in C++ that no member of the struct has",
                 [](const std::string& text) { return is_struct_name(text); }});
    command.add(options->no_bodies, "--no-bodies",
                "take a scene without bodies too: what a world costs before its first");
}

}  // namespace tumble::host
