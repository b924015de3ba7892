#include "scene/json_event.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <set>

#include "scene/reading.hpp"

namespace tumble::host {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* source = "standard input";
constexpr const char* a_line =
    R"(a JSON object: an event such as {"kind": "force", "body": "name", "value": [0, 0, 1]}, or {"step": 1})";

[[noreturn]] void fail(int line, const std::string& key, const std::string& problem, const std::string& wanted) {
    Place{source, line, key}.fail(problem, wanted);
}

bool is_nested_too_deep(const std::string& text) {
    int depth = 0;
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '"') is_quoted = !is_quoted;
        else if (is_quoted && c == '\\') ++i;
        else if (!is_quoted && (c == '[' || c == '{') && ++depth > most_nested) return true;
        else if (!is_quoted && (c == ']' || c == '}')) --depth;
    }
    return false;
}

// A value as TOML: texts, lists, and numbers, of which those beyond 64 bits are written with a point.
std::string toml_of(const Json& value) {
    if (value.is_array()) {
        std::string list;
        for (const Json& each : value) list += (list.empty() ? "" : ", ") + toml_of(each);
        return "[" + list + "]";
    }
    if (value.is_string()) return json_text(value.get_ref<const std::string&>());
    constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    if (value.is_number_unsigned() && value.get<std::uint64_t>() > most) return cpp_number(value.get<double>());
    if (value.is_object()) return "{}";
    return value.is_null() ? "\"null\"" : value.dump();
}

// The object as a table of a scene file.
std::string inline_table(const Json& object, int line) {
    std::string text;
    for (const auto& [key, value] : object.items()) {
        if (value.is_null() || value.is_object())
            fail(line, key, value.is_null() ? "got null" : "got an object", "a number, a text or a list of numbers");
        text += (text.empty() ? "" : ", ") + json_text(key) + " = " + toml_of(value);
    }
    return "{ " + text + " }";
}

std::string problem_of(const Json& value) {
    if (value.is_string()) return "got " + in_quotes(value.get_ref<const std::string&>());
    if (value.is_array()) return "got a list of " + std::to_string(value.size());
    return value.is_object() ? "got an object" : "got " + value.dump();
}

StepsWanted read_steps(const Json& object, int line) {
    constexpr double most = 1LL << 31;
    const Json& count = object.at("step");
    if (object.size() != 1) fail(line, "step", "given beside other keys", R"({"step": 1} on a line of its own)");
    const double steps = count.is_number() ? count.get<double>() : 0;  // some writers have a point in every number
    if (!(steps >= 1 && steps <= most && steps == std::floor(steps)))
        fail(line, "step", problem_of(count), "a whole number of steps from 1 to 2^31");
    return {static_cast<std::int64_t>(steps)};
}

// A line of one key that no event has.
void refuse_misspelt_step(const Json& object, int line) {
    if (object.size() != 1 || object.contains("kind")) return;
    const std::string key = object.begin().key();
    if (!suggestion(key, std::vector<std::string>{"step"}).empty())
        fail(line, key, "unknown key (did you mean \"step\"?)", a_line);
}

}  // namespace

LiveLine read_live_line(const std::string& text, int line, const SceneDescription& scene) {
    if (is_nested_too_deep(text))
        fail(line, "event", "lists and objects lie more than " + std::to_string(most_nested) + " deep in each other",
             a_line);
    // Of a key that is given twice the parser would keep one value.
    std::set<std::string> keys;
    const auto note = [&](int depth, Json::parse_event_t event, Json& key) {
        if (event == Json::parse_event_t::key && depth == 1 && !keys.insert(key.get<std::string>()).second)
            fail(line, key.get<std::string>(), "given twice", "each key once");
        return true;
    };
    const Json object = Json::parse(text, note, false);
    if (object.is_discarded()) fail(line, "event", "is not JSON", a_line);
    if (!object.is_object()) fail(line, "event", "is not an object", a_line);
    if (object.contains("step")) return read_steps(object, line);
    try {
        refuse_misspelt_step(object, line);
        const Document document("event = " + inline_table(object, line) + "\n", source);
        Table root = document.root();
        RangeDescription range = scene.range;
        return read_event(root.table("event").value(), scene, range, true);
    } catch (const SceneError& error) {
        if (error.line() == line) throw;
        // It knows the line of the table alone.
        const std::size_t before = std::string(SceneError(error.file(), error.line(), error.key(), "").what()).size();
        throw SceneError(source, line, error.key(), std::string(error.what()).substr(before));
    }
}

}  // namespace tumble::host
