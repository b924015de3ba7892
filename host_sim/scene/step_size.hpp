// The length of a step as a person writes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tumble::host {

// An exact fraction; or, where `denominator` is 0, `decimal`.
struct StepSize {
    std::int64_t numerator = 1;
    std::int64_t denominator = 256;
    double decimal = 0.0;
    [[nodiscard]] double seconds() const {
        return denominator == 0 ? decimal : static_cast<double>(numerator) / static_cast<double>(denominator);
    }
};

// With all digits, s.
[[nodiscard]] long double long_seconds(const StepSize& step);
// The step, from 0, that begins nearest to a time, s.
[[nodiscard]] std::int64_t nearest_step(double time, const StepSize& step);
// The step times 2^doublings; exact.
[[nodiscard]] StepSize scaled(StepSize step, int doublings);

// Reads "1/256" or "0.005". Empty when it is neither, or not positive.
[[nodiscard]] std::optional<StepSize> parse_step(std::string_view text);
// Writes 1/256, or a few digits.
[[nodiscard]] std::string step_text(const StepSize& step);

}  // namespace tumble::host
