// What is wrong with a scene file.
#pragma once

#include <stdexcept>
#include <string>

namespace tumble::host {

// what() is "file:line: key: message, expected ...".
class SceneError : public std::runtime_error {
public:
    SceneError(std::string file, int line, std::string key, const std::string& message);

    [[nodiscard]] const std::string& file() const { return file_; }
    [[nodiscard]] int line() const { return line_; }               // 0: the file could not be read at all
    [[nodiscard]] const std::string& key() const { return key_; }  // for example body[1].mass; indices start at 0

private:
    std::string file_;
    int line_;
    std::string key_;
};

}  // namespace tumble::host
