// A scene file whose values can be changed. A cell of a map runs it, and `tumble run` replays it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "scene/description.hpp"

namespace tumble::bench::stress {

class SceneFile {
public:
    // Throws std::runtime_error for a file that is not TOML.
    explicit SceneFile(const std::filesystem::path& path);
    SceneFile(const SceneFile& other);
    ~SceneFile();

    // The value at a path in toml++'s notation: "world.step", "body[1].velocity". Its table must exist, the value need
    // not; throws std::invalid_argument otherwise.
    void set(const std::string& path, double value);
    void set(const std::string& path, const std::string& value);
    void set(const std::string& path, const host::Triple& value);
    void set(const std::string& path, const host::Quadruple& value);

    // Appends a copy of an element, "body[0]", to its array of tables; returns the copy's index.
    std::size_t append_copy(const std::string& element);

    // The text of the scene file.
    [[nodiscard]] std::string text() const;
    // The scene, checked by all rules of the format; throws host::SceneError.
    [[nodiscard]] host::SceneDescription description() const;

private:
    struct Document;

    void put(const std::string& path, const auto& value);

    std::string name_;
    std::unique_ptr<Document> document_;
};

}  // namespace tumble::bench::stress
