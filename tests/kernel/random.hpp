// Random test inputs: the same ones in every run and on every machine.
#pragma once

#include <bit>
#include <cstdint>

namespace tumble::test {

// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
public:
    explicit constexpr Random(std::uint64_t seed) : state_{seed} {}

    constexpr std::uint64_t bits() {
        std::uint64_t z = state_ += 0x9e3779b97f4a7c15u;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    constexpr std::int32_t int32() { return static_cast<std::int32_t>(bits()); }
    constexpr std::int64_t int64() { return static_cast<std::int64_t>(bits()); }
    // low <= n <= high
    constexpr int between(int low, int high) {
        return low + static_cast<int>(bits() % static_cast<std::uint64_t>(high - low + 1));
    }
    // low <= x < high
    constexpr double uniform(double low, double high) {
        return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
    }

private:
    std::uint64_t state_;
};

}  // namespace tumble::test
