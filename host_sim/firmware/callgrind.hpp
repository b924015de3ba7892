// Counts the host's instructions inside one function by valgrind's callgrind. A second run gives the same number.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "tools/process.hpp"

namespace tumble::host {

struct Counted {
    std::uint64_t count = 0;
    std::string text;  // what the command wrote to standard output
};

// Runs a shell command and counts the instructions of `function` and of all that it calls. The function must not be
// inlined, and its symbol must be unique; `*` in the name matches anything. Throws std::runtime_error when valgrind is
// missing or the command fails.
[[nodiscard]] inline Counted instructions_in(const std::string& function, const std::string& command) {
    // The environment lies above the stack, and its size changes the alignment of the stack; so it is fixed.
    const std::string whole =
        "env -i PATH=/usr/bin:/bin valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect='" +
        function + "' " + command;
    Process process({"sh", "-c", whole}, {}, Process::Errors::merge);
    std::string all;
    Counted counted;
    bool found = false;
    for (std::string line; process.read_line(line); all += line + '\n') {
        // valgrind's own lines start with ==PID==.
        if (!line.starts_with("==")) counted.text += line + '\n';
        else if (const std::size_t mark = line.find("Collected : "); mark != std::string::npos) {
            counted.count = std::stoull(line.substr(mark + 12));
            found = true;
        }
    }
    if (process.wait() != 0 || !found)
        throw std::runtime_error{"valgrind (port/setup installs it) with " + command + ":\n" + all};
    return counted;
}

}  // namespace tumble::host
