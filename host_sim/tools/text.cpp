#include "tools/text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <utility>
#include <vector>

namespace tumble::host {
namespace {

std::string formatted(const char* format, long double value) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

// The text in quotes, with a backslash before quotes and backslashes. `escape` gives the replacement of any other
// character; an empty one leaves the character as it is.
template <class Escape>
std::string quoted(std::string_view text, const Escape& escape) {
    std::string quoted = "\"";
    for (const char c : text) {
        const std::string other = escape(static_cast<unsigned char>(c));
        if (c == '"' || c == '\\') quoted += '\\';
        if (other.empty()) quoted += c;
        else quoted += other;
    }
    return quoted + '"';
}

}  // namespace

std::string seventeen_digits(long double value) { return formatted("%.17Lg", value); }
std::string few_digits(long double value) { return formatted("%.6Lg", value); }
std::string two_digits(double value) { return formatted("%.2Lg", value); }

std::string four_digits_down(long double value) {
    if (!(value > 0)) return few_digits(value);
    const long double unit = std::pow(10.0L, std::floor(std::log10(value)) - 3);
    return few_digits(std::floor(value / unit) * unit);
}

std::string cpp_number(double value) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
    std::string number(text.data(), end);
    if (number.find_first_of(".en") == std::string::npos) number += ".0";
    return number;
}

std::optional<LeadingNumber> leading_number(std::string_view text) {
    LeadingNumber number;
#if defined(__cpp_lib_to_chars)
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), number.value);
    if (code != std::errc{}) return {};
    number.length = static_cast<std::size_t>(end - text.data());
#else  // a library that reads no floating point; strtod() takes blanks, signs and hexadecimal digits besides
    const std::string decimal(text.substr(0, text.find_first_not_of("0123456789.eE+-")));
    char* end = nullptr;
    if (!decimal.starts_with('+')) number.value = std::strtod(decimal.c_str(), &end);
    if (end == nullptr || end == decimal.c_str() || !std::isfinite(number.value)) return {};
    number.length = static_cast<std::size_t>(end - decimal.c_str());
#endif
    return number;
}

std::string hex(std::uint64_t value) {
    std::string text(16, '0');
    for (std::size_t i = 16; i-- > 0; value >>= 4) text[i] = "0123456789abcdef"[value & 15];
    return text;
}

std::string shortened(std::string_view text, std::size_t most) {
    std::size_t characters = 0, end = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if ((static_cast<unsigned char>(text[i]) & 0xc0) == 0x80) continue;
        if (characters++ == most - 1) end = i;
    }
    return characters > most ? std::string(text.substr(0, end)) + "\u2026" : std::string(text);
}

std::string in_quotes(std::string_view text) {
    constexpr std::size_t longest = 80;
    std::string line = "\"";
    for (const char c : shortened(text, longest)) {
        if (const auto code = static_cast<unsigned char>(c); code < 0x20 || code == 0x7f)
            line += "\\x" + hex(code).substr(14);
        else line += c;
    }
    return line + "\"";
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
    const auto is_same = [](char x, char y) {
        return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
    };
    std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        before = std::exchange(last, row);
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({last[j - 1] + (is_same(a[i - 1], b[j - 1]) ? 0 : 1), last[j] + 1, row[j - 1] + 1});
            if (i > 1 && j > 1 && is_same(a[i - 1], b[j - 2]) && is_same(a[i - 2], b[j - 1]))
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
    }
    return row[b.size()];
}

std::string json_number(long double value) {
    return std::isfinite(static_cast<double>(value)) ? seventeen_digits(value) : "null";
}

std::string json_text(std::string_view text) {
    return quoted(text, [](unsigned char code) {
        return code < 0x20 || code == 0x7f ? "\\u00" + hex(code).substr(14) : std::string();
    });
}

std::string cpp_text(std::string_view text) {
    return quoted(text, [](unsigned char code) {
        std::string escape;
        if (code >= 0x20 && code <= 0x7e) return escape;
        escape = '\\';  // always three octal digits, so that a digit may follow
        for (const int shift : {6, 3, 0}) escape += static_cast<char>('0' + ((code >> shift) & 7));
        return escape;
    });
}

std::string csv_field(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

std::optional<double> parse_frequency(std::string_view text) {
    const auto number = leading_number(text);
    if (!number) return {};
    std::string_view unit = text.substr(number->length);
    while (unit.starts_with(' ')) unit.remove_prefix(1);
    double hertz = 0;
    for (const auto& [name, size] : {std::pair{"", 1.0}, {"Hz", 1.0}, {"kHz", 1e3}, {"MHz", 1e6}, {"GHz", 1e9}})
        if (unit == name) hertz = number->value * size;
    if (!(std::isfinite(hertz) && hertz > 0)) return {};
    return hertz;
}

}  // namespace tumble::host
