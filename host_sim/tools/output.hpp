// Output whose loss is always reported: files that are written whole or not at all, and standard output.
#pragma once

#include <filesystem>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace tumble::host {

// A file that is written whole or not at all. The text goes to a temporary file beside it, which commit() renames.
// Without commit(), also where a signal ends the program, the old file stays as it was. A device or a pipe, as
// /dev/stdout, is written in place, and so is a file in a directory where no other file can be made.
class OutputFile {
public:
    // Throws std::invalid_argument where the file cannot be written. Messages begin with `argument`, the option that
    // named the file, as --plot.
    explicit OutputFile(const std::filesystem::path& path, std::string_view argument = {});
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    [[nodiscard]] std::ostream& stream() { return stream_; }
    // False after an error of writing; commit() will throw.
    [[nodiscard]] bool good() const { return stream_.good(); }
    // Throws std::runtime_error with the system's reason where the text was not written completely.
    void commit();

private:
    class Descriptor;
    [[noreturn]] void fail();

    std::string name_, argument_;
    std::filesystem::path path_;  // after symbolic links
    std::string temporary_;       // empty: written in place
    std::unique_ptr<Descriptor> descriptor_;
    std::ostream stream_;
};

// Writes a text to an OutputFile.
void write_file(const std::filesystem::path& path, std::string_view text);

// A file that an argument names.
struct FileArgument {
    std::string argument;  // as --plot
    std::filesystem::path path;
};
// Throws std::invalid_argument where an output is the same file as an input or another output; links are followed, and
// hard links count as the same file. Empty paths are skipped. Only regular files are checked.
void check_outputs(const std::vector<FileArgument>& inputs, const std::vector<FileArgument>& outputs);

// Makes the program end with a message and status 1 where its standard output could not be written.
void tell_lost_output();

}  // namespace tumble::host
