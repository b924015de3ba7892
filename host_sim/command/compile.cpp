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

#include "command/command.hpp"
#include "scene/fields.hpp"
#include "simulation/simulation.hpp"
#include "tools/output.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

std::string joint_text(const JointDescription& description, const AnyJointSpec& joint) {
    std::string kind = word_of(description.kind), text;
    kind[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(kind[0])));
    joint.visit([&](const auto& spec) { text = cpp_fields(spec); });
    return "        tumble::" + kind + "Spec{   // " + cpp_text(description.name) + "\n" + text + "        },\n";
}

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

// A std::array of specs, each with the name of what it was made from in a comment, if that has one.
template <class Spec, class From = Spec>
std::string list_text(const char* type, const char* name, const std::vector<Spec>& specs,
                      [[maybe_unused]] const std::vector<From>& from = {}) {
    std::string list = "    static constexpr std::array<tumble::" + std::string(type) + ", " +
                       std::to_string(specs.size()) + "> " + name + "{";
    if (specs.empty()) return list + "};\n";
    list += "{\n";
    for (std::size_t i = 0; i < specs.size(); ++i) {
        list += "        {";
        if constexpr (requires { from[i].name; }) list += "   // " + cpp_text(from[i].name);
        list += "\n" + cpp_fields(specs[i]) + "        },\n";
    }
    return list + "    }};\n";
}
// The same, but nothing where there are none.
template <class Spec>
std::string some_text(const char* type, const char* name, const std::vector<Spec>& specs) {
    return specs.empty() ? "" : list_text(type, name, specs);
}

// What the loads have that a scene names by keys of bodies or by a table.
std::string loads_text(const SceneData& data) {
    std::string text;
    if (!data.softening.is_zero())
        text = "    static constexpr tumble::Real softening{" + in_cpp(data.softening) + "};   // m\n";
    if (!data.drags.empty()) text += "    static constexpr tumble::RealVec3 wind" + in_cpp(data.wind) + ";   // m/s\n";
    text += some_text("DragSpec", "drags", data.drags) + some_text("WheelsSpec", "wheels", data.wheels);
    if (!data.orbit.rate.is_zero())
        text += "    static constexpr tumble::OrbitSpec orbit{\n" + cpp_fields(data.orbit, "        ") + "    };\n";
    return text;
}

std::string step_in_cpp(const StepSize& step) {
    if (step.denominator == 0) return "{tumble::Real{" + cpp_number(step.decimal) + "}}";
    constexpr std::int64_t largest = std::numeric_limits<std::int32_t>::max();
    const std::string above = std::to_string(step.numerator), below = std::to_string(step.denominator);
    if (step.numerator <= largest && step.denominator <= largest) return "{" + above + ", " + below + "}";
    return "{tumble::Real::scaled(" + above + ", 0) / tumble::Real::scaled(" + below + ", 0)}";
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
    std::string features;
    Features::for_each([&]<class T>(const char* name, T Features::*member) {
        const T value = needed.*member, usual = Features{}.*member;
        if (std::is_same_v<T, bool> ? value != usual : value > 0 || usual > 0)
            features += std::string("            .") + name + " = " + in_cpp(value) + ",\n";
    });
    return text + "        static constexpr tumble::Features features{\n" + features + "        };\n    };\n";
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
         << "    static constexpr tumble::WorldSpec world{\n"
         << cpp_fields(data.world, "        ") << "    };\n"
         << list_text("BodySpec", "bodies", bodies, scene.bodies) << ids_text(scene.bodies)
         << list_text("PlaneSpec", "planes", data.planes, scene.planes)
         << list_text("SpringSpec", "springs", data.springs) << joints_text(scene.joints, data.joints)
         << loads_text(data) << some_text("EventSpec", "events", data.events) << "\n"
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
