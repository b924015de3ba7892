#include "tools/process.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <system_error>

namespace tumble::host {
namespace {

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

std::array<int, 2> make_pipe() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) fail("pipe");
    return ends;
}

// A file in memory, to be read from its start.
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

// The children that run, 0 where a place is free; a signal handler may read no more than this.
std::array<std::atomic<pid_t>, 1024> running;
static_assert(std::atomic<pid_t>::is_always_lock_free);

void replace(pid_t old, pid_t child) {
    for (auto& place : running) {
        pid_t found = old;
        if (place.compare_exchange_strong(found, child)) return;
    }
}

// Children have groups of their own, which the terminal's Ctrl-C does not reach.
void end_children(int signal) {
    for (const auto& place : running)
        if (const pid_t child = place; child > 0) kill(-child, SIGTERM);
    raise(signal);  // ends this program when the handler returns, since SA_RESETHAND has put its default back
}

void handle_ending_signals() {
    for (const int signal : {SIGHUP, SIGINT, SIGPIPE, SIGTERM}) {
        struct sigaction action {};
        sigaction(signal, nullptr, &action);
        if (action.sa_handler != SIG_DFL) continue;  // as nohup ignores SIGHUP
        action.sa_handler = end_children;
        action.sa_flags = static_cast<int>(SA_RESETHAND);
        sigaction(signal, &action, nullptr);
    }
}

}  // namespace

Process::Process(const std::vector<std::string>& command, std::string_view input, Errors errors) {
    std::vector<char*> arguments;
    for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    static std::once_flag handled;
    std::call_once(handled, handle_ending_signals);
    // A file, since a pipe could fill up while the child waits for its output to be read.
    const int in = make_file(input);
    const auto out = make_pipe();
    if (errors == Errors::keep) errors_ = make_file({});
    std::fflush(nullptr);
    child_ = fork();
    if (child_ < 0) fail("fork");
    if (child_ == 0) {
        setpgid(0, 0);  // its own group, so that it ends with all that it has started
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

void run_quietly(const std::vector<std::string>& command) {
    std::string messages;
    const int status = Process(command, {}, Process::Errors::merge).wait(&messages);
    if (status == 127) throw std::runtime_error(command[0] + " not found");
    if (status != 0)
        throw std::runtime_error(command[0] + " failed with status " + std::to_string(status) + ":\n" + messages);
}

}  // namespace tumble::host
