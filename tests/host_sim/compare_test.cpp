// `tumble compare`: the same bits on a core in QEMU as on the host, and a report that names the place where they are
// not.
#include "command_runner.hpp"

namespace tumble::host {
namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Compare, host_and_core_agree_in_every_recorded_state) {
    for (const auto* numbers : {"q32", "f32", "f64"}) {
        const Outcome outcome = tumble({"compare", shipped("cube"), "--core", "cortex-m3", "--every", "7", "--duration",
                                        "2", "--numbers", numbers});
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        EXPECT_TRUE(has(outcome.text, "cortex-m3 agrees with the host: 59 states, verlet, " + std::string(numbers)))
            << outcome.text;
    }
}

TEST(Compare, every_load_gives_the_same_bits) {
    for (const auto* scene : {"pendulum", "projectile", "satellite", "orbit"}) {
        const Outcome outcome = tumble({"compare", shipped(scene), "--core", "cortex-m4f", "--every", "64",
                                        "--duration", "4", "--integrator", "rk4"});
        EXPECT_EQ(outcome.status, 0) << scene << ": " << outcome.text;
    }
}

TEST(Compare, a_flipped_bit_is_reported_with_its_step_body_and_number) {
    const Outcome outcome = tumble(
        {"compare", shipped("brick"), "--core", "cortex-m3", "--every", "10", "--duration", "1", "--flip", "120"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(has(outcome.text, "cortex-m3 differs at step 120 (0.46875 s): body \"brick\", x_w.x: host "
                                  "0x0000000000000001, cortex-m3 0x0000000000000000; 12 states"))
        << outcome.text;
}

TEST(Compare, leaving_the_range_is_a_failure_on_both_sides) {
    const std::string scene = written(
        "falling.toml",
        "name = \"falling\"\n[world]\ngravity = [0.0, -9.81, 0.0]\nstep = \"1/256\"\nduration = 8.0\n[range]\nposition "
        "= 64.0\n"
        "velocity = 32.0\nangular_velocity = 32.0\n[[body]]\nname = \"ball\"\nshape = { sphere = 0.5 }\nmass = 1.0\n");
    const Outcome outcome = tumble({"compare", scene, "--core", "cortex-m3", "--every", "64"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(has(outcome.text, "agrees with the host")) << outcome.text;
    EXPECT_TRUE(has(outcome.text, "range_left")) << outcome.text;
}

TEST(Compare, firmware_without_doubles_has_no_double_arithmetic) {
    for (const auto* numbers : {"q32", "f32"}) {
        ASSERT_EQ(tumble({"compare", shipped("brick"), "--core", "cortex-m0", "--every", "256", "--duration", "1",
                          "--numbers", numbers})
                      .status,
                  0)
            << numbers;
        std::string symbols;
        ASSERT_EQ(Process({"arm-none-eabi-nm", (source_directory / "build/compare/cortex-m0/record.elf").string()})
                      .wait(&symbols),
                  0);
        for (const auto* name : {"__aeabi_d", "__aeabi_f2d", "__aeabi_i2d", "__aeabi_ui2d", "__aeabi_l2d"})
            EXPECT_FALSE(has(symbols, name)) << numbers << ": " << name;
        EXPECT_EQ(has(symbols, "__aeabi_fmul"), std::string(numbers) == "f32") << numbers;
    }
}

}  // namespace
}  // namespace tumble::host
