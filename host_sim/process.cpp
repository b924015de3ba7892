#include "process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <system_error>

namespace tumble::host {
namespace {

std::array<int, 2> make_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
    return ends;
}

}  // namespace

Process::Process(const std::vector<std::string>& command, std::string_view input, Errors errors) {
    std::vector<char*> arguments;
    for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    const auto in = make_pipe(), out = make_pipe();
    std::fflush(nullptr);
    child_ = fork();
    if (child_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (child_ == 0) {
        setpgid(0, 0);  // its own group, so that it ends with all that it has started
        dup2(in[0], STDIN_FILENO);
        dup2(out[1], STDOUT_FILENO);
        if (errors == Errors::merge) dup2(out[1], STDERR_FILENO);
        execvp(arguments[0], arguments.data());
        _exit(127);
    }
    setpgid(child_, child_);
    close(in[0]);
    close(out[1]);
    signal(SIGPIPE, SIG_IGN);
    while (!input.empty()) {
        const ssize_t written = write(in[1], input.data(), input.size());
        if (written <= 0) break;
        input.remove_prefix(static_cast<std::size_t>(written));
    }
    close(in[1]);
    output_ = fdopen(out[0], "r");
}

Process::~Process() {
    if (output_ != nullptr) std::fclose(output_);
    if (child_ > 0) {
        kill(-child_, SIGTERM);
        waitpid(child_, nullptr, 0);
    }
}

bool Process::read_line(std::string& line) {
    line.clear();
    for (int c = std::fgetc(output_); c != EOF; c = std::fgetc(output_)) {
        if (c == '\n') return true;
        line += static_cast<char>(c);
    }
    return !line.empty();
}

int Process::wait(std::string* rest) {
    for (std::string line; read_line(line);) {
        if (rest != nullptr) *rest += line + '\n';
    }
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace tumble::host
