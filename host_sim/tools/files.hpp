// Files that a build reads, and a build directory for one user at a time. All of it throws std::runtime_error.
#pragma once

#include <filesystem>
#include <string>

namespace tumble::host {

// Empty for a file that cannot be read.
[[nodiscard]] std::string contents_of(const std::filesystem::path& path);

// Leaves a file that says the same alone, so that nothing is built again.
void write_if_changed(const std::filesystem::path& path, const std::string& text);

// One user of a directory at a time; the lock ends with the process.
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
