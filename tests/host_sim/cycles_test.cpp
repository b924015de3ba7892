// Cycles in rows: measured firmware of the budgets, run with the plugin.
#include "command_runner.hpp"
#include "firmware/firmware.hpp"

namespace tumble::host {
namespace {

std::filesystem::path budget_firmware(const std::string& core, const std::string& program) {
    return source_directory / "build" / core / "tests/budget" / ("budget-free-" + program + ".elf");
}

TEST(Cycles, are_in_the_row_of_a_core_that_has_a_timing_table) {
    const auto elf = budget_firmware("cortex-m3", "q32-Verlet");
    const StepOutcome outcome = run_step_program(core_named("cortex-m3"), elf);
    ASSERT_EQ(outcome.error, "");
    const auto& row = outcome.row;
    EXPECT_EQ(row.at("memory"), "zero wait states");
    EXPECT_EQ(row.at("unknown_insn"), 0);
    const auto number = [&](const char* key) { return row.at(key).get<double>(); };
    EXPECT_GT(number("cycles_per_step_min"), number("insn_per_step"));
    EXPECT_GT(number("cycles_per_step_est"), number("cycles_per_step_min"));
    EXPECT_GT(number("cycles_per_step_max"), number("cycles_per_step_est"));
    EXPECT_GE(number("cycles_worst_step_max"), number("cycles_per_step_max"));
    // Classes have every instruction, but for the four of the call.
    double insn = 0;
    for (const auto& [name, count] : row.at("mix_per_step").items()) insn += count.get<double>();
    EXPECT_NEAR(insn, number("insn_per_step") - 4, 0.5 + 0.01 * static_cast<double>(row.at("mix_per_step").size()));

    EXPECT_EQ(run_step_program(core_named("cortex-m3"), elf).row, row);

    const Core without = core_named("cortex-m7");
    ASSERT_FALSE(without.has_cycles());
    const StepOutcome other = run_step_program(without, elf);
    ASSERT_EQ(other.error, "");
    EXPECT_EQ(other.row.at("insn_per_step"), row.at("insn_per_step"));
    EXPECT_FALSE(other.row.contains("cycles_per_step_est"));
}

TEST(Cycles, of_an_instruction_without_a_timing_are_an_error_that_lists_it) {
    Core core = core_named("cortex-m4f");
    core.timing = "m3";  // has no floating point
    const StepOutcome outcome = run_step_program(core, budget_firmware("cortex-m4f", "f32_plain-Rk4"));
    EXPECT_TRUE(outcome.row.is_null());
    EXPECT_TRUE(has(outcome.error, "no timing for the instruction e")) << outcome.error;
    EXPECT_TRUE(has(outcome.error, "executed 256 times")) << outcome.error;
}

TEST(Cycles, of_another_function_than_the_firmware_measures_are_an_error) {
    const StepOutcome outcome =
        run_step_program(core_named("cortex-m3"), budget_firmware("cortex-m3", "q32-Verlet"), 60, {"print_row"});
    EXPECT_TRUE(outcome.row.is_null());
    EXPECT_TRUE(has(outcome.error, "expected the steps and instructions of the firmware, less the 4 of its call"))
        << outcome.error;
}

}  // namespace
}  // namespace tumble::host
