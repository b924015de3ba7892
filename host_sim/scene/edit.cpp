#include "scene/edit.hpp"

#include <algorithm>
#include <cstdint>

#include "scene/toml.hpp"

namespace tumble::host {
namespace {

// The place of a line, from 1, in a text.
std::size_t begin_of(const std::string& text, std::uint32_t line) {
    std::size_t place = 0;
    for (std::uint32_t i = 1; i < line; ++i) place = text.find('\n', place) + 1;
    return place;
}

}  // namespace

// Up to where the next table begins.
std::string without_expectation(const std::string& text) {
    const toml::parse_result root = toml::parse(text);
    const toml::table* const expected = root["expect"].as_table();
    if (expected == nullptr) return text;
    const std::uint32_t first = expected->source().begin.line;
    std::uint32_t next = 0;
    const auto see = [&](const toml::node& node) {
        if (const std::uint32_t line = node.source().begin.line; line > first && (next == 0 || line < next))
            next = line;
    };
    if (expected->is_inline()) next = expected->source().end.line + 1;
    else
        for (const auto& [key, node] : root.table()) {
            see(node);
            if (const toml::array* list = node.as_array())
                for (const toml::node& element : *list) see(element);
        }
    const std::size_t begin = begin_of(text, first);
    const std::size_t end = next == 0 ? text.size() : std::min(begin_of(text, next), text.size());
    return text.substr(0, begin) + text.substr(end);
}

std::string with_value(const std::string& text, const char* table, const char* key, const std::string& value) {
    const toml::parse_result root = toml::parse(text);
    const toml::node* const node = root ? root[table][key].node() : nullptr;
    if (node == nullptr) return text;
    const toml::source_region at = node->source();
    const std::size_t line = begin_of(text, at.begin.line);
    return text.substr(0, line + at.begin.column - 1) + value + text.substr(line + at.end.column - 1);
}

double readable_duration(const SceneDescription& scene) {
    double latest = scene.duration;
    for_each_time(scene, [&](double time) { latest = std::max(latest, time); });
    return latest;
}

}  // namespace tumble::host
