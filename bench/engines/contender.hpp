// The contest of engines: a free asymmetric top (principal moments 1, 2, 3 kg m^2; angular velocity 0.1, 2, 0.1 rad/s
// in the body frame; the tests' own top) for 100 s at 1/256 s. One row for each contender: the error of its orientation
// against an integration in long double that shares no code with any of them, the drift of energy and momentum, and the
// instructions of a whole step on x86-64. Valgrind's callgrind counts the instructions; the count repeats.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tumble::bench {

inline constexpr std::array<double, 3> top_moments{1, 2, 3};   // kg m^2
inline constexpr std::array<double, 3> top_spin{0.1, 2, 0.1};  // rad/s, body frame
inline constexpr int top_steps_per_second = 256, top_seconds = 100;

// A top in some engine's world.
class Runner {
public:
    virtual ~Runner() = default;
    virtual void step() = 0;
    // w, x, y, z; body to world. Of unit length to the engine's rounding.
    [[nodiscard]] virtual std::array<double, 4> orientation() const = 0;
    [[nodiscard]] virtual std::array<double, 3> spin() const = 0;  // rad/s, body frame
};

struct Contender {
    std::string engine, version, method;
    std::string numbers;  // q32, f32 or f64
    bool carry;
    std::function<std::unique_ptr<Runner>()> make;
};

// A world vector in the body frame of orientation q.
[[nodiscard]] inline std::array<double, 3> to_body(const std::array<double, 4>& q, const std::array<double, 3>& r) {
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    return {(1 - 2 * (y * y + z * z)) * r[0] + 2 * (x * y + w * z) * r[1] + 2 * (x * z - w * y) * r[2],
            2 * (x * y - w * z) * r[0] + (1 - 2 * (x * x + z * z)) * r[1] + 2 * (y * z + w * x) * r[2],
            2 * (x * z + w * y) * r[0] + 2 * (y * z - w * x) * r[1] + (1 - 2 * (x * x + y * y)) * r[2]};
}

// main() of a contest: prints one row for each contender. Runs itself under valgrind to count instructions.
int contest(int argc, char** argv, const std::vector<Contender>& contenders);

}  // namespace tumble::bench
