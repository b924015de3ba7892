#include "tools/files.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "tools/output.hpp"

namespace tumble::host {

namespace fs = std::filesystem;

std::string contents_of(const fs::path& path) {
    std::ostringstream text;
    if (std::ifstream file(path); file) text << file.rdbuf();
    return text.str();
}

void write_if_changed(const fs::path& path, const std::string& text) {
    if (contents_of(path) == text) return;
    write_file(path, text);
}

DirectoryLock::DirectoryLock(const fs::path& directory)
    : file_(open((directory / "lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666)) {
    if (file_ < 0 || flock(file_, LOCK_EX) != 0)
        throw std::runtime_error("cannot lock " + directory.string() + ": " + std::generic_category().message(errno));
}
DirectoryLock::~DirectoryLock() { close(file_); }

}  // namespace tumble::host
