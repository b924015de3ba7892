// Files and standard output of the command: written whole or not at all, and lost output is reported.
#include <signal.h>

#include "command_runner.hpp"
#include "rows/rows.hpp"
#include "tools/output.hpp"

namespace tumble::host {
namespace {

// Runs the command in a shell, which may redirect its output. A scene may come from standard input.
Outcome tumble_in_shell(const std::string& arguments, const std::string& scene = {}) {
    Outcome outcome{};
    outcome.status = Process({"sh", "-c", std::string(TUMBLE_COMMAND) + " " + arguments}, scene, Process::Errors::keep)
                         .wait(&outcome.text);
    return outcome;
}

TEST(Output, lost_standard_output_is_reported) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    EXPECT_TRUE(has(tumble_in_shell("list 2>&1 >/dev/full").text,
                    "tumble: writing to standard output failed: No space left on device\n"));
    const std::string orbit = shipped("orbit");
    for (const std::string& arguments :
         {std::string("list"), std::string("--help"), std::string("run --help"), std::string("--version"),
          "compile " + orbit, "run " + orbit, "run --json " + orbit, "compile -o /dev/stdout " + orbit,
          "run --trajectory /dev/stdout " + orbit}) {
        SCOPED_TRACE(arguments);
        expect_outcome(tumble_in_shell(arguments + " 2>&1 >/dev/full"), 1, "failed");
        if (has(arguments, "/dev/stdout")) continue;
        expect_outcome(tumble_in_shell(arguments + " 2>&1 >&-"), 1, "failed");
    }
}

TEST(Output, a_hyphen_is_standard_input_and_standard_output) {
    const std::string orbit = shipped("orbit"), scene = contents(orbit), csv = temporary("out.csv");
    ASSERT_EQ(tumble({"run", orbit, "--duration", "1", "--trajectory", csv}).status, 0);
    const Outcome trajectory = tumble_in_shell("run - --duration 1 --trajectory -", scene);
    EXPECT_EQ(trajectory.status, 0);
    EXPECT_EQ(trajectory.text, contents(csv));  // the table is on standard error
    expect_outcome(tumble_in_shell("compile - --struct Orbit -o -", scene), 0, "struct Orbit {");
    expect_outcome(tumble_in_shell("run - 2>&1", "name = 3\n"), 2, "/dev/stdin:1: name: got 3");
    EXPECT_FALSE(std::filesystem::exists("-"));
}

TEST(Output, a_name_that_cannot_be_written_is_told_before_the_run) {
    namespace fs = std::filesystem;
    const std::string directory = fs::path(temporary("x")).parent_path().string(), file = written("file", ""),
                      endless = temporary("endless");
    fs::remove(endless);
    fs::create_symlink(directory + "/" + std::string(300, 'e'), endless);
    // The run would take minutes.
    const std::string scene = written("scene.toml", world_of("0", "1/1024", "100000.0") + body_of("b", "sphere = 0.1"));
    for (const std::string& name : {directory + "/" + std::string(256, 'n'), directory + "/" + std::string(5000, 'n'),
                                    directory + "/none/out", directory + "/none/", file + "/out", directory, endless}) {
        for (const char* option : {"--trajectory", "--contacts", "--plot", "--gltf"})
            expect_outcome(tumble({"run", scene, option, name}), 2, std::string(option) + ": cannot write ",
                           ", expected a file that can be written");
        expect_outcome(tumble({"run", scene, "--live", "--record", name}), 2, "--record: cannot write ");
        expect_outcome(tumble({"compile", scene, "-o", name}), 2, "--output: cannot write ");
        expect_outcome(tumble({"profile", scene, "--core", "cortex-m3", "--flame", name}), 2, "--flame: cannot write ");
    }
    for (const auto& entry : fs::directory_iterator(directory))
        EXPECT_FALSE(has(entry.path().filename().string(), ".tmp")) << entry.path();
}

TEST(Output, the_scene_and_the_other_outputs_are_not_overwritten) {
    namespace fs = std::filesystem;
    const std::string scene = written("scene.toml", contents(shipped("orbit"))), before = contents(scene);
    const fs::path directory = fs::path(scene).parent_path();
    const std::string link = temporary("link.toml"), hard = temporary("hard.toml"), dangling = temporary("dangling"),
                      dotted = (directory / ".." / directory.filename() / "scene.toml").string();
    for (const std::string& old : {link, hard, dangling}) fs::remove(old);
    fs::create_symlink("scene.toml", link);
    fs::create_symlink("new.svg", dangling);
    fs::create_hard_link(scene, hard);
    for (const std::string& output : {scene, link, hard, dotted}) {
        for (const char* option : {"--trajectory", "--plot", "-o"}) {
            const bool compiles = std::string(option) == "-o";
            expect_outcome(tumble({compiles ? "compile" : "run", scene, option, output}), 2,
                           std::string(compiles ? "--output" : option) + ": " + output +
                               " is the file of the scene, expected another");
            EXPECT_EQ(contents(scene), before) << option << " " << output;
        }
        // The scene may be the link as well.
        EXPECT_EQ(tumble({"run", output, "--trajectory", scene}).status, 2) << output;
        EXPECT_EQ(contents(scene), before) << output;
    }
    for (const auto& [one, other] : {std::pair{temporary("new.svg"), temporary("new.svg")},
                                     {temporary("new.svg"), dangling},
                                     {temporary("new.svg"), (directory / "./new.svg").string()}}) {
        expect_outcome(tumble({"run", scene, "--trajectory", one, "--plot", other}), 2,
                       "--plot: " + other + " is the file of --trajectory, expected another");
        EXPECT_FALSE(fs::exists(one));
    }
}

TEST(OutputFile, is_written_whole_or_not_at_all) {
    namespace fs = std::filesystem;
    const std::string path = written("out", "old"), link = temporary("link");
    const fs::path directory = fs::path(path).parent_path();
    const auto count = [&] { return std::distance(fs::directory_iterator(directory), fs::directory_iterator()); };
    fs::permissions(path, fs::perms(0640));
    fs::remove(link);
    fs::create_symlink("out", link);
    const auto before = count();
    {
        OutputFile file(path);
        file.stream() << std::string(1 << 20, 'x');
        EXPECT_EQ(contents(path), "old");
    }
    EXPECT_EQ(contents(path), "old");
    {
        OutputFile file(link);
        file.stream() << "new";
        EXPECT_EQ(contents(path), "old");
        file.commit();
    }
    EXPECT_EQ(contents(path), "new");
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(fs::status(path).permissions(), fs::perms(0640));
    EXPECT_EQ(count(), before);
    // A signal leaves nothing behind.
    for (const int signal : {SIGINT, SIGTERM, SIGQUIT}) {
        const int status = status_in_a_process([&] {
            OutputFile file(path), other(temporary("other"));
            file.stream() << "newer";
            raise(signal);
        });
        EXPECT_TRUE(WIFSIGNALED(status)) << signal;
        EXPECT_EQ(contents(path), "new");
        EXPECT_EQ(count(), before) << signal;
    }
}

TEST(OutputFile, a_write_error_throws) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
    EXPECT_THROW(write_file("/dev/full", "text"), std::runtime_error);
    EXPECT_THROW(write_file("/nonexistent/file", "text"), std::invalid_argument);
    EXPECT_THROW(write_file(std::filesystem::temp_directory_path(), "text"), std::invalid_argument);
    EXPECT_NO_THROW(write_file("/dev/null", "text"));
    const bench::Row row = {{"scene", "none"}};
    EXPECT_THROW(bench::write_rows("/dev/full", {row}), std::runtime_error);
    const std::string rows = temporary("directory/rows.jsonl");
    bench::write_rows(rows, {row});
    EXPECT_EQ(bench::read_rows(rows).at(0).at("scene"), "none");
    // More than the largest file that the program may write, as a disk that fills up in the middle.
    const std::string path = written("limited", "old");
    const int status = status_in_a_process([&] {
        const rlimit small{4096, 4096};
        setrlimit(RLIMIT_FSIZE, &small);
        signal(SIGXFSZ, SIG_IGN);
        try {
            write_file(path, std::string(1 << 18, 'x'));
        } catch (const std::runtime_error& error) { _exit(has(error.what(), "File too large") ? 3 : 4); }
    });
    EXPECT_EQ(WEXITSTATUS(status), 3);
    EXPECT_EQ(contents(path), "old");
}

}  // namespace
}  // namespace tumble::host
