// The port on a workstation: steady clock in nanoseconds, standard output, process exit.
#include "port.hpp"

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace tumble::port {

namespace {

bool text_lost = false;

// From now on the program ends with text_lost_status where its status would have been 0, also by a return from main.
void lose_text() {
    if (text_lost) return;
    text_lost = true;
    on_exit(
        [](int status, void*) {
            if (status == 0) std::_Exit(text_lost_status);
        },
        nullptr);
}

}  // namespace

void init() {}

Instant ticks() {
    const auto since_epoch = std::chrono::steady_clock::now().time_since_epoch();
    return Instant{
        static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count())};
}

// The cost of reading the clock (tens of ns, not constant) stays in.
std::uint64_t elapsed(Instant from, Instant to) {
    return to > from ? static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from) : 0;
}

std::string_view tick_unit() { return "ns"; }

std::string_view core() { return "host"; }

void write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) lose_text();
}

std::size_t stack_peak() { return 0; }

void exit(int status) {
    if (status != 0 && (status & 0xFF) == 0) status = 255;
    std::exit(status);
}

}  // namespace tumble::port
