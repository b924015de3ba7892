// `tumble profile`: the functions of a step add up to its cycles, and bad input is refused.
#include "command_runner.hpp"

namespace tumble::host {
namespace {

TEST(Profile, functions_add_up_to_the_cycles_of_a_step) {
    const std::string flame = temporary("flame.svg");
    const Json json = json_of(
        {"profile", shipped("free"), "--core", "cortex-m3", "--integrator", "semi_implicit_euler", "--flame", flame});
    EXPECT_EQ(json["integrator"], "semi_implicit_euler");
    EXPECT_EQ(json["core"], "cortex-m3");
    EXPECT_EQ(json["memory"], "zero wait states");
    const double estimate = json["cycles_per_step_est"];
    EXPECT_GE(estimate, json["insn_per_step"].get<double>());
    EXPECT_LE(json["cycles_per_step_min"], estimate);
    EXPECT_GE(json["cycles_per_step_max"], estimate);
    double own = 0;
    bool has_product = false;
    for (const Json& function : json["functions"]) {
        own += function["own_cycles_per_step"].get<double>();
        EXPECT_LE(function["own_cycles_per_step"], function["cycles_per_step"]);
        EXPECT_LE(function["cycles_per_step"], estimate + 0.01);
        has_product = has_product || function["function"].get<std::string>().find("multiply") != std::string::npos;
    }
    EXPECT_NEAR(own, estimate, 0.01);
    EXPECT_TRUE(has_product) << "inlined functions have no frames";
    for (const Json& branch : json["one_way_branches"]) {
        EXPECT_TRUE(branch["taken"] == 0 || branch["not_taken"] == 0);
        EXPECT_NE(branch["line"].get<std::string>().find("kernel/include/tumble/"), std::string::npos);
    }
    EXPECT_NE(contents(flame).find("<title>step_world"), std::string::npos);
}

TEST(ProfileDeep, a_step_with_a_joint_has_its_functions) {
    const Json json = json_of({"profile", shipped("joints/pendulum"), "--core", "cortex-m3", "--duration", "0.25"});
    const double estimate = json["cycles_per_step_est"];
    double own = 0;
    bool has_joints = false;
    for (const Json& function : json["functions"]) {
        own += function["own_cycles_per_step"].get<double>();
        has_joints = has_joints || function["function"].get<std::string>().find("Joint") != std::string::npos;
    }
    EXPECT_NEAR(own, estimate, 0.01);
    EXPECT_TRUE(has_joints);
}

TEST(Profile, bad_input_is_refused) {
    const auto expect = [](const std::vector<std::string>& options, const std::string& message) {
        expect_outcome(tumble(with({"profile", shipped("free")}, options)), 2, message);
    };
    expect({"--core", "cortex-m7"}, "got \"cortex-m7\", whose cycles no manual gives, expected one of cortex-m0");
    expect({"--core", "z80"}, "got \"z80\", expected one of");
    expect({}, "--core");
    expect({"--core", "cortex-m3", "--flame", "/no/such/directory/out.svg"}, "--flame: cannot write");
    expect({"--core", "cortex-m3", "--functions", "0"}, ">= 1");
    expect({"--core", "cortex-m3", "--integrator", "exact"}, "exact");
}

}  // namespace
}  // namespace tumble::host
