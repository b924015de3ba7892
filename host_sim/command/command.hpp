// The command `tumble`: its subcommands and what they share.
#pragma once

#include <optional>
#include <string>

#include "command/options.hpp"
#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "tools/output.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {

// A scene, and how to replay it.
struct Choice {
    std::string scene;                // the file
    std::string integrator, numbers;  // empty: those of the scene's [expect], else verlet and q32
    std::string carry;                // "on", "off" or empty: that of [expect], else the number system's default
    std::string step;                 // empty: the file's
    std::optional<double> duration;   // s; empty: the file's
    bool no_bodies = false;           // is a scene without bodies allowed?

    // The options of every replay.
    void add_to(Subcommand& command);
    [[nodiscard]] Method method(const SceneDescription& scene) const;
    // Reads the scene, applies the choice to it, and warns of everything in it that is not simulated, and of an
    // [expect] of another choice.
    [[nodiscard]] SceneDescription read() const;
    // Warns where the numbers cannot represent the contact tolerance or the largest spin that the scene declares.
    [[nodiscard]] std::unique_ptr<Simulation> start(const SceneDescription& scene) const;
    // Did the run end as the scene's [expect] says? Where it did not, writes both hashes to standard error. True where
    // the scene has none, or one of another choice.
    [[nodiscard]] bool is_as_expected(const SceneDescription& scene, const Simulation& simulation) const;

private:
    // Is there an [expect], and of this choice?
    [[nodiscard]] bool is_expected(const SceneDescription& scene) const;
    void warn(const std::string& of) const;
};

// Each adds one subcommand with its options.
void add_run(CommandLine& line);
void add_compile(CommandLine& line);
void add_compare(CommandLine& line);
void add_advise(CommandLine& line);
void add_profile(CommandLine& line);
void add_view(CommandLine& line);
void add_list(CommandLine& line);

// The header that `compile` writes.
[[nodiscard]] std::string compiled_scene(const SceneDescription& scene, const Choice& choice,
                                         const std::string& name = {});
// The name of the struct in it: the file's name in PascalCase.
[[nodiscard]] std::string struct_name(const std::string& path);

// Does an output go to standard output? The table then goes to standard error. Throws std::invalid_argument where two
// outputs, or an output and the JSON object, would go there.
[[nodiscard]] bool takes_standard_output(const std::vector<FileArgument>& outputs, bool json);

// The members of a body's JSON object that say where it is and how it moves.
[[nodiscard]] std::string json_of_motion(const std::string& name, const BodySnapshot& body,
                                         const std::string& separator);

// The members of a joint's JSON object. Those that its kind has not are null.
[[nodiscard]] std::string json_of_joint(const JointDescription& description, const JointSnapshot& joint,
                                        const std::string& separator);

// Throws std::invalid_argument unless the name is that of a core that QEMU emulates.
void check_core(const std::string& name);
// "cortex-m0, cortex-m3": the cores whose manuals give the cycles of their instructions.
[[nodiscard]] std::string cores_with_cycles();

// Reads the arguments, runs a subcommand and returns the exit status. Prints a message for each error.
int command(int argc, const char* const* argv);

}  // namespace tumble::host
