// The command `tumble`: its subcommands and what they share.
#pragma once

#include <optional>
#include <string>

#include "command/options.hpp"
#include "scene/description.hpp"
#include "simulation/simulation.hpp"
#include "tools/output.hpp"

namespace tumble::host {

// Which scene, and how it is replayed.
struct Choice {
    std::string scene;  // the file
    std::string integrator = "verlet";
    std::string numbers = "q32";
    std::string carry;               // "on", "off" or empty: the number system's default
    std::string step;                // empty: the file's
    std::optional<double> duration;  // s; empty: the file's
    bool no_bodies = false;          // the file may be without

    // The options of every replay.
    void add_to(Subcommand& command);
    [[nodiscard]] std::optional<bool> wants_carry() const {
        return carry.empty() ? std::nullopt : std::optional{carry == "on"};
    }
    // Reads the scene, applies the choice to it and warns of what is not simulated.
    [[nodiscard]] SceneDescription read() const;
    // Warns of a contact tolerance and of spins of [range] that the numbers do not hold at this step.
    [[nodiscard]] std::unique_ptr<Simulation> start(const SceneDescription& scene) const;

private:
    void warn(const std::string& of) const;
};

// Each adds its subcommand and the options of it.
void add_run(CommandLine& line);
void add_compile(CommandLine& line);
void add_compare(CommandLine& line);
void add_advise(CommandLine& line);
void add_profile(CommandLine& line);
void add_list(CommandLine& line);

// The header that `compile` writes.
[[nodiscard]] std::string compiled_scene(const SceneDescription& scene, const Choice& choice,
                                         const std::string& name = {});
// The name of the struct in it: the file's name in PascalCase.
[[nodiscard]] std::string struct_name(const std::string& path);

// Does an output take standard output? What else is printed then goes to standard error. Throws BadArgument where two
// would take it, of which the JSON object is one.
[[nodiscard]] bool takes_standard_output(const std::vector<FileArgument>& outputs, bool json);

// Throws BadArgument unless the name is that of a core that QEMU emulates.
void check_core(const std::string& name);

// Parses the arguments and runs a subcommand; every error becomes a message and a status.
int command(int argc, const char* const* argv);

}  // namespace tumble::host
