// The subcommands of `tumble`, and what they share. Each returns the exit status: 0 done, 1 the run failed, 2 bad
// input.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "scene/description.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {

inline constexpr int done = 0, failed = 1, bad_input = 2;

// What is wrong with the arguments; status 2.
class BadArgument : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Which scene, and how it is replayed.
struct Choice {
    std::string scene;  // the file
    std::string integrator = "verlet";
    std::string numbers = "q32";
    std::string carry;               // "on", "off" or empty: the number system's default
    std::string step;                // empty: the file's
    std::optional<double> duration;  // s; empty: the file's
    bool no_bodies = false;          // the file may be without
    bool is_run = true;              // with this method and step: warn of the limits that they exceed

    [[nodiscard]] std::optional<bool> wants_carry() const {
        return carry.empty() ? std::nullopt : std::optional{carry == "on"};
    }
    // Reads the scene, applies the choice to it and warns of what is not simulated and of exceeded limits.
    [[nodiscard]] SceneDescription read() const;
    // Warns of a contact tolerance that the numbers do not hold.
    [[nodiscard]] std::unique_ptr<Simulation> start(const SceneDescription& scene) const;

private:
    void warn(const std::string& of) const;
};

struct RunOptions : Choice {
    std::string trajectory, plot;  // files; empty: none
    std::int64_t every = 1;        // steps between rows of the trajectory
    bool json = false;
};
int run(const RunOptions& options);

struct CompileOptions : Choice {
    std::string output;  // empty: standard output
    std::string name;    // of the struct in it; empty: struct_name()
};
int compile(const CompileOptions& options);
// The header that `compile` writes.
[[nodiscard]] std::string compiled_scene(const SceneDescription& scene, const Choice& choice,
                                         const std::string& name = {});
// The name of the struct in it: the file's name in PascalCase.
[[nodiscard]] std::string struct_name(const std::string& path);
// A name in C++ that no member of the struct has.
[[nodiscard]] bool is_struct_name(const std::string& name);

struct CompareOptions : Choice {
    std::string core;
    std::int64_t every = 1;
    std::optional<std::int64_t> flip;  // self-test: the step whose record gets one bit flipped on the host
    int timeout = 600;                 // s of emulation
};
int compare(const CompareOptions& options);

struct AdviseOptions {
    std::string scene, core;
    double tolerance = 0;                           // of positions in m and of orientations in rad
    std::optional<double> duration;                 // s; empty: the file's
    std::vector<std::string> integrators, numbers;  // to search; empty: all
    std::string cost;             // "cycles", "insn", or empty: cycles where the core has a timing table
    std::optional<double> clock;  // Hz: what share of a step's time it takes
    bool all = false;             // measure also what cannot be the cheapest
    bool json = false;
};
int advise(const AdviseOptions& options);

struct ProfileOptions : Choice {
    std::string core;
    std::string flame;   // file; empty: none
    int functions = 20;  // that the table names
    bool json = false;
    int timeout = 600;  // s of emulation
};
int profile(const ProfileOptions& options);

int list();

// Throws BadArgument unless the name is that of a core that QEMU emulates.
void check_core(const std::string& name);

// Parses the arguments and runs a subcommand; every error becomes a message and a status.
int command(int argc, const char* const* argv);

}  // namespace tumble::host
