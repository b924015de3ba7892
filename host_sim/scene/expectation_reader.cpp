// The table [expect] of a recorded run.
#include <tumble/integrators/list.hpp>

#include <algorithm>
#include <charconv>
#include <limits>

#include "scene/reader.hpp"
#include "scene/reading.hpp"

namespace tumble::host {
namespace {

constexpr const char* an_integrator = "the name of an integrator, as `tumble list` prints it";

std::string integrator_of(const Value& value) {
    std::vector<std::string> names;
    Integrators::for_each([&]<class Method>() { names.emplace_back(Method::name); });
    const std::string& text = value.text(an_integrator);
    if (std::find(names.begin(), names.end(), text) == names.end())
        value.fail("got " + in_quotes(text) + suggestion(text, names), an_integrator);
    return text;
}

const Words<std::string> number_names{{"q32", "q32"}, {"f32", "f32"}, {"f64", "f64"}};

constexpr const char* a_hash = "16 hexadecimal digits in quotes";

std::uint64_t hash_of(const Value& value) {
    const std::string& text = value.text(a_hash);
    std::uint64_t hash = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
    if (text.size() != 16 || code != std::errc{} || end != text.data() + text.size()) value.refuse(a_hash);
    return hash;
}

}  // namespace

Expectation read_expectation(Table table) {
    Expectation expected;
    const auto whole = [&table](const char* key, std::int64_t least, std::int64_t most) {
        const auto value = table.find(key);
        if (!value) table.missing(key, "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
        return value ? value->whole(least, most) : 0;
    };
    if (const auto value = table.find("integrator")) expected.integrator = integrator_of(*value);
    else table.missing("integrator", an_integrator);
    table.required("numbers", expected.numbers, number_names);
    bool carry = false;
    if (table.optional("carry", carry)) expected.carry = carry;
    expected.steps = whole("steps", 0, max_steps);
    expected.bits = static_cast<int>(whole("tumble_bits", 0, std::numeric_limits<int>::max()));
    if (const auto value = table.find("hash")) expected.hash = hash_of(*value);
    else table.missing("hash", a_hash);
    table.finish();
    return expected;
}

}  // namespace tumble::host
