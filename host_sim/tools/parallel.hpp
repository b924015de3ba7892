// Runs independent pieces of work on all processors.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tumble::host {

// Calls work(i) for all i < count, and returns when all calls have ended. After an exception no further call starts,
// and the first exception is thrown again.
template <class Work>
void in_parallel(std::size_t count, const Work& work) {
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex mutex;
    std::vector<std::thread> workers;
    const std::size_t processors = std::max(1u, std::thread::hardware_concurrency());
    for (std::size_t t = 0; t < std::min(processors, count); ++t) {
        workers.emplace_back([&] {
            try {
                for (std::size_t i; (i = next++) < count;) work(i);
            } catch (...) {
                next = count;
                const std::lock_guard lock{mutex};
                if (!failure) failure = std::current_exception();
            }
        });
    }
    for (auto& worker : workers) worker.join();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace tumble::host
