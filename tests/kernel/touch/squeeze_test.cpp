// A light box squeezed between a wall and a heavy one. Sweeps alone do not solve such an impact.
#include <tumble/tumble.hpp>

#include "kinds.hpp"

#include <cmath>
#include <utility>

namespace tumble::test::squeeze {
namespace {

template <class N>
struct Squeezing : Scene {
    using Numbers = N;
    static constexpr Features features{.bodies = 2, .planes = 2, .pairs = true, .boxes = true};
};

template <class N>
class SqueezeTest : public testing::Test {};
// Floats have steps at which rounding keeps statics from an answer.
using Systems = Tested<testing::Types<Q32<>>, testing::Types<Q32<FieldRange>, Q32<NearRange, false>>>;
TYPED_TEST_SUITE(SqueezeTest, Systems);

// The heavy box pushes the light one against a wall, all on one line. They end at rest against the wall.
TYPED_TEST(SqueezeTest, stops_a_heavy_box_at_once) {
    for (const auto& [mass, rate] : {std::pair{30.0, 128}, {100.0, 60}, {300.0, 128}, {700.0, 240}, {1000.0, 128}})
        for (const bool mirrored : {false, true}) {
            const Real side = mirrored ? Real{-1} : Real{1};
            WorldSpec spec;
            spec.contact.restitution = 0;
            World<Squeezing<TypeParam>> world{Seconds{1, rate}, spec};
            PlaneSpec wall;
            wall.normal = {side, 0, 0};
            ASSERT_TRUE(world.add(wall));
            const RealVec3 edges{Real{0.4}, Real{0.4}, Real{0.4}};
            (void)world.add(at(box(1, edges), {side * Real{0.21}, 0, 0}));
            const BodyId heavy = world.add(at(box(Real(mass), edges), {side * Real{0.7}, 0, 0}, {-side, 0, 0}));
            for (int step = 0; step < rate; ++step) (void)world.step();
            const auto v = world.velocity(heavy), w = world.angular_velocity(heavy);
            for (const double speed : {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z),
                                       static_cast<double>(w.x), static_cast<double>(w.y), static_cast<double>(w.z)})
                EXPECT_LT(std::abs(speed), 2e-6) << mass << " kg, 1/" << rate << " s" << (mirrored ? ", mirrored" : "");
            EXPECT_NEAR(std::abs(static_cast<double>(world.position(heavy).x)), 0.6, 5e-6);
            EXPECT_TRUE(world.status().ok());
        }
}

}  // namespace
}  // namespace tumble::test::squeeze
