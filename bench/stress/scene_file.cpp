#include "stress/scene_file.hpp"

#include <sstream>
#include <stdexcept>

#include "scene/reader.hpp"
#include "scene/toml.hpp"

namespace tumble::bench::stress {

struct SceneFile::Document {
    toml::table root;
};

namespace {

[[noreturn]] void fail(const std::string& file, const std::string& path, const char* wanted) {
    throw std::invalid_argument{file + ": " + path + ": expected " + wanted};
}

}  // namespace

SceneFile::SceneFile(const std::filesystem::path& path)
    : name_(path.string()), document_(std::make_unique<Document>()) {
    toml::parse_result parsed = toml::parse_file(name_);
    if (!parsed) throw std::invalid_argument{name_ + ": " + std::string{parsed.error().description()}};
    document_->root = std::move(parsed).table();
}
SceneFile::SceneFile(const SceneFile& other)
    : name_(other.name_), document_(std::make_unique<Document>(*other.document_)) {}
SceneFile::~SceneFile() = default;

void SceneFile::put(const std::string& path, const auto& value) {
    const std::size_t dot = path.rfind('.');
    toml::table* table =
        dot == std::string::npos ? &document_->root : document_->root.at_path(path.substr(0, dot)).as_table();
    if (table == nullptr) fail(name_, path, "a table that holds it");
    table->insert_or_assign(dot == std::string::npos ? path : path.substr(dot + 1), value);
}
void SceneFile::set(const std::string& path, double value) { put(path, value); }
void SceneFile::set(const std::string& path, const std::string& value) { put(path, value); }
void SceneFile::set(const std::string& path, const host::Triple& value) {
    put(path, toml::array{value[0], value[1], value[2]});
}
void SceneFile::set(const std::string& path, const host::Quadruple& value) {
    put(path, toml::array{value[0], value[1], value[2], value[3]});
}

std::size_t SceneFile::append_copy(const std::string& element) {
    const std::size_t bracket = element.rfind('[');
    const toml::table* table = document_->root.at_path(element).as_table();
    toml::array* array =
        bracket == std::string::npos ? nullptr : document_->root.at_path(element.substr(0, bracket)).as_array();
    if (table == nullptr || array == nullptr) fail(name_, element, "a table in an array of tables");
    array->push_back(toml::table{*table});
    return array->size() - 1;
}

std::string SceneFile::text() const {
    std::ostringstream out;
    out << document_->root << '\n';
    return out.str();
}
host::SceneDescription SceneFile::description() const { return host::read_scene_text(text(), name_); }

}  // namespace tumble::bench::stress
