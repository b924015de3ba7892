#include "tools/process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <stdexcept>
#include <system_error>

#include "tools/ending.hpp"

namespace tumble::host {
namespace {

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

std::array<int, 2> make_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe");
    return ends;
}

// A file in memory with this content, which is read from its start.
int make_file(std::string_view text) {
    const int file = memfd_create("tumble", MFD_CLOEXEC);
    if (file < 0) fail("memfd_create");
    while (!text.empty()) {
        const ssize_t written = write(file, text.data(), text.size());
        if (written <= 0) fail("write");
        text.remove_prefix(static_cast<std::size_t>(written));
    }
    lseek(file, 0, SEEK_SET);
    return file;
}

// The process groups of running children, 0 for a free entry. A signal handler reads this.
std::array<std::atomic<pid_t>, 1024> running;
static_assert(std::atomic<pid_t>::is_always_lock_free);

void replace(pid_t old, pid_t child) {
    for (auto& place : running) {
        pid_t found = old;
        if (place.compare_exchange_strong(found, child)) return;
    }
}

// The terminal's Ctrl-C does not reach children, since they have process groups of their own.
void end_children() {
    for (const auto& place : running)
        if (const pid_t child = place; child > 0) kill(-child, SIGTERM);
}

void end_group(int) {
    signal(SIGTERM, SIG_IGN);  // this process still waits for the child
    kill(0, SIGTERM);
}

// Runs in the process between this program and the child. It waits for the child and ends with the same status. If the
// program (its id is `program`) ends first, for any reason, it ends the whole group.
[[noreturn]] void guard(pid_t child, pid_t program) {
    close_range(3, ~0U, 0);  // closes pipes and locks of the program
    struct sigaction action {};
    action.sa_handler = end_group;
    sigaction(SIGTERM, &action, nullptr);
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != program) end_group(SIGTERM);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
    _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
}

}  // namespace

Process::Process(const std::vector<std::string>& command, std::string_view input, Errors errors) {
    std::vector<char*> arguments;
    for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    static std::once_flag registered;
    std::call_once(registered, [] { before_ending(end_children); });
    // Not a pipe: it could fill up while the child waits until its output is read.
    const int in = make_file(input);
    const auto out = make_pipe();
    if (errors == Errors::keep) errors_ = make_file({});
    std::fflush(nullptr);
    const pid_t program = getpid();
    child_ = fork();
    if (child_ < 0) fail("fork");
    if (child_ == 0) {
        setpgid(0, 0);  // a group of its own, so that all processes that the child starts end with it
        if (const pid_t child = fork(); child != 0) {
            if (child < 0) _exit(126);
            guard(child, program);
        }
        dup2(in, STDIN_FILENO);
        dup2(out[1], STDOUT_FILENO);
        if (errors == Errors::merge) dup2(out[1], STDERR_FILENO);
        if (errors == Errors::keep) dup2(errors_, STDERR_FILENO);
        execvp(arguments[0], arguments.data());
        _exit(127);
    }
    setpgid(child_, child_);
    replace(0, child_);
    close(in);
    close(out[1]);
    output_ = fdopen(out[0], "r");
}

Process::~Process() {
    if (output_ != nullptr) std::fclose(output_);
    if (errors_ >= 0) close(errors_);
    if (child_ > 0) {
        kill(-child_, SIGTERM);
        waitpid(child_, nullptr, 0);
        replace(child_, 0);
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
    replace(child_, 0);
    child_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string Process::errors() const {
    std::string text;
    std::array<char, 4096> part{};
    for (ssize_t count; (count = pread(errors_, part.data(), part.size(), static_cast<off_t>(text.size()))) > 0;)
        text.append(part.data(), static_cast<std::size_t>(count));
    return text;
}

std::string run_quietly(const std::vector<std::string>& command) {
    std::string text;
    Process process(command, {}, Process::Errors::keep);
    const int status = process.wait(&text);
    if (status == 127) throw std::runtime_error(command[0] + " not found");
    if (status != 0)
        throw std::runtime_error(command[0] + " failed with status " + std::to_string(status) + ":\n" + text +
                                 process.errors());
    return text;
}

}  // namespace tumble::host
