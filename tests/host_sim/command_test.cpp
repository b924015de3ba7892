// The command `tumble` as its contract says: help, version, lists, and the exit statuses 0 done, 1 failed, 2 bad input.
#include <tumble/version.hpp>

#include "command_runner.hpp"
#include "firmware/firmware.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {
namespace {

struct BadCall {
    std::vector<std::string> arguments;
    std::string message;
    // Prints the call in the name of a test.
    friend void PrintTo(const BadCall& call, std::ostream* out) {
        for (std::size_t i = 0; i < call.arguments.size(); ++i)
            *out << (i > 0 ? " " : "") << std::filesystem::path(call.arguments[i]).filename().string();
    }
};
class BadInput : public testing::TestWithParam<BadCall> {};

TEST_P(BadInput, ends_with_status_2_and_says_what_was_expected) {
    expect_outcome(tumble(GetParam().arguments), 2, GetParam().message);
}

const std::string brick_file = shipped("brick");
INSTANTIATE_TEST_SUITE_P(
    Command, BadInput,
    testing::Values(
        BadCall{{}, "tumble: A subcommand is required"}, BadCall{{"dance"}, "dance"}, BadCall{{"run"}, "scene"},
        BadCall{{"run", "missing.toml"}, "missing.toml: cannot be read: no such file"},
        BadCall{{"run", TUMBLE_SOURCE_DIR "/tests/host_sim/CMakeLists.txt"}, "CMakeLists.txt:2: TOML syntax: "},
        BadCall{{"run", brick_file, "--integrator", ""}, "expected a name"},
        BadCall{{"run", brick_file, "--numbers", ""}, "expected a name"},
        BadCall{{"run", brick_file, "--integrator", "rk5"},
                "unknown integrator \"rk5\" (did you mean \"rk4\"?), expected one of explicit_euler, "},
        BadCall{{"run", brick_file, "--integrator", "exact"}, "expected --numbers to be one of f32, f64"},
        BadCall{{"compile", brick_file, "--integrator", "exact", "--numbers", "q32"},
                "integrator \"exact\" does not run in q32, because "},
        BadCall{{"run", brick_file, "--numbers", "q16"},
                "unknown number system \"q16\", expected one of q32, f32, f64"},
        BadCall{{"run", brick_file, "--carry", "maybe"}, "--carry: got \"maybe\", expected on or off"},
        BadCall{{"run", brick_file, "--step", "-1"}, "--step: got \"-1\", expected a positive number"},
        BadCall{{"run", brick_file, "--step", "1/0"}, "--step: got \"1/0\", expected a positive number"},
        BadCall{{"run", brick_file, "--step", ""}, "--step: got \"\", expected a positive number"},
        BadCall{{"run", brick_file, "--duration", "-1"}, "--duration: got \"-1\", expected a number of seconds"},
        BadCall{{"run", brick_file, "--duration", "nan"}, "--duration: got \"nan\", expected a number of seconds"},
        BadCall{{"run", brick_file, "--duration", "2s"}, "--duration: got \"2s\", expected a number of seconds"},
        BadCall{{"run", brick_file, "--duration", "1e12"}, "2^31 steps"},
        BadCall{{"run", brick_file, "--every", "0"}, "--every: got \"0\", expected a whole number of steps >= 1\n"},
        BadCall{{"run", brick_file, "--every", "1.5"}, "--every: got \"1.5\", expected a whole number of steps"},
        BadCall{{"run", brick_file, "--trajectory", ""}, "--trajectory: got \"\", expected the name of a file"},
        BadCall{{"run", brick_file, "--plot", "brick.png"},
                "--plot: got \"brick.png\", expected the name of a file that is written as SVG, as out.svg"},
        BadCall{{"profile", brick_file, "--core", "cortex-m3", "--flame", "brick.pdf"}, "--flame: got \"brick.pdf\""},
        BadCall{{"run", brick_file, "--integrator", "RK4"}, "unknown integrator \"RK4\" (did you mean \"rk4\"?)"},
        BadCall{{"compare", brick_file, "--core", "m3"}, "got \"m3\" (did you mean \"cortex-m3\"?)"},
        BadCall{{"rnu", brick_file}, "got \"rnu\" (did you mean \"run\"?)"},
        BadCall{{"advise", brick_file, "--core", "cortex-m3", "--tolerance", "1e-3", "--clock", "16"},
                "--clock: got \"16\", expected a positive frequency, as 16MHz"},
        BadCall{{"run", brick_file, "--integrator", std::string(100000, 'r')}, "rrrr\u2026\", expected one of"},
        BadCall{{"run", brick_file, "--plot", ""}, "--plot: got \"\", expected the name of a file"},
        BadCall{{"run", brick_file, "--plot", "/nonexistent/a.svg"}, "--plot: cannot write /nonexistent/a.svg"},
        BadCall{{"run", brick_file, "--integrator", "foo"}, ", implicit_euler,"},
        BadCall{{"run", brick_file, "--trajectory", "/no/where.csv"}, "/no/where.csv"},
        BadCall{{"compile", brick_file, "-o", "/no/where.hpp"}, "/no/where.hpp"},
        BadCall{{"compile", brick_file, "-o", ""}, "--output: got \"\", expected the name of a file"},
        BadCall{{"compare", brick_file}, "--core"},
        BadCall{{"compare", brick_file, "--core", "z80"}, "got \"z80\", expected one of cortex-m0, "},
        BadCall{{"compare", brick_file, "--core", "cortexm3"}, "got \"cortexm3\" (did you mean \"cortex-m3\"?)"},
        BadCall{{"rum", brick_file}, "got \"rum\" (did you mean \"run\"?), expected \"run\", \"compile\", "},
        BadCall{{"run", "--integrators", "rk4"},
                "--integrators: unknown option of run (did you mean \"--integrator\"?), expected one of \"--help\", "},
        BadCall{{"advise", brick_file, "--toleranc=1"},
                "--toleranc: unknown option of advise (did you mean \"--tolerance\"?), expected one of "},
        BadCall{{"run", brick_file, "--trajectory", "-", "--json"},
                "--trajectory, --json: got standard output for each of them, expected it for one"},
        BadCall{{"view", "-"}, "scene: got standard input, which can be read only once, expected a file\n"},
        BadCall{{"compare", brick_file, "--core", "cortex-m3", "--every", "16", "--flip", "17"},
                "--flip: got 17, expected a step that is recorded"},
        BadCall{{"compare", brick_file, "--core", "cortex-m3", "--flip", "-1"}, "--flip: got \"-1\", expected"},
        BadCall{{"compare", brick_file, "--core", "cortex-m3", "--every", "0"},
                "--every: got \"0\", expected a whole number of steps >= 1\n"},
        BadCall{{"compare", brick_file, "--core", "cortex-m3", "--timeout", "0"},
                "--timeout: got \"0\", expected a whole number of seconds >= 1\n"}));

TEST(Command, version_is_that_of_the_kernel_and_of_its_bits) {
    EXPECT_EQ(text_of({"--version"}), "tumble " TUMBLE_VERSION ", bits " + std::to_string(TUMBLE_BITS) + "\n");
}

TEST(Command, help_is_not_an_error) {
    for (const auto* topic : {"run", "compile", "compare", "list"})
        EXPECT_EQ(tumble({topic, "--help"}).status, 0) << topic;
    EXPECT_TRUE(has(tumble({"compare", "--help"}).text, "--flip"));
    EXPECT_TRUE(has(tumble({"--help"}).text, "Exit status"));
    EXPECT_EQ(tumble({"help"}).status, 0);
    EXPECT_EQ(tumble({"help"}).text, tumble({"--help"}).text);
    EXPECT_EQ(tumble({"help", "compare"}).text, tumble({"compare", "--help"}).text);
    EXPECT_EQ(tumble({"help", "dance"}).status, 2);
    EXPECT_FALSE(has(tumble({"run", "--help"}).text, "00000000"));  // the limits of a double, digit by digit
}

TEST(Firmware, a_memory_shortage_is_one_sentence) {
    EXPECT_EQ(memory_shortage("ld: a.elf section `.bss' will not fit in region `RAM'\n"
                              "ld: region `RAM' overflowed by 8688 bytes\ncollect2: error: ld returned 1 exit status\n",
                              "cortex-m0"),
              "needs 8688 bytes of RAM more than cortex-m0 has");
    EXPECT_EQ(memory_shortage("ld.lld: error: section '.bss' will not fit in region 'RAM': overflowed by 96 bytes\n"
                              "ld.lld: error: section '.text' will not fit in region 'FLASH': overflowed by 4 bytes\n",
                              "cortex-m3"),
              "needs 96 bytes of RAM and 4 bytes of FLASH more than cortex-m3 has");
    EXPECT_EQ(memory_shortage("undefined reference to `main'\n", "cortex-m3"), "");
}

TEST(List, names_integrators_number_systems_ranges_and_cores) {
    const std::string text = text_of({"list"});
    for (const IntegratorInfo& info : integrators()) EXPECT_TRUE(has(text, info.name)) << info.name;
    expect_parts(text, {"not in q32, because " + find_integrator("exact").not_in_fixed_point, "q32", "f32", "f64",
                        "near", "room", "field", "32768 m", "cortex-m0", "mps2-an385"});
}

TEST(List, shows_the_order_of_free_rotation_where_it_differs) {
    const auto lines = lines_of(tumble({"list"}).text);
    const std::size_t column = lines.at(0).find("needs");
    std::size_t rows = 0;
    for (const std::string& line : lines) {
        for (const IntegratorInfo& info : integrators()) {
            if (!line.starts_with("  " + info.name + " ")) continue;
            ++rows;
            ASSERT_GT(line.size(), column);
            EXPECT_EQ(line.substr(column - 1, 1), " ") << line;
            EXPECT_NE(line.substr(column, 1), " ") << line;
            EXPECT_EQ(has(line, " 2 (free 6) "), info.name == "pdmv6") << line;
            EXPECT_EQ(has(line, " 2 (free exact) "), info.name == "exact") << line;
            EXPECT_EQ(has(line, "(free "), info.free_order != info.order) << line;
        }
    }
    EXPECT_EQ(rows, integrators().size());
}

}  // namespace
}  // namespace tumble::host
