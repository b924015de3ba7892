// Unused features change no bit: a world with only the features of a scene against one with all features.
#include "references.hpp"
#include "scenes.hpp"

namespace tumble::test {
namespace {

class Skipping : public testing::TestWithParam<Case> {};

bool has_minimal_world(const Case& c) { return build_minimal({}, c) != nullptr; }
INSTANTIATE_TEST_SUITE_P(every, Skipping, testing::ValuesIn(cases_where(has_minimal_world)), NameOf{});

TEST_P(Skipping, features_that_are_compiled_in_but_not_used_change_no_bit) {
    for (const SceneSetup& scene : scenes()) {
        const auto minimal = build_minimal(scene, GetParam()), full = build(scene, GetParam());
        ASSERT_NE(minimal, nullptr) << scene.name;
        for (int step = 0; step < 600; ++step) {
            minimal->step();
            full->step();
            ASSERT_EQ(minimal->hash(), full->hash()) << scene.name << " differs after step " << step;
            ASSERT_EQ(minimal->status().bits, full->status().bits) << scene.name << " differs after step " << step;
        }
    }
}

TEST_P(Skipping, features_that_are_present_but_do_nothing_change_no_bit) {
    for (const SceneSetup& scene : scenes()) {
        SceneSetup busy = scene;
        const int body = static_cast<int>(busy.bodies.size());
        busy.bodies.push_back(fixed(placed(sphere(1, 0.25), {-40, 0, 40})));  // not connected to the others
        busy.forces.push_back({.body = body, .from = 0.0, .until = 100.0, .force = {1, 0, 0}});
        busy.impulses.push_back({.time = 0.5, .body = body, .impulse = {1, 0, 0}});
        if (!scene.planes.empty()) busy.planes.push_back({.normal = {1, 0, 0}, .offset = 50});
        // In these scenes every body is connected to every other.
        if (scene.needs.gravitation || !scene.world.contact.barrier.is_zero()) continue;
        const auto plain = build(scene, GetParam()), other = build(busy, GetParam());
        for (int step = 0; step < 200; ++step) {
            plain->step();
            other->step();
            for (int b = 0; b < body; ++b) {
                const Motion x = plain->motion(b), y = other->motion(b);
                ASSERT_TRUE(x.x == y.x && x.v == y.v && x.q == y.q && x.w == y.w)
                    << scene.name << " differs after step " << step;
            }
        }
    }
}

TEST_P(Skipping, the_same_scene_run_twice_gives_the_same_bits) {
    for (const SceneSetup& scene : scenes()) {
        const auto a = build(scene, GetParam()), b = build(scene, GetParam());
        a->run(100);
        b->run(100);
        EXPECT_EQ(a->hash(), b->hash()) << scene.name;
        b->step();
        EXPECT_NE(a->hash(), b->hash()) << scene.name;
    }
}

}  // namespace
}  // namespace tumble::test
