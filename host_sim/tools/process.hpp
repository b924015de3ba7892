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
    enum class Errors { pass, merge, keep };  // standard error: ours, into what is read, or for errors()

    // Starts `command` (looked up in PATH) and gives it `input`. A command that cannot be started ends with status 127.
    // When this program ends, whatever ends it, the child ends with all that it has started.
    explicit Process(const std::vector<std::string>& command, std::string_view input = {},
                     Errors errors = Errors::pass);
    // Ends the child if it still runs.
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    // The next line without its end; false when there are no more.
    [[nodiscard]] bool read_line(std::string& line);

    // Reads what is left, and waits. The exit status, or 128 + the signal's number.
    [[nodiscard]] int wait(std::string* rest = nullptr);

    // What has come from standard error so far, if it is kept.
    [[nodiscard]] std::string errors() const;

private:
    pid_t child_ = -1;
    int errors_ = -1;
    std::FILE* output_ = nullptr;
};

// Runs a command; its output is shown only in the std::runtime_error that is thrown when it fails.
void run_quietly(const std::vector<std::string>& command);

}  // namespace tumble::host
