// Processes that the command starts.
#include <poll.h>
#include <signal.h>

#include <array>

#include "command_runner.hpp"

namespace tumble::host {
namespace {

TEST(Process, all_processes_end_when_the_program_ends) {
    for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGABRT, SIGKILL, SIGSEGV}) {
        std::array<int, 2> held{};  // its writing end stays open for as long as one of them runs
        ASSERT_EQ(pipe(held.data()), 0);
        const int status = status_in_a_process([&] {
            // A sanitizer's own handler would end it by exit().
            if (signal == SIGSEGV || signal == SIGABRT) ::signal(signal, SIG_DFL);
            dup2(held[1], STDERR_FILENO);  // what is above it is not kept by all of them
            Process child({"sh", "-c", "sleep 60 & echo started; wait"});
            std::string line;
            (void)child.read_line(line);
            raise(signal);
        });
        close(held[1]);
        EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal) << signal << ": " << status;
        pollfd end{held[0], POLLIN, 0};
        EXPECT_EQ(poll(&end, 1, 10000), 1) << "something runs on after signal " << signal;
        close(held[0]);
    }
}

TEST(Process, a_child_that_ends_by_a_signal_has_its_status) {
    EXPECT_EQ(Process({"sh", "-c", "kill -9 $$"}).wait(), 128 + SIGKILL);
    EXPECT_EQ(Process({"sh", "-c", "exit 7"}).wait(), 7);
    EXPECT_EQ(Process({"no_such_program"}).wait(), 127);
}

TEST(Process, input_and_output_larger_than_a_pipe_pass_through) {
    std::string input, output;
    for (int i = 0; i < 100000; ++i) input += "line " + std::to_string(i) + "\n";
    Process child({"sh", "-c", "cat; echo done >&2"}, input, Process::Errors::keep);
    EXPECT_EQ(child.wait(&output), 0);
    EXPECT_EQ(output, input);
    EXPECT_EQ(child.errors(), "done\n");
}

TEST(Emulator, a_timeout_that_is_not_a_positive_number_is_refused) {
    const std::string run = (source_directory / "port/qemu/run").string();
    for (const std::string timeout : {"abc", "0", "0.0", "-1", "", "1s", "1e3", ".", "inf", "1 2"}) {
        std::string text;
        EXPECT_EQ(Process({run, "--timeout", timeout, "cortex-m3", "no.elf"}, {}, Process::Errors::merge).wait(&text),
                  2);
        EXPECT_EQ(text, "run: --timeout: got '" + timeout + "', expected a positive number of seconds\n");
    }
    for (const std::string timeout : {"1", "0.5", "600"})
        EXPECT_EQ(Process({run, "--timeout", timeout, "cortex-m3", "no.elf"}, {}, Process::Errors::merge).wait(), 126);
}

}  // namespace
}  // namespace tumble::host
