#include "scene/scene_file.hpp"

#include <array>
#include <fstream>

namespace tumble::host {
namespace {

// Bytes; enough for some hundred thousand events.
constexpr std::size_t largest_file = std::size_t{1} << 25;

}  // namespace

SceneDescription read_scene(const std::filesystem::path& path, BodyCount bodies) {
    const auto refuse = [&path](const std::string& why) -> SceneError {
        return {path.string(), 0, "", "cannot be read: " + why + ", expected a scene file (TOML)"};
    };
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status))
        throw refuse(status.type() == std::filesystem::file_type::not_found ? "no such file" : error.message());
    if (std::filesystem::is_directory(status)) throw refuse("it is a directory");
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw refuse("it cannot be opened");
    std::string text;
    for (std::array<char, 1 << 16> part{}; stream.read(part.data(), part.size()), stream.gcount() > 0;) {
        text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
        if (text.size() > largest_file) throw refuse("it is larger than " + std::to_string(largest_file) + " bytes");
    }
    if (stream.bad()) throw refuse("reading it failed");
    return read_scene_text(text, path.string(), bodies);
}

}  // namespace tumble::host
