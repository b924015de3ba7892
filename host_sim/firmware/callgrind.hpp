// Counts the host's instructions inside one function by valgrind's callgrind. A second run gives the same number.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <stdexcept>
#include <string>

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
    FILE* pipe = popen((whole + " 2>&1").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error{"cannot run: " + whole};
    std::string all;
    std::array<char, 4096> part{};
    while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe)) all.append(part.data(), n);
    const int status = pclose(pipe);
    Counted counted;
    bool found = false;
    for (std::size_t at = 0; at < all.size();) {
        std::size_t end = all.find('\n', at);
        if (end == std::string::npos) end = all.size();
        const std::string line = all.substr(at, end - at);
        at = end + 1;
        // valgrind's own lines start with ==PID==.
        if (!line.starts_with("==")) counted.text += line + '\n';
        else if (const std::size_t mark = line.find("Collected : "); mark != std::string::npos) {
            counted.count = std::stoull(line.substr(mark + 12));
            found = true;
        }
    }
    if (status != 0 || !found)
        throw std::runtime_error{"valgrind (port/setup installs it) with " + command + ":\n" + all};
    return counted;
}

}  // namespace tumble::host
