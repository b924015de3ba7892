#include "command/options.hpp"

#include <tumble/version.hpp>

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "tools/text.hpp"

namespace tumble::host {
namespace {

template <class Number, class Test>
Expected number(const std::string& what, const Test& holds) {
    return {what, [=](const std::string& text) {
                Number number{};
                const char* const end = text.data() + text.size();
                const auto [last, code] = std::from_chars(text.data(), end, number);
                return code == std::errc{} && last == end && holds(number);
            }};
}

Expected file_name(const std::string& standard_stream) {
    return {"the name of a file", [=](std::string& text) {
                if (text == "-") text = standard_stream;
                return !text.empty();
            }};
}

std::string name_of(const std::string& option) { return option.substr(0, option.find(' ')); }

std::vector<std::string> subcommands_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* each : app.get_subcommands([](const CLI::App*) { return true; }))
        names.push_back(each->get_name());
    return names;
}

// CLI11 reports a missing option first, although a misspelt one is often the reason; so this is called before.
void refuse_unknown_option(const CLI::App& app) {
    for (const CLI::App* subcommand : app.get_subcommands()) {
        std::vector<std::string> names;
        for (const CLI::Option* option : subcommand->get_options())
            if (!option->get_lnames().empty()) names.push_back("--" + option->get_lnames().front());
        for (const std::string& argument : subcommand->remaining()) {
            if (!argument.starts_with("-") || argument == "-") continue;
            const std::string name = argument.substr(0, argument.find('='));
            throw std::invalid_argument(name + ": unknown option of " + subcommand->get_name() +
                                        suggestion(name, names) + ", expected one of " + listed(names));
        }
    }
}

}  // namespace

Expected input_file() { return file_name("/dev/stdin"); }
Expected output_file() { return file_name(standard_output); }
Expected svg_file() {
    const Expected file = output_file();
    return {file.what + " that is written as SVG, as out.svg", [accepts = file.accepts](std::string& text) {
                for (const char* other : {".png", ".pdf", ".jpg", ".jpeg", ".gif", ".eps", ".ps", ".webp", ".svgz"})
                    if (text.ends_with(other)) return false;
                return accepts(text);
            }};
}
Expected one_of(const std::string& one, const std::string& other) {
    return {one + " or " + other, [=](const std::string& text) { return text == one || text == other; }};
}
Expected duration() {
    return number<double>("a number of seconds >= 0",
                          [](double seconds) { return std::isfinite(seconds) && seconds >= 0; });
}
Expected at_least(std::int64_t least, const std::string& of_what) {
    return number<std::int64_t>("a whole number of " + of_what + " >= " + std::to_string(least),
                                [=](std::int64_t n) { return n >= least; });
}
Expected positive(const std::string& of_what) {
    return number<double>("a positive number, " + of_what, [](double x) { return std::isfinite(x) && x > 0; });
}

template <class T>
void Subcommand::add(T& value, const std::string& option, const std::string& help, const Expected& expected) {
    if constexpr (std::is_same_v<T, bool>) {
        app_->add_flag(option, value, help)->disable_flag_override();
    } else {
        CLI::Option& added = *app_->add_option(name_of(option), value, help);
        added.type_name(option.substr(option.find(' ') + 1));
        if constexpr (std::is_same_v<T, std::vector<std::string>>) added.delimiter(',')->allow_extra_args(false);
        else if (value != T{}) added.capture_default_str();
        if (!expected.accepts) return;
        // CLI11 puts the option's name before the message.
        const auto check = [expected](std::string& text) {
            const std::string given = text;
            return expected.accepts(text) ? "" : "got " + in_quotes(given) + ", expected " + expected.what;
        };
        added.transform(CLI::Validator(check, ""));
    }
}
template void Subcommand::add(std::string&, const std::string&, const std::string&, const Expected&);
template void Subcommand::add(bool&, const std::string&, const std::string&, const Expected&);
template void Subcommand::add(int&, const std::string&, const std::string&, const Expected&);
template void Subcommand::add(std::int64_t&, const std::string&, const std::string&, const Expected&);
template void Subcommand::add(double&, const std::string&, const std::string&, const Expected&);
template void Subcommand::add(std::optional<std::int64_t>&, const std::string&, const std::string&, const Expected&);
template void Subcommand::add(std::optional<double>&, const std::string&, const std::string&, const Expected&);
template void Subcommand::add(std::vector<std::string>&, const std::string&, const std::string&, const Expected&);

void Subcommand::make_required(const std::string& option) { app_->get_option(name_of(option))->required(); }

CommandLine::CommandLine()
    : app_(std::make_unique<CLI::App>("Rigid bodies on small hardware: replay scenes on the host, compile them for "
                                      "firmware, compare the two bit by bit.",
                                      "tumble")) {
    app_->set_version_flag("--version", "tumble " TUMBLE_VERSION ", bits " + std::to_string(TUMBLE_BITS),
                           "print the version of the command, and of the bits of its results");
    app_->require_subcommand(1);
    // As every other message of the command.
    app_->failure_message([](const CLI::App* app, const CLI::Error& error) {
        return "tumble: " + CLI::FailureMessage::simple(app, error);
    });
    app_->footer("Exit status: 0 done, 1 the run failed or a comparison differs, 2 bad input.");
}
CommandLine::~CommandLine() = default;

Subcommand CommandLine::add(const std::string& name, const std::string& help, std::function<int()> run,
                            const std::string& footer) {
    CLI::App& subcommand = *app_->add_subcommand(name, help);
    subcommand.callback([this, run = std::move(run)] { status_ = run(); });
    subcommand.footer(footer);
    return Subcommand(subcommand);
}

int CommandLine::run(int argc, const char* const* argv) {
    if (argc > 1 && argv[1] == std::string("help")) {
        const char* const as_option[] = {argv[0], argc > 2 ? argv[2] : "--help", "--help"};
        return run(3, as_option);
    }
    const std::vector<std::string> names = subcommands_of(*app_);
    if (const std::string first = argc > 1 ? argv[1] : "-";
        !first.starts_with("-") && std::find(names.begin(), names.end(), first) == names.end())
        throw std::invalid_argument("got " + in_quotes(first) + suggestion(first, names) + ", expected " +
                                    listed(names));
    try {
        app_->parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) refuse_unknown_option(*app_);
        return app_->exit(error) == 0 ? done : bad_input;
    }
    return status_;
}

}  // namespace tumble::host
