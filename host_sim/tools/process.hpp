// A child process whose standard output is read line by line.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace tumble::host {

class Process {
public:
    enum class Errors { pass, merge, keep };  // standard error: shared, merged into the output, or kept for errors()

    // Starts a command, found by PATH, with `input` as its standard input. A command that cannot be started ends with
    // status 127. When this program ends, for any reason, the child ends with all processes that it has started.
    explicit Process(const std::vector<std::string>& command, std::string_view input = {},
                     Errors errors = Errors::pass);
    // Ends the child if it still runs.
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    // Reads the next line, without its line break. False at the end of the output.
    [[nodiscard]] bool read_line(std::string& line);

    // Reads the rest of the output and waits. Returns the exit status, or 128 + the number of a signal.
    [[nodiscard]] int wait(std::string* rest = nullptr);

    // The standard error so far, where it is kept.
    [[nodiscard]] std::string errors() const;

private:
    pid_t child_ = -1;
    int errors_ = -1;
    std::FILE* output_ = nullptr;
};

// Runs a command and returns what it prints. Where it fails, throws std::runtime_error with that and with its errors,
// which are not shown otherwise.
std::string run_quietly(const std::vector<std::string>& command);

}  // namespace tumble::host
