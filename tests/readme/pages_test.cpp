// The pages hold together: no link is dead, the front page stays short, and lists of options, of JSON keys and of keys
// of result rows are what the command and the rows have.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tumble/scene.hpp>
#include <tumble/status.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "command/command.hpp"

namespace {

namespace fs = std::filesystem;
using Strings = std::set<std::string>;

const fs::path root = TUMBLE_SOURCE_DIR;

std::string text_of(const fs::path& path) {
    std::ifstream in{path};
    EXPECT_TRUE(in) << path;
    return {std::istreambuf_iterator<char>{in}, {}};
}
std::vector<std::string> lines_of(const fs::path& path) {
    std::istringstream in{text_of(path)};
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

// Every page of the repository, with the code in its blocks taken out.
struct Page {
    fs::path path;
    std::string text;
};
std::vector<Page> pages() {
    std::vector<Page> found;
    std::istringstream list{TUMBLE_PAGES};
    for (std::string name; std::getline(list, name, ':');) {
        Page page{root / name, {}};
        bool in_block = false;
        for (const std::string& line : lines_of(page.path)) {
            if (line.find("```") != std::string::npos) in_block = !in_block;
            else if (!in_block) page.text += line + "\n";
        }
        found.push_back(page);
    }
    return found;
}

// The anchor that a heading gets: lower case, blanks as dashes, other signs dropped.
std::string anchor_of(const std::string& heading) {
    std::string anchor;
    for (const char c : heading) {
        const auto code = static_cast<unsigned char>(c);
        if (std::isalnum(code) != 0 || c == '_' || c == '-') anchor += static_cast<char>(std::tolower(code));
        else if (c == ' ') anchor += '-';
    }
    return anchor;
}
Strings anchors_of(const fs::path& path) {
    Strings anchors;
    for (const std::string& line : lines_of(path))
        if (const std::size_t marks = line.find_first_not_of('#'); marks > 0 && marks < 7 && line[marks] == ' ')
            anchors.insert(anchor_of(line.substr(marks + 1)));
    return anchors;
}

// The first capture of every match.
Strings all_in(const std::string& text, const std::regex& pattern) {
    Strings found;
    for (std::sregex_iterator match{text.begin(), text.end(), pattern}, end; match != end; ++match)
        found.insert((*match)[1]);
    return found;
}
void expect_same(const Strings& page, const Strings& truth, const std::string& what) {
    for (const std::string& name : truth)
        EXPECT_TRUE(page.contains(name)) << what << " " << name << " is not in the page";
    for (const std::string& name : page)
        EXPECT_TRUE(truth.contains(name)) << what << " " << name << " is in the page and nowhere else";
}

// The part of a page under a heading.
std::string section(const fs::path& path, const std::string& heading) {
    const std::string text = text_of(path), mark = "\n## " + heading + "\n";
    const std::size_t at = text.find(mark);
    EXPECT_NE(at, std::string::npos) << path << ": no section " << heading;
    if (at == std::string::npos) return {};
    return text.substr(at + 1, text.find("\n## ", at + mark.size()) - at - 1);
}

// What a command prints on standard output.
std::string output_of(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "tumble");
    testing::internal::CaptureStdout();
    (void)tumble::host::command(static_cast<int>(arguments.size()), arguments.data());
    return testing::internal::GetCapturedStdout();
}

TEST(pages, begin_with_their_title) {
    for (const Page& page : pages()) EXPECT_TRUE(page.text.starts_with("# ")) << page.path;
}

TEST(pages, have_no_dead_links) {
    static const std::regex link{R"(\]\(([^)\s]+)\))"};
    int checked = 0;
    for (const Page& page : pages()) {
        for (const std::string& target : all_in(page.text, link)) {
            if (target.find("://") != std::string::npos) continue;
            const std::size_t hash = target.find('#');
            const fs::path file = target.substr(0, hash);
            const fs::path path = file.empty() ? page.path : page.path.parent_path() / file;
            EXPECT_TRUE(fs::exists(path)) << page.path << ": " << target;
            if (hash != std::string::npos && fs::exists(path)) {
                EXPECT_TRUE(anchors_of(path).contains(target.substr(hash + 1))) << page.path << ": " << target;
            }
            ++checked;
        }
    }
    EXPECT_GT(checked, 0);
}

TEST(pages, are_all_reached_from_the_front_page) {
    static const std::regex link{R"(\]\(([^)#\s]+))"};
    Strings reached{fs::canonical(root / "README.md")};
    std::vector<fs::path> todo{root / "README.md"};
    while (!todo.empty()) {
        const fs::path page = todo.back();
        todo.pop_back();
        for (const std::string& target : all_in(text_of(page), link)) {
            const fs::path path = page.parent_path() / target;
            if (path.extension() == ".md" && fs::exists(path) && reached.insert(fs::canonical(path)).second)
                todo.push_back(path);
        }
    }
    for (const Page& page : pages()) EXPECT_TRUE(reached.contains(fs::canonical(page.path))) << page.path;
}

TEST(pages, begin_with_a_front_page_of_at_most_200_lines) { EXPECT_LE(lines_of(root / "README.md").size(), 200u); }

TEST(pages, say_what_every_key_of_a_result_row_means) {
    Strings keys;
    for (const auto& entry : fs::directory_iterator{root / "bench/results"}) {
        if (entry.path().extension() != ".jsonl") continue;
        for (const std::string& line : lines_of(entry.path())) {
            const auto row = nlohmann::json::parse(line);
            for (const auto& [key, value] : row.items()) keys.insert(key);
        }
    }
    Strings listed;
    for (const std::string& line : lines_of(root / "bench/KEYS.md"))
        if (line.starts_with("| `"))
            listed.merge(all_in(line.substr(0, line.find('|', 1)), std::regex{"`([a-z0-9_]+)`"}));
    for (const std::string& key : keys) EXPECT_TRUE(listed.contains(key)) << "key " << key << " is not in the page";
    // A key that no committed row has may be one that is written now.
    std::string sources;
    for (const char* folder : {"bench", "port", "host_sim"})
        for (const auto& entry : fs::recursive_directory_iterator{root / folder})
            if (entry.path().extension() == ".cpp" || entry.path().extension() == ".hpp") sources += text_of(entry);
    for (const std::string& key : listed)
        EXPECT_TRUE(keys.contains(key) || sources.find('"' + key + '"') != std::string::npos)
            << "key " << key << " is in the page, and in no row or program";
}

TEST(pages, say_what_every_status_bit_means) {
    Strings bits;
    for (const tumble::Issue issue : tumble::all_issues) bits.insert(tumble::name_of(issue));
    expect_same(all_in(section(root / "kernel/README.md", "Status"), std::regex{R"(\n\| `([a-z_]+)`)"}), bits, "bit");
}

TEST(pages, name_every_feature_with_its_default) {
    Strings rows, features;
    tumble::Features::for_each([&]<class T>(const std::string& name, T tumble::Features::*member) {
        const std::string value = std::is_same_v<T, bool> ? tumble::Features{}.*member ? "true" : "false"
                                                          : std::to_string(tumble::Features{}.*member);
        features.insert("| `" + name + "` | " + value + " |");
    });
    std::string text = section(root / "kernel/README.md", "What a scene names");
    text.erase(0, text.find("| feature |"));
    static const std::regex row{R"(\n(\| `[a-z_]+` \|) [^|]* \|( [a-z0-9]+ \|))"};
    for (std::sregex_iterator match{text.begin(), text.end(), row}, end; match != end; ++match)
        rows.insert((*match)[1].str() + (*match)[2].str());
    expect_same(rows, features, "feature");
}

// A designated initializer must follow the order of the declaration.
TEST(pages, name_features_in_the_order_of_their_declaration) {
    std::vector<std::string> declared;
    tumble::Features::for_each([&](const char* name, auto) { declared.emplace_back(name); });
    const std::string text = section(root / "kernel/README.md", "What a scene names");
    static const std::regex word{"[a-z_]+"}, row{R"(\n\| (`([a-z_]+)`|feature) \|)"};
    const std::size_t block = text.find("the order is:\n\n```\n") + 19;
    const std::string list = text.substr(block, text.find("```", block) - block);
    const std::vector<std::string> listed(std::sregex_token_iterator{list.begin(), list.end(), word},
                                          std::sregex_token_iterator{});
    EXPECT_EQ(listed, declared);
    const auto tables = text.substr(text.find("| feature |") - 1);
    std::ptrdiff_t last = -1;
    for (std::sregex_iterator match{tables.begin(), tables.end(), row}, end; match != end; ++match) {
        const std::string name = (*match)[2];  // empty where a table begins
        const auto place = name.empty() ? -1 : std::find(declared.begin(), declared.end(), name) - declared.begin();
        EXPECT_TRUE(name.empty() || place > last) << name;
        last = place;
    }
}

TEST(pages, name_the_options_that_the_command_has) {
    const fs::path page = root / "host_sim/README.md";
    static const std::regex option{R"(--([a-z][a-z-]*))"}, row{R"(\n\| (`-o`, )?`--([a-z-]+))"};
    const auto listed = [](const std::string& text) {
        Strings names;
        for (std::sregex_iterator match{text.begin(), text.end(), row}, end; match != end; ++match)
            names.insert((*match)[2]);
        return names;
    };
    const Strings shared = listed(section(page, "Options of every replay"));
    for (const char* command : {"run", "compile", "compare", "advise"}) {
        Strings has = all_in(output_of({command, "--help"}), option);
        has.erase("help");
        Strings says = listed(section(page, "`tumble " + std::string(command) + "`"));
        if (std::string(command) != "advise") says.insert(shared.begin(), shared.end());
        expect_same(says, has, "tumble " + std::string(command) + " --");
    }
}

TEST(pages, name_the_keys_of_json_and_the_columns_of_a_trajectory) {
    const std::string text = section(root / "host_sim/README.md", "`tumble run`"),
                      scene = root / "host_sim/scenes/ball.toml";
    const fs::path csv = fs::path(testing::TempDir()) / "pages_test.csv";
    const auto json = nlohmann::json::parse(
        output_of({"run", scene.c_str(), "--json", "--duration", "0.1", "--trajectory", csv.c_str()}));
    Strings keys, named;
    for (const auto& [key, value] : json.items()) keys.insert(key);
    for (const auto& [key, value] : json.at("bodies").at(0).items()) keys.insert(key);
    for (const auto& [key, value] : json.at("verdict").items()) keys.insert(key);
    const auto pile = nlohmann::json::parse(
        output_of({"run", (root / "host_sim/scenes/contacts/kinematic.toml").c_str(), "--json", "--duration", "1"}));
    keys.insert("bounded_steps");
    for (const auto& [key, value] : pile.at("bounded_steps").items()) keys.insert(key);
    for (const auto& [key, value] : pile.at("bounded_steps").at("bodies").at(0).items()) keys.insert(key);
    const auto jointed = nlohmann::json::parse(
        output_of({"run", (root / "host_sim/scenes/joints/pendulum.toml").c_str(), "--json", "--duration", "0.1"}));
    keys.insert("joints");
    for (const auto& [key, value] : jointed.at("joints").at(0).items()) keys.insert(key);
    std::istringstream rows{text.substr(text.find("| key of `--json`"))};
    for (std::string line; std::getline(rows, line) && line.starts_with("|");)
        if (line.find("key of") == std::string::npos) named.merge(all_in(line, std::regex{"`([a-z_]+)`"}));
    expect_same(named, keys, "key");
    std::string columns = lines_of(csv).at(0);
    for (std::size_t at = 0; (at = columns.find(',', at)) != std::string::npos; at += 2) columns.insert(at + 1, " ");
    EXPECT_NE(text.find("`" + columns + "`"), std::string::npos) << columns;
    fs::remove(csv);
}

}  // namespace
