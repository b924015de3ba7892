// Output that is not lost without a sign: files that are written whole or not at all, and what goes to standard output.
#pragma once

#include <filesystem>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace tumble::host {

// A file that is written whole or not at all. Text goes to a temporary file beside it, which takes its name in
// commit(); until then, and without it, the file is as it was, also where a signal ends the program. What is no regular
// file, as /dev/stdout or a pipe, is written in place, and so is a file whose directory takes no other.
class OutputFile {
public:
    // Throws std::invalid_argument where nothing can be written there. `argument` is what named the file, as --plot;
    // messages begin with it.
    explicit OutputFile(const std::filesystem::path& path, std::string_view argument = {});
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    [[nodiscard]] std::ostream& stream() { return stream_; }
    // False when something has been lost already: commit() will throw.
    [[nodiscard]] bool good() const { return stream_.good(); }
    // Throws std::runtime_error with the system's reason when not all has been written.
    void commit();

private:
    class Descriptor;
    [[noreturn]] void fail();

    std::string name_, argument_;
    std::filesystem::path path_;  // what links lead to
    std::string temporary_;       // empty: written in place
    std::unique_ptr<Descriptor> descriptor_;
    std::ostream stream_;
};

// The same for a text.
void write_file(const std::filesystem::path& path, std::string_view text);

// A file that an argument names.
struct FileArgument {
    std::string argument;  // as --plot
    std::filesystem::path path;
};
// Throws std::invalid_argument for an output that is the same file as an input or as another output, by whatever name,
// link or hard link. Empty paths are none, and what is no regular file may be named twice.
void check_outputs(const std::vector<FileArgument>& inputs, const std::vector<FileArgument>& outputs);

// At the end of the program, what standard output has not taken is told on standard error, and the status is 1.
void tell_lost_output();

}  // namespace tumble::host
