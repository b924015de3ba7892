#include "scene/toml.hpp"

#include <charconv>
#include <cmath>

namespace tumble::host {
namespace {

constexpr std::size_t longest_key = 200;  // in messages

// Keys that other formats have, and what they are called here.
constexpr std::pair<std::string_view, const char*> other_names[] = {
    {"rotation", "orientation"},   {"attitude", "orientation"},
    {"quaternion", "orientation"}, {"spin", "angular_velocity"},
    {"omega", "angular_velocity"}, {"mu", "friction"},
    {"bounciness", "restitution"}, {"elasticity", "restitution"},
    {"static", "fixed"},           {"dt", "step"},
    {"timestep", "step"},          {"time_step", "step"},
};

int line_of(const toml::source_region& source) { return static_cast<int>(source.begin.line); }

std::string shown(const toml::node& node) {
    if (const auto* x = node.as_integer()) return std::to_string(x->get());
    if (const auto* x = node.as_floating_point()) return host::shown(x->get());
    if (const auto* x = node.as_string()) return in_quotes(x->get());
    if (const auto* x = node.as_boolean()) return x->get() ? "true" : "false";
    if (node.is_array_of_tables()) return "an array of tables";
    if (const auto* x = node.as_array()) return "an array of " + std::to_string(x->size());
    return node.is_table() ? "a table" : "a date or time";
}

// Calls look(c) for each character outside strings and comments, and for the first quote of a string, until it returns
// true. Returns the line of that character, or 0.
template <class Look>
int line_of_bare(std::string_view text, Look&& look) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark
    int line = 1;
    std::string_view close;  // what ends the string or comment that is open
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        const bool one_line = close.size() == 1;
        if (c == '\n') ++line;
        if (close.empty()) {
            if (c == '#') close = "\n";
            for (const std::string_view quote : {"\"\"\"", "'''", "\"", "'"}) {
                if (!close.empty() || !text.substr(i).starts_with(quote)) continue;
                close = quote;
                i += quote.size() - 1;
            }
            if (close != "\n" && look(c)) return line;
        } else if (c == '\\' && close[0] == '"') {
            ++i;
            if (i < text.size() && text[i] == '\n') ++line;
        } else if (text.substr(i).starts_with(close)) {
            if (c == '\n') (void)look(c);
            i += close.size() - 1;
            close = {};
        } else if (c == '\n' && one_line) {
            close = {};  // an unfinished string: the parser reports it
        }
    }
    return 0;
}

// Counts how deep a place of the file is nested in parts of keys, tables and arrays: those of the header above it, the
// open ones, and the key that is read.
class Nesting {
public:
    // True if the next character nests deeper than `most`.
    bool exceeds(int most, char c) {
        const bool at_start = is_start_;
        is_start_ = c == '\n' || (is_start_ && (c == ' ' || c == '\t' || c == '\r'));
        if (in_header_) return read_header(most, c);
        switch (c) {
        case '.': ++key_; break;
        case '=':
            waiting_ = key_;
            key_ = 1;
            break;
        case '[':
            if (at_start && open_.empty()) {
                in_header_ = true;
                header_ = key_ = 1;
                return false;
            }
            [[fallthrough]];
        case '{':
            open_.push_back(waiting_);
            depth_ += waiting_;
            waiting_ = key_ = 1;
            break;
        case ']':
        case '}':
            if (!open_.empty()) {
                depth_ -= open_.back();
                open_.pop_back();
            }
            break;
        case ',': waiting_ = key_ = 1; break;
        case '\n': key_ = 1; break;
        default: break;
        }
        return header_ + depth_ + key_ > most;
    }

private:
    bool read_header(int most, char c) {
        if (c == '.') header_ = ++key_;
        if (c == ']' || c == '\n') in_header_ = false;
        if (!in_header_) key_ = 1;
        return header_ > most;
    }

    bool is_start_ = true, in_header_ = false;
    int header_ = 0, depth_ = 0, key_ = 1, waiting_ = 1;
    std::vector<int> open_;  // parts of the keys of the open tables and arrays
};

toml::table parsed(std::string_view text, const std::string& file) {
    // TOML allows none, but toml++ 3.3 takes some of them (such as a bare micro sign) for unreachable code instead of
    // reporting them.
    if (const int line = line_of_bare(text, [](char c) { return static_cast<unsigned char>(c) >= 0x80; }); line > 0)
        raise(SceneError(file, line, "TOML syntax",
                         "a character outside ASCII, expected such only in quotes and comments"));
    // It makes a table of each part of a key and destroys those in each other recursively.
    if (const int line =
            line_of_bare(text, [nesting = Nesting()](char c) mutable { return nesting.exceeds(most_nested, c); });
        line > 0)
        raise(SceneError(file, line, "TOML syntax",
                         "tables, arrays and parts of keys lie more than " + std::to_string(most_nested) +
                             " deep in each other, expected at most " + std::to_string(most_nested)));
    toml::parse_result result = toml::parse(text, file);
    if (!result)
        raise(SceneError(file, line_of(result.error().source()), "TOML syntax",
                         shortened(result.error().description(), longest_key) + ", expected valid TOML 1.0"));
    return std::move(result).table();
}

}  // namespace

SceneError::SceneError(std::string file, int line, std::string key, const std::string& message)
    : std::runtime_error(file + (line > 0 ? ":" + std::to_string(line) : "") + ": " +
                         (key.empty() ? "" : shortened(key, longest_key) + ": ") + message),
      file_(std::move(file)), line_(line), key_(std::move(key)) {}

bool Quantity::holds(double x) const {
    if (!(std::abs(x) <= largest)) return false;
    switch (bound) {
    case positive: return x >= smallest;
    case not_negative: return x >= 0.0;
    case zero_to_one: return x >= 0.0 && x <= 1.0;
    default: return true;
    }
}

std::string Quantity::expected(std::size_t count) const {
    const bool one = count == 1;
    std::string text = one ? "a " : std::to_string(count) + " ";
    text += bound == positive ? "positive finite number" : bound == zero_to_one ? "number" : "finite number";
    if (!one) text += "s";
    if (bound == not_negative) text += " >= 0";
    if (bound == zero_to_one) text += " from 0 to 1";
    if (!one && *parts != 0) text += " [" + std::string(parts) + "]";
    if (*unit != 0) text += " (" + std::string(unit) + ")";
    return text;
}

std::string Quantity::sizes() const {
    return bound == positive ? "from " + shown(smallest) + " to " + shown(largest)
                             : "of a size up to " + shown(largest);
}

std::string shown(double x) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), x).ptr;
    return {text.data(), end};
}

SceneError Place::error(const std::string& problem, const std::string& wanted) const {
    return {file, line, key, problem + ", expected " + wanted};
}

SceneError Value::refusal(const std::string& wanted) const { return place_.error("got " + shown(*node_), wanted); }

Value Value::operator[](std::size_t i) const {
    const toml::node& element = *node_->as_array()->get(i);
    return {{place_.file, line_of(element.source()), place_.key + "[" + std::to_string(i) + "]"}, element};
}

// toml++ gives no double for a whole number that a double rounds.
std::optional<double> Value::any_number() const {
    if (const auto* whole = node_->as_integer()) return static_cast<double>(whole->get());
    if (const auto* real = node_->as_floating_point()) return real->get();
    return {};
}

double Value::number(const Quantity& quantity) const {
    const auto number = any_number();
    if (number && quantity.holds(*number)) return *number;
    const bool has_sense = number && std::isfinite(*number) && (quantity.bound == Quantity::any || *number > 0) &&
                           quantity.bound != Quantity::zero_to_one;
    refuse(quantity.expected() + (has_sense ? ", " + quantity.sizes() : ""));
}

std::int64_t Value::whole(std::int64_t least, std::int64_t most) const {
    if (const auto* whole = node_->as_integer(); whole != nullptr && whole->get() >= least && whole->get() <= most)
        return whole->get();
    // Some writers have a point in every number.
    if (const auto* real = node_->as_floating_point(); real != nullptr && real->get() == std::floor(real->get()) &&
                                                       real->get() >= static_cast<double>(least) &&
                                                       real->get() <= static_cast<double>(most))
        return static_cast<std::int64_t>(real->get());
    refuse("a whole number from " + std::to_string(least) + " to " + std::to_string(most));
}

std::vector<double> Value::numbers(const Quantity& quantity, std::initializer_list<std::size_t> counts) const {
    const toml::array* array = node_->as_array();
    if (array == nullptr || std::find(counts.begin(), counts.end(), array->size()) == counts.end()) {
        std::string wanted;
        for (const std::size_t count : counts) wanted += (wanted.empty() ? "" : " or ") + quantity.expected(count);
        refuse(wanted);
    }
    std::vector<double> numbers;
    for (std::size_t i = 0; i < array->size(); ++i) numbers.push_back((*this)[i].number(quantity));
    return numbers;
}

const std::string& Value::text(const std::string& wanted) const {
    const auto* text = node_->as_string();
    if (text == nullptr || text->get().empty()) refuse(wanted);
    return text->get();
}

std::string wanted(const double&, const Quantity& quantity) { return quantity.expected(); }
std::string wanted(const std::string&, const Quantity&) { return "text in quotes, not empty"; }
std::string wanted(const bool&, const Quantity&) { return "true or false"; }

void convert(const Value& value, double& out, const Quantity& quantity) { out = value.number(quantity); }
void convert(const Value& value, std::optional<double>& out, const Quantity& quantity) { out = value.number(quantity); }
void convert(const Value& value, std::string& out, const Quantity& quantity) {
    out = value.text(wanted(out, quantity));
}
void convert(const Value& value, bool& out, const Quantity& quantity) {
    if (!value.node().is_boolean()) value.refuse(wanted(out, quantity));
    out = value.node().as_boolean()->get();
}

std::optional<Value> Table::find(const std::string& key) {
    known_.insert(key);
    const auto entry = table_->find(key);
    if (entry == table_->end()) return std::nullopt;
    return Value(place_of(key, line_of(entry->first.source())), entry->second);
}

void Table::finish() const {
    const toml::key* unknown = nullptr;
    for (const auto& [key, value] : *table_)
        if (!known_.contains(std::string(key.str())) &&
            (unknown == nullptr || line_of(key.source()) < line_of(unknown->source())))
            unknown = &key;
    if (unknown != nullptr) {
        const auto* other = std::find_if(std::begin(other_names), std::end(other_names), [&](const auto& name) {
            return name.first == unknown->str() && known_.contains(name.second);
        });
        place_of(std::string(unknown->str()), line_of(unknown->source()))
            .fail("unknown key" + (other != std::end(other_names) ? " (did you mean " + in_quotes(other->second) + "?)"
                                                                  : suggestion(unknown->str(), known_)),
                  listed(known_));
    }
    if (missing_) fail(missing_->first, "missing", missing_->second);
}

std::string Table::named() const {
    const auto* name = table_->get_as<std::string>("name");
    return name == nullptr || name->get().empty() ? "" : " in " + in_quotes(name->get());
}

std::optional<Table> Table::table(const std::string& key) {
    const auto value = find(key);
    if (!value) return std::nullopt;
    if (!value->node().is_table()) value->refuse("a table, [" + value->place().key + "]");
    return Table(value->place(), *value->node().as_table());
}

std::vector<Table> Table::tables(const std::string& key) {
    const auto value = find(key);
    std::vector<Table> list;
    if (!value) return list;
    const std::string wanted = "an array of tables, [[" + key + "]]";
    if (!value->node().is_array()) value->refuse(wanted);
    for (std::size_t i = 0; i < value->node().as_array()->size(); ++i) {
        const Value element = (*value)[i];
        if (!element.node().is_table()) element.refuse("a table, as in " + wanted);
        list.emplace_back(element.place(), *element.node().as_table());
    }
    return list;
}

Document::Document(std::string_view text, std::string file) : file_(std::move(file)), table_(parsed(text, file_)) {}

}  // namespace tumble::host
