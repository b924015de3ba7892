// One law, two rooms: a body that touches nothing that moves has the same bits whether or not its world has room for
// pairs and for more bodies.
#include <tumble/tumble.hpp>

#include "kinds.hpp"

#include <random>

namespace tumble::test::lone_body {
namespace {

inline constexpr Features alone{.bodies = 1, .planes = 2, .boxes = true, .round_shapes = true, .friction = true};
inline constexpr Features among_others = [] {
    Features features = alone;
    features.bodies = 2;
    features.pairs = true;
    return features;
}();

template <class N, Features what>
struct Falling : Scene {
    using Numbers = N;
    static constexpr Features features = what;
};

template <class N>
class LoneBody : public testing::Test {};
using Systems = Tested<testing::Types<Q32<>>, testing::Types<Q32<NearRange, false>, F32, F64>>;
TYPED_TEST_SUITE(LoneBody, Systems);

// Boxes and cans that fall flat, or with a lean and a spin, on a floor that leans, beside a slope.
TYPED_TEST(LoneBody, has_the_same_bits_where_others_could_be) {
    std::mt19937 draw{1};
    const auto uniform = [&](double least, double most) {
        return least + (most - least) * (static_cast<double>(draw()) / static_cast<double>(draw.max()));
    };
    for (int drop = 0; drop < 200; ++drop) {
        WorldSpec spec;
        spec.gravity = {0, -9.81, 0};
        spec.contact.restitution = drop % 3 == 0 ? Real{0} : Real{uniform(0, 0.7)};
        spec.contact.friction = drop % 4 == 0 ? Real{0} : Real{uniform(0, 1)};
        const RealQuat lean = rotation_about({uniform(-1, 1), 0, 1}, drop % 5 == 0 ? 0 : uniform(0, 0.3));
        const Real two = 2;
        const RealVec3 up{two * (lean.v.x * lean.v.y - lean.w * lean.v.z),
                          Real{1} - two * (lean.v.x * lean.v.x + lean.v.z * lean.v.z),
                          two * (lean.v.y * lean.v.z + lean.w * lean.v.x)};
        const Vector3<double> edges{uniform(0.1, 0.6), uniform(0.1, 0.6), uniform(0.1, 0.6)};
        BodySpec body = drop % 7 == 0 ? cylinder(uniform(0.1, 10), edges.x / 2, edges.y)
                                      : box(uniform(0.1, 10), {edges.x, edges.y, edges.z});
        body.position = {uniform(-1, 1), uniform(0.4, 0.8), 0};
        body.velocity = {uniform(-2, 2), uniform(-1, 0), 0};
        body.orientation = lean;
        if (drop % 2 == 0) {
            body.orientation = rotation_about({1, 2, 3}, uniform(0, 1));
            body.angular_velocity = {uniform(-5, 5), uniform(-5, 5), uniform(-5, 5)};
        }
        const auto hash_of = [&](auto world) {
            EXPECT_TRUE(world.add(PlaneSpec{.normal = up}));
            EXPECT_TRUE(world.add(PlaneSpec{.normal = {-0.6, 0.8, 0}, .offset = -1.5}));
            (void)world.add(body);
            for (int step = 0; step < 192; ++step) (void)world.step();
            return world.hash();
        };
        const Seconds step{1, drop % 5 == 0 ? 60 : 128};
        EXPECT_EQ((hash_of(World<Falling<TypeParam, alone>>{step, spec})),
                  (hash_of(World<Falling<TypeParam, among_others>>{step, spec})))
            << drop;
    }
}

}  // namespace
}  // namespace tumble::test::lone_body
