// stack_peak() is the depth that was reached since init(): it sees a deep call, keeps it, and init() forgets it.
#include "port.hpp"

namespace {

constexpr std::size_t deep = 1024;

[[gnu::noinline]] void use_stack() {
    volatile unsigned char bytes[deep];
    for (std::size_t i = 0; i < deep; ++i) bytes[i] = 1;
    if (bytes[deep / 2] != 1) tumble::port::exit(5);
}

}  // namespace

int main() {
    using namespace tumble::port;
    init();
    const std::size_t shallow = stack_peak();
    use_stack();
    const std::size_t peak = stack_peak();
    const std::size_t kept = stack_peak();
    init();
    const std::size_t repainted = stack_peak();
    if (shallow < 8 || shallow > 256) return 1;
    if (peak < deep || peak > deep + 256) return 2;
    if (kept != peak) return 3;
    if (repainted != shallow) return 4;
    return 0;
}
