// The builder and the type-erased simulation: what a scene file says is what the kernel gets, and what it reports is in
// the user's units and axes.
#include <tumble/body/words.hpp>

#include <cmath>
#include <ctime>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "command_runner.hpp"
#include "liar.hpp"
#include "scene/data.hpp"
#include "scene/scene_file.hpp"
#include "simulation/simulation.hpp"

namespace tumble::host {
namespace {

// The deep set alone runs one. A function that is new in Simulation must be in it too.
static_assert(!std::is_abstract_v<Liar>);

constexpr const char* head = "name = \"test\"\n[world]\nstep = \"1/256\"\nduration = 1.0\n";

SceneDescription scene_with(const std::string& body, const std::string& before = "") {
    return read_scene_text(head + before + "[[body]]\nname = \"body\"\n" + body, "test.toml");
}

TEST(SceneBuilder, density_times_volume_is_mass) {
    const SceneData data = build_scene(scene_with("shape = { capsule = [0.5, 2.0] }\ndensity = 1000.0\n"));
    // Straight part of 2 m and two half spheres.
    const double volume = std::numbers::pi * 0.25 * 2.0 + 4.0 / 3.0 * std::numbers::pi * 0.125;
    EXPECT_NEAR(data.bodies[0].mass.to_double(), 1000.0 * volume, 1e-9);
}

TEST(SceneBuilder, points_are_a_body_about_their_centre_of_mass) {
    const SceneData data =
        build_scene(scene_with("shape = { points = [[1.0, 0.0, 0.0, 2.0], [3.0, 0.0, 0.0, 2.0], [2.0, 1.0, 0.0, 1.0], "
                               "[2.0, -1.0, 0.0, 1.0]] }\nposition = [5.0, 6.0, 7.0]\n"));
    const BodySpec& body = data.bodies[0];
    EXPECT_EQ(body.mass.to_double(), 6.0);
    EXPECT_EQ(body.position.x.to_double(), 5.0);
    EXPECT_NEAR(body.inertia.xx.to_double(), 2.0, 1e-15);
    EXPECT_NEAR(body.inertia.yy.to_double(), 4.0, 1e-15);
    EXPECT_NEAR(body.inertia.zz.to_double(), 6.0, 1e-15);
}

TEST(SceneBuilder, fraction_of_a_step_is_exact_to_64_bits) {
    SceneDescription scene = scene_with("shape = { sphere = 1.0 }\nmass = 1.0\n");
    scene.step = parse_step("1/3").value();
    EXPECT_TRUE(build_scene(scene).step.value == Real{1} / Real{3});
}

TEST(SceneBuilder, planes_without_a_response_are_left_out) {
    const std::string rest = "shape = { box = [1.0, 1.0, 1.0] }\nmass = 1.0\n";
    const std::string plane = floor_plane + "offset = 10.0\n";
    const SceneData without = build_scene(scene_with(rest, "[contact]\nresponse = \"none\"\n" + plane)),
                    with = build_scene(scene_with(rest, plane));
    EXPECT_TRUE(without.planes.empty());
    EXPECT_FALSE(needs(without).boxes);
    EXPECT_EQ(with.planes.size(), 1u);
    EXPECT_TRUE(needs(with).boxes);
    EXPECT_FALSE(needs(with).friction);
}

TEST(SceneBuilder, contact_is_as_written) {
    const std::string rest = "shape = { sphere = 1.0 }\nmass = 1.0\n", sleep = "sleep = { speed = 0.1, time = 2.0 }\n",
                      constants = "stiffness = 500.0\ndamping = 3.0\nbarrier = 0.5\ntolerance = 0.01\n";
    const SceneData soft = build_scene(
        scene_with(rest, "[contact]\nresponse = \"spring\"\n" + constants + sleep + floor_plane + "offset = 10.0\n"));
    const ContactSpec& contact = soft.world.contact;
    EXPECT_EQ(contact.response, tumble::ContactResponse::spring);
    EXPECT_EQ(contact.stiffness.to_double(), 500.0);
    EXPECT_EQ(contact.damping.to_double(), 3.0);
    EXPECT_EQ(contact.barrier.to_double(), 0.5);
    EXPECT_EQ(contact.tolerance.to_double(), 0.01);
    EXPECT_FALSE(contact.sleep.on);  // only impulses let a body sleep
    EXPECT_FALSE(needs(soft).sleep);
    EXPECT_EQ(soft.planes.size(), 1u);
    EXPECT_TRUE(needs(soft).contact_springs);
    EXPECT_FALSE(needs(soft).contact_impulses);

    const SceneData hard = build_scene(scene_with(rest, "[contact]\n" + sleep));
    EXPECT_TRUE(needs(hard).sleep);
    EXPECT_EQ(hard.world.contact.sleep.speed.to_double(), 0.1);
    EXPECT_EQ(hard.world.contact.sleep.angular_speed.to_double(), 0.05);
    EXPECT_EQ(hard.world.contact.sleep.time.to_double(), 2.0);
    EXPECT_FALSE(needs(hard).contacts());  // one body, and no plane
    EXPECT_FALSE(needs(build_scene(scene_with(rest))).sleep);
}

TEST(SceneBuilder, more_bodies_than_there_is_room_for_are_refused) {
    SceneDescription scene = scene_with("shape = { sphere = 1.0 }\nmass = 1.0\n");
    scene.bodies.resize(max_bodies, scene.bodies[0]);
    EXPECT_NO_THROW((void)build_scene(scene));
    scene.bodies.push_back(scene.bodies[0]);
    EXPECT_THROW((void)build_scene(scene), UnsupportedScene);
}

TEST(SceneBuilder, events_are_brought_into_order_in_a_moment_and_those_of_one_step_keep_theirs) {
    SceneDescription scene = scene_with("shape = { sphere = 1.0 }\nmass = 1.0\n");
    constexpr int count = 100000;
    scene.duration = 100.0;  // 25600 steps: about four events in each
    for (int i = 0; i < count; ++i) {
        // The last step first, and in a step by turns after and before its time.
        const double time = (25599 - i / 4 + (i % 2 == 0 ? 0.2 : -0.2)) / 256, tag = 0.001 * (i % 4 + 1);
        scene.impulses.push_back({time, 0, Frame::world, {1.0, tag, 0.0}, {}, {}});
        scene.forces.push_back({0, time, time + 1.0, Frame::world, {tag, 0.0, 0.0}, {}, {}});
    }
    const SceneData data = with_events_in_order(build_scene(scene));
    int impulses = 0, forces = 0;
    for (const EventSpec& event : data.events) {
        if (event.kind == EventKind::end_force) continue;
        const bool is_force = event.kind == EventKind::begin_force;
        int& i = is_force ? forces : impulses;
        ASSERT_EQ(std::round(event.time.to_double() * 256), 25600 - count / 4 + i / 4);
        ASSERT_NEAR((is_force ? event.value.x : event.value.y).to_double(), 0.001 * (i % 4 + 1), 1e-12) << i;
        ++i;
    }
    EXPECT_EQ(impulses, count);
    EXPECT_EQ(forces, count);
    // Moving each event past all later ones takes a minute.
    const std::clock_t start = std::clock();
    const auto simulation = make_simulation(scene);
    EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 5.0);
    EXPECT_TRUE(simulation->troubles().empty());
}

TEST(SceneBuilder, misuse_of_the_kernel_is_an_exception_that_says_what_failed) {
    SceneDescription scene = scene_with("shape = { sphere = 1.0 }\nmass = 1.0\n");
    scene.bodies[0].mass = -1.0;
    try {
        (void)make_simulation(scene);
        FAIL() << "no exception";
    } catch (const std::logic_error& error) {
        EXPECT_NE(std::string(error.what()).find("the kernel's assertion "), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find(".hpp, line "), std::string::npos) << error.what();
    }
}

// --- snapshots -------------------------------------------------------------------------------------------------------

struct TestedSystem {
    std::size_t index;  // in number_systems()
    bool has_every_method;
};

class EverySystem : public testing::TestWithParam<TestedSystem> {
protected:
    [[nodiscard]] std::unique_ptr<Simulation> start(const SceneDescription& scene,
                                                    std::string_view integrator = "verlet") const {
        return make_simulation(scene, integrator, info().name, info().carry);
    }
    // The largest relative rounding of a set-up value.
    [[nodiscard]] double tolerance() const { return info().name == "f64" || info().carry ? 1e-9 : 1e-5; }
    [[nodiscard]] const NumberSystemInfo& info() const { return number_systems()[GetParam().index]; }
    [[nodiscard]] bool is_tested(const IntegratorInfo& integrator) const {
        return runs_in(integrator, info().name) && (GetParam().has_every_method || integrator.is_usual);
    }
};

// The axes of a body whose moments are not in the kernel's order, and that is turned in the world.
TEST_P(EverySystem, reports_the_initial_state_in_the_users_axes) {
    const auto simulation = start(scene_with(
        "shape = \"none\"\nmass = 2.0\ninertia = [1.0, 3.0, 2.5, 0.1, -0.2, 0.3]\nposition = [1.0, 2.0, 3.0]\n"
        "velocity = [-1.0, 0.5, 0.25]\norientation = [0.5, 0.5, -0.5, 0.5]\nangular_velocity = [0.3, -0.2, 0.7]\n"));
    const BodySnapshot body = simulation->body(0);
    const auto near = [&](const auto& got, std::initializer_list<double> expected) {
        std::size_t i = 0;
        for (const double x : expected)
            EXPECT_NEAR(static_cast<double>(got[i++]), x, tolerance()) << info().type << ", component " << i - 1;
    };
    near(body.position, {1.0, 2.0, 3.0});
    near(body.velocity, {-1.0, 0.5, 0.25});
    near(body.orientation, {0.5, 0.5, -0.5, 0.5});
    near(body.angular_velocity, {0.3, -0.2, 0.7});
    const double rotation =
        0.5 * (1.0 * 0.09 + 3.0 * 0.04 + 2.5 * 0.49) + 0.1 * 0.3 * -0.2 - 0.2 * 0.3 * 0.7 + 0.3 * -0.2 * 0.7;
    EXPECT_NEAR(static_cast<double>(simulation->energy().kinetic), rotation + 0.5 * 2.0 * (1.0 + 0.25 + 0.0625),
                20 * tolerance());
}

// Of the words of a record after some steps. The hash digests these words.
Simulation::Place last_place(Simulation& simulation, int steps) {
    for (int i = 0; i < steps; ++i) simulation.step();
    std::vector<std::uint32_t> words;
    simulation.append_words(words);
    Hash hash;
    for (const std::uint32_t word : words) hash.add(word);
    EXPECT_EQ(hash.value(), simulation.hash()) << simulation.integrator();
    const auto last = simulation.place_of_word(words.size() - 1);
    EXPECT_EQ(last.first + last.count, words.size());
    return last;
}

TEST_P(EverySystem, words_of_a_record_are_what_the_hash_digests) {
    for (const IntegratorInfo& integrator : integrators()) {
        if (!is_tested(integrator)) continue;
        const auto simulation = start(read_scene(shipped("cube")), integrator.name);
        EXPECT_EQ(last_place(*simulation, 300).number, "t_b.z") << integrator.name;
    }
}

TEST_P(EverySystem, a_point_mass_has_a_place_and_a_velocity_alone) {
    for (const IntegratorInfo& integrator : integrators()) {
        if (!is_tested(integrator)) continue;
        const auto simulation = start(read_scene(shipped("oscillators")), integrator.name);
        const auto last = last_place(*simulation, 100);
        EXPECT_EQ(last.body, 1);
        EXPECT_EQ(last.number, "d_w.z");
        const BodySnapshot body = simulation->body(1);
        EXPECT_EQ(body.orientation, (std::array<long double, 4>{1, 0, 0, 0}));
        EXPECT_EQ(body.angular_velocity, (std::array<long double, 3>{0, 0, 0}));
    }
}

std::string name_of_system(const testing::TestParamInfo<TestedSystem>& info) {
    const NumberSystemInfo& system = number_systems()[info.param.index];
    return system.name + system.range + (system.carry ? "" : "_plain");
}
// In the quick set those with the default carry, with the methods of their first modules: in the smallest range all.
std::vector<TestedSystem> systems_of(bool quick) {
    const auto& all = number_systems();
    std::vector<TestedSystem> found;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (!quick || all[i].carry == default_carry(all[i].name))
            found.push_back({i, !quick || (all[i].name == "q32" && all[i].range == "near")});
    return found;
}
INSTANTIATE_TEST_SUITE_P(Simulation, EverySystem, testing::ValuesIn(systems_of(true)), name_of_system);
INSTANTIATE_TEST_SUITE_P(Deep, EverySystem, testing::ValuesIn(systems_of(false)), name_of_system);

TEST(Simulation, energy_of_a_spring_and_of_gravity_is_potential) {
    const auto simulation = make_simulation(read_scene(shipped("pendulum")), "rk4", "f64");
    EXPECT_NEAR(static_cast<double>(simulation->energy().total()), -13.544, 1e-12);
    EXPECT_EQ(simulation->energy().kinetic, 0.0L);
}

TEST(Simulation, energy_of_an_orbit_is_constant) {
    const auto simulation = make_simulation(read_scene(shipped("orbit")), "rk4", "f64");
    EXPECT_NEAR(static_cast<double>(simulation->energy().total()), -1.82, 1e-12);
    finish(*simulation);
    EXPECT_NEAR(static_cast<double>(simulation->energy().total()), -1.82, 1e-10);
}

TEST(Simulation, motion_does_not_depend_on_the_mass_of_a_fixed_body) {
    const auto hash = [](const std::string& mass, const std::string& response, const char* numbers) {
        const std::string toml = "[world]\nstep = \"1/256\"\nduration = 1.0\ngravity = [0, -9.81, 0]\n[contact]\n"
                                 "friction = 0.3\nresponse = \"" +
                                 response +
                                 "\"\n[[body]]\nname = \"table\"\nshape = { box = [2, 1, 2] }\nfixed = true\n" + mass +
                                 "angular_velocity = [0, 1, 0]\n[[body]]\nname = \"box\"\nshape = { box = [0.3, 0.2, "
                                 "0.1] }\nmass = 1.5\nposition = [0.1, 0.8, 0]\nangular_velocity = [1, 2, 3]\n"
                                 "[[spring]]\nbody = \"box\"\npoint = [0.1, 0, 0]\nto_body = \"table\"\nto_point = "
                                 "[0.5, 0.5, 0]\nstiffness = 20\n";
        return finish(*make_simulation(read_scene_text(toml, "text.toml"), "verlet", numbers));
    };
    for (const char* response : {"impulse", "spring"})
        for (const char* numbers : {"q32", "f64"}) {
            const std::uint64_t without = hash("", response, numbers);
            for (const char* mass : {"mass = 0.001\n", "mass = 7.3\n", "mass = 1e5\n"})
                EXPECT_EQ(hash(mass, response, numbers), without) << response << " " << numbers << " " << mass;
        }
}

TEST(Simulation, a_scene_without_a_range_has_none_in_floating_point) {
    const SceneDescription scene = read_scene_text(
        "[world]\nstep = 600\nduration = 2360592\ngravitation = 6.6743e-11\n[[body]]\nname = \"earth\"\n"
        "shape = \"none\"\nmass = 5.972e24\nvelocity = [0, -12.5, 0]\n[[body]]\nname = \"moon\"\nshape = \"none\"\n"
        "mass = 7.348e22\nposition = [3.844e8, 0, 0]\nvelocity = [0, 1010, 0]\n",
        "text.toml");
    const auto simulation = make_simulation(scene, "rk4", "f64");
    const auto start = static_cast<double>(simulation->energy().total());
    finish(*simulation);
    EXPECT_TRUE(simulation->troubles().empty());
    EXPECT_NEAR(static_cast<double>(simulation->energy().total()) / start, 1.0, 1e-9);
    try {
        (void)make_simulation(scene, "rk4", "q32");
        FAIL() << "no error";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.key(), "body[1].position[0]");
        EXPECT_NE(std::string(error.what()).find("--numbers f64 and f32 need none"), std::string::npos);
    }
}

TEST(Simulation, point_masses_move_as_their_scenes_say) {
    const auto stone = make_simulation(read_scene(shipped("stone")), "verlet", "q32");
    EXPECT_EQ(stone->range(), "near");  // without a spin, whatever the largest is
    finish(*stone);
    const std::array<double, 3> landed{6.0, 1.88, -2.0};
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(static_cast<double>(stone->body(0).position[i]), landed[i], 1e-7);

    SceneDescription scene = read_scene(shipped("oscillators"));
    scene.step = {1, 1024, 0};
    const auto masses = make_simulation(scene, "rk4", "f64");
    EXPECT_NEAR(static_cast<double>(masses->energy().total()), 1.0, 1e-12);
    finish(*masses);
    EXPECT_NEAR(static_cast<double>(masses->energy().total()), 1.0, 1e-9);
    const double t = 4.0, in_phase = std::cos(4.0 * t), against = std::cos(4.0 * std::sqrt(3.0) * t);
    EXPECT_NEAR(static_cast<double>(masses->body(0).position[0]), -0.5 + 0.125 * (in_phase + against), 1e-8);
    EXPECT_NEAR(static_cast<double>(masses->body(1).position[0]), 0.5 + 0.125 * (in_phase - against), 1e-8);
}

TEST(Simulation, energy_of_contact_springs_is_potential) {
    const auto potential = [](const std::string& bodies, const char* barrier) {
        const SceneDescription scene =
            read_scene_text(head + std::string("[contact]\nresponse = \"spring\"\nstiffness = 1000.0\nbarrier = ") +
                                barrier + "\n[[plane]]\nname = \"floor\"\nnormal = [0.0, 2.0, 0.0]\n" + bodies,
                            "test.toml");
        return static_cast<double>(make_simulation(scene, "verlet", "f64")->energy().potential);
    };
    const std::string ball = body_of("ball", "sphere = 0.5", "[0.0, 0.4, 0.0]"),
                      other = body_of("other", "sphere = 0.25", "[0.0, 0.95, 0.0]"), fixed = "fixed = true\n";
    EXPECT_NEAR(potential(ball, "2.0"), 5.0, 1e-9);         // 0.1 m deep
    EXPECT_NEAR(potential(other, "2.0"), 2.0 / 0.7, 1e-9);  // 0.7 m above
    EXPECT_EQ(potential(other, "0.0"), 0.0);
    EXPECT_EQ(potential(ball + fixed, "2.0"), 0.0);
    EXPECT_NEAR(potential(ball + other, "2.0"), 5.0 + 2.0 / 0.7 + 20.0, 1e-9);  // 0.2 m deep in each other
    EXPECT_NEAR(potential(ball + fixed + other, "2.0"), 2.0 / 0.7 + 20.0, 1e-9);
    EXPECT_EQ(potential(ball + fixed + other + fixed, "2.0"), 0.0);
    // Four vertices at -0.1 m, four at 0.9 m.
    EXPECT_NEAR(potential(body_of("box", "box = [1.0, 1.0, 2.0]", "[0.0, 0.4, 0.0]"), "0.0"), 4 * 5.0, 1e-9);
}

TEST(Simulation, smallest_range_that_holds_the_scene_is_used) {
    SceneDescription scene = read_scene(shipped("brick"));
    EXPECT_EQ(make_simulation(scene)->range(), "near");
    scene.range.velocity = 32.1;
    EXPECT_EQ(make_simulation(scene)->range(), "room");
    EXPECT_EQ(make_simulation(scene, "rk4", "f32")->range(), "");
}
TEST(DeepSimulation, largest_range_is_used_where_no_smaller_one_holds_the_scene) {
    SceneDescription scene = read_scene(shipped("brick"));
    scene.range.angular_velocity = 64.1;
    EXPECT_EQ(make_simulation(scene)->range(), "field");
}

TEST(Simulation, carry_is_on_for_q32_and_f32_and_off_for_f64) {
    const SceneDescription scene = read_scene(shipped("brick"));
    EXPECT_TRUE(make_simulation(scene, "verlet", "q32")->carry());
    EXPECT_TRUE(make_simulation(scene, "verlet", "f32")->carry());
    EXPECT_FALSE(make_simulation(scene, "verlet", "f64")->carry());
    EXPECT_FALSE(make_simulation(scene, "verlet", "q32", false)->carry());
}

// --- every shipped scene with every integrator -----------------------------------------------------------------------

class EveryScene : public testing::TestWithParam<std::tuple<std::string, std::string, std::optional<bool>>> {};

TEST_P(EveryScene, runs_in_every_number_system_that_the_integrator_has) {
    const auto& [name, integrator, carry] = GetParam();
    const SceneDescription scene = read_scene(shipped(name));
    for (const auto* numbers : {"q32", "f32", "f64"}) {
        if (!runs_in(find_integrator(integrator), numbers)) continue;
        const auto simulation = make_simulation(scene, integrator, numbers, carry);
        finish(*simulation);
        for (const Trouble& trouble : simulation->troubles()) {
            // Explicit Euler feeds energy into a swinging pendulum until it leaves any range.
            if (integrator == "explicit_euler" && trouble.issue == "range_left") continue;
            // In fixed point the three-axis splitting holds a rod's spin about its axis up to half the range only.
            if (integrator == "strang" && name == "projectile" && numbers == std::string_view{"q32"} &&
                trouble.issue == "range_left") {
                continue;
            }
            ADD_FAILURE() << numbers << ": " << trouble.issue << " at step " << trouble.step;
        }
        for (int b = 0; b < simulation->body_count(); ++b) {
            const BodySnapshot body = simulation->body(b);
            long double norm2 = 0;
            for (const long double q : body.orientation) norm2 += q * q;
            EXPECT_NEAR(static_cast<double>(norm2), 1.0, 0.02) << numbers;
            for (const long double x : body.position) EXPECT_LT(std::abs(x), scene.range.position) << numbers;
        }
    }
}

std::vector<std::string> integrator_names(bool only_usual) {
    std::vector<std::string> names;
    for (const IntegratorInfo& info : integrators())
        if (!only_usual || info.is_usual) names.push_back(info.name);
    return names;
}
std::string name_of_run(const testing::TestParamInfo<EveryScene::ParamType>& info) {
    const auto& [name, integrator, carry] = info.param;
    return name + "_" + integrator + (!carry ? "" : *carry ? "_carry" : "_plain");
}
INSTANTIATE_TEST_SUITE_P(All, EveryScene,
                         testing::Combine(testing::ValuesIn(shipped_scenes()),
                                          testing::ValuesIn(integrator_names(true)), testing::Values(std::nullopt)),
                         name_of_run);
INSTANTIATE_TEST_SUITE_P(Deep, EveryScene,
                         testing::Combine(testing::ValuesIn(shipped_scenes()),
                                          testing::ValuesIn(integrator_names(false)),
                                          testing::Values(std::nullopt, true, false)),
                         name_of_run);

}  // namespace
}  // namespace tumble::host
