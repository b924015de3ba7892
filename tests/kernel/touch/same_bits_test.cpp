// What a world could have and does not have changes no bit. A body that touches nothing that moves is solved in one
// way, whether or not pairs are compiled in. Two bodies fly in one way, whether or not springs are.
#include <tumble/tumble.hpp>

#include "kinds.hpp"
#include "random.hpp"

namespace tumble::test::same_bits {
namespace {

inline constexpr Features alone{.bodies = 1, .planes = 2, .boxes = true, .round_shapes = true, .friction = true};
inline constexpr Features among_others = [] {
    Features features = alone;
    features.bodies = 2;
    features.pairs = true;
    return features;
}();
inline constexpr Features with_springs = [] {
    Features features = among_others;
    features.springs = 1;
    return features;
}();

template <class N>
class SameBits : public testing::Test {
protected:
    // Boxes and cans that fall flat, or with a lean and a spin, on a floor that leans, beside a slope.
    struct Drop {
        Seconds step{1, 128};
        WorldSpec spec;
        BodySpec body, other;  // the latter is above it
        RealVec3 up;           // of the floor

        // Of the world after 192 steps.
        template <Features what>
        [[nodiscard]] std::uint64_t hash(bool with_other) const {
            World<SceneOf<N, integrators::Verlet, what>> world{step, spec};
            EXPECT_TRUE(world.add(PlaneSpec{.normal = up}));
            EXPECT_TRUE(world.add(PlaneSpec{.normal = {-0.6, 0.8, 0}, .offset = -1.5}));
            (void)world.add(body);
            if (with_other) (void)world.add(other);
            for (int i = 0; i < 192; ++i) (void)world.step();
            return world.hash();
        }
    };
    // `spin`: rad/s at most.
    template <class F>
    static void for_each_drop(int drops, double spin, F&& f) {
        Random random{1};
        const auto uniform = [&](double least, double most) { return random.uniform(least, most); };
        for (int i = 0; i < drops; ++i) {
            Drop drop;
            if (i % 5 == 0) drop.step = {1, 60};
            drop.spec.gravity = {0, -9.81, 0};
            drop.spec.contact.restitution = i % 3 == 0 ? 0 : uniform(0, 0.7);
            drop.spec.contact.friction = i % 4 == 0 ? 0 : uniform(0, 1);
            const RealQuat lean = rotation_about({uniform(-1, 1), 0, 1}, i % 5 == 0 ? 0 : uniform(0, 0.3));
            drop.up = detail::rotated_back({lean.w, -lean.v}, {0, 1, 0});
            const double a = uniform(0.1, 0.6), b = uniform(0.1, 0.6), c = uniform(0.1, 0.6);
            BodySpec& body = drop.body;
            body = i % 7 == 0 ? cylinder(uniform(0.1, 10), a / 2, b) : box(uniform(0.1, 10), {a, b, c});
            body.position = {uniform(-1, 1), uniform(0.4, 0.8), 0};
            body.velocity = {uniform(-2, 2), uniform(-1, 0), 0};
            body.orientation = lean;
            if (i % 2 == 0) {
                body.orientation = rotation_about({1, 2, 3}, uniform(0, 1));
                body.angular_velocity = {uniform(-spin, spin), uniform(-spin, spin), uniform(-spin, spin)};
            }
            drop.other = body;
            if (i % 3 != 1) drop.other.mass *= Real{uniform(0.05, 20)};
            drop.other.position += RealVec3{uniform(-0.2, 0.2), 0.7, 0};
            f(drop, i);
        }
    }
};
using Systems = Tested<testing::Types<Q32<>>, testing::Types<Q32<NearRange, false>, F32, F64>>;
TYPED_TEST_SUITE(SameBits, Systems);

TYPED_TEST(SameBits, of_a_lone_body_where_others_could_be) {
    this->for_each_drop(200, 5, [](const auto& drop, int i) {
        EXPECT_EQ(drop.template hash<alone>(false), drop.template hash<among_others>(false)) << i;
    });
}

// What differed spun fast about its long axis.
TYPED_TEST(SameBits, of_two_bodies_where_springs_could_be) {
    this->for_each_drop(30, 20, [](const auto& drop, int i) {
        EXPECT_EQ(drop.template hash<among_others>(true), drop.template hash<with_springs>(true)) << i;
    });
}

}  // namespace
}  // namespace tumble::test::same_bits
