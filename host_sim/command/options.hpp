// The command line: subcommands, and the name, meaning, check and default of their options.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace CLI {
class App;
}

namespace tumble::host {

// Exit statuses.
inline constexpr int done = 0, failed = 1, bad_input = 2;

// The texts that an option accepts. `what` describes them in messages; `accepts` may also rewrite the text.
struct Expected {
    std::string what;
    std::function<bool(std::string& text)> accepts;
};
// The name of a file. It replaces "-" by the device of standard input or standard output.
[[nodiscard]] Expected input_file();
[[nodiscard]] Expected output_file();
// The same of a picture, which is SVG: a name that ends as other pictures do is refused.
[[nodiscard]] Expected svg_file();
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

    // `option` is the name, and the value as the help shows it: "--every K", "-o,--output scene.hpp", "--json",
    // or "scene SCENE.toml" for an argument without a name. T: std::string, int, std::int64_t, double, std::optional of
    // the last two, bool (a flag without a value), and std::vector<std::string> (one argument, separated by commas).
    // The help shows the value that the variable has now as the default.
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

    // Adds a subcommand; `run` returns its exit status. The help prints `footer` below the options.
    Subcommand add(const std::string& name, const std::string& help, std::function<int()> run,
                   const std::string& footer = {});
    // Reads the arguments, runs the subcommand and returns the exit status. Throws std::invalid_argument, and the
    // exceptions of the subcommand.
    int run(int argc, const char* const* argv);

private:
    std::unique_ptr<CLI::App> app_;
    int status_ = done;
};

}  // namespace tumble::host
