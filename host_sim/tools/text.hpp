// Numbers and names as text: for people, JSON, CSV and C++.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace tumble::host {

// 17 significant digits: enough for every bit of a double.
[[nodiscard]] std::string seventeen_digits(long double value);

// A few digits for a table.
[[nodiscard]] std::string few_digits(long double value);

// Two significant digits, as of an error.
[[nodiscard]] std::string two_digits(double value);

// Four digits, rounded down: a largest safe step is still safe as printed.
[[nodiscard]] std::string four_digits_down(long double value);

// The shortest decimal that reads back as the same double, with a point or an exponent.
[[nodiscard]] std::string cpp_number(double value);

// The decimal number that the text begins with, and the characters that it takes; empty where there is none.
struct LeadingNumber {
    double value = 0;
    std::size_t length = 0;
};
[[nodiscard]] std::optional<LeadingNumber> leading_number(std::string_view text);

// A number system with or without carry: "q32 carry", "f32 plain", "f64".
[[nodiscard]] inline std::string numbers_text(const std::string& numbers, bool carry) {
    return numbers + (carry ? " carry" : numbers == "f64" ? "" : " plain");
}

// The frequency in Hz of a text such as 48000000, 16e6, 16MHz or "32.768 kHz". The unit is Hz, kHz, MHz, GHz or
// nothing. Empty for any other text, and where the number is not positive and finite.
[[nodiscard]] std::optional<double> parse_frequency(std::string_view text);

// A hash as 16 hex digits.
[[nodiscard]] std::string hex(std::uint64_t value);

// The first characters of a text in UTF-8, at most `most` of them.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t most);

// For messages: one line of at most 80 characters, in quotes, however long the text is.
[[nodiscard]] std::string in_quotes(std::string_view text);

// "a", "b" or "c"
template <class Names>
[[nodiscard]] std::string listed(const Names& names) {
    std::string list;
    std::size_t i = 0;
    for (const auto& name : names) {
        if (i > 0) list += i + 1 == names.size() ? " or " : ", ";
        list += in_quotes(name);
        ++i;
    }
    return list;
}

// a, b, c
template <class Names>
[[nodiscard]] std::string joined(const Names& names) {
    std::string list;
    for (const auto& name : names) list += (list.empty() ? "" : ", ") + std::string(name);
    return list;
}

// Number of single-letter edits (insert, delete, replace, exchange of neighbours) between two words; case is ignored.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

// " (did you mean "mass"?)" with the nearest name, or with one that ends in the word; empty where more than half of the
// word differs from every name.
template <class Names>
[[nodiscard]] std::string suggestion(std::string_view word, const Names& names) {
    constexpr std::size_t longest_word = 64;
    if (word.size() > longest_word) return {};
    std::size_t nearest = std::max<std::size_t>(1, word.size() / 2) + 1;
    std::string_view best;
    for (const std::string_view name : names) {
        if (name.size() > 2 * longest_word) continue;
        const bool ends_so = word.size() > 1 && name.size() > word.size() &&
                             edit_distance(word, name.substr(name.size() - word.size())) == 0;
        const std::size_t distance = ends_so ? 1 : edit_distance(word, name);
        if (distance < nearest) {
            nearest = distance;
            best = name;
        }
    }
    return best.empty() ? "" : " (did you mean " + in_quotes(best) + "?)";
}

// A number (null when it is not finite as a double) or a text in JSON.
[[nodiscard]] std::string json_number(long double value);
[[nodiscard]] std::string json_text(std::string_view text);
// Of numbers: [1, 2, 3].
template <class Numbers>
[[nodiscard]] std::string json_array(const Numbers& numbers) {
    std::string text = "[";
    for (std::size_t i = 0; i < numbers.size(); ++i) text += (i > 0 ? ", " : "") + json_number(numbers[i]);
    return text + "]";
}

// A string literal of C++ in ASCII; it is safe in a comment as well.
[[nodiscard]] std::string cpp_text(std::string_view text);

// A CSV field, in quotes when it needs them.
[[nodiscard]] std::string csv_field(std::string_view text);

}  // namespace tumble::host
