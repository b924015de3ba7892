#include "scene/step_size.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include "scene/description.hpp"
#include "scene/toml.hpp"
#include "tools/text.hpp"

namespace tumble::host {

std::optional<StepSize> parse_step(std::string_view text) {
    const char* const end = text.data() + text.size();
    StepSize step{0, 0, 0.0};
    if (const auto slash = text.find('/'); slash != std::string_view::npos) {
        const char* const middle = text.data() + slash;
        const auto above = std::from_chars(text.data(), middle, step.numerator);
        const auto below = std::from_chars(middle + 1, end, step.denominator);
        const bool read = above.ec == std::errc{} && below.ec == std::errc{} && above.ptr == middle && below.ptr == end;
        if (!read || step.numerator <= 0 || step.denominator <= 0) return std::nullopt;
        return step;
    }
    const auto number = leading_number(text);
    if (!number || number->length != text.size() || !Quantity{Quantity::positive}.holds(number->value)) return {};
    step.decimal = number->value;
    return step;
}

long double long_seconds(const StepSize& step) {
    return step.denominator == 0
               ? static_cast<long double>(step.decimal)
               : static_cast<long double>(step.numerator) / static_cast<long double>(step.denominator);
}
std::int64_t nearest_step(double time, const StepSize& step) {
    return std::llround(static_cast<long double>(time) / long_seconds(step));
}

StepSize scaled(StepSize step, int doublings) {
    for (; doublings > 0 && step.denominator != 0; --doublings) {
        if (step.denominator % 2 == 0) step.denominator /= 2;
        else if (step.numerator < std::numeric_limits<std::int64_t>::max() / 2) step.numerator *= 2;
        else break;
    }
    for (; doublings < 0 && step.denominator != 0; ++doublings) {
        if (step.numerator % 2 == 0) step.numerator /= 2;
        else if (step.denominator < std::numeric_limits<std::int64_t>::max() / 2) step.denominator *= 2;
        else break;
    }
    if (doublings != 0) step = {1, 0, std::ldexp(step.seconds(), doublings)};
    return step;
}

std::string step_text(const StepSize& step) {
    if (step.denominator == 0) return few_digits(step.decimal);
    return std::to_string(step.numerator) + (step.denominator == 1 ? "" : "/" + std::to_string(step.denominator));
}

std::int64_t SceneDescription::steps() const {
    // The product and the quotient round by a few units of 1e-16, as does the decimal in the file. The tolerance
    // absorbs that; its cap keeps it below one step in long runs.
    const double quotient =
        step.denominator == 0 ? duration / step.decimal
                              : duration * static_cast<double>(step.denominator) / static_cast<double>(step.numerator);
    if (!(quotient < 9e18)) return std::numeric_limits<std::int64_t>::max();
    const double tolerance = std::min(1e-9 * quotient, 1e-5);
    return static_cast<std::int64_t>(std::ceil(quotient - tolerance));
}

}  // namespace tumble::host
