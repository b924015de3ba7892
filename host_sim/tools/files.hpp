// Files for a build, and the lock of a build directory. The functions throw std::runtime_error.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::host {

// The text of a file; empty where it cannot be read.
[[nodiscard]] std::string contents_of(const std::filesystem::path& path);

// Writes a file unless it has this text already; its time then stays, and nothing is built again.
void write_if_changed(const std::filesystem::path& path, const std::string& text);

// Lets one process at a time use a directory. The lock ends with the process at the latest.
class DirectoryLock {
public:
    explicit DirectoryLock(const std::filesystem::path& directory);
    ~DirectoryLock();
    DirectoryLock(const DirectoryLock&) = delete;
    DirectoryLock& operator=(const DirectoryLock&) = delete;

private:
    int file_;
};

}  // namespace tumble::host
