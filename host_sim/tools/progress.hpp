// A progress bar on a terminal; nothing when output is piped, or when the work takes no longer than a moment.
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <iostream>
#include <string>

namespace tumble::host {

class ProgressBar {
public:
    explicit ProgressBar(std::int64_t total)
        : total_(total), on_(isatty(STDERR_FILENO) == 1 && isatty(STDOUT_FILENO) == 1) {}
    ~ProgressBar() {
        if (shown_) std::cerr << "\r\033[K";
    }
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    // At most ten times a second. `what` stands behind the bar.
    void show(std::int64_t done, const std::string& what = {}) {
        if (!on_ || total_ <= 0) return;
        const auto now = std::chrono::steady_clock::now();
        if (now < next_) return;
        next_ = now + std::chrono::milliseconds(100);
        shown_ = true;
        constexpr std::int64_t width = 40;
        const auto filled = static_cast<std::size_t>(width * done / total_);
        std::cerr << "\r\033[K[" << std::string(filled, '=') << std::string(width - filled, ' ') << "] "
                  << 100 * done / total_ << " % " << what << std::flush;
    }

private:
    std::int64_t total_;
    bool on_, shown_ = false;
    std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
};

}  // namespace tumble::host
