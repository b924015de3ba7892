// Start-up: .data is copied, .bss is zero and constructors ran before main.
#include "port.hpp"

#include <array>

namespace {

struct Constructed {
    Constructed() : self{this} {}
    Constructed* self;
};

volatile std::uint32_t copied = 0x12345678;
volatile unsigned char copied_byte = 0x9A;
std::array<volatile std::uint32_t, 100> zeroed;
Constructed constructed;

}  // namespace

int main() {
    if (copied != 0x12345678 || copied_byte != 0x9A) return 1;
    for (auto& word : zeroed)
        if (word != 0) return 2;
    if (constructed.self != &constructed) return 3;
    return 0;
}
