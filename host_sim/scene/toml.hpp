// A TOML document whose values know their place in the file. A `Table` returns the values of its keys and remembers
// these keys, so that finish() can report all others as unknown. A `Value` is one node. Both raise their messages as a
// SceneError.
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/error.hpp"
#include "scene/words.hpp"
#include "tools/raise.hpp"
#include "tools/text.hpp"

// toml++ 3.3 asserts (or, with NDEBUG, lets the compiler assume) that a key follows '[', although its parser reports
// the error "[=]" well.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(condition) static_assert(true)
#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

namespace tumble::host {

// Tables, lists and parts of keys in each other, in scenes and in lines of a live run; a scene needs 4. What reads or
// prints them calls itself once for each.
inline constexpr int most_nested = 64;

// The condition of a number, and its unit. `parts` names the elements of an array.
struct Quantity {
    // The largest number, and the smallest positive one. Products of several of them stay in the range of a double.
    static constexpr double largest = 1e40, smallest = 1e-40;

    using enum Field::Kind;
    Field::Kind bound;
    const char* unit = "";
    const char* parts = "";

    [[nodiscard]] bool holds(double x) const;
    // "3 finite numbers [x, y, z] (m)".
    [[nodiscard]] std::string expected(std::size_t count = 1) const;
    // "of a size up to 1e+40".
    [[nodiscard]] std::string sizes() const;
};
inline constexpr Quantity text_in_quotes{};  // tag: the value is a string

// The shortest decimal that reads back as the same number.
[[nodiscard]] std::string shown(double x);

struct Place {
    std::string file;
    int line = 0;
    std::string key;

    [[nodiscard]] SceneError error(const std::string& problem, const std::string& wanted) const;
    [[noreturn]] void fail(const std::string& problem, const std::string& wanted) const {
        raise(error(problem, wanted));
    }
};

class Value {
public:
    Value(Place place, const toml::node& node) : place_(std::move(place)), node_(&node) {}

    [[nodiscard]] const toml::node& node() const { return *node_; }
    [[nodiscard]] const Place& place() const { return place_; }
    [[noreturn]] void fail(const std::string& problem, const std::string& wanted) const {
        place_.fail(problem, wanted);
    }
    // An error about the value in the file.
    [[nodiscard]] SceneError refusal(const std::string& wanted) const;
    [[noreturn]] void refuse(const std::string& wanted) const { raise(refusal(wanted)); }

    // Element i of an array.
    [[nodiscard]] Value operator[](std::size_t i) const;

    [[nodiscard]] std::int64_t whole(std::int64_t least, std::int64_t most) const;
    [[nodiscard]] double number(const Quantity& quantity) const;
    // The number, whether it is written with a point or not; none where the value is no number.
    [[nodiscard]] std::optional<double> any_number() const;
    // An array of as many numbers as one of `counts`.
    [[nodiscard]] std::vector<double> numbers(const Quantity& quantity,
                                              std::initializer_list<std::size_t> counts) const;
    // Not empty.
    [[nodiscard]] const std::string& text(const std::string& wanted) const;

private:
    Place place_;
    const toml::node* node_;
};

template <class T>
[[nodiscard]] std::vector<std::string> keys_of(const Words<T>& words) {
    std::vector<std::string> keys;
    for (const auto& [word, meaning] : words) keys.push_back(word);
    return keys;
}

// A conversion for each C++ type, with the value that it expects. It is found by the type of the argument, so a reader
// can add its own.
[[nodiscard]] std::string wanted(const double&, const Quantity& quantity);
[[nodiscard]] std::string wanted(const std::string&, const Quantity&);
[[nodiscard]] std::string wanted(const bool&, const Quantity&);
template <std::size_t N>
[[nodiscard]] std::string wanted(const std::array<double, N>&, const Quantity& quantity) {
    return quantity.expected(N);
}
template <class T>
[[nodiscard]] std::string wanted(const T&, const Words<T>& words) {
    return listed(keys_of(words));
}

void convert(const Value& value, double& out, const Quantity& quantity);
void convert(const Value& value, std::optional<double>& out, const Quantity& quantity);
void convert(const Value& value, std::string& out, const Quantity& quantity);
void convert(const Value& value, bool& out, const Quantity& quantity);
template <std::size_t N>
void convert(const Value& value, std::array<double, N>& out, const Quantity& quantity) {
    const auto numbers = value.numbers(quantity, {N});
    std::copy(numbers.begin(), numbers.end(), out.begin());
}
template <class T>
void convert(const Value& value, T& out, const Words<T>& words) {
    const auto names = keys_of(words);
    const std::string& text = value.text(listed(names));
    const auto word = std::find(names.begin(), names.end(), text);
    if (word == names.end()) value.fail("got " + in_quotes(text) + suggestion(text, names), listed(names));
    out = words[static_cast<std::size_t>(word - names.begin())].second;
}

class Table {
public:
    Table(Place place, const toml::table& table) : place_(std::move(place)), table_(&table) {}

    [[nodiscard]] const Place& place() const { return place_; }

    // The value of a key, which is known from now on.
    [[nodiscard]] std::optional<Value> find(const std::string& key);

    [[nodiscard]] bool has(const std::string& key) const { return table_->contains(key); }

    // For checks on a key that is there.
    [[nodiscard]] Value at(const std::string& key) { return find(key).value(); }

    template <class T, class How = Quantity>
    bool optional(const std::string& key, T& out, const How& how = text_in_quotes) {
        const auto value = find(key);
        if (value) convert(*value, out, how);
        return value.has_value();
    }

    template <class T, class How = Quantity>
    void required(const std::string& key, T& out, const How& how = text_in_quotes) {
        if (!optional(key, out, how)) missing(key, wanted(out, how));
    }

    // A key that is required or optional.
    template <class T, class How>
    void read(const std::string& key, T& out, const How& how, bool is_required) {
        if (is_required) required(key, out, how);
        else optional(key, out, how);
    }

    // Remembers that a key is missing; finish() reports it unless a misspelt key explains it.
    void missing(const std::string& key, const std::string& wanted) {
        if (!missing_) missing_ = {key, wanted};
    }

    // Throws for the first unknown key, else for the first missing one. Checks across keys come after it.
    void finish() const;

    // Reports a rule across keys at the line of the table.
    [[noreturn]] void fail(const std::string& key, const std::string& problem, const std::string& wanted) const {
        place_of(key, place_.line).fail(problem == "missing" ? problem + named() : problem, wanted);
    }

    [[nodiscard]] std::optional<Table> table(const std::string& key);
    [[nodiscard]] std::vector<Table> tables(const std::string& key);

private:
    // " in "ball"" of a table with a name; else empty.
    [[nodiscard]] std::string named() const;
    [[nodiscard]] Place place_of(const std::string& key, int line) const {
        return {place_.file, line, place_.key.empty() ? key : place_.key + "." + key};
    }

    Place place_;
    const toml::table* table_;
    std::set<std::string> known_;
    std::optional<std::pair<std::string, std::string>> missing_;
};

// A text in memory, parsed; `file` stands for it in messages. Throws SceneError for what is not TOML.
class Document {
public:
    Document(std::string_view text, std::string file);
    // Lives as long as the document does.
    [[nodiscard]] Table root() const { return Table({file_, 1, ""}, table_); }

private:
    std::string file_;
    toml::table table_;
};

}  // namespace tumble::host
