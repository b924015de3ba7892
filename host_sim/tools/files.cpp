#include "tools/files.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace tumble::host {

namespace fs = std::filesystem;

std::string contents_of(const fs::path& path) {
    std::ostringstream text;
    if (std::ifstream file(path); file) text << file.rdbuf();
    return text.str();
}

void write_if_changed(const fs::path& path, const std::string& text) {
    if (contents_of(path) == text) return;
    std::ofstream file(path);
    file << text;
    file.close();
    if (!file) throw std::runtime_error("cannot write " + path.string());
}

DirectoryLock::DirectoryLock(const fs::path& directory)
    : file_(open((directory / "lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666)) {
    if (file_ < 0 || flock(file_, LOCK_EX) != 0) throw std::runtime_error("cannot lock " + directory.string());
}
DirectoryLock::~DirectoryLock() { close(file_); }

}  // namespace tumble::host
