// Shows the progress of a long job on standard error. On a terminal it is a bar with the remaining time, after half a
// second. Where the output is piped it is nothing, or a line for each tenth.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <iostream>
#include <mutex>
#include <string>

namespace tumble::host {

class Progress {
public:
    enum class Piped { silent, tenths };

    explicit Progress(std::int64_t total, Piped piped = Piped::silent)
        : total_(total), piped_(piped), on_terminal_(isatty(STDERR_FILENO) == 1 && isatty(STDOUT_FILENO) == 1) {}
    ~Progress() {
        if (shown_) std::cerr << "\r\033[K";
    }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // Both functions may be called by any thread. `what` is shown behind the bar.
    void show(std::int64_t done, const std::string& what = {}) {
        const std::lock_guard lock(mutex_);
        advance_to(done, what);
    }
    // Counts one more as done.
    void step(const std::string& what) {
        const std::lock_guard lock(mutex_);
        advance_to(done_ + 1, what);
    }

private:
    void advance_to(std::int64_t done, const std::string& what) {
        const std::int64_t before = done_;
        done_ = done;
        if (total_ <= 0) return;
        if (on_terminal_) draw(what);
        else if (piped_ == Piped::tenths && done * 10 / total_ != before * 10 / total_)
            std::cerr << "[" << done << "/" << total_ << "] " << what << time_left() << std::endl;
    }
    // ", 2:05 left", if the rest takes as long as the part before; empty at the start and at the end.
    [[nodiscard]] std::string time_left() const {
        if (done_ <= 0 || done_ >= total_) return {};
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start_;
        const auto seconds =
            static_cast<std::int64_t>(taken.count() / static_cast<double>(done_) * static_cast<double>(total_ - done_));
        return ", " + std::to_string(seconds / 60) + (seconds % 60 < 10 ? ":0" : ":") + std::to_string(seconds % 60) +
               " left";
    }
    // At most ten times a second.
    void draw(const std::string& what) {
        const auto now = std::chrono::steady_clock::now();
        if (now < next_) return;
        next_ = now + std::chrono::milliseconds(100);
        shown_ = true;
        constexpr std::int64_t width = 40;
        const auto filled = static_cast<std::size_t>(width * done_ / total_);
        std::cerr << "\r\033[K[" << std::string(filled, '=') << std::string(width - filled, ' ') << "] "
                  << 100 * done_ / total_ << " % " << what << time_left() << std::flush;
    }

    std::int64_t total_, done_ = 0;
    Piped piped_;
    bool on_terminal_, shown_ = false;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::chrono::steady_clock::time_point next_ = start_ + std::chrono::milliseconds(500);
    std::mutex mutex_;
};

}  // namespace tumble::host
