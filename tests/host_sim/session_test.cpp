// A session of the page: hits, going back, and the text that replays it.
#include <random>

#include "command_runner.hpp"
#include "page/session.hpp"
#include "scene/reader.hpp"

namespace tumble::host {
namespace {

constexpr int all = 1 << 30;

Session session_of(const std::string& scene) { return {contents(shipped(scene)), scene + ".toml"}; }
ImpulseDescription kick(int body, Frame frame, Triple impulse, Triple point) {
    return {0, body, frame, impulse, point};
}

// The hash at the end of a saved session, from its text alone.
std::uint64_t replayed(const std::string& text) {
    const SceneDescription scene = read_scene_text(text, "saved.toml");
    const Expectation& expected = scene.expected.value();
    const auto simulation = make_simulation(scene, expected.integrator, expected.numbers, expected.carry);
    while (simulation->steps_taken() < expected.steps) simulation->step();
    EXPECT_EQ(simulation->hash(), expected.hash);
    return simulation->hash();
}

struct Played {
    std::string scene;
    RunWay way;
};
class Session_ : public testing::TestWithParam<Played> {};

TEST_P(Session_, is_saved_as_a_scene_that_replays_to_the_same_bits) {
    Session session = session_of(GetParam().scene);
    session.add(GetParam().way);
    std::mt19937 random(7);
    const auto number = [&](double most) { return std::uniform_real_distribution(-most, most)(random); };
    const auto triple = [&](double most) { return Triple{number(most), number(most), number(most)}; };
    const int bodies = session.run(0).body_count();
    std::int64_t step = 0;
    for (int i = 0; i < 12; ++i) {
        const int body = static_cast<int>(random() % static_cast<unsigned>(bodies));
        const BodyDescription& hit = session.scene().body(body);
        if (!hit.fixed)
            session.hit(hit.is_point_mass()
                            ? kick(body, Frame::world, triple(0.5), {})
                            : kick(body, i % 2 == 0 ? Frame::body : Frame::world, triple(0.5), triple(0.1)));
        session.go_to(0, step += 5 + static_cast<int>(random() % 20), all);
    }
    const std::uint64_t end = session.run(0).hash();
    const std::string text = session.text();
    EXPECT_EQ(replayed(text), end);

    // Going back and forth changes nothing, in however many steps at once.
    for (const std::int64_t to : {step / 3, step - 1, std::int64_t{0}, step}) {
        while (!session.go_to(0, to, 7)) {}
    }
    EXPECT_EQ(session.run(0).hash(), end);

    // It goes on as the one that was saved.
    Session again(text, "again.toml");
    EXPECT_EQ(again.saved_steps(), step);
    again.add(again.saved_way());
    again.go_to(0, step, all);
    EXPECT_EQ(again.run(0).hash(), end);
    for (Session* both : {&session, &again}) {
        if (!both->scene().body(bodies - 1).fixed) both->hit(kick(bodies - 1, Frame::world, {0, 0.3, 0.1}, {}));
        both->go_to(0, step + 50, all);
    }
    EXPECT_EQ(again.run(0).hash(), session.run(0).hash());
    EXPECT_EQ(again.text(), session.text());
}
INSTANTIATE_TEST_SUITE_P(Scenes, Session_,
                         testing::Values(Played{"cube", {"verlet", "q32", true}}, Played{"cube", {"rk4", "f64", false}},
                                         Played{"contacts/stack", {"verlet", "q32", true}},
                                         Played{"orbit", {"verlet", "f64", false}},
                                         Played{"joints/double_pendulum", {"verlet", "q32", true}},
                                         Played{"joints/rope", {"verlet", "q32", true}},
                                         Played{"contacts/kinematic", {"verlet", "f64", false}}),
                         [](const auto& info) {
                             const std::string& scene = info.param.scene;
                             return scene.substr(scene.find('/') + 1) + "_" + info.param.way.numbers;
                         });

// Few digits make products that lie in the middle between two states, which are then rounded by the signs of the hit in
// the body's own axes.
TEST(Session, hits_in_the_frames_of_bodies_that_turn_replay_to_the_same_bits) {
    const auto body = [](const char* name, const char* edges, const char* more) {
        return "[[body]]\nname = \"" + std::string(name) + "\"\nshape = { box = " + edges +
               " }\nmass = 0.75\nangular_velocity = [1.0, -2.0, 1.5]\n" + more;
    };
    const std::string text =
        "[world]\nstep = \"1/256\"\nduration = 8.0\n" + body("a", "[0.4, 0.2, 0.3]", "") +
        body("b", "[0.2, 0.3, 0.4]", "position = [4.0, 0.0, 0.0]\n") +
        body("c", "[0.3, 0.3, 0.3]", "position = [0.0, 4.0, 0.0]\ninertia = [0.05, 0.06, 0.055, 0.01, 0.005, 0.002]\n");
    for (const RunWay& way : {RunWay{"verlet", "q32", true}, RunWay{"rk4", "q32", true}, RunWay{"verlet", "f32", true},
                              RunWay{"verlet", "f64", false}}) {
        Session session(text, "turning.toml");
        session.add(way);
        std::mt19937 random(11);
        const auto triple = [&](int most) {
            Triple v{};
            for (double& x : v) x = (static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most) / 256.0;
            return v;
        };
        for (std::int64_t step = 4; step <= 480; step += 4) {
            session.hit(kick(static_cast<int>(random() % 3), Frame::body, triple(32), triple(24)));
            session.go_to(0, step, all);
        }
        EXPECT_EQ(replayed(session.text()), session.run(0).hash()) << way.integrator << ", " << way.numbers;
    }
}

TEST(Session, a_hit_in_the_past_forgets_the_future) {
    Session session = session_of("cube");
    session.add(session.saved_way());
    const ImpulseDescription up = kick(0, Frame::world, {0, 0.2, 0}, {});
    session.go_to(0, 50, all);
    session.hit(up);
    session.hit(up);  // both act
    session.go_to(0, 70, all);
    session.hit(up);
    EXPECT_EQ(session.hits().size(), 3u);
    session.go_to(0, 50, all);
    session.hit(up);
    EXPECT_EQ(session.hits().size(), 1u);
    session.hit(up);
    EXPECT_EQ(session.hits().size(), 2u);
    session.go_to(0, 200, all);
    EXPECT_EQ(replayed(session.text()), session.run(0).hash());
}

TEST(Session, hits_come_after_the_events_of_the_scene) {
    const std::string text =
        "[world]\nstep = 0.01\nduration = 2.0\n[[body]]\nname = \"b\"\nshape = { box = [0.1, 0.2, "
        "0.3] }\nmass = 1.0\nangular_velocity = [3.0, 2.0, 1.0]\n[[impulse]]\ntime = 0.5\nbody = "
        "\"b\"\nimpulse = [0.1, 0.2, 0.7]\npoint = [0.05, 0.01, 0.02]\n[[event]]\ntime = 0.51\nkind = "
        "\"velocity\"\nbody = \"b\"\nvalue = [1.0, 2.0, 3.0]\n";
    for (const char* numbers : {"q32", "f64"}) {
        Session session(text, "events.toml");
        session.add({"verlet", numbers, numbers == std::string("q32")});
        session.go_to(0, 50, all);
        EXPECT_EQ(session.hit(kick(0, Frame::body, {0.3, 0.1, 0.1}, {0, 0.1, 0})), 52);
        session.go_to(0, 120, all);
        EXPECT_EQ(replayed(session.text()), session.run(0).hash()) << numbers;
        // A session that is saved early keeps what acts later.
        session.go_to(0, 20, all);
        EXPECT_EQ(read_scene_text(session.text(), "early.toml").duration, 0.51) << numbers;
        EXPECT_EQ(replayed(session.text()), session.run(0).hash()) << numbers;
    }
}

// Translation without loads but gravity is exact in rk4 at any step.
TEST(Session, runs_of_other_steps_take_hits_at_the_same_times) {
    Session session = session_of("free");
    session.add(session.saved_way());
    for (const int halvings : {4, 1, -1, -2}) session.add({"rk4", "f64", false, halvings});
    session.go_to(0, 40, all);
    session.hit(kick(0, Frame::world, {0.5, 0.5, 0}, {0, 0.2, 0}));
    for (std::size_t run = 0; run < 5; ++run) session.go_to(run, 120, all);
    for (std::size_t run = 0; run < 5; ++run) {
        EXPECT_NEAR(static_cast<double>(session.run(run).time()), 120 * session.scene().step.seconds(), 1e-12);
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_NEAR(static_cast<double>(session.run(run).body(0).position[i]),
                        static_cast<double>(session.run(1).body(0).position[i]), run == 0 ? 1e-5 : 1e-12);
    }
}

// Their impulses and forces act when those of the played run do, though their own steps would round the times
// otherwise.
TEST(Session, runs_of_other_steps_round_the_times_of_the_scene_to_its_steps) {
    const std::string text =
        "[world]\nstep = 0.1\nduration = 2.0\n[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 1.0\n"
        "[[impulse]]\ntime = 0.54\nbody = \"b\"\nimpulse = [1.0, 0.0, 0.0]\n[[force]]\nbody = "
        "\"b\"\nfrom = 0.76\nuntil = 1.04\nforce = [0.0, 1.0, 0.0]\n";
    Session session(text, "between.toml");
    session.add({"rk4", "f64", false});
    session.add({"rk4", "f64", false, 4});
    for (const std::size_t run : {0u, 1u}) session.go_to(run, 20, all);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(static_cast<double>(session.run(0).body(0).position[i]),
                    static_cast<double>(session.run(1).body(0).position[i]), 1e-12);
}

// A place on the body and the body's axes mean nothing there.
TEST(Session, a_hit_of_a_point_mass_anywhere_is_saved_so_that_it_replays) {
    Session session = session_of("stone");
    session.add(session.saved_way());
    for (const Frame frame : {Frame::body, Frame::world}) {
        session.hit({0, 0, frame, {0.1, 0.2, 0.3}, {0.02, 0, 0.01}, {0, 0, 0.1}});
        session.go_to(0, session.run(0).steps_taken() + 9, all);
    }
    EXPECT_EQ(replayed(session.text()), session.run(0).hash());
}

// What a person adds to a saved session is of the scene.
TEST(Session, that_was_added_to_by_hand_loses_nothing) {
    const std::string force = "\n[[force]]\nbody = \"cube\"\nuntil = 0.3\nforce = [1.0, 0.0, 0.0]\n",
                      joint = "\n[[joint]]\nkind = \"hinge\"\nbody = \"brick\"\nanchor = [0.0, 10.0, 0.2]\n"
                              "axis = [0.3, 0.0, 1.0]\n";
    for (const auto& [scene, added] : {std::pair{"cube", force}, std::pair{"free", joint}}) {
        Session session = session_of(scene);
        session.add(session.saved_way());
        session.go_to(0, 100, all);
        Session again(session.text() + added, "added.toml");
        EXPECT_EQ(again.scene().forces.size() + again.scene().joints.size(), 1u);
        again.add(again.saved_way());
        again.go_to(0, 100, all);
        EXPECT_TRUE(has(again.text(), added)) << added;
        EXPECT_EQ(replayed(again.text()), again.run(0).hash());
    }
}

// Whatever a person writes, the saved text is a scene that replays.
TEST(Session, is_saved_from_any_way_of_writing_toml) {
    const std::string body = "[[body]]\nname = \"b\"\nshape = \"none\"\nmass = 1.0\n",
                      ending = "integrator = \"rk4\"\nnumbers = \"f64\"\nsteps = 3\ntumble_bits = 1\nhash = "
                               "\"0123456789abcdef\"\n",
                      world = "[world]\nstep = 0.01\nduration = 2.0 # s\n";
    std::string crlf;
    for (const char c : world + body) crlf += c == '\n' ? "\r\n" : std::string(1, c);
    for (const std::string& text : {
             world + body,
             crlf,
             "world = { step = 0.01, duration = 2.0, gravity = [0.0, -1.0, 0.0] }\n" + body,
             "world.step = 0.01\nworld.duration = 2\n" + body,
             "[expect]\n" + ending + world + body,
             "  [ expect ] # recorded\n" + ending + "# of the world\n" + world + body,
             world + "[expect]\n" + ending + body,
             world + body + "\n[expect]\n" + ending,
             "expect = { integrator = \"rk4\", numbers = \"f64\", steps = 3, tumble_bits = 1, hash = "
             "\"0123456789abcdef\" }\n" +
                 world + body,
             "name = \"\"\"\n[expect]\n\"\"\"\n" + world + body,
             "name = \"m\\u00fcller, [expect] \xc3\xbc\"\n" + world + body,
             world + body.substr(0, body.size() - 1),
             "impulse = [ { time = 0.1, body = \"b\", impulse = [0.0, 1.0, 0.0] } ]\n" + world + body,
             "impulse = []\n" + world + body,
             "\xef\xbb\xbfworld = { step = 0.01, duration = 2.0 }\n" + body,
             "expect.integrator = \"rk4\"\nexpect.numbers = \"f64\"\nexpect.steps = 3\nexpect.tumble_bits = 1\n"
             "expect.hash = \"0123456789abcdef\"\n" +
                 world + body,
             world + "[[body]]\nname = \"a\\u007fb\"\nshape = \"none\"\nmass = 1.0\n",
             "name = \"\"\"a\n\n# The session: hits of the player, and how it ended.\nb\"\"\"\n" + world + body,
         }) {
        Session session(text, "any.toml");
        session.add({"verlet", "f64", false});
        session.hit(kick(0, Frame::world, {0.1, 0.2, 0.3}, {}));
        session.go_to(0, 30, all);
        const std::string saved = session.text();
        EXPECT_EQ(replayed(saved), session.run(0).hash()) << saved;
        EXPECT_EQ(read_scene_text(saved, "saved.toml").steps(), 30) << saved;
        Session again(saved, "again.toml");
        again.add(again.saved_way());
        again.go_to(0, 30, all);
        EXPECT_EQ(again.text(), saved);
    }
}

}  // namespace
}  // namespace tumble::host
