// Warnings about a scene before a run.
#include <array>

#include "command_runner.hpp"

namespace tumble::host {
namespace {

// The warnings of a run that is well otherwise, without the file's name.
std::vector<std::string> warnings_of(const std::string& contact, const std::string& bodies) {
    const std::string scene = written("scene.toml", scene_of(contact, bodies));
    const std::string start = "warning: " + scene + ": ";
    std::vector<std::string> warnings;
    for (const std::string& line : lines_of(text_of({"run", scene})))
        if (line.starts_with(start)) warnings.push_back(line.substr(start.size()));
    return warnings;
}
using Warnings = std::vector<std::string>;

// The messages of `tumble compile` about a scene.
std::string warnings_of_compile(const std::string& scene, const std::vector<std::string>& options = {}) {
    return text_of(with({"compile", written("scene.toml", scene), "-o", "/dev/null"}, options));
}

TEST(Limits, shapes_without_body_contacts_give_a_warning_beside_other_bodies) {
    const std::string ball = body_of("ball", "sphere = 1.0", "[8.0, 0.0, 0.0]");
    const auto warning = [](const std::string& shape, const std::string& what) {
        return Warnings{"body \"a\": contacts of " + shape + " with " + what + " are not simulated, it passes through"};
    };
    const std::vector<std::array<std::string, 2>> round = {
        {"hoop = 1.0", "a hoop"}, {"cylinder = [1.0, 1.0]", "a cylinder"}, {"capsule = [1.0, 1.0]", "a capsule"}};
    for (const auto& [shape, name] : round) {
        const std::string body = body_of("a", shape), fixed = body + "fixed = true\n";
        EXPECT_EQ(warnings_of("", body), Warnings{}) << name;
        EXPECT_EQ(warnings_of("", body + ball), warning(name, "other bodies"));
        EXPECT_EQ(warnings_of("", fixed + ball), warning(name, "other bodies"));
        EXPECT_EQ(warnings_of("", fixed + ball + "fixed = true\n"), Warnings{}) << name;
        EXPECT_EQ(warnings_of("[contact]\nresponse = \"spring\"\nstiffness = 100.0\n", body + ball),
                  warning(name, "other bodies"));
        EXPECT_EQ(warnings_of("[contact]\nresponse = \"none\"\n", body + ball), Warnings{}) << name;
        EXPECT_EQ(warnings_of("", body + "[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 1.0\ninertia = [1.0, 1.0, "
                                         "1.0]\nposition = [8.0, 0.0, 0.0]\n"),
                  Warnings{})
            << name;
    }
    const std::string point = "[[body]]\nname = \"a\"\nshape = \"none\"\nmass = 1.0\n";
    EXPECT_EQ(warnings_of("", point), warning("a point mass", "planes"));
    EXPECT_EQ(warnings_of("", point + ball), warning("a point mass", "planes"));
    EXPECT_EQ(warnings_of("", point + "fixed = true\n" + ball), Warnings{});
    EXPECT_EQ(warnings_of("", point + "inertia = [1.0, 1.0, 1.0]\n"), Warnings{});
    EXPECT_EQ(warnings_of("[contact]\nresponse = \"none\"\n", point), Warnings{});
    const std::string cloud = "[[body]]\nname = \"a\"\nshape = { points = [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0], "
                              "[0.0, 1.0, 0.0, 1.0]] }\n";
    EXPECT_EQ(warnings_of("", cloud), warning("a cloud of points", "planes"));
    EXPECT_EQ(warnings_of("", cloud + ball), warning("a cloud of points", "planes and other bodies"));
    EXPECT_EQ(warnings_of("", cloud + "fixed = true\n" + ball), warning("a cloud of points", "other bodies"));
    EXPECT_EQ(warnings_of("", cloud + "fixed = true\n"), Warnings{});
    EXPECT_EQ(warnings_of("", body_of("a", "sphere = 1.0") + ball), Warnings{});
    EXPECT_EQ(warnings_of("", body_of("a", "box = [1.0, 1.0, 1.0]") + ball), Warnings{});
}

TEST(Limits, a_contact_tolerance_below_the_resolution_of_the_numbers_gives_a_warning) {
    const auto contact = [](const std::string& tolerance) { return "[contact]\ntolerance = " + tolerance + "\n"; };
    const std::string ball = body_of("a", "sphere = 1.0"), long_box = body_of("a", "box = [1.0, 1.0, 600.0]");
    // 600 m take units of 2^-18 m, of which 16 are the least tolerance; a way of 0.5 m in a step units of 2^-28 m.
    EXPECT_EQ(warnings_of(contact("0.0001"), long_box), Warnings{});
    EXPECT_EQ(warnings_of(contact("1e-6"), long_box),
              Warnings{"contact.tolerance = 1e-06 m is too small for q32 beside this scene's largest body or way in a "
                       "step: 6.10352e-05 m is used"});
    EXPECT_EQ(warnings_of(contact("1e-6"), ball), Warnings{});
    EXPECT_EQ(warnings_of(contact("1e-9"), ball).size(), 1u);
    EXPECT_EQ(warnings_of(contact("1e-9") + "response = \"none\"\n", ball), Warnings{});
}

TEST(Limits, spring_response_has_neither_friction_nor_sleep) {
    const std::string ball = body_of("a", "sphere = 1.0"), spring = "[contact]\nresponse = \"spring\"\n",
                      rough = "friction = 0.5\n", sleep = "sleep = { speed = 0.1 }\n";
    const std::string no_friction = "friction is not simulated with contact.response = \"spring\"",
                      no_sleep = "contact.sleep has no effect with contact.response = \"spring\"";
    EXPECT_EQ(warnings_of(spring, ball), Warnings{});
    EXPECT_EQ(warnings_of(spring + rough, ball), Warnings{no_friction});
    EXPECT_EQ(warnings_of(spring, ball + rough), Warnings{no_friction});
    EXPECT_EQ(warnings_of(spring, rough + ball), Warnings{no_friction});  // a key of the plane, which comes before
    EXPECT_EQ(warnings_of(spring, ball + "friction = 0.0\n"), Warnings{});
    EXPECT_EQ(warnings_of(spring + sleep, ball), Warnings{no_sleep});
    EXPECT_EQ(warnings_of("[contact]\n" + rough + sleep, ball), Warnings{});
}

TEST(Limits, events_without_an_effect_give_a_warning) {
    const auto output = [](const std::string& contact, const std::string& bodies) {
        return text_of({"run", written("scene.toml", scene_of(contact, bodies))});
    };
    // 0.1 s is nearest to the end of the last step, the 26th.
    const auto impulse_at = [](const char* time) {
        return body_of("a", "sphere = 1.0") + "[[impulse]]\ntime = " + time +
               "\nbody = \"a\"\nimpulse = [1.0, 0.0, 0.0]\n";
    };
    EXPECT_TRUE(has(output("", impulse_at("0.1")), "warning: "));
    EXPECT_FALSE(has(output("", impulse_at("0.099")), "warning: "));
    const std::string fixed = body_of("a", "sphere = 1.0") + "fixed = true\n";
    const std::string force = "[[force]]\nbody = \"a\"\nuntil = 0.1\nforce = [1.0, 0.0, 0.0]\n";
    EXPECT_TRUE(has(output("", fixed + "[[impulse]]\ntime = 0.0\nbody = \"a\"\nimpulse = [1.0, 0.0, 0.0]\n"),
                    "impulse[0] acts on body \"a\", which is fixed, so it has no effect"));
    EXPECT_TRUE(has(output("", fixed + force), "force[0] acts on body \"a\", which is fixed"));
    EXPECT_FALSE(has(output("", body_of("a", "sphere = 1.0") + force), "warning: "));
}

TEST(Limits, a_force_whose_impulse_changes_in_whole_steps_gives_a_warning) {
    // The warning about a force between two times, at a step; 1000 N and 0.5 s by default.
    const auto said = [](const std::string& step, const std::string& from, const std::string& until,
                         const std::string& what = "force = [600.0, 0.0, -800.0]\n",
                         const std::string& duration = "0.5") {
        return warnings_of_compile("[world]\nstep = \"" + step + "\"\nduration = " + duration + "\n" +
                                   body_of("a", "sphere = 1.0") + "[[force]]\nbody = \"a\"\nfrom = " + from +
                                   "\nuntil = " + until + "\n" + what);
    };
    // Between the steps at 0.09375 s and 0.109375 s: the nearest to both times is the later one.
    EXPECT_TRUE(has(said("1/64", "0.102", "0.108"),
                    "force[0] acts in 0 steps of 0.015625 s, so its impulse is 0 N s instead of 6 N s; take a shorter "
                    "step or an impulse"));
    EXPECT_TRUE(has(said("1/64", "0.1", "0.102"), "force[0] acts in 1 step of 0.015625 s, so its impulse is 15.625 N s "
                                                  "instead of 2 N s; take a shorter step\n"));
    EXPECT_TRUE(has(said("1/64", "0.102", "0.108", "torque = [0.0, 3.0, 4.0]\n"), "0 N m s instead of 0.03 N m s"));
    EXPECT_TRUE(has(said("0.1", "0.14", "0.26", "force = [1.0, 0.0, 0.0]\ntorque = [2.0, 0.0, 0.0]\n"),
                    "2 steps of 0.1 s, so its impulse is 0.2 N s and 0.4 N m s instead of 0.12 N s and 0.24 N m s"));
    // No warning: within a tenth, and without a force.
    EXPECT_EQ(said("1/64", "0.1", "0.3"), "");
    EXPECT_EQ(said("1/8192", "0.102", "0.108"), "");
    EXPECT_EQ(said("1/64", "0.102", "0.108", "force = [0.0, 0.0, 0.0]\n"), "");
    EXPECT_EQ(said("1/64", "0.0", "0.5"), "");
    EXPECT_TRUE(has(said("1/4", "0.6", "0.7", "force = [1.0, 0.0, 0.0]\n", "0.7"), "1 step"));
    const std::string late = "[world]\nstep = \"1/64\"\nduration = 4.0\n" + body_of("a", "sphere = 1.0") +
                             "[[force]]\nbody = \"a\"\nfrom = 3.0\nuntil = 3.5\nforce = [1.0, 0.0, 0.0]\n";
    EXPECT_EQ(warnings_of_compile(late), "");
    for (const auto* duration : {"2", "3"})
        EXPECT_TRUE(has(warnings_of_compile(late, {"--duration", duration}),
                        "force[0] begins when the last step has been taken, so it has no effect"));
    for (const auto& [duration, impulse] : {std::pair{"3.25", "0.25"}, std::pair{"3.0625", "0.0625"}})
        EXPECT_TRUE(has(warnings_of_compile(late, {"--duration", duration}),
                        std::string("force[0] has not ended when the last step has been taken, so its impulse is ") +
                            impulse + " N s instead of 0.5 N s"));
    EXPECT_EQ(warnings_of_compile(late, {"--duration", "3.5"}), "");
}

TEST(Limits, a_velocity_of_a_fixed_body_gives_a_warning) {
    const std::string fixed = body_of("belt", "box = [4.0, 1.0, 4.0]") + "fixed = true\n";
    EXPECT_EQ(warnings_of("", fixed + "velocity = [1.0, 0.0, 0.0]\n"),
              Warnings{"body \"belt\" is fixed, so its velocity has no effect"});
    EXPECT_EQ(warnings_of("", fixed + "velocity = [0.0, 0.0, 0.0]\nangular_velocity = [0.0, 1.0, 0.0]\n"), Warnings{});
}

// The warnings about an overlap of bodies, without a floor or with one at a height.
std::string overlap_in(const std::string& bodies, const std::string& floor = "", const std::string& contact = "") {
    return warnings_of_compile("[world]\nstep = \"1/64\"\nduration = 0\n" + contact + floor + bodies);
}

TEST(Limits, an_overlap_of_a_body_and_a_plane_at_the_start_gives_a_warning) {
    const std::string floor = "[[plane]]\nname = \"floor\"\nnormal = [0.0, 2.0, 0.0]\noffset = -1.0\n",  // y >= 1
        wall = "[[plane]]\nname = \"wall\"\nnormal = [-0.6, 0.0, 0.8]\n",
                      turned = "orientation = [0.8, 0.0, 0.0, 0.6]\n";  // cos 0.28, sin 0.96 about z
    const auto ball = [](const char* position) { return body_of("b", "sphere = 0.5", position); };
    const auto crate = [&](const char* position) { return body_of("b", "box = [1, 2, 3]", position) + turned; };
    const std::vector<std::array<std::string, 2>> overlaps = {
        {overlap_in(ball("[0, -2, 0]"), floor),
         "body \"b\" begins 3.5 m inside plane \"floor\", which pushes it out slowly"},
        {overlap_in(ball("[0, -8000, 0]"), floor, "[range]\nposition = 32768\n"), "8001.5 m"},
        {overlap_in(crate("[0, 1.75, 0]"), floor), "begins 0.01 m inside plane"},  // half of 1 * 0.96 + 2 * 0.28
        {overlap_in(body_of("b", "cylinder = [0.5, 3]", "[0, 1.4, 0]"), floor), "begins 0.1 m inside plane"},
        {overlap_in(body_of("b", "capsule = [0.5, 2]", "[0, 0, 1]"), wall), "begins 0.5 m inside plane \"wall\""},
        {overlap_in(ball("[0, 1.4995, 0]"), floor, "[contact]\ntolerance = 1e-4\n"), "0.0005 m"}};
    for (const auto& [warning, expected] : overlaps) EXPECT_TRUE(has(warning, expected)) << warning << expected;
    EXPECT_EQ(overlap_in(crate("[0, 1.76, 0]"), floor), "");
    EXPECT_EQ(overlap_in(body_of("b", "hoop = 0.5", "[0, 1.5, 0]"), floor), "");
    // The contact tolerance allows a small overlap. Fixed bodies and scenes without contacts touch no plane.
    EXPECT_EQ(overlap_in(ball("[0, 1.4995, 0]"), floor), "");
    EXPECT_EQ(overlap_in(ball("[0, -2, 0]") + "fixed = true\n", floor), "");
    EXPECT_EQ(overlap_in(ball("[0, -2, 0]"), floor, "[contact]\nresponse = \"none\"\n"), "");
}

TEST(Limits, an_overlap_of_two_bodies_at_the_start_gives_a_warning) {
    const auto two = [](const char* a, const char* x, const char* b, const char* y) {
        return overlap_in(body_of("a", a, x) + body_of("b", b, y));
    };
    // Two boxes edge to edge, apart along the normal of both edges alone.
    const auto crossed = [](const std::string& height) {
        return overlap_in(body_of("a", "box = [4, 1, 1]", "[0, 0, 0]") +
                          "orientation = [0.92387953, 0.38268343, 0.0, 0.0]\n" +
                          body_of("b", "box = [1, 1, 4]", "[0, " + height + ", 0]") +
                          "orientation = [0.92387953, 0.0, 0.0, 0.38268343]\n");
    };
    const char *origin = "[0, 0, 0]", *cube = "box = [1, 1, 1]", *ball = "sphere = 0.25";
    const std::vector<std::array<std::string, 2>> overlaps = {
        {two(ball, origin, ball, "[0.27, 0, 0.36]"), "body \"b\" begins 0.05 m inside body \"a\""},
        {two(ball, origin, ball, origin), "begins 0.5 m inside"},
        {two(cube, origin, cube, "[0.2, 0.9, -0.3]"), "begins 0.1 m inside"},
        {two(cube, origin, cube, origin), "begins 1 m inside"},
        // A sphere by a corner of a box: 0.3 m from it along each axis, 0.5196 m in all.
        {two(cube, origin, "sphere = 0.53", "[0.8, -0.8, 0.8]"), "begins 0.0103848 m inside"},
        {two("sphere = 0.1", "[0, 0.3, 0]", cube, origin), "begins 0.3 m inside"},
        {crossed("1.40"), "begins 0.0142136 m inside body \"a\""}};
    for (const auto& [warning, expected] : overlaps) EXPECT_TRUE(has(warning, expected)) << warning << expected;
    EXPECT_EQ(two(ball, origin, ball, "[0.3, 0, 0.4]"), "");
    EXPECT_EQ(two(cube, origin, cube, "[0.2, 1, -0.3]"), "");
    EXPECT_EQ(two(cube, origin, "sphere = 0.51", "[0.8, 0.8, 0.8]"), "");
    EXPECT_EQ(crossed("1.42"), "");
}

}  // namespace
}  // namespace tumble::host
