#include "tools/output.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <mutex>
#include <stdexcept>
#include <streambuf>
#include <system_error>

#include "tools/ending.hpp"

namespace tumble::host {
namespace {

namespace fs = std::filesystem;

std::string reason(int error) { return std::generic_category().message(error); }

// The path that symbolic links lead to; the last one may lead to a file that does not exist yet.
fs::path resolved(fs::path path) {
    std::error_code error;
    for (int i = 0; i < 40 && fs::is_symlink(fs::symlink_status(path, error)); ++i)
        path = path.parent_path() / fs::read_symlink(path, error);
    const fs::path directory = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const fs::path canonical = fs::weakly_canonical(directory, error);
    return (error ? directory : canonical) / path.filename();
}

// The descriptor of the standard stream that writes to this file, or -1.
int stream_of(const struct stat& file) {
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
        struct stat other {};
        if (fstat(stream, &other) == 0 && other.st_dev == file.st_dev && other.st_ino == file.st_ino) return stream;
    }
    return -1;
}

// The names of temporary files, which a signal handler removes. It reads only entries whose flag `named` is set, which
// happens after the name is complete.
struct Unfinished {
    std::atomic_flag taken;
    std::atomic<bool> named;
    std::array<char, PATH_MAX> name;
};
std::array<Unfinished, 8> unfinished;

void remove_unfinished() {
    for (const Unfinished& file : unfinished)
        if (file.named) unlink(file.name.data());
}

void remember(const std::string& name) {
    static std::once_flag registered;
    std::call_once(registered, [] { before_ending(remove_unfinished); });
    if (name.size() >= PATH_MAX) return;
    for (Unfinished& file : unfinished) {
        if (file.taken.test_and_set()) continue;
        file.name[name.copy(file.name.data(), name.size())] = 0;
        file.named = true;
        return;
    }
}

void forget(const std::string& name) {
    for (Unfinished& file : unfinished) {
        if (!file.named || name != file.name.data()) continue;
        file.named = false;
        file.taken.clear();
    }
}

}  // namespace

// Buffers text for a file descriptor and keeps the first error.
class OutputFile::Descriptor : public std::streambuf {
public:
    explicit Descriptor(int file) : file_(file) { setp(part_.data(), part_.data() + part_.size()); }
    ~Descriptor() override {
        if (file_ >= 0) ::close(file_);
    }
    [[nodiscard]] int error() const { return error_; }
    [[nodiscard]] bool finish(bool to_disk) {
        if (flushed() && to_disk && fsync(file_) != 0 && errno != EINVAL) error_ = errno;
        if (::close(file_) != 0 && error_ == 0) error_ = errno;
        file_ = -1;
        return error_ == 0;
    }

protected:
    int_type overflow(int_type c) override {
        if (!flushed()) return traits_type::eof();
        if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
        return sputc(traits_type::to_char_type(c));
    }
    int sync() override { return flushed() ? 0 : -1; }

private:
    bool flushed() {
        const char* from = pbase();
        while (error_ == 0 && from < pptr()) {
            const ssize_t count = write(file_, from, static_cast<std::size_t>(pptr() - from));
            if (count >= 0) from += count;
            else if (errno != EINTR) error_ = errno;
        }
        setp(part_.data(), part_.data() + part_.size());
        return error_ == 0;
    }

    int file_, error_ = 0;
    std::array<char, 1 << 16> part_;
};

OutputFile::OutputFile(const fs::path& path, std::string_view argument)
    : name_(path.string()), argument_(argument.empty() ? "" : std::string(argument) + ": "), path_(resolved(path)),
      stream_(nullptr) {
    static std::atomic<unsigned> count{0};
    struct stat before {};
    // The name may lead to a file that is not there, but the system must be able to look it up.
    errno = 0;
    const bool exists = stat(path.c_str(), &before) == 0 || (errno == ENOENT && stat(path_.c_str(), &before) == 0);
    const int refusal = exists || errno == ENOENT ? 0 : errno;
    const bool is_name = path_.has_filename() && path_.filename() != "." && path_.filename() != "..";
    const int standard = exists ? stream_of(before) : -1;
    int file = -1;
    if (standard >= 0) {
        // Text that was printed before comes first in the file; the duplicate shares its position.
        std::cout.flush();
        std::fflush(nullptr);
        file = dup(standard);
    } else if (refusal != 0 || (!exists && !is_name)) {
        errno = refusal != 0 ? refusal : ENOENT;
    } else if (!exists || access(path.c_str(), W_OK) == 0) {
        if (!exists || S_ISREG(before.st_mode)) {
            const std::string name = ".tumble." + std::to_string(getpid()) + "." + std::to_string(count++) + ".tmp";
            temporary_ = (path_.parent_path() / name).string();
            remember(temporary_);
            file = open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
            if (file >= 0 && exists) (void)fchmod(file, before.st_mode & 07777);
            if (file < 0) {
                forget(temporary_);
                temporary_.clear();
            }
        }
        if (file < 0 && exists) file = open(path.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
    }
    if (file < 0)
        throw std::invalid_argument(argument_ + "cannot write " + name_ + ": " + reason(errno) +
                                    ", expected a file that can be written");
    descriptor_ = std::make_unique<Descriptor>(file);
    stream_.rdbuf(descriptor_.get());
}

OutputFile::~OutputFile() {
    if (temporary_.empty()) return;
    unlink(temporary_.c_str());
    forget(temporary_);
}

void OutputFile::fail() {
    const int error = descriptor_->error();
    throw std::runtime_error(argument_ + "writing " + name_ + " failed" + (error == 0 ? "" : ": " + reason(error)));
}

void OutputFile::commit() {
    const bool good = stream_.good();
    if (!descriptor_->finish(!temporary_.empty()) || !good) fail();
    if (temporary_.empty()) return;
    if (rename(temporary_.c_str(), path_.c_str()) != 0)
        throw std::runtime_error(argument_ + "writing " + name_ + " failed: " + reason(errno));
    forget(temporary_);
    temporary_.clear();
}

void write_file(const fs::path& path, std::string_view text) {
    OutputFile file(path);
    file.stream() << text;
    file.commit();
}

namespace {

bool is_same(const fs::path& a, const fs::path& b) {
    std::error_code error;
    const bool a_exists = fs::exists(a, error), b_exists = fs::exists(b, error);
    if (a_exists && b_exists) return fs::is_regular_file(a, error) && fs::equivalent(a, b, error);
    return !a_exists && !b_exists && resolved(a) == resolved(b);
}

}  // namespace

void check_outputs(const std::vector<FileArgument>& inputs, const std::vector<FileArgument>& outputs) {
    std::vector<FileArgument> others = inputs;
    for (const FileArgument& output : outputs) {
        if (output.path.empty()) continue;
        for (const FileArgument& other : others)
            if (is_same(output.path, other.path))
                throw std::invalid_argument(output.argument + ": " + output.path.string() + " is the file of " +
                                            other.argument + ", expected another");
        others.push_back(output);
    }
}

void tell_lost_output() {
    const auto tell = [] {
        errno = 0;
        std::cout.flush();
        const bool flushed = std::fflush(stdout) == 0;
        const int error = errno;
        if (flushed && std::ferror(stdout) == 0 && !std::cout.bad()) return;
        std::cerr << program_invocation_short_name << ": writing to standard output failed"
                  << (error == 0 ? "" : ": " + reason(error)) << std::endl;
        _exit(1);
    };
    static std::once_flag registered;
    std::call_once(registered, [&] {
        if (std::atexit(tell) != 0) throw std::runtime_error("atexit failed");
    });
}

}  // namespace tumble::host
