// `tumble advise` on a core in QEMU, on a search of two methods.
#include "command_runner.hpp"
#include "scene/scene_file.hpp"
#include "verdict/accuracy.hpp"

namespace tumble::host {
namespace {

// The free body in the range whose worlds without carry other tests need too.
std::string free_body() {
    return written("free.toml",
                   contents(shipped("free")) + "[range]\nposition = 64.0\nvelocity = 32.0\nangular_velocity = 32.0\n");
}

TEST(Advise, cheapest_method_on_a_core_keeps_the_tolerance) {
    constexpr double tolerance = 1e-4;
    const Json json = json_of({"advise", free_body(), "--core", "cortex-m3", "--tolerance", "1e-4", "--integrators",
                               "verlet,rk4", "--numbers", "q32", "--clock", "16MHz"});
    EXPECT_EQ(json["ranking"].size() + json["not_measured"].size() + json["unreached"].size(), 4u);
    ASSERT_FALSE(json["ranking"].empty());
    EXPECT_EQ(json["recommendation"], json["ranking"][0]);
    EXPECT_EQ(json["cost"], "cycles");
    EXPECT_EQ(json["clock_hz"], 16e6);
    double last = 0;
    for (const Json& row : json["ranking"]) {
        const double cost = row["cycles_per_simulated_second_est"], step = row["step_s"];
        EXPECT_GE(cost, last);
        last = cost;
        EXPECT_EQ(cost, row["cycles_per_step_est"].get<double>() / step);
        EXPECT_EQ(row["insn_per_simulated_second"], row["insn_per_step"].get<double>() / step);
        EXPECT_GT(row["cycles_per_step_est"], row["insn_per_step"]);
        EXPECT_EQ(row["memory"], "zero wait states");
        EXPECT_DOUBLE_EQ(row["mean_share_of_step"], row["cycles_per_step_est"].get<double>() / (16e6 * step));
        EXPECT_DOUBLE_EQ(row["worst_share_of_step"], row["cycles_worst_step_max"].get<double>() / (16e6 * step));
        EXPECT_GT(row["insn_per_step"], 100);
        EXPECT_GT(row["text_bytes"], 1000);
        EXPECT_GT(row["ram_bytes"], 100);
    }

    // Run again, by the library, the recommended method is within the tolerance.
    const Json& best = json["recommendation"];
    const SampledScene scene(read_scene(free_body()));
    int step = scene.longest();
    while (scene.with_step(step).step.seconds() > best["step_s"].get<double>()) --step;
    const auto run = run_sampled(
        scene, {best["integrator"].get<std::string>(), best["numbers"].get<std::string>(), best["carry"].get<bool>()},
        step);
    ASSERT_TRUE(run && run->failure.empty());
    const Errors errors = largest_errors(run->samples, truth_of(scene).samples);
    EXPECT_LE(errors.largest(), tolerance);
    EXPECT_EQ(errors.position_m, best["position_error_m"]);
    EXPECT_EQ(errors.orientation_rad, best["orientation_error_rad"]);
}

// Carry adds work, yet a core may take less for it.
TEST(AdviseDeep, the_cheapest_method_is_measured_with_carry_too) {
    const Json json = json_of({"advise", free_body(), "--core", "cortex-m3", "--tolerance", "1e-4", "--integrators",
                               "suzuki4", "--numbers", "q32"});
    ASSERT_EQ(json["ranking"].size(), 2u) << json;
    EXPECT_NE(json["ranking"][0]["carry"], json["ranking"][1]["carry"]);
    EXPECT_LE(json["ranking"][0]["cycles_per_simulated_second_est"],
              json["ranking"][1]["cycles_per_simulated_second_est"]);
}

TEST(AdviseDeep, a_method_for_a_pendulum_on_a_hinge_is_found) {
    const Json json = json_of({"advise", shipped("joints/pendulum"), "--core", "cortex-m3", "--tolerance", "1e-3",
                               "--integrators", "verlet", "--numbers", "q32"});
    ASSERT_FALSE(json["ranking"].empty()) << json;
    const Json& best = json["recommendation"];
    EXPECT_EQ(best["integrator"], "verlet");
    EXPECT_LE(best["position_error_m"], 1e-3);
    EXPECT_GT(best["cycles_per_step_est"], 1000);
}

TEST(Advise, cost_is_in_instructions_on_request_and_without_a_timing_table) {
    const auto advise = [](const std::vector<std::string>& options) {
        return tumble(with({"advise", free_body(), "--integrators", "rk4", "--numbers", "q32"}, options));
    };
    expect_outcome(advise({"--core", "cortex-m3", "--tolerance", "1e-4", "--cost", "insn", "--clock", "16 MHz"}), 0,
                   " instructions a simulated second.",
                   "At 16 MHz a step of 1/32 s has 500000 cycles: the mean step takes 0.");
    // No firmware is built: no method has so small an error.
    expect_outcome(advise({"--core", "cortex-m7", "--tolerance", "1e-12"}), 1,
                   "cortex-m7: nothing publishes its cycles; costs are in instructions");
}

}  // namespace
}  // namespace tumble::host
