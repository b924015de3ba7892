#include "tools/ending.hpp"

#include <signal.h>

#include <array>
#include <atomic>
#include <mutex>

namespace tumble::host {
namespace {

using Action = void (*)();
std::array<std::atomic<Action>, 4> actions;
static_assert(std::atomic<Action>::is_always_lock_free);

void act(int signal) {
    for (const auto& action : actions)
        if (const Action call = action; call != nullptr) call();
    raise(signal);  // ends this program when the handler returns, since SA_RESETHAND has put its default back
}

void handle_ending_signals() {
    for (const int signal : {SIGHUP, SIGINT, SIGPIPE, SIGQUIT, SIGTERM, SIGXFSZ}) {
        struct sigaction action {};
        sigaction(signal, nullptr, &action);
        if (action.sa_handler != SIG_DFL) continue;
        action.sa_handler = act;
        action.sa_flags = static_cast<int>(static_cast<unsigned>(SA_RESETHAND));
        sigaction(signal, &action, nullptr);
    }
}

}  // namespace

void before_ending(Action action) {
    static std::once_flag handled;
    std::call_once(handled, handle_ending_signals);
    for (auto& place : actions) {
        Action found = nullptr;
        if (place.compare_exchange_strong(found, action)) return;
    }
}

}  // namespace tumble::host
