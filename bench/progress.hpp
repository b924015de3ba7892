// How far a program that measures has come, on standard error.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <mutex>
#include <string>

namespace tumble::bench {

// One line that is rewritten on a terminal; plain lines elsewhere, one for each tenth. Any thread may take a step.
class Progress {
public:
    explicit Progress(std::size_t total) : total_{total} {}
    void step(const std::string& what) {
        const std::lock_guard lock{mutex_};
        ++done_;
        if (isatty(2) != 0) {
            std::fprintf(stderr, "\r[%zu/%zu] %-60.60s", done_, total_, what.c_str());
            if (done_ == total_) std::fputc('\n', stderr);
        } else if (done_ * 10 / total_ != (done_ - 1) * 10 / total_) {
            std::fprintf(stderr, "[%zu/%zu] %s\n", done_, total_, what.c_str());
        }
    }

private:
    std::size_t total_, done_ = 0;
    std::mutex mutex_;
};

}  // namespace tumble::bench
