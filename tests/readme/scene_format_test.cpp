// host_sim/scenes/README.md says what the scene reader does: every table and key that the reader accepts is in the page
// and no other, with what its error message expects, whether it is required, and its default.
//
// What the reader accepts is asked of the reader: the message about an unknown key lists the keys of its table, and a
// key that takes a table reports an unknown key in it.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "command/command.hpp"
#include "scene/reader.hpp"

namespace {

using tumble::host::read_scene_text, tumble::host::SceneError;

// A table of the format, by the keys that lead to it: "" or "contact.sleep".
using Keys = std::map<std::string, std::string>;  // key -> value, in TOML

// A table of each kind with nothing but what it must have.
const std::map<std::string, Keys> least{
    {"", {}},
    {"world", {{"step", "\"1/256\""}, {"duration", "1.0"}}},
    {"range", {}},
    {"contact", {}},
    {"gravity_gradient", {{"orbit_rate", "0.001"}, {"to_centre", "[0.0, -1.0, 0.0]"}}},
    {"contact.sleep", {}},
    {"plane", {{"name", "\"floor\""}, {"normal", "[0.0, 1.0, 0.0]"}}},
    {"body", {{"name", "\"brick\""}, {"shape", "{ box = [1.0, 1.0, 1.0] }"}, {"mass", "1.0"}}},
    {"body.shape", {{"box", "[1.0, 1.0, 1.0]"}}},
    {"spring", {{"body", "\"brick\""}, {"to", "[0.0, 1.0, 0.0]"}, {"stiffness", "1.0"}}},
    {"joint",
     {{"kind", "\"universal\""},
      {"body", "\"brick\""},
      {"anchor", "[0.0, 1.0, 0.0]"},
      {"axis", "[1.0, 0.0, 0.0]"},
      {"to_axis", "[0.0, 1.0, 0.0]"}}},
    {"joint.spring", {{"stiffness", "1.0"}}},
    {"joint.to_spring", {{"stiffness", "1.0"}}},
    {"impulse", {{"time", "0.5"}, {"body", "\"brick\""}, {"impulse", "[1.0, 0.0, 0.0]"}}},
    {"force", {{"body", "\"brick\""}, {"until", "1.0"}, {"force", "[1.0, 0.0, 0.0]"}}},
    {"expect",
     {{"integrator", "\"verlet\""},
      {"numbers", "\"q32\""},
      {"steps", "256"},
      {"tumble_bits", "8"},
      {"hash", "\"0123456789abcdef\""}}},
    {"event", {{"time", "0.5"}, {"kind", "\"impulse\""}, {"body", "\"brick\""}, {"value", "[1.0, 0.0, 0.0]"}}},
};

std::string inline_table(const Keys& keys) {
    std::string text;
    for (const auto& [key, value] : keys) text += (text.empty() ? "" : ", ") + key + " = " + value;
    return "{ " + text + " }";
}
bool is_list(const std::string& table) {
    return table == "plane" || table == "body" || table == "spring" || table == "joint" || table == "impulse" ||
           table == "force" || table == "event";
}

// A scene whose table of that name has these keys and no others; of the top level those whose value is not empty.
std::string scene_with(const std::string& table, const Keys& keys) {
    Keys root;
    for (const char* name : {"world", "body"})
        root[name] = is_list(name) ? "[" + inline_table(least.at(name)) + "]" : inline_table(least.at(name));
    if (table.empty()) {
        for (const auto& [key, value] : keys) root[key] = value;
    } else if (const std::size_t dot = table.find('.'); dot == std::string::npos) {
        root[table] = is_list(table) ? "[" + inline_table(keys) + "]" : inline_table(keys);
    } else {
        const std::string outer = table.substr(0, dot);
        Keys around = least.count(outer) != 0 ? least.at(outer) : Keys{};
        around[table.substr(dot + 1)] = inline_table(keys);
        root[outer] = is_list(outer) ? "[" + inline_table(around) + "]" : inline_table(around);
    }
    std::string text;
    for (const auto& [key, value] : root)
        if (!value.empty()) text += key + " = " + value + "\n";
    return text;
}

// What the reader says about a scene; empty when it reads it.
std::string message_of(const std::string& scene) {
    try {
        (void)read_scene_text(scene, "scene.toml");
        return {};
    } catch (const SceneError& error) { return error.what(); }
}
std::string expected_in(const std::string& message) {
    const std::size_t at = message.find(", expected ");
    return at == std::string::npos ? "" : message.substr(at + std::string{", expected "}.size());
}
bool names_unknown_key(const std::string& message) { return message.find("nobody: unknown key") != std::string::npos; }

// The keys of a table, as the message about an unknown one lists them.
std::vector<std::string> keys_of(const std::string& table) {
    const std::string message = message_of(scene_with(table, {{"nobody", "1"}}));
    EXPECT_TRUE(names_unknown_key(message)) << message;
    const std::string list = expected_in(message);
    static const std::regex quoted{"\"([a-z_]+)\""};
    std::vector<std::string> keys;
    for (std::sregex_iterator word{list.begin(), list.end(), quoted}, end; word != end; ++word)
        keys.push_back((*word)[1]);
    return keys;
}

// All tables of the format and their keys, from the top level down.
void discover(const std::string& table, std::map<std::string, std::vector<std::string>>& tables) {
    tables[table] = keys_of(table);
    for (const std::string& key : tables[table]) {
        for (const char* value : {"{ nobody = 1 }", "[{ nobody = 1 }]"}) {
            const std::string message = message_of(scene_with(table, {{key, value}}));
            if (!names_unknown_key(message)) continue;
            const std::string inner = table.empty() ? key : table + "." + key;
            ASSERT_EQ(value[0] == '[', is_list(inner)) << inner;
            discover(inner, tables);
            break;
        }
    }
}

// A row of a table of the page: | `key` | meaning | default | must be |
struct Row {
    std::string meaning, default_value, expected;
};
using Page = std::map<std::string, std::map<std::string, Row>>;

Page read_page() {
    std::ifstream in{TUMBLE_SOURCE_DIR "/host_sim/scenes/README.md"};
    EXPECT_TRUE(in);
    static const std::regex heading{R"(^## (Top level|\[+([a-z_.]+)\]+).*)"}, row{R"(^\| `([a-z_]+)` \|(.*)\|$)"};
    Page page;
    std::string table = "none";
    bool in_format = false;
    for (std::string line; std::getline(in, line);) {
        std::smatch match;
        if (line.starts_with("## ")) {
            in_format = std::regex_match(line, match, heading);
            table = match[2];
            if (in_format) page[table];
        } else if (in_format && std::regex_match(line, match, row)) {
            std::istringstream cells{match[2]};
            std::vector<std::string> texts;
            for (std::string cell; std::getline(cells, cell, '|');) {
                const std::size_t first = cell.find_first_not_of(' '), last = cell.find_last_not_of(' ');
                texts.push_back(first == std::string::npos ? "" : cell.substr(first, last - first + 1));
            }
            if (texts.size() != 3) {
                ADD_FAILURE() << "a row with another number of cells than four: " << line;
                continue;
            }
            EXPECT_TRUE(page[table].emplace(match[1], Row{texts[0], texts[1], texts[2]}).second)
                << table << "." << match[1] << " is there twice";
        }
    }
    return page;
}

// All that a scene says: the header that a firmware gets, and the ranges, of which that shows the preset only.
std::string compiled(const std::string& text) {
    const tumble::host::SceneDescription scene = read_scene_text(text, "scene.toml");
    std::ostringstream out;
    out << tumble::host::compiled_scene(scene, {}) << scene.range.position << ' ' << scene.range.velocity << ' '
        << scene.range.angular_velocity;
    return out.str();
}

TEST(scene_page, has_every_table_and_key_that_the_reader_accepts_and_no_other) {
    std::map<std::string, std::vector<std::string>> reader;
    discover("", reader);
    const Page page = read_page();
    for (const auto& [table, keys] : reader) {
        ASSERT_TRUE(page.contains(table)) << "no section [" << table << "]";
        ASSERT_TRUE(least.contains(table)) << "this test does not know the least [" << table << "]";
        for (const std::string& key : keys)
            EXPECT_TRUE(page.at(table).contains(key)) << "[" << table << "] " << key << " is not in the page";
        for (const auto& [key, row] : page.at(table))
            EXPECT_NE(std::find(keys.begin(), keys.end(), key), keys.end())
                << "[" << table << "] " << key << " is in the page, but the reader does not know it";
    }
    for (const auto& [table, rows] : page) EXPECT_TRUE(reader.contains(table)) << "no table [" << table << "]";
}

TEST(scene_page, says_what_the_message_about_a_wrong_value_expects) {
    for (const auto& [table, rows] : read_page()) {
        for (const auto& [key, row] : rows) {
            const std::string message = message_of(scene_with(table, {{key, "1979-05-27"}}));
            EXPECT_EQ(row.expected, expected_in(message)) << "[" << table << "] " << key << ": " << message;
        }
    }
}

TEST(scene_page, says_which_keys_are_required) {
    for (const auto& [table, rows] : read_page()) {
        const Keys& must = least.at(table);
        EXPECT_EQ(message_of(scene_with(table, must)), "");
        for (const auto& [key, row] : rows) {
            Keys without = must;
            if (table.empty()) without[key] = "";
            else without.erase(key);
            if (table == "body.shape") continue;  // exactly one of its keys, whichever
            const bool is_required = message_of(scene_with(table, without)) != "";
            EXPECT_EQ(row.default_value.starts_with("required"), is_required) << "[" << table << "] " << key;
        }
    }
}

// A default written out changes nothing of the scene that a firmware gets, whatever contacts respond with.
TEST(scene_page, says_which_value_a_key_has_by_default) {
    static const std::regex literal{"^`(.+)`$"};
    int checked = 0;
    for (const auto& [table, rows] : read_page()) {
        for (const auto& [key, row] : rows) {
            std::smatch match;
            if (!std::regex_match(row.default_value, match, literal)) continue;
            for (const char* response : {"\"impulse\"", "\"spring\""}) {
                Keys keys = least.at(table);
                if (table == "contact") keys["response"] = response;
                if (key == "response") keys.erase(key);
                const std::string without = compiled(scene_with(table, keys));
                keys[key] = match[1];
                EXPECT_EQ(compiled(scene_with(table, keys)), without) << "[" << table << "] " << key;
                ++checked;
            }
        }
    }
    EXPECT_GT(checked, 0);
}

TEST(scene_page, and_every_other_page_have_examples_that_are_scenes) {
    int count = 0;
    std::istringstream pages{TUMBLE_PAGES};
    for (std::string page; std::getline(pages, page, ':');) {
        std::ifstream in{std::string{TUMBLE_SOURCE_DIR "/"} + page};
        const std::string text{std::istreambuf_iterator<char>{in}, {}};
        for (std::size_t at = 0; (at = text.find("\n```toml\n", at)) != std::string::npos; ++count) {
            const std::size_t begin = at + 9, end = text.find("\n```\n", begin);
            ASSERT_NE(end, std::string::npos) << page;
            const std::string scene = text.substr(begin, end - begin + 1);
            EXPECT_EQ(message_of(scene), "") << page << ": " << scene;
            EXPECT_NO_THROW((void)compiled(scene)) << page << ": " << scene;
            at = end;
        }
    }
    EXPECT_GT(count, 0);
}

}  // namespace
