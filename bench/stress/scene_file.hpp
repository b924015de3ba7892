// A scene file whose values can be changed: what a cell of a map runs, and what `tumble run` replays.
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

    // The value at a path as toml++ writes one: "world.step", "body[1].velocity". The table that holds it must be
    // there, the value need not; throws std::invalid_argument otherwise.
    void set(const std::string& path, double value);
    void set(const std::string& path, const std::string& value);
    void set(const std::string& path, const host::Triple& value);
    void set(const std::string& path, const host::Quadruple& value);

    // Appends a copy of an element to the array of tables that it is in, "body[0]"; the copy's index.
    std::size_t append_copy(const std::string& element);

    // As a scene file.
    [[nodiscard]] std::string text() const;
    // Checked by every rule of the format; throws host::SceneError.
    [[nodiscard]] host::SceneDescription description() const;

private:
    struct Document;

    void put(const std::string& path, const auto& value);

    std::string name_;
    std::unique_ptr<Document> document_;
};

}  // namespace tumble::bench::stress
