#include "scene/json_event.hpp"

#include <nlohmann/json.hpp>

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

// The object as a table of a scene file: numbers, texts and lists of both are written alike.
std::string inline_table(const Json& object, int line) {
    std::string text;
    for (const auto& [key, value] : object.items()) {
        if (value.is_null() || value.is_object())
            fail(line, key, value.is_null() ? "got null" : "got an object", "a number, a text or a list of numbers");
        text += (text.empty() ? "" : ", ") + json_text(key) + " = " + value.dump();
    }
    return "{ " + text + " }";
}

StepsWanted read_steps(const Json& object, int line) {
    const Json& count = object.at("step");
    if (object.size() != 1) fail(line, "step", "given beside other keys", R"({"step": 1} on a line of its own)");
    if (!count.is_number_integer() || count < 1 || count > (std::int64_t{1} << 31))
        fail(line, "step", "got " + count.dump(), "a whole number of steps from 1 to 2^31");
    return {count.get<std::int64_t>()};
}

}  // namespace

LiveLine read_live_line(const std::string& text, int line, const SceneDescription& scene) {
    const Json object = Json::parse(text, nullptr, false);
    if (object.is_discarded()) fail(line, "event", "is not JSON", a_line);
    if (!object.is_object()) fail(line, "event", "is not an object", a_line);
    if (object.contains("step")) return read_steps(object, line);
    try {
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
