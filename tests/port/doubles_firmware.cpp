// Sums, differences, products and quotients of 20000 doubles with sparse mantissas, where rounding errs if it errs at
// all: prints a digest for the build to compare with the one that IEEE hardware gives.
#include "port.hpp"

#include "../write_number.hpp"

#include <bit>
#include <cstdint>

namespace {

std::uint64_t state = 88172645463325252u;

std::uint64_t random_bits() {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state;
}
std::uint64_t random_below(unsigned n) { return static_cast<std::uint32_t>(random_bits() >> 32) % n; }

double random_double() {
    std::uint64_t mantissa = random_bits();
    switch (random_below(4)) {
    case 0: mantissa = (std::uint64_t{1} << random_below(52)) ^ (std::uint64_t{1} << random_below(52)); break;
    case 1: mantissa = ~std::uint64_t{0} << random_below(52); break;
    case 2: mantissa = ~std::uint64_t{0} >> (12 + random_below(52)); break;
    default: break;
    }
    const std::uint64_t exponent = 1023 - 35 + random_below(70), fraction = mantissa & ((std::uint64_t{1} << 52) - 1);
    return std::bit_cast<double>((random_bits() & (std::uint64_t{1} << 63)) | (exponent << 52) | fraction);
}

}  // namespace

int main() {
    tumble::port::init();
    std::uint32_t digest = 2166136261u;
    const auto add = [&](double result) {
        const auto bits = std::bit_cast<std::uint64_t>(result);
        digest = (digest ^ static_cast<std::uint32_t>(bits)) * 16777619u;
        digest = (digest ^ static_cast<std::uint32_t>(bits >> 32)) * 16777619u;
    };
    for (int i = 0; i < 20000; ++i) {
        volatile double a = random_double(), b = random_double();  // volatile: at run time
        add(a + b);
        add(a - b);
        add(b - a);
        add(a * b);
        add(a / b);
    }
    write_number(digest, 16, 8);
    tumble::port::write("\n");
    return 0;
}
