// The command line: subcommands, and the name, meaning, check and default of their options.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

namespace CLI {
class App;
}

namespace tumble::host {

// Exit statuses.
inline constexpr int done = 0, failed = 1, bad_input = 2;

// What is wrong with the arguments; status 2.
class BadArgument : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// What the text of an option must be. `accepts` may replace the text by the spelling that the program uses.
struct Expected {
    std::string what;
    std::function<bool(std::string& text)> accepts;
};
// The name of a file; "-" is standard input or standard output, which then has the name of its device.
[[nodiscard]] Expected input_file();
[[nodiscard]] Expected output_file();
inline constexpr const char* standard_output = "/dev/stdout";
[[nodiscard]] Expected one_of(const std::string& one, const std::string& other);
[[nodiscard]] Expected duration();
// "a whole number of steps >= 1"
[[nodiscard]] Expected at_least(std::int64_t least, const std::string& of_what);
// "a positive number, of metres and of radians"
[[nodiscard]] Expected positive(const std::string& of_what);

class Subcommand {
public:
    explicit Subcommand(CLI::App& app) : app_(&app) {}

    // `option` is its name and what stands for its value in the help: "--every K", "-o,--output scene.hpp", "--json",
    // or "scene SCENE.toml" for an argument without a name. T: std::string, int, std::int64_t, double, std::optional of
    // the last two, bool (a flag without a value), and std::vector<std::string> (one argument, separated by commas).
    // The help shows the value from before as the default.
    template <class T>
    void add(T& value, const std::string& option, const std::string& help, const Expected& expected = {});
    // The same for an option that must be given.
    template <class T>
    void require(T& value, const std::string& option, const std::string& help, const Expected& expected = {}) {
        add(value, option, help, expected);
        make_required(option);
    }

private:
    void make_required(const std::string& option);

    CLI::App* app_;
};

class CommandLine {
public:
    CommandLine();
    ~CommandLine();
    CommandLine(const CommandLine&) = delete;
    CommandLine& operator=(const CommandLine&) = delete;

    // A subcommand; `run` returns its exit status. `footer` stands below the options in the help.
    Subcommand add(const std::string& name, const std::string& help, std::function<int()> run,
                   const std::string& footer = {});
    // Reads the arguments and runs the subcommand; the exit status. Throws BadArgument, and what the subcommand throws.
    int run(int argc, const char* const* argv);

private:
    std::unique_ptr<CLI::App> app_;
    int status_ = done;
};

}  // namespace tumble::host
